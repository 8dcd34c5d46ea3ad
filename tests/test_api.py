"""What `import fsi` offers in Python: the numbers of the commands, by nouns."""

from __future__ import annotations

import ast
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import fsi
import fsi.api as api
from fsi.meshes.errors import MeshError, MeshFileError
from tests.cli.test_commands import call
from tests.ranks import needs_mpi, python_on

ROOT = Path(__file__).parents[1]
BOX = ROOT / "cases" / "disc_in_box.toml"
DISC: dict[str, Any] = {"name": "disc", "radius": 1.0, "position": [0.0, 2.0], "force": [0.0, -1.0]}


def reduced(**more: Any) -> fsi.Case:
    """A disc above a plane in the reduced model, built without a file."""
    sections: dict[str, Any] = {
        "name": "disc",
        "model": "reduced",
        "fluid": {"viscosity": 1.0},
        "domain": {"shape": "half-plane", "radius": 100.0},
        "bodies": [DISC],
        "reduced": {"drag": 10.0},
        "time": {"end": 1.0},
    }
    return fsi.make_case(**(sections | more))


def test_all_names_stand_in_all_three_places() -> None:
    stub = ast.parse((ROOT / "fsi" / "__init__.pyi").read_text())
    typed = {alias.asname for node in stub.body if isinstance(node, ast.ImportFrom) for alias in node.names}
    public = vars(fsi)["__all__"]
    assert sorted(api.__all__) == sorted(public) == sorted(str(name) for name in typed)
    assert set(public) <= set(dir(fsi))
    with pytest.raises(AttributeError, match="no attribute 'sovle'"):
        _ = fsi.sovle  # type: ignore[attr-defined]


def test_importing_it_costs_no_solver_and_no_tables() -> None:
    code = (
        "import fsi, sys; assert not {'numpy', 'pandas', 'pyvista', 'dolfinx', 'pydantic'} & set(sys.modules)"
    )
    subprocess.run([sys.executable, "-c", code], check=True, cwd=ROOT)


def test_a_resolved_case_is_solved_evaluated_and_has_a_resistance(tmp_path: Path) -> None:
    """A disc in a box of fluid at rest, moving down: the force of cases/disc_in_box.toml is 466.11048."""
    solution = fsi.solve(fsi.load_case(ROOT / "cases" / "disc_in_box.toml"))
    disc = solution["disc"]
    assert disc.force[1] == pytest.approx(466.11048, rel=1e-5)
    assert [body.name for body in solution] == ["disc"]
    # power: the dissipation is the force that the motion needs times its velocity
    assert solution.dissipation == pytest.approx(disc.force[1], rel=1e-9)
    u, p = solution.evaluate([[0.0, 2.100001], [0.0, 1.0], [0.0, 1e-9]])
    np.testing.assert_allclose(u[0], [0.0, -1.0], atol=2e-5)  # at the surface that of the body
    assert np.isnan(u[1]).all()  # in it there is no fluid
    assert np.isnan(p[1])
    np.testing.assert_allclose(u[2], 0.0, atol=1e-6)
    assert [values.shape for values in solution.evaluate([])] == [(0, 2), (0,)]
    assert solution.velocity(np.empty((0, 2))).shape == (0, 2)
    assert solution.velocity([0.0, 1e-9]).shape == (1, 2)
    for points, words in (
        ([[0.0, 4.0, 0.0]], "points have 3 components where this geometry has 2; give"),
        ([4.0], "points have 1 components where this geometry has 2; give"),
        ([[0.0, 4.0], [1.0]], "points: are no numbers, or not as many of each point; give"),
        ([[np.nan, 1.0], [0.0, 4.0]], "points: not all are finite; give"),
    ):
        for values_at in (solution.evaluate, solution.velocity):
            with pytest.raises(fsi.InputError, match=words):
                values_at(points)
    (tmp_path / "there").touch()
    with pytest.raises(fsi.InputError, match=r"output = .*there: Not a directory; give a folder"):
        solution.write(tmp_path / "there")
    assert solution.write(tmp_path / "fields" / "new")["fluid"] == ["fluid_000000.vtu"]
    R = solution.resistance()
    assert R.R[1, 1] == pytest.approx(disc.force[1], rel=1e-9)
    assert "disc: V = [ 0. -1.]" in repr(solution)
    assert solution.errors is not None
    assert abs(disc.force[1] - 466.11048) < solution.errors.F[0, 1]


