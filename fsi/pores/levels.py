"""How fine a pore is, by the number of modes of its necks: degrees and points that go with them."""

from typing import NamedTuple

from fsi.pores.quadrature import Rule
from fsi.pores.quadrature import rule as gauss


class Level(NamedTuple):
    """What goes with a number of modes.

    Attributes:
        modes: from this number of modes of a neck on.
        fluid: order of fluid discs.
        bubbles: degree of the bubbles of a pore.
        neck_bubbles: degrees + 1 of the bubbles of a neck, along and across.
        points: of quadrature along necks and across them, and the degree inside.
    """

    modes: int
    fluid: int
    bubbles: int
    neck_bubbles: int
    points: tuple[int, int, int]

    @property
    def rule(self) -> Rule:
        """The points of quadrature, more along necks where they gather."""
        return gauss(*self.points, _PER_GATHERING)

    @property
    def finer_rule(self) -> Rule:
        """More of them, for flat pores, where weights change within a part of the pore, and few bodies."""
        along, across, inside = (max(pair) for pair in zip(self.points, _FLAT, strict=True))
        return gauss(along, across, inside, 2.0 * _PER_GATHERING)


# Points along a neck for each unit of T.
_PER_GATHERING = 2.0
_FLAT = (20, 24, 25)  # points of flat pores

LEVELS = (
    Level(0, 3, 4, 0, (2, 6, 8)),
    Level(1, 4, 4, 0, (2, 6, 8)),
    Level(2, 5, 5, 0, (3, 6, 10)),
    Level(4, 5, 5, 1, (4, 8, 12)),
    Level(6, 6, 6, 2, (5, 9, 14)),
    Level(8, 8, 8, 2, (7, 10, 17)),
    Level(10, 9, 8, 3, (9, 12, 20)),
    Level(12, 10, 10, 4, (13, 12, 25)),
    Level(16, 12, 12, 6, (16, 16, 30)),
)


def level_of(modes: int) -> int:
    """The number of the level in LEVELS that goes with a number of modes."""
    return max(k for k, level in enumerate(LEVELS) if level.modes <= modes)
