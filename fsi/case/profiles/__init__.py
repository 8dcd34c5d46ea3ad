"""Shapes of walls in the plane, one file each; all files of this room are read."""

from importlib import import_module
from pkgutil import iter_modules

for module in iter_modules(__path__):
    import_module(f"{__name__}.{module.name}")
