/* surface_fit - the best fit of a surface with its parameters, for code that needs derivatives (METHOD section 9). */
#ifndef HIFDM_SURFACE_FIT_H
#define HIFDM_SURFACE_FIT_H

#include <hifdm/surface.h>

/* Quantities of a fit. Shifts are in units of a size, and turns in rad. The curvature is 1 + CURVE times that of
 * the target surface. */
enum {
    HF_FIT_SHIFT_Z,
    HF_FIT_TURN_X,
    HF_FIT_TURN_Y,
    HF_FIT_TURN_Z,
    HF_FIT_CURVE,
    HF_FIT_SHIFT_X,
    HF_FIT_SHIFT_Y,
    HF_FIT_N_QUANTITY
};
enum { HF_FIT_N_PARAMETER = 6 }; /* at most; each kind of surface is invariant under one quantity */

/* Parameters of a fit. In the frame of the fitted surface, a point p is at turn (p - center - shift) + center. */
typedef struct {
    int n;                            /* parameters that the points determine; 0: no fit */
    int quantity[HF_FIT_N_PARAMETER]; /* [n], quantity of each parameter */
    double value[HF_FIT_N_QUANTITY];  /* by quantity; 0 for those that are no parameters */
    double center_m[3], size_m;
} hf_fit_parameters;

/* Computes turn = (Rx Ry Rz)' for three angles, or a derivative: order[k] is the order of the derivative by angle k,
 * 0 to 2. */
void hf_fit_rotation(const double angle[3], const int order[3], double turn[3][3]);

/* Finds the best fit like hf_surface_fit_points, and also writes its parameters. */
hf_status hf_surface_fit_find(hf_surface_kind kind, double focal_length_m, int n, const double *position_m,
                              const double *root_weight, hf_surface_fit *fit, hf_fit_parameters *parameters);

#endif
