/* surface_fit - the best fit of a surface with its parameters, for code that needs derivatives (METHOD section 9). */
#pragma once

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
    int n;                            /* free parameters that the points determine; 0: no fit */
    int n_held;                       /* parameters held at the bounds of a fit */
    int quantity[HF_FIT_N_PARAMETER]; /* [n + n_held], quantity of each parameter, free ones first */
    double value[HF_FIT_N_QUANTITY];  /* by quantity; 0 for those that are no parameters */
    double center_m[3], size_m;
    int size_end[2]; /* coordinates, of [3][n], whose distance is twice size_m */
} hf_fit_parameters;

/* Computes turn = (Rx Ry Rz)' for three angles, or a derivative: order[k] is the order of the derivative by angle k,
 * 0 to 2. */
void hf_fit_rotation(const double angle[3], const int order[3], double turn[3][3]);

/* Finds the best fit like hf_surface_fit_points, and also writes its parameters. */
hf_status hf_surface_fit_find(hf_surface_kind kind, double focal_length_m, int n, const double *position_m,
                              const double *root_weight, hf_surface_fit *fit, hf_fit_parameters *parameters);

/* ---- the points of a best fit as functions of its parameters, with first and second derivatives ---- */

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

/* Returns the error of a point p in metres, u / (1 + t^2)^m, with its height u above a surface of this
 * curvature and the slope t there (M16). m is 1 for the half path and 1/2 along the normal. d [4]: derivatives
 * by p and by the curvature. */
double hf_fit_error(hf_surface_kind kind, double m, double curvature, const double p[3], double d[4]);

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

double hf_fit_weight(const hf_fit_frame *frame, int i);
hf_fit_point hf_fit_point_take(const hf_fit_frame *frame, int i);

/* Returns half the weighted sum of squares of the half-path errors, m2. Writes its derivatives G [n] and H [n][n] by
 * the n = found->n parameters. */
double hf_fit_hessian(const hf_fit_frame *frame, double *G, double *H);
