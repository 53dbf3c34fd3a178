/* Loops over threads: every item is done once, and every room (index of a thread) is used once, for any n_thread. */
#include "support.h"

#include "base/later.h"
#include "search/parallel.h"

#include <pthread.h>
#include <sched.h>
#include <string.h>

enum { N_ITEM = 300, MAX_THREAD = 4 };

/* ---- numbers and rooms ---- */

static struct counts {
    hf_parallel_queue queue;
    int n_taken[N_ITEM], n_room[MAX_THREAD];
    double sum;
} counts;

static void take_all(void *context, int room)
{
    struct counts *c = context;
    __atomic_add_fetch(&c->n_room[room], 1, __ATOMIC_SEQ_CST);
    for (int i = hf_parallel_take(&c->queue); i >= 0; i = hf_parallel_take(&c->queue)) {
        c->n_taken[i]++;
        hf_parallel_add(&c->sum, i);
    }
}

static void assert_all_taken(const struct counts *c, int n_thread)
{
    double sum = 0;
    for (int i = 0; i < N_ITEM; i++) {
        int wanted = !c->queue.wanted || c->queue.wanted[i];
        ck_assert_int_eq(c->n_taken[i], wanted);
        sum += wanted ? i : 0;
    }
    for (int room = 0; room < MAX_THREAD; room++)
        ck_assert_int_eq(c->n_room[room], room < n_thread);
    ck_assert_double_eq(c->sum, sum); /* whole numbers: exact in any order */
    ck_assert(hf_parallel_is_empty(&c->queue));
}

START_TEST(every_wanted_number_and_every_room_comes_once)
{
    unsigned char wanted[N_ITEM];
    for (int i = 0; i < N_ITEM; i++)
        wanted[i] = i % 3 != 1;
    for (int n_thread = 1; n_thread <= MAX_THREAD; n_thread++) {
        counts = (struct counts){.queue = {N_ITEM, 0, _i ? wanted : NULL}};
        ck_assert(!hf_parallel_is_empty(&counts.queue));
        hf_parallel_run(n_thread, take_all, &counts);
        assert_all_taken(&counts, n_thread);
    }
}
END_TEST

/* ---- runs inside a loop ---- */

static struct counts inner[8];

static void run_inner(void *context, int i)
{
    (void)context;
    inner[i] = (struct counts){.queue = {N_ITEM, 0, NULL}};
    hf_parallel_run(MAX_THREAD, take_all, &inner[i]);
}

START_TEST(runs_inside_a_loop_have_every_room_once)
{
    for (int n_thread = 1; n_thread <= MAX_THREAD; n_thread++) {
        hf_parallel_for(n_thread, 8, run_inner, NULL);
        for (int i = 0; i < 8; i++)
            assert_all_taken(&inner[i], MAX_THREAD);
        ck_assert(!hf_parallel_is_inside());
    }
}
END_TEST

/* ---- work left for later is done once, before the loop ends, or at once when the list is full ---- */

struct later {
    int n_done[N_ITEM], n_elsewhere; /* done by another thread than the one that left it */
    int n_here, waits_for_here;      /* the first one done elsewhere waits until the list is full: one is done here */
};

static struct later_item {
    struct later *l;
    int i;
    pthread_t from;
} later_item[N_ITEM];

static void do_item(void *context)
{
    struct later_item *item = context;
    struct later *l = item->l;
    bool is_here = pthread_equal(item->from, pthread_self());
    __atomic_add_fetch(is_here ? &l->n_here : &l->n_elsewhere, 1, __ATOMIC_SEQ_CST);
    while (!is_here && l->waits_for_here && !__atomic_load_n(&l->n_here, __ATOMIC_SEQ_CST))
        sched_yield();
    __atomic_add_fetch(&l->n_done[item->i], 1, __ATOMIC_SEQ_CST);
}

static void leave_for_later(void *context, int i)
{
    later_item[i] = (struct later_item){context, i, pthread_self()};
    hf_later_do(do_item, &later_item[i]);
}

START_TEST(what_is_left_for_later_is_done)
{
    for (int n_thread = 1; n_thread <= 3; n_thread++) {
        static struct later l;
        l = (struct later){.waits_for_here = _i};
        hf_parallel_for(n_thread, N_ITEM, leave_for_later, &l);
        for (int i = 0; i < N_ITEM; i++)
            ck_assert_int_eq(l.n_done[i], 1);
        ck_assert_int_gt(l.n_elsewhere, 0);
        ck_assert_int_ge(l.n_here, _i);
        leave_for_later(&l, 0); /* outside of a loop the work is done at once */
        ck_assert_int_eq(l.n_done[0], 2);
    }
}
END_TEST

Suite *suite_unit_parallel(void)
{
    Suite *suite = suite_create("unit/parallel");
    TCase *tests = tcase_create("parallel");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, every_wanted_number_and_every_room_comes_once, 0, 2);
    tcase_add_test(tests, runs_inside_a_loop_have_every_room_once);
    tcase_add_loop_test(tests, what_is_left_for_later_is_done, 0, 2);
    return suite;
}
