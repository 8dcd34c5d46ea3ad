"""Which sides of a pair end in a tip: their curvature has no bound there."""

import numpy as np

from fsi.case.case import Case
from fsi.case.profiles.profile import WallProfile
from fsi.meshes.geometry.outline import Outline


def sharpness(case: Case, wall: str) -> list[bool]:
    """Of each body that has an outline, and of a wall of this name that has a shape, whether it has a tip."""
    sharp = [is_sharp(outline) for outline in case.configuration().outlines]
    profiles: dict[str, WallProfile] = getattr(case.domain, "profiles", {})
    if wall in profiles:
        heights = profiles[wall].heights()
        sharp.append(bool(np.isinf(heights.at(np.array(heights.joints))[2]).any()))
    return sharp


def is_sharp(outline: Outline) -> bool:
    """Whether it has the end of a tip."""
    return bool(np.isinf(outline.curvature(np.array(outline.joints))).any())
