"""How many cells a mesh will have, before it is made: the laws of sizes, integrated.

Cells grow away from a surface, h + g x at the height x, up to the height X where those of the opposite one
begin. With triangles of area sqrt(3)/4 h^2, and surfaces of radius a, which the layers above them exceed by
1 + x/a, a piece ds of a surface has

    dN = ds int_0^X (1 + x/a) / (sqrt(3)/4 (h + g x)^2) dx

of them above it, and in space a piece dA, with tetrahedra of volume sqrt(2)/12 h^3,

    dN = dA int_0^X (1 + x/a)^2 / (sqrt(2)/12 (h + g x)^3) dx.

On a lone body h is h_body, and X half the distance between neighbours. In a gap, d(s) = d + s^2/(2 R) wide
with 1/R = 1/a + 1/b, h is h_gap(d(s)) and X is d(s)/2.
"""

from dataclasses import dataclass

import numpy as np

from fsi.arrays import Array
from fsi.meshes.geometry.container import Container
from fsi.meshes.resolution import SHORTEST, Resolution

_PLACES = 96  # of an integral along a gap or away from a surface
_FROM = 1e-3  # of the first of them, over the smallest length
_GROWTH = 1.5  # of sizes in the plane over that along walls: between 1 and 2 (`fsi.meshes.build.SLOPE`)
_AREA, _VOLUME = np.sqrt(3.0) / 4.0, np.sqrt(2.0) / 12.0
_TETRAHEDRA = 4.0  # above a triangle between the surfaces of a gap: a prism or two of three


@dataclass(frozen=True, slots=True)
class Narrows:
    """Gaps between surfaces: the width d, radius a of the smaller body, relative curvature 1/R, each (G,)."""

    width: Array
    radius: Array
    curvature: Array

    def profile(self) -> tuple[Array, Array]:
        """Places s along a side of each gap, from its middle to where its body ends, and d(s), as columns."""
        d, a, k = (x[:, None] for x in (self.width, self.radius, self.curvature))
        first = np.minimum(_FROM * np.sqrt(d / np.maximum(k, 1.0 / (_PLACES * a))), _FROM * a)
        s = np.concatenate(
            [0.0 * a, first * (0.5 * np.pi * a / first) ** np.linspace(0.0, 1.0, _PLACES)], axis=1
        )
        return s, d + 0.5 * k * s**2


def cells_of(container: Container, radii: Array, narrows: Narrows, resolution: Resolution) -> float:
    """Some number of cells of the mesh of a container around bodies of these radii, (N,), with these gaps."""
    with np.errstate(all="ignore"):  # the number may be endless
        around = _around(container, radii, resolution)
        if container.dimension == 3:
            return around + _in_gaps_in_space(narrows, resolution)
        return around + _in_gaps(container, narrows, resolution)


def _around(container: Container, radii: Array, resolution: Resolution) -> float:
    """Around bodies without regard to their gaps."""
    sphere = container.dimension == 3
    h = resolution.on_body(radii)[:, None]
    far = (container.volume / max(len(radii), 1)) ** (1.0 / container.dimension)
    x = np.concatenate([0.0 * h, _FROM * h * (far / (_FROM * h)) ** np.linspace(0.0, 1.0, _PLACES)], axis=1)
    a = radii[:, None]
    if sphere:
        size = np.minimum(h + resolution.growth * x, container.largest_element(resolution.cells_per_circle))
        density = 4.0 * np.pi * (a + x) ** 2 / (_VOLUME * size**3)
    else:
        g = min(_GROWTH * resolution.growth, 2.0 * SHORTEST / resolution.cells_per_gap)
        circle = np.pi if container.axisymmetric else 2.0 * np.pi
        density = circle * (a + x) / (_AREA * (h + g * x) ** 2)
    return float(np.trapezoid(density, x, axis=1).sum())


def _in_gaps(container: Container, narrows: Narrows, resolution: Resolution) -> float:
    """Above both sides of gaps in the plane, one half of each in the meridional plane."""
    s, d = narrows.profile()
    h = resolution.across(d, narrows.radius[:, None])
    g = min(_GROWTH * resolution.growth, SHORTEST / resolution.cells_per_gap)  # sizes grow no faster along it
    above = 0.5 / h + 0.5 * d / (_AREA * h * (h + 0.5 * g * d))
    narrow = h < resolution.on_body(narrows.radius)[:, None]
    halves = 2.0 if container.axisymmetric else 4.0
    return float(halves * np.trapezoid(np.where(narrow, above, 0.0), s, axis=1).sum())


def _in_gaps_in_space(narrows: Narrows, resolution: Resolution) -> float:
    s, d = narrows.profile()
    from fsi.meshes.spatial.sizing import in_gap

    h = in_gap(d, narrows.radius[:, None], resolution)
    narrow = h < resolution.on_body(narrows.radius)[:, None]
    triangles = np.where(narrow, 2.0 * np.pi * s / (_AREA * h**2), 0.0)
    return float(_TETRAHEDRA * np.trapezoid(triangles * np.maximum(1.0, d / h), s, axis=1).sum())
