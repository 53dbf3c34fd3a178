/* problem_parts - the steps of hf_problem_open one by one, in the order of their use.
 *
 * `run`, `check` and `evaluate` call them and store or print something in between. Since all share these steps, they
 * refuse the same cases with the same words. */
#ifndef HIFDM_PROBLEM_PARTS_H
#define HIFDM_PROBLEM_PARTS_H

#include <hifdm/problem.h>
#include <hifdm/summary.h>

/* Case, scene, truss, model, symmetry; source: NULL, or what stands in for the files of case and net, of which `path`
 * is only the name. HF_BAD_CASE with all faults, HF_MECHANISM, HF_NO_MEMORY; HF_INTERRUPTED, when *stop is
 * set (NULL: never) in what takes long. Free in any case. */
hf_status hf_problem_load(const char *path, const hf_problem_source *source, const char *const *set, int n_set,
                          const volatile sig_atomic_t *stop, hf_problem *problem, hf_messages *messages);

/* While the problem is at hand, messages give keys with their places in its case (hf_messages_place); NULL ends
 * that. */
void hf_problem_give_places(const hf_problem *problem, hf_messages *messages);

/* Fill in the members of the summary that case and model determine. */
void hf_problem_describe(const hf_problem *problem, hf_summary *summary);

/* HF_EXISTS when `output` is one of the inputs (the case, the files of its net and truss, a table of designs or NULL),
 * which no option lets a result replace; else HF_OK. */
hf_status hf_problem_spare_inputs(const hf_problem *problem, const char *table, const char *output,
                                  hf_messages *messages);

/* Loads LAPACK and allocates the workspace and the arrays that hf_problem_base fills. HF_OK, HF_NO_MEMORY or
 * HF_NO_LAPACK. */
hf_status hf_problem_allocate(hf_problem *problem, hf_messages *messages);

/* base_N and start_q_N_per_m from the shape in the workspace, and the evaluator. With an optimize section HF_BAD_CASE
 * for a base that cannot be optimised: a cable without tension, bounds out of reach, a method that the net does not
 * allow. */
hf_status hf_problem_base(hf_problem *problem, hf_messages *messages);

/* Why hf_polish_applies says no of the problem's designs, and where it is the variables, which ones it applies to. */
const char *hf_problem_no_slopes(const hf_problem *problem);

/* Message with that reason. */
#define HF_PROBLEM_POLISH_NEEDS "optimize: Levenberg-Marquardt needs derivatives; %s"

/* A warning with that where an optimisation by generations is to end with Levenberg-Marquardt, or to be compared with
 * it, and cannot be. */
void hf_problem_warn_of_polish(const hf_problem *problem, hf_messages *messages);

/* Of a front, when no point of it is taken: cases and tolerance are not of its designs. */
void hf_problem_warn_of_front(const hf_problem *problem, hf_messages *messages);

/* The evaluator; hf_problem_base sets problem->evaluator to it. It borrows the problem. */
hf_evaluator hf_problem_evaluator(const hf_problem *problem);

/* Create the batch of n_thread threads (0: all cores). HF_OK or HF_NO_MEMORY. */
hf_status hf_problem_batch(hf_problem *problem, int n_thread);

/* Prepare the factorisation that the batch's threads share (hf_batch_share), if all of base_N is above 0, and set
 * problem->solver. HF_OK, or HF_NO_MEMORY: without it the results would have other bits. */
hf_status hf_problem_share(hf_problem *problem, hf_messages *messages);

#endif
