/* surface - the errors of a shape as a reflector surface (METHOD section 9).
 * Stability: stable.
 *
 * The measures are the RMS errors along the normal and of the half path length, before and after a best fit. The
 * measures also include the gain loss, the faceting error and percentiles. The fitted surface has the same kind as the
 * target surface. If the case has a `surface` section, hifdm measures each reported shape once. Pipeline:
 *
 *   inner nodes of a shape -> errors (M16) -> RMS, percentiles -> best fit -> RMS -> gain loss (M17)
 *   facets of the shape    -> errors (M16) -> RMS              -> best fit -> RMS -> gain loss (M17)
 *
 * The target surface is the cylinder z = x^2/(4f), with its generatrix along y, or the paraboloid z = (x^2 + y^2)/(4f).
 * Let dz be the height of a point above the target surface. Let t be the slope x/(2f) or r/(2f) at this point. The
 * error along the normal is dz / sqrt(1 + t^2). The error of the half path length is dz / (1 + t^2). */
#pragma once

#include <hifdm/api.h>
#include <hifdm/facets.h>
#include <hifdm/model.h>

HF_API_BEGIN

/* ---- The lists: rows as in HF_RESULT_LIST, without .individual, .key and .units ----
 *
 *   kind    type of the stored value; TRUTH is a bool that is stored as a number
 *   .json   place in the JSON object `surface` of a stage, where the figures of the fit have the prefix fit_; equal
 *           places keep the order of the list, with figures before the fit first; omitted: not in JSON
 *
 * The HDF5 attributes in /surface/STAGE have the order of the lists. The attributes of the fit have the prefix fit_. To
 * add a quantity, add a row to one of these lists and the code that computes the quantity. */
#define HF_SURFACE_LIST(X)                                                                                             \
    X(double, z_rms_m, REAL, .json = 1, .description = "RMS height of the nodes above their target positions")         \
    X(double, normal_rms_m, REAL, .json = 1, .description = "RMS error along the normal at the inner nodes, raw")      \
    X(double, half_path_rms_m, REAL, .json = 1,                                                                        \
      .description = "RMS error of the half path length at the inner nodes, raw")                                      \
    X(double, faceting_rms_m, REAL, .json = 4,                                                                         \
      .description = "error of flat strips of width w, w^2/(24 sqrt(5) f); NaN without a width")                       \
    X(double, deviation_p50_m, REAL, .json = 4,                                                                        \
      .description = "of the distances in psi, as the next four: half of them are not above it")                       \
    X(double, deviation_p90_m, REAL, .json = 4, .description = "90 % of these distances are not above it")             \
    X(double, deviation_p95_m, REAL, .json = 4, .description = "95 % of these distances are not above it")             \
    X(double, deviation_p99_m, REAL, .json = 4, .description = "99 % of these distances are not above it")             \
    X(double, deviation_max_m, REAL, .json = 4, .description = "largest of these distances")                           \
    X(double, facet_half_path_rms_m, REAL, .json = 7,                                                                  \
      .description = "RMS over the facets, by projected area; NaN without facets")                                     \
    X(double, facet_normal_rms_m, REAL, .json = 7, .description = "RMS over the facets along the normal")              \
    X(double, facet_fit_half_path_rms_m, REAL, .json = 7,                                                              \
      .description = "RMS over the facets after the best fit to them")                                                 \
    X(double, facet_fit_normal_rms_m, REAL, .json = 7,                                                                 \
      .description = "RMS over the facets along the normal after that fit")                                            \
    X(double, facet_fit_focal_length_m, REAL, .json = 7, .description = "focal length of that best fit")               \
    X(double, facet_area_m2, REAL, .json = 7, .description = "of the facets, projected along z")                       \
    X(double, refocused_half_path_rms_m, REAL, .json = 7,                                                              \
      .description = "of the facets about their mean, by illumination, after the best fit with these weights")         \
    X(double, fixed_half_path_rms_m, REAL, .json = 7,                                                                  \
      .description = "of the facets about their mean, by illumination; NaN without facets")                            \
    X(double, pillow_rms_m, REAL, .json = 7,                                                                           \
      .description = "of how far the mesh is from flat facets; NaN without a mesh tension")                            \
    X(double, mesh_pull_ratio, REAL, .json = 7,                                                                        \
      .description = "largest N l / T of cables between facets; above 1 facets have no errors")                        \
    X(int, n_facet, INT, .json = 7, .description = "triangles and quadrilaterals of the net, seen along z")            \
    X(int, n_open_face, INT, .json = 7, .description = "faces left out: of more than four sides, or not convex")       \
    X(double, ruze_limit_Hz, REAL, .json = 6,                                                                          \
      .description = "above it Ruze's formula does not hold: gain_loss_dB is NaN; INFINITY: no error")                 \
    X(double, facet_ruze_limit_Hz, REAL, .json = 8,                                                                    \
      .description = "above it facet_gain_loss_dB is NaN; NaN without facets")                                         \
    X(double, facet_fit_ruze_limit_Hz, REAL, .json = 8, .description = "above it facet_fit_gain_loss_dB is NaN")

