typedef struct {
  int levels, fewest; /* of pairs: how many at most, and of how many parts at least */
  int most;           /* the most parts of a region, within which they are merged after that, and then all */
  int widest;         /* the most unknowns that what is merged after pairs may leave */
} Wanted;

int merge_cells(const CellLists *, const Wanted *, Groups *);
void list_groups(const CellLists *, const Groups *, int32_t *start, int32_t *list, int8_t *left);
