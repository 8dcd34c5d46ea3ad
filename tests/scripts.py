"""Python programs in a process of their own."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from textwrap import dedent

ROOT = Path(__file__).parents[1]


def script(lines: str) -> subprocess.CompletedProcess[str]:
    """What became of these lines, indented as they may be, in the root folder of the project."""
    command = [sys.executable, "-c", dedent(lines)]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
