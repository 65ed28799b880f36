// Unit tests of parallel loops and teams of threads.

#include "core/base/team.h"
#include "tests/unit/helper_cmocka.h"

#include <pthread.h>
#include <stdatomic.h>
#include <time.h>

enum { ITEMS_MAX = 1000 };

static void count_item(void *context, size_t item)
{
    int *counts = context;
    counts[item]++;
}

static void every_item_is_done_once_for_any_number_of_threads(void **state)
{
    static const int n_threads[] = { -1, 0, 1, 2, 3, 7, 16 };
    static const size_t n_items[] = { 0, 1, 2, 5, ITEMS_MAX - 1 };

    for (size_t t = 0; t < sizeof n_threads / sizeof *n_threads; t++) {
        for (size_t k = 0; k < sizeof n_items / sizeof *n_items; k++) {
            int counts[ITEMS_MAX] = { 0 };
            team_for(n_threads[t], n_items[k], count_item, counts);
            for (size_t m = 0; m < ITEMS_MAX; m++)
                assert_int_equal(counts[m], m < n_items[k]);
        }
    }
}

enum { ROUNDS = 100, MEMBERS_MAX = 16 };

// What each member of a team wrote in a round, in turns.
typedef struct meeting {
    long written[2][MEMBERS_MAX];
    int n_members;
    int n_wrong[MEMBERS_MAX];
} meeting;

// Between two rounds each member sees what all others wrote in the one before.
static void meet(void *context, int member, int n_members, team_barrier *barrier)
{
    meeting *m = context;

    for (long round = 0; round < ROUNDS; round++) {
        m->written[round % 2][member] = 1000 * round + member;
        team_barrier_wait(barrier);
        for (int k = 0; k < n_members; k++)
            m->n_wrong[member] += m->written[round % 2][k] != 1000 * round + k;
    }
    if (member == 0)
        m->n_members = n_members;
}

static void threads_of_a_team_wait_for_each_other(void **state)
{
    static const int n_threads[] = { -1, 0, 1, 2, 3, 5 };

    for (size_t t = 0; t < sizeof n_threads / sizeof *n_threads; t++) {
        meeting m = { 0 };
        team_run(n_threads[t], meet, &m);
        assert_int_equal(m.n_members, n_threads[t] > 1 ? n_threads[t] : 1);
        for (int k = 0; k < MEMBERS_MAX; k++)
            assert_int_equal(m.n_wrong[k], 0);
        for (int k = 0; k < m.n_members; k++)
            assert_int_equal(m.written[(ROUNDS - 1) % 2][k], 1000 * (ROUNDS - 1) + k);
    }
}

// One member comes so late to each round that the other sleeps.
static void meet_late(void *context, int member, int n_members, team_barrier *barrier)
{
    const struct timespec late = { .tv_nsec = 20000000 };
    int *n_rounds = context;

    for (int round = 0; round < 5; round++) {
        if (member == round % 2)
            (void)nanosleep(&late, NULL);
        team_barrier_wait(barrier);
        n_rounds[member]++;
    }
}

static void a_thread_that_waits_long_is_woken(void **state)
{
    int n_rounds[2] = { 0 };

    team_run(2, meet_late, n_rounds);
    assert_int_equal(n_rounds[0], 5);
    assert_int_equal(n_rounds[1], 5);
}

enum { OUTER = 3, INNER = 3, CALLS = 40 };

static void count_in_own_loop(void *context, size_t item)
{
    int(*counts)[ITEMS_MAX] = context;

    team_for(INNER, ITEMS_MAX, count_item, counts[item]);
}

static void loops_on_threads_may_be_nested(void **state)
{
    static int counts[OUTER][ITEMS_MAX];

    team_for(OUTER, OUTER, count_in_own_loop, counts);
    for (size_t k = 0; k < OUTER; k++)
        for (size_t m = 0; m < ITEMS_MAX; m++)
            assert_int_equal(counts[k][m], 1);
}

// What a thread of its own does: teams one after the other, each with its barrier.
static void *meet_often(void *context)
{
    for (int k = 0; k < 2; k++)
        team_run(INNER, meet, context);
    return NULL;
}

static void threads_of_one_process_may_have_teams_at_the_same_time(void **state)
{
    meeting meetings[OUTER] = { 0 };
    pthread_t threads[OUTER];

    for (int k = 0; k < OUTER; k++)
        assert_int_equal(pthread_create(&threads[k], NULL, meet_often, &meetings[k]), 0);
    for (int k = 0; k < OUTER; k++)
        assert_int_equal(pthread_join(threads[k], NULL), 0);
    for (int k = 0; k < OUTER; k++) {
        assert_int_equal(meetings[k].n_members, INNER);
        for (int m = 0; m < MEMBERS_MAX; m++)
            assert_int_equal(meetings[k].n_wrong[m], 0);
    }
}

static void sleep_ms(int ms)
{
    const struct timespec time = { .tv_nsec = 1000000L * ms };

    nanosleep(&time, NULL);
}

static void nap(void *context, int member, int n_members, team_barrier *barrier)
{
    atomic_int *n_naps = context;

    (void)barrier;
    // Members finish milliseconds apart, so that workers and callers sleep and are woken.
    sleep_ms(member);
    atomic_fetch_add(n_naps, 1);
}

static void threads_that_sleep_are_woken(void **state)
{
    atomic_int n_naps = 0;

    for (int k = 0; k < CALLS; k++) {
        team_run(INNER, nap, &n_naps);
        sleep_ms(2 * (k % 2));
    }
    assert_int_equal(n_naps, CALLS * INNER);
}

static void there_is_at_least_one_processor(void **state)
{
    assert_true(team_processors() >= 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_item_is_done_once_for_any_number_of_threads),
        cmocka_unit_test(threads_of_a_team_wait_for_each_other),
        cmocka_unit_test(a_thread_that_waits_long_is_woken),
        cmocka_unit_test(loops_on_threads_may_be_nested),
        cmocka_unit_test(threads_of_one_process_may_have_teams_at_the_same_time),
        cmocka_unit_test(threads_that_sleep_are_woken),
        cmocka_unit_test(there_is_at_least_one_processor),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
