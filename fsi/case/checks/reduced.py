"""What a case must satisfy to be run with the reduced model."""

from pathlib import Path

import numpy as np

from fsi.arrays import Array
from fsi.case.background_flow import background
from fsi.case.case import Case
from fsi.case.checks.time import free_without_mass
from fsi.case.checks.without_flow import check_estimates
from fsi.case.domains.domain import MeanDrive
from fsi.errors import InputError


def check_reduced(case: Case) -> None:
    """Raise InputError, one line with key, value and remedy, for the first thing that cannot be."""
    if not case.bodies:
        raise InputError("bodies: missing; give [[bodies]], [[grids]] or bodies_from")
    _check_drag_file(case)
    held = case.held()[:, : case.dimension].all()  # turning has a drag of its own
    if case.drag == 0.0 and case.masses() is None and not held:
        raise InputError(
            "reduced.drag = 0: only lubrication would resist bodies without mass; give them drag or mass"
        )
    check_estimates(case)
    _check_periodic(case)
    _check_tangential(case)
    _check_cutoff(case)
    _check_background(case)
    laws = {case.reduced.law, case.reduced.wall_law or case.reduced.law}
    literal = case.time is not None and case.time.scheme == "backward-euler"
    if literal and (laws != {"slides"} or case.reduced.cutoff is not None):
        massless = free_without_mass(case)
        masses = f", which needs bodies.{massless[0]}.mass too" if massless else ""
        raise InputError(
            f'reduced.law = "{case.reduced.law}": scheme "backward-euler" is for "slides" without a cutoff; '
            f'use time.scheme = "distance"{masses}'
        )


# A drag belongs to the area fraction at which it was found, to within this part, and to one cutoff.
_SAME_FRACTION, _SAME_CUTOFF = 0.05, 1e-6


def relative_cutoff(case: Case) -> float | None:
    """The cutoff over the mean radius."""
    cutoff, radii = case.reduced.cutoff, case.configuration().radii
    return None if cutoff is None or not len(radii) else cutoff / float(radii.mean())


def _check_drag_file(case: Case) -> None:
    """A drag is for bodies as many, that do not feel pairs twice."""
    if (name := case.reduced.drag_from) is None:
        return
    here = f'reduced.drag_from = "{name}"'
    if case.reduced.drag is not None:
        raise InputError(f"{here}: there is reduced.drag = {case.reduced.drag:g} too; drop one of them")
    if not Path(name).is_file():
        problem = "is a folder" if Path(name).is_dir() else "there is no such file"
        raise InputError(f"{here}: {problem}; `fsi resistance CASE --drag FILE` writes one")
    from fsi.case.drag_file import read_drag_file

    file, cutoff = read_drag_file(Path(name)), relative_cutoff(case)
    of_case = "spheres" if case.spheres else "discs"
    if file.shape != of_case:
        raise InputError(
            f"{here}: a drag of {file.shape}, but the case has {of_case}; calibrate one of these"
        )
    if abs(case.fraction - file.fraction) > _SAME_FRACTION * file.fraction:
        raise InputError(
            f"{here}: found where bodies are {file.fraction:.3g} of the domain, but here they are "
            f"{case.fraction:.3g}; calibrate one for these"
        )
    if (file.cutoff is None) != (cutoff is None) or (
        file.cutoff is not None and cutoff is not None and abs(cutoff / file.cutoff - 1.0) > _SAME_CUTOFF
    ):
        raise InputError(
            f"{here}: found with reduced.cutoff = {file.cutoff} mean radii, not {cutoff}; give that, or "
            "calibrate one for this"
        )
    laws, digests = case.reduced.laws, case.reduced.digests()
    for key in sorted(file.laws.keys() | laws.keys()):
        theirs, ours = file.laws.get(key), laws.get(key)
        its, own = file.digests.get(key, theirs), digests.get(key, ours)
        if its != own:
            raise InputError(
                f"{here}: found with reduced.{key} = {_told(theirs, its)}, not {_told(ours, own)}; give that "
                "one, or calibrate a drag for this"
            )


def _told(law: str | None, digest: str | None) -> str:
    """A law for a message: of those in files, which may have one name, the start of the digest too."""
    if law is None or digest is None:
        return "none"
    return law if digest == law else f"{Path(law).name} ({digest[:8]})"


