"""What `fsi compare` prints: gaps of all levels, and below which gap the reduced model may be trusted."""

from __future__ import annotations

import numpy as np
from rich.console import Console
from rich.table import Table

from fsi.case.case import Case
from fsi.comparison import LIMITS, PART, RateComparison, Trajectories


def print_trajectories(console: Console, case: Case, paths: Trajectories) -> None:
    """The smallest gap at some times, and the largest differences from the first level."""
    table = Table(title=f"{case.name}: smallest gap", title_justify="left")
    for heading in ("t", *paths.gap):
        table.add_column(heading, justify="right")
    rows = np.linspace(0, len(paths.t) - 1, 13).astype(int)
    for k in rows:
        gaps = (f"{gap[k]:.4e}" for gap in paths.smallest.values())
        table.add_row(f"{paths.t[k]:g}", *gaps, end_section=k == rows[-1])
    table.add_row("sup", *(f"{difference:.1e}" for difference in paths.differences.values()))
    table.caption = f"last line: the largest difference from {next(iter(paths.gap))}, of any body at any time"
    console.print(table)
    if {"resolved", "gluey"} <= set(paths.gap):
        console.print(
            f"delta_eps = {paths.smallest['resolved'].min():.1e}: surfaces rougher than this touch, and the "
            "gluey "
            "model, which remembers the push in a film, makes no sense for them (give gluey.roughness)",
            highlight=False,
        )


def print_rates(console: Console, case: Case, found: RateComparison) -> None:
    """The table of the bodies, and from which gap on the reduced model may be trusted."""
    table = Table("body", title=f"{case.name}: reduced against resolved", title_justify="left")
    for heading in ("largest dV / V", "dV / V at the end", "gap at the end", "reduced", "largest dD / D"):
        table.add_column(heading, justify="right")
    for name, row in zip(case.names, found.bodies(), strict=True):
        table.add_row(
            name,
            f"{row['velocity_difference']:.2g}",
            f"{row['final_velocity_difference']:.2g}",
            f"{row['final_gap']:.4g}",
            f"{row['final_reduced_gap']:.4g}",
            f"{row['gap_difference']:.2g}",
        )
    console.print(table)
    for limit in LIMITS:
        gap = found.good_below(limit)
        where = "at no sampled gap" if gap is None else f"for gaps up to {gap:.3g}"
        console.print(
            f"rate of the gap within {limit:.0%} {where} ({PART:.0%} of the samples)", highlight=False
        )
