"""Where the commands print their tables."""

from __future__ import annotations

import os
import sys

from rich.console import Console

import fsi.parallel as parallel

# Of the widest table: without a terminal rich would cut numbers to fit 80 columns.
WIDTH = 140


def standard_output() -> Console:
    """Standard output, as wide as the terminal or as COLUMNS says; without either, wide enough."""
    known = sys.stdout.isatty() or "COLUMNS" in os.environ
    return Console(width=None if known else WIDTH)


def standard_error() -> Console:
    """Standard error, silent on all ranks but root."""
    return Console(stderr=True, quiet=not parallel.is_root())
