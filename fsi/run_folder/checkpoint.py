"""state.npz: all that the next step depends on, replaced in one go."""

import io
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fsi.bodies.configuration import Configuration
from fsi.files import replace
from fsi.integration.state import State


@dataclass(frozen=True, slots=True)
class Checkpoint:
    """The state of the stepper and of the model, and how far the files of the run belong to it.

    model: what `Model.state` gave; lengths: bytes of each table; entries: number of each series' entries.
    """

    state: State
    model: Mapping[str, NDArray[Any]]
    lengths: Mapping[str, int]
    entries: Mapping[str, int]


def write_checkpoint(path: Path, checkpoint: Checkpoint) -> None:
    """Replace the file."""
    state = checkpoint.state
    arrays: dict[str, Any] = {"t": state.t, "step": state.step, "h": state.h, "U": state.U}
    arrays |= {"centres": state.q.centres, "angles": state.q.angles, "radii": state.q.radii}
    for group in ("model", "lengths", "entries"):
        arrays |= {f"{group}/{key}": value for key, value in getattr(checkpoint, group).items()}
    packed = io.BytesIO()
    np.savez(packed, **arrays)
    replace(path, packed.getvalue())


def read_checkpoint(path: Path) -> Checkpoint:
    """What `write_checkpoint` wrote, bit by bit."""
    with path.open("rb") as file, np.load(file, allow_pickle=False) as archive:
        arrays = dict(archive)

    def group(name: str) -> dict[str, NDArray[Any]]:
        prefix = f"{name}/"
        return {key.removeprefix(prefix): value for key, value in arrays.items() if key.startswith(prefix)}

    q = Configuration(arrays["centres"], arrays["angles"], arrays["radii"])
    return Checkpoint(
        State(float(arrays["t"]), int(arrays["step"]), q, arrays["U"], float(arrays["h"])),
        group("model"),
        {name: int(value) for name, value in group("lengths").items()},
        {name: int(value) for name, value in group("entries").items()},
    )
