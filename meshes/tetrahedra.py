"""gmsh fills the fluid around spheres with tetrahedra."""

from __future__ import annotations

import gmsh
import numpy as np
from scipy.spatial import cKDTree

import meshes.backend  # noqa: F401
from meshes.curved import CurvedCells
from meshes.curved_tets import Sphere, curve_tets
from meshes.errors import MeshError
from meshes.geometry import Array, Box, Container, HalfPlane, Round, lengths
from meshes.sizing import Resolution
from meshes.triangulate import Indices, gmsh_model

LENGTH, SHORTEST, LONGEST = 0.3, 0.3, 4.0


class Size:
    def __init__(self, container, centres, radii, resolution):
        self.c, self.x, self.a, self.r = container, centres, radii, resolution
        self.h_body = 2*np.pi*radii/resolution.cells_per_circle

    def __call__(self, p):
        if len(self.a) == 0:
            return 0.1*self.c.size()
        d = np.sqrt(((p - self.x)**2).sum(axis=1)) - self.a
        far = float((self.h_body + self.r.growth*np.maximum(d, 0)).min())
        w = float(self.c.distances(p[None]).min())
        i = d.argmin(); b1 = d[i]; a = self.a[i]
        other = w
        if len(d) > 1:
            j = np.argpartition(d, 1)[1]
            if d[j] < w:
                other = d[j]; a = min(a, self.a[j])
        gap = max(b1 + other, 1e-12)
        h = min(max(min(LENGTH*np.sqrt(a*gap), LONGEST*gap), SHORTEST*gap)/self.r.cells_per_gap, far)
        return float(h)


def fill(container: Container, centres: Array, radii: Array, resolution: Resolution, order: int) -> CurvedCells:
    n = len(radii)
    spheres = {i + 1: Sphere(centres[i], float(radii[i])) for i in range(n)}
    if isinstance(container, (HalfPlane, Round)):
        spheres[n + len(container.walls)] = Sphere(np.zeros(3), container.radius)
    size = Size(container, centres, radii, resolution)
    with gmsh_model():
        occ = gmsh.model.occ
        match container:
            case Box(lower=lo, upper=up):
                outer = occ.addBox(*lo, *np.subtract(up, lo))
            case HalfPlane(radius=R):
                outer = occ.addSphere(0, 0, 0, R, angle1=0.0)
            case Round(radius=R):
                outer = occ.addSphere(0, 0, 0, R)
        out = [(3, outer)]
        if n:
            out, _ = occ.cut(out, [(3, occ.addSphere(*c, a)) for c, a in zip(centres, radii)])
        occ.synchronize()
        gmsh.option.setNumber("Mesh.MeshSizeExtendFromBoundary", 0)
        gmsh.option.setNumber("Mesh.MeshSizeFromPoints", 0)
        gmsh.option.setNumber("Mesh.Optimize", 1)
        gmsh.option.setNumber("Mesh.OptimizeNetgen", 1)
        gmsh.model.mesh.setSizeCallback(lambda dim, tag, x, y, z, lc: size(np.array([x, y, z])))
        gmsh.model.mesh.generate(3)
        gmsh.model.mesh.removeSizeCallback()
        gmsh.option.setNumber("Mesh.MeshSizeExtendFromBoundary", 1)
        gmsh.option.setNumber("Mesh.MeshSizeFromPoints", 1)
        gmsh.option.setNumber("Mesh.OptimizeNetgen", 0)
        ids, xyz, _ = gmsh.model.mesh.getNodes()
        o = np.argsort(ids)
        vertices = xyz.reshape(-1, 3)[o]
        tets = np.searchsorted(ids[o], gmsh.model.mesh.getElementsByType(4)[1]).astype(np.int64).reshape(-1, 4)
        tri = np.searchsorted(ids[o], gmsh.model.mesh.getElementsByType(2)[1]).astype(np.int64).reshape(-1, 3)
    used, tets = np.unique(tets, return_inverse=True)
    tets = tets.reshape(-1, 4)
    tri = np.searchsorted(used, tri)
    vertices = vertices[used]
    away = np.column_stack([*(np.abs(lengths(vertices - c) - a) for c, a in zip(centres, radii)), np.abs(container.distances(vertices))])
    tags = away[tri].max(axis=1).argmin(axis=1) + 1
    assert away[tri].max(axis=1).min(axis=1).max() < 1e-6*container.size()
    for tag, sphere in spheres.items():
        on = np.unique(tri[tags == tag]); vertices[on] = sphere.project(vertices[on])
    a, b, c, d = (vertices[tets[:, k]] for k in range(4))
    flip = np.einsum("td,td->t", np.cross(b - a, c - a), d - a) < 0
    tets[flip] = tets[flip][:, [0, 2, 1, 3]]
    return curve_tets(vertices, tets, tri, tags, spheres, order)
