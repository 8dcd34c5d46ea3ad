"""How long contacts remember, for runs with model = "gluey".

A contact that was pressed with the impulse P stays closed until an equal pull has been paid back. Of each
contact: the largest stored impulse P = -gamma, when it was reached, when the contact came off, the time lag
in between, and P over the lag: the mean pull. Times are those of output, so good to output.interval.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from rich.table import Table

from fsi.bodies.configuration import Array
from fsi.errors import InputError
from fsi.postprocess.run.run import Run

_ROWS = 12


@dataclass(frozen=True, slots=True)
class ContactMemories:
    """Contacts that stored an impulse, in the order of release, and all times of output.

    Attributes:
        names: of the contacts, "body - side".
        stored: the largest -gamma of each, (contacts,).
        reached: when that was.
        released: when the contact came off; infinite if it is closed at the end.
        t: the times, (times,).
        closed: the number of contacts that remember, (times,).
    """

    names: tuple[str, ...]
    stored: Array
    reached: Array
    released: Array
    t: Array
    closed: Array

    @property
    def lag(self) -> Array:
        """From the largest push to the release."""
        return self.released - self.reached


def read_memories(run: Run) -> ContactMemories:
    """The contacts of a run; of one that closes again, the last time. Raises InputError."""
    if not (run.path / "contacts.csv").is_file():
        raise InputError(
            f"{run.path / 'contacts.csv'}: No such file or directory; give the folder of a gluey run"
        )
    t, rows = np.unique(run.bodies["t"]), run.table("contacts")
    rows = rows[rows["gamma"] < 0.0].assign(at=lambda rows: np.searchsorted(t, rows["t"]))
    if rows.empty:
        raise InputError(
            f"{run.path}: no contact remembers anything; let bodies meet, and write output more often"
        )
    # Of each contact the stretch since it last had come off.
    contact = rows.groupby(["body", "side"], sort=False).ngroup()
    stretch = (rows.groupby(contact)["at"].diff() > 1).groupby(contact).cumsum()
    last = rows[stretch == stretch.groupby(contact).transform("max")].groupby(contact)
    push = rows.loc[last["gamma"].idxmin()]
    released = np.append(t, np.inf)[last["at"].last() + 1]
    order = np.lexsort((push["t"], released))
    push = push.iloc[order]
    return ContactMemories(
        tuple(f"{body} - {side}" for body, side in zip(push["body"], push["side"], strict=True)),
        -push["gamma"].to_numpy(),
        push["t"].to_numpy(),
        released[order],
        t,
        np.bincount(rows["at"], minlength=len(t)).astype(float),
    )


def memory_table(memory: ContactMemories) -> Table:
    """At most twelve contacts, evenly spread over the order of release."""
    table = Table(title="what contacts stored, and when they came off")
    for heading in ("contact", "stored P", "at t", "released", "lag", "P / lag"):
        table.add_column(heading, justify="left" if heading == "contact" else "right")
    off = np.flatnonzero(np.isfinite(memory.released))
    for k in off[np.unique(np.linspace(0, len(off) - 1, _ROWS).astype(int))] if len(off) else ():
        numbers = memory.stored[k], memory.reached[k], memory.released[k], memory.lag[k]
        table.add_row(memory.names[k], *(f"{x:.4g}" for x in (*numbers, memory.stored[k] / memory.lag[k])))
    table.caption = f"{len(off)} of {len(memory.names)} contacts came off by t = {memory.t[-1]:g}"
    return table


def memory_data(memory: ContactMemories) -> dict[str, Any]:
    """All contacts; those that are closed at the end have not been released."""
    columns = zip(memory.names, memory.stored, memory.reached, memory.released, strict=True)
    contacts = [
        {"contact": name, "stored": P, "reached": t, "released": end if np.isfinite(end) else None}
        for name, P, t, end in columns
    ]
    return {"contacts": contacts, "t": memory.t.tolist(), "closed": memory.closed.tolist()}
