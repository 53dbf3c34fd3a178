/* store - one HDF5 file per run, and a journal beside it while the run is unfinished.
 * Stability: stable.
 *
 * hifdm writes the file under a temporary name and renames the file after completion. The visible file is always
 * complete. The journal contains the results that are not yet in the file. The commands `show`, `report` and `export`
 * read the file. Pipeline:
 *
 *   hf_store_create or hf_store_resume       provenance, case, scene
 *   hf_store_form                            shape of the form-finding
 *   hf_store_variables, hf_store_generation  search; hf_store_publish between the generations
 *   hf_store_shape, hf_store_front, ...      shapes and results of the later stages
 *   hf_store_finish                          summary; the file gets its final name
 *
 * The following list shows the layout of a file for n nodes, m cables and k design variables. Every data set has the
 * attributes `units` and `description`. The unit "" means that the data set is dimensionless. Roles, groups, laws,
 * statuses and similar values are HDF5 enumerations. All strings are encoded in UTF-8. HDF5 1.10 crashes on damaged
 * strings of variable length. Therefore, strings that hifdm reads back have a fixed length. The strings of fixed length
 * are provenance, title, warnings, case_path, ids and names. All other strings have a variable length. Times, threads
 * and host are stored only as attributes, so the data sets of two runs of the same case are equal.
 *
 *   /            attributes: program ("hifdm"), format_version (3), version, git_describe, compiler, build_flags,
 *                hdf5_version, gsl_version, lapack, rng, host, argv[], started_utc, published_utc, finished_utc, title,
 *                seed, threads, warnings, has_search, has_refine, finished (FALSE: the run can be resumed), status (of
 *                the run, or "unfinished"), identity (hf_store_identify), keeps_earlier (internal); after a resumption
 *                sessions, resumed_utc, resumed_host, resumed_version (of the last one); under Slurm slurm_job_id,
 *                slurm_array_job_id, slurm_array_task_id, slurm_restart_count
 *   /case        text, overrides; attributes sha256, case_path; front_point, front_file, front_design_sha256 if the
 *                result is a point of the Pareto front in that file
 *   /scene/node  id [n], position_m [n][3] (target positions), role [n]; load_N [n][3] if there are loads
 *   /scene/cable id, group, law, target, length_m (between target positions) [m], end [m][2]; EA_N [m] if any is given
 *   /scene/set   if there are named sets of cables: name [s], start [s + 1] of s sets, cable (index into /scene/cable)
 *                [c] with c cables in all; set i has cable[start[i]] to cable[start[i + 1] - 1]
 *   /scene/facet [f][4] if an import has f facets
 *   /form        shape of the form-finding: position_m [n][3]; length_m, tension_N, q_N_per_m, law [m];
 *                attributes: version, HF_SUMMARY_FORM_LIST, HF_RESULT_LIST, wall_s
 *   /form/history  after each of i iterations or steps: psi_m, residual_N, inner_tension_ratio, boundary_tension_ratio,
 *                length_error [i]
 *   /coupling    with a truss that has a attachments: node [a], displacement_m, force_N [a][3] after form-finding;
 *                history/step_m, psi_m, deflection_max_m [iterations]; attributes: HF_COUPLING_LIST
 *   /variable    of a run with a search: cable (index into /scene/cable), group (number of its chain), initial, lower,
 *                upper [k]; leader [k] with a symmetry; with optimize.variables also row (of optimize.variables), node
 *                (index into /scene/node) [k], direction [k][3]
 *   /search      shape of the best design as in /form, design [k]; attributes: algorithm ("ga", "nsga2"),
 *                HF_SUMMARY_SEARCH_LIST, HF_RESULT_LIST, wall_s; with a truss HF_COUPLING_LIST as coupling_...
 *   /search/population  of g generations of p individuals: design [d][k], each of d designs once; design_row [g][p];
 *                evaluated, status, psi_m, residual_N, inner_tension_ratio, boundary_tension_ratio, iterations,
 *                violation, merit, trial_status, trial_psi_m, crossover_rate, mutation_rate [g][p]; parent [g][p][2];
 *                of a front objective_0, objective_1, objective_2 [g][p]; best_individual, best_psi_m, best_merit,
 *                violation_min, mean_psi_m, worst_psi_m, n_infeasible [g]; attributes n_individual, n_variable,
 *                n_objective, generations_limit, store_every (0: best, 1: all), from which a run is resumed. With
 *                optimize.store best, the rows of [g][p] are those of the best individual, [g][1]; with every and
 *                store_every r, those of generations 0, r, 2r, ...
 *   /search/population/last  with best and every, the arrays of the last generation [1][p]; attributes n_evaluation,
 *                n_evaluation_infeasible, n_evaluation_above_cap of all generations
 *   /refine      shape of the refinement, or of the selected point of a front, as in /search; attributes:
 *                algorithm ("lm"), HF_SUMMARY_REFINE_LIST, HF_RESULT_LIST, wall_s; with a truss coupling_...
 *   /refine_state  state of Levenberg-Marquardt after its last step, from which it can continue: opaque numbers;
 *                attribute wall_s
 *   /surface     with a section surface: attributes kind, focal_length_m, strip_width_m, mesh_tension_N_per_m;
 *                frequency_Hz [f]
 *   /surface/STAGE  STAGE is form, search or refine; attributes: HF_SURFACE_LIST, HF_SURFACE_FIT_LIST as fit_...;
 *                HF_SURFACE_LOSS_LIST [f]
 *   /pattern/STAGE  with surface.pattern, for f frequencies, c cuts, t angles: frequency_Hz [f], phi_deg [c],
 *                theta_deg [t]; co_dBi, cross_dBi [f][c][t]; gain_dBi, beam_deg, half_power_width_deg,
 *                first_sidelobe_dB, highest_sidelobe_dB [f][c]; attributes: the feed
 *   /set_tension/STAGE  of the first s <= HF_SUMMARY_SETS named sets: name, min_N, max_N, ratio [s]
 *   /at_limit/STAGE  if the shape is at h limits: row of optimize.limits, or -1 for the cap on the boundary tension
 *                ratio; count, name, value, bound [h]
 *   /objective   of o rows of optimize.objective or optimize.front: name, after_fit [o]; weight [o] of
 *                optimize.objective; values in the shapes of form, search, refine [o], if these exist
 *   /front       of optimize.front with p points: name, initial (of the initial design) [o]; objective, multiplier
 *                [p][o]; status, mark, steps, converged [p]; design [p][k]; variable (names) [k]; attributes n_on,
 *                n_dominated, n_failed, minimised, knee (index of a point, -1: none), wall_s
 *   /load_cases  if there are c load cases: name [c] in the order of the case
 *   /load_cases/NAME  shape as in /form, unless it has none; attributes: HF_RESULT_LIST, HF_LOAD_CASE_LIST,
 *                HF_COUPLING_LIST as coupling_...; surface as in /surface/STAGE; with a truss of a nodes and b members
 *                truss/node/displacement, truss/node/reaction [a][6], truss/member/end_force [b][12]
 *   /tolerance   with a section tolerance: attributes HF_TOLERANCE_LIST, histogram_low_m, histogram_high_m; for q
 *                measures: measure (names), is_measured, mean, mean_low, mean_high, deviation, min, max [q]; quantile,
 *                quantile_low, quantile_high [q][3]; ranked_cable, ranked_share; error_kind, kind_share; histogram;
 *                cable_share, psi_by_cut [m], node_deviation_m [n]
 *   /tolerance/sample  of each sample: status, first_order_psi_m, and the measures by name
 *   /truss       with a nodes, b members, c attachments; attributes: HF_SUMMARY_TRUSS_LIST
 *   /truss/node  id, mass_kg [a], position_m [a][3], fixed [a][6]; displacement, reaction [a][6]
 *   /truss/member  id, joint, unit, E_Pa, A_m2, ..., expansion_per_K [b], end [b][2]; end_force [b][12]
 *   /truss/attachment  net_node (index into /scene/node), truss_node (into /truss/node) [c]
 *   /VTKHDF      of a finished run: its shapes as a grid that ParaView opens, linked to the data sets above; the list
 *                of its arrays is at the top of src/store/vtkhdf.h
 *
 * hifdm also reads files of version 0.2. A finished file also contains the names of version 0.2 as soft links and as
 * copies of attributes (src/manual/renames.md). Version 0.4 will no longer write the names of version 0.2. */
