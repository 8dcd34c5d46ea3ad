"""What the user's own mesh of a case must satisfy: its bodies stand, and all that bounds it has a name."""

import re
from pathlib import Path

from fsi.case.case import Case
from fsi.case.section import toml_text
from fsi.case.series import is_zero
from fsi.errors import InputError
from fsi.files import content

_REMEDY = "give a .msh file written by gmsh"
# Lines that begin what every mesh file has; comments may stand above.
_NEEDED = [re.compile(rb"^\$%b\s" % name, re.MULTILINE) for name in (b"MeshFormat", b"Nodes", b"Elements")]
# Lines of text in binary files too: dimension, number, name.
_NAMES = re.compile(rb"\$PhysicalNames\s(.*?)\$EndPhysicalNames", re.DOTALL)
_CURVE = re.compile(r'^\s*1\s+\d+\s+"(.*)"\s*$', re.MULTILINE)


def check_own_mesh(case: Case) -> None:
    """Raise InputError where bodies leave the place that the user's own mesh has for them."""
    if case.domain.mesh is None:
        return
    for i, body in enumerate(case.bodies):
        for part, key in zip(body.motion[: case.dimension], body.keys, strict=False):
            if part == "free" or not is_zero(part):
                raise InputError(
                    f"domain.mesh = {toml_text(case.domain.mesh)}: serves bodies where they stand, and "
                    f"bodies.{i}.{key.replace('force', 'velocity')} lets {body.name!r} move; drop the mesh, "
                    "so that each instant has its own, hold the bodies at rest, or use `fsi solve`"
                )


def check_mesh_file(case: Case) -> None:
    """Raise InputError where a solve or run of the case would refuse its own mesh, as far as names tell.

    For `fsi check`: whoever meshes reads the file anyway, and `fsi solve` takes bodies that would move.
    """
    if case.domain.mesh is None or not case.level.meshed:
        return
    if case.time is not None:
        check_own_mesh(case)
    here = f"domain.mesh = {case.domain.mesh}"
    if case.dimension == 3:
        raise InputError(f"{here}: a mesh in space cannot be read; drop it")
    text = content(Path(case.domain.mesh), _REMEDY)
    if not all(needed.search(text) for needed in _NEEDED):
        raise InputError(f"{here}: cannot be read; {_REMEDY}")
    listed = _NAMES.search(text)
    curves = _CURVE.findall(listed[1].decode(errors="replace")) if listed else []
    for name in (*case.names, *case.container().boundary_names):
        if name not in curves:
            known = ", ".join(curves) or "none"
            raise InputError(f"{here}: has no physical curve named {name}; it has {known}")
