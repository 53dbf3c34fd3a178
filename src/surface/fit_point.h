/* fit_point - the points of a best fit as functions of its parameters, with first and second derivatives
 * (METHOD section 7). */
#ifndef HIFDM_FIT_POINT_H
#define HIFDM_FIT_POINT_H

#include "surface/surface_fit.h"

/* Points, the surface fitted to them, and the derivatives of its rotation by the angles. */
typedef struct {
    hf_surface_kind kind;
    int n;
    const double *position_m, *root_weight; /* [3][n]; [n] roots of weights, or NULL: all are 1 */
    const hf_fit_parameters *found;
    double shift_m[3], turn[3][3];
    double slope[3][3][3];                /* first derivatives of the rotation, by each angle */
    double by_shift[3][3];                /* derivatives of the coordinates by each shift, the same for all points */
    double curvature_per_m, wanted_per_m; /* of the fitted surface; of the target surface, the unit of CURVE */
} hf_fit_frame;

/* A point in the frame of the surface. Its position and the curvature are four coordinates. */
typedef struct {
    double at[3], arm[3];             /* position there; vector from the shifted centre, frame of the net */
    double by[HF_FIT_N_PARAMETER][4]; /* derivatives of the coordinates by the parameters */
    double value, d[4], dd[4][4];     /* half-path error, with its derivatives by the coordinates */
} hf_fit_point;

/* Returns the index of the angle that a quantity stands for, or -1. */
static inline int hf_fit_angle_of(int quantity)
{
    return quantity >= HF_FIT_TURN_X && quantity <= HF_FIT_TURN_Z ? quantity - HF_FIT_TURN_X : -1;
}

/* Returns the inner product of two vectors of the four coordinates. */
static inline double hf_fit_dot(const double a[4], const double b[4])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
}

/* Computes a frame. It borrows points, roots and parameters. */
hf_fit_frame hf_fit_frame_of(hf_surface_kind kind, double focal_length_m, int n, const double *position_m,
                             const double *root_weight, const hf_fit_parameters *found);

void hf_fit_locate(const hf_fit_frame *frame, int i, double arm[3], double at[3]);

/* Computes the derivatives of the coordinates of a point by the found->n parameters. arm: vector from the shifted
 * centre. */
void hf_fit_derive(const hf_fit_frame *frame, const double arm[3], double by[HF_FIT_N_PARAMETER][4]);

double hf_fit_weight(const hf_fit_frame *frame, int i);
hf_fit_point hf_fit_point_take(const hf_fit_frame *frame, int i);

/* Returns half the weighted sum of squares of the half-path errors, m2. Writes its derivatives G [n] and H [n][n] by
 * the n = found->n parameters. */
double hf_fit_hessian(const hf_fit_frame *frame, double *G, double *H);

#endif
