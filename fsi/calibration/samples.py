"""Samples of a resistance, and the cache that keeps each of them for ever."""

from __future__ import annotations

import hashlib
import json
from dataclasses import asdict, dataclass
from importlib import metadata
from pathlib import Path

import numpy as np

from fsi.bodies.configuration import Array
from fsi.calibration.pair import Pair
from fsi.files import replace

_PACKAGE = Path(__file__).parents[1]
# What computes a sample besides its case.
_SOLVERS = ("fenics-dolfinx", "dolfinx-solver-real", "gmsh", "petsc4py")


@dataclass(frozen=True, slots=True)
class Sample:
    """A resolved resistance.

    Attributes:
        gap: d.
        held_out: whether it tests the law instead of making it.
        kappa: F/U.
        mesh_error: bound of what mesh and elements do.
        truncation: change of kappa in a container of half the radius, 0 without one.
        dofs: unknowns.
        defect: worst of the identities.
        seconds: CPU seconds for all of it.
    """

    gap: float
    held_out: bool
    kappa: float
    mesh_error: float
    truncation: float
    dofs: int
    defect: float
    seconds: float

    @property
    def error(self) -> float:
        """The error bar of kappa."""
        return self.mesh_error + self.truncation


@dataclass(frozen=True, slots=True)
class Samples:
    """Samples as arrays: gaps d, resistances kappa and their bars, increasing in d, shapes (n,)."""

    d: Array
    kappa: Array
    bars: Array


def as_arrays(samples: list[Sample], *, held_out: bool) -> Samples:
    """Those samples that make the law, or those that test it."""
    chosen = sorted((one for one in samples if one.held_out is held_out), key=lambda one: one.gap)
    columns = [[getattr(one, name) for one in chosen] for name in ("gap", "kappa", "error")]
    return Samples(*(np.array(column, dtype=float) for column in columns))


def planned_gaps(pair: Pair) -> list[tuple[float, bool]]:
    """(gap, held out) of all samples: the range in equal ratios, and middles of intervals spread over it."""
    plan = pair.plan
    gaps = np.geomspace(*plan.range, plan.samples)
    middles = np.sqrt(gaps[1:] * gaps[:-1])
    chosen = middles[np.unique(np.linspace(0, len(middles) - 1, plan.held_out).round().astype(int))]
    return [(gap, False) for gap in gaps.tolist()] + [(gap, True) for gap in chosen.tolist()]


def key_of(pair: Pair, gap: float) -> str:
    """What names a sample: a hash of the case at the gap, of the mode, and of all code that computes it."""
    case = pair.at(gap).model_dump(mode="json", exclude={"name"})
    content = {"case": case, "pair": pair.plan.pair, "mode": pair.plan.mode, "code": _code()}
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()[:32]


def read_sample(cache: Path, key: str, *, held_out: bool) -> Sample | None:
    """A sample that has been computed before, or None."""
    path = cache / f"{key}.json"
    if not path.is_file():
        return None
    return Sample(**(json.loads(path.read_text(encoding="utf-8")) | {"held_out": held_out}))


def keep_sample(cache: Path, key: str, sample: Sample) -> None:
    """Put a sample into the cache."""
    replace(cache / f"{key}.json", json.dumps(asdict(sample)).encode())


def _code() -> str:
    """Hash of the sources of mesh and resolved model, and the versions of the libraries that they use."""
    sources = hashlib.sha256()
    for folder in (_PACKAGE / "meshes", _PACKAGE / "stokes"):
        for path in sorted(folder.rglob("*.py")):
            sources.update(path.read_bytes())
    for name in _SOLVERS:
        try:
            sources.update(f"{name} {metadata.version(name)}".encode())
        except metadata.PackageNotFoundError:  # one of two names of the same library
            continue
    return sources.hexdigest()
