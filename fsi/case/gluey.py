"""The section [gluey] of a case file: what happens where surfaces touch, further walls, the limit's study."""

from dataclasses import dataclass
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field, field_validator, model_validator

from fsi.arrays import Array
from fsi.case.section import Name, NotNegative, Positive, Section, all_components, unfit

type Variant = Literal["shifted", "cone", "film"]


@dataclass(frozen=True, slots=True)
class ContactLaw:
    """What happens between two surfaces that touch.

    Attributes:
        variant: "shifted": release costs no step; "cone": the slides' set C_q, which pays too much where an
            impulse pulls (`fsi.gluey.step`); "film": before the limit.
        gamma_min: the memory, <= 0, at which roughness makes contact solid; or -inf.
        friction: Coulomb's coefficient mu_f at solid contact, >= 0.
        tangential: c >= 0 in the viscous force `-c |gamma| slip / a`, `a = a_i a_j/(a_i + a_j)`.
        eps: of films, `gamma = eps Psi'(D)` below the gap delta0 (`fsi.gluey.film`), > 0 for "film".
        delta0: that gap, > 0 for "film".

    The film that gives gamma resists slip as well: both resistances grow as ln D, c = 1/3 of equal spheres.
    """

    variant: Variant = "shifted"
    gamma_min: float = -np.inf
    friction: float = 0.0
    tangential: float = 0.0
    eps: float = 0.0
    delta0: float = 0.0

    def shift(self, gamma: Array) -> Array:
        """What the predictor takes of memories gamma (C,); the cone leaves them to the projection."""
        return np.zeros_like(gamma) if self.variant == "cone" else gamma


class PlaneWall(Section):
    """A plane wall besides those of the domain."""

    name: Name
    """a name of letters, digits, blanks, - and _, neither blank nor - first"""
    point: tuple[float, ...]
    """a point of the wall"""
    normal: tuple[float, ...]
    """its normal, into the room, not zero"""

    _all_components = field_validator("point", "normal")(all_components)

    @field_validator("normal")
    @classmethod
    def _has_a_direction(cls, normal: tuple[float, ...]) -> tuple[float, ...]:
        if not any(normal):
            raise ValueError("is zero")
        return normal

    @property
    def unit_normal(self) -> Array:
        """Its direction, (d,); scaled first, as squares of very small or large components are no numbers."""
        scaled = np.array(self.normal) / max(map(abs, self.normal))
        unit: Array = scaled / np.linalg.norm(scaled)
        return unit


class Gluey(Section):
    """The limit of vanishing viscosity: what happens where surfaces touch."""

    variant: Variant = "shifted"
    '"shifted" or "cone" (gluey), or "film": viscosity eps > 0'
    gamma_min: float | None = Field(default=None, le=0.0)
    """the memory at which contact is solid, <= 0 (none if not given)"""
    eps: Positive | None = None
    """eps > 0 in gamma = eps ln(x) of spheres, 2 eps (1 - x^-0.5) of discs, x = gap/reference_gap"""
    reference_gap: Positive | None = None
    """the gap at which gamma is 0, > 0"""
    roughness: Positive | None = None
    """the gap at which contact is solid, > 0, with eps and reference_gap"""
    friction: NotNegative = 0.0
    """Coulomb's coefficient at solid contact, >= 0"""
    tangential: NotNegative = 0.0
    """the viscous slip resistance over |gamma|/a, >= 0; 1/3 for equal spheres"""
    density: Positive = 1.0
    """the density of the bodies to which no mass is given, a number > 0"""
    walls: tuple[PlaneWall, ...] = ()
    """one section [[gluey.walls]] for each plane besides the walls of the domain"""

    @model_validator(mode="after")
    def _whole(self) -> Self:
        film = (self.eps, self.reference_gap, self.roughness)
        if self.gamma_min is not None and film != (None, None, None):
            raise unfit("gamma_min", "follows from eps, reference_gap and roughness", "drop it, or those")
        if self.variant == "film":
            if self.eps is None or self.reference_gap is None:
                raise unfit("variant", "is of films with eps and reference_gap", "give both")
            for key in ("gamma_min", "roughness", "friction", "tangential"):
                if getattr(self, key) != Gluey.model_fields[key].default:
                    raise unfit(key, 'variant = "film" has none', "drop it, or give another variant")
            return self
        given = [key for key, value in zip(_OF_FILMS, film, strict=True) if value is not None]
        if given and None in film:
            lacking = " and ".join(key for key in _OF_FILMS if key not in given)
            raise unfit(given[0], f"tells the memory together with {lacking}", f"give {lacking}, or drop it")
        if self.roughness is not None and self.roughness >= (self.reference_gap or 0.0):
            raise unfit("roughness", "is not below reference_gap", "give a smaller one")
        if self.friction > 0.0 and self.gamma_min is None and self.roughness is None:
            raise unfit("friction", "there is no solid contact", "give gamma_min or the roughness")
        return self


_OF_FILMS = ("eps", "reference_gap", "roughness")


class LimitStudy(Section):
    """For `fsi limit`: the viscosities that go to zero, and the numbers of steps of the slides' scheme."""

    eps: tuple[Positive, ...] = Field(default=(1e-1, 1e-2, 1e-4, 1e-6, 1e-8), min_length=1)
    """viscosities, numbers > 0"""
    steps: tuple[Annotated[int, Field(ge=1)], ...] = Field(default=(100, 200, 400, 800), min_length=1)
    """numbers of steps of the scheme, at least 1"""
