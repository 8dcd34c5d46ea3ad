/* Nodes of a matrix gathered; see solvers/aggregation.py. */

/* The aggregate of the first neighbour of a node that is in one, -1 where none is. */
static int32_t beside(int i, const int32_t *indptr, const int32_t *neighbour, const int32_t *aggregate)
{
  for (int32_t p = indptr[i]; p < indptr[i + 1]; p++)
    if (aggregate[neighbour[p]] >= 0)
      return aggregate[neighbour[p]];
  return -1;
}

/* The number of each node's aggregate; returns how many there are. A node is put together with all its neighbours
   where these are free; what is left then joins one of those beside it, none by way of another that joins. */
int gather_nodes(int nodes, const int32_t *indptr, const int32_t *neighbour, int32_t *aggregate)
{
  enum { FREE = -1, JOINS = -2 };
  int count = 0;
  for (int i = 0; i < nodes; i++)
    aggregate[i] = FREE;
  for (int i = 0; i < nodes; i++) {
    if (aggregate[i] != FREE || beside(i, indptr, neighbour, aggregate) >= 0)
      continue;
    aggregate[i] = count;
    for (int32_t p = indptr[i]; p < indptr[i + 1]; p++)
      aggregate[neighbour[p]] = count;
    count++;
  }
  for (int i = 0; i < nodes; i++)
    if (aggregate[i] == FREE)
      aggregate[i] = JOINS - beside(i, indptr, neighbour, aggregate);
  for (int i = 0; i < nodes; i++)
    if (aggregate[i] <= JOINS)
      aggregate[i] = JOINS - aggregate[i];
  return count;
}
