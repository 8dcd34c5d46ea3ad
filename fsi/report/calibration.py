"""What `fsi calibrate` prints and writes."""

from __future__ import annotations

import csv
import io
import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from fsi.calibration.result import Calibration
from fsi.case.law_file import save_law
from fsi.lubrication.expansions import EXPONENTS
from fsi.run_folder.checkpoint import replace

SAMPLES = "samples.csv"
LAW = "law.toml"
SUMMARY = "calibration.json"


def write_calibration(folder: Path, found: Calibration) -> None:
    """Write law.toml, samples.csv and calibration.json into an existing folder."""
    save_law(folder / LAW, found.law)
    rows = io.StringIO()
    table = csv.writer(rows, lineterminator="\n")
    names = [*asdict(found.samples[0]), "error", "law", "law_error"]
    table.writerow(names)
    for row in _rows(found):
        table.writerow([row[name] for name in names])
    replace(folder / SAMPLES, rows.getvalue().encode())
    replace(folder / SUMMARY, (json.dumps(summary(found), indent=1) + "\n").encode())


def summary(found: Calibration) -> dict[str, Any]:
    """All numbers of a calibration, for JSON."""
    fit, test = found.fit, found.test
    data: dict[str, Any] = {
        "case": found.pair.case.name,
        "shape": found.pair.shape,
        "mode": found.pair.plan.mode,
        "ratio": found.law.ratio,
        "reduced_radius": found.pair.reduced_radius,
        "viscosity": found.law.viscosity,
        "range": list(found.law.law().range),
        "coefficients": [
            asdict(one) | {"difference": one.difference, "inside": one.inside} for one in found.coefficients
        ],
        "samples": _rows(found),
    }
    if fit is not None:
        data |= {"chi2": fit.chi2, "degrees_of_freedom": fit.dof, "used": int(fit.used.sum())}
        data |= _exponent(found)
    if test is not None:
        data["held_out_passed"] = test.passed
    return data


def _exponent(found: Calibration) -> dict[str, float]:
    fit = found.fit
    if fit is None or np.isnan(fit.exponent):
        return {}
    return {"exponent": fit.exponent, "exponent_error": fit.exponent_error}


def _rows(found: Calibration) -> list[dict[str, Any]]:
    """Each sample with the law at its gap, None outside the law's range."""
    smallest, largest = found.law.law().range
    a = found.pair.reduced_radius
    rows = []
    for one in found.samples:
        inside = smallest <= one.gap / a <= largest
        error = found.law.error(np.array(one.gap), a) if inside else None
        law = float(found.law.law().kappa(one.gap, a)) if inside else None
        extra = {"error": one.error, "law": law, "law_error": None if error is None else float(error)}
        rows.append(asdict(one) | extra)
    return rows


def print_calibration(console: Console, found: Calibration) -> None:
    """The coefficients against theory, the leading exponent, and the test by held-out samples."""
    pair, a = found.pair, found.pair.reduced_radius
    exponent = EXPONENTS[pair.shape, pair.plan.mode]
    console.print(
        f"{pair.case.name}: {pair.plan.mode} of {pair.shape}, kappa = mu a_r^{exponent} sum c phi(s), "
        f"s = d/a_r, a_r = {a:g}",
        soft_wrap=True,
    )
    if found.coefficients:
        console.print(_table(found))
    for line in lines(found):
        console.print(line, soft_wrap=True)


def _table(found: Calibration) -> Table:
    table = Table(box=SIMPLE_HEAD, padding=(0, 1))
    for heading in ("phi(s)", "c", "± 95 %", "theory", "difference", ""):
        table.add_column(heading, justify="left" if heading in ("phi(s)", "") else "right", no_wrap=True)
    for one in found.coefficients:
        if one.theory is None or one.difference is None:
            table.add_row(one.term, f"{one.value:.8g}", f"{one.interval:.1e}", "", "", "")
        else:
            verdict = "[green]inside[/]" if one.inside else "[red]OUTSIDE[/]"
            table.add_row(
                one.term, f"{one.value:.8g}", f"{one.interval:.1e}", f"{one.theory:.8g}",
                f"{one.difference:+.1e}", verdict,
            )  # fmt: skip
    return table


def lines(found: Calibration) -> list[str]:
    """What is to be said besides the coefficients."""
    smallest, largest = found.law.law().range
    said = [f"law from s = {smallest:.3g} to {largest:.3g}"]
    fit, test = found.fit, found.test
    if fit is not None:
        used = f"{fit.used.sum()} of {len(fit.used)} samples"
        said[0] += f": {used} agree with it, chi^2 = {fit.chi2:.2g} for {fit.dof} degrees of freedom"
        if not np.isnan(fit.exponent):
            said.append(f"leading exponent, if free: {fit.exponent:.6f} ± {fit.exponent_error:.1e}")
    if test is not None:
        worst = np.max(np.abs(test.law / test.samples.kappa - 1.0))
        stated = np.max((test.band + test.samples.bars) / test.samples.kappa)
        verdict = "within" if test.passed else "NOT within"
        said.append(
            f"{len(test.law)} samples held out: law off by at most {worst:.1e}, {verdict} the stated errors "
            f"(at most {stated:.1e})"
        )
    return said
