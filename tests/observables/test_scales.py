"""How changes of results are counted."""

import numpy as np
import pytest

from fsi.integration.errors import ErrorEstimate
from fsi.observables.scales import ROUNDING, FlowScales, relative_change


def test_changes_count_torques_over_the_radius_and_rotations_times_it() -> None:
    """Radius 2; a body held with F = (10, 0) and T = 8, another free with V = (0, 3) and omega = 4."""
    U, F = np.array([[0.0, 0.0, 0.0], [0.0, 3.0, 4.0]]), np.array([[10.0, 0.0, 8.0], [0.0, 0.0, 0.0]])
    held = np.array([[True] * 3, [False] * 3])
    arm = np.array([[1.0, 1.0, 2.0]] * 2)
    change = ErrorEstimate(np.array([[0.0] * 3, [0.0, 0.02, 0.04]]), np.array([[0.01, 0.0, 0.06], [0.0] * 3]))
    found = relative_change(ErrorEstimate(U, F), change, held, arm, FlowScales(1.0, 1.0))
    assert found == {"force": pytest.approx(0.03 / 10.0), "velocity": pytest.approx(0.08 / 8.0)}


def test_what_is_zero_by_symmetry_counts_over_a_hundredth_of_what_drives_the_flow() -> None:
    """Velocities of 1e-9 where walls shear with 5: over 0.05."""
    noise = ErrorEstimate(np.full((1, 3), 1e-9), np.zeros((1, 3)))
    free = np.zeros((1, 3), dtype=bool)
    found = relative_change(noise, noise, free, np.ones((1, 3)), FlowScales(5.0, 1.0))
    assert found["velocity"] == pytest.approx(1e-9 / 0.05)


def test_a_free_body_in_a_pressure_all_around_is_at_rest() -> None:
    """Velocities up to the load that rounding leaves over the resistance, 1e-11 times 3 / 2, are none."""
    scales = FlowScales(0.0, 2.0, 3.0)
    free, arm = np.zeros((1, 3), dtype=bool), np.ones((1, 3))
    for part, expected in ((0.9, 0.0), (1.1, 1.0)):
        noise = ErrorEstimate(np.full((1, 3), part * ROUNDING * 1.5), np.zeros((1, 3)))
        assert relative_change(noise, noise, free, arm, scales) == {"velocity": pytest.approx(expected)}
