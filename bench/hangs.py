"""An error on one rank alone, at every call between ranks: `python bench/hangs.py`.

Each launch is one command on two ranks, in which one call raises on one rank: every call of the program to
mpi4py, PETSc or DOLFINx, and to `fsi.parallel`, found by watching a launch without errors, so that new ones
are found too. All ranks must end within 20 s of the error, not with success, and with one message.
"""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from types import CodeType
from typing import Annotated, Any

import typer
from rich.console import Console
from rich.table import Table

import fsi
import fsi.parallel as parallel
from bench.small_cases import CHANNEL, HELD_BALL, ONE_DISC, TWO_DISCS
from fsi.cli.main import main as fsi_command
from fsi.errors import SolveError

LIMIT = 20.0  # seconds from the error to the end of all ranks
LAUNCH = 300.0  # seconds for a launch and its way to the error
WORD = "raised by hand"
RANKS = 2

# What these do, they do on their own rank.
LOCAL = {
    "Comm.Get_rank", "Comm.Get_size", "Comm.tompi4py", "Mat.getLocalSize", "Mat.getOwnershipRange",
    "Mat.getDenseArray", "Mat.setMumpsIcntl", "Mat.getMumpsInfog", "KSP.getPC", "PC.getFactorMatrix",
    "Topology.index_map", "IndexMap.local_to_global", "Mat", "KSP", "IS", "NullSpace", "Constant", "is_root",
    "rank", "size", "Mat.setOption", "KSP.setType", "PC.setType", "Mat.getOwnershipRangesColumn",
    "Mat.getOwnershipRanges", "Options", "Options.delValue", "speak_with", "Mat.getOwnershipRangeColumn",
}  # fmt: skip
LIBRARIES = {"mpi4py", "petsc4py", "dolfinx"}

TIME = "[time]\nend = 0.1\nfirst_step = 0.05\ntolerance = 1e-2\n[output]\ninterval = 0.05\n"
CALIBRATION = "[calibration]\npair = ['free', 'bottom']\nrange = [0.2, 0.5]\nsamples = 6\nheld_out = 0\n"
CASES = {
    "discs": TWO_DISCS, "channel": CHANNEL, "sphere": HELD_BALL, "moving": TWO_DISCS + TIME,
    "calibrated": ONE_DISC + CALIBRATION, "flowing": CHANNEL + TIME,
}  # fmt: skip
COMMANDS = {
    "solve": "solve discs.toml",
    "multiplier": "solve discs.toml --set discretisation.formulation=multiplier",
    "periodic": "solve channel.toml",
    "in space": "solve sphere.toml",
    "resistance": "resistance discs.toml -o R.npz",
    "mesh": "mesh discs.toml -o mesh.msh",
    "run": "run moving.toml -o run",
    "periodic run": "run flowing.toml -o run",
    "resume": "resume stopped",
    "calibrate": "calibrate calibrated.toml -o law",
    "python": "",  # `python_user`, without the command line
}


@dataclass(frozen=True, slots=True)
class Site:
    """A call: where it stands, and what is called; without a line the first one in the file."""

    file: str
    line: int | None
    name: str

    def __str__(self) -> str:
        """As a table has it."""
        return f"{self.file}:{self.line} {self.name}"


@dataclass(frozen=True, slots=True)
class End:
    """How a launch ended: exit code, seconds after the error (None: it never came), messages, all words."""

    code: int
    seconds: float | None
    messages: int
    stderr: str

    @property
    def reached(self) -> bool:
        """Whether the rank came to the call: some are one rank's own."""
        return self.code != 0 or self.seconds is not None

    @property
    def good(self) -> bool:
        """Whether all ranks ended in time, with one message."""
        return self.code != 0 and self.seconds is not None and self.seconds < LIMIT and self.messages == 1


class Watch:
    """Sees each call to a library of ranks; raises at one site, or collects them."""

    def __init__(self, site: Site | None, failure: Exception, moment: Path) -> None:
        self.sites: dict[Site, None] = {}
        self._site, self._failure, self._moment = site, failure, moment
        self._root = str(Path(fsi.__file__).parent) + os.sep
        monitoring = sys.monitoring
        monitoring.use_tool_id(monitoring.DEBUGGER_ID, "hangs")
        monitoring.register_callback(monitoring.DEBUGGER_ID, monitoring.events.CALL, self._seen)
        monitoring.set_events(monitoring.DEBUGGER_ID, monitoring.events.CALL)

    def _seen(self, code: CodeType, offset: int, called: Any, first: Any) -> None:
        if not code.co_filename.startswith(self._root):
            return
        module = getattr(called, "__module__", None) or type(first).__module__
        name = getattr(called, "__qualname__", "")
        ours = module == "fsi.parallel" and code.co_filename != parallel.__file__
        if name in LOCAL or not (ours or str(module).partition(".")[0] in LIBRARIES):
            return
        line = next(line for start, end, line in code.co_lines() if start <= offset < end)
        file = code.co_filename.removeprefix(self._root)
        self.sites[Site(file, line, name)] = None
        if self._site in (Site(file, line, name), Site(file, None, name)):
            sys.monitoring.set_events(sys.monitoring.DEBUGGER_ID, 0)
            self._moment.touch()
            raise self._failure


