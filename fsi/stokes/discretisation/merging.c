/* Which cells are put together in groups, and in which order; see groups.py. */
#include <stdlib.h>

/* The free part beside one that shares most with it, the smaller of equals; -1: there is none. */
static int32_t closest(const Merging *m, int32_t at, const int8_t *taken)
{
  int touched;
  int32_t best = -1, most = 0, size = 0, alone;
  meet_others(m, at, &touched, &alone);
  for (int k = 0; k < touched; k++) {
    const int32_t other = m->touched[k], of_other = outer_at(m, other).unknowns;
    if (taken[other] || m->sides[other] == 0)
      continue;
    if (m->shared[other] > most || (m->shared[other] == most && of_other < size))
      best = other, most = m->shared[other], size = of_other;
  }
  forget_others(m, touched);
  return best;
}

/* Those with few neighbours choose first, or they would find none. */
static void order_parts(const Merging *m, int places)
{
  enum { MANY = 16 };
  int32_t begin[MANY + 1] = {0}, *neighbours = m->slot;
  for (int at = 0; at < places; at++) {
    int touched;
    int32_t alone;
    if (m->part[at] < 0)
      continue;
    const int32_t found = meet_others(m, at, &touched, &alone);
    forget_others(m, touched);
    neighbours[at] = found < MANY ? found : MANY - 1;
    begin[neighbours[at] + 1]++;
  }
  for (int k = 0; k < MANY; k++)
    begin[k + 1] += begin[k];
  for (int at = 0; at < places; at++)
    if (m->part[at] >= 0)
      m->order[begin[neighbours[at]]++] = at;
}

/* Each part is merged with the one that shares most with it, if there is one that is not merged yet. */
static int merge_pairs(Merging *m, int8_t *taken)
{
  const int places = m->cells->cells, count = m->count;
  memset(taken, 0, places);
  order_parts(m, places);
  for (int k = 0; k < count; k++) {
    const int32_t at = m->order[k];
    if (taken[at])
      continue;
    const int32_t other = closest(m, at, taken);
    if (other < 0)
      continue;
    taken[at] = taken[other] = 1;
    if (merge(m, at, other))
      return 1;
  }
  return 0;
}

/* Of a part and one beside it, as both were: by how much more they leave together than each in the mean, twice. What
   the other one has alone, as cells on walls do, is not counted. */
typedef struct {
  int32_t growth, at, other, part, of_other;
} Offer;

/* Whether a part has a pressure that must stay. */
static int keeps_pressure(const Merging *m, int32_t at)
{
  const Outer outer = outer_at(m, at);
  for (int k = 0; k < outer.size; k++)
    if (m->super.pressures[outer.list[k]] > 0 && m->held[outer.list[k]].stays)
      return 1;
  return 0;
}

/* The part beside one with which it grows least, of those that leave no more than so many; part < 0: there is none.
   One that has a single part beside it is merged with that only where a pressure stays, which holds the others. */
static Offer least_growth(const Merging *m, int32_t at, int widest)
{
  int touched;
  int32_t alone;
  const int32_t size = outer_at(m, at).unknowns;
  Offer best = {.at = at, .part = -1};
  const int32_t neighbours = meet_others(m, at, &touched, &alone);
  for (int k = 0; k < touched; k++) {
    const int32_t other = m->touched[k], of_other = outer_at(m, other).unknowns;
    const int32_t left = size + of_other - m->shared[other] - m->sides[other] - alone;
    const int32_t growth = 2 * left - size - of_other;
    if (m->sides[other] == 0 || m->region[other] != m->region[at] || left > widest)
      continue;
    if (neighbours == 1 && !keeps_pressure(m, at) && !keeps_pressure(m, other))
      continue;
    if (best.part < 0 || growth < best.growth)
      best = (Offer){growth, at, other, m->part[at], m->part[other]};
  }
  forget_others(m, touched);
  return best;
}

INLINE int before(const Offer *a, const Offer *b)
{
  return a->growth < b->growth || (a->growth == b->growth && a->at < b->at);
}

/* A heap of offers, the least one first. */
static void put(Offer *heap, int *count, Offer offer)
{
  int at = (*count)++;
  for (; at > 0 && before(&offer, heap + (at - 1) / 2); at = (at - 1) / 2)
    heap[at] = heap[(at - 1) / 2];
  heap[at] = offer;
}

static Offer take(Offer *heap, int *count)
{
  const Offer least = heap[0], last = heap[--*count];
  int at = 0;
  for (int child = 1; child < *count; child = 2 * at + 1) {
    child += child + 1 < *count && before(heap + child + 1, heap + child);
    if (!before(heap + child, &last))
      break;
    heap[at] = heap[child], at = child;
  }
  heap[at] = last;
  return least;
}

