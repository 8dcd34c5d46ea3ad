"""How fast does the dissipation grow as the gaps of a suspension close: like delta^(-3/2) or delta^(-5/2)?

    python docs/examples/dissipation_blow_up.py [dissipation_blow_up.png]

Discs of radius 1 that squeeze the fluid out of their gaps dissipate like delta^(-3/2); the dissipation blows
up like delta^(-5/2) where the flow is forced through necks (Berlyand, Gorb, Novikov 2009, Arch. Ration. Mech.
Anal. 193:585: "anomalous", as only the plane has it). Pores show both in square and hexagonal arrays, down to
gaps of 1e-8. With films h = delta + x^2, lubrication gives for each neck of normal n

    squeezed at speed w:   (3 pi / 2) w^2 delta^(-3/2),      w = d n.E.n,
    with a flux Q:         (9 pi / 2) Q^2 delta^(-5/2),      12 int dx / h^3 = (9 pi / 2) delta^(-5/2),

d -> 2 the distance of centres. So the viscosity in extension E = diag(1/2, -1/2), where 2 E : E = 1, goes to
3 pi / 4 and 3 sqrt3 pi / 8 times delta^(-3/2), and the drag at speed 1, where Q is d times the component of n
across it in the frame of the discs, to 18 pi and 27 pi times delta^(-5/2).
"""

import sys
from pathlib import Path

import numpy as np

from fsi.arrays import Array
from fsi.bodies.configuration import Configuration, Motion
from fsi.meshes.geometry.cell import Cell
from fsi.pores.solve import PoreLoading, solve_pores
from fsi.pores.surfaces import surfaces_of
from fsi.pores.system import PoreSystem
from fsi.postprocess.plots.figure import COLOURS, GREY, saved_figure

GAPS = 10.0 ** -np.arange(1.0, 9.0)
LATTICES = {"square": np.eye(2), "hexagonal": np.array([[1.0, 0.0], [0.5, 0.75**0.5]])}
RATES = {"viscosity": -1.5, "drag": -2.5}
LIMITS = {
    ("square", "viscosity"): 0.75 * np.pi,
    ("hexagonal", "viscosity"): 0.375 * np.sqrt(3.0) * np.pi,
    ("square", "drag"): 18.0 * np.pi,
    ("hexagonal", "drag"): 27.0 * np.pi,
}


def dissipation(lattice: str, what: str, gap: float) -> float:
    """Of extension in a unit of area with the disc free, or of the disc towed along x with no mean flow."""
    towed, one = what == "drag", Configuration.unturned(np.zeros((1, 2)), np.ones(1))
    G = np.zeros((2, 2)) if towed else np.diag([0.5, -0.5])
    vectors = (2.0 + gap) * LATTICES[lattice]
    (a, b), (c, d) = vectors.tolist()
    cell = Cell(((a, b), (c, d)), ((G[0, 0], 0.0), (0.0, G[1, 1])))
    motion = Motion(np.full((1, 3), towed), np.array([[float(towed), 0.0, 0.0]]), np.zeros((1, 3)))
    system = PoreSystem.make(surfaces_of(one, cell), modes=2, viscosity=1.0)
    flow = solve_pores(system, PoreLoading(motion, np.zeros((0, 3)), G))
    return flow.dissipation / (1.0 if towed else cell.volume)


def table() -> dict[tuple[str, str], Array]:
    """Of each array and flow the dissipation at all gaps."""
    return {key: np.array([dissipation(*key, gap) for gap in GAPS]) for key in LIMITS}


def draw(found: dict[tuple[str, str], Array], path: Path) -> None:
    """The dissipation against the gap, on the leading terms."""
    with saved_figure(path, (6.4, 4.4)) as figure:
        axes = figure.add_subplot(xlabel="gap over radius", ylabel="dissipation, mu = 1")
        for colour, marker, ((lattice, what), values) in zip(COLOURS, "sxsx", found.items(), strict=False):
            axes.loglog(GAPS, LIMITS[lattice, what] * GAPS ** RATES[what], color=GREY, lw=4, alpha=0.4)
            axes.loglog(GAPS, values, marker, color=colour, ms=5, label=f"{what}, {lattice} array")
        axes.legend()


def main(picture: Path) -> None:
    """Print the table and draw it."""
    found = table()
    for (lattice, what), values in found.items():
        exponents = np.diff(np.log(values)) / np.diff(np.log(GAPS))
        ratio = values / (LIMITS[lattice, what] * GAPS ** RATES[what])
        print(f"{lattice} array, {what}: exponents {exponents[0]:.3f} ... {exponents[-1]:.6f},")
        print("    over the leading term", *(f"{r:.6f}" for r in ratio))
        assert abs(exponents[-1] - RATES[what]) < 1e-5
        assert abs(ratio[-1] - 1.0) < 1e-5
    draw(found, picture)


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "dissipation_blow_up.png"))
