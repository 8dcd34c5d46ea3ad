"""Which gaps of a crowd close, by interior points: their steps hardly depend on the number of bodies.

With rows scaled to the unit diagonal, y = M^(1/2) (u - u*) and G = J M^(-1/2), the program is

    min 1/2 |y|^2   s.t.   G y >= l,        y = G^T p,   p >= 0   at the optimum.

It is solved by CVXOPT's coneqp: M. Andersen, J. Dahl, Z. Liu & L. Vandenberghe, in Optimization for Machine
Learning (MIT Press 2012), ch. 3. Its steps are those of Newton's method for

    [ I     -G^T  ] [ dy ]   [ a ]
    [ -G  -D^(-1) ] [ dp ] = [ b ],       D = p / slack,

that is (I + G^T D G) dy = a - G^T D b: of two or three unknowns a body, where the dual has one for each gap,
and positive definite whatever D is. Its factors are CHOLMOD's, in an order that is found once.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import scipy.sparse as sp

from fsi.arrays import Array, Indices
from fsi.gluey.augmented_lagrangian import Program

# Of the largest rate: at it, what closes is told from what opens, so that a Newton step or none is left. At
# 1e-6 it may be 20, which cost more than the interior points (`bench/gluey.py`).
CLOSE = 1e-10
# Added to 1 / D: where gaps close D would become so large that rounding leaves no factors.
LEAST = 1e-14


def by_interior_points(program: Program) -> Array:
    """Impulses p >= 0, (rows,), near the solution, of a program whose rows are gaps; 0 where one is open."""
    from cvxopt import matrix, solvers, spmatrix  # takes 0.2 s to load: few steps come here

    s = 1.0 / np.sqrt(program.weight)
    moved = np.unique(program.J.indices)  # rotations are not
    G = sp.csr_matrix(sp.diags(s) @ program.J[:, moved] @ sp.diags(1.0 / np.sqrt(program.mass[moved])))
    rows, unknowns = G.shape
    least = -s * program.rate(program.u_star)
    size = float(np.abs(s * (program.J @ program.u_star)).max(initial=0.0)) or 1.0
    found = solvers.coneqp(
        spmatrix(1.0, range(unknowns), range(unknowns)),
        matrix(0.0, (unknowns, 1)),
        _product(G),
        matrix(-least / size),
        {"l": rows, "q": [], "s": []},
        kktsolver=_newton(G),
        options={"show_progress": False, "abstol": CLOSE, "reltol": CLOSE, "feastol": CLOSE},
    )
    p, slack = _values(found["z"]), _values(found["s"])
    closed: Array = np.where(p > slack, size * s * p, 0.0)
    return closed


def _values(vector: Any) -> Array:
    """The numbers of one of CVXOPT's vectors."""
    values: Array = np.array(vector).ravel()
    return values


def _product(G: sp.csr_matrix) -> Callable[..., None]:
    """y := beta y - alpha G x, or with G^T, of CVXOPT's vectors."""
    from cvxopt import matrix

    transposed = G.T.tocsr()

    def product(x: Any, y: Any, alpha: float = 1.0, beta: float = 0.0, trans: str = "N") -> None:
        by = transposed if trans == "T" else G
        y[:] = matrix(beta * _values(y) - alpha * (by @ _values(x)))

    return product


def _newton(G: sp.csr_matrix) -> Callable[[dict[str, Any]], Callable[..., None]]:
    """What takes D^(-1/2), CVXOPT's d, to what solves for dy and D^(-1/2) dp in place."""
    from cvxopt import cholmod, matrix, spmatrix

    unknowns, transposed = G.shape[1], G.T.tocsr()
    row, column, by_row = _lower(G)
    unit = (row == column).astype(float)
    K = spmatrix(matrix(unit), matrix(row), matrix(column), (unknowns, unknowns))
    cholmod.options["supernodal"] = 2  # L L^T
    factors = cholmod.symbolic(K, uplo="L")

    def factorised(scaling: dict[str, Any]) -> Callable[..., None]:
        d = _values(scaling["d"])
        D = 1.0 / (d * d + LEAST)
        K.V = matrix(unit + by_row @ D)
        cholmod.numeric(K, factors)

        def solve(x: Any, _: Any, z: Any) -> None:
            b = _values(z)
            x[:] = matrix(_values(x) - transposed @ (D * b))
            cholmod.solve(factors, x)
            z[:] = matrix(-d * D * (G @ _values(x) + b))

        return solve

    return factorised


def _lower(G: sp.csr_matrix) -> tuple[Indices, Indices, sp.csr_matrix]:
    """Of the lower triangle of I + G^T D G, by columns: rows, columns, and what D adds to the entries."""
    rows, unknowns = G.shape
    count = np.diff(G.indptr)
    place = np.arange(G.nnz) - np.repeat(G.indptr[:-1], count)
    # Rows of fewer entries than others have zeros more in the column of their first one.
    columns = np.repeat(G.indices[G.indptr[:-1], None].astype(np.int64), count.max(), axis=1)
    values = np.zeros(columns.shape)
    of_row = np.repeat(np.arange(rows), count)
    columns[of_row, place], values[of_row, place] = G.indices, G.data
    one, other = np.tril_indices(count.max())
    key = np.minimum(columns[:, one], columns[:, other]) * unknowns
    key += np.maximum(columns[:, one], columns[:, other])
    keys, entry = np.unique(np.append(key.ravel(), np.arange(unknowns) * (unknowns + 1)), return_inverse=True)
    added = (values[:, one] * values[:, other]).ravel()
    by = (added, (entry[: len(added)], np.repeat(np.arange(rows), len(one))))
    return keys % unknowns, keys // unknowns, sp.csr_matrix(by, (len(keys), rows))
