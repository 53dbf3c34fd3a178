/* requirements_stage - measures the figures that `requirements` bound during a run, and gives the verdicts at its
 * end. */
#pragma once

#include "built/required.h"
#include "built/statistics.h"
#include "store/ledger.h"
#include <hifdm/problem.h>
#include <hifdm/summary.h>

/* All members are zero for a case without `requirements`. */
typedef struct {
    hf_required required;
    hf_material material;         /* mass of the cables, if a row needs it */
    double *value, *item, *error; /* [n_state][n_column] of the design; NaN where nothing was measured */
    void *block;
} hf_requirements_stage;

/* Refuses rows whose figure or set this net does not have. The problem needs a scene, and for figures of a surface the
 * surface with its facets. `material` is that of its cables; NULL: not known. Returns HF_OK, HF_BAD_CASE or
 * HF_NO_MEMORY, with a message for each fault. */
hf_status hf_requirements_stage_check(const hf_problem *problem, const hf_material *material, hf_messages *messages);

/* Prepares the rows of a problem, which have been checked. `masses` receives the mass of the cables, if a row needs it.
 * Returns HF_OK, HF_NO_MEMORY or HF_BAD_CASE, with a message. The caller frees both in any case. */
hf_status hf_requirements_stage_rows(const hf_problem *problem, hf_material *masses, hf_required *required,
                                     hf_messages *messages);

/* Prepares the measurement of these rows. Returns HF_OK, HF_NO_MEMORY or HF_BAD_CASE, with a message. The problem
 * is borrowed. */
hf_status hf_requirements_stage_open(const hf_problem *problem, hf_requirements_stage *stage, hf_messages *messages);
void hf_requirements_stage_free(hf_requirements_stage *stage);

/* Measures the design in a load case: its shape in the workspace of the model, the errors of its surface, and the bound
 * on its position errors, m (NaN: not known). Returns HF_OK or HF_NO_MEMORY, with a message. */
hf_status hf_requirements_stage_take(hf_requirements_stage *stage, int state, const hf_model *model,
                                     const hf_workspace *workspace, const hf_form_result *result,
                                     const hf_surface_measures *surface, hf_messages *messages);

/* Forgets what was measured, before another design is. */
void hf_requirements_stage_forget(hf_requirements_stage *stage);

/* Sets verdict [n] to no verdict. */
void hf_requirements_stage_clear(const hf_requirements_stage *stage, hf_requirement_verdict *verdict);

/* Gives the verdicts on the rows without a share for the design measured last. verdict [n]: other rows are not
 * changed. */
void hf_requirements_stage_judge_design(const hf_requirements_stage *stage, hf_requirement_verdict *verdict);

/* Gives the verdicts on the rows with a share. Returns the status of hf_statistics_judge. */
hf_status hf_requirements_stage_judge_samples(const hf_requirements_stage *stage, const hf_montecarlo *montecarlo,
                                              const hf_statistics_rows *rows, hf_summary *summary,
                                              hf_messages *messages);

/* Warns about bounds that are probably in another unit than their figure, once for all points that are done. The value
 * of a warning is the one nearest to the bound. */
void hf_requirements_stage_doubt_points(const hf_points *points, hf_messages *messages);
