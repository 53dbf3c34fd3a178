/* problem - a case opened: its net with its truss, the shape found, and a batch that evaluates designs.
 * Stability: stable.
 *
 * hf_problem_open and hf_problem_free are all that a program needs around its own optimiser, see tools/own_optimiser.c.
 * `hifdm run`, `check` and `evaluate` make the same object step by step (src/run/problem_parts.h). */
#ifndef HIFDM_PROBLEM_H
#define HIFDM_PROBLEM_H

#include <hifdm/api.h>
#include <hifdm/batch.h>
#include <hifdm/config.h>
#include <hifdm/facets.h>
#include <hifdm/scene_arrays.h>

HF_API_BEGIN

/* Its members point to each other, so it is neither moved nor copied. */
typedef struct {
    hf_case settings;
    hf_scene scene;
    hf_carrier carrier; /* all zero without a truss */
    hf_model model;
    hf_states states;             /* of the net as built; none without `cases` */
    hf_surface_settings surface;  /* the wanted one, its kind known; all zero when the case asks for no measures */
    hf_facets facets;             /* of the wanted surface; none when the case asks for no measures */
    int planes;                   /* of symmetry that link genes: bit 1 = x, bit 2 = y */
    hf_workspace workspace;       /* holds the found shape until another is computed in it */
    hf_form_result form;          /* of the form-finding */
    double *start_q_N_per_m;      /* [n_cable] of the found shape */
    double *base_N;               /* [n_gene] boundary pretensions of the found shape, averaged over linked genes */
    hf_limits limits;             /* of optimize.limits; none without rows */
    struct hf_problem_nets *nets; /* as built, that goals are over; NULL without */
    hf_goals goals;               /* of optimize.goals or objectives; none without rows: psi */
    hf_evaluator evaluator;       /* of designs of this problem */
    hf_batch batch;               /* evaluates designs; borrows the evaluator */
    hf_solver solver;             /* the solver that the batch uses */
} hf_problem;

/* A case whose net a program has in memory. `text` is that of a case file whose section scene has a part import (the
 * files that it names are not read); it and the arrays are borrowed. */
typedef struct {
    const char *text;
    const hf_scene_arrays *net;
} hf_problem_source;

/* Read the case `path` under n_set overrides "key=value" (NULL, 0: none), build the model with its truss and symmetry,
 * find the shape, and create the batch of n_thread threads (0: all cores); hf_batch_share prepares what they share from
 * base_N. A sweep section is ignored. model.n_gene may be 0: then there is nothing to design. Returns HF_OK;
 * HF_BAD_CASE with all faults; HF_NOT_CONVERGED or an ill-posed status of the form-finding with names of cables or
 * nodes (`form` and `workspace` then hold what was reached, and there is no batch); HF_MECHANISM; HF_NO_MEMORY. Every
 * failure leaves an error in the messages. hf_problem_free in any case. */
hf_status hf_problem_open(const char *path, const char *const *set, int n_set, int n_thread, hf_problem *problem,
                          hf_messages *messages);

/* Is a design judged by its merit? Not with objectives. */
bool hf_problem_has_merit(const hf_problem *problem);

/* The figures of a design, in order; returns how many: without objectives all. */
int hf_problem_list_figures(const hf_problem *problem, const hf_result_field *field[HF_RESULT_N_INDIVIDUAL]);

/* The number of figures that have derivatives by the genes, and what each is called: the value of each goal and
 * "merit", which objectives do not have, or without goals "psi_m"; returns text. */
int hf_problem_n_slope(const hf_problem *problem);
const char *hf_problem_slope_name(const hf_problem *problem, int i_slope, char text[HF_GOAL_NAME_SIZE]);

/* Exact derivatives of these figures at n designs [n][n_gene] with these results [n] of hf_batch_run: slope
 * [feasible designs][n_slope][n_gene], in the unit of the figure per unit of the gene, by each gene alone; without the
 * weights of goals, and of a goal that is the largest of several sizes that of its smooth largest; NaN of a figure that
 * is 0. HF_OK; HF_BAD_CASE for nets with struts and under rule seeded, with a message; HF_NO_MEMORY. */
hf_status hf_problem_slopes(hf_problem *problem, int n, const double *design_N, const hf_form_result *result,
                            double *slope, hf_messages *messages);
hf_status hf_problem_has_slopes(const hf_problem *problem, hf_messages *messages); /* HF_OK or HF_BAD_CASE */

void hf_problem_free(hf_problem *problem);

HF_API_END
#endif
