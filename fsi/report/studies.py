"""What the studies print: `fsi compare`, `fsi limit`, `fsi calibrate`, `fsi validate`."""

from collections.abc import Mapping, Sequence

import numpy as np
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table
from rich.text import Text

from fsi.calibration.result import CalibrationResult, HeldOut
from fsi.case.case import Case
from fsi.comparison.instants import LevelAtInstant
from fsi.comparison.motion import LIMITS, PART, RateComparison, Trajectories
from fsi.comparison.viscosity import AGREE, ViscosityHistories
from fsi.gluey.limit_study import Study
from fsi.lubrication.expansions import EXPONENTS
from fsi.report.console import table
from fsi.studies.search import KeyTrial
from fsi.validation.rows import Record, Row, sphere_records


def print_trajectories(console: Console, case: Case, paths: Trajectories) -> None:
    """The smallest gap at some times, and the largest differences from the first level."""
    caption = f"last line: the largest difference from {next(iter(paths.gap))}, of any body at any time"
    title = f"{case.name}: smallest gap"
    shown = table((), ("t", *paths.gap), title=title, title_justify="left", caption=caption)
    for k in np.linspace(0, len(paths.t) - 1, 13).astype(int):
        shown.add_row(f"{paths.t[k]:g}", *(f"{gap[k]:.4e}" for gap in paths.smallest.values()))
    shown.add_section()
    shown.add_row("sup", *(f"{difference:.1e}" for difference in paths.differences.values()))
    console.print(shown)
    if {"resolved", "gluey"} <= set(paths.gap):
        touch = f"delta_eps = {paths.smallest['resolved'].min():.1e}: surfaces rougher than this touch"
        memory = "the gluey model, which remembers the push in a film, makes no sense for them"
        console.print(f"{touch}, and {memory} (give gluey.roughness)", highlight=False)


def print_viscosities(console: Console, case: Case, found: ViscosityHistories) -> None:
    """The apparent viscosity at some times, the largest differences, and until when the levels agree."""
    first = next(iter(found.mu))
    caption = f"off: the largest difference from {first}; until: the time up to which it is below {AGREE:.0%}"
    title = f"{case.name}: apparent viscosity"
    shown = table((), ("t", *found.mu), title=title, title_justify="left", caption=caption)
    for k in np.linspace(0, len(found.t) - 1, 13).astype(int):
        shown.add_row(f"{found.t[k]:g}", *(f"{mu[k]:.6g}" for mu in found.mu.values()))
    shown.add_section()
    shown.add_row("off", *(f"{np.abs(off).max():.2%}" for off in found.differences.values()))
    shown.add_row("until", *(f"{t:.4g}" for t in found.agree_until.values()))
    console.print(shown)


def print_instants(console: Console, case: Case, found: Mapping[str, LevelAtInstant]) -> None:
    """A row for each level: the apparent viscosity, and the errors in per cent."""
    title = f"{case.name}: per cent from {next(iter(found))}, at time 0"
    columns = ("mu_app/mu", "viscosity", "velocities", "spins", "gap rates", "CPU s")
    caption = "velocities less the mean flow; rates of the narrowest gaps, as many as bodies"
    shown = table(("level",), columns, title=title, title_justify="left", caption=caption)
    for level, row in found.items():
        mu = "" if row.apparent_viscosity is None else f"{row.apparent_viscosity:.6g}"
        viscosity = "" if row.viscosity is None else f"{100.0 * row.viscosity:+.3g}"
        others = ("" if x is None else f"{100.0 * x:.3g}" for x in (row.velocities, row.spins, row.gap_rates))
        shown.add_row(level, mu, viscosity, *others, f"{row.seconds:.2g}")
    console.print(shown)


def print_search(console: Console, key: str, quantity: str, trials: Sequence[KeyTrial]) -> None:
    """All trials, by the value of the key; the one that was found is the last."""
    rows = [
        (f"{trial.value:.12g}", f"{trial.quantity:.8g}", "" if trial.error is None else f"{trial.error:.0e}")
        for trial in sorted(trials, key=lambda trial: trial.value)
    ]
    console.print(table((), (key, quantity, "±"), rows))
    last = trials[-1]
    bar = "" if last.error is None else f" ± {last.error:.0e}"
    console.print(f"{key} = {last.value!r}: {quantity} {last.quantity:.8g}{bar}", highlight=False)


