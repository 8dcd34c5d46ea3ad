"""Bodies that a case arranges itself: `[arrangement]`, which makes [[bodies]] and the domain they fill."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from pydantic import Field, ValidationError

from fsi.arrangements.names import CellKind, Kind, Outline, Sizes
from fsi.case.complaints import explain
from fsi.case.section import Section, toml_text, tuples
from fsi.errors import InputError
from fsi.machine.resources import require_memory

if TYPE_CHECKING:  # few cases arrange bodies, and what does loads SciPy and NumPy's random numbers
    from fsi.arrangements.arrangement import Arrangement

_MADE = ("lower", "upper", "periodic", "vectors", "radius")  # keys of [domain]


class Arranged(Section):
    """Bodies as `fsi pack` arranges them, and the domain that they fill at an area fraction.

    It takes the place of [[bodies]], and of the corners or vectors of [domain]; walls and mean flow stand
    there as ever.
    """

    kind: Kind
    """"random", "square", "hexagonal", "rows", "chains" or "columns", or "simple-cubic", "body-centred",
    "face-centred" or "close-packed" of spheres"""
    number: int = Field(ge=1)
    """how many bodies, a number > 0"""
    area_fraction: float
    """the part of the domain that the bodies fill, in space of the volume"""
    radius: float = 1.0
    """the mean radius"""
    gap: float | None = None
    """the smallest gap, between bodies and to walls, 0.02 radii if not given"""
    cell: CellKind = "channel"
    '"channel", with walls above and below, "periodic" or "box"'
    seed: int | None = Field(None, ge=0)
    """of random, 1 if not given"""
    aspect: float | None = None
    """of random: length over height of the domain, 1 if not given"""
    sizes: Sizes | None = None
    """of random: "equal", "bidisperse" or "lognormal" radii, equal if not given"""
    spread: float | None = None
    """of random: large over small radius, or deviation over mean radius, 1.4 or 0.2 if not given"""
    dimension: int | None = Field(None, ge=2, le=3)
    """of random: 3 for spheres, 2 if not given"""
    shape: Outline | None = None
    """of random in the plane: "disc", "ellipse" or "rod", disc if not given"""
    ratio: float | None = None
    """of ellipses and rods: length over width, above 1, 2 if not given"""
    aligned: float | None = None
    """of ellipses and rods: the angle of all to x in degrees, all directions if not given"""
    rows: int | None = Field(None, ge=1)
    """of arrays and rows, and layers of chains, those of a square if not given, one layer"""
    length: int | None = Field(None, ge=1)
    """bodies in each chain or column, 4 in chains, those of a square in columns if not given"""
    angle: float | None = None
    """of chains and columns: degrees from the flow, 135 and 90 if not given"""

    def arrangement(self) -> Arrangement:
        """The bodies in their cell. Raises InputError."""
        from fsi.arrangements.arrangement import BODY_BYTES
        from fsi.arrangements.kinds import arrange
        from fsi.arrangements.request import wanted

        require_memory(_spelled("number", self.number), BODY_BYTES * self.number, "give fewer")
        gap = 0.02 * self.radius if self.gap is None else self.gap
        common = {"number": self.number, "fraction": self.area_fraction, "radius": self.radius, "gap": gap}
        given = self.model_dump(exclude={*common, "area_fraction", "kind", "cell"}, exclude_none=True)
        asked = wanted(self.kind, common | {"cell": self.cell}, given, _spelled)
        try:
            return arrange(self.kind, asked)
        except InputError as error:  # it begins with one of the keys here
            raise InputError(f"arrangement.{error}") from None


def _spelled(name: str, value: Any) -> str:
    return f"arrangement.{name} = {toml_text(value)}"


def with_arrangement(data: Mapping[str, Any]) -> dict[str, Any]:
    """The data of a case with the bodies and the domain of its [arrangement] in that one's place.

    Raises InputError: the arrangement is not sound, or bodies or the size of the domain are given too.
    """
    given, domain = data.get("arrangement"), data.get("domain", {})
    if given is None or not isinstance(domain, dict):
        return dict(data)
    for key in ("bodies", "bodies_from", "grids"):
        if key in data:
            raise InputError(f"{key}: the bodies are those of [arrangement]; drop one of them")
    for key in _MADE:
        if key in domain:
            raise InputError(
                f"domain.{key} = {toml_text(domain[key])}: [arrangement] makes the domain; drop it"
            )
    made = _section(given).arrangement()
    rest = {key: value for key, value in data.items() if key != "arrangement"}
    fills = _domain(made)
    own = fills.get("shape", "box")
    shape = domain.get("shape", own)
    if shape != own:
        cell = ' or give arrangement.cell = "periodic"' if shape == "cell" else ""
        raise InputError(
            f'domain.shape = {toml_text(shape)}: [arrangement] makes shape = "{own}"; drop it{cell}'
        )
    return rest | {"bodies": made.bodies(), "domain": fills | domain}


def _section(given: Any) -> Arranged:
    try:
        return Arranged.model_validate(tuples(given))
    except ValidationError as error:
        raise InputError(explain(error, Arranged, given, ("arrangement",))) from None


def _domain(made: Arrangement) -> dict[str, Any]:
    """The keys of [domain] that hold the bodies."""
    cell = made.cell
    if all(cell.periodic):
        return {"shape": "cell", "vectors": tuple(map(tuple, np.diag(cell.sides).tolist()))}
    box: dict[str, Any] = {"lower": (0.0,) * cell.dimension, "upper": cell.sides}
    periodic = tuple(axis for axis, so in zip("xyz", cell.periodic, strict=False) if so)
    return box | {"periodic": periodic} if periodic else box
