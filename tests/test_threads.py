"""What else may happen while something is solved: other threads, and the callbacks of a run."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import fsi
from tests.cli.test_commands import call
from tests.one_disc import reduced

THREADS = """
from threading import Barrier, Thread
import fsi

def case(x, y):
    disc = {"name": "disc", "radius": 1.0, "position": [x, y], "velocity": [0, -1], "angular_velocity": 0}
    coarse = {"degree": 2, "cells_per_circle": 12, "growth": 1.0}
    box = {"lower": [-4, -4], "upper": [4, 4]}
    fluid = {"viscosity": 1.0}
    return fsi.make_case(name="disc", fluid=fluid, domain=box, discretisation=coarse, bodies=[disc])

def found(case):
    solution = fsi.solve(case)
    u, p = solution.evaluate([[-2.5, 2.5]])
    return [solution["disc"].force.tolist(), u.tolist(), p.tolist()]

def work(case, into):
    start.wait()
    into.extend(found(case) for _ in range(3))

cases = [case(0.5, 0.2), case(2.0, -1.5)]
alone = [found(case) for case in cases]
several, start = [[], []], Barrier(2)
threads = [Thread(target=work, args=each) for each in zip(cases, several)]
for thread in threads:
    thread.start()
for thread in threads:
    thread.join()
assert several == [3 * [one] for one in alone], (several, alone)
print("done")
"""


def test_threads_find_what_one_finds_alone() -> None:
    """To the last digit; gmsh and PETSc, used by both at a time, ended the process by a signal."""
    done = call(sys.executable, "-c", THREADS, timeout=120.0)
    assert (done.returncode, done.stdout) == (0, "done\n"), done.stderr


def test_a_callback_may_solve(tmp_path: Path) -> None:
    """V of the start is that of the instant at time 0."""
    velocities: list[float] = []

    def solve(_: fsi.StepRecord) -> None:
        velocities.append(fsi.solve(reduced())["disc"].velocity[1])

    run = fsi.run(reduced(), tmp_path / "run", solve)
    assert set(velocities) == {run.bodies["V_y"][0]}


def test_a_callback_cannot_change_the_motion(tmp_path: Path) -> None:
    """Velocities without their mean, in place, moved the bodies as if all had stood still."""
    spoilt: list[str] = []

    def spoil(record: fsi.StepRecord) -> None:
        record.columns.clear()  # type: ignore[attr-defined]  # a copy
        q = record.q
        for name, values in (("U", record.U[:, :2]), ("F", record.F), ("x", q.centres), ("a", q.angles)):
            with pytest.raises(ValueError, match="read-only"):
                values -= values.mean(axis=0)
            spoilt.append(name)

    plain, touched = fsi.run(reduced(), tmp_path / "a"), fsi.run(reduced(), tmp_path / "b", spoil)
    assert len(spoilt) == 4 * len(plain.steps)
    np.testing.assert_array_equal(touched.bodies[["x", "y", "V_y"]], plain.bodies[["x", "y", "V_y"]])
    assert list(touched.steps) == list(plain.steps)


@pytest.mark.parametrize("model", [{}, {"model": "gluey", "time": {"end": 0.2, "step": 0.1}}])
def test_a_callback_sees_arrays_that_are_read_only(model: dict[str, Any], tmp_path: Path) -> None:
    writeable: list[bool] = []

    def look(record: fsi.StepRecord) -> None:
        arrays = (record.U, record.F, record.q.centres, record.q.angles, record.q.radii)
        writeable.extend(array.flags.writeable for array in (*arrays, *record.body_columns.values()))

    fsi.run(reduced(**model), tmp_path / "run", look)
    assert set(writeable) == {False}
