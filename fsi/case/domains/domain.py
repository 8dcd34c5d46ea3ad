"""The domain of a case: what all shapes of containers have in common, and the registry of the shapes.

One more shape is one file here, named after its word: a section under `@register_domain`, and one more
container in `fsi.meshes.geometry`. Files of this room are found by themselves; from outside the decorator
alone does.
"""

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, NamedTuple, Self, override

from pydantic import BeforeValidator, Field, PrivateAttr, SerializeAsAny, ValidationInfo, field_validator

from fsi.case.registry import Registered, Registry
from fsi.case.section import Geometry, context_of, refusal, refuse_unknown, require_components, told
from fsi.case.walls import Velocity, Wall, wall_forms
from fsi.meshes.geometry.container import Container


class MeanDrive(NamedTuple):
    """What drives the fluid along a channel or shears that of a cell, besides walls and a given mean flow.

    Attributes:
        pressure_gradient: the mean dp/dx, None where it is a result.
        net_flux: the flux of fluid and bodies along x that is then given.
        mean_stress: the shear stress of a cell whose rate of shear is a result, else None.
    """

    pressure_gradient: float | None = 0.0
    net_flux: float | None = None
    mean_stress: float | None = None


class Walled(Registered):
    """What all domains have: a condition at every wall, and perhaps the user's own mesh of the shape."""

    registry: ClassVar[Registry[Any]] = Registry("shape", __package__, default="box")
    # No mesh file has what a periodic domain needs: sides that match.
    takes_mesh: ClassVar[bool] = True
    # The keys of what drives the fluid besides walls.
    drives: ClassVar[tuple[str, ...]] = ()

    shape: str
    _geometry: Geometry = PrivateAttr("planar")
    walls: dict[str, Wall] = Field(default={}, validate_default=True)
    mesh: str | None = None
    """the path of a mesh file of this shape, seen from the case file's folder"""

    @field_validator("walls")
    @classmethod
    def _complete(cls, walls: dict[str, Wall], info: ValidationInfo) -> dict[str, Wall]:
        """The conditions of all walls in the container's order, at rest where none is given."""
        names, dimension = cls.wall_names(told(info).geometry, info.data), told(info).dimension
        for name, wall in walls.items():
            refuse_unknown(name, names)
            require_components(wall.components(dimension), dimension, f"the velocity of {name}")
        return {name: walls.get(name, Velocity((0.0,) * dimension)) for name in names}

    @field_validator("mesh")
    @classmethod
    def _own_mesh(cls, mesh: str | None) -> str | None:
        if mesh is not None and not cls.takes_mesh:
            raise ValueError("a periodic domain is meshed by this program; drop it")
        return mesh

    @classmethod
    @override
    def describe(cls, key: str) -> str | None:
        return f"for each wall {wall_forms()}" if key == "walls" else super().describe(key)

    @classmethod
    def wall_names(cls, geometry: Geometry, known: Mapping[str, Any]) -> tuple[str, ...]:  # noqa: ARG003
        """Names of the walls of this shape, by the geometry and the keys before `walls`; none by default."""
        return ()

    @override
    def model_post_init(self, context: Any) -> None:
        """Keep the geometry of the case, which says what the container looks like."""
        self._geometry = context_of(context).geometry

    @property
    def geometry(self) -> Geometry:
        """That of the case."""
        return self._geometry

    def container(self) -> Container:
        """The geometry, at time 0."""
        raise NotImplementedError

    @property
    def profiled(self) -> bool:
        """Whether a wall has a shape."""
        return False

    def mean_drive(self) -> MeanDrive:
        """The mean pressure gradient or net flux along a channel, the stress of a cell; none elsewhere."""
        return MeanDrive()

    def require_undriven(self, why: str) -> None:
        """Raise InputError, for this reason, where more than walls drives the fluid."""
        for key in self.drives:
            if (value := getattr(self, key)) != type(self).model_fields[key].default:
                raise refusal(f"domain.{key}", value, f"{why}; drop it")

    def halved(self) -> Self | None:
        """The same with half the radius, where that stands for infinity; None where nothing does."""
        return None

    def require_axis(self) -> None:
        """Raise InputError where an axisymmetric domain does not begin on its axis."""

    def require_shapes(self) -> None:
        """Raise InputError where a wall cannot have the shape that is given."""

    def require_fluid(self) -> None:
        """Raise InputError where no flow is solved for; bodies without fluid may be there all the same."""


register_domain = Walled.registry.register
Domain = Annotated[SerializeAsAny[Walled], BeforeValidator(Walled.registry.validate)]
