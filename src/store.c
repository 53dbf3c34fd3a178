/* Contents: names and checks before a run - provenance, case, scene - shapes - generations - summary - the end */
#include <hifdm/store.h>

#include "band.h"
#include "hdf5_io.h"
#include "store_coupling.h"
#include "store_surface.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <gsl/gsl_version.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

/* The Makefile knows. */
#ifndef HF_VERSION
#define HF_VERSION "unknown"
#endif
#ifndef HF_GIT_DESCRIBE
#define HF_GIT_DESCRIBE "unknown"
#endif
#ifndef HF_COMPILER
#define HF_COMPILER "unknown"
#endif
#ifndef HF_BUILD_FLAGS
#define HF_BUILD_FLAGS "unknown"
#endif

#define ARGUMENTS_MAX 4000     /* kept of the command line: an attribute holds 64 KiB */
#define CHUNK_VALUES (1 << 17) /* of 8 bytes: 1 MiB, what HDF5 caches of a data set */
#define CHUNK_GENERATIONS 1024 /* of data sets with one value per generation */
#define GA_ROW_MAX 32

struct hf_store {
    hf_hdf5 io;
    int force;
    char *path, *temporary; /* behind the struct */
    int n_generation;       /* appended so far */
    int n_individual, n_gene;
    hid_t ga_data_set[GA_ROW_MAX]; /* open from the first generation on */
    int n_ga_data_set;
    void *scratch;
    size_t scratch_bytes;
};

const char *const hf_stage_word[4] = {"form", "optimize", "polish", "none"};
const char *const hf_stage_group[4] = {"/form", "/ga/best", "/polish", "/"};

const char *hf_store_version(void)
{
    return HF_VERSION " (" HF_GIT_DESCRIBE ")";
}

void hf_store_quiet(void)
{
    hf_hdf5_lock();
    H5dont_atexit();
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    hf_hdf5_unlock(HF_OK);
}

/* Space that lasts until the next call; NULL, with a message, when there is none or the store has failed already. */
static void *scratch(hf_store *s, size_t bytes)
{
    if (s->io.status != HF_OK) return NULL;
    if (bytes > s->scratch_bytes) {
        void *bigger = realloc(s->scratch, bytes);
        if (!bigger) {
            s->io.status = hf_error(s->io.messages, HF_NO_MEMORY, "%s: out of memory", s->path);
            return NULL;
        }
        s->scratch = bigger;
        s->scratch_bytes = bytes;
    }
    return s->scratch;
}

/* ---- names and checks before a run ---- */

static hf_status already_there(const char *path, hf_messages *messages)
{
    return hf_error(messages, HF_EXISTS, "%s: exists; use --force to replace it or -o to choose another name", path);
}

/* Can the file be made under this name when the run is over? Told now rather than after hours of work. */
static hf_status check_target(const char *path, int force, hf_messages *messages)
{
    char folder[4096];
    struct stat info;
    if (lstat(path, &info) == 0) {
        if (stat(path, &info) == 0 && !S_ISREG(info.st_mode))
            return hf_error(messages, HF_IO, "%s: is %s; use -o to choose a file name", path,
                            S_ISDIR(info.st_mode) ? "a folder" : "not an ordinary file");
        if (!force) return already_there(path, messages);
    }
    const char *slash = strrchr(path, '/');
    int n = slash == path ? 1 : slash ? (int)(slash - path) : 0; /* the root keeps its slash */
    snprintf(folder, sizeof folder, "%.*s", n ? n : 1, n ? path : ".");
    if (!*path || stat(folder, &info) != 0 || !S_ISDIR(info.st_mode))
        return hf_error(messages, HF_IO, "%s: there is no folder %s; make it or use -o to choose another name", path,
                        folder);
    if (access(folder, W_OK | X_OK) != 0)
        return hf_error(messages, HF_IO, "%s: cannot write into the folder %s: %s; use -o to choose another name", path,
                        folder, strerror(errno));
    return HF_OK;
}

