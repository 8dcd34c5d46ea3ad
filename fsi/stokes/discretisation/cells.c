/* The Stokes matrices of single cells without their inner unknowns, and the pattern and values of their sum.

See cells.py and solvers/assembly.py.
*/
#include <stdint.h>
#include <string.h>

typedef void Tabulate(double *, const double *, const double *, const double *, const int *, const uint8_t *, void *);

/* The symmetric matrix of a cell, its rows in the order of `source`. */
static void matrix_of_cell(const Cells *c, int cell, double *restrict E)
{
  const int u = c->velocities, p = c->pressures, n = u + p, kind = c->kind[cell];
  double X[3 * c->points], every[u * u + p * u + 1];
  memset(every, 0, sizeof every);
  for (int k = 0; k < c->points; k++)
    memcpy(X + 3 * k, c->x + 3 * (int64_t)c->geometry[(int64_t)cell * c->points + k], 3 * sizeof(double));
  ((Tabulate *)c->a[kind])(every, 0, c->mu, X, 0, 0, 0);
  ((Tabulate *)c->b[kind])(every + u * u, 0, 0, X, 0, 0, 0);
  for (int k = 0; k < n * n; k++)
    E[k] = every[c->source[k]];
}

/* E = L D L^T from its last row up to the first inner one; what is left stands in the rows before. */
static void condense(int n, int outer, double *restrict E)
{
  for (int k = n - 1; k >= outer; k--) {
    const double *restrict pivot = E + k * n;
    const double reciprocal = 1.0 / pivot[k];
    for (int i = 0; i < k; i++) {
      const double l = pivot[i] * reciprocal;
      double *restrict row = E + i * n;
      for (int j = 0; j <= i; j++)
        row[j] -= l * pivot[j];
    }
  }
  for (int i = 0; i < outer; i++)
    for (int j = 0; j < i; j++)
      E[j * n + i] = E[i * n + j];
}

/* Y += T^T S, row by row, for rows T of P; S has `columns` columns. */
static void combine(const Sum *s, const int32_t *rows, const int16_t *slots, int outer, int columns, const double *S,
                    int stride, double *restrict Y)
{
  const int w = s->width;
  for (int i = 0; i < outer; i++)
    for (int k = 0; k < w; k++) {
      if (slots[i * w + k] < 0)
        continue;
      const double weight = s->weights[(int64_t)rows[i] * w + k];
      const double *restrict from = S + i * stride;
      double *restrict to = Y + slots[i * w + k] * columns;
      for (int j = 0; j < columns; j++)
        to[j] += weight * from[j];
    }
}

/* T^T S T for the rows T of P on a cell and S in the first rows of E; m: the number of the cell's unknowns. */
static void constrain(const Sum *s, int cell, int n, int outer, int m, const double *E, double *restrict R)
{
  const int32_t *rows = s->rows + (int64_t)cell * n;
  const int16_t *slots = s->slots + (int64_t)cell * outer * s->width;
  double left[m * outer], right[outer * m];
  memset(left, 0, sizeof left);
  memset(R, 0, m * m * sizeof *R);
  combine(s, rows, slots, outer, outer, E, n, left);
  for (int i = 0; i < m; i++)
    for (int j = 0; j < outer; j++)
      right[j * m + i] = left[i * outer + j];
  combine(s, rows, slots, outer, m, right, m, R);
}

static void add(const int32_t *at, int m, const double *R, int stride, double *restrict values)
{
  for (int i = 0; i < m; i++)
    for (int j = 0; j < m; j++)
      if (at[i * m + j] >= 0)
        values[at[i * m + j]] += R[i * stride + j];
}

void add_cells(const Cells *c, const Sum *s, double *restrict values, double *restrict kept, double *restrict matrices,
               double *restrict factors)
{
  const int n = c->velocities + c->pressures, outer = n - c->inner;
  double E[n * n], R[s->most * s->most];
  for (int cell = 0; cell < c->cells; cell++) {
    matrix_of_cell(c, cell, E);
    for (int i = 0; i < outer; i++) {
      const int32_t place = s->kept[(int64_t)cell * outer + i];
      if (place >= 0)
        memcpy(kept + (int64_t)place * n, E + i * n, n * sizeof *E);
    }
    for (int i = 0; matrices && i < n; i++) {
      memcpy(matrices, E + i * n, (i + 1) * sizeof *E);
      matrices += i + 1;
    }
    condense(n, outer, E);
    memcpy(factors + (int64_t)cell * c->inner * n, E + outer * n, c->inner * n * sizeof *E);
    const int m = s->start[cell + 1] - s->start[cell];
    const int32_t *at = s->positions + s->first[cell];
    if (s->plain[cell])
      add(at, m, E, n, values);
    else {
      constrain(s, cell, n, outer, m, E, R);
      add(at, m, R, m, values);
    }
  }
}

