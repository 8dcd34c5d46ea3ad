"""Small flows with laws below a gap, and without."""

from typing import Any

from fsi.case.load import parse_case
from fsi.stokes.model import StokesModel
from fsi.stokes.solution import StokesSolution

PLANE = {"shape": "half-plane", "radius": 1e5}
CHANNEL = {
    "lower": [0.0, 0.0], "upper": [6.0, 6.0], "periodic": ["x"],
    "walls": {"bottom": [-3.0, 0.0], "top": [3.0, 0.0]},
}  # fmt: skip
FREE = [
    {"name": "a", "radius": 1.0, "position": [2.0, 1.02]},
    {"name": "b", "radius": 0.9, "position": [3.35, 2.4]},
]


def solved(bodies: list[dict[str, Any]], below: float | None, **more: Any) -> StokesSolution:
    data = {"name": "laws", "fluid": {"viscosity": 2.0}, "domain": PLANE, "bodies": bodies} | more
    data["lubrication"] = {} if below is None else {"below": below}
    case = parse_case(data)
    return StokesModel(case)(case.configuration(), 0.0)
