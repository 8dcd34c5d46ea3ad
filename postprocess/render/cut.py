"""A vertical plane cut through a flow in space: a field on it, and the lines along its in-plane velocity."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pyvista as pv
from scipy.spatial import cKDTree

from fsi.bodies.configuration import Array, Configuration
from fsi.postprocess.render.view import Gap, View
from fsi.postprocess.run.probe import FLUID, probe
from fsi.postprocess.run.run import Run

FIELDS = {"speed": ("u_x", "u_y", "u_z"), "pressure": ("p",)}
_X, _UP = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
_POINTS = 161  # along each side: exact values there, linear in between
_APART = 0.06  # distance of streamlines, over half the width of the window


@dataclass(frozen=True, slots=True)
class Cut:
    """The points `centre + half (s along + t e_z)`; along: a horizontal unit vector, (3,), as is centre."""

    centre: Array
    half: float
    along: Array

    def points(self, s: Array, t: Array) -> Array:
        """Points in space (..., 3)."""
        found: Array = self.centre + self.half * (s[..., None] * self.along + t[..., None] * _UP)
        return found

    def circles(self, q: Configuration) -> Configuration:
        """Where the plane cuts the spheres, as discs with centres (s, t), in units of half."""
        across = np.cross(self.along, _UP)
        apart = q.centres - self.centre
        squared = q.radii**2 - (apart @ across) ** 2
        cut = squared > 0.0
        centres = np.column_stack([apart @ self.along, apart @ _UP])[cut] / self.half
        return Configuration.unturned(centres, np.sqrt(squared[cut]) / self.half)

    @property
    def name(self) -> str:
        """Where it lies."""
        if abs(self.along[0]) == 1.0:
            return f"y = {self.centre[1]:.3g}"
        return f"at {np.degrees(np.arctan2(self.along[1], self.along[0])):.0f}° to x"


def through_gap(gap: Gap, q: Configuration, view: View) -> Cut:
    """The plane that holds the line of centres; of those of a vertical line the one along x.

    Its centre is that of the view, or what lies nearest to it on the plane.
    """
    towards = (gap.middle - q.centres[gap.sides[0]]) * [1.0, 1.0, 0.0]
    length = float(np.linalg.norm(towards))
    steep = length < 1e-6 * q.radii[gap.sides[0]]
    along = _X if steep else np.copysign(1.0, towards[0]) * towards / length
    across = np.cross(along, _UP)
    return Cut(view.centre - ((view.centre - gap.middle) @ across) * across, view.half, along)


def flow_on(run: Run, step: int, cut: Cut, field: str, reach: float) -> tuple[pv.PolyData, pv.PolyData]:
    """The part of the cut with |s|, |t| <= reach inside the walls, as a surface and its streamlines.

    Points are (s, t, 0); the surface has the point data `value`. Values go on from the fluid into the bodies,
    whose pictures hide it.
    """
    grid = pv.ImageData(
        dimensions=(_POINTS, _POINTS, 1),
        spacing=(2.0 * reach / (_POINTS - 1), 2.0 * reach / (_POINTS - 1), 1.0),
        origin=(-reach, -reach, 0.0),
    )
    s, t, _ = np.asarray(grid.points, dtype=float).T
    x = cut.points(s, t)
    table = probe(run, x, step)
    fluid = (table["where"] == FLUID).to_numpy()
    values = table[list(FIELDS[field])].to_numpy()
    u = table[list(FIELDS["speed"])].to_numpy()
    known = np.flatnonzero(fluid)[cKDTree(x[fluid]).query(x)[1]]
    grid["value"] = (values[:, 0] if values.shape[1] == 1 else np.linalg.norm(values, axis=1))[known]
    grid["in plane"] = np.column_stack([u[known] @ cut.along, u[known] @ _UP, np.zeros(len(x))])
    walls = run.container(step).distances(x)
    for k, distance in enumerate(walls.T):
        grid[f"wall {k}"] = distance
    surface = grid.extract_surface(algorithm="dataset_surface")
    lines = pv.PolyData()
    if field == "speed" and np.any(grid["in plane"]):
        apart = _APART / grid.spacing[0]  # in cells, as all lengths of this filter are
        lines = grid.streamlines_evenly_spaced_2D(
            vectors="in plane",
            start_position=_start(grid),
            separating_distance=apart,
            separating_distance_ratio=0.4,
            compute_vorticity=False,
        )
    return _inside(surface), _inside(lines)


def _start(grid: pv.ImageData) -> tuple[float, float, float]:
    """The first streamline begins where the flow is fastest."""
    s, t, _ = np.asarray(grid.points)[np.argmax(np.linalg.norm(grid["in plane"], axis=1))]
    return float(s), float(t), 0.0


def _inside(drawn: pv.PolyData) -> pv.PolyData:
    """What lies inside the walls."""
    for name in [name for name in drawn.point_data if name.startswith("wall")]:
        if drawn.n_points:
            drawn = drawn.clip_scalar(scalars=name, invert=False, value=0.0)
    return drawn
