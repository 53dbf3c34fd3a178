/* flat - the library for other languages: one opaque handle, plain arrays, numbers and words, but no structs.
 * Stability: stable. A program compares hf_flat_interface() with the number for which the program was written.
 *
 * The Python package (tools/python) uses this interface. Programs in Julia, MATLAB or Fortran can use this interface in
 * the same way. A handle holds one case. Pipeline:
 *
 *   hf_flat_create
 *   hf_flat_open, or arrays of a net and hf_flat_open_net   case -> model
 *   hf_flat_form                                            shape of the case
 *   hf_flat_evaluate, hf_flat_shape, hf_flat_slopes         designs -> figures, one shape, derivatives
 *   hf_flat_residuals, hf_flat_vjp                          design -> residuals, their derivatives and products
 *   hf_flat_free
 *
 * hf_flat_run executes a complete run and does not need hf_flat_form. The functions hf_flat_text, hf_flat_ints and
 * hf_flat_reals return results by name.
 *
 * Status: functions return an hf_status as a number. The number 0 means success. The functions hf_status_word and
 * hf_status_text (status.h) convert the number to text. The function hf_flat_messages returns the errors and warnings
 * of the last call.
 *
 * Memory: the handle borrows the arguments of hf_flat_open, hf_flat_open_net, hf_flat_nodes, hf_flat_cables and
 * hf_flat_sets until hf_flat_free is called. The handle copies all other arguments. A returned string is valid until
 * the next call with the same handle.
 *
 * Threads: except for hf_flat_stop, only one thread at a time may use a handle. A program may use any number of handles
 * at the same time.
 *
 * Waiting: set OMP_WAIT_POLICY=passive and GOMP_SPINCOUNT=2000 in the environment before the library is loaded, as the
 * Python package does. The comment of hf_batch_wait_quietly in batch.h explains why these variables are necessary.
 *
 * GSL: call gsl_set_error_handler_off() once. The header hifdm.h explains why this call is necessary. */
#pragma once

#include <hifdm/api.h>

HF_API_BEGIN

#define HF_FLAT_INTERFACE 2 /* incremented when the arguments, the result or the meaning of a function below changes */

/* A handle with one case. */
typedef struct hf_flat hf_flat;

/* Returns the value of HF_FLAT_INTERFACE with which the library was compiled. */
int hf_flat_interface(void);
/* Returns the version of the library as a constant string, such as "0.1.0 (v0.1.0)". */
const char *hf_flat_version(void);

/* Returns the word for a code in a list, or NULL if the list does not contain the code. The argument `list` is "role",
 * "group", "law", "phase", "status", "stop_reason", "bound_reason" or "coupling_stop". */
const char *hf_flat_word(const char *list, int code);
/* Returns the code of a word in a list, or -1 if the list does not contain the word. */
int hf_flat_code(const char *list, const char *word);

/* Creates a handle. Returns NULL if memory runs out. */
hf_flat *hf_flat_create(void);
/* Frees a handle, which may be NULL. */
void hf_flat_free(hf_flat *flat);
/* Returns the messages of the last call as lines "error: ..." and "warning: ...", or "" if the call added no
 * messages. */
const char *hf_flat_messages(const hf_flat *flat);

/* ---- A case ---- */

/* Opens a case file with the n_set overrides in the array `set`. An override has the form "key=value". The argument
 * n_thread is the number of threads that evaluate designs. If n_thread is 0, the threads use all cores. The function
 * hf_flat_open does not compute a shape. For each handle, call either hf_flat_open or hf_flat_open_net once. Returns
 * HF_OK, HF_BAD_CASE, HF_MECHANISM, HF_NO_MEMORY or HF_NO_LAPACK. A second call returns HF_BAD_USAGE. */
int hf_flat_open(hf_flat *flat, const char *path, int n_set, const char *const *set, int n_thread);

