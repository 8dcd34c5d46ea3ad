"""A report of a run: one HTML file with everything in it, which opens from disk without a network.

`report.html.jinja` is the page; here is what it shows. What cannot be made is replaced by the reason, a line.
"""

from __future__ import annotations

import base64
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from jinja2 import Environment, PackageLoader, StrictUndefined

from fsi.errors import InputError
from fsi.observables.truncation import BOUND, IDENTITIES
from fsi.postprocess.plots.histories import plot_runs
from fsi.postprocess.render.picture import MOVIES, write_pictures
from fsi.postprocess.render.render import artist, render_run
from fsi.postprocess.render.view import Choice
from fsi.postprocess.run.run import Run
from fsi.reduced.identities import BOUND as REDUCED_BOUND
from fsi.run_folder.checkpoint import replace
from fsi.run_folder.folder import CASE

_ROWS = 15  # of the table of steps
_MANY = 20  # bodies, more than which are not listed in the open
_FRAMES, _FRAME_SIZE, _PICTURE_SIZE = 30, 320, 700
# By model: columns of steps.csv, what they say, and the bound of each, which the models enforce.
_IDENTITIES: dict[str, tuple[dict[str, str], float]] = {
    "resolved": (IDENTITIES, BOUND),
    "reduced": (
        IDENTITIES
        | {
            "kernel": "rigid motions of clusters change no gap",
            "invariant": "the first integral of each gap is kept",
            "energy": "the energy inequality",
        },
        REDUCED_BOUND,
    ),
    "gluey": (
        {"kkt": "velocities and impulses are optimal", "momentum_defect": "impulses act and react"},
        BOUND,
    ),
    "macroscopic": ({}, BOUND),
}


@dataclass(frozen=True)
class PageTable:
    """A table of the page.

    Attributes:
        heads: of the columns; without any, the first column says what a row is.
        rows: words go to the left, numbers to the right.
    """

    heads: list[str]
    rows: list[list[Any]]

    @classmethod
    def of(cls, frame: pd.DataFrame) -> PageTable:
        """All of a frame."""
        return cls([*map(str, frame)], frame.astype(object).to_numpy().tolist())


def write_report(run: Run, output: Path) -> None:
    """Write the report of a run, finished or not; what cannot be drawn is said in it.

    Raises:
        InputError: not a .html file, or it cannot be written.
    """
    if output.suffix != ".html" or not output.absolute().parent.is_dir():
        raise InputError(f"output = {output}: give the path of a .html file in a folder that exists")
    templates = Environment(
        loader=PackageLoader("fsi.postprocess", "."), autoescape=True, undefined=StrictUndefined
    )
    page = templates.get_template("report.html.jinja").render(
        name=run.name,
        path=run.path,
        many=_MANY,
        state=_or_reason(lambda: _state(run)),
        case=_case(run),
        pictures=_pictures(run),
        checks=_or_reason(lambda: _checks(run)),
        bodies=_or_reason(
            lambda: PageTable.of(run.bodies[run.bodies["step"] == run.bodies["step"].iloc[-1]])
        ),
        steps=_or_reason(lambda: _steps(run.steps)),
        launches=_or_reason(lambda: _launches(run)),
    )
    try:
        replace(output, page.encode())
    except OSError as error:
        raise InputError(f"output = {output}: {error.strerror}; give another path") from None


def _or_reason[Part](part: Callable[[], Part]) -> Part | str:
    """A part of the page, or why it is missing."""
    try:
        return part()
    except InputError as error:
        return str(error)


def _state(run: Run) -> dict[str, Any]:
    """Whether the run has come to its end."""
    steps = run.steps
    smallest = steps.loc[steps["smallest_gap"].idxmin()]
    return {
        "steps": len(steps) - 1,
        "end": run.end,
        "asked": run.asked,
        "finished": run.finished,
        "gap": smallest["smallest_gap"],
        "at": smallest["t"],
        "cpu": steps["cpu_step"].sum() if "cpu_step" in steps else 0.0,
    }


