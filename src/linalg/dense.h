/* dense - square matrices without structure, by columns: product, LU with partial pivoting. In a fixed order of
 * operations, so that the bits are the same on every machine; meant for some hundred rows. */
#ifndef HIFDM_DENSE_H
#define HIFDM_DENSE_H

/* c = a b, all [n][n] by columns; c is neither a nor b. */
void hf_dense_multiply(int n, const double *a, const double *b, double *c);

/* a [n][n] = P L U in place. pivot [n]: row that row k was swapped with in step k. 0, or 1 + the column without a
 * pivot. */
int hf_dense_factor(int n, double *a, int *pivot);

/* b [n_rhs][n] replaced by the solutions. */
void hf_dense_solve(int n, const double *factor, const int *pivot, int n_rhs, double *b);

#endif
