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

void free_groups(Groups *);
