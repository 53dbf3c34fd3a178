/* Result files: no other file is overwritten, damage is reported, a full disk or failed allocation leaves nothing. */
#include "base/file_out.h"
#include "calls.h"
#include "results.h"
#include "small_ga.h"
#include "store/hdf5.h"

#include <errno.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

/* ---- names ---- */

/* Status of hf_store_create and its message; nothing is left open. */
static hf_status refuse(const char *path, int force, const hf_scene *scene, char *text, size_t size)
{
    hf_messages messages = {0};
    hf_store *store;
    hf_status status = hf_store_create(path, force, any_case(), scene, NULL, 0, NULL, &store, &messages);
    ck_assert_ptr_null(store);
    ck_assert_int_eq(messages.n_error, 1);
    snprintf(text, size, "%s", messages.text);
    hf_messages_free(&messages);
    no_id_is_open();
    return status;
}

START_TEST(existing_files_are_replaced_by_restart_only)
{
    struct net net;
    char text[1024];
    const char *path, *folder = new_folder(&path);
    open_bow(&net);
    write_file(path, "precious");
    ck_assert_int_eq(refuse(path, 0, &net.scene, text, sizeof text), HF_EXISTS);
    ck_assert_ptr_nonnull(strstr(text, path));
    ck_assert_ptr_nonnull(strstr(text, "--restart"));
    hf_store_end(begin(path, 1, &net.scene));
    char *kept = read_file(path, NULL);
    ck_assert_str_eq(kept, "precious");
    free(kept);
    ck_assert_int_eq(count_files(folder), 1);

    end(begin(path, 1, &net.scene), &(hf_summary){0});
    ck_assert_int_eq(read_all(path, text, sizeof text), 2); /* there are no shapes in it */
    ck_assert_int_eq(count_files(folder), 1);
    close_net(&net);
}
END_TEST

/* The result is complete and took long to compute, so it is kept under the temporary name that the message gives. */
START_TEST(a_file_that_appears_meanwhile_is_kept)
{
    struct net net;
    hf_messages messages = {0};
    char text[1024], *at;
    const char *path, *folder = new_folder(&path);
    open_bow(&net);
    hf_store *store = begin(path, 0, &net.scene);
    write_file(path, "precious");
    ck_assert_int_eq(hf_store_finish(store, &(hf_summary){0}, &messages), HF_EXISTS);
    no_id_is_open();
    char *kept = read_file(path, NULL);
    ck_assert_str_eq(kept, "precious");
    free(kept);
    ck_assert_int_eq(count_files(folder), 2);
    at = strrchr(messages.text, ' ') + 1;
    at[strcspn(at, "\n")] = '\0';
    ck_assert_int_eq(read_all(at, text, sizeof text), 2);
    hf_messages_free(&messages);
    close_net(&net);
}
END_TEST

