int gather_nodes(int nodes, const int32_t *indptr, const int32_t *neighbour, int32_t *aggregate);
