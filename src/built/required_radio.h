/* required_radio - the figures at a frequency that rows of `requirements` bound: gain, its loss, pointing.
 *
 *     rows -> frequencies -> antennas (hf_required_radio_make)
 *       -> antennas whose best fits start from the design (hf_required_radio_near)
 *       -> figures of a shape, each group once for all rows */
#pragma once

#include "built/required.h"

/* Makes the antennas of the rows. position_m [n_node][3]: target positions. The facets are borrowed. Returns HF_OK or
 * HF_NO_MEMORY. */
hf_status hf_required_radio_make(hf_required *required, const hf_surface_settings *surface, const hf_facets *facets,
                                 const double *position_m);

/* A shape by row: position_m [3][n_node], tension_N [n_cable]. */
typedef struct {
    const hf_model *model;
    const double *position_m, *tension_N;
} hf_required_net;

/* Makes near [n_antenna] for shapes that are similar to this one. They borrow from the rows. Returns HF_OK or
 * HF_NO_MEMORY. */
hf_status hf_required_radio_near(const hf_required *required, const hf_required_net *net, hf_antenna *near);

/* Returns the group of figures of antenna.h to which a column belongs. */
unsigned hf_required_radio_group(const hf_required_column *column);

/* Writes what [n_antenna], the groups of figures that load case `state` of the samples (is_many) or of the design
 * needs. Returns true if there is one. */
bool hf_required_radio_what(const hf_required *required, bool is_many, int state, unsigned *what);

/* Computes the groups what [n_antenna] of figures of a shape, to [n_antenna]; the others do not change. Figures that do
 * not exist are NaN. near [n_antenna]: antennas to use. Returns HF_OK or HF_NO_MEMORY. */
hf_status hf_required_radio_measure(const hf_required *required, const hf_antenna *near, const unsigned *what,
                                    const hf_required_net *net, hf_antenna_figures *to);

/* Computes bounds of the changes of these figures if no node moves by more than bound_m (hf_antenna_bound). */
hf_status hf_required_radio_bound(const hf_required *required, const unsigned *what, const hf_required_net *net,
                                  double bound_m, hf_antenna_figures *to);

/* Returns the figure of a column, or the bound of its change, from figures [n_antenna]. */
double hf_required_radio_of(const hf_required_column *column, const hf_antenna_figures *figures);

/* Computes the derivatives of the figure of a column by the positions, gradient [n_node][3] in the order of the scene.
 * *exists: hf_antenna_gradient. Returns HF_OK or HF_NO_MEMORY. */
hf_status hf_required_radio_gradient(const hf_required *required, const hf_required_column *column,
                                     const hf_antenna *near, const hf_required_net *net, double *gradient,
                                     bool *exists);
