/* tolerance_stage - the last stage of a run whose case has a section `tolerance`: samples of the net as built at the
 * shape of the result. */
#ifndef HIFDM_TOLERANCE_STAGE_H
#define HIFDM_TOLERANCE_STAGE_H

#include <hifdm/problem.h>
#include <hifdm/run.h>

/* What is borrowed of a run. */
typedef struct {
    const hf_run_request *request;
    const hf_problem *problem;
    const hf_workspace *shape; /* of the result, an equilibrium of problem->model */
    const char *output;        /* the result file, beside which journals are; "": there is none */
    hf_store *store;           /* NULL: none is written */
} hf_tolerance_stage;

/* One task of several finds samples and writes no result. */
static inline bool hf_tolerance_stage_is_task(const hf_run_request *request)
{
    return request->tasks > 0 && request->task >= 0;
}

/* Remove what is left beside a finished result: nobody needs its journals any more. */
void hf_tolerance_stage_end(const hf_run_request *request, const char *output);

/* Fails where hf_tolerance_stage_run would before it solves anything: cables without EA or expansion, struts,
 * errors that may leave nothing of a cable, measures that the net does not have. HF_OK, also without a section
 * `tolerance` unless it is demanded: then HF_BAD_USAGE. HF_BAD_CASE. */
hf_status hf_tolerance_stage_check(const hf_problem *problem, bool is_demanded, hf_messages *messages);

/* HF_EXISTS when a journal beside the output has samples of another case, and the request does not begin anew.
 * HF_NO_MEMORY. */
hf_status hf_tolerance_stage_look(const hf_run_request *request, const hf_problem *problem, const char *output,
                                  hf_messages *messages);

/* What the samples of a run would take, by the first n_tried of them at this shape in one thread: processor time until
 * the first one, mostly for first order, and for one. No more are begun than those before foretell to end within
 * most_s. n_tried is 0 where counted operations foretell more than that until the first one, which is then in begin_s.
 * tolerance.yield takes up to scale_yields yields of scale_samples nets more, of scale_sample_s each at these errors,
 * most of them ended early: scale_s in all, by a search with a few nets where that fits into half of most_s; else 0.
 * HF_OK, or why there are no samples, without a message. */
typedef struct {
    double begin_s, sample_s, scale_sample_s, scale_s;
    int scale_yields, scale_samples, n_tried;
} hf_tolerance_trial;
hf_status hf_tolerance_stage_try(const hf_problem *problem, const hf_workspace *shape, double most_s,
                                 hf_tolerance_trial *trial);

/* Find all samples, or those of request->task, and sum them up into the summary. HF_OK; HF_INTERRUPTED: the same
 * request goes on; HF_BAD_CASE, HF_SINGULAR, HF_EXISTS, HF_IO, HF_NO_MEMORY. */
hf_status hf_tolerance_stage_run(const hf_tolerance_stage *stage, hf_summary *summary, hf_messages *messages);

#endif
