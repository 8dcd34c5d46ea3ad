"""A report of a run: one HTML file with everything in it, which opens from disk without a network."""

from __future__ import annotations

import base64
import html
import tempfile
from collections.abc import Callable, Iterable
from pathlib import Path

import numpy as np
import pandas as pd

from fsi.errors import InputError
from fsi.observables.identities import BOUND, IDENTITIES
from fsi.postprocess.choice import Choice
from fsi.postprocess.plots.histories import plot_runs
from fsi.postprocess.render.animation import MOVIES, write_pictures
from fsi.postprocess.render.opengl import require_opengl
from fsi.postprocess.render.render import artist, render_run
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
_CHECKED = ["check", "what it says", "worst", "at t", "bound", ""]
_STYLE = """
body { font: 16px/1.45 system-ui, sans-serif; color: #222 }
body { max-width: 62rem; margin: 2rem auto; padding: 0 1rem }
h1 { font-size: 1.7rem; margin-bottom: .3rem } h2 { font-size: 1.2rem; margin-top: 2.2rem }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; display: block; overflow-x: auto }
th, td { padding: .2rem .8rem; text-align: right; border-bottom: 1px solid #ddd; white-space: nowrap }
th { border-bottom: 2px solid #888 } .text { text-align: left } img { max-width: 100% }
.warning { background: #fff3d6; border-left: 4px solid #d55e00; padding: .5rem 1rem }
pre { background: #f6f6f6; padding: .8rem; overflow-x: auto; font-size: 13px }
"""


def write_report(run: Run, output: Path) -> None:
    """Write the report of a run, finished or not; what cannot be drawn is said in it.

    Raises:
        InputError: not a .html file, or it cannot be written.
    """
    if output.suffix != ".html" or not output.absolute().parent.is_dir():
        raise InputError(f"output = {output}: give the path of a .html file in a folder that exists")
    name = html.escape(run.name)
    parts = [
        f"<h1>{name}</h1>",
        _or_reason(lambda: _state(run)),
        "<h2>Case</h2>",
        _case(run),
        "<h2>Pictures</h2>",
        *_pictures(run),
        "<h2>Checks</h2>",
        _or_reason(lambda: _checks(run)),
        "<h2>Bodies at the last step</h2>",
        _or_reason(lambda: _folded(run.bodies[run.bodies["step"] == run.bodies["step"].iloc[-1]])),
        "<h2>Steps</h2>",
        _or_reason(lambda: _steps(run.steps)),
        "<h2>Provenance</h2>",
        _or_reason(lambda: _provenance(run)),
    ]
    head = f'<!doctype html>\n<html lang="en"><head><meta charset="utf-8"><title>{name}</title>'
    page = "\n".join([f"{head}<style>{_STYLE}</style></head><body>", *parts, "</body></html>", ""])
    try:
        replace(output, page.encode())
    except OSError as error:
        raise InputError(f"output = {output}: {error.strerror}; give another path") from None


def _or_reason(part: Callable[[], str]) -> str:
    """A part of the page, or why it is missing."""
    try:
        return part()
    except InputError as error:
        return f'<p class="warning">{html.escape(str(error))}</p>'


def _state(run: Run) -> str:
    """Whether the run has come to its end."""
    steps = run.steps
    smallest = steps["smallest_gap"].idxmin()
    cpu = steps["cpu_step"].sum() if "cpu_step" in steps else 0.0
    done = (
        f"{len(steps) - 1} steps to t = {run.end:g}, smallest gap {steps['smallest_gap'][smallest]:.4g}"
        f" (at t = {steps['t'][smallest]:g}), {cpu:.0f} CPU s."
    )
    if run.finished:
        return f"<p>Finished: {done}</p>"
    end = "" if run.asked is None else f" of {run.asked:g}"
    return (
        f'<p class="warning"><b>Not finished</b>: the run was broken off, or is still going on, at'
        f" t = {run.end:g}{end}. {done} <code>fsi resume {html.escape(str(run.path))}</code> goes on.</p>"
    )


def _case(run: Run) -> str:
    """The bodies and the whole case."""
    text = html.escape((run.path / CASE).read_text(encoding="utf-8"))
    whole = f"<details><summary>case.toml</summary><pre>{text}</pre></details>"
    if not run.has_flow:
        return f"<p>{run.model} model</p>{whole}"
    case = run.case
    bodies = pd.DataFrame(
        [
            {"body": body.name, "radius": body.radius, "start": ", ".join(f"{x:g}" for x in body.position)}
            for body in case.bodies
        ]
    )
    walls = ", ".join(case.domain.walls) or "none"
    about = f"<p>{run.model} model, {case.geometry}, viscosity {case.fluid.viscosity:g}, walls: {walls}</p>"
    return about + ("" if bodies.empty else _folded(bodies)) + whole


