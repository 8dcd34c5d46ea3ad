"""The command `fsi`: one module for each command, `fsi.cli.main` runs them."""

import sys
from types import ModuleType

# Pydantic looks through all installed packages for plugins, of which the command uses none, and loads what
# reads e-mails for that: a twentieth of `fsi check`. This stands for the module that does it.
_no_plugins = ModuleType("pydantic.plugin._loader")
vars(_no_plugins)["get_plugins"] = tuple
sys.modules[_no_plugins.__name__] = _no_plugins
