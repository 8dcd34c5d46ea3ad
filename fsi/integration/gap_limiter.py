"""The gap limiter: what fraction of the gaps, of bodies and walls, a displacement closes."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.bodies.feet import Feet
from fsi.bodies.gaps import Gaps, find_gaps
from fsi.meshes.geometry.container import Container

# What is predicted from the present velocity aims below the limit, so that the stages, whose
# velocities differ a little, seldom exceed it; with the stretch of Schedule.landing it stays below 1.
SAFETY = 0.9
# Of bodies that are no discs: places on a way that are looked at, and the least part of a gap between two.
MOST_PLACES, LEAST_ROOM = 50, 0.02
KNOWN = 1e3  # times the rounding of places is the narrowest gap of which they hold enough
SOON = 0.25  # of the way that is left: gaps that may be at their limit by then are looked at together


@dataclass(frozen=True, slots=True)
class Approach:
    """The gap that closes most, relative to itself.

    loss: fraction of the gap lost on the way, 1 or more for contact, negative when it opens;
    gap: its value before; between: the two sides, as positions in the bodies followed by the walls.
    """

    loss: float
    gap: float
    between: tuple[int, int]


class GapRefusedError(Exception):
    """A displacement closes a gap by more than the limit: the step is tried again, shorter."""

    def __init__(self, approach: Approach) -> None:
        super().__init__(approach)
        self.approach = approach


def _closest_pass(q: Configuration, displacement: Array, gaps: Gaps, away_moves: Array) -> Array:
    """Smallest gap of the pairs on the straight way, shape (P,): none can jump through another.

    away_moves: how much further the images of a sheared cell come, (P, d).
    """
    i, j = gaps.pairs.T
    separation = q.centres.take(i, axis=0) - q.centres.take(j, axis=0) - gaps.away
    change = displacement.take(i, axis=0) - displacement.take(j, axis=0) - away_moves
    length2 = np.einsum("pk,pk->p", change, change)
    nearest = -np.einsum("pk,pk->p", separation, change) / np.where(length2 > 0.0, length2, 1.0)
    passed = separation + np.clip(nearest, 0.0, 1.0)[:, None] * change
    closest: Array = np.sqrt(np.einsum("pk,pk->p", passed, passed)) - q.radii[i] - q.radii[j]
    return closest


def _losing(gaps: Gaps, displacement: Array, away_moves: Array, loss: float) -> NDArray[np.intp]:
    """The pairs that would lose `loss` if they moved straight towards each other; all if none would."""
    way, (i, j) = np.linalg.norm(displacement, axis=1), gaps.pairs.T
    images = np.linalg.norm(away_moves, axis=1)
    would = np.flatnonzero(way[i] + way[j] + images >= loss * gaps.pair_gaps)
    return would if len(would) else np.arange(len(gaps.pairs))


def _reach(
    q: Configuration, container: Container, displacement: Array, gap_loss: float, duration: float
) -> float:
    """How wide a gap can be that loses `gap_loss` of itself, of discs at least the largest diameter.

    A lattice carries vectors e to e + A e, so that bodies that differ by d_i = displacement_i - A q_i from
    the mean flow, with centres s = q_i - q_j - e apart, come nearer by

        |d_i - d_j + A s| <= 2 max |d| + |A| (gap + 2 max a)
    """
    unit = np.eye(q.dimension)
    strain = container.carried(unit, duration) - unit
    rate, largest = float(np.linalg.norm(strain, 2)), float(q.radii.max(initial=0.0))
    if rate >= gap_loss:
        return np.inf
    relative = displacement.copy()
    relative[:, : q.dimension] -= q.centres @ strain
    fastest, least = float(q.ways(relative).max(initial=0.0)), 0.0 if q.shaped else 2.0 * largest
    return max(least, 2.0 * (fastest + rate * largest) / (gap_loss - rate))


def greatest_approach(
    q: Configuration, container: Container, displacement: Array, gap_loss: float, duration: float = 0.0
) -> Approach:
    """The gap that loses most of itself when the bodies move straight by `displacement` (N, d or M).

    The container is that at the beginning; in `duration` its images move too.

    Whatever can lose more than `gap_loss` counts, however far apart, and of the neighbours those that can
    lose half of it, or all if none can. Containers are convex, so that the gap to a wall is smallest at an
    end of the way.
    """
    if q.shaped:
        return _approach_of_shapes(q, container, displacement, gap_loss, duration)
    displacement = displacement[:, : q.dimension]
    gaps = find_gaps(q, container, _reach(q, container, displacement, gap_loss, duration))
    away_moves = container.carried(gaps.away, duration) - gaps.away
    losing = _losing(gaps, displacement, away_moves, 0.5 * gap_loss)
    gaps, away_moves = gaps.of(losing), away_moves.take(losing, axis=0)
    wall_left = container.distances(q.centres + displacement) - q.radii[:, None]
    before = np.concatenate([gaps.pair_gaps, gaps.wall_gaps.ravel()])
    left = np.concatenate([_closest_pass(q, displacement, gaps, away_moves), wall_left.ravel()])
    loss = 1.0 - left / before
    if len(loss) == 0:
        return Approach(-np.inf, np.inf, (0, 0))
    worst = int(np.argmax(loss))
    return Approach(float(loss[worst]), float(before[worst]), _sides(worst, gaps.pairs, gaps.wall_gaps.shape))


def _approach_of_shapes(
    q: Configuration, container: Container, displacement: Array, gap_loss: float, duration: float
) -> Approach:
    """The same for bodies that are no discs, which turn on their way.

    A gap closes by no more than the ways of its two bodies' points, one seen from the other. So where it is
    known it is safe for a part of the way, whatever they do: at the end of that it is looked at again, until
    one is below its limit or the way is at its end. Of a pair all gaps count, not its narrowest alone.
    """
    reach = _reach(q, container, displacement, gap_loss, duration)
    gaps, d = find_gaps(q, container, reach), q.dimension
    i, j = gaps.pairs.T
    apart = displacement[:, :d].take(i, axis=0) - displacement[:, :d].take(j, axis=0)
    away_moves = container.carried(gaps.away, duration) - gaps.away
    apart -= away_moves
    turns = q.radii * np.linalg.norm(displacement[:, d:], axis=1)
    of_pairs = np.linalg.norm(apart, axis=1) + turns[i] + turns[j]
    losing = np.flatnonzero(of_pairs >= 0.5 * gap_loss * gaps.pair_gaps)
    gaps, of_pairs, away_moves = gaps.of(losing), of_pairs[losing], away_moves[losing]
    feet = Feet.at(q, container, gaps, reach)
    before = feet.gaps
    if len(before) == 0:
        return Approach(-np.inf, np.inf, (0, 0))
    of_walls = np.repeat(q.ways(displacement), gaps.wall_gaps.shape[1])
    closing = np.concatenate([of_pairs, of_walls])[feet.of]
    lowest, least, left, done = (1.0 - gap_loss) * before, before, before, 0.0
    safe = _safe(left, lowest, before, closing)
    for _ in range(MOST_PLACES):
        done = min(1.0, float(safe.min()))
        # Those that could be there soon are looked at too, lest each has a place of its own; all in the end.
        due = feet.of[safe <= done + SOON * (1.0 - done)] if done < 1.0 else feet.of
        moved, there = q.moved(done * displacement), gaps.away + done * away_moves  # both straight
        now = Feet.at(moved, container, replace(gaps, away=there), reach, due)
        seen = np.isin(feet.of, due)
        left = np.where(seen, feet.followed(now, done * closing), left)
        least = np.minimum(least, left)
        if done == 1.0 or np.any(left < lowest):
            break
        safe = np.where(seen, done + _safe(left, lowest, before, closing), safe)
    loss = np.where(left < lowest, 1.0 - left / before, 1.0 - least / before)
    worst = int(np.argmax(loss))
    # What was stopped on the way would lose as much more as is left of it.
    lost = float(loss[worst]) / done
    if done < 1.0 and lost <= gap_loss:
        lost = gap_loss / done  # beyond that nobody has looked
    first, second = feet.sides[worst].tolist()
    return Approach(lost, float(before[worst]), (first, second))


def lost_in_rounding(
    before: tuple[Configuration, Container], after: tuple[Configuration, Container]
) -> Approach | None:
    """The narrowest gap after a step, if it has not become wider and rounding of places is a part of it.

    Places x have their rounding eps |x|, and gaps are differences of places: one of KNOWN eps |x| is a
    thousandth off, and soon stands still beside a wall. Bodies with shapes are not resolved that far.
    """
    (q, container), (moved, container_after) = before, after
    if q.shaped or not len(q):
        return None
    size = float(np.abs(moved.centres).max()) + float(q.radii.max())
    least = KNOWN * float(np.finfo(float).eps) * size
    gaps = find_gaps(moved, container_after, least)
    gap = gaps.smallest()
    if gap > least or gap > find_gaps(q, container, least).smallest():
        return None
    index = int(np.argmin(np.concatenate([gaps.pair_gaps, gaps.wall_gaps.ravel()])))
    return Approach(0.0, gap, _sides(index, gaps.pairs, gaps.wall_gaps.shape))


def _safe(left: Array, lowest: Array, before: Array, closing: Array) -> Array:
    """For what part of the way gaps that are `left` stay above the lowest ones, or nearly there, (F,)."""
    room = np.maximum(left - lowest, LEAST_ROOM * before)
    return np.asarray(np.divide(room, closing, out=np.full(len(room), np.inf), where=closing > 0.0))


def _sides(index: int, pairs: NDArray[np.intp], bodies_walls: tuple[int, ...]) -> tuple[int, int]:
    """The two sides of an entry of the list of all pairs followed by all (body, wall), row by row."""
    if index < len(pairs):
        return int(pairs[index, 0]), int(pairs[index, 1])
    bodies, walls = bodies_walls
    body, wall = divmod(index - len(pairs), walls)
    return body, bodies + wall


def limited_step(
    q: Configuration, container: Container, velocity: Array, h: float, gap_loss: float
) -> tuple[float, Approach]:
    """The longest step up to h in which velocities (N, M) close no gap by more than `gap_loss`; that gap.

    With the row of a lattice they shear the container too.
    """
    container, velocity = container.sheared(q.strain_of(velocity)), velocity[: len(q)]
    approach = greatest_approach(q, container, _carried(q, container, velocity, h), gap_loss, h)
    while approach.loss > gap_loss:
        h *= SAFETY * gap_loss / approach.loss
        approach = greatest_approach(q, container, _carried(q, container, velocity, h), gap_loss, h)
    return h, approach


def _carried(q: Configuration, container: Container, velocity: Array, h: float) -> Array:
    """The displacements (N, M) in the time h: straight, but where the mean flow bends the ways of images."""
    displacement, unit = h * velocity, np.eye(q.dimension)
    bent = container.carried(unit, h) - unit - h * container.mean_velocity(unit)
    displacement[:, : q.dimension] += q.centres @ bent
    return displacement
