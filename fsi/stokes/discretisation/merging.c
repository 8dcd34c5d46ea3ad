/* Which cells are put together in groups, and in which order; see groups.py. */
#include <stdlib.h>

typedef struct {
  const CellLists *cells;
  Groups *groups;
  int count;           /* parts that are not merged yet */
  int32_t *part;       /* at each place a cell, or the number of cells + merge; -1: it is in another one */
  int32_t *pairs;      /* the two parts of each merge */
  int32_t *first;      /* where the holders of each unknown begin: */
  int32_t *holders;    /* places of parts */
  int32_t *held;       /* how many hold each unknown */
  int32_t *shared;     /* unknowns that a part shares with each other one, zeros */
  int32_t *sides;      /* those of them that it shares with that alone, and need not stay, zeros */
  int32_t *touched;    /* parts with such unknowns */
  int32_t *order;      /* in which parts choose */
  int32_t *weight;     /* the cells at each place */
  int32_t *slot;       /* of each unknown in a merge */
  int64_t lists, slots; /* how many unknowns and slots of merges there is room for */
} Merging;

typedef struct {
  int32_t size;
  const int32_t *list;
} Outer;

static Outer outer_of(const CellLists *c, const Groups *g, int32_t part)
{
  if (part < c->cells)
    return (Outer){c->start[part + 1] - c->start[part], c->list + c->start[part]};
  return (Outer){g->outer[part - c->cells], g->list + g->start[part - c->cells]};
}

static Outer outer_at(const Merging *m, int32_t at)
{
  return outer_of(m->cells, m->groups, m->part[at]);
}

/* Which cells hold each unknown. */
static void find_holders(Merging *m)
{
  const CellLists *c = m->cells;
  memset(m->held, 0, c->unknowns * sizeof *m->held);
  for (int k = 0; k < c->start[c->cells]; k++)
    m->held[c->list[k]]++;
  m->first[0] = 0;
  for (int u = 0; u < c->unknowns; u++)
    m->first[u + 1] = m->first[u] + m->held[u];
  memset(m->held, 0, c->unknowns * sizeof *m->held);
  for (int cell = 0; cell < c->cells; cell++)
    for (int k = c->start[cell]; k < c->start[cell + 1]; k++) {
      const int32_t u = c->list[k];
      m->holders[m->first[u] + m->held[u]++] = cell;
    }
}

