"""The levels at which a case can be computed, and what each of them has.

Whoever must know more of a case than its data asks its level, never for the name of a model. What steps the
levels is in `fsi.models`.
"""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class ModelLevel:
    """What one level has.

    Attributes:
        viscous: whether a viscous fluid gives the bodies their velocities at any instant; the other levels
            step by themselves, with given steps.
        meshed: whether its fluid is meshed.
        accuracy: the section of the case whose `tolerance` refines it, "" where nothing does.
        pressure: whether its fluid always has one, and with it tractions.
        series: the files that pictures of its runs are made of: "fluid" where it has a velocity at every
            point of the fluid, "bodies" (and lines between them), or "profile".
    """

    viscous: bool
    series: str
    accuracy: str = ""
    meshed: bool = False
    pressure: bool = False

    @property
    def flow(self) -> bool:
        """Whether it has a velocity at every point of the fluid."""
        return self.series == "fluid"


LEVELS = {
    "resolved": ModelLevel(
        viscous=True, series="fluid", accuracy="discretisation", meshed=True, pressure=True
    ),
    "pores": ModelLevel(viscous=True, series="fluid", accuracy="pores"),
    "reduced": ModelLevel(viscous=True, series="bodies"),
    "gluey": ModelLevel(viscous=False, series="bodies"),
    "macroscopic": ModelLevel(viscous=False, series="profile"),
}
VISCOUS = tuple(name for name, level in LEVELS.items() if level.viscous)
