"""The case file that the documentation shows, and the files that README and documentation name."""

import re
import tomllib
from pathlib import Path

from fsi.case.load import parse_case

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
        shown = {name for name, field in fields.items() if not field.exclude}  # not what the case puts there
        assert shown == set(given[section]), section


def test_the_example_of_a_periodic_domain_is_a_case() -> None:
    examples = re.findall(r"```toml\n(.*?)```", (ROOT / "docs" / "case-file.md").read_text(), re.DOTALL)
    case = parse_case(tomllib.loads(examples[1]))
    assert (len(case.bodies), len(case.forces), len(case.container().periods)) == (2, 4, 2)


def test_the_files_that_they_name_exist() -> None:
    named = re.findall(r"\b(?:cases|tests|bench|docs|fsi|meshes)/[\w/-]+\.\w+", TEXT)
    assert len(named) > 20
    assert [name for name in named if not (ROOT / name).is_file()] == []
