"""Rigid bodies moving in Stokes flow, resolved down to the lubrication film.

What a Python user needs stands here, from `fsi.api`: `load_case`, `make_case`, `solve`, `run`, `resume`,
`calibrate`, `open_run`. It is imported when it is first used, as the command `fsi --help` needs none of it.
"""

from typing import Any

import fsi.machine.kernels as _kernels  # noqa: F401  before libraries: it tells them which to take
import fsi.machine.threads as _threads  # noqa: F401  before NumPy: it sets the number of threads

__all__ = [
    "BodySolution", "CalibrationResult", "Case", "FsiError", "InputError", "Resistance", "Run", "Solution",
    "SolveError", "StepRecord", "calibrate", "load_case", "make_case", "open_run", "resume", "run", "solve",
]  # fmt: skip


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from importlib import metadata

        return metadata.version("fsi-stokes")
    if name not in __all__:
        raise AttributeError(f"module 'fsi' has no attribute {name!r}")
    import fsi.api as api

    return getattr(api, name)


def __dir__() -> list[str]:
    return [*globals(), *__all__]
