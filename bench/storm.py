"""Whether anything makes the program fall over: seeded mutations of all shipped cases, over all commands.

    python -m bench.storm --count 3000 --seed 0

A trial is one command on a mutated case, with mutated options, or on a damaged run folder, in a process of
its own that is forked from one that has loaded all libraries. It fails where it ends by a signal or with
another exit code than 0, 2, 3 and 4, prints a traceback or a warning of a library, says more than one line of
an error, or is not done after PATIENCE seconds, more on a busy machine, without having said that it takes
long. A run that makes steps is interrupted after ENOUGH seconds, and must then leave with 130. The bench
prints how many trials of each command there were and how they ended, and those that failed with their seeds;
its exit code is 1 if any has. `--seed S --count 1` is one trial again.
"""

from __future__ import annotations

import os
import resource
import shutil
import signal
import sys
import tempfile
import time
import traceback
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Annotated

import tomli_w
import typer
from rich.console import Console
from rich.table import Table

from bench.trials import CASES, OF_CASES, TRIALS, Arguments, Place, coarse, trial_of
from fsi.cli.main import INTERRUPTED, main

PATIENCE = 60.0
ENOUGH = 10.0  # seconds of a run that makes steps
GRACE = 10.0  # seconds after an interruption
ALLOWED = (0, 2, 3, 4)
NOTE = "note: "
LARGEST = 2_000_000_000  # bytes of a file

# The sound runs whose copies are damaged: the case, its level, its end, changes of it.
RUNS = {
    "resolved": ("settling_disc.toml", "resolved", 2.0),
    "spheres": ("settling_spheres.toml", "resolved", 0.1),
    "pores": ("pores/sheared_cell.toml", "pores", 0.05),
    "reduced": ("compare_settling.toml", "reduced", 0.5),
    "channel": ("compare_channel.toml", "reduced", 0.1),
    "gluey": ("gluey/two_discs.toml", "gluey", 6.0),
    "macroscopic": ("macroscopic/blocks.toml", "macroscopic", 1.0),
}


@dataclass(frozen=True, slots=True)
class Ended:
    """How a trial ended: what it was, its exit code (negative: a signal), and its fault, if it has one."""

    seed: int
    name: str
    command: Arguments
    notes: list[str]
    code: int
    seconds: float
    fault: str | None
    said: str


def in_child(arguments: Arguments, folder: Path) -> int:
    """Start `fsi` with these arguments in a folder, its output into files there; gives the process."""
    process = os.fork()
    if process:
        return process
    code = 70
    try:
        os.setsid()
        os.chdir(folder)
        resource.setrlimit(resource.RLIMIT_FSIZE, (LARGEST, LARGEST))
        for stream, name in ((1, "stdout"), (2, "stderr")):
            os.dup2(os.open(name, os.O_WRONLY | os.O_CREAT), stream)
        sys.stdout = open(1, "w", encoding="utf-8", closefd=False)  # noqa: SIM115
        sys.stderr = sys.__stderr__ = open(2, "w", encoding="utf-8", closefd=False)  # type: ignore[misc]  # noqa: SIM115
        sys.argv = ["fsi", *arguments]
        signal.signal(signal.SIGINT, signal.default_int_handler)
        code = main()
        sys.stderr.flush()
    except BaseException:
        traceback.print_exc()
        sys.stderr.flush()
    finally:
        os._exit(code)


def crowding() -> float:
    """How many processes want each CPU, at least 1: a trial has so much more time on a busy machine."""
    return max(1.0, os.getloadavg()[0] / (os.cpu_count() or 1))


def fault_of(code: int, said: str, *, timed_out: bool, interrupted: bool) -> str | None:
    """What is wrong with how a trial ended; None where nothing is."""
    if timed_out:
        return None if NOTE in said else f"not done after {PATIENCE:g} s"
    if code < 0:
        return f"ended by {signal.Signals(-code).name}"
    if code not in (*ALLOWED, *([INTERRUPTED] if interrupted else [])):
        return f"exit code {code}"
    if "Traceback" in said or "Warning" in said:
        return "a traceback or a warning"
    errors = [line for line in said.splitlines() if line and not line.startswith(NOTE)]
    if code not in (0, 4) and (len(errors) != 1 or not errors[0].startswith("error: ")):
        return f"{len(errors)} lines of an error"
    return None


