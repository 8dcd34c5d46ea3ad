/* The Stokes matrices of single cells, without their inner unknowns; see cells.py. */
#include <math.h>
#include <stdint.h>
#include <string.h>

/* Two versions of a loop, of which a machine takes the faster one that it can: machines may share the library. Wider
   registers, of 512 bits, gain nothing but in `subtract`. */
#if defined(__x86_64__) && defined(__gnu_linux__) && !defined(__clang__) && __GNUC__ >= 12
#define FOR_THIS_MACHINE __attribute__((target_clones("arch=x86-64-v3", "default")))
#define WITH_512_BITS
#else
#define FOR_THIS_MACHINE
#endif
#define INLINE static inline __attribute__((always_inline))

/* I = J^-1, for J of d x d; its determinant. */
INLINE double inverted(int d, const double *J, double *I)
{
  if (d == 2) {
    const double det = J[0] * J[3] - J[1] * J[2], s = 1.0 / det;
    I[0] = s * J[3], I[1] = -s * J[1], I[2] = -s * J[2], I[3] = s * J[0];
    return det;
  }
  double C[9];
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      const int a = (i + 1) % 3, b = (i + 2) % 3, e = (j + 1) % 3, f = (j + 2) % 3;
      C[j * 3 + i] = J[a * 3 + e] * J[b * 3 + f] - J[a * 3 + f] * J[b * 3 + e];
    }
  const double det = J[0] * C[0] + J[1] * C[3] + J[2] * C[6];
  for (int k = 0; k < 9; k++)
    I[k] = C[k] / det;
  return det;
}

/* dX/dx = J^-1 where the map of a cell has these derivatives, (d, points); det J. They add up to 1e-14, not to 0: of
   coordinates as seen from a corner of the cell nothing is lost, of those far away all of a narrow gap. */
INLINE double map_back(const Cells *c, const double *X, const double *derivatives, double *I)
{
  const int d = c->dimension;
  double J[9] = {0};
  for (int i = 0; i < d; i++)
    for (int a = 0; a < d; a++)
      for (int k = 0; k < c->points; k++)
        J[i * d + a] += (X[3 * k + i] - X[i]) * derivatives[a * c->points + k];
  return inverted(d, J, I);
}

/* What a point of quadrature counts for in a cell, with an axis 2 pi r times as much; dX/dx there, and r. */
INLINE double at_point(const Cells *c, const double *X, int q, double *I, double *r)
{
  const double *of_map = c->of_map + q * (1 + c->dimension) * c->points;
  const double weight = c->weights[q] * fabs(map_back(c, X, of_map + c->points, I));
  *r = 0.0;
  if (!c->axisymmetric)
    return weight;
  for (int k = 0; k < c->points; k++)
    *r += X[3 * k] * of_map[k];
  return 2.0 * M_PI * *r * weight;
}

INLINE void places_of(const Cells *c, int cell, double *X)
{
  for (int k = 0; k < c->points; k++)
    memcpy(X + 3 * k, c->x + 3 * (int64_t)c->geometry[(int64_t)cell * c->points + k], 3 * sizeof(double));
}

/* e : e, without (u_r / r)^2, of a flow with values U (nodes, d) where functions of the reference cell are these. */
INLINE double squared_rates_in(int d, int n, const double *restrict of_u, const double *restrict U, const double *I)
{
  double G[9] = {0}, e_e = 0.0;
  for (int i = 0; i < n; i++)
    for (int a = 0; a < d; a++)
      for (int e = 0; e < d; e++)
        G[a * d + e] += U[d * i + a] * of_u[(1 + e) * n + i];
  for (int a = 0; a < d; a++)
    for (int b = 0; b < d; b++) {
      double e_ab = 0.0;
      for (int e = 0; e < d; e++)
        e_ab += 0.5 * (G[a * d + e] * I[e * d + b] + G[b * d + e] * I[e * d + a]);
      e_e += e_ab * e_ab;
    }
  return e_e;
}

/* The same with loops over so many components as the compiler knows. */
INLINE double squared_rates(int d, int n, const double *of_u, const double *U, const double *I)
{
  return d == 2 ? squared_rates_in(2, n, of_u, U, I) : squared_rates_in(3, n, of_u, U, I);
}