/* y += the sum over cells of E x, for the lower triangles of E one after the other; columns of x: (size,) each. */
#define TIMES(name, real)                                                                                            \
  void name(int cells, int n, int size, int columns, const int32_t *rows, const double *E, const real *x, real *y)   \
  {                                                                                                                  \
    for (int cell = 0; cell < cells; cell++, rows += n, E += n * (n + 1) / 2)                                        \
      for (int k = 0; k < columns; k++) {                                                                            \
        const real *from = x + (int64_t)k * size;                                                                    \
        real *to = y + (int64_t)k * size, X[n], Y[n];                                                                \
        for (int i = 0; i < n; i++)                                                                                  \
          X[i] = from[rows[i]];                                                                                      \
        for (int i = 0; i < n; i++) {                                                                                \
          const double *row = E + i * (i + 1) / 2;                                                                   \
          real sum = row[i] * X[i];                                                                                  \
          for (int j = 0; j < i; j++) {                                                                              \
            sum += row[j] * X[j];                                                                                    \
            Y[j] += row[j] * X[i];                                                                                   \
          }                                                                                                          \
          Y[i] = sum;                                                                                                \
        }                                                                                                            \
        for (int i = 0; i < n; i++)                                                                                  \
          to[rows[i]] += Y[i];                                                                                       \
      }                                                                                                              \
  }
TIMES(times_cells, double)
TIMES(times_cells_extended, long double)

/* y += M x, or M^T x, of the rows of cells that are kept: row[k] has n entries of one cell, in its columns.
   volatile: added in this order with every compiler, as digits depend on it where pressures of 1e18 cancel. */
#define TIMES_KEPT(name, real)                                                                                       \
  void name(int count, int n, int transposed, const int32_t *row, const int32_t *columns, const double *kept,        \
            const real *x, real *y)                                                                                  \
  {                                                                                                                  \
    volatile real *sum = y;                                                                                          \
    for (int k = 0; k < count; k++, columns += n, kept += n)                                                         \
      for (int j = 0; j < n; j++)                                                                                    \
        if (transposed)                                                                                              \
          sum[columns[j]] += kept[j] * x[row[k]];                                                                    \
        else                                                                                                         \
          sum[row[k]] += kept[j] * x[columns[j]];                                                                    \
  }
TIMES_KEPT(times_kept, double)
TIMES_KEPT(times_kept_extended, long double)

/* The loads of inner unknowns go to the outer ones. */
void reduce_loads(int cells, int n, int inner, const int32_t *rows, const double *factors, double *restrict b)
{
  for (int cell = 0; cell < cells; cell++) {
    const int32_t *row = rows + (int64_t)cell * n;
    const double *L = factors + (int64_t)cell * inner * n - (int64_t)(n - inner) * n;
    for (int k = n - 1; k >= n - inner; k--)
      for (int i = 0; i < k; i++)
        b[row[i]] -= L[k * n + i] / L[k * n + k] * b[row[k]];
  }
}

/* Inner unknowns from the outer ones, for loads that have been reduced. */
void recover(int cells, int n, int inner, const int32_t *rows, const double *factors, const double *b,
             double *restrict x)
{
  for (int cell = 0; cell < cells; cell++) {
    const int32_t *row = rows + (int64_t)cell * n;
    const double *L = factors + (int64_t)cell * inner * n - (int64_t)(n - inner) * n;
    for (int k = n - inner; k < n; k++) {
      double left = b[row[k]];
      for (int i = 0; i < k; i++)
        left -= L[k * n + i] * x[row[i]];
      x[row[k]] = left / L[k * n + k];
    }
  }
}

/* The unknowns that each cell meets, one after the other in `list`, and where each entry of its rows of P finds its
   own among them. Plain cells meet each by one row of P that is a unit row. */
