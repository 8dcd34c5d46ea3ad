"""Narrow gaps at any drag: velocities, rates and forces against rational arithmetic and closed forms."""

from __future__ import annotations

from fractions import Fraction
from math import pi
from typing import Any

import numpy as np
import pytest
import scipy.sparse as sp

import fsi.reduced.gap_forces as gap_forces
from fsi.arrays import Array
from fsi.errors import SolveError
from fsi.lubrication.exact import normal_resistance, pair_resistance, settling_time
from fsi.models import make_model, make_stepper
from fsi.reduced.gap_forces import GapSystem
from fsi.reduced.model import ReducedInstant
from tests.reduced_data import instant, reduced_case

RING = [(np.cos(t), np.sin(t)) for t in 0.3 + np.arange(6) * pi / 3.0]
# Centres; pairs; walls by body and normal.
NETS: dict[str, tuple[list[tuple[float, float]], list[tuple[int, int]], list[tuple[int, float, float]]]] = {
    "oblique pair": ([(0, 0), (0.6, 0.8)], [(0, 1)], []),
    "chain": ([(k, 0) for k in range(5)], [(k, k + 1) for k in range(4)], []),
    "heap": ([(0, 0), (0.8, 0.6), (1.6, 0)], [(0, 1), (1, 2)], [(0, 0, 1), (2, 0, 1)]),
    "between plates": ([(0, 0)], [], [(0, 0, 1), (0, 0, -1)]),
    "chain between walls": ([(k, 0) for k in range(3)], [(0, 1), (1, 2)], [(0, 1, 0), (2, -1, 0)]),
    "hexagon": ([(0, 0), *RING], [(0, k) for k in range(1, 7)] + [(k, k % 6 + 1) for k in range(1, 7)], []),
}


def system(name: str, gap: float, drag: float, d: int = 2) -> GapSystem:
    """Discs pressed together, or in the hexagon by any forces, with gaps that differ."""
    x, pairs, walls = NETS[name]
    centres, random = np.array(x, dtype=float), np.random.default_rng(1)
    G = np.zeros((len(pairs) + len(walls), *centres.shape))
    for row, (i, j) in zip(G, pairs, strict=False):
        row[i] = (centres[i] - centres[j]) / np.linalg.norm(centres[i] - centres[j])
        row[j] = -row[i]
    for row, (i, *n) in zip(G[len(pairs) :], walls, strict=True):
        row[i] = n
    f = np.zeros_like(centres)
    f[0] += (1.0, -0.7 if walls else 0.0)
    f[-1] -= (1.0, 0.0) if len(x) > 1 else (0.7, 0.0)
    if name == "hexagon":
        f = random.standard_normal(f.shape)
    kappa = 13.3 * (gap * (1.0 + random.random(len(G)))) ** -1.5
    rows, Z_inverse = sp.csr_matrix(G.reshape(len(G), -1)), np.full(f.size, 1.0 / drag)
    mobility = (rows.toarray() ** 2) @ Z_inverse
    return GapSystem(rows, 1.0 / kappa, np.zeros(len(G)), mobility, Z_inverse, f.ravel() * Z_inverse, d)


def exact(given: GapSystem) -> tuple[list[Fraction], list[Fraction], list[Fraction]]:
    """u, rates and lambda of the very numbers given, by elimination in rational arithmetic."""
    G = given.G.toarray()
    R, M = G.shape
    A = [[Fraction(0)] * (M + R + 1) for _ in range(M + R)]
    for a in range(M):
        A[a][a], A[a][-1] = Fraction(1), Fraction(given.u0[a])
        for k in range(R):
            A[a][M + k] = Fraction(given.Z_inverse[a]) * Fraction(G[k, a])
            A[M + k][a] = Fraction(G[k, a])
    for k in range(R):
        A[M + k][M + k] = -Fraction(given.compliance[k])
    for i in range(M + R):
        p = next(r for r in range(i, M + R) if A[r][i])
        A[i], A[p] = A[p], A[i]
        A[i] = [entry / A[i][i] for entry in A[i]]
        for r in range(M + R):
            if r != i and A[r][i]:
                A[r] = [x - A[r][i] * y for x, y in zip(A[r], A[i], strict=True)]
    u, force = [row[-1] for row in A[:M]], [row[-1] for row in A[M:]]
    return u, [Fraction(c) * x for c, x in zip(given.compliance, force, strict=True)], force


