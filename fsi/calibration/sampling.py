"""All samples of a calibration, several at a time, none twice: a cache keeps each of them for ever."""

import hashlib
import json
import multiprocessing
import os
import shutil
import signal
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from importlib import metadata
from multiprocessing.connection import wait
from pathlib import Path

import numpy as np

import fsi.parallel as parallel
from fsi.calibration.finding import pair_of
from fsi.calibration.own_code import own_code
from fsi.calibration.pair import Pair, planned_gaps
from fsi.calibration.samples import Sample, keep_sample, read_sample
from fsi.case.load import parse_case
from fsi.errors import FsiError, SolveError
from fsi.files import digest_of, json_of, replace
from fsi.integration.errors import ErrorEstimate
from fsi.machine.ranks import forget
from fsi.models import flow_solvers, make_model
from fsi.observables.truncation import halved
from fsi.workers.launch import outcomes
from fsi.workers.pools import Pool

_PACKAGE, _SOURCES = Path(__file__).parents[1], (".py", ".c", ".h")
# What computes a sample besides its case.
_SOLVERS = ("fenics-dolfinx", "dolfinx-solver-real", "gmsh", "petsc4py", "numba")


def key_of(pair: Pair, gap: float) -> str:
    """What names a sample: a hash of the case at the gap, of the mode, and of all code, the user's too."""
    case = pair.at(gap).model_dump(mode="json", exclude={"name"})
    content = {"case": case, "pair": pair.plan.pair, "mode": pair.plan.mode, "code": _code()}
    return digest_of(content | {"own": own_code(pair.case)})


def _code() -> str:
    """Hash of the sources of the program, and the versions of the libraries that compute a flow."""
    sources = hashlib.sha256()
    folders = _PACKAGE.walk(follow_symlinks=True)  # in a checkout some are links
    files = sorted(folder / name for folder, _, names in folders for name in names)
    for path in files:
        if path.suffix in _SOURCES:
            sources.update(path.read_bytes())
    for name in _SOLVERS:
        try:
            sources.update(f"{name} {metadata.version(name)}".encode())
        except metadata.PackageNotFoundError:  # one of two names of the same library
            continue
    return sources.hexdigest()


type Task = tuple[float, bool, str]  # gap, held out, key
type Outcome = tuple[str, Sample | None, str]  # key, sample, why there is none


@dataclass(frozen=True, slots=True)
class Sampling:
    """How samples are taken.

    Attributes:
        cache: folder of all samples ever computed.
        workers: local processes; on several ranks they work together on one sample after the other instead.
        show: is told how many samples there are of how many.
        cluster: opens what takes them instead, anywhere the cache is seen; None: this machine.
    """

    cache: Path
    workers: int = 1
    show: Callable[[int, int], None] = lambda *_: None
    cluster: Pool | None = None


def take_samples(pair: Pair, sampling: Sampling) -> list[Sample]:
    """The samples that the case asks for, in increasing gaps; collective.

    Each is kept as soon as it is there, so that a killed calibration goes on where it was. Raises SolveError:
    some samples failed; the message names the first. All others are in the cache.
    """
    tasks = [(gap, held_out, key_of(pair, gap)) for gap, held_out in planned_gaps(pair)]
    samples = parallel.on_root(lambda: _cached(tasks, sampling.cache))
    missing = [task for task in tasks if task[2] not in samples]
    failures: list[str] = []
    sampling.show(len(samples), len(tasks))
    for key, sample, failure in _computed(pair, missing, sampling):
        if sample is None:
            failures.append(failure)
        else:
            samples[key] = sample
        sampling.show(len(samples) + len(failures), len(tasks))
    if failures:
        failed = f"{len(failures)} of {len(tasks)} samples failed, first {failures[0]}"
        raise SolveError(f"{failed}; the others are kept")
    return sorted(samples.values(), key=lambda sample: sample.gap)


