/* Contents: comparisons - lengths - sine and cosine - inverse hyperbolic sine - logarithm - normal distribution - power
 * of two */
#include "base/elementary.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- comparisons ---- */

int hf_compare_doubles(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

double hf_max_magnitude(size_t n, const double *value)
{
    double largest = 0;
    for (size_t i = 0; i < n; i++)
        largest = fmax(largest, fabs(value[i]));
    return largest;
}

int hf_list_largest(int i, const double *value, int n_max, int n, int *list)
{
    int at = n;
    for (; at > 0 && value[list[at - 1]] < value[i]; at--)
        if (at < n_max) list[at] = list[at - 1];
    if (at < n_max) list[at] = i;
    return n < n_max ? n + 1 : n;
}

/* ---- lengths ---- */

int hf_compare_down(const void *a, const void *b)
{
    const hf_ranked *x = a, *y = b;
    int by_value = hf_compare_doubles(&y->value, &x->value);
    return by_value ? by_value : x->index - y->index;
}

double hf_tail_mean(int n, const double *value, double tail, hf_ranked *ranked, double *weight)
{
    double sum = 0, left = tail;
    for (int i = 0; i < n; i++)
        ranked[i] = (hf_ranked){value[i], i};
    qsort(ranked, (size_t)n, sizeof *ranked, hf_compare_down);
    memset(weight, 0, (size_t)n * sizeof *weight);
    for (int rank = 0; rank < n && left > 0; rank++) {
        double part = fmin(1, left) / tail;
        weight[ranked[rank].index] = part;
        sum += part * ranked[rank].value;
        left -= 1;
    }
    return sum;
}

double hf_norm(double x, double y, double z)
{
    double square = x * x + y * y + z * z;
    if (square > 0x1p-960 && square < 0x1p960) return sqrt(square);
    double largest = fmax(fmax(fabs(x), fabs(y)), fabs(z));
    if (!(largest > 0) || isinf(largest) || isnan(square)) return isinf(largest) ? largest : fabs(square);
    int exponent;
    frexp(largest, &exponent);
    x = ldexp(x, -exponent), y = ldexp(y, -exponent), z = ldexp(z, -exponent);
    return ldexp(sqrt(x * x + y * y + z * z), exponent);
}

double hf_norm_rate(const double *v, const double *rate)
{
    double size = hf_norm(v[0], v[1], v[2]);
    return size > 0 ? (v[0] * rate[0] + v[1] * rate[1] + v[2] * rate[2]) / size : 0;
}

double hf_distance(const double *a, const double *b)
{
    return hf_norm(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

double hf_dot3(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

void hf_cross(const double *a, const double *b, double *c)
{
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

/* ---- sine and cosine ---- */

/* pi/2 in three parts (Cody and Waite). The first part has 27 bits, so its product with a count of up to 2^26 is exact;
 * ANGLE_MAX needs less. The second part has 30 bits; its products are exact up to a count of 2^23. Beyond that they
 * have a rounding error below 1e-17. */
#define HALF_PI_1 0x1.921fb54p+0
#define HALF_PI_2 0x1.10b46118p-30
#define HALF_PI_3 0x1.313198a2e0370p-61
#define ANGLE_MAX 1e8
#define TERMS 9 /* the first omitted term is below 1e-18 at pi/4 */

/* Returns first (1 - s/((n+1)(n+2)) (1 - s/((n+3)(n+4)) (...))) with s = r^2. This is the series of the sine for n = 1,
 * first = r, and the series of the cosine for n = 0, first = 1. */
static double alternating_series(double r, int n, double first)
{
    double sum = 1, square = r * r;
    for (int k = TERMS; k > 0; k--) {
        double a = n + 2 * k - 1;
        sum = 1 - square / (a * (a + 1)) * sum;
    }
    return first * sum;
}

/* Returns the sine of angle_rad + quarters pi/2. */
static double shifted_sine(double angle_rad, int quarters)
{
    if (!isfinite(angle_rad)) return (double)NAN;
    if (fabs(angle_rad) > ANGLE_MAX) angle_rad = remainder(angle_rad, 4 * (HALF_PI_1 + HALF_PI_2)); /* exact */
    double count = nearbyint(angle_rad / HALF_PI_1);
    double r = ((angle_rad - count * HALF_PI_1) - count * HALF_PI_2) - count * HALF_PI_3;
    int quadrant = (int)(count - 4 * floor(count / 4)) + quarters;
    double value = quadrant % 2 ? alternating_series(r, 0, 1) : alternating_series(r, 1, r);
    return quadrant & 2 ? -value : value;
}

double hf_sine(double angle_rad)
{
    return shifted_sine(angle_rad, 0);
}

double hf_cosine(double angle_rad)
{
    return shifted_sine(angle_rad, 1);
}

/* ---- inverse hyperbolic sine ---- */

/* Halves the result until x is small: asinh x = 2 asinh(x / sqrt(2 (1 + sqrt(1 + x^2)))). Then asinh x = artanh u = u +
 * u^3/3 + u^5/5 + ... with u = x / sqrt(1 + x^2). */
double hf_inverse_sinh(double x)
{
    double scale = 1;
    if (!isfinite(x)) return x;
    while (fabs(x) > 0.25) {
        x = fabs(x) < 1e100 ? x / sqrt(2 * (1 + sqrt(1 + x * x))) : copysign(sqrt(fabs(x) / 2), x);
        scale *= 2;
    }
    double u = x / sqrt(1 + x * x), square = u * u, sum = 0;
    for (int n = 25; n > 0; n -= 2)
        sum = sum * square + 1.0 / n;
    return scale * u * sum;
}

/* ---- logarithm ---- */

/* With x = 2^k m and m around 1, ln x = k ln 2 + ln m. ln m = 2 artanh u with u = (m - 1)/(m + 1), |u|
 * at most 0.172. */
double hf_logarithm(double x)
{
    static const double inverse[] = {1.0 / 21, 1.0 / 19, 1.0 / 17, 1.0 / 15, 1.0 / 13, 1.0 / 11,
                                     1.0 / 9,  1.0 / 7,  1.0 / 5,  1.0 / 3,  1.0};
    int k;
    double m = frexp(x, &k);
    if (m < 0.70710678118654752) m *= 2, k--;
    double u = (m - 1) / (m + 1), square = u * u, sum = 0;
    for (size_t i = 0; i < sizeof inverse / sizeof *inverse; i++)
        sum = sum * square + inverse[i];
    return k * 0x1.62e42fefa3800p-1 +
           (2 * u * sum + k * 0x1.ef35793c76730p-45); /* ln 2 in two parts; k times the first part is exact */
}

/* ---- normal distribution ---- */

static double polynomial(const double c[8], double x)
{
    double sum = 0;
    for (int i = 0; i < 8; i++)
        sum = sum * x + c[i];
    return sum;
}

/* Each region (middle, tails, far tails) has a quotient of two polynomials: numerator, denominator,
 * highest power first. */
double hf_normal_quantile(double probability)
{
    static const double middle[2][8] = {
        {2509.0809287301226727, 33430.575583588128105, 67265.770927008700853, 45921.953931549871457,
         13731.693765509461125, 1971.5909503065514427, 133.14166789178437745, 3.387132872796366608},
        {5226.495278852545925, 28729.085735721942674, 39307.89580009271061, 21213.794301586595867,
         5394.1960214247511077, 687.1870074920579083, 42.313330701600911252, 1}};
    static const double tail[2][8] = {
        {7.7454501427834140764e-4, .0227238449892691845833, .24178072517745061177, 1.27045825245236838258,
         3.64784832476320460504, 5.7694972214606914055, 4.6303378461565452959, 1.42343711074968357734},
        {1.05075007164441684324e-9, 5.475938084995344946e-4, .0151986665636164571966, .14810397642748007459,
         .68976733498510000455, 1.6763848301838038494, 2.05319162663775882187, 1}};
    static const double far_tail[2][8] = {
        {2.01033439929228813265e-7, 2.71155556874348757815e-5, .0012426609473880784386, .026532189526576123093,
         .29656057182850489123, 1.7848265399172913358, 5.4637849111641143699, 6.6579046435011037772},
        {2.04426310338993978564e-15, 1.4215117583164458887e-7, 1.8463183175100546818e-5, 7.868691311456132591e-4,
         .0148753612908506148525, .13692988092273580531, .59983220655588793769, 1}};
    double q = probability - 0.5;
    if (fabs(q) <= 0.425) {
        double r = 0.180625 - q * q;
        return q * polynomial(middle[0], r) / polynomial(middle[1], r);
    }
    double r = sqrt(-hf_logarithm(q < 0 ? probability : 1 - probability));
    const double(*c)[8] = r <= 5 ? tail : far_tail;
    r -= r <= 5 ? 1.6 : 5;
    return copysign(polynomial(c[0], r) / polynomial(c[1], r), q);
}

/* ---- power of two ---- */

double hf_power_of_two(double x)
{
    static const double inverse[] = {1,       1.0 / 2, 1.0 / 3,  1.0 / 4,  1.0 / 5,  1.0 / 6, 1.0 / 7,
                                     1.0 / 8, 1.0 / 9, 1.0 / 10, 1.0 / 11, 1.0 / 12, 1.0 / 13};
    double whole = nearbyint(x), t = (x - whole) * HF_LN_2, sum = 1;
    for (int k = 12; k >= 0; k--)
        sum = 1 + t * inverse[k] * sum;
    return ldexp(sum, (int)whole);
}
