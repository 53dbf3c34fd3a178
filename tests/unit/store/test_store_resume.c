/* A killed run leaves results in its journal; resuming computes their designs again from the seed. */
#include "evolution.h"

#include "store/generations.h"

/* Four generations, of which the visible file has the first two, and the journal the others. */
static void leave_unfinished(const char *path)
{
    struct run r;
    hf_messages messages = {0};
    hf_store *s;
    int n;
    open_run(&r);
    ck_assert_int_eq(begin_new(path, &r, &s, &messages), HF_OK);
    ck_assert_int_eq(store_some(s, &r, 0, 4, &n, &messages), HF_OK);
    hf_store_end(s);
    close_run(&r);
}

static void resume(const char *path, struct run *r, hf_store **s, hf_messages *messages)
{
    hf_summary summary = {0};
    ck_assert_int_eq(hf_store_resume(path, s, messages), HF_OK);
    ck_assert_int_eq(hf_store_generations(*s), 4);
    ck_assert_int_eq(hf_store_restore_initial(*s, N_VARIABLE, r->initial, messages), HF_OK);
    hf_optimiser_free(&r->ga);
    ck_assert_int_eq(hf_optimiser_create(&hf_optimiser_ga, &r->settings, &r->model, r->initial, &r->ga), HF_OK);
    ck_assert_int_eq(hf_store_restore(*s, &r->ga, &summary, messages), HF_OK);
    ck_assert_int_eq(summary.search.generations, hf_store_generations(*s));
}

START_TEST(designs_are_bred_again)
{
    const char *path;
    int n_without_shape = 0;
    struct run r, whole;
    hf_messages messages = {0};
    hf_store *s;
    new_folder(&path);
    leave_unfinished(path);
    open_run(&r);
    for (int k = 0; k < N_VARIABLE; k++)
        r.initial[k] = 1e-9; /* another machine may find another base; the one in the file must be used */
    resume(path, &r, &s, &messages);
    ck_assert_int_eq(messages.n_warning, 0);
    ck_assert_int_eq(hf_store_generations(s), 4);
    open_run(&whole);
    for (int g = 0; g < 4; g++) {
        if (g > 0) hf_optimiser_next(&whole.ga);
        fill(&whole.ga);
    }
    hf_optimiser_tell(&r.ga);
    ck_assert_int_eq(r.ga.population.generation, 3);
    ck_assert_int_eq(r.ga.population.n_evaluation, whole.ga.population.n_evaluation);
    ck_assert_mem_eq(r.ga.population.design, whole.ga.population.design, N_INDIVIDUAL * N_VARIABLE * sizeof(double));
    ck_assert_mem_eq(r.ga.population.best_psi_m, whole.ga.population.best_psi_m, 4 * sizeof(double));
    for (int i = 0; i < N_INDIVIDUAL; i++) {
        const hf_form_result *a = &r.ga.population.result[i], *b = &whole.ga.population.result[i];
        ck_assert_mem_eq(&a->psi_m, &b->psi_m, sizeof(double));
        ck_assert_int_eq(a->status, b->status);
        ck_assert_int_eq(a->stop_reason, b->stop_reason);
        ck_assert_int_eq(a->iterations, b->iterations);
        n_without_shape += a->status != HF_OK;
    }
    ck_assert_int_gt(n_without_shape, 0);
    hf_store_end(s);
    close_run(&r);
    close_run(&whole);
}
END_TEST

/* Results must not be assigned to other designs. A build that makes other designs (here: with another seed) leaves out
 * the results in the journal and evaluates the generations again. */
