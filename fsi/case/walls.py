"""What holds at the walls of a domain: a velocity, or a traction.

One more flow on a wall is one more section here, under `@register_wall`: its `velocity_at` says u_0 and G of
`u = u_0 + G x`, which is all that others ask.
"""

from collections.abc import Sequence
from typing import Annotated, Any, ClassVar, Literal, override

import numpy as np
from pydantic import (
    BeforeValidator,
    ConfigDict,
    Discriminator,
    RootModel,
    SerializeAsAny,
    Tag,
    ValidationInfo,
)
from pydantic_core import PydanticCustomError

from fsi.case.section import Positive, Section, hint_of_own, nearest_word
from fsi.case.series import Series, Table, kinks, value_at
from fsi.case.wall_velocity import WallVelocity
from fsi.errors import refuse_taken


class WallCondition:
    """What holds at a wall; here, what most conditions answer.

    form: what a case file has at such a wall, as messages say it.
    """

    form: ClassVar[str]

    @property
    def outside_pressure(self) -> float | None:
        """That of an open wall; None where the velocity is given instead."""
        return None

    @property
    def slip(self) -> float:
        """The slip length, 0 where fluid sticks to the wall."""
        return 0.0

    def velocity_at(self, t: float, dimension: int) -> WallVelocity | None:  # noqa: ARG002
        """The velocity at time t; None where the traction is given instead."""
        return None

    def resting(self, dimension: int) -> "WallCondition":
        """The same wall at rest; an open wall as it is."""
        return self if self.outside_pressure is not None else Velocity((0.0,) * dimension)

    def series(self) -> tuple[float | Table, ...]:
        """What may depend on time."""
        return ()

    def kinks(self) -> set[float]:
        """The times at which the velocity has a kink."""
        return {time for part in self.series() for time in kinks(part)}

    def shear_stress(self, t: float) -> float | None:  # noqa: ARG002
        """The tangential traction of the wall on the fluid, along x; None where its velocity is given."""
        return None

    def components(self, dimension: int) -> tuple[Any, ...]:
        """The components of a velocity that is given by them; else as many as there should be."""
        return (None,) * dimension

    @property
    def rests(self) -> bool:
        """Whether its velocity is zero at all times."""
        return all(v is not None and v.is_zero for v in self._at_kinks())

    def suits_axis(self, *, along: bool) -> bool:
        """Whether it is symmetric about the axis, at a wall along that or across it."""
        velocities = [v for v in self._at_kinks() if v is not None]
        return all(v.about_axis and (along or not v.velocity[0]) for v in velocities)

    def _at_kinks(self) -> list[WallVelocity | None]:
        """The velocity when it may be extreme: between its kinks it is linear in time."""
        return [self.velocity_at(t, 2) for t in self.kinks() or {0.0}]


class Open(RootModel[Any], WallCondition):
    """An open wall without traction, as the word `open`."""

    root: Literal["open"]

    form: ClassVar[str] = '"open"'
    model_config = ConfigDict(defer_build=True)

    @property
    @override
    def outside_pressure(self) -> float:
        return 0.0


class Velocity(RootModel[Any], WallCondition):
    """A wall that moves at a velocity, as a list of its components."""

    root: tuple[Series, ...]

    form: ClassVar[str] = "its velocity [u_x, u_y] (in space [u_x, u_y, u_z])"
    model_config = ConfigDict(defer_build=True, frozen=True, strict=True, allow_inf_nan=False)

    @override
    def velocity_at(self, t: float, dimension: int) -> WallVelocity:
        return WallVelocity.uniform([value_at(component, t) for component in self.root])

    @override
    def series(self) -> tuple[float | Table, ...]:
        return self.root

    @override
    def components(self, dimension: int) -> tuple[Any, ...]:
        return self.root


class WallSection(Section, WallCondition):
    """A condition that a table gives; its keys tell which."""

    @classmethod
    @override
    def alternatives(cls) -> Sequence[type[Section]]:
        return list(dict.fromkeys(_SECTIONS.values()))


_SECTIONS: dict[str, type[WallSection]] = {}  # by their keys


