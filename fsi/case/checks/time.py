"""What the section [time] of a case must satisfy: bodies that move, a scheme that suits, no jumps."""

from collections.abc import Iterator

from fsi.bodies.gaps import nearest_gaps
from fsi.bodies.resolved_gaps import LEAST, ROUNDING
from fsi.case.case import Case
from fsi.case.section import hint_of_own, nearest_word, refusal, toml_text
from fsi.case.series import Table, jumps
from fsi.errors import InputError


def check_time(case: Case) -> None:
    """Raise InputError, one line with key, value and remedy, for the first thing that cannot be."""
    if case.level.viscous:
        _check_jumps(case)
    if case.time is None:
        return
    end, smallest = case.time.end, case.time.smallest_step
    if not case.bodies and case.model != "macroscopic":
        raise InputError(f"time.end = {end!r}: there are no bodies to move; add [[bodies]] or drop [time]")
    if smallest >= end:
        raise InputError(f"time.smallest_step = {smallest!r}: not below time.end = {end!r}; make it smaller")
    first = case.time.first_step
    if first is not None and first < smallest:
        raise InputError(
            f"time.first_step = {first!r}: below time.smallest_step = {smallest!r}; make it longer, or that "
            "smaller"
        )
    _check_scheme(case)
    _check_contact(case)


def _check_contact(case: Case) -> None:
    """A viscous fluid takes part in what is extrapolated; the gap closes to it, and that is resolved.

    The step that comes to it closes more of the gap, and its end must be resolved too.
    """
    least = case.timing.contact_gap
    if least is None:
        return
    here = f"time.contact_gap = {least!r}"
    if not case.level.viscous:
        raise InputError(f'{here}: model = "{case.model}" has contacts of its own; drop it')
    if not case.bodies:
        return
    smallest = LEAST * float(case.configuration().radii.min())
    smallest /= 1.0 - case.timing.gap_loss if case.level.flow else 1.0
    if least < (1.0 - ROUNDING) * smallest:
        what = f"a step from it ends below {LEAST:g} radii, the least gap that is resolved"
        raise InputError(f"{here}: {what}; give {smallest:.3g}")
    start = nearest_gaps(case.configuration(), case.container()).smallest()
    if least >= start:
        raise InputError(
            f"{here}: the smallest gap at the start is {start:.6g}, no wider; give a smaller one"
        )


def _check_scheme(case: Case) -> None:
    time = case.timing
    if not case.level.viscous:
        if time.scheme is not None:
            raise refusal(
                "time.scheme", time.scheme, f'model = "{case.model}" has a scheme of its own; drop it'
            )
        _require_step(case, f'model = "{case.model}"')
        return
    from fsi.integration.schemes import SCHEMES

    if time.scheme is not None and time.scheme not in SCHEMES:
        nearest = nearest_word(time.scheme, SCHEMES)
        raise InputError(
            f"time.scheme = {toml_text(time.scheme)}: there is no such scheme; the nearest is {nearest!r}, "
            f"of {', '.join(SCHEMES)}{hint_of_own(time.scheme, SCHEMES)}"
        )
    scheme = case.scheme
    here = f"time.scheme = {toml_text(scheme.name)}"
    if case.model not in scheme.models:
        raise InputError(
            f'{here}: is not for model = "{case.model}"; drop it or give model = "{scheme.models[0]}"'
        )
    if scheme.fixed:
        _require_step(case, f'scheme "{scheme.name}"')
    if scheme.inertia == "none" and case.masses() is not None:
        raise InputError(f"{here}: is for bodies without mass; drop it or their masses")
    if scheme.inertia == "all" and (massless := free_without_mass(case)):
        raise InputError(
            f"bodies.{massless[0]}.mass: missing; {here} is for bodies with inertia: give each that is not "
            "held in all modes a mass, or another scheme"
        )


def free_without_mass(case: Case) -> list[int]:
    """The bodies without mass of which any mode is free, so that one would count."""
    free = ~case.held().all(axis=1)
    return [i for i, body in enumerate(case.bodies) if free[i] and body.mass is None]


def _require_step(case: Case, what: str) -> None:
    step, end = case.timing.step, case.timing.end
    if step is None:
        raise InputError(f"time.step: missing; {what} needs the length of its steps, a number > 0")
    if step > end:
        raise InputError(f"time.step = {step!r}: longer than time.end = {end!r}; make it shorter")


def _check_jumps(case: Case) -> None:
    """Only steps that take the integral of a load cross its jumps."""
    for key, series in _tables(case):
        for t in jumps(series):
            raise InputError(
                f'{key}: jumps at t = {t:g}, which model = "{case.model}" does not step over; give a steep '
                f"ramp, times {t:g} and a little later"
            )


def _tables(case: Case) -> Iterator[tuple[str, float | Table | str]]:
    for i, body in enumerate(case.bodies):
        for part in body.motion:
            yield f"bodies.{i}.velocity", part
        for key, part in zip(body.keys, body.loads, strict=True):
            yield f"bodies.{i}.{key}", part
    for k, force in enumerate(case.forces):
        weight = force.weight(case.bulk())
        for part in () if weight is None else weight[1]:
            yield f"forces.{k}.acceleration", part
    for name, wall in case.domain.walls.items():
        for part in wall.series():
            yield f"domain.walls.{name}", part
