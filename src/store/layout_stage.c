/* Writes and reads what the stages have besides their shapes, by tables of fields:
 *
 *     /surface        settings, frequency_Hz; /surface/STAGE: measures and losses; also of load cases
 *     /pattern/STAGE  the far field, its figures and the feed
 *     /set_tension/STAGE, /at_limit/STAGE    lists of sets and of limits
 *     /objective      rows of the objective or of the front, and their values in the result of each stage
 *     /coupling       attachments, history of the coupling
 *     /load_cases     names and figures of the load cases
 *
 * Sections: groups of stages, surface, far field, sets and limits, objectives, coupling, load cases. */
#include "store/store_internal.h"
#include "store/store_read.h"

#include "base/text.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- groups of stages ---- */

enum { PATH_SIZE = 64 };

/* Writes the path "/group/STAGE". */
static const char *path_of(const char *group, int stage, char path[PATH_SIZE])
{
    snprintf(path, PATH_SIZE, "%s/%s", group, hf_stage_word[stage]);
    return path;
}

/* Names are printed and name groups, so they must have only these characters. */
static bool is_name_right(const char *name)
{
    static const char letters[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";
    return *name && !name[strspn(name, letters)];
}

/* ---- surface ---- */

#define MEASURE(...) HF_RESULT_FIELD(hf_surface_measures, __VA_ARGS__)
#define FIT(type, member, kind_, ...)                                                                                  \
    {.name = "fit_" #member,                                                                                           \
     .kind = HF_RESULT_##kind_,                                                                                        \
     .offset = offsetof(hf_surface_measures, fit.member),                                                              \
     .size = sizeof(type),                                                                                             \
     __VA_ARGS__},
const hf_result_field hf_layout_surface[HF_LAYOUT_N_SURFACE] = {HF_SURFACE_LIST(MEASURE) HF_SURFACE_FIT_LIST(FIT)};
static const hf_result_field settings[] = {
    HF_LAYOUT_NAMED(hf_surface_settings, "kind", kind, SURFACE)
        HF_LAYOUT_NAMED(hf_surface_settings, "focal_length_m", focal_length_m, REAL)
            HF_LAYOUT_NAMED(hf_surface_settings, "strip_width_m", strip_width_m, REAL)
                HF_LAYOUT_NAMED(hf_surface_settings, "mesh_tension_N_per_m", mesh_tension_N_per_m, REAL)};
#define LOSS(member, unit, description) HF_LAYOUT_FIELD(hf_surface_measures, #member, member, REAL, unit, description)
static const hf_layout_field losses[] = {HF_SURFACE_LOSS_LIST(LOSS)};
static const hf_layout_field frequency[] = {
    HF_LAYOUT_FIELD(hf_double_list, "frequency_Hz", value, REAL, "Hz", "frequencies of the gain losses")};

static void pass_measures(hf_hdf5 *io, bool writes, const char *path, int n_frequency, hf_surface_measures *s)
{
    if (writes ? !s->is_measured : !hf_hdf5_has(io, io->file, path)) return;
    s->is_measured = true;
    hid_t group = hf_hdf5_make_group(io, path);
    hf_layout_pass_members(io, writes, path, hf_layout_surface, HF_LAYOUT_N_SURFACE, s);
    for (size_t k = 0; k < HF_HDF5_COUNT(losses); k++) {
        double *list = (double *)(void *)((char *)s + losses[k].offset);
        if (writes || hf_hdf5_has(io, group, losses[k].name))
            hf_layout_pass_fields(io, writes, group, losses + k, 1, n_frequency, 0, s);
        else /* an earlier version */
            for (int i = 0; i < n_frequency; i++)
                list[i] = (double)NAN;
    }
    hf_hdf5_close(io, group);
}

static void pass_surface(hf_hdf5 *io, bool writes, hf_summary *s)
{
    char path[PATH_SIZE];
    hf_double_list *at = &s->surface.frequencies_Hz;
    if (writes ? !(s->surface.focal_length_m > 0) : !hf_hdf5_has(io, io->file, "/surface")) return;
    if (writes) hf_layout_renew(io, io->file, "/surface");
    hid_t group = hf_hdf5_make_group(io, "/surface");
    hf_layout_pass_members(io, writes, "/surface", settings, HF_HDF5_COUNT(settings), &s->surface);
    if (!writes)
        at->n = hf_hdf5_has(io, group, "frequency_Hz") ? hf_hdf5_length(io, group, "frequency_Hz", HF_LIST_MAX) : 0;
    hf_layout_pass_fields(io, writes, group, HF_LAYOUT_TABLE(frequency), at->n, 0, at);
    hf_hdf5_close(io, group);
    for (int i = 0; i < HF_N_STAGE; i++)
        pass_measures(io, writes, path_of("/surface", i, path), at->n, &s->stage[i].surface);
}

/* ---- far field ---- */

#define ANGLES_MAX 1000000 /* maximum number of angles in a file */

static void pass_arrays(hf_hdf5 *io, bool writes, hid_t group, const hf_pattern_table *table)
{
    const hsize_t f = (hsize_t)table->n_frequency, c = (hsize_t)table->n_cut, t = (hsize_t)table->n_theta;
    const struct {
        hf_hdf5_array array;
        double *values;
    } all[] = {
        {{"frequency_Hz", HF_KIND_REAL, 1, {f}, "Hz", ""}, table->frequency_Hz},
        {{"phi_deg", HF_KIND_REAL, 1, {c}, "deg", "of each cut, from +x towards +y"}, table->phi_deg},
        {{"theta_deg", HF_KIND_REAL, 1, {t}, "deg", "from +z; below 0 on the other side of +z"}, table->theta_deg},
        {{"co_dBi", HF_KIND_REAL, 3, {f, c, t}, "dBi", "gain in the polarisation of the feed (Ludwig 3)"},
         table->co_dBi},
        {{"cross_dBi", HF_KIND_REAL, 3, {f, c, t}, "dBi", "gain in the polarisation across it"}, table->cross_dBi},
    };
    for (int i = 0; i < HF_HDF5_COUNT(all); i++)
        hf_hdf5_pass_array(io, writes, group, &all[i].array, all[i].values);
}

#define FIGURE(member, units, description) HF_LAYOUT_MEMBER(hf_cut_figures, #member, member, REAL, units, description)
static const hf_layout_field cut_figures[] = {
    FIGURE(gain_dBi, "dBi", "maximum gain of the cut") FIGURE(beam_deg, "deg", "theta of the maximum gain")
        FIGURE(half_power_width_deg, "deg", "of the beam; NaN where the angles do not reach it, as the next two")
            FIGURE(first_sidelobe_dB, "dB", "the higher one beside the beam, below the beam")
                FIGURE(highest_sidelobe_dB, "dB", "of all in the cut, below the beam")};

#define FEED(name, member, kind) HF_LAYOUT_NAMED(hf_feed, name, member, kind)
static const hf_result_field feed[] = {
    FEED("feed", kind, FEED) FEED("feed_x_m", position_m[0], REAL) FEED("feed_y_m", position_m[1], REAL)
        FEED("feed_z_m", position_m[2], REAL) FEED("axis_x", axis[0], REAL) FEED("axis_y", axis[1], REAL)
            FEED("axis_z", axis[2], REAL) FEED("polarisation_x", co[0], REAL) FEED("polarisation_y", co[1], REAL)
                FEED("polarisation_z", co[2], REAL) FEED("cos_power", cos_power, REAL) FEED("scale", scale, REAL)};

hf_status hf_store_pattern(hf_store *store, hf_stage stage, const hf_pattern_table *t, const hf_pattern_summary *s,
                           hf_messages *messages)
{
    char path[PATH_SIZE];
    if (!store) return HF_OK;
    hf_hdf5 *io = hf_store_enter(store, messages);
    hf_hdf5_close(io, hf_hdf5_make_group(io, "/pattern"));
    hf_layout_renew(io, io->file, path_of("/pattern", (int)stage, path));
    hid_t group = hf_hdf5_make_group(io, path);
    hf_layout_pass_members(io, true, path, feed, HF_HDF5_COUNT(feed), (void *)&s->feed);
    pass_arrays(io, true, group, t);
    hf_layout_pass_fields(io, true, group, HF_LAYOUT_TABLE(cut_figures), t->n_frequency * t->n_cut, t->n_cut,
                          (void *)s->figure);
    hf_hdf5_close(io, group);
    return hf_hdf5_unlock(io->status);
}

/* Reads all but the gain at each angle. */
static void get_pattern(hf_hdf5 *io, hf_summary *summary, int stage)
{
    char path[PATH_SIZE];
    if (!hf_hdf5_has(io, io->file, path_of("/pattern", stage, path))) return;
    hf_pattern_summary *s = summary->stage[stage].pattern = hf_hdf5_take(io, 1, sizeof *s);
    if (!s) return;
    hid_t group = hf_hdf5_open_group(io, path);
    int f = s->n_frequency = hf_hdf5_length(io, group, "frequency_Hz", HF_LIST_MAX);
    int c = s->n_cut = hf_hdf5_length(io, group, "phi_deg", HF_PATTERN_CUTS);
    hf_hdf5_read_list(io, group, "frequency_Hz", HF_KIND_REAL, f, 0, s->frequency_Hz);
    hf_hdf5_read_list(io, group, "phi_deg", HF_KIND_REAL, c, 0, s->phi_deg);
    hf_layout_pass_fields(io, false, group, HF_LAYOUT_TABLE(cut_figures), f * c, c, s->figure);
    hf_layout_pass_members(io, false, path, feed, HF_HDF5_COUNT(feed), &s->feed);
    hf_hdf5_close(io, group);
}

hf_status hf_store_read_pattern(const char *path, hf_stage stage, hf_pattern_table *t, hf_messages *messages)
{
    char name[PATH_SIZE];
    *t = (hf_pattern_table){0};
    hf_hdf5 io = hf_store_open_result(path, messages);
    hid_t group = hf_hdf5_open_group(&io, path_of("/pattern", (int)stage, name));
    int f = hf_hdf5_length(&io, group, "frequency_Hz", HF_LIST_MAX);
    int c = hf_hdf5_length(&io, group, "phi_deg", HF_PATTERN_CUTS);
    int n = hf_hdf5_length(&io, group, "theta_deg", ANGLES_MAX);
    if (io.status == HF_OK && hf_pattern_table_create(f, c, n, t) != HF_OK) hf_hdf5_no_memory(&io);
    if (io.status == HF_OK) pass_arrays(&io, false, group, t);
    hf_hdf5_close(&io, group);
    if (hf_store_close_result(&io) != HF_OK) hf_pattern_table_free(t);
    return io.status;
}

/* ---- sets and limits ---- */

/* Of hf_set_tensions and hf_held_limits. The first field has the length of the list. */
#define SET(name, member, kind, units, description)                                                                    \
    HF_LAYOUT_FIELD(hf_set_tensions, name, member, kind, units, description)
static const hf_layout_field sets[] = {
    SET("ratio", ratio, REAL, "", "the maximum over the minimum; infinite with a slack cable, NaN with a strut")
        SET("name", name, CHARS, "", "name of the set") SET("min_N", min_N, REAL, "N", "minimum tension of each set")
            SET("max_N", max_N, REAL, "N", "maximum tension of each set")};

#define LIMIT(name, member, kind, description) HF_LAYOUT_FIELD(hf_held_limits, name, member, kind, "", description)
static const hf_layout_field limits[] = {
    LIMIT("bound", bound, REAL, "bound of the named one: N, m, or a ratio")
        LIMIT("row", row, INT, "row of optimize.limits; -1: boundary_ratio_cap")
            LIMIT("count", count, INT, "number of cables or attachments of the row at this bound")
                LIMIT("name", name, CHARS, "name of one of them")
                    LIMIT("value", value, REAL, "value of the named one, in the unit of the bound")};

#define OPTIMUM(name, member, kind, units, description)                                                                \
    HF_LAYOUT_FIELD(hf_optima, name, member, kind, units, description)
static const hf_layout_field optima[] = {
    OPTIMUM("merit", merit, REAL, "", "merit of each distinct optimum; psi (m) without objectives")
        OPTIMUM("count", count, INT, "", "number of refinements that found it")};

/* Returns true if the names are valid and in ascending order. They are printed as they are. */
static bool are_sets_right(hf_set_tensions *s)
{
    for (int k = 0; k < s->n; k++) {
        s->name[k][HF_CABLE_SET_NAME_SIZE - 1] = '\0';
        if (hf_cable_set_name_fault(s->name[k]) || (k > 0 && strcmp(s->name[k - 1], s->name[k]) >= 0)) return false;
    }
    return true;
}

/* Returns true if names and indices are valid. Names are printed as they are, so they are trimmed to whole UTF-8
 * characters. */
static bool are_limits_right(hf_held_limits *h)
{
    bool is_right = true;
    for (int i = 0; i < h->n; i++) {
        h->name[i][HF_HELD_NAME_SIZE - 1] = '\0';
        hf_text_trim_utf8(h->name[i]);
        is_right &= *h->name[i] && h->row[i] >= -1 && h->row[i] < HF_DESIGN_ROWS_MAX && h->count[i] > 0;
    }
    return is_right;
}

/* Writes or reads a list of a stage, *owner with *n items in an object of `size` bytes. Reading makes the object if
 * there is a list, of at most `max` items. The first member of the object is their number. Returns true if it was
 * read. */
static bool pass_list(hf_hdf5 *io, bool writes, const char *outer, int stage, const hf_layout_field *table, int n_field,
                      int max, void **owner, size_t size)
{
    char path[PATH_SIZE];
    path_of(outer, stage, path);
    if (writes ? !*owner || *(int *)*owner == 0 : !hf_hdf5_has(io, io->file, path)) return false;
    if (!writes) *owner = hf_hdf5_take(io, 1, size);
    if (writes) hf_hdf5_close(io, hf_hdf5_make_group(io, outer));
    hid_t group = hf_hdf5_make_group(io, path);
    int n = writes ? *(int *)*owner : hf_hdf5_length(io, group, table[0].name, max);
    hf_layout_pass_fields(io, writes, group, table, n_field, n, 0, *owner);
    hf_hdf5_close(io, group);
    if (!writes && io->status == HF_OK) *(int *)*owner = n;
    return !writes && io->status == HF_OK;
}

static void pass_lists(hf_hdf5 *io, bool writes, hf_stage_summary *s, int stage)
{
    void *of = s->sets, *held = s->held, *found = s->optima;
    bool has_sets =
        pass_list(io, writes, "/set_tension", stage, HF_LAYOUT_TABLE(sets), HF_SUMMARY_SETS, &of, sizeof *s->sets);
    s->sets = of;
    if (has_sets && !are_sets_right(s->sets))
        hf_hdf5_damaged(io, io->file, "/set_tension", "does not name sets of cables");
    bool has_limits =
        pass_list(io, writes, "/at_limit", stage, HF_LAYOUT_TABLE(limits), HF_SUMMARY_HELD, &held, sizeof *s->held);
    s->held = held;
    if (has_limits && !are_limits_right(s->held)) hf_hdf5_damaged(io, io->file, "/at_limit", "does not name limits");
    pass_list(io, writes, "/optima", stage, HF_LAYOUT_TABLE(optima), HF_OPTIMA_MAX, &found, sizeof *s->optima);
    s->optima = found;
}

/* ---- objectives ---- */

#define OBJECTIVE(name, member, kind, description)                                                                     \
    HF_LAYOUT_FIELD(hf_objective_list, name, member, kind, "", description)
static const hf_layout_field objective_names[] = {OBJECTIVE("name", name, CHARS, "number, figure and set")};
static const hf_layout_field objective_fits[] = {OBJECTIVE(
    "after_fit", after_fit, INT, "1: surface error for a refocused feed, 0: for a fixed feed, -1: other figure")};
static const hf_layout_field objective_weights[] = {OBJECTIVE("weight", weight, REAL, "of the value in the merit")};

const double *hf_layout_objectives(const hf_summary *s, int stage)
{
    return s->objectives.n > 0 && hf_summary_has_shape(s, (hf_stage)stage) ? s->stage[stage].result.objective : NULL;
}

/* Takes the names as they are read, of an earlier version by their names of today. */
static void name_objectives(hf_hdf5 *io, hf_objective_list *g)
{
    bool is_right = true;
    for (int k = 0; k < g->n; k++) {
        char then[HF_OBJECTIVE_NAME_SIZE], now[2 * HF_OBJECTIVE_NAME_SIZE];
        g->name[k][HF_OBJECTIVE_NAME_SIZE - 1] = '\0';
        memcpy(then, g->name[k], sizeof then);
        snprintf(g->name[k], sizeof g->name[k], "%s", hf_renamed_figure(then, now, sizeof now));
        is_right = is_right && is_name_right(g->name[k]);
    }
    if (io->status == HF_OK && !is_right) hf_hdf5_damaged(io, io->file, "/objective/name", "does not name objectives");
}

void hf_layout_pass_objectives(hf_hdf5 *io, bool writes, const hf_summary *summary)
{
    hf_summary *s = (hf_summary *)summary;
    hf_objective_list *g = &s->objectives;
    if (writes ? g->n == 0 : !hf_hdf5_has(io, io->file, "/objective")) return;
    if (writes) hf_layout_renew(io, io->file, "/objective");
    hid_t group = hf_hdf5_make_group(io, "/objective");
    if (!writes) {
        g->is_front = !hf_hdf5_has(io, group, "weight");
        g->n = hf_hdf5_length(io, group, "name", HF_DESIGN_ROWS_MAX);
        for (int k = 0; k < g->n; k++)
            g->after_fit[k] = -1; /* files of version 0.1 have no such values */
    }
    hf_layout_pass_fields(io, writes, group, HF_LAYOUT_TABLE(objective_names), g->n, 0, g);
    if (writes || hf_hdf5_has(io, group, "after_fit"))
        hf_layout_pass_fields(io, writes, group, HF_LAYOUT_TABLE(objective_fits), g->n, 0, g);
    if (!g->is_front) hf_layout_pass_fields(io, writes, group, HF_LAYOUT_TABLE(objective_weights), g->n, 0, g);
    for (int i = 0; i < HF_N_STAGE; i++) {
        const hf_layout_field values = {.name = hf_stage_word[i],
                                        .kind = HF_KIND_REAL,
                                        .units = "",
                                        .description = "value of each objective, in its own unit",
                                        .stride = sizeof(double),
                                        .size = sizeof(double)};
        if (hf_layout_objectives(s, i))
            hf_layout_pass_fields(io, writes, group, &values, 1, g->n, 0, s->stage[i].result.objective);
    }
    if (!writes) name_objectives(io, g);
    hf_hdf5_close(io, group);
}

/* ---- coupling ---- */

static void write_attachments(hf_hdf5 *io, hid_t group, const hf_model *m)
{
    int *index = hf_hdf5_take(io, (size_t)m->n_attachment, sizeof *index);
    if (!index) return;
    for (int i = 0; i < m->n_attachment; i++)
        index[i] = m->node_of_row[m->attachment_row[i]];
    hf_hdf5_write_list(io, group, "node", HF_KIND_INT, m->n_attachment, 0, "",
                       "each attachment, as an index into /scene/node", index);
    free(index);
}

void hf_layout_write_coupling(hf_hdf5 *io, const hf_model *m, const hf_workspace *w, const hf_coupling_history *h)
{
    static const hf_layout_column history_column[] = {
        {"step_m", HF_KIND_REAL, 0, 1, "m", "maximum displacement of an attachment by the next form-finding",
         offsetof(hf_coupling_history, step_m)},
        {"psi_m", HF_KIND_REAL, 0, 1, "m", "RMS distance of the inner nodes", offsetof(hf_coupling_history, psi_m)},
        {"deflection_max_m", HF_KIND_REAL, 0, 1, "m", "maximum deflection of the truss at an attachment",
         offsetof(hf_coupling_history, deflection_max_m)},
        {0}};
    static const hf_layout_column attachment_column[] = {
        {"displacement_m", HF_KIND_REAL, 0, 3, "m", "of each attachment", offsetof(hf_workspace, displacement_m)},
        {"force_N", HF_KIND_REAL, 0, 3, "N", "pull of the net and its loads on each attachment",
         offsetof(hf_workspace, attachment_force_N)},
        {0}};
    hid_t group = hf_hdf5_make_group(io, "/coupling");
    write_attachments(io, group, m);
    hf_layout_pass_columns(io, true, group, attachment_column, m->n_attachment, 0, w);
    hf_hdf5_close(io, group);
    if (!h) return;
    group = hf_hdf5_make_group(io, "/coupling/history");
    hf_layout_pass_columns(io, true, group, history_column, h->n, 0, h);
    hf_hdf5_close(io, group);
}

/* ---- load cases ---- */

#define LOAD_CASE(...) HF_RESULT_FIELD(hf_load_case_summary, __VA_ARGS__)
#define RESULT(type, member, kind, ...) HF_LAYOUT_NAMED(hf_load_case_summary, #member, result.member, kind)
#define COUPLING(type, member, kind, ...)                                                                              \
    HF_LAYOUT_NAMED(hf_load_case_summary, "coupling_" #member, result.coupling.member, kind)
const hf_result_field hf_layout_load_case[HF_LAYOUT_N_LOAD_CASE] = {HF_RESULT_LIST(RESULT) HF_LOAD_CASE_LIST(LOAD_CASE)
                                                                        HF_COUPLING_LIST(COUPLING)};
static const hf_layout_field load_case_names[] = {
    HF_LAYOUT_MEMBER(hf_load_case_summary, "name", name, CHARS, "", "load cases of the as-built net")};

static void pass_load_cases(hf_hdf5 *io, bool writes, hf_summary *s)
{
    int n = s->n_load_case;
    /* An unfinished result has shapes of load cases, but no list of their names yet. */
    if (writes ? n == 0 : !hf_hdf5_has(io, io->file, "/load_cases/name")) return;
    hid_t group = hf_hdf5_make_group(io, "/load_cases");
    if (writes) hf_layout_renew(io, io->file, "/load_cases/name");
    if (!writes) n = hf_hdf5_length(io, group, "name", HF_LOAD_CASES_MAX);
    if (!writes && n > 0) s->load_case = hf_hdf5_take(io, (size_t)n, sizeof *s->load_case);
    hf_layout_pass_fields(io, writes, group, HF_LAYOUT_TABLE(load_case_names), n, 0, s->load_case);
    hf_hdf5_close(io, group);
    if (io->status == HF_OK) s->n_load_case = n;
    for (int k = 0; k < n && io->status == HF_OK; k++) {
        hf_load_case_summary *of = &s->load_case[k];
        char path[HF_LAYOUT_LOAD_CASE_SIZE], surface[HF_LAYOUT_LOAD_CASE_SIZE + 16];
        of->name[HF_SET_NAME_SIZE - 1] = '\0';
        if (!is_name_right(of->name)) {
            hf_hdf5_damaged(io, io->file, "/load_cases/name", "does not name load cases");
            return;
        }
        snprintf(path, sizeof path, "/load_cases/%s", of->name);
        snprintf(surface, sizeof surface, "%s/surface", path);
        if (writes) hf_hdf5_close(io, hf_hdf5_make_group(io, path));
        hf_layout_pass_members(io, writes, path, hf_layout_load_case, HF_LAYOUT_N_LOAD_CASE, of);
        pass_measures(io, writes, surface, s->surface.frequencies_Hz.n, &of->surface);
    }
}

/* ---- all ---- */

void hf_layout_pass_stages(hf_hdf5 *io, bool writes, const hf_summary *summary)
{
    hf_summary *s = (hf_summary *)summary;
    pass_surface(io, writes, s);
    if (writes) hf_layout_renew(io, io->file, "/set_tension");
    if (writes) hf_layout_renew(io, io->file, "/at_limit");
    if (writes) hf_layout_renew(io, io->file, "/optima");
    for (int i = 0; i < HF_N_STAGE; i++) {
        if (!writes) get_pattern(io, s, i);
        pass_lists(io, writes, &s->stage[i], i);
    }
    hf_layout_pass_objectives(io, writes, s);
    pass_load_cases(io, writes, s);
}
