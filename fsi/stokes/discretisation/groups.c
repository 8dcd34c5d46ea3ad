/* Elimination of unknowns that stand in groups of cells alone, group by group; see groups.py. */
#include <stdlib.h>

typedef struct {
  const CellLists *cells;
  Groups *groups;
  int count;         /* parts: cells and merges, that are not merged yet */
  int32_t *parts;    /* a cell, or the number of cells + merge */
  int32_t *pairs;    /* the two parts of each merge */
  int32_t *first;    /* where the holders of each unknown begin: */
  int32_t *holders;  /* places in `parts` */
  int32_t *shared;   /* unknowns that a part shares with each other one, zeros */
  int32_t *sides;    /* those of them that it shares with that alone, zeros */
  int32_t *touched;  /* parts with such unknowns */
  int32_t *order;    /* in which parts choose */
  int32_t *slot;     /* of each unknown in a merge */
} Merging;

typedef struct {
  int32_t size;
  const int32_t *list;
} Outer;

static Outer outer_of(const Merging *m, int32_t part)
{
  const CellLists *c = m->cells;
  const Groups *g = m->groups;
  if (part < c->cells)
    return (Outer){c->start[part + 1] - c->start[part], c->list + c->start[part]};
  return (Outer){g->outer[part - c->cells], g->list + g->start[part - c->cells]};
}

/* Which parts hold each unknown. */
static void find_holders(Merging *m)
{
  int32_t *first = m->first;
  const int unknowns = m->cells->unknowns;
  memset(first, 0, (unknowns + 1) * sizeof *first);
  for (int at = 0; at < m->count; at++) {
    const Outer outer = outer_of(m, m->parts[at]);
    for (int k = 0; k < outer.size; k++)
      first[outer.list[k] + 1]++;
  }
  for (int u = 0; u < unknowns; u++)
    first[u + 1] += first[u];
  for (int at = 0; at < m->count; at++) {
    const Outer outer = outer_of(m, m->parts[at]);
    for (int k = 0; k < outer.size; k++)
      m->holders[first[outer.list[k]]++] = at;
  }
  memmove(first + 1, first, unknowns * sizeof *first);
  first[0] = 0;
}

/* What a part shares with others; how many of them have a side in common with it. */
static int32_t meet_others(const Merging *m, int32_t at, int *touched)
{
  const Outer outer = outer_of(m, m->parts[at]);
  int32_t neighbours = 0;
  *touched = 0;
  for (int k = 0; k < outer.size; k++) {
    const int32_t u = outer.list[k], begin = m->first[u], end = m->first[u + 1];
    if (m->cells->stays[u])
      continue;
    for (int32_t q = begin; q < end; q++) {
      const int32_t other = m->holders[q];
      if (other == at)
        continue;
      if (m->shared[other]++ == 0)
        m->touched[(*touched)++] = other;
      if (end - begin == 2 && m->sides[other]++ == 0)
        neighbours++;
    }
  }
  return neighbours;
}

static void forget_others(const Merging *m, int touched)
{
  for (int k = 0; k < touched; k++)
    m->shared[m->touched[k]] = m->sides[m->touched[k]] = 0;
}

/* The free part beside one that shares most with it, the smaller of equals; -1: there is none. */
static int32_t partner(const Merging *m, int32_t at, const int8_t *taken)
{
  int touched;
  int32_t best = -1, most = 0, size = 0;
  meet_others(m, at, &touched);
  for (int k = 0; k < touched; k++) {
    const int32_t other = m->touched[k], of_other = outer_of(m, m->parts[other]).size;
    if (taken[other] || m->sides[other] == 0)
      continue;
    if (m->shared[other] > most || (m->shared[other] == most && of_other < size))
      best = other, most = m->shared[other], size = of_other;
  }
  forget_others(m, touched);
  return best;
}

/* Those with few neighbours choose first, or they would find none. */
static void order_parts(const Merging *m)
{
  enum { MANY = 16 };
  int32_t begin[MANY + 1] = {0}, *neighbours = m->slot;
  for (int at = 0; at < m->count; at++) {
    int touched;
    const int32_t found = meet_others(m, at, &touched);
    forget_others(m, touched);
    neighbours[at] = found < MANY ? found : MANY - 1;
    begin[neighbours[at] + 1]++;
  }
  for (int k = 0; k < MANY; k++)
    begin[k + 1] += begin[k];
  for (int at = 0; at < m->count; at++)
    m->order[begin[neighbours[at]]++] = at;
}

enum { OUTER, PRESSURE, VELOCITY };

/* What becomes of an unknown that is held so many times by what is merged. */
static int kind(const Merging *m, int32_t u, int32_t held)
{
  if (m->cells->stays[u] || m->first[u + 1] - m->first[u] > held)
    return OUTER;
  return m->cells->pressure[u] ? PRESSURE : VELOCITY;
}

