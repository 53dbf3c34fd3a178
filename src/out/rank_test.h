/* rank_test - tests whether the values of one sample tend to be larger than those of another (Mann and Whitney, Annals
 * of Mathematical Statistics 18, 1947). */
#pragma once

/* Returns the two-sided p-value of the Mann-Whitney U test of a[n] and b[m], n and m from 1, without NaN. Equal values
 * share their mean rank. Up to HF_RANK_TEST_EXACT values the p-value is exact: twice the share of all divisions of the
 * values into samples of these sizes whose rank sum is at least as extreme, on the side of the one found. For more
 * values it is that of the normal approximation, with the corrections for ties and for continuity. */
#define HF_RANK_TEST_EXACT 40
double hf_rank_test(const double *a, int n, const double *b, int m);
