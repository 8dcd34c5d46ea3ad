/* The unknowns that cells, or groups of them, meet, and the pattern of their sum; see solvers/assembly.py. */

/* The unknowns that each cell meets, one after the other in `list`, and where each entry of its rows of P finds its
   own among them. Plain cells meet each by one row of P that is a unit row. */
int32_t list_unknowns(int cells, int n, int outer, int w, const int32_t *rows, const int32_t *columns,
                      const double *weights, int32_t *start, int32_t *list, int16_t *slots, int8_t *plain)
{
  int32_t end = 0;
  int32_t most = 0;
  for (int cell = 0; cell < cells; cell++) {
    int32_t *own = list + end;
    int m = 0;
    start[cell] = end;
    plain[cell] = 1;
    for (int i = 0; i < outer; i++)
      for (int k = 0; k < w; k++) {
        const int64_t entry = (int64_t)rows[(int64_t)cell * n + i] * w + k;
        const int32_t column = columns[entry];
        int slot = -1;
        if (column >= 0) {
          for (slot = 0; slot < m && own[slot] != column; slot++)
            ;
          if (slot == m)
            own[m++] = column;
        }
        slots[((int64_t)cell * outer + i) * w + k] = slot;
        if (k == 0 ? slot != i || weights[entry] != 1.0 : slot >= 0)
          plain[cell] = 0;
      }
    end += m;
    most = m > most ? m : most;
  }
  start[cells] = end;
  return most;
}

/* Where each of the unknowns is met: the places in `list`, and the cells. */
void list_meetings(int cells, int unknowns, const int32_t *start, const int32_t *list, int32_t *first, int32_t *place,
                   int32_t *cell_of)
{
  memset(first, 0, (unknowns + 1) * sizeof *first);
  for (int32_t k = 0; k < start[cells]; k++)
    first[list[k] + 1]++;
  for (int j = 0; j < unknowns; j++)
    first[j + 1] += first[j];
  for (int cell = 0; cell < cells; cell++)
    for (int32_t k = start[cell]; k < start[cell + 1]; k++) {
      place[first[list[k]]] = k;
      cell_of[first[list[k]]++] = cell;
    }
  for (int j = unknowns; j > 0; j--)
    first[j] = first[j - 1];
  first[0] = 0;
}

/* Pressures meet each other where inner unknowns have been eliminated, and otherwise only themselves. */
static int meet(const Meetings *m, int32_t i, int32_t j)
{
  return i == j || m->coupled || !m->pressure[i] || !m->pressure[j];
}

/* Whether an unknown meets what the one before it does: so do the components of a node, and the nodes of a side. */
static int alike(const Meetings *m, int32_t i)
{
  if (i == 0 || m->pressure[i] != m->pressure[i - 1] || (m->pressure[i] && !m->coupled))
    return 0;
  const int32_t *cells = m->cell + m->first[i], *before = m->cell + m->first[i - 1];
  const int32_t count = m->first[i + 1] - m->first[i];
  return cells - before == count && memcmp(cells, before, count * sizeof *cells) == 0;
}

/* The columns of each row of the sum in any order, one row after the other; mark: (unknowns,), any values. What no
   cell meets, the motion of a body in another rank's fluid, has its own column alone. */
void gather_entries(const Meetings *m, int32_t *mark, int32_t *indptr, int32_t *columns)
{
  memset(mark, -1, m->unknowns * sizeof *mark);
  indptr[0] = 0;
  for (int32_t i = 0; i < m->unknowns; i++) {
    int32_t end = indptr[i];
    if (m->first[i] == m->first[i + 1])
      columns[end++] = i;
    else if (alike(m, i)) {
      memcpy(columns + end, columns + indptr[i - 1], (end - indptr[i - 1]) * sizeof *columns);
      indptr[i + 1] = 2 * end - indptr[i - 1];
      continue;
    }
    for (int32_t q = m->first[i]; q < m->first[i + 1]; q++)
      for (int32_t k = m->start[m->cell[q]]; k < m->start[m->cell[q] + 1]; k++) {
        const int32_t j = m->list[k];
        if (mark[j] != i && meet(m, i, j)) {
          mark[j] = i;
          columns[end++] = j;
        }
      }
    indptr[i + 1] = end;
  }
}

/* The same ascending, since the pattern is symmetric: row i is entered in those that it meets. */
void sort_entries(int unknowns, const int32_t *indptr, const int32_t *columns, int32_t *next, int32_t *indices)
{
  memcpy(next, indptr, unknowns * sizeof *next);
  for (int32_t i = 0; i < unknowns; i++)
    for (int32_t p = indptr[i]; p < indptr[i + 1]; p++)
      indices[next[columns[p]]++] = i;
}

/* Where the entries of each cell's matrix go, -1: nowhere; those of the cell begin at offset[cell]. */
void find_positions(const Meetings *m, const int32_t *indptr, const int32_t *indices, const int64_t *offset,
                    int32_t *where, int32_t *positions)
{
  for (int32_t i = 0; i < m->unknowns; i++) {
    const int32_t begin = indptr[i];
    if (!alike(m, i))
      for (int32_t p = begin; p < indptr[i + 1]; p++)
        where[indices[p]] = p - begin;
    for (int32_t q = m->first[i]; q < m->first[i + 1]; q++) {
      const int32_t cell = m->cell[q], size = m->start[cell + 1] - m->start[cell];
      const int32_t *list = m->list + m->start[cell];
      int32_t *row = positions + offset[cell] + (int64_t)(m->place[q] - m->start[cell]) * size;
      for (int32_t k = 0; k < size; k++)
        row[k] = meet(m, i, list[k]) ? begin + where[list[k]] : -1;
    }
  }
}
