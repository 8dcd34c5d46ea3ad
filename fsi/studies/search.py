"""For which value of a key a quantity of a case has a given value: `fsi search`.

Whole numbers (seeds, counts) are tried one by one. Between two numbers the quantity is first looked at in
ever smaller parts of the interval until two neighbours have the target between them, then Brent's method
closes in on it (Brent 1973, Algorithms for Minimization without Derivatives, chapter 4). Where it closes in
on a jump over the target other neighbours are looked at.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
import scipy  # its modules load when they are used

from fsi.case.case import Case
from fsi.errors import InputError
from fsi.studies.evaluate import at_instant

PARTS = 16  # of an interval, at most, to find two neighbours with the target between them
XTOL = 1e-12  # of the interval: between neighbours nearer than that the quantity jumps over the target
RTOL = 4.0 * np.finfo(float).eps  # of the key, the least that Brent's method takes
JUMPS = 4  # over the target, at most, before the search ends: each costs some forty trials


@dataclass(frozen=True, slots=True)
class KeyTrial:
    """A value of the key, the quantity there, and its error bar where it has one."""

    value: float
    quantity: float
    error: float | None = None


type Pair = tuple[KeyTrial, KeyTrial]


@dataclass(frozen=True)
class Search:
    """What is looked for, and what has been tried.

    Attributes:
        key: of the case.
        low, high: its interval; whole numbers where both are.
        target: the value that the quantity shall have.
        tolerance: by how much it may differ.
        evaluate: the quantity of the case for a value of the key, collective.
        trials: in their order.
    """

    key: str
    low: float
    high: float
    target: float
    tolerance: float
    evaluate: Callable[[float], KeyTrial]
    trials: list[KeyTrial] = field(default_factory=list)

    def trying(self) -> Iterator[KeyTrial]:
        """Trial after trial, until one has the target or none is left."""
        for trial in self._one_by_one() if self._whole else self._between():
            yield trial
            if self._hits(trial):
                return

    def found(self) -> KeyTrial:
        """The last trial. Raises InputError: it has not the target; the message says why, by all trials."""
        if self._hits(self.trials[-1]):
            return self.trials[-1]
        where = f"not reached for {self.key} from {self.low:g} to {self.high:g}, where the quantity"
        raise InputError(f"--target {self.target:g}: {where} {self._passing_by()}")

    def _passing_by(self) -> str:
        """How the quantity misses the target, and what helps."""
        quantities, trials = [trial.quantity for trial in self.trials], f"in {len(self.trials)} trials"
        if not min(quantities) < self.target < max(quantities):
            reached = f"goes from {min(quantities):.6g} to {max(quantities):.6g} {trials}"
            return f"{reached}; give a target between them or another interval"
        if self._whole:
            nearest = min(self.trials, key=lambda trial: abs(trial.quantity - self.target))
            there = f"{nearest.quantity:.6g} at {self.key} = {nearest.value:g}"
            return f"comes to {there} {trials} and no nearer; give fewer digits or another interval"
        jumps, _ = self._crossings()
        one, other = min(jumps, key=lambda pair: abs(pair[1].quantity - pair[0].quantity))
        jump = f"from {one.quantity:.6g} to {other.quantity:.6g} at {self.key} = {other.value:.9g}"
        return (
            f"jumps over it, {jump}, {trials}; give a target outside of the jump, fewer digits or another "
            "interval; for random bodies also another seed, or more of them, which jump less"
        )

    @property
    def _whole(self) -> bool:
        return isinstance(self.low, int) and isinstance(self.high, int)

    def _hits(self, trial: KeyTrial) -> bool:
        return abs(trial.quantity - self.target) <= self.tolerance

    def _try(self, value: float) -> KeyTrial:
        self.trials.append(self.evaluate(value))
        return self.trials[-1]

    def _one_by_one(self) -> Iterator[KeyTrial]:
        return (self._try(value) for value in range(int(self.low), int(self.high) + 1))

    def _between(self) -> Iterator[KeyTrial]:
        """Ends, halves, quarters, and on; wherever the target lies between neighbours, towards it."""
        parts = 1
        while parts <= PARTS:
            tried = {trial.value for trial in self.trials}
            for value in np.linspace(self.low, self.high, parts + 1).tolist():
                if value not in tried:
                    yield self._try(value)
            while (pair := self._open()) is not None:
                yield self._closed_in(*pair)
            parts *= 2

    def _crossings(self) -> tuple[list[Pair], list[Pair]]:
        """Neighbours with the target between them: at jumps, and those that are farther apart."""
        nearest = XTOL * (self.high - self.low) + RTOL * max(abs(self.low), abs(self.high))
        jumps, apart = list[Pair](), list[Pair]()
        for one, other in pairwise(sorted(self.trials, key=lambda trial: trial.value)):
            if (one.quantity < self.target) != (other.quantity < self.target):
                (jumps if other.value - one.value <= nearest else apart).append((one, other))
        return jumps, apart

    def _open(self) -> Pair | None:
        """Those to look between: the farthest apart; None where all are at jumps, or enough."""
        jumps, apart = self._crossings()
        if not apart or len(jumps) >= JUMPS:
            return None
        return max(apart, key=lambda pair: pair[1].value - pair[0].value)

    def _closed_in(self, one: KeyTrial, other: KeyTrial) -> KeyTrial:
        """The last trial of Brent's method between two."""
        known = {one.value: one, other.value: other}

        def off(value: float) -> float:
            trial = known[value] if value in known else self._try(value)
            return 0.0 if self._hits(trial) else trial.quantity - self.target

        scipy.optimize.brentq(off, one.value, other.value, xtol=XTOL * (self.high - self.low), rtol=RTOL)
        return self.trials[-1]


def most_trials(low: float, high: float) -> int:
    """How many there may be: all whole numbers, or those of the parts; towards the target some more."""
    return int(high - low) + 1 if isinstance(low, int) else PARTS + 1


def trial_of(case: Case, value: float, quantity: str) -> KeyTrial:
    """The quantity of a case at time 0, without inertia, the same on all ranks; collective."""
    found = at_instant(case, [quantity])[quantity]
    return KeyTrial(value, found.value, found.error)
