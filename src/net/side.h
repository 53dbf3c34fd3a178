/* side - two nodes that are joined, by a cable or a side of a facet. Sorted, they show what joins the same nodes. */
#pragma once

typedef struct {
    int from, to, of; /* two nodes and the index of what joins them */
} hf_side;

/* Returns the side with its lower node first. */
static inline hf_side hf_side_of(int i, int j, int of)
{
    return (hf_side){i < j ? i : j, i < j ? j : i, of};
}

/* Compare sides for qsort and bsearch: by their nodes, and by their nodes and then by what joins them. */
int hf_side_compare_nodes(const void *a, const void *b);
int hf_side_compare(const void *a, const void *b);