/* The two parts that grow least are merged, again and again; each part has one offer in the heap. */
static int merge_least(Merging *m, int widest, Offer *heap)
{
  int count = 0;
  for (int at = 0; at < m->cells->cells; at++)
    if (m->part[at] >= 0) {
      const Offer offer = least_growth(m, at, widest);
      if (offer.part >= 0)
        put(heap, &count, offer);
    }
  while (count > 0) {
    const Offer least = take(heap, &count);
    if (m->part[least.at] != least.part)
      continue;
    if (m->part[least.other] == least.of_other && merge(m, least.at, least.other))
      return 1;
    const Offer next = least_growth(m, m->part[least.at] < 0 ? least.other : least.at, widest);
    if (next.part >= 0)
      put(heap, &count, next);
  }
  return 0;
}

/* Parts in regions of no more than so many, with few unknowns between them. */
static int find_regions(Merging *m, int most)
{
  const int places = m->cells->cells, count = m->count;
  int32_t *number = m->order, *at_place = m->slot; /* of the part at a place, and where a part is */
  int32_t parts = 0, pairs = 0, touched, alone;
  for (int at = 0; at < places; at++)
    if (m->part[at] >= 0) {
      pairs += meet_others(m, at, &touched, &alone);
      forget_others(m, touched);
      at_place[parts] = at, number[at] = parts++;
    }
  int32_t *memory = malloc((2 * (int64_t)count + 1 + 2 * (int64_t)pairs) * sizeof *memory);
  if (!memory)
    return 1;
  int32_t *first = memory, *region = first + count + 1, *beside = region + count, *sides = beside + pairs;
  first[0] = pairs = 0;
  for (int part = 0; part < parts; part++) {
    meet_others(m, at_place[part], &touched, &alone);
    for (int k = 0; k < touched; k++)
      if (m->sides[m->touched[k]] > 0)
        beside[pairs] = number[m->touched[k]], sides[pairs++] = m->sides[m->touched[k]];
    forget_others(m, touched);
    first[part + 1] = pairs;
  }
  const int failed = dissect(&(Graph){parts, first, beside, sides}, most, region);
  for (int part = 0; !failed && part < parts; part++)
    m->region[at_place[part]] = region[part];
  free(memory);
  return failed;
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

static int merge_all(Merging *m, const Wanted *w, int8_t *taken, Offer *heap)
{
  for (int level = 0; level < w->levels && m->count >= w->fewest; level++)
    if (merge_pairs(m, taken))
      return 1;
  if (w->widest > 0 && m->count > w->most) {
    if (find_regions(m, w->most) || merge_least(m, w->widest, heap))
      return 1;
    memset(m->region, 0, m->cells->cells * sizeof *m->region);
  }
  return w->widest > 0 && merge_least(m, w->widest, heap);
}

/* Merge cells that have a side in common, and what comes of it: in pairs, so often, but not if there are fewer parts
   than that; then those that grow least. 0, or 1 where memory is short. */
int merge_cells(const CellLists *c, const Wanted *w, Groups *g)
{
  int8_t *taken = malloc(c->cells + 1);
  Offer *heap = malloc((c->cells + 1) * sizeof *heap);
  Merging m = {.cells = c, .groups = g, .count = c->cells};
  const int failed = !taken || !heap || allocate(g, c->cells) || begin_merging(&m) || merge_all(&m, w, taken, heap);
  if (!failed) {
    int32_t *step = g->steps;
    g->groups = 0;
    for (int at = 0; at < c->cells; at++)
      if (m.part[at] >= 0) {
        step = list_steps(&m, m.part[at], step);
        g->ends[g->groups++] = step - g->steps;
      }
  }
  free_supervariables(&m.super);
  free(m.memory), free(m.held), free(m.begin), free(m.outer), free(taken), free(heap);
  return failed;
}

/* The unknowns that are left of each group, as those of cells; those that are not left by any get a zero. */
void list_groups(const CellLists *c, const Groups *g, int32_t *start, int32_t *list, int8_t *left)
{
  for (int merge = 0; merge < g->merges; merge++)
    for (int k = g->start[merge] + g->outer[merge]; k < g->start[merge + 1]; k++)
      left[g->list[k]] = 0;
  start[0] = 0;
  for (int group = 0; group < g->groups; group++) {
    const int32_t last = g->steps[g->ends[group] - 1], merge = -1 - last;
    const int32_t size = last < 0 ? g->outer[merge] : c->start[last + 1] - c->start[last];
    memcpy(list + start[group], last < 0 ? g->list + g->start[merge] : c->list + c->start[last], size * sizeof *list);
    start[group + 1] = start[group] + size;
  }
}