static hf_store *new_store(const char *path, int force, hf_messages *messages)
{
    size_t size = strlen(path) + 48; /* of each name */
    hf_store *s = calloc(1, sizeof *s + 2 * size);
    if (!s) {
        hf_error(messages, HF_NO_MEMORY, "%s: out of memory", path);
        return NULL;
    }
    s->path = (char *)(s + 1);
    s->temporary = s->path + size;
    strcpy(s->path, path);
    s->force = force;
    s->io = (hf_hdf5){.path = s->path, .messages = messages, .status = HF_OK, .file = -1};
    return s;
}

/* Take a temporary name that is nobody else's; a crashed run may have left the first one behind. */
static void make_temporary(hf_store *s)
{
    int file = -1;
    for (int i = 1; file < 0 && i < 1000; i++) {
        sprintf(s->temporary, i == 1 ? "%s.%ld.tmp" : "%s.%ld-%d.tmp", s->path, (long)getpid(), i);
        file = open(s->temporary, O_WRONLY | O_CREAT | O_EXCL, 0666);
        if (file < 0 && errno != EEXIST) break;
    }
    if (file < 0) {
        s->io.status =
            hf_error(s->io.messages, HF_IO, "%s: cannot create %s: %s", s->path, s->temporary, strerror(errno));
        return;
    }
    close(file);
    hf_hdf5_create_file(&s->io, s->temporary);
    if (s->io.status != HF_OK) unlink(s->temporary);
}

/* ---- provenance, case, scene ---- */

static void put_time(hf_store *s, const char *attribute)
{
    char text[32] = "";
    time_t now = time(NULL);
    struct tm utc;
    if (gmtime_r(&now, &utc)) strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
    hf_hdf5_put_chars(&s->io, s->io.file, "/", attribute, text);
}

static void put_provenance(hf_store *s, int argc, char *const *argv)
{
    char host[256] = "", hdf5[32];
    unsigned major = 0, minor = 0, release = 0;
    if (gethostname(host, sizeof host - 1) != 0) host[0] = '\0';
    H5get_libversion(&major, &minor, &release);
    snprintf(hdf5, sizeof hdf5, "%u.%u.%u", major, minor, release);
    const char *const table[][2] = {{"version", HF_VERSION},
                                    {"git_describe", HF_GIT_DESCRIBE},
                                    {"compiler", HF_COMPILER},
                                    {"build_flags", HF_BUILD_FLAGS},
                                    {"hdf5_version", hdf5},
                                    {"gsl_version", gsl_version},
                                    {"lapack", hf_band_library()},
                                    {"rng", "splitmix64 keyed by (seed, generation, individual)"},
                                    {"host", host}};
    for (int i = 0; i < HF_HDF5_COUNT(table); i++)
        hf_hdf5_put_chars(&s->io, s->io.file, "/", table[i][0], table[i][1]);
    hf_hdf5_put_chars(&s->io, s->io.file, "/", "program", HF_PROGRAM);
    hf_hdf5_put(&s->io, s->io.file, "/", "format_version", HF_KIND_INT, 0, &(int){HF_FORMAT_VERSION});
    if (argc > ARGUMENTS_MAX) argc = ARGUMENTS_MAX;
    if (argc > 0) hf_hdf5_put(&s->io, s->io.file, "/", "argv", HF_KIND_TEXT, (hsize_t)argc, argv);
    put_time(s, "started_utc");
}

static void write_case(hf_store *s, const hf_case *settings)
{
    const char *overrides = settings->overrides ? settings->overrides : "";
    hf_hdf5_array text = {"text", HF_KIND_TEXT, 0, {0}, "", "the case file"};
    hf_hdf5_array set = {"overrides", HF_KIND_TEXT, 0, {0}, "", "the --set arguments, a line each"};
    hid_t group = hf_hdf5_make_group(&s->io, "/case");
    hf_hdf5_write_array(&s->io, group, &text, &settings->text);
    hf_hdf5_write_array(&s->io, group, &set, &overrides);
    hf_hdf5_put_chars(&s->io, group, ".", "sha256", settings->sha256);
    hf_hdf5_close(&s->io, group);
}

