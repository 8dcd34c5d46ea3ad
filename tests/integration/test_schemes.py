from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any, ClassVar, cast

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration, Inertia
from fsi.integration.adams import Adams
from fsi.integration.errors import ErrorEstimate, StepErrors
from fsi.integration.schemes import SCHEMES, AscherRuuthSpiteri, Beginning, BogackiShampine, register_scheme
from fsi.integration.state import Instant, Model, Past, Scheme, State, Trial
from fsi.integration.stepper import Stepper
from fsi.lubrication.ellipsoids import free_rotation, spheroid_axis
from fsi.lubrication.exact import settling_time
from fsi.meshes.geometry.ellipsoid import Ellipsoid
from fsi.models import make_stepper
from tests.exact_model import DiscsBesidePlane, ExactInstant, settling_case


class Field:
    """A model whose velocities are a given function of (q, t)."""

    def __init__(self, velocity: Callable[[Configuration, float], Array]) -> None:
        self.velocity = velocity

    def __call__(
        self,
        q: Configuration,
        t: float,
        inertia: Inertia | None = None,  # noqa: ARG002
    ) -> ExactInstant:
        U = self.velocity(q, t)
        return ExactInstant(U, U)

    def errors(self, q: Configuration, t: float, instant: Instant) -> None:
        pass

    def state(self) -> dict[str, NDArray[Any]]:
        return {}

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        pass


def fixed_steps(scheme: Scheme, model: Model, q: Configuration, end: float, number: int) -> State:
    """The state after equal steps without control."""
    state = State(0.0, 0, q, scheme.start(model, q)[1], end / number)
    for k in range(1, number + 1):
        trial = scheme.step(model, state, end * k / number)
        state = State(end * k / number, k, trial.q, trial.instant.U, state.h)
    return state


def slope(errors: list[float]) -> float:
    """Order between the last two of halved steps."""
    return math.log2(errors[-2] / errors[-1])


def disc_at(x: float, y: float) -> Configuration:
    return Configuration(np.array([[x, y]]), np.zeros(1), np.ones(1))


def spiral(q: Configuration, t: float) -> Array:
    """`z' = (i - 1/2) z + e^{it}` for z = x + i y, `angle' = cos t`."""
    z = q.centres[:, 0] + 1j * q.centres[:, 1]
    w = (1j - 0.5) * z + np.exp(1j * t)
    return np.column_stack([w.real, w.imag, np.cos(t) * np.ones(len(q))])


def test_bogacki_shampine_has_order_three_and_its_estimate_too() -> None:
    errors, estimates = [], []
    for number in (20, 40, 80):
        q = fixed_steps(BogackiShampine(), Field(spiral), disc_at(1.0, 0.0), 2.0, number).q
        # z = 2 e^{it} - e^{(i - 1/2) t} solves it with z(0) = 1.
        z = 2 * np.exp(2j) - np.exp((1j - 0.5) * 2.0)
        errors.append(float(np.hypot(*(q.centres[0] - (z.real, z.imag)))))
        start = State(0.0, 0, disc_at(1.0, 0.0), spiral(disc_at(1.0, 0.0), 0.0), 0.0)
        estimates.append(float(abs(BogackiShampine().step(Field(spiral), start, 2.0 / number).error).max()))
        assert q.angles[0] == pytest.approx(math.sin(2.0), rel=(2.0 / number) ** 3)
    assert slope(errors) == pytest.approx(3.0, abs=0.1)
    assert slope(estimates) == pytest.approx(3.0, abs=0.1)


SPHEROID = Ellipsoid(np.array([1.0, 0.5, 0.5]))
SHEAR = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]])  # u = z e_x


def jeffery(q: Configuration, _: float) -> Array:
    """Of a free spheroid in shear (1922)."""
    own = q.standing[0].rotation
    omega = own @ free_rotation(SPHEROID.half_axes, own.T @ SHEAR @ own)
    return np.concatenate([np.zeros(3), omega])[None]


def orbit(scheme: Scheme, number: int, end: float = 2.0) -> float:
    """How far its axis is from where it should be after equal steps, and a short past that is exact."""
    h = end / number
    q = Configuration(np.zeros((1, 3)), np.array([[0.3, 0.2, 1.0]]), np.ones(1), ellipsoids=(SPHEROID,))
    exact = spheroid_axis(2.0, SHEAR, q.standing[0].rotation[:, 0], end)
    # Times before are those of many small steps backwards.
    ago = [fixed_steps(BogackiShampine(), Field(jeffery), q, -k * h, 20 * k).U for k in (1, 2)]
    past = Past(-h * np.arange(1.0, 3.0), np.array(ago), np.zeros((1, 6)))
    state = State(0.0, 0, q, jeffery(q, 0.0), h, past)
    for k in range(1, number + 1):
        trial = scheme.step(Field(jeffery), state, k * h)
        state = State(k * h, k, trial.q, trial.instant.U, h, trial.past)
    return float(np.linalg.norm(state.q.standing[0].rotation[:, 0] - exact))