def register_wall[T: WallSection](section: type[T]) -> type[T]:
    """Take up a condition, in place of the same one where that is loaded anew; a decorator.

    Raises ValueError: another one has a key of it.
    """
    for key in section.model_fields:
        refuse_taken(key, _SECTIONS.get(key, section), section)
    _SECTIONS.update(dict.fromkeys(section.model_fields, section))
    return section


def wall_forms() -> str:
    """What may stand at a wall, as messages list it."""
    kinds: list[type[WallCondition]] = [Velocity, Open, *_SECTIONS.values()]
    *most, last = dict.fromkeys(kind.form for kind in kinds)
    return f"{', '.join(most)} or {last}"


@register_wall
class Pressure(WallSection):
    """An open wall: the traction there is `sigma n = -pressure n`."""

    form: ClassVar[str] = "{pressure = p}"
    pressure: float
    """the pressure outside an open wall, a number"""

    @property
    @override
    def outside_pressure(self) -> float:
        return self.pressure


@register_wall
class Shear(WallSection):
    """A wall on which the fluid has the shear flow `u = shear y e_x`, in space `shear z e_x`."""

    form: ClassVar[str] = "{shear = rate}"
    shear: float
    """the shear rate of the flow u_x = shear y (in space shear z), a number"""

    @override
    def velocity_at(self, t: float, dimension: int) -> WallVelocity:
        gradient = np.zeros((dimension, dimension))
        gradient[0, -1] = self.shear
        return WallVelocity(np.zeros(dimension), gradient)


@register_wall
class Stress(WallSection):
    """A wall of a channel that a shear stress moves along itself; how fast is a result."""

    form: ClassVar[str] = "{stress = force over length} of a channel"
    stress: Series
    """the force of a wall of a channel on the fluid along x, over its length (in space its area), a series"""

    @override
    def shear_stress(self, t: float) -> float:
        return value_at(self.stress, t)

    @override
    def series(self) -> tuple[float | Table, ...]:
        return (self.stress,)


@register_wall
class SlidingWall(WallSection):
    """A wall along which fluid slides, and which may move itself."""

    form: ClassVar[str] = "{slip_length = b, velocity = [u_x, u_y]}"
    slip_length: Positive
    """the slip length of a wall along which fluid slides, a number > 0"""
    velocity: tuple[Series, ...] | None = None
    """the velocity of such a wall, two components (in space three); at rest if not given"""

    @property
    @override
    def slip(self) -> float:
        return self.slip_length

    @override
    def velocity_at(self, t: float, dimension: int) -> WallVelocity:
        given = self.velocity or (0.0,) * dimension
        return WallVelocity.uniform([value_at(component, t) for component in given])

    @override
    def series(self) -> tuple[float | Table, ...]:
        return self.velocity or ()

    @override
    def components(self, dimension: int) -> tuple[Any, ...]:
        return self.velocity or super().components(dimension)

    @override
    def resting(self, dimension: int) -> "WallCondition":
        return self.model_copy(update={"velocity": None})


def _read(value: Any, info: ValidationInfo) -> Any:
    """The section whose key a table has first, or one that it looks like; a section as it is.

    Raises pydantic's error for a key that looks like none.
    """
    if not isinstance(value, dict):
        return value
    first = str(next(iter(value), "pressure"))
    if own := hint_of_own(first, _SECTIONS):
        context = {"key": first, "remedy": f"give {wall_forms()}{own}"}
        raise PydanticCustomError("unknown_word", "no such condition", context)
    section = _SECTIONS[nearest_word(first, _SECTIONS)]
    return section.model_validate(value, context=info.context)


def _kind(value: Any) -> str:
    match value:
        case dict() | WallSection():
            return "<table>"
        case str() | Open():
            return "<word>"
        case _:
            return "<velocity>"


Wall = Annotated[
    Annotated[Open, Tag("<word>")]
    | Annotated[Velocity, Tag("<velocity>")]
    | Annotated[SerializeAsAny[WallSection], BeforeValidator(_read), Tag("<table>")],
    Discriminator(_kind),
]