/* Sets the nodes of a net in memory. The arguments have the same meaning as the members of hf_scene_arrays
 * (scene_arrays.h). A NULL argument has the same meaning as a NULL member of hf_scene_arrays. Call hf_flat_nodes and
 * hf_flat_cables before hf_flat_open_net. If the net has sets, also call hf_flat_sets before hf_flat_open_net. */
void hf_flat_nodes(hf_flat *flat, int n_node, const double *position_m, const unsigned char *role, const double *load_N,
                   const char *const *node_id);
/* Sets the cables of a net in memory. The rules of hf_flat_nodes apply. */
void hf_flat_cables(hf_flat *flat, int n_cable, const int *end, const unsigned char *group, const unsigned char *law,
                    const double *value, const double *EA_N, const char *const *cable_id);
/* Sets the named sets of cables of a net in memory. The rules of hf_flat_nodes apply. */
void hf_flat_sets(hf_flat *flat, int n_set, const char *const *name, const int *start, const int *cable);
/* Opens a case whose net is in memory. All other rules of hf_flat_open also apply to hf_flat_open_net. The argument
 * `text` is the text of a case file that contains the scene import: {nodes: nodes.csv, cables: cables.csv}. The
 * function reads neither nodes.csv nor cables.csv. The argument `name` is the name of the case in messages. */
int hf_flat_open_net(hf_flat *flat, const char *name, const char *text, int n_set, const char *const *set,
                     int n_thread);

/* ---- Reading ---- */

/* Returns string i of a list. Returns NULL if i is beyond the last string, if the list is unknown, or if no case is
 * open:
 *
 *   title, solver (after hf_flat_form)      i = 0
 *   node_id, cable_id, set_name             of the net
 *   variable, variable_unit                 names and units of the design variables
 *   objective                               names of the objectives
 *   figure, figure_unit, figure_help        figures of a design: rows of hf_flat_evaluate
 *   result, result_unit, result_help        figures of a shape: the reals "result"
 *   result_kind                             "real", "int", or the list of its words ("status", "stop_reason", ...)
 *   slope                                   figures that have derivatives
 *   block                                   blocks of the residuals of a design (hf_problem_block)
 *   summary                                 i = 0: JSON object of hifdm run --json, for the last hf_flat_run */
const char *hf_flat_text(hf_flat *flat, const char *list, int i);

/* Copies integers to the array `to` and returns the number of integers. If `to` is NULL, the function only returns the
 * number of integers. Returns -1 for an unknown name and 0 before a case is open:
 *
 *   end [n_cable][2], role [n_node], group, law [n_cable]
 *   variable_cable [n_variable]     cable of each design variable; -1: the variable displaces a support
 *   block_rows [n_block]            number of rows of each block of residuals
 *   variable_leader [n_variable]    design variable that each one follows by symmetry, or the variable itself
 *   set_start [n_set + 1], set_cable */
int hf_flat_ints(const hf_flat *flat, const char *name, int *to);

/* Copies real numbers in SI units, in the same way as hf_flat_ints. Returns 0 if the numbers do not exist yet:
 *
 *   target_position_m [n_node][3]           target positions
 *   load_N [n_node][3] or none, target [n_cable], EA_N [n_cable] or none
 *   initial, lower, upper [n_variable]      after hf_flat_form: initial design, and the bounds of optimize around it,
 *                                           an open side is infinite
 *   position_m [n_node][3]; length_m, tension_N, q_N_per_m [n_cable]; result [n_result]
 *                                           of the last hf_flat_form or hf_flat_shape */
int hf_flat_reals(const hf_flat *flat, const char *name, double *to);

/* ---- Computation ---- */

/* Finds the shape of the case. Returns HF_OK, HF_NOT_CONVERGED or the status of an ill-posed net. Returns HF_BAD_USAGE
 * without a case. Returns HF_BAD_CASE if the optimisation cannot start from the shape of the case. Returns HF_NO_MEMORY
 * if memory runs out, and HF_NO_LAPACK if LAPACK cannot be loaded. */
int hf_flat_form(hf_flat *flat);

