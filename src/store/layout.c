/* Implements layout.h for the scene, the shapes, the truss and the summary. Sections: enumerations, columns,
 * summary. */
#include "store/layout.h"

#include <hifdm/formfind.h>
#include <hifdm/population.h>
#include <hifdm/scene.h>
#include <hifdm/store.h>

#include <stdlib.h>
#include <string.h>

/* ---- enumerations ---- */

#define STATUS_WORD(name, value, word, ...) word,
#define STATUS_VALUE(name, value, ...) value,
#define STOP_WORD(name, value, word) word,
#define STOP_VALUE(name, value, word) value,
static const char *const status_word[] = {HF_STATUS_LIST(STATUS_WORD)};
static const signed char status_value[] = {HF_STATUS_LIST(STATUS_VALUE)};
static const char *const stop_word[] = {HF_STOP_REASON_LIST(STOP_WORD)};
static const signed char stop_value[] = {HF_STOP_REASON_LIST(STOP_VALUE)};
static const char *const coupling_word[] = {HF_COUPLING_STOP_LIST(STOP_WORD)};
static const signed char coupling_value[] = {HF_COUPLING_STOP_LIST(STOP_VALUE)};
#define BOUND_WORD(name, value, word, ...) word,
#define BOUND_VALUE(name, value, ...) value,
static const char *const bound_word[] = {HF_BOUND_REASON_LIST(BOUND_WORD)};
static const signed char bound_value[] = {HF_BOUND_REASON_LIST(BOUND_VALUE)};

/* Values of the words are 0, 1, 2, ... Lists of words for ENDED_WORDS end with NULL. */
#define WORDS(word) HF_HDF5_ENUM, HF_HDF5_COUNT(word), word, NULL
#define ENDED_WORDS(word) HF_HDF5_ENUM, HF_HDF5_COUNT(word) - 1, word, NULL
#define VALUES(word, value) HF_HDF5_ENUM, HF_HDF5_COUNT(word), word, value
const hf_hdf5_kind hf_layout_role = {WORDS(hf_role_word)};
const hf_hdf5_kind hf_layout_group = {WORDS(hf_group_word)};
const hf_hdf5_kind hf_layout_law = {WORDS(hf_law_word)};
const hf_hdf5_kind hf_layout_search_stop = {WORDS(hf_population_stop_word)};
const hf_hdf5_kind hf_layout_refine_stop = {WORDS(hf_refine_stop_word)};
const hf_hdf5_kind hf_layout_joint = {ENDED_WORDS(hf_joint_word)};
const hf_hdf5_kind hf_layout_surface_kind = {ENDED_WORDS(hf_surface_kind_word)};
const hf_hdf5_kind hf_layout_unit = {WORDS(hf_unit_word)};
const hf_hdf5_kind hf_layout_status = {VALUES(status_word, status_value)};
const hf_hdf5_kind hf_layout_stop_reason = {VALUES(stop_word, stop_value)};
const hf_hdf5_kind hf_layout_coupling_stop = {VALUES(coupling_word, coupling_value)};
const hf_hdf5_kind hf_layout_bound_reason = {VALUES(bound_word, bound_value)};

const hf_hdf5_kind *hf_layout_kind_of(hf_result_kind kind)
{
    switch (kind) {
    case HF_RESULT_REAL:
        return HF_KIND_REAL;
    case HF_RESULT_INT:
        return HF_KIND_INT;
    case HF_RESULT_STATUS:
        return HF_KIND_STATUS;
    case HF_RESULT_STOP_REASON:
        return HF_KIND_STOP_REASON;
    case HF_RESULT_BOUND_REASON:
        return HF_KIND_BOUND_REASON;
    default:
        return HF_KIND_COUPLING_STOP;
    }
}

/* ---- columns ---- */

