"""`fsi calibrate`, from a case to a folder with its law: law.toml, samples.csv, calibration.json."""

from __future__ import annotations

import csv
import io
import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

import fsi.parallel as parallel
from fsi.calibration.pair import pair_of
from fsi.calibration.result import CalibrationResult, fit_law
from fsi.calibration.sampling import Sampling, take_samples
from fsi.case.case import Case
from fsi.case.law_file import save_law
from fsi.errors import InputError
from fsi.run_folder.checkpoint import replace


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


SAMPLES, LAW, SUMMARY = "samples.csv", "law.toml", "calibration.json"


def require_writable(folder: Path) -> None:
    """Raise InputError unless the folder is new, empty or that of a calibration, which is replaced."""
    if folder.exists() and not (
        folder.is_dir() and (not any(folder.iterdir()) or (folder / SUMMARY).exists())
    ):
        raise InputError(f"output = {folder}: exists and is no calibration; give another folder")


def write_calibration(folder: Path, result: CalibrationResult) -> None:
    """Write the three files. Raises InputError if there can be no such folder."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"output = {folder}: {error.strerror}; give a folder that can be written") from None
    save_law(folder / LAW, result.law)
    rows, text = _rows(result), io.StringIO()
    table = csv.DictWriter(text, list(rows[0]), lineterminator="\n")
    table.writeheader()
    table.writerows(rows)
    replace(folder / SAMPLES, text.getvalue().encode())
    replace(folder / SUMMARY, (json.dumps(summary(result), indent=1) + "\n").encode())


def summary(result: CalibrationResult) -> dict[str, Any]:
    """All numbers of a calibration, for JSON."""
    fit, test = result.fit, result.test
    data: dict[str, Any] = {
        "case": result.pair.case.name,
        "shape": result.pair.shape,
        "mode": result.pair.plan.mode,
        "ratio": result.law.ratio,
        "reduced_radius": result.pair.reduced_radius,
        "viscosity": result.law.viscosity,
        "range": list(result.law.law().range),
        "coefficients": [
            asdict(one) | {"difference": one.difference, "inside": one.inside} for one in result.coefficients
        ],
        "samples": _rows(result),
    }
    if fit is not None:
        data |= {"chi2": fit.chi2, "degrees_of_freedom": fit.dof, "used": int(fit.used.sum())}
        if not np.isnan(fit.exponent):
            data |= {"exponent": fit.exponent, "exponent_error": fit.exponent_error}
    if test is not None:
        data["held_out_passed"] = test.passed
    return data


def _rows(result: CalibrationResult) -> list[dict[str, Any]]:
    """Each sample with the law at its gap, None outside the law's range."""
    law, a = result.law.law(), result.pair.reduced_radius
    rows = []
    for one in result.samples:
        inside = law.range[0] <= one.gap / a <= law.range[1]
        error = result.law.error(np.array(one.gap), a) if inside else None
        rows.append(
            asdict(one)
            | {
                "error": one.error,
                "law": float(law.kappa(one.gap, a)) if inside else None,
                "law_error": None if error is None else float(error),
            }
        )
    return rows
