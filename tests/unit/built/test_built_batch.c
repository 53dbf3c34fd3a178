/* Samples of a net as built, solved many at a time, against hf_built_solve; threads, orders, memory. */
#include "built_nets.h"

#include "base/lane.h"

enum { N_SAMPLE = 24 };

/* All that was taken of samples 0 to N_SAMPLE - 1 of one net. */
struct taken {
    struct errors errors;
    const hf_model *model;
    hf_form_result result[N_SAMPLE];
    double *position_m[N_SAMPLE], *tension_N[N_SAMPLE];
    unsigned char *loose[N_SAMPLE];
    int n_take[N_SAMPLE];
};

static void make(void *context, long i, double *cut_m, double *EA_N, double *support_displacement_m, double *load_N)
{
    (void)load_N;
    make_errors(&((struct taken *)context)->errors, i, cut_m, EA_N, support_displacement_m);
}

static void take(void *context, long i, const hf_built_shape *shape, const hf_form_result *result)
{
    struct taken *t = context;
    t->n_take[i]++;
    t->result[i] = *result;
    memcpy(t->position_m[i], shape->position_m, 3 * (size_t)t->model->n_node * sizeof(double));
    memcpy(t->tension_N[i], shape->tension_N, (size_t)t->model->n_cable * sizeof(double));
    memcpy(t->loose[i], shape->loose, (size_t)t->model->n_node);
}

static void open_taken(const hf_model *model, struct errors errors, struct taken *t)
{
    *t = (struct taken){.errors = errors, .model = model};
    for (int i = 0; i < N_SAMPLE; i++) {
        t->position_m[i] = calloc(3 * (size_t)model->n_node, sizeof(double));
        t->tension_N[i] = calloc((size_t)model->n_cable, sizeof(double));
        t->loose[i] = calloc((size_t)model->n_node, 1);
        ck_assert(t->position_m[i] && t->tension_N[i] && t->loose[i]);
    }
}

static void close_taken(struct taken *t)
{
    for (int i = 0; i < N_SAMPLE; i++) {
        free(t->position_m[i]);
        free(t->tension_N[i]);
        free(t->loose[i]);
    }
}

static void run_all(const hf_built *built, int n_thread, unsigned varies, struct taken *t)
{
    hf_built_batch *batch;
    ck_assert_int_eq(hf_built_batch_create(built, n_thread, &batch), HF_OK);
    ck_assert_int_eq(hf_built_batch_threads(batch), n_thread);
    hf_built_batch_run(batch, varies, 0, N_SAMPLE, make, take, t);
    hf_built_batch_free(batch);
    for (int i = 0; i < N_SAMPLE; i++)
        ck_assert_int_eq(t->n_take[i], 1);
}

/* Half-width of the errors: from those that change little to those that leave cables slack and nodes loose. */
static const double width_m[] = {1e-6, 1e-4, 3e-3, 0.1};
enum { N_WIDTH = sizeof width_m / sizeof *width_m };

static struct errors errors_of(const hf_built *built, int trial)
{
    return (struct errors){&built->model, 5000, width_m[trial % N_WIDTH], 0.1, width_m[trial % N_WIDTH] / 2};
}

static void same_result(const hf_form_result *a, const hf_form_result *b, double near_m)
{
    ck_assert_int_eq(a->status, b->status);
    ck_assert_int_eq(a->n_slack, b->n_slack);
    ck_assert_int_eq(a->n_loose, b->n_loose);
    if (isnan(b->psi_m))
        ck_assert(isnan(a->psi_m));
    else
        ck_assert_double_eq_tol(a->psi_m, b->psi_m, near_m);
}

