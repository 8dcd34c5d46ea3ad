"""The section [[forces]] of a case: what acts on bodies besides the fluid.

One more law is one file here: a section under `@register_force`. Files of this room are found by themselves;
from outside the decorator alone does.
"""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, override

import numpy as np
from pydantic import BeforeValidator, SerializeAsAny

from fsi.arrays import Array
from fsi.bodies.forces import Bulk, ForceLaw
from fsi.case.registry import Registered, Registry
from fsi.case.section import toml_text
from fsi.case.series import Table, kinks, value_at
from fsi.errors import InputError
from fsi.meshes.geometry.container import Container

KINDS = '"gravity", "attraction" or "repulsion"'


class ForceSection(Registered, ForceLaw):
    """What acts on bodies besides the fluid."""

    registry: ClassVar[Registry[Any]] = Registry("law", __package__)
    reach_key: ClassVar[str] = "reach"
    """the key that says where a force between surfaces ends"""

    def weight(self, bulk: Bulk) -> tuple[Array, tuple[float | Table, ...]] | None:  # noqa: ARG002
        """What is heavy of each body, (N,), and its acceleration over time, (d,); None of no weight.

        Of a weight `on_bodies` is their product, and no other force.
        """
        return None

    def kinks(self, bulk: Bulk) -> set[float]:
        """The times at which the weight of bodies has a kink."""
        weight = self.weight(bulk)
        return set() if weight is None else {time for part in weight[1] for time in kinks(part)}

    @override
    def on_bodies(self, bulk: Bulk, t: float) -> Array | float:
        weight = self.weight(bulk)
        if weight is None:
            return 0.0
        heavy, acceleration = weight
        force: Array = heavy[:, None] * np.array([value_at(part, t) for part in acceleration])
        return force

    def require_fit(self, key: str, container: Container, *, heavy: bool) -> None:
        """Raise InputError, which calls the law `key`, where it makes no sense; heavy: a body has a mass."""

    def require_reach(self, key: str, container: Container) -> None:
        """A law of the gap ends where bodies and their images are no longer looked for; else InputError."""
        if self.reach > container.image_reach:
            raise InputError(
                f"{key}.{self.reach_key} = {toml_text(getattr(self, self.reach_key))}: reaches farther than "
                f"the periodic domain is large; end it at a gap of {container.image_reach:.6g} or less"
            )

    def require_contact(self, key: str) -> None:
        """Raise InputError, which calls the law `key`, where it has no value at the gap 0."""


register_force = ForceSection.registry.register

Force = Annotated[SerializeAsAny[ForceSection], BeforeValidator(ForceSection.registry.validate)]
