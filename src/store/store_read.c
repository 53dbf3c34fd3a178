/* Implements the reading calls of <hifdm/store.h> and of store_read.h. Sections: summary, scene, shape, truss, the
 * stored case, provenance. */
#include "store/store_read.h"

#include "base/arena.h"
#include "base/text.h"
#include <hifdm/cable_set.h>

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- summary ---- */

/* Reads the status of the run, and whether the form-finding ran. Earlier versions wrote the status as a text of
 * variable length, which is not read; the status then follows from the stages. */
static void get_status(hf_hdf5 *io, hf_summary *s)
{
    char word[32] = "";
    hf_stage_summary *form = &s->stage[HF_STAGE_FORM], *search = &s->stage[HF_STAGE_SEARCH];
    form->exists = form->result.status != HF_NOT_EVALUATED;
    s->status = form->result.status == HF_OK && search->exists ? search->result.status : form->result.status;
    if (hf_hdf5_has_chars(io, io->file, "/", "status")) {
        hf_hdf5_get(io, io->file, "/", "status", HF_KIND_CHARS, word, sizeof word);
        s->status = hf_status_of_word(word);
    }
    if (!s->finished) s->status = HF_NOT_EVALUATED;
}

static hf_status read_summary(const char *path, hf_summary *summary, bool *is_damaged, hf_messages *messages)
{
    hf_hdf5 io = hf_store_open_result(path, messages);
    *summary = (hf_summary){0};
    if (io.status == HF_OK && hf_hdf5_has(&io, io.file, "points"))
        io.status =
            hf_error(messages, HF_IO,
                     "%s: this file is the merged table of a sweep. Use `hifdm report` to read the table", path);
    hf_layout_pass_part(&io, false, HF_LAYOUT_RUN, summary);
    summary->has_coupling = io.status == HF_OK && hf_hdf5_has(&io, io.file, "coupling");
    summary->has_truss = io.status == HF_OK && hf_hdf5_has(&io, io.file, "/truss");
    for (hf_layout_part part = HF_LAYOUT_CASE; part < HF_LAYOUT_TOLERANCE; part++)
        if (hf_layout_has(summary, part)) hf_layout_pass_part(&io, false, part, summary);
    get_status(&io, summary);
    hf_layout_pass_taken(&io, false, &summary->taken);
    hf_layout_pass_stages(&io, false, summary);
    hf_layout_get_front(&io, summary);
    hf_layout_get_tolerance(&io, summary);
    hf_layout_get_requirements(&io, summary);
    if (io.status == HF_OK && ((int)summary->search.solver < 0 || summary->search.solver > HF_SOLVER_FIXED_POINT))
        hf_hdf5_damaged(&io, io.file, "/search", "names a solver that there is not");
    hf_store_close_result(&io);
    *is_damaged = io.is_damaged;
    if (io.status != HF_OK) hf_summary_free(summary);
    return io.status;
}

hf_status hf_store_read_summary(const char *path, hf_summary *summary, hf_messages *messages)
{
    bool is_damaged;
    return read_summary(path, summary, &is_damaged, messages);
}

hf_status hf_store_read_finished(const char *path, hf_summary *summary, hf_messages *messages)
{
    bool is_damaged;
    hf_status status = read_summary(path, summary, &is_damaged, messages);
    return status == HF_IO && is_damaged ? hf_store_fail_damaged(path, messages) : status;
}

/* ---- scene ---- */

static bool are_sets_right(const hf_scene *s, int n_member)
{
    if (s->set_start[0] != 0) return false;
    for (int k = 0; k < s->n_set; k++) {
        int from = s->set_start[k], to = s->set_start[k + 1];
        if (to <= from || to > n_member || hf_cable_set_name_fault(s->set_name[k])) return false;
        if (k > 0 && strcmp(s->set_name[k - 1], s->set_name[k]) >= 0) return false;
        for (int i = from; i < to; i++)
            if (s->set_cable[i] < 0 || s->set_cable[i] >= s->n_cable ||
                (i > from && s->set_cable[i] <= s->set_cable[i - 1]))
                return false;
    }
    return true;
}

