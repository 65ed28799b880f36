// The list of neighbours against all pairs.

#include "core/base/memory.h"
#include "core/base/random.h"
#include "core/micro/neighbours.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

enum { PARTS = 300 };

typedef struct crowd {
    double x[PARTS], y[PARTS], reach[PARTS];
    uint8_t is_gone[PARTS];
} crowd;

static void scatter(crowd *c, uint64_t seed, double extent)
{
    bf_random random;

    random_init(&random, seed);
    for (int k = 0; k < PARTS; k++) {
        c->x[k] = extent * (random_unit(&random) - 0.5);
        c->y[k] = extent * (random_unit(&random) - 0.5);
        c->reach[k] = 0.005 + 0.02 * random_unit(&random);
        c->is_gone[k] = random_unit(&random) < 0.1;
    }
}

static void build(pairs *p, const crowd *c, const double *reach, const uint8_t *is_gone)
{
    assert_int_equal(neighbours_build(p, PARTS, c->x, c->y, reach, 0.012, is_gone, NULL), BF_OK);
}

static void check_part(const pairs *p, const crowd *c, const double *reach, const uint8_t *is_gone,
                       uint32_t k)
{
    uint32_t at = p->start[k];

    for (uint32_t m = 0; m < PARTS; m++) {
        double range = (reach != NULL ? reach[k] + reach[m] : 0.024) + p->skin;
        double dx = c->x[k] - c->x[m], dy = c->y[k] - c->y[m];
        if (m == k || (is_gone != NULL && (is_gone[k] || is_gone[m])) ||
            dx * dx + dy * dy >= range * range)
            continue;
        assert_true(at < p->start[k + 1]);
        assert_int_equal(p->neighbour[at++], m);
    }
    assert_int_equal(at, p->start[k + 1]);
}

static void the_list_is_that_of_all_pairs(void **state)
{
    const double extents[] = { 0.0, 0.3, 1.0, 50.0 };
    pairs p = { .skin = 0.003 };
    crowd c;

    (void)state;
    for (uint64_t seed = 0; seed < 24; seed++) {
        const double *reach = seed % 2 != 0 ? c.reach : NULL;
        const uint8_t *is_gone = seed % 3 != 0 ? c.is_gone : NULL;
        scatter(&c, seed, extents[seed % 4]);
        build(&p, &c, reach, is_gone);
        for (uint32_t k = 0; k < PARTS; k++)
            check_part(&p, &c, reach, is_gone, k);
    }
    assert_int_equal(p.n_builds, 24);
    neighbours_fini(&p);
}

static void the_list_is_stale_once_a_part_has_moved_by_half_the_skin(void **state)
{
    pairs p = { .skin = 0.004 };
    crowd c;

    (void)state;
    scatter(&c, 7, 1.0);
    c.is_gone[5] = c.is_gone[6] = 0;
    build(&p, &c, NULL, c.is_gone);
    assert_false(neighbours_are_stale(&p, c.x, c.y, c.is_gone));
    c.x[5] += 0.0019;
    assert_false(neighbours_are_stale(&p, c.x, c.y, c.is_gone));
    c.y[5] -= 0.0019;
    assert_true(neighbours_are_stale(&p, c.x, c.y, c.is_gone));
    c.is_gone[5] = 1;
    assert_false(neighbours_are_stale(&p, c.x, c.y, c.is_gone));
    c.x[6] = NAN;
    assert_true(neighbours_are_stale(&p, c.x, c.y, c.is_gone));
    neighbours_fini(&p);
}

static void no_parts_have_no_neighbours(void **state)
{
    pairs p = { .skin = 0.004 };

    (void)state;
    assert_int_equal(neighbours_build(&p, 0, NULL, NULL, NULL, 0.012, NULL, NULL), BF_OK);
    assert_int_equal(p.start[0], 0);
    assert_false(neighbours_are_stale(&p, NULL, NULL, NULL));
    neighbours_fini(&p);
    neighbours_fini(NULL);
}

static void without_memory_a_build_fails_and_the_next_is_right(void **state)
{
    crowd c;
    size_t n_failed = 0;

    (void)state;
    scatter(&c, 11, 0.5);
    for (size_t fault = 1;; fault++) {
        pairs p = { .skin = 0.003 };
        memory_plan_fault(fault, 0);
        bf_status status = neighbours_build(&p, PARTS, c.x, c.y, NULL, 0.012, NULL, NULL);
        memory_plan_fault(0, 0);
        assert_true(status == BF_OK || status == BF_ENOMEM);
        n_failed += status == BF_ENOMEM;
        build(&p, &c, NULL, NULL);
        for (uint32_t k = 0; k < PARTS; k++)
            check_part(&p, &c, NULL, NULL, k);
        neighbours_fini(&p);
        if (status == BF_OK)
            break;
    }
    assert_true(n_failed > 4);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_list_is_that_of_all_pairs),
        cmocka_unit_test(the_list_is_stale_once_a_part_has_moved_by_half_the_skin),
        cmocka_unit_test(no_parts_have_no_neighbours),
        cmocka_unit_test(without_memory_a_build_fails_and_the_next_is_right),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
