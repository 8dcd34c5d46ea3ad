/* Unknowns that the same cells have, such as those of a side, and that all stay or none: supervariables (Duff and Reid
   1983, ACM Trans. Math. Softw. 9:302). What is asked of unknowns is asked of them, a sixth as many. */
#include <stdlib.h>

typedef struct {
  int32_t *of;    /* the class of each unknown */
  int32_t *size;  /* of each class: how many unknowns it has, */
  int32_t *cell;  /* the cell that has met it last, */
  int32_t *split; /* and the class of those that this cell has */
} Classes;

/* Divide unknowns by which cells have them, cell after cell; a class that has lost all of its own is used again. */
static void classify(const CellLists *c, Classes *k, int32_t *unused)
{
  int32_t classes = 2, empty = 0;
  memset(k->cell, -1, (c->unknowns + 3) * sizeof *k->cell);
  memset(k->size, 0, 2 * sizeof *k->size);
  for (int u = 0; u < c->unknowns; u++)
    k->size[k->of[u] = c->stays[u] != 0]++;
  for (int cell = 0; cell < c->cells; cell++)
    for (int q = c->start[cell]; q < c->start[cell + 1]; q++) {
      const int32_t u = c->list[q], old = k->of[u];
      if (k->cell[old] != cell) {
        k->cell[old] = cell;
        k->split[old] = k->size[old] == 1 ? old : empty > 0 ? unused[--empty] : classes++;
        if (k->split[old] != old)
          k->size[k->split[old]] = 0;
      }
      const int32_t own = k->split[old];
      if (own == old)
        continue;
      k->of[u] = own, k->size[own]++;
      if (--k->size[old] == 0)
        unused[empty++] = old;
    }
}

/* Number them as cells meet them, and list those of each cell. */
static void list_by_cells(const CellLists *c, const Classes *k, Supervariables *s, int32_t *number)
{
  memset(number, -1, (c->unknowns + 3) * sizeof *number);
  memset(k->cell, -1, (c->unknowns + 3) * sizeof *k->cell);
  s->count = s->start[0] = 0;
  for (int cell = 0; cell < c->cells; cell++) {
    int32_t end = s->start[cell];
    for (int q = c->start[cell]; q < c->start[cell + 1]; q++) {
      const int32_t class = k->of[c->list[q]];
      if (k->cell[class] == cell)
        continue;
      k->cell[class] = cell;
      if (number[class] < 0)
        number[class] = s->count++;
      s->list[end++] = number[class];
    }
    s->start[cell + 1] = end;
  }
  for (int u = 0; u < c->unknowns; u++)
    s->of[u] = number[k->of[u]];
}

/* List the unknowns of each; those that no cell has are of none. */
static void list_members(const CellLists *c, Supervariables *s, int32_t *next)
{
  memset(s->begin, 0, (s->count + 1) * sizeof *s->begin);
  memset(s->pressures, 0, s->count * sizeof *s->pressures);
  for (int u = 0; u < c->unknowns; u++)
    if (s->of[u] >= 0) {
      s->begin[s->of[u] + 1]++;
      s->pressures[s->of[u]] += c->pressure[u];
    }
  for (int k = 0; k < s->count; k++)
    s->begin[k + 1] += s->begin[k];
  memcpy(next, s->begin, s->count * sizeof *next);
  for (int pressure = 1; pressure >= 0; pressure--)
    for (int u = 0; u < c->unknowns; u++)
      if (s->of[u] >= 0 && c->pressure[u] == pressure)
        s->unknowns[next[s->of[u]]++] = u;
}

void free_supervariables(Supervariables *s)
{
  free(s->of);
}

/* Those of cells. 0, or 1 where memory is short. */
int find_supervariables(const CellLists *c, Supervariables *s)
{
  const int64_t unknowns = c->unknowns + 3, all = c->start[c->cells];
  int32_t *work = malloc(5 * unknowns * sizeof *work);
  s->of = malloc((4 * unknowns + c->cells + 1 + all) * sizeof *s->of);
  const int failed = !work || !s->of;
  if (!failed) {
    s->begin = s->of + unknowns, s->unknowns = s->begin + unknowns, s->pressures = s->unknowns + unknowns;
    s->start = s->pressures + unknowns, s->list = s->start + c->cells + 1;
    Classes k = {work, work + unknowns, work + 2 * unknowns, work + 3 * unknowns};
    int32_t *other = work + 4 * unknowns;
    classify(c, &k, other);
    list_by_cells(c, &k, s, other);
    list_members(c, s, other);
  }
  free(work);
  return failed;
}
