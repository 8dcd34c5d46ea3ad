"""Work that threads share: what becomes of each thing comes in order, by any number of threads."""

import threading

import pytest

import fsi.machine.threads as threads


@pytest.mark.parametrize(
    ("given", "number"), [("1", 1), ("2", 2), ("3,1", 3), ("", 1), ("many", 1), ("0", 1), (None, 5)]
)
def test_the_user_says_how_many_threads_there_are(
    monkeypatch: pytest.MonkeyPatch, given: str | None, number: int
) -> None:
    monkeypatch.setattr(threads, "GIVEN", given)
    monkeypatch.setattr(threads, "STARTED", False)
    monkeypatch.setattr(threads, "_processors", lambda: 5)
    assert threads.number_of_threads() == number


def test_each_of_several_ranks_has_one(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(threads, "GIVEN", None)
    monkeypatch.setattr(threads, "STARTED", True)
    monkeypatch.setattr(threads, "_processors", lambda: 5)
    assert threads.number_of_threads() == 1


@pytest.mark.parametrize("given", ["1", "2", "3"])
@pytest.mark.parametrize("count", [0, 1, 7])
def test_results_come_in_order(monkeypatch: pytest.MonkeyPatch, given: str, count: int) -> None:
    monkeypatch.setattr(threads, "GIVEN", given)
    assert list(threads.in_turn(lambda k: k * k, range(count))) == [k * k for k in range(count)]


def test_several_are_at_work_at_a_time(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each waits for another: one alone would wait in vain."""
    monkeypatch.setattr(threads, "GIVEN", "2")
    meeting = threading.Barrier(2, timeout=10.0)
    places = list(threads.in_turn(lambda _: meeting.wait(), range(6)))
    assert sorted(places) == [0, 0, 0, 1, 1, 1]


@pytest.mark.parametrize("given", ["1", "2"])
def test_what_goes_wrong_is_raised(monkeypatch: pytest.MonkeyPatch, given: str) -> None:
    monkeypatch.setattr(threads, "GIVEN", given)

    def work(k: int) -> int:
        if k == 3:
            raise ValueError(k)
        return k

    results = threads.in_turn(work, range(10))
    assert [next(results) for _ in range(3)] == [0, 1, 2]
    with pytest.raises(ValueError, match="3"):
        next(results)
