"""The command `fsi`: one module for each command, `main` runs them."""

from fsi.cli.main import main

__all__ = ["main"]
