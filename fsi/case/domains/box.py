"""Boxes, and channels, which are boxes that are periodic in some directions."""

from collections.abc import Mapping
from typing import Any, ClassVar, Literal, override

import numpy as np
from pydantic import ValidationInfo, field_validator

from fsi.case.domains.domain import MeanDrive, register_domain
from fsi.case.section import Geometry, Section, dimension_of, refusal, require_components, told, toml_text
from fsi.case.shaped_walls import StraightWalls
from fsi.errors import InputError
from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.container import Container


def _walls_of(geometry: Geometry, periodic: tuple[str, ...] = ()) -> tuple[str, ...]:
    corner = (0.0,) * dimension_of(geometry)
    return Box(corner, corner, geometry == "axisymmetric", periodic).walls


@register_domain
class BoxDomain(StraightWalls):
    """The rectangle [lower, upper] with the walls left, right, bottom, top; in space also front, back."""

    shape: Literal["box"] = "box"
    lower: tuple[float, ...]
    """the lower left corner [x, y] (in space [x, y, z]), left of and below `upper`"""
    upper: tuple[float, ...]
    """the upper right corner [x, y] (in space [x, y, z]), right of and above `lower`"""

    @classmethod
    @override
    def wall_names(cls, geometry: Geometry, known: Mapping[str, Any]) -> tuple[str, ...]:
        """left, right, front, back, bottom, top; no front and back in the plane, a cylinder has no left."""
        return _walls_of(geometry)

    @field_validator("lower", "upper")
    @classmethod
    def _all_components(cls, corner: tuple[float, ...], info: ValidationInfo) -> tuple[float, ...]:
        return require_components(corner, told(info).dimension, "a corner")

    @field_validator("upper")
    @classmethod
    def _right_way_round(cls, upper: tuple[float, ...], info: Any) -> tuple[float, ...]:
        lower = info.data.get("lower", (-np.inf,) * len(upper))
        if not all(low < high for low, high in zip(lower, upper, strict=True)):
            raise ValueError(f"does not lie to the right of and above lower = {list(lower)}")
        return upper

    @override
    def straight(self) -> Container:
        return Box(self.lower, self.upper, self.geometry == "axisymmetric")

    @override
    def require_axis(self) -> None:
        if self.lower[0] != 0.0:
            raise refusal(
                "domain.lower", self.lower, "an axisymmetric domain begins on the axis; give [0.0, z]"
            )


class _Periodicity(Section):
    """What decides which walls a periodic box has: a base class, so that it is known before `walls`."""

    periodic: tuple[Literal["x", "y", "z"], ...]
    'the periodic directions: ["x"], in space ["x", "y"]; for all give shape = "cell"'

    @field_validator("periodic")
    @classmethod
    def _each_once(cls, periodic: tuple[str, ...], info: ValidationInfo) -> tuple[str, ...]:
        if told(info).geometry == "axisymmetric":
            raise ValueError('only planar and spatial domains are periodic; give geometry = "planar"')
        letters = "xyz"[: told(info).dimension]
        if not periodic or len(set(periodic)) < len(periodic) or not set(periodic) <= set(letters):
            raise ValueError(f"does not name each of some directions of {', '.join(letters)} once")
        return periodic


@register_domain
class ChannelDomain(BoxDomain, _Periodicity):
    """The box that is periodic in some directions, across which it has no walls: along x, a channel."""

    takes_mesh: ClassVar[bool] = False
    drives: ClassVar[tuple[str, ...]] = ("pressure_gradient", "net_flux")

    pressure_gradient: float = 0.0
    """the mean dp/dx, a number"""
    net_flux: float | None = None
    """the flux of fluid and bodies along x, a number; the pressure gradient is then a result"""

    @classmethod
    @override
    def wall_names(cls, geometry: Geometry, known: Mapping[str, Any]) -> tuple[str, ...]:
        """Those of a box but for the sides that are periodic."""
        return _walls_of(geometry, known.get("periodic", ()))

    @field_validator("walls", mode="before")
    @classmethod
    def _no_sides(cls, walls: Any, info: ValidationInfo) -> Any:
        if not isinstance(walls, dict):
            return walls
        geometry = told(info).geometry
        for letter in info.data.get("periodic", ()):
            for side in set(_walls_of(geometry)) - set(_walls_of(geometry, (letter,))):
                if side in walls:
                    raise ValueError(
                        f"a domain periodic in {letter} has no wall {side}; drop walls.{side} or periodic"
                    )
        return walls

    @field_validator("net_flux")
    @classmethod
    def _one_of_them(cls, net_flux: float | None, info: Any) -> float | None:
        if net_flux is not None and info.data.get("pressure_gradient"):
            raise ValueError("the pressure gradient is given too; drop one of them")
        return net_flux

    @override
    def mean_drive(self) -> MeanDrive:
        return MeanDrive(self.pressure_gradient if self.net_flux is None else None, self.net_flux)

    @override
    def straight(self) -> Container:
        return Box(self.lower, self.upper, periodic=tuple(sorted(self.periodic)))

    @override
    def require_fluid(self) -> None:
        along_walls = ("x",) if self.geometry == "planar" else ("x", "y")
        if tuple(sorted(self.periodic)) != along_walls:
            raise InputError(
                f"domain.periodic = {toml_text(self.periodic)}: a flow is solved for only in boxes between "
                f"two walls, bottom and top; give {toml_text(along_walls)}, for all directions give "
                'shape = "cell"'
            )
