/* flat - the library for other languages: one opaque handle, plain arrays, numbers and words; no structs.
 * Stability: stable; a program compares hf_flat_interface() with the number that it was written for.
 *
 * The Python package (tools/python) is built on it, and Julia, MATLAB or Fortran can call it in the same way. A handle
 * holds one case. Pipeline:
 *
 *   hf_flat_create
 *   hf_flat_open, or arrays of a net and hf_flat_open_net   case -> model
 *   hf_flat_form                                            shape of the case
 *   hf_flat_evaluate, hf_flat_shape, hf_flat_slopes         designs -> figures, one shape, derivatives
 *   hf_flat_free
 *
 * hf_flat_run is a whole run and does not need hf_flat_form. Results are read by name: hf_flat_text, hf_flat_ints,
 * hf_flat_reals.
 *
 * Status: calls return hf_status as a number. 0 is ok; hf_status_word and hf_status_text (status.h) convert it to
 * words. hf_flat_messages has the errors and warnings of the last call.
 *
 * Memory: arguments of hf_flat_open, hf_flat_open_net, hf_flat_nodes, hf_flat_cables and hf_flat_sets are borrowed
 * until hf_flat_free; all others are copied. A text that is returned is valid until the next call with its handle.
 *
 * Threads: a handle belongs to one thread at a time, except for hf_flat_stop. Any number of handles may be in use at
 * once.
 *
 * Waiting: set OMP_WAIT_POLICY=passive and GOMP_SPINCOUNT=2000 in the environment before the library is loaded, as the
 * Python package does. hf_batch_wait_quietly in batch.h gives the reason.
 *
 * GSL: call gsl_set_error_handler_off() once; hifdm.h gives the reason. */
#ifndef HIFDM_FLAT_H
#define HIFDM_FLAT_H

#include <hifdm/api.h>

HF_API_BEGIN

#define HF_FLAT_INTERFACE 2 /* raised when a function below changes what it takes, returns or means */

/* A handle with one case. */
typedef struct hf_flat hf_flat;

/* Returns the HF_FLAT_INTERFACE with which the library was compiled. */
int hf_flat_interface(void);
/* Returns the version of the library, such as "0.1.0 (v0.1.0)", a constant string. */
const char *hf_flat_version(void);

/* Returns the word of a code; NULL if there is none. `list` is "role", "group", "law", "phase", "status",
 * "stop_reason", "bound_reason" or "coupling_stop". */
const char *hf_flat_word(const char *list, int code);
/* Returns the code of a word in one of these lists; -1 if there is none. */
int hf_flat_code(const char *list, const char *word);

/* Creates a handle. Returns NULL if memory runs out. */
hf_flat *hf_flat_create(void);
/* Frees a handle, which may be NULL. */
void hf_flat_free(hf_flat *flat);
/* Returns the lines "error: ..." and "warning: ..." of the last call; "" if there are none. */
const char *hf_flat_messages(const hf_flat *flat);

/* ---- A case ---- */

/* Opens a case file under n_set overrides "key=value", set [n_set]. Designs will be evaluated by n_thread threads; 0:
 * all cores. No shape is computed yet. Call this or hf_flat_open_net once per handle. Returns HF_OK, HF_BAD_CASE,
 * HF_MECHANISM, HF_NO_MEMORY or HF_NO_LAPACK; HF_BAD_USAGE for a second call. */
int hf_flat_open(hf_flat *flat, const char *path, int n_set, const char *const *set, int n_thread);

/* Sets the nodes of a net in memory. The arguments are the members of hf_scene_arrays (scene_arrays.h), with the same
 * meaning of NULL. Call this and hf_flat_cables, and hf_flat_sets if there are sets, before hf_flat_open_net. */
void hf_flat_nodes(hf_flat *flat, int n_node, const double *position_m, const unsigned char *role, const double *load_N,
                   const char *const *node_id);
/* Sets the cables of a net in memory, as hf_flat_nodes sets the nodes. */
void hf_flat_cables(hf_flat *flat, int n_cable, const int *end, const unsigned char *group, const unsigned char *law,
                    const double *value, const double *EA_N, const char *const *cable_id);
/* Sets the named sets of cables of a net in memory, as hf_flat_nodes sets the nodes. */
void hf_flat_sets(hf_flat *flat, int n_set, const char *const *name, const int *start, const int *cable);
/* Opens a case with the net that was set before, as hf_flat_open opens a file. `text` is that of a case file whose
 * scene is import: {nodes: nodes.csv, cables: cables.csv}; the files are not read. `name` is the name of the case in
 * messages. */
