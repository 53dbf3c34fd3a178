/* elementary - constants, lengths, products of vectors, and elementary functions that give the same bits everywhere.
 *
 * The last digit of such a function in the C library depends on the processor and on the version of the library. The
 * functions here consist of sums, products, quotients and roots of doubles in a fixed order. */
#pragma once

#include <stddef.h>

#define HF_PI 3.14159265358979323846
#define HF_RAD_PER_DEG (HF_PI / 180)
#define HF_LN_2 0.69314718055994530942
#define HF_DB_PER_LN 4.3429448190325182765 /* 10/ln 10 */
#define HF_LIGHT_M_PER_S 299792458.0

/* Compares two doubles for qsort(3), ascending. */
int hf_compare_doubles(const void *a, const void *b);

/* Returns the maximum absolute value of n numbers; NaN does not count. Returns 0 without numbers. */
double hf_max_magnitude(size_t n, const double *value);

/* Inserts item i into a list of the items with the largest values, in descending order. n is the number of items in the
 * list, at most n_max. An item with the same value as others goes behind them. Returns the new number of items. */
int hf_list_largest(int i, const double *value, int n_max, int n, int *list);

/* A value with its index. hf_compare_down orders the largest value first, and equal ones by their indices, for
 * qsort(3). */
typedef struct hf_ranked {
    double value;
    int index;
} hf_ranked;
int hf_compare_down(const void *a, const void *b);

/* Returns the mean of the largest `tail` of n values, a real number of them, at least 1 (CVaR: Rockafellar and Uryasev,
 * Journal of Risk 2, 2000). weight [n] becomes the weight of each value in the mean, its derivative. ranked [n] is
 * scratch. */
double hf_tail_mean(int n, const double *value, double tail, hf_ranked *ranked, double *weight);

/* Returns sqrt(x^2 + y^2 + z^2) without overflow or underflow. The error is below 2 units in the last place. The result
 * is infinite if a component is infinite, else NaN if a component is NaN. */
double hf_norm(double x, double y, double z);

/* Returns the rate of the size of a vector [3] that changes by `rate` [3]. The rate of a vector of size 0 is 0. */
double hf_norm_rate(const double *vector, const double *rate);

/* Returns the distance of two points [3]. */
double hf_distance(const double *a, const double *b);

/* Computes c = a x b of vectors [3]. c must be another array than a and b. */
void hf_cross(const double *a, const double *b, double *c);

/* Returns a . b of vectors [3]. */
double hf_dot3(const double a[3], const double b[3]);

/* Return the sine and the cosine. The error is below 3e-16 up to 1e8 rad. Beyond that, the result belongs to an angle
 * with a relative deviation below 1e-16. */
double hf_sine(double angle_rad);
double hf_cosine(double angle_rad);

/* Returns the inverse hyperbolic sine. The relative error is below 1e-15. */
double hf_inverse_sinh(double x);

/* Returns the natural logarithm of a normal number x > 0. The error is below 3e-16 of the result or below 1e-16,
 * whichever is larger. */
double hf_logarithm(double x);

/* Returns the quantile of the standard normal distribution for a probability in (0, 1). The relative error is below
 * 2e-15 (Wichura, algorithm AS 241, Appl. Stat. 37, 1988). */
double hf_normal_quantile(double probability);

/* Returns 2^x for |x| < 1000. The relative error is below 4e-16. */
double hf_power_of_two(double x);
