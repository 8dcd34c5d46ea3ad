"""A sound case of two discs in a box, as data, and how tests change it."""

import copy
from typing import Any

BOX: dict[str, Any] = {
    "name": "test",
    "fluid": {"viscosity": 1.0},
    "domain": {"lower": [-8.0, 0.0], "upper": [8.0, 16.0]},
    "bodies": [
        {"name": "disc", "radius": 1.0, "position": [0.0, 1.1]},
        {"name": "other", "radius": 1.0, "position": [3.0, 1.1]},
    ],
    "time": {"end": 5.0},
}


def changed(key: str, value: Any) -> dict[str, Any]:
    """The test case with one dotted key set; None drops the key."""
    data = copy.deepcopy(BOX)
    here: Any = data
    *path, last = key.split(".")
    for part in path:
        here = here[int(part)] if isinstance(here, list) else here.setdefault(part, {})
    if isinstance(here, list):
        here[int(last)] = value
    elif value is None:
        del here[last]
    else:
        here[last] = value
    return data
