"""Who does the runs of a study: what is said of each of them, whoever is lost."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from fsi.workers import launch


def test_a_run_that_is_lost_has_failed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whoever ran it has died, and says so in several lines; the others have their own words."""

    def launched(command: str, folder: str, ranks: int) -> str:
        if folder == "lost":
            raise RuntimeError("the worker\n  has died")
        return f"{command} {folder} {ranks}" if folder == "failed" else ""

    monkeypatch.setattr(launch, "launched", launched)
    folders = [Path(name) for name in ("done", "lost", "failed")]
    with ThreadPoolExecutor(2) as pool:
        found = dict(launch.outcomes(pool, "sweep-run", folders, 3))
    assert found == dict(zip(folders, ("", "the worker has died", "sweep-run failed 3"), strict=True))
