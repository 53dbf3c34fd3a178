#include "linalg/twofold.h"

#include <math.h>

/* Does one Newton step from the root of the leading part. */
hf_twofold hf_twofold_root(hf_twofold a)
{
    if (!(a.hi > 0)) return (hf_twofold){0, 0};
    double first = sqrt(a.hi);
    hf_twofold square = hf_twofold_product(first, first);
    double rest = ((a.hi - square.hi) - square.lo) + a.lo;
    return hf_twofold_sum_ordered(first, rest / (2 * first));
}
