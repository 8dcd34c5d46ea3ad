"""The case file that the documentation shows, and the files that README and documentation name."""

import re
import tomllib
from pathlib import Path

from fsi.case.case import MODELS
from fsi.case.load import parse_case
from fsi.case.reference import as_markdown, sections_of_case

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
TEXT = "\n".join(page.read_text() for page in PAGES)


def test_the_example_is_a_case() -> None:
    """Every key in it is known, and these sections are complete."""
    example = re.search(r"```toml\n(.*?)```", (ROOT / "docs" / "case-file.md").read_text(), re.DOTALL)
    assert example is not None
    case = parse_case(tomllib.loads(example[1]))
    given = case.model_dump(exclude_unset=True)
    for section in ("fluid", "discretisation", "time", "output"):
        fields = type(getattr(case, section)).model_fields
        assert set(fields) == set(given[section]), section


def test_the_example_of_a_periodic_domain_is_a_case() -> None:
    examples = re.findall(r"```toml\n(.*?)```", (ROOT / "docs" / "case-file.md").read_text(), re.DOTALL)
    case = parse_case(tomllib.loads(examples[1]))
    assert (len(case.bodies), len(case.forces), len(case.container().periods)) == (2, 4, 2)


def test_the_example_of_four_levels_is_a_case_at_each() -> None:
    examples = re.findall(r"```toml\n(.*?)```", (ROOT / "docs" / "case-file.md").read_text(), re.DOTALL)
    for model in MODELS:
        assert parse_case(tomllib.loads(examples[2]) | {"model": model}).model == model


def test_the_example_of_an_arrangement_is_a_case() -> None:
    examples = re.findall(r"```toml\n(.*?)```", (ROOT / "docs" / "case-file.md").read_text(), re.DOTALL)
    assert len(parse_case(tomllib.loads(examples[3])).bodies) == 20


def test_the_page_of_the_case_file_is_what_the_schema_says() -> None:
    """Complete: every key of every section has its line, with a meaning."""
    page = (ROOT / "docs" / "case-file.md").read_text().partition("<!-- generated -->")[2]
    sections = sections_of_case()
    assert page.strip() == as_markdown(sections).strip(), "write it anew with `fsi keys --markdown`"
    assert all(line.endswith("|") for line in page.splitlines() if line.startswith("| ")), "a row is one line"
    assert [key.name for section in sections for key in section.keys if not key.meaning] == []
    named = {key.name for section in sections for key in section.keys}
    assert {"variant", "gamma_min", "eps", "roughness", "friction", "tangential", "scheme"} <= named
    assert {"drag", "wall_law", "extrapolate", "parcels", "blocks", "counts"} <= named


def test_the_page_of_the_run_folder_has_all_that_commands_write_there() -> None:
    page = (ROOT / "docs" / "run-folder.md").read_text()
    commands = ("analyse", "export", "plot", "render", "report")
    text = "\n".join((ROOT / "fsi" / "cli" / f"{name}.py").read_text() for name in commands)
    written = set(re.findall(r'"(\w+\.(?:png|html|xdmf|vtkhdf|csv)|revolved)"', text))
    assert {"history.png", "report.html", "revolved", "fields.xdmf"} <= written
    written.remove("calibration.png")  # into the folder of a calibration
    assert [name for name in sorted(written) if not re.search(rf"`{re.escape(name)}/?`", page)] == []


def test_the_files_that_they_name_exist() -> None:
    named = re.findall(r"\b(?:cases|tests|bench|docs|fsi|meshes)/[\w/-]+\.\w+", TEXT)
    assert len(named) > 20
    assert [name for name in named if not (ROOT / name).is_file()] == []
