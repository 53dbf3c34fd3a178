/* Which lane takes which design, by a solver that only counts: design i settles after rounds_of[i] looks. */
#include "support.h"

#include "base/lane.h"
#include "search/lane_schedule.h"

enum { MAX_DESIGN = 40, NONE = -1 };

struct counts {
    int n_design, n_handed_out, n_asked_after_the_end;
    int rounds_of[MAX_DESIGN]; /* looks that a design needs */
    int lane_of[MAX_DESIGN];   /* that settled it, or NONE */
    int n_settled[MAX_DESIGN]; /* times that it was final */
    int n_rest[MAX_DESIGN];    /* looks that it still needs */
    int in_lane[HF_LANES];     /* design loaded last, or NONE */
    int n_load, n_look, n_step;
};

static int next_design(void *context)
{
    struct counts *c = context;
    if (c->n_handed_out < c->n_design) return c->n_handed_out++;
    c->n_asked_after_the_end++;
    return -1;
}

static void load(void *solver, int lane, int i_design)
{
    struct counts *c = solver;
    ck_assert(lane >= 0 && lane < HF_LANES && i_design >= 0);
    ck_assert_int_lt(i_design, c->n_handed_out); /* no other may be read */
    c->in_lane[lane] = i_design;
    c->n_rest[i_design] = c->rounds_of[i_design];
    c->n_load++;
}

static void look(void *solver)
{
    struct counts *c = solver;
    ck_assert_int_eq(c->n_look, c->n_step); /* looks and steps alternate */
    for (int lane = 0; lane < HF_LANES; lane++)
        ck_assert_int_ne(c->in_lane[lane], NONE); /* kernels need numbers in every lane */
    c->n_look++;
}

static bool settle(void *solver, int lane, int i_design)
{
    struct counts *c = solver;
    ck_assert_int_eq(c->in_lane[lane], i_design);
    if (--c->n_rest[i_design] > 0) return false;
    c->lane_of[i_design] = lane;
    c->n_settled[i_design]++;
    return true;
}

static void step(void *solver)
{
    struct counts *c = solver;
    c->n_step++;
    ck_assert_int_eq(c->n_look, c->n_step);
}

/* rounds: of each design, [n_design]; NULL: one. */
static struct counts run(int n_design, const int *rounds)
{
    static const hf_lane_solver work = {load, look, settle, step};
    struct counts c = {.n_design = n_design};
    ck_assert_int_le(n_design, MAX_DESIGN);
    for (int i = 0; i < MAX_DESIGN; i++) {
        c.rounds_of[i] = rounds && i < n_design ? rounds[i] : 1;
        c.lane_of[i] = NONE;
    }
    for (int lane = 0; lane < HF_LANES; lane++)
        c.in_lane[lane] = NONE;
    hf_lane_schedule_run(&work, &c, next_design, &c);
    for (int i = 0; i < MAX_DESIGN; i++)
        ck_assert_int_eq(c.n_settled[i], i < n_design);
    ck_assert_int_eq(c.n_handed_out, n_design);
    ck_assert_int_eq(c.n_load, n_design ? HF_LANES + n_design : 0); /* each lane once before its first design */
    ck_assert_int_eq(c.n_asked_after_the_end, 1);                   /* no further design is asked for after -1 */
    return c;
}

/* Every design is settled exactly once, however many there are; run() asserts it. */
START_TEST(every_design_is_settled_once)
{
    int rounds[MAX_DESIGN];
    struct rng rng = rng_start(7);
    for (int i = 0; i < MAX_DESIGN; i++)
        rounds[i] = 1 + (int)rng_uniform(&rng, 0, 9);
    for (int n = 0; n <= MAX_DESIGN; n++)
        run(n, rounds);
}
END_TEST

START_TEST(no_design_needs_no_work)
{
    struct counts c = run(0, NULL);
    ck_assert_int_eq(c.n_look, 0);
    ck_assert_int_eq(c.n_step, 0);
}
END_TEST

START_TEST(fewer_designs_than_lanes_take_the_first_lanes)
{
    struct counts c = run(3, (int[]){2, 5, 1});
    for (int i = 0; i < 3; i++)
        ck_assert_int_eq(c.lane_of[i], i);
    ck_assert_int_eq(c.n_look, 5); /* the longest of them */
    ck_assert_int_eq(c.n_step, 4); /* no step after the last look */
}
END_TEST

/* Eight designs begin in the lanes of their numbers. Lane 2 is free after the first look, the lanes 0 and 5 after the
 * second: designs 8, 9 and 10 take them, in this order. */
START_TEST(a_free_lane_takes_the_next_design)
{
    struct counts c = run(11, (int[]){2, 9, 1, 9, 9, 2, 9, 9, 9, 1, 9});
    for (int i = 0; i < HF_LANES; i++)
        ck_assert_int_eq(c.lane_of[i], i);
    ck_assert_int_eq(c.lane_of[8], 2);
    ck_assert_int_eq(c.lane_of[9], 0);
    ck_assert_int_eq(c.lane_of[10], 5);
    ck_assert_int_eq(c.n_look, 11); /* design 10 begins at the third look and needs nine */
}
END_TEST

/* Designs that all end together: the lanes are filled again from lane 0 on. */
START_TEST(all_lanes_are_filled_again)
{
    struct counts c = run(2 * HF_LANES + 1, NULL);
    for (int i = 0; i < 2 * HF_LANES + 1; i++)
        ck_assert_int_eq(c.lane_of[i], i % HF_LANES);
    ck_assert_int_eq(c.n_look, 3);
}
END_TEST

Suite *suite_unit_lane_schedule(void)
{
    Suite *suite = suite_create("unit/lane_schedule");
    TCase *tests = tcase_create("lane_schedule");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, every_design_is_settled_once);
    tcase_add_test(tests, no_design_needs_no_work);
    tcase_add_test(tests, fewer_designs_than_lanes_take_the_first_lanes);
    tcase_add_test(tests, a_free_lane_takes_the_next_design);
    tcase_add_test(tests, all_lanes_are_filled_again);
    return suite;
}
