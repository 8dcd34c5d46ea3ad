"""`fsi calibrate` by processes of their own: the samples of one process, whatever is killed."""

from __future__ import annotations

import csv
import os
import signal
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from fsi.calibration.finding import pair_of
from fsi.calibration.sampling import Sampling, compute_sample, take_samples
from fsi.case.law_file import read_law_file
from fsi.errors import FsiError, SolveError
from fsi.workers import launch
from tests.calibration.test_sampling import CASE, SMALL, ExactModel, model, silent, small_case
from tests.cluster import process, scheduler, wait_until
from tests.commands import fsi_command

__all__ = ["model"]  # a fixture


def test_samples_are_those_of_one_process(
    model: ExactModel, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """To the last bit; a sample that fails costs no other, and its folder is left to nobody."""

    def launched(command: str, folder: str, _: int) -> str:
        assert command == "sample-run"
        try:
            compute_sample(Path(folder))
        except FsiError as error:
            return str(error)
        return ""

    monkeypatch.setattr(launch, "launched", launched)
    pair, serial, cache = pair_of(small_case()), tmp_path / "serial", tmp_path / "cache"
    elsewhere = Sampling(cache, 1, silent, lambda: ThreadPoolExecutor(1))
    model.fails = {4}
    with pytest.raises(SolveError, match=r"1 of 10 samples failed, first at the gap .*: singular"):
        take_samples(pair, elsewhere)
    assert len(model.asked) == 10
    found = take_samples(pair, elsewhere)
    assert len(model.asked) == 11
    assert found == take_samples(pair, Sampling(serial, 1, silent))
    assert {path.name for path in cache.glob("*.json")} == {path.name for path in serial.glob("*.json")}
    assert list((cache / "asked").iterdir()) == []


@pytest.mark.slow
def test_a_cluster_gives_the_law_of_one_process(tmp_path: Path) -> None:
    """Two workers in processes of their own, one of them killed half-way; seconds alone may differ."""
    changes = [word for change in SMALL for word in ("--set", change)]
    words = ["calibrate", CASE, *changes, "-o"]
    cache = tmp_path / "cache"
    with (
        scheduler(tmp_path) as (address, worker),
        process(*worker) as first,
        process(*worker),
        process("fsi", *words, tmp_path / "cluster", "--cache", cache, "--scheduler", address) as it,
    ):
        wait_until(lambda: len(list(cache.glob("*.json"))) >= 3)
        os.kill(first.pid, signal.SIGKILL)
        said, _ = it.communicate()
        assert it.returncode == 0, said
    assert fsi_command(*words, tmp_path / "serial", "--cache", tmp_path / "other", "--workers", 1) == 0
    laws = [read_law_file(tmp_path / name / "law.toml").law() for name in ("cluster", "serial")]
    d = np.geomspace(1e-3, 0.5, 40)
    np.testing.assert_array_equal(laws[0].kappa(d, 1.0), laws[1].kappa(d, 1.0))
    tables = []
    for name in ("cluster", "serial"):
        with (tmp_path / name / "samples.csv").open(encoding="utf-8", newline="") as file:
            tables.append([{**row, "seconds": ""} for row in csv.DictReader(file)])
    assert tables[0] == tables[1]
