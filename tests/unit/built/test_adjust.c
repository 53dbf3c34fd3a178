/* Moves of turnbuckles: twin experiments, steps and range, the table against shapes that are solved. */
#include "twins.h"

#include "built/adjust.h"

typedef struct {
    hf_objectives objectives;
    hf_adjust_settings settings;
    hf_adjust_task task;
    int cable[TWIN_CABLES];
} job;

/* All cables can be turned; the figure is psi. */
static void make_job(const twin *t, job *j, double range_m, double step_m, int moves)
{
    hf_messages messages = {0};
    hf_optimize_settings psi = {0};
    ck_assert_int_eq(
        hf_objectives_create(&t->built.scene, &t->built.model, &psi, NULL, NULL, NULL, &j->objectives, &messages),
        HF_OK);
    j->settings =
        (hf_adjust_settings){.range_m = range_m, .step_m = step_m, .max_adjustments = moves, .figure = HF_FIGURE_PSI};
    for (int e = 0; e < t->built.model.n_cable; e++)
        j->cable[e] = e;
    j->task = (hf_adjust_task){&j->settings, &j->objectives, t->built.model.n_cable, j->cable, NULL, 1};
}

static void find_moves(const twin *t, const job *j, hf_estimate *p, hf_adjustment *found)
{
    ck_assert_int_eq(hf_estimate_create(&t->built, &t->prior, t->position_m, p), HF_OK);
    ck_assert_int_eq(hf_estimate_find(p), HF_OK);
    ck_assert_int_eq(hf_adjust_find(p, &j->task, found), HF_OK);
}

/* psi of the true net after some of these moves. */
static double true_psi_m(twin *t, const hf_adjustment *found, int n_turnbuckle)
{
    static double length[TWIN_CABLES], off[TWIN_DOFS];
    const hf_model *m = &t->built.model;
    hf_form_result r;
    for (int e = 0; e < m->n_cable; e++)
        length[e] = m->target[e] + t->cut_m[e];
    for (int k = 0; k < n_turnbuckle; k++)
        length[found->turnbuckle[k].cable] += found->turnbuckle[k].turnbuckle_m;
    for (int i = 0; i < 3 * m->n_node; i++)
        off[i % 3 * m->n_node + i / 3] = t->rest_m[i];
    hf_built_net net = {.cut_m = length, .support_displacement_m = off};
    ck_assert_int_eq(hf_built_solve(&t->built, &net, &t->work, &r), HF_OK);
    return r.psi_m;
}

static void check_moves(const job *j, const hf_adjustment *found)
{
    ck_assert_int_le(found->n_turnbuckle, j->settings.max_adjustments);
    ck_assert_double_le(found->best_m, found->adjusted_m);
    ck_assert_double_le(found->adjusted_m, found->estimated_m);
    for (int k = 0; k < found->n_turnbuckle; k++) {
        const hf_adjust_turnbuckle *turned = &found->turnbuckle[k];
        ck_assert(turned->turnbuckle_m == turned->steps * j->settings.step_m && turned->steps != 0);
        ck_assert_double_le(fabs(turned->turnbuckle_m), j->settings.range_m);
        for (int l = 0; l < k; l++)
            ck_assert_int_ne(found->turnbuckle[l].cable, turned->cable);
    }
    if (found->n_turnbuckle) /* found on different ways, to the tolerance of shapes */
        ck_assert_double_eq_tol(found->turnbuckle[found->n_turnbuckle - 1].figure_m, found->adjusted_m,
                                1e-6 * found->adjusted_m);
}

/* Sum of squares of what the gains of single moves miss, each over its sigma. */
static double missed_gains(twin *t, const hf_adjustment *found)
{
    double sum = 0, true_m = true_psi_m(t, found, 0);
    for (int k = 0; k < found->n_turnbuckle; k++) {
        const hf_adjust_turnbuckle *turned = &found->turnbuckle[k];
        double now_m = true_psi_m(t, found, k + 1), off = (true_m - now_m - turned->gain_m) / turned->gain_sigma_m;
        true_m = now_m;
        sum += off * off;
    }
    return sum;
}

/* One experiment: what is told, what is true, and what would be chosen if all errors were known. Returns psi of the
 * truth after the moves over that after those of full knowledge. */