def worker(plan: dict[str, Any]) -> int:
    """One rank of a launch; `plan` as `launch` makes it."""
    parallel.PATIENCE = plan["patience"]
    failing = plan["site"] is not None and parallel.rank() == plan["rank"]
    site = Site(**plan["site"]) if failing else None
    failure = (RuntimeError, SolveError)[plan["kind"]](WORD)
    watch = Watch(site, failure, Path("moment"))
    sys.argv[1:] = plan["command"].split()
    code = fsi_command() if plan["command"] else python_user()
    if plan["site"] is None and parallel.is_root():
        Path("sites.json").write_text(json.dumps([[s.file, s.line, s.name] for s in watch.sites]))
    return code


def python_user() -> int:
    """A program of somebody who does without the command line."""
    solution = fsi.solve(fsi.load_case("discs.toml"))
    solution.evaluate([[0.0, 4.0]])
    solution.write("fields")
    return 0


def launch(folder: Path, plan: dict[str, Any]) -> End:
    """Run a command on all ranks; kill them if they do not end."""
    mpiexec = Path(sys.executable).with_name("mpiexec")
    command: list[str | Path] = [
        mpiexec,
        "-n",
        str(RANKS),
        sys.executable,
        __file__,
        "--worker",
        json.dumps(plan),
    ]
    moment, began = folder / "moment", time.time()
    moment.unlink(missing_ok=True)
    with (folder / "stderr").open("w+") as stderr:
        running = subprocess.Popen(
            command,
            cwd=folder,
            env=os.environ | {"PYTHONPATH": str(Path(__file__).parents[1])},
            stdout=subprocess.DEVNULL,
            stderr=stderr,
            start_new_session=True,
        )
        while running.poll() is None:
            time.sleep(0.05)
            raised = moment.stat().st_mtime if moment.exists() else None
            if time.time() > (began + LAUNCH if raised is None else raised + 2.0 * LIMIT):
                os.killpg(running.pid, signal.SIGKILL)
        ended = time.time()
        stderr.seek(0)
        said = stderr.read()
    seconds = ended - moment.stat().st_mtime if moment.exists() else None
    return End(running.returncode, seconds, said.count(WORD), said)


def prepared(folder: Path, command: str) -> Path:
    """A folder with the cases, and a stopped run where that is to go on."""
    folder.mkdir(parents=True)
    for name, text in CASES.items():
        (folder / f"{name}.toml").write_text(text)
    if command.startswith("resume"):
        done = folder.parent / "stopped"
        if not done.exists():
            from fsi.case.load import load_case
            from fsi.runs import run

            def stop(record: Any) -> None:
                if record.step == 1:
                    raise KeyboardInterrupt

            with contextlib.suppress(KeyboardInterrupt):
                run(load_case(folder / "moving.toml"), done, stop)
        subprocess.run(["cp", "-r", done, folder / "stopped"], check=True)
    return folder


def sites_of(command: str, folder: Path, patience: float) -> list[Site]:
    """All sites that a command passes on root."""
    plan = {"command": command, "site": None, "rank": 0, "kind": 0, "patience": patience}
    end = launch(prepared(folder, command), plan)
    if end.code != 0:
        raise RuntimeError(f"{command} fails by itself: {end.stderr}")
    return [Site(*site) for site in json.loads((folder / "sites.json").read_text())]


def trial(command: str, site: Site, rank: int, kind: int, folder: Path, patience: float) -> End:
    """How a command ends with an error at a site on one rank."""
    at = {"file": site.file, "line": site.line, "name": site.name}
    plan = {"command": command, "site": at, "rank": rank, "kind": kind, "patience": patience}
    return launch(prepared(folder, command), plan)


def trials(
    names: list[str], ranks: list[int], patience: float, folder: Path
) -> Iterator[tuple[str, Site, int, End]]:
    """Every site of the commands once on each rank; a site of an earlier command is not tried again."""
    known: set[Site] = set()
    for name in names:
        sites = sites_of(COMMANDS[name], folder / name / "sites", patience)
        new = [site for site in sites if site not in known]
        known.update(new)
        for number, site in enumerate(new):
            for rank in ranks:
                place, kind = folder / name / f"{number}-{rank}", (number + rank) % 2
                end = trial(COMMANDS[name], site, rank, kind, place, patience)
                if end.reached:
                    yield name, site, rank, end


def main(
    only: Annotated[list[str] | None, typer.Option(help="Commands; all if not given.")] = None,
    rank: Annotated[list[int] | None, typer.Option(help="Ranks that fail in turn.")] = None,
    patience: Annotated[float, typer.Option(help="Seconds in place of PATIENCE.")] = parallel.PATIENCE,
) -> None:
    """Try all, and say which did not end as they should."""
    console, bad = Console(), []
    table = Table("command", "launches", "longest s", "bad")
    counts: dict[str, list[End]] = {}
    with tempfile.TemporaryDirectory() as folder:
        for name, site, failing, end in trials(only or [*COMMANDS], rank or [0, 1], patience, Path(folder)):
            counts.setdefault(name, []).append(end)
            if not end.good:
                bad.append((name, site, failing, end))
                console.print(
                    f"{name}, rank {failing}: {site}: {end.code}, {end.seconds} s", end.stderr[-800:]
                )
    for name, ends in counts.items():
        longest = max((end.seconds or float("inf")) for end in ends)
        table.add_row(name, str(len(ends)), f"{longest:.1f}", str(sum(not end.good for end in ends)))
    console.print(table)
    raise SystemExit(bool(bad))


if __name__ == "__main__":
    if sys.argv[1:2] == ["--worker"]:
        sys.exit(worker(json.loads(sys.argv[2])))
    typer.run(main)
