"""The one line that each mistake in a periodic domain gives."""

from __future__ import annotations

from typing import Any

import pytest

from fsi.case import parse_case
from fsi.errors import InputError
from tests.case_data import changed

CHANNEL = {"lower": [-8.0, 0.0], "upper": [8.0, 16.0], "periodic": ["x"]}
CELL = {"shape": "cell", "vectors": [[8.0, 0.0], [1.0, 8.0]]}


@pytest.mark.parametrize(
    ("domain", "parts"),
    [
        (CHANNEL | {"periodic": ["z"]}, ["domain.periodic", '"x"']),
        (CHANNEL | {"walls": {"left": [0.0, 1.0]}}, ["domain.walls", "no wall left", "drop walls.left"]),
        (CHANNEL | {"walls": {"botom": [0.0, 1.0]}}, ["domain.walls", "bottom"]),
        (CHANNEL | {"upper": [-9.0, 16.0]}, ["domain.upper", "right of and above"]),
        (CHANNEL | {"net_flux": 1.0, "pressure_gradient": 2.0}, ["domain.net_flux", "drop one"]),
        (CHANNEL | {"mesh": "own.msh"}, ["domain.mesh", "drop it"]),
        (CHANNEL | {"presure_gradient": 1.0}, ["domain.presure_gradient", "use domain.pressure_gradient"]),
        (CHANNEL | {"upper": [-4.5, 16.0]}, ["bodies.", "overlap", "move them apart"]),
        (CELL | {"vectors": [[8.0, 0.0], [16.0, 0.0]]}, ["domain.vectors", "parallel"]),
        (CELL | {"vectors": [[8.0, 0.0]]}, ["domain.vectors"]),
        (
            CELL | {"vectors": [[1.9, 0.0], [0.0, 8.0]]},
            ["bodies.0.position", "its image", "overlap"],
        ),
        (CELL | {"shear": 1.0, "extension": 1.0}, ["domain.extension", "drop one"]),
        (CELL | {"walls": {"top": [1.0, 0.0]}}, ["domain.walls", "no walls", "drop it"]),
    ],
)
def test_mistakes(domain: dict[str, Any], parts: list[str]) -> None:
    with pytest.raises(InputError) as caught:
        parse_case(changed("domain", domain))
    assert "\n" not in str(caught.value)
    for part in parts:
        assert part in str(caught.value)


@pytest.mark.parametrize("domain", [CHANNEL, CELL])
def test_only_planar_domains_are_periodic(domain: dict[str, Any]) -> None:
    body = {"name": "ball", "radius": 1.0, "position": [0.0, 3.0]}
    data = changed("bodies", [body]) | {"domain": domain, "geometry": "axisymmetric"}
    with pytest.raises(InputError, match="planar"):
        parse_case(data)


def test_bodies_of_a_cell_have_no_inertia() -> None:
    body = {"name": "disc", "radius": 1.0, "position": [0.0, 3.0], "mass": 1.0, "moment_of_inertia": 1.0}
    with pytest.raises(InputError, match=r"bodies\.0\.mass = 1\.0: .*no inertia; drop it"):
        parse_case(changed("bodies", [body]) | {"domain": CELL})


def test_the_iterative_solver_is_not_for_periodic_domains() -> None:
    data = changed("domain", CHANNEL) | {"discretisation": {"solver": "iterative"}}
    with pytest.raises(InputError, match=r'discretisation\.solver = "iterative"'):
        parse_case(data)
