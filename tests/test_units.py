"""One case in other units, at all levels: runs and studies give the same numbers over their units."""

import csv
from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pytest

import fsi
from fsi.arrangements.arrangement import Wanted
from fsi.arrangements.kinds import arrange
from fsi.arrays import Array
from fsi.gluey.limit_study import study
from tests import units
from tests.units import ONE, SYSTEMS, System

# What is promised. A step that is chosen otherwise, or another mesh, changes 1e-5 and more.
SAME = 1e-9
# No powers of ten, an inch and a minute; the others take longer than they are worth each day.
FIRST = System(0.0254, 47.88, 60.0)
SYSTEMS_TO_TRY = [s if s == FIRST else pytest.param(s, marks=pytest.mark.slow) for s in SYSTEMS]

pytestmark = pytest.mark.filterwarnings("error")


def resolved(s: System) -> dict[str, Any]:
    """Two discs that settle, resolved, with error bars."""
    return units.settling(s, "resolved", output={"error_estimates": True})


def moved(s: System) -> dict[str, Any]:
    """The same on a mesh that is moved."""
    return units.settling(s, "resolved", time={"end": s.time, "tolerance": 1e-3, "remesh": "when-needed"})


def sheared(s: System) -> dict[str, Any]:
    """A sheared cell, with error bars."""
    time = {"end": 0.3 * s.time, "tolerance": 1e-3}
    return units.cell(s) | {"time": time, "output": {"error_estimates": True}}


LEVELS: dict[str, Callable[[System], dict[str, Any]]] = {
    kind.__name__: kind
    for kind in (
        units.settling, units.with_memory, units.gluey, units.rough, units.films, units.on_a_line,
        units.blocks, resolved, moved, sheared,
    )
}  # fmt: skip
# Defects of identities, which are rounding, counters, times of the processor.
NOT_RESULTS = {
    "power", "angular_momentum", "balance", "net_flux", "residual", "kernel", "invariant", "momentum_defect",
    "kkt", "overlap", "iterations", "newton_steps", "stress", "viscosity_bound",
}  # fmt: skip


def units_of(s: System) -> Mapping[str, float]:
    """Of the columns of all tables in the plane that have one."""
    a, T, V, F, p = s.length, s.time, s.velocity, s.force("planar"), s.stress
    impulse, mass = F * T, s.density * a**2
    of = {"t": T, "h": T, "smallest_gap": a, "gap": a, "x": a, "y": a, "drift": a}
    of |= {"V_x": V, "V_y": V, "omega": 1.0 / T, "F_x": F, "F_y": F, "T": F * a, "dissipation": F * V}
    of |= {"stress_xx": p, "stress_xy": p, "stress_yy": p, "N_1": p}
    of |= {"S_xx": F * a, "S_xy": F * a, "S_yy": F * a}
    of |= dict.fromkeys(("gamma", "smallest_gamma", "impulse", "solid_impulse"), impulse)
    return of | {"kinetic_energy": mass * V**2}


def on_a_line(s: System, mass: float) -> Mapping[str, float]:
    """Of those of the macroscopic model, with the unit of its mass."""
    V = s.velocity
    own = {"m": mass, "u": V, "gamma": mass * V, "smallest_gamma": mass * V, "momentum": mass * V}
    return {**units_of(s), **own, "kinetic_energy": mass * V**2}


def scaled_tables(kind: str, s: System) -> dict[str, Array]:
    """All numbers in the tables of a run, column by column, over their units."""
    # The mass of blocks is a length.
    masses = {"on_a_line": s.density * s.length**2, "blocks": s.length}
    macroscopic, columns = kind in masses, dict[str, Array]()
    unit = on_a_line(s, masses[kind]) if macroscopic else units_of(s)
    with TemporaryDirectory() as folder:
        fsi.run(fsi.make_case(**LEVELS[kind](s)), Path(folder) / "run")
        for path in sorted((Path(folder) / "run").glob("*.csv")):
            header, *rows = csv.reader(path.read_text().splitlines())
            for name, column in zip(header, zip(*rows, strict=True), strict=False):
                if name in NOT_RESULTS or name.startswith("cpu_") or (name == "momentum" and not macroscopic):
                    continue
                if name in ("body", "side", "name"):
                    columns[f"{path.stem}.{name}"] = np.array(column)
                    continue
                numbers = np.array(column, dtype=float)
                if name == "log10_stored_gap":  # the logarithm of a length
                    columns[f"{path.stem}.{name}"] = numbers - np.log10(s.length)
                    continue
                columns[f"{path.stem}.{name}"] = numbers / unit.get(name.removeprefix("err_"), 1.0)
    return columns


