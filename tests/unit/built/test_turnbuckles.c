/* The choice of moves: against all choices there are; steps and range; when it ends. */
#include "support.h"

#include "built/turnbuckles.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_CABLES = 40, ROWS = 30 };

typedef struct {
    double column[MAX_CABLES][ROWS], residual[ROWS], gram[MAX_CABLES * MAX_CABLES], slope[MAX_CABLES];
    hf_turnbuckles_problem p;
} example;

/* Columns that are alike, as those of neighbouring cables are: a walk of random steps. */
static void make_example(example *x, struct rng *rng, int n, int n_row, int moves, int steps)
{
    memset(x, 0, sizeof *x);
    for (int r = 0; r < n_row; r++) {
        x->residual[r] = rng_uniform(rng, -1, 1);
        for (int i = 0; i < n; i++)
            x->column[i][r] = (i ? 0.7 * x->column[i - 1][r] : 0) + rng_uniform(rng, -1, 1);
    }
    for (int i = 0; i < n; i++)
        for (int r = 0; r < n_row; r++) {
            x->slope[i] += x->column[i][r] * x->residual[r];
            for (int j = 0; j < n; j++)
                x->gram[i * n + j] += x->column[i][r] * x->column[j][r];
        }
    x->p = (hf_turnbuckles_problem){
        .n = n, .gram = x->gram, .slope = x->slope, .step_m = 0.1, .steps_max = steps, .n_max = moves};
    for (int r = 0; r < n_row; r++)
        x->p.square += x->residual[r] * x->residual[r];
}

/* The least sum of squares over all choices of at most `left` cables from `first` on. */
static double search_all(const hf_turnbuckles_problem *p, int first, int left, int *steps)
{
    double least = hf_turnbuckles_square(p, steps);
    for (int i = first; i < p->n && left; i++)
        for (int k = -p->steps_max; k <= p->steps_max; k++) {
            if (!k) continue;
            steps[i] = k;
            least = fmin(least, search_all(p, i + 1, left - 1, steps));
            steps[i] = 0;
        }
    return least;
}

/* The greedy choice with exchanges is that of a search in most cases, and nowhere far from it. */
START_TEST(choices_are_nearly_the_best)
{
    static example x;
    struct rng rng = rng_start(7000);
    int n_best = 0;
    double worst = 1;
    enum { TRIALS = 60 };
    for (int trial = 0; trial < TRIALS; trial++) {
        int steps[MAX_CABLES] = {0}, none[MAX_CABLES] = {0}, n_turned = 0;
        hf_turnbuckles_end end;
        bool is_held;
        make_example(&x, &rng, 8, 12, 3, 4);
        double least = search_all(&x.p, 0, x.p.n_max, none);
        ck_assert_int_eq(hf_turnbuckles_choose(&x.p, steps, &end, &is_held), HF_OK);
        double square = hf_turnbuckles_square(&x.p, steps);
        for (int i = 0; i < x.p.n; i++) {
            n_turned += steps[i] != 0;
            ck_assert_int_le(abs(steps[i]), x.p.steps_max);
        }
        ck_assert_int_le(n_turned, x.p.n_max);
        ck_assert_double_ge(square, least - 1e-9);
        n_best += square < least + 1e-9;
        worst = fmax(worst, sqrt(square / least));
    }
    printf("moves: %d of %d choices are the best, the worst is %.3f of it\n", n_best, TRIALS, worst);
    ck_assert_int_ge(n_best, 4 * TRIALS / 5);
    ck_assert_double_lt(worst, 1.1);
}
END_TEST

START_TEST(it_ends_when_it_should)
{
    static example x;
    struct rng rng = rng_start(7001);
    int steps[MAX_CABLES], more[MAX_CABLES], n = 0;
    double sample[MAX_CABLES] = {0};
    hf_turnbuckles_end end;
    bool is_held;
    make_example(&x, &rng, 20, 30, 5, 100);
    ck_assert_int_eq(hf_turnbuckles_choose(&x.p, steps, &end, &is_held), HF_OK);
    ck_assert_int_eq(end, HF_TURNBUCKLES_ALL);
    double reached = sqrt(hf_turnbuckles_square(&x.p, steps));
    x.p.target = reached * 1.2;
    ck_assert_int_eq(hf_turnbuckles_choose(&x.p, more, &end, &is_held), HF_OK);
    ck_assert_int_eq(end, HF_TURNBUCKLES_TARGET);
    ck_assert_double_le(sqrt(hf_turnbuckles_square(&x.p, more)), x.p.target);
    for (int i = 0; i < x.p.n; i++)
        n += more[i] != 0;
    ck_assert_int_lt(n, 5);

    x.p.target = 0;
    x.p.step_m = 100; /* every step is too large */
    ck_assert_int_eq(hf_turnbuckles_choose(&x.p, steps, &end, &is_held), HF_OK);
    ck_assert_int_eq(end, HF_TURNBUCKLES_NONE);
    ck_assert(hf_turnbuckles_square(&x.p, steps) == x.p.square);

    x.p.step_m = 0.1;
    x.p.n_sample = 1;
    x.p.sample = sample;
    for (int i = 0; i < x.p.n; i++)
        sample[i] = 1e3;
    ck_assert_int_eq(hf_turnbuckles_choose(&x.p, steps, &end, &is_held), HF_OK);
    ck_assert_int_eq(end, HF_TURNBUCKLES_DOUBT);
    ck_assert(hf_turnbuckles_square(&x.p, steps) == x.p.square);
}
END_TEST

