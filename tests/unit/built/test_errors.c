/* What each kind of errors does to first order, against differences of solved nets; temperatures of the truss in
 * samples; what their numbers depend on. */
#include "built_nets.h"

#include "built/montecarlo.h"

enum { N_PART = 2 };

typedef struct {
    struct net net;
    double EA[MAX_BUILT_CABLE], expansion_per_K[MAX_BUILT_CABLE], move_m_per_K[N_PART * 3 * MAX_ATTACHMENT];
    hf_built built;
    hf_workspace work;
    hf_tolerance_settings settings;
    hf_montecarlo m;
} heated;

/* Errors of all kinds on a made-up truss, whose two parts move the attachments by some um for each kelvin. */
static void open_heated(heated *s, int trial)
{
    struct rng rng = rng_start(77 + (uint64_t)trial);
    *s = (heated){.settings = {.sigma_cut_m = 2e-5,
                               .sigma_cut_ratio = 1e-5,
                               .sigma_EA_ratio = 1e-3,
                               .sigma_support_m = 1e-5,
                               .sigma_temperature_K = 3,
                               .batch = 0.4,
                               .samples = 20,
                               .seed = 5,
                               .n_truss = N_PART,
                               .truss = {{0, 5}, {4, 2}}}};
    for (int e = 0; e < MAX_BUILT_CABLE; e++)
        s->expansion_per_K[e] = rng_uniform(&rng, -2e-6, 4e-6);
    for (int k = 0; k < N_PART * 3 * MAX_ATTACHMENT; k++)
        s->move_m_per_K[k] = rng_uniform(&rng, -4e-6, 4e-6);
    open_design(&s->net, trial, s->EA, true);
    make_built(&s->net, &s->built, &s->work);
}

static void begin_heated(heated *s, int threads)
{
    const hf_built_heat heat = {s->expansion_per_K, s->move_m_per_K};
    ck_assert_int_eq(hf_montecarlo_create(&s->settings, &s->built, NULL, NULL, &heat, threads, &s->m), HF_OK);
}

static void close_heated(heated *s)
{
    hf_montecarlo_free(&s->m);
    hf_workspace_free(&s->work);
    hf_built_free(&s->built);
    close_design(&s->net);
}

/* The net with these numbers, by the reference: its shape is in the workspace. */
static void solve_with(heated *s, const double *z, hf_form_result *r)
{
    const hf_model *m = &s->built.model;
    size_t n = (size_t)m->n_cable, places = 3 * (size_t)m->n_node;
    double *cut = malloc(n * sizeof *cut), *EA = malloc(n * sizeof *EA), *move = calloc(places, sizeof *move);
    memcpy(cut, m->target, n * sizeof *cut);
    memcpy(EA, m->EA_N, n * sizeof *EA);
    hf_built_errors_apply(&s->m.errors, 1, z, cut, EA, move);
    ck_assert_int_eq(hf_built_solve(&s->built, &(hf_built_net){cut, EA, move, NULL}, &s->work, r), HF_OK);
    free(cut);
    free(EA);
    free(move);
}

static double inner_part(const heated *s, int k)
{
    const hf_model *m = &s->built.model;
    return s->work.position_m[k % 3 * m->n_node + m->inner_row[k / 3]];
}