/* As in test_built.c: two shapes within 1e-11 of the tensions are nearer than 1e-9 m. */
START_TEST(samples_are_those_of_the_reference)
{
    double EA[MAX_BUILT_CABLE];
    struct net net;
    hf_built built;
    hf_workspace w;
    struct taken t;
    int trial = _i / 2;
    unsigned varies = trial % 3 == 0 ? 0 : trial % 3 == 1 ? HF_BUILT_VARIES_EA : HF_BUILT_VARIES_SUPPORTS;
    open_design(&net, trial, EA, _i % 2);
    make_built(&net, &built, &w);
    open_taken(&built.model, errors_of(&built, trial), &t);
    run_all(&built, 2, varies, &t);
    for (int i = 0; i < N_SAMPLE; i++) {
        hf_form_result r;
        double cut[MAX_BUILT_CABLE], own_EA[MAX_BUILT_CABLE], move[3 * MAX_BUILT_CABLE] = {0};
        const hf_model *m = &built.model;
        memcpy(cut, m->target, (size_t)m->n_cable * sizeof(double));
        memcpy(own_EA, m->EA_N, (size_t)m->n_cable * sizeof(double));
        bool has_EA = varies & HF_BUILT_VARIES_EA, has_supports = varies & HF_BUILT_VARIES_SUPPORTS;
        make_errors(&t.errors, i, cut, has_EA ? own_EA : NULL, has_supports ? move : NULL);
        hf_built_solve(&built, &(hf_built_net){cut, own_EA, move, NULL}, &w, &r);
        same_result(&t.result[i], &r, 1e-9);
        for (int k = 0; k < 3 * m->n_node && r.status == HF_OK; k++)
            ck_assert_double_eq_tol(t.position_m[i][k], w.position_m[k], 1e-9);
        for (int e = 0; e < m->n_cable && r.status == HF_OK; e++)
            ck_assert_double_eq_tol(t.tension_N[i][e], w.tension_N[e], 1e-6 * m->reference_N);
        for (int k = 0; k < m->n_node && r.status == HF_OK; k++)
            ck_assert_int_eq(t.loose[i][k], r.n_loose ? w.loose[k] : 0);
    }
    close_taken(&t);
    hf_workspace_free(&w);
    hf_built_free(&built);
    close_design(&net);
}
END_TEST

static void same_bits(const struct taken *a, const struct taken *b)
{
    for (int i = 0; i < N_SAMPLE; i++) {
        ck_assert_mem_eq(a->position_m[i], b->position_m[i], 3 * (size_t)a->model->n_node * sizeof(double));
        ck_assert_mem_eq(a->tension_N[i], b->tension_N[i], (size_t)a->model->n_cable * sizeof(double));
        ck_assert_int_eq(a->result[i].iterations, b->result[i].iterations);
        ck_assert_mem_eq(&a->result[i].psi_m, &b->result[i].psi_m, sizeof(double));
        ck_assert_mem_eq(&a->result[i].residual_N, &b->result[i].residual_N, sizeof(double));
    }
}

START_TEST(bits_depend_on_the_sample_alone)
{
    double EA[MAX_BUILT_CABLE];
    struct net net;
    hf_built built;
    hf_workspace w;
    struct taken one, other;
    hf_built_batch *batch;
    open_design(&net, _i, EA, _i % 2);
    make_built(&net, &built, &w);
    open_taken(&built.model, errors_of(&built, _i), &one);
    run_all(&built, 1, 0, &one);
    for (int n_thread = 1; n_thread <= 3; n_thread++) {
        open_taken(&built.model, one.errors, &other);
        if (n_thread > 1) {
            run_all(&built, n_thread, 0, &other);
        } else { /* backwards, by twos and ones */
            ck_assert_int_eq(hf_built_batch_create(&built, 1, &batch), HF_OK);
            hf_built_batch_run(batch, 0, N_SAMPLE - 1, 1, make, take, &other);
            for (int i = N_SAMPLE - 3; i >= 0; i -= 2)
                hf_built_batch_run(batch, 0, i, 2, make, take, &other);
            hf_built_batch_run(batch, 0, 0, 1, make, take, &other);
            hf_built_batch_free(batch);
        }
        same_bits(&one, &other);
        close_taken(&other);
    }
    close_taken(&one);
    hf_workspace_free(&w);
    hf_built_free(&built);
    close_design(&net);
}
END_TEST

