/* tolerance_stage - the last stage of a run whose case has a section `tolerance`: samples of the as-built net at the
 * shape of the result. */
#pragma once

#include <hifdm/problem.h>
#include <hifdm/run.h>

/* Returns true if the request is one task of several. Such a task finds samples and writes no result. */
static inline bool hf_tolerance_stage_is_task(const hf_run_request *request)
{
    return request->part.tasks > 0 && request->part.task >= 0;
}

/* Removes the journals next to a finished result, which are not needed any more. */
void hf_tolerance_stage_end(const hf_run_request *request, const char *output);

/* Refuses a case for which hf_stage_samples would fail before it solves anything: cables without EA or expansion,
 * struts, errors that may leave nothing of a cable. The case has a section `tolerance`, and `material` is that of the
 * cables. Returns HF_OK or HF_BAD_CASE. */
hf_status hf_tolerance_stage_check(const hf_problem *problem, const hf_material *material, hf_messages *messages);

/* Returns HF_EXISTS if a journal next to the output has samples of another case and the request does not restart;
 * HF_NO_MEMORY; else HF_OK. */
hf_status hf_tolerance_stage_look(const hf_run_request *request, const hf_problem *problem, const char *output,
                                  hf_messages *messages);

/* Estimated processor time of the samples of a run, s. begin_s is the time until the first sample, mostly for the first
 * order. sample_s is that of one sample in the nominal load case and in the n_load_case others that `requirements`
 * need, from n_tried samples in one thread. n_tried is 0 if counted operations predict a begin_s above most_s; begin_s
 * is then that prediction. The search for the scale (tolerance.find_scale) takes up to scale_yields yields of
 * scale_samples nets, at scale_sample_s each. Most yields end early: scale_s is the time of the search, extrapolated
 * from one with few nets, or 0 if that would not fit into half of most_s. */
typedef struct {
    double begin_s, sample_s, scale_sample_s, scale_s;
    int n_load_case, scale_yields, scale_samples, n_tried;
} hf_tolerance_trial;
/* Sets *trial for this shape. No more samples are started than earlier ones predict to end within most_s, s. Returns
 * HF_OK, or the status that prevents samples, without a message. */
hf_status hf_tolerance_stage_try(const hf_problem *problem, const hf_workspace *shape, double most_s,
                                 hf_tolerance_trial *trial);
