"""Random arrangements of ellipses and rods, of all directions or aligned.

As those of discs (`packing`): bodies thrown at random are moved and turned until none overlap, by minimising

    E = 1/2 sum_{i<j} (g - s_ij)_+^2 + 1/2 sum_walls (g + h_i - y_i)_+^2

with s_ij how far they are apart, h_i how far a body reaches towards a wall and y_i its centre's distance,
and then shaken by Metropolis moves and turns into the equilibrium fluid of hard bodies.
"""

from __future__ import annotations

from math import pi

import numpy as np
import scipy  # its modules load when they are used

from fsi.arrangements.arrangement import Arrangement, Wanted
from fsi.arrangements.cell import SimulationCell
from fsi.arrangements.convex import ConvexShape, apart
from fsi.arrangements.oriented import OrientedBodies
from fsi.arrangements.packing import ITERATIONS, LENGTH, MARGIN, MOVES, ROUNDING, TRIES, cell_for, proposal
from fsi.arrays import Array
from fsi.errors import InputError

LIMIT = 0.75  # area fraction of bodies with half the gap around them, above which none is looked for


def oriented_arrangement(radii: Array, w: Wanted) -> Arrangement:
    """Bodies of the shape that is asked for, of the areas pi a^2, at random; no two nearer than the gap.

    The same seed gives the same arrangement. Raises InputError: the area fraction is above what is looked
    for, none was found, or the cell is so small that a body meets two images of another.
    """
    shape = ConvexShape("ellipse" if w.shape == "ellipse" else "rod", w.ratio)
    cell = cell_for(radii, w.fraction, w.periodic, w.aspect)
    here = f"area_fraction = {w.fraction:g}: "
    around = radii + 0.5 * w.gap
    if w.fraction * float(np.sum(around**2) / np.sum(radii**2)) > LIMIT:
        what = f"{w.shape}s at random with gaps of {w.gap:g} radii"
        raise InputError(f"{here}too large for {what}; lower it, or the gap")
    longest = 2.0 * shape.half_length * float(radii.max()) + w.gap
    if any(so and side < 2.0 * longest for side, so in zip(cell.sides, w.periodic, strict=True)):
        short = f"the cell is shorter than two {w.shape}s of ratio {w.ratio:g}"
        raise InputError(
            f"number = {w.number}: {short}; give more bodies, or lower the ratio or the fraction"
        )
    rng, gap = np.random.default_rng(w.seed), w.gap + ROUNDING * max(cell.sides)
    bodies = _Packing(cell, shape, radii, gap, w.aligned is None)
    for _ in range(TRIES):
        x = rng.random((len(radii), 2)) * cell.sides
        theta = pi * rng.random(len(radii))
        theta = theta if w.aligned is None else np.full(len(radii), np.radians(w.aligned))
        found = bodies.without_overlaps(x, theta)
        if found is not None:
            x, theta = bodies.shaken(*found, rng)
            return Arrangement(cell, cell.wrapped(x), radii, shape, np.mod(theta, pi))
    raise InputError(
        f"{here}no arrangement of {len(radii)} {w.shape}s with gaps of {w.gap:g} radii found in {TRIES} "
        "tries; lower it, the ratio or the gap, or place more bodies"
    )


class _Packing:
    """What does not change while bodies are moved: N of one shape in a cell."""

    def __init__(
        self, cell: SimulationCell, shape: ConvexShape, radii: Array, gap: float, turn: bool
    ) -> None:
        """Of bodies that turn, or do not."""
        self.cell, self.shape, self.radii, self.gap, self.turn = cell, shape, radii, gap, turn

    def at(self, x: Array, theta: Array) -> OrientedBodies:
        """The bodies somewhere."""
        return OrientedBodies(self.cell, self.shape, self.radii, x, theta)

    def energy(self, bodies: OrientedBodies, gap: float) -> tuple[float, Array, Array]:
        """E and its derivatives, (N, 2) and (N,)."""
        i, j, couples = bodies.couples(bodies.longest + gap)
        s, phi = apart(self.shape, couples, gap)
        lack = np.maximum(gap - s, 0.0)
        push = lack[:, None] * np.column_stack([np.cos(phi), np.sin(phi)])
        dx, dtheta = np.zeros_like(bodies.x), np.zeros_like(bodies.theta)
        np.add.at(dx, i, -push)
        np.add.at(dx, j, push)
        _, slope = self.shape.support(phi[:, None] - couples.angles)
        for k, body in enumerate((i, j)):
            np.add.at(dtheta, body, -lack * couples.radii[:, k] * slope[:, k])
        room, by_turning = bodies.wall_room()
        into = np.maximum(gap - room, 0.0)
        low, high = np.hsplit(into, 2)
        dx[:, self.cell.walled] += high - low
        dtheta -= (into * by_turning).sum(axis=1)
        return 0.5 * float(lack @ lack + np.sum(into**2)), dx, dtheta

    def without_overlaps(self, x: Array, theta: Array) -> tuple[Array, Array] | None:
        """The bodies moved and turned to a minimum of E; None if overlaps remain there."""
        n, unit = len(theta), self.shape.half_length  # by which angles count as lengths
        target = self.gap + MARGIN * float(self.radii.min())

        def bodies(flat: Array) -> OrientedBodies:
            turned = theta + flat[2 * n :] / unit if self.turn else theta
            return self.at(flat[: 2 * n].reshape(n, 2), turned)

        def energy(flat: Array) -> tuple[float, Array]:
            E, dx, dtheta = self.energy(bodies(flat), target)
            return E, np.concatenate([dx.ravel(), dtheta / unit if self.turn else 0.0 * dtheta])

        def stop_when_apart(flat: Array) -> None:
            if self.energy(bodies(flat), self.gap)[0] == 0.0:
                raise StopIteration

        options = {"maxiter": ITERATIONS, "maxfun": 2 * ITERATIONS, "ftol": 0.0, "gtol": 0.0, "maxcor": 20}
        start = np.concatenate([x.ravel(), np.zeros(n)])
        best = scipy.optimize.minimize(
            energy, start, jac=True, method="L-BFGS-B", callback=stop_when_apart, options=options
        )
        found = bodies(best.x)
        return (found.x, found.theta) if self.energy(found, self.gap)[0] == 0.0 else None

    def shaken(self, x: Array, theta: Array, rng: np.random.Generator) -> tuple[Array, Array]:
        """The bodies after many moves and turns, at least the gap apart."""
        length, longest = LENGTH * float(self.radii.mean()), self.at(x, theta).longest
        for _ in range(MOVES):
            x = self.cell.wrapped(x)
            moved, good = proposal(self.cell, x, longest + self.gap + 2.0 * length, length, rng)
            turn = rng.uniform(-length, length, len(x)) / self.shape.half_length
            moved = np.where(good[:, None], moved, x)
            trial = self.at(moved, np.where(good & self.turn, theta + turn, theta))
            i, j, couples = trial.couples(longest + self.gap)
            changed = good[i] | good[j]
            s, _ = apart(self.shape, couples.of(changed), self.gap)
            touching = np.flatnonzero(changed)[s < self.gap]
            good[i[touching]] = good[j[touching]] = False
            good &= np.all(trial.wall_room()[0] >= self.gap, axis=1)
            x, theta = np.where(good[:, None], moved, x), np.where(good, trial.theta, theta)
        return x, theta
