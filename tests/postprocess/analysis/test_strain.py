"""The strain of sheared suspensions."""

import numpy as np
import pytest

from fsi.case.case import Case
from fsi.case.load import parse_case
from fsi.postprocess.analysis.strain import accumulated_strain


def sheared(**domain: object) -> Case:
    """A case of one disc."""
    body = {"name": "disc", "radius": 0.5, "position": [2.0, 2.0]}
    return parse_case({"name": "sheared", "fluid": {"viscosity": 1.0}, "domain": domain, "bodies": [body]})


def channel(top: object) -> Case:
    return sheared(lower=[0.0, 0.0], upper=[4.0, 4.0], periodic=["x"], walls={"top": top})


@pytest.mark.parametrize(
    ("case", "rate"),
    [
        (channel([8.0, 0.0]), 2.0),
        (sheared(shape="cell", vectors=[[4.0, 0.0], [0.0, 4.0]], shear=3.0), 3.0),
        (sheared(shape="cell", vectors=[[4.0, 0.0], [0.0, 4.0]], extension=3.0), 6.0),
    ],
    ids=["walls", "shear", "extension"],
)
def test_rate_of_walls_and_of_cells(case: Case, rate: float) -> None:
    strain = accumulated_strain(case, np.array([0.0, 0.5, 2.0]))
    assert strain is not None
    np.testing.assert_allclose(strain, np.array([0.0, 0.5, 2.0]) * rate)


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
