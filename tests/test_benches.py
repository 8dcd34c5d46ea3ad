"""What docs/speed.md names runs from a checkout as it says, `python bench/X.py`, here at its smallest."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
SMALLEST = {
    "step": ["0.1", "--settings", "P2"],
    "suspension": ["10", "50", "--growth", "1"],
    "reduced": ["200", "--scheme", "distance"],
    "gluey": ["agitated", "100", "--steps", "1"],
    "gallery": ["film_pressure", "--most", "1000"],
}
AGAINST_ITSELF = [
    str(ROOT),
    *["--turns", "1", "--most", "9", "--discs", "1", "--gap", "0.1", "--sphere", "P2", "--ranks", "2"],
]
SLOW = {
    "start": ["--times", "1"],
    "against": AGAINST_ITSELF,
    "space": ["P2"],
    "pore_speed": ["50", "--modes", "1", "--resolved", "1"],
}


@pytest.mark.parametrize("name", [*SMALLEST, *(pytest.param(name, marks=pytest.mark.slow) for name in SLOW)])
def test_a_bench_of_the_page_on_speed_runs_from_anywhere(name: str, tmp_path: Path) -> None:
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    command = [sys.executable, str(ROOT / "bench" / f"{name}.py"), *(SMALLEST | SLOW)[name]]
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("\n") >= 3
