/* Measures eight cables at twice the precision, one in each lane. The file is compiled once for each instruction set.
 *
 *     ends from and to, tension T, target, EA
 *         | d = to - from,  length = |d|
 *         | over = length - target, of an elastic cable length - target (1 + T/EA)
 *         | T: as given; target times length of a spring; by law of an elastic cable; 0 of a slack cable
 *         v
 *     length, unit = d / length, over, q = T / length, pull = q d */
#define HF_LANE_EIGHT
#include "solve/precise_kernel.h"

/* ---- numbers of twice the precision: the same operations and bits as in linalg/twofold.h ---- */

typedef struct {
    lanes hi, lo;
} twofold;

INLINE twofold twofold_of(lanes a)
{
    return (twofold){a, a - a};
}

INLINE twofold twofold_choose(lanes_where condition, twofold a, twofold b)
{
    return (twofold){lanes_choose(condition, a.hi, b.hi), lanes_choose(condition, a.lo, b.lo)};
}

INLINE twofold twofold_sum(lanes a, lanes b)
{
    lanes s = a + b, part = s - a;
    return (twofold){s, (a - (s - part)) + (b - part)};
}

INLINE twofold twofold_sum_ordered(lanes a, lanes b)
{
    lanes s = a + b;
    return (twofold){s, b - (s - a)};
}

INLINE twofold twofold_product(lanes a, lanes b)
{
    lanes ca = 134217729.0 * a, cb = 134217729.0 * b; /* 2^27 + 1 */
    lanes ah = ca - (ca - a), al = a - ah, bh = cb - (cb - b), bl = b - bh, p = a * b;
    return (twofold){p, ((ah * bh - p) + ah * bl + al * bh) + al * bl};
}

INLINE twofold twofold_add(twofold a, twofold b)
{
    twofold s = twofold_sum(a.hi, b.hi), t = twofold_sum(a.lo, b.lo);
    twofold v = twofold_sum_ordered(s.hi, s.lo + t.hi);
    return twofold_sum_ordered(v.hi, t.lo + v.lo);
}

INLINE twofold twofold_subtract(twofold a, twofold b)
{
    return twofold_add(a, (twofold){-b.hi, -b.lo});
}

INLINE twofold twofold_multiply(twofold a, twofold b)
{
    twofold p = twofold_product(a.hi, b.hi);
    return twofold_sum_ordered(p.hi, p.lo + (a.hi * b.lo + a.lo * b.hi));
}

INLINE twofold twofold_divide(twofold a, twofold b)
{
    lanes first = a.hi / b.hi;
    twofold product = twofold_product(b.hi, first);
    twofold back = twofold_sum_ordered(product.hi, b.lo * first);
    back = twofold_sum_ordered(back.hi, back.lo + product.lo);
    lanes rest = (a.hi - back.hi) + (a.lo - back.lo);
    return twofold_sum_ordered(first, rest / b.hi);
}

INLINE twofold twofold_root(twofold a)
{
    lanes zero = {0}, first = lanes_root(a.hi);
    twofold square = twofold_product(first, first);
    lanes rest = ((a.hi - square.hi) - square.lo) + a.lo;
    twofold root = twofold_sum_ordered(first, rest / (2 * first));
    return twofold_choose(a.hi > 0, root, (twofold){zero, zero});
}

/* ---- measure ---- */

INLINE twofold load2(double from[2][HF_LANES])
{
    return (twofold){lanes_load(from[0]), lanes_load(from[1])};
}

INLINE void store2(double to[2][HF_LANES], twofold a)
{
    lanes_store(to[0], a.hi);
    lanes_store(to[1], a.lo);
}

void HF_KERNEL(hf_precise_measure)(hf_precise_lanes *p, bool by_law)
{
    const twofold zero = {{0}, {0}};
    lanes_where elastic = lanes_load(p->is_elastic) != 0, spring = lanes_load(p->is_spring) != 0;
    lanes_where slack = lanes_load(p->is_slack) != 0;
    twofold d[3], square = zero, T = load2(p->T), target = twofold_of(lanes_load(p->target));
    twofold EA = twofold_of(lanes_load(p->EA)), wanted = target;
    for (int c = 0; c < 3; c++) {
        d[c] = twofold_subtract(load2(p->to[c]), load2(p->from[c]));
        square = twofold_add(square, twofold_multiply(d[c], d[c]));
    }
    twofold length = twofold_root(square);
    bool has_elastic = false;
    for (int k = 0; k < HF_LANES; k++)
        has_elastic = has_elastic || p->is_elastic[k] != 0;
    if (has_elastic) {
        twofold more = twofold_divide(twofold_multiply(target, T), EA);
        wanted = twofold_choose(elastic, twofold_add(target, more), target);
    }
    store2(p->over, twofold_subtract(length, wanted));
    T = twofold_choose(spring, twofold_multiply(target, length), T);
    if (has_elastic && by_law) {
        twofold longer = twofold_subtract(length, target);
        twofold own = twofold_divide(twofold_multiply(EA, longer), target);
        T = twofold_choose(elastic, own, T);
    }
    twofold q = twofold_choose(slack, zero, twofold_divide(T, length));
    lanes_store(p->length, length.hi);
    lanes_store(p->q, q.hi);
    for (int c = 0; c < 3; c++) {
        lanes_store(p->unit[c], d[c].hi / length.hi);
        store2(p->pull[c], twofold_multiply(q, d[c]));
    }
}
