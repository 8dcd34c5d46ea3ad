"""The section [reduced] of a case file."""

from __future__ import annotations

from pydantic import Field

from fsi.case.section import NotNegative, Positive, Section, Text
from fsi.lubrication.named_laws import names_of_laws


class Reduced(Section):
    """The reduced model: which laws, which drag."""

    renamed = {"scheme": "use time.scheme", "step": "use time.step"}  # noqa: RUF012

    law: Text = Field(
        default="exact", description=f"the law of the gaps: {names_of_laws()} or the path of a law file"
    )
    wall_law: Text | None = None
    """the law of the gaps to walls, as `law`; the same if not given"""
    drag: NotNegative | None = None
    """the drag of a lone disc over mu V, of a sphere over mu a V (6 pi if not given), >= 0"""
    cutoff: Positive | None = None
    """the gap beyond which bodies do not feel each other, a length > 0, or none"""
    extrapolate: bool = False
    """true to use a law file outside the range of its gaps, false to stop there"""
