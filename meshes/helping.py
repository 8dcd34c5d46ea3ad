"""Rank 0 makes a mesh; the others, which wait for it, take a share of what it does many times.

What they do is a function of the package and what it is given, so that a mesh does not depend on how many
there are.
"""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager

import fsi.meshes.backend  # noqa: F401

from mpi4py import MPI

_helpers: list[int] = []  # ranks that wait for work


@contextmanager
def helped() -> Iterator[None]:
    """On rank 0 let the others help while this lasts; they leave `help_root` when it ends."""
    _helpers[:] = range(1, MPI.COMM_WORLD.size)
    try:
        yield
    finally:
        for rank in _helpers:
            MPI.COMM_WORLD.send(None, rank)
        _helpers.clear()


def help_root() -> None:
    """On another rank do what rank 0 asks for until it is done."""
    comm = MPI.COMM_WORLD
    while (asked := comm.recv(source=0)) is not None:
        comm.send(_done(*asked), 0)


def shared_out[T, R](function: Callable[[T], R], given: Sequence[T]) -> list[R]:
    """The results for all that is given, by rank 0 and those that help; raises the first error.

    function: one of a module, by whose name the others find it.
    """
    comm, ranks = MPI.COMM_WORLD, 1 + min(len(_helpers), len(given) - 1)
    for rank in range(1, ranks):
        comm.send((function, given[rank::ranks]), rank)
    parts = [_done(function, given[::ranks])]
    parts += [comm.recv(source=rank) for rank in range(1, ranks)]
    for _, error in parts:
        if error is not None:
            raise error
    return [parts[k % ranks][0][k // ranks] for k in range(len(given))]


def _done[T, R](function: Callable[[T], R], given: Sequence[T]) -> tuple[list[R], Exception | None]:
    """Results, or those before the first error and that: whoever waits for them must not wait for ever."""
    results: list[R] = []
    try:
        results += map(function, given)
    except Exception as error:  # rank 0 raises it
        return results, error
    return results, None
