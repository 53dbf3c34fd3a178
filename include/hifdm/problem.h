/* problem - a case opened: its net with its truss, the shape found, and a batch that evaluates designs.
 * Stability: stable.
 *
 * hf_problem_open and hf_problem_free are all that a program needs around its own optimiser, see tools/own_optimiser.c.
 * `hifdm run`, `check` and `evaluate` make the same object step by step (src/run/problem_parts.h). */
#ifndef HIFDM_PROBLEM_H
#define HIFDM_PROBLEM_H

#include <hifdm/batch.h>
#include <hifdm/config.h>
#include <hifdm/facets.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Its members point to each other, so it is neither moved nor copied. */
typedef struct {
    hf_case settings;
    hf_scene scene;
    hf_carrier carrier; /* all zero without a truss */
    hf_model model;
    hf_states states;            /* of the net as built; none without `cases` */
    hf_surface_settings surface; /* the wanted one, its kind known; all zero when the case asks for no measures */
    hf_facets facets;            /* of the wanted surface; none when the case asks for no measures */
    int planes;                  /* of symmetry that link genes: bit 1 = x, bit 2 = y */
    hf_workspace workspace;      /* holds the found shape until another is computed in it */
    hf_form_result form;         /* of the form-finding */
    double *start_q_N_per_m;     /* [n_cable] of the found shape */
    double *base_N;              /* [n_gene] boundary pretensions of the found shape, averaged over linked genes */
    hf_limits limits;            /* of optimize.limits; none without rows */
    hf_goals goals;              /* of optimize.goals or objectives; none without rows: psi */
    hf_evaluator evaluator;      /* of designs of this problem */
    hf_batch batch;              /* evaluates designs; borrows the evaluator */
    hf_solver solver;            /* the solver that the batch uses */
} hf_problem;

/* Read the case `path` under n_set overrides "key=value" (NULL, 0: none), build the model with its truss and symmetry,
 * find the shape, and create the batch of n_thread threads (0: all cores); hf_batch_share prepares what they share from
 * base_N. A sweep section is ignored. model.n_gene may be 0: then there is nothing to design. Returns HF_OK;
 * HF_BAD_CASE with all faults; HF_NOT_CONVERGED or an ill-posed status of the form-finding with names of cables or
 * nodes (`form` and `workspace` then hold what was reached, and there is no batch); HF_MECHANISM; HF_NO_MEMORY. Every
 * failure leaves an error in the messages. hf_problem_free in any case. */
hf_status hf_problem_open(const char *path, const char *const *set, int n_set, int n_thread, hf_problem *problem,
                          hf_messages *messages);

void hf_problem_free(hf_problem *problem);

#ifdef __cplusplus
}
#endif
#endif
