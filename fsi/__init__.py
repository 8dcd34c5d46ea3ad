"""Rigid bodies moving in Stokes flow, resolved down to the lubrication film.

What a Python user needs stands here, from `fsi.api`: `load_case`, `make_case`, `solve`, `run`, `resume`,
`calibrate`, `open_run`. It is imported when it is first used, as the command `fsi --help` needs none of it.
"""

from __future__ import annotations

from typing import Any

import fsi.meshes as _meshes  # noqa: F401  before NumPy: it sets the number of threads


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from importlib import metadata

        return metadata.version("fsi-stokes")
    if not name.startswith("_"):
        import fsi.api as api

        if name in api.__all__:
            return getattr(api, name)
    raise AttributeError(f"module 'fsi' has no attribute {name!r}")


def __dir__() -> list[str]:
    import fsi.api as api

    return [*globals(), *api.__all__]
