"""The lag of separation against the throw and the weight that a contact remembers."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fsi.case.load import load_case
from fsi.errors import InputError
from fsi.postprocess.analysis.memory import (
    memory_data,
    memory_table,
    read_memories,
)
from fsi.postprocess.plots.analyses import plot_memories
from fsi.postprocess.run.run import open_run
from fsi.runs import run

CASES = Path(__file__).parents[3] / "cases"


def test_two_discs_come_off_after_the_push(tmp_path: Path) -> None:
    """Pushed by 1 for 2, pulled by 1: P = 2, a lag of 2, to one time of output, and the mean pull is 1."""
    overrides = ["time.step=0.02", "output.interval=0.1", "output.fields=false", "time.end=5"]
    case = load_case(CASES / "gluey" / "two_discs.toml", overrides)
    run(case, tmp_path / "run")
    memory = read_memories(open_run(tmp_path / "run"))
    np.testing.assert_allclose(memory.contacts["stored"], 2.0, atol=0.05)
    np.testing.assert_allclose(memory.contacts["lag"], 2.0, atol=0.11)
    assert memory_table(memory).row_count == 1
    assert memory_data(memory)["contacts"][0]["released"] == memory.contacts["released"][0]
    plot_memories(memory, tmp_path / "memory.png")
    assert (tmp_path / "memory.png").stat().st_size > 10_000


def test_of_a_contact_that_closes_again_the_last_time_counts(tmp_path: Path) -> None:
    """Closed at t = 1 and 2 with a push of 5, open at 3, closed at 4 and 5 with 2: off since 6."""
    case = load_case(CASES / "gluey" / "two_discs.toml", ["time.end=6", "time.step=1"])
    (tmp_path / "case.toml").write_text(case.as_toml())
    contacts = [(1, -3.0), (2, -5.0), (4, -2.0), (5, -1.0)]
    rows = [f"{t},{t}.0,{case.names[0]},{case.names[1]},0.0,{gamma},0.0,0.0" for t, gamma in contacts]
    head = "step,t,side,body,gap,gamma,impulse,solid_impulse"
    (tmp_path / "contacts.csv").write_text("\n".join([head, *rows]) + "\n")
    bodies = [f"{t},{t}.0,{name},0.0,0.0" for t in range(7) for name in case.names]
    (tmp_path / "bodies.csv").write_text("\n".join(["step,t,body,x,y", *bodies]) + "\n")
    memory = read_memories(open_run(tmp_path))
    (row,) = memory.contacts[["stored", "reached", "released", "lag"]].to_numpy().tolist()
    assert row == [2.0, 4.0, 6.0, 2.0]
    np.testing.assert_array_equal(memory.closed, [0, 1, 1, 0, 1, 1, 0])


def test_a_run_without_contacts_is_told_which_model_has_them(tmp_path: Path) -> None:
    case = load_case(CASES / "settling_disc.toml")
    (tmp_path / "case.toml").write_text(case.as_toml())
    told = r'contacts\.csv: is not there; give .* a run with model = "gluey", this has "resolved"$'
    with pytest.raises(InputError, match=told):
        read_memories(open_run(tmp_path))