def _pictures(run: Run) -> list[str]:
    """Histories, the last fields, and all of them as an animation."""
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)

        def histories() -> str:
            plot_runs([run], place / "history.png")
            return _image(place / "history.png", "histories")

        def picture(field: str | None) -> Callable[[], str]:
            def draw() -> str:
                path = render_run(run, place / "picture.png", Choice(field, size=_PICTURE_SIZE))
                what = field or ("bodies" if run.times.empty else "speed, streamlines, and the narrowest gap")
                return _image(path, f"{what} at the last step")

            return draw

        def animation() -> str:
            drawer = artist(
                run, Choice(size=_FRAME_SIZE) if run.times.empty else Choice("speed", size=_FRAME_SIZE)
            )
            run.step(None, drawer.series)  # says so where there are no fields
            require_opengl()
            steps = run.times_of(drawer.series).index.to_numpy()
            shown = steps[np.unique(np.linspace(0, len(steps) - 1, _FRAMES).astype(int))].tolist()
            path = place / f"all{MOVIES[1]}"
            write_pictures(drawer.pictures(shown), path)
            return _image(path, "all of the run")

        parts = [histories, picture(None), picture("dissipation"), animation]
        if run.model != "resolved":
            del parts[2]  # no field of it
        return [_or_reason(part) for part in parts]


def _image(path: Path, caption: str) -> str:
    """A picture, in the page itself."""
    kind = path.suffix.removeprefix(".")
    data = base64.b64encode(path.read_bytes()).decode()
    text = html.escape(caption)
    picture = f'<img alt="{text}" src="data:image/{kind};base64,{data}">'
    return f"<figure>{picture}<figcaption>{text}</figcaption></figure>"


def _checks(run: Run) -> str:
    """The worst defect of each identity over the whole run, and the smallest gap."""
    steps, rows = run.steps, []
    identities, bound = _IDENTITIES[run.model]
    for name, meaning in identities.items():
        if name in steps:
            worst = steps[name].abs().idxmax()
            defect = float(steps[name].abs()[worst])
            verdict = "holds" if defect <= bound else "VIOLATED"
            rows.append([name, meaning, f"{defect:.1e}", f"{steps['t'][worst]:g}", f"{bound:g}", verdict])
    if not run.has_flow:
        return _table(pd.DataFrame(rows, columns=_CHECKED)) if rows else "<p>None recorded.</p>"
    gap = steps["smallest_gap"].idxmin()
    least = float(steps["smallest_gap"][gap])
    verdict = "holds" if least > 0.0 else "VIOLATED"
    rows.append(["gap", "bodies do not overlap", f"{least:.4g}", f"{steps['t'][gap]:g}", "> 0", verdict])
    return _table(pd.DataFrame(rows, columns=_CHECKED))


def _steps(steps: pd.DataFrame) -> str:
    """Some of the steps, evenly spread."""
    columns = [name for name in steps if not name.startswith("cpu_") and name not in IDENTITIES]
    chosen = np.unique(np.linspace(0, len(steps) - 1, _ROWS).astype(int))
    return _table(steps[columns].iloc[chosen])


def _provenance(run: Run) -> str:
    """A table of the launches."""
    rows = [
        {
            "started": launch["started"],
            "command": launch["command"],
            "ranks": launch["ranks"],
            "commit": (launch["git"] or "")[:10] + ("+dirty" if "dirty" in (launch["git"] or "") else ""),
            "python": launch["python"],
            "platform": launch["platform"],
            "packages": ", ".join(f"{name} {version}" for name, version in launch["packages"].items()),
        }
        for launch in run.launches
    ]
    return _table(pd.DataFrame(rows).T.reset_index(), header=False)


def _table(frame: pd.DataFrame, header: bool = True) -> str:
    """Words to the left, numbers to the right."""

    def cell(value: object, tag: str) -> str:
        value = value.item() if isinstance(value, np.generic) else value
        kind = "" if isinstance(value, float | int) else " class=text"
        return f"<{tag}{kind}>{html.escape(_text(value))}</{tag}>"

    def cells(row: Iterable[object], tag: str) -> str:
        return "".join(cell(value, tag) for value in row)

    rows = [cells(row, "td") for row in frame.itertuples(index=False)]
    head = f"<tr>{cells(frame.columns, 'th')}</tr>" if header else ""
    return f"<table>{head}{''.join(f'<tr>{row}</tr>' for row in rows)}</table>"


def _folded(bodies: pd.DataFrame) -> str:
    """A table of the bodies; that of many opens with a click."""
    if len(bodies) <= _MANY:
        return _table(bodies)
    return f"<details><summary>{len(bodies)} bodies</summary>{_table(bodies)}</details>"


def _text(cell: object) -> str:
    return f"{cell:.6g}" if isinstance(cell, float) else str(cell)
