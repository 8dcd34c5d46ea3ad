"""The time schemes by name, and what each is for.

One more scheme is one class: it satisfies `fsi.integration.state.Scheme` and stands under `@register_scheme`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

from fsi.bodies.configuration import Array
from fsi.integration.state import Scheme


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
        make: the scheme for given bodies.
        inertia: "none" of bodies, "some" (those with masses have it) or "all".
        fixed: true where steps have the length `time.step`, false where the stepper chooses.
        models: the levels that it steps.
    """

    name: str
    make: Callable[[Beginning], Scheme]
    inertia: Literal["none", "some", "all"]
    fixed: bool
    models: tuple[str, ...]


SCHEMES: dict[str, SchemeKind] = {}
FLOWS = ("resolved", "reduced")


def register_scheme[T: Callable[[Beginning], Scheme]](
    name: str,
    inertia: Literal["none", "some", "all"] = "none",
    *,
    fixed: bool = False,
    models: tuple[str, ...] = FLOWS,
) -> Callable[[T], T]:
    """Put a scheme into the registry: a class, or a function, that makes it from a `Beginning`."""

    def register(make: T) -> T:
        SCHEMES[name] = SchemeKind(name, make, inertia, fixed, models)
        return make

    return register


def scheme_for(name: str | None, *, inertia: bool) -> SchemeKind:
    """The scheme of that name, or the one that is taken for bodies with or without inertia."""
    return SCHEMES[name or ("ascher-ruuth-spiteri" if inertia else "bogacki-shampine")]
