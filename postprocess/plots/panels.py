"""What histories of runs show: gaps, speeds, loads, apparent viscosity, coordinates.

Each panel is one entry here, or is registered from elsewhere:

    register_panel("dissipation", of_steps("dissipation"))
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fsi.arrays import Array
from fsi.bodies.configuration import PLACES
from fsi.bodies.gaps import smallest_of_each
from fsi.bodies.surface_gap import gap_between
from fsi.postprocess.run.gaps import parse_sides
from fsi.postprocess.run.run import Run

_NO_LOAD = 1e-8  # loads on free bodies are rounding, relative to viscosity times speed and to other bodies'
_TURN = 1e-3  # radians, which nobody sees

type Curves = dict[str, Array]  # values (steps,) by the name of a body, or of a law; none: nothing to draw


@dataclass(frozen=True)
class Asked:
    """What a panel is asked for.

    Attributes:
        run: what is drawn.
        gap: two sides as in `plot_runs`; None for the smallest gap of each body.
        singly: up to so many bodies have a curve each; of more it is the smallest, median and largest value.
        by_name: whether `--curves` names the panel.
    """

    run: Run
    gap: str | None
    singly: int
    by_name: bool = False

    @property
    def bodies(self) -> bool:
        """Whether there are bodies in a fluid."""
        return self.run.viscous and bool(self.run.case.names)

    def each(self, table: Array) -> Curves:
        """Columns of a table (steps, N) by the name of the body."""
        names = self.run.case.names
        if len(names) <= self.singly:
            return dict(zip(names, table.T, strict=True))
        least, median, most = np.nanquantile(table, [0.0, 0.5, 1.0], axis=1)
        N = len(names)
        named = zip(("smallest", "median", "largest"), (least, median, most), strict=True)
        return {f"{what} of {N} bodies": values for what, values in named}

    def place(self, column: str) -> Array:
        """A coordinate or an angle of all bodies, (steps, N)."""
        values: Array = self.run.bodies[column].to_numpy(dtype=float)
        return values.reshape(-1, len(self.run.case.names))

    def sizes(self, vector: str) -> Array:
        """Lengths of a vector of all bodies, "V", "omega" or "F", (steps, N)."""
        components = self.run.bodies.filter(regex=f"^{vector}(_|$)").to_numpy()
        sizes: Array = np.linalg.norm(components, axis=1).reshape(-1, len(self.run.case.names))
        return sizes


LINEAR = frozenset(PLACES[2] + PLACES[3])  # coordinates and angles, whose zero anyone may choose
PANELS: dict[str, Callable[[Asked], Curves]] = {}
_ON_DEMAND: set[str] = set()


def register_panel(title: str, read: Callable[[Asked], Curves], on_demand: bool = False) -> None:
    """Let `fsi plot` draw one more panel of that title, below the others, where there are curves.

    on_demand: only where `--curves` names it.
    """
    PANELS[title] = read
    if on_demand:
        _ON_DEMAND.add(title)


def panel_titles(curves: str | None) -> list[str]:
    """The titles in "gap,x,angle", which may be of no panel, or those of every figure."""
    if curves is None:
        return [title for title in PANELS if title not in _ON_DEMAND]
    return [word.strip() for word in curves.split(",")]


def of_steps(column: str) -> Callable[[Asked], Curves]:
    """The curve of a column of steps.csv, where it has numbers."""

    def read(asked: Asked) -> Curves:
        values = asked.run.steps.get(column)
        return {} if values is None or values.isna().all() else {"": values.to_numpy()}

    return read


def _gaps(asked: Asked) -> Curves:
    """The smallest gap of each body, or one gap."""
    run = asked.run
    if not asked.bodies:
        return {}
    steps, container = run.steps["step"].astype(int), run.case.container()
    moments = ((run.configuration(step), run.container(step)) for step in steps)
    if asked.gap is None:
        table = np.array([smallest_of_each(*moment) for moment in moments])
        return asked.each(np.where(np.isfinite(table), table, np.nan))  # a lone body, without walls
    sides = parse_sides(asked.gap, run.case.names, container.walls)
    return {f"gap {asked.gap}": np.array([gap_between(*moment, sides).width for moment in moments])}


def _loads(asked: Asked) -> Curves:
    """On each body, where any is loaded; on one with nothing but rounding zero."""
    if not asked.bodies:
        return {}
    load, radii = asked.sizes("F"), asked.run.case.configuration().radii
    speed = asked.sizes("V") + radii * asked.sizes("omega")
    if load.max() <= _NO_LOAD * asked.run.case.fluid.viscosity * speed.max():
        return {}
    return asked.each(np.where(load.max(axis=0) <= _NO_LOAD * load.max(), 0.0, load))


VISCOSITY = "apparent viscosity"
ADDED_VISCOSITY = "viscosity added by lubrication"  # that of the reduced model: only the part that this adds
register_panel("gap", _gaps)
register_panel("speed", lambda asked: asked.each(asked.sizes("V")) if asked.bodies else {})
register_panel("load", _loads)
register_panel(VISCOSITY, of_steps("apparent_viscosity"))
register_panel("order parameter", of_steps("order_parameter"))
register_panel("tumbling rate", of_steps("tumbling_rate"))
register_panel(ADDED_VISCOSITY, of_steps("lubrication_viscosity"))


def _place(column: str) -> Callable[[Asked], Curves]:
    """Where the bodies are, in one coordinate or angle that they have."""

    def read(asked: Asked) -> Curves:
        has = bool(asked.run.case.names) and column in asked.run.bodies
        return asked.each(asked.place(column)) if has else {}

    return read


def _angle(column: str) -> Callable[[Asked], Curves]:
    """The same of an angle; where no one asks for it only of bodies that seem to turn, each with a curve."""
    everyone = _place(column)

    def read(asked: Asked) -> Curves:
        angles = everyone(asked)
        if asked.by_name or not angles:
            return angles
        shaped = {body.name for body in asked.run.case.bodies if body.shape is not None}
        return {name: angle for name, angle in angles.items() if name in shaped and np.ptp(angle) > _TURN}

    return read


for _column in dict.fromkeys(PLACES[2] + PLACES[3]):
    if _column.startswith("angle"):
        register_panel(_column, _angle(_column))
    else:
        register_panel(_column, _place(_column), on_demand=True)
for _column in ("contacts", "largest_density", "smallest_gamma", "kinetic_energy"):  # of vanishing viscosity
    register_panel(_column.replace("_", " "), of_steps(_column))
