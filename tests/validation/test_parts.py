"""`fsi validate` by processes of their own: the rows of one process, whatever is killed."""

from __future__ import annotations

import json
import os
import signal
from pathlib import Path

import pytest

from fsi.validation.parts import ROWS, compute_part
from fsi.workers import launch
from tests.cluster import process, scheduler, wait_until
from tests.commands import fsi_command
from tests.validation.test_validate import QUICK, folder_with


def validated(folder: Path, output: Path, *more: object) -> int:
    return fsi_command("validate", "--cases", folder, "-o", output, *more)


def test_rows_are_those_of_one_process(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """To the last bit and in their order, whichever part is done first; one that crashes alone has failed."""
    folder = folder_with(tmp_path, ball=QUICK, other=QUICK.replace("[4.0, 2.0]", "[3.0]"))
    assert validated(folder, tmp_path / "serial") == 0
    asked: list[str] = []

    def launched(command: str, part: str, _: int) -> str:
        asked.append(f"{command} {Path(part).name}")
        if crashing and part.endswith("ball-1"):
            return "ended with code -11"
        compute_part(Path(part))
        return ""

    monkeypatch.setattr(launch, "launched", launched)
    crashing = False
    assert validated(folder, tmp_path / "parts", "--workers", 1) == 0
    assert asked == ["validate-run ball-0", "validate-run ball-1", "validate-run other-0"]
    for name in ("validation.json", "validation.csv"):
        assert (tmp_path / "parts" / name).read_bytes() == (tmp_path / "serial" / name).read_bytes()
    crashing = True
    assert validated(folder, tmp_path / "crashed", "--workers", 1) == 4
    found, known = (
        json.loads((tmp_path / run / "validation.json").read_text()) for run in ("crashed", "serial")
    )
    assert [row["failure"] for row in found] == ["", "ended with code -11", ""]
    assert [found[0], found[2]] == [known[0], known[2]]


def test_one_door_at_a_time(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    for command in (("validate",), ("calibrate", "cases/calibration/disc_wall.toml")):
        given = ("--scheduler", "tcp://127.0.0.1:9", "--workers", 2, "-o", tmp_path / "none")
        assert fsi_command(*command, *given) == 2
        assert "--workers 2: the cluster has its own; drop it, or --scheduler" in capfd.readouterr().err
    assert not (tmp_path / "none").exists()


@pytest.mark.slow
def test_a_cluster_gives_the_rows_of_one_process(tmp_path: Path) -> None:
    """Two workers in processes of their own, one of them killed half-way."""
    radii = ", ".join(str(2.0 + 0.25 * k) for k in range(8))
    folder = folder_with(tmp_path, ball=QUICK.replace("4.0, 2.0", radii))
    output = tmp_path / "cluster"
    with (
        scheduler(tmp_path) as (address, worker),
        process(*worker) as first,
        process(*worker),
        process("fsi", "validate", "--cases", folder, "-o", output, "--scheduler", address) as it,
    ):
        wait_until(lambda: len(list(output.glob(f"parts/*/{ROWS}"))) >= 2)
        os.kill(first.pid, signal.SIGKILL)
        said, _ = it.communicate()
        assert it.returncode == 0, said
    assert validated(folder, tmp_path / "serial") == 0
    for name in ("validation.json", "validation.csv"):
        assert (output / name).read_bytes() == (tmp_path / "serial" / name).read_bytes()
