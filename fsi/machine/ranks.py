"""Whether this process is one of several ranks: known before MPI is loaded."""

import os


def _told() -> list[str]:
    """What tells a rank which it is: PMI_RANK, PMIX_RANK, OMPI_COMM_WORLD_RANK, PALS_RANKID and others."""
    return [name for name in os.environ if "PMI" in name or "RANK" in name]


STARTED = bool(_told())


def forget() -> None:
    """Let the processes that a lone rank starts be none: they would look for its MPI, and not find it."""
    for name in _told():
        del os.environ[name]