def test_a_reduced_case_is_solved_without_a_flow() -> None:
    """V = F / (zeta + kappa), drag 10 and the exact law of a disc at gap 1 beside a plane."""
    from fsi.lubrication.exact import normal_resistance

    solution = fsi.solve(reduced())
    kappa = float(normal_resistance(np.array([1.0]), np.ones(1), 1.0)[0])
    assert solution["disc"].velocity[1] == pytest.approx(-1.0 / (10.0 + kappa), rel=1e-12)
    assert solution.errors is None
    with pytest.raises(fsi.InputError, match="has no flow to evaluate"):
        solution.evaluate([[0.0, 0.5]])


def test_a_run_calls_back_and_goes_on(tmp_path: Path) -> None:
    times: list[float] = []

    def stop(record: fsi.StepRecord) -> None:
        times.append(record.t)
        if len(times) == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        fsi.run(reduced(), tmp_path / "run", stop)
    run = fsi.resume(tmp_path / "run", lambda record: times.append(record.t))
    assert run.finished
    np.testing.assert_array_equal(run.steps["t"], times)
    assert times[-1] == 1.0


def test_levels_without_an_instant_say_so() -> None:
    case = reduced(model="gluey", time={"end": 1.0, "step": 0.1})
    with pytest.raises(fsi.InputError, match='model = "gluey": has no velocities at an instant'):
        fsi.solve(case)


def test_a_mistake_in_python_is_one_line_too() -> None:
    with pytest.raises(fsi.InputError, match=r"reduced\.darg = 10\.0: unknown key; use reduced\.drag"):
        reduced(reduced={"darg": 10.0})


@pytest.mark.parametrize("case", ["case.toml", None, {"name": "disc"}])
def test_what_is_no_case_is_refused(case: Any, tmp_path: Path) -> None:
    words = rf"^case: is a {type(case).__name__}; give fsi\.load_case\(PATH\)"
    out = tmp_path / "out"
    for use in (fsi.solve, lambda it: fsi.run(it, out), lambda it: fsi.calibrate(it, out)):
        with pytest.raises(fsi.InputError, match=words):
            use(case)
    assert not out.exists()


def test_a_calibration_without_processes_writes_nothing(tmp_path: Path) -> None:
    case = fsi.load_case(ROOT / "cases" / "calibration" / "disc_wall.toml")
    with pytest.raises(fsi.InputError, match=r"^processes = 0: give at least 1$"):
        fsi.calibrate(case, tmp_path / "out", 0)
    assert not list(tmp_path.iterdir())


def test_cases_solutions_and_runs_say_what_they_are(tmp_path: Path) -> None:
    case = reduced()
    assert repr(case) == "<Case 'disc': reduced, planar, 1 bodies, half-plane>"
    assert repr(fsi.solve(case)).startswith("<Solution of 'disc': reduced, 1 bodies in 2 dimensions, dissip")
    assert repr(fsi.run(case, tmp_path / "run")).startswith("<Run 'disc': reduced, ")


def test_files_of_the_user_that_are_named_like_its_folders_do_no_harm(tmp_path: Path) -> None:
    """A script postprocess.py or meshes.py beside the user's own."""
    fsi.run(reduced(), tmp_path / "run")
    for name in ("postprocess", "meshes", "cases"):
        (tmp_path / f"{name}.py").write_text("raise SystemExit('not this one')")
    code = "import fsi; print(len(fsi.open_run('run').steps))"
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    assert int(done.stdout) > 1


