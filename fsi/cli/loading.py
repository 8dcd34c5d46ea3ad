"""Loading what a command needs, without a look for cycles in it, and not broken off in the middle."""

import gc
from collections.abc import Iterator
from contextlib import contextmanager

from fsi.machine.signals import held


@contextmanager
def loading() -> Iterator[None]:
    """For imports: no looks for cycles, and Ctrl-C holds afterwards."""
    with kept(), held():
        yield


@contextmanager
def kept() -> Iterator[None]:
    """Python looks for no cycles meanwhile, nor later in what is there then; Ctrl-C holds at once.

    What is loaded stays, and looks at it take a sixth of `fsi check` and of `fsi solve` of one disc.
    """
    looks = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        gc.freeze()
        if looks:
            gc.enable()
