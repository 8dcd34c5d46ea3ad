/* Parts of a mesh, what they have in common, and how two of them become one; see groups.py. */
#include <stdlib.h>

/* Of a supervariable: which parts hold it, and what it is; side by side in memory, as they are asked for together. */
typedef struct {
  int32_t first;       /* where its holders begin, */
  int32_t held;        /* how many they are, */
  int32_t unknowns;    /* how many unknowns it has, */
  int32_t stays;       /* and whether they must stay */
} Held;

/* What a part leaves. */
typedef struct {
  int32_t unknowns;    /* how many */
  int32_t size;        /* of so many supervariables: */
  const int32_t *list;
} Outer;

typedef struct {
  const CellLists *cells;
  Supervariables super;
  Groups *groups;
  int count;           /* parts that are not merged yet */
  int32_t *memory;     /* of what comes here, but for held, begin and outer: */
  int32_t *part;       /* at each place a cell, or the number of cells + merge; -1: it is in another one */
  int32_t *pairs;      /* the two parts of each merge */
  Held *held;          /* of each supervariable */
  int32_t *holders;    /* places of parts */
  int64_t *begin;      /* where those that merges leave begin: */
  int32_t *outer;      /* their supervariables */
  int32_t *mark;       /* of each supervariable, zeros between merges */
  int32_t *shared;     /* unknowns that a part shares with each other one, zeros */
  int32_t *sides;      /* those of them that it shares with that alone, and need not stay, zeros */
  int32_t *touched;    /* parts with such unknowns */
  int32_t *order;      /* in which parts choose */
  int32_t *weight;     /* the cells at each place */
  int32_t *slot;       /* of each unknown in a merge, and numbers of parts */
  int32_t *region;     /* of each place, if there are many parts: within it parts are merged first; zeros */
  int64_t lists, slots, outers; /* how many unknowns, slots and supervariables of merges there is room for */
} Merging;

static Outer outer_at(const Merging *m, int32_t at)
{
  const CellLists *c = m->cells;
  const Supervariables *s = &m->super;
  const int32_t part = m->part[at], merge = part - c->cells;
  if (merge < 0)
    return (Outer){c->start[part + 1] - c->start[part], s->start[part + 1] - s->start[part], s->list + s->start[part]};
  return (Outer){m->groups->outer[merge], m->begin[merge + 1] - m->begin[merge], m->outer + m->begin[merge]};
}

/* Which cells hold each supervariable. */
static void find_holders(Merging *m)
{
  const Supervariables *s = &m->super;
  const CellLists *c = m->cells;
  for (int u = 0; u < s->count; u++)
    m->held[u] = (Held){.unknowns = s->begin[u + 1] - s->begin[u], .stays = c->stays[s->unknowns[s->begin[u]]]};
  for (int k = 0; k < s->start[c->cells]; k++)
    m->held[s->list[k]].held++;
  for (int u = 1; u < s->count; u++)
    m->held[u].first = m->held[u - 1].first + m->held[u - 1].held;
  for (int u = 0; u < s->count; u++)
    m->held[u].held = 0;
  for (int cell = 0; cell < c->cells; cell++)
    for (int k = s->start[cell]; k < s->start[cell + 1]; k++) {
      Held *held = m->held + s->list[k];
      m->holders[held->first + held->held++] = cell;
    }
}

/* What a part shares with others; how many of them have a side in common with it, and what it has alone. */
static int32_t meet_others(const Merging *m, int32_t at, int *touched, int32_t *alone)
{
  const Outer outer = outer_at(m, at);
  int32_t neighbours = 0;
  *touched = 0, *alone = 0;
  for (int k = 0; k < outer.size; k++) {
    const Held held = m->held[outer.list[k]];
    const int32_t *holder = m->holders + held.first, unknowns = held.unknowns;
    const int eliminated = held.held <= 2 && !held.stays;
    if (held.held == 1)
      *alone += eliminated ? unknowns : 0;
    for (int q = 0; q < held.held; q++) {
      const int32_t other = holder[q];
      if (other == at)
        continue;
      if (m->shared[other] == 0)
        m->touched[(*touched)++] = other;
      m->shared[other] += unknowns;
      if (!eliminated)
        continue;
      neighbours += m->sides[other] == 0;
      m->sides[other] += unknowns;
    }
  }
  return neighbours;
}

static void forget_others(const Merging *m, int touched)
{
  for (int k = 0; k < touched; k++)
    m->shared[m->touched[k]] = m->sides[m->touched[k]] = 0;
}