/* Reads the sets of a scene; results of earlier versions have none. The sets are checked before anything uses them. */
static void read_sets(hf_hdf5 *io, hid_t group, hf_scene *s)
{
    if (!hf_hdf5_has(io, group, "set")) return;
    int n_set = hf_hdf5_length(io, group, "set/name", HF_LAYOUT_COUNT_MAX);
    int n_member = hf_hdf5_length(io, group, "set/cable", INT_MAX);
    size_t size = 0;
    char *name = io->status == HF_OK ? hf_hdf5_read_strings(io, group, "set/name", n_set, &size) : NULL;
    if (io->status == HF_OK && size > HF_CABLE_SET_NAME_SIZE)
        hf_hdf5_damaged(io, group, "set/name", "has a name that is too long");
    if (io->status == HF_OK && hf_cable_set_allocate(s, n_set, n_member) != HF_OK) hf_hdf5_no_memory(io);
    if (io->status == HF_OK) {
        hf_hdf5_read_list(io, group, "set/start", HF_KIND_INT, n_set + 1, 0, s->set_start);
        hf_hdf5_read_list(io, group, "set/cable", HF_KIND_INT, n_member, 0, s->set_cable);
        for (int k = 0; k < n_set; k++)
            memcpy((char *)s->set_name[k], name + (size_t)k * size, size);
        if (io->status == HF_OK && (s->set_start[n_set] != n_member || !are_sets_right(s, n_member)))
            hf_hdf5_damaged(io, group, "set", "does not describe sets of cables");
    }
    free(name);
}

/* Reads the facets that the import named, if there are any. */
static void read_facets(hf_hdf5 *io, hid_t group, hf_scene *s)
{
    if (!hf_hdf5_has(io, group, "facet")) return;
    int n = hf_hdf5_length(io, group, "facet", HF_LAYOUT_COUNT_MAX);
    s->facet = hf_hdf5_take(io, (size_t)n + 1, 4 * sizeof *s->facet);
    hf_hdf5_read_list(io, group, "facet", HF_KIND_INT, n, 4, s->facet);
    s->n_facet = n;
    for (int i = 0; i < 4 * n && io->status == HF_OK; i++)
        if (s->facet[i] < 0 || s->facet[i] >= s->n_node)
            hf_hdf5_damaged(io, group, "facet", "names a node that is not there");
}

hf_status hf_store_read_scene(const char *path, hf_scene *scene, hf_messages *messages)
{
    hf_hdf5 io = hf_store_open_result(path, messages);
    *scene = (hf_scene){0};
    hid_t group = hf_hdf5_open_group(&io, "/scene");
    int n_node = hf_hdf5_length(&io, group, "node/role", HF_LAYOUT_COUNT_MAX);
    int n_cable = hf_hdf5_length(&io, group, "cable/law", HF_LAYOUT_COUNT_MAX);
    bool with_load = hf_hdf5_has(&io, group, "node/load_N"), with_EA = hf_hdf5_has(&io, group, "cable/EA_N");
    if (io.status == HF_OK && hf_scene_allocate(scene, n_node, n_cable, with_load, with_EA, false) != HF_OK)
        hf_hdf5_no_memory(&io);
    hf_layout_pass_columns(&io, false, group, hf_layout_scene, n_node, n_cable, scene);
    if (io.status == HF_OK)
        hf_hdf5_read_ids(&io, group, "node/id", n_node, scene->node_id, "cable/id", n_cable, scene->cable_id,
                         &scene->text);
    for (int i = 0; i < 2 * n_cable && io.status == HF_OK; i++)
        if (scene->end[i] < 0 || scene->end[i] >= n_node)
            hf_hdf5_damaged(&io, group, "cable/end", "names a node that is not there");
    read_sets(&io, group, scene);
    read_facets(&io, group, scene);
    hf_hdf5_close(&io, group);
    if (hf_store_close_result(&io) != HF_OK) hf_scene_free(scene);
    return io.status;
}

