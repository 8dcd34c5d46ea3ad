/* Elimination of unknowns that stand in groups of cells alone, group by group; see groups.py. */

INLINE int size_of(const Groups *g, int merge)
{
  return g->start[merge + 1] - g->start[merge];
}

/* What a cell or a merge leaves: the lower triangle of a matrix, its rows `stride` apart. */
typedef struct {
  int size, stride;
  double *matrix, *begin, *end; /* what it takes of the room */
} Part;

/* It goes into that of what it is merged into. */
INLINE void spread(const Part *part, const int16_t *slots, double *restrict F, int stride)
{
  for (int i = 0; i < part->size; i++)
    for (int j = 0; j <= i; j++) {
      const int row = slots[i], column = slots[j];
      F[row > column ? row * stride + column : column * stride + row] += part->matrix[i * part->stride + j];
    }
}

/* A lower triangle, its rows one behind the other: whole vectors, beyond whose rows the next ones come. */
INLINE void pack(int n, const double *E, int stride, double *to)
{
  for (int i = 0; i < n - 1; to += ++i)
    for (int j = 0; j <= i; j += TILE)
      *(Columns *)(to + j) = *(const Columns *)(E + i * stride + j);
  memcpy(to, E + (n - 1) * stride, n * sizeof *E);
}

/* What a cell leaves, its rows and factors kept where they are wanted. */
INLINE Part cell_left(const Cells *c, const Sum *s, int cell, double *room, double *kept, double *matrices,
                      double *factors)
{
  const int n = c->dimension * c->nodes + c->pressures, outer = n - c->inner, stride = widened(n);
  double *E = room, *R = E + n * stride;
  matrix_of_cell(c, cell, stride, E);
  for (int i = 0; i < outer; i++) {
    const int32_t place = s->kept[(int64_t)cell * outer + i];
    if (place >= 0)
      memcpy(kept + (int64_t)place * n, E + i * stride, n * sizeof *E);
  }
  if (matrices)
    pack(n, E, stride, matrices + (int64_t)cell * (n * (n + 1) / 2));
  condense(n, outer, stride, E);
  for (int k = outer; k < n; k++)
    memcpy(factors + ((int64_t)cell * c->inner + k - outer) * n, E + k * stride, n * sizeof *E);
  const int m = s->start[cell + 1] - s->start[cell];
  if (s->plain[cell])
    return (Part){m, stride, E, room, R};
  constrain(s, cell, n, outer, m, E, stride, R);
  return (Part){m, m, R, room, R + m * widened(m)};
}

/* The lower triangle of n rows, further down: whole vectors are moved, which end within each row. */
INLINE void move_down(int n, const double *from, int stride, double *to, int narrower)
{
  for (int i = 0; i < n; i++, from += stride, to += narrower)
    for (int j = 0; j <= i; j += WIDE)
      for (int h = 0; h < WIDE; h += TILE)
        *(Columns *)(to + j + h) = *(const Columns *)(from + j + h);
}

/* What is left of A and B once they are one, in the place of A. */
INLINE Part merge_left(const Groups *g, int merge, const Part *A, const Part *B, double *of_groups)
{
  const int n = size_of(g, merge), outer = g->outer[merge], stride = widened(n);
  const int16_t *slots = g->slots + g->begin[merge];
  double *F = B->end, *L = F + n * stride, *to = of_groups + g->factors[merge];
  memset(F, 0, n * stride * sizeof *F);
  spread(A, slots, F, stride);
  spread(B, slots + A->size, F, stride);
  eliminate(n, outer, stride, F, L);
  for (int k = outer; k < n; k++, to += n)
    memcpy(to, F + k * stride, n * sizeof *F);
  const int narrower = widened(outer);
  move_down(outer, F, stride, A->begin, narrower);
  return (Part){outer, narrower, A->begin, A->begin, A->begin + outer * narrower};
}

INLINE void add(const int32_t *at, const Part *part, double *restrict values)
{
  const int m = part->size;
  for (int i = 0; i < m; i++)
    for (int j = 0; j <= i; j++) {
      const int32_t place = at[i * m + j], mirrored = at[j * m + i];
      if (place < 0)
        continue;
      values[place] += part->matrix[i * part->stride + j];
      if (i != j)
        values[mirrored] += part->matrix[i * part->stride + j];
    }
}

enum { DEEPEST = 64 }; /* parts that wait at a time: as the larger one comes first, twice as many cells have one more */

/* How many numbers the next one needs at most: beside those that wait to be merged its own room. */
int64_t room_of_groups(const CellLists *c, const Groups *g)
{
  const int64_t n = c->rows, of_cell = n * widened(n);
  int64_t ends[DEEPEST] = {0}, most = 0;
  for (int group = 0, step = 0; group < g->groups; group++) {
    int last = 0;
    for (; step < g->ends[group]; step++) {
      const int merge = -1 - g->steps[step];
      int64_t needed;
      if (merge < 0) {
        const int64_t m = c->start[g->steps[step] + 1] - c->start[g->steps[step]];
        needed = ends[last] + of_cell + m * widened(m), last++;
        ends[last] = needed;
      } else {
        const int64_t size = size_of(g, merge), outer = g->outer[merge];
        needed = ends[last] + (2 * size - outer) * widened(size), last--;
        ends[last] = ends[last - 1] + outer * widened(outer);
      }
      most = needed > most ? needed : most;
    }
  }
  return most + WIDE;
}

/* The sum of what groups of cells leave. Parts that wait to be merged lie one behind the other in `room`. */
FOR_THIS_MACHINE
void add_cells(const Cells *c, const Sum *s, const Groups *g, double *room, double *restrict values,
               double *restrict kept, double *restrict matrices, double *restrict factors, double *restrict of_groups)
{
  Part parts[DEEPEST];
  for (int group = 0, step = 0; group < g->groups; group++) {
    int last = -1;
    for (; step < g->ends[group]; step++)
      if (g->steps[step] >= 0) {
        double *free = last < 0 ? room : parts[last].end;
        parts[++last] = cell_left(c, s, g->steps[step], free, kept, matrices, factors);
      } else {
        last--;
        parts[last] = merge_left(g, -1 - g->steps[step], &parts[last], &parts[last + 1], of_groups);
      }
    add(s->positions + s->first[group], parts, values);
  }
}

/* Those of parts first. */
FOR_THIS_MACHINE
void reduce_groups(const Groups *g, const double *factors, double *b)
{
  for (int m = 0; m < g->merges; m++)
    give_loads(size_of(g, m), g->outer[m], g->list + g->start[m], factors + g->factors[m], b);
}

/* Those of parts last. */
FOR_THIS_MACHINE
void recover_groups(const Groups *g, const double *factors, const double *b, double *x)
{
  for (int m = g->merges - 1; m >= 0; m--)
    find_inner(size_of(g, m), g->outer[m], g->list + g->start[m], factors + g->factors[m], b, x);
}
