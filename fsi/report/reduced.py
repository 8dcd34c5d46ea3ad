"""What `fsi solve` shows of a reduced case; forces on bodies are those of drag and gaps."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from fsi.case.case import Case
from fsi.reduced.model import ReducedInstant
from fsi.report.solution import bodies_json, components


def instant_json(case: Case, found: ReducedInstant) -> dict[str, Any]:
    """The object that `fsi solve --json` prints; the force of a contact is positive where the gap opens."""
    return {
        "name": case.name,
        "bodies": bodies_json(case, found.U, found.F),
        "contacts": _contacts(case, found),
        **{name: float(value) for name, value in found.record.items()},
    }


def print_instant(console: Console, case: Case, found: ReducedInstant) -> None:
    """The same for a reader: the bodies, their lubricated gaps, one line of numbers."""
    table = Table("body", "component", "motion", title=case.name, title_justify="left")
    for heading in ("velocity", "force of the fluid"):
        table.add_column(heading, justify="right")
    held, modes = case.motion(0.0).held, np.flatnonzero(case.modes)
    for i, name in enumerate(case.names):
        for k in modes:
            table.add_row(
                name if k == modes[0] else "",
                components(case)[k],
                "held" if held[i, k] else "free",
                f"{found.U[i, k]:.8g}",
                f"{0.0 - found.F[i, k]:.8g}",
                end_section=bool(k == modes[-1]),
            )
    contacts = Table("gap between", "and", title="lubricated gaps; forces > 0 where they open")
    for heading in ("gap", "its rate", "force"):
        contacts.add_column(heading, justify="right")
    for row in _contacts(case, found):
        numbers = (f"{row[key]:.8g}" for key in ("gap", "rate", "force"))
        contacts.add_row(*row["between"], *numbers)
    console.print(table, contacts, sep="\n")
    console.print(
        "  ".join(f"{name} {value:.8g}" for name, value in _numbers(found).items()), highlight=False
    )


def _numbers(found: ReducedInstant) -> Mapping[str, float]:
    shown = ("dissipation", "lubrication_viscosity", "momentum", "power", "balance", "residual")
    return {name: found.record[name] for name in shown if name in found.record}


def _contacts(case: Case, found: ReducedInstant) -> list[dict[str, Any]]:
    """Each gap within the reach of its law: its sides, D, D', lambda."""
    pairs, sides = found.pairs, (*case.names, *case.container().walls)
    columns = zip(pairs.i, pairs.j, pairs.gap, found.rates, found.force, strict=True)
    return [
        {"between": [sides[i], sides[j]], "gap": float(D), "rate": float(rate), "force": float(force)}
        for i, j, D, rate, force in columns
    ]
