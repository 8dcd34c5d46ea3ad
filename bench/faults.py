"""Faults put into the code one at a time, and whether the tests notice: `python -m bench.faults`.

A fault is a slip that gives plausible numbers: a sign, a factor, a stale value, a place in a list for a name,
a term left out, a guard that never refuses, a wrong colour. Each is a replacement of text, one entry of a
table in `bench/fault_tables`, one table for each room of the house. It is put into a copy of the checkout,
never into the checkout itself, and the tests that should notice it are run there. The benchmark ends with
exit code 1 if any fault goes unnoticed.

    python -m bench.faults --list                     # the faults and their tests; nothing is run
    python -m bench.faults --only gluey --only sign   # those with one of these words in room, name or file
    python -m bench.faults --whole                    # all default tests where the chosen ones notice nothing
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

ROOT = Path(__file__).parents[1]
TABLES = ROOT / "bench" / "fault_tables"
# What a copy does not need, or must not have: bytecode of another text.
LEFT_OUT = shutil.ignore_patterns(".git", ".venv", "runs", "build", "__pycache__", ".*_cache", "*.egg-info")
PATIENCE = 1200  # seconds for the tests of one fault; a fault that makes them hang has not been noticed
FAILED = 1  # exit code of pytest where tests have run and some have failed


@dataclass(frozen=True, slots=True)
class Fault:
    """One slip.

    Attributes:
        room: whose table has it.
        name: what is wrong, in a few words.
        file: seen from the top of the checkout.
        old: text that stands in the file exactly once.
        new: what replaces it.
        tests: that should notice, as pytest takes them.
    """

    room: str
    name: str
    file: str
    old: str
    new: str
    tests: tuple[str, ...]

    def matches(self, words: Sequence[str]) -> bool:
        """Whether one of the words is in its room, name or file; always without words."""
        return not words or any(word in f"{self.room} {self.name} {self.file}" for word in words)

    def put_into(self, text: str) -> str:
        """The file's text with the fault. Raises ValueError unless `old` stands in it exactly once."""
        if (count := text.count(self.old)) != 1:
            raise ValueError(
                f"{self.room}: {self.name}: {self.file} has its old text {count} times, not once"
            )
        return text.replace(self.old, self.new)


def read_faults() -> list[Fault]:
    """All faults of all tables."""
    faults = []
    for path in sorted(TABLES.glob("*.toml")):
        for entry in tomllib.loads(path.read_text(encoding="utf-8"))["fault"]:
            faults.append(Fault(path.stem, **(entry | {"tests": tuple(entry["tests"])})))
    return faults


@dataclass(frozen=True, slots=True)
class Verdict:
    """What came of the tests.

    Attributes:
        noticed: whether some failed.
        by: the first that did, or why nothing can be said.
    """

    noticed: bool
    by: str


class Copy:
    """A copy of the checkout in which tests are run."""

    def __init__(self, path: Path) -> None:
        """Make it in a folder that is not there yet."""
        self.path = path
        shutil.copytree(ROOT, path, symlinks=True, ignore=LEFT_OUT)

    def test(self, tests: Sequence[str], *, keep_bytecode: bool = False) -> Verdict:
        """Run tests up to the first that fails, all default ones if none are given."""
        environment = os.environ | {"PYTHONPATH": str(self.path)}
        # Bytecode is told from its source by seconds and size alone: a fault's own would outlive it.
        environment["PYTHONDONTWRITEBYTECODE"] = "" if keep_bytecode else "1"
        command = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", *tests]
        try:
            run = subprocess.run(
                command, cwd=self.path, env=environment, capture_output=True, text=True, timeout=PATIENCE,
                check=False,
            )  # fmt: skip
        except subprocess.TimeoutExpired:
            return Verdict(False, f"the tests hang: {PATIENCE} s were not enough")
        if run.returncode == 0:
            return Verdict(False, "")
        failed = re.search(r"^(?:FAILED|ERROR) (\S+)", run.stdout, re.MULTILINE)
        if run.returncode != FAILED or failed is None:
            return Verdict(False, f"the tests do not run (exit code {run.returncode}): {run.stdout[-500:]}")
        return Verdict(True, failed[1])

    @contextmanager
    def with_fault(self, fault: Fault) -> Iterator[None]:
        """The fault is in the copy."""
        file = self.path / fault.file
        sound = file.read_text(encoding="utf-8")
        file.write_text(fault.put_into(sound), encoding="utf-8")
        try:
            yield
        finally:
            file.write_text(sound, encoding="utf-8")


def main(
    only: Annotated[list[str] | None, typer.Option(help="words in room, name or file")] = None,
    list_them: Annotated[bool, typer.Option("--list", help="say what there is, run nothing")] = False,
    whole: Annotated[bool, typer.Option(help="all tests for what the chosen ones do not notice")] = False,
) -> None:
    """Put the faults in one at a time, and say which are noticed."""
    console = Console(highlight=False, soft_wrap=True)
    faults = [fault for fault in read_faults() if fault.matches(only or [])]
    if list_them:
        for fault in faults:
            console.print(f"{fault.room}: {fault.name} ({fault.file}); {', '.join(fault.tests)}")
        return
    with tempfile.TemporaryDirectory(prefix="faults-") as folder:
        copy = Copy(Path(folder) / "checkout")
        tests = sorted({test for fault in faults for test in fault.tests})
        if (sound := copy.test(tests, keep_bytecode=True)).by:
            console.print(f"nothing can be said: without any fault {sound.by} fails")
            raise typer.Exit(2)
        missed = [fault for fault in faults if not _noticed(console, copy, fault, whole)]
    console.print(f"{len(faults) - len(missed)} of {len(faults)} faults noticed")
    for fault in missed:
        console.print(f"unnoticed: {fault.room}: {fault.name} ({fault.file})")
    raise typer.Exit(1 if missed else 0)


def _noticed(console: Console, copy: Copy, fault: Fault, whole: bool) -> bool:
    """Whether tests notice a fault; prints which one does."""
    with copy.with_fault(fault):
        verdict = copy.test(fault.tests)
        if whole and not verdict.noticed:
            verdict = copy.test(())
    said = f"noticed by {verdict.by}" if verdict.noticed else f"UNNOTICED {verdict.by}"
    console.print(f"{fault.room}: {fault.name}: {said}")
    return verdict.noticed


if __name__ == "__main__":
    typer.run(main)
