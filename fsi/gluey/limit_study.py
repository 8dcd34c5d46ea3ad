"""One gap as the viscosity vanishes, and its convergence to the limit."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import PPoly

from fsi.arrays import Array
from fsi.bodies.forces import Bulk
from fsi.case.case import Case
from fsi.case.gluey import LimitStudy
from fsi.case.section import refusal, toml_text
from fsi.case.series import Table, polynomial
from fsi.errors import InputError
from fsi.gluey.limit import Limit, Path, slides_scheme, solve
from fsi.meshes.geometry.container import Container

SAMPLES = 400


@dataclass(frozen=True, slots=True)
class OneGap:
    """`q'' = -eps q'/q + f` on [0, end]: the gap of one body above a wall, or of two on a line.

    Attributes:
        q0: the gap at time 0, > 0.
        u0: its rate at time 0.
        f: what drives it apart, per mass.
        end: of time.
        radius: of the smaller body.
        room: the gap at which a body reaches the wall behind it; infinite where there is none.
    """

    q0: float
    u0: float
    f: PPoly
    end: float
    radius: float
    room: float = np.inf

    def solved(self, eps: float, t: Array) -> Path:
        """The solution at times t with `gamma = eps ln(q / a)`, a the radius. Raises as `solve`.

        It is solved for q / a over t / end, in which the tolerances of `solve` are relative ones.
        """
        a, T = self.radius, self.end
        f = self.f
        powers = np.arange(len(f.c))[::-1, None]
        scaled = PPoly(f.c * (T ** (2.0 + powers) / a), f.x / T)
        path = solve(self.q0 / a, self.u0 * T / a, scaled, eps * T / a, t / T)
        return Path(t, a * path.q, a / T * path.gamma, path.steps)


def one_gap(case: Case) -> OneGap:
    """The gap of one body that a wall faces, or of two along an axis. Raises InputError of other cases."""
    masses = case.masses()
    massless = sum(body.mass is None for body in case.bodies)
    if masses is None or massless or len(case.bodies) not in (1, 2):
        raise InputError(
            f"bodies: there are {len(case.bodies)}, {len(case.bodies) - massless} with a mass; `fsi limit` "
            "is for one gap, of a body with a mass and a wall, or of two such bodies on a line along an axis"
        )
    _require_known(case)
    q, U, end = case.configuration(), case.initial_velocity(), case.timing.end
    container = case.container()
    if len(case.bodies) == 2:
        between = q.centres[1] - q.centres[0]
        axis = int(np.abs(between).argmax())
        sides = (1, 0) if between[axis] > 0.0 else (0, 1)
        gap = float(abs(between[axis]) - q.radii.sum())
        if np.count_nonzero(between) > 1:
            raise InputError(
                f"bodies.1.position = {toml_text(case.bodies[1].position)}: not on a line along an axis with "
                "the other one; `fsi limit` is for one gap"
            )
        if walls := _facing(container, axis):
            raise InputError(
                f'domain: the bodies may meet its wall "{container.walls[walls[0]]}", and `fsi limit` is for '
                'one gap; give two bodies shape = "unbounded"'
            )
        upper, lower = (_accelerations(case, i, axis, n) for i, n in zip(sides, (1.0, -1.0), strict=True))
        rate = float(U[sides[0], axis] - U[sides[1], axis])
        return OneGap(gap, rate, _sum([*upper, *lower], end), end, float(q.radii.min()))
    free = [axis for axis in range(case.dimension) if case.bodies[0].motion[axis] == "free"]
    axis = free[-1] if free else case.dimension - 1
    facing = _facing(container, axis)
    if not facing:
        raise InputError(
            "domain: no wall faces the body; `fsi limit` is for one gap; give a half-plane or a box"
        )
    gaps = container.distances(q.centres)[0, facing] - q.radii[0]
    wall = facing[int(gaps.argmin())]
    n = float(container.normals(q.centres)[0, wall, axis])
    rate, radius = n * float(U[0, axis]), float(q.radii[0])
    room = float(gaps.sum()) if len(facing) > 1 else np.inf
    return OneGap(float(gaps.min()), rate, _sum(_accelerations(case, 0, axis, n), end), end, radius, room)


def _facing(container: Container, axis: int) -> list[int]:
    """The walls across an axis, but for those that stand for infinity."""
    return [
        w
        for w, name in enumerate(container.walls)
        if name not in container.far_walls and container.corner_axes[w] == axis
    ]


def _accelerations(case: Case, i: int, axis: int, n: float) -> list[tuple[float, float | Table]]:
    """n times those of body i along an axis, as multiples of its load and of gravity's accelerations."""
    body, masses = case.bodies[i], case.masses()
    assert masses is not None  # `one_gap` has asked
    terms = [(n / masses[i, axis], body.loads[axis])]
    if body.motion[axis] == "free":
        bulk = Bulk(masses[:, 0], case.bulk().volumes)
        weights = [weight for force in case.forces if (weight := force.weight(bulk)) is not None]
        terms += [(n * float(heavy[i]) / masses[i, axis], g[axis]) for heavy, g in weights]
    return terms


