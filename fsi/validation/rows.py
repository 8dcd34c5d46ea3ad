"""Validation: rows of computed values against references, their verdicts, and the files that keep them."""

import tomllib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from decimal import Decimal
from pathlib import Path

import numpy as np

from fsi.case.case import Case
from fsi.case.checks.expected import check_expected
from fsi.case.load import load_case, override, parse_case
from fsi.case.quantities import NUMBERS, gap_of, is_time
from fsi.case.section import nearest_word, toml_text
from fsi.case.sections import Expected
from fsi.errors import InputError
from fsi.files import csv_of, json_text, write_whole
from fsi.lubrication.exact_results import EXACT, ExactProblem
from fsi.lubrication.expansions import expansion
from fsi.lubrication.spheres import normal_resistance
from fsi.observables.quantities import component

EXACT_DIGITS = 1e-13  # relative error of the functions in `fsi.lubrication`


def reference(case: Case, row: Expected) -> tuple[float, float]:
    """The reference of a row, and its relative error: half a unit of the last digit given, of 0 none.

    Raises InputError: it is no number, or 0 of what is neither a load nor a velocity.
    """
    if row.exact is not None:
        value, digits = exact_value(case, row.exact, row.quantity), EXACT_DIGITS
    else:
        assert row.value is not None  # by the schema
        value, digits = row.value, _digits_of(row.value)
    if value == 0.0 and not _is_of_body(row.quantity):
        here = "value = 0.0" if row.exact is None else f'exact = "{row.exact}": is 0 here'
        raise InputError(
            f"{here}: the tolerance of {toml_text(row.quantity)} is relative to it; give a case where it is "
            "not 0, or a load or velocity"
        )
    return value, digits


def _digits_of(value: float) -> float:
    """Half a unit of the last digit over the value; symmetry gives 0 to all digits."""
    exponent = Decimal(repr(value)).as_tuple().exponent
    return 0.5 * 10.0 ** int(exponent) / abs(value) if value else EXACT_DIGITS


def _is_of_body(quantity: str) -> bool:
    """Whether it is a load or a velocity, of which a case has a largest one."""
    return quantity not in NUMBERS and not is_time(quantity)


def exact_value(case: Case, name: str, quantity: str) -> float:
    """What an exact result gives for a quantity of the case at time 0. Raises InputError: no number."""
    q = case.configuration()
    motion, far = case.motion_at(q, 0.0), case.wall_velocity(0.0).get("far")
    body, mode, gap = 0, 0, 0.0
    if is_time(quantity):
        gap = gap_of(quantity)
    else:
        body, mode = component(case, quantity)
    problem = ExactProblem(
        case.fluid.viscosity, q.centres, q.radii, motion.U, motion.F, case.container().size(),
        0.0 if far is None else far.shear, body, mode, gap,
        *_surfaces(case), case.bodies[0].half_axes, q.standing,
    )  # fmt: skip
    try:
        found = float(EXACT[name].value(problem))  # NumPy's are no JSON
    except ValueError as error:  # where the function is not known
        raise InputError(f'exact = "{name}": {error}; give a value') from None
    except Exception as error:  # it may be a user's
        said = f"{type(error).__name__}: {' '.join(str(error).split())}"
        raise InputError(f'exact = "{name}": its function fails ({said}); correct it') from error
    if np.isnan(found):
        raise InputError(f'exact = "{name}": is not known for the shape of {case.names[0]!r}; give a value')
    if np.isinf(found):
        raise InputError(f'exact = "{name}": its function gives {found}; correct it')
    return found


def _surfaces(case: Case) -> tuple[float, float, float]:
    """The slip lengths of the first body and of a round container, and B_1."""
    body = case.bodies[0]
    return body.slip_length or 0.0, case.wall_slip().get("far", 0.0), (body.surface_velocity or (0.0,))[0]


SPHERE = "sphere_wall_normal"
TERMS = {1: "leading", 2: "two-term", 3: "three-term"}
WIDEST_BAR = 10.0  # an error bar holds if the true error is between a tenth of it and all of it


type Record = dict[str, float | str | bool | None]


@dataclass(frozen=True, slots=True)
class Row:
    """One computed number and its reference. Errors are relative to the reference, where it is 0 to `scale`.

    Attributes:
        case: file name without suffix.
        sweep: value of the swept key, None without sweep.
        gap: smallest gap over smallest radius at time 0.
        quantity: of the expected row.
        value: as it was computed.
        mesh_error: estimated error of the elements (and of the time steps).
        truncation: of the finite container.
        reference: what the value should be.
        digits: how exact that is.
        rtol: the tolerance of the expected row.
        exact: the name of an exact result, or empty.
        source: of the reference.
        failure: why there is no value, or empty.
        scale: the largest load or velocity, in the unit of the value (`largest_of_kind`); nan of others.
    """

    case: str
    sweep: float | None
    gap: float
    quantity: str
    value: float
    mesh_error: float
    truncation: float
    reference: float
    digits: float
    rtol: float
    exact: str
    source: str
    failure: str = ""
    scale: float = np.nan

    @property
    def error_bar(self) -> float:
        """Estimated error, of all origins."""
        return self.mesh_error + self.truncation

    @property
    def true_error(self) -> float:
        """What it really is."""
        return abs(self.value - self.reference) / (abs(self.reference) or self.scale)

    @property
    def passed(self) -> bool:
        """Within the tolerance; a row without a value fails."""
        return self.true_error <= self.rtol

    @property
    def bar_holds(self) -> bool | None:
        """Whether the bar brackets the true error and is within a factor 10 of it.

        None where the true error is below the reference's own digits, so that it is not known.
        """
        if self.true_error <= self.digits:
            return None
        return self.true_error <= self.error_bar <= WIDEST_BAR * self.true_error

    @property
    def record(self) -> Record:
        """All of it, for JSON and CSV."""
        derived = ("error_bar", "true_error", "passed", "bar_holds")
        return asdict(self) | {name: getattr(self, name) for name in derived}


