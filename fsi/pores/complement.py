"""A lower bound of the apparent viscosity of a cell, from stresses in equilibrium, in the same pores.

In the plane a stress in equilibrium has Airy's function phi, sigma = (phi_yy, -phi_xy; -phi_xy, phi_xx).
Bodies without force and torque leave phi and grad phi single-valued; apart from that phi is free on their
circles. By the complementary principle (the least dissipation W at a mean strain rate E, |Omega| the area)

    W >= 2 |Omega| Sigma : E - 1/mu int over the fluid of (sigma' : sigma') / 2

for all of them, Sigma the mean stress. Of deviators (s, d) = (sigma_xy, (sigma_xx - sigma_yy) / 2)

    1/mu int (sigma' : sigma') / 2 = 1/(4 mu) int 4 phi_xy^2 + (phi_yy - phi_xx)^2,

the form of psi. So the least of it at a mean stress is found by the elements of psi: bodies are circles on
which phi is any biharmonic polynomial up to some order, with nothing inside, and a mean stress (s, d) is a
mean gradient, G = s diag(-1, 1) + d [[0, 1], [1, 0]]. With |Omega| (s, d) M (s, d) / mu this least and
e = (E_xy, E_xx), the best mean stress gives

    W >= 4 mu |Omega| e M^-1 e,   mu_app / mu >= e M^-1 e / |e|^2.

The lower bound is as exact as the upper one: but for quadrature.
"""

from dataclasses import replace

import numpy as np

from fsi.bodies.configuration import Array, Motion
from fsi.pores.solve import PoreFlow, PoreLoading, solve_pores
from fsi.pores.surfaces import DISC
from fsi.pores.system import PoreSystem

_STRESSES = (np.diag([-1.0, 1.0]), np.array([[0.0, 1.0], [1.0, 0.0]]))


def least_viscosity(system: PoreSystem, E: Array) -> float:
    """Below the apparent viscosity of a cell in the mean strain rate E, bodies without loads, over mu."""
    surfaces = system.pores.surfaces
    hollow = replace(surfaces, fluid=surfaces.kind == DISC, hollow=system.bodies)
    pores = replace(system.pores, surfaces=hollow)
    stresses = PoreSystem.of(0, pores, system.assembly.numbering.modes, 1.0)
    flows, area = [_under(stresses, G) for G in _STRESSES], abs(float(np.linalg.det(surfaces.periods)))
    M = np.array([[flow.power_of_mean(G) for G in _STRESSES] for flow in flows]) / (4.0 * area)
    e = np.array([E[0, 1], E[0, 0]])
    return float(e @ np.linalg.solve(M, e) / (e @ e))


def _under(stresses: PoreSystem, G: Array) -> PoreFlow:
    """The stress that dissipates least at a mean stress."""
    nothing = np.zeros((0, 3))
    return solve_pores(stresses, PoreLoading(Motion(nothing.astype(bool), nothing, nothing), nothing, G))
