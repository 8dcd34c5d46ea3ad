"""What a case is compared with: its rows [[expected]] and the section [sweep]."""

from __future__ import annotations

from pydantic import Field, field_validator, model_validator

from fsi.case.section import Positive, Section, Text, nearest_word
from fsi.lubrication.exact_results import EXACT

APPARENT_VISCOSITY = "apparent viscosity"
DISSIPATION = "dissipation"
TIME_AT_GAP = "time at gap "
_COMPONENT = r"(velocity|force|position|angular_velocity|torque)\.[xyrz]|angular_velocity|torque"
_QUANTITY = rf"^({DISSIPATION}|{APPARENT_VISCOSITY}|{TIME_AT_GAP}[\d.e-]+|[\w -]+\.({_COMPONENT}))$"


def gap_of(quantity: str) -> float:
    """The gap in `time at gap 0.1`."""
    return float(quantity.removeprefix(TIME_AT_GAP))


class Expected(Section):
    """A number that the case must give: a value, or the name of an entry of `fsi.lubrication.exact_results`.

    quantity: `dissipation`, `apparent viscosity`, or of a body `disc.velocity.x`, `disc.force.y` (by the
    fluid on the body), `disc.angular_velocity`, `disc.torque`, at the end of a run `disc.position.y`; for a
    run also `time at gap 0.1`, the first time at which the smallest gap is 0.1.
    """

    quantity: str = Field(
        pattern=_QUANTITY,
        description='"dissipation", "apparent viscosity", "BODY.force.x" (velocity, position; y), '
        '"BODY.torque", "time at gap 0.1"',
    )
    value: float | None = None
    """the expected number, or give `exact`"""
    exact: str | None = Field(default=None, description=f"one of {', '.join(EXACT)}, or give `value`")
    rtol: Positive
    """the relative tolerance, a number > 0"""
    source: Text
    """where the number comes from"""

    @field_validator("exact")
    @classmethod
    def _known(cls, exact: str | None) -> str | None:
        if exact is not None and exact not in EXACT:
            raise ValueError(f"no such exact result; the nearest is {nearest_word(exact, EXACT)!r}")
        return exact

    @model_validator(mode="after")
    def _one_of_them(self) -> Expected:
        if (self.value is None) == (self.exact is None):
            raise ValueError("needs either a value or the name of an exact result")
        return self


class Sweep(Section):
    """For `fsi validate`: the same case with one number changed, for each of several values."""

    key: str = Field(pattern=r"^[\w.-]+$")
    'the dotted key of a number, like "bodies.0.position.1"'
    values: tuple[float, ...] = Field(min_length=1)
    """the values of that key, at least one"""
