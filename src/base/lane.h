/* lane - the eight SIMD lanes in which chord and swarm process eight designs, the instruction sets of the kernels, and
 * the vector types and operations of the kernels.
 *
 * All instruction sets give the same bits. There are always eight lanes and one order of operations. The only
 * operations are IEEE + - * /, square root and fused multiply-add. The source marks every fused product
 * (`plus_product`, `less_product`, C's fma()); the compiler fuses nothing else (see CODEGEN in the Makefile). */
#pragma once

#include <stdbool.h>

#define HF_LANES 8

/* The instruction sets, slowest first. HF_LANE_AVX2 means AVX2 with FMA. */
typedef enum { HF_LANE_PORTABLE, HF_LANE_AVX2, HF_LANE_AVX512 } hf_lane_isa;
#define HF_LANE_N_ISA 3

bool hf_lane_has_isa(hf_lane_isa isa); /* true if this machine can execute it */
hf_lane_isa hf_lane_best_isa(void);    /* the fastest that this machine can execute */
const char *hf_lane_isa_name(hf_lane_isa isa);

/* ---- for *_kernel.c, which the Makefile compiles once for each instruction set with -DHF_ISA=avx512 and so on ---- */

#define HF_JOIN_(a, b) a##_##b
#define HF_JOIN(a, b) HF_JOIN_(a, b)
#define HF_KERNEL(name) HF_JOIN(name, HF_ISA) /* name with the instruction set as suffix */

/* Lists the objects of all instruction sets in the order of hf_lane_isa: what a *_kernel.c defines as HF_KERNEL(name),
 * usually a table of its functions. A caller takes entry hf_lane_best_isa() of such a list. */
#define HF_LANE_EACH(name) name##_portable, name##_avx2, name##_avx512

#define INLINE static inline __attribute__((always_inline))

/* ---- vectors of the width of the processor ---- */

#ifdef HF_LANE_VECTORS

#include <math.h>
#include <stddef.h>
#if defined __AVX2__
#include <immintrin.h>
#endif

/* A vector holds WIDTH doubles; PARTS vectors hold eight doubles. */
#if defined __AVX512F__
enum { WIDTH = 8 };
#elif defined __AVX2__
enum { WIDTH = 4 };
#else
enum { WIDTH = 2 };
#endif
enum { PARTS = HF_LANES / WIDTH };

typedef double vec __attribute__((vector_size(WIDTH * sizeof(double)), may_alias));
typedef unsigned long long bits_of __attribute__((vector_size(WIDTH * sizeof(double))));

/* A loop with a small constant count. It is unrolled, so that the arrays in it stay in registers. */
#define foreach(i, count) _Pragma("GCC unroll 16") for (int i = 0; i < (count); i++)

INLINE vec splat(double x)
{
    return x - (vec){0};
}

/* Returns WIDTH lanes of a row of array [][HF_LANES], from lane p on. */
INLINE vec *lanes_of(const double *array, ptrdiff_t row, int p)
{
    return (vec *)(void *)(array + row * HF_LANES + p);
}

#if !defined __AVX2__ && !defined FP_FAST_FMA
/* Fused multiply-add for processors without such an instruction: the algorithm of Boldo and Melquiond (IEEE
 * Trans. Comput. 57, 2008). Outside its range, C's fma() is called. It is as exact, but it is a call, and slow on
 * such a processor. */

/* Returns the exact rounding error a + b - sum, where sum = a + b is rounded. */
INLINE vec rest_of_sum(vec a, vec b, vec sum)
{
    vec part = sum - a;
    return (a - (sum - part)) + (b - part);
}

INLINE vec high_half(vec a)
{
    vec c = 134217729.0 * a; /* 2^27 + 1 */
    return c - (c - a);
}

INLINE vec rest_of_product(vec a, vec b, vec product)
{
    vec ah = high_half(a), al = a - ah, bh = high_half(b), bl = b - bh;
    return ((ah * bh - product) + ah * bl + al * bh) + al * bl;
}

