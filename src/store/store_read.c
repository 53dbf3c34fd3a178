/* Contents: opening a result file - whose result is it? - summary - scene - shape - series - provenance */
#include "store/store_read.h"

#include "base/arena.h"
#include "store/hdf5_io.h"
#include "store/journal.h"
#include "base/sha256.h"
#include "store/store_coupling.h"
#include "store/store_surface.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* ---- opening a result file ---- */

/* Is an open file one of ours? Whatever another program's file holds instead of our mark is no reason to complain. */
static int is_ours(const hf_hdf5 *io)
{
    char program[16] = "";
    hf_messages unwanted = {0};
    hf_hdf5 probe = {.path = io->path, .messages = &unwanted, .status = HF_OK, .file = io->file};
    hf_hdf5_get(&probe, probe.file, "/", "program", HF_KIND_CHARS, program, sizeof program);
    hf_messages_free(&unwanted);
    return !strcmp(program, HF_PROGRAM);
}

hf_hdf5 hf_store_open_result(const char *path, hf_messages *messages)
{
    hf_hdf5 io = {.path = path, .messages = messages, .status = HF_OK, .file = -1};
    struct stat info;
    int version = 0;
    if (stat(path, &info) != 0) {
        io.status = hf_error(messages, HF_IO, "%s: cannot open: %s", path, strerror(errno));
    } else if (S_ISDIR(info.st_mode)) {
        io.status = hf_error(messages, HF_IO, "%s: is a folder, not a result file", path);
    } else if (!S_ISREG(info.st_mode) || H5Fis_hdf5(path) == 0) {
        io.status = hf_error(messages, HF_IO, "%s: is not an HDF5 file, so no result of hifdm", path);
    } else {
        hf_hdf5_open_file(&io, path, 0);
    }
    if (io.status != HF_OK) return io;
    if (!is_ours(&io))
        io.status = hf_error(messages, HF_IO, "%s: is an HDF5 file, but no result of hifdm or a damaged one", path);
    hf_hdf5_get(&io, io.file, "/", "format_version", HF_KIND_INT, &version, sizeof version);
    if (io.status == HF_OK && version != HF_FORMAT_VERSION)
        io.status = hf_error(messages, HF_IO, "%s: is of format version %d, this program reads version %d", path,
                             version, HF_FORMAT_VERSION);
    return io;
}

/* ---- whose result is it? ---- */

/* identity = digest of the identity so far and of these bytes */
static void extend(char identity[65], const void *data, size_t bytes)
{
    char both[128], hex[65];
    hf_sha256(bytes ? data : "", bytes, hex);
    memcpy(both, identity, 64);
    memcpy(both + 64, hex, 64);
    hf_sha256(both, sizeof both, identity);
}

static void extend_columns(char identity[65], const hf_hdf5_column *table, int n, int n_node, int n_cable,
                           const void *owner)
{
    for (int i = 0; i < n; i++) {
        const void *values;
        memcpy(&values, (const char *)owner + table[i].offset, sizeof values);
        size_t rows = (size_t)(table[i].per_cable ? n_cable : n_node);
        extend(identity, values, values ? rows * (size_t)table[i].columns * hf_hdf5_kind_bytes(table[i].kind) : 0);
    }
}

/* With the NUL of each, so that "a", "bc" is not "ab", "c". */
static hf_status extend_ids(char identity[65], int n, const char *const *id)
{
    size_t size = 1, used = 0;
    for (int i = 0; i < n; i++)
        size += strlen(id[i]) + 1;
    char *text = malloc(size);
    if (!text) return HF_NO_MEMORY;
    for (int i = 0; i < n; i++)
        used += strlen(strcpy(text + used, id[i])) + 1;
    extend(identity, text, used);
    free(text);
    return HF_OK;
}

