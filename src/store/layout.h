/* layout - what our result files contain: groups, names, types, units and descriptions, and the struct members that
 * they come from. <hifdm/store.h> describes the whole file for a reader; hdf5.h has the calls that write and read.
 * Elsewhere are only the rows of generations (generations.c), genes, case and provenance (store.c), and the marks of a
 * session (store_resume.c).
 * A new data set per node or cable is a row of SCENE_COLUMNS or SHAPE_COLUMNS, a new attribute a row of a list of
 * members, a new enumeration a kind. */
#ifndef HIFDM_STORE_LAYOUT_H
#define HIFDM_STORE_LAYOUT_H

#include "store/hdf5.h"

#include <hifdm/carrier.h>
#include <hifdm/summary.h>
#include <hifdm/workspace.h>

#define HF_PROGRAM "hifdm"  /* attribute `program`: the file is one of ours */
#define HF_FORMAT_VERSION 2 /* attribute `format_version`; raise it for a change that old programs would misread */

/* More nodes or members than any scene has. The limit keeps a damaged file from taking all memory. */
#define HF_LAYOUT_COUNT_MAX 20000000

/* ---- Enumerations: words and values from the engine's own lists ---- */

extern const hf_hdf5_kind hf_layout_role, hf_layout_group, hf_layout_law, hf_layout_status, hf_layout_stop_reason,
    hf_layout_ga_stop, hf_layout_polish_stop, hf_layout_joint, hf_layout_unit, hf_layout_coupling_stop,
    hf_layout_bound_reason, hf_layout_surface_kind;
#define HF_KIND_ROLE (&hf_layout_role)
#define HF_KIND_GROUP (&hf_layout_group)
#define HF_KIND_LAW (&hf_layout_law)
#define HF_KIND_STATUS (&hf_layout_status)
#define HF_KIND_STOP_REASON (&hf_layout_stop_reason)
#define HF_KIND_GA_STOP (&hf_layout_ga_stop)
#define HF_KIND_POLISH_STOP (&hf_layout_polish_stop)
#define HF_KIND_JOINT (&hf_layout_joint)
#define HF_KIND_UNIT (&hf_layout_unit)
#define HF_KIND_COUPLING_STOP (&hf_layout_coupling_stop)
#define HF_KIND_BOUND_REASON (&hf_layout_bound_reason)
#define HF_KIND_SURFACE (&hf_layout_surface_kind)
#define HF_KIND_SOLVER HF_KIND_INT /* stored as its number */
#define HF_KIND_TRUTH HF_KIND_INT  /* a bool that was stored as a number before there were flags */

/* The stored kind of a figure of HF_RESULT_LIST. */
const hf_hdf5_kind *hf_layout_kind_of(hf_result_kind kind);

/* ---- Columns: a pointer in a struct <-> a data set [n_node] or [n_cable], [...][columns] when columns > 1 ---- */

typedef struct {
    const char *name;
    const hf_hdf5_kind *kind;
    bool per_cable; /* [n_cable], of a truss [n_member]; else [n_node] */
    int columns;
    const char *units, *description;
    size_t offset; /* of the pointer in its struct */
} hf_layout_column;

typedef struct {
    const hf_layout_column *column;
    int n;
} hf_layout_columns;

