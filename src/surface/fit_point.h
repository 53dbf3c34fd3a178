/* fit_point - the points of a best fit as functions of its parameters, to the second derivative (METHOD section 7). */
#ifndef HIFDM_FIT_POINT_H
#define HIFDM_FIT_POINT_H

#include "surface/surface_fit.h"

/* Points, the surface that is fitted to them, and the derivatives of its turn by angles. */
typedef struct {
    hf_surface_kind kind;
    int n;
    const double *position_m, *root_weight; /* [3][n]; [n] roots of weights, or NULL: all are 1 */
    const hf_fit_parameters *found;
    double shift_m[3], turn[3][3];
    double slope[3][3][3];                /* of the rotation by each angle */
    double bend[3][3][3][3];              /* by two angles */
    double curvature_per_m, wanted_per_m; /* of the fitted surface; of the wanted one: of CURVE */
} hf_fit_frame;

/* A point in the frame of the surface: its place and the curvature are four coordinates. */
typedef struct {
    double at[3], arm[3];             /* its place there; its place from the shifted centre, in the frame of the net */
    double by[HF_FIT_N_PARAMETER][4]; /* coordinates by parameter */
    double value, d[4], dd[4][4];     /* its half-path error, and the derivatives by coordinates */
} hf_fit_point;

/* Which angle a quantity is, or -1. */
static inline int hf_fit_angle_of(int quantity)
{
    return quantity >= HF_FIT_TURN_X && quantity <= HF_FIT_TURN_Z ? quantity - HF_FIT_TURN_X : -1;
}

/* The frame borrows points, roots and parameters. */
hf_fit_frame hf_fit_frame_of(hf_surface_kind kind, double focal_length_m, int n, const double *position_m,
                             const double *root_weight, const hf_fit_parameters *found);

void hf_fit_locate(const hf_fit_frame *frame, int i, double arm[3], double at[3]);
double hf_fit_weight(const hf_fit_frame *frame, int i);
hf_fit_point hf_fit_point_take(const hf_fit_frame *frame, int i);

/* Half the weighted sum of squares of the half-path errors, m^2; G [n] and H [n][n] by the n = found->n parameters. */
double hf_fit_hessian(const hf_fit_frame *frame, double *G, double *H);

#endif
