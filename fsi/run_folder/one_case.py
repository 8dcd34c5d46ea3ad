"""A run is one case: what is kept of it beside the run, and what of it may change when the run goes on."""

import json
from collections.abc import Iterator, Mapping
from hashlib import sha256
from pathlib import Path
from typing import Any

from fsi.case.case import Case
from fsi.case.load import named_files, read_toml
from fsi.case.section import toml_text
from fsi.errors import InputError
from fsi.files import digest_of

MAY_CHANGE = ("time.end", "output.interval", "output.fields")
_GOES_WITH_END = "time.smallest_step"
ABSENT = "none"
_NAMED = 5  # changes that a message lists
_BRIEF = 12  # digits of a digest there

type Changes = dict[str, tuple[object, object]]


def case_record(case: Case) -> dict[str, Any]:
    """What provenance.json keeps of a case: its data, and the SHA-256 of each file that it names by a key."""
    data = case.as_data()
    digests = {key: digest(path) for key, path in named_files(data)}
    record: dict[str, Any] = json.loads(json.dumps({"case": data, "files": digests}))
    return record


def identity(record: Mapping[str, Any]) -> str:
    """The digest of what stays of a case, by its record: the same as long as its run goes on."""

    def staying(section: str, values: Any) -> Any:
        match values:
            case dict():
                changing = (*MAY_CHANGE, _GOES_WITH_END)
                return {key: value for key, value in values.items() if f"{section}.{key}" not in changing}
            case _:
                return values

    case = {section: staying(section, values) for section, values in record["case"].items()}
    return digest_of({"case": case, "files": record["files"]})


def require_of_one_run(folder: Path, record: Mapping[str, Any], committed: str | None) -> None:
    """Raise InputError where a commit is that of another case than the record; those of older runs tell none.

    committed: the `identity` that it keeps.
    """
    if committed not in (None, identity(record)):
        raise InputError(
            f"{folder}: a run is one case, and state.npz is of another one than provenance.json; put the "
            "files of one run there, or run the case again into another folder"
        )


def changes(kept: Mapping[str, Any], case: Case) -> Changes:
    """The keys in which a case differs from the one that was kept, each with its old and its new value."""
    now = case_record(case)
    before, after = (
        {key: known[:_BRIEF] for key, known in record["files"].items()} for record in (kept, now)
    )
    of_files = {f"the file of {key}": values for key, values in _differences(before, after, "")}
    return {**dict(_differences(kept["case"], now["case"], "")), **of_files}


def require_one_case(folder: Path, changed: Changes, t: float) -> None:
    """Raise InputError of changes that a run at time t does not allow; the message names their keys."""
    _require_may_change(folder, changed)
    end = changed.get("time.end", (None, t))[1]
    if not isinstance(end, float | int) or end < t:
        raise InputError(f"time.end = {toml_text(end)}: the run is at t = {t:g} already; give a later end")


def require_same_keys(folder: Path, kept: Mapping[str, Any], data: Mapping[str, Any]) -> None:
    """Raise InputError where data of a case, sound or not, differ from the kept one in a key that stays."""
    now: Any = json.loads(json.dumps(data, default=str))
    _require_may_change(folder, dict(_differences(kept["case"], now, "")))


def _require_may_change(folder: Path, changed: Changes) -> None:
    """Raise InputError of changes of other keys than those that may; the message names them."""
    refused = [
        f"{key} = {_text(old)} -> {_text(new)}"
        for key, (old, new) in changed.items()
        if key not in MAY_CHANGE
    ]
    if refused:
        more = f" (and {len(refused) - _NAMED} more)" if len(refused) > _NAMED else ""
        raise InputError(
            f"{folder}: a run is one case, and this is not the one it began with: "
            f"{', '.join(refused[:_NAMED])}{more}; put the old values back, or run the changed case into "
            f"another folder; only {', '.join(MAY_CHANGE[:-1])} and {MAY_CHANGE[-1]} may change"
        )


def require_as_written(folder: Path, kept: Mapping[str, Any], case_file: Path) -> None:
    """Raise InputError where a case file in the folder of a run is not the one that its record keeps.

    Both are compared as they are written, without defaults, of which another version may have other ones.
    The files that a case names may be elsewhere by now, or gone: a run that has been made needs none.
    """
    written: Any = json.loads(json.dumps(read_toml(case_file), default=str))
    found = dict(_differences(kept["case"], written, ""))
    require_one_case(folder, {key: change for key, change in found.items() if key not in kept["files"]}, 0.0)


def _differences(old: Any, new: Any, key: str) -> Iterator[tuple[str, tuple[object, object]]]:
    """Dotted keys with the old and the new value, of data as JSON has them."""
    match old, new:
        case dict(), dict():
            for part in {**old, **new}:
                inner = f"{key}.{part}" if key else part
                yield from _differences(old.get(part, ABSENT), new.get(part, ABSENT), inner)
        case [{}, *_], [{}, *_] if len(old) == len(new):
            for number, (one, other) in enumerate(zip(old, new, strict=True)):
                yield from _differences(one, other, f"{key}.{number}")
        case _ if old != new:
            yield key, (old, new)


def _text(value: object) -> str:
    """A value as a message has it; of a list of sections how many there are."""
    match value:
        case [{}, *_]:
            return f"{len(value)} sections"
        case str() if value == ABSENT:
            return ABSENT
        case _:
            return toml_text(value)


def digest(path: Path) -> str:
    """The SHA-256 of a file, or the word for none."""
    return sha256(path.read_bytes()).hexdigest() if path.is_file() else ABSENT
