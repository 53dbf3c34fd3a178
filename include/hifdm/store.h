/* store - one HDF5 file per run. The file is written under a temporary name and renamed when it is whole, so that the
 * visible file is always complete; a journal beside it holds what the file does not hold yet. `show`, `report` and
 * `export` read the file.
 * Stability: stable.
 *
 * Layout, with n nodes, m cables, i iterations, g generations, p individuals, k genes. Every data set has the
 * attributes `units` ("" = dimensionless) and `description`. Role, group, law, status and the like are HDF5
 * enumerations. Texts are UTF-8. Those that are read back (provenance, title, warnings, case_path, the version in
 * /form, ids) have a fixed length, because HDF5 1.10 crashes on damaged texts of variable length; the others have a
 * variable length. Times, threads and host are attributes only: the data sets of two runs of the same case are equal.
 *   /            attributes: program ("hifdm"), format_version, version, git_describe, compiler, build_flags,
 *                hdf5_version, gsl_version, lapack, rng, host, argv[], started_utc, finished_utc, title, seed, threads,
 *                warnings, has_optimize, status (word of the run's),
 *                finished (FALSE: the run can go on), published_utc, identity (of the run, see hf_store_identify);
 *                after a resumption sessions, resumed_utc, resumed_host, resumed_version (of the last); under Slurm
 *                slurm_job_id, slurm_array_job_id, slurm_array_task_id, slurm_restart_count
 *   /case        text, overrides; attributes sha256, case_path; front_point, front_file, front_design_sha256 if the
 *                result is a point of the front in that file
 *   /scene/node  id [n], position_m [n][3], role [n]; load_N [n][3] if there are loads
 *   /scene/cable id, group, law, target, length_m (theoretical) [m], end [m][2]; EA_N [m] if any is given
 *   /scene/set   if there are named sets of cables, of the s sets with c cables in all: name [s], start [s + 1],
 *                cable (index into /scene/cable) [c]; set k has cable[start[k]] to cable[start[k + 1] - 1]
 *   /form        position_m [n][3]; length_m, tension_N, q_N_per_m, law [m]
 *                attributes: version, HF_SUMMARY_FORM_LIST, and the figures of hf_summary.form
 *   /form/history  psi_m, residual_N, inner_tension_ratio, boundary_tension_ratio, length_error [i]
 *   /coupling    with a truss, of the a attachments: node [a], displacement_m, force_N [a][3]; history/step_m, psi_m,
 *                max_displacement_m [rounds]; attributes: the members of hf_summary.form.coupling (those of best
 *                and polish are best_coupling_... of /ga and coupling_... of /polish)
 *   /ga          design_N [g][p][k]; evaluated, status, psi_m, residual_N, inner_tension_ratio, boundary_tension_ratio,
 *                iterations, violation, merit, trial_status, trial_psi_m, crossover_rate, mutation_rate [g][p];
 *                parent [g][p][2];
 *                best_individual, best_psi_m, best_merit, least_violation, mean_psi_m, worst_psi_m, n_infeasible [g];
 *                with optimize.store best the rows of [g][p] are of one individual, the best, [g][1]; with every they
 *                are those of generations 0, n, 2n, ..., and both have /ga/last, the same of the last one [1][p], with
 *                attributes n_evaluation, n_evaluation_infeasible, n_evaluation_above_cap of all;
 *                gene_cable (index into /scene/cable), gene_group, base_N, lower_N, upper_N [k]; gene_leader [k] under
 *                a symmetry; attributes: HF_SUMMARY_GA_LIST, the figures of hf_summary.best as best_...; n_individual,
 *                n_variable, generations_limit, store_every (0: best), by which a run goes on
 *                with optimize.variables design, base, lower and upper have no unit in their names, because each gene
 *                has its own, and gene_variable (row of optimize.variables), gene_node, gene_direction [k][3] are there
 *   /ga/best     as /form, and design_N [k]
 *   /polish      the same, of Levenberg-Marquardt; attributes: HF_SUMMARY_POLISH_LIST, the figures of
 *                hf_summary.polish
 *   /polish_state  of an unfinished run that was in Levenberg-Marquardt: its time and where it goes on, opaque numbers
 *   /surface     when the case asks for it: attributes focal_length_m, strip_width_m; frequency_Hz [f]
 *   /surface/form, /surface/optimize, /surface/polish   attributes: HF_SURFACE_LIST, HF_SURFACE_FIT_LIST as fit_...;
 *                gain_loss_dB, fit_gain_loss_dB [f]
 *   /set_tension/form, /set_tension/optimize, /set_tension/polish   of the first s <= HF_SUMMARY_SETS sets of cables,
 *                if there are any: name, least_N, largest_N, ratio [s]
 *   /at_limit/optimize, /at_limit/polish   when the shape is at h limits that its design must keep: row of
 *                optimize.limits or -1, the cap on the boundary; count, name, value, bound [h]
 *   /goals       with g rows of optimize.goals: name, weight [g]; the value of each in the shapes of form, optimize,
 *                polish [g], as far as these ran
 *   /front       of optimize.objectives, with p points, o objectives, k genes: name, base [o]; objective, multiplier
 *                [p][o]; status, mark, iterations [p]; design_N (with optimize.variables design) [p][k]; gene, the name
 *                of each [k]; attributes n_on, n_dominated, n_failed, minimised, knee (index into p, -1: none), wall_s
 *   /cases       states of the net as built, when there are any: name [c] in the order of the case
 *   /cases/NAME  as /form, unless it has no shape; attributes: the figures of its result, those of its coupling as
 *                coupling_..., HF_STATE_LIST; /cases/NAME/surface as /surface/form; with a truss /cases/NAME/truss/node
 *                with displacement, reaction [a][6], /cases/NAME/truss/member with end_force [b][12]
 *   /tolerance   with a section tolerance: attributes HF_TOLERANCE_LIST; figures [m] of the measures named in `measure`
 *                (mean, deviation, ..., quantile [m][3]); require_... of the rows of tolerance.require; ranked_cable,
 *                ranked_share; error_kind, kind_share; histogram; cable_share of each cable, node_deviation_m of each
 *                node; sample/status, first_order_psi_m and the measures of each sample [samples]
 *   /truss       with a nodes, b members, c attachments; attributes mass_kg, n_node, n_member
 *   /truss/node  id, mass_kg [a], position_m [a][3], fixed [a][6]; displacement, reaction [a][6]
 *   /truss/member  id, joint, unit, E_Pa, A_m2, ..., expansion_per_K [b], end [b][2]; end_force [b][12]
 *   /truss/attachment  net_node (index into /scene/node), truss_node (into /truss/node) [c]
 *   /VTKHDF      of a finished run: its shapes as a grid that ParaView opens, linked to the data sets above; the list
 *                of its arrays is at the top of src/store/vtkhdf.h */
