/* Implements renamed.h. Sections: tables, names in a file of 0.2, old names in new files, names of figures. */
#include "store/renamed.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- tables ---- */

/* Groups that have moved, and what is in them. Those with `attributes` had data sets and attributes that are mixed
 * elsewhere now. A row comes before the rows whose path is the beginning of its own. */
static const struct {
    const char *now, *then, *attributes;
} group_table[] = {{"/search/population/last", "/ga/last", "/ga/last"},
                   {"/search/population", "/ga", "/ga"},
                   {"/search", "/ga/best", "/ga"},
                   {"/variable", "/ga", "/ga"},
                   {"/refine", "/polish", "/polish"},
                   {"/surface/search", "/surface/optimize", NULL},
                   {"/surface/refine", "/surface/polish", NULL},
                   {"/pattern/search", "/pattern/optimize", NULL},
                   {"/pattern/refine", "/pattern/polish", NULL},
                   {"/at_limit/search", "/at_limit/optimize", NULL},
                   {"/at_limit/refine", "/at_limit/polish", NULL},
                   {"/set_tension/search", "/set_tension/optimize", NULL},
                   {"/set_tension/refine", "/set_tension/polish", NULL},
                   {"/objective", "/goals", NULL},
                   {"/load_cases", "/cases", NULL}};

/* Data sets whose own name has changed, by the path that their group has in a file of 0.2; "/x/" is every group below
 * /x. With `by_row` the name depended on the design variables: `then` in N, `by_row` with optimize.variables. */
static const struct {
    const char *group, *now, *then, *by_row;
} data_set_table[] = {{"/ga", "design", "design_N", "design"},
                      {"/ga/best", "design", "design_N", "design"},
                      {"/ga/last", "design", "design_N", "design"},
                      {"/polish", "design", "design_N", "design"},
                      {"/front", "design", "design_N", "design"},
                      {"/ga", "initial", "base_N", "base"},
                      {"/ga", "lower", "lower_N", "lower"},
                      {"/ga", "upper", "upper_N", "upper"},
                      {"/ga", "cable", "gene_cable", NULL},
                      {"/ga", "group", "gene_group", NULL},
                      {"/ga", "leader", "gene_leader", NULL},
                      {"/ga", "row", "gene_variable", NULL},
                      {"/ga", "node", "gene_node", NULL},
                      {"/ga", "direction", "gene_direction", NULL},
                      {"/ga", "violation_min", "least_violation", NULL},
                      {"/goals", "search", "optimize", NULL},
                      {"/goals", "refine", "polish", NULL},
                      {"/front", "initial", "base", NULL},
                      {"/front", "steps", "iterations", NULL},
                      {"/front", "variable", "gene", NULL},
                      {"/set_tension/", "min_N", "least_N", NULL},
                      {"/set_tension/", "max_N", "largest_N", NULL},
                      {"/tolerance", "min", "least", NULL},
                      {"/tolerance", "max", "largest", NULL},
                      {"/tolerance/sample", "tension_min_N", "least_tension_N", NULL},
                      {"/coupling/history", "deflection_max_m", "max_displacement_m", NULL}};

/* Attributes whose own name has changed, by their group of today. Of /search all others had the prefix best_, except
 * those of search_table. */
