typedef struct {
  int width;                        /* modes that move a row of a node on a body */
  const int32_t *indptr, *column;   /* of L: rows of this rank's nodes, columns numbers of those that they meet */
  const double *value;              /* of L */
  const int32_t *unknown;           /* of each node that is met the first of its three unknowns; -1: it has none */
  const int32_t *on_body;           /* its number among those on bodies; -1: on none */
  const int32_t *modes;             /* unknowns that move each of these, (nodes on bodies, 3, width) */
  const double *weights;            /* their velocities there */
} Alike;

int64_t room_of_rows(const Alike *, int rows, const int32_t *row);
int64_t rows_of_nodes(const Alike *, int rows, const int32_t *row, int32_t *number, double *sum, int32_t *indptr,
                      int32_t *columns, double *values);