/* ---- shape ---- */

static void read_shape(hf_hdf5 *io, const char *path, hf_shape *shape)
{
    hid_t group = hf_hdf5_open_group(io, path);
    int n_node = hf_hdf5_length(io, io->file, "/scene/node/role", HF_LAYOUT_COUNT_MAX);
    int n_cable = hf_hdf5_length(io, io->file, "/scene/cable/law", HF_LAYOUT_COUNT_MAX);
    if (io->status == HF_OK &&
        HF_ARENA_ARRAYS(&shape->block, HF_ARRAY(shape->position_m, 3 * (size_t)n_node),
                        HF_ARRAY(shape->length_m, (size_t)n_cable), HF_ARRAY(shape->tension_N, (size_t)n_cable),
                        HF_ARRAY(shape->q_N_per_m, (size_t)n_cable), HF_ARRAY(shape->law, (size_t)n_cable)) != HF_OK)
        hf_hdf5_no_memory(io);
    hf_layout_pass_columns(io, false, group, hf_layout_shape, n_node, n_cable, shape);
    hf_hdf5_close(io, group);
}

hf_status hf_store_read_shape(const char *path, hf_stage stage, hf_shape *shape, hf_messages *messages)
{
    hf_hdf5 io = hf_store_open_result(path, messages);
    *shape = (hf_shape){0};
    char position[32] = "";
    if (stage != HF_N_STAGE) snprintf(position, sizeof position, "%s/position_m", hf_stage_group[stage]);
    bool is_there = *position && hf_hdf5_has(&io, io.file, position);
    if (!is_there && io.status == HF_OK) /* hf_hdf5_has has reported a failure already */
        io.status =
            hf_error(messages, HF_IO,
                     "%s: this result has no %s shape, because that stage did not run or found no feasible design",
                     path, hf_stage_word[stage]);
    read_shape(&io, hf_stage_group[stage], shape);
    if (hf_store_close_result(&io) != HF_OK) hf_shape_free(shape);
    return io.status;
}

/* Returns true if this part of a load case exists; if not, io has the error. Writes the path of the load case into
 * `group`. */
static bool has_state(hf_hdf5 *io, const char *name, const char *part, char group[HF_LAYOUT_LOAD_CASE_SIZE])
{
    char object[HF_LAYOUT_LOAD_CASE_SIZE];
    snprintf(group, HF_LAYOUT_LOAD_CASE_SIZE, "/load_cases/%s", name);
    snprintf(object, sizeof object, "/load_cases/%s/%s", name, part);
    bool is_there = hf_hdf5_has(io, io->file, object);
    if (!is_there && io->status == HF_OK)
        io->status =
            hf_error(io->messages, HF_IO, "%s: this result has no shape of the load case '%s'", io->path, name);
    return is_there;
}

hf_status hf_store_read_load_case(const char *path, const char *name, hf_shape *shape, hf_messages *messages)
{
    char group[HF_LAYOUT_LOAD_CASE_SIZE];
    hf_hdf5 io = hf_store_open_result(path, messages);
    *shape = (hf_shape){0};
    if (has_state(&io, name, "position_m", group)) read_shape(&io, group, shape);
    if (hf_store_close_result(&io) != HF_OK) hf_shape_free(shape);
    return io.status;
}

void hf_shape_free(hf_shape *shape)
{
    hf_arena_free_block(shape->block);
    *shape = (hf_shape){0};
}

/* ---- truss ---- */

hf_status hf_store_read_load_case_truss(const char *path, const char *name, const hf_truss *truss,
                                        hf_carrier_state *state, hf_messages *messages)
{
    char group[HF_LAYOUT_LOAD_CASE_SIZE];
    *state = (hf_carrier_state){0};
    hf_hdf5 io = hf_store_open_result(path, messages);
    if (has_state(&io, name, "truss", group)) {
        strncat(group, "/truss", sizeof group - strlen(group) - 1);
        hid_t id = hf_hdf5_open_group(&io, group);
        hf_layout_read_truss_state(&io, id, truss, state);
        hf_hdf5_close(&io, id);
    }
    if (hf_store_close_result(&io) != HF_OK) hf_carrier_state_free(state);
    return io.status;
}

