"""The weak forms, each under the name that a textbook gives it.

Stokes flow, with `e(u) = (grad u + grad u^T) / 2` and `sigma = 2 mu e(u) - p I`:

    a(u, v) + b(v, p) = (f, v) + <t, v>      a(u, v) = int 2 mu e(u) : e(v)
    b(u, q)           = 0                    b(v, q) = - int q div v

Only the form with e(u), not grad u, gives the physical traction `sigma n`. Forms are compiled once for each
pair of element orders, without a mesh, and bound to each new mesh: compiling costs seconds, binding
microseconds.
"""

from dataclasses import dataclass, field
from functools import cache

from fsi.meshes.backend import petsc_forms

import basix.ufl
import numpy as np
import ufl
from dolfinx import fem
from dolfinx.mesh import exterior_facet_indices
from mpi4py import MPI
from numpy.typing import NDArray
from petsc4py import PETSc

from fsi.arrays import Array
from fsi.meshes.build import FluidMesh, FunctionSpace, coordinate_element
from fsi.stokes.discretisation.jit import compile_form

CELL = fem.IntegralType.cell
FACET = fem.IntegralType.exterior_facet
EVERYWHERE = -1
MARKED = 1
EQUISPACED = basix.LagrangeVariant.equispaced
SIMPLEX = {2: "triangle", 3: "tetrahedron"}


type Expr = ufl.core.expr.Expr
type Form = fem.Form[np.float64]


@cache
def velocity_element(degree: int, dimension: int) -> basix.ufl._ElementBase:
    """Continuous vector elements of the given degree; equispaced nodes, which VTK draws as they are."""
    return basix.ufl.element("Lagrange", SIMPLEX[dimension], degree, EQUISPACED, shape=(dimension,))


@cache
def component_element(degree: int) -> basix.ufl._ElementBase:
    """One component of the velocity in space."""
    return basix.ufl.element("Lagrange", SIMPLEX[3], degree, EQUISPACED)


@cache
def cell_element() -> basix.ufl._ElementBase:
    """A constant in each cell in space."""
    return basix.ufl.element("Discontinuous Lagrange", SIMPLEX[3], 0)


@cache
def pressure_element(degree: int, dimension: int) -> basix.ufl._ElementBase:
    """Continuous scalar elements one degree below the velocity (Taylor and Hood 1973)."""
    return basix.ufl.element("Lagrange", SIMPLEX[dimension], degree - 1, EQUISPACED)


@dataclass(frozen=True, slots=True)
class Coordinates:
    """The differential operators of Cartesian or axisymmetric (r, z, theta) coordinates.

    Axisymmetric flow without swirl has the hoop strain u_r / r as its third diagonal component, and integrals
    carry the circumference 2 pi r.
    """

    omega: ufl.Mesh
    axisymmetric: bool

    @property
    def weight(self) -> Expr:
        """What an element of the domain of computation stands for: 1, or 2 pi r."""
        r = ufl.SpatialCoordinate(self.omega)[0]
        weight: Expr = 2 * ufl.pi * r if self.axisymmetric else ufl.as_ufl(1)
        return weight

    def hoop(self, u: Expr) -> Expr:
        """u_r / r."""
        hoop: Expr = u[0] / ufl.SpatialCoordinate(self.omega)[0]
        return hoop

    def strain_rate(self, u: Expr) -> Expr:
        """e(u) = (grad u + grad u^T) / 2."""
        e: Expr = ufl.sym(ufl.grad(u))
        if self.axisymmetric:
            e = ufl.as_matrix([[e[0, 0], e[0, 1], 0], [e[1, 0], e[1, 1], 0], [0, 0, self.hoop(u)]])
        return e

    def div(self, u: Expr) -> Expr:
        """div u = tr e(u)."""
        div: Expr = ufl.div(u) + self.hoop(u) if self.axisymmetric else ufl.div(u)
        return div

    def traction(self, u: Expr, p: Expr, mu: Expr, n: Expr) -> Expr:
        """sigma n with sigma = 2 mu e(u) - p I; n lies in the plane of computation."""
        t: Expr = 2 * mu * ufl.dot(ufl.sym(ufl.grad(u)), n) - p * n
        return t


@dataclass(frozen=True, slots=True)
class WeakForms:
    """Forms without a mesh, each compiled when it is first asked for, and the placeholders in them.

    Attributes:
        forms: by name, its test and trial spaces, a letter each, "V" or "Q", and what is integrated.
        coefficients: the functions u, f and p of a known flow.
        viscosity: mu.
    """

    forms: dict[str, tuple[str, ufl.Form]]
    coefficients: dict[str, ufl.Coefficient]
    viscosity: ufl.Constant
    _compiled: dict[str, fem.forms.CompiledForm] = field(default_factory=dict)

    def compiled(self, name: str) -> fem.forms.CompiledForm:
        """The compiled form of that name; collective when it is first asked for."""
        if name not in self._compiled:
            self._compiled[name] = compile_form(self.forms[name][1])
        return self._compiled[name]


