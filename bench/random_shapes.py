"""Random bodies of all shapes of the plane, close to each other and to walls."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bench.random_walls import Data, Random, Walls
from fsi.bodies.configuration import Array, Configuration
from fsi.bodies.gaps import find_gaps
from fsi.case.section import tuples
from fsi.case.shapes.shape import BodyShape
from fsi.errors import InputError
from fsi.meshes.geometry.feet import Foot
from fsi.meshes.geometry.placed import Placed
from fsi.meshes.geometry.wall_feet import wall_feet

# Gaps over the radius of the smallest circle that holds the body, equal in the logarithm.
NARROWEST, WIDEST = 1e-4, 1.0
TRIES, SLIDES = 60, 30
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
    q, shapes = _standing(rng, walls)
    return [
        {"position": x, "shape": shape.model_dump(), "angle": angle}
        for x, angle, shape in zip(q.centres.tolist(), q.angles.tolist(), shapes, strict=True)
    ]


def _standing(rng: Random, walls: Walls) -> tuple[Configuration, list[BodyShape]]:
    """Bodies one after the other where there is room for it, often close to what is there."""
    q, shapes = Configuration.unturned(np.empty((0, 2)), np.empty(0)), list[BodyShape]()
    wanted = int(rng.integers(1, walls.most + 1))
    for _ in range(TRIES):
        shape = random_shape(rng)
        body = _placed(rng, walls, q, shape)
        more = Configuration(
            np.vstack([q.centres, body.centre]),
            np.append(q.angles, body.angle),
            np.append(q.radii, body.outline.radius),
            (*q.outlines, body.outline),
        )
        if find_gaps(more, walls.container).smallest() >= 0.9 * NARROWEST * more.radii.min():
            q, shapes = more, [*shapes, shape]
        if len(q) == wanted:
            break
    if len(q) == 0:
        raise ValueError("no room for a body in these walls")
    return q, shapes


def _placed(rng: Random, walls: Walls, q: Configuration, shape: BodyShape) -> Placed:
    """Where another body may go, perhaps too close to something: slid to a gap to a body or wall."""
    container, outline = walls.container, shape.outline
    span = min(container.size(), 12.0)
    middle = np.asarray(container.middle) if container.size() == span else np.zeros(2)
    centre = middle + rng.uniform(-0.5, 0.5, 2) * span
    if len(container.far_walls):
        centre[-1] = outline.radius + rng.uniform(0.0, 3.0)
    body = Placed(outline, centre, float(rng.uniform(0.0, 2.0 * np.pi)))
    near = [k for k, wall in enumerate(container.walls) if wall not in container.far_walls]
    choices = len(near) + len(q)
    if choices == 0:
        return body
    k, gap = int(rng.integers(choices)), outline.radius * NARROWEST * (WIDEST / NARROWEST) ** rng.random()
    for _ in range(SLIDES):
        foot = wall_feet(body, container)[near[k]] if k < len(near) else body.gap_to(q.placed[k - len(near)])
        if abs(foot.gap - gap) < 1e-3 * gap:
            break
        body = replace(body, centre=_slid(body, foot, gap))
    return body


def _slid(body: Placed, foot: Foot, gap: float) -> Array:
    """The centre of a body moved along the normal where it is nearest, until the gap is this one."""
    centre: Array = body.centre + (gap - foot.gap) * foot.normal
    return centre
