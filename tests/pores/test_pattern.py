"""The triangle of all pores: each entry is the sum of those of the pores in which its two unknowns meet."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fsi.pores.pattern import add_forms, pattern_of


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 12), st.integers(1, 8))
def test_forms_of_any_members_add_up(seed: int, pores: int, count: int) -> None:
    """Members may come several times in a pore, as a disc beside its own image does, or be missing."""
    rng = np.random.default_rng(seed)
    start = np.concatenate([[0], np.cumsum(rng.integers(1, 4, count))])
    members = rng.integers(-1, count, (pores, 6))
    members[:, 0] = np.maximum(members[:, 0], 0)
    exact, pattern = np.zeros((start[-1], start[-1])), pattern_of(members, start)
    data = np.zeros(len(pattern.indices))
    for pore in members:
        unknown = np.concatenate([np.arange(start[k], start[k + 1]) for k in pore if k >= 0])
        form = rng.normal(size=(len(unknown), len(unknown)))
        form += form.T
        np.add.at(exact, (unknown[:, None], unknown[None]), form)
        add_forms(data, pattern, pore[None], form[None])
    found = pattern.matrix(data)
    assert found.has_canonical_format
    assert found.toarray() == pytest.approx(np.tril(exact), abs=1e-12)
