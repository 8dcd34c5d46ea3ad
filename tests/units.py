"""Systems of units, and small cases in any of them."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from fsi.arrays import Array


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

    @property
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


def settling(s: System, model: str = "reduced", **sections: Any) -> dict[str, Any]:
    """Two discs that fall onto a plane, one beside the other."""
    a, T, F = s.length, s.time, s.force("planar")
    first = {"name": "a", "radius": a, "position": [-1.1 * a, 1.3 * a], "force": [0.0, -8.0 * F]}
    second = {"name": "b", "radius": 0.8 * a, "position": [0.9 * a, 1.7 * a], "force": [0.3 * F, -6.0 * F]}
    domain = {"shape": "half-plane", "radius": 20.0 * a}
    reduced = {"law": "exact", "drag": 50.0, "cutoff": 0.5 * a}
    time = {"end": 0.4 * T, "tolerance": 1e-3}
    given = {"domain": domain, "bodies": [first, second], "time": time, "reduced": reduced}
    return _case(s, model=model, **(given | {"discretisation": COARSE} | sections))


def with_memory(s: System) -> dict[str, Any]:
    """The same with masses and the distance scheme."""
    case = settling(s, time={"end": 0.4 * s.time, "scheme": "distance", "step": 0.01 * s.time})
    mass = s.density * s.length**2
    bodies = [
        body | {"mass": 0.1 * mass, "moment_of_inertia": 0.05 * mass * s.length**2} for body in case["bodies"]
    ]
    return case | {"bodies": bodies}


def gluey(s: System, **keys: Any) -> dict[str, Any]:
    """Five discs that fall into a corner and are pulled off."""
    a, T = s.length, s.time
    g = a / T**2
    places = [(1.3, 1.2), (3.6, 1.43), (2.5, 3.3), (1.4, 5.4), (4.1, 3.9)]
    bodies = [
        {"name": f"d{k}", "radius": (1.0 - 0.05 * k) * a, "position": [x * a, y * a]}
        for k, (x, y) in enumerate(places)
    ]
    times = [0.0, 3.0 * T, 3.0 * T]
    pull = [
        {"times": times, "values": [-0.3 * g, -0.3 * g, 0.2 * g]},
        {"times": times, "values": [-g, -g, g]},
    ]
    forces = [{"kind": "gravity", "acceleration": pull}]
    domain = {"shape": "box", "lower": [0.0, 0.0], "upper": [20.0 * a, 20.0 * a]}
    time = {"end": 5.0 * T, "step": 0.1 * T}
    sections = {"model": "gluey", "domain": domain, "bodies": bodies, "forces": forces, "time": time}
    return {"name": "units", "gluey": {"density": s.density, **keys}, **sections}


def rough(s: System) -> dict[str, Any]:
    """Three of them with friction at solid contacts."""
    impulse = s.force("planar") * s.time
    case = gluey(s, gamma_min=-0.5 * impulse, friction=0.3, tangential=0.2)
    return case | {"bodies": case["bodies"][:3], "time": {"end": 4.0 * s.time, "step": 0.1 * s.time}}


def films(s: System) -> dict[str, Any]:
    """The same with films of a viscosity before the limit."""
    return gluey(s, variant="film", eps=0.01 * s.viscosity * s.length, reference_gap=0.05 * s.length)


def on_a_line(s: System) -> dict[str, Any]:
    """Three discs on a line, pushed together and pulled apart, by the macroscopic model."""
    a, T = s.length, s.time
    mass, F = s.density * a**2, s.density * a**3 / T**2
    free = {"velocity": ["free", 0.0], "angular_velocity": 0.0}
    bodies = [
        {
            "name": f"d{k}",
            "radius": a,
            "position": [x * a, 0.0],
            "mass": mass,
            "moment_of_inertia": mass * a**2,
            # Not at the end of a step, where rounding would say on which side of the jump it is.
            "force": [{"times": [0.0, 2.02 * T, 2.02 * T], "values": [-k * F, -k * F, k * F]}, 0.0],
            **free,
        }
        for k, x in enumerate((0.0, 2.5, 6.0))
    ]
    time = {"end": 4.0 * T, "step": 0.05 * T}
    sections = {"model": "macroscopic", "domain": {"shape": "unbounded"}, "bodies": bodies, "time": time}
    return {"name": "units", "macroscopic": {"parcels": 30}, **sections}


def blocks(s: System) -> dict[str, Any]:
    """Two blocks, with formulas in the user's units."""
    a, T = s.length, s.time
    given = [
        {"left": -2.0 * a, "right": -a, "density": 0.5, "initial_velocity": f"-x/{T!r}"},
        {"left": a, "right": 3.0 * a, "density": 0.7, "initial_velocity": f"-x/{T!r}"},
    ]
    macroscopic = {
        "parcels": 38,
        "blocks": given,
        "force_per_mass": f"where(t > {1.5 * T!r}, x, -x)/{T * T!r}",
    }
    time = {"end": 3.0 * T, "step": 0.05 * T}
    sections = {"model": "macroscopic", "domain": {"shape": "unbounded"}, "time": time}
    return {"name": "units", "macroscopic": macroscopic, **sections}


def above_a_wall(s: System) -> dict[str, Any]:
    """One disc that is pushed onto a plane and pulled off, for `fsi limit`."""
    a, T = s.length, s.time
    mass, F = s.density * a**2, s.density * a**3 / T**2
    force = {"times": [0.0, T, T], "values": [-2.0 * F, -2.0 * F, 1.5 * F]}
    disc = {"name": "disc", "radius": a, "position": [0.0, 1.5 * a], "force": [0.0, force]}
    disc |= {
        "mass": mass,
        "moment_of_inertia": mass * a**2,
        "velocity": [0.0, "free"],
        "angular_velocity": 0.0,
    }
    domain = {"shape": "half-plane", "radius": 1e3 * a}
    time, limit = (
        {"end": 3.0 * T, "step": 0.05 * T},
        {"eps": [0.1 * a / T, 1e-4 * a / T, 1e-8 * a / T], "steps": [50]},
    )
    sections = {"model": "gluey", "domain": domain, "bodies": [disc], "time": time, "limit": limit}
    return {"name": "units", **sections}


def calibrated(s: System) -> dict[str, Any]:
    """A disc beside a plane, whose resistance is sampled."""
    a = s.length
    disc = {"name": "disc", "radius": a, "position": [0.0, 2.0 * a]}
    domain = {"shape": "half-plane", "radius": 50.0 * a}
    calibration = {"pair": ["disc", "plane"], "range": [1e-2 * a, a], "samples": 6, "held_out": 2}
    return _case(s, domain=domain, bodies=[disc], calibration=calibration, discretisation=COARSE)