#pragma once

#include <hifdm/api.h>
#include <hifdm/config.h>
#include <hifdm/model.h>
#include <hifdm/optimiser.h>
#include <hifdm/summary.h>
#include <hifdm/workspace.h>

HF_API_BEGIN

/* Represents the file of a run that is being written. Only one thread at a time may use a store. */
typedef struct hf_store hf_store;

/* Several threads may call the functions of this header at the same time if each thread uses a different store. The
 * functions that read a file need no store and have no such restriction. Calls from several threads wait for each other
 * because HDF5 works for one thread at a time. */

/* Contains the names of the HDF5 groups with shapes: "/form", "/search", "/refine" and "/". */
extern const char *const hf_stage_group[HF_N_STAGE + 1];

/* Returns the stage whose shape is the result of a finished run. */
hf_stage hf_store_result_stage(const hf_summary *summary);

/* Computes the identity of a run as 64 hexadecimal digits and a NUL. The identity is a digest of the case text, the
 * overrides, the seed, the tables of load cases and the selected point of a Pareto front. The digest also includes the
 * scene and the truss with their ids. If the case has no truss, the argument `truss` is NULL. Returns HF_OK or
 * HF_NO_MEMORY. */
hf_status hf_store_identify(const hf_case *settings, const hf_scene *scene, const hf_truss *truss, char identity[65]);

