"""The units that a case is solved in: the largest radius, its viscosity, and the user's unit of time.

Stokes flow is linear, and has no length or viscosity of its own. With the unit a of lengths and mu of
viscosities, what is solved has

    x' = x / a      u' = u / a      omega' = omega      p' = p / mu      mu' = 1

and, with k = 0 in the plane, where loads are those per unit length, and k = 1 in space and with an axis,

    F' = F / (mu a^(1 + k))     T' = T / (mu a^(2 + k))     dissipation' = dissipation / (mu a^(2 + k))

Every number of the mesh and of the matrix is then of the order of one, whatever the user's units are; times
are left as they are, since velocities stand on the right-hand side alone. Lengths are rounded to 15 digits,
so that a case in other units is the same case to the last bit, has the same mesh, and the same digits.
Without bodies the size of the container is the unit of length.

Doubles are dense at zero alone. In the plane gaps that shut fluid in make of a rounding of coordinates, 1e-16
of their distance from the origin, a pressure that is larger by (a/q)^(5/2), and gmsh loses cells that halve
towards a corner. So where the container can stand anywhere (a box without periods), x' = (x - x0) / a with
the origin x0 in the narrowest gap, if that is below NARROW radii at the beginning, else in the middle of the
box, if the user's is farther from it than its size. Differences of doubles so near to each other are exact.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration, Inertia, Motion
from fsi.bodies.gaps import wall_gaps
from fsi.bodies.surface_gap import SurfaceGap, narrowest_gap
from fsi.case.case import Case
from fsi.meshes.build import FluidMesh
from fsi.meshes.geometry.container import Container
from fsi.meshes.geometry.curves import rescaled
from fsi.observables.bulk_stress import BulkStress
from fsi.observables.resistance import Modes, Resistance
from fsi.stokes.fields import Flow, Surface
from fsi.stokes.pair_laws import PairLaws
from fsi.stokes.problem import Boundary, Field, StokesProblem, SurfaceConditions
from fsi.stokes.solution import StokesSolution

NARROW = 5e-5  # of a radius


@dataclass(frozen=True, slots=True)
class Units:
    """What is 1 in the solve, in the user's units.

    Attributes:
        length: a.
        viscosity: mu.
        spheres: whether loads are those of spheres, k = 1, or per unit length.
        origin: x0, (d,), zero where the user's is kept.
    """

    length: float
    viscosity: float
    spheres: bool
    origin: Array

    @classmethod
    def of(cls, case: Case) -> Units:
        """Those of a case."""
        largest = max((body.radius for body in case.bodies), default=case.container().size())
        return cls(largest, case.fluid.viscosity, case.spheres, _origin(case))

    @property
    def force(self) -> float:
        """mu a^(1 + k)."""
        return self.viscosity * self.length ** (2 if self.spheres else 1)

    @property
    def power(self) -> float:
        """mu a^(2 + k); of moments too."""
        return self.force * self.length

    @property
    def flux(self) -> float:
        """a^(2 + k), of a channel."""
        return self.length ** (3 if self.spheres else 2)

    def velocities(self, dimension: int) -> Array:
        """Of each mode, (M,): a for translations, 1 for rotations."""
        return self._modes(dimension, self.length, 1.0)

    def loads(self, dimension: int) -> Array:
        """Of each mode, (M,): of forces, and of torques."""
        return self._modes(dimension, self.force, self.power)

    @staticmethod
    def _modes(dimension: int, translation: float, rotation: float) -> Array:
        return np.repeat([translation, rotation], [dimension, dimension * (dimension - 1) // 2])

    # Into these units.

    def scaled_lengths(self, x: Array) -> Array:
        """Lengths of any shape."""
        return rescaled(x, 1.0 / self.length)

    def scaled_places(self, x: Array) -> Array:
        """Points (n, d)."""
        return self.scaled_lengths(x - self.origin)

    def scaled_configuration(self, q: Configuration) -> Configuration:
        """The bodies."""
        centres, radii = self.scaled_places(q.centres), self.scaled_lengths(q.radii)
        outlines = tuple(outline.scaled(1.0 / self.length) for outline in q.outlines)
        ellipsoids = tuple(form.scaled(1.0 / self.length) for form in q.ellipsoids)
        return Configuration(centres, q.angles, radii, outlines, ellipsoids, q.strain)

    def scaled_container(self, container: Container) -> Container:
        """What encloses the fluid."""
        seen = container.seen_from(self.origin) if self.origin.any() else container
        assert seen is not None, "only where the container can be moved is there another origin"
        return seen.scaled(1.0 / self.length)

    def scaled(self, problem: StokesProblem) -> StokesProblem:
        """A problem whose mesh alone has these units already."""
        q, motion, boundary = problem.q, problem.motion, problem.boundary
        d = q.dimension
        speeds, loads = self.velocities(d), self.loads(d)
        interaction, inertia = problem.interaction, problem.inertia
        return StokesProblem(
            fluid=problem.fluid,
            container=problem.fluid.container,
            q=self.scaled_configuration(q),
            motion=Motion(motion.held, motion.U / speeds, motion.F / loads),
            boundary=self._scaled_boundary(boundary),
            viscosity=1.0,
            inertia=None if inertia is None else Inertia(inertia.D * (speeds / loads), inertia.U0 / speeds),
            interaction=None if interaction is None else interaction / self.power,
            surfaces=self._scaled_surfaces(problem.surfaces),
            laws=None if problem.laws is None else self._scaled_laws(problem.laws, q),
        )

    def _scaled_laws(self, laws: PairLaws, q: Configuration) -> PairLaws:
        a = self.length
        G = laws.G * np.tile(self.velocities(q.dimension) / a, len(q))
        own, resistance = laws.own / a, laws.resistance * (a / self.force)
        carried = laws.carried / self.velocities(q.dimension)
        scaled = replace(laws, G=G, own=own, resistance=resistance, carried=carried)
        return replace(scaled, strains=laws.strains / a, leaning=laws.leaning / a)

    def _scaled_boundary(self, boundary: Boundary) -> Boundary:
        """Its fluxes are of a channel, in the plane per unit length."""
        a, mu = self.length, self.viscosity
        f, G, flux = boundary.body_force, boundary.pressure_gradient, boundary.net_flux
        return Boundary(
            velocities={wall: self._scaled_field(u, a) for wall, u in boundary.velocities.items()},
            pressures={wall: p / mu for wall, p in boundary.pressures.items()},
            body_force=None if f is None else self._scaled_field(f, mu / a),
            pressure_gradient=None if G is None else G / (mu / a),
            net_flux=None if flux is None else flux / self.flux,
            mean_stress=None if boundary.mean_stress is None else boundary.mean_stress / mu,
            stresses={wall: stress / mu for wall, stress in boundary.stresses.items()},
            slip_lengths={wall: b / a for wall, b in boundary.slip_lengths.items()},
            shear_rate=boundary.shear_rate,
        )

    def _scaled_surfaces(self, surfaces: SurfaceConditions) -> SurfaceConditions:
        a = self.length
        lengths = {i: b / a for i, b in surfaces.slip_lengths.items()}
        return SurfaceConditions(lengths, {i: modes / a for i, modes in surfaces.swimming.items()})

    def _scaled_field(self, field: Field, unit: float) -> Field:
        """A field whose values have this unit."""
        return lambda x: field(self.user_places(x)) / unit

    # Back to the user's.

    def user_places(self, x: Array) -> Array:
        """Points (n, d)."""
        return self.length * x + self.origin if self.origin.any() else self.length * x

    def user_mesh(self, fluid: FluidMesh, container: Container) -> FluidMesh:
        """A mesh in this container from the scaled one, which is changed in place."""
        return fluid.scaled(self.length, container, self.origin)

    def user_solution(self, solution: StokesSolution, problem: StokesProblem) -> StokesSolution:
        """The solution of a problem from that of the scaled one; its mesh stays as it is."""
        d, gradient, flux = problem.q.dimension, solution.mean_pressure_gradient, solution.flux
        loads, fluid = self.loads(d), replace(problem.fluid, container=problem.container)
        speeds = {wall: speed * self.length for wall, speed in solution.wall_speeds.items()}
        boundary = problem.boundary.faster(speeds, solution.shear_rate or 0.0)
        sliding, of_laws = solution.slip_dissipation, solution.law_dissipation
        return replace(
            solution,
            U=solution.U * self.velocities(d),
            F=solution.F * loads,
            traction_F=solution.traction_F * loads,
            dissipation=solution.dissipation * self.power,
            law_dissipation=None if of_laws is None else of_laws * self.power,
            slip_dissipation=None if sliding is None else sliding * self.power,
            bulk=None if solution.bulk is None else self._user_bulk(solution.bulk, problem.container),
            problem=replace(problem, fluid=fluid, boundary=boundary),
            wall_speeds=speeds,
            flow=self._user_flow(solution.flow),
            surface=self._user_surface(solution.surface, fluid),
            mean_pressure_gradient=None if gradient is None else gradient * (self.viscosity / self.length),
            flux=None if flux is None else flux * self.flux,
        )

    def _user_bulk(self, bulk: BulkStress, container: Container) -> BulkStress:
        mu = self.viscosity
        return replace(
            bulk,
            fluid=bulk.fluid * mu,
            stresslets=bulk.stresslets * self.power,
            forces=bulk.forces * mu,
            volume=container.volume,
            in_gaps=None if bulk.in_gaps is None else bulk.in_gaps * self.power,
            newtonian=None if bulk.newtonian is None else bulk.newtonian * mu,
        )

    def _user_flow(self, flow: Flow) -> Flow:
        a, mu = self.length, self.viscosity
        return replace(flow, x=self.user_places(flow.x), u=a * flow.u, p=mu * flow.p)

    def _user_surface(self, surface: Surface, fluid: FluidMesh) -> Surface:
        x, reaction = self.user_places(surface.x), self.force * surface.reaction
        return replace(surface, x=x, reaction=reaction, lattice=fluid.lattice)

    def user_resistance(self, found: Resistance, modes: Modes) -> Resistance:
        """R and its inverse for modes in the user's units; eigenvalues have no unit."""
        s = modes.scale / found.modes.scale
        mobility = None if found.mobility is None else found.mobility / np.outer(s, s)
        return replace(found, modes=modes, R=found.R * np.outer(s, s), mobility=mobility)


