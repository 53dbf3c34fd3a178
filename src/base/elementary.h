/* elementary - constants, lengths, products of vectors, and functions whose last digit in the C library depends on the
 * processor and on the version of the library. Here they are sums, products, quotients and roots of doubles in a fixed
 * order: the same bits everywhere. */
#ifndef HIFDM_ELEMENTARY_H
#define HIFDM_ELEMENTARY_H

#define HF_PI 3.14159265358979323846
#define HF_RAD_PER_DEG (HF_PI / 180)
#define HF_LN_2 0.69314718055994530942
#define HF_DB_PER_LN 4.3429448190325182765 /* 10/ln 10 */
#define HF_LIGHT_M_PER_S 299792458.0

/* Of two doubles, for qsort: ascending. */
int hf_compare_doubles(const void *a, const void *b);

/* sqrt(x^2 + y^2 + z^2) without overflow or underflow; error below 2 units in the last place. Infinite when one is,
 * else NaN when one is. */
double hf_norm(double x, double y, double z);

/* Distance of two points [3]. */
double hf_distance(const double *a, const double *b);

/* c = a x b of vectors [3]; c is another array. */
void hf_cross(const double *a, const double *b, double *c);

/* a . b of vectors of three. */
double hf_dot3(const double a[3], const double b[3]);

/* Error below 3e-16 up to 1e8 rad; beyond, of an angle that differs by less than 1e-16 of it. */
double hf_sine(double angle_rad);
double hf_cosine(double angle_rad);

/* Inverse of the hyperbolic sine; relative error below 1e-15. */
double hf_inverse_sinh(double x);

/* Natural logarithm of a normal number x > 0; error below 3e-16 of the result, or 1e-16 where that is larger. */
double hf_logarithm(double x);

/* The number below which a normally distributed one of mean 0 and deviation 1 is with this probability, above 0 and
 * below 1; relative error below 2e-15 (Wichura, algorithm AS 241, Appl. Stat. 37, 1988). */
double hf_normal_quantile(double probability);

/* 2^x for |x| < 1000; relative error below 4e-16. */
double hf_power_of_two(double x);

#endif
