/* variables - makes the genes that the rows of optimize.variables ask for, in place of the boundary pretensions.
 *
 * A row has a gene for each cable of its set with a free end, or one or three for each support at which these cables
 * end, in the order of cables and nodes. Genes of a row that are linked change by the same step. */
#ifndef HIFDM_VARIABLES_H
#define HIFDM_VARIABLES_H

#include <hifdm/model.h>

/* Replace the genes of a newly built model; without rows nothing changes. surface: of support_normal. Returns HF_OK;
 * HF_BAD_CASE for a set that does not exist or has nothing to vary, for a cable or support that is varied twice, and
 * for what a cable of that law does not have; HF_NO_MEMORY. Links by symmetry are made by hf_symmetry_apply. */
hf_status hf_variables_apply(const hf_scene *scene, const hf_optimize_settings *settings,
                             const hf_surface_settings *surface, hf_model *model, hf_messages *messages);

/* The values of the genes in the shape in which cables have these force densities (N/m), tensions (N) and lengths (m),
 * [n_cable]: of supports 0. */
void hf_variables_read(const hf_model *model, const double *q_N_per_m, const double *tension_N, const double *length_m,
                       double *value);

/* The bounds of gene k around its value `base`, and *reach: how far the first designs spread from it. *fault (unless
 * NULL): NULL, or why there is no value between them. */
void hf_variables_bound(const hf_optimize_settings *settings, const hf_model *model, int i_gene, double base,
                        double *lower, double *upper, double *reach);

#endif
