"""`fsi validate` by processes of their own: each case, or each value of its sweep, is one part.

A part has a folder beside the runs: `request.json` says which case file and which value, `rows.json` has the
rows that came of it. Numbers go through JSON as they are, so that the rows are those of one process.
"""

import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from pathlib import Path

from fsi.files import json_of, replace
from fsi.validation.resolved import Solve, failed_rows, rows_at
from fsi.validation.rows import Row, swept
from fsi.workers.launch import outcomes
from fsi.workers.pools import Pool

COMMAND = "validate-run"
REQUEST, ROWS, _REMEDY = "request.json", "rows.json", "validate again"


def handed_out(pool: Pool) -> Solve:
    """What has the parts solved there, and gives their rows in their order as soon as they are complete."""

    def solve(paths: Sequence[Path], runs: Path) -> Iterator[list[Row]]:
        asked = [_asked(path, k, runs.absolute()) for path in paths for k, _ in enumerate(swept(path))]
        done = dict[Path, str]()
        with pool() as open_pool:
            for folder, failure in outcomes(open_pool, COMMAND, asked):
                done[folder] = failure
                while asked and asked[0] in done:
                    yield _rows(asked[0], done[asked.pop(0)])

    return solve


def compute_part(folder: Path) -> None:
    """Solve the part that is asked for in a folder. Raises InputError: the case is not sound."""
    path, k, runs = _request(folder)
    value, case = list(swept(path))[k]
    rows = rows_at(path.stem, value, case, runs)
    replace(folder / ROWS, json.dumps([asdict(row) for row in rows]).encode())


def _asked(path: Path, k: int, runs: Path) -> Path:
    folder = runs.with_name("parts") / f"{path.stem}-{k}"
    folder.mkdir(parents=True)
    request = {"case": str(path.absolute()), "value": k, "runs": str(runs)}
    replace(folder / REQUEST, json.dumps(request).encode())
    return folder


def _request(folder: Path) -> tuple[Path, int, Path]:
    asked = json_of(folder / REQUEST, _REMEDY)
    return Path(asked["case"]), asked["value"], Path(asked["runs"])


def _rows(folder: Path, failure: str) -> list[Row]:
    if failure:  # of the process: a solve that fails has rows that say so
        path, k, _ = _request(folder)
        value, case = list(swept(path))[k]
        return failed_rows(path.stem, value, case, failure)
    return [Row(**row) for row in json_of(folder / ROWS, _REMEDY)]