START_TEST(results_of_other_designs_are_left_out)
{
    const char *path;
    struct run r;
    hf_messages messages = {0};
    hf_store *s;
    int n;
    new_folder(&path);
    leave_unfinished(path);
    open_run(&r);
    r.settings.seed = 99;
    resume(path, &r, &s, &messages);
    ck_assert_int_eq(messages.n_warning, 1);
    ck_assert_msg(strstr(messages.text, "hifdm evaluates the unpublished generations 3 to 4 again") != NULL, "%s",
                  messages.text);
    ck_assert_int_eq(hf_store_generations(s), 2);
    ck_assert_int_eq(r.ga.population.generation, 1);
    hf_messages_free(&messages);
    hf_optimiser_tell(&r.ga);
    ck_assert_int_eq(store_some(s, &r, 2, 4, &n, &messages), HF_OK);
    hf_store_end(s);
    close_run(&r);
    open_run(&r); /* the journal holds the new ones now */
    r.settings.seed = 99;
    resume(path, &r, &s, &messages);
    ck_assert_int_eq(messages.n_warning, 0);
    ck_assert_int_eq(hf_store_generations(s), 4);
    hf_store_end(s);
    close_run(&r);
}
END_TEST

/* Demands that a payload is refused if its head has these numbers, also with the size that they would give. */
static void refuse_head(const hf_generations *g, char *payload, size_t used, int n_fresh, int n_new,
                        size_t design_bytes)
{
    const hf_generations_head right = g->head, wrong = {right.hash, n_fresh, n_new};
    size_t size = used + (size_t)(n_fresh - right.n_fresh) * g->fresh_bytes;
    size += (size_t)(n_new - right.n_new) * design_bytes;
    memcpy(payload, &wrong, sizeof wrong);
    ck_assert(!hf_generations_are_payload(g, payload, used) && !hf_generations_are_payload(g, payload, size));
    memcpy(payload, &right, sizeof right);
}

/* Designs that were moved into limits are in the payload, because they cannot be proposed again. */
START_TEST(moved_designs_are_kept)
{
    struct run r;
    hf_generations g = {
        .n_individual = N_INDIVIDUAL, .n_variable = N_VARIABLE, .limit = N_GENERATION, .every = (int[]){1, 2, 0}[_i]};
    hf_generations reader = g;
    struct iovec piece[HF_GENERATIONS_PAYLOAD];
    char payload[4096];
    double moved[N_INDIVIDUAL * N_VARIABLE];
    const size_t one = N_VARIABLE * sizeof(double), places = _i == 0 ? N_INDIVIDUAL * sizeof(int) : 0;
    open_run(&r);
    fill(&r.ga);
    hf_population *p = &r.ga.population;
    ck_assert(hf_generations_create(&g) == HF_OK && hf_generations_create(&reader) == HF_OK);
    p->is_moved = true;
    for (int n = 0; n < 3; n++) { /* all designs are new, then two, then none */
        size_t used = 0, n_new = (size_t[]){N_INDIVIDUAL, 2, 0}[_i == 0 ? n : 0];
        for (int i = 0; i < N_INDIVIDUAL * N_VARIABLE && n < 2; i++)
            if (n == 0 || i / N_VARIABLE == 1 || i == N_INDIVIDUAL * N_VARIABLE - 1) p->design[i] *= 1 + 0.01 * i;
        memcpy(moved, p->design, sizeof moved);
        hf_generations_add(&g, p, piece);
        for (int i = 0; i < HF_GENERATIONS_PAYLOAD; used += piece[i++].iov_len)
            if (piece[i].iov_len) memcpy(payload + used, piece[i].iov_base, piece[i].iov_len);
        ck_assert_int_eq(g.head.n_new, (int)n_new);
        ck_assert(hf_generations_are_payload(&g, payload, used));
        ck_assert(!hf_generations_are_payload(&g, payload, used - 8));
        ck_assert(!hf_generations_are_payload(&g, payload, used + 8));
        ck_assert(!hf_generations_are_payload(&g, payload, sizeof g.head - 1));
        refuse_head(&g, payload, used, N_INDIVIDUAL, N_INDIVIDUAL + 1, one);
        refuse_head(&g, payload, used, N_INDIVIDUAL, -2, one);
        refuse_head(&g, payload, used, N_INDIVIDUAL + 1, (int)n_new, one);
        refuse_head(&g, payload, used, -1, (int)n_new, one);
        memset(p->design, 0, sizeof moved);
        ck_assert(hf_generations_take_payload(&reader, payload, NULL, p));
        ck_assert_mem_eq(p->design, moved, sizeof moved);
        payload[n_new ? used - 1 : 0] ^= 1; /* the hash notices */
        ck_assert(!hf_generations_take_payload(&reader, payload, NULL, p));
        payload[n_new ? used - 1 : 0] ^= 1;
        for (size_t i = 0; i < places; i += sizeof(int)) { /* rows that do not fit the designs are noticed before */
            for (int shift = 1; shift < 128; shift <<= 2) {
                payload[sizeof g.head + i] ^= (char)shift;
                ck_assert(!hf_generations_take_payload(&reader, payload, NULL, p));
                payload[sizeof g.head + i] ^= (char)shift;
            }
        }
        ck_assert(hf_generations_take_payload(&reader, payload, NULL, p));
        hf_generations_add(&reader, p, NULL);
    }
    hf_generations_free(&g);
    hf_generations_free(&reader);
    close_run(&r);
}
END_TEST