def chosen_cases(folder: Path, names: Sequence[str]) -> list[Path]:
    """The case files of these names in the folder, all of them if there are none. Raises InputError."""
    files = {path.stem: path for path in sorted(folder.glob("*.toml"))}
    if not files:
        remedy = "drop it for those that come with the program"
        raise InputError(f"--cases {folder}: no case files there; {remedy}")
    for name in names:
        if name not in files:
            raise InputError(f"{name}: no such validation case; the nearest is {nearest_word(name, files)}")
    return [files[name] for name in names or files]


def require_sound(paths: Sequence[Path]) -> None:
    """Raise InputError for the first case file that is not sound or lacks a reference, with its path."""
    for path in paths:
        for _, case in swept(path):
            with _blamed(path):
                for row in case.expected:
                    reference(case, row)


@contextmanager
def _blamed(path: Path) -> Iterator[None]:
    """An InputError names the file: a folder has many."""
    try:
        yield
    except InputError as error:
        said = str(error)
        raise InputError(said if said.startswith(f"{path}:") else f"{path}: {said}") from None


def swept(path: Path) -> Iterator[tuple[float | None, Case]]:
    """The case, or one for each value of its sweep. Raises InputError, with the path."""
    with _blamed(path):
        yield from _swept(path)


def _swept(path: Path) -> Iterator[tuple[float | None, Case]]:
    case = load_case(path)
    _require_comparable(path, case)
    if case.sweep is None:
        yield None, case
        return
    for value in case.sweep.values:
        data = tomllib.loads(case.as_toml())
        number = int(value) if value.is_integer() else value  # some keys take whole numbers only
        override(data, f"{case.sweep.key}={number!r}")
        changed = parse_case(data)
        check_expected(changed)
        yield value, changed


def _require_comparable(path: Path, case: Case) -> None:
    """Raise InputError unless the resolved flow gives every expected row, of an instant or of a run."""
    if case.model != "resolved":
        raise InputError(f'{path}: model = "{case.model}": only the resolved flow is validated; change it')
    if not case.expected:
        raise InputError(f"{path}: nothing to compare with; give it [[expected]] rows")
    check_expected(case)
    for i, row in enumerate(case.expected):
        here = f"{path}: expected.{i}.quantity = {toml_text(row.quantity)}"
        if case.time is not None and not is_time(row.quantity):
            raise InputError(f"{here}: a case with [time] is validated by `time at gap ...` alone; drop it")
        if case.time is None and is_time(row.quantity):
            raise InputError(f"{here}: is that of a run; add a section [time] with its end")
        if case.time is None and row.quantity.split(".")[1:2] == ["position"]:
            raise InputError(f"{here}: a position is given at time 0; expect a velocity or a force")


def of_spheres(rows: Sequence[Row]) -> list[Row]:
    """Those of a sphere that moves normal to a plane, with a force to compare."""
    return [row for row in rows if row.exact == SPHERE and not row.failure and row.reference != 0.0]


def sphere_records(rows: Sequence[Row]) -> list[Record]:
    """Resolved force of a sphere moving normal to a plane over 1, 2, 3 terms of its expansion at small gaps.

    The ratio to the exact force turns the expansions, of a unit sphere, into those of the row.
    """
    records: list[Record] = []
    for row in of_spheres(rows):
        s = np.array(row.gap)
        scale = row.value / row.reference * normal_resistance(s, 1.0, 1.0)
        record: Record = {"case": row.case, "gap/radius": row.gap, "resolved": row.value}
        for terms, name in TERMS.items():
            law = expansion("spheres", "squeeze", np.inf, terms)
            record[f"resolved/{name}"] = float(scale / law.value(s))
        records.append(record)
    return records


def write_rows(rows: Sequence[Row], folder: Path) -> None:
    """Write validation.json and validation.csv, and of a sphere beside a plane sphere_wall_ratios.csv.

    Each file appears whole. Raises InputError: the disk refuses.
    """
    records = [row.record for row in rows]
    write_whole(folder / "validation.json", json_text(records, indent=1) + "\n")
    write_whole(folder / "validation.csv", csv_of(records))
    if ratios := sphere_records(rows):
        write_whole(folder / "sphere_wall_ratios.csv", csv_of(ratios))
