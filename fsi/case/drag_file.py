"""Drag files: the drag with which the reduced model has the mean mobility of a resolved flow, as TOML.

drag = 7.92                # over mu V of a disc, over mu a V of a sphere
error = 2e-6               # estimated, of the resolved flow
shape = "discs"
fraction = 0.4             # of the domain that is bodies
cutoff = 1.0               # over the mean radius
[laws]                     # those of [reduced], which resist besides, of files the names
law = "law.toml"
wall_law = "exact"
[digests]                  # of the laws in files, which tell whether others are the same
law = "0b5c..."
[source]                   # free: case, mean mobility, versions ...
"""

from pathlib import Path
from typing import Any

from pydantic import Field

from fsi.case.section import NotNegative, Positive, Section
from fsi.case.section_file import read_section, save_section
from fsi.lubrication.expansions import Shape


class DragFile(Section):
    """What a drag file holds."""

    drag: Positive
    """the drag over mu V of a disc, over mu a V of a sphere, a number > 0"""
    error: NotNegative
    """its estimated error, a number >= 0"""
    shape: Shape
    '"spheres" or "discs"'
    fraction: Positive
    """the part of the domain that is bodies, a number > 0"""
    cutoff: Positive | None = None
    """the gap beyond which bodies did not feel each other, over their mean radius, or leave it out"""
    laws: dict[str, str]
    """a section [laws] with the laws of the gaps"""
    digests: dict[str, str]
    """a section [digests], which `fsi resistance CASE --drag FILE` writes: make the file anew by it"""
    source: dict[str, Any] = Field(default={})
    """a section [source]"""


def read_drag_file(path: Path) -> DragFile:
    """The content of a drag file. Raises InputError, one line with key, value and remedy."""
    return read_section(DragFile, path, "a drag file, `fsi resistance CASE --drag FILE` writes one")


def save_drag(path: Path, drag: DragFile) -> None:
    """Write a drag file, in one go."""
    save_section(path, drag)