static const struct {
    const char *group, *now, *then;
} attribute_table[] = {{"/", "has_search", "has_optimize"},
                       {"/", "has_refine", "has_polish"},
                       {"/form", "objectives", "goals"}, /* these three are lists of a points file */
                       {"/search", "objectives", "best_goals"},
                       {"/refine", "objectives", "goals"},
                       {"/form", "n_variable", "n_gene"},
                       {"/form", "wall_s", "form_wall_s"},
                       {"/coupling", "deflection_max_m", "max_displacement_m"},
                       {"/search", "initial_psi_m", "base_psi_m"},
                       {"/search", "algorithm_stop", "optimize_stop"},
                       {"/search", "wall_s", "optimize_wall_s"},
                       {"/search", "cpu_s", "optimize_cpu_s"},
                       {"/search", "best_generation", "best_generation"},
                       {"/search", "best_individual", "best_individual"},
                       {"/search", "coupling_deflection_max_m", "best_coupling_max_displacement_m"},
                       {"/refine", "steps", "polish_iterations"},
                       {"/refine", "algorithm_stop", "polish_stop"},
                       {"/refine", "evaluations", "polish_evaluations"},
                       {"/refine", "is_result", "polish_is_result"},
                       {"/refine", "n_at_lower", "polish_n_at_lower"},
                       {"/refine", "n_at_upper", "polish_n_at_upper"},
                       {"/refine", "is_at_cap", "polish_is_at_cap"},
                       {"/refine", "n_at_limit", "polish_n_at_limit"},
                       {"/refine", "wall_s", "polish_wall_s"},
                       {"/refine", "coupling_deflection_max_m", "coupling_max_displacement_m"},
                       {"/load_cases/", "tension_min_N", "least_tension_N"},
                       {"/load_cases/", "tension_max_N", "largest_tension_N"},
                       {"/load_cases/", "displacement_rms_m", "move_rms_m"},
                       {"/load_cases/", "member_force_max_N", "largest_member_N"},
                       {"/load_cases/", "coupling_deflection_max_m", "coupling_max_displacement_m"}};

static const char *const search_table[] = {"solver",      "n_leader",   "planes",     "generations",
                                           "evaluations", "infeasible", "store_cpu_s"};

/* Parts of names of figures and measures. */
static const struct {
    const char *then, *now;
} figure_table[] = {
    {"good_to_Hz", "gain_loss_1dB_Hz"}, {"least_tension_N", "tension_min_N"}, {"largest_tension_N", "tension_max_N"}};

/* Beginning of the name of an objective, and the word of a figure that objectives have. */
static const char *const objective_then[] = {"goal_", "displacement"}, *const objective_now[] = {"objective_",
                                                                                                 "deflection"};

/* ---- names in a file of 0.2 ---- */

/* Replaces the first `from` in text[size] by `to`. */
static void replace(char *text, size_t size, const char *from, const char *to)
{
    char rest[HF_HDF5_NAME_SIZE];
    char *at = strstr(text, from);
    if (!at) return;
    snprintf(rest, sizeof rest, "%s", at + strlen(from));
    snprintf(at, size - (size_t)(at - text), "%s%s", to, rest);
}

/* Writes the name of an objective, such as goal_1_displacement_edge, with other words into to[size]: words[0] for its
 * beginning, words[1] for its figure. The set at its end keeps its name. Returns false if it is no objective. */
static bool rename_objective(const char *name, const char *const from[2], const char *const words[2], char *to,
                             size_t size)
{
    size_t n = strlen(from[0]), n_figure = strlen(from[1]);
    size_t digits = strncmp(name, from[0], n) ? 0 : strspn(name + n, "0123456789");
    const char *figure = name + n + digits + 1;
    if (!digits || figure[-1] != '_') return false;
    bool is_renamed = !strncmp(figure, from[1], n_figure) && (!figure[n_figure] || figure[n_figure] == '_');
    snprintf(to, size, "%s%.*s_%s%s", words[0], (int)digits, name + n, is_renamed ? words[1] : "",
             is_renamed ? figure + n_figure : figure);
    return true;
}

/* Returns the row of group_table for a path, or -1. */
static int group_of(const char *path)
{
    for (int i = 0; i < HF_HDF5_COUNT(group_table); i++) {
        size_t n = strlen(group_table[i].now);
        if (!strncmp(path, group_table[i].now, n) && (!path[n] || path[n] == '/')) return i;
    }
    return -1;
}

/* Returns true if the first n characters of `path` are the group of a row. */
static bool is_in(const char *group, const char *path, size_t n)
{
    size_t length = strlen(group);
    if (length > 1 && group[length - 1] == '/') return n > length && !strncmp(path, group, length);
    return n == length && !strncmp(path, group, n);
}

/* Returns the name of a data set in the group of n characters at `path`, or `now`. */
static const char *data_set_then(const char *path, size_t n, const char *now, bool by_row)
{
    for (int i = 0; i < HF_HDF5_COUNT(data_set_table); i++)
        if (is_in(data_set_table[i].group, path, n) && !strcmp(data_set_table[i].now, now))
            return by_row && data_set_table[i].by_row ? data_set_table[i].by_row : data_set_table[i].then;
    return now;
}