hf_status hf_store_identify(const hf_case *settings, const hf_scene *scene, const hf_truss *truss, char identity[65])
{
    static const hf_hdf5_column net[] = {HF_SCENE_COLUMNS(HF_HDF5_COLUMN)};
    static const hf_hdf5_column carrier[] = {HF_TRUSS_COLUMNS(HF_HDF5_COLUMN)
                                                 HF_MEMBER_NUMBERS(HF_TRUSS_NUMBER_COLUMN)};
    char words[128];
    int n = snprintf(words, sizeof words, "%s %llu", settings->sha256, (unsigned long long)settings->optimize.seed);
    hf_sha256(words, (size_t)n, identity);
    extend_columns(identity, net, HF_HDF5_COUNT(net), scene->n_node, scene->n_cable, scene);
    HF_TRY(extend_ids(identity, scene->n_node, scene->node_id));
    HF_TRY(extend_ids(identity, scene->n_cable, scene->cable_id));
    if (!truss) return HF_OK;
    extend_columns(identity, carrier, HF_HDF5_COUNT(carrier), truss->n_node, truss->n_member, truss);
    extend(identity, truss->fixed, (size_t)truss->n_node);
    HF_TRY(extend_ids(identity, truss->n_node, truss->node_id));
    return extend_ids(identity, truss->n_member, truss->member_id);
}

/* Split lines in place; the caller frees the list. NULL when memory ran out. */
static const char **split_lines(char *text, int *n)
{
    size_t count = 1;
    for (char *p = text; *p; p++)
        count += *p == '\n';
    const char **line = calloc(count, sizeof *line);
    *n = 0;
    for (char *p = text; line && *p;) {
        char *end = strchr(p, '\n');
        line[(*n)++] = p;
        if (!end) break;
        *end = '\0';
        p = end + 1;
    }
    return line;
}

/* Did the file's case make sense to this version? path: where the files that it names are looked for. */
static int read_case(hf_hdf5 *io, const char *path, hf_case *then)
{
    char *text = NULL, *overrides = NULL;
    const char **set = NULL;
    hf_messages unwanted = {0};
    uint64_t seed = 0;
    int n_set = 0, is_known = 0;
    hf_hdf5_get(io, io->file, "/", "seed", HF_KIND_UINT64, &seed, sizeof seed);
    hf_hdf5_read_text(io, io->file, "/case/text", &text);
    hf_hdf5_read_text(io, io->file, "/case/overrides", &overrides);
    if (io->status == HF_OK && !(set = split_lines(overrides, &n_set))) hf_hdf5_no_memory(io);
    if (io->status == HF_OK) is_known = hf_config_parse(path, text, set, n_set, then, &unwanted) == HF_OK;
    then->optimize.seed = seed; /* as --seed may have set it */
    hf_messages_free(&unwanted);
    free(set);
    free(text);
    free(overrides);
    return is_known;
}

void hf_store_read_case(hf_hdf5 *io, hf_case *settings)
{
    if (!read_case(io, io->path, settings) && io->status == HF_OK)
        hf_hdf5_damaged(io, io->file, "/case", "has keys that this version does not know");
}

/* Which keys differ between the stored case and this one, in words. */
static void tell_difference(hf_hdf5 *io, const hf_case *now, char *words, size_t size)
{
    hf_case then = {0};
    if (!read_case(io, now->path, &then))
        snprintf(words, size, "%s", "keys that this version does not know");
    else if (hf_config_differences(&then, now, words, size) == 0)
        snprintf(words, size, "%s",
                 "no key, but comments and layout of the case, or its tables of the net or of the truss");
    hf_case_free(&then);
}

/* A run that was killed after its result had got its name leaves a journal that nobody needs. */
static void remove_journal(const char *path)
{
    char name[4096];
    hf_journal journal;
    hf_messages unwanted = {0};
    snprintf(name, sizeof name, "%s.journal", path);
    if (access(name, F_OK) != 0) return;
    hf_status status = hf_journal_open(path, 0, &journal, &unwanted);
    hf_journal_close(&journal, status == HF_OK);
    hf_messages_free(&unwanted);
}

