/* problem - what `run`, `check` and `evaluate` begin with, in one place so that all three refuse the same cases: case
 * -> scene -> model, the form-finding with words for what went wrong, and the base design of the optimisation. */
#ifndef HIFDM_PROBLEM_H
#define HIFDM_PROBLEM_H

#include <hifdm/config.h>
#include <hifdm/evaluate.h>
#include <hifdm/summary.h>

typedef struct {
    hf_case settings;
    hf_scene scene;
    hf_carrier carrier; /* all zero without a truss */
    hf_model model;
    int planes; /* of symmetry, HF_PLANE_ bits */
    hf_workspace workspace;
    double *start_q_N_per_m; /* [n_cable] of the found shape */
    double *base_N;          /* [n_gene] boundary pretensions of the found shape, averaged over linked genes */
} hf_problem;

/* Case, scene, truss, model, symmetry. HF_BAD_CASE with all faults, HF_MECHANISM, HF_NO_MEMORY. The problem must stay
 * where it is. Free in any case. */
hf_status hf_problem_load(const char *path, const char *const *set, int n_set, hf_problem *problem,
                          hf_messages *messages);

/* The workspace, and all else that hf_problem_base fills. HF_OK or HF_NO_MEMORY. */
hf_status hf_problem_allocate(hf_problem *problem, hf_messages *messages);

/* From the shape in the workspace: base_N and start_q_N_per_m. With an optimize section HF_BAD_CASE for a base that
 * cannot be optimised: a cable without tension, bounds out of reach, a method that the net does not allow. */
hf_status hf_problem_base(hf_problem *problem, hf_messages *messages);

/* What optimize.method lm and ga+lm ask for. */
#define HF_PROBLEM_POLISH_NEEDS "optimize: Levenberg-Marquardt needs a net without struts and a rule other than seeded"

/* For designs of this problem; valid while the problem stays where it is. */
hf_evaluator hf_problem_evaluator(const hf_problem *problem);

/* Fill in what case and model say. */
void hf_problem_describe(const hf_problem *problem, hf_summary *summary);

/* Warnings about a shape that was found: no equilibrium yet, loaded straight chains, slack cables, all by name. */
void hf_problem_warn(const hf_problem *problem, const char *stage, hf_workspace *workspace,
                     const hf_form_result *result, hf_messages *messages);

/* The form-finding in the problem's workspace in words: hf_problem_warn, or an error that names cables or chains.
 * Returns result->status. */
hf_status hf_problem_explain(hf_problem *problem, const hf_form_result *result, hf_messages *messages);

void hf_problem_free(hf_problem *problem);

#endif