/* Describes the kind of object that exists at a path. */
typedef enum { HF_STORE_NOTHING, HF_STORE_UNFINISHED, HF_STORE_FINISHED } hf_store_state;

/* Determines whether `path` contains nothing, an unfinished result or a finished result. The function accepts a result
 * only if the result belongs to this case, scene and truss. Returns HF_OK, HF_IO or HF_NO_MEMORY. Returns HF_EXISTS if
 * `path` is the name of any other result or file. The message lists the keys in which the cases differ. */
hf_status hf_store_look(const char *path, const hf_case *settings, const hf_scene *scene, const hf_truss *truss,
                        hf_store_state *state, hf_messages *messages);

/* Creates the file of a new run and writes the case, the scene and the provenance. The array argv [argc] is part of the
 * provenance. The number argc may be 0. The store borrows none of the arguments. The function checks the name `path`
 * before the run computes results. Returns HF_OK or HF_NO_MEMORY. Returns HF_EXISTS if the name is in use and `restart`
 * is false. Returns HF_IO if the name is a folder, if another process writes the file, or if the file cannot be
 * created. If the folder of the file does not exist or is not writable, the function also returns HF_IO. If
 * hf_store_create fails, *store is NULL. */
hf_status hf_store_create(const char *path, bool restart, const hf_case *settings, const hf_scene *scene,
                          const hf_truss *truss, int argc, char *const *argv, hf_store **store, hf_messages *messages);

/* Opens the unfinished file at `path` to resume its run. Returns HF_OK, HF_IO or HF_NO_MEMORY. Returns HF_EXISTS if the
 * file is finished. If the function fails, *store is NULL and the file is unchanged. */
hf_status hf_store_resume(const char *path, hf_store **store, hf_messages *messages);

/* Opens the finished file at `path` to continue its refinement. The function omits the results that follow the
 * refinement. The visible file stays unchanged until hf_store_settle replaces it, and hf_store_publish has no effect.
 * Returns HF_OK, HF_IO or HF_NO_MEMORY. Returns HF_EXISTS if the file contains no state of Levenberg-Marquardt. If the
 * function fails, *store is NULL. */
