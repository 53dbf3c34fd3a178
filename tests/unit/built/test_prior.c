/* What is known of errors before anything is measured: whose number a cable has, and variances by hand. */
#include "built_nets.h"

#include "built/prior.h"
#include <hifdm/cable_set.h>

/* Set b has only cable 2 for itself: cable 1 is of a as well. */
static const hf_cable_set_member member[] = {{0, 0}, {0, 1}, {1, 1}, {1, 2}};
static const char *const name[] = {"a", "b"};

typedef struct {
    struct net net;
    double EA[MAX_BUILT_CABLE], expansion_per_K[MAX_BUILT_CABLE];
    hf_built built;
    hf_workspace work;
    hf_tolerance_settings settings;
} known;

static void open_known(known *k)
{
    *k = (known){.settings = {.sigma_cut_m = 2e-5,
                              .sigma_cut_ratio = 3e-5,
                              .sigma_EA_ratio = 2e-3,
                              .sigma_temperature_K = 3,
                              .batch = 0.4}};
    open_design(&k->net, 8, k->EA, false);
    ck_assert_int_eq(k->net.scene.n_set, 0);
    ck_assert_int_eq(hf_cable_set_make(&k->net.scene, 2, name, sizeof member / sizeof *member, member), HF_OK);
    for (int e = 0; e < k->net.scene.n_cable; e++)
        k->expansion_per_K[e] = 1e-6 * (e % 5 - 1);
    make_built(&k->net, &k->built, &k->work);
}

static void close_known(known *k)
{
    hf_workspace_free(&k->work);
    hf_built_free(&k->built);
    close_design(&k->net);
}

START_TEST(a_cable_of_two_sets_is_of_the_first)
{
    static known k;
    hf_built_errors errors;
    open_known(&k);
    const hf_scene *s = &k.built.scene;
    const hf_built_linear of = {.built = &k.built};
    ck_assert_int_eq(hf_built_errors_make(&of, &k.settings, &(hf_built_heat){k.expansion_per_K, NULL}, &errors), HF_OK);
    ck_assert_int_eq(errors.n_spool, 4);
    for (int e = 0; e < s->n_cable; e++)
        ck_assert_int_eq(errors.spool[e], e < 2 ? 0 : e == 2 ? 1 : 2 + s->group[e]);
    hf_arena_free_block(errors.block);
    close_known(&k);
}
END_TEST

/* Whatever is shared: the variances of all kinds add up for each cable; a number of one cable alone is its own. */
START_TEST(variances_add_up)
{
    static known k;
    hf_prior p;
    open_known(&k);
    const hf_tolerance_settings *t = &k.settings;
    const size_t n = (size_t)k.built.model.n_cable;
    ck_assert_int_eq(hf_prior_make(&k.built, t, k.expansion_per_K, &p), HF_OK);
    for (size_t e = 0; e < n; e++) {
        double l0 = k.built.scene.target[e], stretch = l0 * k.built.tension_N[e] / k.EA[e], shared = 0;
        double cut = pow(t->sigma_cut_m, 2), ratio = pow(t->sigma_cut_ratio * l0, 2);
        double stiffness = pow(t->sigma_EA_ratio * stretch, 2);
        double heat = pow(t->sigma_temperature_K * k.expansion_per_K[e] * l0, 2);
        double own = cut + (e == 2 ? 1 : 1 - t->batch) * (ratio + stiffness);
        ck_assert_double_eq_tol(p.own_m[e], sqrt(own), 1e-12 * p.own_m[e]);
        ck_assert_double_eq_tol(p.sigma_m[e], sqrt(cut + ratio + stiffness + heat), 1e-12 * p.sigma_m[e]);
        for (int i = 0; i < p.n_shared; i++)
            shared += pow(p.shared_m[(size_t)i * n + e], 2);
        ck_assert_double_eq_tol(shared, pow(p.sigma_m[e], 2) - own, 1e-12 * pow(p.sigma_m[e], 2));
    }
    hf_arena_free_block(p.block);
    close_known(&k);
}
END_TEST

Suite *suite_unit_prior(void)
{
    Suite *suite = suite_create("unit/prior");
    TCase *tcase = tcase_create("prior");
    tcase_add_test(tcase, a_cable_of_two_sets_is_of_the_first);
    tcase_add_test(tcase, variances_add_up);
    suite_add_tcase(suite, tcase);
    return suite;
}
