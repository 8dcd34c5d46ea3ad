"""The drag of the reduced model from a resolved flow: that with which bodies move as easily, on the average.

What near pairs do not resist, a drag zeta against the mean flow stands for. It is found from the resolved
mobility M = R^-1 of all bodies at the same area fraction, from the mean over the translations:

    tr (zeta Z + R_lub)^-1 = tr M,    Z = mu of discs, mu a of spheres

with R_lub of the laws and the cutoff of the case, and the drag against rotation that a lone body has. The
left side decreases with zeta, so that there is one solution, or none where the pairs alone resist more.

The mobility decides, not the resistance: the mean of R_ii - R_lub,ii is tens of times larger, since a body
that is moved while all others are held pushes fluid through every neck around it, which free bodies do not.

Source: the isotropic resistance of fast lubrication dynamics, A. Kumar and J. J. L. Higdon, Phys. Rev. E 82
(2010) 051401, who fit it to the mean self-mobility of Stokesian dynamics; here the flow is resolved.
"""

from pathlib import Path

import numpy as np
from scipy.optimize import brentq

from fsi.arrays import Array
from fsi.calibration.pair import LEFT_OUT
from fsi.case.case import Case
from fsi.case.checks.reduced import relative_cutoff
from fsi.case.drag_file import DragFile
from fsi.case.load import parse_case
from fsi.errors import InputError
from fsi.observables.resistance import Resistance, ResistanceErrors
from fsi.reduced.model import ReducedModel
from fsi.run_folder.provenance import launch

# Drags are looked for between these, over mu.
_LEAST, _MOST = 1e-6, 1e9


def reduced_model(case: Case) -> ReducedModel:
    """The reduced model of a case, whatever its drag. Raises InputError: it cannot be one."""
    if case.axisymmetric:
        raise InputError(
            f'geometry = "{case.geometry}": spheres on an axis have no mean mobility; the drag is 6 pi'
        )
    data = {key: value for key, value in case.as_data().items() if key not in LEFT_OUT}
    section = {key: value for key, value in data["reduced"].items() if key != "drag_from"}
    return ReducedModel(parse_case(data | {"model": "reduced", "reduced": section | {"drag": 1.0}}))


def calibrated_drag(
    model: ReducedModel, resistance: Resistance, errors: ResistanceErrors, source: Path
) -> DragFile:
    """The drag of a case with this resolved resistance; `source` is its file. Raises InputError: none."""
    case, q = model.case, model.case.configuration()
    if resistance.mobility is None or errors.mobility is None:
        raise InputError(
            "domain.walls: no wall is at rest, so that bodies have no mobility; give one that is"
        )
    translations = np.arange(q.arms.size) % q.arms.shape[1] < q.dimension
    target = float(np.diag(resistance.mobility)[translations].mean())
    error = float(np.diag(errors.mobility)[translations].mean())
    R = model.resistance(q, 0.0).toarray()

    def mobility(drag: float) -> float:
        zeta: Array = np.where(translations, drag * model.zeta.ravel(), model.zeta.ravel())
        return float(np.diag(np.linalg.inv(R + np.diag(zeta)))[translations].mean())

    if mobility(_LEAST) <= target:
        raise InputError(
            f"reduced.cutoff = {case.reduced.cutoff}: pairs alone resist more than the resolved flow does; "
            "shorten it"
        )
    drag = float(brentq(lambda x: mobility(x) - target, _LEAST, _MOST, rtol=1e-12))
    slope = (mobility(1.001 * drag) - mobility(0.999 * drag)) / (0.002 * drag)
    found = {"case": source.name, "name": case.name, "bodies": len(q), "mean_mobility": target}
    here = launch()
    found |= {"computed": here["started"], "command": here["command"]}
    found |= {"git": here["git"] or "", "packages": here["packages"]}
    return DragFile(
        drag=drag,
        error=error / abs(slope),
        shape="spheres" if case.spheres else "discs",
        fraction=case.fraction,
        cutoff=relative_cutoff(case),
        laws={key: Path(law).name for key, law in case.reduced.laws.items()},
        digests=case.reduced.digests(),
        source=found,
    )
