"""Random bodies of all shapes of the plane, close to each other and to walls."""

from __future__ import annotations

import numpy as np

from bench.placing import TRIES, one_after_the_other, put_close, solid, somewhere
from bench.random_walls import Data, Random, Walls
from fsi.bodies.configuration import Configuration
from fsi.case.section import tuples
from fsi.case.shapes.shape import BodyShape
from fsi.errors import InputError
from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.outline import Outline
from fsi.meshes.geometry.placed import Placed

NARROWEST = 1e-4  # of gaps over the radius of the smallest circle that holds the body
WIDE = 12.0  # of the places in containers that are larger
LENGTHS = ("axes", "length", "radius", "rounding", "corners", "points")  # keys whose numbers are lengths


def random_shape(rng: Random) -> BodyShape:
    """One of all kinds, held by a circle of the radius 0.3 to 0.9."""
    kind = str(rng.choice(["ellipse", "stadium", "superellipse", "polygon", "fourier", "spline", "tip"]))
    for _ in range(TRIES):
        table = _table(kind, rng)
        try:
            size = sound_shape(table).outline.radius
            return sound_shape(scaled(table, rng.uniform(0.3, 0.9) / size))
        except (ValueError, InputError):  # sides too short for their arcs
            continue
    raise ValueError(f"no sound {kind} found")


def scaled(table: Data, factor: float) -> Data:
    """The table of a shape with all lengths times a factor."""
    return {
        key: (factor * np.array(value)).tolist() if key in LENGTHS else value for key, value in table.items()
    }


def sound_shape(table: Data) -> BodyShape:
    """The shape of a table. Raises ValueError, InputError: no body looks so."""
    shape: BodyShape = BodyShape.registry.section_for(table).model_validate(tuples(table))
    if shape.outline.crosses_itself():
        raise ValueError("crosses itself")
    return shape


def _table(kind: str, rng: Random) -> Data:
    """The table `shape` of a body about as large as 1."""
    angles = np.sort(rng.uniform(0.0, 2.0 * np.pi, int(rng.integers(3, 7))))
    orders = sorted({int(n) for n in rng.integers(2, 13, 2)})
    around = 2.0 * np.pi * np.arange(8) / 8.0
    star = rng.uniform(0.6, 1.0, 8)[:, None] * np.column_stack([np.cos(around), np.sin(around)])
    alpha = float(rng.uniform(0.2, 1.0))
    tables: dict[str, Data] = {
        "ellipse": {"axes": [1.0, float(rng.uniform(0.2, 1.0))]},
        "stadium": {"length": float(rng.uniform(0.3, 6.0)), "radius": 0.5},
        "superellipse": {
            "axes": [1.0, float(rng.uniform(0.3, 1.0))], "exponent": float(rng.uniform(2.0, 8.0))
        },
        "polygon": {
            "corners": np.column_stack([np.cos(angles), np.sin(angles)]).tolist(),
            "rounding": float(rng.uniform(0.05, 0.3)),
        },
        "fourier": {
            "radius": 1.0, "orders": orders, "cosines": [float(rng.uniform(-0.4, 0.4)) / n for n in orders]
        },
        "spline": {"points": star.tolist()},
        "tip": {"radius": 1.0, "alpha": alpha, "length": float(rng.uniform(0.3, 1.2))},
    }  # fmt: skip
    return {"kind": kind} | tables[kind]


def bodies_of_the_plane(rng: Random, walls: Walls) -> list[Data]:
    """Where one or more bodies stand and what they look like: parts of [[bodies]]."""

    def draw(q: Configuration) -> tuple[Placed, Data]:
        shape = random_shape(rng)
        body = _placed(rng, walls.container, q, shape.outline)
        table = {"position": body.centre.tolist(), "shape": shape.model_dump(), "angle": body.angle}
        return body, table

    return one_after_the_other(rng, walls, draw, narrowest_gap)


def narrowest_gap(q: Configuration) -> float:
    """The narrowest that is left between bodies in the plane or on an axis."""
    return float(0.9 * NARROWEST * q.radii.min())


def _placed(rng: Random, container: Container, q: Configuration, outline: Outline) -> Placed:
    """Where another body may go, perhaps too close: at a gap to a body or wall if there is one."""
    centre = somewhere(rng, container, outline.radius, WIDE)
    body = Placed(outline, centre, float(rng.uniform(0.0, 2.0 * np.pi)))
    near = solid(container)
    if len(near) + len(q) == 0:
        return body
    return put_close(rng, q, body, container, near, NARROWEST, outline.radius)
