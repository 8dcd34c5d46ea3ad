"""A run as one file: what VTK's reader gives back is what the run has."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import pyvista as pv
from vtkmodules.vtkIOHDF import vtkHDFReader

import fsi
from tests.commands import fsi_command


def test_all_steps_with_their_curved_cells_are_in_one_file(run: Path) -> None:
    assert fsi_command("export", run) == 0
    reader, of_run = vtkHDFReader(), fsi.open_run(run)
    reader.SetFileName(str(run / "fields.vtkhdf"))
    reader.UpdateInformation()
    assert reader.GetNumberOfSteps() == 2
    for k, step in enumerate((0, 2)):
        reader.SetStep(k)
        reader.Update()
        read, written = pv.wrap(reader.GetOutput()), of_run.mesh(step)
        assert set(read.celltypes) == {pv.CellType.LAGRANGE_TRIANGLE}
        np.testing.assert_array_equal(read.cell_connectivity, written.cell_connectivity)
        np.testing.assert_array_equal(read.points, written.points)
        for name in ("velocity", "pressure"):
            np.testing.assert_array_equal(read[name], written[name])
        assert reader.GetTimeValue() == of_run.times[step]
    assert list(run.glob(".partial*")) == []


def test_bodies_with_their_radii(run: Path) -> None:
    assert fsi_command("export", run, "--format", "csv", "-o", run / "discs.csv") == 0
    table = pd.read_csv(run / "discs.csv")
    assert list(table["radius"]) == [1.0, 1.0, 1.0]
    pd.testing.assert_frame_equal(table.drop(columns="radius"), fsi.open_run(run).bodies)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--format", "xdmf"), "'xdmf' is not one of 'vtkhdf', 'csv'"),
        (("-o", "fields.h5"), "fields.h5: give the path of a .vtkhdf file"),
        (("-o", "nowhere/fields.vtkhdf"), "no file can be written there"),
        (("--format", "csv", "-o", "fields.vtkhdf"), "fields.vtkhdf: give the path of a .csv file"),
    ],
)
def test_what_is_not_written(
    words: tuple[str, ...], message: str, run: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    assert fsi_command("export", run, *words) == 2
    assert message in capfd.readouterr().err
