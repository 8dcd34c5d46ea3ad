"""Sizes among many spheres: looked up near a place, they are those of all bodies and gaps."""

from __future__ import annotations

import numpy as np
from hypothesis import example, given, settings
from hypothesis import strategies as st

from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.container import FluidDomain
from fsi.meshes.resolution import Resolution
from fsi.meshes.spatial.local_sizes import LocalSizes
from fsi.meshes.spatial.sizing import Spacing

BOX, SIDE = Box((0.0, 0.0, 0.0), (12.0, 12.0, 12.0)), 12.0


@settings(max_examples=10, deadline=None)
@given(st.integers(0, 10**6), st.floats(1e-5, 0.5), st.floats(0.3, 1.0))
@example(148, 0.125, 1.0)  # at one place larger than a quarter of a side
def test_as_all_bodies_and_gaps_say(seed: int, gap: float, growth: float) -> None:
    """27 spheres, pairs of which are closer, against the law in the docstring of `sizing`."""
    rng = np.random.default_rng(seed)
    grid = np.stack(np.meshgrid(*3 * [np.arange(3)], indexing="ij"), axis=-1).reshape(-1, 3)
    radii = rng.uniform(0.5, 1.0, len(grid))
    centres = 2.0 + 4.0 * grid + rng.uniform(-0.4, 0.4, grid.shape)
    centres[1] = centres[0] + [0.0, 0.0, radii[0] + radii[1] + gap]
    centres[-1, 2] = SIDE - radii[-1] - gap
    resolution = Resolution(0.5, 14, growth)
    sizes = LocalSizes(Spacing(FluidDomain(BOX, centres, radii), resolution))
    h_body = 2.0 * np.pi * radii / 14

    def law(x: np.ndarray) -> float:
        away = np.concatenate([np.linalg.norm(x - centres, axis=1) - radii, x, SIDE - x])
        every = [0.25 * np.sqrt(3.0) * SIDE, *(h_body + growth * away[: len(radii)])]
        to_walls = np.concatenate([centres, SIDE - centres], axis=1) - radii[:, None]
        for i in range(len(radii)):
            to_bodies = np.linalg.norm(centres - centres[i], axis=1) - radii - radii[i]
            gaps = np.concatenate([to_bodies, to_walls[i]])
            smaller = np.append(np.minimum(radii, radii[i]), np.full(6, radii[i]))
            larger = np.append(np.maximum(h_body, h_body[i]), np.full(6, h_body[i]))
            for j in range(i + 1, len(gaps)):
                if h_gap(gaps[j], smaller[j]) < larger[j]:
                    every.append(h_gap(away[i] + away[j], smaller[j]))
        return float(min(every))

    def h_gap(d: float, a: float) -> float:
        return float(max(min(0.3 * np.sqrt(a * abs(d)), 10.0 * d), 0.3 * d) / 0.5)

    narrow = centres[0] + [0.0, 0.0, radii[0] + 0.5 * gap]
    points = [narrow, *rng.uniform(0.0, SIDE, (10, 3))]
    points = [x for x in points if (np.linalg.norm(x - centres, axis=1) > radii).all()]
    found = [sizes(3, 1, float(x[0]), float(x[1]), float(x[2]), 0.0) for x in points]
    np.testing.assert_allclose(found, [law(x) for x in points], rtol=1e-11)
