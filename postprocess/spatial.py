"""Pictures of the flow in space: spheres, and a vertical plane through one of them that shows a field."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import pyvista as pv
from scipy.spatial import cKDTree

from fsi.bodies import Array
from fsi.errors import InputError
from meshes.geometry import HalfPlane
from postprocess.animation import Picture
from postprocess.choice import Choice, Span
from postprocess.drawings import DRAWINGS
from postprocess.figure import Framed, compose
from postprocess.probe import FLUID, probe
from postprocess.run import Run
from postprocess.space import new_space
from postprocess.view import View, around_all

FIELDS = {"speed": ("u_x", "u_y", "u_z"), "pressure": ("p",)}
_POINTS = 161  # of the plane along each side: exact values there, linear in between
_WIDE = 2.2  # of the window over that which just holds the bodies
_REACH = 1.35  # of the plane over the window, half its width


class SpatialArtist:
    """Draws a run in space: the same plane and window, and the same colours for the same values."""

    series = "fluid"

    def __init__(self, run: Run, choice: Choice) -> None:
        """Raises InputError: there is no such field, or a gap is asked for."""
        if choice.gap is not None:
            raise InputError(
                f"--gap {choice.gap}: gaps in space are not drawn close up; drop it, or tabulate it by "
                "fsi probe RUN --line"
            )
        if choice.field is not None and choice.field not in FIELDS:
            raise InputError(f"--field {choice.field}: give one of {', '.join(FIELDS)}")
        self.run, self.choice, self.field = run, choice, choice.field or "speed"

    def require_fields(self, step: int) -> None:
        """All steps have the same."""

    def pictures(self, steps: Sequence[int]) -> Iterator[Picture]:
        """A picture of each step."""
        q = [self.run.configuration(step) for step in steps]
        near = around_all(np.stack([at.centres for at in q]), q[0].radii)
        view = View(near.centre, _WIDE * near.half)
        planes = [self._plane(step, view) for step in steps]
        span = self.choice.span or _span(self.field, np.concatenate([plane["value"] for plane in planes]))
        drawing = DRAWINGS[self.field]
        norm = drawing.norm(span)
        for step, at, plane in zip(steps, q, planes, strict=True):
            space = new_space(view, self.choice.size)
            space.colour(plane, "value", drawing.colours, norm)
            space.bodies(at)
            if isinstance(self.run.case.container(), HalfPlane):
                space.floor(0.0)
            title = f"{self.run.name},  t = {self.run.times[step]:.6g}"
            what = f"{self.field} on the plane y = {view.centre[1]:.3g}"
            yield compose(
                title, [Framed(space.image(), what, view.half, drawing.label, drawing.colours, norm)]
            )

    def _plane(self, step: int, view: View) -> pv.PolyData:
        """The plane across y through the window's centre, in its coordinates, with the fluid's values."""
        along = np.linspace(-_REACH, _REACH, _POINTS)
        u, w = np.meshgrid(along, along, indexing="ij")
        grid = pv.StructuredGrid(u[..., None], np.zeros_like(u)[..., None], w[..., None])
        x = view.centre + view.half * np.asarray(grid.points, dtype=float)
        table = probe(self.run, x, step)
        value = np.linalg.norm(table[list(FIELDS[self.field])].to_numpy(), axis=1)
        if len(FIELDS[self.field]) == 1:
            value = table[FIELDS[self.field][0]].to_numpy()
        fluid = (table["where"] == FLUID).to_numpy()
        _, nearest = cKDTree(x[fluid]).query(x)
        grid["value"] = value[fluid][nearest]  # goes on into the spheres, which hide it
        grid["distance"] = self.run.container(step).distances(x).min(axis=1)
        surface = grid.extract_surface(algorithm="dataset_surface")
        return surface.clip_scalar(scalars="distance", invert=False, value=0.0)


def _span(name: str, values: Array) -> Span:
    """The largest speed and four decades less, or the largest size on both sides of zero."""
    largest = float(np.abs(values).max()) or 1.0
    return (1e-2 * largest, largest) if name == "speed" else (-largest, largest)
