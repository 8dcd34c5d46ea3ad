"""Mesh files: what is written can be read by gmsh, by pyvista and by ourselves; what is wrong is refused."""

import errno
import os
from collections.abc import Callable
from pathlib import Path

import fsi.meshes.backend  # noqa: F401

import gmsh
import meshio
import numpy as np
import pytest
import pyvista
import ufl
from dolfinx import fem

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration
from fsi.case.load import parse_case
from fsi.meshes.build import FluidMesh
from fsi.meshes.errors import MeshFileError
from fsi.meshes.files.read import read_mesh
from fsi.meshes.files.write import write_mesh
from fsi.meshes.geometry.box import Box
from fsi.meshes.geometry.container import Container, FluidDomain
from fsi.meshes.geometry.round import HalfPlane
from fsi.meshes.planar.boundary import boundary
from fsi.meshes.planar.triangulate import gmsh_model
from fsi.meshes.resolution import Resolution
from fsi.stokes.meshes import CaseMeshes
from fsi.stokes.problem import SolverOptions, StokesProblem
from fsi.stokes.solve import solve
from tests.flows import BOX, SMALL_BOX, disc_over_plane, discs, held, mesh, resting

PAIR = discs([(-1.2, 0.1), (1.1, -0.2)], [1.0, 0.6])
NAMES = ("big", "small")
COARSE = Resolution(1.0, 24, 0.5)


def force(fluid: FluidMesh, container: Container, q: Configuration, motion: Array) -> Array:
    problem = StokesProblem(fluid, container, q, held(*motion), resting(container))
    return solve(problem, SolverOptions(max(2, fluid.order))).F


@pytest.mark.parametrize("order", [1, 2, 3, 4, 5, 6])
def test_msh_round_trip(order: int, tmp_path: Path) -> None:
    """The same force to rounding: the file keeps nodes and tags, cells only change their order."""
    motion = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.5]])
    written = mesh(SMALL_BOX, PAIR, COARSE, order)
    path = tmp_path / "pair.msh"
    write_mesh(written, path, NAMES)
    read = read_mesh(path, NAMES, FluidDomain(SMALL_BOX, PAIR.centres, PAIR.radii), max(order, 2))
    if order == 1:  # a straight mesh is curved on the way in, by the rule that `build` follows
        written = mesh(SMALL_BOX, PAIR, COARSE, 2)
    assert (read.order, read.cells(), read.container) == (max(order, 2), written.cells(), written.container)
    expected = force(written, SMALL_BOX, PAIR, motion)
    np.testing.assert_allclose(
        force(read, SMALL_BOX, PAIR, motion), expected, atol=1e-12 * np.abs(expected).max()
    )
    assert [p.name for p in tmp_path.iterdir()] == ["pair.msh"]


