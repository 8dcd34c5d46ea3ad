"""What the site has beside the pages of this folder: examples, notebooks, and the table of `fsi validate`.

`mkdocs.yml` names this module as a hook. The pages are made from the examples' docstrings and code, from the
notebooks with what they have shown, and from the files that `fsi validate` writes, each time that the site is
built.
"""

from __future__ import annotations

import ast
import json
import re
from base64 import b64decode
from pathlib import Path
from typing import Any

DOCS = Path(__file__).parent
EXAMPLES, PICTURES, VALIDATION = DOCS / "examples", DOCS / "gallery", DOCS / "validation"
NOTEBOOKS = DOCS / "notebooks"


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
    text += (
        "\n## Notebooks\n\nSome of them as notebooks for Jupyter, with what they print and draw; the tests "
        "run their cells.\n\n"
    )
    for path in notebooks():
        name = path.stem
        text += f"- [{title(EXAMPLES / f'{name}.py')}](../notebooks/{name}.md)\n"
    return text


def notebooks() -> list[Path]:
    """The notebooks, by name, each that of the example of its name."""
    return sorted(NOTEBOOKS.glob("*.ipynb"))


def notebook_files(notebook: Path) -> dict[str, str | bytes]:
    """Its page in Markdown, and its pictures, by their paths in the site."""
    name, pictures = notebook.stem, dict[str, str | bytes]()
    parts = [f"[The notebook]({name}.ipynb) for Jupyter, as it was executed:\n"]
    for cell in json.loads(notebook.read_text(encoding="utf-8"))["cells"]:
        source = "".join(cell["source"])
        parts.append(source if cell["cell_type"] == "markdown" else f"```python\n{source}\n```")
        for output in cell.get("outputs", []):
            if output["output_type"] == "stream":
                parts.append(f"```text\n{''.join(output['text']).rstrip()}\n```")
            else:
                picture = f"{name}_{len(pictures) + 1}.png"
                pictures[f"notebooks/{picture}"] = b64decode(output["data"]["image/png"])
                parts.append(f"![What the cell above draws]({picture})")
    heading, body = parts[1].partition("\n")[0], parts[1].partition("\n")[2]
    text = "\n\n".join([heading, parts[0], body, *parts[2:]])
    return {f"notebooks/{name}.md": text, **pictures}


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
    """Of mkdocs: add the pages that are made."""
    from mkdocs.structure.files import File

    made: dict[str, str | bytes] = {"gallery/index.md": gallery_page()}
    made |= {f"gallery/{each.stem}.md": example_page(each) for each in examples()}
    for notebook in notebooks():
        made |= notebook_files(notebook)
    for path, content in made.items():
        files.append(File.generated(config, path, content=content))
    return files


def on_page_markdown(markdown: str, page: Any, config: Any, files: Any) -> str:  # noqa: ARG001
    """Of mkdocs: put the table of the validation where its page says, and lead to pages of examples."""
    marked = "<!-- validation -->"
    whole = markdown.replace(marked, validation_table()) if marked in markdown else markdown
    return with_pages_of_examples(whole)


def with_pages_of_examples(markdown: str) -> str:
    """Links to the folder of examples and to scripts there, which a checkout has, as those to the gallery."""
    scripts = re.sub(r"\]\(examples/(\w+)\.py\)", r"](gallery/\1.md)", markdown)
    return scripts.replace("](examples)", "](gallery/index.md)")