/* Rows of the lists below: X(struct, name, member, kind, per_cable, columns, units, description) */
#define SCENE_COLUMNS(X)                                                                                               \
    X(hf_scene, "node/position_m", position_m, REAL, 0, 3, "m", "target position; of supports also the real one")      \
    X(hf_scene, "node/load_N", load_N, REAL, 0, 3, "N", "load")                                                        \
    X(hf_scene, "node/role", role, ROLE, 0, 1, "", "support, inner (counted by psi) or edge")                          \
    X(hf_scene, "cable/end", end, INT, 1, 2, "", "the two nodes, as indices from 0 into /scene/node")                  \
    X(hf_scene, "cable/group", group, GROUP, 1, 1, "", "inner or boundary")                                            \
    X(hf_scene, "cable/law", law, LAW, 1, 1, "", "what the scene asks of the cable")                                   \
    X(hf_scene, "cable/target", target, REAL, 1, 1, "N, m or N/m",                                                     \
      "tension, length, force density or unstressed length, by law; "                                                  \
      "NaN = the pretension of the case")                                                                              \
    X(hf_scene, "cable/EA_N", EA_N, REAL, 1, 1, "N", "axial stiffness, NaN where not given")

#define SHAPE_COLUMNS(X)                                                                                               \
    X(hf_shape, "position_m", position_m, REAL, 0, 3, "m", "position of each node of /scene/node")                     \
    X(hf_shape, "length_m", length_m, REAL, 1, 1, "m", "length of each cable of /scene/cable")                         \
    X(hf_shape, "tension_N", tension_N, REAL, 1, 1, "N", "tension, force density times length")                        \
    X(hf_shape, "q_N_per_m", q_N_per_m, REAL, 1, 1, "N/m", "force density")                                            \
    X(hf_shape, "law", law, LAW, 1, 1, "", "law in force, under the case's method or rule")