/* int e : e over all cells of the flow with these values at their nodes, (cells, nodes) and (.., d). */
FOR_THIS_MACHINE
double squared_strain_rate(const Cells *c, const int32_t *nodes, const double *u)
{
  const int d = c->dimension, n = c->nodes, step = (1 + d) * n;
  double X[3 * c->points], U[d * n], I[9], r, sum = 0.0;
  for (int cell = 0; cell < c->cells; cell++, nodes += n) {
    places_of(c, cell, X);
    for (int i = 0; i < n; i++)
      for (int a = 0; a < d; a++)
        U[d * i + a] = u[d * (int64_t)nodes[i] + a];
    if (c->straight[cell] && !c->axisymmetric) {
      const double volume = fabs(map_back(c, X, c->of_map + c->points, I));
      for (int q = 0; q < c->count; q++)
        sum += volume * c->weights[q] * squared_rates(d, n, c->of_u + q * step, U, I);
      continue;
    }
    for (int q = 0; q < c->count; q++) {
      const double weight = at_point(c, X, q, I, &r);
      double u_r = 0.0;
      for (int i = 0; i < n; i++)
        u_r += U[d * i] * c->of_u[q * step + i];
      sum += weight * squared_rates(d, n, c->of_u + q * step, U, I);
      sum += c->axisymmetric ? weight * u_r * u_r / (r * r) : 0.0;
    }
  }
  return sum;
}

/* With S_ab = int d_a phi_i d_b phi_j for a <= b, one after the other, and R_a = int psi_k d_a phi_i:
   a straight cell, on which derivatives are those on the reference cell times constants. */
INLINE void integrate_straight(const Cells *c, const double *X, double *restrict S, double *restrict R)
{
  const int d = c->dimension, nn = c->nodes * c->nodes, np = c->nodes * c->pressures;
  double I[9];
  const double volume = fabs(map_back(c, X, c->of_map + c->points, I));
  for (int a = 0; a < d; a++)
    for (int b = a; b < d; b++, S += nn)
      for (int e = 0; e < d; e++)
        for (int f = 0; f < d; f++) {
          const double weight = volume * I[e * d + a] * I[f * d + b];
          const double *restrict from = c->stiffness + (e * d + f) * nn;
          for (int k = 0; k < nn; k++)
            S[k] += weight * from[k];
        }
  for (int a = 0; a < d; a++, R += np)
    for (int e = 0; e < d; e++) {
      const double weight = volume * I[e * d + a];
      const double *restrict from = c->divergence + e * np;
      for (int k = 0; k < np; k++)
        R[k] += weight * from[k];
    }
}

/* So many rows and columns of products are held in registers; what is multiplied has zeros up to a multiple. */
enum { TILE = 4 };
typedef double Columns __attribute__((vector_size(TILE * sizeof(double)), aligned(sizeof(double)), may_alias));

INLINE int padded(int n)
{
  return (n + TILE - 1) / TILE * TILE;
}

/* The same for rows of matrices. */
enum { WIDE = 2 * TILE };

INLINE int widened(int n)
{
  return (n + WIDE - 1) / WIDE * WIDE;
}

/* Y_ij = sum over points of F_i G_j, (m, n); rows of F and G are f and g apart. */
INLINE void products(int count, int m, int n, const double *F, int f, const double *G, int g, double *restrict Y)
{
  for (int i = 0; i < m; i += TILE)
    for (int j = 0; j < n; j += TILE) {
      Columns sum[TILE] = {{0}};
      for (int q = 0; q < count; q++)
        for (int k = 0; k < TILE; k++)
          sum[k] += F[q * f + i + k] * *(const Columns *)(G + q * g + j);
      for (int k = 0; k < TILE && i + k < m; k++)
        for (int l = 0; l < TILE && j + l < n; l++)
          Y[(i + k) * n + j + l] = sum[k][l];
    }
}

/* The same on any cell, point by point; with an axis phi / r counts as one derivative more, d, of S_dd and R_d. */
INLINE void integrate(const Cells *c, const double *X, double *restrict S, double *restrict R)
{
  const int d = c->dimension, n = c->nodes, p = c->pressures, count = c->count;
  const int derivatives = d + c->axisymmetric, wide = padded(n), stride = derivatives * wide, wide_p = padded(p);
  double G[count * stride], weighted[count * stride], psi[count * wide_p];
  memset(G, 0, sizeof G), memset(psi, 0, sizeof psi);
  for (int q = 0; q < count; q++) {
    const double *of_u = c->of_u + q * (1 + d) * n;
    double I[9], r, *at = G + q * stride;
    const double weight = at_point(c, X, q, I, &r);
    for (int a = 0; a < d; a++)
      for (int e = 0; e < d; e++)
        for (int i = 0; i < n; i++)
          at[a * wide + i] += I[e * d + a] * of_u[(1 + e) * n + i];
    if (c->axisymmetric)
      for (int i = 0; i < n; i++)
        at[d * wide + i] = of_u[i] / r;
    for (int k = 0; k < stride; k++)
      weighted[q * stride + k] = weight * at[k];
    memcpy(psi + q * wide_p, c->of_p + q * p, p * sizeof *psi);
  }
  for (int a = 0; a < derivatives; a++, R += p * n) {
    for (int b = a; b < (a < d ? d : derivatives); b++, S += n * n)
      products(count, n, n, weighted + a * wide, stride, G + b * wide, stride, S);
    products(count, p, n, psi, wide_p, weighted + a * wide, stride, R);
  }
}

