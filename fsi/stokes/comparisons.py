"""The flows with which a resolved flow is compared for its error bars: they differ from it by the error.

The error bar on every force and velocity comes from the same problem with elements of another degree. Forces
from the reactions, and the velocities of free bodies, converge like h^(2k) with elements of degree k in
velocity and geometry (they are energies, so their error is the square of the flow's). On the same mesh the
values of degree k + 1 are therefore 10 to 1000 times closer to the exact ones, and the difference of the two
is the error of the first. Measured against exact solutions for a disc and a sphere beside a plane, gaps from
1e-5 to 10 radii and k = 2, 3, 4, it is 0.97 to 1.01 times the true error; 1.10 times once, at an error of
1e-10, where rounding begins. On meshes too coarse far away, where one degree more gains only a factor 10, it
is 0.9 times. The factor SAFETY makes it a bound.

Where derivatives of a body's outline jump, as its curvature does between side and corner of a polygon, or are
infinite, as at the end of a tip, the flow beside it has few derivatives. One degree more then gains as little
as a factor 2 (bench.bars with --kinds shapes: errors up to 1.3 times SAFETY times the difference), and what
two degrees miss has no one sign: bars are those for a factor JOINTED, each value known to the part CHANCE of
the largest.

Elements of degree 2 in narrow gaps, up to fourteen times as long as wide, err by 1e-3 or by 2e-2 as nodes
fall on the two surfaces, and those of degree 3 by 5e-4: where the former is small by chance one degree more
tells half of it (bench.bars, gaps of 1e-4 radii: 1.2 and 1.5 times SAFETY times the difference). On meshes of
less than COARSE cells around a body one degree more misses much itself: of 179, 177 and 178 random cases of
degree 2, 3 and 4 in nine kinds of walls 16, 8 and 6 had an error above SAFETY times the difference, by up to
3, 4.9 and 1.9. Both are compared with two degrees more: all those of degree 2 and 3 are below 0.81 of that.

In space one degree more costs some ten times as much as the solution itself. There the same problem is solved
with one degree less, for a tenth of it: its values are the less accurate ones, and the difference is their
error. Measured beside a plane for k = 3, gaps from 0.01 to 1 radii, it is 14 to 50 times that of degree k on
the default meshes and finer ones, and 9 times on a mesh half as fine; of two and three spheres in cells that
are sheared or stretched 5 times for some stresses. The factor FEWER makes it a bound; what is small by chance
of loads is known to the part CHANCE_FEWER of the largest difference (in seven cells with 11 cells around a
sphere 0.03 was too little for one of them, by 1.1), of velocities to CHANCE_OF_FREE (one that symmetry makes
zero missed by 0.142 of it in a driven channel), of stresses to CHANCE (0.03 was too little by 2.3).

On meshes of less than COARSE cells around a body degree 2 may by chance miss as little as degree 3: in
eleven of 28 cells with two to six spheres, gaps from 0.01 radii, a factor of 0.15 was too small for some
value, by up to 9.4 times (`python -m bench.bars --kinds "spheres in a cell" --seed 1001`). There the factor
is FEWER_COARSE and the part CHANCE_COARSE. Degree 2, which has none below, takes one more. What is small by
chance is known to the part CHANCE_LOWEST there: a velocity beside a swimmer with slip missed by 0.13 of that.

Where fluid slides both degrees may miss the same in part: of a swimmer in balls of 1.5 to 5 radii, with slip
lengths of 0.05 to 1, degree 3 errs by 0.02 to 1.06 times the largest difference of its velocities, as does
the torque on a sphere with a slip length of 10. There each value is known to SAFETY times the largest. Loads
on held bodies, between walls that fluid sticks to and with slip lengths up to SHORT_SLIP of the smallest
radius, err by 0.04 to 0.3 of it, what symmetry makes zero by up to 0.1 (a sphere that turns in a ball of two
radii); swimmers without slip by up to 0.3 of their own difference (two in a ball, with a gap of 0.1 radii),
and by 0.04 of the largest where symmetry makes them zero. For both the factor is FEWER_SLIDING, the part
CHANCE.

Of many discs one degree more costs twice the solution itself and twice its memory, one degree
less half of it. For k = 4 it is used there too: what it misses is some 20 times the error of the apparent
viscosity, and some 15 times that of the motion of most bodies, from area fraction 0.1 to 0.65, with gaps from
1e-3 to 0.1 radii, in channels, cells and boxes. The factor OF_MANY makes it a bound, and what is small by
chance is known to the part CHANCE_OF_MANY of the largest; `python -m bench.bars --kinds suspension` tries it.

Where the data of walls jump at a corner (see `corners`), two degrees on one mesh miss the same there, and
their difference does not tell it. Planar meshes are graded towards such corners, so that the order comes
back, and the other problem is then solved on another mesh: one with `growth` over FINER = 2, which is graded
more finely and deeper (see `fsi.meshes.planar.grading`). So is the one beside a user's own mesh, which is not
graded. The difference is 0.97 to 1.05 times the error of the first again. On coarse meshes it is 1 - FINER^-p
of what corners alone miss, p = 2.74, whatever the degree: with FINER = 1.5 that is what SAFETY allows.

In space cells beside such an edge are graded likewise (see `fsi.meshes.spatial.grading`), and what they miss
goes with their size like h^p, p = 2.74 where velocities jump and 1.19 between an open wall and a solid one,
whatever the degree. That error and the one of gaps and bodies may cancel, in one flow and not in the next, so
that each has a flow of its own: one of another degree, as above, and one of the same degree with `growth`
over FINER = 1.5, whose difference is 1 - FINER^-p of the error of the edges. The bar is the sum of both.

Bars see the mesh and the elements; they do not see how far a container of finite radius is from an infinite
one (`fsi.observables.truncation` does), nor how a user's own curved mesh differs from its circles.
"""

