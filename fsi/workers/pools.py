"""What takes the runs of a study: processes on this machine, or the workers of a Dask cluster."""

from collections.abc import Callable, Iterator
from concurrent.futures import Executor, ThreadPoolExecutor
from contextlib import AbstractContextManager, contextmanager

from fsi.errors import InputError
from fsi.workers.launch import end_runs

# Opens what takes runs.
type Pool = Callable[[], AbstractContextManager[Executor]]

_PATIENCE = 10.0  # seconds, for a scheduler and its first worker


@contextmanager
def local(workers: int) -> Iterator[Executor]:
    """So many processes at a time on this machine."""
    with ThreadPoolExecutor(workers) as pool:
        try:
            yield pool
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            end_runs()
            raise


@contextmanager
def cluster(address: str) -> Iterator[Executor]:
    """The workers of a Dask scheduler. Raises InputError: none answers there, or it has no workers."""
    here = f"--scheduler {address}"
    try:
        from distributed import Client
    except ModuleNotFoundError:
        raise InputError(f"{here}: needs Dask; pip install 'fsi-stokes[cluster]'") from None
    try:
        client = Client(address, timeout=_PATIENCE, set_as_default=False)
    except (OSError, ValueError, TimeoutError):
        raise InputError(
            f"{here}: no scheduler answers there; start one with `dask scheduler`, it prints its address"
        ) from None
    with client:
        try:
            client.wait_for_workers(1, timeout=_PATIENCE)
        except TimeoutError:
            raise InputError(f"{here}: has no workers; start some with `dask worker {address}`") from None
        with client.get_executor(pure=False) as pool:
            yield pool