/* The symmetric matrix of a cell, its rows in their places and so far apart: with these integrals it is

     A_ij = mu (S_ji + delta_ij sum_a S_aa),     B_i = -R_i,

   and with an axis  A_00 += 2 mu S_22,  B_0 -= R_2. */
INLINE void matrix_of_cell(const Cells *c, int cell, int stride, double *restrict E)
{
  const int d = c->dimension, n = c->nodes, p = c->pressures, nn = n * n;
  const int pairs = d * (d + 1) / 2;
  double X[3 * c->points], S[(pairs + 1) * nn], R[(d + 1) * p * n], grad[nn];
  memset(S, 0, sizeof S), memset(R, 0, sizeof R), memset(grad, 0, sizeof grad);
  places_of(c, cell, X);
  if (c->straight[cell] && !c->axisymmetric)
    integrate_straight(c, X, S, R);
  else
    integrate(c, X, S, R);
  for (int a = 0, pair = 0; a < d; pair += d - a, a++)
    for (int k = 0; k < nn; k++)
      grad[k] += S[pair * nn + k];
  const double *S_ab = S, *hoop = S + pairs * nn, *R_hoop = R + d * p * n;
  for (int a = 0; a < d; a++)
    for (int b = a; b < d; b++, S_ab += nn)
      for (int i = 0; i < n; i++)
        for (int j = 0; j < (a == b ? i + 1 : n); j++) {
          const int row = c->place[d * j + a], column = c->place[d * i + b];
          double entry = S_ab[i * n + j];
          if (a == b)
            entry += grad[i * n + j] + (a == 0 ? 2.0 * hoop[i * n + j] : 0.0);
          E[row * stride + column] = E[column * stride + row] = c->mu * entry;
        }
  for (int a = 0; a < d; a++)
    for (int k = 0; k < p; k++)
      for (int i = 0; i < n; i++) {
        const int row = c->place[d * n + k], column = c->place[d * i + a];
        const double more = a == 0 ? R_hoop[k * n + i] : 0.0;
        E[row * stride + column] = E[column * stride + row] = -R[(a * p + k) * n + i] - more;
      }
  for (int k = 0; k < p; k++)
    for (int l = 0; l < p; l++)
      E[c->place[d * n + k] * stride + c->place[d * n + l]] = 0.0;
}

/* F_ij -= sum over k of L_ki P_kj for `count` rows k, of rows from one to before another, ROWS at a time, and j <= i;
   what is written beyond j = i is of no use. In registers of one type: what is as wide as two goes through memory. */
#define SUBTRACT(name, tiles, ROWS, Vector) \
  INLINE void tiles(int rows, int i, int count, int stride, const double *L, const double *P, double *restrict F) \
  { \
    enum { LENGTH = sizeof(Vector) / sizeof(double), ACROSS = WIDE / LENGTH }; \
    for (int j = 0; j < i + rows; j += WIDE) { \
      Vector sum[ROWS][ACROSS]; \
      for (int r = 0; r < rows; r++) \
        for (int h = 0; h < ACROSS; h++) \
          sum[r][h] = *(const Vector *)(F + (i + r) * stride + j + h * LENGTH); \
      for (int k = 0; k < count; k++) \
        for (int r = 0; r < rows; r++) \
          for (int h = 0; h < ACROSS; h++) \
            sum[r][h] -= L[k * stride + i + r] * *(const Vector *)(P + k * stride + j + h * LENGTH); \
      for (int r = 0; r < rows; r++) \
        for (int h = 0; h < ACROSS; h++) \
          *(Vector *)(F + (i + r) * stride + j + h * LENGTH) = sum[r][h]; \
    } \
  } \
  INLINE void name(int count, int from, int to, int stride, const double *L, const double *P, double *restrict F) \
  { \
    int i = from; \
    for (; i + ROWS <= to; i += ROWS) \
      tiles(ROWS, i, count, stride, L, P, F); \
    for (; i < to; i++) \
      tiles(1, i, count, stride, L, P, F); \
  }

SUBTRACT(subtract_narrow, narrow_tiles, TILE, Columns)

#ifdef WITH_512_BITS
typedef double Wide __attribute__((vector_size(WIDE * sizeof(double)), aligned(sizeof(double)), may_alias));
SUBTRACT(subtract_wide, wide_tiles, WIDE, Wide)

__attribute__((target("arch=x86-64-v4")))
static void subtract_512(int count, int from, int to, int stride, const double *L, const double *P, double *restrict F)
{
  subtract_wide(count, from, to, stride, L, P, F);
}
#endif

