"""What `fsi calibrate` prints."""

from __future__ import annotations

import numpy as np
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table

from fsi.calibration.result import CalibrationResult
from fsi.lubrication.expansions import EXPONENTS
from fsi.report.console import table


def print_calibration(console: Console, result: CalibrationResult) -> None:
    """The coefficients against theory, the leading exponent, and the test by held-out samples."""
    pair, a = result.pair, result.pair.reduced_radius
    exponent = EXPONENTS[pair.shape, pair.plan.mode]
    console.print(
        f"{pair.case.name}: {pair.plan.mode} of {pair.shape}, kappa = mu a_r^{exponent} sum c phi(s), "
        f"s = d/a_r, a_r = {a:g}",
        soft_wrap=True,
    )
    if result.coefficients:
        console.print(_table(result))
    for line in lines(result):
        console.print(line, soft_wrap=True)


def _table(result: CalibrationResult) -> Table:
    shown = table(("phi(s)",), ("c", "± 95 %", "theory", "difference"), box=SIMPLE_HEAD, padding=(0, 1))
    shown.add_column("")
    for one in result.coefficients:
        row = [one.term, f"{one.value:.8g}", f"{one.interval:.1e}"]
        if one.theory is not None and one.difference is not None:
            verdict = "[green]inside[/]" if one.inside else "[red]OUTSIDE[/]"
            row += [f"{one.theory:.8g}", f"{one.difference:+.1e}", verdict]
        shown.add_row(*row)
    return shown


def lines(result: CalibrationResult) -> list[str]:
    """What is to be said besides the coefficients."""
    smallest, largest = result.law.law().range
    said = [f"law from s = {smallest:.3g} to {largest:.3g}"]
    fit, test = result.fit, result.test
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