def points_degree(order: int, degree: int, dimension: int, axisymmetric: bool) -> int:
    """Of the polynomials that quadrature in cells is exact for.

    That is exact on straight cells in the plane. On curved ones, where the integrands are rational, degree
    2 k is enough for forces of order 2 k: with more points those of P3 at default sizes change by 1e-10 and
    less. Where integrals carry r its degree is added.
    """
    return max(2 * degree, (dimension - 1) * (order - 1) + degree - 1) + order * axisymmetric


@cache
def weak_forms(order: int, degree: int, dimension: int, axisymmetric: bool) -> WeakForms:
    """All forms for cells of the given order and velocities of the given degree.

    The matrices of a and b are those of single cells (see `cells`), with the same points of quadrature. With
    n dA a polynomial of degree (d - 1) (order - 1) on facets, and div u dx one of that degree and k - 1, what
    flows through the boundary, and what through that of each cell, is integrated exactly: so a constant
    pressure does nothing, as the iterative solver must know, and what rigid bodies move through is closed.
    """
    omega = ufl.Mesh(coordinate_element(order, dimension))
    V = ufl.FunctionSpace(omega, velocity_element(degree, dimension))
    Q = ufl.FunctionSpace(omega, pressure_element(degree, dimension))
    v, p, q = ufl.TestFunction(V), ufl.TrialFunction(Q), ufl.TestFunction(Q)
    u_h, f_h, p_h = ufl.Coefficient(V), ufl.Coefficient(V), ufl.Coefficient(Q)
    mu = ufl.Constant(omega)
    n = ufl.FacetNormal(omega)
    space = Coordinates(omega, axisymmetric)
    enough = points_degree(order, degree, dimension, axisymmetric)
    quadrature = {"quadrature_degree": enough}
    of_flux = {"quadrature_degree": max(enough, (dimension - 1) * (order - 1) + degree)}
    w = space.weight
    dx, ds = ufl.dx(omega, metadata=quadrature), ufl.ds(omega, metadata=of_flux)
    dS = ufl.ds(MARKED, domain=omega, metadata=quadrature)
    dS_of_flux = ufl.ds(MARKED, domain=omega, metadata=of_flux)
    e_v, e_h = space.strain_rate(v), space.strain_rate(u_h)
    forms = {
        "pressure mass": ("QQ", p * q / mu * w * dx),
        "load": ("V", ufl.inner(f_h, v) * w * dx),
        "stress": ("V", (2 * mu * ufl.inner(e_h, e_v) - p_h * space.div(v)) * w * dx),
        "pressure weights": ("Q", q * w * dx),
        "flux": ("", ufl.inner(u_h, n) * w * ds),
        "speed on boundary": ("", ufl.sqrt(ufl.inner(u_h, u_h)) * w * ds),
        "normal": ("V", ufl.inner(n, v) * w * dS_of_flux),
        "traction": ("V", ufl.inner(space.traction(u_h, p_h, mu, n), v) * w * dS),
    }
    return WeakForms(forms, {"u": u_h, "f": f_h, "p": p_h}, mu)


@cache
def compile_gradients(
    order: int, degree: int, quadrature: int
) -> tuple[fem.forms.CompiledForm, ufl.Constant]:
    """int mu grad u.grad v of one component of a velocity in space, with mu; quadrature: its degree."""
    omega = ufl.Mesh(coordinate_element(order, 3))
    W, mu = ufl.FunctionSpace(omega, component_element(degree)), ufl.Constant(omega)
    u, v = ufl.TrialFunction(W), ufl.TestFunction(W)
    dx = ufl.dx(omega, metadata={"quadrature_degree": quadrature})
    return compile_form(mu * ufl.inner(ufl.grad(u), ufl.grad(v)) * dx), mu


@cache
def compile_films(order: int, degree: int) -> tuple[fem.forms.CompiledForm, ufl.Coefficient, ufl.Constant]:
    """int (k / mu) grad p.grad q of pressures in space, with k, constant in cells, and mu."""
    omega = ufl.Mesh(coordinate_element(order, 3))
    Q, mu = ufl.FunctionSpace(omega, pressure_element(degree, 3)), ufl.Constant(omega)
    k = ufl.Coefficient(ufl.FunctionSpace(omega, cell_element()))
    p, q = ufl.TrialFunction(Q), ufl.TestFunction(Q)
    dx = ufl.dx(omega, metadata={"quadrature_degree": 2 * (degree - 2)})
    return compile_form(k / mu * ufl.inner(ufl.grad(p), ufl.grad(q)) * dx), k, mu


