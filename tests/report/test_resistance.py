"""Resistance matrices without a solver: what is refused, what is shown and written."""

from __future__ import annotations

import csv
import io
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from rich.console import Console

from fsi.arrays import Array
from fsi.errors import InputError, SolveError
from fsi.observables.resistance import (
    Resistance,
    ResistanceErrors,
    all_modes,
    axial_modes,
    difference,
    estimated_errors,
    inverse,
    positive_eigenvalues,
    symmetrised,
)
from fsi.report.resistance import print_resistance, require_format, resistance_json, write_resistance

RADII = np.array([0.5, 2.0])
MODES = all_modes(("small", "large"), RADII, 3.0, 2)
SPD = np.array([[4.0, 1.0, 0.5], [1.0, 3.0, -1.0], [0.5, -1.0, 2.0]])
ONES = np.ones(3)


def of_one_disc(mobility: Array | None) -> Resistance:
    eigenvalues = np.array([1.25, 2.0, 5.5])
    return Resistance(
        all_modes(("disc",), ONES[:1], 1.0, 2), SPD, mobility, eigenvalues, {"power": 1e-13}, 120, 30,
        {"mesh": 0.25, "solve": 0.5},
    )  # fmt: skip


def errors_of(mobility: Array | None) -> ResistanceErrors:
    return ResistanceErrors(1e-6 * SPD, None if mobility is None else 3e-7 * np.ones((3, 3)), 2e-6)


def test_every_entry_has_its_error_also_where_rounding_is_all() -> None:
    """R_00 differs by 0.2: the inverse of 1x1 blocks by 1/4 - 1/4.2; no entry is known better than 1e-11."""
    found, other = of_one_disc(inverse(SPD)), of_one_disc(inverse(SPD + np.diag([0.2, 0.0, 0.0])))
    other = replace(other, R=SPD + np.diag([0.2, 0.0, 0.0]))
    errors = estimated_errors(found, [(1.5, other)], 0.0)
    assert errors.R[0, 0] == pytest.approx(0.3)
    assert errors.largest == pytest.approx(0.3 / 4.0)
    assert_allclose(errors.R[1:, 1], 1e-11 * np.sqrt([9.0, 6.0]))
    cancelling = estimated_errors(found, [(1.5, replace(other, R=SPD + np.diag([0.2, 0.1, 0.0])))], 0.0)
    assert cancelling.R[0, 1] == pytest.approx(0.03 * np.sqrt(0.3 * 0.15))
    # Sherman and Morrison: M - M' = 0.2 M e e^T M / (1 + 0.2 M_00).
    assert found.mobility is not None
    assert errors.mobility is not None
    M = found.mobility
    assert_allclose(errors.mobility, 1.5 * 0.2 * np.abs(np.outer(M[0], M[0])) / (1.0 + 0.2 * M[0, 0]))
    assert estimated_errors(of_one_disc(None), [(1.5, other)], 0.0).mobility is None


def test_bodies_in_touch_move_as_one_by_what_rounding_leaves() -> None:
    """R = [[k + c, -k, 0], [-k, k + c, 0], [0, 0, c]], k of equal discs at a gap of 1e-8 radii.

    M_00 = (k + c) / (c (2 k + c)), M_00 + M_01 = 1 / c. The other matrix is the same one. The error was 1e-11
    of M_00, which R leaves unknown to some 1e-5 of itself: it holds k + c to 5e-4, and so the pair's 2 c.
    """
    k, c = 1.5 * np.pi * 1e12, 2.0 * np.pi
    R = np.array([[k + c, -k, 0.0], [-k, k + c, 0.0], [0.0, 0.0, c]])
    found = replace(of_one_disc(inverse(R)), R=R)
    errors = estimated_errors(found, [(1.5, found)], 0.0).mobility
    assert errors is not None
    assert found.mobility is not None
    assert errors[0, 0] == pytest.approx(2.0 * np.finfo(float).eps * (k + c) / c**2, rel=1e-3)
    off = abs(found.mobility[0, 0] - (k + c) / (c * (2.0 * k + c)))
    assert 1e-7 < off < errors[0, 0]
    assert errors[2, 2] == pytest.approx(1e-11 / c)


def test_scales_make_every_entry_dimensionless() -> None:
    """mu for forces by velocities, mu a for the couplings, mu a^2 for torques; mu a on an axis."""
    outer = np.outer(MODES.scale, MODES.scale)
    assert_allclose(outer[0], 3.0 * np.array([1.0, 1.0, 0.5, 1.0, 1.0, 2.0]))
    assert outer[5, 5] == pytest.approx(3.0 * 2.0**2)
    assert_allclose(axial_modes(("a", "b"), RADII, 3.0).scale ** 2, 3.0 * RADII)


def test_units_of_length_change_no_check() -> None:
    """In millimetres a torque is a million times larger; eigenvalues and asymmetry are what they were."""
    R = np.kron(np.eye(2), SPD) + 0.1
    R[0, 5] += 1e-10
    to_mm = np.tile([1.0, 1.0, 1e3], 2)
    in_mm = all_modes(("small", "large"), 1e3 * RADII, 3.0, 2)
    symmetric, asymmetry = symmetrised(R, MODES.scale)
    other, same = symmetrised(R * np.outer(to_mm, to_mm), in_mm.scale)
    assert same == pytest.approx(asymmetry, rel=1e-5)
    assert_allclose(
        positive_eigenvalues(other, in_mm.scale, resting=True),
        positive_eigenvalues(symmetric, MODES.scale, resting=True),
    )