def print_rates(console: Console, case: Case, found: RateComparison) -> None:
    """The table of the bodies, and from which gap on the reduced model may be trusted."""
    columns = {
        "largest dV / V": ("velocity_difference", ".2g"),
        "dV / V at the end": ("final_velocity_difference", ".2g"),
        "gap at the end": ("final_gap", ".4g"),
        "reduced": ("final_reduced_gap", ".4g"),
        "largest dD / D": ("gap_difference", ".2g"),
    }
    title = f"{case.name}: reduced against resolved"
    end = found.t[found.common][-1]
    ends = "" if found.common.all() else f"gaps until t = {end:.6g}, where the reduced run ends"
    shown = table(("body",), tuple(columns), title=title, title_justify="left", caption=ends or None)
    for name, row in zip(case.names, found.bodies(), strict=True):
        shown.add_row(name, *(format(row[key], digits) for key, digits in columns.values()))
    console.print(shown)
    for limit in LIMITS:
        gap = found.good_below(limit)
        where = "at no sampled gap" if gap is None else f"for gaps up to {gap:.3g}"
        text = f"rate of the gap within {limit:.0%} {where} ({PART:.0%} of the samples)"
        console.print(text, highlight=False)


def print_study(console: Console, study: Study) -> None:
    """When it sticks, the errors for each eps, those of the scheme for each number of steps."""
    for begin, end in study.contacts:
        until = f"is released at t = {end:.12g}" if np.isfinite(end) else "is not released"
        console.print(f"sticks at t = {begin:.12g}, {until}", highlight=False)
    shown = table(("eps", "sup |q_eps - q|", "over eps", "mean |gamma_eps - gamma|"), ())
    for eps, in_q, in_gamma in zip(study.wanted.eps, study.errors_q, study.errors_gamma, strict=True):
        given = np.format_float_scientific(eps, precision=4, trim="-", exp_digits=2)
        shown.add_row(given, f"{in_q:.3e}", f"{in_q / eps:#.4g}", f"{in_gamma:.3e}")
    console.print(shown)
    shown = table(("steps", "max |q_h - q|", "order"), ())
    before: tuple[int, float] | None = None
    for steps, error in zip(study.wanted.steps, study.scheme, strict=True):
        order = np.log(before[1] / error) / np.log(steps / before[0]) if before and error > 0.0 else np.nan
        shown.add_row(str(steps), f"{error:.3e}", "" if np.isnan(order) else f"{order:.3f}")
        before = (steps, error)
    console.print(shown)


def print_calibration(console: Console, result: CalibrationResult) -> None:
    """The coefficients against theory, the leading exponent, and the test by held-out samples."""
    pair, a = result.pair, result.pair.reduced_radius
    exponent = EXPONENTS[pair.shape, pair.plan.mode]
    law = f"kappa = mu a_r^{exponent} sum c phi(s), s = d/a_r, a_r = {a:g}"
    console.print(f"{pair.case.name}: {pair.plan.mode} of {pair.shape}, {law}", soft_wrap=True)
    if result.coefficients:
        console.print(_coefficients_table(result))
    for line in lines(result):
        console.print(line, soft_wrap=True)


def _verdict(good: str, bad: str, *, holds: bool) -> Text:
    """A word, green or red on a terminal."""
    return Text(good, style="green") if holds else Text(bad, style="red")


def _coefficients_table(result: CalibrationResult) -> Table:
    shown = table(("phi(s)",), ("c", "± 95 %", "theory", "difference"), box=SIMPLE_HEAD, padding=(0, 1))
    shown.add_column("")
    for one in result.coefficients:
        row: list[str | Text] = [one.term, f"{one.value:.8g}", f"{one.interval:.1e}"]
        if one.theory is not None and one.difference is not None:
            verdict = _verdict("inside", "OUTSIDE", holds=bool(one.inside))
            row += [f"{one.theory:.8g}", f"{one.difference:+.1e}", verdict]
        shown.add_row(*row)
    return shown


