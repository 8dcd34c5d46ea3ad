"""A report of a run: one HTML file with everything in it, which opens from disk without a network.

`report.html.jinja` is the page; here is what it shows. What cannot be made is replaced by the reason, a line.
"""

import base64
import os
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import pandas as pd
from jinja2 import Environment, PackageLoader, StrictUndefined

from fsi.bodies.gaps import OVERLAP
from fsi.errors import InputError
from fsi.files import require_suffix, write_whole
from fsi.gluey.step import ACCEPTED, MOMENTUM
from fsi.observables.solved_flow import BOUND, IDENTITIES
from fsi.pores.instant import BOUND as PORES_BOUND
from fsi.postprocess.plots.histories import plot_runs
from fsi.postprocess.render.network import NECKS
from fsi.postprocess.render.picture import MOVIES, write_pictures
from fsi.postprocess.render.render import artist, render_run
from fsi.postprocess.render.suspended import MOTION
from fsi.postprocess.render.view import Choice
from fsi.postprocess.run.run import Run
from fsi.postprocess.run.tables import spread
from fsi.reduced.system import BOUND as REDUCED_BOUND
from fsi.run_folder.kept import CASE

_ROWS = 15  # of the table of steps
_MANY = 20  # bodies, more than which are not listed in the open
_FRAMES, _FRAME_SIZE, _PICTURE_SIZE = 30, 320, 700
_OF_VISCOSITY = {
    "stress": "viscosity by stress = viscosity by dissipation",
    "viscosity_bound": "viscosity >= 1 / (1 - fraction of the bodies)",
}
_OF_NETWORK = {
    "kernel": "rigid motions of clusters change no gap",
    "invariant": "the first integral of each gap is kept",
    "energy": "the energy inequality",
    "stress": "stress and loads do the work that drag and gaps dissipate",
}


def _all_within(bound: float, says: dict[str, str]) -> dict[str, tuple[str, float]]:
    return {name: (text, bound) for name, text in says.items()}


# By model: columns of steps.csv, what they say, and the bound of each, which the models enforce.
_IDENTITIES: dict[str, dict[str, tuple[str, float]]] = {
    "resolved": _all_within(BOUND, IDENTITIES | _OF_VISCOSITY),
    "pores": _all_within(PORES_BOUND, IDENTITIES | _OF_VISCOSITY),
    "reduced": _all_within(REDUCED_BOUND, IDENTITIES | _OF_NETWORK),
    "gluey": {
        "kkt": ("velocities and impulses are optimal", ACCEPTED),
        "momentum_defect": ("impulses act and react", MOMENTUM),
        "overlap": ("bodies overlap by so little, in smallest radii", OVERLAP),
    },
    "macroscopic": {},
}


def write_report(run: Run, output: Path) -> None:
    """Write the report of a run, finished or not; what cannot be drawn is said in it.

    Raises InputError: not a .html file, it cannot be written, or someone has changed the tables of the run.
    """
    require_suffix(output, ".html")
    run.require_tables()
    loader = PackageLoader("fsi.postprocess", ".")
    templates = Environment(loader=loader, autoescape=True, undefined=StrictUndefined)
    page = templates.get_template("report.html.jinja").render(
        name=run.case.name,
        path=run.path,
        many=_MANY,
        state=_or_reason(run, lambda: _state(run)),
        case=_case(run),
        pictures=_pictures(run),
        checks=_or_reason(run, lambda: _checks(run)),
        bodies=_or_reason(run, lambda: run.bodies[run.bodies["step"] == run.bodies["step"].iloc[-1]]),
        steps=_or_reason(run, lambda: _steps(run)),
        launches=_or_reason(run, lambda: _launches(run)),
    )
    write_whole(output, page)


def _or_reason[Part](run: Run, part: Callable[[], Part]) -> Part | str:
    """A part of the page, or why it is missing, without the folder: the page may be read anywhere."""
    try:
        return part()
    except InputError as error:
        return str(error).removeprefix(f"{run.path}{os.sep}").removeprefix(f"{run.path}: ")


def _state(run: Run) -> dict[str, Any]:
    """Whether the run has come to its end."""
    steps = run.steps
    gap, t = steps.loc[steps["smallest_gap"].idxmin(), ["smallest_gap", "t"]]
    cpu = steps["cpu_step"].sum() if "cpu_step" in steps else 0.0
    ends = {"end": run.end, "asked": run.asked, "finished": run.finished}
    return {"steps": len(steps) - 1, "gap": gap, "at": t, "cpu": cpu} | ends


