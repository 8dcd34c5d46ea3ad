"""Who resists whom? The resistance matrix of three discs in a box, and Lorentz' reciprocity.

    python docs/examples/resistance_matrix.py [resistance_matrix.png]

F = R U, F the forces and torques that move the discs at the velocities and spins U. R is symmetric (Lorentz
1896) and positive definite, as it gives the dissipation U.R U; its inverse are the velocities under unit
loads. One factorisation serves all nine columns. `fsi resistance CASE -o R.npz` writes it with labels.
"""

import sys
from pathlib import Path

import numpy as np

import fsi
from fsi.postprocess.plots.figure import saved_figure

PLACES = {"one": [2.0, 2.0], "two": [4.1, 2.2], "three": [3.0, 4.6]}


def case(moving: str | None = None, axis: int = 0) -> fsi.Case:
    """The discs free, or all held but one that moves at unit speed along an axis."""
    bodies = [{"name": name, "radius": 1.0, "position": place} for name, place in PLACES.items()]
    if moving is not None:
        for body in bodies:
            velocity = np.eye(2)[axis] * (body["name"] == moving)
            body |= {"velocity": velocity.tolist(), "angular_velocity": 0.0}
    box = {"lower": [0.0, 0.0], "upper": [6.0, 7.0]}
    return fsi.make_case(name="three discs", fluid={"viscosity": 1.0}, domain=box, bodies=bodies)


def main(picture: Path) -> None:
    """Compute R, check what it must be, draw it."""
    R = fsi.solve(case()).resistance().R
    # Two flows, solved by themselves: one moves along x, and two along y.
    first, second = fsi.solve(case("one", 0)), fsi.solve(case("two", 1))
    there, back = -first["two"].force[1], -second["one"].force[0]
    eigenvalues = np.linalg.eigvalsh(R)
    print(f"force along y on two as one moves along x: {there:.9f}, the other way round {back:.9f}")
    print(f"in R {R[4, 0]:.9f}; its eigenvalues: {eigenvalues[0]:.1f} to {eigenvalues[-1]:.1f}")
    assert abs(there / back - 1.0) < 1e-9  # reciprocity holds for the discrete flow as well
    assert abs(R[4, 0] / there - 1.0) < 1e-9  # a column that belonged to another motion is off by one
    assert eigenvalues[0] > 0.0
    # The pair whose gap is narrowest resists approaching most: its forces are opposite.
    stiffest = np.linalg.eigh(R)[1][:, -1].reshape(3, 3)
    across = np.subtract(PLACES["two"], PLACES["one"])
    assert stiffest[0, :2] @ across * (stiffest[1, :2] @ across) < 0.0
    with saved_figure(picture, (6.5, 5.5)) as figure:
        axes = figure.add_subplot()
        shown = axes.imshow(R, cmap="PuOr_r", norm="symlog", vmin=-np.abs(R).max(), vmax=np.abs(R).max())
        labels = [f"{name}.{part}" for name in PLACES for part in ("x", "y", "turn")]
        axes.set_xticks(range(9), labels, rotation=60, ha="right")
        axes.set_yticks(range(9), labels)
        axes.grid(visible=False)
        figure.colorbar(shown, label="force or torque per unit velocity or spin")


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "resistance_matrix.png"))
