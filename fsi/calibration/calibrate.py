"""`fsi calibrate`, from a case to a folder with its law: law.toml, samples.csv, calibration.json."""

from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

import fsi.parallel as parallel
from fsi.calibration.finding import pair_of
from fsi.calibration.result import CalibrationResult, fit_law
from fsi.calibration.sampling import Sampling, take_samples
from fsi.case.case import Case
from fsi.case.checks.work import require_room_for_samples
from fsi.case.law_file import save_law
from fsi.errors import InputError
from fsi.files import csv_of, json_text, replace, require_folder


def calibrate_case(case: Case, source: str, folder: Path, sampling: Sampling) -> CalibrationResult:
    """Sample, fit and write; collective. An earlier calibration in the folder is replaced.

    Raises InputError: the case (from the file `source`) cannot be calibrated, or the folder not be written.
    SolveError: a sample failed, or the samples do not decrease with the gap.
    """
    pair = pair_of(case)
    parallel.on_root(lambda: require_writable(folder, sampling.cache))
    parallel.on_root(lambda: require_folder(sampling.cache))
    parallel.on_root(lambda: require_room_for_samples(case, sampling.cache))
    samples = take_samples(pair, sampling)
    result = parallel.on_root(lambda: fit_law(pair, samples, source))
    parallel.on_root(lambda: write_calibration(folder, result))
    return result


SAMPLES, LAW, SUMMARY = "samples.csv", "law.toml", "calibration.json"


def require_writable(folder: Path, cache: Path) -> None:
    """Raise InputError unless the folder is new, has at most the cache, or is of a calibration to replace."""
    others = {path.absolute() for path in folder.iterdir()} - {cache.absolute()} if folder.is_dir() else set()
    fits = folder.is_dir() and (not others or (folder / SUMMARY).exists())
    if folder.exists() and not fits:
        raise InputError(f"output = {folder}: exists and is no calibration; give another folder")
    require_folder(folder)


def write_calibration(folder: Path, result: CalibrationResult) -> None:
    """Write the three files. Raises InputError: there can be no such folder, or the disk takes no more.

    The summary, which tells that the folder is of a calibration, comes first: what is killed between two
    files is replaced when it is repeated.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        replace(folder / SUMMARY, (json_text(summary(result), indent=1) + "\n").encode())
        save_law(folder / LAW, result.law)
        replace(folder / SAMPLES, csv_of(_rows(result)).encode())
    except OSError as error:
        remedy = "make room, or give a folder that can be written"
        raise InputError(f"output = {folder}: {error.strerror}; {remedy}") from None


def summary(result: CalibrationResult) -> dict[str, Any]:
    """All numbers of a calibration, for JSON."""
    fit, test = result.fit, result.test
    pair, law, terms = result.pair, result.law, result.coefficients
    data: dict[str, Any] = {"case": pair.case.name, "shape": pair.shape, "mode": pair.plan.mode}
    data |= {"ratio": law.ratio, "reduced_radius": pair.reduced_radius, "viscosity": law.viscosity}
    data["range"] = list(law.law().range)
    data["coefficients"] = [asdict(c) | {"difference": c.difference, "inside": c.inside} for c in terms]
    data["samples"] = _rows(result)
    if fit is not None:
        data |= {"chi2": fit.chi2, "degrees_of_freedom": fit.dof, "used": int(fit.used.sum())}
        if not np.isnan(fit.exponent):
            data |= {"exponent": fit.exponent, "exponent_interval": fit.exponent_interval}
    if result.leading is not None:
        data["leading"] = asdict(result.leading)
    if result.widest_band is not None:
        data["widest_band"] = dict(zip(("gap", "relative"), result.widest_band, strict=True))
    if test is not None:
        data["held_out_error"] = test.error
        if test.passed is not None:
            data["held_out_passed"] = test.passed
    return data


def _rows(result: CalibrationResult) -> list[dict[str, Any]]:
    """Each sample with the law at its gap, None outside the law's range."""
    law, a = result.law.law(), result.pair.reduced_radius
    rows = []
    for one in result.samples:
        inside = law.range[0] <= one.gap / a <= law.range[1]
        error = result.law.error(np.array(one.gap), a) if inside else None
        kappa = float(law.kappa(one.gap, a)) if inside else None
        computed = {"law": kappa, "law_error": None if error is None else float(error)}
        rows.append(asdict(one) | {"error": one.error} | computed)
    return rows
