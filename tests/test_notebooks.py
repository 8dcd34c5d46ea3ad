"""The notebooks of docs/notebooks: their cells run in their order and print what the notebooks show."""

from __future__ import annotations

import json
from base64 import b64decode
from contextlib import chdir, redirect_stdout
from io import BytesIO, StringIO
from pathlib import Path
from typing import Any

import matplotlib as mpl
import pytest
from matplotlib import pyplot as plt
from matplotlib.image import imread

from tests.test_gallery import EXAMPLES

FOLDER = Path(__file__).parents[1] / "docs" / "notebooks"
NOTEBOOKS = {path.stem: path for path in sorted(FOLDER.glob("*.ipynb"))}
QUICK = ("film_pressure", "dilute_viscosity")


def cells(name: str) -> list[dict[str, Any]]:
    """The cells with code, in their order."""
    book = json.loads(NOTEBOOKS[name].read_text(encoding="utf-8"))
    assert (book["nbformat"], book["metadata"]["kernelspec"]["name"]) == (4, "python3")
    return [cell for cell in book["cells"] if cell["cell_type"] == "code"]


def shown(cell: dict[str, Any], kind: str) -> list[dict[str, Any]]:
    """The outputs of a cell of one kind."""
    return [output for output in cell["outputs"] if output["output_type"] == kind]


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=() if name in QUICK else pytest.mark.slow) for name in NOTEBOOKS]
)
def test_a_notebook_prints_what_it_shows(name: str, tmp_path: Path) -> None:
    known: dict[str, Any] = {"__name__": "__main__"}
    with mpl.rc_context({"backend": "agg"}), chdir(tmp_path):
        for cell in cells(name):
            with redirect_stdout(StringIO()) as printed:
                exec(compile("".join(cell["source"]), name, "exec"), known)
            assert printed.getvalue() == "".join("".join(out["text"]) for out in shown(cell, "stream"))
        figures = len(plt.get_fignums())
        plt.close("all")
    assert figures == sum(len(shown(cell, "display_data")) for cell in cells(name)) > 0


@pytest.mark.parametrize("name", NOTEBOOKS)
def test_a_notebook_was_executed_from_its_first_cell_to_its_last(name: str) -> None:
    found = cells(name)
    assert [cell["execution_count"] for cell in found] == list(range(1, len(found) + 1))
    assert [shown(cell, "error") for cell in found] == [[]] * len(found)
    for cell in found:
        for output in shown(cell, "display_data"):
            picture = imread(BytesIO(b64decode(output["data"]["image/png"])))
            assert picture.shape[1] > 500
            assert picture[..., :3].std() > 0.05  # no empty page
    assert any("assert " in "".join(cell["source"]) for cell in found)


def test_there_are_three_and_each_has_its_script_in_the_gallery() -> None:
    assert len(NOTEBOOKS) >= 3
    assert {*NOTEBOOKS} <= {*EXAMPLES}
