"""Body-fitted meshes of the fluid domain: geometry in, `FluidMesh` out; no physics here."""

import os

# More threads slow small factorisations down and change the last bits; MPI is the way to use cores.
# It must be said before NumPy is loaded, whose own threads otherwise spin between two calls.
os.environ.setdefault("OMP_NUM_THREADS", "1")
