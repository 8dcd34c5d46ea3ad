/* Sparse rows of entries that stand in rows of one width, where a negative column is none; see nodal_matrix.py.
   Columns first to end - 1 are apart from all others, as PETSc has those of a rank. */

/* How many entries each row has, one place behind its own, where their sums are to begin the next row. */
void count_entries(int rows, int width, const int64_t *row, const int64_t *column, int64_t first, int64_t end,
                   int32_t *inside, int32_t *outside)
{
  for (int r = 0; r < rows; r++)
    for (int k = 0; k < width; k++) {
      const int64_t c = column[(int64_t)r * width + k];
      if (c >= 0)
        (first <= c && c < end ? inside : outside)[row[r] + 1]++;
    }
}

/* The columns of one part, ascending in each row, by insertion, and which of all entries each of them is. */
void list_entries(int rows, int width, const int64_t *row, const int64_t *column, int64_t first, int64_t end,
                  int inside, const int32_t *indptr, int32_t *indices, int64_t *entries)
{
  const int64_t offset = inside ? first : 0;
  for (int r = 0; r < rows; r++) {
    const int32_t begin = indptr[row[r]];
    int32_t last = begin;
    for (int k = 0; k < width; k++) {
      const int64_t entry = (int64_t)r * width + k;
      const int64_t c = column[entry];
      if (c < 0 || (first <= c && c < end) != inside)
        continue;
      int32_t q = last++;
      for (; q > begin && indices[q - 1] > c - offset; q--) {
        indices[q] = indices[q - 1];
        entries[q] = entries[q - 1];
      }
      indices[q] = c - offset;
      entries[q] = entry;
    }
  }
}
