"""Element sizes in the fluid between the boundaries, as fields of gmsh."""

from dataclasses import dataclass

import fsi.meshes.backend  # noqa: F401

import gmsh

from fsi.meshes.planar.grading import Grading

BODIES = 1  # gmsh's curve of all bodies
FINEST_SHIFT = 1e-12


@dataclass(frozen=True, slots=True)
class FarSize:
    """A bound on the element size in the fluid: `smallest + slope d` at the distance d from the nearest body.

    Without it gmsh, which interpolates between distant boundaries, leaves what is around bodies too coarse.
    Where outlines bend more here than there, or radii are unlike, the length of the nearest edge stands for
    `smallest`: beside the rim of a thin body sizes are a thousandth of those elsewhere, and gmsh's cells,
    which need to be small by the mean over their corners only, would leap from one to the other.

    Attributes:
        bodies: how many, with the tags 1 ... N.
        smallest: the size on a body.
        slope: how fast sizes grow.
        reach: a length that no distance exceeds.
        grading: towards corners of the container.
        alone: whether the sizes of the boundary do not count in the fluid.
        bent: whether outlines bend more here than there, or radii are unlike.
    """

    bodies: int
    smallest: float
    slope: float
    reach: float
    grading: Grading
    alone: bool = False
    bent: bool = False

    def apply(self) -> None:
        """Make it gmsh's background size."""
        if len(self.grading.corners):
            # gmsh shifts nodes by that part of the size of the domain before it connects them.
            gmsh.option.setNumber("Mesh.RandomFactor", FINEST_SHIFT)
        if self.bodies == 0:
            return
        bound = self._from_edges() if self.bent else self._from_bodies()
        if self.alone:
            gmsh.option.setNumber("Mesh.MeshSizeExtendFromBoundary", 0)
            bound = self._graded(bound)
        gmsh.model.mesh.field.setAsBackgroundMesh(bound)

    @property
    def _largest(self) -> float:
        """The size at the distance `reach`."""
        return self.smallest + self.slope * self.reach

    def _from_bodies(self) -> int:
        """gmsh's number of the field of sizes that grow from `smallest` on."""
        field = gmsh.model.mesh.field
        distance, bound = field.add("Distance"), field.add("Threshold")
        field.setNumbers(distance, "CurvesList", [BODIES])
        for end, d, size in (("Min", 0.0, self.smallest), ("Max", self.reach, self._largest)):
            field.setNumber(bound, f"Dist{end}", d)
            field.setNumber(bound, f"Size{end}", size)
        field.setNumber(bound, "InField", distance)
        return int(bound)

    def _from_edges(self) -> int:
        """The same from the length of the nearest edge on."""
        field = gmsh.model.mesh.field
        bound = field.add("Extend")
        field.setNumbers(bound, "CurvesList", [BODIES])
        for key, value in (("DistMax", self.reach), ("SizeMax", self._largest), ("Power", 1.0)):
            field.setNumber(bound, key, value)
        return int(bound)

    def _graded(self, bound: int) -> int:
        """gmsh's number of the least of a field of sizes and those towards the corners."""
        field, fields = gmsh.model.mesh.field, [bound]
        for (x, y), smallest in zip(self.grading.corners.tolist(), self.grading.smallest, strict=True):
            away = f"Sqrt((x - ({x!r}))^2 + (y - ({y!r}))^2)"
            fields.append(field.add("MathEval"))
            field.setString(fields[-1], "F", f"{smallest:.17g} + {self.grading.slope:.17g} * {away}")
        field.setNumbers(least := field.add("Min"), "FieldsList", fields)
        return int(least)