/* Writes the name of an attribute of the group `path` of today into then[size]. Returns false if it did not exist. */
static bool attribute_then(const char *path, const char *now, char *then, size_t size)
{
    for (int i = 0; i < HF_HDF5_COUNT(attribute_table); i++)
        if (is_in(attribute_table[i].group, path, strlen(path)) && !strcmp(attribute_table[i].now, now)) {
            snprintf(then, size, "%s", attribute_table[i].then);
            return true;
        }
    bool is_of_best = !strcmp(path, "/search");
    for (int i = 0; i < HF_HDF5_COUNT(search_table); i++)
        is_of_best &= strcmp(search_table[i], now) != 0;
    snprintf(then, size, "%s%s", is_of_best ? "best_" : "", now);
    return strcmp(now, "algorithm") != 0;
}

/* Returns true if the objects in a group of a merge, without "/points", are figures. In the other groups their names
 * are those of axes and load cases. */
static bool is_of_figures(const char *group)
{
    return strcmp(group, "/input") != 0 && strcmp(group, "/load_cases") != 0;
}

/* Replaces the name of a figure, measure or objective by that of 0.2. Those of /search had the prefix best_. */
static void name_figure_then(char name[HF_HDF5_NAME_SIZE])
{
    char now[HF_HDF5_NAME_SIZE];
    size_t n = strncmp(name, "best_", 5) ? 0 : 5;
    snprintf(now, sizeof now, "%s", name + n);
    if (rename_objective(now, objective_now, objective_then, name + n, HF_HDF5_NAME_SIZE - n)) return;
    for (int f = 0; f < HF_HDF5_COUNT(figure_table); f++)
        replace(name, HF_HDF5_NAME_SIZE, figure_table[f].now, figure_table[f].then);
}

/* Writes the path of an object of a merge without "/points": all numbers are data sets there, by the names of the
 * attributes. */
static void point_then(const char *path, char *then, size_t size)
{
    char group[HF_HDF5_NAME_SIZE], name[HF_HDF5_NAME_SIZE];
    const char *leaf = strrchr(path, '/');
    snprintf(group, sizeof group, "%.*s", leaf == path ? 1 : (int)(leaf - path), path);
    int i = group_of(path), k = group_of(group);
    bool is_group = i >= 0 && !strcmp(path, group_table[i].now);
    const char *from = is_group ? path : group;
    if (is_group) k = i;
    if (k >= 0 && !strcmp(from, group_table[k].now) && group_table[k].attributes)
        snprintf(then, size, "%s", group_table[k].attributes);
    else if (k >= 0)
        snprintf(then, size, "%s%s", group_table[k].then, from + strlen(group_table[k].now));
    else
        snprintf(then, size, "%.500s", group[1] ? group : "");
    if (is_group || !attribute_then(group, leaf + 1, name, sizeof name)) return;
    if (is_of_figures(group)) name_figure_then(name);
    size_t n = strlen(then);
    snprintf(then + n, size - n, "/%s", name);
}

static void object_then(const char *path, bool by_row, char *then, size_t size)
{
    static const char points[] = "/points";
    size_t n = sizeof points - 1;
    if (!strncmp(path, points, n) && path[n] == '/') {
        snprintf(then, size, "%s", points);
        point_then(path + n, then + n, size - n);
        return;
    }
    int i = group_of(path);
    snprintf(then, size, "%s%s", i < 0 ? "" : group_table[i].then, i < 0 ? path : path + strlen(group_table[i].now));
    char *leaf = strrchr(then, '/');
    if (!leaf || !leaf[1]) return;
    const char *other = data_set_then(then, (size_t)(leaf - then), leaf + 1, by_row);
    if (other != leaf + 1) snprintf(leaf + 1, size - (size_t)(leaf + 1 - then), "%s", other);
}

