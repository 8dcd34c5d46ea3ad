"""Products with the rows of pairs: `J J^T z`, where each row of J has entries of two bodies at most.

Iterations for the forces of a crowd are such products and little else. Rows of one or two bodies have so few
entries, all as many, that loops which know how many take a third of the time of those for any sparse matrix.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy.sparse as sp

from fsi.bodies.configuration import Array

# From so many rows on products take longer than loading what is compiled, some 0.3 s.
MANY = 5000


def gram(J: sp.csr_matrix) -> Callable[[Array], Array]:
    """`z -> J J^T z` of rows J (R, M), z and the product (R,)."""
    if J.shape[0] <= MANY or J.nnz == 0:
        transposed = J.T.tocsr()
        return lambda z: np.asarray(J @ (transposed @ z))
    from fsi.bodies.row_products import Products  # loads Numba

    return Products(J)