#define HF_SURFACE_FIT_LIST(X)                                                                                         \
    X(double, half_path_rms_m, REAL, .json = 3, .description = "RMS of the nodes' errors against the fitted surface")  \
    X(double, normal_rms_m, REAL, .json = 2,                                                                           \
      .description = "RMS of the nodes' errors along the normal of the fitted surface")                                \
    X(double, focal_length_m, REAL, .json = 3, .description = "of the fitted surface")                                 \
    X(double, shift_x_m, REAL, .json = 3, .description = "shift of the fitted surface along x")                        \
    X(double, shift_y_m, REAL, .json = 3, .description = "shift of the fitted surface along y; 0 of a cylinder")       \
    X(double, shift_z_m, REAL, .json = 3, .description = "shift of the fitted surface along z")                        \
    X(double, rotation_x_rad, REAL, .json = 3, .description = "turn of the fitted surface about x")                    \
    X(double, rotation_y_rad, REAL, .json = 3, .description = "turn of the fitted surface about y")                    \
    X(double, rotation_z_rad, REAL, .json = 3, .description = "turn of the fitted surface about z; 0 of a paraboloid") \
    X(double, ruze_limit_Hz, REAL, .json = 6,                                                                          \
      .description = "of hf_surface_measure: above it fit_gain_loss_dB is NaN")                                        \
    X(double, center_x_m, REAL, .description = "of the nodes")                                                         \
    X(double, center_y_m, REAL, .description = "of the nodes")                                                         \
    X(double, center_z_m, REAL, .description = "of the nodes")                                                         \
    X(int, iterations, INT, .description = "of the last fit")                                                          \
    X(bool, converged, TRUTH, .json = 5, .description = "false: all but the centre and iterations is NaN")

/* Each row X(member, unit, description) defines a list by frequency. The gain losses of the nodes and of the facets by
 * Ruze's formula (M17) come first. Then follow the figures by physical optics over the facets (METHOD section 13), with
 * a refocused feed and with a fixed feed. The lists are lists in JSON and data sets in HDF5. Lists that a file of an
 * earlier version does not contain are NaN. */
#define HF_SURFACE_LOSS_LIST(X)                                                                                        \
    X(gain_loss_dB, "dB",                                                                                              \
      "loss of gain (Ruze) of the nodes by frequency; NaN beyond 3 dB, where the formula does not hold")               \
    X(fit_gain_loss_dB, "dB", "the same after the best fit")                                                           \
    X(facet_gain_loss_dB, "dB", "of the facets; NaN without facets")                                                   \
    X(facet_fit_gain_loss_dB, "dB", "of the facets after their best fit")                                              \
    X(refocused_gain_dBi, "dBi", "gain by physical optics with a refocused feed, in the direction of its beam")        \
    X(refocused_gain_loss_dB, "dB", "the same, below that of the smooth target surface")                               \
    X(refocused_ruze_loss_dB, "dB", "by Ruze's formula from refocused_half_path_rms_m; NaN beyond 3 dB")               \
    X(fixed_gain_dBi, "dBi", "gain by physical optics with a fixed feed, in the direction of its beam")                \
    X(fixed_gain_loss_dB, "dB", "the same, below that of the smooth target surface")                                   \
    X(fixed_ruze_loss_dB, "dB", "by Ruze's formula from fixed_half_path_rms_m; NaN beyond 3 dB")                       \
    X(pointing_deg, "deg", "from the beam of the fixed feed to the maximum of the main beam; NaN without a main beam")

#define HF_SURFACE_MEMBER(type, member, ...) type member;

/* Describes the best fit of a surface to a set of points. The fitted surface is the surface of the target kind with the
 * minimum half-path RMS (METHOD section 9). The focal length of the fitted surface may differ from the focal length of
 * the target surface. The fit also rotates the surface about the centre of the points by Rx(a) Ry(b) Rz(c) and then
 * shifts the surface. The fit omits motions that do not change the surface. Therefore, the fit omits the shift of a
 * cylinder along y and the rotation Rz of a paraboloid. In a shallow reflector, a lateral shift and a rotation are
 * nearly the same motion. The lateral shift and the rotation are therefore uncertain, but the fitted surface is not.
 *
 * Parameters that the points do not determine keep the values of the target surface. If the minimum is not found, the
 * shift shift_x_m is 0. The shift shift_x_m is also 0 if the minimum needs a shift of more than a tenth of the
 * half-width of the net. For a paraboloid, the rules for shift_x_m also apply to shift_y_m. If the minimum is not
 * found, the focal length focal_length_m is the focal length of the target surface. If the focal length of the minimum
 * differs from its target by more than a factor of 2, the fit uses the target focal length. Points on two lines along
 * y, for example, do not determine the focal length. */
