"""Samples of a resistance, and the files that keep them in a cache."""

import json
from dataclasses import asdict, dataclass, fields
from math import inf
from pathlib import Path
from typing import Any

import numpy as np

from fsi.arrays import Array
from fsi.case.section import toml_text
from fsi.errors import InputError
from fsi.files import content, plain, replace

_FLAGS = ("held_out", "mesh_instead")  # what a sample has besides numbers >= 0
_SAME = 1e-6  # of a gap: of bodies in the same places, but for rounding


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
        mesh_instead: whether the sizes of the case gave no valid mesh, so that others were taken.
    """

    gap: float
    held_out: bool
    kappa: float
    mesh_error: float
    truncation: float
    dofs: int
    defect: float
    seconds: float
    mesh_instead: bool = False

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


def read_sample(cache: Path, key: str, gap: float, *, held_out: bool) -> Sample | None:
    """A sample at a gap that has been computed before, or None. Raises InputError: its file is damaged."""
    if not (path := cache / f"{key}.json").exists():
        return None
    remedy = "remove it, and it is computed again"
    try:
        data = plain(json.loads(content(path, remedy)))
    except (ValueError, RecursionError):
        data = None
    if wrong := _wrong_in_sample(data, gap):
        raise InputError(f"{path}: is damaged, {wrong}; {remedy}")
    return Sample(**(data | {"held_out": held_out}))


def _wrong_in_sample(data: Any, gap: float) -> str | None:
    """Why data are no sample at the gap."""
    if not (isinstance(data, dict) and set(data) == {field.name for field in fields(Sample)}):
        return "it is no sample"
    for key, value in data.items():
        is_number = isinstance(value, int | float) and not isinstance(value, bool)
        right = is_number and 0.0 <= value < inf and (value > 0.0 or key != "kappa")
        if not (isinstance(value, bool) if key in _FLAGS else right):
            return f"it has {key} = {toml_text(value)}"
    same_gap = abs(data["gap"] - gap) <= _SAME * gap
    return None if same_gap else f"it has gap = {data['gap']:g} in place of {gap:g}"


def keep_sample(cache: Path, key: str, sample: Sample) -> None:
    """Put a sample into the cache."""
    replace(cache / f"{key}.json", json.dumps(asdict(sample)).encode())