/* By as many rows as registers hold the sums of. */
INLINE void subtract(int count, int from, int to, int stride, const double *L, const double *P, double *restrict F)
{
#ifdef WITH_512_BITS
  if (__builtin_cpu_supports("avx512f")) {
    subtract_512(count, from, to, stride, L, P, F);
    return;
  }
#endif
  subtract_narrow(count, from, to, stride, L, P, F);
}

/* F = L D L^T, its lower triangle, from its last row up to the first inner one, BLOCK rows at a time, which outer rows
   take off as many at a time as stay in the cache; L: room for the rows from there. */
INLINE void eliminate(int n, int outer, int stride, double *restrict F, double *restrict L)
{
  enum { BLOCK = 16, CACHED = 64 };
  for (int end = n, begin; end > outer; end = begin) {
    const int over = (end - outer) % BLOCK;
    begin = end - (over ? over : BLOCK);
    for (int k = end - 1; k >= begin; k--) {
      const double *restrict pivot = F + k * stride;
      double *restrict scaled = L + (k - outer) * stride;
      const double reciprocal = 1.0 / pivot[k];
      for (int i = 0; i < k; i++)
        scaled[i] = pivot[i] * reciprocal;
      for (int i = begin; i < k; i++) {
        double *restrict row = F + i * stride;
        for (int j = 0; j <= i; j++)
          row[j] -= scaled[i] * pivot[j];
      }
    }
    subtract(end - begin, outer, begin, stride, L + (begin - outer) * stride, F + begin * stride, F);
  }
  for (int k = outer; k < n; k += CACHED)
    subtract(n - k < CACHED ? n - k : CACHED, 0, outer, stride, L + (k - outer) * stride, F + k * stride, F);
}

/* What is left of the outer rows of a cell's matrix stands there, and in the inner ones its factors. */
INLINE void condense(int n, int outer, int stride, double *restrict E)
{
  double L[(n - outer) * stride + 1];
  eliminate(n, outer, stride, E, L);
  for (int i = 0; i < outer; i++)
    for (int j = 0; j < i; j++)
      E[j * stride + i] = E[i * stride + j];
}

/* Y += T^T S, row by row, for rows T of P; S has `columns` columns. */
INLINE void combine(const Sum *s, const int32_t *rows, const int16_t *slots, int outer, int columns, const double *S,
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
INLINE void constrain(const Sum *s, int cell, int n, int outer, int m, const double *E, int stride, double *restrict R)
{
  const int32_t *rows = s->rows + (int64_t)cell * n;
  const int16_t *slots = s->slots + (int64_t)cell * outer * s->width;
  double left[m * outer], right[outer * m];
  memset(left, 0, sizeof left);
  memset(R, 0, m * m * sizeof *R);
  combine(s, rows, slots, outer, outer, E, stride, left);
  for (int i = 0; i < m; i++)
    for (int j = 0; j < outer; j++)
      right[j * m + i] = left[i * outer + j];
  combine(s, rows, slots, outer, m, right, m, R);
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

/* The loads of the inner ones of these unknowns go to the outer ones; rows: of L and D. */
INLINE void give_loads(int n, int outer, const int32_t *own, const double *rows, double *restrict b)
{
  double load[n];
  for (int i = 0; i < n; i++)
    load[i] = b[own[i]];
  for (int k = n - 1; k >= outer; k--) {
    const double *row = rows + (int64_t)(k - outer) * n, of_pivot = load[k] / row[k];
    for (int i = 0; i < k; i++)
      load[i] -= row[i] * of_pivot;
  }
  for (int i = 0; i < n; i++)
    b[own[i]] = load[i];
}

/* The inner ones from the outer ones, for loads that have been given. */
INLINE void find_inner(int n, int outer, const int32_t *own, const double *rows, const double *b, double *restrict x)
{
  double value[n];
  for (int i = 0; i < outer; i++)
    value[i] = x[own[i]];
  for (int k = outer; k < n; k++) {
    const double *row = rows + (int64_t)(k - outer) * n;
    double left = b[own[k]];
    for (int i = 0; i < k; i++)
      left -= row[i] * value[i];
    x[own[k]] = value[k] = left / row[k];
  }
}

FOR_THIS_MACHINE
void reduce_loads(int cells, int n, int inner, const int32_t *rows, const double *factors, double *b)
{
  for (int64_t cell = 0; cell < cells; cell++)
    give_loads(n, n - inner, rows + cell * n, factors + cell * inner * n, b);
}

FOR_THIS_MACHINE
void recover(int cells, int n, int inner, const int32_t *rows, const double *factors, const double *b, double *x)
{
  for (int64_t cell = 0; cell < cells; cell++)
    find_inner(n, n - inner, rows + cell * n, factors + cell * inner * n, b, x);
}
