/* cases - the states of the net as built that a case asks for, once its design is found. */
#ifndef HIFDM_CASES_H
#define HIFDM_CASES_H

#include <hifdm/built.h>
#include <hifdm/problem.h>
#include <hifdm/store.h>

#include <signal.h>

/* The net that is made of a design, and memory for its states. All zero before a design is taken, and without states.
 * It does not move in memory. */
typedef struct {
    hf_built built;
    hf_workspace workspace;
    double *cut_m, *move_m, *load_N; /* of a state, as hf_built_state */
    double *attachment_move_m;       /* [3 n_attachment] */
    double *truss_force;             /* [n_truss_node][6] N, N m */
    void *block;
} hf_cases;

/* Make the net of the design whose shape `workspace` holds, in place of an earlier one. HF_BAD_CASE for a design that
 * cannot be made, HF_NO_MEMORY, both with a message. */
hf_status hf_cases_take(const hf_problem *problem, const hf_workspace *workspace, hf_cases *cases,
                        hf_messages *messages);

/* Where the truss puts the attachments in each state before the net pulls: move_m [n_state][3 n_attachment]. HF_OK or
 * HF_NO_MEMORY. */
hf_status hf_cases_rest(const hf_problem *problem, double *move_m);

/* The same of each row of tolerance.truss, by 1 K of its part: move_m_per_K [n_truss][3 n_attachment]. */
hf_status hf_cases_rest_by_heat(const hf_problem *problem, double *move_m_per_K);

/* Find, measure and store all states of problem->states. A state without a shape has a warning and its status in the
 * summary, and the run goes on. HF_INTERRUPTED, when *stop is set (stop may be NULL); HF_NO_MEMORY; errors of the
 * store, which may be NULL. */
hf_status hf_cases_run(const hf_problem *problem, hf_cases *cases, hf_store *store, const volatile sig_atomic_t *stop,
                       hf_summary *summary, hf_messages *messages);

void hf_cases_free(hf_cases *cases);

#endif