hf_status hf_store_continue(const char *path, hf_store **store, hf_messages *messages);

/* Adds the generations of the journal to the unfinished file at `path` and reads the summary of the file. The function
 * computes no new results. If the file is finished, the function leaves the file unchanged and adds a warning. Returns
 * the same status codes as hf_store_resume. If this build proposes other designs than the build that wrote the journal,
 * the function also returns HF_EXISTS. */
hf_status hf_store_recover(const char *path, hf_summary *summary, hf_messages *messages);

/* Returns the number of generations in the store, including those in the journal. */
int hf_store_generations(const hf_store *store);

/* All functions that write return HF_OK, HF_IO or HF_NO_MEMORY. A function that fails to write adds a message. After a
 * failed write, the store is unusable. Later calls with this store write nothing, add no message and return the same
 * status. The only exception is hf_store_complete. If `store` is NULL, the functions that write have no effect and
 * return HF_OK. */

/* Writes the shape in the workspace in the order of the scene. Unless `history` is NULL, the function also writes the
 * history of the iterations. Call hf_store_form once per store. If the store is resumed, the function does not write
 * the shape but compares the shape with the stored shape. If the tensions of the two shapes differ in the last bits,
 * the function adds a warning. If the tensions of the two shapes differ by more than 1e-5 of the maximum tension, the
 * function returns HF_EXISTS. */
hf_status hf_store_form(hf_store *store, const hf_model *model, const hf_workspace *workspace,
                        const hf_history *history, hf_messages *messages);

/* Writes the initial design, the bounds and the cables of the design variables. Call hf_store_variables once, after the
 * population is created. If the store is resumed, it already contains these data and the function writes nothing. */
hf_status hf_store_variables(hf_store *store, const hf_model *model, const hf_population *population,
                             hf_messages *messages);

/* Appends the generation that hf_optimiser_tell has just ranked. If the status is HF_OK, the generation is preserved
 * even if this process ends. The same build of hifdm can restore the generation (hf_store_restore). If the status is
 * HF_IO and hf_store_publish was called after hf_store_variables, all earlier generations are preserved. */
hf_status hf_store_generation(hf_store *store, const hf_model *model, const hf_population *population,
                              hf_messages *messages);

/* Reads the initial design of the genetic algorithm from a resumed store into the array initial [n_variable]. The
 * stored values are necessary because this machine may compute values that differ in the last bits. If the store has no
 * initial design, `initial` is unchanged. */
hf_status hf_store_restore_initial(hf_store *store, int n_variable, double *initial, hf_messages *messages);

/* Restores the state that the optimiser had before hf_optimiser_tell for the last generation in the store. The caller
 * must have just created the optimiser from the design of hf_store_restore_initial. The summary receives the values of
 * the best individual so far. The optimiser again proposes the designs of the generations in the journal. If this build
 * does not propose the designs in the journal, the function omits these generations and adds a warning. If the store
 * has no generation, the function does nothing. */
hf_status hf_store_restore(hf_store *store, hf_optimiser *optimiser, hf_summary *summary, hf_messages *messages);

/* Copies the state of Levenberg-Marquardt in the array state [n] and the elapsed time wall_s in s. Later publications
 * and the finished file include this state. */
hf_status hf_store_refine(hf_store *store, double wall_s, size_t n, const double *state, hf_messages *messages);
/* Reads the state of Levenberg-Marquardt in a resumed store. The function sets *wall_s to the elapsed time in s, *state
 * to the state, and *n to the size of the state. If the store contains no state of Levenberg-Marquardt, *n is 0. The
 * array *state is borrowed until the next call of hf_store_refine. */
hf_status hf_store_restore_refine(hf_store *store, double *wall_s, size_t *n, const double **state,
                                  hf_messages *messages);

