/* Fronts and what to keep of them, against references that take each word of the definitions literally. */
#include "support.h"

#include "hypervolume.h"
#include "search/pareto.h"

#include <string.h>

enum { MOST = 80 };

struct set {
    void *block;
    hf_pareto pareto;
    int rank[MOST], naive[MOST];
};

static void open_set(struct set *s, int n, int n_objective)
{
    memset(s, 0, sizeof *s);
    s->pareto = (hf_pareto){.n = n, .n_objective = n_objective};
    ck_assert_int_eq(HF_ARENA_ARRAYS(&s->block, HF_PARETO_ARRAYS(s->pareto)), HF_OK);
}

/* Few different values, so that many are equal; some are not numbers, some designs beyond their limits. */
static void draw_values(struct set *s, struct rng *rng)
{
    static const double odd[2] = {NAN, INFINITY};
    int n_level = rng_int(rng, 1, 30);
    for (int i = 0; i < s->pareto.n; i++) {
        double objective[HF_FRONT_OBJECTIVES_MAX], violation = 0;
        for (int j = 0; j < s->pareto.n_objective; j++)
            objective[j] = rng_int(rng, 0, 40) ? (double)rng_int(rng, -2, n_level) : odd[rng_int(rng, 0, 1)];
        if (!rng_int(rng, 0, 3)) violation = rng_int(rng, 0, 9) ? (double)rng_int(rng, 1, 5) : odd[rng_int(rng, 0, 1)];
        hf_pareto_set(&s->pareto, i, objective, violation);
    }
}

static bool has_numbers(const hf_pareto *p, int i)
{
    for (int j = 0; j < p->n_objective; j++)
        if (!isfinite(hf_pareto_value(p, i)[j])) return false;
    return true;
}

static bool naive_dominates(const hf_pareto *p, int a, int b)
{
    int n_less = 0, n_more = 0;
    if (p->violation[a] > 0 || p->violation[b] > 0) return p->violation[a] < p->violation[b];
    for (int j = 0; j < p->n_objective; j++) {
        n_less += hf_pareto_value(p, a)[j] < hf_pareto_value(p, b)[j];
        n_more += hf_pareto_value(p, a)[j] > hf_pareto_value(p, b)[j];
    }
    return n_less > 0 && n_more == 0;
}

/* Front after front, those that none of the others that are left dominates. */
static int rank_naively(const hf_pareto *p, int *rank)
{
    int n_front = 0;
    for (int i = 0; i < p->n; i++)
        rank[i] = -1;
    for (int n_left = p->n; n_left > 0; n_front++) {
        bool is_next[MOST] = {false};
        for (int i = 0; i < p->n; i++) {
            is_next[i] = rank[i] < 0;
            for (int k = 0; k < p->n && is_next[i]; k++)
                is_next[i] = rank[k] >= 0 || !naive_dominates(p, k, i);
        }
        for (int i = 0; i < p->n; i++) {
            if (!is_next[i]) continue;
            rank[i] = n_front;
            n_left--;
        }
    }
    return n_front;
}

START_TEST(ranks_are_those_of_the_definition)
{
    for (int trial = 0; trial < 300; trial++) {
        struct rng rng = rng_start((uint64_t)trial);
        struct set s;
        open_set(&s, rng_int(&rng, 1, MOST), rng_int(&rng, 2, 3));
        draw_values(&s, &rng);
        for (int i = 0; i < s.pareto.n; i++)
            ck_assert(s.pareto.violation[i] > 0 || has_numbers(&s.pareto, i));
        ck_assert_int_eq(hf_pareto_rank(&s.pareto, s.rank), rank_naively(&s.pareto, s.naive));
        ck_assert_mem_eq(s.rank, s.naive, (size_t)s.pareto.n * sizeof *s.rank);
        for (int a = 0; a < s.pareto.n; a++)
            for (int b = 0; b < s.pareto.n; b++)
                ck_assert_int_eq(hf_pareto_dominates(&s.pareto, a, b), naive_dominates(&s.pareto, a, b));
        hf_arena_free_block(s.block);
    }
}
END_TEST