@dataclass
class Running:
    """A trial under way."""

    seed: int
    name: str
    command: Arguments
    place: Place
    process: int
    began: float
    interrupted: bool = False

    def look(self) -> Ended | None:
        """How it has ended, None while it has not; ends what takes too long."""
        done, status = os.waitpid(self.process, os.WNOHANG)
        seconds = time.monotonic() - self.began
        if not done:
            steps = any(path.is_file() for path in self.place.folder.glob("**/steps.csv"))
            stepping = self.command[0] in ("run", "resume", "compare") and steps
            if stepping and seconds > ENOUGH and not self.interrupted:
                os.kill(self.process, signal.SIGINT)
                self.interrupted = True
            if seconds < (ENOUGH + GRACE if self.interrupted else PATIENCE) * crowding():
                return None
            os.killpg(self.process, signal.SIGKILL)
            _, status = os.waitpid(self.process, 0)
        said = (self.place.folder / "stderr").read_text(errors="replace")
        code = os.waitstatus_to_exitcode(status)
        fault = fault_of(code, said, timed_out=not done, interrupted=self.interrupted)
        return Ended(self.seed, self.name, self.command, self.place.notes, code, seconds, fault, said)


type Start = Callable[[int, Place], tuple[str, Arguments]]


def storm(seeds: Iterator[int], start: Start, runs: Path, workers: int) -> Iterator[Ended]:
    """All trials, some at a time; start: the command and arguments of a seed, in a place."""
    running: list[Running] = []
    with tempfile.TemporaryDirectory(prefix="storm-") as base:
        os.environ["TMPDIR"] = base
        tempfile.tempdir = None
        while True:
            while len(running) < workers and (seed := next(seeds, None)) is not None:
                place = Place(Path(base) / str(seed), runs)
                place.folder.mkdir()
                name, command = start(seed, place)
                process = in_child(command, place.folder)
                running.append(Running(seed, name, command, place, process, time.monotonic()))
            if not running:
                return
            for trial in list(running):
                if (ended := trial.look()) is not None:
                    running.remove(trial)
                    yield ended
                    shutil.rmtree(trial.place.folder, ignore_errors=True)
            time.sleep(0.005)


def make_runs(folder: Path) -> None:
    """The sound runs, each in a process of its own."""
    for name, (case, model, end) in RUNS.items():
        data = coarse(CASES / case, model)
        data["time"]["end"] = end
        (folder / f"{name}.toml").write_bytes(tomli_w.dumps(data).encode())
        process = in_child(
            ["run", str(folder / f"{name}.toml"), "--output", str(folder / "runs" / name)], folder
        )
        if os.waitpid(process, 0)[1]:
            sys.exit(f"the sound run {name} fails: {(folder / 'stderr').read_text()}")


def load_libraries() -> None:
    """All that commands import when they run; none of it may start threads or a display yet."""
    import fsi.api
    import fsi.gluey.limit_study
    import fsi.pores.accuracy
    import fsi.pores.resistance
    import fsi.postprocess.export
    import fsi.postprocess.plots.histories
    import fsi.postprocess.render.render
    import fsi.postprocess.report
    import fsi.report.studies
    import fsi.stokes.adapt
    import fsi.stokes.resistance  # noqa: F401


def bench(
    count: Annotated[int, typer.Option(help="How many trials.", min=1)] = 3000,
    seed: Annotated[int, typer.Option(help="The first; each trial has the next one.")] = 0,
    workers: Annotated[int, typer.Option(help="How many at a time.", min=1)] = os.cpu_count() or 1,
    only: Annotated[list[str] | None, typer.Option(help=f"Some of: {', '.join(TRIALS)}.")] = None,
) -> None:
    """Try to make the program fall over."""
    console, began = Console(width=160, highlight=False, markup=False), time.monotonic()
    warnings.simplefilter("ignore", DeprecationWarning)  # of forking; libraries' own threads are idle
    load_libraries()
    counts: Counter[tuple[str, str]] = Counter()
    failed = 0
    with tempfile.TemporaryDirectory(prefix="storm-runs-") as folder:
        if not set(only or TRIALS) <= set(OF_CASES):
            make_runs(Path(folder))
        start = partial(trial_of, only=only or ())
        for ended in storm(iter(range(seed, seed + count)), start, Path(folder) / "runs", workers):
            counts[ended.name, "failed" if ended.fault else str(ended.code)] += 1
            if ended.fault:
                failed += 1
                _tell(console, ended)
    _print(console, counts)
    console.print(f"{count} trials, {failed} failed, {time.monotonic() - began:.0f} s")
    if failed:
        raise typer.Exit(1)


def _tell(console: Console, ended: Ended) -> None:
    """A fault, and all that is needed to see it again."""
    words = " ".join(ended.command)[:300]
    console.print(f"seed {ended.seed}: {ended.fault}: fsi {words}\n    {'; '.join(ended.notes)}")
    console.print(f"    {ended.said.strip()[-600:]}", soft_wrap=True)


def _print(console: Console, counts: Counter[tuple[str, str]]) -> None:
    """A row for each command, a column for each way to end."""
    ways = sorted({way for _, way in counts})
    table = Table("command", *ways)
    for name in sorted({name for name, _ in counts}):
        table.add_row(name, *(str(counts[name, way] or "") for way in ways))
    console.print(table)


if __name__ == "__main__":
    typer.run(bench)