static void write_ids(hf_store *s, hid_t group, const char *name, const char *const *id, int n, const char *description)
{
    size_t length = 1;
    for (int i = 0; i < n; i++)
        length = strlen(id[i]) > length ? strlen(id[i]) : length;
    hf_hdf5_array array = {name, HF_KIND_CHARS, 1, {(hsize_t)n, length}, "", description};
    char *chars = scratch(s, (size_t)n * length);
    for (int i = 0; chars && i < n; i++)
        memcpy(memset(chars + (size_t)i * length, 0, length), id[i], strlen(id[i]));
    hf_hdf5_write_array(&s->io, group, &array, chars);
}

static void write_scene(hf_store *s, const hf_scene *scene)
{
    static const hf_hdf5_column table[] = {HF_SCENE_COLUMNS(HF_HDF5_COLUMN)};
    const hf_hdf5_array length = {
        "cable/length_m",          HF_KIND_REAL, 1,
        {(hsize_t)scene->n_cable}, "m",          "theoretical: distance of the two nodes' positions"};
    hid_t group = hf_hdf5_make_group(&s->io, "/scene");
    hf_hdf5_close(&s->io, hf_hdf5_make_group(&s->io, "/scene/node"));
    hf_hdf5_close(&s->io, hf_hdf5_make_group(&s->io, "/scene/cable"));
    write_ids(s, group, "node/id", scene->node_id, scene->n_node, "name of the node");
    write_ids(s, group, "cable/id", scene->cable_id, scene->n_cable, "name of the cable");
    hf_hdf5_write_columns(&s->io, group, table, HF_HDF5_COUNT(table), scene->n_node, scene->n_cable, scene);
    double *length_m = scratch(s, (size_t)scene->n_cable * sizeof *length_m);
    for (int e = 0; length_m && e < scene->n_cable; e++)
        length_m[e] = hf_scene_theoretical_length(scene, e);
    hf_hdf5_write_array(&s->io, group, &length, length_m);
    hf_hdf5_close(&s->io, group);
}

hf_status hf_store_create(const char *path, int force, const hf_case *settings, const hf_scene *scene, int argc,
                          char *const *argv, hf_store **store, hf_messages *messages)
{
    *store = NULL;
    HF_TRY(check_target(path, force, messages));
    hf_store *s = new_store(path, force, messages);
    if (!s) return HF_NO_MEMORY;
    hf_hdf5_lock();
    make_temporary(s);
    put_provenance(s, argc, argv);
    write_case(s, settings);
    write_scene(s, scene);
    hf_status status = hf_hdf5_unlock(s->io.status);
    if (status == HF_OK)
        *store = s;
    else
        hf_store_abandon(s);
    return status;
}

/* ---- shapes ---- */

static void write_shape(hf_store *s, hid_t group, const hf_model *model, const hf_workspace *workspace)
{
    static const hf_hdf5_column table[] = {HF_SHAPE_COLUMNS(HF_HDF5_COLUMN)};
    size_t n = (size_t)model->n_node;
    hf_shape shape = {.position_m = scratch(s, 3 * n * sizeof(double)),
                      .length_m = workspace->length_m,
                      .tension_N = workspace->tension_N,
                      .q_N_per_m = workspace->q_N_per_m,
                      .law = workspace->law};
    if (!shape.position_m) return;
    for (size_t row = 0; row < n; row++)
        for (size_t c = 0; c < 3; c++)
            shape.position_m[3 * (size_t)model->node_of_row[row] + c] = workspace->position_m[c * n + row];
    hf_hdf5_write_columns(&s->io, group, table, HF_HDF5_COUNT(table), model->n_node, model->n_cable, &shape);
}

