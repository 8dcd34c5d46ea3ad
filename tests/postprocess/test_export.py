"""A run as one file: what VTK's reader gives back is what the run has."""

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import pyvista as pv
from meshio.xdmf import TimeSeriesReader
from vtkmodules.vtkIOHDF import vtkHDFReader

import fsi
from fsi.postprocess.run.run import Run
from tests.commands import fsi_command
from tests.postprocess.spatial_run import write_spatial_run


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


def require_xdmf(path: Path, run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    """VTK and meshio read the instants, points and values of a run to the last bit, VTK from anywhere."""
    steps, times = list(run.times.index), list(run.times)
    reader = pv.get_reader(path)
    with monkeypatch.context() as patch:
        assert reader.time_values == times
        patch.chdir(path.parent)  # meshio looks for files of numbers where the process runs
        again = TimeSeriesReader(path)
        assert again.num_steps == len(steps)
        for k, step in enumerate(steps):
            reader.set_active_time_value(times[k])
            read, written, again.mesh_grid = reader.read(), run.mesh(step), again.collection[k]
            points, (block,) = again.read_points_cells()
            t, values, _ = again.read_data(k)
            assert t == times[k]
            np.testing.assert_array_equal(block.data, read.cell_connectivity.reshape(block.data.shape))
            for x in (points, read.points):
                np.testing.assert_array_equal(x, written.points)
            assert set(values) == set(read.point_data) == set(written.point_data) >= {"velocity", "pressure"}
            for name in values:
                np.testing.assert_array_equal(values[name], written[name])
                np.testing.assert_array_equal(read[name], written[name])


def test_other_programs_read_xdmf(run: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The small cells of cubic ones have the area of these, but for what arcs are more than chords."""
    for _ in range(2):  # the second takes the place of the first
        assert fsi_command("export", run, "--format", "xdmf") == 0
    of_run = fsi.open_run(run)
    require_xdmf(run / "fields.xdmf", of_run, monkeypatch)
    read = pv.read(run / "fields.xdmf")
    assert set(read.celltypes) == {pv.CellType.TRIANGLE}
    assert read.n_cells == 9 * of_run.mesh(0).n_cells
    assert read.area == pytest.approx(of_run.mesh(0).area, rel=2e-3)
    assert list(run.glob(".partial*")) == []
    assert len(list((run / "fields.data").iterdir())) == 8  # points, cells and two fields, twice


def test_xdmf_has_a_name_that_its_readers_find(run: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """VTK reads no numbers of `é.data`: 0 cells, and a warning."""
    assert fsi_command("export", run, "--format", "xdmf", "-o", run / "é.xdmf") == 2
    assert "ASCII names only" in capfd.readouterr().err
    assert list(run.glob("é*")) == []


def test_xdmf_in_space(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run = fsi.open_run(write_spatial_run(tmp_path))
    assert fsi_command("export", tmp_path, "--format", "xdmf", "-o", tmp_path / "in space.xdmf") == 0
    require_xdmf(tmp_path / "in space.xdmf", run, monkeypatch)
    read = pv.read(tmp_path / "in space.xdmf")
    assert set(read.celltypes) == {pv.CellType.TETRA}
    assert read.n_cells == 8 * run.mesh(0).n_cells
    assert read.volume == pytest.approx(4.0**3, rel=1e-3)  # of the box, in which cells overlap by 1e-4


def test_no_folder_of_others_is_replaced(run: Path, capfd: pytest.CaptureFixture[str]) -> None:
    (run / "fields.data").mkdir()
    (run / "fields.data" / "measured.txt").touch()
    assert fsi_command("export", run, "--format", "xdmf") == 2
    assert "fields.data is there with other files in it; give another path" in capfd.readouterr().err
    assert not (run / "fields.xdmf").exists()


def test_a_broken_export_leaves_the_one_before(run: Path) -> None:
    assert fsi_command("export", run, "--format", "xdmf") == 0
    before = (run / "fields.xdmf").read_bytes()
    (run / "fields" / "fluid_000002_1.vtu").write_text("no grid")
    assert fsi_command("export", run, "--format", "xdmf") == 2
    assert (run / "fields.xdmf").read_bytes() == before
    assert len(list((run / "fields.data").iterdir())) == 8
    assert list(run.glob(".partial*")) == []


@pytest.mark.parametrize("name", ["discs.xdmf", "discs.csv", "discs.vtkhdf"])
def test_a_suffix_chooses_the_format(name: str, run: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """The first two were refused: `give the path of a .vtkhdf file`."""
    assert fsi_command("export", run, "-o", run / name) == 0
    rows_or_steps = "3 rows" if name == "discs.csv" else "2 steps"
    assert capfd.readouterr().out == f"wrote {run / name}, {rows_or_steps}\n"


def test_bodies_with_their_radii(run: Path) -> None:
    assert fsi_command("export", run, "--format", "csv", "-o", run / "discs.csv") == 0
    table = pd.read_csv(run / "discs.csv")
    assert list(table["radius"]) == [1.0, 1.0, 1.0]
    assert list(table["shape"]) == ["disc", "disc", "disc"]
    pd.testing.assert_frame_equal(table.drop(columns=["shape", "radius"]), fsi.open_run(run).bodies)


def test_an_ellipse_is_told_from_a_disc_that_is_as_long(run: Path) -> None:
    """Its radius is its longer half-axis."""
    case = run / "case.toml"
    case.write_text(case.read_text().replace("radius = 1.0", 'shape = {kind = "ellipse", axes = [1.0, 0.5]}'))
    assert fsi_command("export", run, "--format", "csv", "-o", run / "ellipse.csv") == 0
    table = pd.read_csv(run / "ellipse.csv")
    assert set(zip(table["shape"], table["radius"], strict=True)) == {("ellipse", 1.0)}


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (("--format", "pvd"), "'pvd' is not one of 'vtkhdf', 'xdmf', 'csv'"),
        (("--format", "xdmf", "-o", "fields.h5"), "fields.h5: give the path of a .xdmf file"),
        (("--format", "xdmf", "-o", "nowhere/fields.xdmf"), "no file can be written there"),
        (("-o", "fields.h5"), "fields.h5: unknown suffix '.h5'; give .vtkhdf, .xdmf, .csv"),
        (("-o", "nowhere/fields.vtkhdf"), "no file can be written there"),
        (("--format", "csv", "-o", "fields.vtkhdf"), "fields.vtkhdf: give the path of a .csv file"),
    ],
)
def test_what_is_not_written(
    words: tuple[str, ...], message: str, run: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    assert fsi_command("export", run, *words) == 2
    assert message in capfd.readouterr().err


@pytest.mark.parametrize("damage", [Path.unlink, lambda file: file.write_text("no grid")])
@pytest.mark.parametrize("step", [0, 2])
def test_a_damaged_step_is_told_and_leaves_no_file(
    damage: Callable[[Path], object], step: int, run: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    """VTK's writer asks for ever where it is told that there is no mesh; `fsi resume` would not mend this."""
    file = run / "fields" / f"fluid_{step:06d}_1.vtu"
    damage(file)
    assert fsi_command("export", run) == 2
    (line,) = capfd.readouterr().err.splitlines()
    how = "is damaged" if file.exists() else "is not there, or no file"
    assert line == f"error: {file}: {how}; run the case again"
    assert not list(run.glob("*fields.vtkhdf"))


SHORT_OF_ROOM = """
import resource, sys
from fsi.cli.main import main
resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv.pop()), resource.RLIM_INFINITY))
sys.exit(main())
"""


@pytest.mark.parametrize("part", [0.2, 0.99])
def test_a_file_that_the_disk_does_not_take_whole_is_none(part: float, run: Path) -> None:
    """VTK's writer says that all went well, and HDF5 prints pages, the last as the process ends."""
    whole = run / "whole.vtkhdf"
    assert fsi_command("export", run, "-o", whole) == 0
    room = str(int(part * whole.stat().st_size))
    command = [sys.executable, "-c", SHORT_OF_ROOM, "export", str(run), room]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    (line,) = done.stderr.splitlines()
    assert line.endswith("fields.vtkhdf: could not be written, perhaps for want of room")
    assert not list(run.glob("*fields.vtkhdf"))


def test_a_full_disk_takes_no_file(run: Path) -> None:
    """The name of the file, but nothing in it: VTK's writer tried for ever."""
    command = [sys.executable, "-c", SHORT_OF_ROOM, "export", str(run), "0"]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=100)
    assert done.returncode == 2
    (line,) = done.stderr.splitlines()
    assert "fields.vtkhdf: File too large; " in line
    assert not list(run.glob("*fields.vtkhdf"))
