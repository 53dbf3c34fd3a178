/* antenna - the figures of a shape as a reflector antenna, by physical optics over its facets (METHOD section 13).
 *
 * Two feeds illuminate each shape. The fixed feed is that of the target surface. The refocused feed is the fixed feed,
 * moved rigidly with the best-fit surface of the shape, and along the axis of this surface by the change of the focal
 * length. It is aimed at the same part of the reflector. This matters where a shift and a turn of the fit nearly
 * cancel, so that errors of the shape decide how far the fit goes along both. The best fit weights the points by their
 * illumination. */
#pragma once

#include "surface/gain.h"
#include "surface/surface_near.h"

/* What figures need besides the shape, at one frequency. Threads share it. */
typedef struct {
    hf_gain_beam beam; /* the fixed feed and the quadrature */
    const hf_facets *facets;
    hf_surface_kind kind;
    double focal_length_m; /* of the target surface */
    bool is_too_coarse;    /* true: HF_GAIN_TOO_COARSE, so all figures are NaN */
    int n_point;           /* quadrature points of all facets */
    double *root_weight;   /* [n_point] root of the current of each point at the target positions */
    double middle_m[3];    /* weighted mean of the points of the target surface */
    double smooth_dBi;     /* gain of the target surface over the same area, with the fixed feed */
    hf_surface_pose start; /* best fit from which those of similar shapes start */
    void *block;           /* owned memory behind the array */
} hf_antenna;

/* Figures of a shape with one feed, in the direction of the beam of this feed. NaN: there is none. */
typedef struct {
    double gain_dBi;     /* in the polarisation of the feed, relative to an isotropic radiator */
    double gain_loss_dB; /* relative to the smooth target surface with the same feed; 0 if the shape is this surface */
    double half_path_rms_m; /* of the half-path errors about their mean, weighted by the illumination */
    double ruze_loss_dB;    /* loss by Ruze's formula from half_path_rms_m; NaN above HF_RUZE_MOST_DB */
} hf_antenna_feed;

/* Figures of a shape. */
typedef struct {
    hf_antenna_feed refocused; /* NaN if the best fit does not converge */
    hf_antenna_feed fixed;
    /* Angle between the maximum of the main beam with the fixed feed and the beam of the feed. NaN if no direction has
     * half of the power density of the same currents in phase, so that the main beam is not certain. */
    double pointing_deg;
} hf_antenna_figures;

/* Prepares the figures of shapes of a net. position_m [n_node][3]: target positions. The antenna borrows the facets,
 * which must not be empty. The section surface.pattern is not needed; without it, the feed is the default. Call
 * gsl_set_error_handler_off() before this function. Returns HF_OK or HF_NO_MEMORY. Free the antenna in every case. */
hf_status hf_antenna_make(const hf_surface_settings *surface, const hf_facets *facets, const double *position_m,
                          double frequency_Hz, hf_antenna *antenna);
void hf_antenna_free(hf_antenna *antenna);

/* Makes an antenna whose best fits start from that of another shape, to which later shapes are similar. It borrows the
 * arrays of the first antenna; do not free it. scratch [hf_antenna_scratch]. Returns HF_OK or HF_NO_MEMORY. */
hf_status hf_antenna_near(const hf_antenna *antenna, const hf_pattern_surface *design, double *scratch,
                          hf_antenna *near);

/* Returns the number of doubles of scratch memory, aligned to HF_ALIGNMENT, that hf_antenna_measure needs. */
size_t hf_antenna_scratch(const hf_antenna *antenna);

/* The groups of figures. */
enum { HF_ANTENNA_REFOCUSED = 1, HF_ANTENNA_FIXED = 2, HF_ANTENNA_POINTING = 4, HF_ANTENNA_ALL = 7 };

/* Computes the groups `what` of the figures of a shape with the facets of the antenna; the others are NaN. If a cable
 * cannot hold the pull of the mesh, there is no shape; do not call this function then. scratch [hf_antenna_scratch].
 * Returns HF_OK or HF_NO_MEMORY. Allocates memory only if the best fit is not near that of the design. */
