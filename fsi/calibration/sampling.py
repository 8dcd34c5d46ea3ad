"""All samples of a calibration, several at a time, none twice."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from multiprocessing.connection import wait
from pathlib import Path

import fsi.parallel as parallel
from fsi.calibration.pair import Pair, pair_of
from fsi.calibration.samples import Sample, keep_sample, key_of, planned_gaps, read_sample
from fsi.case.load import parse_case
from fsi.errors import FsiError, SolveError
from fsi.meshes.errors import MeshError

type Task = tuple[float, bool, str]  # gap, held out, key
type Outcome = tuple[str, Sample | None, str]  # key, sample, why there is none


@dataclass(frozen=True, slots=True)
class Sampling:
    """How samples are taken.

    Attributes:
        cache: folder of all samples ever computed.
        workers: local processes; on several ranks they work together on one sample after the other instead.
        show: is told how many samples there are of how many.
    """

    cache: Path
    workers: int = 1
    show: Callable[[int, int], None] = lambda *_: None


def take_samples(pair: Pair, sampling: Sampling) -> list[Sample]:
    """The samples that the case asks for, in increasing gaps; collective.

    Each is kept as soon as it is there, so that a killed calibration goes on where it was.

    Args:
        pair: what is sampled.
        sampling: where they are kept, and who computes them.

    Raises:
        SolveError: some samples failed; the message names the first. All others are in the cache.
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
        raise SolveError(
            f"{len(failures)} of {len(tasks)} samples failed, first {failures[0]}; the others are kept"
        )
    return sorted(samples.values(), key=lambda sample: sample.gap)


def _cached(tasks: list[Task], cache: Path) -> dict[str, Sample]:
    cache.mkdir(parents=True, exist_ok=True)
    samples = {key: read_sample(cache, key, held_out=held_out) for _, held_out, key in tasks}
    return {key: sample for key, sample in samples.items() if sample is not None}


def _computed(pair: Pair, tasks: list[Task], sampling: Sampling) -> Iterator[Outcome]:
    """The outcome of each task, as they come."""
    cache, workers = sampling.cache, sampling.workers
    if parallel.size() > 1 or workers == 1 or len(tasks) < 2:
        yield from (_compute(pair, task, cache) for task in tasks)
        return
    case = pair.case.model_dump(exclude_none=True)
    # Started afresh: a fork would share the parent's MPI.
    fresh = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(min(workers, len(tasks)), fresh, _leave_with_parent) as pool:
        try:
            running = [pool.submit(_compute_case, case, task, cache) for task in tasks]
            yield from (done.result() for done in as_completed(running))
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise


def _leave_with_parent() -> None:
    """Let this process end when its parent does, even killed: it would wait for work for ever.

    Ctrl-C is left to the parent.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()
    assert parent is not None  # it is a worker

    def watch() -> None:
        wait([parent.sentinel])
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def _compute_case(case: dict[str, object], task: Task, cache: Path) -> Outcome:
    """`_compute` in another process."""
    return _compute(pair_of(parse_case(case)), task, cache)


def _compute(pair: Pair, task: Task, cache: Path) -> Outcome:
    from fsi.calibration.resolved import resolved_sample

    gap, held_out, key = task
    try:
        sample = resolved_sample(pair, gap, held_out=held_out)
    except (FsiError, MeshError) as error:
        return key, None, f"at the gap {gap:.6g}: {error}"
    parallel.on_root(lambda: keep_sample(cache, key, sample))
    return key, sample, ""
