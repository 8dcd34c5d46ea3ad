"""Files of ParaView: which file shows which time (.pvd), points and lines with numbers (.vtu)."""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING
from xml.etree import ElementTree
from xml.sax.saxutils import quoteattr

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.files import appearing, content

if TYPE_CHECKING:
    import meshio

_HEAD = b'<?xml version="1.0"?>\n<VTKFile type="Collection" version="1.0">\n  <Collection>\n'
_TAIL = b"  </Collection>\n</VTKFile>\n"

type Cells = list[tuple[str, NDArray[np.intp]]]


@dataclass(frozen=True, slots=True)
class Entry:
    """One file of a collection; `file` is relative to the collection, with slashes."""

    t: float
    part: int
    file: str

    @property
    def step(self) -> int:
        """The number of the step in the name of its file."""
        number = re.search(r"_(\d+)", Path(self.file).stem)
        return int(number[1]) if number else 0


class Collection:
    """Which file shows which time: entries, and their XML, which grows at its end as they come."""

    def __init__(self, entries: Iterable[Entry] = ()) -> None:
        self.entries: list[Entry] = []
        self._lines = bytearray()
        self.add(entries)

    def add(self, entries: Iterable[Entry]) -> None:
        """Put entries behind the others."""
        for e in entries:
            self.entries.append(e)
            line = f'    <DataSet timestep="{e.t!r}" part="{e.part}" file={quoteattr(e.file)}/>\n'
            self._lines += line.encode()

    def xml(self) -> bytes:
        """The whole file."""
        return _HEAD + self._lines + _TAIL


def read_collection(path: Path) -> list[Entry]:
    """The entries of a collection, in order. Raises ValueError of what is none."""
    try:
        data_sets = ElementTree.fromstring(content(path, "give a run folder")).iter("DataSet")
        return [
            Entry(float(d.attrib["timestep"]), int(d.attrib["part"]), d.attrib["file"]) for d in data_sets
        ]
    except (ElementTree.ParseError, KeyError, LookupError) as error:
        raise ValueError(f"{path.name}: {error}") from None


def write_points(path: Path, x: Array, values: Mapping[str, Array]) -> None:
    """Points (n, d) with numbers (n,) or vectors (n, 3) at each."""
    cells = [("vertex", np.arange(len(x))[:, None])]
    _write(path, x, cells, point_data=dict(values))


def write_lines(path: Path, start: Array, end: Array, values: Mapping[str, Array]) -> None:
    """Straight lines between points (n, d), with numbers (n,) on each."""
    n = len(start)
    cells = [("line", np.column_stack([np.arange(n), n + np.arange(n)]))]
    on_lines: dict[str, object] = {name: [value] for name, value in values.items()}
    _write(path, np.concatenate([start, end]), cells, cell_data=on_lines)


def write_polyline(path: Path, x: Array, values: Mapping[str, Array]) -> None:
    """A line through the points (n, d) in their order, with numbers (n,) at each."""
    k = np.arange(len(x) - 1)
    _write(path, x, [("line", np.column_stack([k, k + 1]))], point_data=dict(values))


def in_space(vectors: Array) -> Array:
    """Vectors (n, d) with a third component, zero in the plane, (n, 3)."""
    return np.pad(vectors, ((0, 0), (0, 3 - vectors.shape[1])))


def _write(path: Path, x: Array, cells: Cells, **data: dict[str, object]) -> None:
    import meshio  # takes a tenth of a second to load

    write_vtu(path, meshio.Mesh(in_space(x), cells, **data))


def write_vtu(path: Path, mesh: "meshio.Mesh") -> None:
    """Write all of a file or nothing. Raises OSError: the disk refuses."""
    with appearing(path) as partial:
        mesh.write(partial, file_format="vtu")
