"""`fsi search`: the value of a key for which a quantity of a case has a given value."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

import fsi.parallel as parallel
from fsi.case.magnitudes import LARGEST, SMALLEST
from fsi.case.quantities import names_of_quantities
from fsi.cli.arguments import AsJson, CaseFile, Overrides, option, output_to, require_writable, warn
from fsi.errors import InputError, SolveError
from fsi.files import json_text
from fsi.report.console import standard_output

if TYPE_CHECKING:
    from fsi.studies.search import KeyTrial

EXAMPLE = (
    'Example: fsi search cases/slides/columns.toml --quantity "apparent viscosity" --target 6.54 '
    "--vary arrangement.angle=93.0,96.0"
)


def search(
    case_file: CaseFile,
    quantity: Annotated[
        str,
        option(f"What shall have the target, as in [[expected]] rows: {names_of_quantities(of_run=False)}."),
    ],
    target: Annotated[str, option("The value that it shall have, to the digits that are given.")],
    vary: Annotated[
        str,
        option("A key and its interval; whole numbers are tried one by one.", metavar="KEY=LOW,HIGH"),
    ],
    output: Annotated[Path | None, output_to("A case file (TOML) with the value that is found.")] = None,
    as_json: AsJson = False,
    overrides: Overrides = None,
) -> None:
    """Find a case in which a quantity has a given value, by changing one key.

    The target is reached where the quantity differs from it by no more than half a unit of its last digit:
    2.45 takes 2.445 to 2.455. One that is out of reach is refused, with the range that was reached. A note
    tells where the error bar of what is found is larger than that.
    """
    from fsi.case.load import case_data, saved_data
    from fsi.report.progress import counting
    from fsi.report.studies import print_search
    from fsi.studies.keys import require_apart
    from fsi.studies.search import Search, most_trials

    if output is not None:
        require_writable(output)
    key, low, high = _interval(vary)
    _require_between(key, low, high, vary)
    require_apart([key], overrides or ())
    value, tolerance = _digits(target)

    def data(x: float) -> dict[str, Any]:
        return case_data(case_file, overrides or (), {key: x})

    wanted = Search(key, low, high, value, tolerance, lambda x: _trial(data, key, x, quantity))
    with counting("trials") as show:
        for _ in wanted.trying():
            show(len(wanted.trials), most_trials(low, high))
    found = wanted.found()
    if output is not None:
        # Expected numbers are those of the case as it was.
        kept = {section: values for section, values in data(found.value).items() if section != "expected"}
        parallel.on_root(lambda: saved_data(kept, output))
    if not parallel.is_root():
        return
    trials = [[trial.value, trial.quantity] for trial in wanted.trials]
    if as_json:
        known = {"key": key, "value": found.value, "quantity": found.quantity, "error": found.error}
        typer.echo(json_text(known | {"trials": trials}))
    else:
        print_search(standard_output(), key, quantity, wanted.trials)
    if output is not None and not as_json:
        typer.echo(f"wrote {output}")
    if found.error is not None and found.error > tolerance:
        warn(_wide(found.error, tolerance))


def _wide(error: float, tolerance: float) -> str:
    """What is said of an error bar beyond the digits of the target."""
    return (
        f"the error bar {error:.0e} is {error / tolerance:.2g} times {tolerance:g}, half a unit of the last "
        "digit of the target; give fewer digits or, for a narrower one, more pores.modes, a finer mesh or a "
        "tolerance"
    )


def _interval(text: str) -> tuple[str, float, float]:
    """The key and both ends; both whole numbers, or both not. Raises InputError."""
    key, _, ends = (part.strip() for part in text.partition("="))
    words = ends.split(",")
    try:
        numbers = [int(w) for w in words] if all(map(_is_whole, words)) else [float(w) for w in words]
    except ValueError:
        numbers = []
    if not key or len(numbers) != 2 or not numbers[0] < numbers[1] < float("inf"):
        raise InputError(f"--vary {text}: no key and interval; write KEY=LOW,HIGH, LOW below HIGH")
    return key, numbers[0], numbers[1]


def _require_between(key: str, low: float, high: float, vary: str) -> None:
    """Raise InputError where a key has choices and others would be tried: nothing is between them."""
    from fsi.case.case import Case
    from fsi.case.complaints import choices_of

    choices = choices_of(key, Case)
    if choices and not set(range(int(low), int(high) + 1)) <= set(choices):
        told = f"{key} is one of {', '.join(map(str, choices))}"
        raise InputError(f"--vary {vary}: {told}, with nothing between; use `fsi sweep --vary {key}=A,B,C`")


def _is_whole(word: str) -> bool:
    return re.fullmatch(r"\s*\d+\s*", word) is not None


def _digits(text: str) -> tuple[float, float]:
    """A number and half a unit of the last digit that it is written with. Raises InputError."""
    if not re.fullmatch(r"-?\d+(\.\d*)?([eE][-+]?\d{1,9})?", text):
        raise InputError(f"--target {text}: not a number; give one with as many digits as it shall have")
    mantissa, _, exponent = text.lower().partition("e")
    decimals = len(mantissa.partition(".")[2])
    value, half_unit = float(text), float(f"5e{int(exponent or 0) - decimals - 1}")
    if half_unit > LARGEST or not (SMALLEST <= abs(value) <= LARGEST or value == 0.0 < half_unit):
        bounds = f"{SMALLEST:g} to {LARGEST:g} in size"
        raise InputError(f"--target {text}: too small or too large for numbers, {bounds}; give other units")
    return value, half_unit


def _trial(data: Callable[[float], dict[str, Any]], key: str, value: float, quantity: str) -> KeyTrial:
    """The quantity of the case with that value of the key; collective."""
    from fsi.case.load import parse_case
    from fsi.studies.evaluate import require_quantity
    from fsi.studies.search import trial_of

    with _told_with(key, value):
        case = parallel.on_root(lambda: parse_case(data(value)))
    parallel.on_root(lambda: require_quantity(case, quantity))
    with _told_with(key, value):
        return trial_of(case, value, quantity)


@contextmanager
def _told_with(key: str, value: float) -> Iterator[None]:
    """Errors begin with the key that is varied and its value, unless they tell of it."""
    try:
        yield
    except (InputError, SolveError) as error:
        said = str(error)
        tells = said.startswith((key, f"--vary {key}"))
        raise type(error)(said if tells else f"{key} = {value!r}: {said}") from error