from dataclasses import dataclass

from fsi.case.case import Case
from fsi.case.checks.surfaces import slip_lengths
from fsi.case.sections import HIGHEST_DEGREE, MOST_FEW
from fsi.observables.resistance import KNOWN_TO
from fsi.stokes.corners import jumps, singular
from fsi.stokes.walls import boundary_of, singular_corners, wall_kinks

SAFETY = 1.5
JOINTED = 2.0  # what one degree more gains at least beside outlines whose derivatives jump
_OF_JOINTS = SAFETY / (1.0 - 1.0 / JOINTED)
FEWER, FEWER_COARSE, COARSE = 0.25, 0.75, 10
FEWER_SLIDING, SHORT_SLIP = 0.75, 0.5  # the latter of the smallest radius
OF_MANY, MANY_DEGREE, CHANCE_OF_MANY = 0.25, 4, 0.2
FINER = {2: 2.0, 3: 1.5}
# How the error of a force goes with h beside edges of a box in space.
JUMP_ORDER, OPEN_ORDER = 2.74, 1.19
# Two meshes in space have other cells everywhere, and what a lower degree misses has no one sign; nor what
# two degrees miss beside outlines whose derivatives jump.
CHANCE, CHANCE_COARSE, CHANCE_FEWER, CHANCE_OF_FREE = 0.3, 0.6, 0.05, 0.2
LOWEST, CHANCE_LOWEST = 2, 0.15


@dataclass(frozen=True, slots=True)
class Comparison:
    """Another flow, which differs from that of a case by its error or a part of it.

    Attributes:
        degree: of its elements.
        finer: what its `growth` is less by.
        factor: what makes the difference a bound.
        chance: the part of the largest difference to which each is known: by chance some cancel.
        chance_of_stress: the same of stresses and stresslets.
        chance_of_free: the same of velocities; as `chance` if None.
    """

    degree: int
    finer: float
    factor: float
    chance: float = KNOWN_TO
    chance_of_stress: float = KNOWN_TO
    chance_of_free: float | None = None


