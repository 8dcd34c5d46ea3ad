"""CPU seconds of one gluey step of a crowd that has just been pressed together, by its size.

    python bench/gluey.py [agitated|squeezed] 1000 10000

Discs of radii 0.497 to 0.5 on a triangular lattice beside two walls: "agitated", with random velocities
and gravity, or "squeezed" into the corner so fast that an impulse must travel through all of them.
Printed: contacts that carry an impulse, iterations, KKT residual, overlap, CPU seconds.
"""

from __future__ import annotations

import sys
from time import process_time

import numpy as np

from fsi.gluey.contacts import Room
from fsi.gluey.step import advance
from fsi.gluey.system import GlueyState, Law, System

H = 0.01


def crowd(n: int, how: str) -> tuple[System, GlueyState]:
    """About n discs that nearly touch."""
    side = round(np.sqrt(n))
    random = np.random.default_rng(0)
    places = np.stack(np.meshgrid(np.arange(side), np.arange(side), indexing="ij"), -1).reshape(-1, 2)
    shift = np.column_stack([0.5 * (places[:, 1] % 2), np.zeros(len(places))])
    q = (places + shift) * np.array([1.0, np.sqrt(0.75)]) + 0.51
    radii = random.uniform(0.497, 0.5, len(q))
    m = np.pi * radii**2
    mass = np.column_stack([m, m, 0.5 * m * radii**2])
    room = Room(np.zeros((2, 2)), np.eye(2), np.zeros(2))

    def impulse(t0: float, t1: float) -> np.ndarray:
        return (t1 - t0) * m[:, None] * np.array([-0.5, -1.0, 0.0])

    U = np.zeros((len(q), 3))
    agitation = random.normal(size=(len(q), 2))
    U[:, :2] = agitation if how == "agitated" else -0.3 * q + 0.1 * agitation
    return System(radii, mass, room, impulse, Law()), GlueyState.at(q, U)


how, *counts = sys.argv[1:] or ("agitated", "1000", "10000")
for count in map(int, counts):
    system, state = crowd(count, how)
    for step in range(3):
        began = process_time()
        state, touching, checks = advance(system, state, step * H, H)
        print(
            f"{len(system.radii):7d} discs, step {step}: {int((touching.p > 0).sum())} of {len(touching.p)} "
            "contacts, "
            f"{checks.iterations} iterations, {checks.newton} Newton steps, kkt {checks.kkt:.1e}, "
            f"overlap {checks.overlap:.1e}, {process_time() - began:.2f} s CPU",
            flush=True,
        )