int hf_flat_open_net(hf_flat *flat, const char *name, const char *text, int n_set, const char *const *set,
                     int n_thread);

/* ---- Reading ---- */

/* Returns text i of a list; NULL beyond the last one, for an unknown list, and before a case is open:
 *
 *   title, solver (after hf_flat_form)      i = 0
 *   node_id, cable_id, set_name             of the net
 *   variable, variable_unit                 names and units of the design variables
 *   objective                               names of the objectives
 *   figure, figure_unit, figure_help        figures of a design: rows of hf_flat_evaluate
 *   result, result_unit, result_help        figures of a shape: the reals "result"
 *   result_kind                             "real", "int", or the list of its words ("status", "stop_reason", ...)
 *   slope                                   figures that have derivatives
 *   summary                                 i = 0: the object that hifdm run --json prints, of the last hf_flat_run */
const char *hf_flat_text(hf_flat *flat, const char *list, int i);

/* Copies integers to `to`, unless it is NULL, and returns their number; -1 for an unknown name, 0 before a case is
 * open:
 *
 *   end [n_cable][2], role [n_node], group, law [n_cable]
 *   variable_cable [n_variable]     cable of each design variable; -1: it displaces a support
 *   variable_leader [n_variable]    design variable whose change it takes by symmetry, or itself
 *   set_start [n_set + 1], set_cable */
int hf_flat_ints(const hf_flat *flat, const char *name, int *to);

/* Copies real numbers in SI units as hf_flat_ints copies integers; returns 0 if they do not exist yet:
 *
 *   target_position_m [n_node][3]           target positions
 *   load_N [n_node][3] or none, target [n_cable], EA_N [n_cable] or none
 *   initial, lower, upper [n_variable]      after hf_flat_form: initial design, and the bounds of optimize around it,
 *                                           infinite where a side is open
 *   position_m [n_node][3]; length_m, tension_N, q_N_per_m [n_cable]; result [n_result]
 *                                           of the last hf_flat_form or hf_flat_shape */
int hf_flat_reals(const hf_flat *flat, const char *name, double *to);

/* ---- Computation ---- */

/* Finds the shape of the case. Returns HF_OK, HF_NOT_CONVERGED or the status of an ill-posed net; HF_BAD_USAGE without
 * a case; HF_BAD_CASE for a section optimize that cannot start from the shape; HF_NO_MEMORY; HF_NO_LAPACK. */
int hf_flat_form(hf_flat *flat);

/* Evaluates n designs design [n][n_variable] on all cores, as `hifdm evaluate` does. figure [n_figure][n] receives a
 * row for each text of the list "figure"; the first row has the status of each design as a code. Returns HF_OK, also if
 * designs are infeasible; HF_BAD_CASE for a value that is not finite, or that is of a cable and not above zero;
 * HF_BAD_USAGE before hf_flat_form; HF_NO_MEMORY. */
int hf_flat_evaluate(hf_flat *flat, int n, const double *design, double *figure);

/* Finds the shape of one design [n_variable], which is then read with hf_flat_reals. Its status is in the result.
 * Returns the same status as hf_flat_evaluate. */
int hf_flat_shape(hf_flat *flat, const double *design);

/* Computes the derivatives of n designs [n][n_variable] by the design variables (hf_problem_slopes): slope
 * [n][n_slope][n_variable], NaN for infeasible designs. Returns the same status as hf_flat_evaluate, and HF_BAD_CASE if
 * there are no derivatives. */
int hf_flat_slopes(hf_flat *flat, int n, const double *design, double *slope);

/* Receives the progress of a run; a result other than 0 stops the run. `phase` is a code of the list "phase". `done`
 * and `all` count generations, samples, steps of Levenberg-Marquardt or points of a front. hf_run_progress in run.h
 * describes the other figures. */
typedef int hf_flat_observer(void *context, int phase, long done, long all, long evaluations, double best_psi_m,
                             double elapsed_s);

/* Runs the case as `hifdm run` does, with its load cases and samples, and writes the result file `output` (NULL: none).
 * A later call resumes an unfinished file unless restart is not 0. The observer may be called from other threads, one
 * at a time; NULL: none. Returns the status of hf_run_case, or HF_BAD_USAGE without a case. The figures are the text
 * "summary". */
int hf_flat_run(hf_flat *flat, const char *output, int restart, hf_flat_observer *observer, void *context);

/* Stops the current run, from any thread or signal handler; hf_flat_run then returns HF_INTERRUPTED. */
void hf_flat_stop(hf_flat *flat);

HF_API_END
#endif
