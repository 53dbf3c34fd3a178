/* surface_fit - the best fit of a surface by its parameters, for what needs derivatives (METHOD section 9). */
#ifndef HIFDM_SURFACE_FIT_H
#define HIFDM_SURFACE_FIT_H

#include <hifdm/surface.h>

/* Shifts are in units of a size, turns in radians; the curvature is 1 + CURVE times the wanted one. */
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
enum { HF_FIT_N_PARAMETER = 6 }; /* at most; of each kind of surface one quantity changes nothing */

/* A point p is at turn (p - center - shift) + center in the frame of the fitted surface. */
typedef struct {
    int n;                            /* parameters that the points determine; 0: there is no fit */
    int quantity[HF_FIT_N_PARAMETER]; /* [n] what each is */
    double value[HF_FIT_N_QUANTITY];  /* by quantity; 0 where it is none of them */
    double center_m[3], size_m;
} hf_fit_parameters;

/* turn = (Rx Ry Rz)' of three angles, or its derivative: order[k] times by angle k, each to the second order. */
void hf_fit_rotation(const double angle[3], const int order[3], double turn[3][3]);

/* hf_surface_fit_points that tells its parameters. */
hf_status hf_surface_fit_find(hf_surface_kind kind, double focal_length_m, int n, const double *position_m,
                              const double *root_weight, hf_surface_fit *fit, hf_fit_parameters *parameters);

#endif
