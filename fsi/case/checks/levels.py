"""What a case must satisfy to be run with the gluey, the macroscopic or the reduced model."""

from pathlib import Path

import numpy as np

from fsi.bodies.configuration import Array, Configuration
from fsi.bodies.gaps import find_gaps, wall_gaps
from fsi.case.background_flow import background
from fsi.case.case import Case
from fsi.case.domain import MeanDrive
from fsi.case.section import refusal, toml_text
from fsi.case.series import is_zero
from fsi.errors import InputError

# Of the smallest radius: an overlap that is rounding in a contact.
_ROUNDING = 1e-10


def check_gluey(case: Case) -> None:
    """Raise InputError, one line with key, value and remedy, for the first thing that cannot be."""
    if not case.bodies:
        raise InputError("bodies: missing; give [[bodies]], [[grids]] or bodies_from")
    _check_estimates(case)
    _check_rest(case)
    _check_walls(case)
    _check_names(case)
    for k, force in enumerate(case.forces):
        force.require_contact(f"forces.{k}")
    _check_contacts(case)


def _check_estimates(case: Case) -> None:
    """There is no mesh."""
    if case.output.error_estimates:
        raise InputError(
            f'output.error_estimates = true: model = "{case.model}" has no mesh to estimate the error of; '
            "drop it"
        )


def _check_rest(case: Case) -> None:
    """Walls are at rest, and nothing drives a mean flow."""
    for name, wall in case.domain.walls.items():
        if not wall.rests:
            raise refusal(
                f"domain.walls.{name}",
                wall,
                f"walls of the {case.model} model are solid and at rest; drop it",
            )
    if case.container().mean_gradient.any() or case.domain.mean_drive() != MeanDrive():
        raise InputError(
            f"domain = {toml_text(case.domain)}: no fluid drives {case.model} bodies; drop shear, extension, "
            "pressure_gradient or net_flux"
        )


def _check_walls(case: Case) -> None:
    """Walls are plane, and the lattice stands along the axes, several bodies wide."""
    container, largest = case.container(), case.configuration().radii.max()
    for name, plane in zip(container.walls, container.plane, strict=True):
        # A gap in a round wall is concave, so that a step, which keeps its linearisation, would overlap.
        if not plane and name not in container.far_walls:
            raise InputError(
                f"domain.shape = {toml_text(case.domain.shape)}: the gluey model knows no contact with the "
                'round wall; give "box", "half-plane" or "unbounded"'
            )
    periods = container.periods
    if np.count_nonzero(periods) > len(periods):
        raise refusal(
            "domain", case.domain, "the gluey model wants periods along the axes; give such vectors"
        )
    if np.any(periods) and periods[periods != 0.0].min() < 8.0 * largest:
        raise InputError(
            f"domain = {toml_text(case.domain)}: a period is below four diameters, so that bodies meet their "
            "own images; widen it"
        )


def _check_names(case: Case) -> None:
    taken = {*case.domain.walls, *case.names}
    for i, wall in enumerate(case.gluey.walls):
        if wall.name in taken:
            raise refusal(
                f"gluey.walls.{i}.name", wall.name, "a wall or body has this name; give another one"
            )
        taken.add(wall.name)


def _check_contacts(case: Case) -> None:
    """Bodies and walls touch at most, and films have gaps."""
    q, container = case.configuration(), case.container()
    gaps = find_gaps(q, container, reach=0.0)
    between_bodies = zip(gaps.pairs, gaps.pair_gaps, strict=True)
    touching = [(gap, f"{case.names[i]} and {case.names[j]}") for (i, j), gap in between_bodies]
    of_planes = [
        (np.array(wall.normal) / np.linalg.norm(wall.normal)) @ (q.centres - np.array(wall.point)).T - q.radii
        for wall in case.gluey.walls
    ]
    to_walls = np.column_stack([container.distances(q.centres) - q.radii[:, None], *of_planes])
    names = [*container.walls, *(wall.name for wall in case.gluey.walls)]
    overlaps = np.argwhere(to_walls <= 0.0)
    touching += [(to_walls[i, w], f"{case.names[i]} and wall {names[w]}") for i, w in overlaps]
    if not touching:
        return
    deepest, between = min(touching)
    if deepest < -_ROUNDING * q.radii.min():
        raise InputError(f"bodies: {between} overlap by {-deepest:.3g}; move them apart")
    if case.gluey.variant == "film":
        raise InputError(
            f'bodies: {between} touch, where gluey.variant = "film" needs a gap; move them apart or give '
            '"shifted"'
        )


# Relative: densities of bodies, and numbers of parcels in each, nearer than this are the same.
_SAME = 1e-9


def check_macroscopic(case: Case) -> None:
    """Raise InputError, one line with key, value and remedy, for the first thing that cannot be."""
    container, here = case.container(), f"domain.shape = {toml_text(case.domain.shape)}"
    _check_estimates(case)
    _check_rest(case)
    if len(container.periods):
        raise InputError(f'{here}: is periodic, but the line of the macroscopic model ends; give "unbounded"')
    if case.macroscopic.blocks:
        if case.bodies:
            raise refusal(
                "bodies.0", case.bodies[0].name, "there are [[macroscopic.blocks]]; give bodies or blocks"
            )
        if container.walls:
            raise InputError(f'{here}: has walls, which [[macroscopic.blocks]] do not meet; give "unbounded"')
        return
    if not case.bodies:
        raise InputError("macroscopic.blocks: missing; give [[macroscopic.blocks]] or [[bodies]] on a line")
    axis = line_of(case)
    q, masses = case.configuration(), case.masses()
    _check_loads(case, axis)
    if masses is None or any(body.mass is None for body in case.bodies):
        raise InputError("bodies.0.mass: missing; the macroscopic model wants the mass of each body")
    per_length = masses[:, axis] / (2.0 * q.radii)
    uneven = int(np.abs(per_length - per_length[0]).argmax())
    if abs(per_length[uneven] - per_length[0]) > _SAME * per_length[0]:
        raise InputError(
            f"bodies.{uneven}.mass = {masses[uneven, axis]:g}: matter has one density, mass over diameter, "
            f"here {per_length[0]:g}; give {2.0 * q.radii[uneven] * per_length[0]:g}"
        )
    _check_parcels(case, q.radii)
    if (past := past_walls(case, q)) is not None:
        raise InputError(past)


