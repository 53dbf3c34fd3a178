/* Work for later: every item is done once, in order, by the serving thread, or at once when no thread serves. */
#include "support.h"

#include "base/later.h"

#include <pthread.h>
#include <semaphore.h>

enum { N_ITEM = 3 * HF_LATER_MAX };

static struct record {
    int n_done, order[N_ITEM + 1];
    pthread_t thread[N_ITEM];
    sem_t gate; /* the first item waits here, so that all others have to wait, too */
} record;

static struct item {
    int i, waits;
} item[N_ITEM];

static void do_item(void *context)
{
    const struct item *it = context;
    if (it->waits)
        while (sem_wait(&record.gate) != 0) {
        }
    record.thread[it->i] = pthread_self();
    record.order[__atomic_fetch_add(&record.n_done, 1, __ATOMIC_SEQ_CST)] = it->i;
}

static void begin(void)
{
    record.n_done = 0;
    ck_assert_int_eq(sem_init(&record.gate, 0, 0), 0);
    for (int i = 0; i < N_ITEM; i++)
        item[i] = (struct item){i, 0};
}

static void *serve(void *list)
{
    hf_later_serve(list);
    return NULL;
}

START_TEST(without_a_list_it_is_done_at_once)
{
    begin();
    for (int i = 0; i < N_ITEM; i++) {
        hf_later_do(do_item, &item[i]);
        ck_assert_int_eq(record.n_done, i + 1);
        ck_assert(pthread_equal(record.thread[i], pthread_self()));
    }
}
END_TEST

/* HF_LATER_MAX items can wait, and one more can be in the hands of the server; further items are done by the caller. */
START_TEST(items_wait_in_order_until_no_more_fit)
{
    hf_later_list list;
    pthread_t server;
    int n_here = 0, last = -1;
    begin();
    item[0].waits = 1;
    hf_later_open(1, &list);
    hf_later_join(&list);
    ck_assert_int_eq(pthread_create(&server, NULL, serve, &list), 0);
    for (int i = 0; i < N_ITEM; i++)
        hf_later_do(do_item, &item[i]);
    ck_assert_int_ge(record.n_done, N_ITEM - HF_LATER_MAX - 1);
    ck_assert_int_le(record.n_done, N_ITEM - HF_LATER_MAX);
    sem_post(&record.gate);
    hf_later_leave(&list);
    ck_assert_int_eq(pthread_join(server, NULL), 0);
    ck_assert_int_eq(record.n_done, N_ITEM);
    for (int k = 0; k < N_ITEM; k++) {
        int i = record.order[k];
        if (pthread_equal(record.thread[i], pthread_self())) {
            n_here++;
            continue;
        }
        ck_assert_int_gt(i, last);
        last = i;
    }
    ck_assert_int_ge(n_here, N_ITEM - HF_LATER_MAX - 1);
    hf_later_do(do_item, &(struct item){0, 0}); /* this thread has left the list */
    ck_assert(pthread_equal(record.thread[0], pthread_self()));
    hf_later_close(&list);
}
END_TEST

Suite *suite_unit_later(void)
{
    Suite *suite = suite_create("unit/later");
    TCase *tests = tcase_create("later");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, without_a_list_it_is_done_at_once);
    tcase_add_test(tests, items_wait_in_order_until_no_more_fit);
    return suite;
}