hf_status hf_store_form(hf_store *store, const hf_model *model, const hf_workspace *workspace,
                        const hf_history *history, hf_messages *messages)
{
#define HISTORY(member, units, description)                                                                            \
    {                                                                                                                  \
#member, HF_KIND_REAL, 0, 1, units, description, offsetof(hf_history, member)                                  \
    }
    static const hf_hdf5_column table[] = {
        HISTORY(psi_m, "m", "RMS distance of the inner nodes to their theoretical positions, after each linear solve"),
        HISTORY(residual_N, "N", "largest nodal force out of balance"),
        HISTORY(inner_tension_ratio, "", "largest over smallest tension of the inner cables"),
        HISTORY(boundary_tension_ratio, "", "largest over smallest tension of the boundary cables"),
        HISTORY(length_error, "", "largest |l/L*-1| over taut cables of law length")};
#undef HISTORY
    hf_hdf5_lock();
    store->io.messages = messages;
    hid_t group = hf_hdf5_make_group(&store->io, "/form");
    write_shape(store, group, model, workspace);
    hf_hdf5_close(&store->io, group);
    if (history) {
        group = hf_hdf5_make_group(&store->io, "/form/history");
        hf_hdf5_write_columns(&store->io, group, table, HF_HDF5_COUNT(table), history->n, 0, history);
        hf_hdf5_close(&store->io, group);
    }
    if (model->n_attachment) hf_store_write_coupling(&store->io, model, workspace, history ? &history->coupling : NULL);
    return hf_hdf5_unlock(store->io.status);
}

static void write_design(hf_store *s, hid_t group, const hf_model *model, const double *design_N)
{
    hf_hdf5_array design = {
        "design_N", HF_KIND_REAL, 1, {(hsize_t)model->n_gene}, "N", "boundary pretension T' of each gene"};
    hf_hdf5_write_array(&s->io, group, &design, design_N);
}

hf_status hf_store_best(hf_store *store, hf_stage stage, const hf_model *model, const hf_workspace *workspace,
                        const double *design_N, hf_messages *messages)
{
    hf_hdf5_lock();
    store->io.messages = messages;
    if (stage == HF_STAGE_OPTIMIZE) hf_hdf5_close(&store->io, hf_hdf5_make_group(&store->io, "/ga"));
    hid_t group = hf_hdf5_make_group(&store->io, hf_stage_group[stage]);
    write_shape(store, group, model, workspace);
    write_design(store, group, model, design_N);
    hf_hdf5_close(&store->io, group);
    return hf_hdf5_unlock(store->io.status);
}

/* ---- generations ---- */

/* A data set that grows by one row per generation, and where the values of this generation are: item after item,
 * `stride` bytes apart. */
typedef struct {
    hf_hdf5_array array;
    const void *from;
    size_t stride, item_bytes;
} ga_row;

