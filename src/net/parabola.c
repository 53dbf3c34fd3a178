#include "net/parabola.h"

#include "base/elementary.h"

#include <math.h>

double hf_parabola_arc_m(double x, double focal)
{
    double slope = x / (2 * focal);
    return focal * (slope * sqrt(1 + slope * slope) + hf_inverse_sinh(slope));
}

/* Solves arc(x) = s by Newton's method. The function is convex and increasing, and the start s is not below the
 * solution (x <= s). So the iterates decrease to the solution and converge quadratically. */
double hf_parabola_x_at_arc_m(double s, double focal)
{
    double x = s;
    for (int i = 0; i < 60; i++) {
        double step = (hf_parabola_arc_m(x, focal) - s) / hf_norm(1, x / (2 * focal), 0);
        x -= step;
        if (fabs(step) <= 1e-16 * fabs(s)) break;
    }
    return x;
}