/* Volume of the members but one. */
static double volume_without(const hf_pareto *p, int n, const int *member, int without)
{
    static const double reference[3] = {2, 2, 1};
    double point[MOST][3];
    int n_point = 0;
    for (int k = 0; k < n; k++) {
        if (member[k] == without) continue;
        point[n_point][0] = hf_pareto_value(p, member[k])[0];
        point[n_point][1] = hf_pareto_value(p, member[k])[1];
        point[n_point++][2] = 0;
    }
    return hypervolume(n_point, point, reference);
}

/* Of two objectives: has member i the least of one? */
static bool is_end(const hf_pareto *p, int n, const int *member, int i)
{
    bool is_least[2] = {true, true};
    for (int k = 0; k < n; k++)
        for (int j = 0; j < 2; j++)
            is_least[j] &= hf_pareto_value(p, i)[j] <= hf_pareto_value(p, member[k])[j];
    return is_least[0] || is_least[1];
}

/* Room of one member of three objectives: how far its neighbours are from each other. */
static double room_naively(const hf_pareto *p, int n, const int *member, const double *range, int i)
{
    double sum = 0;
    for (int j = 0; j < 3; j++) {
        double own = hf_pareto_value(p, i)[j], below = -INFINITY, above = INFINITY;
        for (int k = 0; k < n; k++) {
            double value = hf_pareto_value(p, member[k])[j];
            if (value < own) below = fmax(below, value);
            if (value > own) above = fmin(above, value);
        }
        sum += (above - below) / range[j];
    }
    return sum;
}

/* One after the other: of two objectives the one whose loss costs least of the volume, but for the ends, of three the
 * one with the least room. */
static void keep_naively(const hf_pareto *p, int n, int *member, int n_keep)
{
    double range[3];
    for (int j = 0; j < p->n_objective; j++) {
        double low = INFINITY, high = -INFINITY;
        for (int k = 0; k < n; k++) {
            low = fmin(low, hf_pareto_value(p, member[k])[j]);
            high = fmax(high, hf_pareto_value(p, member[k])[j]);
        }
        range[j] = high - low;
    }
    for (; n > n_keep; n--) {
        int out = -1;
        double least = INFINITY;
        for (int k = 0; k < n; k++) {
            if (p->n_objective == 2 && is_end(p, n, member, member[k])) continue;
            double room = p->n_objective == 2
                              ? volume_without(p, n, member, -1) - volume_without(p, n, member, member[k])
                              : room_naively(p, n, member, range, member[k]);
            if (room < least) least = room, out = k;
        }
        memmove(member + out, member + out + 1, (size_t)(n - out - 1) * sizeof *member);
    }
}

/* Points of a front, all different: on a line bent inwards or outwards, on a sphere. */
static void draw_front(struct set *s, struct rng *rng)
{
    double power = rng_uniform(rng, 0.3, 3);
    for (int i = 0; i < s->pareto.n; i++) {
        double t = rng_uniform(rng, 0.01, 0.99), u = rng_uniform(rng, 0.01, 0.99);
        double on_line[2] = {t, 1 - pow(t, power)}, on_sphere[3] = {t, u, sqrt(2 - t * t - u * u)};
        hf_pareto_set(&s->pareto, i, s->pareto.n_objective == 2 ? on_line : on_sphere, 0);
    }
}