/* The payload of a generation has the results of the individuals that are not kept. The others have those of the
 * generation before. Other numbers of them are noticed. */
START_TEST(kept_individuals_are_taken_over)
{
    struct run r;
    hf_generations g = {
        .n_individual = N_INDIVIDUAL, .n_variable = N_VARIABLE, .limit = N_GENERATION, .every = (int[]){1, 2, 0}[_i]};
    struct iovec piece[HF_GENERATIONS_PAYLOAD];
    char payload[4096];
    hf_form_result result[N_INDIVIDUAL];
    size_t used = 0;
    open_run(&r);
    fill(&r.ga);
    hf_population *p = &r.ga.population, before = *p;
    ck_assert_int_eq(hf_generations_create(&g), HF_OK);
    hf_generations_add(&g, p, NULL);
    memcpy(result, p->result, sizeof result);
    before.result = result;
    for (int i = 1; i < N_INDIVIDUAL; i++) { /* all but the first were kept */
        p->parent[2 * i] = i;
        p->parent[2 * i + 1] = -1;
    }
    p->result[0].psi_m *= 2;
    hf_generations_add(&g, p, piece);
    ck_assert_int_eq(g.head.n_fresh, 1);
    for (int i = 0; i < HF_GENERATIONS_PAYLOAD; used += piece[i++].iov_len)
        memcpy(payload + used, piece[i].iov_base, piece[i].iov_len);
    memset(p->result, 0, sizeof result);
    result[0].psi_m *= 2;
    ck_assert(hf_generations_are_payload(&g, payload, used));
    ck_assert(hf_generations_take_payload(&g, payload, &before, p));
    for (int i = 0; i < N_INDIVIDUAL; i++) {
        ck_assert_int_eq(p->result[i].status, result[i].status);
        ck_assert_mem_eq(&p->result[i].psi_m, &result[i].psi_m, sizeof(double));
    }
    ck_assert(!hf_generations_take_payload(&g, payload, NULL, p)); /* nothing to take over from */
    for (int n = 0; n < 3; n += 2) {
        memcpy(payload + offsetof(hf_generations_head, n_fresh), &(int32_t){n}, sizeof(int32_t));
        ck_assert(!hf_generations_are_payload(&g, payload, used));
        ck_assert(hf_generations_are_payload(&g, payload, used + (size_t)n * g.fresh_bytes - g.fresh_bytes));
        ck_assert(!hf_generations_take_payload(&g, payload, &before, p));
    }
    hf_generations_free(&g);
    close_run(&r);
}
END_TEST

