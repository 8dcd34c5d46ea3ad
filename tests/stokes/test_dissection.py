"""Parts of long domains are divided where they have least in common."""

from __future__ import annotations

import numpy as np
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_array_equal
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components, maximum_flow

from fsi.arrays import Array
from fsi.stokes.discretisation.loops import Numbers, loops, pointer


def pairs_of_grid(columns: int, rows: int) -> NDArray[np.int64]:
    """Squares side by side, numbered up the columns, (pairs, 2)."""
    number = np.arange(columns * rows).reshape(columns, rows)
    across = np.stack([number[:-1].ravel(), number[1:].ravel()], axis=1)
    return np.concatenate([across, np.stack([number[:, :-1].ravel(), number[:, 1:].ravel()], axis=1)])


def regions(parts: int, pairs: NDArray[np.int64], sides: Array, most: int) -> Numbers:
    both = np.concatenate([pairs, pairs[:, ::-1]])
    graph = coo_array((np.tile(sides, 2), (both[:, 0], both[:, 1])), shape=(parts, parts)).tocsr()
    first, beside, common = (a.astype(np.int32) for a in (graph.indptr, graph.indices, graph.data))
    found: Numbers = np.empty(parts, dtype=np.int32)
    lib, ffi = loops().lib, loops().ffi
    held = {name: pointer(a) for name, a in (("first", first), ("beside", beside), ("sides", common))}
    assert lib.dissect(ffi.new("Graph *", {"parts": parts} | held), most, pointer(found)) == 0
    return found


def test_a_strip_is_cut_at_its_waist() -> None:
    """Between two of 30 columns of six, which have a third as much in common as others."""
    pairs = pairs_of_grid(30, 6)
    sides = np.where((pairs[:, 0] // 6 == 7) & (pairs[:, 1] // 6 == 8), 1.0, 3.0)
    found = regions(180, pairs, sides, 140).reshape(30, 6)
    assert_array_equal(
        found, np.where(np.arange(30) < 8, found[0, 0], found[-1, 0])[:, None] + np.zeros((1, 6))
    )
    assert found[0, 0] != found[-1, 0]


@settings(deadline=None, max_examples=50)
@given(st.integers(2, 40), st.integers(1, 6), st.integers(2, 30), st.integers(0, 2**32 - 1))
def test_regions_are_small_and_hang_together(columns: int, rows: int, most: int, seed: int) -> None:
    """Of some squares of a grid, which may fall apart, with any numbers in common."""
    rng = np.random.default_rng(seed)
    pairs = pairs_of_grid(columns, rows)
    pairs = pairs[rng.random(len(pairs)) < 0.8]
    parts = columns * rows
    found = regions(parts, pairs, rng.integers(1, 9, len(pairs)).astype(float), most)
    assert np.unique(found, return_counts=True)[1].max() <= most
    within = pairs[found[pairs[:, 0]] == found[pairs[:, 1]]]
    graph = coo_array((np.ones(len(within)), (within[:, 0], within[:, 1])), shape=(parts, parts))
    assert connected_components(graph, directed=False)[0] == len(np.unique(found))


@settings(deadline=None, max_examples=100)
@given(st.integers(4, 10), st.integers(0, 2**32 - 1))
def test_a_cut_is_as_large_as_the_greatest_flow(rows: int, seed: int) -> None:
    """Between the ends of a strip, a maze in its middle, where what flows must turn; as SciPy has it."""
    columns, rng = 40, np.random.default_rng(seed)
    pairs, parts = pairs_of_grid(columns, rows), columns * rows
    ends = (pairs // rows < 17).any(axis=1) | (pairs // rows > 23).any(axis=1)
    sides = np.where(ends, 1000.0, rng.integers(1, 4, len(pairs)))
    kept = ends | (rng.random(len(pairs)) < 0.6)
    pairs, sides = pairs[kept], sides[kept]
    number = connected_components(
        coo_array((sides, (pairs[:, 0], pairs[:, 1])), shape=(parts, parts)), directed=False
    )[1]
    assume(number[0] == number[-1])
    found = regions(parts, pairs, sides, int((number == number[0]).sum()) - 1)
    # A part more at each end, from which or to which all flows.
    begin = [(parts, k) for k in range(rows)] + [(parts - 1 - k, parts + 1) for k in range(rows)]
    every, room = np.concatenate([pairs, begin]), np.append(sides, np.full(2 * rows, 10**6))
    graph = coo_array((room, (every[:, 0], every[:, 1])), shape=(parts + 2, parts + 2)).tocsr()
    flow = maximum_flow((graph + graph.T).astype(np.int32), parts, parts + 1).flow_value
    assert sides[found[pairs[:, 0]] != found[pairs[:, 1]]].sum() == flow
