/* Parts of a mesh in regions that have few unknowns in common; see groups.py. */
#include <stdlib.h>

typedef struct {
  const Graph *graph;
  int32_t *region;  /* of each part */
  int32_t *room;    /* how much more may flow from a part to each one beside it */
  int32_t *back;    /* where that one has the part beside it */
  int32_t *level;   /* how far a part is from where the flow begins, of those that it reaches; else -1 */
  int32_t *next;    /* which of those beside a part is tried next */
  int32_t *order;   /* parts of a region, from one of its ends to the other */
  int8_t *drains;   /* those where what flows ends */
} Dissection;

static int32_t lesser(int32_t a, int32_t b)
{
  return a < b ? a : b;
}

/* What can be reached from the first so many parts of the order, within their region: they and what comes after them;
   how many. Of these parts the first `inner` have none beside them but others of these. What flows goes no further than
   where it ends. */
static int32_t reach(const Dissection *d, int32_t inner, int32_t given, int flows)
{
  const Graph *p = d->graph;
  int32_t count = given;
  memset(d->level, -1, p->parts * sizeof *d->level);
  for (int32_t k = 0; k < given; k++)
    d->level[d->order[k]] = 0;
  for (int32_t k = inner; k < count; k++) {
    const int32_t at = d->order[k];
    if (flows && d->drains[at])
      continue;
    for (int32_t q = p->first[at]; q < p->first[at + 1]; q++) {
      const int32_t to = p->beside[q];
      if (d->level[to] >= 0 || d->region[to] != d->region[at] || (flows && d->room[q] == 0))
        continue;
      d->level[to] = d->level[at] + 1;
      d->order[count++] = to;
    }
  }
  return count;
}

/* What more flows from a part towards where the flow ends, at most so much. */
static int32_t push(const Dissection *d, int32_t at, int32_t most)
{
  const Graph *p = d->graph;
  if (d->drains[at])
    return most;
  for (; d->next[at] < p->first[at + 1]; d->next[at]++) {
    const int32_t q = d->next[at], to = p->beside[q];
    if (d->room[q] == 0 || d->region[to] != d->region[at] || d->level[to] != d->level[at] + 1)
      continue;
    const int32_t sent = push(d, to, lesser(most, d->room[q]));
    if (sent > 0) {
      d->room[q] -= sent, d->room[d->back[q]] += sent;
      return sent;
    }
  }
  return 0;
}

/* The greatest flow between the ends of a region, which has been listed from one to the other: from the first so many
   parts to the last so many, by one path after the other among the shortest (Dinic). What it reaches then lies on one
   side of the least cut; how many. */
static int32_t flow(const Dissection *d, int32_t size, int32_t ends)
{
  const Graph *p = d->graph;
  int32_t inner = ends;
  while (inner > 0 && d->level[d->order[inner - 1]] >= d->level[d->order[ends - 1]] - 1)
    inner--;
  memset(d->drains, 0, p->parts);
  for (int32_t k = 0; k < ends; k++)
    d->drains[d->order[size - 1 - k]] = 1;
  memcpy(d->room, p->sides, p->first[p->parts] * sizeof *d->room);
  for (;;) {
    const int32_t reached = reach(d, inner, ends, 1);
    int ended = 0;
    for (int32_t k = ends; k < reached; k++)
      ended |= d->drains[d->order[k]];
    if (!ended)
      return reached;
    memcpy(d->next, p->first, p->parts * sizeof *d->next);
    for (int32_t k = inner; k < ends; k++)
      while (push(d, d->order[k], INT32_MAX) > 0)
        ;
  }
}

/* The region of a part, as far as it can be reached from it, is one of the regions that are wanted, or falls into two
   along the least cut between its ends. */
static void divide(const Dissection *d, int32_t seed, int32_t most, int32_t *wanted, int32_t *large)
{
  enum { ENDS = 5 }; /* one of so many parts of a region is at either end */
  d->order[0] = seed;
  for (int turn = 0; turn < 2; turn++)
    d->order[0] = d->order[reach(d, 0, 1, 0) - 1];
  const int32_t size = reach(d, 0, 1, 0);
  if (size <= most) {
    for (int32_t k = 0; k < size; k++)
      d->region[d->order[k]] = *wanted;
    ++*wanted;
    return;
  }
  const int32_t one = flow(d, size, size / ENDS + 1);
  --*large;
  for (int32_t k = 0; k < one; k++)
    d->region[d->order[k]] = *large;
}

/* The number of the region of each part, of which a region has no more than so many. 0, or 1 where memory is short. */
int dissect(const Graph *p, int most, int32_t *region)
{
  const int64_t parts = p->parts, pairs = p->first[p->parts];
  int32_t *memory = malloc((3 * parts + 2 * pairs) * sizeof *memory);
  int8_t *drains = malloc(parts);
  if (memory && drains) {
    Dissection d = {.graph = p, .region = region, .drains = drains};
    d.level = memory, d.next = d.level + parts, d.order = d.next + parts;
    d.room = d.order + parts, d.back = d.room + pairs;
    for (int32_t at = 0; at < parts; at++)
      for (int32_t q = p->first[at]; q < p->first[at + 1]; q++) {
        int32_t back = p->first[p->beside[q]];
        while (p->beside[back] != at)
          back++;
        d.back[q] = back;
      }
    memset(region, 0, parts * sizeof *region);
    int32_t wanted = 1, large = 0;
    for (int32_t at = 0; at < parts; at++)
      while (region[at] <= 0)
        divide(&d, at, most, &wanted, &large);
  }
  const int failed = !memory || !drains;
  free(memory), free(drains);
  return failed;
}
