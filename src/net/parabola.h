/* parabola - the arc length of z = x^2/(4f), by which generators space their nodes. */
#ifndef HIFDM_PARABOLA_H
#define HIFDM_PARABOLA_H

/* Arc length from the vertex to x, m; negative for x below 0. */
double hf_parabola_arc_m(double x_m, double focal_length_m);

/* The x >= 0 at this arc length s >= 0 from the vertex, m. */
double hf_parabola_x_at_arc_m(double arc_m, double focal_length_m);

#endif
