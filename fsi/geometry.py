"""The geometry of a case, which decides how many components its vectors have."""

from __future__ import annotations

from typing import Literal

type Geometry = Literal["planar", "axisymmetric", "spatial"]

# The case puts its geometry and the number of its bodies into its sections under these names; the brackets
# keep them out of the user's reach.
GEOMETRY = "<geometry>"
BODIES = "<bodies>"


def dimension_of(geometry: Geometry) -> int:
    """How many coordinates a point has: (x, y), (r, z) or (x, y, z)."""
    return 3 if geometry == "spatial" else 2


def require_components[T](vector: tuple[T, ...], number: int, what: str) -> tuple[T, ...]:
    """The vector, if it has that many components. Raises ValueError."""
    if len(vector) != number:
        raise ValueError(f"{what} has {len(vector)} components where this geometry has {number}")
    return vector