int32_t list_unknowns(int cells, int n, int outer, int w, const int32_t *rows, const int32_t *columns,
                      const double *weights, int32_t *start, int32_t *list, int16_t *slots, int8_t *plain)
{
  int32_t end = 0;
  int32_t most = 0;
  for (int cell = 0; cell < cells; cell++) {
    int32_t *own = list + end;
    int m = 0;
    start[cell] = end;
    plain[cell] = 1;
    for (int i = 0; i < outer; i++)
      for (int k = 0; k < w; k++) {
        const int64_t entry = (int64_t)rows[(int64_t)cell * n + i] * w + k;
        const int32_t column = columns[entry];
        int slot = -1;
        if (column >= 0) {
          for (slot = 0; slot < m && own[slot] != column; slot++)
            ;
          if (slot == m)
            own[m++] = column;
        }
        slots[((int64_t)cell * outer + i) * w + k] = slot;
        if (k == 0 ? slot != i || weights[entry] != 1.0 : slot >= 0)
          plain[cell] = 0;
      }
    end += m;
    most = m > most ? m : most;
  }
  start[cells] = end;
  return most;
}

/* Where each of the unknowns is met: the places in `list`, and the cells. */
void list_meetings(int cells, int unknowns, const int32_t *start, const int32_t *list, int32_t *first, int32_t *place,
                   int32_t *cell_of)
{
  memset(first, 0, (unknowns + 1) * sizeof *first);
  for (int32_t k = 0; k < start[cells]; k++)
    first[list[k] + 1]++;
  for (int j = 0; j < unknowns; j++)
    first[j + 1] += first[j];
  for (int cell = 0; cell < cells; cell++)
    for (int32_t k = start[cell]; k < start[cell + 1]; k++) {
      place[first[list[k]]] = k;
      cell_of[first[list[k]]++] = cell;
    }
  for (int j = unknowns; j > 0; j--)
    first[j] = first[j - 1];
  first[0] = 0;
}

/* Pressures meet each other where inner unknowns have been eliminated, and otherwise only themselves. */
static int meet(const Meetings *m, int32_t i, int32_t j)
{
  return i == j || m->coupled || !m->pressure[i] || !m->pressure[j];
}

/* How many entries each row of the sum has; mark: (unknowns,), any values. */
void count_entries(const Meetings *m, int32_t *mark, int32_t *count)
{
  memset(mark, -1, m->unknowns * sizeof *mark);
  for (int32_t i = 0; i < m->unknowns; i++) {
    count[i] = 0;
    for (int32_t q = m->first[i]; q < m->first[i + 1]; q++)
      for (int32_t k = m->start[m->cell[q]]; k < m->start[m->cell[q] + 1]; k++) {
        const int32_t j = m->list[k];
        if (mark[j] != i && meet(m, i, j)) {
          mark[j] = i;
          count[i]++;
        }
      }
  }
}

/* The columns of each row, ascending since the pattern is symmetric: row i is entered in those that it meets.
   next: the beginnings of the rows; their ends when this is done. */
void list_entries(const Meetings *m, int32_t *mark, int32_t *next, int32_t *indices)
{
  memset(mark, -1, m->unknowns * sizeof *mark);
  for (int32_t i = 0; i < m->unknowns; i++)
    for (int32_t q = m->first[i]; q < m->first[i + 1]; q++)
      for (int32_t k = m->start[m->cell[q]]; k < m->start[m->cell[q] + 1]; k++) {
        const int32_t j = m->list[k];
        if (mark[j] != i && meet(m, i, j)) {
          mark[j] = i;
          indices[next[j]++] = i;
        }
      }
}

/* Where the entries of each cell's matrix go, -1: nowhere; those of the cell begin at offset[cell]. */
void find_positions(const Meetings *m, const int32_t *indptr, const int32_t *indices, const int64_t *offset,
                    int32_t *where, int32_t *positions)
{
  for (int32_t i = 0; i < m->unknowns; i++) {
    for (int32_t p = indptr[i]; p < indptr[i + 1]; p++)
      where[indices[p]] = p;
    for (int32_t q = m->first[i]; q < m->first[i + 1]; q++) {
      const int32_t cell = m->cell[q], begin = m->start[cell], size = m->start[cell + 1] - begin;
      int32_t *row = positions + offset[cell] + (int64_t)(m->place[q] - begin) * size;
      for (int32_t k = 0; k < size; k++)
        row[k] = meet(m, i, m->list[begin + k]) ? where[m->list[begin + k]] : -1;
    }
  }
}
