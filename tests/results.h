/* results - writes and reads result files in tests. Header only, like nets.h. */
#pragma once

#include "nets.h"

#include <dirent.h>
#include <hifdm/store.h>
#include <sys/stat.h>

#include "store/hdf5.h"

#define N(table) ((int)(sizeof(table) / sizeof(table)[0]))

/* Opens three nodes with two cables and one load, the smallest net that makes a result file. */
static inline void open_bow(struct net *net)
{
    static const struct hand_node node[] = {{{0, 0, 0}, HF_ROLE_SUPPORT, {0}},
                                            {{1.25, 0.1, -0.3}, HF_ROLE_INNER, {0, 0, -2.385}},
                                            {{2.75, 0, 0}, HF_ROLE_SUPPORT, {0}}};
    static const struct hand_cable cable[] = {{{0, 1}, HF_GROUP_INNER, HF_LAW_TENSION, 10.7},
                                              {{2, 1}, HF_GROUP_BOUNDARY, HF_LAW_FORCE_DENSITY, 3.11}};
    OPEN_HAND(net, node, cable, HF_METHOD_HIFDM);
}

static inline void quiet(void)
{
    hf_store_quiet();
}

static inline void no_id_is_open(void)
{
    ck_assert_int_eq(H5Fget_obj_count((hid_t)H5F_OBJ_ALL, H5F_OBJ_ALL), 0);
}

static inline const hf_case *any_case(void)
{
    static const hf_case any = {.text = "title: any\n", .overrides = "form.pretension_N=12\n", .sha256 = "abc"};
    return &any;
}

/* Makes an empty folder, in which a test can count files, and sets *result to "<folder>/run.h5". */
static inline const char *new_folder(const char **result)
{
    static int serial; /* without fork, tests share their temporary directory */
    char file[64];
    snprintf(file, sizeof file, "results-%d", serial++);
    const char *folder = temp_path(file);
    ck_assert_int_eq(mkdir(folder, 0700), 0);
    snprintf(file, sizeof file, "results-%d/run.h5", serial - 1);
    *result = temp_path(file);
    return folder;
}

static inline int count_files(const char *folder)
{
    int n = 0;
    DIR *directory = opendir(folder);
    ck_assert_ptr_nonnull(directory);
    while (readdir(directory))
        n++;
    closedir(directory);
    return n - 2; /* without . and .. */
}

static inline hf_store *begin(const char *path, int force, const hf_scene *scene)
{
    hf_messages messages = {0};
    hf_store *store;
    char *argv[] = {"hifdm", "run", "a b.yaml"};
    ck_assert_msg(hf_store_create(path, force, any_case(), scene, NULL, 3, argv, &store, &messages) == HF_OK, "%s",
                  messages.text);
    return store;
}

static inline void end(hf_store *store, const hf_summary *summary)
{
    hf_messages messages = {0};
    ck_assert_msg(hf_store_finish(store, summary, &messages) == HF_OK, "%s", messages.text);
    ck_assert_ptr_null(messages.text);
    no_id_is_open();
}

/* Reads a file in all four ways. Each failure must be HF_IO with exactly one message. Returns the number of failures,
 * and the messages in text[size]. */
static inline int read_all(const char *path, char *text, size_t size)
{
    hf_messages messages = {0};
    hf_summary summary;
    hf_scene scene;
    hf_shape form, best;
    hf_status status[4] = {hf_store_read_summary(path, &summary, &messages),
                           hf_store_read_scene(path, &scene, &messages),
                           hf_store_read_shape(path, HF_STAGE_FORM, &form, &messages),
                           hf_store_read_shape(path, HF_STAGE_SEARCH, &best, &messages)};
    int n_failed = 0;
    for (int i = 0; i < 4; i++) {
        ck_assert_msg(status[i] == HF_OK || status[i] == HF_IO, "status %d", status[i]);
        n_failed += status[i] != HF_OK;
    }
    ck_assert_int_eq(messages.n_error, n_failed);
    snprintf(text, size, "%s", messages.text ? messages.text : "");
    hf_summary_free(&summary);
    hf_scene_free(&scene);
    hf_shape_free(&form);
    hf_shape_free(&best);
    hf_messages_free(&messages);
    no_id_is_open();
    return n_failed;
}

/* Runs a script of Python with h5py. The file `path` is open as `f` in this mode. The script must succeed. */
static inline void python(const char *mode, const char *path, const char *script)
{
    char text[4096];
    int n = snprintf(text, sizeof text, "import sys, h5py, numpy as np\nf = h5py.File(sys.argv[1], '%s')\n%s\n", mode,
                     script);
    ck_assert(n > 0 && n < (int)sizeof text);
    const char *const argv[] = {python_program(), "-c", text, path, NULL};
    struct command command = run_command(HANG_S, argv);
    ck_assert_msg(command.exit_code == 0, "%s", command.err);
    free_command(&command);
}

/* Writes a finished file with both shapes. */
static inline void write_result(const char *path, struct net *net)
{
    hf_messages messages = {0};
    hf_summary summary = {.stage[HF_STAGE_SEARCH].exists = 1};
    hf_store *store = begin(path, 1, &net->scene);
    double design[1000] = {0};
    ck_assert_int_le(net->model.n_variable, 1000);
    find_shape(net);
    ck_assert_int_eq(hf_store_form(store, &net->model, &net->work, NULL, &messages), HF_OK);
    ck_assert_int_eq(hf_store_shape(store, HF_STAGE_SEARCH, &net->model, &net->work, design, &messages), HF_OK);
    end(store, &summary);
}