hf_status hf_store_look(const char *path, const hf_case *settings, const hf_scene *scene, const hf_truss *truss,
                        hf_store_state *state, hf_messages *messages)
{
    char now[65], then[65] = "", words[1024] = "";
    signed char finished = 0;
    struct stat info;
    *state = HF_STORE_NOTHING;
    if (stat(path, &info) != 0 || !S_ISREG(info.st_mode)) return HF_OK; /* hf_store_create says what is wrong */
    hf_messages unwanted = {0};
    HF_TRY(hf_store_identify(settings, scene, truss, now));
    hf_hdf5_lock();
    hf_hdf5 io = hf_store_open_result(path, &unwanted);
    hf_hdf5_get(&io, io.file, "/", "finished", HF_KIND_FLAG, &finished, 1);
    hf_hdf5_get(&io, io.file, "/", "identity", HF_KIND_CHARS, then, sizeof then);
    if (io.status == HF_OK && strcmp(now, then) != 0) tell_difference(&io, settings, words, sizeof words);
    hf_hdf5_close_file(&io);
    hf_messages_free(&unwanted);
    hf_hdf5_unlock(HF_OK);
    if (io.status != HF_OK)
        return hf_error(
            messages, HF_EXISTS,
            "%s: exists and is no result of hifdm; use --restart (of a sweep: --retry failed) to replace it or "
            "-o to choose another name",
            path);
    if (*words)
        return hf_error(messages, HF_EXISTS,
                        "%s: exists and is the %s result of another case; what differs: %s. Use --restart (of a sweep: "
                        "--retry failed) to replace it "
                        "or -o to choose another name",
                        path, finished ? "finished" : "unfinished", words);
    *state = finished ? HF_STORE_FINISHED : HF_STORE_UNFINISHED;
    if (finished) remove_journal(path);
    return HF_OK;
}

/* ---- summary ---- */

/* Of the run. Older files have it as a text of variable length, which is not read: there the stages say it. */
static void get_status(hf_hdf5 *io, hf_summary *s)
{
    char word[32] = "";
    s->status = s->form.status == HF_OK && s->has_optimize ? s->best.status : s->form.status;
    if (hf_hdf5_has_chars(io, io->file, "/", "status")) {
        hf_hdf5_get(io, io->file, "/", "status", HF_KIND_CHARS, word, sizeof word);
        s->status = hf_status_of_word(word);
    }
    if (!s->finished) s->status = HF_NOT_EVALUATED;
}

hf_status hf_store_read_summary(const char *path, hf_summary *summary, hf_messages *messages)
{
    static const hf_hdf5_member form[] = {HF_SUMMARY_FORM_MEMBERS(HF_HDF5_MEMBER)};
    static const hf_hdf5_member ga[] = {HF_SUMMARY_GA_MEMBERS(HF_HDF5_MEMBER)};
    static const hf_hdf5_member polish[] = {HF_SUMMARY_POLISH_MEMBERS(HF_HDF5_MEMBER)};
    static const hf_hdf5_member truss[] = {HF_SUMMARY_TRUSS_MEMBERS(HF_HDF5_MEMBER)};
    hf_hdf5_lock();
    hf_hdf5 io = hf_store_open_result(path, messages);
    *summary = (hf_summary){0};
    hf_hdf5_get_members(&io, form, HF_HDF5_COUNT(form), summary);
    summary->has_coupling = io.status == HF_OK && hf_hdf5_has(&io, io.file, "coupling");
    if (summary->has_coupling) hf_store_get_coupling(&io, summary);
    if (summary->has_polish) hf_hdf5_get_members(&io, polish, HF_HDF5_COUNT(polish), summary);
    if (summary->has_optimize) hf_hdf5_get_members(&io, ga, HF_HDF5_COUNT(ga), summary);
    get_status(&io, summary);
    hf_store_get_surface(&io, summary);
    summary->has_truss = hf_hdf5_has(&io, io.file, "/truss");
    if (summary->has_truss) hf_hdf5_get_members(&io, truss, HF_HDF5_COUNT(truss), summary);
    hf_hdf5_close_file(&io);
    if (io.status != HF_OK) *summary = (hf_summary){0};
    return hf_hdf5_unlock(io.status);
}

/* ---- scene ---- */

