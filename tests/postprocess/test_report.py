"""The report: complete in one file, also for a run that was killed, and without a screen."""

import re
from pathlib import Path

import pytest

import fsi
from fsi.errors import InputError
from fsi.postprocess.render import canvas
from fsi.postprocess.report import write_report
from tests.postprocess.conftest import write_bodies
from tests.small_run import small_case, start
from tests.strict_html import StrictReader

HEADER = "step,t,h,smallest_gap,rejected,power,momentum\n"
ROWS = "0,0.0,0.0,0.2,0,1e-12,2e-9\n1,0.5,0.5,0.15,0,0,0\n2,1.0,0.5,0.1,0,-3e-9,1e-12\n"
PROVENANCE = (
    '{"launches": [{"started": "now", "command": "fsi run <case>", "ranks": 1, "git": null,'
    ' "python": "3", "platform": "here", "packages": {"numpy": "2"}}]}'
)


def page(run: Path) -> str:
    write_report(fsi.open_run(run), run / "report.html")
    return (run / "report.html").read_text()


@pytest.fixture
def checked_run(run: Path) -> Path:
    """The run folder of conftest, with steps up to t = 1 of 2 and provenance."""
    (run / "steps.csv").write_text(HEADER + ROWS)
    write_bodies(run, [0.0, 0.5, 1.0], [1.2, 1.15, 1.1])
    (run / "provenance.json").write_text(PROVENANCE)
    return run


@pytest.mark.usefixtures("drawing")
def test_it_needs_no_other_file_and_no_network(checked_run: Path) -> None:
    text = page(checked_run)
    read = StrictReader(text)
    assert read.errors == []
    assert [source[:22] for source in read.sources] == [
        f"data:image/{kind};base64," for kind in ("png", "png", "gif")
    ]
    rest = re.sub(r"base64,[A-Za-z0-9+/=]*", "", text)
    assert not re.search(r"https?:|url\(|@import|<script|<link|//", rest)
    assert "--field dissipation: is not in the files" in text  # said, not hidden


def test_a_run_killed_half_way_says_so(checked_run: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(canvas, "_DRAW", "raise SystemExit(1)")
    text = page(checked_run)
    assert "<b>Not finished</b>" in text
    assert "t = 1 of 2." in text
    assert "no off-screen OpenGL" in text
    assert "fsi run &lt;case&gt;" in text
    assert StrictReader(text).errors == []


def test_checks_have_their_worst_values(checked_run: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(canvas, "_DRAW", "raise SystemExit(1)")
    rows = re.findall(r"<tr>(.*?)</tr>", page(checked_run))
    cells = {
        row[0]: row[2:] for row in (re.findall(r"<td[^>]*>(.*?)</td>", row) for row in rows) if len(row) == 6
    }
    assert cells["power"] == ["3.0e-09", "1", "1e-08", "holds"]
    assert cells["momentum"] == ["2.0e-09", "0", "1e-08", "holds"]
    assert cells["gap"] == ["0.1", "1", "&gt; 0", "holds"]


def test_a_violated_identity_is_marked(checked_run: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(canvas, "_DRAW", "raise SystemExit(1)")
    (checked_run / "steps.csv").write_text(HEADER + "0,0.0,0.0,0.2,0,2e-8,0\n")
    write_bodies(checked_run, [0.0], [1.2])
    assert "VIOLATED" in page(checked_run)


@pytest.mark.usefixtures("drawing")
def test_a_finished_run_without_fields(tmp_path: Path) -> None:
    """Its bodies are drawn by its tables, in few steps: each is a frame of the film."""
    short = {"end": 0.05, "first_step": 0.05}
    start(small_case(time=short, output={"fields": False}), tmp_path / "run")
    text = page(tmp_path / "run")
    assert "Finished: " in text
    assert "Not finished" not in text
    assert len(StrictReader(text).sources) == 3
    assert 'class="warning"' not in text
    assert "speeds of the bodies at the last step; the run has written no fields" in text


def test_fields_that_a_run_has_not_are_told_of_once(checked_run: Path) -> None:
    """Around an axis all pictures but the histories need them; the page may be read in any folder."""
    (checked_run / "fluid.pvd").unlink()
    case = checked_run / "case.toml"
    case.write_text(case.read_text().replace("planar", "axisymmetric"))
    (reason,) = re.findall(r'<p class="warning">([^<]*)</p>', page(checked_run).split("<h2>Checks")[0])
    assert reason.startswith("fluid.pvd: the run has written no fields; ")


@pytest.mark.parametrize("table", ["steps", "bodies"])
def test_changed_tables_are_refused(table: str, tmp_path: Path) -> None:
    """As by all that reads them: a report that only says so looked like one of the run."""
    start(small_case(output={"fields": False}), tmp_path / "run")
    path = tmp_path / "run" / f"{table}.csv"
    path.write_text(path.read_text().replace("step,t,", "stop,t,", 1))
    with pytest.raises(InputError, match=rf"{table}\.csv: was changed since the run wrote it"):
        page(tmp_path / "run")
    assert not (tmp_path / "run" / "report.html").exists()


def test_a_run_killed_before_its_first_step(run: Path) -> None:
    (run / "bodies.csv").unlink()
    (run / "fluid.pvd").unlink()
    assert "steps.csv: is not there yet; continue the run with `fsi resume`" in page(run)


def test_output_must_be_html(run: Path) -> None:
    with pytest.raises(InputError, match=r"give the path of a \.html file"):
        write_report(fsi.open_run(run), run / "report.pdf")


@pytest.mark.parametrize(
    ("page", "wrong"),
    [
        ("<p><b>a</p></b>", "</p> closes nothing"),
        ("<table><td>1</td></table>", "<td> in <table>"),
        ("<p><table></table></p>", "<table> in <p>"),
        ("<div>", "<div> is not closed"),
    ],
)
def test_the_strict_reader_sees_what_browsers_forgive(page: str, wrong: str) -> None:
    assert wrong in StrictReader(page).errors
