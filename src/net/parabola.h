/* parabola - the arc length of z = x^2/(4f). Generators space their nodes by it. */
#pragma once

/* Returns the arc length from the vertex to x, m. It is negative for x below 0. */
double hf_parabola_arc_m(double x_m, double focal_length_m);

/* Returns the x >= 0 at the arc length s >= 0 from the vertex, m. */
double hf_parabola_x_at_arc_m(double arc_m, double focal_length_m);