/* Evaluates the n designs in the array design [n][n_variable] in parallel, in the same way as `hifdm evaluate`. The
 * array figure [n_figure][n] receives one row for each string of the list "figure". The first row of the array contains
 * the status code of each design. Returns HF_OK, even if designs are infeasible. Returns HF_BAD_CASE if a value is not
 * finite, or if a design variable of a cable has a value that is not above zero. Returns HF_BAD_USAGE if hf_flat_form
 * has not been called, and HF_NO_MEMORY if memory runs out. */
int hf_flat_evaluate(hf_flat *flat, int n, const double *design, double *figure);

/* Finds the shape of one design, the array design [n_variable]. Read the shape with hf_flat_reals. The status of the
 * design is part of the numbers "result" (hf_flat_reals). The function returns the same status codes as
 * hf_flat_evaluate. */
int hf_flat_shape(hf_flat *flat, const double *design);

/* Computes the derivatives of n designs [n][n_variable] with respect to the design variables (hf_problem_slopes).
 * Writes the derivatives to the array slope [n][n_slope][n_variable]. The derivatives of infeasible designs are NaN.
 * Returns the same status codes as hf_flat_evaluate, and HF_BAD_CASE if there are no derivatives. */
int hf_flat_slopes(hf_flat *flat, int n, const double *design, double *slope);

/* Computes the residuals of one design [n_variable] and their derivatives (hf_problem_residuals). Bit i of the argument
 * `blocks` selects block i. The array residual [n_row] and, unless it is NULL, the array jacobian [n_row][n_variable]
 * receive the rows of the selected blocks. Returns the same status codes as hf_flat_slopes. If the design has no shape,
 * returns the status of the design. */
int hf_flat_residuals(hf_flat *flat, const double *design, int blocks, double *residual, double *jacobian);

/* Computes product [n_variable], the product of the transposed Jacobian of the selected blocks and vector [n_row]
 * (hf_problem_vjp). The rules of hf_flat_residuals apply. */
int hf_flat_vjp(hf_flat *flat, const double *design, int blocks, const double *vector, double *product);

/* Receives the progress of a run. If the observer returns a value other than 0, the run stops. The argument `phase` is
 * a code of the list "phase". The arguments `done` and `all` count generations, samples, steps of Levenberg-Marquardt
 * or points of a Pareto front. The struct hf_run_progress in run.h describes the other arguments. */
typedef int hf_flat_observer(void *context, int phase, long done, long all, long evaluations, double best_psi_m,
                             double elapsed_s);

/* Runs the case as `hifdm run` does, including its load cases and samples. Writes the result file `output`, unless
 * `output` is NULL. If `output` is an unfinished result file and restart is 0, the function resumes the run. Any thread
 * may call the observer, but calls never overlap. The observer may be NULL. Returns the status of hf_run_case, or
 * HF_BAD_USAGE if no case is open. The function hf_flat_text returns the results of the run as the list "summary". */
int hf_flat_run(hf_flat *flat, const char *output, int restart, hf_flat_observer *observer, void *context);

/* Sets the command that checks an existing output file before a run reads the file. A separate program is necessary
 * because HDF5 crashes on some damaged files. The string command[0] is the path of the program. The array `command`
 * contains at most 8 words and ends with NULL. The words are borrowed. hifdm calls the program with the words of
 * `command` and the path of the file. The program calls hf_flat_read and exits with status 0. If `command` is NULL, or
 * if the program fails, fork(2) copies the process and the copy reads the file. If another thread holds a lock when
 * fork(2) copies the process, the copy waits for this lock forever. If other threads use HDF5 or if HDF5 has callbacks,
 * the process must therefore set a command before its first run. The Python package sets one. */
void hf_flat_set_reader(const char *const *command);

/* Reads a result file in the same way as hf_flat_run. The function hf_flat_read may crash or end the process. */
void hf_flat_read(const char *path);

/* Stops the current run. Any thread or signal handler may call hf_flat_stop. The stopped call of hf_flat_run returns
 * HF_INTERRUPTED. */
void hf_flat_stop(hf_flat *flat);

HF_API_END