/* Columns of hf_truss and of hf_carrier_state in /truss. Here per_cable means per member. */
#define TRUSS_NUMBER_COLUMN(name, units, otherwise, description)                                                       \
    {"member/" #name, HF_KIND_REAL, 1, 1, units, description, offsetof(hf_truss, name)},
#define TRUSS_COLUMNS(X)                                                                                               \
    X(hf_truss, "node/position_m", position_m, REAL, 0, 3, "m", "position without load")                               \
    X(hf_truss, "node/mass_kg", mass_kg, REAL, 0, 1, "kg", "mass of the hinges")                                       \
    X(hf_truss, "member/end", end, INT, 1, 2, "", "the two nodes, as indices from 0 into /truss/node")                 \
    X(hf_truss, "member/joint", joint, JOINT, 1, 1, "", "rigid: clamped to its nodes; pinned: axial force alone")      \
    X(hf_truss, "member/unit", unit, UNIT, 1, 1, "", "basic unit that the member belongs to")

#define TRUSS_STATE_COLUMNS(X)                                                                                         \
    X(hf_carrier_state, "node/displacement", displacement, REAL, 0, 6, "m, rad",                                       \
      "under the pull of the net: along x, y, z, about x, y, z")                                                       \
    X(hf_carrier_state, "node/reaction", reaction, REAL, 0, 6, "N, N m", "of the supports on the truss")               \
    X(hf_carrier_state, "member/end_force", end_force, REAL, 1, 12, "N, N m",                                          \
      "local, of the nodes on the member: Nx (compression), Vy, Vz, Tx, My, Mz at the first end, then at the second")

static const hf_layout_column scene_column[] = {SCENE_COLUMNS(HF_LAYOUT_COLUMN)};
static const hf_layout_column shape_column[] = {SHAPE_COLUMNS(HF_LAYOUT_COLUMN)};
static const hf_layout_column truss_column[] = {TRUSS_COLUMNS(HF_LAYOUT_COLUMN) HF_MEMBER_NUMBERS(TRUSS_NUMBER_COLUMN)};
static const hf_layout_column state_column[] = {TRUSS_STATE_COLUMNS(HF_LAYOUT_COLUMN)};
const hf_layout_columns hf_layout_scene = {HF_LAYOUT_COLUMNS(scene_column)};
const hf_layout_columns hf_layout_shape = {HF_LAYOUT_COLUMNS(shape_column)};
const hf_layout_columns hf_layout_truss = {HF_LAYOUT_COLUMNS(truss_column)};
const hf_layout_columns hf_layout_truss_state = {HF_LAYOUT_COLUMNS(state_column)};

static hf_hdf5_array column_array(const hf_layout_column *c, int n_node, int n_cable)
{
    return (hf_hdf5_array){.name = c->name,
                           .kind = c->kind,
                           .rank = c->columns > 1 ? 2 : 1,
                           .dims = {(hsize_t)(c->per_cable ? n_cable : n_node), (hsize_t)c->columns},
                           .units = c->units,
                           .description = c->description};
}

/* Returns the pointer that `owner` has for column `c`. */
static void *column_values(const hf_layout_column *c, const void *owner)
{
    void *values;
    memcpy(&values, (const char *)owner + c->offset, sizeof values);
    return values;
}

void hf_layout_write_columns(hf_hdf5 *io, hid_t group, const hf_layout_columns *columns, int n_node, int n_cable,
                             const void *owner)
{
    for (const hf_layout_column *c = columns->column; c < columns->column + columns->n; c++) {
        hf_hdf5_array array = column_array(c, n_node, n_cable);
        const void *values = column_values(c, owner);
        if (values) hf_hdf5_write_array(io, group, &array, values);
    }
}

void hf_layout_read_columns(hf_hdf5 *io, hid_t group, const hf_layout_columns *columns, int n_node, int n_cable,
                            void *owner)
{
    for (const hf_layout_column *c = columns->column; c < columns->column + columns->n; c++) {
        hf_hdf5_array array = column_array(c, n_node, n_cable);
        void *values = column_values(c, owner);
        if (values) hf_hdf5_read_array(io, group, &array, values);
    }
}

void hf_layout_renew(hf_hdf5 *io, const char *path)
{
    if (io->status == HF_OK && hf_hdf5_has(io, io->file, path) && H5Ldelete(io->file, path, H5P_DEFAULT) < 0)
        hf_hdf5_fail(io, "replace", io->file, path);
}

/* ---- fields ---- */

/* Returns the bytes of a row in the file. */
static size_t row_bytes(const hf_layout_field *f)
{
    size_t bytes = f->kind == HF_KIND_CHARS ? f->size : hf_hdf5_kind_bytes(f->kind);
    return f->columns ? bytes * (size_t)f->columns : bytes;
}

/* Copies n rows between the structs of the owner and packed values: to the packed ones with `packs`, else back. */
static void copy_field(const hf_layout_field *f, int n, bool packs, char *packed, char *owner)
{
    const hf_hdf5_member number = {.kind = f->kind, .size = f->size};
    size_t bytes = row_bytes(f);
    for (int i = 0; i < n; i++, packed += bytes) {
        char *member = owner + f->offset + (size_t)i * f->stride;
        if (f->kind->class != HF_HDF5_ENUM && f->size != sizeof(bool))
            memcpy(packs ? packed : member, packs ? member : packed, bytes);
        else if (packs)
            *(signed char *)packed = (signed char)hf_hdf5_int_value(&number, member);
        else
            hf_hdf5_set_int_value(&number, *(signed char *)packed, member);
    }
}

static void pass_fields(hf_hdf5 *io, hid_t group, const hf_layout_field *table, int n_field, int n, int columns,
                        bool writes, char *owner)
{
    for (const hf_layout_field *f = table; f < table + n_field && n > 0 && io->status == HF_OK; f++) {
        int per_row = f->columns ? f->columns : columns;
        hf_hdf5_array array = {f->name, f->kind, per_row ? 2 : 1, {(hsize_t)n}, f->units, f->description};
        char *packed = malloc((size_t)n * row_bytes(f));
        if (per_row) array.dims[1] = (hsize_t)per_row;
        if (columns) array.dims[0] = (hsize_t)(n / columns);
        if (f->kind == HF_KIND_CHARS) array.dims[array.rank] = f->size;
        if (!packed) hf_hdf5_no_memory(io);
        if (packed && writes) copy_field(f, n, true, packed, owner);
        if (packed && writes) hf_hdf5_write_array(io, group, &array, packed);
        if (packed && !writes) hf_hdf5_read_array(io, group, &array, packed);
        if (packed && !writes && io->status == HF_OK) copy_field(f, n, false, packed, owner);
        free(packed);
    }
}

void hf_layout_put_fields(hf_hdf5 *io, hid_t group, const hf_layout_field *table, int n_field, int n, int columns,
                          const void *owner)
{
    pass_fields(io, group, table, n_field, n, columns, true, (char *)owner);
}

void hf_layout_get_fields(hf_hdf5 *io, hid_t group, const hf_layout_field *table, int n_field, int n, int columns,
                          void *owner)
{
    pass_fields(io, group, table, n_field, n, columns, false, owner);
}

/* ---- summary ---- */

/* The members of the summary about the run itself. Rows: X(struct, object, attribute, member, kind) */
#define RUN_MEMBERS(X)                                                                                                 \
    X(hf_summary, "/", "title", title, CHARS)                                                                          \
    X(hf_summary, "/", "threads", threads, INT)                                                                        \
    X(hf_summary, "/", "seed", seed, UINT64)                                                                           \
    X(hf_summary, "/", "warnings", warnings, CHARS)                                                                    \
    X(hf_summary, "/", "finished", finished, FLAG)                                                                     \
    X(hf_summary, "/", "has_search", stage[HF_STAGE_SEARCH].exists, FLAG)                                              \
    X(hf_summary, "/", "has_refine", stage[HF_STAGE_REFINE].exists, FLAG)                                              \
    X(hf_summary, "/case", "case_path", case_path, CHARS)                                                              \
    X(hf_summary, "/form", "version", version, CHARS)

#define FORM(type, member, kind, ...) HF_HDF5_MEMBER(hf_summary, NULL, #member, member, kind)
#define SEARCH(type, member, kind, ...) HF_HDF5_MEMBER(hf_search_summary, NULL, #member, member, kind)
#define REFINE(type, member, kind, ...) HF_HDF5_MEMBER(hf_refine_summary, NULL, #member, member, kind)
#define RESULT(type, member, kind, ...) HF_HDF5_MEMBER(hf_stage_summary, NULL, #member, result.member, kind)
#define COUPLING(type, member, kind, ...) HF_HDF5_MEMBER(hf_coupling_result, NULL, #member, member, kind)
#define OTHER_COUPLING(type, member, kind, ...)                                                                        \
    HF_HDF5_MEMBER(hf_coupling_result, NULL, "coupling_" #member, member, kind)
#define TRUSS(type, member, kind, ...) HF_HDF5_MEMBER(hf_truss_summary, NULL, #member, member, kind)
#define TOLERANCE(type, member, kind, ...) HF_HDF5_MEMBER(hf_tolerance_summary, NULL, #member, member, kind)
static const hf_hdf5_member run[] = {RUN_MEMBERS(HF_HDF5_MEMBER)};
static const hf_hdf5_member form[] = {HF_SUMMARY_FORM_LIST(FORM)};
static const hf_hdf5_member search[] = {HF_SUMMARY_SEARCH_LIST(SEARCH)};
static const hf_hdf5_member refine[] = {HF_SUMMARY_REFINE_LIST(REFINE)};
static const hf_hdf5_member stage[] = {HF_RESULT_LIST(RESULT)
                                           HF_HDF5_MEMBER(hf_stage_summary, NULL, "wall_s", wall_s, REAL)};
static const hf_hdf5_member coupling[] = {HF_COUPLING_LIST(COUPLING)};
static const hf_hdf5_member other_coupling[] = {HF_COUPLING_LIST(OTHER_COUPLING)};
static const hf_hdf5_member truss[] = {HF_SUMMARY_TRUSS_LIST(TRUSS)};
static const hf_hdf5_member tolerance[] = {
    HF_TOLERANCE_LIST(TOLERANCE) HF_HDF5_MEMBER(hf_tolerance_summary, NULL, "histogram_low_m", bin_low_m, REAL)
        HF_HDF5_MEMBER(hf_tolerance_summary, NULL, "histogram_high_m", bin_high_m, REAL)};
const hf_layout_members hf_layout_summary[HF_LAYOUT_N_PART] = {
    [HF_LAYOUT_RUN] = {NULL, HF_LAYOUT_TABLE(run)},
    [HF_LAYOUT_FORM] = {"/form", HF_LAYOUT_TABLE(form)},
    [HF_LAYOUT_SEARCH] = {"/search", HF_LAYOUT_TABLE(search)},
    [HF_LAYOUT_REFINE] = {"/refine", HF_LAYOUT_TABLE(refine)},
    [HF_LAYOUT_FORM_STAGE] = {"/form", HF_LAYOUT_TABLE(stage)},
    [HF_LAYOUT_SEARCH_STAGE] = {"/search", HF_LAYOUT_TABLE(stage)},
    [HF_LAYOUT_REFINE_STAGE] = {"/refine", HF_LAYOUT_TABLE(stage)},
    [HF_LAYOUT_FORM_COUPLING] = {"/coupling", HF_LAYOUT_TABLE(coupling)},
    [HF_LAYOUT_SEARCH_COUPLING] = {"/search", HF_LAYOUT_TABLE(other_coupling)},
    [HF_LAYOUT_REFINE_COUPLING] = {"/refine", HF_LAYOUT_TABLE(other_coupling)},
    [HF_LAYOUT_TRUSS] = {"/truss", HF_LAYOUT_TABLE(truss)},
    [HF_LAYOUT_TOLERANCE] = {"/tolerance", HF_LAYOUT_TABLE(tolerance)}};

bool hf_layout_has(const hf_summary *s, hf_layout_part part)
{
    switch (part) {
    case HF_LAYOUT_SEARCH:
    case HF_LAYOUT_SEARCH_STAGE:
        return s->stage[HF_STAGE_SEARCH].exists;
    case HF_LAYOUT_REFINE:
    case HF_LAYOUT_REFINE_STAGE:
        return s->stage[HF_STAGE_REFINE].exists;
    case HF_LAYOUT_FORM_COUPLING:
    case HF_LAYOUT_SEARCH_COUPLING:
    case HF_LAYOUT_REFINE_COUPLING:
        return s->has_coupling && (part == HF_LAYOUT_FORM_COUPLING || s->stage[part - HF_LAYOUT_FORM_COUPLING].exists);
    case HF_LAYOUT_TRUSS:
        return s->has_truss;
    case HF_LAYOUT_TOLERANCE:
        return s->tolerance != NULL;
    default:
        return true;
    }
}

void *hf_layout_owner(const hf_summary *summary, hf_layout_part part)
{
    hf_summary *s = (hf_summary *)summary;
    switch (part) {
    case HF_LAYOUT_SEARCH:
        return &s->search;
    case HF_LAYOUT_REFINE:
        return &s->refine;
    case HF_LAYOUT_FORM_STAGE:
    case HF_LAYOUT_SEARCH_STAGE:
    case HF_LAYOUT_REFINE_STAGE:
        return &s->stage[part - HF_LAYOUT_FORM_STAGE];
    case HF_LAYOUT_FORM_COUPLING:
    case HF_LAYOUT_SEARCH_COUPLING:
    case HF_LAYOUT_REFINE_COUPLING:
        return &s->stage[part - HF_LAYOUT_FORM_COUPLING].result.coupling;
    case HF_LAYOUT_TRUSS:
        return &s->truss;
    case HF_LAYOUT_TOLERANCE:
        return s->tolerance;
    default:
        return s;
    }
}

void hf_layout_put_part(hf_hdf5 *io, hf_layout_part part, const hf_summary *summary)
{
    const hf_layout_members *p = &hf_layout_summary[part];
    if (p->object) hf_hdf5_close(io, hf_hdf5_make_group(io, p->object));
    hf_hdf5_put_members(io, p->object, p->member, p->n, hf_layout_owner(summary, part));
}

void hf_layout_get_part(hf_hdf5 *io, hf_layout_part part, hf_summary *summary)
{
    const hf_layout_members *p = &hf_layout_summary[part];
    hf_hdf5_get_members(io, p->object, p->member, p->n, hf_layout_owner(summary, part));
}

hf_hdf5_array hf_layout_of_variables(const char *name, bool has_rows, int rank, const hsize_t *dims)
{
    static const char *const meaning[][2] = {{"design", "pretension of each design variable"},
                                             {"initial", "pretension of each design variable in the initial design"},
                                             {"lower", "lower bound of each design variable"},
                                             {"upper", "upper bound of each design variable"}};
    size_t i = 0;
    while (strcmp(meaning[i][0], name))
        i++;
    hf_hdf5_array array = {.name = name,
                           .kind = HF_KIND_REAL,
                           .rank = rank,
                           .units = has_rows ? "" : "N",
                           .description =
                               has_rows ? "of each design variable, in the unit of what it varies" : meaning[i][1]};
    for (int d = 0; d < rank; d++)
        array.dims[d] = dims[d];
    return array;
}
