/* flat - the library for other languages: one opaque handle, plain arrays, numbers and words, but no structs.
 * Stability: stable; a program compares the value of hf_flat_interface() with the number for which it was written.
 *
 * The Python package (tools/python) uses this interface. Programs in Julia, MATLAB or Fortran can use it in the same
 * way. A handle holds one case. Pipeline:
 *
 *   hf_flat_create
 *   hf_flat_open, or arrays of a net and hf_flat_open_net   case -> model
 *   hf_flat_form                                            shape of the case
 *   hf_flat_evaluate, hf_flat_shape, hf_flat_slopes         designs -> figures, one shape, derivatives
 *   hf_flat_free
 *
 * hf_flat_run executes a complete run and does not need hf_flat_form. The functions hf_flat_text, hf_flat_ints and
 * hf_flat_reals return results by name.
 *
 * Status: functions return hf_status as a number, and 0 is ok. The functions hf_status_word and hf_status_text
 * (status.h) convert the number to text. hf_flat_messages returns the errors and warnings of the last call.
 *
 * Memory: the handle borrows the arguments of hf_flat_open, hf_flat_open_net, hf_flat_nodes, hf_flat_cables and
 * hf_flat_sets until hf_flat_free. The handle copies all other arguments. A returned string is valid until the next
 * call with the same handle.
 *
 * Threads: only one thread at a time may use a handle. hf_flat_stop is the exception. A program may use any number of
 * handles at the same time.
 *
 * Waiting: set OMP_WAIT_POLICY=passive and GOMP_SPINCOUNT=2000 in the environment before the library is loaded, as the
 * Python package does. The comment of hf_batch_wait_quietly in batch.h gives the reason.
 *
 * GSL: call gsl_set_error_handler_off() once. The header hifdm.h gives the reason. */
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

/* Returns the word for a code, or NULL if there is none. The argument `list` is "role", "group", "law", "phase",
 * "status", "stop_reason", "bound_reason" or "coupling_stop". */
const char *hf_flat_word(const char *list, int code);
/* Returns the code of a word in one of these lists, or -1 if there is none. */
int hf_flat_code(const char *list, const char *word);

/* Creates a handle. Returns NULL if memory runs out. */
hf_flat *hf_flat_create(void);
/* Frees a handle, which may be NULL. */
void hf_flat_free(hf_flat *flat);
/* Returns the lines "error: ..." and "warning: ..." of the last call, or "" if there are none. */
const char *hf_flat_messages(const hf_flat *flat);

/* ---- A case ---- */

/* Opens a case file with the n_set overrides set [n_set], which have the form "key=value". Designs are later evaluated
 * by n_thread threads, or by all cores if n_thread is 0. This function does not compute a shape. Call either this
 * function or hf_flat_open_net once per handle. Returns HF_OK, HF_BAD_CASE, HF_MECHANISM, HF_NO_MEMORY or HF_NO_LAPACK.
 * A second call returns HF_BAD_USAGE. */
int hf_flat_open(hf_flat *flat, const char *path, int n_set, const char *const *set, int n_thread);

/* Sets the nodes of a net in memory. The arguments are the members of hf_scene_arrays (scene_arrays.h). NULL has the
 * same meaning as in that struct. Call this function and hf_flat_cables before hf_flat_open_net. If the net has sets,
 * also call hf_flat_sets before it. */
void hf_flat_nodes(hf_flat *flat, int n_node, const double *position_m, const unsigned char *role, const double *load_N,
                   const char *const *node_id);
/* Sets the cables of a net in memory. The rules of hf_flat_nodes apply. */
void hf_flat_cables(hf_flat *flat, int n_cable, const int *end, const unsigned char *group, const unsigned char *law,
                    const double *value, const double *EA_N, const char *const *cable_id);
