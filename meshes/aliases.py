"""dolfinx's generic types at double precision, named once."""

import fsi.meshes.backend  # noqa: F401

import numpy as np
from dolfinx import fem, mesh

type Mesh = mesh.Mesh[np.float64]
type FunctionSpace = fem.FunctionSpace[np.float64]
type Form = fem.Form[np.float64]
