/* union_find - classes of numbers that are joined pair by pair. */
#ifndef HIFDM_UNION_FIND_H
#define HIFDM_UNION_FIND_H

/* Root of the class of i; i and j are in one class when their roots are equal. parent: [n], parent[i] = i at the start;
 * set parent[one root] = another root to join two classes. Every other link is skipped on the way (path halving), so
 * that later searches are shorter. */
int hf_union_find_root(int *parent, int i);

#endif