/* Sets the named sets of cables of a net in memory. The rules of hf_flat_nodes apply. */
void hf_flat_sets(hf_flat *flat, int n_set, const char *const *name, const int *start, const int *cable);
/* Opens a case whose net is in memory. The other rules are those of hf_flat_open. The argument `text` is the text of a
 * case file whose scene is import: {nodes: nodes.csv, cables: cables.csv}. The function does not read these two files.
 * The argument `name` is the name of the case in messages. */
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
 *   summary                                 i = 0: JSON object of hifdm run --json, for the last hf_flat_run */
const char *hf_flat_text(hf_flat *flat, const char *list, int i);

/* Copies integers to `to`, unless it is NULL, and returns the number of integers. Returns -1 for an unknown name and 0
 * before a case is open:
 *
 *   end [n_cable][2], role [n_node], group, law [n_cable]
 *   variable_cable [n_variable]     cable of each design variable; -1: the variable displaces a support
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
 * without a case. Returns HF_BAD_CASE if the section optimize cannot start from the shape. Returns HF_NO_MEMORY or
 * HF_NO_LAPACK if memory or LAPACK is missing. */
int hf_flat_form(hf_flat *flat);

/* Evaluates the n designs design [n][n_variable] on all cores, like `hifdm evaluate`. The array figure [n_figure][n]
 * receives one row for each string of the list "figure". The first row has the status code of each design. Returns
 * HF_OK, even if designs are infeasible. Returns HF_BAD_CASE if a value is not finite, or if a value of a cable is not
 * above zero. Returns HF_BAD_USAGE before hf_flat_form, and HF_NO_MEMORY if memory runs out. */
int hf_flat_evaluate(hf_flat *flat, int n, const double *design, double *figure);

/* Finds the shape of one design [n_variable]. Read the shape with hf_flat_reals. The status of the design is in the
 * result of the shape. The function returns the same status codes as hf_flat_evaluate. */
int hf_flat_shape(hf_flat *flat, const double *design);

/* Computes the derivatives of n designs [n][n_variable] with respect to the design variables (hf_problem_slopes).
 * Writes them to slope [n][n_slope][n_variable], as NaN for infeasible designs. Returns the same status codes as
 * hf_flat_evaluate, and HF_BAD_CASE if there are no derivatives. */
int hf_flat_slopes(hf_flat *flat, int n, const double *design, double *slope);

/* Receives the progress of a run. A return value other than 0 stops the run. The argument `phase` is a code of the list
 * "phase". The arguments `done` and `all` count generations, samples, steps of Levenberg-Marquardt or points of a
 * front. hf_run_progress in run.h describes the other arguments. */
typedef int hf_flat_observer(void *context, int phase, long done, long all, long evaluations, double best_psi_m,
                             double elapsed_s);

/* Runs the case as `hifdm run` does, including its load cases and samples. Writes the result file `output`, unless it
 * is NULL. If `output` is an unfinished file, a later call resumes it, unless restart is not 0. Any thread may call the
 * observer, but only one thread at a time. The observer may be NULL. Returns the status of hf_run_case, or HF_BAD_USAGE
 * without a case. hf_flat_text returns the figures of the run as the list "summary". */
int hf_flat_run(hf_flat *flat, const char *output, int restart, hf_flat_observer *observer, void *context);

/* Sets the command with which a run first reads an existing output file, because HDF5 crashes on some damaged files.
 * command[0] is the path of a program. At most 8 words are allowed, and NULL terminates them. The words are borrowed.
 * hifdm calls the program with these words and the path of the file. The program calls hf_flat_read and exits with
 * status 0. If `command` is NULL, or if the program fails, a copy of this process by fork(2) reads the file. If another
 * thread holds a lock when the copy is made, the copy waits for this lock for ever. Therefore a process must set a
 * command before its first run if other threads use HDF5 or if HDF5 has callbacks. The Python package sets one. */
void hf_flat_set_reader(const char *const *command);

/* Reads a result file as a run does. This function may crash or end the process. */
void hf_flat_read(const char *path);

/* Stops the current run. Any thread or signal handler may call this function. hf_flat_run then returns
 * HF_INTERRUPTED. */
void hf_flat_stop(hf_flat *flat);

HF_API_END