bool hf_renamed(const char *path, const char *attribute, int k, char object[HF_HDF5_NAME_SIZE],
                char name[HF_HDF5_NAME_SIZE])
{
    int i = group_of(path);
    if (attribute && !attribute_then(path, attribute, name, HF_HDF5_NAME_SIZE)) return false;
    if (attribute && i >= 0 && !strcmp(path, group_table[i].now) && group_table[i].attributes)
        snprintf(object, HF_HDF5_NAME_SIZE, "%s", group_table[i].attributes);
    else
        object_then(path, k == 1, object, HF_HDF5_NAME_SIZE);
    return k < (attribute ? 1 : 2);
}

void hf_renamed_note(hf_hdf5 *io)
{
    hf_hdf5 probe = {.path = io->path, .status = io->status, .file = io->file};
    int version = 0;
    if (hf_hdf5_has_attribute(&probe, probe.file, "/", "format_version"))
        hf_hdf5_get(&probe, probe.file, "/", "format_version", HF_KIND_INT, &version, sizeof version);
    bool is_unread = io->status == HF_OK && probe.status != HF_OK && !probe.is_damaged;
    if (is_unread)
        io->status =
            hf_error(io->messages, probe.status, "%s: cannot read the attribute format_version of this file", io->path);
    if (version == HF_FORMAT_0_2) io->alias = hf_renamed;
}

/* ---- old names in new files ---- */

enum { OBJECTS_MAX = 4096 };

typedef struct {
    hf_hdf5 *io;
    bool has_rows;
    int n;
    struct {
        char *path;
        bool is_group;
    } object[OBJECTS_MAX];
} linking;

static void note_object(void *context, const char *path, hid_t object, H5I_type_t type)
{
    linking *l = context;
    (void)object;
    if (l->n == OBJECTS_MAX || !strncmp(path, "/VTKHDF", 7)) return;
    char *copy = strdup(path);
    if (!copy) {
        hf_hdf5_no_memory(l->io);
        return;
    }
    l->object[l->n].is_group = type == H5I_GROUP;
    l->object[l->n++].path = copy;
}

static void note_link(void *context, const char *path, hid_t object, H5I_type_t type)
{
    if (type == H5I_BADID) note_object(context, path, object, type);
}

static void link_to(hf_hdf5 *io, const char *now, const char *then)
{
    if (io->status == HF_OK && H5Lexists(io->file, then, H5P_DEFAULT) == 0 &&
        H5Lcreate_soft(now, io->file, then, H5P_DEFAULT, H5P_DEFAULT) < 0)
        hf_hdf5_fail(io, "write", io->file, then);
}

/* Returns the path below /points of an object of a merge; of any other object its whole path. */
static const char *below_points(const char *path)
{
    return strncmp(path, "/points/", 8) ? path : strchr(path + 1, '/');
}

static void link_data_set(const linking *l, const char *path)
{
    char then[HF_HDF5_NAME_SIZE], beside[HF_HDF5_NAME_SIZE];
    int i = group_of(below_points(path));
    if (!strcmp(path, "/search/population/design")) return; /* it had the designs of all generations */
    object_then(path, l->has_rows, then, sizeof then);
    if (i >= 0 && group_table[i].attributes)
        link_to(l->io, path, then);
    else if (strcmp(strrchr(path, '/'), strrchr(then, '/')) != 0) {
        snprintf(beside, sizeof beside, "%.*s%s", (int)(strrchr(path, '/') - path), path, strrchr(then, '/'));
        link_to(l->io, path, beside);
    }
}

typedef struct {
    hf_hdf5 *io;
    const char *path;
} copying;

static herr_t copy_attribute(hid_t group, const char *name, const H5A_info_t *info, void *context)
{
    copying *c = context;
    char object[HF_HDF5_NAME_SIZE], then[HF_HDF5_NAME_SIZE];
    (void)group, (void)info;
    if (hf_renamed(c->path, name, 0, object, then) && (strcmp(c->path, object) != 0 || strcmp(name, then) != 0))
        hf_hdf5_copy_attribute(c->io, c->path, name, object, then);
    return c->io->status == HF_OK ? 0 : 1;
}

