"""Which trial functions a pore has, and how many."""

from typing import NamedTuple

RIGID = 4  # U_x, U_y, omega, c
STRAINED = 2  # the order of bodies whose stresslets are wanted: z^2 is a strain rate
CUBIC = 3  # the least order of fluid discs
KNOTS = 4  # of a neck at a foot on a surface where psi is free: f, f', g, g'
CORNER = 5  # where two walls meet on which psi is free: psi and its gradient, g' of each
TIED = 2  # of a narrow neck: the flux through it, and the speed at which its surfaces part (`narrow`)


class Orders(NamedTuple):
    """Which trial functions pores have.

    Attributes:
        modes: of each of the three sides.
        fluid: order M of the vertices that are discs of fluid, at least CUBIC: psi is a biharmonic
            polynomial of 4 M - 2 numbers there; STRAINED, with Re and Im of z^2, of bodies that are tested by
            a strain rate, 0 of others.
        bubbles: the degree of p(x, y).
        neck_bubbles: degrees + 1 of p(e, l_j - l_i) along and across each neck; 0 for none.
        free: of the vertices on which psi is free, how many polynomials f has between feet, and g; else 0.
        narrow: 1 of sides that are narrow necks, which have TIED numbers of their own, 0 of others.
        corner: 1 of sides that are corners of walls on which psi is free, which have no knots, 0 of others.
    """

    modes: tuple[int, int, int]
    fluid: tuple[int, int, int]
    bubbles: int
    neck_bubbles: int
    free: tuple[int, int, int] = (0, 0, 0)
    narrow: tuple[int, int, int] = (0, 0, 0)
    corner: tuple[int, int, int] = (0, 0, 0)

    @property
    def knots(self) -> tuple[int, int, int]:
        """How many each side has."""
        a, b, c = (KNOTS * int(number > 0) for number in self.free)
        of_a, of_b, of_c = (1 - corner for corner in self.corner)
        return of_a * (b + c), of_b * (c + a), of_c * (a + b)

    @property
    def shared(self) -> int:
        """How many functions belong to surfaces and necks; those that follow are bubbles."""
        numbers = sum(numbers_of(order) for order in self.fluid)
        return numbers + sum(self.modes) + sum(self.knots)

    @property
    def numbers(self) -> int:
        """How many numbers surfaces and necks have: those of shared functions, and of narrow necks."""
        return self.shared + TIED * sum(self.narrow)

    @property
    def total(self) -> int:
        """How many functions there are."""
        inner = (self.bubbles + 1) * (self.bubbles + 2) // 2 + 3 * self.neck_bubbles**2
        return self.shared + inner + CORNER * sum(self.corner) + 2 * sum(self.free)


def numbers_of(order: int) -> int:
    """How many numbers a fluid disc of that order has, or a surface that is none, of order 0."""
    return 4 * order - 2 if order else RIGID
