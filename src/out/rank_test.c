#include "out/rank_test.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

enum { HALF = HF_RANK_TEST_EXACT / 2, SUM_MAX = HALF * (HF_RANK_TEST_EXACT + HALF + 1) };

/* Returns twice the mean rank of a value among all values, which is a whole number, and in *n_equal their number. */
static int double_rank(double value, const double *a, int n, const double *b, int m, int *n_equal)
{
    int n_below = 0;
    *n_equal = 0;
    for (int i = 0; i < n + m; i++) {
        double other = i < n ? a[i] : b[i - n];
        n_below += other < value;
        *n_equal += other == value;
    }
    return 2 * n_below + *n_equal + 1;
}

/* Returns the exact p-value of the rank sum of the smaller sample, a[n]. */
static double exact(const double *a, int n, const double *b, int m)
{
    static double count[HALF + 1][SUM_MAX + 1]; /* divisions by size and doubled rank sum; whole numbers */
    double low = 0, high = 0, all = 0;
    int found = 0, n_equal;
    memset(count, 0, sizeof count);
    count[0][0] = 1;
    for (int i = 0; i < n + m; i++) {
        int rank = double_rank(i < n ? a[i] : b[i - n], a, n, b, m, &n_equal);
        if (i < n) found += rank;
        for (int k = n; k > 0; k--)
            for (int sum = SUM_MAX; sum >= rank; sum--)
                count[k][sum] += count[k - 1][sum - rank];
    }
    for (int sum = 0; sum <= SUM_MAX; sum++) {
        all += count[n][sum];
        low += sum <= found ? count[n][sum] : 0;
        high += sum >= found ? count[n][sum] : 0;
    }
    return fmin(1, 2 * fmin(low, high) / all);
}

double hf_rank_test(const double *a, int n, const double *b, int m)
{
    double sum = 0, ties = 0, size = n + m;
    if (n > m) return hf_rank_test(b, m, a, n);
    if (n + m <= HF_RANK_TEST_EXACT) return exact(a, n, b, m);
    for (int i = 0; i < n + m; i++) {
        int n_equal, rank = double_rank(i < n ? a[i] : b[i - n], a, n, b, m, &n_equal);
        if (i < n) sum += 0.5 * rank;
        ties += (double)n_equal * n_equal - 1; /* each of t equal values adds (t^3 - t)/t */
    }
    double u = sum - 0.5 * n * (n + 1), mean = 0.5 * n * m;
    double variance = n * (double)m / 12 * (size + 1 - ties / (size * (size - 1)));
    return variance > 0 ? erfc(fmax(0, fabs(u - mean) - 0.5) / sqrt(2 * variance)) : 1;
}
