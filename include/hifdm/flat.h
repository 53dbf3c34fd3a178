/* flat - the library for other languages: one opaque handle, plain arrays, numbers and words; no struct crosses. The
 * Python package (tools/python) is made on it, and Julia, MATLAB or Fortran can call it in the same way.
 * Stability: stable; a program compares hf_flat_interface() with the number that it was written for.
 *
 * A handle holds one case: open it (hf_flat_open, or arrays of a net and hf_flat_open_net), find its shape
 * (hf_flat_form), then evaluate designs, take shapes and derivatives. hf_flat_run is a run of its own and needs no
 * hf_flat_form. What there is to read has a name: hf_flat_text, hf_flat_ints, hf_flat_reals.
 *
 * Status. Calls return hf_status as a number: 0 is ok, hf_status_word, hf_status_text (status.h) put it in words, and
 *     hf_flat_said has the errors and warnings of the last call.
 * Memory. What is given to hf_flat_open..., hf_flat_nodes, hf_flat_cables and hf_flat_sets is borrowed until
 *     hf_flat_free; everything else is copied. A text that is returned is valid until the next call with its handle.
 * Threads. A handle belongs to one thread at a time, but for hf_flat_stop; any number of handles may work at once.
 * Waiting. Set OMP_WAIT_POLICY=passive and GOMP_SPINCOUNT=2000 in the environment before the library is loaded
 *     (hf_batch_wait_quietly in batch.h says why); the Python package does.
 * GSL. See hifdm.h: call gsl_set_error_handler_off() once. */
#ifndef HIFDM_FLAT_H
#define HIFDM_FLAT_H

#include <hifdm/api.h>

HF_API_BEGIN

#define HF_FLAT_INTERFACE 1 /* raised when a function below changes what it takes, returns or means */

typedef struct hf_flat hf_flat;

int hf_flat_interface(void);       /* HF_FLAT_INTERFACE of the library */
const char *hf_flat_version(void); /* of the library, "0.1.0" */

/* The word of a code, NULL where there is none; and the code of a word, -1 where there is none. `list`: "role", "group",
 * "law", "phase", "status", "stop_reason", "bound_reason", "coupling_stop". */
const char *hf_flat_word(const char *list, int code);
int hf_flat_code(const char *list, const char *word);

hf_flat *hf_flat_create(void); /* NULL: no memory */
void hf_flat_free(hf_flat *flat);
const char *hf_flat_said(const hf_flat *flat); /* lines "error: ..." and "warning: ..."; "" when there are none */

/* ---- A case ---- */

/* Open a case file under n_set overrides "key=value", to be evaluated by n_thread threads (0: all cores). No shape is
 * found yet. HF_OK, HF_BAD_CASE, HF_MECHANISM, HF_NO_MEMORY. Call this or hf_flat_open_net once per handle. */
int hf_flat_open(hf_flat *flat, const char *path, int n_set, const char *const *set, int n_thread);

/* The same of a net of arrays: first nodes and cables, then, if there are any, sets, then hf_flat_open_net. Members
 * and NULL as in scene_arrays.h. text: of a case file whose scene is import: {nodes: nodes.csv, cables: cables.csv},
 * names of files that are not read; name: what messages call it. */
void hf_flat_nodes(hf_flat *flat, int n_node, const double *position_m, const unsigned char *role, const double *load_N,
                   const char *const *node_id);
void hf_flat_cables(hf_flat *flat, int n_cable, const int *end, const unsigned char *group, const unsigned char *law,
                    const double *value, const double *EA_N, const char *const *cable_id);
void hf_flat_sets(hf_flat *flat, int n_set, const char *const *name, const int *start, const int *cable);
int hf_flat_open_net(hf_flat *flat, const char *name, const char *text, int n_set, const char *const *set,
                     int n_thread);

/* ---- What there is to read ---- */

/* Text i of a list, NULL beyond its last:
 *   title, solver (after hf_flat_form)      i = 0
 *   node_id, cable_id, set_name             of the net
 *   gene, gene_unit                         the variables of a design
 *   figure, figure_unit, figure_help        of a design: rows of hf_flat_evaluate
 *   result, result_unit, result_help        of a shape: the reals "result"
 *   result_kind                             "real", "int", or the list of its words ("status", "stop_reason", ...)
 *   slope                                   the figures that have derivatives
 *   summary                                 i = 0: of the last hf_flat_run, the object that hifdm run --json prints */
const char *hf_flat_text(hf_flat *flat, const char *list, int i);

/* Copy integers to `to` (NULL: none); returns how many there are, -1 for an unknown name:
 *   end [n_cable][2], role [n_node], group, law [n_cable], gene_cable [n_gene] (-1: of a support),
 *   gene_leader [n_gene] (the gene with which it is linked), set_start [n_set + 1], set_cable */
int hf_flat_ints(const hf_flat *flat, const char *name, int *to);

/* The same of real numbers, SI:
 *   theoretical_m [n_node][3], load_N [n_node][3] or none, target [n_cable], EA_N [n_cable] or none
 *   base, lower, upper [n_gene]             after hf_flat_form: the design of the shape found, and the bounds of
 *                                           optimize around it, infinite where open
 *   position_m [n_node][3]; length_m, tension_N, q_N_per_m [n_cable]; result [n_result]
 *                                           of the last hf_flat_form or hf_flat_shape */
int hf_flat_reals(const hf_flat *flat, const char *name, double *to);

/* ---- Work ---- */

/* Find the shape of the case. HF_OK, HF_NOT_CONVERGED, or why there is none. */
int hf_flat_form(hf_flat *flat);

/* Evaluate n designs [n][n_gene] on all cores, as `hifdm evaluate` does: figure [n_figure][n], a row for each text of
 * the list "figure"; the first is the status as a code. HF_OK, also when designs are infeasible; HF_BAD_CASE for a
 * value that is no number, or of a cable not above zero; HF_BAD_USAGE without a shape; HF_NO_MEMORY. */
int hf_flat_evaluate(hf_flat *flat, int n, const double *design, double *figure);

/* The shape of one design [n_gene], to be read with hf_flat_reals. Status as hf_flat_evaluate; that of the design is
 * in its result. */
int hf_flat_shape(hf_flat *flat, const double *design);

/* Derivatives by the genes of n designs: slope [n][n_slope][n_gene], NaN of infeasible designs (hf_problem_slopes). */
int hf_flat_slopes(hf_flat *flat, int n, const double *design, double *slope);

/* Called during a run; another result than 0 stops it. phase: of hf_flat_word; done, all: generations, samples,
 * steps of Levenberg-Marquardt, or points of a front. */
typedef int hf_flat_observer(void *context, int phase, long done, long all, long evaluations, double best_psi_m,
                             double elapsed_s);

/* Run the case as `hifdm run` does, its cases and tolerances included, into the result file `output` (NULL: none),
 * which a later call continues unless restart is not 0. The observer may be called from other threads, one at a time.
 * Status as hf_run_case; the figures are the text "summary". */
int hf_flat_run(hf_flat *flat, const char *output, int restart, hf_flat_observer *observer, void *context);

/* Stop the run that goes on, from any thread or signal handler: hf_flat_run returns HF_INTERRUPTED. */
void hf_flat_stop(hf_flat *flat);

HF_API_END
#endif
