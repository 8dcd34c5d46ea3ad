"""What is said before loops are compiled, which is done where no earlier program has kept them."""

import logging
from functools import cache
from pathlib import Path
from typing import Any

from fsi.parallel import is_root
from fsi.pores.power import insert

NOTE = (
    "note: compiling the loops of pores, once for this installation; the minute or two that it takes count "
    "as seconds of this command"
)


@cache
def tell_of_compilation() -> None:
    """Say so once, on root, where nothing is kept; on stderr but where logging goes elsewhere."""
    stats: Any = getattr(insert, "stats", None)  # None where Numba is told to compile nothing
    if stats is not None and is_root() and not any(Path(stats.cache_path).glob("*.nbi")):
        logging.getLogger("fsi").warning(NOTE)
