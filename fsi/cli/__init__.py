"""The command `fsi`: one module for each command, `fsi.cli.main` runs them."""

import os

# Pydantic looks through all installed packages for plugins, of which the command uses none.
os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