/* Cables that have nothing to do with each other, more than the few that are tried in full: the best are turned. */
START_TEST(the_most_promising_are_tried)
{
    static example x;
    enum { TURNED = 3 };
    int steps[MAX_CABLES];
    hf_turnbuckles_end end;
    bool is_held;
    x = (example){
        .p = {.n = MAX_CABLES, .gram = x.gram, .slope = x.slope, .step_m = 0.01, .steps_max = 1000, .n_max = TURNED}};
    for (int i = 0; i < MAX_CABLES; i++) {
        x.gram[i * MAX_CABLES + i] = 1;
        x.slope[i] = 1 + i * 7 % MAX_CABLES; /* each size once */
        x.p.square += x.slope[i] * x.slope[i];
    }
    ck_assert_int_eq(hf_turnbuckles_choose(&x.p, steps, &end, &is_held), HF_OK);
    for (int i = 0; i < MAX_CABLES; i++)
        ck_assert_int_eq(steps[i] != 0, x.slope[i] > MAX_CABLES - TURNED);
}
END_TEST

enum { TENSIONS = 6 };

typedef struct {
    example x;
    double rate[MAX_CABLES][TENSIONS], room[TENSIONS];
} held;

static void give_rates(void *context, int i, double *rate)
{
    memcpy(rate, ((const held *)context)->rate[i], sizeof((const held *)context)->rate[i]);
}

/* Does a tension fall too far after these steps? */
static bool breaks(const held *h, const int *steps)
{
    for (int t = 0; t < TENSIONS; t++) {
        double fall = 0;
        for (int i = 0; i < h->x.p.n; i++)
            fall -= h->x.p.step_m * steps[i] * h->rate[i][t];
        if (fall > h->room[t] + 2e-9) return true;
    }
    return false;
}

/* search_all, of what tensions allow. */
static double search_allowed(const held *h, int first, int left, int *steps)
{
    double least = breaks(h, steps) ? (double)INFINITY : hf_turnbuckles_square(&h->x.p, steps);
    for (int i = first; i < h->x.p.n && left; i++)
        for (int k = -h->x.p.steps_max; k <= h->x.p.steps_max; k++) {
            if (!k) continue;
            steps[i] = k;
            least = fmin(least, search_allowed(h, i + 1, left - 1, steps));
            steps[i] = 0;
        }
    return least;
}

/* Choices keep tensions, of which some have no room at all, and are nearly the best of those that do; most choices
 * without them break some. */
START_TEST(tensions_are_kept)
{
    static held h;
    struct rng rng = rng_start(7200);
    int n_broken = 0, n_best = 0;
    double worst = 1;
    enum { TRIALS = 40 };
    for (int trial = 0; trial < TRIALS; trial++) {
        int free_steps[MAX_CABLES], steps[MAX_CABLES], none[MAX_CABLES] = {0};
        hf_turnbuckles_end end;
        bool is_held, is_free_held;
        make_example(&h.x, &rng, 8, 12, 3, 4);
        ck_assert_int_eq(hf_turnbuckles_choose(&h.x.p, free_steps, &end, &is_free_held), HF_OK);
        ck_assert(!is_free_held);
        for (int t = 0; t < TENSIONS; t++) {
            h.room[t] = t == trial % (2 * TENSIONS) ? 0 : rng_uniform(&rng, 0.1, 0.6);
            for (int i = 0; i < h.x.p.n; i++)
                h.rate[i][t] = rng_uniform(&rng, -1, 1);
        }
        h.x.p.n_tension = TENSIONS, h.x.p.room_N = h.room, h.x.p.rates = give_rates, h.x.p.context = &h;
        h.x.p.reference_N = 1;
        ck_assert_int_eq(hf_turnbuckles_choose(&h.x.p, steps, &end, &is_held), HF_OK);
        ck_assert(!breaks(&h, steps));
        if (breaks(&h, free_steps)) ck_assert(is_held);
        n_broken += breaks(&h, free_steps);
        double least = search_allowed(&h, 0, h.x.p.n_max, none), square = hf_turnbuckles_square(&h.x.p, steps);
        ck_assert_double_ge(square, least - 1e-9);
        n_best += square < least + 1e-9;
        worst = fmax(worst, sqrt(square / least));
    }
    printf("moves: %d of %d choices without tensions break some; of those with them %d are the best, the worst is %.3f "
           "of it\n",
           n_broken, TRIALS, n_best, worst);
    ck_assert_int_ge(n_broken, TRIALS / 2);
    ck_assert_int_ge(n_best, TRIALS / 2);
    ck_assert_double_lt(worst, 1.2);
}
END_TEST

