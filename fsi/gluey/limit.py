"""One body above a wall as the viscosity vanishes: its path, the exact limit, the first-order scheme.

    q'' = -eps q'/q + f,  q(0) = q0 > 0,  q'(0) = u0,          gamma_eps = eps ln q

As eps -> 0, with `utilde = u0 + int f`,

    q' + gamma = utilde,   q >= 0,   gamma <= 0,   q gamma = 0.

While the body sticks, `gamma` stores the impulse of the push, and a pull must pay it back before release.
Source: B. Maury, A gluey particle model, ESAIM Proc. 18 (2007) 133; A. Lefebvre, Numerical simulation
of gluey particles, M2AN 43 (2009) 53. The unit of mass is that of the body.

At eps > 0 the equation is solved by its first integral:

    w = q' + gamma,  gamma = eps ln q,   w' = f       so that      q' = w(t) - gamma,  w known exactly.

The unknown is gamma, since q = exp(gamma/eps) underflows where the body sticks: then the equation turns into
`gamma = w` by itself, and no memory is lost. Each implicit stage is solved in closed form by the Wright
omega function. Source of the method: E. Hairer & G. Wanner, Solving Ordinary Differential Equations II,
table IV.6.5: SDIRK of order 4, L-stable, stiffly accurate, so of order 4 where the equation is algebraic,
too.

On arrival at the speed W, q falls by exp(-W/eps) within what rounding leaves of t, and gamma jumps: the
collision of the limit. There the shortest step is taken by backward Euler,

    (exp(gamma_1/eps) - q)/h + gamma_1 = w(t + h),

the gluey scheme at eps > 0. It is monotone, so it leaps to `gamma = w` without overshooting, and since
`d(w - eps ln q)/dq < 0`, errors of q never grow: that of this step is below h W, which is rounding.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import PPoly
from scipy.optimize import brentq

from fsi.arrays import Array
from fsi.errors import InputError, SolveError
from fsi.gluey.film import log_gap


@dataclass(frozen=True, slots=True)
class Limit:
    """The limit by Skorokhod's reflection: `Q = q0 + int utilde`, `q(t) = Q(t) - min(0, min_{s <= t} Q(s))`.

    utilde: `u0 + int f`; Q: its integral plus q0, both piecewise polynomials in t >= 0;
    lowest: times at which Q takes extreme values between its ends, increasing.
    """

    utilde: PPoly
    Q: PPoly
    lowest: Array

    @classmethod
    def of(cls, q0: float, u0: float, f: PPoly) -> Limit:
        """The limit for a force per mass f, any piecewise polynomial that begins at t = 0."""
        utilde = f.antiderivative()
        utilde.c[-1] += u0
        Q = utilde.antiderivative()
        Q.c[-1] += q0
        stationary = utilde.roots(discontinuity=False, extrapolate=False)
        # A piece on which utilde vanishes altogether is reported by its left end and NaN.
        return cls(utilde, Q, np.unique(np.append(stationary[np.isfinite(stationary)], f.x)))

    def lowest_until(self, t: Array) -> Array:
        """`min(0, min_{s <= t} Q(s))`."""
        until = np.minimum.accumulate(np.append(0.0, self.Q(self.lowest)))
        passed = until[np.searchsorted(self.lowest, t, side="right")]
        lowest: Array = np.minimum(passed, self.Q(t))
        return lowest

    def q(self, t: Array) -> Array:
        """The distance, shape of t; exactly 0 in contact."""
        q: Array = self.Q(t) - self.lowest_until(t)
        return q

    def gamma(self, t: Array) -> Array:
        """The memory: `min(utilde, 0)` in contact, 0 elsewhere."""
        touching = self.q(t) <= self._rounding()
        gamma: Array = np.where(touching, np.minimum(self.utilde(t), 0.0), 0.0)
        return gamma

    def contacts(self) -> list[tuple[float, float]]:
        """The intervals (contact, release) in which the body sticks, in order; the last may have no end."""
        f = self.utilde.x
        candidates = np.unique(np.concatenate([self.lowest, self._arrivals(), [f[0], f[-1]]]))
        middles = 0.5 * (candidates[1:] + candidates[:-1])
        sticks = self.q(middles) <= self._rounding()
        edges = np.flatnonzero(np.diff(np.concatenate([[0], sticks.astype(int), [0]])))
        times = candidates[edges].reshape(-1, 2)
        return [(float(a), float(b) if b < f[-1] else np.inf) for a, b in times]

    def _arrivals(self) -> Array:
        """Times at which Q falls to its running minimum, from above.

        Q is monotone between its extremes, so that each is a simple root there. Where the body lets go, Q has
        its minimum: that is a root of utilde, and as a double one of Q it would be known to 1e-8 only.
        """
        t, Q = self.lowest, self.Q(self.lowest)
        level = np.minimum.accumulate(np.append(0.0, Q))[1:-1]  # at the beginning of each interval of t
        falls = np.flatnonzero((Q[:-1] > level + self._rounding()) & (Q[1:] < level))

        def above(s: float, k: int) -> float:
            return float(self.Q(s) - level[k])

        return np.array([brentq(above, t[k], t[k + 1], args=(k,), xtol=1e-300) for k in falls])

    def _rounding(self) -> float:
        """Below this a distance is rounding in Q."""
        return 128.0 * float(np.finfo(float).eps) * float(np.abs(self.Q(self.lowest)).max())


def slides_scheme(q0: float, u0: float, impulses: Array, h: Array) -> tuple[Array, Array, Array]:
    """The distances of the slides' scheme, case by case: a push stores gamma, a pull pays it back first.

    It begins at q0, u0, with `int f dt` over steps of lengths h, both (n,), and gives q, u, gamma at the
    start and at the ends of all steps, (n + 1,). First order in h.

    In a step that ends in contact, u is the velocity with which q gets there, `q += h u`, as it is for many
    bodies (`fsi.gluey.step`), and gamma what it misses; the slides have u = 0 and all of it in gamma. Only
    u + gamma enters the next step, which is the same, and so are all distances.
    """
    q, u, gamma = (np.zeros(len(h) + 1) for _ in range(3))
    q[0], u[0] = q0, u0
    for n, (step, impulse) in enumerate(zip(h, impulses, strict=True)):
        u_tilde = u[n] + impulse + gamma[n]
        if q[n] + step * u_tilde >= 0.0:  # free, or released: what was stored has been paid back
            u[n + 1] = u_tilde
            q[n + 1] = q[n] + step * u_tilde
        else:  # arrives or stays: the velocity that it cannot have is stored
            u[n + 1] = -q[n] / step
            gamma[n + 1] = u_tilde - u[n + 1]
    return q, u, gamma


A = np.array(
    [
        [1 / 4, 0, 0, 0, 0],
        [1 / 2, 1 / 4, 0, 0, 0],
        [17 / 50, -1 / 25, 1 / 4, 0, 0],
        [371 / 1360, -137 / 2720, 15 / 544, 1 / 4, 0],
        [25 / 24, -49 / 48, 125 / 16, -85 / 12, 1 / 4],
    ]
)
C = A.sum(axis=1)
# Two formulas of order 3 less that of order 4, for the slopes at the start and of the stages. The first is
# the source's: blind to what happens before the first stage, at a quarter of the step, as a release may.
ESTIMATES = np.array([[0, -3 / 16, -27 / 32, 25 / 32, 0, 1 / 4], [1 / 4, -11 / 16, -11 / 32, 25 / 32, 0, 0]])
DIAGONAL = 1 / 4
# Errors of a step that are tolerated: in q, relative and absolute; in gamma.
RELATIVE, ABSOLUTE, IN_GAMMA = 1e-10, 1e-12, 1e-8
# In ln q: less than that, or a step that has not seen the wall could be taken for a good one.
IN_LOG = 1e-2
# Of the largest w: what rounding makes of gamma in a step; and the least eps whose ln q this leaves alone.
ROUNDING, SMALLEST = 2e-14, 1e-12
# Of the time span: the shortest step, which t still feels.
SHORTEST = 1e-15
# A step that would end nearer than this to a stop, of itself, ends there: less than a rejected step shrinks.
NEARLY = 1.05
MOST_STEPS = 200_000


@dataclass(frozen=True, slots=True)
class Path:
    """A solution.

    Attributes:
        t: times, shape (n,).
        q: the distance there, 0 where it underflows, (n,).
        gamma: eps ln q, (n,).
        steps: how many were tried.
    """

    t: Array
    q: Array
    gamma: Array
    steps: int


def solve(q0: float, u0: float, f: PPoly, eps: float, t: Array) -> Path:
    """The solution from q0 > 0, u0 at increasing times t >= 0, for eps > 0 and the force f per mass.

    f is a piecewise polynomial that begins at time 0 and covers t. Raises InputError: eps is below the
    rounding of velocities; SolveError: MOST_STEPS do not reach the end.
    """
    w = f.antiderivative()
    w.c[-1] += u0 + eps * np.log(q0)
    # Steps land on the breaks of f, and on the contacts of the limit, which they could leap over.
    events = np.concatenate([f.x, np.ravel(Limit.of(q0, u0, f).contacts())])
    stops = np.unique(np.concatenate([t, events[(events > 0.0) & (events < t[-1])]]))
    largest = float(np.abs(w(np.concatenate([f.x, t]))).max())
    if eps < SMALLEST * largest:
        ratio = f"{eps / largest:.1e} of the largest velocity, and rounding {SMALLEST:g}"
        raise InputError(f"limit.eps: one is {ratio}; make it larger")
    tolerated = min(IN_GAMMA, IN_LOG * eps) + ROUNDING * largest
    film = _Film(w, eps, tolerated, SHORTEST * float(t[-1]))
    now = _Now(0.0, q0, eps * np.log(q0), 1e-3 * float(t[-1]), 0)
    stages = {0.0: now}
    for stop in map(float, stops[stops > 0.0]):
        now = stages[stop] = _until(stop, film, now)
    q, gamma = np.array([(stages[time].q, stages[time].gamma) for time in map(float, t)]).T
    return Path(t, q, gamma, now.steps)


@dataclass(frozen=True, slots=True)
class _Film:
    """The equation and how it is solved: w(t), eps, the tolerated error of gamma, the shortest step."""

    w: PPoly
    eps: float
    tolerated: float
    shortest: float


@dataclass(frozen=True, slots=True)
class _Now:
    """A time t, q and gamma there, the step h to try next, how many were tried."""

    t: float
    q: float
    gamma: float
    h: float
    steps: int


def _until(stop: float, film: _Film, now: _Now) -> _Now:
    """Go on to the time `stop`, by steps whose estimated errors are tolerated. Raises SolveError."""
    t, q, gamma, h, steps = now.t, now.q, now.gamma, now.h, now.steps
    while t < stop:
        steps += 1
        if steps > MOST_STEPS:
            raise SolveError(
                f"limit.eps: {MOST_STEPS} steps end at {t / stop:.2g} of the way to a stop; shorten time.end"
            )
        landing = t + NEARLY * h >= stop
        used = stop - t if landing else h
        q1, gamma1, error = _step(film, q, gamma, t, used)
        growth = min(4.0, max(0.1, 0.9 * max(error, 1e-12) ** -0.25))
        if error > 1.0 and used > NEARLY * film.shortest:
            h = max(used * growth, film.shortest)
            continue
        q, gamma = (q1, gamma1) if error <= 1.0 else _collide(film, q, t, used)
        t = stop if landing else t + used
        h = max(h if landing else film.shortest, used * growth)
    return _Now(t, q, gamma, h, steps)


def _collide(film: _Film, q: float, t: float, h: float) -> tuple[float, float]:
    """q and gamma after a step of backward Euler."""
    y = float(log_gap(q + h * float(film.w(np.nextafter(t + h, t))), h * film.eps))
    return float(np.exp(y)), film.eps * y


def _step(film: _Film, q: float, gamma: float, t: float, h: float) -> tuple[float, float, float]:
    """q and gamma after a step, and its estimated error over what is tolerated."""
    w, eps = film.w, film.eps
    start, slopes = float(w(t)) - gamma, np.zeros(5)
    w_stages = w(np.minimum(t + h * C, np.nextafter(t + h, t)))  # the piece of this step also at its end
    stage = gamma
    c = DIAGONAL * h * eps
    for i in range(5):
        r = q + h * float(A[i, :i] @ slopes[:i]) + DIAGONAL * h * float(w_stages[i])
        stage = eps * float(log_gap(r, c))  # one implicit stage: the solution is gamma/eps = ln q
        slopes[i] = w_stages[i] - stage
    q1 = float(np.exp(stage / eps))
    raw = h * float(np.abs(ESTIMATES @ np.append(start, slopes)).max())
    # The estimate filtered by (1 + h eps / (4 q))^-1, as stiff equations want it.
    in_q, in_gamma = raw * q1 / (q1 + c), raw * eps / (q1 + c)
    return q1, stage, max(in_q / (RELATIVE * q1 + ABSOLUTE), in_gamma / film.tolerated)
