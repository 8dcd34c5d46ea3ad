typedef struct {
  int dimension, axisymmetric;
  int cells, points, nodes, pressures, inner, count; /* how many; of each cell but the first; of quadrature the last */
  double mu;
  const int8_t *straight;    /* whether each cell is that */
  const int32_t *geometry;   /* its points */
  const double *x;           /* coordinates of all points, three each */
  const int32_t *place;      /* of each of a cell's rows (u, p) in its matrix */
  const double *weights;     /* of the points of quadrature */
  const double *of_map;      /* values and derivatives there of what maps a cell, (count, 1 + d, points) */
  const double *of_u, *of_p; /* the same of what u is made of, (count, 1 + d, nodes), and values for p */
  const double *stiffness;   /* int d_a phi_i d_b phi_j on the reference cell, (d, d, nodes, nodes) */
  const double *divergence;  /* int psi_k d_a phi_i there, (d, pressures, nodes) */
} Cells;

typedef struct {
  int width, most;          /* entries in a row of P; the most unknowns of a cell */
  const int32_t *rows;      /* of x on each cell, in that order */
  const double *weights;    /* entries of P, (rows of x, width) */
  const int32_t *start;     /* where the unknowns of each cell begin in their list */
  const int16_t *slots;     /* which of its unknowns each entry of its rows of P meets; -1: none */
  const int8_t *plain;      /* whether all these rows are unit rows */
  const int64_t *first;     /* where the positions of each group begin */
  const int32_t *positions; /* of its entries in the sum; -1: none */
  const int32_t *kept;      /* where each of its rows is kept as it is; -1: nowhere */
} Sum;

double squared_strain_rate(const Cells *c, const int32_t *nodes, const double *u);
void times_cells(int cells, int n, int size, int columns, const int32_t *rows, const double *E, const double *x,
                 double *y);
void times_cells_extended(int cells, int n, int size, int columns, const int32_t *rows, const double *E,
                    const long double *x, long double *y);
void times_kept(int count, int n, int transposed, const int32_t *row, const int32_t *columns, const double *kept,
                const double *x, double *y);
void times_kept_extended(int count, int n, int transposed, const int32_t *row, const int32_t *columns,
                         const double *kept, const long double *x, long double *y);
void reduce_loads(int cells, int n, int inner, const int32_t *rows, const double *factors, double *b);
void recover(int cells, int n, int inner, const int32_t *rows, const double *factors, const double *b, double *x);
