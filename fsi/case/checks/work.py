"""How much work a case asks for, before it starts: what no machine finishes is refused by name.

Of a resolved case the cells of its mesh are estimated (`fsi.meshes.estimate`), and from them the unknowns of
velocities of degree k and pressures of degree k - 1,

    n = cells (k^2 + (k - 1)^2 / 2),   in space   1.15 cells (k^3 / 2 + (k - 1)^3 / 6),

where the factor is for what lies on the boundary; of the other levels the bodies or parcels are counted, of
pores at area fraction 0.5, where wide pores are few.
Steps are at least end / step where their length is given, and end / interval of output. These numbers are
good to a factor 3, so that a case is refused only where a third of them is too much.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from fsi.bodies.gaps import Gaps, find_gaps
from fsi.bodies.resolved_gaps import too_narrow
from fsi.case.case import Case
from fsi.case.section import CaseContext
from fsi.case.sections import Discretisation
from fsi.errors import InputError
from fsi.files import require_folder
from fsi.machine.resources import memory, require_disk, require_memory, size
from fsi.meshes.estimate import Narrows, cells_of
from fsi.meshes.resolution import Resolution

_SURE = 3.0  # what an estimate may be off by
# Measured on the shipped cases: bytes and CPU seconds of a solve for each unknown, in the plane and in space.
_BYTES, _SECONDS = {2: 4.5e3, 3: 12e3}, {2: 14e-6, 3: 90e-6}
# Of the other levels, for each body or parcel: bytes, and seconds of a step.
_BODY_BYTES, _BODY_SECONDS = 20e3, 2e-5
# Of pores, bytes and seconds of a step for each body, with so many modes.
_MODES, _PORE_BYTES, _PORE_SECONDS = (1, 4, 8, 16), (1.9e5, 3.7e5, 7.6e5, 2e6), (2e-3, 4.4e-3, 1.1e-2, 7e-2)
_ROW, _BODY_ROW, _FIELD = 200.0, 150.0, 40.0  # bytes of a step, of a body in it, of an unknown in a file
_SAMPLE = 4096.0  # bytes of a sample's file
_LIMIT_STEP = 400.0  # bytes of a step of the slides' scheme
_LONG = 10.0  # minutes from which on it is said beforehand


def check_work(case: Case) -> str | None:
    """What to say beforehand of a case that takes long; None of others.

    Raises InputError, one line with key, value, estimate and remedy: it is more than this machine holds.
    """
    resolved = case.level.meshed and case.domain.mesh is None
    if resolved or (case.level.flow and not case.level.meshed):
        _check_gaps(case)
    count = _check_mesh(case) if resolved else _check_bodies(case)
    steps, _ = _steps(case)
    if case.limit is not None:
        most = max(case.limit.steps)
        require_memory(f"limit.steps = {most}", most * _LIMIT_STEP, "give fewer")
    each = _SECONDS[case.dimension] if resolved else _of_body(case, _PORE_SECONDS, _BODY_SECONDS)
    minutes = max(steps, 1.0) * count * each / 60.0
    if minutes < _LONG:
        return None
    what = f"{count:.2g} {'unknowns' if resolved else 'bodies'}" + (f", {steps:.2g} steps" if steps else "")
    return f"{what}: some {minutes:.2g} minutes or more"


def _check_gaps(case: Case) -> None:
    """No gap is narrower than what is resolved."""
    if (what := too_narrow(case.configuration(), case.container(), case.names)) is not None:
        shaped = case.configuration().shaped or case.domain.profiled  # which other levels do not know
        raise InputError(f"bodies: {what}; widen it{'' if shaped else ' or give model = "reduced"'}")


def _check_mesh(case: Case) -> float:
    """The unknowns of a resolved case."""
    gaps = find_gaps(case.configuration(), case.container())
    given = case.discretisation
    n = _unknowns(case, gaps, given)
    need = bytes_of(case, n)
    if need / _SURE <= memory():
        return n
    usual = Discretisation.model_validate({}, context=CaseContext(case.geometry, len(case.bodies)))
    keys = ("cells_per_circle", "cells_per_gap", "growth")
    fewest, key = min(
        (_unknowns(case, gaps, given.model_copy(update={key: getattr(usual, key)})), key) for key in keys
    )
    what, remedy = f"discretisation.{key} = {getattr(given, key)}", f"give {getattr(usual, key)} or so"
    if fewest > 0.5 * n:
        what, remedy = (
            f"bodies: {len(case.bodies)}, smallest gap {gaps.smallest():.3g}",
            "give wider gaps or fewer",
        )
    raise InputError(
        f"{what}: a mesh with {n:.2g} unknowns needs some {size(need)} of memory, this machine has "
        f"{size(memory())}; {remedy}"
    )


def bytes_of(case: Case, unknowns: float) -> float:
    """What a solve takes of memory."""
    return unknowns * _BYTES[case.dimension]


def finer_by(case: Case, finer: Case) -> float:
    """How many times as many unknowns a case has with other sizes; without bodies at most."""
    if not case.bodies:
        now, then = case.discretisation, finer.discretisation
        finest = then.cells_per_circle / now.cells_per_circle * now.growth / then.growth
        return float((finest * then.degree / now.degree) ** case.dimension)
    gaps = find_gaps(case.configuration(), case.container())
    return _unknowns(finer, gaps, finer.discretisation) / _unknowns(case, gaps, case.discretisation)


def _unknowns(case: Case, gaps: Gaps, sizes: Discretisation) -> float:
    resolution = Resolution(sizes.cells_per_gap, sizes.cells_per_circle, sizes.growth, sizes.interior)
    k, radii = float(sizes.degree), case.configuration().radii
    cells = cells_of(case.container(), radii, narrows(case, gaps), resolution)
    return cells * (1.15 * (k**3 / 2 + (k - 1) ** 3 / 6) if case.dimension == 3 else k**2 + (k - 1) ** 2 / 2)


def narrows(case: Case, gaps: Gaps) -> Narrows:
    """The gaps between bodies, and to walls no farther than a diameter."""
    radii, spheres = case.configuration().radii, case.container().spheres
    a, b = radii[gaps.pairs].T
    body, wall = np.nonzero(gaps.wall_gaps < 2.0 * radii[:, None])
    each = zip(spheres, case.container().concavities, strict=True)
    around = np.array([0.0 if sphere is None else side * sphere.mean_curvature for sphere, side in each])
    return Narrows(
        np.concatenate([gaps.pair_gaps, gaps.wall_gaps[body, wall]]),
        np.concatenate([np.minimum(a, b), radii[body]]),
        np.concatenate([1.0 / a + 1.0 / b, np.maximum(1.0 / radii[body] - around[wall], 0.0)]),
    )


def _check_bodies(case: Case) -> float:
    """The bodies or parcels of the other levels."""
    if case.model == "macroscopic":
        key, count = f"macroscopic.parcels = {case.macroscopic.parcels}", float(case.macroscopic.parcels)
    else:
        key, count = f"bodies: {len(case.bodies)}", float(len(case.bodies))
    if case.model == "pores":
        key += f", with pores.modes = {case.pores.modes}"
    require_memory(key, count * _of_body(case, _PORE_BYTES, _BODY_BYTES), "give fewer", _SURE)
    return count


def _of_body(case: Case, of_pores: Sequence[float], of_others: float) -> float:
    """What a body or parcel takes: bytes, or seconds of a step."""
    return float(np.interp(case.pores.modes, _MODES, of_pores)) if case.model == "pores" else of_others


def _steps(case: Case) -> tuple[float, float]:
    """The least number of steps, and of those that are written; none without [time]."""
    time = case.time
    if time is None:
        return 0.0, 0.0
    fixed = not case.level.viscous or case.scheme.fixed
    steps = time.end / time.step if fixed and time.step is not None else 0.0
    interval = case.output.interval
    outputs = steps if interval is None else time.end / interval
    return max(steps, outputs), outputs


def require_room(case: Case, folder: Path) -> None:
    """Raise InputError where a run, with [time], cannot write its files, or they have no room on the disk.

    folder: of the run, which will be made, or is there.
    """
    if (time := case.time) is None:
        return
    require_folder(folder)
    row, field = _ROW + _BODY_ROW * len(case.bodies), _field(case) if case.output.fields else 0.0
    remedy = "make room, or give another folder"  # longer steps are no fewer than the first and the last
    require_disk(f"output = {folder}: two steps", 2.0 * (row + field), remedy, folder, _SURE)
    steps, outputs = _steps(case)
    rows, files = row * steps, field * outputs
    short = case.output.interval is None or (steps > outputs and rows > files)
    key = f"time.step = {time.step}" if short else f"output.interval = {case.output.interval}"
    what = f"{key}: {steps:.2g} steps to time.end = {time.end:g}"
    require_disk(what, rows + files, "give longer ones", folder, _SURE)


def _field(case: Case) -> float:
    """Bytes of the field files of a step."""
    unknowns = 0.0
    if case.level.meshed and case.domain.mesh is None:
        unknowns = _unknowns(case, find_gaps(case.configuration(), case.container()), case.discretisation)
    return _FIELD * unknowns + 2 * _ROW * len(case.bodies)


def require_room_for_samples(case: Case, folder: Path) -> None:
    """Raise InputError where the samples of a calibration have no room on the disk of their folder."""
    if case.calibration is not None:
        what = f"calibration.samples = {case.calibration.samples}: so many solves"
        require_disk(what, case.calibration.samples * _SAMPLE, "give fewer", folder)
