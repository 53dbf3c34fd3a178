/* built_nets - the as-built nets of a design over which objectives are taken (METHOD section 7).
 *
 * It implements the interface hf_objectives_nets of objectives.h. The nets are the load cases of the case file,
 * followed by samples of the errors of its section `tolerance`. Samples use random numbers even where `tolerance` uses
 * Sobol's sequence. The directions of that sequence depend on the design, whereas all designs must be judged by the
 * same errors.
 *
 * Each net is cut for the shape of the design and solved from that shape. built_batch solves samples eight at a time;
 * load cases are solved one by one. An hf_built_nets does not change after it is made. Each thread has its own working
 * memory. */
#pragma once

#include "built/loaded.h"
#include <hifdm/objectives.h>

typedef struct {
    hf_objectives_nets as; /* the first member: the interface that objectives.h uses */
    const hf_scene *scene;
    const hf_model *model; /* the model of the design */
    const hf_form_settings *form;
    const hf_load_cases *load_cases;
    const hf_tolerance_settings *tolerance;
    hf_built_rest rest;
    hf_built_heat heat; /* effects of the temperatures of samples */
    const char *name[HF_LOAD_CASES_MAX];
} hf_built_nets;

/* Makes the nets of n_sample samples and of all load cases in `states`. All pointers are borrowed. `states` is NULL
 * without load cases, `tolerance` is NULL without samples. */
void hf_built_nets_make(const hf_scene *scene, const hf_model *model, const hf_form_settings *form,
                        const hf_load_cases *load_cases, const hf_built_rest *rest,
                        const hf_tolerance_settings *tolerance, const hf_built_heat *heat, int n_sample,
                        hf_built_nets *nets);
