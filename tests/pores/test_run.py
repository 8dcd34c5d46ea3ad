"""Runs of the model of pores: tables, files, resumption, ranks, and every command that reads them."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path
from typing import Any

import basix
import numpy as np
import pytest
import pyvista as pv
from scipy.spatial import cKDTree

import fsi
from fsi.case.load import load_case
from fsi.errors import InputError
from fsi.meshes.cells.lagrange import tabulate
from fsi.meshes.geometry.lattice import Lattice
from fsi.models import make_evolution
from fsi.pores.instant import FEW, PoreInstant
from fsi.pores.model import PoreModel
from fsi.postprocess.render import canvas
from fsi.postprocess.render.render import render_run
from fsi.postprocess.render.view import Choice
from fsi.postprocess.report import write_report
from fsi.postprocess.run.grids import nodes
from fsi.postprocess.run.probe import probe
from fsi.postprocess.run.run import Run, open_run
from fsi.postprocess.vtk_hdf import write_vtkhdf
from fsi.runs import resume, run
from tests.commands import fsi_command
from tests.pore_cases import BOX, PULLED, case_of
from tests.ranks import needs_mpi, python_on
from tests.small_run import break_off, contents

CASES = Path(__file__).parents[2] / "cases"


@pytest.fixture(scope="module")
def sheared(tmp_path_factory: pytest.TempPathFactory) -> Run:
    """In a cell, with error bars."""
    folder = tmp_path_factory.mktemp("pores") / "run"
    run(case_of(output={"interval": 0.1, "error_estimates": True}), folder)
    return open_run(folder)


def test_xdmf_tells_of_each_small_triangle_which_pore_it_is_in(sheared: Run, tmp_path: Path) -> None:
    assert fsi_command("export", sheared.path, "--format", "xdmf", "-o", tmp_path / "pores.xdmf") == 0
    read, written = pv.read(tmp_path / "pores.xdmf"), sheared.mesh(0)
    small = read.n_cells // written.n_cells
    assert small == 36  # of those of order 6
    np.testing.assert_array_equal(read.cell_data["pore"], np.repeat(written.cell_data["pore"], small))
    np.testing.assert_array_equal(read["psi"], written["psi"])


@pytest.mark.parametrize(
    "sections", [{}, {"pores": {"modes": 0, "tolerance": 0.01}}], ids=["one", "tolerance"]
)
def test_a_resumed_run_is_the_unbroken_one_bit_by_bit(
    sections: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The other one without pressures in its files, which take longer than all else."""
    monkeypatch.setattr("fsi.pores.instant.FEW", 0 if sections else FEW)
    case = case_of(**sections)
    outcome = run(case, tmp_path / "whole")
    break_off(tmp_path / "broken", case, outcome.state.step // 2, make_evolution)
    assert resume(tmp_path / "broken").steps > 0
    assert contents(tmp_path / "broken") == contents(tmp_path / "whole")
    if sections:
        assert open_run(tmp_path / "whole").steps["modes"].iloc[0] > 0


def test_the_tables_have_the_columns_of_the_resolved_model(sheared: Run) -> None:
    steps, bodies = set(sheared.steps), set(sheared.bodies)
    assert {"dofs", "dissipation", "apparent_viscosity", "stress_xy", "N_1", "power", "residual"} <= steps
    assert {"err_U", "err_apparent_viscosity", "err_stress_xy", "err_N_1", "err_smallest_gap"} <= steps
    assert {"x", "V_x", "F_x", "T", "err_V_x", "err_x"} <= bodies
    assert not {"stress_xx", "stress_yy"} & steps  # a pressure would add to them


def test_the_field_files_hold_the_flow_of_the_solution(sheared: Run) -> None:
    """Interpolated in curved cells of order 6, to 2e-4 of the speed; in cells of order 4 it would be 2e-3."""
    solution = fsi.solve(sheared.case)
    fluid = sheared.mesh(0)
    middle = np.asarray(fluid.points)[nodes(fluid)[::7, 3:]].mean(axis=1)[:, :2]
    u = solution.velocity(middle)
    table = probe(sheared, middle, 0)
    known = (table["where"] == "fluid").to_numpy() & np.isfinite(u[:, 0])
    assert known.mean() > 0.9
    found = table.loc[known, ["u_x", "u_y"]].to_numpy()
    assert np.abs(found - u[known]).max() < 2e-4 * np.abs(u[known]).max()


def test_the_flow_is_found_at_images(sheared: Run) -> None:
    """To 2e-3 of the speed, with the mean flow that the API has there too, up to 9 times that of one cell."""
    x = np.random.default_rng(0).uniform((-9.0, -9.0), (14.0, 13.0), (300, 2))
    table, u = probe(sheared, x, 0), fsi.solve(sheared.case).velocity(x)
    assert set(table["where"]) == {"fluid", "one", "other"}
    known = (table["where"] == "fluid").to_numpy()
    assert known.mean() > 0.7
    assert np.array_equal(known, np.isfinite(u[:, 0]))  # also in a large circle of fluid beside small ones
    found = table.loc[known, ["u_x", "u_y"]].to_numpy()
    assert np.abs(found - u[known]).max() < 2e-3 * np.abs(u[known]).max()


def test_cells_run_counterclockwise_and_their_areas_add_up(sheared: Run) -> None:
    """To that of the cell less the discs, 1e-6 of it. Half of a strip's cells were clockwise."""
    fluid = sheared.mesh(0)
    X, weights = basix.make_quadrature(basix.CellType.triangle, 10)
    J = np.einsum("cnd,qnk->cqdk", np.asarray(fluid.points)[nodes(fluid), :2], tabulate(6, X)[1])
    area = np.linalg.det(J) @ weights
    assert area.min() > 0.0
    exact = sheared.case.container().volume - np.pi * np.sum(sheared.configuration(0).radii ** 2)
    assert area.sum() == pytest.approx(exact, rel=1e-6)


def test_cells_of_circles_of_fluid_meet_those_around_them_at_nodes(sheared: Run) -> None:
    """Or at images of these; where cells had straight sides nodes would be up to 0.06 from others."""
    fluid, lattice = sheared.mesh(0), Lattice(sheared.case.container().periods)
    x, cells, inside = np.asarray(fluid.points)[:, :2], nodes(fluid), fluid.cell_data["pore"] < 0
    edge = x[cells[inside][:, [1, *range(8, 13), 2]]].reshape(-1, 2)  # opposite of the centre
    shift = lattice.shift(np.stack(np.meshgrid([-1, 0, 1], [-1, 0, 1]), axis=-1).reshape(-1, 2))
    around = cKDTree((x[np.unique(cells[~inside])][:, None] + shift).reshape(-1, 2))
    assert around.query(edge)[0].max() <= 1e-9


def test_psi_is_that_of_the_velocity(sheared: Run) -> None:
    """u = (psi_y, -psi_x): its differences along the sides of cells are the fluxes across them."""
    fluid = sheared.mesh(0)
    x, cells = np.asarray(fluid.points)[:, :2], nodes(fluid)
    side = cells[:, [0, 3, 4, 5, 6, 7, 1]]  # an edge with seven nodes: Weddle's weights of Newton and Cotes
    weights = np.array([41.0, 216.0, 27.0, 272.0, 27.0, 216.0, 41.0]) / 840.0
    along = np.polynomial.polynomial.polyvander(np.linspace(0.0, 1.0, 7), 6)
    slope = np.linalg.solve(along, x[side].transpose(1, 0, 2).reshape(7, -1))
    d = (np.arange(1, 7)[:, None] * slope[1:]).T @ along[:, :6].T
    dx, dy = d.reshape(len(side), 2, 7).transpose(1, 0, 2)
    u = fluid["velocity"][side]
    flux = (u[..., 0] * dy - u[..., 1] * dx) @ weights
    rise = fluid["psi"][side[:, -1]] - fluid["psi"][side[:, 0]]
    assert np.abs(rise - flux).max() < 1e-4 * np.ptp(fluid["psi"])


def test_necks_are_lines_between_bodies_with_what_is_dissipated_in_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("fsi.pores.instant.FEW", 0)  # pressures in files take longer than all else
    run(case_of(domain=BOX, bodies=PULLED, time={"end": 0.01}), tmp_path / "run")
    box = open_run(tmp_path / "run")
    lines = box.mesh(0, "necks")
    ends = np.asarray(lines.points)[nodes(lines)][..., :2]
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    radii = np.append(box.configuration(0).radii, np.zeros(4))
    i, j = (lines.cell_data[name].astype(int) for name in ("first", "second"))
    gaps = lines.cell_data["gap"]
    assert length - radii[i] - radii[j] == pytest.approx(gaps, abs=1e-12)
    assert np.all(lines.cell_data["dissipation"] > 0.0)
    assert lines.cell_data["dissipation"].sum() < box.steps["dissipation"].iloc[0]
    assert {"flux", "gap", "dissipation"} <= set(lines.cell_data)
    assert any(j >= 2)  # to walls


def test_fluxes_through_the_necks_of_an_array_add_up_to_the_mean_flow() -> None:
    """One disc in a sheared square cell of side L: psi of the mean flow u = (y, 0) is y^2 / 2.

    Between the centres of the disc and of its image above flows L^2 / 2. In the disc the velocity is
    -omega y, in its image L - omega (y - L), so that both carry L a together, and the neck the rest.
    """
    bodies, L = [{"name": "one", "radius": 1.0, "position": [0.0, 0.0]}], 2.6
    domain = {"shape": "cell", "vectors": [[L, 0.0], [0.0, L]], "shear": 1.0}
    instant = fsi.solve(case_of(domain=domain, bodies=bodies, time=None)).instant
    assert isinstance(instant, PoreInstant)
    necks = instant.necks
    upright, level = ((necks.image == image).all(axis=1) for image in ([0, 1], [1, 0]))
    assert (upright.sum(), level.sum()) == (1, 1)
    assert necks.flux[upright] == pytest.approx([0.5 * L**2 - L], abs=1e-6)
    assert necks.flux[level] == pytest.approx([0.0], abs=1e-6)


def test_no_flux_is_minus_zero() -> None:
    """Two discs at rest: tables had -0 for a neck that is seen from its other side."""
    case = case_of(domain=BOX, bodies=[body | {"force": [0.0, 0.0]} for body in PULLED], time=None)
    flux = PoreModel(case)(case.configuration(), 0.0).necks.flux
    np.testing.assert_array_equal(flux, np.zeros(3))
    assert not np.signbit(flux).any()


def test_the_flux_through_a_neck_is_that_of_the_velocity_across_it() -> None:
    """Of ten discs, whichever way each neck runs: `int u . n ds` from foot to foot, n to the right."""
    case = load_case(CASES / "pores" / "couette_N10.toml", ["pores.modes=2"])
    solved = fsi.solve(case)
    assert isinstance(solved.instant, PoreInstant)
    necks, q, L = solved.instant.necks, case.configuration(), float(case.container().periods[0, 0])
    s, weights = np.polynomial.legendre.leggauss(12)
    for k in np.flatnonzero((necks.sides < len(q)).all(axis=1)):
        i, j = necks.sides[k]
        way = q.centres[j] + np.array([L * necks.image[k, 0], 0.0]) - q.centres[i]
        way /= np.hypot(*way)
        across = q.radii[i] + 0.5 * necks.gap[k] * (1.0 + s)
        x = q.centres[i] + across[:, None] * way
        x[:, 0] %= L
        u = solved.velocity(x)
        flux = 0.5 * necks.gap[k] * weights @ (u[:, 0] * way[1] - u[:, 1] * way[0])
        assert necks.flux[k] == pytest.approx(flux, abs=1e-6)


@needs_mpi
def test_two_ranks_write_what_one_writes(tmp_path: Path) -> None:
    """Root alone writes; every rank computes the same. All take machine code that was kept: what a process
    has just compiled may round in another way."""
    case = case_of(time={"end": 0.05, "tolerance": 1e-2}, output={})
    (tmp_path / "case.toml").write_text(case.as_toml())
    fsi.solve(case)  # compiles what is not kept yet
    command = ["-m", "fsi", "run", str(tmp_path / "case.toml"), "-o"]
    environment = os.environ | {"OMP_NUM_THREADS": "1"}
    for name, ranks in (("one", 1), ("two", 2)):
        full = [*python_on(ranks), *command, str(tmp_path / name)]
        done = subprocess.run(full, env=environment, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
    assert contents(tmp_path / "two") == contents(tmp_path / "one")


def test_what_needs_a_pressure_or_a_mesh_is_refused_by_name(
    sheared: Run, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    file, near = tmp_path / "case.toml", tmp_path / "near"
    file.write_text(case_of(time=None).as_toml())
    beside = [PULLED[0] | {"position": [1.0005, 1.5]}, PULLED[1]]  # a narrow neck
    run(case_of(domain=BOX, bodies=beside, time={"end": 0.01, "tolerance": 1e-2}), near)
    shown = "speed, vorticity, dissipation, necks, motion"  # in a box, without a pressure
    for arguments, words in (
        (("render", near, "--field", "pressure"), f"of at most {FEW} bodies; raise pores.modes, or give"),
        (("render", near, "--field", "psi"), f"--field psi: give one of {shown}\n"),
        (("render", near, "--field", "traction"), f'model = "pores" has no mesh; give one of {shown}\n'),
        (("render", sheared.path, "--field", "mesh"), "has no mesh; give one of speed, pressure, "),
        (("mesh", file, "-o", tmp_path / "a.msh"), "only the resolved level has a mesh"),
        (
            ("mesh", sheared.path, "-o", tmp_path / "a.msh"),
            "give a run of the case with --set model=resolved",
        ),
        (("resistance", file), "so it has no resistance matrix"),
    ):
        assert fsi_command(*arguments) == 2, arguments
        assert words in capfd.readouterr().err, arguments
    assert not (tmp_path / "a.msh").exists()


def test_chains_plots_and_reports_read_such_runs(
    sheared: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(canvas, "_DRAW", "raise SystemExit(1)")  # pictures by OpenGL take seconds
    assert fsi_command("analyse", "chains", sheared.path) == 0
    assert fsi_command("plot", sheared.path, "-o", tmp_path / "history.png") == 0
    write_report(sheared, tmp_path / "report.html")
    words = (tmp_path / "report.html").read_text()
    assert "pores model" in words
    assert "VIOLATED" not in words
    assert "viscosity by stress = viscosity by dissipation" in words


@pytest.mark.parametrize(
    "field",
    [*(pytest.param(name, marks=pytest.mark.slow) for name in ("speed", "dissipation")), "necks"],
)
@pytest.mark.usefixtures("drawing")
def test_pictures(field: str, sheared: Run, tmp_path: Path) -> None:
    picture = tmp_path / "picture.png"
    assert fsi_command("render", sheared.path, "--field", field, "--size", 150, "-o", picture) == 0
    assert picture.stat().st_size > 1000


def test_fluid_at_rest_in_a_box_has_no_pressure_above_its_level(tmp_path: Path) -> None:
    """No mean rate and no load: there are no stresses to choose from, which was a defect of the program."""
    disc = {"name": "a", "radius": 1.0, "position": [2.0, 2.0]}
    case = case_of(domain={"lower": [0.0, 0.0], "upper": [7.0, 4.0]}, bodies=[disc], time={"end": 0.01})
    run(case, tmp_path / "run")
    found = probe(open_run(tmp_path / "run"), [[1.0, 0.5], [5.0, 3.0]])
    assert found["p"].tolist() == [0.0, 0.0]


def test_a_run_whose_later_steps_have_no_pressure_is_exported_and_not_filmed(
    sheared: Run, tmp_path: Path
) -> None:
    """VTK's files have the same arrays at all steps: NaN. They failed, and films by a KeyError."""
    folder = shutil.copytree(sheared.path, tmp_path / "run")
    copied = open_run(folder)
    last = copied.step()
    (path,) = copied.files(last)
    mesh = pv.read(path)
    for data, name in ((mesh.point_data, "pressure"), (mesh.cell_data, "dp_dx"), (mesh.cell_data, "dp_dy")):
        del data[name]
    mesh.save(path)
    assert write_vtkhdf(copied, tmp_path / "run.vtkhdf") == len(copied.times_of("fluid"))
    with pytest.raises(InputError, match=f"--field pressure: is not in the files of step {last}; between"):
        render_run(copied, tmp_path / "run.gif", Choice(field="pressure", size=120))
    assert not (tmp_path / "run.gif").exists()
