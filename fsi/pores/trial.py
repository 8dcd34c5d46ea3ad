"""The trial functions of a pore: stream functions, u = (psi_y, -psi_x), with no slip built in.

A surface v that moves rigidly imposes psi and grad psi through four numbers (U_x, U_y, omega, c),

    Psi_v(x) = c + U_x (y - y_v) - U_y (x - x_v) - omega (|x - x_v|^2 - a_v^2) / 2,

c being psi where the narrowest neck ends (in U_x and U_y x_v is that point: what slides in it makes no flux),
and c_w - c_v is the flux through the neck between v and w. With d_v the distance to surface v and e_v the
distance to the line of side v, 1 at the arc of vertex v, the weights

    l_v = q_v / (q_1 + q_2 + q_3),  q_v = s_v d_i d_j,  s_v = e_v^2 / (e_v^2 + e_i^2 e_j^2)    (i, j the
    others)

are 1 with zero slope on surface v and 0 with zero slope on the two others; on side v they are (0, t, 1 - t),
t = d_j / (d_i + d_j), with slopes that only d_i and d_j determine, hence the same in both pores that share
it. So

    psi = sum_v (l_v^2 (3 - 2 l_v) + 2 l_1 l_2 l_3) Psi_v                       blending; the weights sum to 1
          - 2 sum_{v<w} l_v^2 l_w^2 (d_v + d_w) n_vw . grad(Psi_v - Psi_w)      cubic in necks: Reynolds
          + sum_{sides} l_i^2 l_j^2 P_k(l_j - l_i) (m_k + m'_k e / D)           modes of necks
          + l_1 l_2 l_3 p(x, y) + sum_{sides} l_i^2 l_j^2 e^2 p(e, l_j - l_i)   bubbles

is continuous with its gradient across necks (it lies in H^2 of all the fluid), moves with the bodies on their
surfaces, costs nothing where all move as one rigid body, and is complete as the degrees grow: all functions
are analytic in the pore, and bubbles vanish to second order exactly on its boundary.
"""

import numpy as np

from fsi.arrays import Array
from fsi.machine.compiled import vectorised
from fsi.pores.free_functions import arc_bubbles, corner, knots
from fsi.pores.inner_functions import ALONG, bubbles, modes, neck_bubbles
from fsi.pores.jets import room
from fsi.pores.orders import CUBIC, RIGID, Orders
from fsi.pores.pore_data import Complex
from fsi.pores.surface_functions import fluid, rigid
from fsi.pores.target import Target
from fsi.pores.weights import WEIGHTS, make_weights


def room_for(orders: Orders) -> Array:
    """To make functions of these orders."""
    polynomials = 2 * max(ALONG, orders.bubbles + 1)
    return room(WEIGHTS + max(polynomials, max(orders.fluid) + 8, max(orders.free) + 5))


@vectorised
def take_functions(pore: Complex, orders: Orders, to: Target) -> None:
    """All trial functions of a pore at some points: of surfaces, of sides, bubbles.

    What comes out of each is 4 psi_zz times `root`, whose square is that of the strain rate, or psi with its
    derivatives.
    """
    make_weights(pore, to.points, to.room)
    k = int(np.int64(0))  # of one type throughout, so that nothing is compiled twice
    for v in range(3):
        rigid(pore, v, to, k)
        k += RIGID
        if orders.fluid[v] > 0:
            k = fluid(pore, v, orders.fluid[v], to, k)
    for v in range(3):
        beside = max(orders.fluid[(v + 1) % 3], orders.fluid[(v + 2) % 3]) >= CUBIC
        k = modes(pore, v, -orders.modes[v] if beside else orders.modes[v], to, k)
        k = knots(pore, v, orders.free, to, k)
    k = bubbles(pore, orders.bubbles, to, k)
    for v in range(3):
        if orders.neck_bubbles > 0:
            k = neck_bubbles(pore, v, orders.neck_bubbles, to, k)
    for v in range(3):
        if orders.corner[v] > 0:
            k = corner(pore, v, to, k)
    for v in range(3):
        if orders.free[v] > 0:
            k = arc_bubbles(pore, v, orders.free[v], to, k)