/* Returns a + b if it is a double. Otherwise returns the neighbouring double whose last bit is odd. */
INLINE vec odd_sum(vec a, vec b)
{
    vec sum = a + b, rest = rest_of_sum(a, b, sum);
    bits_of s = (bits_of)sum, is_even = (s & 1) - 1;    /* all bits set if s is even, else 0 */
    bits_of away = 1 - 2 * ((s ^ (bits_of)rest) >> 63); /* 1 away from 0; -1 if the rest has the other sign */
    return (vec)(s + (away & is_even & (bits_of)(rest != 0)));
}

INLINE bool is_within(vec a, double low, double high)
{
    vec size = (vec)((bits_of)a & ~(1ULL << 63));
    bits_of is = (bits_of)((size > low) & (size < high));
    return (is[0] & is[1]) != 0;
}

/* Returns c + a b, rounded once. */
static __attribute__((noinline, unused)) vec plus_product(vec c, vec a, vec b)
{
    vec product = a * b;
    if (is_within(a, 0, 0x1p990) && is_within(b, 0, 0x1p990) && is_within(product, 0x1p-900, 0x1p1000) &&
        is_within(c, -1, 0x1p1000)) {
        vec low = rest_of_product(a, b, product), t = c + low, v = product + t;
        return v + odd_sum(rest_of_sum(c, low, t), rest_of_sum(product, t, v));
    }
    foreach (i, WIDTH)
        c[i] = a[i] == 0 || b[i] == 0 ? product[i] + c[i] : fma(a[i], b[i], c[i]);
    return c;
}
#else
/* Returns c + a b, rounded once. */
INLINE vec plus_product(vec c, vec a, vec b)
{
#if defined __AVX512F__
    return _mm512_fmadd_pd(a, b, c);
#elif defined __AVX2__
    return _mm256_fmadd_pd(a, b, c);
#else
    foreach (i, WIDTH)
        c[i] = fma(a[i], b[i], c[i]);
    return c;
#endif
}
#endif

/* Returns c - a b, rounded once. */
INLINE vec less_product(vec c, vec a, vec b)
{
#if defined __AVX512F__
    return _mm512_fnmadd_pd(a, b, c);
#elif defined __AVX2__
    return _mm256_fnmadd_pd(a, b, c);
#else
    return plus_product(c, -a, b);
#endif
}

INLINE vec root(vec a)
{
#if defined __AVX512F__
    return _mm512_sqrt_pd(a);
#elif defined __AVX2__
    return _mm256_sqrt_pd(a);
#else
    foreach (i, WIDTH)
        a[i] = sqrt(a[i]);
    return a;
#endif
}

/* Returns x^2 + y^2 + z^2. */
INLINE vec norm_squared(vec x, vec y, vec z)
{
    return plus_product(plus_product(x * x, y, y), z, z);
}

/* Returns `yes` where a > b, else `no`. Returns `no` where a or b is NaN. */
INLINE vec if_greater(vec a, vec b, vec yes, vec no)
{
    typedef long long mask __attribute__((vector_size(WIDTH * sizeof(double))));
    mask m = a > b;
    return (vec)((m & (mask)yes) | (~m & (mask)no));
}

INLINE vec larger(vec a, vec b)
{
    return if_greater(a, b, a, b);
}

INLINE vec smaller(vec a, vec b)
{
    return if_greater(b, a, a, b);
}

INLINE vec magnitude(vec a)
{
    return larger(a, -a);
}

/* Computes cosine and sine of an angle in turns, below 2^51; the error is below 6e-16. Whole turns are subtracted
 * exactly, which leaves -1/2 to 1/2. Series give cosine and sine of half of the angle, and then its double follows. */