@pytest.mark.parametrize("degree", [2, 5])
def test_lines_have_the_fluid_on_their_left(degree: int, tmp_path: Path) -> None:
    """So that they go once around a body, clockwise; in narrow gaps some ran the other way."""
    egg = {"kind": "fourier", "radius": 1.0, "orders": [3], "cosines": [0.1]}
    ellipse = {"kind": "ellipse", "axes": [0.8, 0.85]}
    bodies = [
        {"name": "big", "shape": egg, "position": [-1.0, 0.2], "angle": 2.1},
        {"name": "small", "shape": ellipse, "position": [0.880542, -0.2], "angle": 1.8},
    ]
    data = {
        "name": "x", "fluid": {"viscosity": 1.0}, "discretisation": {"degree": degree}, "bodies": bodies,
        "domain": {"lower": [-4.0] * 2, "upper": [4.0] * 2},
    }  # fmt: skip
    case = parse_case(data)
    fluid = CaseMeshes(case).mesh(case.configuration(), 0.0)
    write_mesh(fluid, tmp_path / "pair.msh", NAMES)
    file = meshio.read(tmp_path / "pair.msh")
    (lines,) = (k for k, block in enumerate(file.cells) if block.type.startswith("line"))
    ends, tags = file.cells[lines].data[:, :2], file.cell_data["gmsh:physical"][lines]
    for tag, outline in enumerate(case.configuration().outlines, 1):
        a, b = file.points[ends[tags == tag].T]
        np.testing.assert_allclose((b - a).sum(axis=0), 0.0, atol=1e-12)
        area = 0.5 * (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum()
        assert area == pytest.approx(-outline.area, rel=0.02)  # of the polygon of the ends


@pytest.mark.parametrize("order", [2, 3, 4, 5, 6])
def test_gmsh_reads_the_same_cells(order: int, tmp_path: Path) -> None:
    """gmsh itself finds valid cells (a wrong order of nodes folds them) and the physical groups."""
    fluid = mesh(SMALL_BOX, PAIR, COARSE, order)
    write_mesh(fluid, tmp_path / "pair.msh", NAMES)
    with gmsh_model():
        gmsh.merge(str(tmp_path / "pair.msh"))
        groups = {gmsh.model.getPhysicalName(*group): group[0] for group in gmsh.model.getPhysicalGroups()}
        cells = gmsh.model.mesh.getElementsByType({2: 9, 3: 21, 4: 23, 5: 25, 6: 42}[order])[0]
        quality = np.array(gmsh.model.mesh.getElementQualities(cells, "minSJ"))
        sides = gmsh.model.mesh.getElementsByType({2: 8, 3: 26, 4: 27, 5: 28, 6: 62}[order])[0]
    assert groups == dict.fromkeys((*NAMES, *fluid.container.walls), 1) | {"fluid": 2}
    assert len(cells) == fluid.cells()
    assert len(sides) == len(fluid.facet_tags.indices)
    assert quality.min() > 0.3


@pytest.mark.parametrize("order", [1, 2, 3, 4, 5, 6])
def test_vtu_has_curved_cells(order: int, tmp_path: Path) -> None:
    """pyvista's pieces of the cells have the area, up to 0.003; straight cells are 0.046 off."""
    fluid = mesh(SMALL_BOX, PAIR, COARSE, order)
    write_mesh(fluid, tmp_path / "pair.vtu", NAMES)
    read = pyvista.read(tmp_path / "pair.vtu")
    triangle, curve = pyvista.CellType.LAGRANGE_TRIANGLE, pyvista.CellType.LAGRANGE_CURVE
    assert set(read.celltypes) == {triangle, curve}
    assert set(read.cell_data["tag"][read.celltypes == curve]) == {1, 2, 3, 4, 5, 6}
    drawn = read.tessellate(max_n_subdivide=4).compute_cell_sizes().cell_data["Area"].sum()
    assert abs(drawn - (24.0 - 1.36 * np.pi)) < (0.05 if order == 1 else 0.004)


def straight_mesh(path: Path, change: Callable[[dict[str, list[int]]], None] | None = None) -> None:
    """`disc_over_plane(0.1)` in BOX by gmsh's own kernel, with named groups, which `change` may edit."""
    with gmsh_model():
        occ, field = gmsh.model.occ, gmsh.model.mesh.field
        box, disc = occ.addRectangle(-8.0, 0.0, 0.0, 16.0, 16.0), occ.addDisk(0.0, 1.1, 0.0, 1.0, 1.0)
        ((_, fluid),), _ = occ.cut([(2, box)], [(2, disc)])
        occ.synchronize()
        groups: dict[str, list[int]] = {}
        for _, tag in gmsh.model.getBoundary([(2, fluid)], oriented=False):
            x, y, _ = occ.getCenterOfMass(1, tag)
            near = {
                "left": x + 8.0,
                "right": 8.0 - x,
                "bottom": y,
                "top": 16.0 - y,
                "disc": np.hypot(x, y - 1.1),
            }
            groups.setdefault(min(near, key=lambda name: near[name]), []).append(tag)
        if change is not None:
            change(groups)
        for name, tags in groups.items():
            gmsh.model.addPhysicalGroup(1, tags, name=name)
        gmsh.model.addPhysicalGroup(2, [fluid], name="fluid")
        field.add("MathEval", 1)
        field.setString(1, "F", "0.05 + 0.12 * sqrt(x^2 + (y - 0.1)^2)")
        field.setAsBackgroundMesh(1)
        gmsh.option.setNumber("Mesh.MeshSizeExtendFromBoundary", 0)
        gmsh.model.mesh.generate(2)
        gmsh.option.setNumber("Mesh.MeshSizeExtendFromBoundary", 1)
        gmsh.write(str(path))


def read_disc(path: Path, gap: float = 0.1, container: Container = BOX, order: int = 3) -> FluidMesh:
    q = disc_over_plane(gap)
    return read_mesh(path, ["disc"], FluidDomain(container, q.centres, q.radii), order)


def test_a_straight_gmsh_mesh_is_curved(tmp_path: Path) -> None:
    """tests/reference/disc_in_box.json: 466.11048; on straight cells the force is 1 % off."""
    straight_mesh(tmp_path / "disc.msh")
    fluid = read_disc(tmp_path / "disc.msh")
    assert fluid.order == 3
    F = force(fluid, BOX, disc_over_plane(0.1), np.array([[0.0, -1.0, 0.0]]))
    assert -F[0, 1] == pytest.approx(466.11048, rel=1e-4)


def test_clockwise_triangles_are_turned(tmp_path: Path) -> None:
    """A surface may look either way in gmsh."""
    written = mesh(SMALL_BOX, PAIR, COARSE, 3)
    write_mesh(written, tmp_path / "pair.msh", NAMES)
    file = meshio.gmsh.read(tmp_path / "pair.msh")
    cells = next(block for block in file.cells if block.type == "triangle10")
    cells.data = cells.data[:, [0, 2, 1, 8, 7, 6, 5, 4, 3, 9]]
    meshio.write(tmp_path / "turned.msh", file, file_format="gmsh22")
    turned = read_mesh(tmp_path / "turned.msh", NAMES, FluidDomain(SMALL_BOX, PAIR.centres, PAIR.radii), 3)
    assert turned.quality == pytest.approx(written.quality, rel=1e-9)


def test_the_far_arc_of_a_half_plane_is_curved(tmp_path: Path) -> None:
    """Order 3 on a straight mesh of a half disc gives its area, 2 % more than the straight cells have."""
    q, half = disc_over_plane(0.5), HalfPlane(6.0)
    write_mesh(mesh(half, q, COARSE, 1), tmp_path / "half.msh", ["disc"])
    fluid = read_mesh(tmp_path / "half.msh", ["disc"], FluidDomain(half, q.centres, q.radii), 3)
    one = fem.Constant(fluid.mesh, 1.0)
    area = fem.assemble_scalar(fem.form(one * ufl.dx(fluid.mesh)))
    assert area == pytest.approx(17.0 * np.pi, rel=1e-6)


def refused(path: Path, *, gap: float = 0.1, container: Container = BOX) -> str:
    """The line that says what is wrong."""
    with pytest.raises(MeshFileError) as caught:
        read_disc(path, gap, container)
    message = str(caught.value)
    assert message.startswith(f"domain.mesh = {path}: ")
    assert "\n" not in message
    return message


def test_groups_that_do_not_fit_the_case_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "disc.msh"

    def renamed(groups: dict[str, list[int]]) -> None:
        groups["ball"] = groups.pop("disc")

    def without_top(groups: dict[str, list[int]]) -> None:
        groups["disc"] += groups.pop("top")

    straight_mesh(path, renamed)
    assert "has no physical curve named disc; it has" in refused(path)
    straight_mesh(path, without_top)
    assert "has no physical curve named top" in refused(path)
    straight_mesh(path)
    assert "disc lies up to 0.1 off its place" in refused(path, gap=0.2)
    assert "top lies up to 1 off its place" in refused(path, container=Box((-8.0, 0.0), (8.0, 15.0)))


def test_an_untagged_boundary_is_refused(tmp_path: Path) -> None:
    """A second hole that is in no group."""
    two = discs([(0.0, 1.1), (3.0, 3.0)], [1.0, 0.5])
    write_mesh(mesh(BOX, two, COARSE, 1), tmp_path / "two.msh", ["disc", "other"])
    hole = len(boundary(FluidDomain(BOX, two.centres, two.radii), COARSE)[1].nodes)
    assert f"{hole} boundary edges are in no group" in refused(tmp_path / "two.msh")


@pytest.mark.parametrize(
    "content", [b"", b"solid\n", bytes(range(256)), b"$MeshFormat\n9.9 0 8\n$EndMeshFormat\n", None]
)
def test_a_damaged_file_is_refused_in_silence(
    content: bytes | None, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    """meshio prints and leaves the program on some of these."""
    path = tmp_path / "broken.msh"
    if content is None:  # a file cut short
        write_mesh(mesh(SMALL_BOX, PAIR, COARSE, 1), path, NAMES)
        content = path.read_bytes()[:-3000]
    path.write_bytes(content)
    assert "cannot be read; give a .msh file written by gmsh" in refused(path)
    assert capfd.readouterr() == ("", "")


def test_a_mesh_without_triangles_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "lines.msh"
    nodes, edge = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]), np.array([[0, 1]])
    tags = {"gmsh:physical": [np.array([1])], "gmsh:geometrical": [np.array([1])]}
    names = {name: np.array([k, 1]) for k, name in enumerate(("disc", *BOX.walls), 1)}
    lines = meshio.Mesh(nodes, [("line", edge)], cell_data=tags, field_data=names)
    meshio.write(path, lines, file_format="gmsh22")
    assert "has no triangles; make the fluid a physical surface, of one order, 1 to 6" in refused(path)
    corners = meshio.CellBlock("triangle", np.array([[0, 1, 1]]))
    lines.cells.append(corners)
    lines.cell_data = {key: [np.array([1])] * 2 for key in tags}
    meshio.write(path, lines, file_format="gmsh22")
    assert "has no edges in the physical curve left; put those of left there" in refused(path)
    lines.cells.append(meshio.CellBlock("triangle6", np.array([[0, 1, 1, 0, 1, 0]])))
    lines.cell_data = {key: [np.array([1])] * 3 for key in tags}
    meshio.write(path, lines, file_format="gmsh22")
    assert "has triangles of several orders; make the fluid a physical surface, of one" in refused(path)


