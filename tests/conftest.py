"""For all tests: load the project before NumPy, as the command line does, so that it runs on one thread."""

from hypothesis import settings

import fsi as fsi

# A busy machine is not a defect: nothing is judged by the clock.
settings.register_profile("untimed", deadline=None)
settings.load_profile("untimed")
