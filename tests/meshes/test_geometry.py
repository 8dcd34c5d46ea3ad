"""Containers: which wall is how far."""

import numpy as np

from fsi.meshes.geometry.containers import Box, HalfPlane


def test_distances_in_a_box() -> None:
    box = Box((-1.0, 0.0), (3.0, 2.0))
    d = box.distances(np.array([[0.0, 0.5], [3.5, 1.0]]))
    assert box.walls == ("left", "right", "bottom", "top")
    np.testing.assert_array_equal(d, [[1.0, 3.0, 0.5, 1.5], [4.5, -0.5, 1.0, 1.0]])  # negative: outside


def test_distances_in_a_half_plane() -> None:
    half = HalfPlane(10.0)
    d = half.distances(np.array([[3.0, 4.0], [0.0, -1.0], [6.0, 9.0]]))
    assert half.walls == ("plane", "far")
    np.testing.assert_allclose(d, [[4.0, 5.0], [-1.0, 9.0], [9.0, 10.0 - np.sqrt(117.0)]], rtol=1e-15)


def test_no_distance_inside_exceeds_the_size() -> None:
    assert Box((-1.0, 0.0), (3.0, 3.0)).size() == 5.0  # 3-4-5 triangle
    assert HalfPlane(10.0).size() == 20.0


def test_corner_axes_are_the_normals_at_the_corners() -> None:
    assert Box((0.0, 0.0), (1.0, 1.0)).corner_axes == (0, 0, 1, 1)
    assert HalfPlane(1.0).corner_axes == (1, 0)