def past_walls(case: Case, q: Configuration, t: float = 0.0) -> str | None:
    """The line that says which body of the macroscopic model, at q and t, is past a wall; None if none is.

    The model has no walls: a domain with some is as good as an unbounded one while bodies do not meet them.
    """
    for i, w in np.argwhere(wall_gaps(q, case.container()) < -_ROUNDING * q.radii.min())[:1]:
        here, body, wall = toml_text(case.domain.shape), case.names[i], case.container().walls[w]
        return (
            f"domain.shape = {here}: body {body!r} is past wall {wall!r} at t = {t:.9g}, "
            'and the macroscopic model has no walls; give "unbounded", or model = "gluey"'
        )
    return None


def line_of(case: Case) -> int:
    """The axis along which the bodies of a case stand, the first that separates them. Raises InputError."""
    centres = case.configuration().centres
    spread = np.ptp(centres, axis=0)
    if case.axisymmetric:
        return 1
    if np.count_nonzero(spread) > 1:
        raise InputError(
            f"bodies.1.position = {toml_text(case.bodies[1].position)}: not on a line along an axis with the "
            'others; model = "macroscopic" is for bodies on such a line'
        )
    return int(spread.argmax())


def _check_loads(case: Case, axis: int) -> None:
    """Along the line bodies are free; nothing pushes free ones off it."""
    for i, body in enumerate(case.bodies):
        if body.motion[axis] != "free":
            raise InputError(
                f"bodies.{i}.velocity = {toml_text(body.velocity)}: bodies of the macroscopic model are free "
                'along their line; give "free" there'
            )
        for k, (motion, load, key) in enumerate(zip(body.motion, body.loads, body.keys, strict=True)):
            if k != axis and motion == "free" and not is_zero(load):
                raise refusal(f"bodies.{i}.{key}", load, "pushes the body off its line; drop it")
    for k, _ in enumerate(case.forces):
        raise InputError(f"forces.{k}: the macroscopic model knows only the forces of [[bodies]]; drop it")


def _check_parcels(case: Case, radii: Array) -> None:
    parts = case.macroscopic.parcels * radii / radii.sum()
    if np.abs(parts - np.rint(parts)).max() > _SAME * case.macroscopic.parcels:
        raise InputError(
            f"macroscopic.parcels = {case.macroscopic.parcels}: the diameters of the bodies are not whole "
            f"numbers of parcels; give a multiple of {len(radii)} for equal bodies"
        )


def check_reduced(case: Case) -> None:
    """Raise InputError, one line with key, value and remedy, for the first thing that cannot be."""
    if not case.bodies:
        raise InputError("bodies: missing; give [[bodies]], [[grids]] or bodies_from")
    _check_drag_file(case)
    if case.drag == 0.0 and case.masses() is None:
        raise InputError(
            "reduced.drag = 0: only lubrication would resist bodies without mass; give them drag or mass"
        )
    _check_estimates(case)
    _check_periodic(case)
    _check_tangential(case)
    _check_cutoff(case)
    _check_background(case)
    laws = {case.reduced.law, case.reduced.wall_law or case.reduced.law}
    literal = case.time is not None and case.time.scheme == "backward-euler"
    if literal and (laws != {"slides"} or case.reduced.cutoff is not None):
        raise InputError(
            f'reduced.law = "{case.reduced.law}": scheme "backward-euler" is for "slides" without a cutoff; '
            'use time.scheme = "distance"'
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
        raise InputError(f"{here}: there is no such file; `fsi resistance CASE --drag FILE` writes one")
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
    for key in sorted(file.laws.keys() | case.reduced.laws.keys()):
        theirs, ours = (laws.get(key) for laws in (file.laws, case.reduced.laws))
        if theirs != ours:
            raise InputError(
                f"{here}: found with reduced.{key} = {theirs or 'none'}, not {ours or 'none'}; give that, or "
                "calibrate one for this"
            )


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
    from fsi.lubrication.named_laws import LAWS

    if (cutoff := case.reduced.cutoff) is None:
        return
    for key in case.reduced.laws:
        name = getattr(case.reduced, key)
        if name in LAWS or not Path(name).is_file():
            continue
        file, here = read_law_file(Path(name)), f'reduced.{key} = "{name}"'
        try:
            smallest, largest = file.law().range
        except ValueError as error:
            raise InputError(f'{here}: {error}; give "leading"') from None
        a_r = _reduced_radii(case, file.ratio)
        low, high = smallest * a_r.max(initial=0.0), largest * a_r.min(initial=np.inf)
        if not low <= cutoff <= high and not case.reduced.extrapolate:
            raise InputError(
                f"reduced.cutoff = {cutoff:g}: {here} holds for gaps from {low:.6g} to {high:.6g} of these "
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
    for t in case.knots() or (0.0,):
        background(case.container(), case.wall_velocity(t))
