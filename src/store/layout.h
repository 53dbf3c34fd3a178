/* layout - describes the content of our result files: groups, names, types, units and descriptions, and the struct
 * members that they come from. <hifdm/store.h> describes the whole file for a reader; hdf5.h has the calls that write
 * and read.
 *
 * Other files describe the rest: generations.c the rows of generations; provenance.c the provenance; store.c the case,
 * ids, sets and facets of the scene, the history and the design variables; store_tolerance.c the as-built samples;
 * store_resume.c the marks of a session and the state of the refinement; vtkhdf.c the group /VTKHDF.
 *
 * A new data set per node or cable is a row of scene_column or shape_column (layout.c). A new attribute is a row of a
 * list of members. A new enumeration is a new kind. */
#pragma once

#include "base/json.h"
#include "store/hdf5.h"
#include "store/renamed.h"

#include <hifdm/carrier.h>
#include <hifdm/summary.h>
#include <hifdm/workspace.h>

#define HF_PROGRAM "hifdm"  /* value of the attribute `program` in our files */
#define HF_FORMAT_VERSION 3 /* attribute `format_version`; must grow with a change that older programs would misread */

/* Maximum number of nodes or members, more than any scene has. The limit keeps a damaged file from taking all
 * memory. */
#define HF_LAYOUT_COUNT_MAX 20000000

/* ---- Enumerations: words and values from the engine's own lists ---- */

extern const hf_hdf5_kind hf_layout_role, hf_layout_group, hf_layout_law, hf_layout_status, hf_layout_verdict;
#define HF_KIND_ROLE (&hf_layout_role)
#define HF_KIND_GROUP (&hf_layout_group)
#define HF_KIND_LAW (&hf_layout_law)
#define HF_KIND_STATUS (&hf_layout_status)

/* Returns the stored kind of a figure. */
const hf_hdf5_kind *hf_layout_kind_of(const hf_result_field *field);

/* ---- Columns: pointers in structs and their data sets ---- */

/* One column of a list that ends with {0}: a pointer in a struct and its data set [n_node] or [n_cable]. With columns >
 * 1 the data set is [n_node][columns] or [n_cable][columns]. */
typedef struct {
    const char *name;
    const hf_hdf5_kind *kind;
    bool per_cable; /* [n_cable], or [n_member] of a truss; else [n_node] */
    int columns;
    const char *units, *description;
    size_t offset; /* of the pointer in its struct */
} hf_layout_column;

#define HF_LAYOUT_COLUMN(type, name, member, kind, per_cable, columns, units, description)                             \
    {                                                                                                                  \
        name, HF_KIND_##kind, per_cable, columns, units, description, offsetof(type, member)                           \
    }

extern const hf_layout_column hf_layout_scene[];       /* hf_scene in /scene */
extern const hf_layout_column hf_layout_shape[];       /* hf_shape in /form, /search, /refine and /load_cases/NAME */
extern const hf_layout_column hf_layout_truss[];       /* hf_truss in /truss */
extern const hf_layout_column hf_layout_truss_state[]; /* hf_carrier_state in /truss and /load_cases/NAME/truss */

/* Writes or reads the data sets of all columns whose pointer in `owner` is not NULL. n_cable: cables, or members of a
 * truss. */
void hf_layout_pass_columns(hf_hdf5 *io, bool writes, hid_t group, const hf_layout_column *columns, int n_node,
                            int n_cable, const void *owner);

/* Removes the object `name` below `place` if it exists, so that it can be written again. A resumed run needs this if an
 * earlier session has written the object. */
void hf_layout_renew(hf_hdf5 *io, hid_t place, const char *name);

/* ---- Fields: members of structs and their data sets ---- */

/* A data set [n] of one member of n structs, or of n values in an array. Row i is at `offset` + i * `stride` of the
 * owner. A value has `size` bytes there: an enumeration is an int or a bool, a name is char[size]. With columns > 0 the
 * data set is [n][columns], and the values of a row lie side by side. */
typedef struct {
    const char *name;
    const hf_hdf5_kind *kind;
    const char *units, *description;
    size_t offset, stride, size;
    int columns;
} hf_layout_field;