def test_arrays_of_a_solution_are_copies() -> None:
    """V beside a plane is not zero; taken from itself in place it stays what it is."""
    solution = fsi.solve(reduced())
    V = solution["disc"].velocity[1]
    for name in ("position", "velocity", "angular_velocity", "force", "torque"):
        getattr(solution["disc"], name)[...] = 7.0
    assert solution["disc"].velocity[1] == V != 7.0
    assert solution["disc"].angular_velocity != 7.0
    assert solution["disc"].position.tolist() == [0.0, 2.0]
    assert solution["disc"].force[1] != 7.0


def test_solutions_are_equal_to_themselves_alone() -> None:
    """Of fields that are arrays nobody knows whether they are equal: that raised ValueError."""
    solution = fsi.solve(reduced())
    body = solution["disc"]
    assert solution == solution
    assert solution != fsi.solve(reduced())
    assert body == body
    assert body != solution["disc"]


def test_a_case_takes_arrays_and_numbers_of_numpy() -> None:
    body = DISC | {"radius": np.int64(1), "position": np.array([0, 2]), "force": (np.float32(0), -1.0)}
    assert reduced(bodies=[body]) == reduced()
    assert reduced(bodies=np.array([body], dtype=object)) == reduced()
    with pytest.raises(fsi.InputError, match=r"^bodies\.0\.position\.0 = \[0\.0, 2\.0\]: must be a"):
        reduced(bodies=[DISC | {"position": np.array([[0.0, 2.0]])}])


def test_a_case_takes_paths_for_files(tmp_path: Path) -> None:
    """It said that the mesh must be a text."""
    mesh = tmp_path / "own.msh"
    domain = {"lower": [-3.0, 0.0], "upper": [3.0, 6.0], "mesh": mesh}
    with pytest.raises(fsi.InputError, match=r"^domain\.mesh = .*: no such file"):
        reduced(domain=domain, model="resolved")
    mesh.touch()
    assert reduced(domain=domain, model="resolved").domain.mesh == str(mesh)


def test_a_mesh_that_fails_is_a_solve_that_fails() -> None:
    """As `fsi.errors` has it: `except fsi.FsiError` did not catch it."""
    assert issubclass(MeshError, fsi.SolveError)
    assert issubclass(MeshFileError, fsi.InputError)


def test_a_case_without_bodies_has_no_resistance() -> None:
    domain = {"lower": [0.0, 0.0], "upper": [3.0, 3.0], "walls": {"top": [1.0, 0.0]}}
    sizes = {"degree": 2, "growth": 1.0}
    case = fsi.make_case(name="box", fluid={"viscosity": 1.0}, domain=domain, bodies=[], discretisation=sizes)
    with pytest.raises(fsi.InputError, match=r"^bodies: there are none, and no resistance; give one$"):
        fsi.solve(case).resistance()


def test_a_level_without_a_flow_has_no_resistance() -> None:
    with pytest.raises(
        fsi.InputError, match=r'^model = "reduced": has no resistance; solve the resolved case$'
    ):
        fsi.solve(reduced()).resistance()


def test_programs_without_a_standard_error_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """As under pythonw: sys.stderr is None."""
    monkeypatch.setattr(sys, "stderr", None)
    assert len(fsi.run(reduced(), tmp_path / "run").steps) > 1


API: Any = fsi  # as those use it who check no types