/* What a part shares with others; how many of them have a side in common with it, and what it has alone. */
static int32_t meet_others(const Merging *m, int32_t at, int *touched, int32_t *alone)
{
  const Outer outer = outer_at(m, at);
  int32_t neighbours = 0;
  *touched = 0, *alone = 0;
  for (int k = 0; k < outer.size; k++) {
    const int32_t u = outer.list[k], *holder = m->holders + m->first[u];
    const int held = m->held[u], stays = m->cells->stays[u];
    *alone += held == 1 && !stays;
    for (int q = 0; q < held; q++) {
      const int32_t other = holder[q];
      if (other == at)
        continue;
      if (m->shared[other]++ == 0)
        m->touched[(*touched)++] = other;
      if (held == 2 && !stays && m->sides[other]++ == 0)
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
static int32_t closest(const Merging *m, int32_t at, const int8_t *taken)
{
  int touched;
  int32_t best = -1, most = 0, size = 0, alone;
  meet_others(m, at, &touched, &alone);
  for (int k = 0; k < touched; k++) {
    const int32_t other = m->touched[k], of_other = outer_at(m, other).size;
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

enum { OUTER, PRESSURE, VELOCITY };

/* What becomes of an unknown that is held so many times by what is merged. */
static int kind(const Merging *m, int32_t u, int32_t held)
{
  if (m->cells->stays[u] || m->held[u] > held)
    return OUTER;
  return m->cells->pressure[u] ? PRESSURE : VELOCITY;
}

/* A part that holds an unknown is in another one. */
static void hand_over(Merging *m, int32_t u, int32_t from, int32_t to, int to_holds)
{
  int32_t *holder = m->holders + m->first[u];
  while (*holder != from)
    holder++;
  *holder = to_holds ? m->holders[m->first[u] + --m->held[u]] : to;
}

/* The same memory, or more with what it has, for so many things; NULL where memory is short. */
static void *grown(void *memory, int64_t *room, int64_t wanted, int64_t bytes)
{
  if (wanted <= *room)
    return memory;
  void *more = realloc(memory, 2 * wanted * bytes);
  if (more)
    *room = 2 * wanted;
  return more;
}

/* Two parts become one: its unknowns, outer ones first, then pressures that it has alone, then velocities. The larger
   one comes first: so few parts wait for others at any time. */
static int merge(Merging *m, int32_t one, int32_t other)
{
  enum { NONE = -1, ONCE = -2, TWICE = -3 };
  Groups *g = m->groups;
  if (m->weight[one] < m->weight[other]) {
    const int32_t larger = other;
    other = one, one = larger;
  }
  const int32_t merge = g->merges, together = outer_at(m, one).size + outer_at(m, other).size;
  int32_t *list = grown(g->list, &m->lists, g->start[merge] + together, sizeof *list);
  g->list = list ? list : g->list;
  int16_t *slots = grown(g->slots, &m->slots, g->begin[merge] + together, sizeof *slots);
  g->slots = slots ? slots : g->slots;
  if (!list || !slots)
    return 1;
  const Outer parts[2] = {outer_at(m, one), outer_at(m, other)};
  int32_t *slot = m->slot, *own = g->list + g->start[merge], size = 0;
  slots += g->begin[merge];
  for (int k = 0; k < parts[0].size; k++)
    slot[parts[0].list[k]] = ONCE;
  for (int k = 0; k < parts[1].size; k++) {
    const int32_t u = parts[1].list[k];
    slot[u] = slot[u] == ONCE ? TWICE : ONCE;
  }
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
  for (int k = 0; k < parts[0].size; k++)
    slot[parts[0].list[k]] = ONCE;
  for (int k = 0; k < parts[1].size; k++)
    hand_over(m, parts[1].list[k], other, one, slot[parts[1].list[k]] == ONCE);
  for (int k = 0; k < parts[0].size; k++)
    slot[parts[0].list[k]] = NONE;
  m->pairs[2 * merge] = m->part[one], m->pairs[2 * merge + 1] = m->part[other];
  m->part[one] = m->cells->cells + merge, m->part[other] = -1;
  m->weight[one] += m->weight[other];
  m->count--, g->merges++;
  g->start[merge + 1] = g->start[merge] + size;
  g->begin[merge + 1] = g->begin[merge] + together;
  g->factors[merge + 1] = g->factors[merge] + (int64_t)(size - g->outer[merge]) * size;
  return 0;
}

/* Each part is merged with the one that shares most with it, if there is one that is not merged yet. */
static int merge_pairs(Merging *m, int8_t *taken)
{
  const int places = m->cells->cells, count = m->count;
  memset(taken, 0, places);
  order_parts(m, places);
  memset(m->slot, -1, m->cells->unknowns * sizeof *m->slot);
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
    if (m->cells->stays[outer.list[k]] && m->cells->pressure[outer.list[k]])
      return 1;
  return 0;
}

/* The part beside one with which it grows least, of those that leave no more than so many; part < 0: there is none.
   One that has a single part beside it is merged with that only where a pressure stays, which holds the others. */
static Offer least_growth(const Merging *m, int32_t at, int widest)
{
  int touched;
  int32_t alone;
  const int32_t size = outer_at(m, at).size;
  Offer best = {.at = at, .part = -1};
  const int32_t neighbours = meet_others(m, at, &touched, &alone);
  for (int k = 0; k < touched; k++) {
    const int32_t other = m->touched[k], of_other = outer_at(m, other).size;
    const int32_t left = size + of_other - m->shared[other] - m->sides[other] - alone;
    const int32_t growth = 2 * left - size - of_other;
    if (m->sides[other] == 0 || left > widest)
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
  memset(m->slot, -1, m->cells->unknowns * sizeof *m->slot);
  return w->widest > 0 && merge_least(m, w->widest, heap);
}

static int allocate(Groups *g, int cells)
{
  g->start = malloc((cells + 1) * sizeof *g->start), g->begin = malloc((cells + 1) * sizeof *g->begin);
  g->outer = malloc(cells * sizeof *g->outer), g->factors = malloc((cells + 1) * sizeof *g->factors);
  g->ends = malloc(cells * sizeof *g->ends), g->steps = malloc(2 * cells * sizeof *g->steps);
  if (!g->start || !g->begin || !g->outer || !g->factors || !g->ends || !g->steps)
    return 1;
  g->merges = g->start[0] = g->begin[0] = g->factors[0] = 0;
  return 0;
}

void free_groups(Groups *g)
{
  void *held[] = {g->start, g->list, g->outer, g->begin, g->slots, g->factors, g->ends, g->steps};
  for (int k = 0; k < (int)(sizeof held / sizeof *held); k++)
    free(held[k]);
}

/* Merge cells that have a side in common, and what comes of it: in pairs, so often, but not if there are fewer parts
   than that; then those that grow least. 0, or 1 where memory is short. */
int merge_cells(const CellLists *c, const Wanted *w, Groups *g)
{
  const int64_t cells = c->cells, all = c->start[cells], slots = c->unknowns > cells ? c->unknowns : cells;
  int32_t *memory = malloc((8 * cells + 2 * (int64_t)c->unknowns + 1 + all + slots) * sizeof *memory);
  int8_t *taken = malloc(cells + 1);
  Offer *heap = malloc((cells + 1) * sizeof *heap);
  Merging m = {.cells = c, .groups = g, .count = cells};
  int failed = !memory || !taken || !heap || allocate(g, cells);
  if (!failed) {
    m.part = memory, m.pairs = m.part + cells, m.shared = m.pairs + 2 * cells, m.sides = m.shared + cells;
    m.touched = m.sides + cells, m.order = m.touched + cells, m.weight = m.order + cells;
    m.first = m.weight + cells, m.held = m.first + c->unknowns + 1, m.holders = m.held + c->unknowns;
    m.slot = m.holders + all;
    memset(m.shared, 0, 2 * cells * sizeof *m.shared);
    for (int cell = 0; cell < cells; cell++)
      m.part[cell] = cell, m.weight[cell] = 1;
    find_holders(&m);
    failed = merge_all(&m, w, taken, heap);
  }
  if (!failed) {
    int32_t *step = g->steps;
    g->groups = 0;
    for (int at = 0; at < cells; at++)
      if (m.part[at] >= 0) {
        step = list_steps(&m, m.part[at], step);
        g->ends[g->groups++] = step - g->steps;
      }
  }
  free(memory), free(taken), free(heap);
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
    const int32_t last = g->steps[g->ends[group] - 1];
    const Outer outer = outer_of(c, g, last < 0 ? c->cells - 1 - last : last);
    memcpy(list + start[group], outer.list, outer.size * sizeof *list);
    start[group + 1] = start[group] + outer.size;
  }
}
