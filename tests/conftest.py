"""For all tests: load the project before NumPy, as the command line does, so that it runs on one thread."""

import fsi as fsi
