"""The fields that `fsi render --field` can show: each is one entry here, or is registered from elsewhere.

    register_field(
        RenderedField("fast", "|u|^2", "square of the speed", "viridis", Logarithmic(6.0), ("velocity",),
                      lambda at, viscosity: (at["velocity"] ** 2).sum(axis=1))
    )

The command takes its choices and its help from here, and all pictures what they draw. What a value is
computed from is known at points of the flow, by the names of the run's files: `velocity` u, (n, 3);
`pressure` p, (n,); `disturbance` u - u_inf, (n, 3), of sheared flows; `strain_rate` sqrt(2 e:e), (n,);
`vorticity`, (n,), on a plane in space its part across that; on bodies `traction`
sigma n, (n, 3). With an axis, components are those along r and z, and gradients hold the hoop rate u_r / r.

Its scale says how values become colours, see `fsi.postprocess.render.scales`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import isfinite
from typing import TYPE_CHECKING, Self

from fsi.errors import InputError, refuse_taken
from fsi.postprocess.render.scales import FromZero, Linear, Logarithmic, Scale, Shown, Signed, Span, shaded

if TYPE_CHECKING:  # for `fsi render --help`, which lists the fields, what draws them is not imported
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Colormap

    from fsi.arrays import Array

type KnownAtPoints = Mapping[str, Array]

DISTURBANCE = "disturbance"  # velocity less the linear flow without bodies, where there is one


@dataclass(frozen=True)
class RenderedField:
    """A field as pictures show it.

    Attributes:
        name: what `--field` calls it.
        label: what its colour bar says, a formula; {x} and {y} in it are the coordinates of the plane.
        title: what is written above a panel.
        colours: the name of a colour map of matplotlib: perceptual, told apart by every eye, bright where the
            field is large, white at zero where it is signed.
        scale: how values become colours.
        needs: the data that it is computed from.
        value: from these data at n points, and the viscosity, to the field there, (n,).
        pale: whether to leave out the dark end of the colours, so that dark lines stay visible.
        streamlines: the velocity whose streamlines are drawn on it; none: no lines.
        edges: whether to draw those of the cells on it.
        on_bodies: whether it lives on the surfaces of the bodies.
    """

    name: str
    label: str
    title: str
    colours: str
    scale: Scale
    needs: tuple[str, ...]
    value: Callable[[KnownAtPoints, float], Array]
    pale: bool = False
    streamlines: str = ""
    edges: bool = False
    on_bodies: bool = False

    @property
    def of_mesh(self) -> bool:
        """Whether only a level with a mesh has it."""
        return self.edges or "traction" in self.needs

    def along(self, right: str, up: str) -> Self:
        """The same where the coordinates have those letters."""
        return replace(self, label=self.label.replace("{x}", right).replace("{y}", up))

    def shades(self, steps: Sequence[Shown], asked: Span | None = None) -> ScalarMappable:
        """What its colours mean in all those steps, in the range that is asked for, or in that of all.

        Raises InputError: it is not finite there.
        """
        from statistics import median

        self._require_finite(steps)
        span = asked or self.scale.joined([seen.span for seen in steps])
        return shaded(self.scale, Shown(span, median(seen.typical for seen in steps)), self.colour_map)

    def _require_finite(self, steps: Sequence[Shown]) -> None:
        """Raise InputError where what is seen of it is NaN or infinite, which no colour shows."""
        if not all(map(isfinite, (number for span, typical in steps for number in (*span, typical)))):
            raise InputError(f"--field {self.name}: is NaN or infinite in these steps; correct its `value`")

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
    """Let `fsi render --field` show it. Raises ValueError: another one, of another file, has its name."""
    if field.name in _FIELDS:
        refuse_taken(field.name, _FIELDS[field.name].value, field.value)
    _FIELDS[field.name] = field


def field_names() -> list[str]:
    """What can be chosen."""
    return [*_FIELDS]


def rendered_field(name: str) -> RenderedField:
    """The field of that name. Raises InputError: there is none."""
    known = field_names()
    if name not in known:
        raise InputError(f"--field {name}: give one of {', '.join(known)}")
    return _FIELDS[name]


for _field in (
    RenderedField("speed", "|u|", "speed and streamlines", "viridis", Logarithmic(4.0),
                  ("velocity",), lambda at, _: (at["velocity"] ** 2).sum(axis=1) ** 0.5,
                  streamlines="velocity"),
    RenderedField("pressure", "p", "pressure", "RdBu_r", Signed(),
                  ("pressure",), lambda at, _: at["pressure"]),
    RenderedField(DISTURBANCE, r"$|u - u_\infty|$", "velocity less the mean flow, its streamlines", "viridis",
                  FromZero(), (DISTURBANCE,), lambda at, _: (at[DISTURBANCE] ** 2).sum(axis=1) ** 0.5,
                  streamlines=DISTURBANCE),
    RenderedField("vorticity", r"$\partial_{x} u_{y} - \partial_{y} u_{x}$", "vorticity", "PuOr_r", Signed(),
                  ("vorticity",), lambda at, _: at["vorticity"]),
    RenderedField("dissipation", r"$2 \mu\, e : e$", "dissipation", "magma", Logarithmic(8.0),
                  ("strain_rate",), lambda at, viscosity: viscosity * at["strain_rate"] ** 2),
    RenderedField("traction", r"$|\sigma n|$", "traction on the bodies", "plasma", Logarithmic(4.0),
                  ("traction",), lambda at, _: (at["traction"] ** 2).sum(axis=1) ** 0.5,
                  on_bodies=True),
    RenderedField("mesh", "p", "pressure and mesh", "cividis", Linear(),
                  ("pressure",), lambda at, _: at["pressure"], pale=True, edges=True),
):  # fmt: skip
    register_field(_field)
