"""Reports of runs of every model as a browser reads them: well formed, complete, in need of no other file."""

from __future__ import annotations

import base64
import io
import re
import shutil
import sys
from pathlib import Path

import pytest
from PIL import Image

import fsi
from fsi.cli.main import main
from fsi.integration.state import StepRecord
from fsi.postprocess.render import canvas
from fsi.postprocess.report import write_report
from fsi.runs import run
from tests.reduced_data import heap, reduced_case
from tests.strict_html import StrictReader

CASES = Path(__file__).parents[2] / "cases"


def page(folder: Path) -> str:
    """The text of the report; all pictures are inside and can be decoded."""
    write_report(fsi.open_run(folder), folder / "report.html")
    text = (folder / "report.html").read_text(encoding="utf-8")
    found = StrictReader(text)
    assert found.errors == []
    assert "url(" not in text
    assert "@import" not in text
    assert found.sources
    for address in found.sources:
        kind, _, data = address.partition(",")
        assert kind in ("data:image/png;base64", "data:image/gif;base64")
        with Image.open(io.BytesIO(base64.b64decode(data, validate=True))) as picture:
            picture.load()
            assert min(picture.size) >= 100
    return found.words


@pytest.fixture(autouse=True)
def _no_opengl(monkeypatch: pytest.MonkeyPatch) -> None:
    """Histories only, as pictures by OpenGL take seconds; test_report.py has them."""
    monkeypatch.setattr(canvas, "_DRAW", "raise SystemExit(1)")


@pytest.mark.parametrize("name", ["gluey/two_discs", "macroscopic/blocks"])
def test_limits_of_vanishing_viscosity(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Their cases have other keys than those of the models with a fluid."""
    few = ["--set", "time.end=0.1"] + (["--set", "macroscopic.parcels=40"] if "blocks" in name else [])
    monkeypatch.setattr(
        sys, "argv", ["fsi", "run", str(CASES / f"{name}.toml"), "-o", str(tmp_path / "run"), *few]
    )
    assert main() == 0
    words = page(tmp_path / "run")
    assert "Finished:" in words
    assert "unknown key" not in words
    assert "VIOLATED" not in words
    assert f"{name.split('/')[0]} model" in words


def parts(folder: Path) -> tuple[dict[str, list[str]], list[str]]:
    """The cells of each check from its worst value on, by its name, and the columns of the table of steps."""
    write_report(fsi.open_run(folder), folder / "report.html")
    checks, steps = (folder / "report.html").read_text().split("<h2>Checks</h2>")[1].split("<h2>Steps</h2>")
    rows = [re.findall(r"<td[^>]*>(.*?)</td>", row) for row in re.findall(r"<tr>(.*?)</tr>", checks)]
    columns = re.findall(r"<th[^>]*>(.*?)</th>", steps.split("</table>")[0])
    return {row[0]: row[2:] for row in rows if len(row) == 6}, columns


def test_checks_of_impulses_have_the_bounds_of_their_model(tmp_path: Path) -> None:
    """What `fsi.gluey.step` refuses: 1e-8, 1e-12 and 1e-10; one bound of 1e-8 would hold for all three."""
    columns = ["step", "t", "smallest_gap", "contacts", "kkt", "momentum_defect", "overlap"]
    rows = ["0,0.0,0.2,0,0.0,0.0,0.0", "1,0.1,0.1,1,1e-9,1e-11,1e-9"]
    shutil.copy(CASES / "gluey" / "two_discs.toml", tmp_path / "case.toml")
    (tmp_path / "steps.csv").write_text("\n".join([",".join(columns), *rows]) + "\n")
    found, shown = parts(tmp_path)
    assert found["kkt"] == ["1.0e-09", "0.1", "1e-08", "holds"]
    assert found["momentum_defect"] == ["1.0e-11", "0.1", "1e-12", "VIOLATED"]
    assert found["overlap"] == ["1.0e-09", "0.1", "1e-10", "VIOLATED"]
    assert shown == ["step", "t", "smallest_gap", "contacts"]


@pytest.mark.parametrize(("model", "bound"), [("resolved", "1e-08"), ("pores", "1e-06")])
def test_a_suspension_is_checked_by_its_viscosity(model: str, bound: str, tmp_path: Path) -> None:
    """Where bodies have loads its bound is not known: no check then. Neither is a result of the steps."""
    case = (CASES / "compare_channel.toml").read_text()
    (tmp_path / "case.toml").write_text(f'model = "{model}"\n{case}')
    columns = "step,t,smallest_gap,apparent_viscosity,power,stress,viscosity_bound"
    (tmp_path / "steps.csv").write_text(f"{columns}\n0,0.0,0.2,1.5,0.0,1e-10,\n1,0.1,0.1,1.6,0.0,2e-10,\n")
    found, shown = parts(tmp_path)
    assert found["stress"] == ["2.0e-10", "0.1", bound, "holds"]
    assert "viscosity_bound" not in found
    assert shown == ["step", "t", "smallest_gap", "apparent_viscosity"]


@pytest.mark.parametrize("killed", [False, True])
def test_reduced(killed: bool, tmp_path: Path) -> None:
    case = reduced_case(heap(), {"drag": 12.0, "cutoff": 0.5}, time={"end": 0.2, "tolerance": 1e-3})

    def stop(record: StepRecord) -> None:
        if killed and record.step == 1:
            raise KeyboardInterrupt

    try:
        run(case, tmp_path / "run", stop)
    except KeyboardInterrupt:
        assert killed
    words = page(tmp_path / "run")
    assert ("Not finished" in words) == killed
    assert ("Finished:" in words) != killed
    assert "1e-12" in words  # the bound of this model
    assert "VIOLATED" not in words
