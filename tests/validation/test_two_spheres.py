"""Exact results of two spheres as a case names them: signs, bodies, and where they are not known."""

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fsi.case.load import load_case
from fsi.errors import InputError
from fsi.lubrication.spheres import line_forces
from fsi.lubrication.two_spheres import in_far_ball, pair_matrix
from fsi.validation.rows import exact_value

FOLDER = Path(__file__).parents[2] / "cases" / "validation"
HELD, FREE = FOLDER / "two_spheres_in_space.toml", FOLDER / "two_free_spheres_in_space.toml"


def test_forces_on_held_spheres() -> None:
    """Those of the fluid, against the motion of the first; in so large a ball those without container."""
    case = load_case(HELD, ["domain.radius=1e9"])
    along = line_forces(0.1, (1.0, 1.0), 1.0, (1.0, 0.0))
    for name, force in zip(("first", "second"), along, strict=True):
        assert_allclose(exact_value(case, "sphere_pair", f"{name}.force.z"), -force, rtol=1e-8)
    R = pair_matrix(case.configuration().centres, (1.0, 1.0), 1.0)
    for name, row in (("first.force.x", 0), ("first.torque.y", 4), ("second.torque.x", 9)):
        loads = R[row, :6] @ [1.0, 0.0, 1.0, 1.0, 0.0, 1.0]
        assert_allclose(exact_value(case, "sphere_pair", name), -loads, rtol=1e-6)


def test_velocities_of_free_spheres() -> None:
    case = load_case(FREE)
    q = case.configuration()
    mobility = in_far_ball(np.linalg.inv(pair_matrix(q.centres, (1.0, 1.0), 1.0)), 80.0, 1.0)
    U = mobility @ case.motion_at(q, 0.0).F.ravel()
    for row, name in ((0, "first.velocity.x"), (11, "second.angular_velocity.z")):
        assert_allclose(exact_value(case, "free_sphere_pair", name), U[row], rtol=1e-12)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        (["bodies.1.position.2=1.0001"], "multipoles, more than 1000; widen it"),
        (["domain.radius=20.0"], "domain.radius = 20: need 21 at least"),
    ],
)
def test_where_it_is_not_known(changes: list[str], said: str) -> None:
    case = load_case(HELD, changes)
    with pytest.raises(InputError, match=f'exact = "sphere_pair": .*{said}; give a value'):
        exact_value(case, "sphere_pair", "first.force.x")