#ifndef HIFDM_STORE_H
#define HIFDM_STORE_H

#include <hifdm/api.h>
#include <hifdm/config.h>
#include <hifdm/model.h>
#include <hifdm/optimiser.h>
#include <hifdm/summary.h>
#include <hifdm/workspace.h>

HF_API_BEGIN

typedef struct hf_store hf_store;

/* Several threads may call these functions at once: those that write each with its own store, those that read freely.
 * The calls wait for each other, because HDF5 works for one thread at a time. */

/* The stages of a run that produce a shape. */
typedef enum { HF_STAGE_FORM, HF_STAGE_OPTIMIZE, HF_STAGE_POLISH, HF_STAGE_NONE } hf_stage;
extern const char *const hf_stage_word[4];  /* "form", "optimize", "polish", "none" */
extern const char *const hf_stage_group[4]; /* where a file keeps the shape: "/form", "/ga/best", "/polish", "/" */

/* The stage whose shape is the result of a finished run. */
hf_stage hf_store_result_stage(const hf_summary *summary);

/* The identity of a run: 64 hexadecimal digits of a digest of the case's text and overrides, the seed, the scene and
 * the truss (NULL: none), with their ids. HF_OK or HF_NO_MEMORY. */
hf_status hf_store_identify(const hf_case *settings, const hf_scene *scene, const hf_truss *truss, char identity[65]);

typedef enum { HF_STORE_NOTHING, HF_STORE_UNFINISHED, HF_STORE_FINISHED } hf_store_state;

/* Find out what is at `path`: nothing, or a result of this case, scene and truss. HF_EXISTS for anything else, with a
 * message that says in which keys the cases differ; HF_IO, HF_NO_MEMORY. */
hf_status hf_store_look(const char *path, const hf_case *settings, const hf_scene *scene, const hf_truss *truss,
                        hf_store_state *state, hf_messages *messages);

/* Begin the file of a new run. The name `path` is checked now, not only at the end: HF_EXISTS when it is taken and
 * `restart` is false; HF_IO when it is a folder, when its folder does not exist or is not writable, when another
 * process is writing it, or when the file cannot be made; HF_NO_MEMORY. argv (argc may be 0) goes into the provenance.
 * Case and scene are written at once, nothing is borrowed. *store is NULL after a failure. */
