/* Contents: lengths - sine and cosine - inverse hyperbolic sine - power of two */
#include "base/elementary.h"

#include <math.h>

/* ---- lengths ---- */

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

double hf_distance(const double *a, const double *b)
{
    return hf_norm(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

void hf_cross(const double *a, const double *b, double *c)
{
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

/* ---- sine and cosine ---- */

/* pi/2 in three parts; the first two have 29 and 28 bits, so that multiples of up to 2^24 of them are exact, and up to
 * ANGLE_MOST all but. */
#define HALF_PI_1 0x1.921fb54p+0
#define HALF_PI_2 0x1.10b46118p-30
#define HALF_PI_3 0x1.313198a2e0370p-61
#define ANGLE_MOST 1e8
#define TERMS 9 /* the first one left out is below 1e-18 at pi/4 */

/* first (1 - s/((n+1)(n+2)) (1 - s/((n+3)(n+4)) (...))) with s = r^2: the series of the sine for n = 1, first = r, that
 * of the cosine for n = 0, first = 1 */
static double alternating_series(double r, int n, double first)
{
    double sum = 1, square = r * r;
    for (int k = TERMS; k > 0; k--) {
        double a = n + 2 * k - 1;
        sum = 1 - square / (a * (a + 1)) * sum;
    }
    return first * sum;
}

/* Of an angle that is larger by so many quarters of a turn. */
static double turned_sine(double angle_rad, int quarters)
{
    if (!isfinite(angle_rad)) return (double)NAN;
    if (fabs(angle_rad) > ANGLE_MOST) angle_rad = remainder(angle_rad, 4 * (HALF_PI_1 + HALF_PI_2)); /* exact */
    double count = nearbyint(angle_rad / HALF_PI_1);
    double r = ((angle_rad - count * HALF_PI_1) - count * HALF_PI_2) - count * HALF_PI_3;
    int quadrant = (int)(count - 4 * floor(count / 4)) + quarters;
    double value = quadrant % 2 ? alternating_series(r, 0, 1) : alternating_series(r, 1, r);
    return quadrant & 2 ? -value : value;
}

double hf_sine(double angle_rad)
{
    return turned_sine(angle_rad, 0);
}

double hf_cosine(double angle_rad)
{
    return turned_sine(angle_rad, 1);
}

/* ---- inverse hyperbolic sine ---- */

/* asinh x = 2 asinh(x / sqrt(2 (1 + sqrt(1 + x^2)))) until x is small; then artanh u = u + u^3/3 + u^5/5 ... with
 * u = x / sqrt(1 + x^2). */
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

/* ---- power of two ---- */

double hf_power_of_two(double x)
{
    static const double inverse[] = {1,       1.0 / 2, 1.0 / 3,  1.0 / 4,  1.0 / 5,  1.0 / 6, 1.0 / 7,
                                     1.0 / 8, 1.0 / 9, 1.0 / 10, 1.0 / 11, 1.0 / 12, 1.0 / 13};
    double whole = nearbyint(x), t = (x - whole) * 0.6931471805599453094, sum = 1;
    for (int k = 12; k >= 0; k--)
        sum = 1 + t * inverse[k] * sum;
    return ldexp(sum, (int)whole);
}