/* The n strings of a data set as they are stored, side by side; the caller frees the arena. */
static char *read_chars(hf_hdf5 *io, hid_t group, const char *name, int n, size_t *length, hf_arena *arena)
{
    *length = hf_hdf5_chars_length(io, group, name);
    hf_arena_take(arena, (size_t)n, *length);
    if (io->status != HF_OK) return NULL;
    if (hf_arena_allocate(arena) != HF_OK) {
        hf_hdf5_no_memory(io);
        return NULL;
    }
    hf_hdf5_array array = {.name = name, .kind = HF_KIND_CHARS, .rank = 1, .dims = {(hsize_t)n, *length}};
    char *chars = hf_arena_take(arena, (size_t)n, *length);
    hf_hdf5_read_array(io, group, &array, chars);
    return chars;
}

/* Lay the strings out one after the other from `text` on, each with its NUL, and set the ids. */
static void place_ids(const char *chars, size_t length, int n, const char **id, char *text)
{
    for (int i = 0; i < n; i++) {
        const char *from = chars + (size_t)i * length, *end = memchr(from, '\0', length);
        size_t used = end ? (size_t)(end - from) : length;
        id[i] = memcpy(text, from, used);
        text += used;
        *text++ = '\0';
    }
}

void hf_store_read_ids(hf_hdf5 *io, hid_t group, const char *name_a, int n, const char **id_a, const char *name_b,
                       int m, const char **id_b, void **text)
{
    size_t length_a, length_b;
    hf_arena a = {0}, b = {0}, all = {0};
    const char *chars_a = read_chars(io, group, name_a, n, &length_a, &a);
    const char *chars_b = read_chars(io, group, name_b, m, &length_b, &b);
    hf_arena_take(&all, (size_t)n, length_a + 1);
    hf_arena_take(&all, (size_t)m, length_b + 1);
    if (io->status == HF_OK && hf_arena_allocate(&all) != HF_OK) hf_hdf5_no_memory(io);
    if (io->status == HF_OK) {
        *text = all.block;
        place_ids(chars_a, length_a, n, id_a, hf_arena_take(&all, (size_t)n, length_a + 1));
        place_ids(chars_b, length_b, m, id_b, hf_arena_take(&all, (size_t)m, length_b + 1));
    }
    hf_arena_free(&a);
    hf_arena_free(&b);
}

static void check_ends(hf_hdf5 *io, hid_t group, const hf_scene *scene)
{
    for (int i = 0; i < 2 * scene->n_cable && io->status == HF_OK; i++)
        if (scene->end[i] < 0 || scene->end[i] >= scene->n_node)
            hf_hdf5_damaged(io, group, "cable/end", "names a node that is not there");
}

hf_status hf_store_read_scene(const char *path, hf_scene *scene, hf_messages *messages)
{
    static const hf_hdf5_column table[] = {HF_SCENE_COLUMNS(HF_HDF5_COLUMN)};
    hf_hdf5_lock();
    hf_hdf5 io = hf_store_open_result(path, messages);
    *scene = (hf_scene){0};
    hid_t group = hf_hdf5_open_group(&io, "/scene");
    int n_node = hf_hdf5_length(&io, group, "node/role", HF_STORE_COUNT_MAX);
    int n_cable = hf_hdf5_length(&io, group, "cable/law", HF_STORE_COUNT_MAX);
    int with_load = hf_hdf5_has(&io, group, "node/load_N"), with_EA = hf_hdf5_has(&io, group, "cable/EA_N");
    if (io.status == HF_OK && hf_scene_allocate(scene, n_node, n_cable, with_load, with_EA, 0) != HF_OK)
        hf_hdf5_no_memory(&io);
    hf_hdf5_read_columns(&io, group, table, HF_HDF5_COUNT(table), n_node, n_cable, scene);
    if (io.status == HF_OK)
        hf_store_read_ids(&io, group, "node/id", n_node, scene->node_id, "cable/id", n_cable, scene->cable_id,
                          &scene->text);
    check_ends(&io, group, scene);
    hf_hdf5_close(&io, group);
    hf_hdf5_close_file(&io);
    if (io.status != HF_OK) hf_scene_free(scene);
    return hf_hdf5_unlock(io.status);
}