def _cached(tasks: list[Task], cache: Path) -> dict[str, Sample]:
    cache.mkdir(parents=True, exist_ok=True)
    samples = {key: read_sample(cache, key, gap, held_out=held_out) for gap, held_out, key in tasks}
    return {key: sample for key, sample in samples.items() if sample is not None}


def _computed(pair: Pair, tasks: list[Task], sampling: Sampling) -> Iterator[Outcome]:
    cache, workers = sampling.cache, sampling.workers
    if sampling.cluster is not None and tasks:
        yield from _handed_out(pair, tasks, cache, sampling.cluster)
        return
    if parallel.size() > 1 or workers == 1 or len(tasks) < 2:
        yield from (_compute(pair, task, cache) for task in tasks)
        return
    case = pair.case.model_dump(exclude_none=True)
    # Started afresh: a fork would share the parent's MPI.
    forget()
    fresh = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(min(workers, len(tasks)), fresh, _leave_with_parent) as pool:
        try:
            running = [pool.submit(_compute_case, case, task, cache) for task in tasks]
            yield from (done.result() for done in as_completed(running))
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise


COMMAND, REQUEST = "sample-run", "request.json"


def _handed_out(pair: Pair, tasks: list[Task], cache: Path, cluster: Pool) -> Iterator[Outcome]:
    """Each sample by a process of its own, which finds what is asked for in a folder of the cache."""
    case, asked = pair.case.model_dump(mode="json", exclude_none=True), dict[Path, Task]()
    with cluster() as pool:
        for task in tasks:
            folder = cache.absolute() / "asked" / task[2]
            folder.mkdir(parents=True, exist_ok=True)
            replace(folder / REQUEST, json.dumps({"case": case, "task": task}).encode())
            asked[folder] = task
        for folder, failure in outcomes(pool, COMMAND, list(asked)):
            gap, held_out, key = asked[folder]
            shutil.rmtree(folder)
            yield key, None if failure else read_sample(cache, key, gap, held_out=held_out), failure


def compute_sample(folder: Path) -> None:
    """Take the sample that is asked for in a folder of a cache. Raises SolveError: it fails."""
    asked = json_of(folder / REQUEST, "repeat the calibration")
    gap, held_out, key = asked["task"]
    _, _, failure = _compute_case(asked["case"], (gap, held_out, key), folder.parents[1])
    if failure:
        raise SolveError(failure)


def _leave_with_parent() -> None:
    """End with the parent, even if that is killed, or wait for work for ever; leave Ctrl-C to the parent."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()
    assert parent is not None  # it is a worker

    def watch() -> None:
        wait([parent.sentinel])
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def _compute_case(case: dict[str, object], task: Task, cache: Path) -> Outcome:
    return _compute(pair_of(parse_case(case)), task, cache)


def _compute(pair: Pair, task: Task, cache: Path) -> Outcome:
    gap, held_out, key = task
    try:
        sample = resolved_sample(pair, gap, held_out=held_out)
    except FsiError as error:
        parallel.settle(error)
        return key, None, f"at the gap {gap:.6g}: {error}"
    parallel.on_root(lambda: keep_sample(cache, key, sample))
    return key, sample, ""


def resolved_sample(pair: Pair, gap: float, *, held_out: bool) -> Sample:
    """The resistance of the pair at a gap; collective. Raises SolveError."""
    began = time.process_time()
    case = pair.at(gap)
    solved = flow_solvers(case).solve(case)
    kappa, error = pair.resistance(gap, solved.solution, solved.errors)
    half, change = halved(solved.case), 0.0
    if half is not None:
        smaller = make_model(half)(half.configuration(), 0.0)
        none = ErrorEstimate(0.0 * smaller.U, 0.0 * smaller.F)
        change = abs(pair.resistance(gap, smaller, none)[0] - kappa)
    solution, seconds = solved.solution, time.process_time() - began
    defect, instead = float(np.nanmax([*solution.checks.values()])), bool(solution.mesh_instead)
    return Sample(gap, held_out, kappa, error, change, solution.dofs, defect, seconds, instead)
