/* Contents: files - answers - cases - limits */
#include "fuzz/fuzz.h"

#include "base/text.h"
#include "case/config_fault.h"
#include "case/study.h"
#include <hifdm/config.h>
#include <hifdm/store.h>
#include <hifdm/truss.h>

#include <dirent.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

void fuzz_fail(const char *condition, const char *file, int line)
{
    fprintf(stderr, "%s:%d: does not hold: %s\n", file, line, condition);
    abort();
}

/* ---- files ---- */

static char folder[128];

static void remove_folder(void)
{
    char path[FUZZ_PATH_SIZE];
    DIR *list = opendir(folder);
    for (struct dirent *entry; list && (entry = readdir(list)) != NULL;) {
        fuzz_path(entry->d_name, path);
        if (entry->d_name[0] != '.') unlink(path);
    }
    if (list) closedir(list);
    rmdir(folder);
}

static void make_folder(void)
{
    const char *where = getenv("TMPDIR");
    snprintf(folder, sizeof folder, "%s/hifdm-fuzz-XXXXXX", where ? where : "/dev/shm");
    FUZZ_REQUIRE(mkdtemp(folder) != NULL);
    atexit(remove_folder);
    hf_store_quiet();
}

void fuzz_path(const char *name, char path[FUZZ_PATH_SIZE])
{
    if (!*folder) make_folder();
    FUZZ_REQUIRE(snprintf(path, FUZZ_PATH_SIZE, "%s/%s", folder, name) < FUZZ_PATH_SIZE);
}

void fuzz_write(const char *name, const void *data, size_t size)
{
    char path[FUZZ_PATH_SIZE];
    fuzz_path(name, path);
    int file = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    FUZZ_REQUIRE(file >= 0);
    FUZZ_REQUIRE(write(file, data, size) == (ssize_t)size);
    close(file);
}

void fuzz_write_text(const char *name, const char *text)
{
    fuzz_write(name, text, strlen(text));
}

size_t fuzz_split(const uint8_t *data, size_t size, size_t *first_size)
{
    for (size_t i = 0; i + 3 <= size; i++)
        if (!memcmp(data + i, "%%\n", 3)) {
            *first_size = i;
            return i + 3;
        }
    *first_size = size;
    return size;
}

/* ---- answers ---- */

void fuzz_judge(hf_status status, hf_messages *messages)
{
    FUZZ_REQUIRE(status != HF_NO_MEMORY);
    FUZZ_REQUIRE((status == HF_OK) == (messages->n_error == 0));
    FUZZ_REQUIRE(messages->n_error + messages->n_warning == 0 || messages->text);
    for (char *line = messages->text, *end; line && *line; line = end + 1) {
        end = strchr(line, '\n');
        FUZZ_REQUIRE(end != NULL);
        *end = '\0';
        FUZZ_REQUIRE(hf_text_is_utf8(line));
        for (uint32_t code; *line; FUZZ_REQUIRE(!hf_text_is_hidden(code)))
            line += hf_text_character(line, &code);
    }
    hf_messages_free(messages);
}

/* ---- cases ---- */

bool fuzz_keeps_case;

hf_status __real_hf_config_load(const char *, const char *const *, int, hf_case *, hf_messages *);
hf_status __wrap_hf_config_load(const char *, const char *const *, int, hf_case *, hf_messages *);

hf_status __wrap_hf_config_load(const char *path, const char *const *overrides, int n_override, hf_case *settings,
                                hf_messages *messages)
{
    static hf_case kept;
    if (!fuzz_keeps_case) return __real_hf_config_load(path, overrides, n_override, settings, messages);
    if (!kept.text) FUZZ_REQUIRE(__real_hf_config_load(path, overrides, n_override, &kept, messages) == HF_OK);
    *settings = kept;
    settings->text = strdup(kept.text);
    settings->overrides = strdup(kept.overrides);
    size_t n_byte = (size_t)hf_key_n_location() * HF_CONFIG_WHERE_SIZE + HF_CONFIG_FAULTY_SIZE;
    settings->where_given = malloc(n_byte);
    FUZZ_REQUIRE(settings->text && settings->overrides && settings->where_given);
    memcpy(settings->where_given, kept.where_given, n_byte);
    return HF_OK;
}

/* ---- limits ----
 * What the program accepts and works on for minutes is refused here, by -Wl,--wrap. What the program refuses for its
 * size still reaches the program. */

enum { NODE_MAX = 400, COUNT_LEAST = 10, COUNT_MAX = 16, POINT_MAX = 64 };

