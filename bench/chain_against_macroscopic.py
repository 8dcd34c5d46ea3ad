"""From micro to macro: chains of N gluey spheres against the macroscopic model.

    python -m bench.chain_against_macroscopic [N ...]

Spheres of diameter and mass 1/N fill half of [-1, 1], with the velocity `u = x^2 - sin(pi x)` at time 0,
and no force; at t = 0.4 a part of them has been pressed together. Their places are compared with those
of the macroscopic model's parcels, of which there are so many more that their own error does not count.
"""

from __future__ import annotations

import sys

import numpy as np
from rich.table import Table

from fsi.arrays import Array
from fsi.case.gluey import ContactLaw
from fsi.gluey.contacts import Room
from fsi.gluey.film import SphereFilm
from fsi.gluey.step import advance
from fsi.gluey.system import GlueyState, System
from fsi.macroscopic.model import Parcels, blocks
from fsi.meshes.geometry.unbounded import Unbounded
from fsi.report.console import standard_output

END, FINE = 0.4, 6400


def start(n: int) -> Parcels:
    """n parcels as they begin."""
    parcels, _ = blocks([(-1.0, 1.0, 0.5)], n)
    return parcels.moving(parcels.X**2 - np.sin(np.pi * parcels.X))


def gluey_chain(parcels: Parcels) -> tuple[System, GlueyState]:
    """Spheres on a line of the parcels' masses, with diameters that fill it at density 1."""
    n = len(parcels.X)
    room = Room(np.empty((0, 1)), np.empty((0, 1)), Unbounded(dimension=1))
    mass, radii = np.full((n, 1), parcels.dm), np.full(n, 0.5 * parcels.dm)
    system = System(radii, mass, room, lambda _t0, _t1: np.zeros((n, 1)), ContactLaw(), SphereFilm)
    return system, GlueyState.at(parcels.X[:, None], parcels.u[:, None])


def chain_errors(n: int) -> tuple[float, float]:
    """The largest errors of a chain's places, and of its gamma (its mean over the masses), in 2 n steps."""
    fine, begin = start(FINE), start(n)
    for k in range(FINE):
        fine = fine.advance(_no_force, k * END / FINE, END / FINE)
    system, state = gluey_chain(begin)
    h = END / (2 * n)
    for k in range(2 * n):
        state, _, _ = advance(system, state, k * h, h)
    gamma = np.zeros(n + 1)
    gamma[1 + state.key // n] = state.gamma  # the key of neighbours i, i + 1 is i n + i + 1
    expected = np.interp(np.arange(n + 1) / n, np.arange(FINE + 1) / FINE, fine.gamma)
    in_X = np.abs(state.centres[:, 0] - np.interp(begin.m, fine.m, fine.X)).max()
    return float(in_X), float(np.abs(gamma - expected).mean())


def _no_force(x: Array, _m: Array, _t: float) -> Array:
    return np.zeros_like(x)


def main(arguments: list[str]) -> int:
    """Print the errors for the numbers of spheres that are given, or 25, 50, 100, 200, 400; the exit code."""
    if any(not text.isdecimal() or int(text) < 2 for text in arguments):
        print(f"{__doc__}\nGive numbers of spheres, at least 2, or none.", file=sys.stderr)
        return 2
    table = Table(title=f"chain of N gluey spheres against the macroscopic model, t = {END}")
    for heading in ("N", "largest error of a place", "mean error of gamma"):
        table.add_column(heading, justify="right")
    for n in map(int, arguments or ("25", "50", "100", "200", "400")):
        in_X, in_gamma = chain_errors(n)
        table.add_row(str(n), f"{in_X:.3e}", f"{in_gamma:.3e}")
    standard_output().print(table)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
