/* hypervolume - of points with two or three objectives below a reference, for tests: by slices, O(n^3). */
#pragma once

#include <math.h>
#include <stdlib.h>

static int by_first(const void *a, const void *b)
{
    const double *x = a, *y = b;
    return (x[0] > y[0]) - (x[0] < y[0]);
}

/* point [n][3]; of two objectives the third is 0, and reference[2] 1. */
static inline double hypervolume(int n, double (*point)[3], const double reference[3])
{
    double volume = 0;
    qsort(point, (size_t)n, sizeof *point, by_first);
    for (int i = 0; i < n; i++) { /* slices across the first objective: from point i to the next */
        double width = fmin(reference[0], i + 1 < n ? point[i + 1][0] : INFINITY) - point[i][0];
        if (!(width > 0)) continue;
        double area = 0, low = -INFINITY;
        for (;;) { /* the union of the rectangles of points 0 to i, from the least second objective on */
            double at = INFINITY, height = reference[2], next = reference[1];
            for (int k = 0; k <= i; k++)
                if (point[k][1] > low) at = fmin(at, point[k][1]);
            if (!(at < reference[1])) break;
            for (int k = 0; k <= i; k++) {
                if (point[k][1] <= at) height = fmin(height, point[k][2]);
                if (point[k][1] > at) next = fmin(next, point[k][1]);
            }
            area += (next - at) * (reference[2] - height);
            low = at;
        }
        volume += width * area;
    }
    return volume;
}