/* The share of an error is the mean square of what it moves the inner nodes by. */
START_TEST(shares_are_those_of_solved_nets)
{
    static heated s;
    const double h = 0.05;
    hf_form_result r;
    open_heated(&s, 8 + _i);
    begin_heated(&s, 2);
    int n = 3 * s.built.model.n_inner_node;
    double *z = calloc((size_t)hf_built_errors_count(&s.m.errors), sizeof *z), *first = malloc((size_t)n * sizeof *z);
    for (int kind = 0; kind < HF_ERROR_N_KIND; kind++) {
        ck_assert_double_gt(s.m.covariance.kind_m2[kind], 0);
        for (int i = s.m.errors.first[kind], count = 0; i < s.m.errors.first[kind + 1] && count < 3; i += 7, count++) {
            double square = 0;
            z[i] = -h;
            solve_with(&s, z, &r);
            for (int k = 0; k < n; k++)
                first[k] = inner_part(&s, k);
            z[i] = h;
            solve_with(&s, z, &r);
            for (int k = 0; k < n; k++)
                square += pow((inner_part(&s, k) - first[k]) / (2 * h), 2) / s.built.model.n_inner_node;
            z[i] = 0;
            double off = sqrt(s.m.covariance.share_m2[i]) - sqrt(square);
            ck_assert_msg(fabs(off) <= 1e-5 * sqrt(square) + 2e-10, "kind %d, error %d: %g of %g m", kind, i, off,
                          sqrt(square));
        }
    }
    free(z);
    free(first);
    close_heated(&s);
}
END_TEST

/* Samples, eight at a time, are the nets of their numbers; first order predicts them. */
START_TEST(samples_have_the_temperatures_of_the_truss)
{
    static heated s;
    hf_form_result r;
    open_heated(&s, 12 + _i);
    begin_heated(&s, 2);
    double *z = malloc(s.m.n_z * sizeof *z), nominal = s.m.covariance.nominal_psi_m;
    ck_assert_int_eq(hf_montecarlo_run(&s.m, 1, 0, s.settings.samples), HF_OK);
    for (int i = 0; i < s.settings.samples; i++) {
        const double *row = s.m.row + i * HF_TOLERANCE_COLUMNS;
        double psi = row[HF_TOLERANCE_FIRST + HF_TOLERANCE_PSI];
        hf_built_errors_draw(&s.m.errors, i, z);
        solve_with(&s, z, &r);
        ck_assert_double_eq_tol(psi, r.psi_m, 1e-10);
        ck_assert_double_eq_tol(row[HF_TOLERANCE_LINEAR_PSI], psi, 0.05 * fabs(psi - nominal) + 1e-6);
    }
    free(z);
    close_heated(&s);
}
END_TEST

/* The number of an error is its own, whatever other kinds there are and in whatever order parts are named. */
START_TEST(numbers_are_known_by_part)
{
    static heated a, b;
    open_heated(&a, 8);
    open_heated(&b, 8);
    b.settings.truss[0] = a.settings.truss[1];
    b.settings.truss[1] = a.settings.truss[0];
    b.settings.sigma_cut_m = b.settings.sigma_support_m = b.settings.sigma_EA_ratio = 0;
    begin_heated(&a, 1);
    begin_heated(&b, 1);
    double *x = malloc(a.m.n_z * sizeof *x), *y = malloc(b.m.n_z * sizeof *y);
    for (int i = 0; i < 50; i++) {
        hf_built_errors_draw(&a.m.errors, i, x);
        hf_built_errors_draw(&b.m.errors, i, y);
        const double *of_a = x + a.m.errors.first[HF_ERROR_TEMPERATURE],
                     *of_b = y + b.m.errors.first[HF_ERROR_TEMPERATURE];
        ck_assert(of_a[0] == of_b[0] && of_a[1] == of_b[2] && of_a[2] == of_b[1]);
        ck_assert(of_a[0] != of_a[1] && of_a[1] != of_a[2] && of_a[0] != of_a[2]);
    }
    free(x);
    free(y);
    close_heated(&a);
    close_heated(&b);
}
END_TEST

Suite *suite_unit_errors(void)
{
    Suite *suite = suite_create("unit/errors");
    TCase *tcase = tcase_create("errors");
    tcase_add_loop_test(tcase, shares_are_those_of_solved_nets, 0, 4);
    tcase_add_loop_test(tcase, samples_have_the_temperatures_of_the_truss, 0, 4);
    tcase_add_test(tcase, numbers_are_known_by_part);
    suite_add_tcase(suite, tcase);
    return suite;
}
