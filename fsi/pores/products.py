"""Products of rows of numbers, several rows at a time, so that each number that is loaded is used often.

Loops in place of a library's: rows are so few and short that a library spends its time on their sizes, or on
threads.
"""

from fsi.arrays import Array
from fsi.machine.compiled import vectorised


@vectorised
def products(A: Array, B: Array, out: Array, end: int) -> None:
    """A B^T of rows up to an end, two by four at a time; rows beyond the last are the last."""
    _products(A, B, out, end, 0)


@vectorised
def squares(A: Array, out: Array, end: int) -> None:
    """A A^T."""
    _products(A, A, out, end, 1)
    for i in range(len(A)):
        for j in range(i):
            out[i, j] = out[j, i]


@vectorised
def _products(A: Array, B: Array, out: Array, end: int, upper: int) -> None:
    """A B^T, or its upper triangle alone: four rows of B stay near while pairs of A go by."""
    m, n = len(A), len(B)
    for j in range(0, n, 4):
        j1, j2, j3 = min(j + 1, n - 1), min(j + 2, n - 1), min(j + 3, n - 1)
        c, d, e, f = B[j], B[j1], B[j2], B[j3]
        for i in range(0, min(m, j + 4) if upper else m, 2):
            k = min(i + 1, m - 1)
            a, b = A[i], A[k]
            ac = ad = ae = af = bc = bd = be = bf = 0.0
            for p in range(end):
                ac += a[p] * c[p]
                ad += a[p] * d[p]
                ae += a[p] * e[p]
                af += a[p] * f[p]
                bc += b[p] * c[p]
                bd += b[p] * d[p]
                be += b[p] * e[p]
                bf += b[p] * f[p]
            out[i, j], out[i, j1], out[i, j2], out[i, j3] = ac, ad, ae, af
            out[k, j], out[k, j1], out[k, j2], out[k, j3] = bc, bd, be, bf


@vectorised
def take_off(S: Array, X: Array, B: Array, end: int) -> None:
    """S <- S - X^T B up to an end, two rows of S and four of B at a time; an odd row of S is alone."""
    whole, pairs = len(B) // 4 * 4, len(S) // 2 * 2
    for c in range(0, pairs, 2):
        row, next_row = S[c], S[c + 1]
        for b in range(0, whole, 4):
            x0, x1, x2, x3 = X[b, c], X[b + 1, c], X[b + 2, c], X[b + 3, c]
            y0, y1, y2, y3 = X[b, c + 1], X[b + 1, c + 1], X[b + 2, c + 1], X[b + 3, c + 1]
            b0, b1, b2, b3 = B[b], B[b + 1], B[b + 2], B[b + 3]
            for p in range(end):
                row[p] -= x0 * b0[p] + x1 * b1[p] + x2 * b2[p] + x3 * b3[p]
                next_row[p] -= y0 * b0[p] + y1 * b1[p] + y2 * b2[p] + y3 * b3[p]
        for b in range(whole, len(B)):
            last, x0, y0 = B[b], X[b, c], X[b, c + 1]
            for p in range(end):
                row[p] -= x0 * last[p]
                next_row[p] -= y0 * last[p]
    for c in range(pairs, len(S)):
        row = S[c]
        for b in range(len(B)):
            last, x0 = B[b], X[b, c]
            for p in range(end):
                row[p] -= x0 * last[p]


@vectorised
def take_rows(A: Array, i: int, f: Array, rows: tuple[int, int], begin: int) -> None:
    """Take these rows times f off row i, four at a time, from column `begin` on."""
    first, last = rows
    whole, row, end = first + (last - first) // 4 * 4, A[i], A.shape[1]
    for k in range(first, whole, 4):
        f0, f1, f2, f3 = f[k], f[k + 1], f[k + 2], f[k + 3]
        a0, a1, a2, a3 = A[k], A[k + 1], A[k + 2], A[k + 3]
        for c in range(begin, end):
            row[c] -= f0 * a0[c] + f1 * a1[c] + f2 * a2[c] + f3 * a3[c]
    for k in range(whole, last):
        a0, f0 = A[k], f[k]
        for c in range(begin, end):
            row[c] -= f0 * a0[c]
