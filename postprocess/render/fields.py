"""The fields that `fsi render --field` can show: each is one entry here, or is registered from elsewhere.

    register_field(
        RenderedField("fast", "|u|^2", "square of the speed", "viridis", Logarithmic(6.0), ("velocity",),
                      lambda at, viscosity: (at["velocity"] ** 2).sum(axis=1))
    )

The command takes its choices and its help from here, and all pictures what they draw. What a value is
computed from is known at points of the flow, by the names of the run's files: `velocity` u, (n, 3);
`pressure` p, (n,); `strain_rate` sqrt(2 e:e), (n,); `vorticity`, (n,), in space (n, 3); on bodies `traction`
sigma n, (n, 3). With an axis, components are those along r and z, and gradients hold the hoop rate u_r / r.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from fsi.errors import InputError
from fsi.postprocess.render.scales import Linear, Logarithmic, Scale, Signed

if TYPE_CHECKING:  # the help of the command needs the names only
    from matplotlib.colors import Colormap

    from fsi.bodies.configuration import Array

type KnownAtPoints = Mapping[str, Array]


@dataclass(frozen=True)
class RenderedField:
    """A field as pictures show it.

    Attributes:
        name: what `--field` calls it.
        label: what its colour bar says, a formula.
        title: what is written above a panel.
        colours: the name of a colour map of matplotlib: perceptual, told apart by every eye, bright where the
            field is large, white at zero where it is signed.
        scale: how values become colours.
        needs: the data that it is computed from.
        value: from these data at n points, and the viscosity, to the field there, (n,).
        pale: whether to leave out the dark end of the colours, so that dark lines stay visible.
        streamlines: whether to draw them on it.
        edges: whether to draw those of the cells on it.
        on_bodies: whether it lives on the surfaces of the bodies.
        in_space: whether a plane through a flow in space shows it.
    """

    name: str
    label: str
    title: str
    colours: str
    scale: Scale
    needs: tuple[str, ...]
    value: Callable[[KnownAtPoints, float], Array]
    pale: bool = False
    streamlines: bool = False
    edges: bool = False
    on_bodies: bool = False
    in_space: bool = True

    @property
    def colour_map(self) -> Colormap:
        """The map of that name."""
        import numpy as np
        from matplotlib import colormaps
        from matplotlib.colors import ListedColormap

        colours = colormaps[self.colours]
        return ListedColormap(colours(np.linspace(0.35, 1.0, 256))) if self.pale else colours


_FIELDS: dict[str, RenderedField] = {}


def register_field(field: RenderedField) -> None:
    """Let `fsi render --field` show it."""
    _FIELDS[field.name] = field


def field_names(in_space: bool = False) -> list[str]:
    """What can be chosen; on a plane in space not all of it."""
    return [name for name, field in _FIELDS.items() if field.in_space or not in_space]


def rendered_field(name: str, in_space: bool = False) -> RenderedField:
    """The field of that name. Raises InputError: there is none."""
    known = field_names(in_space)
    if name not in known:
        raise InputError(f"--field {name}: give one of {', '.join(known)}")
    return _FIELDS[name]


for _field in (
    RenderedField(
        "speed", "|u|", "speed and streamlines", "viridis", Logarithmic(4.0), ("velocity",),
        lambda at, _: (at["velocity"] ** 2).sum(axis=1) ** 0.5, streamlines=True,
    ),
    RenderedField(
        "pressure", "p", "pressure", "RdBu_r", Signed(), ("pressure",), lambda at, _: at["pressure"],
    ),
    RenderedField(
        "vorticity", r"$\partial_x u_y - \partial_y u_x$", "vorticity", "PuOr_r", Signed(), ("vorticity",),
        lambda at, _: at["vorticity"], in_space=False,
    ),
    RenderedField(
        "dissipation", r"$2 \mu\, e : e$", "dissipation", "magma", Logarithmic(8.0), ("strain_rate",),
        lambda at, viscosity: viscosity * at["strain_rate"] ** 2,
    ),
    RenderedField(
        "traction", r"$|\sigma n|$", "traction on the bodies", "plasma", Logarithmic(4.0), ("traction",),
        lambda at, _: (at["traction"] ** 2).sum(axis=1) ** 0.5, on_bodies=True, in_space=False,
    ),
    RenderedField(
        "mesh", "p", "pressure and mesh", "cividis", Linear(), ("pressure",), lambda at, _: at["pressure"],
        pale=True, edges=True, in_space=False,
    ),
):  # fmt: skip
    register_field(_field)
