"""What tells a process that it is a rank, and is kept from those that it starts."""

import os

import pytest

from fsi.machine.ranks import forget


def test_processes_of_a_lone_rank_are_no_ranks(monkeypatch: pytest.MonkeyPatch) -> None:
    """`mpiexec -n 1 fsi calibrate` ended as they looked for its MPI by what it had told them."""
    monkeypatch.setattr(os, "environ", {"PMI_FD": "6", "PMIX_RANK": "0", "HOME": "/home"})
    forget()
    assert os.environ == {"HOME": "/home"}