def comparisons(case: Case) -> tuple[Comparison, ...]:
    """The flows with which that of a case is compared; the bars of each add up."""
    degree, finer = case.discretisation.degree, FINER[case.dimension]
    if case.dimension == 2:
        return (_in_the_plane(case, finer if len(singular_corners(case)) else 1.0),)
    orders = _edge_orders(case)
    of_edges = (SAFETY / (1.0 - finer**-p) for p in sorted(orders)[:1])
    flows = (Comparison(degree, finer, factor, CHANCE, CHANCE) for factor in of_edges)
    return (_of_elements_in_space(case), *flows)


def _in_the_plane(case: Case, finer: float) -> Comparison:
    degree = case.discretisation.degree
    if any(outline.joints for outline in case.configuration().outlines):
        return Comparison(degree + 1, finer, _OF_JOINTS, CHANCE, CHANCE)
    if finer == 1.0 and _is_smooth_and_crowded(case):
        return Comparison(degree - 1, 1.0, OF_MANY, CHANCE_OF_MANY, CHANCE_OF_MANY)
    return Comparison(_of_more(case), finer, SAFETY)


def _of_more(case: Case) -> int:
    """The higher degree in the plane: two more where one would miss by chance as much."""
    degree, around = case.discretisation.degree, case.discretisation.cells_per_circle
    more = 2 if degree == LOWEST or around < COARSE else 1
    return min(degree + more, HIGHEST_DEGREE[2] + 1)


def _of_elements_in_space(case: Case) -> Comparison:
    degree = case.discretisation.degree
    if degree == LOWEST:
        return Comparison(degree + 1, 1.0, SAFETY, CHANCE_LOWEST, CHANCE_LOWEST)
    if slip_lengths(case) and not _sticks_nearly(case):
        return Comparison(degree - 1, 1.0, SAFETY, 1.0, 1.0)
    if case.discretisation.cells_per_circle < COARSE:
        return Comparison(degree - 1, 1.0, FEWER_COARSE, CHANCE_COARSE, CHANCE_COARSE)
    if _slides(case):
        return Comparison(degree - 1, 1.0, FEWER_SLIDING, CHANCE, CHANCE)
    return Comparison(degree - 1, 1.0, FEWER, CHANCE_FEWER, CHANCE, CHANCE_OF_FREE)


def _sticks_nearly(case: Case) -> bool:
    """Whether degree 2 tells the error where fluid slides: along bodies that are held, and not far."""
    q, slips = case.configuration(), slip_lengths(case)
    if case.wall_slip() or _swims(case) or not case.motion_at(q, 0.0).held.all():
        return False
    return bool(max(slips.values()) <= SHORT_SLIP * q.radii.min())


def _is_smooth_and_crowded(case: Case) -> bool:
    """Whether one degree less is known to tell the error in the plane: many discs, quartic elements."""
    crowded = case.discretisation.degree == MANY_DEGREE and len(case.bodies) > MOST_FEW
    round_ones = all(body.shape is None for body in case.bodies)
    return crowded and round_ones and not _slides(case)


def _slides(case: Case) -> bool:
    """Whether fluid slides or bodies swim."""
    return bool(slip_lengths(case)) or _swims(case)


def _swims(case: Case) -> bool:
    return any(body.swims for body in case.bodies)


def _edge_orders(case: Case) -> set[float]:
    """The orders of the errors where the flow is singular at some time, none where it is smooth."""
    container, orders = case.container(), set[float]()
    for t in wall_kinks(case):
        boundary = boundary_of(case, t)
        jumping = jumps(container, boundary)
        pairs = singular(container, boundary)
        orders |= {JUMP_ORDER if pair in jumping else OPEN_ORDER for pair in pairs}
    return orders
