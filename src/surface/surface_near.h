/* surface_near - the best fit to points that are near those of another fit, such as an as-built net near its design. It
 * takes Gauss-Newton steps from that fit and allocates no memory for them (METHOD section 9). The reference is
 * hf_surface_fit_points; it also finds the fits that this method does not find. */
#pragma once

#include "surface/surface_fit.h"

/* A fitted surface: z = curvature x^2 (+ y^2). In its frame, point p is at turn (p - center - shift) + center. */
typedef struct {
    bool is_whole; /* true: the points of this fit determine all parameters */
    hf_surface_kind kind;
    double center_m[3], shift_m[3], turn[3][3];
    double curvature_per_m, wanted_per_m, size_m;
} hf_surface_pose;

hf_surface_pose hf_surface_pose_of(hf_surface_kind kind, double focal_length_m, const hf_surface_fit *fit,
                                   const hf_fit_parameters *parameters);

/* Computes the half-path RMS in metres after the best fit to points [3][n], starting from this pose. root_weight [n]:
 * roots of the weights, or NULL if all are 1. Agrees with the reference to 1e-9 of the RMS (unit/surface/surface).
 * Returns false if the steps do not converge at once, or if they end near what the reference treats as undetermined.
 * *half_path_rms_m has no meaning then. */
bool hf_surface_fit_near(const hf_surface_pose *from, int n, const double *position_m, const double *root_weight,
                         double *half_path_rms_m);
