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

#define HF_TWOFOLD_NUMBER lanes
#include "linalg/twofold.h"

/* ---- numbers of twice the precision ---- */

INLINE hf_twofold twofold_choose(lanes_where condition, hf_twofold a, hf_twofold b)
{
    return (hf_twofold){lanes_choose(condition, a.hi, b.hi), lanes_choose(condition, a.lo, b.lo)};
}

INLINE hf_twofold twofold_root(hf_twofold a)
{
    lanes zero = {0}, first = lanes_root(a.hi);
    hf_twofold square = hf_twofold_product(first, first);
    lanes rest = ((a.hi - square.hi) - square.lo) + a.lo;
    hf_twofold root = hf_twofold_sum_ordered(first, rest / (2 * first));
    return twofold_choose(a.hi > 0, root, (hf_twofold){zero, zero});
}

/* ---- measure ---- */

INLINE hf_twofold load2(double from[2][HF_LANES])
{
    return (hf_twofold){lanes_load(from[0]), lanes_load(from[1])};
}

INLINE void store2(double to[2][HF_LANES], hf_twofold a)
{
    lanes_store(to[0], a.hi);
    lanes_store(to[1], a.lo);
}

void HF_KERNEL(hf_precise_measure)(hf_precise_lanes *p, bool by_law)
{
    const hf_twofold zero = {{0}, {0}};
    lanes_where elastic = lanes_load(p->is_elastic) != 0, spring = lanes_load(p->is_spring) != 0;
    lanes_where slack = lanes_load(p->is_slack) != 0;
    hf_twofold d[3], square = zero, T = load2(p->T), target = hf_twofold_of(lanes_load(p->target));
    hf_twofold EA = hf_twofold_of(lanes_load(p->EA)), wanted = target;
    for (int c = 0; c < 3; c++) {
        d[c] = hf_twofold_subtract(load2(p->to[c]), load2(p->from[c]));
        square = hf_twofold_add(square, hf_twofold_multiply(d[c], d[c]));
    }
    hf_twofold length = twofold_root(square);
    bool has_elastic = false;
    for (int k = 0; k < HF_LANES; k++)
        has_elastic = has_elastic || p->is_elastic[k] != 0;
    if (has_elastic) {
        hf_twofold more = hf_twofold_divide(hf_twofold_multiply(target, T), EA);
        wanted = twofold_choose(elastic, hf_twofold_add(target, more), target);
    }
    store2(p->over, hf_twofold_subtract(length, wanted));
    T = twofold_choose(spring, hf_twofold_multiply(target, length), T);
    if (has_elastic && by_law) {
        hf_twofold longer = hf_twofold_subtract(length, target);
        hf_twofold own = hf_twofold_divide(hf_twofold_multiply(EA, longer), target);
        T = twofold_choose(elastic, own, T);
    }
    hf_twofold q = twofold_choose(slack, zero, hf_twofold_divide(T, length));
    lanes_store(p->length, length.hi);
    lanes_store(p->q, q.hi);
    for (int c = 0; c < 3; c++) {
        lanes_store(p->unit[c], d[c].hi / length.hi);
        store2(p->pull[c], hf_twofold_multiply(q, d[c]));
    }
}
