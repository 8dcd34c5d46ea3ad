"""What is asked of an arrangement, checked: the options of its kind, numbers within their ranges."""

from collections.abc import Callable, Mapping
from typing import Any

from fsi.arrangements.arrangement import Wanted
from fsi.arrangements.kinds import KINDS
from fsi.arrangements.names import CellKind, Kind
from fsi.errors import InputError

type Spelling = Callable[[str, Any], str]

SMALLEST, LARGEST = 1e-50, 1e50  # as in a case: volumes of what is larger are no numbers
_SPREADS = {"equal": 0.0, "bidisperse": 1.4, "lognormal": 0.2}  # unless it is given


def wanted(kind: Kind, common: Mapping[str, Any], options: Mapping[str, Any], spelled: Spelling) -> Wanted:
    """All values, checked, and what holds for those that are not given.

    Args:
        kind: of the arrangement.
        common: number, fraction, radius, gap, cell.
        options: those of the kind that were given.
        spelled: how the user writes the option of a name with a value.

    Raises InputError: the kind has no such option, or a number is out of range.
    """
    _require_options(kind, options, spelled)
    _require_consistent(options, spelled)
    filled = (
        {"spread": _SPREADS[options.get("sizes", "equal")], "dimension": KINDS[kind].dimension}
        | _shape(kind, common["number"], common["cell"])
        | dict(options)
    )
    asked = Wanted(**common, **filled)
    _require_ranges(asked, spelled)
    return asked


def _require_options(kind: Kind, options: Mapping[str, Any], spelled: Spelling) -> None:
    """Raise InputError where the kind has no such option."""
    for name, value in options.items():
        if name not in KINDS[kind].options:
            takes = ", ".join(KINDS[kind].options) or "none"
            raise InputError(
                f"{spelled(name, value)}: {kind} has no such option; drop it ({kind} takes {takes})"
            )


def _require_consistent(options: Mapping[str, Any], spelled: Spelling) -> None:
    """Raise InputError where one option leaves another no meaning."""
    if "spread" in options and options.get("sizes", "equal") == "equal":
        given, remedy = (spelled(*each) for each in (("spread", options["spread"]), ("sizes", "bidisperse")))
        raise InputError(f"{given}: the radii are equal; give {remedy} or lognormal")
    if options.get("shape", "disc") == "disc":
        for name in ("ratio", "aligned"):
            if name in options:
                remedy = spelled("shape", "ellipse")
                raise InputError(f"{spelled(name, options[name])}: discs have none; give {remedy} or rod")
    elif options.get("dimension", 2) == 3:
        given, remedy = (spelled(*each) for each in (("shape", options["shape"]), ("dimension", 2)))
        raise InputError(f"{given}: is for the plane; give {remedy}, or drop it")


def _require_ranges(asked: Wanted, spelled: Spelling) -> None:
    """Raise InputError where a number is out of range."""
    for name, value, least in (
        ("area_fraction", asked.fraction, 0.0), ("radius", asked.radius, 0.0), ("gap", asked.gap, 0.0),
        ("aspect", asked.aspect, 0.0), ("spread", asked.spread, 1.0 if asked.sizes == "bidisperse" else 0.0),
        ("ratio", asked.ratio, 1.0), ("aligned", asked.aligned or 0.0, -360.0),
    ):  # fmt: skip
        at_least = name in ("gap", "spread", "aligned")
        if not least <= value <= LARGEST or (value == least and not at_least) or 0.0 < value < SMALLEST:
            bounds = f"a number of {least:g} or more" if at_least else f"a number above {least:g}"
            size = f"from {SMALLEST:g} to {LARGEST:g} in size"
            raise InputError(f"{spelled(name, value)}: out of range; give {bounds}, {size}")
    if asked.fraction >= 1.0:
        given = spelled("area_fraction", asked.fraction)
        raise InputError(f"{given}: bodies cannot fill all; give a number below 1")


def _shape(kind: Kind, number: int, cell: CellKind) -> dict[str, Any]:
    """Rows, length and angle where they are not given; rows of a periodic hexagonal array are even."""
    if kind == "chains":
        return {"rows": 1, "length": 4, "angle": 135.0}
    step = 2 if kind == "hexagonal" and cell == "periodic" and number % 2 == 0 else 1
    suitable = (k for k in range(step, number + 1, step) if number % k == 0)
    middle = min(suitable, key=lambda k: abs(k - number**0.5))
    return {"rows": middle, "length": middle, "angle": 90.0}
