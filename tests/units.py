"""Systems of units, and small cases in any of them."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from fsi.bodies.configuration import Array


@dataclass(frozen=True)
class System:
    """What the unit of a length, a viscosity and a time of a case is called in other units."""

    length: float
    viscosity: float
    time: float

    @property
    def velocity(self) -> float:
        return self.length / self.time

    @property
    def stress(self) -> float:
        return self.viscosity / self.time

    def force(self, geometry: str) -> float:
        """In the plane per unit length."""
        return self.stress * self.length ** (1 if geometry == "planar" else 2)

    def density(self) -> float:
        """So that mass / time^2 is a force over a length."""
        return self.viscosity * self.time / self.length**2

    def __str__(self) -> str:
        return f"{self.length:g}, {self.viscosity:g}, {self.time:g}"


ONE = System(1.0, 1.0, 1.0)
# Among them no power of two, the ends of what is promised, an inch and a minute.
SYSTEMS = (
    System(1e3, 1.0, 1.0),
    System(1.0, 1e-8, 1.0),
    System(1e-9, 1e12, 1e-9),
    System(1e9, 1e-12, 1e9),
    System(0.0254, 47.88, 60.0),
    System(1e-6, 1e-3, 1e-3),
)


def arms(M: int, dimension: int, length: float) -> Array:
    """1 for translations, a length for rotations, (M,)."""
    return np.repeat([1.0, length], [dimension, M - dimension])


COARSE = {"cells_per_circle": 16, "growth": 0.5}


def planar(s: System) -> dict[str, Any]:
    """A disc of radius 1 and a lesser one, loaded, in a box with a lid."""
    a, V, F = s.length, s.velocity, s.force("planar")
    first = {"name": "a", "radius": a, "position": [-1.1 * a, 0.0]}
    loads = {"force": [0.3 * F, -1.1 * F], "torque": 0.2 * F * a}
    second = {"name": "b", "radius": 0.8 * a, "position": [1.0 * a, 0.2 * a], **loads}
    walls = {"top": [0.7 * V, 0.0], "left": {"pressure": 0.4 * s.stress}}
    box = {"shape": "box", "lower": [-3 * a, -3 * a], "upper": [3 * a, 3 * a], "walls": walls}
    return _case(s, domain=box, discretisation=COARSE, bodies=[first, second])


def axisymmetric(s: System) -> dict[str, Any]:
    """A sphere that sinks towards a plane."""
    a, F = s.length, s.force("axisymmetric")
    ball = {"name": "a", "radius": a, "position": [0.0, 1.3 * a], "force": [0.0, -0.4 * F]}
    domain = {"shape": "half-plane", "radius": 20 * a}
    return _case(s, geometry="axisymmetric", domain=domain, discretisation=COARSE, bodies=[ball])


def spatial(s: System) -> dict[str, Any]:
    """A sphere that moves and is turned in a ball."""
    a, V, F = s.length, s.velocity, s.force("spatial")
    ball = {"name": "a", "radius": a, "position": [-1.1 * a, 0.0, 0.1 * a], "velocity": [V, 0.0, 0.0]}
    ball |= {"torque": [0.0, F * a, 0.0]}
    sizes = {"degree": 2, "cells_per_circle": 8, "growth": 1.0}
    domain = {"shape": "round", "radius": 4 * a}
    return _case(s, geometry="spatial", domain=domain, discretisation=sizes, bodies=[ball])


def cell(s: System) -> dict[str, Any]:
    """Two discs that repel each other in a sheared cell."""
    a = s.length
    first = {"name": "a", "radius": a, "position": [0.0, 0.0]}
    second = {"name": "b", "radius": 0.8 * a, "position": [2.0 * a, 0.2 * a]}
    vectors = [[5.0 * a, 0.0], [0.0, 5.0 * a]]
    force: dict[str, Any] = {"kind": "repulsion", "law": "exponential", "strength": s.force("planar")}
    force |= {"length": 0.1 * a, "cutoff": a}
    domain: dict[str, Any] = {"shape": "cell", "vectors": vectors, "shear": 0.5 / s.time}
    return _case(s, domain=domain, discretisation=COARSE, bodies=[first, second], forces=[force])


def channel(s: System) -> dict[str, Any]:
    """A disc in a channel of given flux."""
    a = s.length
    domain: dict[str, Any] = {
        "shape": "box",
        "lower": [0.0, 0.0],
        "upper": [5.0 * a, 4.0 * a],
        "periodic": ["x"],
    }
    domain |= {"net_flux": 2.0 * a * s.velocity, "walls": {"top": [0.3 * s.velocity, 0.0]}}
    disc = {"name": "a", "radius": a, "position": [2.0 * a, 1.5 * a]}
    return _case(s, domain=domain, discretisation=COARSE, bodies=[disc])


def _case(s: System, **sections: Any) -> dict[str, Any]:
    return {"name": "units", "fluid": {"viscosity": s.viscosity}, **sections}
