#include "linalg/twofold.h"

#include <math.h>

hf_twofold hf_twofold_divide(hf_twofold a, hf_twofold b)
{
    double first = a.hi / b.hi;
    hf_twofold product = hf_twofold_product(b.hi, first);
    hf_twofold back = hf_twofold_sum_ordered(product.hi, b.lo * first);
    back = hf_twofold_sum_ordered(back.hi, back.lo + product.lo);
    double rest = (a.hi - back.hi) + (a.lo - back.lo);
    return hf_twofold_sum_ordered(first, rest / b.hi);
}

/* Does one Newton step from the root of the leading part. */
hf_twofold hf_twofold_root(hf_twofold a)
{
    if (!(a.hi > 0)) return (hf_twofold){0, 0};
    double first = sqrt(a.hi);
    hf_twofold square = hf_twofold_product(first, first);
    double rest = ((a.hi - square.hi) - square.lo) + a.lo;
    return hf_twofold_sum_ordered(first, rest / (2 * first));
}
