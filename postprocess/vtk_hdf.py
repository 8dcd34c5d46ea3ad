"""A series of fields as one file of VTK's own format for meshes that change in time, .vtkhdf.

Its readers, vtkHDFReader in pyvista and ParaView, give back the curved cells of every step with the values at
their nodes. Steps are read one by one as they are written.
"""

from pathlib import Path
from typing import Any

import numpy as np
from vtkmodules.util.vtkAlgorithm import VTKPythonAlgorithmBase
from vtkmodules.vtkCommonDataModel import vtkDataObject
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as Pipeline

from fsi.errors import InputError
from fsi.files import require_suffix
from fsi.postprocess.run.run import Run

SUFFIX = ".vtkhdf"


class _Steps(VTKPythonAlgorithmBase):
    """What VTK's writer asks for the meshes of a series, time by time."""

    def __init__(self, run: Run, series: str) -> None:
        VTKPythonAlgorithmBase.__init__(  # type: ignore[no-untyped-call]  # it says none
            self, nInputPorts=0, nOutputPorts=1, outputType="vtkUnstructuredGrid"
        )
        self._run, self._series = run, series
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
        nearest = int(np.argmin(np.abs(np.array(self._times) - t)))
        about.Get(vtkDataObject.DATA_OBJECT()).ShallowCopy(
            self._run.mesh(self._numbers[nearest], self._series)
        )
        return 1


def write_vtkhdf(run: Run, output: Path, series: str | None = None) -> int:
    """Write a series of a run, by default the one of its pictures, into a .vtkhdf file; gives the steps.

    Raises InputError: the run has no such series, or the file cannot be written.
    """
    from vtkmodules.vtkIOHDF import vtkHDFWriter

    require_suffix(output, SUFFIX)
    series = series or run.series
    run.step(None, series)
    temporary = output.with_name(f".partial-{output.name}")
    steps, writer = _Steps(run, series), vtkHDFWriter()
    writer.SetFileName(str(temporary))
    writer.SetWriteAllTimeSteps(True)
    writer.SetInputConnection(steps.GetOutputPort())
    try:
        temporary.touch()  # where that fails, VTK would say so in its own words
        if not writer.Write():
            raise InputError(f"output = {output}: could not be written, perhaps for want of room")
        temporary.replace(output)
    except OSError as error:
        raise InputError(f"output = {output}: {error.strerror or error}; choose another path") from None
    finally:
        temporary.unlink(missing_ok=True)
    return len(run.times_of(series))
