"""The key `profiles` of [domain]: what walls look like that are not straight.

One more shape is one file here: a section under `@register_profile` with its heights. Files of this room are
found by themselves; from outside the decorator alone does.
"""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import numpy as np
from pydantic import BeforeValidator, SerializeAsAny, ValidationInfo

from fsi.arrays import Array
from fsi.case.registry import Registered, Registry, blamed_on
from fsi.meshes.geometry.jets import CONSISTENT, Jet, inconsistency

if TYPE_CHECKING:  # shapes of walls take long to load, and most walls are straight
    from fsi.meshes.geometry.relief import Heights

STRAIGHT = 1e-6  # slope, and height over the length of the stretch: less is none
SAMPLES = 1025  # enough but for sharp bends


class WallProfile(Registered):
    """The heights of a wall over the straight one, into the fluid, along a stretch of it.

    At both ends of the stretch heights and slopes are zero.
    """

    registry: ClassVar[Registry[Any]] = Registry("kind", __package__)

    @abstractmethod
    def heights(self) -> Heights:
        """Over the coordinate along the wall: x of bottom, top and plane, y of left and right."""

    def check(self) -> None:
        """Raise ValueError where no wall looks so."""
        from fsi.meshes.geometry.relief import close_places

        heights = self.heights()
        begin, end = heights.interval

        def jet(s: Array) -> Jet:
            with np.errstate(all="ignore"):
                return Jet(*(values[:, None] for values in heights.at(s)))

        if not begin < end:
            raise ValueError("ends before it begins; give an interval that ascends")
        h, dh, _ = jet(np.array([begin, end]))
        if not max(np.abs(h).max() / (end - begin), np.abs(dh).max()) <= STRAIGHT:
            raise ValueError(
                "begins or ends with a step or a slope; give heights that are zero there, with their slopes"
            )
        places = np.union1d(np.linspace(begin, end, SAMPLES), heights.joints)
        if not (
            inconsistency(jet, places) <= CONSISTENT
            or inconsistency(jet, close_places(heights)) <= CONSISTENT  # which takes longer
        ):
            raise ValueError("has derivatives that are not those of its heights; correct its heights")


register_profile = WallProfile.registry.register


def _sound(value: Any, info: ValidationInfo) -> Any:
    """The section that a table describes. Raises ValueError: no wall looks so."""
    profile: WallProfile = WallProfile.registry.validate(value, info)
    with blamed_on(profile):
        profile.check()
    return profile


Profile = Annotated[SerializeAsAny[WallProfile], BeforeValidator(_sound)]
