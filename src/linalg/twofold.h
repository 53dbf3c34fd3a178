/* twofold - numbers of twice the precision: the unevaluated sum of two doubles, about 106 bits.
 *
 * The algorithms are those of Dekker (Numer. Math. 18, 1971) and of Joldes, Muller, Popescu (ACM Trans. Math. Softw.
 * 44, 2017). The root is that of Lefevre, Louvet, Muller, Picot, Rideau (ACM Trans. Math. Softw. 49, 2023). They prove
 * the error bounds stated below. The bounds are relative to the result, with u = 2^-53, and hold without overflow and
 * underflow. Products are split, not fused, so that the bits are the same on every processor. */
#pragma once

/* A kernel that computes with eight of them side by side defines HF_TWOFOLD_NUMBER as a vector, before it includes this
 * file. The operations are the same, and so are the bits. */
#ifndef HF_TWOFOLD_NUMBER
#define HF_TWOFOLD_NUMBER double
#endif
typedef HF_TWOFOLD_NUMBER hf_twofold_number;

typedef struct {
    hf_twofold_number hi, lo; /* hi is hi + lo rounded to double */
} hf_twofold;

#define HF_TWOFOLD_INLINE static inline __attribute__((always_inline))

/* The unit of the error bounds below, u^2. */
#define HF_TWOFOLD_UNIT 0x1p-106

/* Returns a + b, exact. */
HF_TWOFOLD_INLINE hf_twofold hf_twofold_sum(hf_twofold_number a, hf_twofold_number b)
{
    hf_twofold_number s = a + b, part = s - a;
    return (hf_twofold){s, (a - (s - part)) + (b - part)};
}

/* Returns a + b, exact for |a| >= |b|. */
HF_TWOFOLD_INLINE hf_twofold hf_twofold_sum_ordered(hf_twofold_number a, hf_twofold_number b)
{
    hf_twofold_number s = a + b;
    return (hf_twofold){s, b - (s - a)};
}

/* Returns a b, exact. */
HF_TWOFOLD_INLINE hf_twofold hf_twofold_product(hf_twofold_number a, hf_twofold_number b)
{
    hf_twofold_number ca = 134217729.0 * a, cb = 134217729.0 * b; /* 2^27 + 1 */
    hf_twofold_number ah = ca - (ca - a), al = a - ah, bh = cb - (cb - b), bl = b - bh, p = a * b;
    return (hf_twofold){p, ((ah * bh - p) + ah * bl + al * bh) + al * bl};
}

HF_TWOFOLD_INLINE hf_twofold hf_twofold_of(hf_twofold_number a)
{
    return (hf_twofold){.hi = a};
}

HF_TWOFOLD_INLINE hf_twofold hf_twofold_minus(hf_twofold a)
{
    return (hf_twofold){-a.hi, -a.lo};
}

/* Returns a + b. The error is below 3 u^2 + 13 u^3 for any signs. */
HF_TWOFOLD_INLINE hf_twofold hf_twofold_add(hf_twofold a, hf_twofold b)
{
    hf_twofold s = hf_twofold_sum(a.hi, b.hi), t = hf_twofold_sum(a.lo, b.lo);
    hf_twofold v = hf_twofold_sum_ordered(s.hi, s.lo + t.hi);
    return hf_twofold_sum_ordered(v.hi, t.lo + v.lo);
}

HF_TWOFOLD_INLINE void hf_twofold_add_to(hf_twofold *sum, hf_twofold a)
{
    *sum = hf_twofold_add(*sum, a);
}

HF_TWOFOLD_INLINE hf_twofold hf_twofold_subtract(hf_twofold a, hf_twofold b)
{
    return hf_twofold_add(a, hf_twofold_minus(b));
}

/* Returns a b. The error is below 7 u^2. */
HF_TWOFOLD_INLINE hf_twofold hf_twofold_multiply(hf_twofold a, hf_twofold b)
{
    hf_twofold p = hf_twofold_product(a.hi, b.hi);
    return hf_twofold_sum_ordered(p.hi, p.lo + (a.hi * b.lo + a.lo * b.hi));
}

/* Returns a / b. The error is below 16 u^2. */
HF_TWOFOLD_INLINE hf_twofold hf_twofold_divide(hf_twofold a, hf_twofold b)
{
    hf_twofold_number first = a.hi / b.hi;
    hf_twofold product = hf_twofold_product(b.hi, first);
    hf_twofold back = hf_twofold_sum_ordered(product.hi, b.lo * first);
    back = hf_twofold_sum_ordered(back.hi, back.lo + product.lo);
    hf_twofold_number rest = (a.hi - back.hi) + (a.lo - back.lo);
    return hf_twofold_sum_ordered(first, rest / b.hi);
}

/* Returns the square root of a >= 0, and 0 for other a. The error is below 4 u^2. */
hf_twofold hf_twofold_root(hf_twofold a);
