"""Pairs that slide and roll: invariance, closed forms, the resistance matrix, dissipation and stress."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration, rigid_motion
from fsi.case.case import Case
from fsi.case.law_file import LawFile, TableSection, save_law
from fsi.case.load import load_case
from fsi.errors import InputError
from fsi.lubrication import exact
from fsi.lubrication.named_laws import GapFilm, exact_law
from fsi.lubrication.two_discs import rolling_of_sliding
from fsi.models import make_model
from fsi.reduced.model import ReducedModel
from tests.reduced_data import ALL, INERTIA, LEADING, heap, instant, reduced_case

CASES = Path(__file__).parents[2] / "cases"
LARGE = {"shape": "round", "radius": 1e4}


def resistance(case: Case, q: Configuration | None = None) -> Array:
    """R of lubrication alone, over all modes."""
    return np.asarray(ReducedModel(case).resistance(q or case.configuration(), 0.0).toarray())


def spheres(number: int) -> list[dict[str, Any]]:
    """A heap of them far above a plane."""
    random = np.random.default_rng(2)
    grid = np.stack(np.meshgrid(*[np.arange(2)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)[:number]
    x = 2.2 * grid + 0.1 * random.uniform(-1.0, 1.0, grid.shape) + [0.0, 0.0, 50.0]
    return [
        {"name": f"s{k}", "radius": 1.0 - 0.1 * (k % 2), "position": place}
        for k, place in enumerate(x.tolist())
    ]


def cluster(geometry: str) -> Case:
    if geometry == "planar":
        bodies = [body | {"position": [body["position"][0], body["position"][1] + 50.0]} for body in heap()]
        return reduced_case(bodies, ALL)
    return reduced_case(spheres(8), LEADING | {"law": "leading"}, geometry="spatial")


@pytest.mark.parametrize("geometry", ["planar", "spatial"])
def test_the_resistance_is_symmetric_positive_and_rigid_motions_cost_nothing(geometry: str) -> None:
    """Far from walls R has the rigid motions as its kernel, and nothing else of a connected, rigid heap.

    With arms a_i in place of those to the point between the surfaces a rotation would cost 1e-2 of R.
    """
    case = cluster(geometry)
    R, q = resistance(case), case.configuration()
    size = np.abs(R).max()
    assert np.abs(R - R.T).max() <= 1e-13 * size
    values = np.linalg.eigvalsh(R)
    M = len(rigid_motion(np.zeros(q.dimension)))
    assert values[0] > -1e-13 * size
    assert np.sum(values < 1e-10 * size) == M
    rigid = rigid_motion(q.centres).reshape(-1, M)
    assert np.abs(R @ rigid).max() <= 1e-12 * size


@given(angle=st.floats(0.0, 6.3), mirrored=st.booleans(), seed=st.integers(0, 99))
@settings(max_examples=25)
def test_turned_mirrored_and_renamed_bodies_have_the_same_resistance(
    angle: float, mirrored: bool, seed: int
) -> None:
    """T turns velocities and, mirrored, changes the sign of rotations: T R T^T is that of the new bodies."""
    case = cluster("planar")
    q, R = case.configuration(), resistance(case)
    Q = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    if mirrored:
        Q = Q @ np.diag([1.0, -1.0])
    T = np.zeros((3, 3))
    T[:2, :2], T[2, 2] = Q, -1.0 if mirrored else 1.0
    order = np.random.default_rng(seed).permutation(len(q))
    centre = np.array([0.0, 50.0])
    there = Configuration.unturned((centre + (q.centres - centre) @ Q.T)[order], q.radii[order])
    blocks = np.einsum("ab,ibjc,dc->iajd", T, R.reshape(5, 3, 5, 3), T)[np.ix_(order, range(3), order)]
    found = resistance(case, there).reshape(5, 3, 5, 3)
    np.testing.assert_allclose(found, blocks, atol=1e-9 * np.abs(R).max())


@pytest.mark.parametrize("load", ["squeeze", "shear", "rotation"])
def test_two_equal_discs_move_by_the_closed_forms(load: str) -> None:
    """Loads of one mode move that alone, and by one over (3/2) pi (a/d)^(3/2), pi (a/d)^(1/2), pi a^2 (...).

    Reynolds' limits of equal discs at a gap of 1e-6; what the cutoff takes off is 1e-3 of them or less, and
    the lone discs' resistance to turning 2e-3.
    """
    gap, reduced = 1e-6, LEADING | {"law": "leading", "drag": 1e-3}
    place, half = 0.5 * (2.0 + gap), 0.5 * (2.0 + gap)
    loads = {"squeeze": (1.0, 0.0, 0.0), "shear": (0.0, 1.0, -half), "rotation": (0.0, 0.0, 1.0)}
    F = np.array(loads[load])
    other = {"squeeze": -F, "shear": F * [1, -1, 1], "rotation": -F}[load]
    bodies = [
        {"name": name, "radius": 1.0, "position": [x, 0.0], "force": f[:2].tolist(), "torque": f[2]}
        for name, x, f in (("right", place, F), ("left", -place, other))
    ]
    U = instant(reduced_case(bodies, reduced, domain=LARGE)).U
    rates = {
        "squeeze": U[0, 0] - U[1, 0],
        "shear": U[0, 1] - U[1, 1] - half * (U[0, 2] + U[1, 2]),
        "rotation": U[0, 2] - U[1, 2],
    }
    unit = {"squeeze": 1.5 * np.pi * gap**-1.5, "shear": np.pi * gap**-0.5, "rotation": np.pi * gap**-0.5}
    for mode, rate in rates.items():
        expected = 1.0 / unit[mode] if mode == load else 0.0
        assert rate == pytest.approx(expected, rel=0.01, abs=1e-7), mode


@pytest.mark.parametrize(("a", "b", "gap"), [(1.0, 0.2, 0.1), (0.5, 1.0, 0.3), (1.0, 1.0, 0.1)])
def test_two_unlike_discs_roll_as_they_slide_without_a_couple(a: float, b: float, gap: float) -> None:
    """The power is S s^2 + R (rho + g s)^2: R and g R are what motions of s and rho alone cost together.

    With the g of narrow gaps the first pair would have 1.25 times as much, the second 1.42.
    """
    d, bodies = a + b + gap, [{"name": "left", "radius": b, "position": [0.0, 50.0]}]
    bodies += [{"name": "right", "radius": a, "position": [d, 50.0]}]
    R = resistance(reduced_case(bodies, ALL | {"cutoff": 0.5}))
    rolls = np.array([0.0, 0.0, 0.0, 0.0, a * d / (a + b), 1.0])
    slides = np.array([0.0, 0.0, 0.0, 0.0, 1.0, 0.0])
    found = float(slides @ R @ rolls / (rolls @ R @ rolls))
    assert found == pytest.approx(float(rolling_of_sliding(gap, a, b)), rel=1e-10, abs=1e-12)


@pytest.mark.parametrize("ratio", [1.0, 0.5, 3.0])
def test_two_spheres_have_the_logarithms_of_jeffrey_and_onishi(ratio: float) -> None:
    """Y_11^A, Y_11^B and Y_11^C, D. J. Jeffrey and Y. Onishi, J. Fluid Mech. 139 (1984) 261, equations 4.11.

    Per ln(1/gap), over 6 pi a, 4 pi a^2 and 8 pi a^3.
    """
    a, b, gaps = 1.0, ratio, np.array([1e-4, 1e-8])
    bodies = [
        {"name": name, "radius": r, "position": [0.0, 0.0, z]}
        for name, r, z in (("a", a, 0.0), ("b", b, 9.0))
    ]
    case = reduced_case(bodies, LEADING | {"law": "leading"}, geometry="spatial", domain=LARGE)
    parts = []
    for gap in gaps.tolist():
        q = Configuration.unturned(np.array([[0.0, 0.0, 0.0], [0.0, 0.0, a + b + gap]]), np.array([a, b]))
        parts.append(resistance(case, q))
    R = (parts[1] - parts[0]) / np.log(gaps[0] / gaps[1])
    A = 4.0 * ratio * (2.0 + ratio + 2.0 * ratio**2) / (15.0 * (1.0 + ratio) ** 3)
    B = -ratio * (4.0 + ratio) / (5.0 * (1.0 + ratio) ** 2)
    C = 2.0 * ratio / (5.0 * (1.0 + ratio))
    for k in (0, 1):
        assert R[k, k] == pytest.approx(6.0 * np.pi * a * A, rel=1e-3)
        assert R[3 + k, 3 + k] == pytest.approx(8.0 * np.pi * a**3 * C, rel=1e-3)
    assert abs(R[0, 4]) == pytest.approx(4.0 * np.pi * a**2 * abs(B), rel=1e-3)
    assert R[1, 3] == pytest.approx(-R[0, 4], rel=1e-9)
    assert R[5, 5] == pytest.approx(0.0, abs=1e-12)  # to twist, spheres have no logarithm


def test_a_channel_is_that_of_dense_algebra() -> None:
    """Ten discs, an assembly written by itself: row by row, walls by the closed forms, a dense solve."""
    case = load_case(CASES / "sheared_pairwise.toml")
    U, mu = by_dense_algebra(case)
    found = instant(case)
    np.testing.assert_allclose(found.U, U, atol=1e-9)
    assert found.apparent_viscosity == pytest.approx(mu, rel=1e-9)


def by_dense_algebra(case: Case) -> tuple[Array, float]:
    """Velocities and apparent viscosity of equal discs of radius 1 in a channel sheared at the rate 1."""
    (length, height), x = case.domain.upper, case.configuration().centres  # type: ignore[attr-defined]
    N, cut, drag = len(x), case.reduced.cutoff, case.drag
    assert cut is not None
    rows, kappa, own = [], [], []

    def add(entries: dict[int, tuple[float, float, float]], law: Any, gap: float, moving: float) -> None:
        row = np.zeros(3 * N)
        for body, values in entries.items():
            row[3 * body : 3 * body + 3] += values
        rows.append(row)
        kappa.append(float(law(gap)) - float(law(cut)))
        own.append(moving)

    def discs(mode: Any) -> Any:
        return lambda gap: exact_law(GapFilm("discs", 1.0, 1.0, mode=mode)).kappa(gap, 0.5)

    for i in range(N):
        for wall, speed in ((0.0, -0.5 * height), (height, 0.5 * height)):
            if (gap := abs(x[i, 1] - wall) - 1.0) < cut:
                add({i: (0.0, 1.0, 0.0)}, lambda q: exact.normal_resistance(q, 1.0, 1.0), gap, 0.0)
                add({i: (1.0, 0.0, 0.0)}, lambda q: exact.parallel_resistance(q, 1.0, 1.0), gap, speed)
                add({i: (0.0, 0.0, 1.0)}, lambda q: exact.rotation_resistance(q, 1.0, 1.0), gap, 0.0)
        for j in range(i):
            for image in (-length, 0.0, length):
                apart = x[i] - x[j] - [image, 0.0]
                d = float(np.hypot(*apart))
                if (gap := d - 2.0) < cut:
                    n_x, n_y = apart / d
                    add({i: (n_x, n_y, 0.0), j: (-n_x, -n_y, 0.0)}, discs("squeeze"), gap, 0.0)
                    slide = {i: (-n_y, n_x, -0.5 * d), j: (n_y, -n_x, -0.5 * d)}
                    add(slide, discs("shear"), gap, 0.0)
                    add(
                        {i: (0.0, 0.0, 1.0), j: (0.0, 0.0, -1.0)},
                        discs("rotation"),
                        gap,
                        0.0,
                    )
    G, k, b = np.array(rows), np.array(kappa), np.array(own)
    background = np.column_stack([x[:, 1] - 0.5 * height, np.zeros(N), np.full(N, -0.5)]).ravel()
    zeta = np.tile([drag, drag, 4.0 * np.pi], N)
    U = np.linalg.solve(np.diag(zeta) + G.T @ (k[:, None] * G), zeta * background + G.T @ (k * b))
    power = float(np.sum(k * (G @ U - b) ** 2) + np.sum(zeta * (U - background) ** 2))
    area = length * height
    return U.reshape(N, 3), 1.0 + 2.0 * np.pi * N / area + power / area


def test_calibrated_laws_of_shear_and_rotation_are_taken(tmp_path: Path) -> None:
    """A disc beside a plane moves by F over the law of shear and turns by T over that of rotation, a^2 K."""
    for mode, K in (("shear", (500.0, 20.0)), ("rotation", (700.0, 30.0))):
        table = TableSection(s=(1e-3, 1.0), K=K)
        law = LawFile(form="table", shape="discs", mode=mode, viscosity=1.0, table=table)  # type: ignore[arg-type]
        save_law(tmp_path / f"{mode}.toml", law)
    a, mu, gap = 2.0, 3.0, 0.02
    disc = {"name": "disc", "radius": a, "position": [0.0, a + gap], "force": [5.0, 0.0], "torque": 7.0}
    reduced = {
        key: str(tmp_path / f"{key.removesuffix('_law')}.toml") for key in ("shear_law", "rotation_law")
    }
    more = {"drag": 4.0, "cutoff": 2.0}
    U = instant(reduced_case([disc], reduced | more, fluid={"viscosity": mu})).U[0]
    log = np.log(gap / a) / np.log(1e-3)  # the table is a straight line in logarithms
    along, turning = 20.0 * 25.0**log - 20.0, 30.0 * (70.0 / 3.0) ** log - 30.0
    assert U[0] == pytest.approx(5.0 / (mu * (along + 4.0)), rel=1e-9)
    assert U[2] == pytest.approx(7.0 / (mu * a**2 * (turning + 4.0 * np.pi)), rel=1e-9)


def test_a_disc_rolls_on_the_inside_of_a_round_wall() -> None:
    """At the bottom, where V_x turns the line of centres by V_x/(R - a) and moves the wall by V_x R/(R - a).

    By Reynolds' equation both surfaces' speeds are resisted alike; a^2 is that of the disc, not of a_r.
    """
    R, a, gap = 3.0, 1.0, 1e-8
    disc = {"name": "disc", "radius": a, "position": [0.0, -(R - a - gap)]}
    domain = {"shape": "round", "radius": R}
    found = resistance(reduced_case([disc], LEADING | {"law": "leading", "cutoff": 1.9}, domain=domain))
    kappa = 2.0 * np.sqrt(2.0) * np.pi * np.sqrt(a * R / (R - a)) * (gap**-0.5 - 1.9**-0.5)
    speed, curved = R / (R - a), 1.0 / (R - a)
    expected = kappa * np.array([[speed**2 + (a * curved) ** 2, -(a**2) * curved], [-(a**2) * curved, a**2]])
    assert found[np.ix_([0, 2], [0, 2])] == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize(
    ("reduced", "more", "message"),
    [
        ({"shear_law": "slides"}, {}, r'^reduced\.shear_law = "slides": not known for shear; give "lead'),
        ({"rotation_law": "exakt"}, {}, r'^reduced\.rotation_law = "exakt": there is no such law; give "'),
        ({"rotation_law": "."}, {}, r'^reduced\.rotation_law = ".*": is a folder; give "'),
        ({"shear_law": None, "wall_shear_law": "exact"}, {}, r"needs the law between bodies too; give red"),
        ({"cutoff": None}, {}, r'^reduced\.shear_law = "exact": goes on to any gap.*give reduced\.cutoff'),
        (
            {"scheme": "distance", "step": 0.1},
            {"bodies": heap(**INERTIA)},
            r'^reduced\.shear_law = "exact": scheme "distance" stores gaps, for squeeze alone',
        ),
        (
            {},
            {"bodies": [{"name": "a", "radius": 1.0, "position": [0.0, 2.0]}], "geometry": "axisymmetric"},
            "spheres on an axis neither slide nor roll",
        ),
        (
            {"law": "leading"},
            {"bodies": spheres(2), "geometry": "spatial"},
            r"no exact resistance to shear of two spheres is known here; give reduced\.shear_law",
        ),
        (
            {},
            {
                "bodies": [{"name": "a", "radius": 1.0, "position": [0.0, 0.0]}],
                "domain": {"shape": "round", "radius": 3.0},
            },
            r"to shear is known here within a round wall; give reduced\.wall_shear_law = \"leading\"",
        ),
    ],
)  # fmt: skip
def test_mistakes_are_one_line(reduced: dict[str, Any], more: dict[str, Any], message: str) -> None:
    given = {key: value for key, value in (ALL | reduced).items() if value is not None}
    with pytest.raises(InputError, match=message):
        make_model(reduced_case(more.pop("bodies", heap()), given, **more))
