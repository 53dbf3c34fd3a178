/* load_case_stage - the load cases of the as-built net that a case describes, once its design is known. */
#pragma once

#include "run/requirements_stage.h"
#include <hifdm/built.h>
#include <hifdm/problem.h>

/* The as-built net of a design, and memory for its load cases. All members are zero before a design is taken, and for a
 * case without load cases. It must not be moved in memory. */
typedef struct {
    hf_built built;
    hf_workspace workspace;
    double *cut_m, *move_m, *load_N; /* of one load case, as for hf_built_load_case */
    double *attachment_move_m;       /* [3 n_attachment] m, by the truss alone */
    double *truss_force;             /* [n_truss_node][6] N, N m */
    void *block;
} hf_load_case_stage;

/* Makes the as-built net of the design whose shape `workspace` holds, and replaces an earlier one. Returns HF_OK;
 * HF_BAD_CASE for a design that cannot be made; HF_NO_MEMORY; both with a message. */
hf_status hf_load_case_stage_take(const hf_problem *problem, const hf_workspace *workspace, hf_load_case_stage *cases,
                                  hf_messages *messages);

/* Sets move_m [n_load_case][3 n_attachment] to the displacements of the attachments in each load case by the truss
 * without the net, m. by_weight_m receives the part of them that its weight causes; it may be NULL. Returns HF_OK or
 * HF_NO_MEMORY. */
hf_status hf_load_case_stage_rest(const hf_problem *problem, double *move_m, double *by_weight_m);

/* Sets move_m_per_K [n_truss][3 n_attachment] to the same displacements for each row of tolerance.truss, caused by a
 * rise of its part by 1 K, m/K. Returns HF_OK or HF_NO_MEMORY. */
hf_status hf_load_case_stage_rest_by_heat(const hf_problem *problem, double *move_m_per_K);

/* Sets *all_s to the estimated processor time of all load cases at this shape, s. Further load cases are tried as long
 * as earlier ones took less than most_s. Returns HF_OK or the status that prevents load cases, without a message. */
hf_status hf_load_case_stage_try(const hf_problem *problem, const hf_workspace *shape, double most_s, double *all_s);

/* Measures what rows of `requirements` without a share need of the load cases, for the design whose shape `shape`
 * holds. A load case without a shape has no values. Returns HF_OK, HF_BAD_CASE for a design that cannot be made, or
 * HF_NO_MEMORY, with a message. */
hf_status hf_load_case_stage_measure(const hf_problem *problem, const hf_workspace *shape,
                                     hf_requirements_stage *requirements, hf_messages *messages);

void hf_load_case_stage_free(hf_load_case_stage *cases);