/* Publishes all results so far. The published file has the visible name and is marked as unfinished. If at_once is
 * true, the function publishes immediately. If at_once is false, the function publishes only if enough time has passed
 * since the last publication. The time between two publications is at least 2 s and at least 50 times the duration of
 * the earlier publication. Publishing therefore takes less than 2 % of the run time. A search also does not publish if
 * the copy of the file would make hifdm write more than twice the bytes of the final file. Call hf_store_publish after
 * every generation. */
hf_status hf_store_publish(hf_store *store, const hf_summary *summary, bool at_once, hf_messages *messages);

/* Writes the shape in the workspace and its design [model->n_variable] for the stage HF_STAGE_SEARCH or
 * HF_STAGE_REFINE. Call hf_store_shape once per stage. */
hf_status hf_store_shape(hf_store *store, hf_stage stage, const hf_model *model, const hf_workspace *workspace,
                         const double *design, hf_messages *messages);

/* Writes the Pareto front and replaces an earlier Pareto front. The summary contains the names of the objectives. */
hf_status hf_store_front(hf_store *store, const hf_scene *scene, const hf_model *model, const hf_summary *summary,
                         const hf_front *front, hf_messages *messages);
/* Reads the Pareto front that an earlier session of this run has stored, and the time in seconds that it took. Without
 * one, n_point is 0. The caller frees the front. Returns HF_OK, HF_NO_MEMORY or HF_IO. */
hf_status hf_store_restore_front(hf_store *store, int n_variable, hf_front *front, double *wall_s,
                                 hf_messages *messages);

/* Writes the far field of the shape of a stage and replaces an earlier far field. */
hf_status hf_store_pattern(hf_store *store, hf_stage stage, const hf_pattern_table *table,
                           const hf_pattern_summary *figures, hf_messages *messages);
/* Reads the far field of the shape of a stage. Returns HF_OK or HF_NO_MEMORY. Returns HF_IO if the file cannot be read
 * or contains no far field. Call hf_pattern_table_free even if hf_store_read_pattern fails. */
hf_status hf_store_read_pattern(const char *path, hf_stage stage, hf_pattern_table *table, hf_messages *messages);

/* Writes the shape in the workspace as the shape of load case `name` of the as-built net. The function replaces an
 * earlier shape of this load case. The argument `truss` contains the displacements and forces of the truss in this load
 * case. If the case has no truss, the argument `truss` is NULL. */
hf_status hf_store_built(hf_store *store, const char *name, const hf_model *model, const hf_workspace *workspace,
                         const hf_carrier *carrier, const hf_carrier_state *truss, hf_messages *messages);

/* Writes the summary, closes the file and renames the file to its final name. Calls hf_store_complete and
 * hf_store_settle. The function frees the store even if the function fails. If the function fails, the published file
 * and the journal remain unchanged. If the file is complete but cannot have its final name (HF_EXISTS, HF_IO), the file
 * keeps another name. If the file keeps another name, the message contains this name. */
hf_status hf_store_finish(hf_store *store, const hf_summary *summary, hf_messages *messages);

/* Writes the summary and closes the file. The function requires processor time. Even if hf_store_complete fails, the
 * caller must call hf_store_settle afterwards. */
hf_status hf_store_complete(hf_store *store, const hf_summary *summary, hf_messages *messages);
/* Writes the file from the cache to the disk and renames the file. The function mostly waits for the disk. Another
 * thread may therefore call hf_store_settle. The function frees the store even if the function fails. */
hf_status hf_store_settle(hf_store *store, hf_messages *messages);

/* Frees the store, which may be NULL. The published file remains on the disk. The journal also remains, with the
 * generations that the file does not contain. */
void hf_store_end(hf_store *store);
/* Frees the store in the same way as hf_store_end. If the function cannot remove a temporary file, it adds a
 * warning. */
void hf_store_abandon(hf_store *store, hf_messages *messages);