static int list_rows(const hf_ga *g, ga_row row[GA_ROW_MAX])
{
    const hsize_t p = (hsize_t)g->n_individual, k = (hsize_t)g->n_gene;
    const hf_form_result *r = g->result;
#define ARRAY(member) g->member, sizeof *g->member, sizeof *g->member
#define RESULT(member) &r->member, sizeof *r, sizeof r->member
#define SINGLE(value) &(value), 0, sizeof(value)
    const ga_row rows[] = {
        {{"design_N", HF_KIND_REAL, 3, {1, p, k}, "N", "boundary pretension T' of each gene"}, ARRAY(design_N)},
        {{"evaluated", HF_KIND_FLAG, 2, {1, p}, "", "FALSE = a copy whose result was known"}, ARRAY(pending)},
        {{"status", HF_KIND_STATUS, 2, {1, p}, "", "ok = feasible; under any other psi is NaN"}, RESULT(status)},
        {{"psi_m", HF_KIND_REAL, 2, {1, p}, "m", "RMS distance of the inner nodes"}, RESULT(psi_m)},
        {{"residual_N", HF_KIND_REAL, 2, {1, p}, "N", "largest nodal force out of balance"}, RESULT(residual_N)},
        {{"inner_tension_ratio", HF_KIND_REAL, 2, {1, p}, "", "largest over smallest"}, RESULT(inner_tension_ratio)},
        {{"boundary_tension_ratio", HF_KIND_REAL, 2, {1, p}, "", "largest over smallest"},
         RESULT(boundary_tension_ratio)},
        {{"iterations", HF_KIND_INT, 2, {1, p}, "", "linear solves"}, RESULT(iterations)},
        {{"crossover_rate", HF_KIND_REAL, 2, {1, p}, "", "that bred the individual"}, ARRAY(crossover_rate)},
        {{"mutation_rate", HF_KIND_REAL, 2, {1, p}, "", "that bred the individual"}, ARRAY(mutation_rate)},
        {{"parent", HF_KIND_INT, 3, {1, p, 2}, "", "individuals of the generation before, or -1"}, ARRAY(parent)},
        {{"best_individual", HF_KIND_INT, 1, {1}, "", "-1 while none is feasible"}, SINGLE(g->best)},
        {{"best_psi_m", HF_KIND_REAL, 1, {1}, "m", "of the generation"}, SINGLE(g->best_psi_m[g->generation])},
        {{"mean_psi_m", HF_KIND_REAL, 1, {1}, "m", "of the feasible individuals"}, SINGLE(g->mean_psi_m)},
        {{"worst_psi_m", HF_KIND_REAL, 1, {1}, "m", "of the feasible individuals"}, SINGLE(g->worst_psi_m)},
        {{"n_infeasible", HF_KIND_INT, 1, {1}, "", "individuals whose status is not ok"}, SINGLE(g->n_infeasible)}};
#undef ARRAY
#undef RESULT
#undef SINGLE
    _Static_assert(sizeof rows / sizeof rows[0] <= GA_ROW_MAX, "GA_ROW_MAX is too small");
    memcpy(row, rows, sizeof rows);
    return HF_HDF5_COUNT(rows);
}

/* One generation per chunk, or several chunks when that is more than CHUNK_VALUES. */
static void choose_chunk(const hf_hdf5_array *a, hsize_t chunk[3])
{
    hsize_t left = CHUNK_VALUES;
    chunk[0] = a->rank == 1 ? CHUNK_GENERATIONS : 1;
    for (int i = a->rank - 1; i > 0; i--) {
        chunk[i] = a->dims[i] < 1 ? 1 : a->dims[i] < left ? a->dims[i] : left;
        left = left / chunk[i] ? left / chunk[i] : 1;
    }
}

/* /ga with all that does not change from generation to generation, and the empty data sets of what does. */
static void start_generations(hf_store *s, const hf_model *model, const hf_ga *g, const ga_row *row, int n_row)
{
    const hsize_t k[3] = {(hsize_t)g->n_gene};
    const hf_hdf5_array cable = {"gene_cable", HF_KIND_INT, 1, {k[0]}, "", "index into /scene/cable of each gene"};
    const hf_hdf5_array group_of = {"gene_group", HF_KIND_INT, 1, {k[0]}, "", "genes that were varied together"};
    const hf_hdf5_array leader = {"gene_leader", HF_KIND_INT, 1, {k[0]}, "", "gene whose step each takes, by symmetry"};
    const hf_hdf5_array lower = {"lower_N", HF_KIND_REAL, 1, {k[0]}, "N", "least T' of each gene"};
    const hf_hdf5_array upper = {"upper_N", HF_KIND_REAL, 1, {k[0]}, "N", "largest T' of each gene"};
    hid_t group = hf_hdf5_make_group(&s->io, "/ga");
    hf_hdf5_write_array(&s->io, group, &cable, model->gene_cable);
    hf_hdf5_write_array(&s->io, group, &group_of, model->gene_group);
    if (g->gene_leader) hf_hdf5_write_array(&s->io, group, &leader, g->gene_leader);
    hf_hdf5_write_array(&s->io, group, &lower, g->lower_N);
    hf_hdf5_write_array(&s->io, group, &upper, g->upper_N);
    for (int i = 0; i < n_row; i++) {
        hsize_t chunk[3];
        choose_chunk(&row[i].array, chunk);
        s->ga_data_set[i] = hf_hdf5_make_array(&s->io, group, &row[i].array, chunk);
    }
    s->n_ga_data_set = n_row;
    s->n_individual = g->n_individual;
    s->n_gene = g->n_gene;
    hf_hdf5_close(&s->io, group);
}