@pytest.mark.parametrize("name", ["pair.unknown", "pair", "pair.stl"])
def test_unknown_suffixes_are_refused(name: str, tmp_path: Path) -> None:
    with pytest.raises(MeshFileError, match=r"unknown suffix .*; give \.msh or \.vtu"):
        write_mesh(mesh(SMALL_BOX, PAIR, COARSE, 2), tmp_path / name, NAMES)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("name", "refusal", "words"),
    [
        ("pair.vtu", OSError(errno.ENOSPC, os.strerror(errno.ENOSPC)), "No space left on device"),
        (
            "pair.msh",
            OSError("30 requested and 0 written"),
            r"takes a part of it only \(30 requested",
        ),  # NumPy
    ],
)
def test_a_full_disk_leaves_nothing(
    name: str, refusal: OSError, words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And what was there before stays."""

    def write(path: Path, *_: object, **__: object) -> None:
        path.write_bytes(b"a part")
        raise refusal

    (tmp_path / name).write_bytes(b"of before")
    monkeypatch.setattr(meshio, "write", write)
    with pytest.raises(MeshFileError, match=words):
        write_mesh(mesh(SMALL_BOX, PAIR, COARSE, 1), tmp_path / name, NAMES)
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == {name: b"of before"}


def test_a_folder_that_is_not_there_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "nowhere" / "pair.msh"
    with pytest.raises(MeshFileError, match=f"output = {path}: No such file or directory"):
        write_mesh(mesh(SMALL_BOX, PAIR, COARSE, 2), path, NAMES)