/* ---- shape ---- */

static void lay_out(hf_arena *arena, size_t n_node, size_t n_cable, hf_shape *shape)
{
    shape->position_m = hf_arena_take(arena, 3 * n_node, sizeof(double));
    shape->length_m = hf_arena_take(arena, n_cable, sizeof(double));
    shape->tension_N = hf_arena_take(arena, n_cable, sizeof(double));
    shape->q_N_per_m = hf_arena_take(arena, n_cable, sizeof(double));
    shape->law = hf_arena_take(arena, n_cable, 1);
}

static hf_status allocate_shape(int n_node, int n_cable, hf_shape *shape)
{
    hf_arena arena = {0};
    lay_out(&arena, (size_t)n_node, (size_t)n_cable, shape);
    HF_TRY(hf_arena_allocate(&arena));
    lay_out(&arena, (size_t)n_node, (size_t)n_cable, shape);
    shape->block = arena.block;
    return HF_OK;
}

hf_status hf_store_read_shape(const char *path, hf_stage stage, hf_shape *shape, hf_messages *messages)
{
    static const hf_hdf5_column table[] = {HF_SHAPE_COLUMNS(HF_HDF5_COLUMN)};
    hf_hdf5_lock();
    hf_hdf5 io = hf_store_open_result(path, messages);
    *shape = (hf_shape){0};
    int is_there = stage != HF_STAGE_NONE && (stage != HF_STAGE_OPTIMIZE || hf_hdf5_has(&io, io.file, "/ga")) &&
                   hf_hdf5_has(&io, io.file, hf_stage_group[stage]);
    if (!is_there && io.status == HF_OK) /* a question that fails has said so itself */
        io.status =
            hf_error(messages, HF_IO, "%s: has no %s shape: that stage did not run, or found no feasible design", path,
                     hf_stage_word[stage]);
    hid_t group = hf_hdf5_open_group(&io, hf_stage_group[stage]);
    int n_node = hf_hdf5_length(&io, io.file, "/scene/node/role", HF_STORE_COUNT_MAX);
    int n_cable = hf_hdf5_length(&io, io.file, "/scene/cable/law", HF_STORE_COUNT_MAX);
    if (io.status == HF_OK && allocate_shape(n_node, n_cable, shape) != HF_OK) hf_hdf5_no_memory(&io);
    hf_hdf5_read_columns(&io, group, table, HF_HDF5_COUNT(table), n_node, n_cable, shape);
    hf_hdf5_close(&io, group);
    hf_hdf5_close_file(&io);
    if (io.status != HF_OK) hf_shape_free(shape);
    return hf_hdf5_unlock(io.status);
}

void hf_shape_free(hf_shape *shape)
{
    hf_arena_free(&(hf_arena){.block = shape->block});
    *shape = (hf_shape){0};
}

/* ---- series ---- */

