"""Products with the rows of pairs: `J J^T z`, where each row of J has entries of two bodies at most.

Iterations for the forces of a crowd are such products and little else. Of few rows J J^T is multiplied out:
to call a sparse product takes longer. Rows of one or two bodies have so few entries, all as many, that loops
which know how many take a third of the time of those for any sparse matrix.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
import scipy.sparse as sp

from fsi.arrays import Array

if TYPE_CHECKING:
    from fsi.bodies.row_products import Products

# Up to FEW rows a full matrix takes half of the time or less; from MANY on products take longer than loading
# what is compiled, some 0.3 s.
FEW, MANY = 200, 5000


def gram(J: sp.csr_matrix, slack: Array) -> Callable[[Array], Array]:
    """`z -> J J^T z + slack z` of rows J (R, M); slack, z and the product are (R,)."""
    if J.shape[0] <= FEW:
        W = (J @ J.T).toarray() + np.diag(slack)
        return lambda z: np.asarray(W @ z)
    if J.shape[0] <= MANY:
        transposed = J.T.tocsr()
        return lambda z: np.asarray(J @ (transposed @ z) + slack * z)
    return products(J, slack)


def products(J: sp.csr_matrix, slack: Array) -> Products:
    """The same in compiled loops, with iterations that use it."""
    from fsi.bodies.row_products import Products  # loads Numba

    return Products(J, slack)
