"""The loops over cells, written in C, and arrays as they take them."""

from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fsi.stokes.discretisation.jit import compile_c

type Numbers = NDArray[np.int32]


@cache
def loops() -> Any:
    """The loops in machine code, with `ffi` and `lib`; collective."""
    graph = ("supervariables", "parts", "dissection", "merging")
    names = ("cells", "rows", "pattern", *graph, "groups", "components", "aggregates")
    sources = [Path(__file__).with_name(name) for name in names]
    return compile_c("fsi_cells", sources)


def pointer(values: NDArray[Any]) -> Any:
    """An array as the loops take it, which must outlive it."""
    kind = {"b": "int8_t", "i": "int32_t", "l": "int64_t", "h": "int16_t",
            "d": "double", "g": "long double"}  # fmt: skip
    assert values.flags.c_contiguous
    return loops().ffi.from_buffer(f"{kind[values.dtype.char]}[]", values)
