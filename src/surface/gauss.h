/* gauss - Gauss-Legendre rules for waves. */
#ifndef HIFDM_GAUSS_H
#define HIFDM_GAUSS_H

/* Returns the smallest order, at most `most`, whose error for exp(j phase x), -1 <= x <= 1, is below exp(error_ln). The
 * error bound is phase^(2n) 2^(2n+1) n!^4 / ((2n+1) (2n)!^3). */
int hf_gauss_order(double phase, double error_ln, int most);

/* Computes the rule of order n on [0, 1]: at [n], weight [n]. */
void hf_gauss_rule(int n, double *at, double *weight);

#endif