START_TEST(names_that_cannot_be_are_told_at_once)
{
    struct net net;
    char text[1024];
    const char *path, *folder = new_folder(&path);
    open_bow(&net);
    const char *const bad[] = {folder, temp_path("no/such/run.h5"), "", "/dev/null", temp_path("nowhere/")};
    const char *const why[] = {"is a folder", "no/such", "is empty", "not a regular file", "does not exist"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        for (int force = 0; force < 2; force++) {
            ck_assert_int_eq(refuse(bad[i], force, &net.scene, text, sizeof text),
                             i == 0 || i == 3 ? HF_EXISTS : HF_IO);
            ck_assert_msg(strstr(text, bad[i]) && strstr(text, why[i]) && strstr(text, "-o"), "%s", text);
        }
    ck_assert_int_eq(chmod(folder, 0500), 0);
    if (geteuid() != 0) { /* root may write there all the same */
        ck_assert_int_eq(refuse(path, 0, &net.scene, text, sizeof text), HF_IO);
        ck_assert_ptr_nonnull(strstr(text, "Permission denied"));
    } else {
        skip_for_machine("unit/store_faults: a folder that is read-only", "root may write there");
    }
    ck_assert_int_eq(chmod(folder, 0700), 0);
    ck_assert_int_eq(count_files(folder), 0);
    close_net(&net);
}
END_TEST

START_TEST(abandoned_files_leave_nothing)
{
    struct net net;
    hf_messages messages = {0};
    const char *path, *folder = new_folder(&path);
    OPEN_CASE(&net, SMALL_REFLECTOR);
    char text[1024];
    hf_store *store = begin(path, 0, &net.scene), *second;
    ck_assert_int_eq(count_files(folder), 2); /* the file under its temporary name, and the journal */
    ck_assert_int_eq(hf_store_create(path, 1, any_case(), &net.scene, NULL, 0, NULL, &second, &messages), HF_EXISTS);
    ck_assert_ptr_null(second);
    snprintf(text, sizeof text, "%s", messages.text);
    ck_assert_msg(strstr(text, "another process is writing this result") != NULL, "%s", text);
    hf_messages_free(&messages);
    find_shape(&net);
    ck_assert_int_eq(hf_store_form(store, &net.model, &net.work, NULL, &messages), HF_OK);
    hf_store_end(store);
    hf_store_end(NULL);
    ck_assert_int_eq(count_files(folder), 0);
    no_id_is_open();
    close_net(&net);
}
END_TEST

/* ---- trouble ---- */

START_TEST(what_is_no_result_is_refused)
{
    struct net net;
    char text[4096];
    OPEN_CASE(&net, SMALL_REFLECTOR);
    write_result(temp_path("a.h5"), &net);
    ck_assert_int_eq(read_all(temp_path("a.h5"), text, sizeof text), 0);
    size_t size;
    char *bytes = read_file(temp_path("a.h5"), &size);
    write_file(temp_path("text.h5"), "node,x,y,z\n");
    write_file(temp_path("empty.h5"), "");
    python("w", temp_path("other.h5"), "f['x'] = 1\nf.attrs['program'] = 'another'");
    const char *const bad[] = {temp_path("missing.h5"), temp_path("."), temp_path("text.h5"),
                               temp_path("empty.h5"),   "/dev/null",    temp_path("other.h5")};
    const char *const why[] = {"No such file", "is a folder", "not an HDF5",
                               "not an HDF5",  "not an HDF5", "not a result"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        ck_assert_int_eq(read_all(bad[i], text, sizeof text), 4);
        ck_assert_msg(strstr(text, bad[i]) && strstr(text, why[i]), "%s", text);
    }
    for (size_t left = 0; left < size; left += size / 23) {
        FILE *file = fopen(temp_path("cut.h5"), "wb");
        ck_assert(file && fwrite(bytes, 1, left, file) == left && fclose(file) == 0);
        ck_assert_int_eq(read_all(temp_path("cut.h5"), text, sizeof text), 4);
    }
    free(bytes);
    close_net(&net);
}
END_TEST

/* A group of tensions of two sets, of these names. */
#define SET_TENSION(names)                                                                                             \
    "g = f.create_group('set_tension/form'); t = h5py.string_dtype('utf-8', 64); "                                     \
    "g['name'] = np.array([" names "], t); g['min_N'] = g['max_N'] = g['ratio'] = np.ones(2)"

/* A group of one limit. */
#define AT_LIMIT(row, name)                                                                                            \
    "g = f.create_group('at_limit/refine'); g['name'] = np.array([" name "], h5py.string_dtype('utf-8', 160)); "       \
    "g['row'] = np.array([" row "], 'i4'); g['count'] = np.array([1], 'i4'); g['value'] = g['bound'] = np.ones(1)"

/* The file is one of another version. */
#define OLD "f.attrs.create('git_describe', b'old', dtype=h5py.string_dtype('utf-8', 3)); "

/* What Python does to a good file; how many of the four ways of reading must refuse it, and a word of their message. */
static const struct {
    const char *deed;
    int n_refused;
    const char *why;
} damages[] = {
    {"f.attrs.modify('format_version', 4)", 4, "format version 4"},
    {"del f.attrs['title']", 1, "attribute title of /"},
    {"del f.attrs['threads']; f.attrs['threads'] = 'many'", 1, "attribute threads of / is of another type"},
    {"del f.attrs['title']; f.attrs['title'] = np.bytes_(b'x' * 300)", 1, "too long"},
    {"del f['form'].attrs['psi_m']; f['form'].attrs['psi_m'] = [1., 2.]", 1, "attribute psi_m of /form"},
    {"del f['scene/cable/end']", 1, "/scene/cable/end is not there"},
    {"f['scene/cable/end'][3, 1] = 10**6", 1, "a node that is not there"},
    {"f['scene/cable/end'][3, 1] = -1", 1, "a node that is not there"},
    {"f['scene/node/role'][2] = 3", 1, "/scene/node/role holds a value"},
    {"f['form/law'][2] = -1", 1, "/form/law holds a value"},
    {"del f['scene/node/id']; f['scene/node/id'] = ['a', 'b']", 1, "/scene/node/id is of another type"},
    {"del f['scene/node/id']; f['scene/node/id'] = np.array([b'a', b'b'])", 1, "other dimensions"},
    {"del f['scene/node/role']; f['scene/node/role'] = 1", 3, "empty or too large"},
    {"del f['scene/node/role']; f['scene'].create_dataset('node/role', (10**12,), 'i1', chunks=(10,))", 3,
     "has larger dimensions than there are values"},
    {"d = f['form/tension_N'][:]; del f['form/tension_N']; f['form/tension_N'] = d[1:]", 1, "other dimensions"},
    {"d = f['form/tension_N'][:]; del f['form/tension_N']; f['form/tension_N'] = d.astype(int)", 1, "another type"},
    {"del f['search']", 2, "/search is not there"},
    {"del f['search/position_m']", 1, "has no search shape"},
    {"del f['scene']", 3, "/scene"},
    {"del f['form']; f['form'] = 1", 2, "attribute version of /form is not there"},
    {"f.move('form', 'moved'); f['form'] = h5py.SoftLink('/moved')", 2, "/form is a link to another place"},
    {"del f['scene/node/id']; f['scene/node/id'] = h5py.ExternalLink('/etc/passwd', '/')", 1, "is a link to another"},
    {"d = f['form/q_N_per_m'].shape; del f['form/q_N_per_m']; f['form'].create_dataset('q_N_per_m', d, 'f8', "
     "external=[('/dev/zero', 0, h5py.h5f.UNLIMITED)])",
     1, "/form/q_N_per_m has its values in another file"},
    {"f['search'].attrs.modify('solver', 77)", 1, "/search names a solver that there is not"},
    {OLD "del f['form'].attrs['culprit'], f['search'].attrs['algorithm_stop'], f['form'].attrs['psi_m']", 0, ""},
    {OLD "del f['form/tension_N']", 1,
     "(old) does not contain /form/tension_N, which this version needs. Run the case again, or read the file with the "
     "version that wrote the file"},
    {"del f['form'].attrs['culprit']", 1, "this file is damaged: attribute culprit of /form is not there"},
    {"f['scene/set/cable'][0] = 10**6", 1, "/scene/set does not describe sets of cables"},
    {"f['scene/set/cable'][1] = f['scene/set/cable'][0]", 1, "/scene/set does not describe sets of cables"},
    {"f['scene/set/start'][1] = 10**9", 1, "/scene/set does not describe sets of cables"},
    {"f['scene/set/start'][0] = -1", 1, "/scene/set does not describe sets of cables"},
    {"d = f['scene/set/name'][:]; f['scene/set/name'][0] = d[1]", 1, "/scene/set does not describe sets of cables"},
    {"f['scene/set/name'][0] = b'a.b'", 1, "/scene/set does not describe sets of cables"},
    {"del f['scene/set/name']; f['scene/set/name'] = np.array([b'x' * 64, b'y', b'z'])", 1, "a name that is too long"},
    {"del f['scene/set/start']", 1, "/scene/set/start is not there"},
    {SET_TENSION("b'edge', b'ends'"), 0, ""},
    {SET_TENSION("b'edge', b'edge'"), 1, "/set_tension does not name sets of cables"},
    {SET_TENSION("b'edge', b'\\x1b[1m'"), 1, "/set_tension does not name sets of cables"},
    {SET_TENSION("b'edge'"), 1, "other dimensions"},
    {AT_LIMIT("0", "b'tension of cable c'"), 0, ""},
    {AT_LIMIT("16", "b'tension of cable c'"), 1, "/at_limit does not name limits"},
    {AT_LIMIT("0", "b''"), 1, "/at_limit does not name limits"},
    {AT_LIMIT("0", "b'x'") "; del g['bound']; g['bound'] = np.ones(34)", 1, "empty or too large"},
    {SET_TENSION("b'edge', b'ends'") "; del g['ratio']; g['ratio'] = np.ones(17)", 1, "empty or too large"},
};

START_TEST(damage_is_told)
{
    struct net net;
    char text[4096];
    OPEN_CASE(&net, SMALL_REFLECTOR);
    write_result(temp_path("a.h5"), &net);
    python("a", temp_path("a.h5"), damages[_i].deed);
    int n_refused = read_all(temp_path("a.h5"), text, sizeof text);
    ck_assert_msg(n_refused == damages[_i].n_refused, "%d refused: %s", n_refused, text);
    ck_assert_msg(strstr(text, damages[_i].why) != NULL, "%s", text);
    close_net(&net);
}
END_TEST

/* HDF5 1.10 loses memory when a file is damaged or cannot be written: not ours to mend. The symbol is there under a
 * sanitizer only. */
#pragma weak __lsan_disable
void __lsan_disable(void);

static void allow_leaks(void)
{
    if (__lsan_disable) __lsan_disable();
}

/* A flipped bit may only change a number, which cannot be detected, or make the file refused; it must not crash. */
START_TEST(flipped_bits_do_no_harm)
{
    struct net net;
    struct rng rng = rng_start((uint64_t)_i);
    char text[4096];
    size_t size;
    allow_leaks();
    open_bow(&net); /* a small file: most of it is structure */
    write_result(temp_path("a.h5"), &net);
    char *bytes = read_file(temp_path("a.h5"), &size);
    for (int trial = 0; trial < 100; trial++) {
        int n_flip = rng_int(&rng, 1, 20);
        for (int i = 0; i < n_flip; i++)
            bytes[rng_int(&rng, 0, (int)size - 1)] ^= (char)(1 << rng_int(&rng, 0, 6));
        FILE *file = fopen(temp_path("b.h5"), "wb");
        ck_assert(file && fwrite(bytes, 1, size, file) == size && fclose(file) == 0);
        read_all(temp_path("b.h5"), text, sizeof text);
        free(bytes);
        bytes = read_file(temp_path("a.h5"), &size);
    }
    free(bytes);
    close_net(&net);
}
END_TEST

/* A limit on file sizes stands for the full disk: at the start, among the generations, at the end. */
START_TEST(a_full_disk_is_told)
{
    static const rlim_t limits[] = {0, 2000, 20000, 100000, 700000};
    struct net net;
    hf_messages messages = {0};
    hf_store *store;
    struct rlimit limit, before;
    const char *path, *folder = new_folder(&path);
    allow_leaks();
    open_bow(&net);
    hf_optimize_settings settings = small_ga(50, 40);
    double initial[40] = {0};
    int variable[40] = {0}, leader[40];
    for (int k = 0; k < 40; k++)
        leader[k] = k;
    hf_model m = {.n_variable = 40,
                  .n_variable_group = 1,
                  .variable_cable = variable,
                  .variable_group = variable,
                  .variable_leader = leader,
                  .n_leader = 40};
    hf_optimiser ga;
    ck_assert_int_eq(hf_optimiser_create(&hf_optimiser_ga, &settings, &m, initial, &ga), HF_OK);

    getrlimit(RLIMIT_FSIZE, &before);
    limit = before;
    limit.rlim_cur = limits[_i];
    signal(SIGXFSZ, SIG_IGN);
    setrlimit(RLIMIT_FSIZE, &limit);
    hf_status status = hf_store_create(path, 0, any_case(), &net.scene, NULL, 0, NULL, &store, &messages);
    if (status == HF_OK) {
        for (ga.population.generation = 0; ga.population.generation < 40; ga.population.generation++) {
            for (int i = 0; i < 50 * 40; i++) /* each design is new */
                ga.population.design[i] += 1;
            hf_store_generation(store, &m, &ga.population, &messages);
        }
        status = hf_store_finish(store, &(hf_summary){0}, &messages);
    }
    setrlimit(RLIMIT_FSIZE, &before);
    ck_assert_int_eq(status, HF_IO);
    ck_assert_int_eq(count_files(folder), 0);
    ck_assert_msg(strstr(messages.text, path) && strstr(messages.text, "File too large"), "%s", messages.text);
    hf_messages_free(&messages);
    hf_optimiser_free(&ga);
    close_net(&net);
}
END_TEST

/* Whichever file cannot be opened, the message has the reason of the system. */
START_TEST(a_file_that_cannot_be_opened_is_told)
{
    struct net net;
    const char *path, *folder = new_folder(&path);
    bool was_reached = true;
    open_bow(&net);
    for (long n = 1; was_reached; n++) {
        hf_messages messages = {0};
        hf_store *store = NULL;
        fail_call_at("open", n, EMFILE, false);
        hf_status status = hf_store_create(path, 0, any_case(), &net.scene, NULL, 0, NULL, &store, &messages);
        was_reached = end_call_failure();
        if (status != HF_OK) {
            ck_assert_int_eq(status, HF_IO);
            ck_assert_msg(strstr(messages.text, path) && strstr(messages.text, strerror(EMFILE)), "open %ld: %s", n,
                          messages.text);
        }
        hf_store_end(store);
        ck_assert_int_eq(count_files(folder), 0);
        hf_messages_free(&messages);
        no_id_is_open();
    }
    close_net(&net);
}
END_TEST

/* Each allocation of ours fails once; those inside HDF5 are out of reach. */
START_TEST(failed_allocations_are_told)
{
    struct net net;
    char text[4096];
    const char *path, *folder = new_folder(&path);
    OPEN_CASE(&net, SMALL_REFLECTOR);
    find_shape(&net);
    for (long n = 1;; n++) {
        hf_messages messages = {0};
        hf_store *store = NULL;
        hf_scene scene = {0};
        hf_shape shape = {0};
        fail_allocation_at(n);
        hf_status status = hf_store_create(path, 1, any_case(), &net.scene, NULL, 0, NULL, &store, &messages), later;
        if (status == HF_OK) {
            later = hf_store_form(store, &net.model, &net.work, NULL, &messages);
            status = hf_store_finish(store, &(hf_summary){0}, &messages);
            if (later != HF_OK && later != status) status = HF_BAD_USAGE; /* finish returns it, too */
        }
        if (status == HF_OK) status = hf_store_read_scene(path, &scene, &messages);
        if (status == HF_OK) status = hf_store_read_shape(path, HF_STAGE_FORM, &shape, &messages);
        int was_reached = end_allocation_failure();
        ck_assert_int_eq(status, was_reached ? HF_NO_MEMORY : HF_OK);
        ck_assert_int_eq(messages.n_error > 0, was_reached);
        hf_scene_free(&scene);
        hf_shape_free(&shape);
        hf_messages_free(&messages);
        no_id_is_open();
        if (!was_reached) break;
    }
    ck_assert_int_eq(read_all(path, text, sizeof text), 1);
    ck_assert_int_eq(count_files(folder), 1);
    close_net(&net);
}
END_TEST

/* HDF5 counts objects of another file, too, when it takes this one for a file that it could not close. */
START_TEST(a_file_that_cannot_be_closed_is_an_error)
{
    const char *path;
    hf_messages messages = {0};
    hf_file_out out = {.file = -1};
    new_folder(&path);
    hf_hdf5 io = {.path = path, .messages = &messages, .status = HF_OK, .file = -1};
    ck_assert_int_eq(hf_file_out_make(path, &out), 0);
    hf_hdf5_lock();
    hf_hdf5_create_file(&io, &out);
    ck_assert_int_eq(io.status, HF_OK);
    hf_hdf5_make_group(&io, "/open");
    hf_hdf5_close_file(&io);
    ck_assert_int_eq(hf_hdf5_unlock(io.status), HF_IO);
    ck_assert_ptr_nonnull(strstr(messages.text, "cannot close"));
    hf_messages_free(&messages);
    hf_file_out_drop(&out, NULL);
}
END_TEST

Suite *suite_unit_store_faults(void)
{
    Suite *suite = suite_create("unit/store_faults");
    TCase *tests = tcase_create("store_faults");
    suite_add_tcase(suite, tests);
    tcase_add_checked_fixture(tests, quiet, NULL);
    tcase_add_test(tests, existing_files_are_replaced_by_restart_only);
    tcase_add_test(tests, a_file_that_appears_meanwhile_is_kept);
    tcase_add_test(tests, names_that_cannot_be_are_told_at_once);
    tcase_add_test(tests, abandoned_files_leave_nothing);
    tcase_add_test(tests, what_is_no_result_is_refused);
    tcase_add_loop_test(tests, damage_is_told, 0, N(damages));
    tcase_add_loop_test(tests, flipped_bits_do_no_harm, 0, 4);
    tcase_add_test(tests, failed_allocations_are_told);
    tcase_add_test(tests, a_file_that_cannot_be_closed_is_an_error);
    tcase_add_test(tests, a_file_that_cannot_be_opened_is_told);
    tcase_add_loop_test(tests, a_full_disk_is_told, 0, 5); /* last: leaves ids open */
    return suite;
}
