typedef struct {
  int parts;
  const int32_t *first, *beside; /* those beside part p are beside[first[p] ... first[p + 1] - 1], and p beside them */
  const int32_t *sides;          /* how many unknowns each of these pairs has in common, and no other part */
} Graph;

int dissect(const Graph *, int most, int32_t *region);
