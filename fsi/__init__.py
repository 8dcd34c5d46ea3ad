"""Rigid bodies moving in Stokes flow, resolved down to the lubrication film."""

import meshes as meshes  # before NumPy: it sets the number of threads