/* ---- the stored case ---- */

/* Splits a text into *n lines in place. Returns the list of lines, which the caller frees, or NULL if memory runs
 * out. */
static const char **split_lines(char *text, int *n)
{
    size_t count = 1;
    for (char *p = text; *p; p++)
        count += *p == '\n';
    const char **line = calloc(count, sizeof *line);
    *n = 0;
    for (char *rest, *p = line ? strtok_r(text, "\n", &rest) : NULL; p; p = strtok_r(NULL, "\n", &rest))
        line[(*n)++] = p;
    return line;
}

bool hf_store_parse_case(hf_hdf5 *io, const char *path, hf_case *settings)
{
    const char **set = NULL;
    uint64_t seed = 0;
    size_t size;
    int n_set = 0;
    bool is_known = false;
    hf_hdf5_get(io, io->file, "/", "seed", HF_KIND_UINT64, &seed, sizeof seed);
    char *text = hf_hdf5_read_strings(io, io->file, "/case/text", -1, &size);
    char *overrides = hf_hdf5_read_strings(io, io->file, "/case/overrides", -1, &size);
    if (io->status == HF_OK && !(set = split_lines(overrides, &n_set))) hf_hdf5_no_memory(io);
    if (io->status == HF_OK) is_known = hf_config_parse(path, text, set, n_set, settings, NULL) == HF_OK;
    settings->optimize.seed = seed; /* --seed may have set it */
    free(set);
    free(text);
    free(overrides);
    return is_known;
}

void hf_store_read_case(hf_hdf5 *io, hf_case *settings)
{
    if (!hf_store_parse_case(io, io->path, settings) && io->status == HF_OK)
        hf_hdf5_damaged(io, io->file, "/case", "has keys that this version does not know");
}

int hf_store_case_differences(const char *path, const hf_case *settings, char *text, size_t size)
{
    hf_case *then = calloc(1, sizeof *then);
    *text = '\0';
    if (!then) return 0;
    hf_hdf5 io = hf_store_open_result(path, NULL);
    bool is_known = io.status == HF_OK && hf_store_parse_case(&io, settings->path, then);
    is_known = hf_store_close_result(&io) == HF_OK && is_known;
    int n = is_known ? hf_config_differences(then, settings, text, size) : 0;
    hf_case_free(then);
    free(then);
    return n;
}

/* ---- provenance ---- */

hf_status hf_store_read_provenance(const char *path, char *text, size_t size, hf_messages *messages)
{
    static const char *const from[][2] = {{"/", "started_utc"},  {"/", "finished_utc"}, {"/", "host"},
                                          {"/", "version"},      {"/", "git_describe"}, {"/", "compiler"},
                                          {"/", "build_flags"},  {"/", "lapack"},       {"/", "gsl_version"},
                                          {"/", "hdf5_version"}, {"/", "rng"},          {"/case", "sha256"}};
    hf_hdf5 io = hf_store_open_result(path, messages);
    size_t used = 0;
    *text = '\0';
    for (int i = 0; i < HF_HDF5_COUNT(from); i++) {
        char value[6144] = "", line[6144]; /* build flags may be long */
        if (!hf_hdf5_has_chars(&io, io.file, from[i][0], from[i][1])) continue;
        hf_hdf5_get(&io, io.file, from[i][0], from[i][1], HF_KIND_CHARS, value, sizeof value);
        hf_text_escape(value, line, sizeof line); /* one line, whatever the value contains */
        int n = snprintf(text + used, size - used, "%s: %s\n", from[i][1], line);
        if (n < 0 || (size_t)n >= size - used) break; /* the text ends where its room ends */
        used += (size_t)n;
    }
    return hf_store_close_result(&io);
}