def _origin(case: Case) -> Array:
    """In the narrowest gap of a case or the middle of its box, (d,), if wanted and possible; else zero."""
    q, container = case.configuration(), case.container()
    here = np.zeros(container.dimension)
    if case.domain.mesh is not None or container.seen_from(here) is None:
        return here
    narrowest = narrowest_gap(q, container)
    if narrowest is not None and narrowest.width <= NARROW * q.radii.min():
        here = place_of(narrowest, q, container)
    elif container.distances(here[None]).min() < -container.size():
        here = _on_axis(container.middle, container)
    return here


def place_of(gap: SurfaceGap, q: Configuration, container: Container) -> Array:
    """Where the origin is best for a gap, (d,): on its second side.

    Of a body that is so near to several walls it is where they meet, in the fluid that is shut in there.
    """
    origin, i = gap.opposite[None], gap.sides[0]
    near = wall_gaps(q, container)[i] <= NARROW * q.radii.min()
    for wall in np.flatnonzero(near):
        origin = origin - container.distances(origin)[0, wall] * container.normals(origin)[0, wall]
    return _on_axis(origin[0], container)


def _on_axis(place: Array, container: Container) -> Array:
    """What is beside a place on the axis, if there is one, (d,): it cannot be moved."""
    return place * [0.0, 1.0] if container.axisymmetric else place
