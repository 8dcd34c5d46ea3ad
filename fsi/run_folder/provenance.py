"""Where a result comes from: the code, the packages, the machine, the command."""

import os
import platform
import shlex
import subprocess
import sys
from datetime import UTC, datetime
from importlib import metadata
from pathlib import Path
from typing import Any

import fsi.parallel as parallel

PACKAGES = (
    "fsi-stokes", "fenics-dolfinx", "dolfinx-solver-real", "petsc4py", "mpi4py", "gmsh", "meshio",
    "numpy", "scipy", "pydantic",
)  # fmt: skip


def launch() -> dict[str, Any]:
    """What provenance.json records of this process; `seed` is null because nothing is random."""
    return {
        "started": datetime.now(UTC).isoformat(timespec="seconds"),
        "command": shlex.join(sys.argv),
        "ranks": parallel.size(),
        "threads": os.environ.get("OMP_NUM_THREADS"),
        "seed": None,
        "git": git_commit(Path(__file__).resolve().parents[2]),
        "python": platform.python_version(),
        "packages": {name: version for name in PACKAGES if (version := _version(name)) is not None},
        "platform": platform.platform(),
    }


def git_commit(root: Path) -> str | None:
    """Commit of the checkout with this root, `+dirty` if tracked files differ from it; None if it is none."""
    top = _git(root, "rev-parse", "--show-toplevel")
    if top is None or Path(top) != root:
        return None
    commit = _git(root, "rev-parse", "--verify", "HEAD")
    if commit is None:
        return None
    return commit + ("+dirty" if _git(root, "status", "--porcelain", "--untracked-files=no") else "")


def _version(package: str) -> str | None:
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return None


def _git(root: Path, *arguments: str) -> str | None:
    """Output of a git command in a folder; None if it fails or there is no git."""
    try:
        done = subprocess.run(["git", "-C", root, *arguments], capture_output=True, text=True, check=False)
    except OSError:
        return None
    return done.stdout.strip() if done.returncode == 0 else None