@pytest.mark.parametrize(("scheme", "order"), [(BogackiShampine(), 3), (Adams(), 4)])
def test_what_turns_out_of_a_plane_has_the_same_order(scheme: Scheme, order: int) -> None:
    """Turns in space do not commute: without what that takes both are of order 2."""
    errors = [orbit(scheme, number) for number in (16, 32)]
    assert slope(errors) == pytest.approx(order, abs=0.25)
    assert errors[1] < 1e-5


def spinning(_: Configuration, t: float) -> Array:
    """omega = (t / 2, 1, 0), linear in time, out of a plane."""
    return np.array([[0.0, 0.0, 0.0, 0.5 * t, 1.0, 0.0]])


def turned_by(t: float) -> Rotation:
    """R with R' = omega x R, R(1) = 1, at t."""

    def rate(at: float, R: Array) -> Array:
        omega = spinning(AT_REST, at)[0, 3:]
        return np.cross(omega, R.reshape(3, 3), axisb=0, axisc=0).ravel()

    found = solve_ivp(rate, (1.0, t), np.eye(3).ravel(), method="DOP853", rtol=1e-12, atol=1e-13)
    return Rotation.from_matrix(found.y[:, -1].reshape(3, 3))


AT_REST = Configuration(np.zeros((1, 3)), np.zeros((1, 3)), np.ones(1), ellipsoids=(SPHEROID,))
MASSLESS = AscherRuuthSpiteri(Beginning(np.zeros((1, 6)), np.zeros((1, 6)), 1e-6))


@pytest.mark.parametrize("h", [0.4, 0.8])
@pytest.mark.parametrize("scheme", [MASSLESS, BogackiShampine(), Adams()])
def test_errors_of_turns_out_of_a_plane_are_seen(scheme: Scheme, h: float) -> None:
    """Of omega linear in time: differences of displacements told 0, and steps grew at any tolerance."""
    past = Past(np.array([0.5, 0.0]), np.array([spinning(AT_REST, t) for t in (0.5, 0.0)]), np.zeros((1, 6)))
    trial = scheme.step(Field(spinning), State(1.0, 0, AT_REST, spinning(AT_REST, 1.0), h, past), 1.0 + h)
    missed = (Rotation.from_rotvec(trial.q.angles[0]) * turned_by(1.0 + h).inv()).magnitude()
    assert 0.6 < np.linalg.norm(trial.error[0, 3:]) / missed < 3.0


def test_inertia_has_order_two_with_the_resistance_of_the_film() -> None:
    """The force depends on time too, which tells whether each stage takes it at its own."""
    force = {"times": [0.0, 2.0], "values": [-5.0, -50.0]}
    case = settling_case(0.5, body={"force": [0.0, force], "mass": 10.0, "moment_of_inertia": 1.0})
    masses = np.array([[10.0, 10.0, 1.0]])
    scheme = AscherRuuthSpiteri(Beginning(masses, np.zeros((1, 3)), rest=1e-12))
    model = DiscsBesidePlane(case)

    def newton(t: float, y: Array) -> list[float]:
        R = model.resistance(disc_at(0.0, y[0]))[0, 1]
        return [y[1], (case.motion(t).F[0, 1] - R * y[1]) / 10.0]

    exact = solve_ivp(newton, (0.0, 0.5), [2.0, 0.0], method="DOP853", rtol=1e-13, atol=1e-14).y[:, -1]
    positions, velocities = [], []
    for number in (40, 80, 160):
        end = fixed_steps(scheme, model, case.configuration(), 0.5, number)
        positions.append(abs(end.q.centres[0, 1] - exact[0]))
        velocities.append(abs(end.U[0, 1] - exact[1]))
    assert slope(positions) == pytest.approx(2.0, abs=0.1)
    assert slope(velocities) == pytest.approx(2.0, abs=0.1)


def test_a_body_with_inertia_begins_with_its_velocity() -> None:
    """A disc that turns in place, `I omega' = -R omega`: omega = omega_0 exp(-R t / I)."""
    body = {"mass": 1.0, "moment_of_inertia": 20.0, "force": [0.0, 0.0], "velocity": [0.0, 0.0]}
    case = settling_case(1.0, tolerance=1e-7, body=body | {"initial_angular_velocity": 3.0})
    stepper = make_stepper(case, DiscsBesidePlane(case))
    step = stepper.start(case.configuration())
    R = DiscsBesidePlane(case).resistance(case.configuration())[0, 2]
    assert step.instant.U[0, 2] == 3.0
    assert step.instant.F[0, 2] == 3.0 * R
    while step.state.t < 1.0:
        step = stepper.advance(step.state)
    assert step.state.U[0, 2] == pytest.approx(3.0 * math.exp(-R / 20.0), rel=1e-5)