/* A part that holds a supervariable is in another one. */
static void hand_over(Merging *m, int32_t u, int32_t from, int32_t to, int to_holds)
{
  Held *held = m->held + u;
  int32_t *holder = m->holders + held->first;
  while (*holder != from)
    holder++;
  *holder = to_holds ? m->holders[held->first + --held->held] : to;
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

/* Room for a merge of so many unknowns and supervariables; 1 where memory is short. */
static int make_room(Merging *m, int64_t unknowns, int64_t supervariables)
{
  Groups *g = m->groups;
  int32_t *list = grown(g->list, &m->lists, g->start[g->merges] + unknowns, sizeof *list);
  g->list = list ? list : g->list;
  int16_t *slots = grown(g->slots, &m->slots, g->begin[g->merges] + unknowns, sizeof *slots);
  g->slots = slots ? slots : g->slots;
  int32_t *outer = grown(m->outer, &m->outers, m->begin[g->merges] + supervariables, sizeof *outer);
  m->outer = outer ? outer : m->outer;
  return !list || !slots || !outer;
}

/* Unknowns of a supervariable are those of a merge that come next. */
static int32_t append(const Merging *m, const int32_t *unknown, int32_t count, int32_t *own, int32_t size)
{
  for (int k = 0; k < count; k++) {
    own[size] = unknown[k];
    m->slot[unknown[k]] = size++;
  }
  return size;
}

/* The slots of what a part left, as it lists its unknowns. */
static int16_t *list_slots(const Merging *m, int32_t part, int16_t *slots)
{
  const CellLists *c = m->cells;
  const Groups *g = m->groups;
  const int32_t merge = part - c->cells, size = merge < 0 ? c->start[part + 1] - c->start[part] : g->outer[merge];
  const int32_t *list = merge < 0 ? c->list + c->start[part] : g->list + g->start[merge];
  for (int k = 0; k < size; k++)
    *slots++ = m->slot[list[k]];
  return slots;
}

/* Supervariables of two parts that are merged, as far as they are listed. */
enum { NONE, MARKED, BEGUN };

/* The unknowns of a merge of two parts, whose supervariables are marked: outer ones first, then pressures that it has
   alone, then velocities. */
static void list_merged(Merging *m, const Outer *parts)
{
  const Supervariables *s = &m->super;
  Groups *g = m->groups;
  const int32_t merge = g->merges;
  int32_t *own = g->list + g->start[merge], *outer = m->outer + m->begin[merge], size = 0, left = 0;
  for (int p = 0; p < 2; p++)
    for (int k = 0; k < parts[p].size; k++) {
      const int32_t u = parts[p].list[k];
      if (m->mark[u] != MARKED || (m->held[u].held == 1 && !m->held[u].stays))
        continue;
      m->mark[u] = NONE, outer[left++] = u;
      size = append(m, s->unknowns + s->begin[u], m->held[u].unknowns, own, size);
    }
  g->outer[merge] = size, m->begin[merge + 1] = m->begin[merge] + left;
  for (int p = 0; p < 2; p++)
    for (int k = 0; k < parts[p].size; k++) {
      const int32_t u = parts[p].list[k];
      if (m->mark[u] != MARKED)
        continue;
      m->mark[u] = BEGUN;
      size = append(m, s->unknowns + s->begin[u], s->pressures[u], own, size);
    }
  for (int p = 0; p < 2; p++)
    for (int k = 0; k < parts[p].size; k++) {
      const int32_t u = parts[p].list[k], pressures = s->pressures[u];
      if (m->mark[u] != BEGUN)
        continue;
      m->mark[u] = NONE;
      size = append(m, s->unknowns + s->begin[u] + pressures, m->held[u].unknowns - pressures, own, size);
    }
  g->start[merge + 1] = g->start[merge] + size;
  g->factors[merge + 1] = g->factors[merge] + (int64_t)(size - g->outer[merge]) * size;
}

/* Two parts become one. The larger one comes first: so few parts wait for others at any time. */
static int merge(Merging *m, int32_t one, int32_t other)
{
  Groups *g = m->groups;
  if (m->weight[one] < m->weight[other]) {
    const int32_t larger = other;
    other = one, one = larger;
  }
  const int32_t merge = g->merges;
  Outer parts[2] = {outer_at(m, one), outer_at(m, other)};
  if (make_room(m, parts[0].unknowns + parts[1].unknowns, parts[0].size + parts[1].size))
    return 1;
  parts[0] = outer_at(m, one), parts[1] = outer_at(m, other); /* their lists may be elsewhere now */
  for (int k = 0; k < parts[0].size; k++)
    m->mark[parts[0].list[k]] = MARKED;
  for (int k = 0; k < parts[1].size; k++) {
    const int32_t u = parts[1].list[k];
    hand_over(m, u, other, one, m->mark[u] == MARKED);
    m->mark[u] = MARKED;
  }
  list_merged(m, parts);
  int16_t *slots = list_slots(m, m->part[one], g->slots + g->begin[merge]);
  slots = list_slots(m, m->part[other], slots);
  g->begin[merge + 1] = slots - g->slots;
  m->pairs[2 * merge] = m->part[one], m->pairs[2 * merge + 1] = m->part[other];
  m->part[one] = m->cells->cells + merge, m->part[other] = -1;
  m->weight[one] += m->weight[other];
  m->count--, g->merges++;
  return 0;
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

/* What merging works in; 1 where memory is short. */
static int begin_merging(Merging *m)
{
  const int64_t cells = m->cells->cells, unknowns = m->cells->unknowns;
  if (find_supervariables(m->cells, &m->super))
    return 1;
  const int64_t supers = m->super.count, all = m->super.start[cells], slots = unknowns > cells ? unknowns : cells;
  m->memory = malloc((9 * cells + supers + all + slots + 1) * sizeof *m->memory);
  m->held = malloc((supers + 1) * sizeof *m->held);
  m->begin = malloc((cells + 1) * sizeof *m->begin);
  if (!m->memory || !m->held || !m->begin)
    return 1;
  m->part = m->memory, m->pairs = m->part + cells, m->shared = m->pairs + 2 * cells, m->sides = m->shared + cells;
  m->touched = m->sides + cells, m->order = m->touched + cells, m->weight = m->order + cells;
  m->region = m->weight + cells, m->mark = m->region + cells, m->holders = m->mark + supers, m->slot = m->holders + all;
  memset(m->shared, 0, 2 * cells * sizeof *m->shared);
  memset(m->region, 0, cells * sizeof *m->region);
  memset(m->mark, 0, supers * sizeof *m->mark);
  m->begin[0] = 0;
  for (int cell = 0; cell < cells; cell++)
    m->part[cell] = cell, m->weight[cell] = 1;
  find_holders(m);
  return 0;
}
