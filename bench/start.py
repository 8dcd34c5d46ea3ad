"""CPU seconds of whole processes, `fsi check` and `fsi solve` of one disc or another case: loading, mostly.

With another checkout its commands are run in turns with those of this one, by the same Python, and the
median of the ratios is printed: machines differ, and one differs from minute to minute. What Python makes
of the sources is kept, in a folder of its own, and made before the first run that counts.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
from pathlib import Path
from statistics import median

sys.path.insert(0, str(Path(__file__).parents[1]))  # of a checkout that runs bench/start.py

from bench.processes import cpu_seconds

HERE = Path(__file__).parents[1]
CASE = "cases/disc_in_box.toml"


def seconds(checkout: Path, command: str, case: str, compiled: str) -> float:
    """CPU seconds of a command of a checkout, on one thread; compiled: the folder of compiled sources."""
    environment = os.environ | {"PYTHONPATH": str(checkout), "OMP_NUM_THREADS": "1"}
    environment |= {"PYTHONDONTWRITEBYTECODE": "", "PYTHONPYCACHEPREFIX": compiled}
    return cpu_seconds([sys.executable, "-m", "fsi", command, str(checkout / case)], environment, checkout)


def row(command: str, case: str, times: int, other: Path | None, compiled: str) -> str:
    """A row of the table."""
    here, there = [], []
    for _ in range(1 + times):
        here.append(seconds(HERE, command, case, compiled))
        there += [seconds(other, command, case, compiled)] if other else []
    del here[0], there[:1]
    ratio = f"{median(a / b for a, b in zip(here, there, strict=True)):.2f}" if other else ""
    return f"| fsi {command} | {min(here):.2f} | {median(here):.2f} | {ratio} |"


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("other", nargs="?", type=Path, help="a checkout to compare with")
    parser.add_argument("--times", type=int, default=5, help="how often each is run (5)")
    parser.add_argument("--case", default=CASE, help=f"of both checkouts ({CASE})")
    given = parser.parse_args()
    other = given.other.resolve() if given.other else None
    print("| command | CPU s, least | median | of the other |")
    print("|---|---|---|---|")
    with tempfile.TemporaryDirectory() as compiled:
        for command in ("check", "solve"):
            print(row(command, given.case, given.times, other, compiled), flush=True)


if __name__ == "__main__":
    main()