def lines(result: CalibrationResult) -> list[str]:
    """What is to be said besides the coefficients."""
    smallest, largest = result.law.law().range
    said = [f"law from s = {smallest:.3g} to {largest:.3g}"]
    fit, test = result.fit, result.test
    if fit is not None:
        used = f"{fit.used.sum()} of {len(fit.used)} samples are used,"
        agree = "which agree with it" if fit.agrees else "which do NOT agree with it"
        said[0] += f": {used} {agree}, chi^2 = {fit.chi2:.2g} for {fit.dof} degrees of freedom"
        if (first := result.leading) is not None:
            said.append(
                f"leading term: ({first.coefficient:.6g} ± {first.coefficient_interval:.1e}) mu "
                f"d^-({first.exponent:.6f} ± {first.exponent_interval:.1e}), 95 % intervals"
            )
        elif not np.isnan(fit.exponent):
            width = fit.exponent_interval
            said.append(f"leading exponent, if free: {fit.exponent:.6f} ± {width:.1e}, 95 % interval")
    if (widest := result.widest_band) is not None:
        gap, part = widest
        said.append(
            f"law known to ± {part:.1e} of itself over its range, 95 % interval, worst at the gap {gap:.2g}"
        )
    if test is not None:
        count, inside = sum(sample.held_out for sample in result.samples), len(test.law)
        held = (
            f"{count} samples held out"
            if inside == count
            else f"{inside} of {count} held out are in its range"
        )
        said.append(f"{held}: law off by at most {test.error:.1e}, {_stated(test)}")
    if instead := sum(sample.mesh_instead for sample in result.samples):
        said.append(
            f"the sizes of the case gave {instead} samples no valid mesh; see mesh_instead in samples.csv"
        )
    return said


def _stated(test: HeldOut) -> str:
    """What a law says itself of the error that was found."""
    if test.band is None:
        return "which is all that is known of the error of a table"
    stated = np.max((test.band + test.samples.bars) / test.samples.kappa)
    return (
        f"{'within' if test.passed else 'NOT within'} the errors stated at these gaps (at most {stated:.1e})"
    )


WIDTH = 100  # below it the numbers would be folded


def print_errors(console: Console, rows: Sequence[Row]) -> None:
    """One line as soon as a case is computed."""
    worst = max(row.true_error for row in rows)
    console.print(f"{rows[0].case}: gap/a {rows[0].gap:.3g}, error {worst:.1e}", highlight=False)


def print_rows(console: Console, rows: Sequence[Row]) -> None:
    """The table of all rows, the sphere's, and what they come to."""
    console.width = max(console.width, WIDTH)
    console.print(_rows_table(rows))
    for case in dict.fromkeys(row.case for row in rows):
        console.print(*dict.fromkeys(f"{case}: {row.source}" for row in rows if row.case == case), sep="\n")
    for row in rows:
        if row.failure:
            console.print(f"{row.case}: {row.failure}", style="red")
    records = sphere_records(rows)
    if records:
        console.print(_sphere_table(records))
    console.print(summary(rows))


def summary(rows: Sequence[Row]) -> str:
    """How many rows pass, and how many error bars hold."""
    passed = sum(row.passed for row in rows)
    known = [row.bar_holds for row in rows if row.bar_holds is not None and not row.failure]
    text = f"{passed} of {len(rows)} rows pass; "
    if known:
        part = f"{sum(known)} of {len(known)} error bars ({100.0 * sum(known) / len(known):.0f} %)"
        text += f"{part} bracket the true error and are within a factor 10 of it"
    unknown = len(rows) - len(known) - sum(bool(row.failure) for row in rows)
    return text + (f"; {unknown} more agree to all digits of the reference" if unknown else "")


def _sphere_table(records: Sequence[Record]) -> Table:
    case, *numbers = records[0]
    title = "a sphere and a plane: the resolved force over 6 pi mu a U (a/q + ln(a/q)/5 + 0.97128)"
    shown = table((case,), numbers, title=title)
    for record in records:
        shown.add_row(*(f"{x:.8g}" if isinstance(x, float) else str(x) for x in record.values()))
    return shown


def _rows_table(rows: Sequence[Row]) -> Table:
    numbers = ("gap/a", "resolved", "± est.", "reference", "true", "rtol")
    zeros = ", of zeros to the largest load or velocity" if any(row.reference == 0.0 for row in rows) else ""
    title = f"validation; errors are relative to the reference{zeros}"
    shown = table(("case, quantity",), numbers, title=title, box=SIMPLE_HEAD, padding=(0, 1))
    shown.add_column("")
    previous = ""
    for row in rows:
        if row.case != previous:
            if previous:
                shown.add_section()
            shown.add_row(Text(row.case, style="bold"))
            previous = row.case
        shown.add_row(
            f"  {row.quantity}",
            f"{row.gap:.6g}",
            f"{row.value:.10g}",
            f"{row.error_bar:.1e}",
            f"{row.reference:.10g}",
            f"{row.true_error:.1e}" if row.true_error > row.digits else f"< {row.digits:.0e}",
            f"{row.rtol:.0e}",
            _verdict("ok", "FAIL", holds=row.passed),
        )
    return shown
