"""A series of fields as one file of VTK's own format for meshes that change in time, .vtkhdf.

Its readers, vtkHDFReader in pyvista and ParaView, give back the curved cells of every step with the values at
their nodes. Steps are read one by one as they are written, then the file is read back: VTK's writer passes
over what HDF5 could not write.
"""

import atexit
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from zlib import crc32

import numpy as np
import pyvista as pv
from vtkmodules.util.vtkAlgorithm import VTKPythonAlgorithmBase
from vtkmodules.vtkCommonDataModel import vtkDataObject
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as Pipeline

from fsi.errors import InputError
from fsi.files import require_suffix, unfinished
from fsi.pores.vtu import GRADIENT
from fsi.postprocess.run.run import Run

SUFFIX = ".vtkhdf"
_BEGINNING = 2**16  # bytes: more than VTK's writer has to put down before it looks whether it can


class _Steps(VTKPythonAlgorithmBase):
    """What VTK's writer asks for the meshes of a series, time by time.

    VTK passes over what is raised in it, and asks for ever where it is told of a failure: so the first error
    is kept for whoever wrote, and meshes are empty from there on.

    Attributes:
        error: that was raised.
        sums: of the meshes that were given, by their position in the series.
    """

    def __init__(self, run: Run, series: str) -> None:
        VTKPythonAlgorithmBase.__init__(  # type: ignore[no-untyped-call]  # it says none
            self, nInputPorts=0, nOutputPorts=1, outputType="vtkUnstructuredGrid"
        )
        self._run, self._series = run, series
        self.error: BaseException | None = None
        self.sums: dict[int, int] = {}
        times = run.times_of(series)
        self._times, self._numbers = [float(t) for t in times], [int(n) for n in times.index]

    def RequestInformation(self, request: Any, inputs: Any, outputs: Any) -> int:  # noqa: ARG002
        """The times."""
        about = outputs.GetInformationObject(0)
        about.Set(Pipeline.TIME_STEPS(), self._times, len(self._times))
        about.Set(Pipeline.TIME_RANGE(), [self._times[0], self._times[-1]], 2)
        return 1

    def RequestData(self, request: Any, inputs: Any, outputs: Any) -> int:  # noqa: ARG002
        """The mesh of the time that is asked for, the first if none is."""
        about, asked = outputs.GetInformationObject(0), Pipeline.UPDATE_TIME_STEP()
        t = about.Get(asked) if about.Has(asked) else self._times[0]
        about.Get(vtkDataObject.DATA_OBJECT()).ShallowCopy(
            self._mesh(int(np.argmin(np.abs(np.array(self._times) - t))))
        )
        return 1

    def _mesh(self, k: int) -> pv.UnstructuredGrid:
        if self.error is None:
            try:
                mesh = self._run.mesh(self._numbers[k], self._series)
                self._fill(mesh)
                self.sums[k] = _sum(mesh)
                return mesh
            except BaseException as error:  # also Ctrl-C
                self.error = error
        return pv.UnstructuredGrid()

    def _fill(self, mesh: pv.UnstructuredGrid) -> None:
        """Arrays that not all meshes have, as all of a series must: between pores a pressure, NaN there."""
        if self._series != "fluid" or self._run.case.level.pressure or "pressure" in mesh.point_data:
            return
        mesh.point_data["pressure"] = np.full(mesh.n_points, np.nan, mesh["strain_rate"].dtype)
        for name in GRADIENT:
            mesh.cell_data[name] = np.full(mesh.n_cells, np.nan)


def write_vtkhdf(run: Run, output: Path) -> int:
    """Write the series of the pictures of a run into a .vtkhdf file; gives the steps.

    Raises InputError: the run has no such series, a file of it is damaged, or the file cannot be written.
    """
    from vtkmodules.vtkIOHDF import vtkHDFWriter

    require_suffix(output, SUFFIX)
    run.step(None, run.series)
    temporary = unfinished(output)
    steps, writer = _Steps(run, run.series), vtkHDFWriter()
    writer.SetFileName(str(temporary))
    writer.SetWriteAllTimeSteps(True)
    writer.SetInputConnection(steps.GetOutputPort())
    try:
        _require_room(temporary)
        with _silent():
            written = writer.Write() and steps.error is None and _sums(temporary) == steps.sums
        if steps.error is not None:
            raise steps.error
        if not written:
            atexit.register(_hush)  # HDF5 tells once more, when the process ends, what it could not close
            raise InputError(f"output = {output}: could not be written, perhaps for want of room")
        temporary.replace(output)
    except OSError as error:
        raise InputError(f"output = {output}: {error.strerror or error}; choose another path") from None
    finally:
        temporary.unlink(missing_ok=True)
    return len(run.times_of(run.series))


def _require_room(path: Path) -> None:
    """Begin a file. Raises OSError: where it cannot, VTK would say so in its own words, or try for ever."""
    with path.open("wb") as file:
        file.write(bytes(_BEGINNING))
        file.flush()
        os.fsync(file.fileno())


def _sums(path: Path) -> dict[int, int]:
    """The sums of the meshes in a file by their position, none where VTK cannot read it."""
    from vtkmodules.vtkIOHDF import vtkHDFReader

    reader = vtkHDFReader()
    if not reader.CanReadFile(str(path)):
        return {}
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    sums = {}
    for k in range(reader.GetNumberOfSteps()):
        reader.SetStep(k)
        reader.Update()
        sums[k] = _sum(pv.wrap(reader.GetOutput()))
    return sums


def _sum(mesh: pv.UnstructuredGrid) -> int:
    """A number that differs where points, cells or values do."""
    values = [values for data in (mesh.point_data, mesh.cell_data) for _, values in sorted(data.items())]
    total = 0
    for array in (mesh.points, mesh.cell_connectivity, *values):
        total = crc32(np.ascontiguousarray(array).data, total)
    return total


@contextmanager
def _silent() -> Iterator[None]:
    """HDF5 prints on the standard error of the process, below Python's, what it could not write."""
    kept = os.dup(2)
    _hush()
    try:
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)


def _hush() -> None:
    with Path(os.devnull).open("wb") as nowhere:
        os.dup2(nowhere.fileno(), 2)
