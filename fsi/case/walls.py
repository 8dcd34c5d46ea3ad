"""What holds at the walls of a domain: a velocity, or a traction."""

from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Literal, override

import numpy as np
from pydantic import ConfigDict, Discriminator, RootModel, Tag

from fsi.arrays import Array
from fsi.case.section import Positive, Section, nearest_word
from fsi.case.series import Series, Table, kinks, value_at


@dataclass(frozen=True, slots=True)
class WallVelocity:
    """The velocity of the fluid at a wall, `u = velocity + shear h e_x`.

    Attributes:
        velocity: shape (d,).
        shear: the rate; h is the last coordinate, y in the plane and z in space.
    """

    velocity: Array
    shear: float


class WallCondition:
    """What holds at a wall; here, what most conditions answer."""

    tag: ClassVar[str]

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
        return all(v is not None and not v.shear and not v.velocity.any() for v in self._at_kinks())

    def suits_axis(self, *, along: bool) -> bool:
        """Whether it is symmetric about the axis, at a wall along that or across it."""
        velocities = [v for v in self._at_kinks() if v is not None]
        return not any(v.shear or (v.velocity[0] and not along) for v in velocities)

    def _at_kinks(self) -> list[WallVelocity | None]:
        """The velocity when it may be extreme: between its kinks it is linear in time."""
        return [self.velocity_at(t, 2) for t in self.kinks() or {0.0}]


class Open(RootModel[Any], WallCondition):
    """An open wall without traction, as the word `open`."""

    root: Literal["open"]

    tag: ClassVar[str] = "<word>"
    model_config = ConfigDict(defer_build=True)

    @property
    @override
    def outside_pressure(self) -> float:
        return 0.0


class Velocity(RootModel[Any], WallCondition):
    """A wall that moves at a velocity, as a list of its components."""

    root: tuple[Series, ...]

    tag: ClassVar[str] = "<velocity>"
    model_config = ConfigDict(defer_build=True, frozen=True, strict=True, allow_inf_nan=False)

    @override
    def velocity_at(self, t: float, dimension: int) -> WallVelocity:
        return WallVelocity(np.array([value_at(component, t) for component in self.root]), 0.0)

    @override
    def series(self) -> tuple[float | Table, ...]:
        return self.root

    @override
    def components(self, dimension: int) -> tuple[Any, ...]:
        return self.root


class Pressure(Section, WallCondition):
    """An open wall: the traction there is `sigma n = -pressure n`."""

    tag: ClassVar[str] = "<pressure>"
    pressure: float
    """the pressure outside an open wall, a number"""

    @property
    @override
    def outside_pressure(self) -> float:
        return self.pressure


class Shear(Section, WallCondition):
    """A wall on which the fluid has the shear flow `u = shear y e_x`, in space `shear z e_x`."""

    tag: ClassVar[str] = "<shear>"
    shear: float
    """the shear rate of the flow u_x = shear y (in space shear z), a number"""

    @override
    def velocity_at(self, t: float, dimension: int) -> WallVelocity:
        return WallVelocity(np.zeros(dimension), self.shear)


class Stress(Section, WallCondition):
    """A wall of a channel that a shear stress moves along itself; how fast is a result."""

    tag: ClassVar[str] = "<stress>"
    stress: Series
    """the force of a wall of a channel on the fluid along x, over its length (in space its area), a series"""

    @override
    def shear_stress(self, t: float) -> float:
        return value_at(self.stress, t)

    @override
    def series(self) -> tuple[float | Table, ...]:
        return (self.stress,)


class SlidingWall(Section, WallCondition):
    """A wall along which fluid slides, and which may move itself."""

    tag: ClassVar[str] = "<slip>"
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
        return WallVelocity(np.array([value_at(component, t) for component in given]), 0.0)

    @override
    def series(self) -> tuple[float | Table, ...]:
        return self.velocity or ()

    @override
    def components(self, dimension: int) -> tuple[Any, ...]:
        return self.velocity or super().components(dimension)

    @override
    def resting(self, dimension: int) -> "WallCondition":
        return self.model_copy(update={"velocity": None})


def _wall_kind(value: Any) -> str:
    if isinstance(value, dict):
        words = ("pressure", "shear", "stress", *SlidingWall.model_fields)
        key = nearest_word(str(next(iter(value), "pressure")), words)
        return SlidingWall.tag if key in SlidingWall.model_fields else f"<{key}>"
    return getattr(value, "tag", Open.tag if isinstance(value, str) else Velocity.tag)


Wall = Annotated[
    Annotated[Open, Tag(Open.tag)]
    | Annotated[Velocity, Tag(Velocity.tag)]
    | Annotated[Pressure, Tag(Pressure.tag)]
    | Annotated[Shear, Tag(Shear.tag)]
    | Annotated[Stress, Tag(Stress.tag)]
    | Annotated[SlidingWall, Tag(SlidingWall.tag)],
    Discriminator(_wall_kind),
]