@cache
def in_units_of_one(kind: str) -> dict[str, Array]:
    """What all others are compared with."""
    return scaled_tables(kind, ONE)


@pytest.mark.parametrize("s", SYSTEMS_TO_TRY, ids=str)
@pytest.mark.parametrize(
    "kind", [pytest.param(kind, marks=pytest.mark.slow) if kind == "rough" else kind for kind in LEVELS]
)
def test_a_run_gives_the_same_numbers_over_their_units(kind: str, s: System) -> None:
    expected, found = in_units_of_one(kind), scaled_tables(kind, s)
    assert found.keys() == expected.keys()
    for name, values in expected.items():
        if values.dtype.kind == "U":
            assert np.array_equal(found[name], values), name
            continue
        # Loads of free bodies are rounding, beside weights of one.
        least = 1.0 if name.rpartition(".")[2] in ("F_x", "F_y", "T") else 0.0
        # The error of a bar is the rounding of two solutions, up to SAME, over their difference, here 4e-5.
        same = 1e-5 if ".err_" in name else SAME
        largest = max(least, float(np.abs(values[np.isfinite(values)]).max(initial=0.0)))
        np.testing.assert_allclose(found[name], values, rtol=0.0, atol=same * largest, err_msg=name)


def numbers_of_limit(s: System) -> dict[str, Array]:
    """Contacts, paths and errors of `fsi limit`."""
    found, a, V = study(fsi.make_case(**units.above_a_wall(s))), s.length, s.velocity
    numbers = {"contacts": np.array(found.contacts) / s.time, "scheme": found.scheme / a}
    numbers |= {"errors_q": found.errors_q / a, "errors_gamma": found.errors_gamma / V}
    for k, path in enumerate(found.paths):
        numbers |= {f"q of eps {k}": path.q / a, f"gamma of eps {k}": path.gamma / V}
    return numbers


def numbers_of_calibration(s: System) -> dict[str, Array]:
    """Samples and law of `fsi calibrate`."""
    with TemporaryDirectory() as folder:
        found = fsi.calibrate(fsi.make_case(**units.calibrated(s)), Path(folder) / "law")
    assert found.law.series is not None
    samples = np.array([(one.gap / s.length, one.kappa / s.viscosity) for one in found.samples])
    law = found.law.law().kappa(s.length * np.array([0.02, 0.3]), s.length) / s.viscosity
    return {"samples": samples, "coefficients": np.array(found.law.series.coefficients), "law": law}


@pytest.mark.parametrize("s", SYSTEMS_TO_TRY, ids=str)
@pytest.mark.parametrize(
    "numbers", [numbers_of_limit, pytest.param(numbers_of_calibration, marks=pytest.mark.slow)]
)
def test_studies_give_the_same_numbers_over_their_units(
    numbers: Callable[[System], dict[str, Array]], s: System
) -> None:
    expected, found = numbers(ONE), numbers(s)
    for name, values in expected.items():
        np.testing.assert_allclose(
            found[name], values, rtol=0.0, atol=SAME * np.abs(values).max(), err_msg=name
        )


@pytest.mark.parametrize("s", SYSTEMS, ids=str)
def test_the_same_seed_packs_the_same_bodies(s: System) -> None:
    """Metropolis moves are chaotic: one that is decided by rounding would give another packing."""

    def packed(a: float) -> tuple[Array, Array]:
        found = arrange("random", Wanted(12, 0.4, 0.01 * a, a, sizes="lognormal", spread=0.2))
        return found.centres / a, found.radii / a

    for found, expected in zip(packed(s.length), packed(1.0), strict=True):
        np.testing.assert_allclose(found, expected, rtol=1e-14)
