typedef struct {
  int cells, unknowns, rows;   /* the last: of the matrix of a cell */
  const int32_t *start, *list; /* the unknowns of each cell */
  const int8_t *stays;         /* those that are not eliminated */
  const int8_t *pressure;      /* those that are pressures */
} CellLists;

typedef struct {
  int count;
  int32_t *of;           /* that of each unknown */
  int32_t *begin;        /* where the unknowns of each begin: */
  int32_t *unknowns;     /* pressures first */
  int32_t *pressures;    /* how many of them these are */
  int32_t *start, *list; /* those of each cell */
} Supervariables;

int find_supervariables(const CellLists *, Supervariables *);
void free_supervariables(Supervariables *);