int hf_store_is_there(hf_hdf5 *io, const char *name)
{
    char part[256];
    for (const char *slash = strchr(name + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
        snprintf(part, sizeof part, "%.*s", (int)(slash - name), name);
        if (!hf_hdf5_has(io, io->file, part)) return 0;
    }
    return hf_hdf5_has(io, io->file, name);
}

/* n of a data set of numbers [n] or [n][columns]; 0 = as many columns as it has. Sets series->columns and the type to
 * read as: HDF5 turns every kind of number into double, but no enumeration. */
static int measure_series(hf_hdf5 *io, const char *name, hid_t data_set, int columns, hf_series *series, hid_t *type)
{
    hsize_t dims[H5S_MAX_RANK] = {0};
    hid_t space = H5Dget_space(data_set), stored = H5Dget_type(data_set);
    int rank = space >= 0 ? H5Sget_simple_extent_dims(space, dims, NULL) : -1;
    H5T_class_t class = stored >= 0 ? H5Tget_class(stored) : H5T_NO_CLASS;
    series->columns = rank == 2 && dims[1] < INT_MAX ? (int)dims[1] : 1;
    *type = class == H5T_ENUM ? H5T_NATIVE_SCHAR : H5T_NATIVE_DOUBLE;
    if (rank < 0 || class == H5T_NO_CLASS)
        hf_hdf5_fail(io, "read", io->file, name);
    else if (class != H5T_INTEGER && class != H5T_FLOAT && (class != H5T_ENUM || H5Tget_size(stored) != 1))
        hf_hdf5_damaged(io, io->file, name, "is of another type");
    else if (rank < 1 || rank > 2 || (columns && columns != series->columns) || dims[0] > HF_STORE_COUNT_MAX)
        hf_hdf5_damaged(io, io->file, name, "has other dimensions than a report reads");
    hf_hdf5_close(io, stored);
    hf_hdf5_close(io, space);
    return io->status == HF_OK ? (int)dims[0] : 0;
}

static void read_series(hf_hdf5 *io, const char *name, int columns, hf_series *series)
{
    hid_t data_set = H5Dopen2(io->file, name, H5P_DEFAULT), type = -1;
    hf_arena arena = {0};
    if (data_set < 0) {
        hf_hdf5_fail(io, "read", io->file, name);
        return;
    }
    int n = measure_series(io, name, data_set, columns, series, &type);
    size_t count = (size_t)n * (size_t)series->columns;
    hf_arena_take(&arena, count, sizeof(double));
    if (n > 0 && hf_arena_allocate(&arena) != HF_OK) hf_hdf5_no_memory(io);
    if (n > 0 && io->status == HF_OK) {
        *series = (hf_series){n, series->columns, hf_arena_take(&arena, count, sizeof(double)), arena.block};
        if (H5Dread(data_set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, series->value) < 0)
            hf_hdf5_fail(io, "read", io->file, name);
        for (size_t i = type == H5T_NATIVE_SCHAR ? count : 0; i-- > 0;) /* in place, from the end */
            series->value[i] = ((const signed char *)series->value)[i];
    }
    hf_hdf5_close(io, data_set);
}

hf_status hf_store_read_series(const char *path, const char *name, int columns, hf_series *series,
                               hf_messages *messages)
{
    hf_hdf5_lock();
    hf_hdf5 io = hf_store_open_result(path, messages);
    *series = (hf_series){0};
    if (hf_store_is_there(&io, name)) read_series(&io, name, columns, series);
    hf_hdf5_close_file(&io);
    if (io.status != HF_OK) hf_series_free(series);
    return hf_hdf5_unlock(io.status);
}

void hf_series_free(hf_series *series)
{
    hf_arena_free(&(hf_arena){.block = series->block});
    *series = (hf_series){0};
}

/* ---- provenance ---- */

hf_status hf_store_read_provenance(const char *path, char *text, size_t size, hf_messages *messages)
{
    static const char *const from[][2] = {{"/", "started_utc"},  {"/", "finished_utc"}, {"/", "host"},
                                          {"/", "version"},      {"/", "git_describe"}, {"/", "compiler"},
                                          {"/", "build_flags"},  {"/", "lapack"},       {"/", "gsl_version"},
                                          {"/", "hdf5_version"}, {"/", "rng"},          {"/case", "sha256"}};
    hf_hdf5_lock();
    hf_hdf5 io = hf_store_open_result(path, messages);
    size_t used = 0;
    *text = '\0';
    for (int i = 0; i < HF_HDF5_COUNT(from); i++) {
        char value[1024] = "";
        if (!hf_hdf5_has_chars(&io, io.file, from[i][0], from[i][1])) continue;
        hf_hdf5_get(&io, io.file, from[i][0], from[i][1], HF_KIND_CHARS, value, sizeof value);
        int n = snprintf(text + used, size - used, "%s: %s\n", from[i][1], value);
        if (n < 0 || (size_t)n >= size - used) break; /* cut at the end of the room */
        used += (size_t)n;
    }
    hf_hdf5_close_file(&io);
    return hf_hdf5_unlock(io.status);
}
