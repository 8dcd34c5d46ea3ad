"""Closed splines through points."""

from abc import abstractmethod
from pathlib import Path
from typing import Annotated, Any, Literal, override

import numpy as np
import scipy  # its modules load when they are used
from pydantic import Field, field_validator, model_validator

from fsi.arrays import Array
from fsi.case.shapes.shape import BodyShape, register_shape
from fsi.meshes.geometry.jets import Jet, JetOf

type Place = Annotated[tuple[float, ...], Field(min_length=2, max_length=2)]


class ShapeThroughPoints(BodyShape):
    """The periodic cubic spline through points, by the lengths of the chords between them."""

    @property
    @abstractmethod
    def around(self) -> tuple[tuple[float, ...], ...]:
        """The points once around it, counterclockwise."""

    @field_validator("points", mode="before", check_fields=False)
    @classmethod
    def _read(cls, points: Any) -> Any:
        """The points of a file."""
        if not isinstance(points, str):
            return points
        try:
            rows = [line.partition("#")[0] for line in Path(points).read_text().splitlines()]
            if not any(row.strip() for row in rows):  # NumPy would warn, and name no file
                raise ValueError("there are no points in it")
            table = np.loadtxt(rows, delimiter=",", ndmin=2, dtype=float)
        except (OSError, ValueError) as error:
            reason = error.strerror if isinstance(error, OSError) else str(error).splitlines()[0]
            raise ValueError(f"cannot be read ({reason})") from None
        return tuple(map(tuple, table.tolist()))

    @model_validator(mode="after")
    def _moves_on(self) -> "ShapeThroughPoints":
        x = np.array([*self.around, self.around[0]])
        if not np.all(np.diff(x, axis=0).any(axis=1)):
            raise ValueError("has the same point twice in a row, the first also after the last; drop one")
        return self

    @property
    def _knots(self) -> tuple[Array, Array]:
        """The points with the first again at the end, and t at each."""
        x = np.array([*self.around, self.around[0]])
        t = np.append(0.0, np.cumsum(np.hypot(*np.diff(x, axis=0).T)))
        return x, t / t[-1]

    @property
    @override
    def joints(self) -> tuple[float, ...]:
        return tuple(self._knots[1][:-1].tolist())

    @override
    def curve(self) -> JetOf:
        x, t = self._knots
        spline = scipy.interpolate.CubicSpline(t, x, bc_type="periodic")
        return lambda at: Jet(spline(at), spline(at, 1), spline(at, 2))


@register_shape
class Spline(ShapeThroughPoints):
    """The spline through points once around the body."""

    kind: Literal["spline"]
    points: tuple[Place, ...] = Field(min_length=5)
    """the points [x, y] counterclockwise, five or more, or the path of a CSV file of x, y without a header"""

    @property
    @override
    def around(self) -> tuple[tuple[float, ...], ...]:
        return self.points
