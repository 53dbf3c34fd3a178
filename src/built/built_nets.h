/* built_nets - the nets that goals of a design are over, as goals.h wants them: states of the case, then samples of the
 * errors of `tolerance` (METHOD section 7). Samples are the first random ones, also where `tolerance` takes Sobol's
 * sequence, whose directions follow the design: every design is judged by the same numbers.
 *
 * A net is cut for the shape of the design, and found from it: samples eight at a time by built_batch, states one by
 * one. Everything is constant once it is made, and each thread has a room of its own. */
#ifndef HIFDM_BUILT_NETS_H
#define HIFDM_BUILT_NETS_H

#include "built/errors.h"
#include <hifdm/built_batch.h>
#include <hifdm/goals.h>

typedef struct {
    hf_goals_nets as; /* the first member: what goals see */
    const hf_scene *scene;
    const hf_model *model; /* of the design */
    const hf_form_settings *form;
    const hf_states *states;
    const hf_tolerance_settings *tolerance;
    const double *attachment_move_m; /* [n_state][3 n_attachment] how far the truss alone moves them; NULL without */
    hf_built_heat heat;              /* what temperatures of samples do */
    const char *name[HF_STATES_MAX];
} hf_built_nets;

/* All but n_sample is borrowed; `states` and `tolerance` may be NULL where there are none of them. */
void hf_built_nets_make(const hf_scene *scene, const hf_model *model, const hf_form_settings *form,
                        const hf_states *states, const double *attachment_move_m,
                        const hf_tolerance_settings *tolerance, const hf_built_heat *heat, int n_sample,
                        hf_built_nets *nets);

#endif
