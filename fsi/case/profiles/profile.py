"""The key `profiles` of [domain]: what walls look like that are not straight.

One more shape is one file here: a section under `@register_profile` with its heights. Files of this room are
found by themselves; from outside the decorator alone does.
"""

from __future__ import annotations

from abc import abstractmethod
from typing import Annotated, Any, ClassVar

from pydantic import BeforeValidator, SerializeAsAny

from fsi.case.registry import Registered, Registry
from fsi.meshes.geometry.relief import Heights


class WallProfile(Registered):
    """The heights of a wall over the straight one, into the fluid, along a stretch of it.

    At both ends of the stretch heights and slopes are zero.
    """

    registry: ClassVar[Registry[Any]] = Registry("kind", __package__)

    @abstractmethod
    def heights(self) -> Heights:
        """Over the coordinate along the wall: x of bottom, top and plane, y of left and right."""


register_profile = WallProfile.registry.register

Profile = Annotated[SerializeAsAny[WallProfile], BeforeValidator(WallProfile.registry.validate)]