/* Every difference in the designs is detected: a last bit, two that cancel in a sum, two individuals exchanged. */
START_TEST(other_designs_are_told_apart)
{
    struct run r;
    hf_generations g = {.n_individual = N_INDIVIDUAL, .n_variable = N_VARIABLE, .limit = N_GENERATION, .every = 1};
    struct iovec piece[HF_GENERATIONS_PAYLOAD];
    char payload[4096];
    size_t used = 0;
    open_run(&r);
    fill(&r.ga);
    ck_assert_int_eq(hf_generations_create(&g), HF_OK);
    hf_generations_add(&g, &r.ga.population, piece);
    for (int i = 0; i < HF_GENERATIONS_PAYLOAD; used += piece[i++].iov_len)
        memcpy(payload + used, piece[i].iov_base, piece[i].iov_len);
    ck_assert(hf_generations_are_payload(&g, payload, used));
    ck_assert(hf_generations_take_payload(&g, payload, NULL, &r.ga.population));
    double *d = r.ga.population.design, one[N_VARIABLE];
    for (int k = 0; k < N_INDIVIDUAL * N_VARIABLE; k++) {
        int other = (k + 5) % (N_INDIVIDUAL * N_VARIABLE);
        double a = d[k], b = d[other];
        d[k] = nextafter(a, 1e9);
        ck_assert(!hf_generations_take_payload(&g, payload, NULL, &r.ga.population));
        d[other] = nextafter(b, -1e9);
        ck_assert(!hf_generations_take_payload(&g, payload, NULL, &r.ga.population));
        d[k] = a;
        d[other] = b;
    }
    memcpy(one, d + N_VARIABLE, sizeof one);
    memcpy(d + N_VARIABLE, d + 2 * N_VARIABLE, sizeof one);
    memcpy(d + 2 * N_VARIABLE, one, sizeof one);
    ck_assert(!hf_generations_take_payload(&g, payload, NULL, &r.ga.population));
    hf_generations_free(&g);
    close_run(&r);
}
END_TEST

/* What Python does to the unfinished file, or to its journal with a right checksum, and what is said then. */
#define RECORD(deed)                                                                                                   \
    "import struct, zlib; name = sys.argv[1] + '.journal'; data = bytearray(open(name, 'rb').read())\n"                \
    "n, = struct.unpack_from('<I', data, 76)\n" deed                                                                   \
    "\nstruct.pack_into('<I', data, 80, zlib.crc32(data[84:84 + n])); open(name, 'wb').write(data)"
static const struct {
    const char *deed, *why;
} spoilt[] = {
    {"f['search/population'].attrs.modify('n_individual', f['search/population'].attrs['n_individual'] + 1); import "
     "os; os.remove(f.filename + "
     "'.journal')",
     "other sizes than the case"},
    {"f['search/population'].attrs.modify('n_individual', 2**30)", "impossible sizes"},
    {"f['search/population'].attrs.modify('n_individual', 100001)", "impossible sizes"},
    {"f['search/population'].attrs.modify('n_individual', 0)", "impossible sizes"},
    {"f['search/population'].attrs.modify('n_variable', 2**30)", "impossible sizes"},
    {"f['search/population'].attrs['n_objective'] = np.int32(-1)", "impossible sizes"},
    {"f['search/population'].attrs['n_objective'] = np.int32(4)", "impossible sizes"},
    {"f['search/population'].attrs['store_every'] = np.int32(-1)", "impossible sizes"},
    {"f['search/population'].attrs['store_every'] = np.int32(1000001)", "impossible sizes"},
    {"f['search/population'].attrs.modify('generations_limit', 0)", "impossible sizes"},
    {"f['search/population'].attrs.modify('generations_limit', 1000001)", "impossible sizes"},
    {"f['search/population'].attrs.modify('generations_limit', -1)", "impossible sizes"},
    {"f['search/population'].attrs.modify('generations_limit', f['search/population'].attrs['generations_limit'] + 1)",
     "other sizes than the case"},
    {"f['search/population/design'][f['search/population/design_row'][1, 0], 0] = np.nan",
     "a last generation that no run stores"},
    {"f['search/population/design'][f['search/population/design_row'][1, 0], 0] = 1e9",
     "a last generation that no run stores"},
    {"f['search/population/design_row'][1, 0] = -1",
     "/search/population/design_row points to a design that is not there"},
    {"f['search/population/design_row'][1, 0] = len(f['search/population/design'])",
     "/search/population/design_row points to a design that is not there"},
    {"f['search/population/psi_m'][1, 0] = np.inf", "a last generation that no run stores"},
    {"f['search/population/parent'][1, 0, 0] = 10**6", "a last generation that no run stores"},
    {"f['search/population/status'][1, 0] = 99", "/search/population/status holds a value that has no word"},
    {"f['variable/initial'][0] = np.inf", "/variable has an initial design that is none"},
    {"f['search/population/mutation_rate'].resize(1, 0)", "/search/population/mutation_rate has other dimensions"},
    {"del f['search/population/psi_m']; f['search/population/psi_m'] = np.zeros((2, 3), int)",
     "/search/population/psi_m "},
    {"f.move('search/population/psi_m', 'x'); f['search/population/psi_m'] = h5py.SoftLink('/x')",
     "/search/population/psi_m is a link to another place"},
    {"f['search/more'] = h5py.ExternalLink('/etc/passwd', '/')", "/search/more is a link to another place"},
    {"f['all'] = f['/']", "one object too many, or too deep"},
    {RECORD("data[88 + 16] = 77"),
     "no run stores a record like its generation 2"}, /* `evaluated` of the first individual */
    {RECORD("data[84:84 + n] = struct.pack('<i', 2) + bytes(20); n = 24; struct.pack_into('<I', data, 76, n)"),
     "does not match"},
    {RECORD("struct.pack_into('<i', data, 84, 2**31 - 1)"), "does not match"},
};

