/* gain - how much of the far field in the direction of the beam is in phase, for a shape with facets, with exact
 * derivatives (METHOD section 13). */
#pragma once

#include <hifdm/pattern.h>

#include "base/arena.h"

enum { HF_GAIN_ORDER_MOST = 16 };

/* Text for a beam of order HF_GAIN_ORDER_MOST; the end of a sentence. */
#define HF_GAIN_TOO_COARSE "its facets are too coarse for this frequency: the phase across one varies by several turns"

/* Quantities of one frequency that do not depend on the shape. */
typedef struct hf_gain_beam {
    hf_feed feed;
    hf_polarisation polarisation; /* of the feed on its axis */
    double co[3];                 /* in the direction feed.beam */
    double wavelength_m;
    int order;                                                 /* quadrature points along each side of a facet */
    double at[HF_GAIN_ORDER_MOST], weight[HF_GAIN_ORDER_MOST]; /* [order], the rule */
} hf_gain_beam;

/* Computes a beam for facets at the target positions, position_m [n_node][3]. surface->has_pattern must be true, and
 * there must be a facet. If the order is HF_GAIN_ORDER_MOST, the facets are too coarse for this frequency. */
void hf_gain_beam_make(const hf_surface_settings *surface, const hf_facets *facets, const double *position_m,
                       double frequency_Hz, hf_gain_beam *beam);

/* Computes the polarisation in a direction by Ludwig's third definition. */
void hf_gain_polarisation(hf_polarisation polarisation, const double direction[3], double co[3]);

/* Returns the loss of gain in the direction of the beam relative to the same current in phase, dB. It is infinite if
 * all gain is lost, and NaN if no facet is illuminated. */
double hf_gain_loss_dB(const hf_gain_beam *beam, const hf_pattern_surface *surface);

/* ---- an objective ---- */

/* The arrays of hf_gain for n points. */
#define HF_GAIN_FIELDS(X)                                                                                              \
    X(double, size, n, "current")                                                                                      \
    X(double, phase, 2 * n, "[2][n], phase, real and imaginary")                                                       \
    X(double, by_place, 6 * n, "[6][n], derivatives of phase, then current, by the point")                             \
    X(double, by_side, 6 * n, "[6][n], derivatives of the current by du, then dv, of the point")                       \
    X(double, rate, 2 * n, "[2][n], scratch: rates of phase and current")

/* Quadrature points in flat facets. Let a_i be the current of a point, e_i its phase as a complex unit number, and w_i
 * = a_i / sum a. The residuals are sqrt(w_i) (e_i - mean). The sum of their squares is 1 - |mean|^2. */
typedef struct hf_gain {
    const hf_gain_beam *beam;
    int n_node;     /* nodes of the model */
    int n, n_facet; /* points; facets */
    const int *row; /* [n_facet][4], rows of the corners; borrowed */
    double all;     /* sum of all currents */
    double mean[2]; /* mean phase, real and imaginary */
    HF_GAIN_FIELDS(HF_ARENA_MEMBER)
} hf_gain;

int hf_gain_points(const hf_gain_beam *beam, int n_facet); /* number of points; each has two residuals */

/* Takes the arrays of a gain from an arena. The members up to `row` must be set. */
void hf_gain_lay_out(hf_arena *arena, hf_gain *gain);

/* Computes residual [2 n] of a shape, position_m [3][n_node] by row. They are NaN if no facet is illuminated. */
void hf_gain_measure(hf_gain *gain, const double *position_m, double *residual);

/* Computes the derivatives at the shape measured last. */
void hf_gain_linearise(hf_gain *gain, const double *position_m);

/* Computes rate [2 n], the rates of the residuals for a motion `move` [3][n_node] of the nodes. */
void hf_gain_push(hf_gain *gain, const double *move, double *rate);
