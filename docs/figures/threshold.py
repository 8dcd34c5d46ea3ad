"""How smooth must a surface be so that it never meets another? Tips |x|^(1 + alpha) that settle onto a plane.

    python docs/figures/threshold.py runs/threshold threshold.png

Discs that end in such a tip are pushed towards a plane by the force 1, from a gap of 1 to 1e-6
(`cases/shapes/settling_tip.toml`); runs that are there already are taken as they are. In lubrication

    -q' = q^m / C,    m = 3 alpha / (1 + alpha),    C = 24 / (1 + alpha) B(b, 3 - b),    b = 3 / (1 + alpha),

so that there is contact in finite time if and only if alpha < 1/2 (D. Gerard-Varet and M. Hillairet, Arch.
Rational Mech. Anal. 195 (2010) 375). Printed are exponent and time of contact that follow from each run, with
their errors. Drawn are the gaps over time, and over the time that is left to contact.
"""

import sys
from pathlib import Path

import numpy as np
from scipy.special import beta

import fsi
from fsi.case.shapes.tip import Tip
from fsi.integration.contact import ContactTime, contact_time
from fsi.models import make_model
from fsi.postprocess.plots.figure import BLUE, GREEN, GREY, ORANGE, saved_figure

CASE = Path(__file__).parents[2] / "cases" / "shapes" / "settling_tip.toml"
NARROWEST = 1e-6
ENDS = {1.0: 1e5, 1.0 / 2.0: 1e3, 1.0 / 3.0: 200.0, 1.0 / 4.0: 200.0}  # of time, later than the last gap
NAMES = dict(zip(ENDS, ("1", "1/2", "1/3", "1/4"), strict=True))
COLOURS = dict(zip(ENDS, (GREY, GREEN, BLUE, ORANGE), strict=True))
DASHES = dict(zip(ENDS, (":", "-.", "-", "--"), strict=True))
MARKERS = dict(zip(ENDS, "xv.s", strict=True))


def above(alpha: float, gap: float) -> list[str]:
    """The tip at that gap, as changes of the case."""
    # It stands at the origin of its formula.
    height = gap + float(Tip(kind="tip", radius=1.0, alpha=alpha, length=1.0).outline.shift[1])
    return [f"bodies.0.shape.alpha={alpha!r}", f"bodies.0.position=[0.0, {height!r}]"]


def speed(alpha: float, gap: float) -> float:
    """With which it settles there."""
    case = fsi.load_case(CASE, above(alpha, 1.0))
    q = case.configuration().moved(np.array([[0.0, gap - 1.0, 0.0]]))
    return -float(make_model(case)(q, 0.0).U[0, 1])


def settled(alpha: float, folder: Path) -> tuple[np.ndarray, np.ndarray]:
    """Times and gaps of the run of a tip."""
    if not folder.exists():
        changes = above(alpha, 1.0)
        changes += [f"time.end={ENDS[alpha]}", f"time.contact_gap={NARROWEST}", "time.tolerance=1e-5"]
        fsi.run(fsi.load_case(CASE, changes), folder)
    steps = fsi.open_run(folder).columns("steps")
    return steps["t"], steps["smallest_gap"]


def coefficient(alpha: float) -> float:
    """C of lubrication."""
    b = 3.0 / (1.0 + alpha)
    return float(24.0 / (1.0 + alpha) * beta(b, 3.0 - b))


def told(alpha: float, found: ContactTime) -> str:
    """A row of the table."""
    m = 3.0 * alpha / (1.0 + alpha)
    row = f"{NAMES[alpha]:>5s}  {m:.4f}  {found.exponent:.4f} ± {found.exponent_error:.4f}"
    if np.isinf(found.time) or np.isinf(found.error):
        return f"{row}  {'none' if np.isinf(found.time) else 'not decided':>16s}"
    return f"{row}  {found.time:7.3f} ± {found.error:.3f}"


def main(folder: Path, picture: Path) -> None:
    """Run what is not there yet, print the table and draw."""
    print("alpha  m       of the run        contact at t")
    with saved_figure(picture, (9.0, 4.2)) as figure:
        over_time, left = figure.subplots(1, 2, sharey=True)
        for alpha in ENDS:
            t, q = settled(alpha, folder / f"alpha_{NAMES[alpha].replace('/', '_')}")
            found = contact_time(t, q)
            assert found is not None, "the gap closes steadily"
            print(told(alpha, found), flush=True)
            line = {"color": COLOURS[alpha], "label": f"alpha = {NAMES[alpha]}"}
            over_time.plot(t, q, DASHES[alpha], **line)
            if np.isfinite(found.time + found.error):
                left.plot(found.time - t, q, MARKERS[alpha], ms=4, **line)
                power = 1.0 / (1.0 - 3.0 * alpha / (1.0 + alpha))
                s = np.geomspace((NARROWEST * 0.8) ** (1.0 / power), 1.0, 50)
                s *= coefficient(alpha) * power
                left.plot(s, (s / (coefficient(alpha) * power)) ** power, color=COLOURS[alpha], lw=0.8)
        over_time.set(yscale="log", xlim=(0.0, 250.0), xlabel="time", ylabel="gap")
        over_time.legend()
        left.set(xscale="log", xlabel="time that is left to contact; lines: lubrication alone")
        left.legend()


if __name__ == "__main__":
    main(*(Path(word) for word in sys.argv[1:3]))