hf_status hf_store_create(const char *path, bool restart, const hf_case *settings, const hf_scene *scene,
                          const hf_truss *truss, int argc, char *const *argv, hf_store **store, hf_messages *messages);

/* Continue the unfinished file at `path`. HF_EXISTS when it is finished, HF_IO, HF_NO_MEMORY. *store is NULL after a
 * failure, and nothing has changed. */
hf_status hf_store_resume(const char *path, hf_store **store, hf_messages *messages);

/* Add the generations of the journal to the unfinished file at `path`, without computing more, and return its summary.
 * A finished file stays as it is; a warning says so. Errors as hf_store_resume; HF_EXISTS also when this build does not
 * propose the designs to which the journal's results belong. */
hf_status hf_store_recover(const char *path, hf_summary *summary, hf_messages *messages);

/* How many generations the store holds, those in the journal included. */
int hf_store_generations(const hf_store *store);

/* The calls that write return HF_OK, HF_IO or HF_NO_MEMORY with a message. After a failure the store cannot be
 * used any more: later calls write nothing and return the same status without a message, except hf_store_complete,
 * which adds one. With store == NULL they write nothing and return HF_OK. */

/* Write the shape in the workspace in the order of the scene, and the history unless it is NULL. Call it once per
 * store. A resumed store compares the shape with the stored one instead: a warning when the tensions differ in their
 * last bits, HF_EXISTS when they differ by more than 1e-5 of the largest. */
hf_status hf_store_form(hf_store *store, const hf_model *model, const hf_workspace *workspace,
                        const hf_history *history, hf_messages *messages);

/* Write base, bounds and gene cables of the population. Call it once the population is created; a resumed store has
 * them already and writes nothing. */
hf_status hf_store_genes(hf_store *store, const hf_model *model, const hf_population *population,
                         hf_messages *messages);

/* Append the generation that hf_optimiser_tell has just ranked. After HF_OK it survives the end of this process, and
 * the same build can restore it (see hf_store_restore). After HF_IO all generations before it survive, provided that
 * hf_store_publish was called after hf_store_genes. */
hf_status hf_store_generation(hf_store *store, const hf_model *model, const hf_population *population,
                              hf_messages *messages);

/* Read the pretensions base_N [n_gene] from which the genetic algorithm of a resumed store started; those that this
 * machine computes may differ in the last bits. base_N is unchanged when the store has none. */
hf_status hf_store_restore_base(hf_store *store, int n_gene, double *base_N, hf_messages *messages);

/* Put the optimiser, just created from that base, into the state before hf_optimiser_tell of the last generation that
 * the store holds, and what was the best until then into the summary. The designs of generations in the journal are
 * proposed again; a build that proposes others leaves these generations out, with a warning. Does nothing when
 * the store holds no generation. */
hf_status hf_store_restore(hf_store *store, hf_optimiser *optimiser, hf_summary *summary, hf_messages *messages);

/* Take where Levenberg-Marquardt is, after this time, for the publications to come; a finished file does not have it.
 * Restoring it: n is 0 where a resumed store has none; state is borrowed until hf_store_polish. */
hf_status hf_store_polish(hf_store *store, double wall_s, size_t n, const double *state, hf_messages *messages);
hf_status hf_store_restore_polish(hf_store *store, double *wall_s, size_t *n, const double **state,
                                  hf_messages *messages);

/* Publish everything so far: give the visible name to a file that is marked as unfinished. With at_once it is done now,
 * otherwise only when the last publication took less than 2 % of the time since then. Call it after every
 * generation. */
hf_status hf_store_publish(hf_store *store, const hf_summary *summary, bool at_once, hf_messages *messages);

/* Write the shape in the workspace as the one that an optimisation stage found, with its design_N [model->n_gene]. Call
 * it once per stage. */
hf_status hf_store_best(hf_store *store, hf_stage stage, const hf_model *model, const hf_workspace *workspace,
                        const double *design_N, hf_messages *messages);

/* Write the front, whose objectives are named by the goals of the summary, in place of an earlier one. */
hf_status hf_store_front(hf_store *store, const hf_scene *scene, const hf_model *model, const hf_summary *summary,
                         const hf_front *front, hf_messages *messages);

/* Write the far field of the shape of a stage, in place of an earlier one. Reading it: HF_IO when there is none; free
 * the table in any case. */
hf_status hf_store_pattern(hf_store *store, hf_stage stage, const hf_pattern_table *table,
                           const hf_pattern_summary *figures, hf_messages *messages);
