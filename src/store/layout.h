/* layout - describes the content of our result files: groups, names, types, units and descriptions, and the struct
 * members that they come from. <hifdm/store.h> describes the whole file for a reader; hdf5.h has the calls that write
 * and read.
 *
 * Other files describe the rest: generations_list.c the rows of generations; store.c the provenance, the case, ids,
 * sets and facets of the scene, the history and the design variables; store_tolerance.c the as-built samples;
 * store_resume.c the marks of a session and the state of the refinement; vtkhdf.c the group /VTKHDF.
 *
 * A new data set per node or cable is a row of SCENE_COLUMNS or SHAPE_COLUMNS. A new attribute is a row of a list of
 * members. A new enumeration is a new kind. */
#ifndef HIFDM_STORE_LAYOUT_H
#define HIFDM_STORE_LAYOUT_H

#include "store/hdf5.h"

#include <hifdm/carrier.h>
#include <hifdm/summary.h>
#include <hifdm/workspace.h>

#define HF_PROGRAM "hifdm"  /* value of the attribute `program` in our files */
#define HF_FORMAT_VERSION 2 /* attribute `format_version`; must grow with a change that older programs would misread */

/* Maximum number of nodes or members, more than any scene has. The limit keeps a damaged file from taking all
 * memory. */
#define HF_LAYOUT_COUNT_MAX 20000000

/* ---- Enumerations: words and values from the engine's own lists ---- */

extern const hf_hdf5_kind hf_layout_role, hf_layout_group, hf_layout_law, hf_layout_status, hf_layout_stop_reason,
    hf_layout_search_stop, hf_layout_refine_stop, hf_layout_joint, hf_layout_unit, hf_layout_coupling_stop,
    hf_layout_bound_reason, hf_layout_surface_kind;
#define HF_KIND_ROLE (&hf_layout_role)
#define HF_KIND_GROUP (&hf_layout_group)
#define HF_KIND_LAW (&hf_layout_law)
#define HF_KIND_STATUS (&hf_layout_status)
#define HF_KIND_STOP_REASON (&hf_layout_stop_reason)
#define HF_KIND_SEARCH_STOP (&hf_layout_search_stop)
#define HF_KIND_REFINE_STOP (&hf_layout_refine_stop)
#define HF_KIND_JOINT (&hf_layout_joint)
#define HF_KIND_UNIT (&hf_layout_unit)
#define HF_KIND_COUPLING_STOP (&hf_layout_coupling_stop)
#define HF_KIND_BOUND_REASON (&hf_layout_bound_reason)
#define HF_KIND_SURFACE (&hf_layout_surface_kind)
#define HF_KIND_SOLVER HF_KIND_INT /* stored as its number, without words */
#define HF_KIND_TRUTH HF_KIND_INT  /* a bool that is stored as a number, because it is older than the flags */

/* Returns the stored kind of a figure of HF_RESULT_LIST. */
const hf_hdf5_kind *hf_layout_kind_of(hf_result_kind kind);

/* ---- Columns: pointers in structs and their data sets ---- */

/* One column: a pointer in a struct and its data set [n_node] or [n_cable]. With columns > 1 the data set is
 * [n_node][columns] or [n_cable][columns]. */
