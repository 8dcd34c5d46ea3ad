"""A mesh of one's own: written as Gmsh's file, looked at, and solved on.

    python docs/examples/own_mesh.py [own_mesh.png]

`fsi mesh CASE -o disc.msh` writes the mesh that a case would have, with physical groups named like its
walls and bodies; a file of any other program does as well, as long as its boundary is that of the case.
`domain.mesh` takes it. The force of the fluid on the disc, which moves down at unit speed, is 466.11048
upwards by a reference (cases/disc_in_box.toml); on the mesh that the case would have made itself it is the
same to rounding.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

import meshio

import fsi
from fsi.postprocess.plots.figure import BLUE, saved_figure

CASE = Path(__file__).parents[2] / "cases" / "disc_in_box.toml"
FORCE = 466.11048
COARSE = "discretisation.cells_per_circle=12"


def force(*overrides: str) -> float:
    """Of the fluid on the disc, upwards."""
    return float(fsi.solve(fsi.load_case(CASE, overrides))["disc"].force[1])


def draw(path: Path, picture: Path) -> None:
    """The triangles of a mesh file, by their corners."""
    mesh = meshio.read(path)
    cells = next(block.data[:, :3] for block in mesh.cells if block.type.startswith("triangle"))
    with saved_figure(picture, (5.0, 8.0)) as figure:
        axes = figure.add_subplot(aspect="equal", xlabel="x", ylabel="y", title=f"{len(cells)} cells")
        axes.triplot(*mesh.points[:, :2].T, cells, color=BLUE, lw=0.5)
        axes.grid(visible=False)


def main(picture: Path) -> None:
    """Write two meshes with the command line, solve on them, draw one."""
    with tempfile.TemporaryDirectory() as name:
        files = {key: Path(name) / f"{key}.msh" for key in ("fine", "coarse")}
        for key, more in (("fine", []), ("coarse", ["--set", COARSE])):
            command = [sys.executable, "-m", "fsi", "mesh", str(CASE), "-o", str(files[key]), *more]
            subprocess.run(command, check=True, capture_output=True)
        made = force()
        given, coarse = (force(f"domain.mesh={str(path)!r}") for path in files.values())
        draw(files["fine"], picture)
    found = {"mesh of the case": made, "from its file": given, "coarser, from a file": coarse}
    for what, value in found.items():
        print(f"{what:21} {value:.6f}, off by {value / FORCE - 1.0:+.1e}")
    assert abs(given / made - 1.0) < 1e-9
    assert abs(given / FORCE - 1.0) < 1e-5
    assert abs(coarse / given - 1.0) > 1e-7  # the file is what was solved on


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "own_mesh.png"))