hf_status hf_store_read_pattern(const char *path, hf_stage stage, hf_pattern_table *table, hf_messages *messages);

/* Write the shape in the workspace as that of a state of the net as built, with the truss in it (NULL without one). A
 * state that is there already is replaced. */
hf_status hf_store_built(hf_store *store, const char *name, const hf_model *model, const hf_workspace *workspace,
                         const hf_carrier *carrier, const hf_carrier_state *truss, hf_messages *messages);

/* Write the summary, close the file and give it its name. The store is freed in any case. A failure leaves the
 * published file and the journal as they were. When the file is whole but cannot get its name (HF_EXISTS, HF_IO), it
 * stays under another name, which the message gives. */
hf_status hf_store_finish(hf_store *store, const hf_summary *summary, hf_messages *messages);

/* hf_store_finish in two parts. hf_store_complete writes and closes the file, which takes processor time.
 * hf_store_settle writes it through to the disk and renames it, which is mostly waiting and may be done by another
 * thread; it frees the store in any case. */
hf_status hf_store_complete(hf_store *store, const hf_summary *summary, hf_messages *messages);
hf_status hf_store_settle(hf_store *store, hf_messages *messages);

/* Free the store, leaving on the disk what is there: the published file, and the journal with the generations that the
 * file does not hold. store may be NULL. */
void hf_store_end(hf_store *store);
/* The same. Warns if a temporary file cannot be removed. */
void hf_store_abandon(hf_store *store, hf_messages *messages);

/* One stored shape, in the order of the scene. */
typedef struct {
    double *position_m;                       /* [n_node][3] */
    double *length_m, *tension_N, *q_N_per_m; /* [n_cable] */
    unsigned char *law;                       /* [n_cable] hf_law in force */
    void *block;
} hf_shape;

/* The functions that read return HF_OK; HF_IO with one message when the file does not exist, is no file of hifdm, or is
 * damaged; HF_NO_MEMORY. The output is all zero after a failure. */

/* Read every member as it was given to hf_store_finish, bit by bit; those after has_optimize are 0 when it is false. */
hf_status hf_store_read_summary(const char *path, hf_summary *summary, hf_messages *messages);

/* Read the scene, without its line numbers. Free it with hf_scene_free in any case. */
hf_status hf_store_read_scene(const char *path, hf_scene *scene, hf_messages *messages);

/* Read the shape that a stage found; HF_IO when there is none. Its counts are those of hf_store_read_scene. */
hf_status hf_store_read_shape(const char *path, hf_stage stage, hf_shape *shape, hf_messages *messages);
/* The same of a state of the net as built. */
hf_status hf_store_read_state(const char *path, const char *name, hf_shape *shape, hf_messages *messages);
void hf_shape_free(hf_shape *shape);

/* Read the front, and *gene, the names of its genes, [n_gene] of *gene_size bytes each. HF_IO when there is none. Free
 * the front by hf_front_free and *gene by free in any case. */
hf_status hf_store_read_front(const char *path, hf_front *front, char **gene, size_t *gene_size, hf_messages *messages);

/* Write the keys in which the case of a result differs from this one into text[size], as hf_config_differences. Returns
 * their number; 0 also where that cannot be told. */
int hf_store_case_differences(const char *path, const hf_case *settings, char *text, size_t size);

/* Write the group /truss: the truss as described, its attachments to the net and, when `state` is not NULL, its
 * displacements and forces under the pull of the net. Call it once, before hf_store_finish of a summary that
 * has_truss. */
hf_status hf_store_truss(hf_store *store, const hf_carrier *carrier, const hf_carrier_state *state,
                         hf_messages *messages);

/* Read the truss, without its line numbers; state: all NULL when none was stored. HF_IO when there is no truss. Free
 * both in any case. */
hf_status hf_store_read_truss(const char *path, hf_truss *truss, hf_carrier_state *state, hf_messages *messages);

/* Read what a state of the net as built makes of the truss that hf_store_read_truss has read. HF_IO when it has no
 * shape. Free it in any case. */
hf_status hf_store_read_state_truss(const char *path, const char *name, const hf_truss *truss, hf_carrier_state *state,
                                    hf_messages *messages);

/* "VERSION (git describe)" of this library. */
const char *hf_store_version(void);

/* Switch off HDF5's error printing and its exit handler, which crashes when the disk was full. Call it once, before the
 * first call of HDF5. False: there is too little memory for HDF5, which would crash. */
bool hf_store_quiet(void);

HF_API_END
#endif
