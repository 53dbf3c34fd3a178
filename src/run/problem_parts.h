/* problem_parts - the steps of hf_problem_open one by one, in the order of their use.
 *
 * `run`, `check` and `evaluate` call them and store or print something in between. Because they share these steps, they
 * refuse the same cases with the same words. */
#pragma once

#include <hifdm/problem.h>
#include <hifdm/summary.h>

/* Loads case, scene, truss, model and symmetry. source is NULL, or replaces the files of case and net; `path` is then
 * only a name. Returns HF_OK; HF_BAD_CASE with all faults; HF_MECHANISM; HF_NO_MEMORY; HF_INTERRUPTED if *stop is set
 * (NULL: never) during a long step. The caller frees the problem in any case. */
hf_status hf_problem_load(const char *path, const hf_problem_source *source, const char *const *set, int n_set,
                          const volatile sig_atomic_t *stop, hf_problem *problem, hf_messages *messages);

/* Finds the tensions tension_N [n_cable] that would hold the nodes of a problem with form.prestress: exact with another
 * form.pretension_N. `source` is that of hf_problem_load. Returns HF_OK, HF_NO_MEMORY, or another status without a
 * message if there are none. */
hf_status hf_problem_hold_at(const hf_problem *problem, const hf_problem_source *source, double pretension_N,
                             double *tension_N);

/* Sets the members of the summary that case and model determine. */
void hf_problem_describe(const hf_problem *problem, hf_summary *summary);

/* Returns HF_EXISTS, with a message, if `output` is an input: the case, a file of its net or truss or of a load case,
 * or `table` (may be NULL). No option lets a result replace an input. Otherwise returns HF_OK. */
hf_status hf_problem_spare_inputs(const hf_problem *problem, const char *table, const char *output,
                                  hf_messages *messages);

/* Loads LAPACK and allocates the workspace and the arrays that hf_problem_base fills. Returns HF_OK, HF_NO_MEMORY or
 * HF_NO_LAPACK. */
hf_status hf_problem_allocate(hf_problem *problem, hf_messages *messages);

/* Sets `initial` and start_q_N_per_m from the shape in the workspace, and the evaluator. Returns HF_OK or HF_NO_MEMORY.
 * With a section optimize it returns HF_NO_FEASIBLE for a cable without tension, and HF_BAD_CASE for bounds out of
 * reach or a method that the net does not allow. */
hf_status hf_problem_base(hf_problem *problem, hf_messages *messages);

/* Limits the generations of method `auto` to the operations of about one refinement, if designs have derivatives. */
void hf_problem_limit_search(hf_problem *problem);

/* Returns why the designs of the problem have no derivatives (hf_refine_applies). If the default variables are the
 * reason, the text proposes others. */
const char *hf_problem_no_slopes(const hf_problem *problem);

/* Format of a message with that reason. */
#define HF_PROBLEM_REFINE_NEEDS "optimize: Levenberg-Marquardt needs derivatives; %s"

/* Warns with that reason if a search by generations is followed by a refinement that cannot be done. */
void hf_problem_warn_of_refine(const hf_problem *problem, hf_messages *messages);

/* Warns that load cases and tolerances are not those of designs of the front, if no point of the front is taken. */
void hf_problem_warn_of_front(const hf_problem *problem, hf_messages *messages);

/* Returns the evaluator, which borrows the problem. hf_problem_base sets problem->evaluator to it. */
hf_evaluator hf_problem_evaluator(const hf_problem *problem);

/* Creates the batch of n_thread threads (0: all cores). Returns HF_OK or HF_NO_MEMORY. */
hf_status hf_problem_batch(hf_problem *problem, int n_thread);

/* Prepares the factorisation that the threads of the batch share (hf_batch_share), if all values of cables in `initial`
 * are above 0, and sets problem->solver. Returns HF_OK or HF_NO_MEMORY; without this memory the results would have
 * other bits. */
hf_status hf_problem_share(hf_problem *problem, hf_messages *messages);

/* Calls hf_problem_base, hf_problem_batch and hf_problem_share. Returns HF_OK or the status of the one that failed. */
hf_status hf_problem_prepare(hf_problem *problem, int n_thread, hf_messages *messages);
