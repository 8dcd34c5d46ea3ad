"""A model of NumPy only: discs that feel the plane y = 0 by the closed forms, and not each other."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration, Inertia
from fsi.case.case import Case
from fsi.case.load import parse_case
from fsi.integration.errors import ErrorEstimate, StepErrors
from fsi.integration.state import Instant, Model
from fsi.lubrication.exact import normal_resistance, parallel_resistance, rotation_resistance
from fsi.models import stepped
from fsi.runs import MakeEvolution


@dataclass(frozen=True)
class ExactInstant:
    """U, F of shape (N, 3), and nothing of a flow; its files hold the bytes of U."""

    U: Array
    F: Array
    record: Mapping[str, float] = field(default_factory=dict)
    body_columns: ClassVar[Mapping[str, Array]] = {}
    dissipation: ClassVar[float] = math.nan
    apparent_viscosity: ClassVar[None] = None
    bulk: ClassVar[None] = None
    wall_speeds: ClassVar[Mapping[str, float]] = {}
    shear_rate: ClassVar[None] = None
    dp_dx: ClassVar[None] = None
    flux: ClassVar[None] = None

    def write(self, folder: Path, step: int) -> dict[str, list[str]]:
        fluid = [f"fluid_{step:06d}_{part}.vtu" for part in range(2)]
        surface = [f"surface_{step:06d}_0.vtu"]
        for name in fluid + surface:
            (folder / name).write_bytes(self.U.tobytes())
        return {"fluid": fluid, "surface": surface}


@dataclass
class DiscsBesidePlane:
    """Diagonal resistance of each disc beside the plane.

    noise: a relative perturbation that depends on how often the model was called before, as the mesh
    of a resolved model depends on the meshes before it: resuming must restore that number.
    """

    case: Case
    noise: float = 0.0
    calls: int = 0

    def resistance(self, q: Configuration) -> Array:
        """R of each mode, shape (N, 3)."""
        gap = q.centres[:, 1] - q.radii
        mu = self.case.fluid.viscosity
        laws = (parallel_resistance, normal_resistance, rotation_resistance)
        return np.column_stack([law(gap, q.radii, mu) for law in laws])

    def __call__(self, q: Configuration, t: float, inertia: Inertia | None = None) -> ExactInstant:
        self.calls += 1
        motion, inertia = self.case.motion_at(q, t).under(inertia)
        R = self.resistance(q)
        inertia = inertia or Inertia(np.zeros_like(R), np.zeros_like(R))
        free = (motion.F + inertia.D * inertia.U0) / (R + inertia.D) * (1 + self.noise * np.sin(self.calls))
        U = np.where(motion.held, motion.U, free)
        return ExactInstant(U, R * U, {"cpu_solve": 0.5, "residual": 1e-16 * self.calls})

    def errors(self, q: Configuration, t: float, instant: Instant) -> StepErrors:  # noqa: ARG002
        nothing = np.zeros_like(instant.U)
        return StepErrors(ErrorEstimate(1e-6 * t * np.abs(instant.U), nothing), {"velocity": 1e-6 * t})

    def state(self) -> dict[str, NDArray[Any]]:
        return {"calls": np.array(self.calls)}

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        self.calls = int(state["calls"])


def by(model: Callable[[Case], Model]) -> MakeEvolution:
    """What steps a case with such a model."""
    return lambda case: stepped(case, model(case))


def plane_case(bodies: list[dict[str, Any]], end: float, **time: Any) -> Case:
    """Bodies above a plane, far from everything else; `time` adds to the section of that name."""
    return parse_case(
        {
            "name": "test",
            "fluid": {"viscosity": 1.0},
            "domain": {"shape": "half-plane", "radius": 1000.0},
            "bodies": bodies,
            "time": {"end": end, **time},
        }
    )


def settling_case(end: float, **more: Any) -> Case:
    """A disc of radius 1 at gap 1 under the force that makes time tau of settling.json."""
    body = {"name": "disc", "radius": 1.0, "position": [0.0, 2.0], "force": [0.0, -4 * math.pi]}
    return plane_case([body | more.pop("body", {})], end, **more)
