"""Sweeps by processes of their own, on this machine and on a cluster, whatever is killed."""

from __future__ import annotations

import os
import signal
import time
from pathlib import Path

import pytest

from fsi.studies.member import LAUNCHES, RESULT
from tests.cluster import process, scheduler, wait_until
from tests.commands import fsi_command
from tests.small_run import rows
from tests.studies.small_sweep import FRACTION, QUANTITY

ROOT = Path(__file__).parents[2]


def wait_for_results(folder: Path, count: int) -> None:
    """Until so many runs are done."""
    wait_until(lambda: len(list(folder.glob(f"runs/*/{RESULT}"))) >= count)


def launches(folder: Path) -> dict[str, int]:
    """How often each run was begun."""
    return {
        path.parent.name: len(path.read_text().splitlines()) for path in folder.glob(f"runs/*/{LAUNCHES}")
    }


@pytest.mark.slow
def test_a_killed_sweep_goes_on(case: Path, tmp_path: Path, here: list[str]) -> None:
    """kill -9 half-way: its runs end with it, what was done is kept, the table is that of a serial one."""
    folder, serial = tmp_path / "killed", tmp_path / "serial"
    words = [
        "sweep",
        case,
        "--vary",
        f"{FRACTION}=0.2,0.3",
        "--seeds",
        5,
        *QUANTITY,
        "--workers",
        2,
        "-o",
        folder,
    ]
    with process("fsi", *words) as one:
        wait_for_results(folder, 3)
        one.send_signal(signal.SIGKILL)
        one.wait()
    time.sleep(3.0)  # runs end within their next look at the pipe
    done = {path.parent.name: path.stat().st_mtime_ns for path in folder.glob(f"runs/*/{RESULT}")}
    assert 3 <= len(done) < 10
    time.sleep(3.0)
    assert len(list(folder.glob(f"runs/*/{RESULT}"))) == len(done)  # none went on alone
    with process("fsi", *words) as again:
        assert again.wait() == 0
    for path in folder.glob(f"runs/*/{RESULT}"):
        assert path.stat().st_mtime_ns == done.get(path.parent.name, path.stat().st_mtime_ns)
    assert fsi_command(*words[:-1], serial) == 0
    assert len(here) == 10
    for table in ("sweep.csv", "runs.csv"):
        assert (folder / table).read_bytes() == (serial / table).read_bytes()


@pytest.mark.slow
def test_a_cluster_gives_the_table_of_a_serial_sweep(case: Path, tmp_path: Path, here: list[str]) -> None:
    """100 runs over two workers in processes of their own, one killed half-way: all done, none twice."""
    folder, serial = tmp_path / "cluster", tmp_path / "serial"
    words = ["sweep", case, "--vary", f"{FRACTION}=0.1,0.2,0.25,0.3,0.35", "--seeds", 20, *QUANTITY, "-o"]
    with (
        scheduler(tmp_path) as (address, worker),
        process(*worker) as first,
        process(*worker),
        process("fsi", *words, folder, "--scheduler", address) as it,
    ):
        wait_for_results(folder, 40)
        os.kill(first.pid, signal.SIGKILL)
        said, _ = it.communicate()
        assert it.returncode == 0, said
    begun = launches(folder)
    assert len(begun) == 100
    assert sorted(begun.values())[:99] == [1] * 99  # only the killed one was begun twice
    assert max(begun.values()) <= 2
    assert fsi_command(*words, serial, "--workers", 1) == 0
    assert len(here) == 100
    for table in ("sweep.csv", "runs.csv"):
        assert (folder / table).read_bytes() == (serial / table).read_bytes()


@pytest.mark.slow
@pytest.mark.mpi
def test_a_run_of_two_ranks_is_one_task(tmp_path: Path) -> None:
    """A resolved disc on two ranks gives the force of one to 1e-9."""
    found = []
    for ranks in (1, 2):
        folder = tmp_path / str(ranks)
        given = [
            "--vary",
            "discretisation.degree=2",
            "--quantity",
            "disc.force.y",
            "-o",
            folder,
            "--ranks",
            ranks,
        ]
        assert fsi_command("sweep", ROOT / "cases" / "disc_in_box.toml", *given, "--workers", 1) == 0
        found.append(float(rows(folder / "runs.csv")[0]["disc.force.y"]))
    assert found[1] == pytest.approx(found[0], rel=1e-9)
    assert found[0] == pytest.approx(466.11048, rel=1e-3)  # cases/disc_in_box.toml, of coarser elements