/* Two parts become one: its unknowns, outer ones first, then pressures that it has alone, then velocities. */
static void merge(Merging *m, int32_t one, int32_t other)
{
  enum { NONE = -1, ONCE = -2, TWICE = -3 };
  Groups *g = m->groups;
  const int32_t merge = g->merges++;
  const Outer parts[2] = {outer_of(m, one), outer_of(m, other)};
  int32_t *slot = m->slot, *own = g->list + g->start[merge], size = 0;
  int16_t *slots = g->slots + g->begin[merge];
  m->pairs[2 * merge] = one, m->pairs[2 * merge + 1] = other;
  for (int k = 0; k < parts[0].size; k++)
    slot[parts[0].list[k]] = ONCE;
  for (int k = 0; k < parts[1].size; k++)
    slot[parts[1].list[k]] = slot[parts[1].list[k]] == ONCE ? TWICE : ONCE;
  for (int wanted = OUTER; wanted <= VELOCITY; wanted++) {
    for (int p = 0; p < 2; p++)
      for (int k = 0; k < parts[p].size; k++) {
        const int32_t u = parts[p].list[k];
        if (slot[u] < NONE && kind(m, u, slot[u] == TWICE ? 2 : 1) == wanted) {
          own[size] = u;
          slot[u] = size++;
        }
      }
    if (wanted == OUTER)
      g->outer[merge] = size;
  }
  for (int p = 0; p < 2; p++)
    for (int k = 0; k < parts[p].size; k++)
      *slots++ = slot[parts[p].list[k]];
  for (int k = 0; k < size; k++)
    slot[own[k]] = NONE;
  g->start[merge + 1] = g->start[merge] + size;
  g->begin[merge + 1] = g->begin[merge] + parts[0].size + parts[1].size;
  g->factors[merge + 1] = g->factors[merge] + (int64_t)(size - g->outer[merge]) * size;
}

/* Once all parts have been asked to merge: those that are left. */
static void merge_level(Merging *m, int8_t *taken)
{
  int32_t left = 0;
  memset(taken, 0, m->count);
  find_holders(m);
  order_parts(m);
  memset(m->slot, -1, m->cells->unknowns * sizeof *m->slot);
  for (int k = 0; k < m->count; k++) {
    const int32_t at = m->order[k];
    if (taken[at])
      continue;
    const int32_t other = partner(m, at, taken);
    if (other < 0)
      continue;
    taken[at] = taken[other] = 1;
    merge(m, m->parts[at], m->parts[other]);
    m->parts[at] = m->cells->cells + m->groups->merges - 1;
    m->parts[other] = -1;
  }
  for (int at = 0; at < m->count; at++)
    if (m->parts[at] >= 0)
      m->parts[left++] = m->parts[at];
  m->count = left;
}

/* The steps that make a part. */
static int32_t *list_steps(const Merging *m, int32_t part, int32_t *step)
{
  const int32_t merge = part - m->cells->cells;
  if (merge < 0) {
    *step = part;
    return step + 1;
  }
  step = list_steps(m, m->pairs[2 * merge], step);
  step = list_steps(m, m->pairs[2 * merge + 1], step);
  *step = -1 - merge;
  return step + 1;
}

/* Merge cells that have a side in common, and what comes of it, so many times, but no fewer parts than that; 0, or 1
   where memory is short. */
int merge_cells(const CellLists *c, int levels, int fewest, Groups *g)
{
  const int64_t cells = c->cells, most = c->start[cells], slots = c->unknowns > cells ? c->unknowns : cells;
  int32_t *memory = malloc((8 * cells + c->unknowns + 1 + most + slots) * sizeof *memory);
  int8_t *taken = malloc(cells + 1);
  if (!memory || !taken) {
    free(memory), free(taken);
    return 1;
  }
  Merging m = {.cells = c, .groups = g, .count = cells};
  m.parts = memory, m.pairs = m.parts + cells, m.shared = m.pairs + 2 * cells, m.sides = m.shared + cells;
  m.touched = m.sides + cells, m.order = m.touched + cells, m.first = m.order + cells;
  m.holders = m.first + c->unknowns + 1, m.slot = m.holders + most;
  memset(m.shared, 0, 2 * cells * sizeof *m.shared);
  for (int cell = 0; cell < cells; cell++)
    m.parts[cell] = cell;
  g->merges = g->start[0] = g->begin[0] = g->factors[0] = 0;
  for (int level = 0; level < levels && m.count >= fewest; level++)
    merge_level(&m, taken);
  g->groups = m.count;
  int32_t *step = g->steps;
  for (int at = 0; at < m.count; at++) {
    step = list_steps(&m, m.parts[at], step);
    g->ends[at] = step - g->steps;
  }
  free(memory), free(taken);
  return 0;
}

/* The unknowns that are left of each group, as those of cells. */
void list_groups(const CellLists *c, const Groups *g, int32_t *start, int32_t *list)
{
  start[0] = 0;
  for (int at = 0; at < g->groups; at++) {
    const int32_t last = g->steps[g->ends[at] - 1], merge = -1 - last;
    const int32_t *own = last < 0 ? g->list + g->start[merge] : c->list + c->start[last];
    const int32_t size = last < 0 ? g->outer[merge] : c->start[last + 1] - c->start[last];
    memcpy(list + start[at], own, size * sizeof *list);
    start[at + 1] = start[at] + size;
  }
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
  return (Part){m, m, R, room, R + m * m};
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
  const int n = g->start[merge + 1] - g->start[merge], outer = g->outer[merge], stride = widened(n);
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

/* The sum of what groups of cells leave. Parts that wait to be merged lie one behind the other in `room`. */
FOR_THIS_MACHINE
void add_cells(const Cells *c, const Sum *s, const Groups *g, double *room, double *restrict values,
               double *restrict kept, double *restrict matrices, double *restrict factors, double *restrict of_groups)
{
  enum { DEEPEST = 64 };
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

INLINE int size_of(const Groups *g, int merge)
{
  return g->start[merge + 1] - g->start[merge];
}

/* Those of parts first. */
void reduce_groups(const Groups *g, const double *factors, double *b)
{
  for (int m = 0; m < g->merges; m++)
    give_loads(size_of(g, m), g->outer[m], g->list + g->start[m], factors + g->factors[m], b);
}

/* Those of parts last. */
void recover_groups(const Groups *g, const double *factors, const double *b, double *x)
{
  for (int m = g->merges - 1; m >= 0; m--)
    find_inner(size_of(g, m), g->outer[m], g->list + g->start[m], factors + g->factors[m], b, x);
}
