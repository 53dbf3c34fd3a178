/* Implements layout.h for the scene, the shapes, the truss and the summary. Sections: enumerations, columns,
 * fields, members, summary. */
#include "store/layout.h"

#include <hifdm/scene.h>
#include <hifdm/store.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- enumerations ---- */

/* Of rows (name, value, word) and of rows with more columns. */
#define WORD(name, value, word) word,
#define FIRST_WORD(name, value, word, ...) word,
#define VALUE(name, value, ...) value,
/* Defines a kind by such a list. */
#define LISTED(kind, name, LIST, WORD)                                                                                 \
    static const char *const name##_word[] = {LIST(WORD)};                                                             \
    static const signed char name##_value[] = {LIST(VALUE)};                                                           \
    kind = {HF_HDF5_ENUM, HF_HDF5_COUNT(name##_word), name##_word, name##_value}
LISTED(const hf_hdf5_kind hf_layout_status, status, HF_STATUS_LIST, FIRST_WORD);
LISTED(static const hf_hdf5_kind kind_of_stop_reason, stop, HF_STOP_REASON_LIST, WORD);
LISTED(static const hf_hdf5_kind kind_of_coupling_stop, coupling, HF_COUPLING_STOP_LIST, WORD);
LISTED(static const hf_hdf5_kind kind_of_bound_reason, bound, HF_BOUND_REASON_LIST, FIRST_WORD);

/* Values of the words are 0, 1, 2, ... Lists of words for ENDED_WORDS end with NULL. */
#define WORDS(word) HF_HDF5_ENUM, HF_HDF5_COUNT(word), word, NULL
#define ENDED_WORDS(word) HF_HDF5_ENUM, HF_HDF5_COUNT(word) - 1, word, NULL
const hf_hdf5_kind hf_layout_role = {WORDS(hf_role_word)}, hf_layout_group = {WORDS(hf_group_word)};
const hf_hdf5_kind hf_layout_law = {WORDS(hf_law_word)}, hf_layout_verdict = {WORDS(hf_verdict_word)};
static const hf_hdf5_kind kind_of_joint = {ENDED_WORDS(hf_joint_word)}, kind_of_unit = {WORDS(hf_unit_word)};
static const hf_hdf5_kind kind_of_search_stop = {WORDS(hf_population_stop_word)};
static const hf_hdf5_kind kind_of_refine_stop = {WORDS(hf_refine_stop_word)};
static const hf_hdf5_kind kind_of_surface = {ENDED_WORDS(hf_surface_kind_word)};
static const hf_hdf5_kind kind_of_feed = {HF_HDF5_ENUM, 4, hf_feed_word, NULL};
/* Stored as its number, without words. */
static const hf_hdf5_kind kind_of_solver = {HF_HDF5_INT, HF_HDF5_COUNT(hf_solver_word), hf_solver_word, NULL};
#define HF_KIND_JOINT (&kind_of_joint)
#define HF_KIND_UNIT (&kind_of_unit)

const hf_hdf5_kind *hf_layout_kind_of(const hf_result_field *field)
{
    static const hf_hdf5_kind *const kind[] = {
        [HF_RESULT_REAL] = HF_KIND_REAL,
        [HF_RESULT_INT] = HF_KIND_INT,
        [HF_RESULT_STATUS] = HF_KIND_STATUS,
        [HF_RESULT_STOP_REASON] = &kind_of_stop_reason,
        [HF_RESULT_COUPLING_STOP] = &kind_of_coupling_stop,
        [HF_RESULT_BOUND_REASON] = &kind_of_bound_reason,
        [HF_RESULT_LONG] = HF_KIND_LONG,
        [HF_RESULT_FLAG] = HF_KIND_FLAG,
        [HF_RESULT_TRUTH] = HF_KIND_INT, /* a number, because it is older than the flags */
        [HF_RESULT_REFINE_STOP] = &kind_of_refine_stop,
        [HF_RESULT_SOLVER] = &kind_of_solver,
        [HF_RESULT_SEARCH_STOP] = &kind_of_search_stop,
        [HF_RESULT_UINT64] = HF_KIND_UINT64,
        [HF_RESULT_CHARS] = HF_KIND_CHARS,
        [HF_RESULT_SURFACE] = &kind_of_surface,
        [HF_RESULT_FEED] = &kind_of_feed,
    };
    return kind[field->kind];
}

/* ---- columns ---- */

const hf_layout_column hf_layout_scene[] = {
    HF_LAYOUT_COLUMN(hf_scene, "node/position_m", position_m, REAL, 0, 3, "m",
                     "target position; of supports also the real one"),
    HF_LAYOUT_COLUMN(hf_scene, "node/load_N", load_N, REAL, 0, 3, "N", "load"),
    HF_LAYOUT_COLUMN(hf_scene, "node/role", role, ROLE, 0, 1, "", "support, inner (counted by psi) or edge"),
    HF_LAYOUT_COLUMN(hf_scene, "cable/end", end, INT, 1, 2, "", "the two nodes, as indices from 0 into /scene/node"),
    HF_LAYOUT_COLUMN(hf_scene, "cable/group", group, GROUP, 1, 1, "", "inner or boundary"),
    HF_LAYOUT_COLUMN(hf_scene, "cable/law", law, LAW, 1, 1, "", "what the scene asks of the cable"),
    HF_LAYOUT_COLUMN(hf_scene, "cable/target", target, REAL, 1, 1, "N, m or N/m",
                     "tension, length, force density or unstressed length, by law; NaN = the pretension of the case"),
    HF_LAYOUT_COLUMN(hf_scene, "cable/EA_N", EA_N, REAL, 1, 1, "N", "axial stiffness, NaN where not given"),
    {0}};

const hf_layout_column hf_layout_shape[] = {
    HF_LAYOUT_COLUMN(hf_shape, "position_m", position_m, REAL, 0, 3, "m", "position of each node of /scene/node"),
    HF_LAYOUT_COLUMN(hf_shape, "length_m", length_m, REAL, 1, 1, "m", "length of each cable of /scene/cable"),
    HF_LAYOUT_COLUMN(hf_shape, "tension_N", tension_N, REAL, 1, 1, "N", "tension, force density times length"),
    HF_LAYOUT_COLUMN(hf_shape, "q_N_per_m", q_N_per_m, REAL, 1, 1, "N/m", "force density"),
    HF_LAYOUT_COLUMN(hf_shape, "law", law, LAW, 1, 1, "", "law in force, under the case's method or rule"),
    {0}};

/* Columns of hf_truss and of hf_carrier_state in /truss. Here per_cable means per member. */
#define NUMBER(name, units, otherwise, description)                                                                    \
    {"member/" #name, HF_KIND_REAL, 1, 1, units, description, offsetof(hf_truss, name)},
const hf_layout_column hf_layout_truss[] = {
    HF_LAYOUT_COLUMN(hf_truss, "node/position_m", position_m, REAL, 0, 3, "m", "position without load"),
    HF_LAYOUT_COLUMN(hf_truss, "node/mass_kg", mass_kg, REAL, 0, 1, "kg", "mass of the hinges"),
    HF_LAYOUT_COLUMN(hf_truss, "member/end", end, INT, 1, 2, "", "the two nodes, as indices from 0 into /truss/node"),
    HF_LAYOUT_COLUMN(hf_truss, "member/joint", joint, JOINT, 1, 1, "",
                     "rigid: clamped to its nodes; pinned: axial force alone"),
    HF_LAYOUT_COLUMN(hf_truss, "member/unit", unit, UNIT, 1, 1, "", "basic unit that the member belongs to"),
    HF_MEMBER_NUMBERS(NUMBER){0}};

const hf_layout_column hf_layout_truss_state[] = {
    HF_LAYOUT_COLUMN(hf_carrier_state, "node/displacement", displacement, REAL, 0, 6, "m, rad",
                     "under the pull of the net: along x, y, z, about x, y, z"),
    HF_LAYOUT_COLUMN(hf_carrier_state, "node/reaction", reaction, REAL, 0, 6, "N, N m", "of the supports on the truss"),
    HF_LAYOUT_COLUMN(hf_carrier_state, "member/end_force", end_force, REAL, 1, 12, "N, N m",
                     "local, of the nodes on the member: Nx (compression), Vy, Vz, Tx, My, Mz at the first end, then "
                     "at the second"),
    {0}};

void hf_layout_pass_columns(hf_hdf5 *io, bool writes, hid_t group, const hf_layout_column *columns, int n_node,
                            int n_cable, const void *owner)
{
    for (const hf_layout_column *c = columns; c->name; c++) {
        const hsize_t n = (hsize_t)(c->per_cable ? n_cable : n_node);
        const hf_hdf5_array array = {c->name,  c->kind,       c->columns > 1 ? 2 : 1, {n, (hsize_t)c->columns},
                                     c->units, c->description};
        void *values;
        memcpy(&values, (const char *)owner + c->offset, sizeof values);
        if (values) hf_hdf5_pass_array(io, writes, group, &array, values);
    }
}

void hf_layout_renew(hf_hdf5 *io, hid_t place, const char *name)
{
    if (hf_hdf5_has(io, place, name) && H5Ldelete(place, name, H5P_DEFAULT) < 0)
        hf_hdf5_fail(io, "replace", place, name);
}

/* ---- fields ---- */

int hf_layout_int(const void *value, size_t size)
{
    return size == sizeof(bool) ? *(const bool *)value : *(const int *)value;
}

static void set_int(void *to, size_t size, int value)
{
    if (size == sizeof(bool))
        *(bool *)to = value != 0;
    else
        *(int *)to = value;
}

/* Returns the bytes of a row in the file. */
static size_t row_bytes(const hf_layout_field *f)
{
    size_t bytes = f->kind == HF_KIND_CHARS ? f->size : hf_hdf5_kind_bytes(f->kind);
    return f->columns ? bytes * (size_t)f->columns : bytes;
}

void hf_layout_copy(const hf_hdf5_kind *kind, size_t bytes, size_t size, size_t stride, int n, bool packs, char *packed,
                    char *owner)
{
    bool is_alike = kind->class != HF_HDF5_ENUM || size == bytes;
    if (is_alike && stride == bytes && n > 0) { /* one item */
        bytes *= (size_t)n;
        n = 1;
    }
    if (is_alike && packs && bytes == sizeof(double)) { /* the same, several times faster */
        for (int i = 0; i < n; i++)
            memcpy(packed + (size_t)i * sizeof(double), owner + (size_t)i * stride, sizeof(double));
        return;
    }
    if (packs && size == sizeof(int) && (!is_alike || bytes == sizeof(int))) { /* the same, too */
        for (int i = 0, value; i < n; i++) {
            memcpy(&value, owner + (size_t)i * stride, sizeof value);
            if (is_alike)
                memcpy(packed + (size_t)i * sizeof value, &value, sizeof value);
            else
                packed[i] = (char)(signed char)value;
        }
        return;
    }
    for (int i = 0; i < n; i++, packed += bytes, owner += stride) {
        if (is_alike)
            memcpy(packs ? packed : owner, packs ? owner : packed, bytes);
        else if (packs)
            *(signed char *)packed = (signed char)hf_layout_int(owner, size);
        else
            set_int(owner, size, *(signed char *)packed);
    }
}

void hf_layout_pass_fields(hf_hdf5 *io, bool writes, hid_t group, const hf_layout_field *table, int n_field, int n,
                           int columns, void *owner)
{
    for (const hf_layout_field *f = table; f < table + n_field && n > 0 && io->status == HF_OK; f++) {
        int per_row = f->columns ? f->columns : columns;
        char *member = (char *)owner + f->offset;
        hf_hdf5_array array = {f->name, f->kind, per_row ? 2 : 1, {(hsize_t)n}, f->units, f->description};
        char *packed = hf_hdf5_take(io, (size_t)n, row_bytes(f));
        if (per_row) array.dims[1] = (hsize_t)per_row;
        if (columns) array.dims[0] = (hsize_t)(n / columns);
        if (f->kind == HF_KIND_CHARS) array.dims[array.rank] = f->size;
        if (packed && writes) hf_layout_copy(f->kind, row_bytes(f), f->size, f->stride, n, true, packed, member);
        if (packed) hf_hdf5_pass_array(io, writes, group, &array, packed);
        if (io->status == HF_OK && !writes)
            hf_layout_copy(f->kind, row_bytes(f), f->size, f->stride, n, false, packed, member);
        free(packed);
    }
}

/* ---- members ---- */

void hf_layout_pass_members(hf_hdf5 *io, bool writes, const char *object, const hf_result_field *field, int n,
                            void *owner)
{
    for (const hf_result_field *f = field; f < field + n; f++) {
        const hf_hdf5_kind *kind = hf_layout_kind_of(f);
        bool is_byte = kind->class == HF_HDF5_ENUM, is_int = kind->class == HF_HDF5_INT;
        void *member = (char *)owner + f->offset;
        int value = writes && (is_byte || is_int) ? hf_layout_int(member, f->size) : 0;
        signed char byte = (signed char)value;
        void *stored = is_byte ? &byte : is_int ? &value : member;
        if (writes && kind == HF_KIND_CHARS) {
            hf_hdf5_put_chars(io, io->file, object, f->name, member);
        } else if (writes) {
            hf_hdf5_put(io, io->file, object, f->name, kind, 0, stored);
        } else if (*io->made_by && hf_hdf5_has(io, io->file, object) &&
                   !hf_hdf5_has_attribute(io, io->file, object, f->name)) { /* another version did not have it yet */
            memset(member, 0, f->size);
            if (kind == HF_KIND_REAL) *(double *)member = (double)NAN;
        } else {
            hf_hdf5_get(io, io->file, object, f->name, kind, stored, f->size);
            if (is_byte || is_int) set_int(member, f->size, is_byte ? byte : value);
        }
    }
}

/* ---- summary ---- */

#define FORM(...) HF_RESULT_FIELD(hf_summary, __VA_ARGS__)
#define STAGE(type, member, kind, ...) HF_LAYOUT_NAMED(hf_stage_summary, #member, result.member, kind)
#define SEARCH(...) HF_RESULT_FIELD(hf_search_summary, __VA_ARGS__)
#define REFINE(...) HF_RESULT_FIELD(hf_refine_summary, __VA_ARGS__)
#define OTHER_COUPLING(type, member, kind, ...) HF_LAYOUT_NAMED(hf_coupling_result, "coupling_" #member, member, kind)
#define TRUSS(...) HF_RESULT_FIELD(hf_truss_summary, __VA_ARGS__)
#define TOLERANCE(...) HF_RESULT_FIELD(hf_tolerance_summary, __VA_ARGS__)
static const hf_result_field run[] = {
    HF_LAYOUT_NAMED(hf_summary, "title", title, CHARS) HF_LAYOUT_NAMED(hf_summary, "threads", threads, INT)
        HF_LAYOUT_NAMED(hf_summary, "seed", seed, UINT64) HF_LAYOUT_NAMED(hf_summary, "warnings", warnings, CHARS)
            HF_LAYOUT_NAMED(hf_summary, "finished", finished, FLAG)
                HF_LAYOUT_NAMED(hf_summary, "has_search", stage[HF_STAGE_SEARCH].exists, FLAG)
                    HF_LAYOUT_NAMED(hf_summary, "has_refine", stage[HF_STAGE_REFINE].exists, FLAG)};
static const hf_result_field of_case[] = {HF_LAYOUT_NAMED(hf_summary, "case_path", case_path, CHARS)};
static const hf_result_field version[] = {HF_LAYOUT_NAMED(hf_summary, "version", version, CHARS)};
static const hf_result_field form[] = {HF_SUMMARY_FORM_LIST(FORM)}, search[] = {HF_SUMMARY_SEARCH_LIST(SEARCH)},
                             refine[] = {HF_SUMMARY_REFINE_LIST(REFINE)}, truss[] = {HF_SUMMARY_TRUSS_LIST(TRUSS)};
static const hf_result_field stage[] = {HF_RESULT_LIST(STAGE)
                                            HF_LAYOUT_NAMED(hf_stage_summary, "wall_s", wall_s, REAL)};
static const hf_result_field other_coupling[] = {HF_COUPLING_LIST(OTHER_COUPLING)};
static const hf_result_field tolerance[] = {
    HF_TOLERANCE_LIST(TOLERANCE) HF_LAYOUT_NAMED(hf_tolerance_summary, "histogram_low_m", bin_low_m, REAL)
        HF_LAYOUT_NAMED(hf_tolerance_summary, "histogram_high_m", bin_high_m, REAL)};

#define OF(table) table, HF_HDF5_COUNT(table)
#define OF_STAGE(i) OF(stage), offsetof(hf_summary, stage[i]), i
#define OF_OTHER_COUPLING(i) OF(other_coupling), offsetof(hf_summary, stage[i].result.coupling), i
const hf_layout_members hf_layout_summary[HF_LAYOUT_N_PART] = {
    [HF_LAYOUT_RUN] = {"/", OF(run), 0, HF_STAGE_FORM},
    [HF_LAYOUT_CASE] = {"/case", OF(of_case), 0, HF_STAGE_FORM},
    [HF_LAYOUT_VERSION] = {"/form", OF(version), 0, HF_STAGE_FORM},
    [HF_LAYOUT_FORM] = {"/form", OF(form), 0, HF_STAGE_FORM},
    [HF_LAYOUT_SEARCH] = {"/search", OF(search), offsetof(hf_summary, search), HF_STAGE_SEARCH},
    [HF_LAYOUT_REFINE] = {"/refine", OF(refine), offsetof(hf_summary, refine), HF_STAGE_REFINE},
    [HF_LAYOUT_FORM_STAGE] = {"/form", OF_STAGE(HF_STAGE_FORM)},
    [HF_LAYOUT_SEARCH_STAGE] = {"/search", OF_STAGE(HF_STAGE_SEARCH)},
    [HF_LAYOUT_REFINE_STAGE] = {"/refine", OF_STAGE(HF_STAGE_REFINE)},
    [HF_LAYOUT_FORM_COUPLING] = {"/coupling", hf_coupling_field_of, HF_COUPLING_N,
                                 offsetof(hf_summary, stage[HF_STAGE_FORM].result.coupling), HF_STAGE_FORM},
    [HF_LAYOUT_SEARCH_COUPLING] = {"/search", OF_OTHER_COUPLING(HF_STAGE_SEARCH)},
    [HF_LAYOUT_REFINE_COUPLING] = {"/refine", OF_OTHER_COUPLING(HF_STAGE_REFINE)},
    [HF_LAYOUT_TRUSS] = {"/truss", OF(truss), offsetof(hf_summary, truss), HF_STAGE_FORM},
    [HF_LAYOUT_TOLERANCE] = {"/tolerance", OF(tolerance), offsetof(hf_summary, tolerance), HF_STAGE_FORM}};

bool hf_layout_has(const hf_summary *s, hf_layout_part part)
{
    hf_stage needed = hf_layout_summary[part].stage;
    bool is_coupling = part >= HF_LAYOUT_FORM_COUPLING && part <= HF_LAYOUT_REFINE_COUPLING;
    if (part == HF_LAYOUT_TRUSS) return s->has_truss;
    if (part == HF_LAYOUT_TOLERANCE) return s->tolerance != NULL;
    return (s->has_coupling || !is_coupling) && (needed == HF_STAGE_FORM || s->stage[needed].exists);
}

void *hf_layout_owner(const hf_summary *summary, hf_layout_part part)
{
    return part == HF_LAYOUT_TOLERANCE ? summary->tolerance
                                       : (void *)((char *)summary + hf_layout_summary[part].offset);
}

void hf_layout_pass_part(hf_hdf5 *io, bool writes, hf_layout_part part, const hf_summary *summary)
{
    const hf_layout_members *p = &hf_layout_summary[part];
    if (writes) hf_hdf5_close(io, hf_hdf5_make_group(io, p->object));
    hf_layout_pass_members(io, writes, p->object, p->field, p->n, hf_layout_owner(summary, part));
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
    const char *units = has_rows ? "" : "N";
    const char *description = has_rows ? "of each design variable, in the unit of what it varies" : meaning[i][1];
    hf_hdf5_array array = {name, HF_KIND_REAL, rank, {0}, units, description};
    memcpy(array.dims, dims, (size_t)rank * sizeof *dims);
    return array;
}

void hf_layout_write_variables(hf_hdf5 *io, hid_t group, const char *name, bool has_rows, int n, const double *values)
{
    const hf_hdf5_array array = hf_layout_of_variables(name, has_rows, 1, &(hsize_t){(hsize_t)n});
    hf_hdf5_write_array(io, group, &array, values);
}