class Forms:
    """The forms, compiled and bound to one mesh.

    Attributes:
        mesh: which it is.
        degree: of the velocity.
        axisymmetric: whether its points are (r, z).
        viscosity: mu.
        V, Q: velocity and pressure spaces.
        u, p, f: the functions that stand in the forms of a known flow.
    """

    def __init__(self, fluid: FluidMesh, degree: int, viscosity: float) -> None:
        """Bind the forms to a mesh; degree of the velocity, at least the order of the cells."""
        self._weak = weak_forms(fluid.order, degree, fluid.dimension, fluid.container.axisymmetric)
        self.mesh = fluid.mesh
        self.degree, self.viscosity = degree, viscosity
        self.axisymmetric = fluid.container.axisymmetric
        self.V = fem.functionspace(fluid.mesh, velocity_element(degree, fluid.dimension))
        self.Q = fem.functionspace(fluid.mesh, pressure_element(degree, fluid.dimension))
        self.u, self.f, self.p = fem.Function(self.V), fem.Function(self.V), fem.Function(self.Q)
        self._constants = {self._weak.viscosity: fem.Constant(fluid.mesh, viscosity)}

    def fit(self, fluid: FluidMesh, degree: int, viscosity: float) -> bool:
        """Whether these are the forms of that mesh, which may have moved, with these parameters."""
        return self.mesh is fluid.mesh and (self.degree, self.viscosity) == (degree, viscosity)

    def fill(self, x: Array) -> None:
        """Set u and p to nodal values, this rank's rows; collective."""
        for function, values in ((self.u, x[: self.velocities]), (self.p, x[self.velocities :])):
            function.x.array[: len(values)] = values
            function.x.scatter_forward()

    @property
    def velocities(self) -> int:
        """Unknowns of u that this rank owns."""
        return int(self.V.dofmap.index_map.size_local * self.V.dofmap.index_map_bs)

    @property
    def dofs(self) -> int:
        """Unknowns (u, p) of all ranks, before constraints."""
        V, Q = self.V.dofmap, self.Q.dofmap
        return int(V.index_map.size_global * V.index_map_bs + Q.index_map.size_global)

    def bind(self, name: str, facets: NDArray[np.int32] | None = None) -> Form:
        """The form of that name; those over marked facets need the facets."""
        form, letters = self._weak.compiled(name), self._weak.forms[name][0]
        spaces = [self.V if letter == "V" else self.Q for letter in letters]
        subdomains: dict[fem.IntegralType, list[tuple[int, NDArray[np.int32]]]] = {}
        topology = self.mesh.topology
        if facets is not None:
            entities = fem.compute_integration_domains(FACET, topology, facets)
            subdomains[FACET] = [(MARKED, entities)]
        elif name in ("flux", "speed on boundary"):
            facets = exterior_facet_indices(topology)
            subdomains[FACET] = [(EVERYWHERE, fem.compute_integration_domains(FACET, topology, facets))]
        else:
            cells = np.arange(topology.index_map(topology.dim).size_local, dtype=np.int32)
            subdomains[CELL] = [(EVERYWHERE, cells)]
        functions = {f: getattr(self, letter) for letter, f in self._weak.coefficients.items()}
        return fem.create_form(form, spaces, self.mesh, subdomains, functions, self._constants)

    def gradients(self, V: FunctionSpace, degree: int) -> PETSc.Mat:
        """The matrix of int mu grad u.grad v over all nodes of V, for one component; in space; collective.

        V: velocities of that degree, at most that of these forms: for such as both have, the integrals are
        the same, exact on straight cells.
        """
        mesh, mu = self.mesh, fem.Constant(self.mesh, self.viscosity)
        form, placeholder = compile_gradients(mesh.geometry.cmaps[0].degree, degree, 2 * (self.degree - 1))
        W = fem.functionspace(mesh, component_element(degree))
        assert np.array_equal(W.dofmap.list, V.dofmap.list), "spaces of one mesh number nodes alike"
        cells = np.arange(mesh.topology.index_map(mesh.topology.dim).size_local, dtype=np.int32)
        subdomains = {CELL: [(EVERYWHERE, cells)]}
        bound = fem.create_form(form, [W, W], mesh, subdomains, {}, {placeholder: mu})
        matrix = petsc_forms().assemble_matrix(bound)
        matrix.assemble()
        return matrix

    def films(self, k: Array) -> PETSc.Mat:
        """That of int (k / mu) grad p.grad q over all nodes of Q, with k of this rank's cells and ghosts."""
        mesh, mu = self.mesh, fem.Constant(self.mesh, self.viscosity)
        form, coefficient, placeholder = compile_films(mesh.geometry.cmaps[0].degree, self.degree)
        of_cells = fem.Function(fem.functionspace(mesh, cell_element()))
        of_cells.x.array[of_cells.function_space.dofmap.list[:, 0]] = k
        cells = np.arange(mesh.topology.index_map(mesh.topology.dim).size_local, dtype=np.int32)
        known = ({CELL: [(EVERYWHERE, cells)]}, {coefficient: of_cells}, {placeholder: mu})
        matrix = petsc_forms().assemble_matrix(fem.create_form(form, [self.Q, self.Q], mesh, *known))
        matrix.assemble()
        return matrix

    def integrate(self, name: str) -> float:
        """Value of a form without arguments, over all ranks."""
        return float(MPI.COMM_WORLD.allreduce(fem.assemble_scalar(self.bind(name))))