/* Contains a stored shape in the order of the scene. */
typedef struct {
    double *position_m;                       /* [n_node][3] positions of the nodes */
    double *length_m, *tension_N, *q_N_per_m; /* [n_cable] lengths, tensions and force densities */
    unsigned char *law;                       /* [n_cable] law in effect (hf_law) */
    void *block;                              /* owned memory behind the arrays */
} hf_shape;

/* The functions that read return HF_OK or HF_NO_MEMORY. If the file does not exist, is not a file of hifdm, or is
 * damaged, the functions that read return HF_IO and add one message. If a function that reads fails, all members of its
 * output are zero. */

/* Reads all members of the summary. The values are bit-for-bit identical to the values that hf_store_finish received.
 * If a stage does not exist, all its values are 0. Call hf_summary_free even if hf_store_read_summary fails. */
hf_status hf_store_read_summary(const char *path, hf_summary *summary, hf_messages *messages);

/* Reads the scene without its line numbers. Call hf_scene_free even if hf_store_read_scene fails. */
hf_status hf_store_read_scene(const char *path, hf_scene *scene, hf_messages *messages);

/* Reads the shape of a stage. If the file does not contain this shape, the function also returns HF_IO. The shape has
 * the same numbers of nodes and cables as the scene of hf_store_read_scene. Call hf_shape_free even if
 * hf_store_read_shape fails. */
hf_status hf_store_read_shape(const char *path, hf_stage stage, hf_shape *shape, hf_messages *messages);
/* Reads the shape of load case `name`, in the same way as hf_store_read_shape. */
hf_status hf_store_read_load_case(const char *path, const char *name, hf_shape *shape, hf_messages *messages);
/* Frees the arrays of a shape. */
void hf_shape_free(hf_shape *shape);

/* Reads the Pareto front and the names of its design variables. The array *variable contains n_variable names of
 * *variable_size bytes each. If the file contains no Pareto front, the function also returns HF_IO. Free the front with
 * hf_front_free and *variable with free, even if hf_store_read_front fails. */
hf_status hf_store_read_front(const char *path, hf_front *front, char **variable, size_t *variable_size,
                              hf_messages *messages);

/* Writes the keys in which the case of a result differs from this case to text[size]. The list of keys has the format
 * of hf_config_differences. Returns the number of keys that differ. If the result cannot be read, the function returns
 * 0. */
int hf_store_case_differences(const char *path, const hf_case *settings, char *text, size_t size);

/* Writes the description of the truss and its attachments to the group /truss. If `state` is not NULL, the function
 * also writes the displacements and forces of the truss under the forces of the net. If has_truss is set in the
 * summary, call hf_store_truss once before hf_store_finish. */
hf_status hf_store_truss(hf_store *store, const hf_carrier *carrier, const hf_carrier_state *state,
                         hf_messages *messages);

/* Reads the truss without its line numbers. The function also reads the displacements and forces of the truss. If the
 * file contains no displacements and forces, the pointers to them are NULL. If the file contains no truss, the function
 * also returns HF_IO. Call hf_truss_free and hf_carrier_state_free even if hf_store_read_truss fails. */
hf_status hf_store_read_truss(const char *path, hf_truss *truss, hf_carrier_state *state, hf_messages *messages);

/* Reads the displacements and forces of the truss in load case `name`. The argument `truss` is the truss that
 * hf_store_read_truss returned. If the load case has no shape, the function also returns HF_IO. Call
 * hf_carrier_state_free even if hf_store_read_load_case_truss fails. */
hf_status hf_store_read_load_case_truss(const char *path, const char *name, const hf_truss *truss,
                                        hf_carrier_state *state, hf_messages *messages);

/* Returns "VERSION (git describe)" of this library as a constant string. */
const char *hf_store_version(void);

/* Disables the error output of HDF5 and its exit handler. The exit handler crashes if the disk was full. Call
 * hf_store_quiet once before the first call of HDF5. Returns false if there is not enough memory for HDF5. HDF5 would
 * crash if there were too little memory. */
bool hf_store_quiet(void);

HF_API_END
