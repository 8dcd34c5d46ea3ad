"""What a case must satisfy to be run with the macroscopic model."""

from fractions import Fraction
from math import lcm

import numpy as np

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.bodies.gaps import wall_gaps
from fsi.case.case import Case
from fsi.case.checks.without_flow import ROUNDING, check_estimates, check_rest
from fsi.case.magnitudes import LARGEST, SMALLEST
from fsi.case.section import refusal, toml_text
from fsi.case.series import is_zero
from fsi.errors import InputError

# Relative: densities of bodies, and numbers of parcels in each, nearer than this are the same.
_SAME = 1e-9
# The largest number of parcels that is proposed.
_MOST_PARCELS = 10_000


def check_macroscopic(case: Case) -> None:
    """Raise InputError, one line with key, value and remedy, for the first thing that cannot be."""
    container, here = case.container(), f"domain.shape = {toml_text(case.domain.shape)}"
    check_estimates(case)
    check_rest(case)
    _check_forces(case)
    if len(container.periods):
        raise InputError(f'{here}: is periodic, but the line of the macroscopic model ends; give "unbounded"')
    if case.macroscopic.blocks:
        if case.bodies:
            raise refusal(
                "bodies.0", case.bodies[0].name, "there are [[macroscopic.blocks]]; give bodies or blocks"
            )
        if container.walls:
            raise InputError(f'{here}: has walls, which [[macroscopic.blocks]] do not meet; give "unbounded"')
        _check_parcels(case, _masses(case), "masses of the blocks (length times density)", "masses")
        return
    if not case.bodies:
        raise InputError("macroscopic.blocks: missing; give [[macroscopic.blocks]] or [[bodies]] on a line")
    axis = line_of(case)
    q, masses = case.configuration(), case.masses()
    _check_apart(case, q, axis)
    _check_loads(case, axis)
    if masses is None or any(body.mass is None for body in case.bodies):
        raise InputError("bodies.0.mass: missing; the macroscopic model wants the mass of each body")
    per_length = masses[:, axis] / (2.0 * q.radii)
    uneven = int(np.abs(per_length - per_length[0]).argmax())
    if abs(per_length[uneven] - per_length[0]) > _SAME * per_length[0]:
        raise InputError(
            f"bodies.{uneven}.mass = {masses[uneven, axis]:g}: matter has one density, mass over diameter, "
            f"here {per_length[0]:g}; give {2.0 * q.radii[uneven] * per_length[0]:g}"
        )
    _check_parcels(case, q.radii, "diameters of the bodies", "radii")
    if (past := past_walls(case, q)) is not None:
        raise InputError(past)


def past_walls(case: Case, q: Configuration, t: float = 0.0) -> str | None:
    """The line that says which body of the macroscopic model, at q and t, is past a wall; None if none is.

    The model has no walls: a domain with some is as good as an unbounded one while bodies do not meet them.
    """
    for i, w in np.argwhere(wall_gaps(q, case.container()) < -ROUNDING * q.radii.min())[:1]:
        here, body, wall = toml_text(case.domain.shape), case.names[i], case.container().walls[w]
        return (
            f"domain.shape = {here}: body {body!r} is past wall {wall!r} at t = {t:.9g}, "
            'and the macroscopic model has no walls; give "unbounded", or model = "gluey"'
        )
    return None


def line_of(case: Case) -> int:
    """The axis along which the bodies of a case stand, the first where none does. Raises InputError."""
    centres = case.configuration().centres
    spread = np.ptp(centres, axis=0)
    if case.axisymmetric:
        return 1
    if np.count_nonzero(spread) > 1:
        raise InputError(
            f"bodies.1.position = {toml_text(case.bodies[1].position)}: not on a line along an axis with the "
            'others; model = "macroscopic" is for bodies on such a line'
        )
    return int(spread.argmax())


def _check_apart(case: Case, q: Configuration, axis: int) -> None:
    """Bodies touch at most: a step would part them, at a velocity from nowhere."""
    order = np.argsort(q.centres[:, axis], kind="stable")
    x, radii = q.centres[order, axis], q.radii[order]
    gaps = np.diff(x) - radii[1:] - radii[:-1]
    if gaps.min(initial=0.0) < -ROUNDING * radii.min():
        deepest = int(gaps.argmin())
        one, other = (case.names[i] for i in sorted(order[deepest : deepest + 2]))
        raise InputError(f"bodies: {one} and {other} overlap by {-gaps[deepest]:.3g}; move them apart")


def _check_forces(case: Case) -> None:
    """Bodies have their own forces, and blocks their force per mass: there are no others."""
    if case.forces:
        known = "macroscopic.force_per_mass" if case.macroscopic.blocks else "the forces of [[bodies]]"
        raise InputError(f"forces.0: the macroscopic model knows only {known}; drop it")


def _check_loads(case: Case, axis: int) -> None:
    """Along the line bodies are free; nothing pushes free ones off it."""
    for i, body in enumerate(case.bodies):
        if body.motion[axis] != "free":
            raise InputError(
                f"bodies.{i}.velocity = {toml_text(body.velocity)}: bodies of the macroscopic model are free "
                'along their line; give "free" there'
            )
        for k, (motion, load, key) in enumerate(zip(body.motion, body.loads, body.keys, strict=True)):
            if k != axis and motion == "free" and not is_zero(load):
                raise refusal(f"bodies.{i}.{key}", load, "pushes the body off its line; drop it")


def _masses(case: Case) -> Array:
    """Of the blocks, (n,), such that parts of them are numbers."""
    masses = [(block.right - block.left) * block.density for block in case.macroscopic.blocks]
    if not SMALLEST <= (total := sum(masses)) <= LARGEST:
        raise InputError(
            f"macroscopic.blocks: have the mass {total:.3g}, too small or too large for numbers, "
            f"{SMALLEST:g} to {LARGEST:g}; give other units"
        )
    return np.array(masses)


def _check_parcels(case: Case, sizes: Array, told: str, key: str) -> None:
    """Bodies or blocks, whose masses are as their sizes, hold whole parcels: else they get others' masses."""
    given = case.macroscopic.parcels
    if _are_whole(given, sizes):
        return
    here = f"macroscopic.parcels = {given}: the {told} are not whole numbers of parcels"
    parts = (Fraction(part).limit_denominator(_MOST_PARCELS) for part in sizes / sizes.sum())
    least = lcm(*(part.denominator for part in parts))
    remedy = f"give a multiple of {least}"
    if least > _MOST_PARCELS or not _are_whole(least, sizes):
        remedy = f"give {key} whose ratios are those of small whole numbers"
    raise InputError(f"{here}; {remedy}")


def _are_whole(parcels: int, sizes: Array) -> bool:
    """Whether each body or block has a whole number of parcels."""
    parts = parcels * sizes / sizes.sum()
    return bool(np.abs(parts - np.rint(parts)).max() <= _SAME * parcels)
