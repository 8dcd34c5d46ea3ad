"""Cases of the reduced model for its tests."""

from __future__ import annotations

from typing import Any

from fsi.case.case import Case
from fsi.case.load import parse_case
from fsi.models import make_model
from fsi.reduced.model import ReducedInstant


def reduced_case(bodies: list[dict[str, Any]], reduced: dict[str, Any], **sections: Any) -> Case:
    """Bodies above a plane; `sections` replace the others. `scheme` and `step` go to [time]."""
    stepping = {key: reduced[key] for key in ("scheme", "step") if key in reduced}
    data: dict[str, Any] = {
        "name": "test",
        "model": "reduced",
        "fluid": {"viscosity": 1.0},
        "domain": {"shape": "half-plane", "radius": 1000.0},
        "bodies": bodies,
        "reduced": {key: value for key, value in reduced.items() if key not in stepping},
        "time": {"end": 1.0},
    } | sections
    data["time"] = data["time"] | stepping
    return parse_case(data)


def heap(**more: Any) -> list[dict[str, Any]]:
    """Five discs of three sizes that fall onto a plane and onto each other."""
    places = [(0.0, 1.3, 1.0), (2.05, 1.2, 1.0), (1.0, 3.0, 0.8), (-1.5, 2.6, 0.5), (3.0, 3.1, 0.8)]
    return [
        {"name": f"b{k}", "radius": a, "position": [x, y], "force": [0.5 * k, -10.0 * a * a]} | more
        for k, (x, y, a) in enumerate(places)
    ]


INERTIA = {"mass": 1.0, "moment_of_inertia": 0.5}


# Laws of all three modes, those of sliding and rolling by their leading terms too.
ALL = {"law": "exact", "shear_law": "exact", "rotation_law": "exact", "drag": 12.0, "cutoff": 1.0}
LEADING = ALL | {"shear_law": "leading", "rotation_law": "leading"}


def instant(case: Case) -> ReducedInstant:
    found = make_model(case)(case.configuration(), 0.0)
    assert isinstance(found, ReducedInstant)
    return found


def disc(name: str, x: float, y: float, radius: float = 1.0) -> dict[str, object]:
    return {"name": name, "radius": radius, "position": [x, y], "force": [0.0, -1.0]}


PLANE = {"shape": "half-plane", "radius": 1000.0}
LARGE = {"shape": "round", "radius": 1e4}
EQUAL, UNEQUAL = [disc("a", 0.0, 9.0), disc("b", 3.0, 9.0)], [disc("a", 0.0, 9.0), disc("b", 5.0, 9.0, 3.0)]
