"""The quantities that [[expected]] rows, `fsi search` and `fsi sweep` take, by name.

One more number of a flow is one more function here, or anywhere that is imported, which `flow_number` enters:
it takes what a model has computed, or the errors of that, and gives the number. What keys, help and messages
say of it follows. Besides there are the components of bodies, and of a run the time at a gap.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

from fsi.errors import refuse_taken

if TYPE_CHECKING:
    from fsi.case.domains.domain import Domain
    from fsi.integration.state import Measured
    from fsi.levels import ModelLevel
    from fsi.meshes.geometry.container import Container

_TIME_AT_GAP = "time at gap "
_OF_TIME = rf"{_TIME_AT_GAP}(\d+\.?\d*|\.\d+)(e[+-]?\d+)?"
_OF_BODY = r"[\w -]+\.((velocity|force|position|angular_velocity|torque)\.[xyrz]|angular_velocity|torque)"


type OfCase = Callable[[Any], str]  # of a `Case`, whose sections know the numbers, so not the other way round


class Driven(Protocol):
    """What the numbers here ask of it."""

    @property
    def domain(self) -> Domain:
        """The section [domain], with what drives the fluid."""

    @property
    def level(self) -> ModelLevel:
        """What its model has."""

    def container(self) -> Container:
        """What encloses the fluid."""

    def wall_stress(self, t: float) -> Mapping[str, float]:
        """The tangential traction at time t of the walls that it moves."""


@dataclass(frozen=True, slots=True)
class FlowNumber:
    """One entry of the registry.

    Attributes:
        value: of what is computed, or the error of errors; None where there is none.
        whose: which flows have it, "" for all: "of a channel".
        lacking: what a case that has none is told, as "...; remedy"; "" where it has one.
        column: of steps.csv.
        square: whether it goes with the square of what drives the flow.
    """

    value: Callable[[Measured], float | None]
    whose: str
    lacking: OfCase
    column: OfCase
    square: bool


NUMBERS: dict[str, FlowNumber] = {}


def flow_number[F: Callable[[Measured], float | None]](
    name: str,
    whose: str = "",
    *,
    lacking: OfCase = lambda _: "",
    column: OfCase | None = None,
    square: bool = False,
) -> Callable[[F], F]:
    """Enter a number under a name, whose column is the name with _ unless given.

    Raises ValueError: another one has it.
    """

    def enter(value: F) -> F:
        if name in NUMBERS:
            refuse_taken(name, NUMBERS[name].value, value)
        of_name = column or (lambda _: name.replace(" ", "_"))
        NUMBERS[name] = FlowNumber(value, whose, lacking, of_name, square)
        return value

    return enter


@flow_number("dissipation", square=True)
def _dissipation(found: Measured) -> float:
    return found.dissipation


def _without_period(case: Driven) -> str:
    return "" if len(case.container().periods) else "is that of a periodic domain; give another"


@flow_number("apparent viscosity", "of a periodic flow", lacking=_without_period)
def _apparent_viscosity(found: Measured) -> float | None:
    return found.apparent_viscosity


def _without_flux(case: Driven) -> str:
    given = case.domain.mean_drive().net_flux is not None
    return "" if given else "is found in a channel whose flux is given; give domain.net_flux"


@flow_number("pressure gradient", "of a channel whose net flux is given", lacking=_without_flux)
def _pressure_gradient(found: Measured) -> float | None:
    return found.dp_dx


def _without_gradient(case: Driven) -> str:
    if "pressure_gradient" not in case.domain.drives:
        return "is that of a periodic channel; give another"
    if case.domain.mean_drive().net_flux is not None:
        return "is given, as domain.net_flux; take the pressure gradient, or give domain.pressure_gradient"
    return "" if case.level.flow else 'is found in a flow; give model = "resolved" or "pores"'


@flow_number("flux", "of a channel whose mean pressure gradient is given", lacking=_without_gradient)
def _flux(found: Measured) -> float | None:
    return found.flux


def _without_stress(case: Driven) -> str:
    stressed = case.domain.mean_drive().mean_stress is not None
    return "" if stressed else "is found in a cell under a stress; give domain.stress"


@flow_number("shear rate", "of a cell that a stress shears", lacking=_without_stress)
def _shear_rate(found: Measured) -> float | None:
    return found.shear_rate


def _without_stressed_wall(case: Driven) -> str:
    remedy = "give domain.walls.top = { stress = 1.0 }"
    return "" if case.wall_stress(0.0) else f"is found in a channel under a stress; {remedy}"


@flow_number(
    "wall speed",
    "of a wall that a stress moves",
    lacking=_without_stressed_wall,
    column=lambda case: f"speed_{next(iter(case.wall_stress(0.0)))}",
)
def _wall_speed(found: Measured) -> float | None:
    return next(iter(found.wall_speeds.values()), None)


def names_of_numbers() -> str:
    """The names for help and messages, with whose they are: `"dissipation", "flux" (of a channel), ...`."""
    whose = {name: f" ({number.whose})" if number.whose else "" for name, number in NUMBERS.items()}
    return ", ".join(f'"{name}"{of}' for name, of in whose.items())


def names_of_quantities(*, of_run: bool = True) -> str:
    """The same of all quantities, or without those that only a run has."""
    position, time = (", position", f', of a run "{_TIME_AT_GAP}0.1"') if of_run else ("", "")
    of_bodies = (
        f'"BODY.force.x" (by the fluid; velocity{position}; y), "BODY.torque", "BODY.angular_velocity"'
    )
    return f"{names_of_numbers()}, {of_bodies}{time}"


def is_quantity(text: str) -> bool:
    """Whether it names one, of some case."""
    return text in NUMBERS or is_time(text) or re.fullmatch(_OF_BODY, text) is not None


def is_time(quantity: str) -> bool:
    """Whether it is the time at a gap."""
    return re.fullmatch(_OF_TIME, quantity) is not None


def time_at_gap(gap: float) -> str:
    """The name of the time at a gap: `time at gap 0.1`."""
    return f"{_TIME_AT_GAP}{gap:g}"


def gap_of(quantity: str) -> float:
    """The gap in `time at gap 0.1`."""
    return float(quantity.removeprefix(_TIME_AT_GAP))
