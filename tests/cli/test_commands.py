"""The commands as a user types them: what they print, their exit codes, one message on all ranks."""

import os
import shutil
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

from fsi.cli.main import main
from tests.exact_model import DiscsBesidePlane
from tests.ranks import needs_mpi, python_on

ROOT = Path(__file__).parents[2]
COMMANDS = (
    *("check", "mesh", "pack", "solve", "run", "resume", "calibrate", "compare"),
    *("plot", "probe", "render", "report", "resistance", "revolve"),
)
CASE = ROOT / "cases" / "disc_in_box.toml"


def call(*command: str, timeout: float = 900.0) -> subprocess.CompletedProcess[str]:
    """Run a command in the checkout with narrow, colourless output."""
    environment = os.environ | {"PYTHONPATH": str(ROOT), "COLUMNS": "100", "NO_COLOR": "1"}
    return subprocess.run(
        command, capture_output=True, text=True, timeout=timeout, cwd=ROOT, env=environment, check=False
    )


def fsi(*arguments: str) -> subprocess.CompletedProcess[str]:
    return call(sys.executable, "-m", "fsi", *arguments)


def complaint(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, *arguments: str) -> str:
    """The one line that wrong input gives, in this process; stdout must be empty and the exit code 2."""
    monkeypatch.setattr(sys, "argv", ["fsi", *arguments])
    monkeypatch.setattr(sys, "__stderr__", sys.stderr)
    assert main() == 2
    printed = capsys.readouterr()
    assert printed.out == ""
    assert printed.err.startswith("error: ")
    assert printed.err.count("\n") == 1
    return printed.err


def test_help_lists_the_commands() -> None:
    done = fsi("--help")
    assert done.returncode == 0
    assert all(command in done.stdout for command in COMMANDS)


@pytest.mark.parametrize("command", COMMANDS)
def test_each_command_has_an_example(
    command: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "argv", ["fsi", command, "--help"])
    assert main() == 0
    assert f"Example: fsi {command} " in capsys.readouterr().out


def test_check_shows_bodies_gaps_and_walls() -> None:
    done = fsi("check", str(CASE), "--set", "domain.walls.top=[1.0, 0.0]")
    assert (done.returncode, done.stderr) == (0, "")
    assert all(word in done.stdout for word in ("disc", "0.1", "bottom", "held", "[1.0, 0.0]", "at rest"))


def test_check_shows_that_fluid_slides_along_a_wall_at_rest() -> None:
    done = fsi("check", str(CASE), "--set", "domain.walls.top={slip_length = 0.5}")
    assert (done.returncode, done.stderr) == (0, "")
    assert "{slip_length = 0.5}" in done.stdout


def test_check_and_help_load_neither_dolfinx_nor_gmsh_nor_pyvista() -> None:
    script = f"""
        import sys
        from fsi.cli.main import main
        for arguments in (["--help"], ["check", {str(CASE)!r}]):
            sys.argv = ["fsi", *arguments]
            assert main() == 0
        assert not {{"dolfinx", "gmsh", "pyvista", "petsc4py"}} & set(sys.modules)
    """
    done = call(sys.executable, "-c", textwrap.dedent(script))
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["check"], "Missing argument 'CASE'; see fsi check --help"),
        (["chek"], "Did you mean 'check'"),
        (["check", str(CASE), "--sett", "x=1"], "--set"),
        (["compare", str(CASE), "--levels"], "'--levels' requires an argument; see fsi compare --help"),
        (["check", str(CASE), "--set", "limit.eps=[]"], "= []: must have at least 1 item, not 0; give"),
        (["check", "nowhere.toml"], "nowhere.toml: No such file"),
        (["check", str(CASE), "--set", "fluid.viscosity=-1"], "fluid.viscosity = -1: must be greater than 0"),
        (["check", str(CASE), "--set", "bodies.0.position=[0.0, 0.9]"], "'bottom' (gap -0.1)"),
        (["check", str(CASE), "--set", "fluid.viscocity=1"], "use fluid.viscosity"),
        (["solve", str(CASE), "--json", "--set", "bodies.0.radius=nan"], "bodies.0.radius = nan"),
        (["mesh", str(CASE), "-o", "/nowhere/disc.msh"], "output = /nowhere/disc.msh"),
        (["mesh", str(CASE), "-o", "disc.unknown"], "unknown suffix '.unknown'; give .msh or .vtu"),
        (["resistance", str(CASE), "-o", "/nowhere/disc.npz"], "output = /nowhere/disc.npz"),
        (["resistance", str(CASE), "-o", "disc.txt"], "unknown suffix '.txt'; give .json, .csv, .npz"),
        (["resistance", str(CASE), "--set", "bodies=[]"], "at least one [[bodies]]"),
        (["resume", "/nowhere"], "/nowhere"),
        (["render", "/nowhere"], "/nowhere"),
    ],
)
def test_wrong_input_gives_one_line_and_exit_code_2(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, arguments: list[str], words: str
) -> None:
    assert words in complaint(capsys, monkeypatch, *arguments)


def test_wrong_input_from_the_shell() -> None:
    done = fsi("run", str(CASE), "--set", "fluid.viscosity=0")
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.count("\n") == 1