START_TEST(memory_runs_out)
{
    double EA[MAX_BUILT_CABLE];
    struct net net;
    hf_built built;
    hf_workspace w;
    struct taken t;
    hf_built_batch *batch;
    open_design(&net, 1, EA, _i);
    make_built(&net, &built, &w);
    for (long n = 1;; n++) {
        fail_allocation_at(n);
        hf_status status = hf_built_batch_create(&built, 2, &batch);
        if (!end_allocation_failure()) {
            ck_assert_int_eq(status, HF_OK);
            ck_assert_int_gt(n, 2);
            break;
        }
        ck_assert_int_eq(status, HF_NO_MEMORY);
        ck_assert_ptr_null(batch);
        hf_built_batch_free(batch);
    }
    open_taken(&built.model, errors_of(&built, 1), &t);
    fail_allocation_at(1); /* of the second thread, whose work the first one does */
    hf_built_batch_run(batch, 0, 0, N_SAMPLE, make, take, &t);
    end_allocation_failure();
    for (int i = 0; i < N_SAMPLE; i++)
        ck_assert_int_eq(t.n_take[i], 1);
    hf_built_batch_run(batch, 0, 0, N_SAMPLE, make, take, &t);
    hf_built_batch_free(batch);

    ck_assert_int_eq(hf_built_batch_create(&built, 1, &batch), HF_OK);
    long before = allocation_count();
    hf_built_batch_run(batch, HF_BUILT_VARIES_EA | HF_BUILT_VARIES_SUPPORTS, 0, N_SAMPLE, make, take, &t);
    ck_assert_int_eq(allocation_count(), before);
    hf_built_batch_free(batch);
    close_taken(&t);
    hf_workspace_free(&w);
    hf_built_free(&built);
    close_design(&net);
}
END_TEST

static volatile sig_atomic_t stop_now;

static void take_and_stop(void *context, long i, const hf_built_shape *shape, const hf_form_result *result)
{
    take(context, i, shape, result);
    stop_now = 1;
}

/* Only samples that have begun when the flag is set are finished. */
START_TEST(no_sample_begins_after_a_stop)
{
    double EA[MAX_BUILT_CABLE];
    struct net net;
    hf_built built;
    hf_workspace w;
    struct taken t;
    hf_built_batch *batch;
    int n = 0;
    open_design(&net, 1, EA, false);
    make_built(&net, &built, &w);
    open_taken(&built.model, errors_of(&built, 1), &t);
    stop_now = 0;
    built.stop = &stop_now;
    ck_assert_int_eq(hf_built_batch_create(&built, 1, &batch), HF_OK);
    hf_built_batch_run(batch, 0, 0, N_SAMPLE, make, take_and_stop, &t);
    for (int i = 0; i < N_SAMPLE; i++)
        n += t.n_take[i];
    ck_assert_int_ge(n, 1);
    ck_assert_int_le(n, HF_LANES);
    hf_built_batch_free(batch);
    close_taken(&t);
    hf_workspace_free(&w);
    hf_built_free(&built);
    close_design(&net);
}
END_TEST

Suite *suite_unit_built_batch(void)
{
    Suite *suite = suite_create("unit/built_batch");
    TCase *tcase = tcase_create("built_batch");
    tcase_add_loop_test(tcase, samples_are_those_of_the_reference, 0, 24);
    tcase_add_loop_test(tcase, bits_depend_on_the_sample_alone, 0, 8);
    tcase_add_loop_test(tcase, memory_runs_out, 0, 2);
    tcase_add_test(tcase, no_sample_begins_after_a_stop);
    suite_add_tcase(suite, tcase);
    return suite;
}