START_TEST(what_is_kept_covers_the_front)
{
    for (int trial = 0; trial < 40; trial++) {
        struct rng rng = rng_start((uint64_t)trial);
        struct set s;
        int member[MOST], wanted[MOST], n = rng_int(&rng, 6, 20), n_keep = rng_int(&rng, 6, n); /* no fewer than ends */
        bool is_kept[MOST] = {false};
        open_set(&s, n, 2 + trial % 2);
        draw_front(&s, &rng);
        for (int i = 0; i < n; i++)
            member[i] = wanted[i] = i;
        hf_pareto_keep(&s.pareto, n, member, n_keep);
        keep_naively(&s.pareto, n, wanted, n_keep);
        for (int k = 0; k < n_keep; k++)
            is_kept[member[k]] = true;
        for (int k = 0; k < n_keep; k++)
            ck_assert(is_kept[wanted[k]]);
        hf_arena_free_block(s.block);
    }
}
END_TEST

/* Equal points, a single value, fewer places than ends, designs beyond their limits. */
START_TEST(odd_fronts_are_kept_as_well)
{
    static const double point[6][2] = {{0, 4}, {0, 4}, {1, 1}, {1, 1}, {1, 1}, {4, 0}};
    struct set s;
    int member[6] = {0, 1, 2, 3, 4, 5}, n_of[3] = {0};
    open_set(&s, 6, 2);
    for (int i = 0; i < 6; i++)
        hf_pareto_set(&s.pareto, i, point[i], 0);
    hf_pareto_keep(&s.pareto, 6, member, 3);
    for (int k = 0; k < 3; k++)
        n_of[point[member[k]][0] > 1 ? 2 : (int)point[member[k]][0]]++;
    for (int k = 0; k < 3; k++)
        ck_assert_int_eq(n_of[k], 1);
    int again[6] = {0, 1, 2, 3, 4, 5};
    hf_pareto_keep(&s.pareto, 6, again, 1);
    ck_assert_int_le(again[0], 5);
    for (int i = 0; i < 6; i++)
        hf_pareto_set(&s.pareto, i, point[0], 1 + (i > 3));
    ck_assert_int_eq(hf_pareto_rank(&s.pareto, s.rank), 2);
    for (int i = 0; i < 6; i++)
        again[i] = i;
    hf_pareto_keep(&s.pareto, 4, again, 2);
    ck_assert(again[0] < 4 && again[1] < 4 && again[0] != again[1]);
    hf_arena_free_block(s.block);
}
END_TEST

/* Two equal ones give one point; those that are dominated, or beyond their limits, none. */
START_TEST(a_population_gives_its_front)
{
    enum { N = 6 };
    double design[N] = {0, 1, 2, 3, 4, 5};
    hf_form_result r[N] = {{.objective = {2, 2}},
                           {.objective = {1, 3}},
                           {.objective = {2, 2}},
                           {.objective = {3, 3}},
                           {.objective = {0, 0}, .status = HF_RATIO_CAP, .violation = 1},
                           {.objective = {9, 0}}};
    const hf_population p = {.n_variable = 1, .n_individual = N, .n_objective = 2, .design = design, .result = r};
    hf_front f;
    ck_assert_int_eq(hf_pareto_front(&p, &f), HF_OK);
    ck_assert_int_eq(f.n_point, 3);
    ck_assert_int_eq(f.minimised, -1);
    ck_assert(f.design[0] == 1 && f.design[1] == 0 && f.design[2] == 5);
    for (int i = 0; i < 3; i++)
        ck_assert_int_eq(f.point[i].mark, HF_FRONT_ON);
    hf_front_free(&f);
    for (int i = 0; i < N; i++)
        r[i].status = HF_COLLAPSED;
    ck_assert_int_eq(hf_pareto_front(&p, &f), HF_OK);
    ck_assert_int_eq(f.n_point, 0);
    hf_front_free(&f);
}
END_TEST

Suite *suite_unit_pareto(void)
{
    Suite *suite = suite_create("unit/pareto");
    TCase *tests = tcase_create("pareto");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, ranks_are_those_of_the_definition);
    tcase_add_test(tests, what_is_kept_covers_the_front);
    tcase_add_test(tests, odd_fronts_are_kept_as_well);
    tcase_add_test(tests, a_population_gives_its_front);
    return suite;
}
