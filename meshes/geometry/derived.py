"""A container that is another one in all but some ways."""

from dataclasses import dataclass

from fsi.meshes.geometry.container import Container


@dataclass(frozen=True, slots=True, eq=False)
class DerivedContainer(Container):
    """Answers by another container about what its kind leaves as it was.

    Attributes:
        inner: the other.
    """

    inner: Container

    @property
    def walls(self) -> tuple[str, ...]:
        """As before."""
        return self.inner.walls

    @property
    def far_walls(self) -> tuple[str, ...]:
        """As before."""
        return self.inner.far_walls

    @property
    def corner_axes(self) -> tuple[int, ...]:
        """As before: corners of a box stay where their walls meet."""
        return self.inner.corner_axes
