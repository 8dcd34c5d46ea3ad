typedef struct {
  int cells, points, velocities, pressures, inner; /* how many, the last four of each cell */
  const uintptr_t *a, *b;   /* what tabulates the forms on cells of each kind */
  const int8_t *kind;       /* of each cell */
  const int32_t *geometry;  /* its points */
  const double *x, *mu;     /* coordinates of all points, three each */
  const int32_t *source;    /* of each entry of a cell's matrix, among those of a, of b, and a zero */
} Cells;

typedef struct {
  int width, most;          /* entries in a row of P; the most unknowns of a cell */
  const int32_t *rows;      /* of x on each cell, in that order */
  const double *weights;    /* entries of P, (rows of x, width) */
  const int32_t *start;     /* where the unknowns of each cell begin in their list */
  const int16_t *slots;     /* which of its unknowns each entry of its rows of P meets; -1: none */
  const int8_t *plain;      /* whether all these rows are unit rows */
  const int64_t *first;     /* where its positions begin */
  const int32_t *positions; /* of its entries in the sum; -1: none */
  const int32_t *kept;      /* where each of its rows is kept as it is; -1: nowhere */
} Sum;

typedef struct {
  int unknowns;
  const int32_t *start, *list;         /* the unknowns of each cell */
  const int32_t *first, *place, *cell; /* where each unknown stands in that list, and in which cells */
  const int8_t *pressure;              /* which unknowns are pressures */
  int coupled;                         /* whether pressures of a cell meet each other */
} Meetings;

void add_cells(const Cells *, const Sum *, double *values, double *kept, double *matrices, double *factors);
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
int32_t list_unknowns(int cells, int n, int outer, int w, const int32_t *rows, const int32_t *columns,
                      const double *weights, int32_t *start, int32_t *list, int16_t *slots, int8_t *plain);
void list_meetings(int cells, int unknowns, const int32_t *start, const int32_t *list, int32_t *first,
                   int32_t *place, int32_t *cell_of);
void count_entries(const Meetings *, int32_t *mark, int32_t *count);
void list_entries(const Meetings *, int32_t *mark, int32_t *next, int32_t *indices);
void find_positions(const Meetings *, const int32_t *indptr, const int32_t *indices, const int64_t *offset,
                    int32_t *where, int32_t *positions);
