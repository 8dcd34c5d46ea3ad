"""What `fsi check` says of a user's own mesh, by the names in it, before anything reads its cells."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from fsi.case.case import Case
from fsi.case.checks.own_mesh import check_mesh_file
from fsi.case.load import parse_case, saved_data
from fsi.errors import InputError
from fsi.meshes.errors import MeshFileError
from fsi.meshes.files.write import write_mesh
from fsi.meshes.resolution import Resolution
from fsi.stokes.meshes import CaseMeshes
from tests.case_data import changed
from tests.cli.test_commands import complaint
from tests.flows import BOX, disc_over_plane, mesh

# Two nodes and the line between them, without a name.
LINE = b"""$MeshFormat
2.2 0 8
$EndMeshFormat
$Nodes
2
1 0 0 0
2 1 0 0
$EndNodes
$Elements
1
1 1 2 1 1 1 2
$EndElements
"""
WALLS = ("left", "right", "bottom", "top")
DISC: dict[str, Any] = {"name": "disc", "radius": 1.0, "position": [0.0, 1.1], "velocity": [0.0, 0.0]}


def own(path: Path, **sections: Any) -> Case:
    """A disc at rest in a box, at one instant, with that mesh."""
    return parse_case(changed("time", None) | {"domain": box_with(path), "bodies": [DISC]} | sections)


def box_with(path: Path) -> dict[str, Any]:
    return dict(changed("domain.mesh", str(path))["domain"])


def names(path: Path, curves: tuple[str, ...]) -> Path:
    """A mesh file as far as its elements, as gmsh writes names in all its versions; its nodes are binary."""
    lines = [f'1 {k} "{name}"' for k, name in enumerate(curves, 1)] + ['2 9 "fluid"']
    head = [
        "$Comments",
        "by hand",
        "$EndComments",
        "$MeshFormat",
        "4.1 1 8",
        "$EndMeshFormat",
        "$PhysicalNames",
        str(len(lines)),
        *lines,
    ]
    nodes = "\n".join([*head, "$EndPhysicalNames", "$Nodes", ""]).encode() + bytes(range(256))
    path.write_bytes(nodes + b"\n$EndNodes\n$Elements\n")
    return path


def test_a_mesh_with_all_names_passes(tmp_path: Path) -> None:
    """One that this program has written, and one with line ends of another system."""
    path = tmp_path / "disc.msh"
    write_mesh(mesh(BOX, disc_over_plane(0.1), Resolution(1.0, 12, 1.0), 1), path, ["disc"])
    check_mesh_file(own(path))
    names(path, ("disc", *WALLS))
    path.write_bytes(path.read_bytes().replace(b"\n", b"\r\n"))
    check_mesh_file(own(path))


def test_names_that_are_missing_are_told(tmp_path: Path) -> None:
    path = names(tmp_path / "own.msh", ("disc", *WALLS))
    half = {"shape": "half-plane", "radius": 100.0, "mesh": str(path)}
    with pytest.raises(InputError, match=r"own\.msh: has no physical curve named plane; it has disc, left,"):
        check_mesh_file(own(path, domain=half))
    names(path, ("fluid", *WALLS))
    with pytest.raises(InputError, match="has no physical curve named disc; it has fluid, left,"):
        check_mesh_file(own(path))


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"solid", "cannot be read; give a .msh file written by gmsh"),
        (b"$MeshFormat\n4.1 0 8\n$EndMeshFormat\n", "cannot be read; give a .msh file written by gmsh"),
        (b"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n", "cannot be read; give a .msh file written by gmsh"),
        (LINE, "has no physical curve named disc; it has none"),
    ],
)
def test_files_without_names(content: bytes, words: str, tmp_path: Path) -> None:
    """`fsi check`, which knows names alone, and whoever reads the cells say the same."""
    path = tmp_path / "own.msh"
    path.write_bytes(content)
    case = own(path)
    with pytest.raises(InputError, match=rf"^domain\.mesh = .*own\.msh: {words}$") as checked:
        check_mesh_file(case)
    with pytest.raises(MeshFileError) as read:
        CaseMeshes(case).mesh(case.configuration(), 0.0)
    assert str(read.value) == str(checked.value)


def test_bodies_that_move_are_refused_only_if_there_is_a_time(tmp_path: Path) -> None:
    path = names(tmp_path / "own.msh", ("disc", *WALLS))
    falling = [DISC | {"velocity": [0.0, "free"]}]
    check_mesh_file(own(path, bodies=falling))
    check_mesh_file(own(path, time={"end": 1.0}))
    with pytest.raises(InputError, match=r"serves bodies where they stand, and bodies\.0\.velocity\.1 lets"):
        check_mesh_file(own(path, bodies=falling, time={"end": 1.0}))


def test_the_command_says_so(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    path = names(tmp_path / "own.msh", WALLS)
    saved_data(changed("time", None) | {"domain": box_with(path)}, tmp_path / "case.toml")
    said = complaint(capsys, monkeypatch, "check", str(tmp_path / "case.toml"))
    assert "has no physical curve named disc; it has left" in said
