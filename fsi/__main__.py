"""`python -m fsi` is the command `fsi`."""

import sys

from fsi.cli.main import main

sys.exit(main())
