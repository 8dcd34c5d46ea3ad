"""The command `fsi calibrate`, from a case to a folder with its law."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from fsi import parallel
from fsi.calibration.pair import pair_of
from fsi.calibration.result import Calibration, calibration
from fsi.calibration.sampling import take_samples
from fsi.case.case import Case
from fsi.errors import InputError
from fsi.report.calibration import SUMMARY, write_calibration


def calibrate_case(
    case: Case, source: str, folder: Path, cache: Path, workers: int, show: Callable[[int, int], None]
) -> Calibration:
    """Sample, fit and write; collective.

    Args:
        case: with its section [calibration].
        source: name of the case file.
        folder: for the law; new, or of an earlier calibration, which is replaced.
        cache: of samples.
        workers: local processes.
        show: is told the progress, as (samples there, samples in all).

    Raises:
        InputError: the case cannot be calibrated, or a folder not be written.
        SolveError: a sample failed, or the samples do not decrease with the gap.
    """
    pair = pair_of(case)
    parallel.on_root(lambda: _require_own(folder))
    samples = take_samples(pair, cache, workers, show)
    found = parallel.on_root(lambda: calibration(pair, samples, source))
    parallel.on_root(lambda: _write(folder, found))
    return found


def _require_own(folder: Path) -> None:
    """The folder is new, empty or that of a calibration."""
    if folder.exists() and not (
        folder.is_dir() and (not any(folder.iterdir()) or (folder / SUMMARY).exists())
    ):
        raise InputError(f"output = {folder}: exists and is no calibration; give another folder")


def _write(folder: Path, found: Calibration) -> None:
    from fsi.postprocess.plots.calibration import plot_calibration

    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"output = {folder}: {error.strerror}; give a folder that can be written") from None
    write_calibration(folder, found)
    plot_calibration(folder, folder / "calibration.png")
