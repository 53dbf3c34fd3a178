/* stages - the stages of a run. run.c calls them one after the other; each measures and stores its shape.
 *
 *     stages_form.c      form-finding
 *     stages_search.c    initial design, batch and optimiser; the search by generations
 *     stages_refine.c    refinement by Levenberg-Marquardt, or a point of an earlier front
 *     stages_front.c     front of the objectives
 *     load_case_stage.c  load cases of the as-built net
 *     tolerance_stage.c  samples of the as-built net
 *     requirements_stage.c  verdicts on the rows of requirements
 *     stages_measure.c   measures and far field of a shape, for all stages
 *
 * A stage returns HF_INTERRUPTED if the run was told to stop before its end; run.c then publishes what is stored. Other
 * failures have a message. */
#pragma once

#include "run/diagnose.h"
#include "run/feasible.h"
#include "run/load_case_stage.h"
#include "run/requirements_stage.h"
#include "run/take_point.h"
#include <hifdm/optimiser.h>
#include <hifdm/run.h>

#define HF_STOPPED_AT_SIZE 160

/* What the stages of a run share. The run owns all but the request and output. */
typedef struct {
    const hf_run_request *request;
    char *output; /* [HF_OUTPUT_SIZE] path of the result file; "": none */
    hf_problem problem;
    hf_store *store;           /* NULL: no file is written */
    bool may_publish;          /* the store has a shape, and all generations that an earlier session left */
    bool has_design;           /* the stages that find the design have ended without a failure */
    hf_carrier_state truss;    /* of the truss, under the shape of the result */
    const hf_workspace *shape; /* workspace that holds that shape; NULL: there is none */
    hf_load_case_stage cases;  /* as-built net of the design, if there are load cases */
    hf_requirements_stage requirements;
    hf_places places;       /* after form-finding, if an optimisation follows */
    hf_optimiser_plan plan; /* the algorithms of optimize.method */
    hf_optimiser optimiser;
    double *design;                       /* [n_variable] best design so far, of the problem or of the population */
    hf_front front;                       /* front of optimize.front */
    hf_taken_point taken;                 /* point taken instead of a search */
    int steps_before;                     /* steps of the finished refinement that the run continues */
    char advice[HF_FEASIBLE_ADVICE_SIZE]; /* what would let the initial design meet the limits on tensions, or "" */
    char stopped_at[HF_STOPPED_AT_SIZE];  /* how far an interrupted stage came, for the message */
} hf_run;

/* Returns true if the caller has told the run to stop. */
static inline bool hf_run_must_stop(const hf_run *r)
{
    const volatile sig_atomic_t *stop = r->request->control.stop_requested;
    return stop && *stop;
}

/* Passes the progress to the observer, if there is one. */
static inline void hf_run_report(const hf_run_control *control, hf_run_progress progress)
{
    if (control->observer) control->observer(control->observer_context, &progress);
}

typedef hf_status hf_run_stage(hf_run *run, hf_summary *summary, hf_messages *messages);

/* Finds the shape of the case. Also returns HF_NOT_CONVERGED or the status of an ill-posed net. */
hf_run_stage hf_stage_form;
/* Prepares the initial design with its objectives, the batch and the optimiser. It allocates everything that the
 * generations need before the first one. If there is no design variable, it only warns. */
hf_run_stage hf_stage_begin;
/* Evolves generations, each stored when it is evaluated, and stores the best individual. If no individual is feasible,
 * the refinement starts from the individual nearest to the constraints. Returns HF_NO_FEASIBLE if there is no
 * refinement. */
hf_run_stage hf_stage_search;
/* Refines the best individual, or the initial design if no search was run. The better design is the result. Does
 * nothing if hf_stage_wants_refine returns false. Returns HF_NO_FEASIBLE if the run has no feasible design. */
hf_run_stage hf_stage_refine;
/* Takes a point of an earlier front as the design. */
hf_run_stage hf_stage_point;
/* Finds and stores the front of the objectives. After a search it is that of the last generation, from which
 * Levenberg-Marquardt starts if the method ends with it. Otherwise Levenberg-Marquardt finds it alone. */
hf_run_stage hf_stage_front;
/* Finds, measures and stores all load cases of the as-built net. If a load case has no shape, the summary gets its
 * status and the user a warning, and the run continues. */
hf_run_stage hf_stage_load_cases;
/* Finds all samples of the as-built net, or those of the task, and writes their statistics into the summary. Also
 * returns HF_BAD_CASE, HF_SINGULAR or HF_EXISTS. */
hf_run_stage hf_stage_samples;
/* Gives the verdicts on the rows of `requirements`. */
hf_run_stage hf_stage_verdicts;

/* Gives the verdicts on the rows of `requirements` with a share for one of several designs, from as many samples as the
 * result has. They are not kept. verdict [n]: other rows are not changed. Returns HF_OK; HF_NO_MEMORY, HF_INTERRUPTED
 * or HF_IO, with a message; another status if the design has no as-built net. */
typedef struct {
    const hf_workspace *shape; /* of the design */
    int i, n;                  /* number of this design and of all, for the progress */
    double begin_s;            /* time of the first one, for the progress */
} hf_tolerance_design;
hf_status hf_tolerance_stage_judge(const hf_run *run, const hf_tolerance_design *design,
                                   hf_requirement_verdict *verdict, hf_messages *messages);

/* Measures the shape in the workspace as that of `stage`: the tensions of its sets, the limits that a design reaches
 * and, for a case with a section `surface`, the surface and its far field. Returns HF_OK; HF_NO_MEMORY; HF_INTERRUPTED
 * without the far field; or an error of the store. */
hf_status hf_stage_measure(hf_run *run, hf_stage stage, const hf_workspace *workspace, hf_summary *summary,
                           hf_messages *messages);

/* Returns true if the run refines its best design: the method ends with it, optimize.refine is true, or it is cheap or
 * the only way to a feasible design. */
bool hf_stage_wants_refine(const hf_run *run, const hf_summary *summary);

/* Counts the design variables at their bounds. */
void hf_stage_count_at_bounds(const hf_population *population, const double *design, int *at_lower, int *at_upper);

/* Makes the shape in the workspace the result, unless a later stage finds another. Returns HF_OK; HF_BAD_CASE for a
 * design whose as-built net cannot be made; HF_NO_MEMORY. */
hf_status hf_stage_take(hf_run *run, hf_workspace *workspace, hf_messages *messages);