typedef struct {
    HF_SURFACE_FIT_LIST(HF_SURFACE_MEMBER)
} hf_surface_fit;

/* Fits a surface to n points with the positions position_m [3][n] in m. The weight of a point is the square of its
 * entry in root_weight [n]. If root_weight is NULL, all weights are equal. The argument `kind` must not be
 * HF_SURFACE_AUTO. The argument focal_length_m is the focal length of the target surface in m. If there are fewer than
 * six points, the fit is not unique. Call gsl_set_error_handler_off() before this function (see hifdm.h). Returns HF_OK
 * or HF_NO_MEMORY. If the fit does not converge, the status is HF_OK and fit->converged is false. */
hf_status hf_surface_fit_points(hf_surface_kind kind, double focal_length_m, int n, const double *position_m,
                                const double *root_weight, hf_surface_fit *fit);

/* Computes the errors of the n points position_m [3][n] along the normal of a fitted surface of this kind. The array
 * error_m [n] receives the errors in m. If the fit did not converge, the errors are NaN. */
void hf_surface_fit_errors(hf_surface_kind kind, const hf_surface_fit *fit, int n, const double *position_m,
                           double *error_m);

/* Contains the surface errors of a shape and its losses as a reflector. */
typedef struct {
    bool is_measured; /* false: the other members have no meaning */
    HF_SURFACE_LIST(HF_SURFACE_MEMBER)
    /* Contains the best fit to the inner nodes. */
    hf_surface_fit fit;
#define HF_SURFACE_LOSS_MEMBER(member, unit, description) double member[HF_LIST_MAX];
    HF_SURFACE_LOSS_LIST(HF_SURFACE_LOSS_MEMBER)
} hf_surface_measures;

/* Measures the inner nodes of a shape and the facets between them. The array position_m [3][n_node] contains the
 * positions in m, and the array tension_N [n_cable] contains the tensions in N. The focal length
 * settings->focal_length_m must be above 0. The kind settings->kind must not be HF_SURFACE_AUTO. The facets must belong
 * to the scene of the model. Call gsl_set_error_handler_off() before this function (see hifdm.h). Returns HF_OK, or
 * HF_NO_MEMORY with all values set to zero. */
hf_status hf_surface_measure(const hf_surface_settings *settings, const hf_facets *facets, const hf_model *model,
                             const double *position_m, const double *tension_N, hf_surface_measures *measures);

/* Sets all values except the counts to NaN. Call this function if all inner nodes of a net are loose, because the
 * positions of loose nodes have no meaning. */
void hf_surface_blank(hf_surface_measures *measures);

/* Contains the errors by which hifdm judges a shape. The errors belong to the facets or to the nodes of the shape,
 * before and after the best fit. The pointers to the gain losses refer to the arrays of hf_surface_measures. */
typedef struct {
    double half_path_rms_m, fit_half_path_rms_m;   /* RMS of the half-path error, before and after the best fit */
    const double *gain_loss_dB, *fit_gain_loss_dB; /* [frequencies_Hz.n] gain losses that these errors cause */
} hf_surface_errors;

/* Returns the errors of the facets or, if of_facets is false, of the nodes. */
hf_surface_errors hf_surface_errors_of(const hf_surface_measures *measures, bool of_facets);

/* Defines the gain loss in dB at the maximum frequency of a reflector. */
#define HF_SURFACE_GOOD_TO_DB 1.0

/* Ruze's formula holds for gain losses up to HF_RUZE_MOST_DB. Ruze's formula requires errors that are small compared
 * with the wavelength. The gain loss HF_RUZE_MOST_DB corresponds to an RMS error of lambda/15 for the wavelength
 * lambda. */
#define HF_RUZE_MOST_DB 3.0

/* Returns the maximum of the frequencies frequencies_Hz in Hz, or 0 if no frequency is given. */
double hf_surface_highest_Hz(const hf_surface_settings *settings);

/* Returns the positive gain loss in dB that a half-path RMS causes at a frequency, by Ruze's formula (M17). Returns NaN
 * above HF_RUZE_MOST_DB. */
double hf_surface_gain_loss_dB(double half_path_rms_m, double frequency_Hz);

/* Returns the gain loss in dB by Ruze's formula (M17) for errors of any size. */
double hf_surface_ruze_dB(double half_path_rms_m, double frequency_Hz);

/* Returns the frequency in Hz at which a half-path RMS causes the gain loss loss_dB. The gain loss must be above 0 and
 * at most HF_RUZE_MOST_DB. If the RMS error is 0, the function returns INFINITY. */
double hf_surface_frequency_of_loss_Hz(double half_path_rms_m, double loss_dB);

HF_API_END