/* The values of a row side by side, as HDF5 takes them. */
static const void *gather(hf_store *s, const ga_row *row)
{
    size_t bytes = hf_hdf5_kind_bytes(row->array.kind), n = 1;
    for (int i = 1; i < row->array.rank; i++)
        n *= (size_t)row->array.dims[i];
    if (row->item_bytes == bytes && (row->stride == bytes || n == 1)) return row->from;
    char *to = scratch(s, n * bytes);
    for (size_t i = 0; to && i < n; i++) {
        const char *from = (const char *)row->from + i * row->stride;
        int value;
        if (row->item_bytes == bytes) {
            memcpy(to + i * bytes, from, bytes);
        } else { /* an enum: an int here, a byte in the file */
            memcpy(&value, from, sizeof value);
            to[i] = (char)value;
        }
    }
    return to;
}

hf_status hf_store_generation(hf_store *store, const hf_model *model, const hf_ga *ga, hf_messages *messages)
{
    ga_row row[GA_ROW_MAX];
    int n_row = list_rows(ga, row);
    hf_hdf5_lock();
    store->io.messages = messages;
    if (store->io.status == HF_OK && !store->n_ga_data_set) start_generations(store, model, ga, row, n_row);
    assert(store->io.status != HF_OK || (ga->n_individual == store->n_individual && ga->n_gene == store->n_gene));
    for (int i = 0; i < n_row; i++) {
        const void *values = gather(store, &row[i]);
        hf_hdf5_append(&store->io, store->ga_data_set[i], &row[i].array, (hsize_t)store->n_generation, values);
    }
    store->n_generation++;
    return hf_hdf5_unlock(store->io.status);
}

/* ---- summary ---- */

static void put_summary(hf_store *s, const hf_summary *summary)
{
    static const hf_hdf5_member form[] = {HF_SUMMARY_FORM_MEMBERS(HF_HDF5_MEMBER)};
    static const hf_hdf5_member ga[] = {HF_SUMMARY_GA_MEMBERS(HF_HDF5_MEMBER)};
    static const hf_hdf5_member polish[] = {HF_SUMMARY_POLISH_MEMBERS(HF_HDF5_MEMBER)};
    static const hf_hdf5_member truss[] = {HF_SUMMARY_TRUSS_MEMBERS(HF_HDF5_MEMBER)};
    hf_status outcome = summary->form.status;
    if (outcome == HF_OK && summary->has_optimize) outcome = summary->best.status;
    /* groups that are there already, unless the run had no shape or no generation to store */
    hf_hdf5_close(&s->io, hf_hdf5_make_group(&s->io, "/form"));
    hf_hdf5_put_members(&s->io, form, HF_HDF5_COUNT(form), summary);
    if (summary->has_optimize) {
        hf_hdf5_close(&s->io, hf_hdf5_make_group(&s->io, "/ga"));
        hf_hdf5_put_members(&s->io, ga, HF_HDF5_COUNT(ga), summary);
    }
    if (summary->has_polish) {
        hf_hdf5_close(&s->io, hf_hdf5_make_group(&s->io, "/polish"));
        hf_hdf5_put_members(&s->io, polish, HF_HDF5_COUNT(polish), summary);
    }
    if (summary->has_truss) {
        hf_hdf5_close(&s->io, hf_hdf5_make_group(&s->io, "/truss"));
        hf_hdf5_put_members(&s->io, truss, HF_HDF5_COUNT(truss), summary);
    }
    if (summary->has_coupling) hf_store_put_coupling(&s->io, summary);
    hf_hdf5_put_text(&s->io, s->io.file, "/", "status", hf_status_word(outcome));
    put_time(s, "finished_utc");
}