def test_ctrl_c_is_one_line_and_exit_code_130(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupt(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("fsi.case.load.load_case", interrupt)
    monkeypatch.setattr(sys, "argv", ["fsi", "check", str(CASE)])
    monkeypatch.setattr(sys, "__stderr__", sys.stderr)
    assert main() == 130
    assert capsys.readouterr().err == "error: interrupted\n"


def ranks(n: int, *command: str) -> subprocess.CompletedProcess[str]:
    return call(*python_on(n), *command)


@needs_mpi
@pytest.mark.mpi
def test_ranks_print_once() -> None:
    done = ranks(3, "-m", "fsi", "check", str(CASE))
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("disc in a box") == 1


@needs_mpi
@pytest.mark.mpi
def test_ranks_complain_once_and_leave_with_one_exit_code() -> None:
    done = ranks(3, "-m", "fsi", "check", "nowhere.toml")
    assert done.returncode == 2
    assert done.stderr.count("error: nowhere.toml: No such file") == 1


@needs_mpi
@pytest.mark.mpi
@pytest.mark.parametrize("error", [pytest.param("InputError", marks=pytest.mark.slow), "ZeroDivisionError"])
def test_an_error_on_one_rank_ends_all_with_one_message(error: str) -> None:
    script = f"""
        import sys
        import fsi.meshes.backend
        from mpi4py import MPI
        import fsi.parallel as parallel
        from fsi.cli import cases
        from fsi.cli.main import main
        from fsi.errors import InputError

        def load(*_):
            if parallel.rank() > 0:
                raise {error}("the radius is wrong here")
            MPI.COMM_WORLD.Barrier()  # waits for ever

        cases.load = load
        sys.argv = ["fsi", "check", "case.toml"]
        sys.exit(main())
    """
    done = ranks(3, "-c", textwrap.dedent(script))
    assert done.returncode == (2 if error == "InputError" else 70)
    assert done.stderr.count("the radius is wrong here") == 1


@pytest.fixture
def exact(monkeypatch: pytest.MonkeyPatch) -> None:
    """The closed form of a disc beside a plane in place of the resolved model."""
    monkeypatch.setattr("fsi.models.make_model", DiscsBesidePlane)


def typed(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, *arguments: str) -> str:
    """What a command that succeeds prints, in this process."""
    monkeypatch.setattr(sys, "argv", ["fsi", *arguments])
    assert main() == 0
    return capsys.readouterr().out


@pytest.mark.usefixtures("exact")
def test_run_then_resume(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = str(tmp_path / "runs" / "settling")
    changes = ["--set", "time.end=1", "--set", "output.fields=false"]
    arguments = ["run", str(CASE.with_name("settling_disc.toml")), "--output", folder, *changes]
    summary = typed(capsys, monkeypatch, *arguments)
    assert f"{folder}: " in summary
    assert "steps to t = 1, smallest gap 0.637" in summary  # the exact gap is 0.63717
    again = typed(capsys, monkeypatch, "resume", folder)
    assert "nothing to do" in again
    assert "look at it with: fsi plot" in summary  # there are no fields to render
    assert "look at it with: fsi plot" in again
    assert "exists and is not empty" in complaint(capsys, monkeypatch, *arguments)


@pytest.mark.usefixtures("exact")
def test_the_end_of_a_resumed_run_tells_of_all_of_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A disc that is pulled up from where it is nearest; its folder's name has a blank."""
    case, folder = str(CASE.with_name("settling_disc.toml")), str(tmp_path / "my run")
    up = ("--set", "bodies.0.force=[0.0, 10.0]", "--set", "time.end=0.5")
    started = typed(capsys, monkeypatch, "run", case, "--output", folder, *up).splitlines()
    assert started[-1] == f"look at it with: fsi render '{folder}'"
    shutil.rmtree(f"{folder}/fields")
    resumed = typed(capsys, monkeypatch, "resume", folder, "--set", "time.end=1")
    written = (tmp_path / "my run" / "steps.csv").read_text().splitlines()
    steps, gap = len(written) - 2, float(written[1].split(",")[3])
    assert f": {steps} steps to t = 1, smallest gap {gap:.4g} (at t = 0), the last " in resumed
    assert list((tmp_path / "my run" / "fields").iterdir())  # made anew, for what comes after


@pytest.mark.usefixtures("exact")
def test_run_writes_beside_the_caller_by_default(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    typed(capsys, monkeypatch, "run", str(CASE.with_name("settling_disc.toml")), "--set", "time.end=0.1")
    assert (tmp_path / "runs" / "settling_disc" / "steps.csv").is_file()


@pytest.mark.usefixtures("exact")
def test_a_run_needs_a_time_and_a_folder_it_can_write(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert "time: missing" in complaint(capsys, monkeypatch, "run", str(CASE))
    (tmp_path / "file").touch()
    settling = str(CASE.with_name("settling_disc.toml"))
    assert "output = " in complaint(capsys, monkeypatch, "run", settling, "-o", "file/run")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["file"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("probe", "RUN", "--line", "0,0,1"), "there is no case.toml"),
        (("probe", "RUN"), "give exactly one of --line, --plane and --points"),
        (("render", "RUN", "--range", "2,1"), "--range 2,1: give the lower end first"),
        (("render", "RUN", "--range", "0,1e-60"), "--range 0,1e-60: colours span 1e-30 or more"),
        (("render", "RUN", "--step", "1", "--time", "2"), "give --time or --step, not both"),
        (("plot", "RUN"), "there is no case.toml"),
        (("report", "RUN"), "there is no case.toml"),
        (("revolve", "RUN"), "there is no case.toml"),
    ],
)
def test_looking_at_nothing(
    arguments: tuple[str, ...],
    message: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    given = [str(tmp_path) if word == "RUN" else word for word in arguments]
    assert message in complaint(capsys, monkeypatch, *given)
    assert not any(tmp_path.iterdir())
