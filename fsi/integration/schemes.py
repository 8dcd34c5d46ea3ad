"""The time schemes by name, and what each is for; `time.scheme` chooses one.

One more scheme is one class: it satisfies `fsi.integration.state.Scheme` and stands under `@register_scheme`.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar, Literal, get_args

import numpy as np

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration, Inertia
from fsi.errors import refuse_taken
from fsi.integration.adams import Adams
from fsi.integration.state import Instant, Model, Scheme, State, Trial, velocities
from fsi.levels import VISCOUS

type _Inertia = Literal["none", "some", "all"]

_OF_SCHEMES = ("error_order", "start", "step")  # what `Scheme` has


@dataclass(frozen=True, slots=True)
class Beginning:
    """What a scheme learns of the bodies before the first step.

    Attributes:
        masses: m or I of each mode, 0 without inertia, shape (N, M).
        U: the velocity of each mode at time 0, prescribed, given or at rest, shape (N, M).
        rest: a duration that is short against everything.
    """

    masses: Array
    U: Array
    rest: float


@dataclass(frozen=True, slots=True)
class SchemeKind:
    """A scheme in the registry.

    Attributes:
        name: what `time.scheme` calls it.
        order: the power of the step with which its error goes to zero.
        make: the scheme for given bodies; None where a model makes its steps itself.
        inertia: "none" of bodies, "some" (those with masses have it) or "all".
        models: the levels that it steps.
    """

    name: str
    order: int
    make: Callable[[Beginning], Scheme] | None
    inertia: _Inertia
    models: tuple[str, ...]

    @property
    def fixed(self) -> bool:
        """True where steps have the length `time.step`, false where the stepper chooses."""
        return self.make is None


SCHEMES: dict[str, SchemeKind] = {}


def register_scheme[T: Callable[[Beginning], Scheme]](
    name: str, order: int, inertia: _Inertia = "none"
) -> Callable[[T], T]:
    """Put a scheme into the registry: a class, or a function, that makes it from a `Beginning`.

    Raises ValueError: another one has its name, the class is no scheme, or there is no such inertia.
    """

    def register(make: T) -> T:
        if inertia not in (words := get_args(_Inertia.__value__)):
            raise ValueError(f"{name!r}: inertia = {inertia!r} is none of {', '.join(words)}")
        lacking = [part for part in _OF_SCHEMES if isinstance(make, type) and not hasattr(make, part)]
        if lacking:
            raise ValueError(f"{name!r}: {make.__name__} is no scheme, as it lacks {', '.join(lacking)}")
        if name in SCHEMES:
            refuse_taken(name, SCHEMES[name].make or SchemeKind, make)
        SCHEMES[name] = SchemeKind(name, order, make, inertia, VISCOUS)
        return make

    return register


def scheme_for(name: str | None, *, inertia: bool) -> SchemeKind:
    """The scheme of that name, or the one that is taken for bodies with or without inertia."""
    return SCHEMES[name or ("ascher-ruuth-spiteri" if inertia else "bogacki-shampine")]


GAMMA = 1.0 - 1.0 / math.sqrt(2.0)
DELTA = 1.0 - 1.0 / (2.0 * GAMMA)


@register_scheme("ascher-ruuth-spiteri", 2, "some")
@dataclass(frozen=True, slots=True)
class AscherRuuthSpiteri:
    """`q' = U, m U' = F_ext(t) - F(q, U)`: the implicit-explicit Runge-Kutta scheme ARS(2,2,2).

    U. M. Ascher, S. J. Ruuth & R. J. Spiteri, Appl. Numer. Math. 25 (1997) 151, section 2.6.

    Positions take the explicit tableau, velocities the implicit one, in which the resistance is that
    of the stage's configuration: each stage is one linear solve. Order 2, L-stable, stiffly accurate:
    the last stage is the end of the step. Where m = 0 the velocity is the quasi-static one of its
    stage, so that m -> 0 is the motion without inertia.

    At the first instant bodies with mass have the velocity that they begin with, held modes their prescribed
    one, and modes without inertia their quasi-static one. The first step begins with what an implicit Euler
    step, short against everything, leaves of them: narrow films stop bodies faster than steps can follow.

    Attributes:
        beginning: masses, shape (N, M), 0 for modes without inertia; the first velocities; that short time.
    """

    beginning: Beginning
    error_order: ClassVar[int] = 3

    def start(self, model: Model, q: Configuration) -> tuple[Instant, Array]:
        """The instant at time 0, and the velocities with which the first step begins."""
        masses, U = self.beginning.masses, self.beginning.U
        instant = model(q, 0.0, Inertia(np.where(masses > 0.0, np.inf, 0.0), U))
        if not masses.any():
            return instant, velocities(instant)
        return instant, velocities(model(q, 0.0, Inertia(masses / self.beginning.rest, U)))

    def step(self, model: Model, state: State, t_end: float) -> Trial:
        """One step; the error is the difference of the displacement from the trapezoidal rule's.

        The rule is that of displacements since the step began, whose rate in space is not the velocity.
        """
        t, q, U = state.t, state.q, state.U
        h = t_end - t
        D = self.beginning.masses / (GAMMA * h)
        U1 = velocities(model(q.moved(GAMMA * h * U), t + GAMMA * h, Inertia(D, U[: len(D)])))
        # Each stage leaves h m^-1 (F_ext - F) = (U_i - U0_i) / gamma.
        U0 = U + (1.0 - GAMMA) / GAMMA * (U1 - U)
        displacement = h * (DELTA * U + (1.0 - DELTA) * U1)
        q_end = q.moved(displacement)
        instant = model(q_end, t_end, Inertia(D, U0[: len(D)]))
        return Trial(q_end, instant, displacement - h / 2 * (U + q.rates(displacement, velocities(instant))))


@dataclass(frozen=True, slots=True)
class BogackiShampine:
    """`q' = U(q, t)`: the embedded Runge-Kutta pair 3(2).

    P. Bogacki & L. F. Shampine, A 3(2) pair of Runge-Kutta formulas, Appl. Math. Lett. 2 (1989) 321.

    The last stage lies at the end of the step: it is the instant recorded there and the first stage
    of the next step. Order 3; the difference of its two members is of order h^3. Stages are rates of the
    displacement since the step began, which in space, where turns do not commute, are not the velocities
    (Runge-Kutta-Munthe-Kaas).
    """

    error_order: ClassVar[int] = 3

    def start(self, model: Model, q: Configuration) -> tuple[Instant, Array]:
        """The instant at time 0, and its velocities."""
        instant = model(q, 0.0)
        return instant, velocities(instant)

    def step(self, model: Model, state: State, t_end: float) -> Trial:
        """One step; the error is the difference of the two members of the pair."""
        t, q, U1 = state.t, state.q, state.U
        h = t_end - t
        U2 = _rates(model, q, h / 2 * U1, t + h / 2)
        U3 = _rates(model, q, 3 * h / 4 * U2, t + 3 * h / 4)
        displacement = h * (2 / 9 * U1 + 1 / 3 * U2 + 4 / 9 * U3)
        q_end = q.moved(displacement)
        instant = model(q_end, t_end)
        U4 = q.rates(displacement, velocities(instant))
        return Trial(q_end, instant, h * (-5 / 72 * U1 + 1 / 12 * U2 + 1 / 9 * U3 - 1 / 8 * U4))


def _rates(model: Model, q: Configuration, displacement: Array, t: float) -> Array:
    """Of displacements from q, (N, M), after those."""
    return q.rates(displacement, velocities(model(q.moved(displacement), t)))


register_scheme("bogacki-shampine", 3)(lambda _: BogackiShampine())
register_scheme("adams", 3)(lambda _: Adams())

# Their pairs remember gaps, which only the model can step: `fsi.reduced.distance_stepper`.
for _name in ("backward-euler", "distance"):
    SCHEMES[_name] = SchemeKind(_name, 1, None, "all", ("reduced",))