hf_status hf_antenna_measure(const hf_antenna *antenna, unsigned what, const hf_pattern_surface *shape, double *scratch,
                             hf_antenna_figures *figures);

/* Computes a bound of the change of the groups `what` of the figures of a shape, to first order, if each node moves by
 * at most position_error_m. A figure that is NaN has a bound that is NaN. The bounds of the refocused feed are also NaN
 * if the points do not determine all parameters of the best fit. The sags of a mesh count as constant. Returns HF_OK or
 * HF_NO_MEMORY. Takes about a hundred times as long as hf_antenna_measure. */
hf_status hf_antenna_bound(const hf_antenna *antenna, unsigned what, const hf_pattern_surface *shape,
                           double position_error_m, hf_antenna_figures *bound);

/* Computes the derivatives of one figure by the positions of the nodes, gradient [n_node][3]: of the gain with one of
 * the feeds, or of the pointing. The best fit and the feed follow the nodes; the sags of a mesh count as constant.
 * *exists is false if there is no figure, or if the points do not determine the best fit. Returns HF_OK or
 * HF_NO_MEMORY. */
hf_status hf_antenna_gradient(const hf_antenna *antenna, unsigned group, const hf_pattern_surface *shape, int n_node,
                              double *gradient, bool *exists);

/* ---- the steps of a measurement ---- */

/* Quadrature points of a shape, with the currents that a feed causes. The arrays are scratch memory. */
typedef struct {
    double *x;       /* [6][n_point] position, then the vector of area */
    double *current; /* [3][n_point] current times area */
    double *path_m;  /* [n_point] path from the feed */
    double field[2]; /* sum of the currents along the polarisation in the direction of the beam, real and imaginary */
    double in_phase; /* sum of the sizes of these currents */
} hf_antenna_points;

/* Computes the points of a shape, without currents. */
hf_antenna_points hf_antenna_points_of(const hf_antenna *antenna, const hf_pattern_surface *shape, double *scratch);

/* Computes the currents of the points and their sums. */
void hf_antenna_light(const hf_antenna *antenna, const hf_feed *feed, hf_antenna_points *points);

/* Computes the vector from the refocused feed, which is longer_m further along z than the fixed feed, to the point at
 * which it is aimed. x [3][n_point]: points in the frame of the best fit. */
void hf_antenna_aim_vector(const hf_antenna *antenna, const double *x, double longer_m, const double *beside_m,
                           double vector_m[3]);

/* Turns the points into the frame of a best fit and illuminates them with the refocused feed, in this frame. Returns
 * the gain, dBi. beside_m [3], or NULL: the feed is aimed beside its aim by this vector. */
double hf_antenna_refocused_dBi(const hf_antenna *antenna, const hf_surface_pose *pose, const double *beside_m,
                                hf_antenna_points *points, hf_feed *feed);

/* Finds the weighted best fit to points x [3][n_point]. Returns HF_OK or HF_NO_MEMORY. */
hf_status hf_antenna_fit(const hf_antenna *antenna, const double *x, hf_surface_pose *pose, bool *is_found);

/* The field F in a direction, with its derivatives for turns about it. */
typedef struct {
    double e[2][3];           /* unit vectors across the direction */
    double size, phase[2];    /* |F|, and F / |F| relative to the centre of the start of the best fits */
    double slope[2], bend[3]; /* derivatives of ln |F|^2 by turns along e: first; second 00, 01, 11 */
    double middle[2];         /* phase centre, the derivatives of the phase of F by these turns */
} hf_antenna_view;

/* Computes the field in a direction. */
void hf_antenna_look(const hf_antenna *antenna, const hf_antenna_points *points, const double direction[3],
                     hf_antenna_view *view);

/* Turns `direction`, first the beam of the feed, to the maximum of the main beam, where it looks. Returns false if
 * there is no main beam. */
bool hf_antenna_aim(const hf_antenna *antenna, const hf_antenna_points *points, double direction[3],
                    hf_antenna_view *view);

void hf_antenna_blank(hf_antenna_figures *figures); /* sets all figures to NaN */
