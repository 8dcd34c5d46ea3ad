"""`python -m fsi` is the command `fsi`."""

import sys

from fsi.cli import main

sys.exit(main())