def test_a_scheme_from_outside_is_chosen_by_its_name(monkeypatch: pytest.MonkeyPatch) -> None:
    """One class under a decorator: the midpoint rule, of order 2 in the field of a disc over a plane."""
    monkeypatch.setitem(SCHEMES, "midpoint", SCHEMES["bogacki-shampine"])  # so that it goes again
    del SCHEMES["midpoint"]

    @register_scheme("midpoint", 2)
    class Midpoint:
        error_order: ClassVar[int] = 3

        def __init__(self, _: Beginning) -> None:
            pass

        def start(self, model: Model, q: Configuration) -> tuple[Instant, Array]:
            instant = model(q, 0.0)
            return instant, instant.U

        def step(self, model: Model, state: State, t_end: float) -> Trial:
            h = t_end - state.t
            q = state.q.moved(h * model(state.q.moved(h / 2 * state.U), state.t + h / 2).U)
            instant = model(q, t_end)
            return Trial(q, instant, np.zeros_like(instant.U))

    case, errors = settling_case(1.0, scheme="midpoint"), []
    model = DiscsBesidePlane(case)
    stepper = make_stepper(case, model)
    assert isinstance(stepper, Stepper)
    for number in (20, 40, 80):
        end = fixed_steps(stepper.scheme, model, case.configuration(), 1.0, number)
        gap = end.q.centres[0, 1] - 1.0
        errors.append(abs(float(settling_time(gap, 1.0, 1.0, 1.0, -4 * math.pi)) - 1.0))
    assert slope(errors) == pytest.approx(2.0, abs=0.1)


def test_what_is_no_scheme_is_refused_as_it_is_registered() -> None:
    """It was taken, and a run ended with "no attribute 'start'"."""

    class Idle:
        error_order: ClassVar[int] = 3

        def __init__(self, _: Beginning) -> None:
            pass

    with pytest.raises(ValueError, match=r"^'idle': Idle is no scheme, as it lacks start, step$"):
        register_scheme("idle", 2)(cast(Any, Idle))
    always: Any = "always"
    with pytest.raises(ValueError, match=r"^'idle': inertia = 'always' is none of none, some, all$"):
        register_scheme("idle", 2, inertia=always)(cast(Any, Idle))
    assert "idle" not in SCHEMES


def test_a_scheme_whose_name_is_taken_is_refused() -> None:
    """That of the program stays."""
    before = SCHEMES["ascher-ruuth-spiteri"]
    with pytest.raises(
        ValueError, match=r'^"ascher-ruuth-spiteri": is the name of fsi\.integration\.schemes\.Asch'
    ):
        register_scheme("ascher-ruuth-spiteri", 3)(lambda _: BogackiShampine())
    assert SCHEMES["ascher-ruuth-spiteri"] is before
    with pytest.raises(ValueError, match=r'^"distance": is the name of '):  # that a model steps by itself
        register_scheme("distance", 3)(lambda _: BogackiShampine())


def test_the_estimate_with_inertia_is_of_third_order() -> None:
    """Displacement less that of the trapezoidal rule; with the velocity at the start alone of second."""
    force = {"times": [0.0, 2.0], "values": [-5.0, -50.0]}
    case = settling_case(0.5, body={"force": [0.0, force], "mass": 10.0, "moment_of_inertia": 1.0})
    U0 = np.array([[0.0, -0.2, 0.0]])
    scheme = AscherRuuthSpiteri(Beginning(np.array([[10.0, 10.0, 1.0]]), U0, rest=1e-12))
    state = State(0.0, 0, case.configuration(), U0, 0.1)
    sizes = (0.02, 0.01, 0.005)
    found = [float(np.abs(scheme.step(DiscsBesidePlane(case), state, h).error).max()) for h in sizes]
    assert slope(found) == pytest.approx(3.0, abs=0.1)


def test_errors_stand_in_the_columns_of_what_they_are_errors_of() -> None:
    errors = ErrorEstimate(np.array([[1.0, 2.0, 3.0]]), np.array([[4.0, 5.0, 6.0]]), 0.0, 7.0)
    step = StepErrors(errors, {"velocity": 0.1, "force": 0.2})
    names = ("V_x", "V_y", "omega", "F_x", "F_y", "T")
    assert {name: float(value[0]) for name, value in step.body_columns.items()} == {
        f"err_{name}": k + 1.0 for k, name in enumerate(names)
    }
    assert step.columns["err_U"] == 0.1
    assert step.columns["err_F"] == 0.2
