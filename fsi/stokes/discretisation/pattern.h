typedef struct {
  int unknowns;
  const int32_t *start, *list;         /* the unknowns of each cell */
  const int32_t *first, *place, *cell; /* where each unknown stands in that list, and in which cells */
  const int8_t *pressure;              /* which unknowns are pressures */
  int coupled;                         /* whether pressures of a cell meet each other */
} Meetings;

int32_t list_unknowns(int cells, int n, int outer, int w, const int32_t *rows, const int32_t *columns,
                      const double *weights, int32_t *start, int32_t *list, int16_t *slots, int8_t *plain);
void list_meetings(int cells, int unknowns, const int32_t *start, const int32_t *list, int32_t *first,
                   int32_t *place, int32_t *cell_of);
void gather_entries(const Meetings *, int32_t *mark, int32_t *indptr, int32_t *columns);
void sort_entries(int unknowns, const int32_t *indptr, const int32_t *columns, int32_t *next, int32_t *indices);
void find_positions(const Meetings *, const int32_t *indptr, const int32_t *indices, const int64_t *offset,
                    int32_t *where, int32_t *positions);
