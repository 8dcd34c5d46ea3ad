"""Nearby points: the same with and without a tree."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from fsi.meshes.geometry.nearby import NearbyPoints


@given(st.integers(1, 12), st.integers(0, 2**32 - 1))
def test_what_is_near_is_told_by_distances_however_many_points_there_are(n: int, seed: int) -> None:
    random = np.random.default_rng(seed)
    points, x, reach = random.random((n, 2)), random.random((5, 2)), random.random(5)
    distances = np.linalg.norm(x[:, None] - points, axis=2)  # of all, without a tree
    k = int(random.integers(1, n + 1))
    nearby = NearbyPoints(points)
    away, which = nearby.nearest(x, k)
    np.testing.assert_allclose(away, np.sort(distances, axis=1)[:, :k], rtol=1e-14)
    np.testing.assert_allclose(np.take_along_axis(distances, which, axis=1), away, rtol=1e-14)
    assert nearby.within(x, reach) == [np.flatnonzero(near).tolist() for near in distances <= reach[:, None]]
    of_x, point = nearby.pairs(x, float(reach[0]))
    close = np.zeros_like(distances, dtype=bool)
    close[of_x, point] = True
    assert np.array_equal(close, distances <= reach[0])
    assert len(of_x) == close.sum()
