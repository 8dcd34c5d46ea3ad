"""The command line in this process."""

from __future__ import annotations

import sys
from unittest import mock

from fsi.cli.main import main


def fsi_command(*arguments: object) -> int:
    """Run `fsi` with these arguments; its exit code."""
    with mock.patch.object(sys, "argv", ["fsi", *map(str, arguments)]):
        return main()
