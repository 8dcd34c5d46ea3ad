"""Exact results from outside the package: registered, refused where a name is taken, or not known."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fsi.arrays import Array
from fsi.case.load import load_case
from fsi.errors import InputError
from fsi.lubrication.exact_results import EXACT as RESULTS
from fsi.lubrication.exact_results import ExactProblem, Fitting, exact_result
from fsi.validation.rows import Row, reference, require_sound, swept, write_rows
from tests.validation.test_validate import QUICK


def test_one_more_exact_result_is_one_function(tmp_path: Path) -> None:
    """Entered from outside: the schema, its complaints and `reference` know it by its name."""
    path = tmp_path / "case.toml"
    path.write_text(QUICK.replace("concentric_sphere", "sphere_in_anything"))

    @exact_result(Fitting("axisymmetric", "round", 1, "force", enclosed=True))
    def sphere_in_anything(problem: ExactProblem) -> float:
        """-R V with R = mu (size/a)^2, here of spheres at V = 1 in containers of radii 4 and 2."""
        R = problem.viscosity * (problem.size / problem.radii[0]) ** 2
        return -float(R * problem.U[0, problem.mode])

    try:
        values = [reference(case, case.expected[0])[0] for _, case in swept(path)]
        wrong = path.with_name("wrong.toml")
        wrong.write_text(QUICK.replace("concentric_sphere", "sphere_in_anithing"))
        with pytest.raises(InputError, match="the nearest is 'sphere_in_anything'"):
            load_case(wrong)
        moved = path.with_name("moved.toml")
        moved.write_text(path.read_text().replace("ball.force.z", "ball.velocity.z"))
        with pytest.raises(InputError, match=r"gives a force, not ball\.velocity\.z"):
            list(swept(moved))
    finally:
        del RESULTS["sphere_in_anything"]
    assert values == [-64.0, -16.0]
    with pytest.raises(InputError, match="no such exact result"):
        load_case(path)


def test_a_result_whose_name_is_taken_is_refused() -> None:
    """That of the program stays."""
    before = RESULTS["two_discs"]

    def two_discs(_: ExactProblem) -> float:
        return 1.0

    with pytest.raises(
        ValueError, match=r'^"two_discs": is the name of fsi\.lubrication\.exact_results\.two_discs'
    ):
        exact_result(Fitting("planar", "round", 2, "force"))(two_discs)
    assert RESULTS["two_discs"] is before


def test_a_reference_that_is_not_known_is_missed_before_anything_is_solved(tmp_path: Path) -> None:
    """No closed form is known of this shape: an exact result says so by NaN."""
    path = tmp_path / "case.toml"
    path.write_text(QUICK.replace("concentric_sphere", "of_no_shape"))
    exact_result(Fitting("axisymmetric", "round", 1, "force"))(of_no_shape)
    try:
        with pytest.raises(
            InputError, match=r'case\.toml: exact = "of_no_shape": is not known for the shape'
        ):
            require_sound([path])
    finally:
        del RESULTS["of_no_shape"]


def raises(_: ExactProblem) -> float:
    raise RuntimeError("mine")


def of_all_bodies(problem: ExactProblem) -> Array:
    return np.asarray(problem.U[:, :2])


def nothing(_: ExactProblem) -> None:
    return None


def without_end(_: ExactProblem) -> float:
    return np.inf


@pytest.mark.parametrize(
    "wrong", [raises, of_all_bodies, nothing, without_end], ids=lambda wrong: wrong.__name__
)
def test_a_result_that_gives_no_number_is_named(wrong: Any, tmp_path: Path) -> None:
    """In one line that blames its function, before anything is solved."""
    path = tmp_path / "case.toml"
    path.write_text(QUICK.replace("concentric_sphere", wrong.__name__))
    exact_result(Fitting("axisymmetric", "round", 1, "force"))(wrong)
    try:
        with pytest.raises(InputError, match=rf'case\.toml: exact = "{wrong.__name__}": its function '):
            require_sound([path])
    finally:
        del RESULTS[wrong.__name__]


def numpy_sphere(problem: ExactProblem) -> float:
    found: float = -137.6 * np.float64(problem.viscosity)
    return found


def test_a_result_may_be_a_number_of_numpy(tmp_path: Path) -> None:
    """Its rows are written as those of plain numbers: of a verdict of NumPy JSON knows nothing."""
    path = tmp_path / "case.toml"
    path.write_text(QUICK.replace("concentric_sphere", "numpy_sphere"))
    exact_result(Fitting("axisymmetric", "round", 1, "force"))(numpy_sphere)
    try:
        case = load_case(path)
        found, digits = reference(case, case.expected[0])
    finally:
        del RESULTS["numpy_sphere"]
    row = Row("case", None, 0.1, "q", -137.5, 1e-3, 0.0, found, digits, 1e-2, "numpy_sphere", "mine")
    write_rows([row], tmp_path)
    assert json.loads((tmp_path / "validation.json").read_text())[0]["passed"] is True


def of_no_shape(_: ExactProblem) -> float:
    return np.nan
