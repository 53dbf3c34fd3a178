/* dissection - sparse symmetric quasi-definite matrices of 6 x 6 blocks by nested dissection: factor L D L' without
 * exchange of blocks, and solve. A matrix [X M; M' -G] with positive semidefinite X and G has such a factor in any
 * order of its blocks if M restricted to the first blocks is nonsingular there (Vanderbei, SIAM J. Optim. 5, 1995). D
 * has the pivot blocks.
 *
 * The blocks are the vertices of a graph and have positions. The longest extent of a set of vertices is cut at its
 * median. The vertices of one half that are adjacent to the other half are the separator, which is eliminated after
 * both halves (George, SIAM J. Numer. Anal. 10, 1973). Each separator and each small part is a front: a dense matrix of
 * its columns and of what they change (Duff, Reid, ACM Trans. Math. Softw. 9, 1983). */
#pragma once

#include <hifdm/status.h>

#define HF_BLOCK 6

/* Columns that are eliminated together, and the rows that they reach. A place is an index in the order of
 * elimination. */
typedef struct {
    int first, n_pivot; /* places of its own blocks */
    int n_row, *row;    /* [n_row] places: its own blocks, then the later ones */
    int part[2];        /* fronts of the halves, or -1 */
    size_t ld;          /* 6 n_row with padding */
    double *entry;      /* [6 n_pivot][ld] the columns, then those of L */
    void *block;
} hf_dissection_front;

typedef struct {
    int n, n_front;
    int *place;                 /* [n] of each vertex */
    int *front_of;              /* [n] front of each place */
    hf_dissection_front *front; /* [n_front], halves before their separator */
    size_t n_entry;
    double *entry, *inverse; /* [n][6][6] inverses of the pivot blocks */
    double *stack, *scratch;
    int *at; /* [n] scratch: index of a place in the rows of a front */
    void *block, *order_block;
} hf_dissection;

/* Orders a matrix of n blocks at position [n][3] for the nonzero blocks end [n_edge][2], and allocates it with all
 * entries 0. Returns HF_OK or HF_NO_MEMORY; call hf_dissection_free in either case. */
hf_status hf_dissection_create(int n, const double *position, int n_edge, const int *end, hf_dissection *matrix);
void hf_dissection_free(hf_dissection *matrix);

/* Sets all entries to 0. */
void hf_dissection_clear(hf_dissection *matrix);

/* Adds a block to block (i,j) of the matrix and, if i and j differ, its transpose to block (j,i). */
void hf_dissection_add(hf_dissection *matrix, int i, int j, double block[HF_BLOCK][HF_BLOCK]);

/* Replaces the matrix by its factor. Returns HF_OK, or HF_SINGULAR if a pivot block is singular. */
hf_status hf_dissection_factor(hf_dissection *matrix);

/* Replaces x [n][6] by the solution. */
void hf_dissection_solve(const hf_dissection *factor, double *x);