static double run_twin(twin *t, int n, const char *what, double range_m, double step_m, int moves, double *missed)
{
    static job j;
    hf_estimate p;
    hf_adjustment found, known;
    make_job(t, &j, range_m, step_m, moves);
    find_moves(t, &j, &p, &found);
    check_moves(&j, &found);
    ck_assert(p.is_settled && found.is_settled);
    double before = true_psi_m(t, &found, 0), after = true_psi_m(t, &found, found.n_turnbuckle);
    memcpy(p.cut_m, t->cut_m, sizeof(double) * (size_t)t->built.model.n_cable);
    memcpy(p.rest_m, t->rest_m, sizeof(double) * 3 * (size_t)t->built.model.n_node);
    hf_form_result r;
    ck_assert_int_eq(hf_estimate_shape(&p, NULL, &p.work, &r), HF_OK);
    ck_assert_int_eq(hf_adjust_find(&p, &j.task, &known), HF_OK);
    check_moves(&j, &known);
    printf("%s %d: psi %.3f -> %.3f mm by %d moves (told %.3f +- %.3f), known %.3f by %d, bound %.3f\n", what, n,
           before * 1e3, after * 1e3, found.n_turnbuckle, found.doubt_m[1] * 1e3, found.spread_m[1] * 1e3,
           known.adjusted_m * 1e3, known.n_turnbuckle, known.best_m * 1e3);
    ck_assert_double_lt(after, before);
    ck_assert_double_lt(fabs(after - found.doubt_m[1]), 6 * found.spread_m[1] + 0.1 * found.doubt_m[1]);
    double ratio = after / known.adjusted_m;
    *missed = missed_gains(t, &found) / found.n_turnbuckle;
    hf_arena_free_block(found.block);
    hf_arena_free_block(known.block);
    hf_objectives_free(&j.objectives);
    hf_estimate_free(&p);
    return ratio;
}

/* Errors of 1 mm and, in every second pair, of supports of 0.2 mm; measured to 0.2 mm, every fifth node is not. Six
 * moves found in noise come near those that full knowledge would choose, which are as good as the choice goes. */
START_TEST(twins_of_random_nets)
{
    static twin t;
    enum { TRIALS = 8 };
    double mean = 0, missed = 0, of_net;
    for (int trial = 0; trial < TRIALS; trial++) {
        open_random_twin(&t, 80 + trial, trial % 2);
        measure_twin(&t, 1e-3, trial % 4 > 1 ? 2e-4 : 0, 2e-4, 5);
        mean += run_twin(&t, trial, "saddle", 5e-3, 1e-4, 6, &of_net) / TRIALS;
        missed += of_net / TRIALS;
        close_twin(&t);
    }
    printf("psi after the moves over that of full knowledge: %.3f; gains miss %.2f of their sigmas (root of mean "
           "square)\n",
           mean, sqrt(missed));
    ck_assert_double_lt(mean, 1.5);
    ck_assert_double_eq_tol(sqrt(missed), 1, 0.5);
}
END_TEST

/* The net of the paper, cut to 0.03 mm, measured to 0.1 mm. */
START_TEST(twin_of_a_reflector)
{
    static twin t;
    double missed;
    t = (twin){.rng = rng_start(9000)};
    OPEN_CASE(&t.net, "configs/chen2022.yaml", "form.method=newton");
    make_twin(&t);
    measure_twin(&t, 3e-5, 0, 1e-4, 10);
    ck_assert_double_lt(run_twin(&t, 0, "chen2022", 5e-4, 1e-5, 8, &missed), 1.02);
    close_twin(&t);
}
END_TEST

/* How far moves take a tension below what is asked for, or below what it has without moves where that is less: of the
 * worst cable, in parts of what is asked for. Linear predictions are not exact, so it may be a little. */
static double shortfall(const twin *t, const hf_estimate *p, const hf_adjustment *found, const double *least_N)
{
    static double turn_m[TWIN_CABLES], before_N[TWIN_CABLES];
    int n = t->built.model.n_cable;
    double worst = 0;
    hf_workspace w;
    hf_form_result r;
    ck_assert_int_eq(hf_workspace_create(&t->built.model, &w), HF_OK);
    ck_assert_int_eq(hf_estimate_shape(p, NULL, &w, &r), HF_OK);
    memcpy(before_N, w.tension_N, sizeof(double) * (size_t)n);
    memset(turn_m, 0, sizeof turn_m);
    for (int k = 0; k < found->n_turnbuckle; k++)
        turn_m[found->turnbuckle[k].cable] = found->turnbuckle[k].turnbuckle_m;
    ck_assert_int_eq(hf_estimate_shape(p, turn_m, &w, &r), HF_OK);
    for (int e = 0; e < n; e++)
        worst = fmax(worst, (fmin(least_N[e], before_N[e]) - w.tension_N[e]) / least_N[e]);
    hf_workspace_free(&w);
    return worst;
}

/* The net of the paper has a psi of its own, and a range in which moves for it take tension away: those that do not
 * know that half of each tension of the design is asked for leave some cable a fifth less, those that do keep it but
 * for a twentieth. */