/* ---- the end ---- */

/* HDF5 1.10 does not survive a close that cannot write what is left: the ids stay open and the program crashes at its
 * end. So all is written before; and when the disk is full, the file stays open, for which hf_store_quiet has prepared,
 * but empty. */
static void close_everything(hf_store *s)
{
    if (s->io.file < 0) return;
    if (H5Fflush(s->io.file, H5F_SCOPE_GLOBAL) < 0) {
        hf_hdf5_fail(&s->io, "write", -1, NULL);
        int ignored = truncate(s->temporary, 0);
        (void)ignored;
        return;
    }
    for (int i = 0; i < s->n_ga_data_set; i++)
        hf_hdf5_close(&s->io, s->ga_data_set[i]);
    hf_hdf5_close_file(&s->io);
}

static void free_store(hf_store *s)
{
    free(s->scratch);
    free(s);
}

/* Down to the disk before the name is given: after a power cut there is the old file or the new one, whole. */
static void sync_to_disk(hf_store *s)
{
    int file = open(s->temporary, O_RDONLY);
    if (file < 0 || (fsync(file) != 0 && errno != EINVAL)) /* EINVAL: this file system has no such thing */
        s->io.status = hf_error(s->io.messages, HF_IO, "%s: cannot write to the disk: %s", s->path, strerror(errno));
    if (file >= 0) close(file);
}

/* Give the file its name without ever replacing another: 0, or -1 and errno. */
static int rename_to_new(const char *from, const char *to)
{
    if (link(from, to) == 0) {
        unlink(from); /* a second name that stays would do no harm */
        return 0;
    }
    if (errno == EEXIST) return -1;
    /* a file system without links: take the name with an empty file, then replace that */
    int file = open(to, O_WRONLY | O_CREAT | O_EXCL, 0600);
    if (file < 0) return -1;
    close(file);
    if (rename(from, to) == 0) return 0;
    int why = errno;
    unlink(to);
    errno = why;
    return -1;
}

/* The work is done and whole, so it is kept under its temporary name when its own name cannot be given to it. */
static hf_status publish(hf_store *s)
{
    if ((s->force ? rename(s->temporary, s->path) : rename_to_new(s->temporary, s->path)) == 0) return HF_OK;
    if (errno == EEXIST)
        return hf_error(s->io.messages, HF_EXISTS,
                        "%s: was made by someone else during the run; this run's result is %s", s->path, s->temporary);
    return hf_error(s->io.messages, HF_IO, "%s: cannot be given this name: %s; the result is %s", s->path,
                    strerror(errno), s->temporary);
}

hf_status hf_store_finish(hf_store *store, const hf_summary *summary, hf_messages *messages)
{
    hf_status status;
    hf_hdf5_lock();
    store->io.messages = messages;
    if (store->io.status != HF_OK)
        hf_error(messages, store->io.status, "%s: is not written, since an earlier part of it could not be",
                 store->path);
    put_summary(store, summary);
    hf_store_put_surface(&store->io, summary);
    close_everything(store);
    if (store->io.status == HF_OK) sync_to_disk(store);
    status = store->io.status;
    if (status != HF_OK)
        unlink(store->temporary);
    else
        status = publish(store);
    free_store(store);
    return hf_hdf5_unlock(status);
}

hf_hdf5 *hf_store_io(hf_store *store, hf_messages *messages)
{
    store->io.messages = messages;
    return &store->io;
}

const char *hf_store_temporary(const hf_store *store)
{
    return store->temporary;
}

void hf_store_abandon(hf_store *store)
{
    if (!store) return;
    hf_messages unwanted = {0};
    hf_hdf5_lock();
    store->io.messages = &unwanted;
    if (store->io.file >= 0) {
        close_everything(store);
        unlink(store->temporary);
    }
    hf_messages_free(&unwanted);
    free_store(store);
    hf_hdf5_unlock(HF_OK);
}
