/* variables - makes the design variables that the rows of optimize.variables ask for. They replace the boundary
 * pretensions.
 *
 * A row makes one design variable for each cable of its set with a free end. A row that varies supports makes one or
 * three for each support at the ends of these cables, in the order of the cables. Linked design variables of a row
 * change by the same step. */
#pragma once

#include <hifdm/model.h>

/* Replaces the design variables of a newly built model. Without rows nothing changes. `surface` is needed for
 * support_normal. Returns HF_OK or HF_NO_MEMORY. Returns HF_BAD_CASE for a set that does not exist or has nothing to
 * vary, for a cable or support that two rows vary, and for a quantity that the law of a cable lacks. hf_symmetry_apply
 * makes links by symmetry later. */
hf_status hf_variables_apply(const hf_scene *scene, const hf_optimize_settings *settings,
                             const hf_surface_settings *surface, hf_model *model, hf_messages *messages);

/* Writes the values of the design variables into value [n_variable], from force densities (N/m), tensions (N) and
 * lengths (m) of the cables, all [n_cable]. Displacements of supports are 0. */
void hf_variables_read(const hf_model *model, const double *q_N_per_m, const double *tension_N, const double *length_m,
                       double *value);

/* Finds the smallest and the largest factor by which a design scales variables with `link: scale`, from their initial
 * values. Both become NaN without such variables. */
void hf_variables_scales(const hf_model *model, const double *initial, const double *design, double *least,
                         double *most);

/* Writes the bounds of design variable i_variable around its initial value `base`. *reach is the distance from it over
 * which the first designs are spread. */
void hf_variables_bound(const hf_optimize_settings *settings, const hf_model *model, int i_variable, double base,
                        double *lower, double *upper, double *reach);