@pytest.mark.parametrize(
    ("ask", "words"),
    [
        (lambda _: API.load_case(None), "path: is a NoneType"),
        (lambda _: API.load_case(3), "path: is a int"),
        (lambda _: API.load_case(b"x"), "path: is a bytes"),
        (lambda _: API.load_case(BOX, None), "overrides = None"),
        (lambda _: API.open_run(None), "run: is a NoneType"),
        (lambda _: API.resume(None), "folder: is a NoneType"),
        (lambda case: API.run(case, None), "folder: is a NoneType"),
        (lambda case: API.run(case, "out", 3), "callback: is a int"),
        (lambda case: API.solve(case).write(None), "folder: is a NoneType"),
        (lambda _: API.load_case("a\0b"), r"path = 'a\\x00b': has a zero byte"),
        (lambda _: API.resume("a\0b"), r"folder = 'a\\x00b': has a zero byte"),
        (lambda case: API.run(case, "a\0b"), r"folder = 'a\\x00b': has a zero byte"),
        (lambda case: API.solve(case).write("a\0b"), r"folder = 'a\\x00b': has a zero byte"),
        (lambda case: API.calibrate(case, "out", "2"), "processes: is a str"),
        (lambda case: API.calibrate(case, "out", 1.5), "processes: is a float"),
    ],
)
def test_what_is_no_argument_is_refused_in_one_line(
    ask: Callable[[fsi.Case], object], words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(fsi.InputError, match=rf"^{words}[;:] give .+$"):
        ask(reduced())
    assert not list(tmp_path.iterdir())


@needs_mpi
@pytest.mark.mpi
def test_it_works_on_several_ranks(tmp_path: Path) -> None:
    """The force on a disc, a point of the flow and a run are those of one process."""
    script = tmp_path / "script.py"
    script.write_text(
        f"import fsi, fsi.parallel as parallel\n"
        f"case = fsi.load_case({str(ROOT / 'cases' / 'disc_in_box.toml')!r}, ['discretisation.degree=2'])\n"
        "solution = fsi.solve(case)\n"
        "u, p = solution.evaluate([[0.0, 4.0]])\n"
        "small = fsi.load_case(" + repr(str(ROOT / "cases" / "gluey" / "two_discs.toml")) + ", "
        "['time.end=0.1', 'time.step=0.05'])\n"
        f"steps = len(fsi.run(small, {str(tmp_path / 'run')!r} + str(parallel.size())).steps)\n"
        "if parallel.is_root():\n"
        "    print(solution['disc'].force[1], u[0, 1], p[0], steps)\n"
    )
    alone = call(sys.executable, str(script))
    several = call(*python_on(2), str(script))
    assert alone.returncode == several.returncode == 0, several.stderr
    np.testing.assert_allclose(
        [float(word) for word in several.stdout.split()],
        [float(word) for word in alone.stdout.split()],
        rtol=1e-9,
    )


DIFFERENT = """
import sys
import numpy as np
import fsi, fsi.parallel as parallel

def refused(what, ask):
    try:
        ask()
    except fsi.InputError as error:
        said = parallel.gather(str(error))
        assert said == 2 * [f"{what}: not the same on all ranks; give the same on each"], said
    else:
        raise AssertionError(what)

box, own, out = sys.argv[1], parallel.rank(), sys.argv[2]
small = ["discretisation.degree=2", "discretisation.cells_per_circle=12", "discretisation.growth=1.0"]
case = fsi.load_case(box, small)
solution = fsi.solve(case)
x = np.column_stack([np.linspace(-3.0, 3.0, 40), np.full(40, 4.0)])
for points in (x[own::2], x[: 20 + own], x if own else []):
    refused("points", lambda: solution.evaluate(points))
    refused("points", lambda: solution.velocity(points))
other = fsi.load_case(box, [*small, f"fluid.viscosity={1 + own}"])
refused("case", lambda: fsi.solve(other))
refused("case", lambda: fsi.run(other, out))
refused("case", lambda: fsi.calibrate(other, out))
refused("folder", lambda: fsi.run(case, f"{out}{own}"))
refused("folder", lambda: fsi.resume(f"{out}{own}"))
refused("folder", lambda: solution.write(f"{out}{own}"))
assert not np.isnan(solution.velocity(x)).any()
if parallel.is_root():
    print("done")
"""


@needs_mpi
@pytest.mark.mpi
def test_what_differs_between_ranks_is_refused_on_all_of_them(tmp_path: Path) -> None:
    """Points were matched by their places: of halves the values were those of the other rank's points."""
    box = ROOT / "cases" / "disc_in_box.toml"
    done = call(*python_on(2), "-c", DIFFERENT, str(box), str(tmp_path / "out"), timeout=120.0)
    assert done.returncode == 0, done.stderr
    assert done.stdout == "done\n"
    assert not list(tmp_path.iterdir())
