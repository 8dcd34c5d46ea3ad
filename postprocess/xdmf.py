"""A series of fields as XDMF: a .xdmf file, and in a folder beside it a binary file for each array.

XDMF has no curved cells of these orders. Each is cut between its own nodes into small straight ones, order^2
triangles or order^3 tetrahedra: points, and the values at them, stay those of the run to the last bit.
Steps are read one by one as they are written. (VTK has a writer too, which rounds times to six digits.)
"""

import shutil
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pyvista as pv
from meshio.xdmf import TimeSeriesWriter

from fsi.arrays import Array
from fsi.errors import InputError
from fsi.files import require_suffix, unfinished
from fsi.meshes.cells.lagrange import order_of, small_simplices
from fsi.postprocess.run.grids import Indices, nodes
from fsi.postprocess.run.run import Run

SUFFIX, HEAVY = ".xdmf", ".data"
# By kind of cell in VTK: meshio's name of what is written, and the dimension of what is cut.
_KINDS = {
    pv.CellType.LAGRANGE_TRIANGLE: ("triangle", 2),
    pv.CellType.LAGRANGE_TETRAHEDRON: ("tetra", 3),
    pv.CellType.LINE: ("line", 0),
    pv.CellType.VERTEX: ("vertex", 0),
}


class _Collection(TimeSeriesWriter):  # type: ignore[misc]  # meshio has no types
    """meshio's series, of meshes that change: its own has one mesh, and leaves files where the process runs.

    Args:
        light: the .xdmf file to write.
        heavy: the folder for the files of numbers.
        name: what that folder is called in the end.
    """

    def __init__(self, light: Path, heavy: Path, name: str) -> None:
        super().__init__(light, data_format="Binary")
        self._heavy, self._name = heavy, name

    def add(self, t: float, grid: pv.UnstructuredGrid) -> None:
        """One instant: its mesh, in straight cells, and all its data."""
        kind, cells, pieces = _straight(grid)
        instant = ElementTree.SubElement(self.collection, "Grid", Name="fields", GridType="Uniform")
        ElementTree.SubElement(instant, "Time", Value=repr(t))
        self.points(instant, np.asarray(grid.points))
        self.cells([(kind, cells)], instant)
        for topology in instant.iter("Topology"):  # of points and lines VTK asks for it
            topology.set("NodesPerElement", str(cells.shape[1]))
        self.point_data(dict(grid.point_data), instant)
        self.cell_data({name: [np.repeat(of, pieces)] for name, of in grid.cell_data.items()}, instant)

    def numpy_to_xml_string(self, data: Array) -> str:
        """Write an array; gives the path of its file, from that of the .xdmf file on."""
        file = f"{self.data_counter:06d}.bin"
        self.data_counter += 1
        data.tofile(self._heavy / file)
        return f"{self._name}/{file}"


def _straight(grid: pv.UnstructuredGrid) -> tuple[str, Indices, int]:
    """meshio's name of its cells once they are straight, their nodes, and how many each cell gives."""
    cells = nodes(grid)
    kind, dimension = _KINDS[grid.celltypes[0]]
    if not dimension:
        return kind, cells, 1
    small = small_simplices(order_of(cells.shape[1], dimension), dimension)
    return kind, cells[:, small].reshape(-1, dimension + 1), len(small)


def write_xdmf(run: Run, output: Path) -> int:
    """Write the series of a run's pictures as NAME.xdmf with its folder NAME.data; gives the steps.

    Raises InputError: the run has no such series, or the files cannot be written.
    """
    require_suffix(output, SUFFIX)
    if not output.stem.isascii():  # VTK does not find such a folder by what XML has of its name
        raise InputError(f"output = {output}: ParaView reads .xdmf files with ASCII names only; give one")
    run.step(None, run.series)
    times = run.times_of(run.series)
    data = output.with_suffix(HEAVY)
    if data.exists() and not (data.is_dir() and all(file.suffix == ".bin" for file in data.iterdir())):
        raise InputError(f"output = {output}: {data} is there with other files in it; give another path")
    light, heavy = map(unfinished, (output, data))
    try:
        shutil.rmtree(heavy, ignore_errors=True)
        heavy.mkdir()
        with _Collection(light, heavy, data.name) as collection:
            for step, t in times.items():
                collection.add(float(t), run.mesh(int(str(step)), run.series))
        output.unlink(missing_ok=True)  # a .xdmf file that is there has its own numbers beside it
        if data.exists():
            shutil.rmtree(data)
        heavy.replace(data)
        light.replace(output)
    except OSError as error:
        raise InputError(f"output = {output}: {error.strerror or error}; choose another path") from None
    finally:
        light.unlink(missing_ok=True)
        shutil.rmtree(heavy, ignore_errors=True)
    return len(times)