def _require_known(case: Case) -> None:
    """What drives the gap is known in time, walls are those of the domain, and contact is never solid."""
    if case.gluey.walls:
        name = case.gluey.walls[0].name
        raise refusal("gluey.walls.0.name", name, "`fsi limit` knows walls of the domain only; drop it")
    for key in ("gamma_min", "roughness"):
        if (value := getattr(case.gluey, key)) is not None:
            solid = "contact becomes solid there, and in `fsi limit` it never does; drop it, or use `fsi run`"
            raise refusal(f"gluey.{key}", value, solid)
    for k, force in enumerate(case.forces):
        if force.reach > 0.0:
            raise refusal(
                f"forces.{k}", force, "depends on the gap, and `fsi limit` knows forces in time; drop it"
            )
        if force.weight(case.bulk()) is None:
            here = "no weight, and `fsi limit` integrates tables; give bodies their force, or use `fsi run`"
            raise refusal(f"forces.{k}", force, here)


def _sum(terms: Sequence[tuple[float, float | Table]], end: float) -> PPoly:
    """A sum of multiples of tables on [0, end], as one piecewise polynomial."""
    parts = [(factor, polynomial(series, end)) for factor, series in terms]
    breaks = np.unique(np.concatenate([part.x for _, part in parts]))
    starts = breaks[:-1]
    slopes = sum(factor * part.derivative()(starts) for factor, part in parts)
    return PPoly(np.array([slopes, sum(factor * part(starts) for factor, part in parts)]), breaks)


@dataclass(frozen=True, slots=True)
class Study:
    """Solutions at t, (n,), for each eps, the limit there, and the scheme's errors for each number of steps.

    errors_q: `sup |q_eps - q|`; errors_gamma: the mean of `|gamma_eps - gamma|` (gamma jumps on contact);
    scheme: `max |q_h - q|` over the steps.
    """

    t: Array
    q: Array
    gamma: Array
    paths: tuple[Path, ...]
    errors_q: Array
    errors_gamma: Array
    scheme: Array
    contacts: list[tuple[float, float]]
    wanted: LimitStudy


def study(case: Case) -> Study:
    """Solve for the one gap of a case, for each eps and number of steps of [limit]. Raises InputError."""
    gap, wanted = one_gap(case), case.limit or LimitStudy()
    limit = Limit.of(gap.q0, gap.u0, gap.f)
    _require_room(gap, limit)
    contacts = limit.contacts()
    events = [time for pair in contacts for time in pair if np.isfinite(time)]
    t = np.unique(np.concatenate([np.linspace(0.0, gap.end, SAMPLES + 1), events]))
    q, gamma = limit.q(t), limit.gamma(t)
    paths = tuple(gap.solved(eps, t) for eps in wanted.eps)
    arrivals = [begin for begin, _ in contacts]  # there gamma jumps
    width = np.where(np.isin(t, arrivals), 0.0, np.gradient(t)) / gap.end
    return Study(
        t, q, gamma, paths,
        np.array([np.abs(path.q - q).max() for path in paths]),
        np.array([(width * np.abs(path.gamma - gamma)).sum() for path in paths]),
        np.array([_scheme_error(gap, limit, steps) for steps in wanted.steps]),
        contacts, wanted,
    )  # fmt: skip


def _require_room(gap: OneGap, limit: Limit) -> None:
    """Raise InputError: the body reaches the wall behind it, which the equation does not know."""
    t = np.unique(np.concatenate([np.linspace(0.0, gap.end, SAMPLES + 1), limit.lowest]))
    reached = t[limit.q(t) >= gap.room]
    if reached.size:
        far = f"the body reaches the wall behind it by t = {reached[0]:.4g}, and `fsi limit` is for one gap"
        raise refusal("time.end", gap.end, f"{far}; end before, or give a half-plane")


def _scheme_error(gap: OneGap, limit: Limit, steps: int) -> float:
    t = np.linspace(0.0, gap.end, steps + 1)
    impulses = np.diff(limit.utilde(t))
    q, _, _ = slides_scheme(gap.q0, gap.u0, impulses, np.diff(t))
    return float(np.abs(q - limit.q(t)).max())
