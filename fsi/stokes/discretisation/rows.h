void count_entries(int rows, int width, const int64_t *row, const int64_t *column, int64_t first, int64_t end,
                   int32_t *inside, int32_t *outside);
void list_entries(int rows, int width, const int64_t *row, const int64_t *column, int64_t first, int64_t end,
                  int inside, const int32_t *indptr, int32_t *indices, int64_t *entries);