typedef struct {
    const char *name;
    const hf_hdf5_kind *kind;
    bool per_cable; /* [n_cable], or [n_member] of a truss; else [n_node] */
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

extern const hf_layout_columns hf_layout_scene;       /* hf_scene in /scene */
extern const hf_layout_columns hf_layout_shape;       /* hf_shape in /form, /ga/best, /polish and /cases/NAME */
extern const hf_layout_columns hf_layout_truss;       /* hf_truss in /truss */
extern const hf_layout_columns hf_layout_truss_state; /* hf_carrier_state in /truss and /cases/NAME/truss */

/* Writes or reads the data sets of all columns whose pointer in `owner` is not NULL. n_cable: cables, or members of a
 * truss. */
void hf_layout_write_columns(hf_hdf5 *io, hid_t group, const hf_layout_columns *columns, int n_node, int n_cable,
                             const void *owner);
void hf_layout_read_columns(hf_hdf5 *io, hid_t group, const hf_layout_columns *columns, int n_node, int n_cable,
                            void *owner);

/* Removes the object `path` if it exists, so that it can be written again. A resumed run needs this if an earlier
 * session has written the object. */
void hf_layout_renew(hf_hdf5 *io, const char *path);

/* ---- The summary: members of hf_summary and the attributes that store them ---- */

/* Parts of the summary. Each comment says when the part is stored. */
typedef enum {
    HF_LAYOUT_FORM,            /* always */
    HF_LAYOUT_GA,              /* if the search has begun */
    HF_LAYOUT_REFINE,          /* if has_polish */
    HF_LAYOUT_TRUSS,           /* if has_truss; the group /truss exists then */
    HF_LAYOUT_COUPLING,        /* if has_coupling */
    HF_LAYOUT_COUPLING_GA,     /* if has_coupling and has_optimize; attributes of /ga */
    HF_LAYOUT_COUPLING_REFINE, /* if has_coupling and has_polish; attributes of /polish */
    HF_LAYOUT_TOLERANCE,       /* if has_tolerance */
    HF_LAYOUT_N_PART
} hf_layout_part;

typedef struct {
    const hf_hdf5_member *member;
    int n;
} hf_layout_members;
extern const hf_layout_members hf_layout_summary[HF_LAYOUT_N_PART];

/* Writes or reads the attributes of one part of the summary. */
void hf_layout_put_summary(hf_hdf5 *io, hf_layout_part part, const hf_summary *summary);
void hf_layout_get_summary(hf_hdf5 *io, hf_layout_part part, hf_summary *summary);

/* ---- Groups that are not plain tables ----
 * Each has a source file of its own. The calls do nothing after a failure. */

/* layout_coupling: the group /coupling. hf_layout_write_coupling writes node, displacement and force of each
 * attachment, and the history of the coupling unless it is NULL. The other two calls write and read the results of the
 * coupling in a summary, as attributes of the groups of their stages. */
void hf_layout_write_coupling(hf_hdf5 *io, const hf_model *model, const hf_workspace *workspace,
                              const hf_coupling_history *history);
void hf_layout_put_coupling(hf_hdf5 *io, const hf_summary *summary);
void hf_layout_get_coupling(hf_hdf5 *io, hf_summary *summary);

/* layout_surface: the measures of the surface.
 *   /surface           attributes kind, focal_length_m, strip_width_m, mesh_tension_N_per_m; frequency_Hz [k]
 *   /surface/STAGE     STAGE is form, optimize or polish. Attributes: the numbers of hf_surface_measures, and those of
 *                      its fit as fit_...; data sets: the losses of HF_SURFACE_LOSS_LIST [k]
 * If the case does not ask for the surface, there is no such group. If the case names no frequencies, there are no data
 * sets. */
void hf_layout_put_surface(hf_hdf5 *io, const hf_summary *summary);
void hf_layout_get_surface(hf_hdf5 *io, hf_summary *summary);

/* Writes or reads the measures of one shape in the group `path`. If there is no such group, reading changes nothing. */
void hf_layout_put_measures(hf_hdf5 *io, const char *path, int n_frequency, const hf_surface_measures *measures);
void hf_layout_get_measures(hf_hdf5 *io, const char *path, int n_frequency, hf_surface_measures *measures);

/* layout_pattern: the far field of a stage, in /pattern/STAGE. Its attributes describe the feed. Its data sets, for f
 * frequencies, c cuts and t angles, are frequency_Hz [f], phi_deg [c], theta_deg [t], co_dBi and cross_dBi [f][c][t],
 * and the members of hf_cut_figures [f][c]. Without surface.pattern there is no such group. hf_layout_get_pattern reads
 * all but theta_deg, co_dBi and cross_dBi into the summary. hf_layout_read_pattern reads all arrays of one stage into a
 * new table, which the caller frees in any case. */
void hf_layout_write_pattern(hf_hdf5 *io, int stage, const hf_pattern_table *table, const hf_pattern_summary *figures);
void hf_layout_get_pattern(hf_hdf5 *io, hf_summary *summary);
void hf_layout_read_pattern(hf_hdf5 *io, int stage, hf_pattern_table *table);

/* layout_cases: the figures of the load cases of the as-built net.
 *   /cases             name [n] of the load cases, in the order of the case
 *   /cases/NAME        attributes: the figures of HF_RESULT_LIST, those of the coupling as coupling_...,
 *                      HF_LOAD_CASE_LIST
 *   /cases/NAME/surface    as /surface/STAGE
 * hf_store_built has written the shapes and the truss before. Without load cases nothing is written. */
#define HF_LAYOUT_LOAD_CASE_SIZE (HF_SET_NAME_SIZE + 32) /* bytes of the path of a group */
void hf_layout_put_cases(hf_hdf5 *io, const hf_summary *summary);
void hf_layout_get_cases(hf_hdf5 *io, hf_summary *summary);

/* layout_sets: the tensions of the named sets of cables, in /set_tension/STAGE: name, least_N, largest_N, ratio [n]. A
 * net without sets has no such group. */
void hf_layout_put_sets(hf_hdf5 *io, const hf_summary *summary);
void hf_layout_get_sets(hf_hdf5 *io, hf_summary *summary);

/* layout_held: the limits that the shape of a stage is at, in /at_limit/STAGE: row, count, name, value, bound [n]. A
 * shape that is at no limit has no such group. */
void hf_layout_put_held(hf_hdf5 *io, const hf_summary *summary);
void hf_layout_get_held(hf_hdf5 *io, hf_summary *summary);

/* layout_objectives: the group /goals with the rows of optimize.goals, or of optimize.objectives, and their values in
 * the result of each stage. Without rows there is no such group. */
enum { HF_LAYOUT_N_OBJECTIVES_STAGE = 3 }; /* form, optimize, polish */
/* Returns the values of the rows in the result of a stage, [goals.n], or NULL if there are none. */
const double *hf_layout_objectives(const hf_summary *summary, int stage);
void hf_layout_put_objectives(hf_hdf5 *io, const hf_summary *summary);
void hf_layout_get_objectives(hf_hdf5 *io, hf_summary *summary);

/* layout_front: the group /front of optimize.objectives; the goals of the summary name its objectives.
 * hf_layout_get_front reads the front without its designs and tabulates it in the summary. hf_layout_read_front reads
 * the whole front and *variable, the names of the design variables, [n_variable] of *variable_size bytes each. The
 * caller frees both in any case. has_rows: the design variables are those of optimize.variables. */
void hf_layout_write_front(hf_hdf5 *io, const hf_scene *scene, const hf_model *model, const hf_summary *summary,
                           const hf_front *front);
void hf_layout_get_front(hf_hdf5 *io, hf_summary *summary);
void hf_layout_read_front(hf_hdf5 *io, bool has_rows, hf_front *front, char **variable, size_t *variable_size);

/* Writes or reads the point of a front that is the result of this run, as attributes of /case. If there are no such
 * attributes, reading changes nothing. */
void hf_layout_put_taken(hf_hdf5 *io, const hf_front_origin *taken);
void hf_layout_get_taken(hf_hdf5 *io, hf_front_origin *taken);

/* layout_tolerance: the statistics of the as-built samples, in /tolerance. Without samples nothing is written. */
void hf_layout_put_tolerance(hf_hdf5 *io, const hf_summary *summary);
void hf_layout_get_tolerance(hf_hdf5 *io, hf_summary *summary);

/* layout_truss: the truss as described, its attachments and, if `state` is not NULL, its displacements and forces under
 * the pull of the net. Reading allocates truss and state; the caller frees both in any case. */
void hf_layout_write_truss(hf_hdf5 *io, const hf_carrier *carrier, const hf_carrier_state *state);
void hf_layout_read_truss(hf_hdf5 *io, hf_truss *truss, hf_carrier_state *state);

/* Reads the displacements and forces alone, from the group `group`. If it has none, *state does not change. */
void hf_layout_read_truss_state(hf_hdf5 *io, hid_t group, const hf_truss *truss, hf_carrier_state *state);

/* Describes the data set with one value per design variable. name: design_N, base_N, lower_N or upper_N, in N. With
 * has_rows each design variable of optimize.variables has its own unit, and the data set has the name without "_N".
 * dims [rank]: the dimensions. */
hf_hdf5_array hf_layout_of_variables(const char *name, bool has_rows, int rank, const hsize_t *dims);

#endif
