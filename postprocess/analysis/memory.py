"""How long contacts remember, for runs with model = "gluey": `python -m fsi.postprocess.analysis.memory RUN`.

A contact that was pressed with the impulse P stays closed until an equal pull has been paid back.
Prints, for the contacts in the order of their release, the largest stored impulse P = -gamma, when it
was reached, when the contact came off, the time lag in between, and P over the lag: the mean pull. Draws
all of them, and the number of closed contacts in time, into RUN/memory.png. Times are those of output,
so good to output.interval.
"""

from __future__ import annotations

import csv
import sys
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from rich.table import Table

from fsi.bodies.configuration import Array
from fsi.errors import InputError
from fsi.postprocess.program import program, say

_ROWS = 12


@dataclass(frozen=True, slots=True)
class Memory:
    """Contacts that stored an impulse, shapes (contacts,), in the order of release; and all times of output.

    stored: the largest -gamma; reached, released: when; infinite if it is closed at the end;
    t, closed: times and the number of contacts that remember, (times,).
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


def read_memory(run: Path) -> Memory:
    """The contacts of a run; of one that closes again, the last time. Raises InputError."""
    try:
        with (run / "contacts.csv").open(newline="") as lines:
            rows = [
                (row["side"], row["body"], float(row["t"]), -float(row["gamma"]))
                for row in csv.DictReader(lines)
            ]
        with (run / "bodies.csv").open(newline="") as lines:
            t = np.unique([float(row["t"]) for row in csv.DictReader(lines)])
    except OSError as error:
        raise InputError(f"{error.filename}: {error.strerror}; give the folder of a gluey run") from None
    histories: dict[str, list[tuple[float, float]]] = {}
    closed = np.zeros(len(t))
    for side, body, time, stored in rows:
        if stored > 0.0:
            at = int(np.searchsorted(t, time))
            closed[at] += 1
            history = histories.setdefault(f"{body} - {side}", [])
            if history and t[at - 1] > history[-1][0]:  # it had come off
                history.clear()
            history.append((time, stored))
    if not histories:
        raise InputError(
            f"{run}: no contact remembers anything; let bodies meet, and write output more often"
        )
    peaks = [max(history, key=lambda entry: entry[1]) for history in histories.values()]
    after = np.searchsorted(t, [history[-1][0] for history in histories.values()]) + 1
    released = np.append(t, np.inf)[after]
    order = np.lexsort((np.array([time for time, _ in peaks]), released))
    return Memory(
        tuple(np.array(list(histories))[order].tolist()),
        np.array([stored for _, stored in peaks])[order],
        np.array([time for time, _ in peaks])[order],
        released[order],
        t,
        closed,
    )


def as_table(memory: Memory) -> Table:
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


def plot(memory: Memory, path: Path) -> None:
    """The lag against the stored impulse, and how many contacts are closed. Raises InputError."""
    figure = Figure(figsize=(10.0, 4.2), layout="constrained")
    left, right = figure.subplots(1, 2)
    off = np.isfinite(memory.released)
    left.plot(memory.stored[off], memory.lag[off], "o", color="#0072b2", ms=4, alpha=0.5)
    left.set(
        xlabel=r"stored impulse $P = -\gamma$",
        ylabel="time lag of separation",
        xlim=(0, None),
        ylim=(0, None),
    )
    right.step(memory.t, memory.closed, where="post", color="#d55e00")
    right.set(xlabel="time", ylabel="closed contacts", ylim=(0, None))
    for axes in (left, right):
        axes.spines[["top", "right"]].set_visible(False)
        axes.grid(alpha=0.3)
    try:
        figure.savefig(path, dpi=150)
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}; give a run folder that can be written") from None


def show(run: Path) -> None:
    """Print the table and draw the plot of one run."""
    memory = read_memory(run)
    plot(memory, run / "memory.png")
    say(as_table(memory), f"plot: {run / 'memory.png'}")


main = partial(program, __doc__, show)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
