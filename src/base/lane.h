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