#define HF_LAYOUT_COLUMN(type, name, member, kind, per_cable, columns, units, description)                             \
    {name, HF_KIND_##kind, per_cable, columns, units, description, offsetof(type, member)},
#define HF_LAYOUT_COLUMNS(table) table, HF_HDF5_COUNT(table)

extern const hf_layout_columns hf_layout_scene;       /* hf_scene below /scene */
extern const hf_layout_columns hf_layout_shape;       /* hf_shape below /form, /ga/best and /polish */
extern const hf_layout_columns hf_layout_truss;       /* hf_truss below /truss */
extern const hf_layout_columns hf_layout_truss_state; /* hf_carrier_state below /truss */

/* Columns whose pointer in `owner` is NULL are left out. */
void hf_layout_write_columns(hf_hdf5 *io, hid_t group, const hf_layout_columns *columns, int n_node, int n_cable,
                             const void *owner);
void hf_layout_read_columns(hf_hdf5 *io, hid_t group, const hf_layout_columns *columns, int n_node, int n_cable,
                            void *owner);

/* Remove a group that is written anew, as when a result goes on whose end was there already. */
void hf_layout_renew(hf_hdf5 *io, const char *path);

/* ---- The summary: members of hf_summary <-> attributes of the groups of its stages ---- */

typedef enum {
    HF_LAYOUT_FORM,            /* always */
    HF_LAYOUT_GA,              /* when has_optimize */
    HF_LAYOUT_POLISH,          /* when has_polish */
    HF_LAYOUT_TRUSS,           /* when has_truss: when there is a group /truss */
    HF_LAYOUT_COUPLING,        /* this and the next two: when has_coupling */
    HF_LAYOUT_COUPLING_GA,     /* and has_optimize; beside the results of that stage */
    HF_LAYOUT_COUPLING_POLISH, /* and has_polish */
    HF_LAYOUT_TOLERANCE,       /* when has_tolerance */
    HF_LAYOUT_N_PART
} hf_layout_part;

typedef struct {
    const hf_hdf5_member *member;
    int n;
} hf_layout_members;
extern const hf_layout_members hf_layout_summary[HF_LAYOUT_N_PART];

void hf_layout_put_summary(hf_hdf5 *io, hf_layout_part part, const hf_summary *summary);
void hf_layout_get_summary(hf_hdf5 *io, hf_layout_part part, hf_summary *summary);

/* ---- Groups that are not plain tables, each in a file of its own; the calls do nothing after a failure ---- */

/* layout_coupling: node, displacement and force of each attachment, and the history of the loop unless it is NULL; the
 * results of the coupling in a summary, as attributes of the groups of their stages. */
void hf_layout_write_coupling(hf_hdf5 *io, const hf_model *model, const hf_workspace *workspace,
                              const hf_coupling_history *history);
void hf_layout_put_coupling(hf_hdf5 *io, const hf_summary *summary);
void hf_layout_get_coupling(hf_hdf5 *io, hf_summary *summary);

/* layout_surface: the measures of the surface, below /surface:
 *   /surface           attributes kind, focal_length_m, strip_width_m; frequency_Hz [k]
 *   /surface/STAGE     form, optimize, polish, as far as they ran: attributes, the numbers of hf_surface_measures and
 *                      of its fit (fit_...); the losses of HF_SURFACE_LOSS_LIST [k]
 * Nothing when the case asks for none; no data sets when it names no frequencies. */
void hf_layout_put_surface(hf_hdf5 *io, const hf_summary *summary);
void hf_layout_get_surface(hf_hdf5 *io, hf_summary *summary);

/* The part of it about one shape, in the group `path`; reading sets nothing when there is no such group. */
void hf_layout_put_measures(hf_hdf5 *io, const char *path, int n_frequency, const hf_surface_measures *measures);
void hf_layout_get_measures(hf_hdf5 *io, const char *path, int n_frequency, hf_surface_measures *measures);

/* layout_pattern: the far field, /pattern/STAGE: attributes of the feed; frequency_Hz [f], phi_deg [c], theta_deg [t];
 * co_dBi, cross_dBi [f][c][t]; the members of hf_cut_figures [f][c]. Nothing without surface.pattern. */
void hf_layout_write_pattern(hf_hdf5 *io, int stage, const hf_pattern_table *table, const hf_pattern_summary *figures);
void hf_layout_get_pattern(hf_hdf5 *io, hf_summary *summary);
void hf_layout_read_pattern(hf_hdf5 *io, int stage, hf_pattern_table *table);

/* layout_cases: figures of the states of the net as built:
 *   /cases             name [n] of the states, in the order of the case
 *   /cases/NAME        attributes: figures of HF_RESULT_LIST, coupling_..., HF_STATE_LIST; below it `surface`, as
 *                      /surface/STAGE
 * Shapes and the truss are written by hf_store_built before. Nothing without states. */
#define HF_LAYOUT_STATE_SIZE (HF_SET_NAME_SIZE + 32) /* of the path of a group */
void hf_layout_put_cases(hf_hdf5 *io, const hf_summary *summary);
void hf_layout_get_cases(hf_hdf5 *io, hf_summary *summary);

/* layout_sets: tensions of the named sets of cables, below /set_tension/STAGE: name, least_N, largest_N, ratio [n].
 * Nothing for a net without sets. */
void hf_layout_put_sets(hf_hdf5 *io, const hf_summary *summary);
void hf_layout_get_sets(hf_hdf5 *io, hf_summary *summary);

/* layout_held: what the shapes of optimize and polish are at, below /at_limit/STAGE: row, count, name, value, bound
 * [n]. Nothing for a shape that is at no limit. */
void hf_layout_put_held(hf_hdf5 *io, const hf_summary *summary);
void hf_layout_get_held(hf_hdf5 *io, hf_summary *summary);

/* layout_goals: /goals, the rows of optimize.goals with their values in the results of the stages; nothing without
 * rows. */
enum { HF_LAYOUT_N_GOALS_STAGE = 3 };                                /* form, optimize, polish */
const double *hf_layout_goals(const hf_summary *summary, int stage); /* [goals.n] of that stage; NULL: it has none */
void hf_layout_put_goals(hf_hdf5 *io, const hf_summary *summary);
void hf_layout_get_goals(hf_hdf5 *io, hf_summary *summary);

/* layout_front: /front, of optimize.objectives, whose names are the goals of the summary. The summary gets all of it
 * but the designs. hf_layout_read_front reads a whole front and names of genes [n_gene] of *gene_size bytes each; the
 * caller frees both in any case. has_rows: designs are of optimize.variables. */
void hf_layout_write_front(hf_hdf5 *io, const hf_scene *scene, const hf_model *model, const hf_summary *summary,
                           const hf_front *front);
void hf_layout_get_front(hf_hdf5 *io, hf_summary *summary);
void hf_layout_read_front(hf_hdf5 *io, bool has_rows, hf_front *front, char **gene, size_t *gene_size);

/* The point of a front that is the result of this run: attributes of /case. Reading changes nothing where there is
 * none. */
void hf_layout_put_taken(hf_hdf5 *io, const hf_front_origin *taken);
void hf_layout_get_taken(hf_hdf5 *io, hf_front_origin *taken);

/* layout_tolerance: /tolerance, the figures of samples of the net as built; nothing without such samples. */
void hf_layout_put_tolerance(hf_hdf5 *io, const hf_summary *summary);
void hf_layout_get_tolerance(hf_hdf5 *io, hf_summary *summary);

/* layout_truss: the truss as described, its attachments and, when `state` is not NULL, its displacements and forces
 * under the pull of the net. Reading allocates: the caller frees both in any case. */
void hf_layout_write_truss(hf_hdf5 *io, const hf_carrier *carrier, const hf_carrier_state *state);
void hf_layout_read_truss(hf_hdf5 *io, hf_truss *truss, hf_carrier_state *state);

/* The displacements and forces alone, from the group `group`; none when it has none. */
void hf_layout_read_truss_state(hf_hdf5 *io, hid_t group, const hf_truss *truss, hf_carrier_state *state);

/* The data set of a value of each gene: design_N, base_N, lower_N or upper_N, in N; with genes of optimize.variables,
 * each in its own unit, the same name without its end. */
hf_hdf5_array hf_layout_of_genes(const char *name, bool has_rows, int rank, const hsize_t *dims);

#endif