/* Half of the tensions have no room: with fine steps, choices are as good as with a room that is next to nothing. */
START_TEST(no_room_is_no_reason_to_fail)
{
    static held h;
    struct rng rng = rng_start(7300);
    double worst = 1;
    for (int trial = 0; trial < 40; trial++) {
        double square[2];
        make_example(&h.x, &rng, 8, 20, 6, 20000);
        h.x.p.step_m = 1e-4;
        for (int t = 0; t < TENSIONS; t++) {
            h.room[t] = t < TENSIONS / 2 ? 0 : rng_uniform(&rng, 0, 0.5);
            for (int i = 0; i < h.x.p.n; i++)
                h.rate[i][t] = rng_uniform(&rng, -1, 1);
        }
        h.x.p.n_tension = TENSIONS, h.x.p.room_N = h.room, h.x.p.rates = give_rates, h.x.p.context = &h;
        h.x.p.reference_N = 1;
        for (int k = 0; k < 2; k++) {
            int steps[MAX_CABLES];
            hf_turnbuckles_end end;
            bool is_held;
            for (int t = 0; t < TENSIONS / 2; t++)
                h.room[t] = k * 1e-9;
            ck_assert_int_eq(hf_turnbuckles_choose(&h.x.p, steps, &end, &is_held), HF_OK);
            ck_assert(!breaks(&h, steps));
            square[k] = hf_turnbuckles_square(&h.x.p, steps);
        }
        worst = fmax(worst, square[0] / square[1]);
    }
    printf("moves: without room the worst sum of squares is %.6f of that with next to none\n", worst);
    ck_assert_double_lt(worst, 1.001);
}
END_TEST

/* A choice that ran out of memory is no choice, however late that was. */
START_TEST(without_memory_there_is_no_choice)
{
    static example x;
    struct rng rng = rng_start(7400);
    int wanted[MAX_CABLES], steps[MAX_CABLES], n_failed = 0;
    hf_turnbuckles_end end;
    bool is_held;
    make_example(&x, &rng, 8, 12, 3, 4);
    ck_assert_int_eq(hf_turnbuckles_choose(&x.p, wanted, &end, &is_held), HF_OK);
    for (long n = 1;; n++) {
        fail_allocation_at(n);
        hf_status status = hf_turnbuckles_choose(&x.p, steps, &end, &is_held);
        if (!end_allocation_failure()) break;
        ck_assert_int_eq(status, HF_NO_MEMORY);
        n_failed++;
    }
    ck_assert_int_gt(n_failed, 10);
    ck_assert_mem_eq(steps, wanted, (size_t)x.p.n * sizeof *steps);
}
END_TEST

/* Without steps the moves are within the range, and no choice of steps is better. */
START_TEST(the_best_is_a_bound)
{
    static example x;
    struct rng rng = rng_start(7100 + (uint64_t)_i);
    int steps[MAX_CABLES];
    double move[MAX_CABLES], square;
    hf_turnbuckles_end end;
    bool is_held;
    make_example(&x, &rng, 20, 30, 20, _i + 1);
    ck_assert_int_eq(hf_turnbuckles_best(&x.p, move), HF_OK);
    ck_assert_int_eq(hf_turnbuckles_choose(&x.p, steps, &end, &is_held), HF_OK);
    square = 0;
    for (int r = 0; r < 30; r++) {
        double sum = x.residual[r];
        for (int i = 0; i < x.p.n; i++)
            sum += x.column[i][r] * move[i];
        square += sum * sum;
    }
    for (int i = 0; i < x.p.n; i++)
        ck_assert_double_le(fabs(move[i]), x.p.steps_max * x.p.step_m);
    ck_assert_double_le(square, hf_turnbuckles_square(&x.p, steps));
}
END_TEST

Suite *suite_unit_turnbuckles(void)
{
    Suite *suite = suite_create("unit/built/turnbuckles");
    TCase *tcase = tcase_create("turnbuckles");
    tcase_add_test(tcase, choices_are_nearly_the_best);
    tcase_add_test(tcase, it_ends_when_it_should);
    tcase_add_test(tcase, the_most_promising_are_tried);
    tcase_add_test(tcase, tensions_are_kept);
    tcase_add_test(tcase, no_room_is_no_reason_to_fail);
    tcase_add_test(tcase, without_memory_there_is_no_choice);
    tcase_add_loop_test(tcase, the_best_is_a_bound, 0, 8);
    suite_add_tcase(suite, tcase);
    return suite;
}
