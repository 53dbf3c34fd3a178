/* check - what a run of a case would do, without running it: the solvers, the memory and about how long it takes. Only
 * short trials are run, never the whole optimisation. */
#pragma once

#include "case/study.h"
#include "run/tolerance_stage.h"
#include <hifdm/problem.h>

/* What to check. */
typedef struct {
    const char *path;       /* of the case */
    const char *const *set; /* [n_set], "key=value" */
    int n_set, threads;
} hf_check_request;

/* Memory that a run would allocate, and the maximum size of its generations in the result file, bytes. */
typedef struct {
    double workspaces, newton; /* of all threads; `newton` is what Newton's method adds to the workspaces */
    double shared, lanes;      /* of the evaluation of a population: once for all threads; of all threads */
    double population, refine, generations;
} hf_check_memory;

enum { HF_CHECK_FAMILIES = 12 };

/* Range of the tensions that hold the net (form.prestress: exact) in a family of cables, N. */
typedef struct {
    const char *name;
    double lower_N, upper_N;
} hf_check_family;

/* Size of the sums of the far field at one frequency. */
typedef struct {
    long n_point;
    int n_angle;
} hf_check_far_field;

/* What was found. Times are in s; that of a part which was not tried is NaN. */
typedef struct {
    hf_problem problem;
    int threads;

    /* Set by hf_check_load. */
    bool optimizes, evolves, refines; /* an optimisation, a search by generations, Levenberg-Marquardt may run */
    bool is_refine_result;            /* Levenberg-Marquardt gives the result, or each point of a front */
    hf_method method;                 /* of the form-finding */
    const char *method_reason;        /* why this one */
    int n_role[3];                    /* nodes of each hf_role */
    int n_group[2], n_law[HF_N_LAW];  /* cables of each group, and of each law in force */
    int n_family;                     /* 0 without form.prestress: exact */
    hf_check_family family[HF_CHECK_FAMILIES];
    int n_in_row[HF_DESIGN_ROWS_MAX];            /* design variables of each row of optimize.variables */
    const char *unit_of_row[HF_DESIGN_ROWS_MAX]; /* their units */
    int n_net, n_sample;                         /* as-built nets of which each design is solved; samples among them */
    hf_check_far_field far_field[HF_LIST_MAX];   /* at each of surface.frequencies_Hz, with surface.pattern */
    double truss_s;                              /* time to build and condense the truss once */
    hf_check_memory memory;

    /* Set by hf_check_try. */
    double form_s;         /* time of the form-finding; a maximum if it is not finished */
    double load_cases_s;   /* time of all load cases */
    bool is_form_finished; /* the trial came to an end */
    bool has_tolerance;    /* `tolerance` is set */
    hf_tolerance_trial tolerance;
    int tolerance_threads;        /* number of threads with work for the samples */
    double tolerance_s, yields_s; /* times of all samples, and of the search for tolerance.find_scale */
    int n_judged;                 /* maximum number of points of a front that are judged by samples */
    double judged_s;              /* time of the samples of these points */
    hf_solver solver;             /* of the designs of a generation */
    double design_s, search_s;    /* times of a design of the first generation; maximum of the whole search */
    bool is_step_tried;           /* false: step_s follows from counted operations */
    int n_step;                   /* steps of Levenberg-Marquardt (for each point of a front) that are expected */
    bool is_refine_tried;         /* true: the trial took all n_step steps, from the initial design */
    double step_s, refine_s;      /* times of a step of Levenberg-Marquardt, and of all expected steps */
    bool advises_fewer;           /* the refinement takes long or much memory: fewer variables would be better */
    double at_most_s;             /* time of a run: the maximum of the search, and the expected time of all else */
} hf_check;

/* Loads the case and finds what does not need a trial. *check must be zero on entry. Returns HF_OK; HF_BAD_CASE with
 * all faults; or the status of another failure, with a message. The caller frees check->problem in any case. */
hf_status hf_check_load(const hf_check_request *request, hf_check *check, hf_messages *messages);

/* Tries the stages of the run, after hf_check_load, for about a second each. Returns HF_OK, the status of an ill-posed
 * scene, or that of another failure, with a message. What was found until then is valid. */
hf_status hf_check_try(hf_check *check, hf_messages *messages);

/* Returns the time of n > 0 tasks of each_s, which run in parallel, each in one thread. *threads becomes the number of
 * threads with work. */
double hf_check_together_s(double each_s, int n, int *threads);

/* What was found when scenes and models of the points of a study were made, for as many points as time allowed. */
typedef struct {
    int n_tried, n_fault;
    int first; /* the first point that can be run, or -1 */
} hf_check_points;

/* Makes scene and model of points in *scratch, as a sweep does, in an order that is spread over all axes. Reports the
 * faults of the points. Returns HF_OK; HF_BAD_CASE if no point can be run; HF_NO_MEMORY, HF_IO or HF_INTERRUPTED. */
hf_status hf_check_study_points(const hf_study *study, hf_problem *scratch, hf_check_points *points,
                                hf_messages *messages);
