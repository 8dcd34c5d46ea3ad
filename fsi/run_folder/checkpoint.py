"""state.npz: all that the next step depends on, replaced in one go."""

import io
import zlib
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np
from numpy.typing import NDArray

from fsi.bodies.configuration import Configuration
from fsi.files import content, replace
from fsi.integration.state import Past, State

_ZIP = b"PK\x03\x04"


@dataclass(frozen=True, slots=True)
class Checkpoint:
    """The state of the stepper and of the model, and how far the files of the run belong to it.

    Attributes:
        state: of the stepper.
        model: what `Model.state` gave.
        lengths: bytes of each table.
        entries: number of each series' entries.
        sums: CRC-32 of those bytes of each table; older runs have none.
        case: the digest of what stays of the case, see `one_case`; older runs have none.
    """

    state: State
    model: Mapping[str, NDArray[Any]]
    lengths: Mapping[str, int]
    entries: Mapping[str, int]
    sums: Mapping[str, int] = field(default_factory=dict)
    case: str | None = None


def write_checkpoint(path: Path, checkpoint: Checkpoint) -> None:
    """Replace the file."""
    state = checkpoint.state
    arrays: dict[str, Any] = {"t": state.t, "step": state.step, "h": state.h, "U": state.U}
    arrays |= {"centres": state.q.centres, "angles": state.q.angles, "radii": state.q.radii}
    arrays["strain"] = state.q.strain
    if state.past is not None:
        arrays |= {f"past/{field.name}": getattr(state.past, field.name) for field in fields(Past)}
    if checkpoint.case is not None:
        arrays["case"] = checkpoint.case
    for group in ("model", "lengths", "entries", "sums"):
        arrays |= {f"{group}/{key}": value for key, value in getattr(checkpoint, group).items()}
    packed = io.BytesIO()
    np.savez(packed, **arrays)
    replace(path, packed.getvalue())


def read_checkpoint(path: Path) -> Checkpoint:
    """What `write_checkpoint` wrote, bit by bit. Raises ValueError of what it has not written."""
    try:
        return _checkpoint(_arrays(path))
    except (BadZipFile, EOFError, KeyError, RuntimeError, TypeError, zlib.error) as error:
        raise ValueError(f"{path.name}: {type(error).__name__} {error}") from None


def _arrays(path: Path) -> dict[str, NDArray[Any]]:
    packed = content(path, "give a run folder")
    if not packed.startswith(_ZIP):  # of other files NumPy would say how to load them unsafely
        raise ValueError(f"{path.name}: is no archive of arrays")
    with np.load(io.BytesIO(packed), allow_pickle=False) as archive:
        return dict(archive.items())


def _checkpoint(arrays: Mapping[str, NDArray[Any]]) -> Checkpoint:
    """What the arrays of a file say."""

    def group(name: str) -> dict[str, NDArray[Any]]:
        prefix = f"{name}/"
        return {key.removeprefix(prefix): value for key, value in arrays.items() if key.startswith(prefix)}

    def counts(name: str) -> dict[str, int]:
        return {key: int(value) for key, value in group(name).items()}

    strain = float(arrays.get("strain", 0.0))  # older runs have none: no stress sheared their cells
    q = Configuration(arrays["centres"], arrays["angles"], arrays["radii"], strain=strain)
    if len({len(part) for part in (q.centres, q.angles, q.radii, arrays["U"][: len(q)])}) > 1:
        raise ValueError("its arrays are of different numbers of bodies")
    past = Past(**group("past")) if group("past") else None
    return Checkpoint(
        State(float(arrays["t"]), int(arrays["step"]), q, arrays["U"], float(arrays["h"]), past),
        group("model"),
        counts("lengths"),
        counts("entries"),
        counts("sums"),
        str(arrays["case"]) if "case" in arrays else None,
    )
