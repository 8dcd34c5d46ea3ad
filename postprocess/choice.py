"""What the user of `fsi render` wants to see."""

from __future__ import annotations

from dataclasses import dataclass

type Span = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Choice:
    """Without field and gap: the speed, and the mesh in the narrowest gap; or the contacts.

    field: what to colour; gap: two sides, "3,7" or "disc,bottom"; span: of the colours; size: pixels of a
    panel.
    """

    field: str | None = None
    gap: str | None = None
    span: Span | None = None
    size: int = 1000
