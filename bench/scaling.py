"""What each benchmark collects for `--json FILE`, which `fsi plot FILE` draws: CPU seconds against a size."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from fsi.postprocess.plots.scaling import write_scaling

JSON_HELP = "write the CPU seconds against the size, which `fsi plot FILE` draws"


@dataclass(frozen=True, slots=True)
class Scaling:
    """The measured pairs (N, CPU seconds) of each curve; title: what was done; size: what N counts."""

    title: str
    size: str
    curves: dict[str, list[tuple[int, float]]] = field(default_factory=dict)

    def add(self, curve: str, N: int, seconds: float) -> None:
        """Keep a measurement."""
        self.curves.setdefault(curve, []).append((N, seconds))

    def write(self, path: Path | None) -> None:
        """Write all of them, if a file is asked for."""
        if path is not None:
            write_scaling(path, self.title, self.size, self.curves)
