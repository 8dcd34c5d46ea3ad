"""What the examples of the gallery take: `OMP_NUM_THREADS=1 python bench/gallery.py [NAME ...]`.

Each is run as a reader runs it, `python docs/examples/NAME.py`, loading included. The bench ends with exit
code 1 where one takes more than `--most` CPU seconds: nobody waits longer for an example.
"""

import argparse
import os
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))  # of a checkout that runs bench/gallery.py

from bench.processes import cpu_seconds

ROOT = Path(__file__).parents[1]
EXAMPLES = sorted(path.stem for path in (ROOT / "docs" / "examples").glob("*.py"))


def seconds(name: str, picture: Path) -> float:
    """CPU seconds of an example with those of the processes that it starts."""
    command = [sys.executable, str(ROOT / "docs" / "examples" / f"{name}.py"), str(picture)]
    return cpu_seconds(command, os.environ | {"PYTHONPATH": str(ROOT)}, picture.parent)


def main() -> int:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n\n")[1])
    parser.add_argument("names", nargs="*", metavar="NAME", help="of examples; all of them if none")
    parser.add_argument("--most", type=float, default=30.0, help="CPU seconds of one (30)")
    given = parser.parse_args()
    for name in given.names:
        if name not in EXAMPLES:
            parser.error(f"{name}: there is no such example; choose from {', '.join(EXAMPLES)}")
    longest = 0.0
    print("| example | CPU s |")
    print("|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for name in given.names or EXAMPLES:
            longest = max(longest, taken := seconds(name, Path(folder) / f"{name}.png"))
            print(f"| {name} | {taken:.1f} |", flush=True)
    return int(longest > given.most)


if __name__ == "__main__":
    sys.exit(main())