START_TEST(least_tensions_are_kept)
{
    static twin t;
    static job j;
    static double least_N[TWIN_CABLES];
    double lacks[2];
    t = (twin){.rng = rng_start(9001)};
    OPEN_CASE(&t.net, "configs/chen2022.yaml", "form.method=newton");
    make_twin(&t);
    measure_twin(&t, 3e-5, 0, 1e-4, 10);
    make_job(&t, &j, 2e-3, 1e-5, 8);
    for (int e = 0; e < t.built.model.n_cable; e++)
        least_N[e] = t.built.tension_N[e] / 2;
    for (int asked = 0; asked < 2; asked++) {
        hf_estimate p;
        hf_adjustment found;
        j.task.min_N = asked ? least_N : NULL;
        find_moves(&t, &j, &p, &found);
        lacks[asked] = shortfall(&t, &p, &found, least_N);
        printf("%s: psi %.3f -> %.3f mm by %d moves, %.3f of a least tension is not there\n",
               asked ? "asked for" : "not asked for", found.estimated_m * 1e3, found.adjusted_m * 1e3,
               found.n_turnbuckle, lacks[asked]);
        ck_assert_int_gt(found.n_turnbuckle, 0);
        ck_assert(found.is_held_taut);
        hf_arena_free_block(found.block);
        hf_estimate_free(&p);
    }
    ck_assert_double_gt(lacks[0], 0.1); /* else there would be nothing to keep */
    ck_assert_double_lt(lacks[1], 0.05);
    hf_objectives_free(&j.objectives);
    close_twin(&t);
}
END_TEST

/* Within a range in which tensions are not linear in the moves, the shapes that are solved keep nine tenths of what is
 * asked for all the same. */
START_TEST(least_tensions_are_kept_far_away)
{
    static twin t;
    static job j;
    static double least_N[TWIN_CABLES];
    hf_estimate p;
    hf_adjustment found;
    open_random_twin(&t, 200 + _i, _i % 2);
    for (int row = 0; row < t.built.model.n_free; row++)
        t.built.model.position_m[2 * t.built.model.n_node + row] += rng_uniform(&t.rng, -0.3, 0.3);
    measure_twin(&t, 1e-3, 0, 1e-3, 3);
    make_job(&t, &j, 0.3, 1e-3, 6);
    for (int e = 0; e < t.built.model.n_cable; e++)
        least_N[e] = t.built.tension_N[e] / 2;
    j.task.min_N = least_N;
    find_moves(&t, &j, &p, &found);
    double lacks = shortfall(&t, &p, &found, least_N);
    printf("net %d: %d moves, %.3f of a least tension is not there\n", _i, found.n_turnbuckle, lacks);
    ck_assert_double_lt(lacks, 0.1 + 1e-6); /* shapes on the way are found to tolerances */
    hf_arena_free_block(found.block);
    hf_estimate_free(&p);
    hf_objectives_free(&j.objectives);
    close_twin(&t);
}
END_TEST

/* Twice the same bits, whatever the memory held before. */
START_TEST(moves_repeat)
{
    static twin t;
    static job j;
    hf_estimate p;
    hf_adjustment found[2];
    open_random_twin(&t, 99, true);
    measure_twin(&t, 1e-3, 2e-4, 2e-4, 5);
    make_job(&t, &j, 5e-3, 1e-4, 6);
    for (int k = 0; k < 2; k++) {
        find_moves(&t, &j, &p, &found[k]);
        hf_estimate_free(&p);
    }
    ck_assert(found[0].n_turnbuckle > 0 && found[0].n_turnbuckle == found[1].n_turnbuckle);
    ck_assert(found[0].adjusted_m == found[1].adjusted_m && found[0].best_m == found[1].best_m);
    for (int k = 0; k < found[0].n_turnbuckle; k++)
        ck_assert(memcmp(&found[0].turnbuckle[k], &found[1].turnbuckle[k], sizeof *found[0].turnbuckle) == 0);
    hf_arena_free_block(found[0].block);
    hf_arena_free_block(found[1].block);
    hf_objectives_free(&j.objectives);
    close_twin(&t);
}
END_TEST

Suite *suite_unit_adjust(void)
{
    Suite *suite = suite_create("unit/built/adjust");
    TCase *tcase = tcase_create("adjust");
    tcase_add_test(tcase, twins_of_random_nets);
    tcase_add_test(tcase, twin_of_a_reflector);
    tcase_add_test(tcase, least_tensions_are_kept);
    tcase_add_loop_test(tcase, least_tensions_are_kept_far_away, 0, 12);
    tcase_add_test(tcase, moves_repeat);
    suite_add_tcase(suite, tcase);
    return suite;
}
