typedef struct {
  int cells, unknowns, rows;   /* the last: of the matrix of a cell */
  const int32_t *start, *list; /* the unknowns of each cell */
  const int8_t *stays;         /* those that are not eliminated */
  const int8_t *pressure;      /* those that are pressures */
} CellLists;

typedef struct {
  int levels, fewest; /* of pairs: how many at most, and of how many parts at least */
  int widest;         /* the most unknowns that what is merged after that may leave */
} Wanted;

typedef struct {
  int merges, groups; /* what a group is merged from, two by two; the groups that are left */
  int32_t *start;     /* where the unknowns of each merge begin in their list, outer ones first */
  int32_t *list;
  int32_t *outer;     /* how many these are */
  int32_t *begin;     /* where the slots of each begin */
  int16_t *slots;     /* which of its unknowns each outer one of its two parts is */
  int64_t *factors;   /* where its rows of L and D begin */
  int32_t *ends;      /* where the steps of each group end */
  int32_t *steps;     /* a cell, or -1 - merge: of the two parts that were made last */
} Groups;

int merge_cells(const CellLists *, const Wanted *, Groups *);
void list_groups(const CellLists *, const Groups *, int32_t *start, int32_t *list, int8_t *left);
void free_groups(Groups *);
