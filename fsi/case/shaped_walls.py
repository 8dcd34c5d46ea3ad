"""The key `profiles` of domains with straight walls: those that have a shape."""

from functools import cached_property
from typing import override

import numpy as np
from pydantic import Field, ValidationInfo, field_validator

from fsi.case.domains.domain import Walled
from fsi.case.profiles.profile import Profile
from fsi.case.section import refusal, refuse_unknown, told, toml_text
from fsi.errors import InputError
from fsi.meshes.geometry.container import Container

STANDING = 1e-9  # of its length: what is higher stands over the straight wall


class StraightWalls(Walled):
    """A domain whose straight walls may be given a shape."""

    profiles: dict[str, Profile] = Field(
        default={},
        description="for each wall with a shape a table with its kind: its heights over the straight wall",
    )

    @field_validator("profiles")
    @classmethod
    def _of_walls(cls, profiles: dict[str, Profile], info: ValidationInfo) -> dict[str, Profile]:
        if profiles and told(info).geometry != "planar":
            raise ValueError('walls have shapes where geometry = "planar"; drop it')
        for name in profiles:
            refuse_unknown(name, list(info.data.get("walls", profiles)))
        return profiles

    @property
    @override
    def profiled(self) -> bool:
        return bool(self.profiles)

    def straight(self) -> Container:
        """The container with straight walls."""
        raise NotImplementedError

    @override
    def container(self) -> Container:
        return self._shaped if self.profiles else self.straight()

    @cached_property
    def _shaped(self) -> Container:
        from fsi.meshes.geometry.shaped import ShapedWalls

        heights = {name: profile.heights() for name, profile in self.profiles.items()}
        return ShapedWalls.of(self.straight(), heights)

    @override
    def require_shapes(self) -> None:
        straight = self.straight()
        for name, profile in self.profiles.items():
            here = f"domain.profiles.{name} = {toml_text(profile)}"
            if len(straight.periods):
                raise InputError(f"{here}: periodic domains have straight walls; drop it")
            if self.mesh is not None:
                raise InputError(f"{here}: a mesh of your own is for straight walls; drop domain.mesh, or it")
            if name in straight.far_walls or not straight.plane[straight.walls.index(name)]:
                raise InputError(f"{here}: this wall is not straight; drop it")
            if not self.walls[name].rests:
                key = f"domain.walls.{name}"
                raise refusal(
                    key, self.walls[name], "a wall with a shape is at rest; drop the one or the other"
                )
            self._require_room(name, straight, here)

    def _require_room(self, name: str, straight: Container, here: str) -> None:
        """Between the corners of the wall, and in the domain without crossing itself."""
        wall = straight.walls.index(name)
        axis = 1 - straight.corner_axes[wall]
        ends = next(curve.ends[:, axis] for curve in straight.outline() if curve.wall == wall)
        low, high = float(ends.min()), float(ends.max())
        begin, end = self.profiles[name].heights().interval
        if begin < low or end > high:
            raise InputError(
                f"{here}: stands from {begin:.6g} to {end:.6g} on a wall from {low:.6g} to {high:.6g}; move "
                "or shorten it"
            )
        shaped = self._shaped
        x = np.concatenate([curve.at(curve.samples) for curve in shaped.outline() if curve.wall == wall])
        others = np.delete(shaped.distances(x), wall, axis=1)
        standing = straight.distances(x)[:, wall] > STANDING * (end - begin)
        if np.any(others[standing] <= 0.0):
            raise InputError(f"{here}: reaches another wall; make it lower, or move it")