def test_asymmetry_is_measured_then_removed() -> None:
    columns = SPD.copy()
    columns[0, 1] += 2e-10
    R, asymmetry = symmetrised(columns, ONES)
    assert asymmetry == pytest.approx(2e-10 / np.sqrt(12.0), rel=1e-5)
    assert_allclose(R, R.T, rtol=0, atol=0)
    columns[0, 1] += 1e-7
    with pytest.raises(SolveError, match=r"reciprocity: relative asymmetry 2\.9e-08, bound 1e-09"):
        symmetrised(columns, ONES)


def test_what_is_not_positive_is_refused() -> None:
    singular = np.diag([0.0, 1.0, 2.0])
    assert_allclose(positive_eigenvalues(singular, ONES, resting=False), [0.0, 1.0, 2.0])
    with pytest.raises(SolveError, match="not positive"):
        positive_eigenvalues(singular, ONES, resting=True)
    for resting in (True, False):
        with pytest.raises(SolveError, match=r"eigenvalue -0\.01, the largest is 1"):
            positive_eigenvalues(np.diag([-0.01, 1.0, 2.0]), ONES, resting=resting)


def test_a_nearly_resistless_body_does_not_blow_up_the_comparison() -> None:
    """Where nothing resists, rounding is compared with mu."""
    noise = 1e-12 * np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    assert difference(noise, noise.T, ONES) == pytest.approx(2e-12)


def test_inverse_keeps_its_digits_at_small_gaps() -> None:
    """Rows 1e10 apart in size, as at gaps of 1e-6 radii."""
    size = np.diag([1e5, 1.0, 1.0])
    expected = np.diag([1e-5, 1.0, 1.0]) @ np.linalg.inv(SPD) @ np.diag([1e-5, 1.0, 1.0])
    assert_allclose(inverse(size @ SPD @ size), expected, rtol=1e-14)


def test_files(tmp_path: Path) -> None:
    """Each reads back to the last digit, with labels."""
    mobility = inverse(SPD)
    data = resistance_json("a disc", of_one_disc(mobility), errors_of(mobility), 1e-6)
    for suffix in ("json", "csv", "npz"):
        write_resistance(tmp_path / f"R.{suffix}", data)
    assert json.loads((tmp_path / "R.json").read_text()) == data
    assert (data["error"], data["truncation"]) == (2e-6, 1e-6)
    with (tmp_path / "R.csv").open(newline="") as file:
        header, *rows = csv.reader(file)
    assert header == ["", "disc.V_x", "disc.V_y", "disc.omega"]
    assert [row[0] for row in rows] == ["disc.F_x", "disc.F_y", "disc.T"]
    assert_allclose([[float(value) for value in row[1:]] for row in rows], SPD, rtol=0)
    arrays = np.load(tmp_path / "R.npz")
    assert_allclose(arrays["resistance"], SPD, rtol=0)
    assert_allclose(arrays["mobility"], mobility, rtol=0)
    assert_allclose(arrays["resistance_error"], 1e-6 * SPD, rtol=0)
    assert_allclose(arrays["mobility_error"], 3e-7, rtol=0)
    assert list(arrays["loads"]) == ["disc.F_x", "disc.F_y", "disc.T"]
    assert sorted(file.name for file in tmp_path.iterdir()) == ["R.csv", "R.json", "R.npz"]


def test_files_without_mobility(tmp_path: Path) -> None:
    data = resistance_json("a disc", of_one_disc(None), errors_of(None), None)
    assert data["mobility"] is None
    assert "truncation" not in data
    write_resistance(tmp_path / "R.npz", data)
    assert "mobility" not in np.load(tmp_path / "R.npz")


def test_a_file_that_cannot_be_written_is_one_line(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"unknown suffix '\.txt'; give \.json, \.csv, \.npz"):
        require_format(Path("R.txt"))
    with pytest.raises(InputError, match=r"No such file or directory; give another path"):
        write_resistance(
            tmp_path / "nowhere" / "R.csv",
            resistance_json("a disc", of_one_disc(None), errors_of(None), None),
        )


def shown(found: Resistance, width: int) -> str:
    printed = io.StringIO()
    print_resistance(Console(width=width, file=printed), "a disc", found, errors_of(found.mobility), None)
    return printed.getvalue()


def test_tables_fit_a_screen() -> None:
    """All labels and numbers, none cut short, in 80 columns."""
    text = shown(of_one_disc(inverse(SPD)), 80)
    for word in (
        "disc.F_x",
        "disc.omega",
        "0.3077",
        "4e-06",
        "3e-07",
        "smallest eigenvalue",
        "1.25",
        "30 cells, 120 unknowns",
    ):
        assert word in text
    assert "…" not in text


def test_singular_is_said() -> None:
    assert "no wall is at rest" in shown(of_one_disc(None), 200)