def _case(run: Run) -> dict[str, Any]:
    """The bodies and the whole case."""
    about, rows = f"{run.model} model", []
    if run.has_flow:
        case = run.case
        walls = ", ".join(case.domain.walls) or "none"
        about += f", {case.geometry}, viscosity {case.fluid.viscosity:g}, walls: {walls}"
        rows = [[body.name, body.radius, ", ".join(f"{x:g}" for x in body.position)] for body in case.bodies]
    text = (run.path / CASE).read_text(encoding="utf-8")
    return {"about": about, "bodies": PageTable(["body", "radius", "start"], rows), "text": text}


def _pictures(run: Run) -> list[dict[str, str] | str]:
    """Histories, the last step, of a flow its dissipation too, and all steps as an animation."""
    what = {"fluid": "speed, streamlines, and the narrowest gap", "bodies": "bodies", "profile": "profiles"}
    last = {f"{what[run.series]} at the last step": Choice(size=_PICTURE_SIZE)}
    if run.series == "fluid":
        last["dissipation at the last step"] = Choice("dissipation", size=_PICTURE_SIZE)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "picture.png"
        parts = {"histories": partial(_histories, run, file)}
        parts |= {caption: partial(render_run, run, file, choice) for caption, choice in last.items()}
        parts["all of the run"] = partial(_animation, run, Path(folder) / f"all{MOVIES[1]}")
        return [_or_reason(partial(_embedded, caption, draw)) for caption, draw in parts.items()]


def _embedded(caption: str, draw: Callable[[], Path]) -> dict[str, str]:
    """A picture, to stand in the page itself."""
    path = draw()
    data = base64.b64encode(path.read_bytes()).decode()
    return {"caption": caption, "kind": path.suffix.removeprefix("."), "data": data}


def _histories(run: Run, path: Path) -> Path:
    """Of gaps, speeds and so on."""
    plot_runs([run], path)
    return path


def _animation(run: Run, path: Path) -> Path:
    """At most thirty steps, evenly spread; of a flow its speed."""
    painter = artist(run, Choice("speed" if run.series == "fluid" else None, size=_FRAME_SIZE))
    painter.require(run.step(None, painter.series))
    steps = run.times_of(painter.series).index.to_numpy()
    shown = steps[np.unique(np.linspace(0, len(steps) - 1, _FRAMES).astype(int))].tolist()
    write_pictures(painter.pictures(shown), path)
    return path


def _checks(run: Run) -> PageTable:
    """The worst defect of each identity over the whole run, and the smallest gap."""
    steps, rows = run.steps, []
    identities, bound = _IDENTITIES[run.model]
    for name in (name for name in identities if name in steps):
        worst = steps[name].abs().idxmax()
        defect, t = abs(float(steps[name][worst])), steps["t"][worst]
        verdict = "holds" if defect <= bound else "VIOLATED"
        rows.append([name, identities[name], f"{defect:.1e}", f"{t:g}", f"{bound:g}", verdict])
    if run.has_flow:
        least = steps.loc[steps["smallest_gap"].idxmin()]
        verdict = "holds" if least["smallest_gap"] > 0.0 else "VIOLATED"
        gap, t = f"{least['smallest_gap']:.4g}", f"{least['t']:g}"
        rows.append(["gap", "bodies do not overlap", gap, t, "> 0", verdict])
    return PageTable(["check", "what it says", "worst", "at t", "bound", ""], rows)


def _steps(steps: pd.DataFrame) -> PageTable:
    """Some of the steps, evenly spread."""
    columns = [name for name in steps if not name.startswith("cpu_") and name not in IDENTITIES]
    chosen = np.unique(np.linspace(0, len(steps) - 1, _ROWS).astype(int))
    return PageTable.of(steps[columns].iloc[chosen])


def _launches(run: Run) -> PageTable:
    """Of all launches: a column each."""
    columns = [
        launch
        | {
            "commit": (launch["git"] or "")[:10] + ("+dirty" if "dirty" in (launch["git"] or "") else ""),
            "packages": ", ".join(f"{name} {version}" for name, version in launch["packages"].items()),
        }
        for launch in run.launches
    ]
    names = ("started", "command", "ranks", "commit", "python", "platform", "packages")
    return PageTable([], [[name, *(column[name] for column in columns)] for name in names])