def _check_periodic(case: Case) -> None:
    """Images end at the cutoff."""
    if case.reduced.cutoff is None and len(case.container().periods):
        raise InputError(
            "reduced.cutoff: missing; a body of a periodic domain has images without end; give the gap from "
            "which on they do not feel each other"
        )


def _check_tangential(case: Case) -> None:
    """What sliding and rolling need: laws between bodies, a reach, freedoms, and a model that keeps them."""
    from fsi.integration.schemes import SCHEMES

    keys = ("shear_law", "wall_shear_law", "rotation_law", "wall_rotation_law")
    given = {key: law for key in keys if (law := getattr(case.reduced, key)) is not None}
    for key, law in given.items():
        here, plain = f'reduced.{key} = "{law}"', key.removeprefix("wall_")
        if plain not in given:
            raise InputError(f"{here}: needs the law between bodies too; give reduced.{plain}")
        if case.axisymmetric:
            raise InputError(f"{here}: spheres on an axis neither slide nor roll; drop it")
        if case.reduced.cutoff is None:
            raise InputError(
                f"{here}: goes on to any gap, where drag is counted already; give reduced.cutoff, the gap "
                "from which on bodies do not feel each other"
            )
        scheme = SCHEMES.get(case.time.scheme or "") if case.time is not None else None
        if scheme is not None and scheme.fixed:
            raise InputError(
                f'{here}: scheme "{scheme.name}" stores gaps, for squeeze alone; drop it, or time.scheme'
            )


def _check_cutoff(case: Case) -> None:
    """A law is taken less what it is at the cutoff: one of a file must hold there, for all its films."""
    from fsi.case.law_file import read_law_file
    from fsi.lubrication.laws import ROUNDING
    from fsi.lubrication.named_laws import LAWS

    if (cutoff := case.reduced.cutoff) is None:
        return
    for key, name in case.reduced.laws.items():
        if name in LAWS or not Path(name).is_file():
            continue
        file, here = read_law_file(Path(name)), f'reduced.{key} = "{name}"'
        try:
            smallest, largest = file.law().range
        except ValueError as error:
            raise InputError(f'{here}: {error}; give "leading"') from None
        a_r = _reduced_radii(case, file.ratio)
        low, high = smallest * a_r.max(initial=0.0), largest * a_r.min(initial=np.inf)
        if not (1.0 - ROUNDING) * low <= cutoff <= (1.0 + ROUNDING) * high and not case.reduced.extrapolate:
            raise InputError(
                f"reduced.cutoff = {cutoff!r}: {here} holds for gaps from {low:.6g} to {high:.6g} of these "
                "bodies; give a cutoff among them, or reduced.extrapolate = true"
            )


def _reduced_radii(case: Case, ratio: float | None) -> Array:
    """a_r of the films for which a law of one ratio of radii is: none where the bodies have another ratio.

    Beside a plane, None, it is a of each body; between bodies the same a b/(a + b) of all pairs.
    """
    a, images = case.configuration().radii, len(case.container().periods)
    if ratio is None:
        return a
    larger = max(ratio, 1.0 / ratio)
    paired = len(a) + images > 1 and np.isclose(a.max(), larger * a.min())
    return np.array([a.min() * larger / (1.0 + larger)] if paired else [])


def _check_background(case: Case) -> None:
    """Walls drive a flow that is known at any time, and no pressure drives one."""
    drive = case.domain.mean_drive()
    if drive != MeanDrive():
        key = "pressure_gradient" if drive.net_flux is None else "net_flux"
        raise InputError(
            f"domain.{key} = {getattr(drive, key):g}: the reduced model knows only flow between moving "
            "walls; drop it"
        )
    pressures = case.wall_pressure()
    if len(set(pressures.values())) > 1:
        name = max(pressures, key=lambda name: abs(pressures[name]))
        raise InputError(
            f"domain.walls.{name} = {{pressure = {pressures[name]:g}}}: the reduced model knows no flow that "
            "pressure drives; give all open walls the same"
        )
    for t in case.kinks() or (0.0,):
        background(case.container(), case.wall_velocity(t))
