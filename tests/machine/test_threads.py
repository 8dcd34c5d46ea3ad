"""Work that threads share: all of it is done once, in as many parts as OMP_NUM_THREADS says."""

import threading

import pytest

from fsi.machine.threads import in_parts


@pytest.mark.parametrize(
    ("said", "parts"), [("1", 1), ("2", 2), ("3,1", 3), ("20", 7), ("", 1), ("many", 1), ("0", 1)]
)
def test_all_is_done_once_in_as_many_parts_as_there_are_threads(
    monkeypatch: pytest.MonkeyPatch, said: str, parts: int
) -> None:
    monkeypatch.setenv("OMP_NUM_THREADS", said)
    done, lock = list[list[int]](), threading.Lock()

    def take(part: slice) -> None:
        with lock:
            done.append(list(range(7))[part])

    in_parts(7, take)
    assert sorted(k for part in done for k in part) == list(range(7))
    assert len(done) == parts


def test_what_goes_wrong_in_a_part_is_raised(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("OMP_NUM_THREADS", "2")

    def take(part: slice) -> None:
        if part.start > 0:
            raise ValueError(part)

    with pytest.raises(ValueError, match="slice"):
        in_parts(10, take)