START_TEST(a_damaged_file_is_refused)
{
    const char *path;
    struct run r;
    hf_messages messages = {0};
    hf_store *s = NULL;
    hf_summary summary = {0};
    new_folder(&path);
    leave_unfinished(path);
    python("a", path, spoilt[_i].deed);
    open_run(&r);
    hf_status status = hf_store_resume(path, &s, &messages);
    if (status == HF_OK) status = hf_store_restore_initial(s, N_VARIABLE, r.initial, &messages);
    if (status == HF_OK) status = hf_store_restore(s, &r.ga, &summary, &messages);
    ck_assert_int_eq(status, HF_EXISTS); /* in the way, also of the next attempt */
    ck_assert_msg(strstr(messages.text, path) && strstr(messages.text, spoilt[_i].why), "%s", messages.text);
    if (s) hf_store_end(s);
    hf_messages_free(&messages);
    close_run(&r);
}
END_TEST

/* An allocation that fails anywhere on the way back is said: a run that went on without its population would find other
 * designs. */
START_TEST(without_memory_nothing_is_restored)
{
    const char *path;
    int n_failed = 0;
    new_folder(&path);
    leave_unfinished(path);
    for (long n = 1;; n++) {
        struct run r;
        hf_store *s = NULL;
        hf_summary summary = {0};
        hf_messages messages = {0};
        open_run(&r);
        fail_allocation_at(n);
        hf_status status = hf_store_resume(path, &s, &messages);
        if (status == HF_OK) status = hf_store_restore_initial(s, N_VARIABLE, r.initial, &messages);
        if (status == HF_OK) status = hf_store_restore(s, &r.ga, &summary, &messages);
        bool has_failed = end_allocation_failure();
        ck_assert_msg(status == (has_failed ? HF_NO_MEMORY : HF_OK), "allocation %ld: %d: %s", n, status,
                      messages.text);
        n_failed += has_failed;
        if (s) hf_store_end(s);
        hf_messages_free(&messages);
        close_run(&r);
        if (!has_failed) break;
    }
    ck_assert_int_gt(n_failed, 5);
}
END_TEST

Suite *suite_unit_store_resume(void)
{
    Suite *suite = suite_create("unit/store_resume");
    TCase *tests = tcase_create("store_resume");
    suite_add_tcase(suite, tests);
    tcase_add_checked_fixture(tests, quiet, NULL);
    tcase_add_test(tests, designs_are_bred_again);
    tcase_add_test(tests, without_memory_nothing_is_restored);
    tcase_add_loop_test(tests, moved_designs_are_kept, 0, 3);
    tcase_add_test(tests, other_designs_are_told_apart);
    tcase_add_loop_test(tests, kept_individuals_are_taken_over, 0, 3);
    tcase_add_loop_test(tests, a_damaged_file_is_refused, 0, (int)(sizeof spoilt / sizeof spoilt[0]));
    tcase_add_test(tests, results_of_other_designs_are_left_out);
    return suite;
}
