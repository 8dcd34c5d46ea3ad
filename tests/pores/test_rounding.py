"""What rounding leaves of a disc in two narrow gaps at once: hardly anything."""

from __future__ import annotations

import numpy as np
import pytest

from fsi.arrays import Array
from fsi.case.case import Case
from fsi.case.load import parse_case
from fsi.errors import SolveError
from fsi.pores.accuracy import solve_with_errors
from fsi.pores.definite import Cholesky
from fsi.pores.resistance import resistance_with_error

# The drag of discs of radius 0.4 in a lattice of equilateral triangles of side 1, `model = "resolved"`.
RESOLVED = 750.579


def between_walls(gap: float, x: float, **more: object) -> Case:
    """A disc with the same gap to both walls of a channel."""
    body = {"name": "disc", "radius": 1.0, "position": [x, 1.0 + gap]} | more
    domain = {"lower": [0.0, 0.0], "upper": [6.0, 2.0 + 2.0 * gap], "periodic": ["x"]}
    data = {"name": "t", "model": "pores", "fluid": {"viscosity": 1.0}, "domain": domain, "bodies": [body]}
    return parse_case(data | {"pores": {"modes": 4}})


@pytest.mark.parametrize("gap", [1e-5, 1e-8])
def test_slides_and_rolls_by_two_narrow_gaps_keep_their_digits(gap: float) -> None:
    """Each film resists a slide by 2 pi mu sqrt(2 a / gap), and a turn as much (Jeffrey and Onishi 1981).

    The rest resists a slide by less than 3, a turn by less than 20. Squeezes: 3 sqrt(2) pi mu (a / gap)^3/2.

    Where the disc stands along the channel makes no difference. As differences of numbers of surfaces slides
    would be known to 3e-4 at 1e-5, and not at all at 1e-8.
    """
    found = [resistance_with_error(between_walls(gap, x)) for x in (0.4234567, 1.077)]
    R, other = (np.diag(one.resistance.R) for one in found)
    assert np.all(np.abs(R - other) <= 1e-8 * R)
    films = 4.0 * np.pi * np.sqrt(2.0 / gap)
    assert R[0] == pytest.approx(films, abs=3.0)
    assert R[2] == pytest.approx(films, abs=20.0)
    assert R[1] == pytest.approx(6.0 * np.sqrt(2.0) * np.pi * gap**-1.5, rel=3e-5)


def test_a_pair_that_nearly_touches_has_a_mobility() -> None:
    """Pushed along the line of centres both move as one, as solved for at 1e-8, where all digits are there.

    With a unit diagonal R has the eigenvalue r / (3 pi mu (a / gap)^3/2) for that, 1.4e-12, r the resistance
    of both together; the largest is 3. It was refused below 1e-12 of that; rounding hides some 1e-4 of it.
    """
    pair = [
        {"name": name, "radius": 1.0, "position": [x, 9.0]} for name, x in (("p", 8.0), ("q", 10.0 + 1e-8))
    ]
    data = {"name": "t", "model": "pores", "fluid": {"viscosity": 1.0}, "pores": {"modes": 1}}
    data["domain"] = {"lower": [0.0, 0.0], "upper": [20.0, 18.0]}
    free = {"velocity": ["free", "free"], "angular_velocity": "free"}
    pushed = [pair[0] | free | {"force": [1.0, 0.0]}, pair[1] | free]
    found = resistance_with_error(parse_case(data | {"bodies": pair}))
    M, bars, R = found.resistance.mobility, found.errors.mobility, found.resistance.R
    assert M is not None
    assert bars is not None
    size = np.sqrt(np.diag(R))
    least = np.linalg.eigvalsh(R / np.outer(size, size))[0]
    assert least == pytest.approx(1.0 / (M[0, 0] * 3.0 * np.pi * 1e12), rel=2e-3)
    U = solve_with_errors(parse_case(data | {"bodies": pushed})).solution.U.ravel()
    assert np.all(np.abs(M[:, 0] - U) <= bars[:, 0])
    assert np.all(bars[[0, 3], 0] <= 0.5 * M[0, 0])


def test_a_disc_that_is_pulled_along_two_narrow_gaps_moves() -> None:
    """At 1e-8 by its resistance to slides; with pressure that drives a flux this was refused."""
    case = between_walls(1e-8, 0.3, force=[1.0, 0.0])
    found = solve_with_errors(case).solution
    R = resistance_with_error(case).resistance.R
    assert found.U[0, 0] == pytest.approx(1.0 / R[0, 0], rel=1e-7)
    assert found.checks["power"] <= 1e-10


@pytest.mark.parametrize("modes", [0, 1])
def test_the_drag_of_a_lattice_is_no_residual(modes: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """An upper bound of RESOLVED for a unit of viscosity, 1.3e-3 above.

    All right sides are rounding, as the lattice is symmetric: over these the residual was 1. What is off by
    1e-3 of the root of the dissipation in every free number is refused still.
    """
    disc = {"name": "disc", "radius": 0.4, "position": [0.0, 0.0], "velocity": [1.0, 0.0]}
    data = {"name": "t", "model": "pores", "fluid": {"viscosity": 2.0}, "pores": {"modes": modes}}
    data["domain"] = {"shape": "cell", "vectors": [[1.0, 0.0], [0.5, np.sqrt(0.75)]]}
    case = parse_case(data | {"bodies": [disc]})
    found = solve_with_errors(case).solution
    assert 0.0 <= found.F[0, 0] / 2.0 / RESOLVED - 1.0 <= 2e-3
    assert found.checks["residual"] <= 1e-14
    solve = Cholesky.solve

    def spoiled(factors: Cholesky, b: Array) -> Array:
        off: Array = 1e-3 * np.sqrt(RESOLVED) * factors._scale
        return solve(factors, b) + off

    monkeypatch.setattr(Cholesky, "solve", spoiled)
    with pytest.raises(SolveError, match="residual is violated"):
        solve_with_errors(case)
