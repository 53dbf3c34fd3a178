/* gauss - Gauss-Legendre's rules for waves. */
#ifndef HIFDM_GAUSS_H
#define HIFDM_GAUSS_H

/* Smallest order, at most `most`, of which the error for exp(j phase x), -1 <= x <= 1, is below exp(error_ln):
 * phase^(2n) 2^(2n+1) n!^4 / ((2n+1) (2n)!^3). */
int hf_gauss_order(double phase, double error_ln, int most);

/* The rule of order n on [0, 1]: at [n], weight [n]. */
void hf_gauss_rule(int n, double *at, double *weight);

#endif
