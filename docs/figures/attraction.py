"""What does attraction do to a sheared suspension? Thirty discs with it and without, to strain 3.

    fsi run cases/suspensions/attraction.toml
    fsi run cases/suspensions/attraction.toml --set 'forces=[]' -o runs/no_attraction
    python docs/figures/attraction.py runs/attraction runs/no_attraction attraction.png

Discs that attract each other are the interacting particles of A. Lefebvre and B. Maury, "Apparent viscosity
of a mixture of a Newtonian fluid and interacting particles", C. R. Mecanique 333 (2005). Drawn over strain
are the apparent viscosity, the number of discs in the largest cluster, of discs linked by gaps below a tenth
of a radius, and the parts of the viscosity that lubrication forces carry along these links and that the
attraction carries between all discs.
"""

import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np

from fsi.postprocess.analysis.chains import read_chains
from fsi.postprocess.analysis.links import NECKS
from fsi.postprocess.plots.figure import BLUE, GREEN, ORANGE, saved_figure
from fsi.postprocess.run.run import Run


class History(NamedTuple):
    """Of a run, at its steps and, of clusters, at its output times.

    Attributes:
        t, viscosity: the strain, as the rate of shear is one, and the apparent viscosity.
        at: the times of the clusters.
        largest: how many discs the largest has.
        clusters: how many there are.
        carried, attracted: by lubrication along their links and by attraction, of the apparent viscosity.
    """

    t: np.ndarray
    viscosity: np.ndarray
    at: np.ndarray
    largest: np.ndarray
    clusters: np.ndarray
    carried: np.ndarray
    attracted: np.ndarray


def history(folder: Path) -> History:
    """That of a run folder."""
    run = Run(folder)
    steps, rows = run.columns("steps"), []
    for step in run.times_of(NECKS).index:
        found = read_chains(run, int(step))
        largest = max((len(chain.bodies) for chain in found.chains), default=1)
        moment = run.case.interaction_moment(found.q, found.t)
        viscosity = steps["apparent_viscosity"][steps["step"] == step][0]  # mu and the rate of shear are one
        pull = (0.0 - moment[0, 1]) / run.case.container().volume / viscosity
        links = found.share(range(len(found.links.gaps)))
        rows.append((found.t, largest, len(found.chains), links, pull))
    return History(steps["t"], steps["apparent_viscosity"], *np.array(rows).T)


def draw(attracted: History, free: History, path: Path) -> None:
    """Both histories over each other."""
    with saved_figure(path, (7.0, 7.5)) as figure:
        viscosity, size, part = figure.subplots(3, 1, sharex=True)
        for one, colour, style, name in (
            (attracted, BLUE, "-", "with attraction"),
            (free, ORANGE, "--", "without"),
        ):
            viscosity.plot(one.t, one.viscosity, style, color=colour, label=name)
            size.plot(one.at, one.largest, style, color=colour, marker="o", ms=4)
            part.plot(one.at, one.carried, style, color=colour, marker="o", ms=4, label=f"links, {name}")
        part.plot(attracted.at, attracted.attracted, ":", color=GREEN, marker="s", ms=4, label="attraction")
        viscosity.set(ylabel="apparent viscosity")
        size.set(ylabel="discs in the largest cluster", ylim=(0.0, None))
        part.set(xlabel="strain", ylabel="of the viscosity")
        part.legend()
        viscosity.legend()


def main(attracted: Path, free: Path, path: Path) -> None:
    """Print what both are at some strains, and draw them."""
    found = {"with attraction": history(attracted), "without": history(free)}
    for name, one in found.items():
        print(f"{name}: apparent viscosity {one.viscosity.min():.3g} to {one.viscosity.max():.3g}")
        print("   t   clusters   largest   along them   by attraction")
        for t, largest, clusters, part, pulled in zip(*one[2:], strict=True):
            print(f"{t:4g} {clusters:10g} {largest:9g} {part:12.1%} {pulled:15.1%}")
    draw(*found.values(), path)


if __name__ == "__main__":
    main(*(Path(word) for word in sys.argv[1:4]))
