/* gain - how much of the far field in the direction of the beam is in phase, for a shape of facets, with exact
 * derivatives (METHOD section 13). */
#ifndef HIFDM_GAIN_H
#define HIFDM_GAIN_H

#include <hifdm/pattern.h>

#include "base/arena.h"

enum { HF_GAIN_ORDER_MOST = 16 };

/* What a beam of this order is told of; the end of a sentence. */
#define HF_GAIN_TOO_COARSE "its facets are too coarse for this frequency: the phase across one varies by several turns"

/* One frequency: what does not depend on a shape. */
typedef struct hf_gain_beam {
    hf_feed feed;
    double co[3]; /* polarisation in the direction of feed.beam */
    double wavelength_m;
    int order;                                                 /* points of quadrature along each side of a facet */
    double at[HF_GAIN_ORDER_MOST], weight[HF_GAIN_ORDER_MOST]; /* of their rule */
} hf_gain_beam;

/* surface->has_pattern; facets (there are some) at the theoretical places position_m [n_node][3], from which the order
 * follows: HF_GAIN_ORDER_MOST: they are too coarse for this frequency. */
void hf_gain_beam_make(const hf_surface_settings *surface, const hf_facets *facets, const double *position_m,
                       double frequency_Hz, hf_gain_beam *beam);

/* Loss of gain in the direction of the beam below that of the same current in phase, dB: infinite where all of it is
 * lost, NaN where nothing is lit. */
double hf_gain_loss_dB(const hf_gain_beam *beam, const hf_pattern_surface *surface);

/* ---- a goal ---- */

/* The points of quadrature in flat facets. With a_i the size of the current that each stands for, e_i its phase as a
 * unit number, w_i = a_i/sum a: the residuals sqrt(w_i) (e_i - mean), whose squares have the sum 1 - |mean|^2. */
typedef struct hf_gain {
    const hf_gain_beam *beam;
    int n_node;       /* of the model */
    int n, n_facet;   /* points; facets */
    const int *row;   /* [n_facet][4] of the corners; borrowed */
    double all;       /* sum of sizes */
    double mean[2];   /* of phases, real and imaginary */
    double *size;     /* [n] */
    double *phase;    /* [2][n] */
    double *by_place; /* [6][n] derivatives of phase and size by the place of a point */
    double *by_side;  /* [6][n] of the size by those of the place by u, then v */
    double *rate;     /* [2][n] scratch: of phase and size */
} hf_gain;

int hf_gain_points(const hf_gain_beam *beam, int n_facet); /* each with two residuals */

/* Takes the memory of a gain whose members up to `row` are set. */
void hf_gain_lay_out(hf_arena *arena, hf_gain *gain);

/* residual [2 n] of a shape, position_m [3][n_node] by row; NaN where nothing is lit. */
void hf_gain_measure(hf_gain *gain, const double *position_m, double *residual);

/* Derivatives at the shape that was measured last. */
void hf_gain_linearise(hf_gain *gain, const double *position_m);

/* rate [2 n] of the residuals for a move of all nodes [3][n_node]. */
void hf_gain_push(hf_gain *gain, const double *move, double *rate);

#endif
