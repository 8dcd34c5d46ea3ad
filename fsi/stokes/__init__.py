"""The resolved model: Stokes flow around rigid bodies, by finite elements (dolfinx)."""

import fsi.meshes.backend  # noqa: F401 before any module of this package imports dolfinx
