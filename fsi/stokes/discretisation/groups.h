int64_t room_of_groups(const CellLists *, const Groups *);
void reduce_groups(const Groups *, const double *factors, double *b);
void recover_groups(const Groups *, const double *factors, const double *b, double *x);
void add_cells(const Cells *, const Sum *, const Groups *, double *room, double *values, double *kept,
               double *matrices, double *factors, double *of_groups);
