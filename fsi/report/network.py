"""What `fsi solve` shows of an instant without a flow, with its network of gaps: a JSON object, or tables.

A force is the one that the FLUID exerts on the body, `-F`, as in `fsi.report.solution`.
"""

from typing import Any, Protocol, runtime_checkable

from rich.console import Console

from fsi.arrays import Array
from fsi.case.case import Case
from fsi.integration.state import Instant
from fsi.reduced.pairs import Pairs
from fsi.report.console import table
from fsi.report.solution import bodies_json, bodies_table

# Of what a step records.
SHOWN = (
    "dissipation", "apparent_viscosity", "lubrication_viscosity", "momentum", "power", "balance", "residual",
)  # fmt: skip


@runtime_checkable
class Networked(Protocol):
    """An instant of a level with laws of gaps: P pairs, D' and lambda of each, (P,)."""

    pairs: Pairs
    rates: Array
    force: Array


def instant_json(case: Case, instant: Instant) -> dict[str, Any]:
    """The object that `fsi solve --json` prints; the force of a contact is positive where the gap opens."""
    bodies, contacts = bodies_json(case, instant.U, instant.F), _contacts(case, instant)
    record = {name: float(value) for name, value in instant.record.items()}
    return {"name": case.name, "bodies": bodies, "contacts": contacts, **record}


def print_instant(console: Console, case: Case, instant: Instant) -> None:
    """The same for a reader: the bodies, their lubricated gaps, one line of numbers."""

    def numbers(i: int, k: int) -> tuple[str, str]:
        return f"{instant.U[i, k]:.8g}", f"{0.0 - instant.F[i, k]:.8g}"

    keys, contacts = ("gap", "rate", "force"), _contacts(case, instant)
    rows = ((*row["between"], *(f"{row[key]:.8g}" for key in keys)) for row in contacts)
    title = "lubricated gaps; forces > 0 where they open"
    gaps = table(("gap between", "and"), ("gap", "its rate", "force"), rows, title=title)
    bodies = bodies_table(case, ("velocity", "force of the fluid"), numbers)
    console.print(bodies, *([gaps] if contacts else []), sep="\n")
    shown = (f"{name} {instant.record[name]:.8g}" for name in SHOWN if name in instant.record)
    console.print("  ".join(shown), highlight=False)


def _contacts(case: Case, instant: Instant) -> list[dict[str, Any]]:
    """Each gap within the reach of its law: its sides, D, D', lambda; none where there are no such laws."""
    if not isinstance(instant, Networked):
        return []
    pairs, sides = instant.pairs, (*case.names, *case.container().walls)
    columns = zip(pairs.i, pairs.j, pairs.gap, instant.rates, instant.force, strict=True)
    return [
        {"between": [sides[i], sides[j]], "gap": float(D), "rate": float(rate), "force": float(force)}
        for i, j, D, rate, force in columns
    ]
