/* surface_near - the best fit to points that are near those of another fit, such as an as-built net near its design. It
 * takes Gauss-Newton steps from that fit and allocates no memory for them (METHOD section 9). The reference is
 * hf_surface_fit_points; it also finds the fits that this method does not find. */
#pragma once

#include "surface/surface_fit.h"

/* A change of a pose in the frame of the surface, or the derivatives of a figure by such a change: shift in m, turn
 * about the centre in rad, curvature in 1/m. */
typedef struct {
    double move[3], turn[3], curve;
} hf_surface_motion;

/* A fitted surface: z = curvature x^2 (+ y^2). In its frame, point p is at turn (p - center - shift) + center. */
typedef struct {
    int n; /* parameters that the points of this fit determine, of HF_FIT_N_PARAMETER; 0: there is no fit */
    hf_surface_kind kind;
    double center_m[3], shift_m[3], turn[3][3];
    double curvature_per_m, wanted_per_m, size_m;
    /* Without all parameters: changes of the n free ones, shifts held at a bound, and the coordinates, of [3][n_point],
     * whose distance is twice size_m. */
    hf_surface_motion free[HF_FIT_N_PARAMETER];
    double held_m[3];
    int size_end[2];
} hf_surface_pose;

hf_surface_pose hf_surface_pose_of(hf_surface_kind kind, double focal_length_m, const hf_surface_fit *fit,
                                   const hf_fit_parameters *parameters);

/* Returns the pose of the target surface, from which the steps to a fit to these points [3][n] can start. */
hf_surface_pose hf_surface_pose_of_target(hf_surface_kind kind, double focal_length_m, int n, const double *position_m);

/* Computes the half-path RMS in metres after the best fit to points [3][n], starting from this pose. root_weight [n]:
 * roots of the weights, or NULL if all are 1. Agrees with the reference to 1e-9 of the RMS (unit/surface/surface).
 * Returns false if the steps do not converge at once, or if they end near what the reference treats as undetermined.
 * *half_path_rms_m has no meaning then. */
bool hf_surface_fit_near(const hf_surface_pose *from, int n, const double *position_m, const double *root_weight,
                         double *half_path_rms_m);

/* Finds this fit like hf_surface_fit_near, and also writes its pose. */
bool hf_surface_pose_near(const hf_surface_pose *from, int n, const double *position_m, const double *root_weight,
                          hf_surface_pose *pose, double *half_path_rms_m);

/* Returns a pose after a step of its parameters: shifts and turns in the frame of the surface, shifts relative to the
 * size, turns in rad, then the change of the curvature times the size. */
hf_surface_pose hf_surface_pose_moved(const hf_surface_pose *pose, const double step[HF_FIT_N_PARAMETER]);

/* Returns the maximum of gradient . step over the steps of the best fit that follow, to first order, if the half-path
 * error of each point changes by at most change_m. pose: the best fit to these points. gradient: by the parameters of
 * hf_surface_pose_moved. Returns NaN if the points do not determine the parameters. */
double hf_surface_pose_bound(const hf_surface_pose *pose, int n, const double *position_m, const double *root_weight,
                             const double gradient[HF_FIT_N_PARAMETER], double change_m);

/* Adds to by [3][n], derivatives of a figure by points x [3][n] in the frame of their best fit, how the figure changes
 * because the fit follows the points. by_fit: derivatives of the figure by the fit. Parameters that the points do not
 * determine are constant, and so are those held at a bound, in units of the size. Returns false without a fit. */
bool hf_surface_pose_pull(const hf_surface_pose *pose, int n, const double *x, const double *root_weight,
                          const hf_surface_motion *by_fit, double *by);
