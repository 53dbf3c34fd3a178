#include "surface/gauss.h"

#include "base/elementary.h"

#include <math.h>

int hf_gauss_order(double phase, double error_ln, int most)
{
    double ln = hf_logarithm(2.0), step = 2 * hf_logarithm(fmax(phase, 1e-3));
    for (int n = 1; n < most; n++) {
        double k = 2 * n;
        ln += step + hf_logarithm(4.0 * n * n * n * n / (k * k * k * (k - 1) * (k - 1) * (k - 1)));
        if (ln - hf_logarithm(k + 1) < error_ln) return n;
    }
    return most;
}

/* Returns the Legendre polynomial of order n at x, and writes its derivative. */
static double legendre(int n, double x, double *derivative)
{
    double p = 1, before = 0;
    for (int k = 1; k <= n; k++) {
        double next = ((2 * k - 1) * x * p - (k - 1) * before) / k;
        before = p;
        p = next;
    }
    *derivative = n * (x * p - before) / (x * x - 1);
    return p;
}

void hf_gauss_rule(int n, double *at, double *weight)
{
    for (int i = 0; i < n; i++) {
        double x = hf_cosine(HF_PI * (i + 0.75) / (n + 0.5)), slope = 1, step = 1;
        for (int k = 0; k < 10 && fabs(step) > 1e-15; k++)
            x -= step = legendre(n, x, &slope) / slope;
        legendre(n, x, &slope);
        at[i] = (1 - x) / 2;
        weight[i] = 1 / ((1 - x * x) * slope * slope);
    }
}