hf_status __real_hf_scene_parabolic_cylinder(const hf_cylinder *, const double[2], hf_scene *, hf_messages *);
hf_status __wrap_hf_scene_parabolic_cylinder(const hf_cylinder *, const double[2], hf_scene *, hf_messages *);
hf_status __real_hf_scene_paraboloid(const hf_paraboloid *, const double[2], hf_scene *, hf_messages *);
hf_status __wrap_hf_scene_paraboloid(const hf_paraboloid *, const double[2], hf_scene *, hf_messages *);
hf_status __real_hf_truss_generate(const hf_truss_settings *, const hf_cylinder *, hf_truss *, hf_messages *);
hf_status __wrap_hf_truss_generate(const hf_truss_settings *, const hf_cylinder *, hf_truss *, hf_messages *);
hf_status __real_hf_truss_ring_generate(const hf_truss_settings *, const hf_paraboloid *, hf_truss *, hf_messages *);
hf_status __wrap_hf_truss_ring_generate(const hf_truss_settings *, const hf_paraboloid *, hf_truss *, hf_messages *);
bool __real_hf_text_uint64(const char *, uint64_t *);
bool __wrap_hf_text_uint64(const char *, uint64_t *);
hf_status __real_hf_study_make_points(hf_study *, hf_messages *);
hf_status __wrap_hf_study_make_points(hf_study *, hf_messages *);

/* 4e6 nodes are the program's own limit. */
hf_status __wrap_hf_scene_parabolic_cylinder(const hf_cylinder *c, const double EA_N[2], hf_scene *scene,
                                             hf_messages *messages)
{
    double n =
        ((double)c->modules[0] * c->cells_per_module[0] + 1) * ((double)c->modules[1] * c->cells_per_module[1] + 1);
    n *= c->rear_distance_m > 0 ? 2 : 1;
    if (n <= NODE_MAX || n > 4e6) return __real_hf_scene_parabolic_cylinder(c, EA_N, scene, messages);
    *scene = (hf_scene){0};
    return hf_error(messages, HF_BAD_CASE, "%g nodes take too long here", n);
}

hf_status __wrap_hf_scene_paraboloid(const hf_paraboloid *p, const double EA_N[2], hf_scene *scene,
                                     hf_messages *messages)
{
    double n = 8.0 * p->rings * p->rings;
    if (n <= NODE_MAX) return __real_hf_scene_paraboloid(p, EA_N, scene, messages);
    *scene = (hf_scene){0};
    return hf_error(messages, HF_BAD_CASE, "%g nodes take too long here", n);
}

hf_status __wrap_hf_truss_generate(const hf_truss_settings *settings, const hf_cylinder *c, hf_truss *truss,
                                   hf_messages *messages)
{
    double panels = settings->bud.panels + settings->mbug.panels + settings->abug.panels;
    double n = (c->modules[0] + 1.0) * (c->modules[1] + 1.0) * panels;
    if (n <= NODE_MAX || n > 4e7) return __real_hf_truss_generate(settings, c, truss, messages);
    *truss = (hf_truss){0};
    return hf_error(messages, HF_BAD_CASE, "a truss of %g panels takes too long here", n);
}

hf_status __wrap_hf_truss_ring_generate(const hf_truss_settings *settings, const hf_paraboloid *p, hf_truss *truss,
                                        hf_messages *messages)
{
    double n = 8.0 * p->rings * p->rings;
    if (n <= NODE_MAX) return __real_hf_truss_ring_generate(settings, p, truss, messages);
    *truss = (hf_truss){0};
    return hf_error(messages, HF_BAD_CASE, "a ring under %g nodes takes too long here", n);
}

/* Values along an axis, samples, of which there are COUNT_LEAST; seeds shrink with them. */
bool __wrap_hf_text_uint64(const char *text, uint64_t *value)
{
    bool is_number = __real_hf_text_uint64(text, value);
    if (is_number && *value > COUNT_MAX && *value <= HF_STUDY_POINT_MAX)
        *value = COUNT_LEAST + *value % (COUNT_MAX - COUNT_LEAST + 1);
    return is_number;
}

hf_status __wrap_hf_study_make_points(hf_study *study, hf_messages *messages)
{
    double n = 1;
    for (int a = 0; a < study->n_axis; a++)
        n *= study->axis[a].n_value;
    if (n <= POINT_MAX || n > HF_STUDY_POINT_MAX || study->is_zip) return __real_hf_study_make_points(study, messages);
    return hf_error(messages, HF_BAD_CASE, "%g points take too long here", n);
}
