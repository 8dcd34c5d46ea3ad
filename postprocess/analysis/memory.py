"""How long contacts remember, for runs with model = "gluey".

A contact that was pressed with the impulse P stays closed until an equal pull has been paid back. Of each
contact: the largest stored impulse P = -gamma, when it was reached, when the contact came off, the time lag
in between, and P over the lag: the mean pull. Times are those of output, so good to output.interval.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd
from rich.table import Table

from fsi.arrays import Array
from fsi.errors import InputError
from fsi.postprocess.run.run import Run
from fsi.postprocess.run.tables import spread
from fsi.report.console import table

_ROWS = 12


@dataclass(frozen=True, slots=True)
class ContactMemories:
    """Contacts that stored an impulse, and all times of output.

    Attributes:
        contacts: in the order of release: `contact`, its name, "body - side"; `stored`, the largest -gamma;
            `reached`, when that was; `released`, when it came off, infinite if it is closed at the end;
            `lag`, from the one to the other.
        t: the times, (times,).
        closed: the number of contacts that remember, (times,).
    """

    contacts: pd.DataFrame
    t: Array
    closed: Array


def read_memories(run: Run) -> ContactMemories:
    """The contacts of a run; of one that closes again, the last time. Raises InputError."""
    if not (run.path / "contacts.csv").is_file():
        remedy = f'give the folder of a run with model = "gluey", this has "{run.case.model}"'
        raise InputError(f"{run.path / 'contacts.csv'}: is not there; {remedy}")
    t, rows = np.unique(run.bodies["t"]), run.table("contacts")
    rows = rows[rows["gamma"] < 0.0].assign(at=lambda rows: np.searchsorted(t, rows["t"]))
    if rows.empty:
        remedy = "let bodies meet, and write output more often"
        raise InputError(f"{run.path}: no contact remembers anything; {remedy}")
    # Of each contact the stretch since it last had come off.
    contact = rows.groupby(["body", "side"], sort=False).ngroup()
    stretch = (rows.groupby(contact)["at"].diff() > 1).groupby(contact).cumsum()
    last = rows[stretch == stretch.groupby(contact).transform("max")].groupby(contact)
    push = rows.loc[last["gamma"].idxmin()]
    released = np.append(t, np.inf)[last["at"].last() + 1]
    contacts = pd.DataFrame(
        {
            "contact": push["body"].astype(str) + " - " + push["side"].astype(str),
            "stored": -push["gamma"],
            "reached": push["t"],
            "released": released,
            "lag": released - push["t"],
        }
    ).sort_values(["released", "reached"], kind="stable", ignore_index=True)
    return ContactMemories(contacts, t, np.bincount(rows["at"], minlength=len(t)).astype(float))


def memory_table(memory: ContactMemories) -> Table:
    """At most twelve contacts, evenly spread over the order of release."""
    off = memory.contacts[np.isfinite(memory.contacts["released"])]
    shown = off.iloc[spread(len(off), _ROWS)]
    shown = shown.assign(pull=shown["stored"] / shown["lag"])
    rows = ([name, *(f"{x:.4g}" for x in of)] for name, *of in shown.itertuples(index=False))
    numbers = ("stored P", "at t", "released", "lag", "P / lag")
    caption = f"{len(off)} of {len(memory.contacts)} contacts came off by t = {memory.t[-1]:g}"
    title = "what contacts stored, and when they came off"
    return table(("contact",), numbers, rows, title=title, caption=caption)


def memory_data(memory: ContactMemories) -> dict[str, Any]:
    """All contacts; those that are closed at the end have not been released."""
    contacts = memory.contacts.astype(object).replace(np.inf, None).to_dict("records")
    return {"contacts": contacts, "t": memory.t.tolist(), "closed": memory.closed.tolist()}