def _case(run: Run) -> dict[str, Any]:
    """The bodies and the whole case."""
    case, about, rows = run.case, f"{run.case.model} model", []
    if run.viscous:
        walls = ", ".join(case.domain.walls) or "none"
        about += f", {case.geometry}, viscosity {case.fluid.viscosity:g}, walls: {walls}"
        rows = [[body.name, body.radius, ", ".join(f"{x:g}" for x in body.position)] for body in case.bodies]
    text = (run.path / CASE).read_text(encoding="utf-8")
    return {"about": about, "bodies": pd.DataFrame(rows, columns=["body", "radius", "start"]), "text": text}


def _pictures(run: Run) -> list[dict[str, str] | str]:
    """Histories, the last step, and all steps as an animation; why any are missing, each reason once."""
    fieldless = run.drawn_by_tables and _or_reason(run, lambda: not run.has(run.series)) is True
    last = _without_fields() if fieldless else _with_fields(run)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "picture.png"
        parts = {"histories": partial(plot_runs, [run], file)}
        parts |= {caption: partial(render_run, run, file, choice) for caption, choice in last.items()}
        field = MOTION if fieldless else "speed" if run.series == "fluid" else None
        parts["all of the run"] = partial(_animation, run, Path(folder) / f"all{MOVIES[1]}", field)
        found = [_or_reason(run, partial(_embedded, caption, draw)) for caption, draw in parts.items()]
    return [part for k, part in enumerate(found) if part not in found[:k]]


def _with_fields(run: Run) -> dict[str, Choice]:
    """What is drawn of the last step by its caption; of a flow its dissipation too."""
    what = {"fluid": "speed, streamlines, and the narrowest gap", "bodies": "bodies", "profile": "profiles"}
    last = {f"{what[run.series]} at the last step": Choice(size=_PICTURE_SIZE)}
    if run.series == "fluid":
        last["dissipation at the last step"] = Choice("dissipation", size=_PICTURE_SIZE)
    if run.has(NECKS):
        last["necks at the last step, as wide as what is dissipated in them"] = Choice(
            NECKS, size=_PICTURE_SIZE
        )
    return last


def _without_fields() -> dict[str, Choice]:
    """The same of a run that has tables alone."""
    caption = "speeds of the bodies at the last step; the run has written no fields"
    return {caption: Choice(MOTION, size=_PICTURE_SIZE)}


def _embedded(caption: str, draw: Callable[[], Path]) -> dict[str, str]:
    """A picture, to stand in the page itself."""
    path = draw()
    data = base64.b64encode(path.read_bytes()).decode()
    return {"caption": caption, "kind": path.suffix.removeprefix("."), "data": data}


def _animation(run: Run, path: Path, field: str | None) -> Path:
    """At most thirty steps, evenly spread."""
    painter = artist(run, Choice(field, size=_FRAME_SIZE))
    painter.require(painter.step(None))
    steps = painter.film
    write_pictures(painter.pictures([steps[k] for k in spread(len(steps), _FRAMES)]), path)
    return path


def _checks(run: Run) -> pd.DataFrame:
    """The worst defect of each identity over the whole run, and the smallest gap."""
    steps, rows = run.steps, []
    for name, (says, bound) in _IDENTITIES[run.case.model].items():
        if name not in steps or steps[name].isna().all():
            continue
        worst = steps[name].abs().idxmax()
        defect, t = abs(float(steps[name][worst])), steps["t"][worst]
        verdict = "holds" if defect <= bound else "VIOLATED"
        rows.append([name, says, f"{defect:.1e}", f"{t:g}", f"{bound:g}", verdict])
    if run.viscous:
        least = steps.loc[steps["smallest_gap"].idxmin()]
        verdict = "holds" if least["smallest_gap"] > 0.0 else "VIOLATED"
        gap, t = f"{least['smallest_gap']:.4g}", f"{least['t']:g}"
        rows.append(["gap", "bodies do not overlap", gap, t, "> 0", verdict])
    return pd.DataFrame(rows, columns=["check", "what it says", "worst", "at t", "bound", ""])


def _steps(run: Run) -> pd.DataFrame:
    """Some of the steps, evenly spread, without what is said of them elsewhere."""
    steps, identities = run.steps, _IDENTITIES[run.case.model]
    columns = [name for name in steps if not name.startswith("cpu_") and name not in identities]
    return steps[columns].iloc[spread(len(steps), _ROWS)]


def _launches(run: Run) -> pd.DataFrame:
    """A column for each launch, led by that of the names."""
    launches = pd.DataFrame(run.launches)
    git = launches["git"].fillna("")
    launches["commit"] = git.str[:10] + git.str.contains("dirty").map({True: "+dirty", False: ""})
    launches["packages"] = [", ".join(f"{k} {v}" for k, v in of.items()) for of in launches["packages"]]
    names = ["started", "command", "ranks", "commit", "python", "platform", "packages"]
    return launches[names].T.reset_index()
