// The list of neighbours against all pairs.

#include "core/base/memory.h"
#include "core/base/random.h"
#include "core/micro/neighbours.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <string.h>

enum { PARTS = 300 };

typedef struct crowd {
    double x[PARTS], y[PARTS], radius[PARTS];
    uint8_t is_gone[PARTS];
} crowd;

static void scatter(crowd *c, uint64_t seed, double extent)
{
    bf_random random;

    random_init(&random, seed);
    for (int k = 0; k < PARTS; k++) {
        c->x[k] = extent * (random_unit(&random) - 0.5);
        c->y[k] = extent * (random_unit(&random) - 0.5);
        c->radius[k] = 0.005 + 0.02 * random_unit(&random);
        c->is_gone[k] = random_unit(&random) < 0.1;
    }
}

static neighbours_parts parts_of(const crowd *c)
{
    return (neighbours_parts){
        .x = c->x, .y = c->y, .stride = 1, .radius = c->radius, .radius_stride = 1
    };
}

static void build(neighbours_list *p, const crowd *c, const uint8_t *is_gone)
{
    assert_int_equal(neighbours_build(p, PARTS, parts_of(c), is_gone, NULL), BF_OK);
}

static void check_part(const neighbours_list *p, const crowd *c, const uint8_t *is_gone, uint32_t k)
{
    uint32_t at = p->start[k];

    for (uint32_t m = 0; m < PARTS; m++) {
        double range = c->radius[k] + c->radius[m] + p->skin;
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
    neighbours_list p = { .skin = 0.003 };
    crowd c;

    for (uint64_t seed = 0; seed < 24; seed++) {
        const uint8_t *is_gone = seed % 3 != 0 ? c.is_gone : NULL;
        scatter(&c, seed, extents[seed % 4]);
        build(&p, &c, is_gone);
        for (uint32_t k = 0; k < PARTS; k++)
            check_part(&p, &c, is_gone, k);
    }
    assert_int_equal(p.n_builds, 24);
    neighbours_fini(&p);
}

// Two parts that approach each other by half the skin each.
static void the_list_holds_until_a_part_has_moved_by_half_the_skin(void **state)
{
    assert_true(neighbours_holds(0.004, 0.0));
    assert_true(neighbours_holds(0.004, 0.0019));
    assert_true(neighbours_holds(0.004, 0.002));
    assert_false(neighbours_holds(0.004, 0.0021));
    assert_false(neighbours_holds(0.004, NAN));
}

static void the_list_knows_where_parts_were(void **state)
{
    neighbours_list p = { .skin = 0.004 };
    crowd c;

    scatter(&c, 7, 1.0);
    build(&p, &c, NULL);
    assert_memory_equal(p.x_built, c.x, sizeof c.x);
    assert_memory_equal(p.y_built, c.y, sizeof c.y);
    neighbours_fini(&p);
}

// Parts that stand in a table of rows, as disks do, with ids in falling order, are found in that order.
static void neighbours_stand_in_the_order_of_their_ids(void **state)
{
    neighbours_list p = { .skin = 0.003 };
    uint32_t ids[PARTS], found[2 * PARTS];
    crowd c;

    scatter(&c, 3, 0.3);
    build(&p, &c, NULL);
    for (uint32_t k = 0; k < PARTS; k++)
        ids[k] = PARTS - k;
    neighbours_parts parts = parts_of(&c);
    parts.id = ids;
    parts.order = p.cells.order;
    for (uint32_t k = 0; k < PARTS; k++) {
        const uint32_t start = p.start[k], n = p.start[k + 1] - start;
        assert_int_equal(neighbours_find(&p.cells, &parts, p.skin, k, found, 2, PARTS), n);
        for (uint32_t m = 0; m < n; m++)
            assert_int_equal(found[2 * m], p.neighbour[start + n - 1 - m]);
        if (n > 0)
            assert_true(neighbours_find(&p.cells, &parts, p.skin, k, found, 2, n - 1) == SIZE_MAX);
    }
    neighbours_fini(&p);
}

// Parts that enter: lists of more parts and of fewer.
static void the_number_of_parts_may_change(void **state)
{
    neighbours_list p = { .skin = 0.003 };
    const size_t counts[] = { 100, PARTS, 50, PARTS };
    crowd c;

    scatter(&c, 5, 0.3);
    for (size_t m = 0; m < 4; m++) {
        assert_int_equal(neighbours_build(&p, counts[m], parts_of(&c), NULL, NULL), BF_OK);
        for (size_t at = 0; at < p.start[counts[m]]; at++)
            assert_true(p.neighbour[at] < counts[m]);
    }
    for (uint32_t k = 0; k < PARTS; k++)
        check_part(&p, &c, NULL, k);
    neighbours_fini(&p);
}

static void no_parts_have_no_neighbours(void **state)
{
    neighbours_list p = { .skin = 0.004 };

    assert_int_equal(neighbours_build(&p, 0, (neighbours_parts){ .stride = 1 }, NULL, NULL), BF_OK);
    assert_int_equal(p.start[0], 0);
    neighbours_fini(&p);
    neighbours_fini(NULL);
}

static void without_memory_a_build_fails_and_the_next_is_right(void **state)
{
    crowd c;
    size_t n_failed = 0;

    scatter(&c, 11, 0.5);
    for (size_t fault = 1;; fault++) {
        neighbours_list p = { .skin = 0.003 };
        memory_plan_fault(fault, 0);
        bf_status status = neighbours_build(&p, PARTS, parts_of(&c), NULL, NULL);
        memory_plan_fault(0, 0);
        assert_true(status == BF_OK || status == BF_ENOMEM);
        n_failed += status == BF_ENOMEM;
        build(&p, &c, NULL);
        for (uint32_t k = 0; k < PARTS; k++)
            check_part(&p, &c, NULL, k);
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
        cmocka_unit_test(the_list_holds_until_a_part_has_moved_by_half_the_skin),
        cmocka_unit_test(the_list_knows_where_parts_were),
        cmocka_unit_test(neighbours_stand_in_the_order_of_their_ids),
        cmocka_unit_test(the_number_of_parts_may_change),
        cmocka_unit_test(no_parts_have_no_neighbours),
        cmocka_unit_test(without_memory_a_build_fails_and_the_next_is_right),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