/* HF_LAYOUT_FIELD: `member` is an array of the struct `type`. HF_LAYOUT_MEMBER: the owner is an array of `type`. */
#define HF_LAYOUT_FIELD(type, name, member, kind, units, description)                                                  \
    HF_LAYOUT_STRIDED(type, name, member[0], kind, units, description, sizeof(((type *)0)->member[0]), 0)
#define HF_LAYOUT_MEMBER(type, name, member, kind, units, description)                                                 \
    HF_LAYOUT_STRIDED(type, name, member, kind, units, description, sizeof(type), 0)
#define HF_LAYOUT_STRIDED(type, name, item, kind, units, description, stride, columns)                                 \
    {name, HF_KIND_##kind, units, description, offsetof(type, item), stride, sizeof(((type *)0)->item), columns},
#define HF_LAYOUT_TABLE(table) table, HF_HDF5_COUNT(table)

/* Writes or reads n values of each field as data sets [n], or [n / columns][columns] with columns > 0. Nothing is done
 * if n is 0. */
void hf_layout_pass_fields(hf_hdf5 *io, bool writes, hid_t group, const hf_layout_field *table, int n_field, int n,
                           int columns, void *owner);

/* Copies n values of a kind between `owner`, where they are `size` bytes long and `stride` bytes apart, and `packed`,
 * as HDF5 takes them: to `packed` with `packs`, else back. An enumeration is an int or a bool in the owner and a byte
 * in `packed`. `bytes` is the size of a value in `packed`. */
void hf_layout_copy(const hf_hdf5_kind *kind, size_t bytes, size_t size, size_t stride, int n, bool packs, char *packed,
                    char *owner);

/* ---- Members: rows of <hifdm/result.h> and the attributes that store them ---- */

/* Returns the value of an enumeration, an int or a bool of `size` bytes. */
int hf_layout_int(const void *value, size_t size);

/* Writes or reads n members as attributes of `object`. If a file of another version (io->made_by) has the object but
 * not the attribute, reading sets the member to NaN, 0 or "". */
void hf_layout_pass_members(hf_hdf5 *io, bool writes, const char *object, const hf_result_field *field, int n,
                            void *owner);

/* A member with another name than in its struct. */
#define HF_LAYOUT_NAMED(owner, name_, member, kind_)                                                                   \
    {.name = name_, .kind = HF_RESULT_##kind_, .offset = offsetof(owner, member), .size = sizeof(((owner *)0)->member)},

/* ---- The summary: its members and the attributes that store them ---- */

/* Parts of the summary. hf_layout_has says when a part is stored. */
typedef enum {
    HF_LAYOUT_RUN,
    HF_LAYOUT_CASE,
    HF_LAYOUT_VERSION,
    HF_LAYOUT_FORM,
    HF_LAYOUT_SEARCH,
    HF_LAYOUT_REFINE,
    HF_LAYOUT_FORM_STAGE, /* what every stage has */
    HF_LAYOUT_SEARCH_STAGE,
    HF_LAYOUT_REFINE_STAGE,
    HF_LAYOUT_FORM_COUPLING, /* figures of the coupling */
    HF_LAYOUT_SEARCH_COUPLING,
    HF_LAYOUT_REFINE_COUPLING,
    HF_LAYOUT_TRUSS,
    HF_LAYOUT_TOLERANCE,
    HF_LAYOUT_N_PART
} hf_layout_part;

typedef struct {
    const char *object; /* group of the attributes */
    const hf_result_field *field;
    int n;
    size_t offset;  /* of the owner in hf_summary; of HF_LAYOUT_TOLERANCE of a pointer to it */
    hf_stage stage; /* the part needs this stage */
} hf_layout_members;
extern const hf_layout_members hf_layout_summary[HF_LAYOUT_N_PART];

/* Returns true if the run has this part. */
bool hf_layout_has(const hf_summary *summary, hf_layout_part part);

/* Returns the struct whose members the part lists, or NULL if there is none. */
void *hf_layout_owner(const hf_summary *summary, hf_layout_part part);

/* Writes or reads the attributes of one part. Writing makes the group. Here and below reading changes *summary. */
void hf_layout_pass_part(hf_hdf5 *io, bool writes, hf_layout_part part, const hf_summary *summary);

/* ---- Groups that are not plain tables ----
 * The calls do nothing after a failure. */

/* layout_stage: what the stages and the load cases have besides shapes and figures, see the top of the file. A part
 * that a run does not have has no group. hf_layout_pass_objectives passes /objective alone. */
void hf_layout_pass_stages(hf_hdf5 *io, bool writes, const hf_summary *summary);
void hf_layout_pass_objectives(hf_hdf5 *io, bool writes, const hf_summary *summary);

/* Members of hf_surface_measures, and of hf_load_case_summary with its result. */
enum {
    HF_LAYOUT_N_SURFACE = 0 HF_SURFACE_LIST(HF_RESULT_COUNT) HF_SURFACE_FIT_LIST(HF_RESULT_COUNT),
    HF_LAYOUT_N_LOAD_CASE = HF_RESULT_N + HF_COUPLING_N HF_LOAD_CASE_LIST(HF_RESULT_COUNT)
};
extern const hf_result_field hf_layout_surface[HF_LAYOUT_N_SURFACE], hf_layout_load_case[HF_LAYOUT_N_LOAD_CASE];

/* Returns the values of the objectives in the result of a stage, [objectives.n], or NULL if there are none. */
const double *hf_layout_objectives(const hf_summary *summary, int stage);

/* Writes node, displacement and force of each attachment into /coupling, and the history of the coupling unless it is
 * NULL. */
void hf_layout_write_coupling(hf_hdf5 *io, const hf_model *model, const hf_workspace *workspace,
                              const hf_coupling_history *history);

/* The far field of a stage, in /pattern/STAGE. Its attributes describe the feed. Its data sets, for f frequencies, c
 * cuts and t angles, are frequency_Hz [f], phi_deg [c], theta_deg [t], co_dBi and cross_dBi [f][c][t], and the members
 * of hf_cut_figures [f][c]. layout_stage also has hf_store_pattern and hf_store_read_pattern. */

#define HF_LAYOUT_LOAD_CASE_SIZE (HF_SET_NAME_SIZE + 32) /* bytes of the path of a group of a load case */

/* layout_front: the group /front of optimize.front; the objectives of the summary name its objectives.
 * hf_layout_get_front reads the front without its designs and tabulates it in the summary. layout_front also has
 * hf_store_front and hf_store_read_front. */
void hf_layout_get_front(hf_hdf5 *io, hf_summary *summary);

/* Writes or reads the point of a front that is the result of this run, as attributes of /case. If there are no such
 * attributes, reading changes nothing. */
void hf_layout_pass_taken(hf_hdf5 *io, bool writes, const hf_front_origin *taken);

/* layout_tolerance: the statistics of the as-built samples, in /tolerance. Without samples nothing is written. */
void hf_layout_put_tolerance(hf_hdf5 *io, const hf_summary *summary);
void hf_layout_get_tolerance(hf_hdf5 *io, hf_summary *summary);

/* layout_requirements: the verdicts on the rows of `requirements`, in /requirements. Without verdicts nothing is
 * written. hf_layout_write_verdict writes the members of one verdict into a JSON object. */
void hf_layout_put_requirements(hf_hdf5 *io, const hf_summary *summary);
void hf_layout_get_requirements(hf_hdf5 *io, hf_summary *summary);
void hf_layout_write_verdict(const hf_requirement_verdict *verdict, hf_json *json);

/* layout_truss: hf_store_truss, hf_store_read_truss, and the parts of a truss in a load case. hf_layout_make_truss
 * makes the group `path` of a truss with its groups node and member, and returns it. */
hid_t hf_layout_make_truss(hf_hdf5 *io, const char *path);

/* Reads the displacements and forces alone, from the group `group`. If it has none, *state does not change. */
void hf_layout_read_truss_state(hf_hdf5 *io, hid_t group, const hf_truss *truss, hf_carrier_state *state);

/* Describes the data set with one value per design variable. name: design, initial, lower or upper. Their unit is N;
 * with has_rows each design variable of optimize.variables has its own unit. dims [rank]: the dimensions. */
hf_hdf5_array hf_layout_of_variables(const char *name, bool has_rows, int rank, const hsize_t *dims);

/* Writes this data set for n design variables. */
void hf_layout_write_variables(hf_hdf5 *io, hid_t group, const char *name, bool has_rows, int n, const double *values);
