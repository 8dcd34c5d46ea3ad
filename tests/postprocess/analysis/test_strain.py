"""The strain of sheared suspensions."""

import numpy as np
import pytest

from fsi.case.case import Case
from fsi.case.load import parse_case
from fsi.postprocess.analysis.strain import accumulated_strain, strain_rate


def sheared(**domain: object) -> Case:
    """A case of one disc."""
    body = {"name": "disc", "radius": 0.5, "position": [2.0, 2.0]}
    return parse_case({"name": "sheared", "fluid": {"viscosity": 1.0}, "domain": domain, "bodies": [body]})


def channel(top: object) -> Case:
    return sheared(lower=[0.0, 0.0], upper=[4.0, 4.0], periodic=["x"], walls={"top": top})


def channel_in_space(top: list[object], bottom: list[object]) -> Case:
    """One of height 4 whose walls do not stand symmetrically, of one sphere."""
    domain = {"lower": [0.0, 0.0, -1.0], "upper": [4.0, 4.0, 3.0], "periodic": ["x", "y"]}
    walls = {"top": top, "bottom": bottom}
    ball = {"name": "ball", "radius": 0.5, "position": [2.0, 2.0, 1.0]}
    return parse_case(
        {
            "name": "in space",
            "geometry": "spatial",
            "fluid": {"viscosity": 1.0},
            "domain": domain | {"walls": walls},
            "bodies": [ball],
        }
    )


@pytest.mark.parametrize(
    ("case", "rate"),
    [
        (channel([8.0, 0.0]), 2.0),
        (channel([-8.0, 0.0]), -2.0),
        (channel_in_space([6.0, 0.0, 0.0], [-2.0, 0.0, 0.0]), 2.0),
        (channel_in_space([0.0, -6.0, 0.0], [0.0, 2.0, 0.0]), -2.0),
        (sheared(shape="cell", vectors=[[4.0, 0.0], [0.0, 4.0]], shear=3.0), 3.0),
        (sheared(shape="cell", vectors=[[4.0, 0.0], [0.0, 4.0]], extension=3.0), 6.0),
    ],
    ids=["walls", "backwards", "in space", "along y", "shear", "extension"],
)
def test_rate_of_walls_and_of_cells(case: Case, rate: float) -> None:
    """(u_top - u_bottom) / H between walls, sqrt(2 E:E) of cells."""
    strain = accumulated_strain(case, np.array([0.0, 0.5, 2.0]))
    assert strain is not None
    np.testing.assert_allclose(strain, np.array([0.0, 0.5, 2.0]) * rate)


def test_strain_rate_of_a_channel_in_space() -> None:
    """E_xz = E_zx = (u_top - u_bottom) / 2H = 1, all others are 0."""
    E = strain_rate(channel_in_space([6.0, 0.0, 0.0], [-2.0, 0.0, 0.0]), 0.0)
    np.testing.assert_array_equal(E, [[0.0, 0.0, 1.0], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0]])


def test_rate_that_varies_between_steps() -> None:
    """The wall speeds up and slows down within one step: the strain is the area of the triangle."""
    table = {"times": [0.0, 1.0, 2.0], "values": [0.0, 4.0, 0.0]}
    strain = accumulated_strain(channel([table, 0.0]), np.array([0.0, 2.0]))
    assert strain is not None
    assert strain[-1] == pytest.approx(1.0)


def test_rate_that_falls_over_a_step() -> None:
    """From 1 to 0 in 2: the strain is 1, where the rate at the start would give 2."""
    strain = accumulated_strain(
        channel([{"times": [0.0, 2.0], "values": [4.0, 0.0]}, 0.0]), np.array([0.0, 1.0, 2.0])
    )
    assert strain is not None
    np.testing.assert_allclose(strain, [0.0, 0.75, 1.0])


def test_no_strain_in_a_closed_box() -> None:
    assert accumulated_strain(sheared(lower=[0.0, 0.0], upper=[4.0, 4.0]), np.array([0.0, 1.0])) is None