def worst(found: Array, right: list[Fraction], each: bool = False) -> float:
    """The largest error, relative to the largest value, or to each one."""
    off = [abs(Fraction(float(a)) - b) for a, b in zip(found, right, strict=True)]
    if each:
        return float(max(a / abs(b) for a, b in zip(off, right, strict=True)))
    return float(max(off) / max(map(abs, right)))


@pytest.mark.parametrize("gap", [1e-1, 1e-3, 1e-6, 1e-10])
@pytest.mark.parametrize("drag", [1e-9, 1e-4, 8.83, 1e3])
@pytest.mark.parametrize("name", [name for name in NETS if name != "hexagon"])
def test_narrow_gaps_are_exact_at_any_drag(name: str, drag: float, gap: float) -> None:
    """To 1e-8, whatever kappa over drag, up to 1e25.

    Without corrections rates were off by up to 1e13, beside two walls forces by any amount; with momentum in
    single precision the velocities of chains by 1e-5.
    """
    given = system(name, gap, drag)
    u, force = given.solve()
    right_u, right_rates, right_force = exact(given)
    assert worst(u, right_u) < 1e-8
    assert worst(given.compliance * force, right_rates, each=True) < 1e-8
    assert worst(force, right_force, each=True) < 1e-8


@pytest.mark.parametrize("d", [2, 3])
@pytest.mark.parametrize("name", ["oblique pair", "chain", "heap"])
def test_iterations_are_corrected_too(name: str, d: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(gap_forces, "LARGEST_DIRECT", 1)
    given = system(name, 1e-7, 1e-3, d)
    u, force = given.solve()
    right_u, _, right_force = exact(given)
    assert worst(u, right_u) < 1e-8
    assert worst(force, right_force, each=True) < 1e-8


@pytest.mark.parametrize(("kappa", "drag"), [(1e-2, 1.0), (1e4, 1.0), (1e9, 1e-3)])
def test_all_pairs_have_the_same_solution_by_the_velocities(
    kappa: float, drag: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Twelve discs, each with a law with each, two of them held: 66 rows for 24 velocities.

    Without what is held in the laws the velocities would be off by as much as they are.
    """
    random = np.random.default_rng(2)
    pairs = [(i, j) for i in range(12) for j in range(i)]
    G = np.zeros((len(pairs), 12, 2))
    for row, (i, j) in zip(G, pairs, strict=True):
        row[i] = random.standard_normal(2)
        row[j] = -row[i]
    rows, Z_inverse = sp.csr_matrix(G.reshape(len(pairs), -1)), np.full(24, 1.0 / drag)
    Z_inverse[[0, 1, 6]] = 0.0
    compliance = 1.0 / (kappa * 10.0 ** random.uniform(-3.0, 0.0, len(pairs)))
    mobility, own = (rows.toarray() ** 2) @ Z_inverse, random.standard_normal(len(pairs))
    given = GapSystem(rows, compliance, own, mobility, Z_inverse, random.standard_normal(24), 2)
    found = []
    for crowded in (0, 1000):
        monkeypatch.setattr(gap_forces, "_CROWDED", crowded)
        found.append(given.solve())
    for by_velocities, by_forces in zip(*found, strict=True):
        assert by_velocities == pytest.approx(by_forces, rel=1e-8, abs=1e-10 * np.abs(by_forces).max())


def test_without_a_cutoff_a_crowd_takes_no_full_matrix_of_its_pairs(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of 60 discs all 1770 pairs and their walls have a force: its matrix, all but full, is not made."""
    monkeypatch.delattr(gap_forces._ByForces, "_solved")
    places = [(2.5 + 2.3 * i, 2.5 + 2.3 * j) for i in range(10) for j in range(6)]
    bodies = [
        {"name": f"d{k}", "radius": 1.0, "position": list(x), "force": [0.1 * k, -1.0]}
        for k, x in enumerate(places)
    ]
    laws = {"law": "exact", "wall_law": "exact", "drag": 5.0}
    case = reduced_case(bodies, laws, domain={"lower": [0.0, 0.0], "upper": [30.0, 20.0]})
    found = make_model(case)(case.configuration(), 0.0)
    assert isinstance(found, ReducedInstant)
    assert len(found.pairs) == 60 * 59 // 2 + 4 * 60


def test_what_rounding_decides_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    """More gaps than freedoms in bodies that move along: rounding of their velocity decides on the forces.

    In the hexagon they were off by their own size; in space between walls there are no factors of all.
    """
    with pytest.raises(SolveError, match=r"as drag and inertia: their forces are lost in rounding; give"):
        system("hexagon", 1e-8, 1e-3).solve()
    u, force = system("hexagon", 1e-3, 8.83).solve()
    right_u, _, right_force = exact(system("hexagon", 1e-3, 8.83))
    assert worst(u, right_u) < 1e-12
    assert worst(force, right_force) < 1e-6
    monkeypatch.setattr(gap_forces, "LARGEST_DIRECT", 1)
    with pytest.raises(SolveError, match="how they move is lost in rounding"):
        system("chain between walls", 1e-10, 1e-3, 3).solve()


def disc(gap: float, drag: float, **time: Any) -> Any:
    body = {"name": "disc", "radius": 1.0, "position": [0.0, 1.0 + gap], "force": [0.0, -4.0 * pi]}
    return reduced_case([body], {"law": "exact", "drag": drag}, time={"end": 1.0} | time)


@pytest.mark.parametrize("drag", [1e-9, 1e-8, 1e-6, 1e-4, 8.83, 1e3])
def test_a_disc_beside_a_plane_settles_by_the_exact_law(drag: float) -> None:
    """`V = F / (kappa + zeta)`. At drag 1e-9 and a gap of 0.009 it was 1.2589e-3, not 7.97e-4."""
    for gap in (0.009, 1e-3, 1e-5, 1e-8, 1e-10):
        D = (1.0 + gap) - 1.0  # as positions have it
        V = -4.0 * pi / (float(normal_resistance(D, 1.0, 1.0)) + drag)
        solved = instant(disc(gap, drag))
        assert solved.U[0, 1] == pytest.approx(V, rel=1e-8, abs=0.0)
        assert solved.rates == pytest.approx(V, rel=1e-8, abs=0.0)


def test_a_disc_that_is_held_has_the_force_of_its_law() -> None:
    """`F = -kappa V` at a gap of 1e-9, kappa = 4.2e14, which was cut at 1e13."""
    body = {"name": "disc", "radius": 1.0, "position": [0.0, 1.0 + 1e-9], "velocity": [0.0, -1.0]}
    solved = instant(reduced_case([body], {"law": "exact", "drag": 1.0}))
    D = (1.0 + 1e-9) - 1.0
    assert solved.F[0, 1] == pytest.approx(-float(normal_resistance(D, 1.0, 1.0)), rel=1e-8, abs=0.0)


@pytest.mark.parametrize("turned", [0.0, 0.7, 1.1])
def test_two_discs_that_are_pressed_together(turned: float) -> None:
    """Rates `2 F / (2 kappa + zeta)` also at an angle, where rounding of the loads turns the pair.

    In the distance of the centres rounding would lose up to 1e-6 of the narrowest gap.
    """
    along, drag = np.array([np.cos(turned), np.sin(turned)]), 1e-6
    for gap in (1e-3, 1e-6, 1e-9, 1e-10):
        ends = [np.zeros(2), (2.0 + gap) * along]
        bodies = [
            {"name": str(k), "radius": 1.0, "position": x.tolist(), "force": (s * along).tolist()}
            for k, (x, s) in enumerate(zip(ends, (1.0, -1.0), strict=True))
        ]
        case = reduced_case(bodies, {"law": "exact", "drag": drag}, domain={"shape": "unbounded"})
        x, y = (Fraction(float(part)) for part in ends[1])
        beyond = float(x**2 + y**2 - 4)  # s^2 - 4, rounded once
        D = beyond / (float(np.sqrt(beyond + 4.0)) + 2.0)
        rate = -2.0 / (2.0 * float(pair_resistance(D, 1.0, 1.0)) + drag)
        assert instant(case).rates == pytest.approx(rate, rel=1e-8, abs=0.0)


@pytest.mark.parametrize("drag", [1e-3, 8.83])
def test_a_run_follows_the_exact_gap_down_to_1e_10(drag: float) -> None:
    """From 0.5, in the time of Jeffrey and Onishi's law and that of drag, `zeta (0.5 - D) / F`.

    The gap was 8.9e-16 where it is 1.3e-9, and with the lesser drag closed at t = 2889.
    """
    end = float(settling_time(1e-10, 0.5, 1.0, 1.0, -4.0 * pi)) + drag * (0.5 - 1e-10) / (4.0 * pi)
    case = disc(0.5, drag, end=end, tolerance=1e-4)
    stepper = make_stepper(case, make_model(case))
    state = stepper.start(case.configuration()).state
    while state.t < end:
        state = stepper.advance(state).state
    assert float(state.q.centres[0, 1]) - 1.0 == pytest.approx(1e-10, rel=1e-3, abs=0.0)
