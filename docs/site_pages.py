"""What the site has beside the pages of this folder: one for each example, and the table of `fsi validate`.

`mkdocs.yml` names this module as a hook. The pages are made from the examples' docstrings and code and from
the files that `fsi validate` writes, each time that the site is built.
"""

from __future__ import annotations

import ast
import json
from pathlib import Path
from typing import Any

DOCS = Path(__file__).parent
EXAMPLES, PICTURES, VALIDATION = DOCS / "examples", DOCS / "gallery", DOCS / "validation"


def examples() -> list[Path]:
    """The scripts of the gallery, by name."""
    return sorted(EXAMPLES.glob("*.py"))


def title(example: Path) -> str:
    """The question that it answers: the first paragraph of its docstring."""
    return " ".join(docstring(example).partition("\n\n")[0].split())


def docstring(example: Path) -> str:
    """Of the module. Raises ValueError: it has none."""
    found = ast.get_docstring(ast.parse(example.read_text(encoding="utf-8")))
    if found is None:
        raise ValueError(f"{example}: has no docstring")
    return found


def example_page(example: Path) -> str:
    """Its question, picture, words and code, in Markdown."""
    name, words = example.stem, docstring(example).partition("\n\n")[2]
    code = example.read_text(encoding="utf-8").partition('"""\n\n')[2]
    return (
        f"# {title(example)}\n\n![{title(example)}]({name}.png)\n\n{words}\n\n"
        f"`docs/examples/{name}.py`:\n\n```python\n{code.strip()}\n```\n"
    )


def gallery_page() -> str:
    """All examples, each by its picture and question."""
    text = (
        "# Gallery\n\nEach picture is made by a script of some fifty lines in `docs/examples`, which also "
        "asserts a number that has a source; the tests run all of them. Click for the code.\n\n"
        "| | |\n|---|---|\n"
    )
    for each in examples():
        name, words = each.stem, title(each)
        text += f"| [![{words}]({name}.png){{ width=300 }}]({name}.md) | [{words}]({name}.md) |\n"
    return text


def validation_table() -> str:
    """The rows of `fsi validate`, in Markdown."""
    rows = json.loads((VALIDATION / "validation.json").read_text(encoding="utf-8"))
    lines = [
        "| case | quantity | gap/a | resolved | reference | true error | estimated | tolerance |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for row in rows:
        gap = "" if row["gap"] is None else f"{row['gap']:g}"
        numbers = f"{row['value']:.9g} | {row['reference']:.9g} | {row['true_error']:.1e}"
        bars = f"{row['error_bar']:.1e} | {row['rtol']:.0e}"
        lines.append(f"| {row['case']} | `{row['quantity']}` | {gap} | {numbers} | {bars} |")
    return "\n".join(lines)


def on_files(files: Any, config: Any) -> Any:
    """Of mkdocs: add the pages that are made, and the picture of the validation."""
    from mkdocs.structure.files import File

    made = {"gallery/index.md": gallery_page()}
    made |= {f"gallery/{each.stem}.md": example_page(each) for each in examples()}
    for path, text in made.items():
        files.append(File.generated(config, path, content=text))
    picture = VALIDATION / "validation.png"
    files.append(File.generated(config, "validation.png", abs_src_path=str(picture)))
    return files


def on_page_markdown(markdown: str, page: Any, config: Any, files: Any) -> str:  # noqa: ARG001
    """Of mkdocs: put the table of the validation where its page says."""
    marked = "<!-- validation -->"
    return markdown.replace(marked, validation_table()) if marked in markdown else markdown
