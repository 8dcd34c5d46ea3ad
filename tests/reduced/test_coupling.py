"""How sliding and turning of a sphere are coupled beside a wall."""

from __future__ import annotations

import numpy as np
import pytest

from fsi.bodies.configuration import Configuration
from fsi.lubrication import sphere_beside_plane
from tests.reduced.test_tangential import resistance
from tests.reduced_data import ALL, reduced_case


@pytest.mark.parametrize("gap", [1e-6, 0.0453, 0.9])
def test_a_sphere_beside_a_plane_is_coupled_as_it_is(gap: float) -> None:
    """All of R is exact, less what it is at the cutoff; 1/4 of the diagonal is 1.6 times that at 0.0453."""
    ball = {"name": "ball", "radius": 2.0, "position": [0.0, 0.0, 2.0 * (1.0 + gap)]}
    given, mu = ALL | {"law": "leading", "cutoff": 2.0}, 3.0
    R = resistance(reduced_case([ball], given, geometry="spatial", fluid={"viscosity": mu}))
    for k, law in (
        (0, sphere_beside_plane.parallel_resistance),
        (4, sphere_beside_plane.rotation_resistance),
    ):
        at, cut = law([2.0 * gap, 2.0], 2.0, mu)
        assert R[k, k] == pytest.approx(at - cut, rel=1e-6)
    # About y a positive rotation rolls the ball forwards along x, which is minus omega of the (x, y) plane.
    at, cut = sphere_beside_plane.coupling_resistance([2.0 * gap, 2.0], 2.0, mu)
    assert R[0, 4] == pytest.approx(cut - at, rel=1e-6)
    assert R[1, 3] == pytest.approx(-R[0, 4], rel=1e-9)


@pytest.mark.parametrize("cutoff", [0.01, 90.0])
def test_the_exact_coupling_leaves_the_resistance_positive(cutoff: float) -> None:
    """C^2 <= S R/16, its limit (Goldman, Cox and Brenner 1967), from the narrowest gaps to the cutoff.

    Without the coupling at the cutoff taken off, C^2 is 500 S R at the last gap.
    """
    ball = {"name": "ball", "radius": 1.0, "position": [0.0, 0.0, 1.5]}
    case = reduced_case([ball], ALL | {"law": "leading", "cutoff": cutoff}, geometry="spatial")
    for gap in (2e-16, 1e-12, 1e-9, 1e-4, 0.3 * cutoff, cutoff * (1.0 - 1e-6)):
        R = resistance(case, Configuration.unturned(np.array([[0.0, 0.0, 1.0 + gap]]), np.ones(1)))
        assert R[0, 0] > 0.0
        assert R[0, 4] == R[4, 0]
        assert R[0, 4] ** 2 <= 0.0625 * (1.0 + 1e-9) * R[0, 0] * R[4, 4]