/* Makes the old group of one that has moved, with copies of its attributes, or a link to it. */
static void link_group(hf_hdf5 *io, const char *path)
{
    copying c = {io, path};
    const char *below = below_points(path);
    bool is_of_merge = below != path;
    int i = group_of(below);
    bool is_moved = i >= 0 && !strcmp(below, group_table[i].now);
    char then[HF_HDF5_NAME_SIZE];
    object_then(path, false, then, sizeof then);
    bool is_mixed = is_moved && group_table[i].attributes;
    if (is_moved && !is_mixed) link_to(io, path, then);
    if (is_mixed && is_of_merge) hf_hdf5_close(io, hf_hdf5_make_group(io, then));
    if (is_of_merge) return;
    if (is_mixed) {
        hf_hdf5_close(io, hf_hdf5_make_group(io, group_table[i].attributes));
        hf_hdf5_close(io, hf_hdf5_make_group(io, group_table[i].then));
        if (io->status == HF_OK &&
            H5Aiterate_by_name(io->file, path, H5_INDEX_NAME, H5_ITER_INC, NULL, copy_attribute, &c, H5P_DEFAULT) < 0)
            hf_hdf5_fail(io, "read", io->file, path);
        return;
    }
    for (int k = 0; k < HF_HDF5_COUNT(attribute_table); k++)
        if (is_in(attribute_table[k].group, path, strlen(path)) && io->status == HF_OK &&
            H5Aexists_by_name(io->file, path, attribute_table[k].now, H5P_DEFAULT) > 0)
            hf_hdf5_copy_attribute(io, path, attribute_table[k].now, path, attribute_table[k].then);
}

void hf_renamed_link(hf_hdf5 *io, bool has_rows)
{
    linking *l = hf_hdf5_take(io, 1, sizeof *l);
    if (!l) return;
    l->io = io;
    l->has_rows = has_rows;
    hf_hdf5_walk(io, note_object, l);
    link_group(io, "/");
    for (int i = 0; i < l->n; i++) {
        if (l->object[i].is_group)
            link_group(io, l->object[i].path);
        else
            link_data_set(l, l->object[i].path);
        free(l->object[i].path);
    }
    free(l);
}

void hf_renamed_unlink(hf_hdf5 *io)
{
    linking *l = hf_hdf5_take(io, 1, sizeof *l);
    if (!l) return;
    l->io = io;
    hf_hdf5_walk(io, note_link, l);
    for (int i = 0; i < l->n; i++) {
        if (io->status == HF_OK && H5Ldelete(io->file, l->object[i].path, H5P_DEFAULT) < 0)
            hf_hdf5_fail(io, "write", io->file, l->object[i].path);
        free(l->object[i].path);
    }
    for (int i = 0; i < HF_HDF5_COUNT(group_table); i++) {
        const char *group = group_table[i].attributes;
        if (group && hf_hdf5_has(io, io->file, group) && H5Ldelete(io->file, group, H5P_DEFAULT) < 0)
            hf_hdf5_fail(io, "write", io->file, group);
    }
    free(l);
}

/* ---- names of today ---- */

const char *hf_renamed_figure(const char *then, char *now, size_t size)
{
    if (rename_objective(then, objective_then, objective_now, now, size)) return now;
    snprintf(now, size, "%s", then);
    for (int i = 0; i < HF_HDF5_COUNT(figure_table); i++)
        replace(now, size, figure_table[i].then, figure_table[i].now);
    return now;
}

const char *hf_renamed_point(const char *group, const char *then, char *now, size_t size)
{
    static const char points[] = "/points";
    size_t n = sizeof points - 1;
    const char *name = then;
    if (strncmp(group, points, n) != 0 || !is_of_figures(group + n)) {
        snprintf(now, size, "%s", then);
        return now;
    }
    for (int i = 0; i < HF_HDF5_COUNT(attribute_table); i++)
        if (is_in(attribute_table[i].group, group[n] ? group + n : "/", group[n] ? strlen(group + n) : 1) &&
            !strcmp(attribute_table[i].then, then)) {
            snprintf(now, size, "%s", attribute_table[i].now);
            return now;
        }
    if (!strcmp(group + n, "/search") && !strncmp(then, "best_", 5)) name += 5;
    return hf_renamed_figure(name, now, size);
}
