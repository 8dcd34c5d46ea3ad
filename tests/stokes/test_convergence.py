"""Orders of convergence: a manufactured flow in L2 and H1, the reaction force, the traction integral."""

import fsi.meshes.backend  # noqa: F401

import numpy as np
import pytest
import ufl
from dolfinx import fem
from mpi4py import MPI

from fsi.arrays import Array
from fsi.meshes.build import FluidMesh
from fsi.meshes.resolution import Resolution
from fsi.stokes.discretisation.forms import velocity_element
from fsi.stokes.problem import Boundary, SolverOptions, StokesProblem
from fsi.stokes.solve import solve
from tests.flows import BOX, SMALL_BOX, disc_over_plane, discs, held, resting
from tests.nested import nested_meshes

MU = 1.3
SCALE = 1e-4  # with a larger u, its error would show in p at u's higher order
AROUND_A_DISC = discs([(0.0, 0.0)], [1.0])


class Manufactured:
    """u = SCALE curl(s^2 e^x), s = x^2 + y^2 - 1, which vanishes on the unit disc; p = sin 2x cos y.

    psi = h e^x with h = s^2 gives laplace(psi) = G e^x, G = laplace(h) + 2 h_x + h = 16 s + 8 + 8 s x + s^2.
    """

    @staticmethod
    def u(x: Array) -> Array:
        X, Y = x.T
        s, e = X**2 + Y**2 - 1, np.exp(X)
        return SCALE * np.column_stack([4 * s * Y * e, -(4 * s * X + s**2) * e])

    @staticmethod
    def f(x: Array) -> Array:
        X, Y = x.T
        s, e = X**2 + Y**2 - 1, np.exp(X)
        G = 16 * s + 8 + 8 * s * X + s**2
        G_x = 32 * X + 8 * s + 16 * X**2 + 4 * s * X
        laplacian = np.column_stack([(32 * Y + 16 * X * Y + 4 * s * Y) * e, -(G + G_x) * e])
        grad_p = np.column_stack([2 * np.cos(2 * X) * np.cos(Y), -np.sin(2 * X) * np.sin(Y)])
        f: Array = -MU * SCALE * laplacian + grad_p
        return f

    @staticmethod
    def exact(x: ufl.core.expr.Expr) -> tuple[ufl.core.expr.Expr, ufl.core.expr.Expr]:
        s, e = x[0] ** 2 + x[1] ** 2 - 1, ufl.exp(x[0])
        u = ufl.as_vector([4 * s * x[1] * e, -(4 * s * x[0] + s**2) * e])
        return SCALE * u, ufl.sin(2 * x[0]) * ufl.cos(x[1])


def errors(fluid: FluidMesh, degree: int) -> Array:
    """1/h, and the errors of u in L2 and H1, of p in L2 and H1, p up to a constant."""
    q = AROUND_A_DISC
    boundary = Boundary(dict.fromkeys(SMALL_BOX.walls, Manufactured.u), {}, Manufactured.f)
    problem = StokesProblem(fluid, SMALL_BOX, q, held((0.0, 0.0, 0.0)), boundary, MU)
    solution = solve(problem, SolverOptions(degree))
    u_h = fem.Function(fem.functionspace(fluid.mesh, velocity_element(degree, 2)))
    u_h.x.array[:] = solution.flow.u.ravel()
    p_h = fem.Function(u_h.function_space.sub(0).collapse()[0])
    p_h.x.array[:] = solution.flow.p
    u, p = Manufactured.exact(ufl.SpatialCoordinate(fluid.mesh))
    dx = ufl.dx(metadata={"quadrature_degree": 14})

    def integral(form: ufl.Form) -> float:
        return float(fluid.mesh.comm.allreduce(fem.assemble_scalar(fem.form(form)), op=MPI.SUM))

    area = integral(fem.Constant(fluid.mesh, 1.0) * dx)
    shift = integral((p_h - p) * dx) / area
    e, e_p = u_h - u, p_h - p - shift
    norms = [np.sqrt(integral(ufl.inner(d, d) * dx)) for d in (e, ufl.grad(e), e_p, ufl.grad(e_p))]
    return np.array([np.sqrt(fluid.cells()), *norms])


def slope(x: Array, y: Array) -> float:
    """Order by least squares on log-log axes."""
    return float(-np.polyfit(np.log(x), np.log(y), 1)[0])


COARSE, COARSEST = Resolution(1.0, 12, 0.8), Resolution(1.0, 8, 1.0)
SLOW = pytest.mark.slow


@pytest.mark.parametrize(
    ("degree", "sizes", "meshes"),
    [
        (2, COARSE, 4),
        (3, COARSE, 4),
        pytest.param(4, COARSE, 4, marks=SLOW),
        pytest.param(5, COARSEST, 4, marks=SLOW),
        pytest.param(6, COARSEST, 3, marks=SLOW),  # on the fourth u errs by rounding
    ],
)
def test_manufactured_flow(degree: int, sizes: Resolution, meshes: int) -> None:
    """u converges at k + 1 in L2 and k in H1, p one order lower; cells of lower order lose half an order."""
    fluids = nested_meshes(SMALL_BOX, AROUND_A_DISC, sizes, degree, meshes)
    table = np.array([errors(fluid, degree) for fluid in fluids])
    orders = [slope(table[-2:, 0], table[-2:, column]) for column in (1, 2, 3, 4)]
    assert orders == pytest.approx([degree + 1, degree, degree, degree - 1], abs=0.15 if degree < 6 else 0.25)


@pytest.mark.parametrize(("degree", "least"), [(2, 3.5), (3, 5.5)])
def test_force_of_a_disc_in_a_box(degree: int, least: float) -> None:
    """The reaction converges at 2 k, the traction integral at k, to the same value (two codes, 8 digits).

    Cells whose inner nodes were blended by powers instead of a polynomial lift gave 5.2 and 2.1 at k = 3.
    """
    q, expected = disc_over_plane(0.1), -466.11048
    solutions = [
        solve(StokesProblem(fluid, BOX, q, held((0.0, -1.0, 0.0)), resting(BOX)), SolverOptions(degree))
        for fluid in nested_meshes(BOX, q, Resolution(0.7, 12, 0.8), degree, 3)
    ]
    error = [abs(s.F[0, 1] / expected - 1.0) for s in solutions]
    cross = [abs(s.traction_F[0, 1] / expected - 1.0) for s in solutions]
    # On the third mesh of degree 3 the error is that of the reference's last digit.
    assert np.log2(error[0] / error[1]) >= least
    assert np.log2(cross[0] / cross[2]) / 2 >= degree - 0.5
    assert error[1] < cross[1] < 1e-3
