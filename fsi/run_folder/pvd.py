"""ParaView collections (.pvd): which file shows which time. One file per rank and time, any mesh each."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree
from xml.sax.saxutils import quoteattr


@dataclass(frozen=True, slots=True)
class Entry:
    """One file of a collection; `file` is relative to the collection, with slashes."""

    t: float
    part: int
    file: str


def collection(entries: Iterable[Entry]) -> bytes:
    """The collection as XML."""
    lines = [
        f'    <DataSet timestep="{entry.t!r}" part="{entry.part}" file={quoteattr(entry.file)}/>'
        for entry in entries
    ]
    head = ['<?xml version="1.0"?>', '<VTKFile type="Collection" version="1.0">', "  <Collection>"]
    return "\n".join([*head, *lines, "  </Collection>", "</VTKFile>", ""]).encode()


def read_collection(path: Path) -> list[Entry]:
    """The entries of a collection, in order."""
    data_sets = ElementTree.parse(path).iter("DataSet")
    return [Entry(float(d.attrib["timestep"]), int(d.attrib["part"]), d.attrib["file"]) for d in data_sets]
