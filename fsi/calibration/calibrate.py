"""`fsi calibrate`, from a case to a folder with its law."""

from __future__ import annotations

from pathlib import Path

import fsi.parallel as parallel
from fsi.calibration.files import require_writable, write_calibration
from fsi.calibration.pair import pair_of
from fsi.calibration.result import CalibrationResult, fit_law
from fsi.calibration.sampling import Sampling, take_samples
from fsi.case.case import Case


def calibrate_case(case: Case, source: str, folder: Path, sampling: Sampling) -> CalibrationResult:
    """Sample, fit and write; collective.

    Args:
        case: with its section [calibration].
        source: name of the case file.
        folder: for the law; new, or of an earlier calibration, which is replaced.
        sampling: how the samples are taken.

    Raises:
        InputError: the case cannot be calibrated, or a folder not be written.
        SolveError: a sample failed, or the samples do not decrease with the gap.
    """
    pair = pair_of(case)
    parallel.on_root(lambda: require_writable(folder))
    samples = take_samples(pair, sampling)
    result = parallel.on_root(lambda: fit_law(pair, samples, source))
    parallel.on_root(lambda: write_calibration(folder, result))
    return result
