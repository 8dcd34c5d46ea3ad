"""Steps do not depend on which images a case names: sizes of rates and errors, and runs of given flows."""

from __future__ import annotations

from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration, Inertia
from fsi.integration.displacements import Displacements
from fsi.integration.schemes import BogackiShampine
from fsi.integration.state import Schedule
from fsi.integration.stepper import Stepper
from fsi.meshes.geometry.cell import Cell
from fsi.meshes.geometry.lattice import unit_shear
from tests.exact_model import ExactInstant
from tests.integration.stepping import run
from tests.integration.test_schemes import Field

STILL, SHEAR, EXTENSION = np.zeros((2, 2)), unit_shear(2), np.diag([1.0, -1.0])
IMAGES = [((0, 0), (0, 0)), ((0, 3), (0, 3)), ((1, -200), (-3, 200))]


def cell(gradient: Array) -> Cell:
    return Cell(((9.0, 0.0), (0.0, 8.0)), tuple(map(tuple, gradient.tolist())))


def pair(images: tuple[tuple[int, int], tuple[int, int]], apart: tuple[float, float]) -> Configuration:
    """Discs of radius 1 of which these images are named, their nearest ones so far apart."""
    places = np.array([(0.0, 0.0), apart]) + np.array(images) * [9.0, 8.0]
    return Configuration.unturned(places, np.ones(2))


@pytest.mark.parametrize("images", IMAGES)
@pytest.mark.parametrize(
    ("given", "strain", "apart", "size"),
    [
        (SHEAR, 0.0, (1.5, 2.0), 1.5 * 2.0 / 2.5 / 0.5),
        (EXTENSION, 0.0, (0.7, 2.4), (2.4**2 - 0.7**2) / 2.5 / 0.5),
        (STILL, 1.0, (1.5, 2.0), 1.5 * 2.0 / 2.5 / 0.5),
        (STILL, 1.0, (2.5, 0.0), 1.0),
    ],
    ids=["sheared", "stretched", "sheared by a stress", "a strain"],
)
def test_rates_of_discs_that_a_lattice_carries_are_those_of_their_gap(
    given: Array,
    strain: float,
    apart: tuple[float, float],
    size: float,
    images: tuple[tuple[int, int], tuple[int, int]],
) -> None:
    """With u = G x, |r.G r| / (|r| gap), for any images; rates of images were added, up to 1600."""
    q, gradient = pair(images, apart), given + strain * unit_shear(2)
    rates = np.zeros((2 + (strain != 0.0), 3))
    rates[:2, :2], rates[2:, 0] = q.centres @ gradient.T, strain
    # Gaps are differenced over a thousandth.
    assert Displacements(q, cell(given), rates, gradient).size() == pytest.approx(size, rel=1e-3)


def periodic(q: Configuration, t: float) -> Array:
    """A shear that grows, and what is of period 8 along y."""
    _, y = q.centres.T
    phase = 2.0 * np.pi * y / 8.0
    along = rate(t) * y + 0.3 * np.sin(phase)
    return np.column_stack([along, 0.4 * np.cos(phase), np.full(2, -0.5)])


def rate(t: float) -> float:
    return 1.0 + 0.5 * t**3


class Stressed(Field):
    """The same by a stress, whose shear the lattice has too."""

    def __call__(self, q: Configuration, t: float, _: Inertia | None = None) -> ExactInstant:
        return cast(ExactInstant, SimpleNamespace(U=self.velocity(q, t), shear_rate=rate(t)))


def steady(q: Configuration, _: float) -> Array:
    return periodic(q, 0.0)


@pytest.mark.parametrize(
    ("model", "gradient"), [(Field(steady), SHEAR), (Stressed(periodic), STILL)], ids=["given", "by a stress"]
)
def test_any_images_of_bodies_in_a_sheared_cell_make_the_same_steps(model: Field, gradient: Array) -> None:
    """First steps were shorter by the velocity, up to 2000 times, and others by errors of the strain."""
    runs = []
    for images in IMAGES:
        stepper = Stepper(model, BogackiShampine(), cell(gradient), "ab", Schedule(1.0), 1e-4, 0.2, 1e-9)
        runs.append([step.state.t for step in run(stepper, pair(images, (1.5, 2.5)))])
    assert len(runs[0]) > 5
    for times in runs[1:]:
        np.testing.assert_allclose(times, runs[0], rtol=1e-8)
