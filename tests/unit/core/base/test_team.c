// Unit tests of parallel loops.

#include "core/base/team.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>

#include <cmocka.h>
#include <string.h>

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

    (void)state;
    for (size_t t = 0; t < sizeof n_threads / sizeof *n_threads; t++) {
        for (size_t k = 0; k < sizeof n_items / sizeof *n_items; k++) {
            int counts[ITEMS_MAX] = { 0 };
            team_for(n_threads[t], n_items[k], count_item, counts);
            for (size_t m = 0; m < ITEMS_MAX; m++)
                assert_int_equal(counts[m], m < n_items[k]);
        }
    }
}

enum { ROUNDS = 300, MEMBERS_MAX = 16 };

// What each member of a team wrote in a round, in turns.
typedef struct meeting {
    long written[2][MEMBERS_MAX];
    int n_members;
    int n_wrong[MEMBERS_MAX];
} meeting;

// Between two rounds each member sees what all others wrote in the one before.
static void meet(void *context, int member, int n_members, team_gate *gate)
{
    meeting *m = context;

    for (long round = 0; round < ROUNDS; round++) {
        m->written[round % 2][member] = 1000 * round + member;
        team_wait(gate);
        for (int k = 0; k < n_members; k++)
            m->n_wrong[member] += m->written[round % 2][k] != 1000 * round + k;
    }
    if (member == 0)
        m->n_members = n_members;
}

static void members_of_a_team_wait_for_each_other(void **state)
{
    static const int n_threads[] = { -1, 0, 1, 2, 3, 5 };

    (void)state;
    for (size_t t = 0; t < sizeof n_threads / sizeof *n_threads; t++) {
        meeting m = { 0 };
        team_run(n_threads[t], meet, &m);
        assert_in_range(m.n_members, 1, n_threads[t] > 1 ? n_threads[t] : 1);
        for (int k = 0; k < MEMBERS_MAX; k++)
            assert_int_equal(m.n_wrong[k], 0);
        for (int k = 0; k < m.n_members; k++)
            assert_int_equal(m.written[(ROUNDS - 1) % 2][k], 1000 * (ROUNDS - 1) + k);
    }
}

static void there_is_at_least_one_processor(void **state)
{
    (void)state;
    assert_true(team_processors() >= 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_item_is_done_once_for_any_number_of_threads),
        cmocka_unit_test(members_of_a_team_wait_for_each_other),
        cmocka_unit_test(there_is_at_least_one_processor),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
