/* Rows of (L x 1) P, where L acts on the three components of the velocity alike; see solvers/components.py. */

#define COMPONENTS 3

/* Entries that three rows for each of these nodes have at most. */
int64_t room_of_rows(const Alike *a, int rows, const int32_t *row)
{
  int64_t most = 0;
  for (int r = 0; r < rows; r++)
    for (int32_t p = a->indptr[row[r]]; p < a->indptr[row[r] + 1]; p++)
      most += a->on_body[a->column[p]] < 0 ? 1 : a->width;
  return COMPONENTS * most;
}

/* Unknowns ascending, by insertion, as they nearly are; those that come twice, through images, added up. */
static int in_order(int count, int32_t *number, double *sum)
{
  int end = 0;
  for (int k = 0; k < count; k++) {
    const int32_t z = number[k];
    const double v = sum[k];
    int q = end;
    while (q > 0 && number[q - 1] > z)
      q--;
    if (q > 0 && number[q - 1] == z) {
      sum[q - 1] += v;
      continue;
    }
    memmove(number + q + 1, number + q, (end - q) * sizeof *number);
    memmove(sum + q + 1, sum + q, (end - q) * sizeof *sum);
    number[q] = z;
    sum[q] = v;
    end++;
  }
  return end;
}

/* What a row of L gives to the modes of bodies, by one component; returns how many there are. */
static int of_modes(const Alike *a, int32_t i, int component, int32_t *number, double *sum)
{
  int count = 0;
  for (int32_t p = a->indptr[i]; p < a->indptr[i + 1]; p++) {
    const int32_t body = a->on_body[a->column[p]];
    if (body < 0)
      continue;
    const int64_t first = ((int64_t)body * COMPONENTS + component) * a->width;
    for (int k = 0; k < a->width; k++) {
      const int32_t z = a->modes[first + k];
      int q = 0;
      while (q < count && number[q] != z)
        q++;
      if (q == count) {
        number[count] = z;
        sum[count++] = 0.0;
      }
      sum[q] += a->value[p] * a->weights[first + k];
    }
  }
  return in_order(count, number, sum);
}

/* Three rows for each of these nodes, unknowns ascending; number, sum: each has room for width times the entries of any
   row of L. Returns the number of entries. */
int64_t rows_of_nodes(const Alike *a, int rows, const int32_t *row, int32_t *number, double *sum, int32_t *indptr,
                      int32_t *columns, double *values)
{
  int64_t end = 0;
  indptr[0] = 0;
  for (int r = 0; r < rows; r++) {
    const int32_t i = row[r];
    int count = 0, meets_bodies = 0;
    for (int32_t p = a->indptr[i]; p < a->indptr[i + 1]; p++) {
      const int32_t z = a->unknown[a->column[p]];
      if (z >= 0) {
        number[count] = z;
        sum[count++] = a->value[p];
      } else if (a->on_body[a->column[p]] >= 0)
        meets_bodies = 1;
    }
    count = in_order(count, number, sum);
    for (int c = 0; c < COMPONENTS; c++) {
      int32_t *modes = number + count;
      double *of_mode = sum + count;
      const int more = meets_bodies ? of_modes(a, i, c, modes, of_mode) : 0;
      int k = 0;
      for (; k < count && (more == 0 || number[k] < modes[0]); k++, end++) {
        columns[end] = number[k] + c;
        values[end] = sum[k];
      }
      for (int q = 0; q < more; q++, end++) {
        columns[end] = modes[q];
        values[end] = of_mode[q];
      }
      for (; k < count; k++, end++) {
        columns[end] = number[k] + c;
        values[end] = sum[k];
      }
      indptr[COMPONENTS * r + c + 1] = end;
    }
  }
  return end;
}
