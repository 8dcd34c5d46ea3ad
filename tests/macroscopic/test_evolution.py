"""Macroscopic runs by hand: forces in time, profiles, bodies on a line, and what a resumed run takes back."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fsi.arrays import Array
from fsi.case.load import load_case, parse_case
from fsi.case.macroscopic import evaluate
from fsi.errors import InputError, SolveError
from fsi.integration.state import StepRecord
from fsi.macroscopic.evolution import PROFILES, MacroscopicEvolution, matter, profile
from fsi.macroscopic.model import Parcels, blocks
from fsi.models import make_evolution

CASES = Path(__file__).parents[2] / "cases"


def test_a_force_that_grows_in_time_is_integrated_exactly() -> None:
    """f = 2 t from 0.2 to 0.6 gives 0.32; at the start of the step it would give 0.16."""
    parcels, _ = blocks([(-0.05, 0.05, 1.0), (4.95, 5.05, 1.0)], 2)

    def force(x: Array, _m: Array, t: float) -> Array:
        return np.full_like(x, 2.0 * t)

    assert_allclose(parcels.advance(force, 0.2, 0.4).u, 0.32, rtol=1e-14)


def test_a_profile_is_that_at_the_middles_of_parcels() -> None:
    """Gamma lives between parcels, here 0, -0.1, -0.4 and 0: its means; density by both distances."""
    slack, w = np.array([0.0, 0.1, 0.4]), np.array([1.0, 3.0, -4.0])
    parcels = Parcels(np.array([0.05, 0.15, 0.25]), 0.1, -0.05, slack, np.zeros(3), w)
    assert_allclose(parcels.X, [0.0, 0.2, 0.6], atol=1e-15)
    found = profile(parcels, 3.0)
    assert_allclose(parcels.gamma, [0.0, -0.1, -0.4, 0.0], atol=1e-15)
    assert_allclose(found["gamma"], 3.0 * np.array([-0.05, -0.25, -0.2]), rtol=1e-13)
    assert_allclose(found["rho"], [0.1 / 0.2, 0.1 / 0.3, 0.1 / 0.4])


def bodies_case(**first: Any) -> Any:
    """Three discs on a line, listed from right to left, of radii 1, 2, 1, with gaps of 0.5 and 0.25."""
    places = [(7.75, 1.0), (4.5, 2.0), (1.0, 1.0)]
    bodies = [
        {"name": f"b{k}", "radius": a, "position": [x, 0.0], "mass": a, "moment_of_inertia": 1.0}
        for k, (x, a) in enumerate(places)
    ]
    bodies[0] |= first
    return parse_case(
        {
            "name": "test", "model": "macroscopic", "bodies": bodies, "macroscopic": {"parcels": 40},
            "domain": {"lower": [-50.0, -50.0], "upper": [50.0, 50.0]}, "time": {"end": 1.0, "step": 0.1},
        }
    )  # fmt: skip


def test_parcels_belong_to_their_bodies_whatever_the_order() -> None:
    """Where the parcels are is where the bodies are; a force on the first, to the right, moves it alone."""
    case = bodies_case(force=[2.0, 0.0])
    line = matter(case)
    assert line.bodies is not None
    assert_allclose(line.bodies.at(line.parcels.X).centres, case.configuration().centres, atol=1e-12)
    evolution = MacroscopicEvolution(case)
    start = evolution.start()
    assert start.record.smallest_gap == pytest.approx(0.25, abs=1e-12)
    after = evolution.advance(start.state).record
    assert_allclose(after.U[:, 0], [0.2, 0.0, 0.0], atol=1e-12)
    assert after.smallest_gap == pytest.approx(0.25 + 0.02, abs=1e-12)


def test_what_is_pushed_is_still_pushed_when_a_run_goes_on() -> None:
    """Pushed together from the right until gamma < 0; its memory taken back is the same, to the bit."""
    case = bodies_case(force=[-40.0, 0.0])
    evolution, other = MacroscopicEvolution(case), MacroscopicEvolution(case)
    state = evolution.start().state
    for _ in range(8):
        state = evolution.advance(state).state
    assert evolution.parcels.gamma.min() < -0.5
    other.restore(evolution.memory())
    assert np.array_equal(other.parcels.gamma, evolution.parcels.gamma)
    assert np.array_equal(other.advance(state).record.U, evolution.advance(state).record.U)


def test_a_pulse_within_a_step_is_not_lost() -> None:
    """100 from 0.011 to 0.014, past the middle of a step of 0.1: the impulse 0.3, exactly."""
    pulse = {"times": [0.011, 0.011, 0.014, 0.014], "values": [0.0, 100.0, 100.0, 0.0]}
    evolution = MacroscopicEvolution(bodies_case(force=[pulse, 0.0]))
    after = evolution.advance(evolution.start().state).record
    assert_allclose(after.U[:, 0], [0.3, 0.0, 0.0], atol=1e-12)


@pytest.mark.parametrize(
    ("x", "line"),
    [(7.25, "b0 and b1 overlap by 0.25"), (4.5, "b0 and b1 overlap by 3"), (1.0, "b0 and b2 overlap by 2")],
)
def test_bodies_do_not_begin_in_each_other(x: float, line: str) -> None:
    """The first, of radius 1, beside or upon the second, of radius 2 at 4.5, or the third, of 1 at 1."""
    bodies_case(position=[7.5, 0.0])  # they touch
    bodies_case(position=[7.5 - 5e-11, 0.0])  # that is rounding
    with pytest.raises(InputError, match=rf"^bodies: {line}; move them apart$"):
        bodies_case(position=[x, 0.0])


@pytest.mark.parametrize(("radii", "least"), [((1.0, 1.0, 1.0), 3), ((1.0, 0.5, 0.8), 23), ((0.3, 0.1), 4)])
def test_the_least_number_of_parcels_is_named(radii: tuple[float, ...], least: int) -> None:
    """Of whole numbers without a common factor, here 10, 5 and 8, or 3 and 1, their sum."""
    bodies = [
        {"name": f"b{k}", "radius": a, "position": [5.0 * k, 0.0], "mass": a, "moment_of_inertia": 1.0}
        for k, a in enumerate(radii)
    ]
    case = {"name": "test", "model": "macroscopic", "domain": {"shape": "unbounded"}, "bodies": bodies}
    case["time"] = {"end": 1.0, "step": 0.1}
    parse_case(case | {"macroscopic": {"parcels": 2 * least}})
    with pytest.raises(InputError, match=rf"^macroscopic\.parcels = 101: .*; give a multiple of {least}$"):
        parse_case(case | {"macroscopic": {"parcels": 101}})


def test_radii_without_whole_ratios_are_told_to_be_changed() -> None:
    with pytest.raises(
        InputError, match=r"^macroscopic\.parcels = 40: .*; give radii whose ratios are those"
    ):
        bodies_case(position=[9.0, 0.0], radius=2.0**0.5, mass=2.0**0.5)


def test_energy_and_memory_are_those_of_the_gluey_level() -> None:
    """Two discs of mass 1, half their diameter, pushed by 1: 2 t^2 / 2 before they meet, and gamma = -2 at 2.

    Per length their energy and gamma would be twice that.
    """
    case = load_case(CASES / "levels.toml", ["time.end=2.0"])
    of_level: dict[str, list[StepRecord]] = {}
    for model in ("gluey", "macroscopic"):
        evolution = make_evolution(case.model_copy(update={"model": model}))
        moments = [evolution.start()]
        while moments[-1].state.t < 2.0:
            moments.append(evolution.advance(moments[-1].state))
        of_level[model] = [moment.record for moment in moments]
        assert moments[30].record.columns["kinetic_energy"] == pytest.approx(0.09, rel=1e-9)
        assert moments[-1].record.columns["smallest_gamma"] == pytest.approx(-2.0, rel=1e-9)
    for name in ("kinetic_energy", "smallest_gamma"):
        gluey, macroscopic = ([one.columns[name] for one in steps] for steps in of_level.values())
        assert_allclose(macroscopic, gluey, atol=1e-9)


def test_tables_of_bodies_have_their_mass() -> None:
    """Discs of masses 8, 16 and 8, diameters 2, 4 and 2: momentum 8 * 0.25, and 32 in all."""
    bodies = [body.model_copy(update={"mass": 8.0 * body.radius}) for body in bodies_case().bodies]
    first = bodies[0].model_copy(update={"initial_velocity": (0.25, 0.0)})
    case = bodies_case().model_copy(update={"bodies": (first, *bodies[1:])})
    start = MacroscopicEvolution(case).start()
    assert start.record.columns["momentum"] == pytest.approx(8.0 * 0.25, rel=1e-12)
    header, rows = start.tables()[PROFILES]
    m = [float(str(row[header.index("m")])) for row in rows]
    assert_allclose(m, (np.arange(40) + 0.5) * 32.0 / 40.0, rtol=1e-12)


def of_blocks(domain: dict[str, Any]) -> Any:
    block = {"left": 0.0, "right": 1.0, "density": 1.0, "initial_velocity": "0"}
    return {
        "name": "test", "model": "macroscopic", "domain": domain, "time": {"end": 1.0, "step": 0.1},
        "macroscopic": {"blocks": [block]},
    }  # fmt: skip


BOX = {"lower": [-50.0, -50.0], "upper": [50.0, 50.0]}


@pytest.mark.parametrize(
    ("domain", "line"),
    [
        (BOX, r'^domain\.shape = "box": has walls, .*; give "unbounded"$'),
        (BOX | {"periodic": ["x"]}, r'^domain\.shape = "box": is periodic, .*; give "unbounded"$'),
        ({"shape": "cell", "vectors": [[9.0, 0.0], [0.0, 9.0]]}, r'^domain\.shape = "cell": is periodic'),
        (BOX | {"walls": {"top": [1.0, 0.0]}}, r"^domain\.walls\.top = .* at rest"),
    ],
)
def test_a_line_of_blocks_has_neither_walls_nor_periods(domain: dict[str, Any], line: str) -> None:
    with pytest.raises(InputError, match=line):
        parse_case(of_blocks(domain))
    parse_case(of_blocks({"shape": "unbounded"}))


def test_there_are_no_error_estimates() -> None:
    estimates = {"output": {"error_estimates": True}}
    with pytest.raises(InputError, match=r"^output\.error_estimates = true: .*no mesh"):
        parse_case(of_blocks({"shape": "unbounded"}) | estimates)


def test_bodies_do_not_run_through_a_wall_unseen() -> None:
    """From 7.75 and radius 1 the first is past the wall at 50 when it has come 41.25: at 100 after 0.4125."""
    evolution = MacroscopicEvolution(bodies_case(initial_velocity=[100.0, 0.0]))
    state = evolution.start().state
    for _ in range(4):
        state = evolution.advance(state).state
    line = r"""^domain\.shape = "box": body 'b0' is past wall 'right' at t = 0\.5, .*; give "unbounded", or"""
    with pytest.raises(SolveError, match=line):
        evolution.advance(state)
    with pytest.raises(InputError, match="body 'b0' is past wall 'right' at t = 0"):
        bodies_case(position=[49.5, 0.0])


def test_blocks_know_no_forces_of_other_levels() -> None:
    gravity = {"kind": "gravity", "acceleration": [5.0, 0.0], "density_difference": 1.0}
    with pytest.raises(InputError, match=r"^forces\.0: .* only macroscopic\.force_per_mass; drop it$"):
        parse_case(of_blocks({"shape": "unbounded"}) | {"forces": [gravity]})
    bodies = bodies_case()
    with pytest.raises(InputError, match=r"^forces\.0: .* only the forces of \[\[bodies\]\]; drop it$"):
        parse_case(bodies.model_dump(exclude_unset=True) | {"forces": [gravity]})


def on_a_line(ends: list[tuple[float, float]], u: str, parcels: int, **macroscopic: Any) -> Any:
    blocks = [{"left": a, "right": b, "density": 0.7, "initial_velocity": u} for a, b in ends]
    matter = {"blocks": blocks, "parcels": parcels} | macroscopic
    return parse_case(of_blocks({"shape": "unbounded"}) | {"macroscopic": matter})


def test_blocks_hold_whole_parcels() -> None:
    """Masses 1 to 2: of 40 parcels a block would have 13.3, and its velocity be given to 13 or 14."""
    ends = [(-1.65, -0.45), (-0.32, 2.08)]
    line = r"^macroscopic\.parcels = 40: the masses of the blocks .* whole .* parcels; give a multiple of 3$"
    with pytest.raises(InputError, match=line):
        on_a_line(ends, "1", 40)
    parcels = matter(on_a_line(ends, "where(x < -0.4, 1, -2)", 42)).parcels
    assert parcels.u.sum() * parcels.dm == pytest.approx(0.7 * (1.2 - 2.0 * 2.4), rel=1e-12)
    assert_allclose(
        parcels.X[[0, 13, 14, 41]],
        np.array([-1.65, -0.45, -0.32, 2.08]) + [e * 0.5 * parcels.dm / 0.7 for e in (1, -1, 1, -1)],
        atol=1e-14,
    )
    with pytest.raises(InputError, match=r"; give masses whose ratios are those of small whole numbers$"):
        on_a_line([(0.0, 1.0), (1.0, 1.0 + 2.0**0.5)], "1", 40)
    with pytest.raises(InputError, match=r"^macroscopic\.blocks: have the mass inf, .*; give other units$"):
        on_a_line([(-1e308, 1e308)], "1", 40)


def test_a_velocity_without_a_square_is_refused() -> None:
    line = r'^macroscopic\.blocks\.0\.initial_velocity = "1e300\*x": .*; give another formula$'
    with pytest.raises(InputError, match=line):
        matter(on_a_line([(0.0, 1.0)], "1e300*x", 5))


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("force", ["1e308", "1e308*x*1e10", "-1e160", "where(x > 0.5, -1e308, 1e308)"])
def test_a_step_that_runs_out_of_numbers_is_none(force: str) -> None:
    """From u = 0 a step of 0.1: 1e307, whose square, 1e614, is no number; nor is that of 1e159."""
    evolution = MacroscopicEvolution(on_a_line([(0.0, 1.0)], "0", 5, force_per_mass=force))
    start = evolution.start()
    with pytest.raises(SolveError, match="is not finite at "):
        evolution.advance(start.state)


@pytest.mark.parametrize(
    ("formula", "line"),
    [
        ("sin(x, m)", "gives sin 2 arguments, which takes 1"),  # NumPy would write it into m
        ("cos(t, x)", "gives cos 2 arguments, which takes 1"),
        ("sin()", "gives sin 0 arguments, which takes 1"),
        ("maximum(x, m, x)", "gives maximum 3 arguments, which takes 2"),
        ("where(x > 0)", "gives where 1 arguments, which takes 3"),
        ("where(x > 0, 1, sin)", "has sin without arguments"),
        *((formula, r"uses more than numbers, \+ - \* / \*\*") for formula in (
            "x@x", "x % m", "x // m", "x << 2", "not x", "~x", "x is m", "x in m", "sin(x, out=m)", "sin(*x)",
        )),
    ],
)  # fmt: skip
def test_a_formula_is_arithmetic_and_functions_of_their_own_number_of_arguments(
    formula: str, line: str
) -> None:
    with pytest.raises(InputError, match=rf"^macroscopic\.force_per_mass = .*: {line}"):
        on_a_line([(0.0, 1.0)], "0", 5, force_per_mass=formula)


def test_what_formulas_may_say() -> None:
    """+(-1) + 3/2 - 2 * 0.5^2 = 0 at any x, and 4 where x > 1/4 and not beyond 3/4."""
    x = np.array([0.0, 0.5, 1.0])
    formula = "+(-1) + 3/2 - 2*0.5**2 + where(x > 0.25, where(x >= 0.75, 0, 4), 0)"
    on_a_line([(0.0, 1.0)], formula, 5)
    assert_allclose(evaluate(formula, x, x=x), [0.0, 4.0, 0.0])
