"""What bounds the pieces of a periodic domain: arcs, walls and links around each, whole bodies in it.

The two sides of a link on the cut get the same nodes, at places that differ by a vector of the lattice. So
the nodes of the two sides match, and each lies on the cut at most twice: where loops cross, there is a body.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from fsi.arrays import Array, Indices
from fsi.meshes.errors import TouchingError
from fsi.meshes.geometry.curves import segment
from fsi.meshes.planar.cut import cut
from fsi.meshes.planar.faces import Faces, HalfLinks
from fsi.meshes.planar.outlines import outline_arcs, outline_rings
from fsi.meshes.planar.rings import arcs, rings
from fsi.meshes.planar.sizing import INSIDE, Curve, Surfaces
from fsi.meshes.planar.strips import divided

LINK_PIECES = 16  # of a link, to begin with


def opened(surfaces: Surfaces) -> list[Curve]:
    """Whole bodies, then what bounds the pieces: arcs, walls, links. Raises MeshError where bodies touch."""
    links = cut(surfaces)
    if links.gap.min(initial=np.inf) <= 0.0:  # of outlines that has been found before
        nearest = int(links.gap.argmin())
        place = surfaces.centres[int(links.first[nearest])]
        raise TouchingError("the disc at {} touches a disc or wall, or overlaps it; move it", place)
    faces = Faces.of(HalfLinks(divided(links, surfaces), surfaces))
    on_links = {stretch.node for face in faces.faces for stretch in face}
    whole = [i for i in range(surfaces.bodies) if i not in on_links]
    shifts, pieces = faces.shifts(whole)
    around = outline_rings if surfaces.placed else rings
    holes = zip(around(surfaces, whole), shifts, pieces.tolist(), strict=True)
    return [_moved(hole, shift, piece) for hole, shift, piece in holes] + _outer(faces)


def _outer(faces: Faces) -> list[Curve]:
    """The links, then for each piece its arcs and walls, which begin and end exactly where links do."""
    of_halves, stretches = _link_curves(faces), _stretch_curves(faces)
    every = [of_halves[half] for half in of_halves if half < faces.halves.count or not faces.is_inside(half)]
    for face in faces.faces:
        for stretch, before in zip(face, [face[-1], *face[:-1]], strict=True):
            every.append(next(stretches))
            every[-1].nodes[0] = of_halves[before.half].nodes[-1]
            every[-1].nodes[-1] = of_halves[stretch.half].nodes[0]
    return every


def _link_curves(faces: Faces) -> dict[int, Curve]:
    """The nodes of each half; those inside have the same ones in both directions."""
    halves, curves = faces.halves, dict[int, Curve]()
    for link, away in enumerate(_on_links(halves)):
        back = halves.twin(link)
        curves[link], curves[back] = _half_curve(faces, link, away), _half_curve(faces, back, away[::-1])
        if faces.is_inside(link):
            both = replace(curves[link], tag=INSIDE, pieces=(faces.face_of[link], faces.face_of[back]))
            curves[link], curves[back] = both, replace(both, nodes=both.nodes[::-1])
    return curves


def _half_curve(faces: Faces, half: int, away: Array) -> Curve:
    """One side of a link on the cut, its nodes by how far they are away from a surface it joins."""
    halves, s = faces.halves, np.abs(away - away[0])
    begin, arm = faces.places[half] + halves.foot[half], halves.arms[halves.origin[half]]
    tag = halves.surfaces.bodies + len(halves.surfaces.container.walls) + 1
    nodes = begin + (arm + s)[:, None] * halves.along[half]
    return Curve(tag, nodes, pieces=(faces.face_of[half],))


def _stretch_curves(faces: Faces) -> Iterator[Curve]:
    """For each stretch of each piece its arc or part of a wall."""
    surfaces, every = faces.halves.surfaces, [stretch for face in faces.faces for stretch in face]
    on_bodies = [stretch for stretch in every if stretch.node < surfaces.bodies]
    on_walls = [stretch for stretch in every if stretch.node >= surfaces.bodies]
    angles = np.array([(stretch.end, stretch.start) for stretch in on_bodies]).reshape(-1, 2)
    of_bodies = outline_arcs if surfaces.placed else arcs
    around = iter(of_bodies(surfaces, [stretch.node for stretch in on_bodies], angles))
    segments = [segment(each.node - surfaces.bodies, each.centre, each.leaves) for each in on_walls]
    walls = iter(surfaces.walls(segments))
    for piece, face in enumerate(faces.faces):
        for stretch in face:
            if stretch.node < surfaces.bodies:
                shift = stretch.centre - surfaces.centres[stretch.node]
                yield _reversed(_moved(next(around), shift, piece))
            else:
                yield replace(next(walls), pieces=(piece,))


def _on_links(halves: HalfLinks) -> list[Array]:
    """Distances of the nodes of each link from the surface of its first node, from 0 to the gap."""
    links, surfaces = halves.links, halves.surfaces
    n, walls = surfaces.bodies, np.zeros((2, 2))  # where a link begins that has no body
    begin = np.vstack([surfaces.centres[:n], walls])[links.first] + links.feet[:, 0]
    arm = halves.arms[links.first]

    def at(s: Array, k: Indices) -> Array:
        x: Array = begin[k] + (arm[k] + s)[:, None] * links.along[k]
        return x

    return surfaces.lines(at, np.column_stack([np.zeros(len(links)), links.gap]), LINK_PIECES)


def _reversed(curve: Curve) -> Curve:
    opening, nodes = None if curve.opening is None else curve.opening[::-1], curve.nodes[::-1]
    return Curve(curve.tag, nodes, curve.closed, curve.centre, opening, curve.pieces, curve.body)


def _moved(curve: Curve, shift: Array, piece: int) -> Curve:
    """A curve of bodies elsewhere, which bounds that piece."""
    centre = None if curve.centre is None else curve.centre + shift
    body = None if curve.body is None else curve.body.moved(curve.body.centre + shift)
    # `replace` takes three times as long, of thousands of them.
    return Curve(curve.tag, curve.nodes + shift, curve.closed, centre, curve.opening, (piece,), body)