INLINE void turn(vec turns, vec *cosine, vec *sine)
{
    static const double s[] = {-2.2948428997269873e-08, 7.952054001475513e-07,  -2.1915353447830217e-05,
                               0.00046630280576761255,  -0.0073704309457143504, 0.08214588661112823,
                               -0.5992645293207921,     2.5501640398773455,     -5.16771278004997,
                               3.141592653589793};
    static const double c[] = {3.604730797462501e-09,
                               -1.3878952462213771e-07,
                               4.303069587032947e-06,
                               -0.0001046381049248457,
                               0.0019295743094039231,
                               -0.02580689139001406,
                               0.2353306303588932,
                               -1.3352627688545895,
                               4.0587121264167685,
                               -4.934802200544679,
                               1.0};
    vec whole = (turns + 0x1.8p52) - 0x1.8p52, r = turns - whole, square = r * r, half = splat(s[0]),
        other = splat(c[0]);
    foreach (k, 9)
        half = plus_product(splat(s[k + 1]), half, square);
    foreach (k, 10)
        other = plus_product(splat(c[k + 1]), other, square);
    half *= r;
    vec twice = half + half;
    *sine = twice * other;
    *cosine = less_product(splat(1), twice, half);
}

/* Returns a^q for a > 0, else 0. The relative error is below 1e-15 (1 + q |ln a|). With a = 2^k m and m around 1, the
 * binary logarithm of a is k + that of m, and ln m = 2 artanh u with u = (m - 1)/(m + 1), as in hf_logarithm. Powers
 * below 2^-900 are 0. */
INLINE vec power(vec a, double q)
{
    const double ln_2 = 0.69314718055994530942;
    bits_of bits = (bits_of)a, mantissa = (bits & 0xfffffffffffffULL) | 0x3ff0000000000000ULL;
    vec m = (vec)mantissa, k = (vec)((bits >> 52) | 0x4330000000000000ULL) - (0x1p52 + 1023);
    k = if_greater(m, splat(1.4142135623730951), k + 1, k);
    m = if_greater(m, splat(1.4142135623730951), 0.5 * m, m);
    vec u = (m - 1) / (m + 1), square = u * u, sum = splat(1.0 / 21);
    foreach (i, 10)
        sum = plus_product(splat(1.0 / (19 - 2 * i)), sum, square);
    vec exponent = q * plus_product(k, u * sum, splat(2 / ln_2)), moved = exponent + 0x1.8p52;
    vec t = (exponent - (moved - 0x1.8p52)) * ln_2, grown = splat(1);
    foreach (i, 13)
        grown = plus_product(splat(1), t * (1.0 / (13 - i)), grown);
    vec scale = (vec)(((bits_of)moved + 1023) << 52), result = grown * scale;
    return if_greater(a, splat(0), if_greater(exponent, splat(-900), result, splat(0)), splat(0));
}

#endif

/* ---- eight doubles in one vector, which the compiler divides ---- */

#ifdef HF_LANE_EIGHT

#include <string.h>

typedef double lanes __attribute__((vector_size(HF_LANES * sizeof(double))));
typedef long long lanes_where __attribute__((vector_size(HF_LANES * sizeof(double)))); /* -1: true, 0: false */

INLINE lanes lanes_load(const double from[HF_LANES])
{
    lanes a;
    memcpy(&a, from, sizeof a);
    return a;
}

INLINE void lanes_store(double to[HF_LANES], lanes a)
{
    memcpy(to, &a, sizeof a);
}

/* Returns the lanes of a where the condition holds, and those of b elsewhere. */
INLINE lanes lanes_choose(lanes_where condition, lanes a, lanes b)
{
    return (lanes)((condition & (lanes_where)a) | (~condition & (lanes_where)b));
}

/* Returns the square roots. C has no vector form of sqrt; the compiler makes vector instructions from the loop. */
INLINE lanes lanes_root(lanes a)
{
    for (int k = 0; k < HF_LANES; k++)
        a[k] = __builtin_sqrt(a[k]);
    return a;
}

#endif
