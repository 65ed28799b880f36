// Unit tests of how a density enters: into cells that do not change unless the test does it.

#include "core/feed/density_entry.h"

#include "core/base/memory.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <string.h>

enum { N1 = 10, N2 = 4, KINDS = 2 };

typedef struct cells {
    double rho[N1 * N2];
    double factor;
    size_t off;          // the belt of places that are on none
    vec2 place[N1 * N2]; // where what a cell has got came in
    double of_kind[KINDS];
} cells;

static double density(const void *context, size_t cell)
{
    return ((const cells *)context)->rho[cell];
}

static double factor(const void *context, size_t belt)
{
    assert_true(belt == 0 || belt == ((const cells *)context)->off);
    return ((const cells *)context)->factor;
}

static void add(void *context, size_t cell, double amount, vec2 at, const double *fractions)
{
    cells *c = context;

    assert_true(amount > 0.0);
    c->place[cell] = at;
    c->rho[cell] += amount;
    for (size_t k = 0; fractions != NULL && k < KINDS; k++)
        c->of_kind[k] += amount * fractions[k];
}

static const double dt = 0.05;

// 1 m x 0.4 m in cells of 0.1 m, 100 parts in a packed one, on a belt of 0.5 m/s: a step of 0.05 s carries 0.25 of a cell.
// n feeds along the west side at `rate` parts/s.
static void make_scene(scene *s, size_t n_feeds, double rate)
{
    helper_scene_belt(s, 1.0, 0.4, 0.1, NULL, 0);
    s->macro.packing = 10000.0;
    helper_scene_add_belt(s, (vec2){ 0.5, 0.0 }, NULL, 0);
    s->n_feeds = n_feeds;
    s->feeds = memory_alloc(n_feeds, sizeof *s->feeds);
    assert_non_null(s->feeds);
    for (size_t k = 0; k < n_feeds; k++) {
        scene_feed_init(&s->feeds[k]);
        s->feeds[k].is_edge = true;
        s->feeds[k].edge = SCENE_WEST;
        s->feeds[k].demand = SCENE_DEMAND_RATE;
        s->feeds[k].rate = rate;
    }
}

static feed_density *make_density(scene *s, cells *c)
{
    feed_density *d = NULL;

    *c = (cells){ .factor = 1.0 };
    helper_scene_resolve(s);
    assert_int_equal(feed_density_create(s, dt, &d, NULL), BF_OK);
    return d;
}

static void advance(feed_density *d, double t, cells *c)
{
    const feed_field field = { c, density, factor, add };

    feed_density_advance(d, t, &field);
}

static void check_balance(const feed_density *d, size_t feed, double offered, double admitted,
                          double discarded)
{
    const feed_balance b = feed_density_balance(d, feed);

    assert_near(b.offered, offered, 1e-12 * offered);
    assert_near(b.admitted, admitted, 1e-8);
    assert_near(b.discarded, discarded, 1e-9);
    assert_near(b.waiting, offered - admitted - discarded, 1e-8);
}

// 40 parts are 0.1 in each of the four cells of the west side.
static void equal_cells_take_equal_amounts(void **state)
{
    cells c;
    scene s;
    make_scene(&s, 1, 800.0);
    feed_density *d = make_density(&s, &c);
    advance(d, 0.05, &c);
    for (size_t j = 0; j < N2; j++) {
        assert_near(c.rho[j * N1], 0.1, 1e-14);
        assert_near(c.place[j * N1].x, 0.0, 1e-15);
        assert_near(c.place[j * N1].y, 0.1 * (double)j + 0.05, 1e-15);
    }
    check_balance(d, 0, 40.0, 40.0, 0.0);
    assert_near(feed_density_offered(d, 0.1), 80.0, 1e-12);
    feed_density_destroy(d);
    scene_fini(&s);
}

// Rooms of 0.05, 0.2, 0.25 and 0.25 (the belt's), and a demand of 0.5: 0.05, then 0.15 for each of the others. With a
// demand of 0.68 the second one is full, too, and the last two take 0.215. All rooms are 0.75.
static void what_a_full_cell_cannot_take_goes_to_the_others(void **state)
{
    static const double demands[] = { 0.5, 0.68, 0.9 };
    static const double expected[][N2] = { { 0.15, 0.05, 0.15, 0.15 },
                                           { 0.2, 0.05, 0.215, 0.215 },
                                           { 0.2, 0.05, 0.25, 0.25 } };
    for (size_t k = 0; k < 3; k++) {
        cells c;
        scene s;
        double taken = 0.0;
        make_scene(&s, 1, 100.0 * demands[k] / dt);
        feed_density *d = make_density(&s, &c);
        c.rho[0] = 0.8;
        c.rho[1] = 1.0;
        c.rho[N1] = 0.95;
        c.rho[N1 + 1] = 1.5;
        c.rho[2 * N1] = 0.7;
        const cells before = c;
        advance(d, dt, &c);
        for (size_t j = 0; j < N2; j++) {
            assert_near(c.rho[j * N1] - before.rho[j * N1], expected[k][j], 1e-11);
            taken += expected[k][j];
        }
        check_balance(d, 0, 100.0 * demands[k], 100.0 * taken, 0.0);
        feed_density_destroy(d);
        scene_fini(&s);
    }
}

// The outer cell has room for 0.1 and the belt takes 0.25: the other 0.15 go behind it.
static void the_inner_cell_takes_what_the_outer_one_cannot(void **state)
{
    cells c;
    scene s;
    make_scene(&s, 1, 1e5);
    feed_density *d = make_density(&s, &c);
    for (size_t j = 0; j < N2; j++) {
        c.rho[j * N1] = 0.9;
        c.rho[j * N1 + 1] = 0.75;
    }
    advance(d, dt, &c);
    for (size_t j = 0; j < N2; j++) {
        assert_near(c.rho[j * N1], 1.0, 1e-11);
        assert_near(c.rho[j * N1 + 1], 0.9, 1e-11);
    }
    assert_true(c.rho[0] < 1.0);
    feed_density_destroy(d);
    scene_fini(&s);
}

// From y = 0.15 to 0.35 m: half a cell, a cell, half a cell. At half its speed the belt takes half as much.
static void a_part_of_a_side_takes_a_part_of_the_belt(void **state)
{
    cells c;
    scene s;
    make_scene(&s, 1, 1e5);
    s.feeds[0].line[0].y = 0.15;
    s.feeds[0].line[1].y = 0.35;
    feed_density *d = make_density(&s, &c);
    c.factor = 0.5;
    advance(d, dt, &c);
    assert_true(c.rho[0] == 0.0);
    assert_near(c.rho[N1], 0.0625, 1e-12);
    assert_near(c.rho[2 * N1], 0.125, 1e-12);
    assert_near(c.rho[3 * N1], 0.0625, 1e-12);
    feed_density_destroy(d);
    scene_fini(&s);
}

// Parts of 0.1 m in single file have their centres on 0.02 m about y = 0.2 m. They are carried from 0.15 to 0.25 m: half a cell twice.
static void parts_in_single_file_enter_as_wide_as_they_are(void **state)
{
    cells c;
    scene s;

    (void)state;
    make_scene(&s, 1, 1e5);
    s.cargo[0].shape.radius = 0.05;
    s.feeds[0].line[0].y = 0.19;
    s.feeds[0].line[1].y = 0.21;
    feed_density *d = make_density(&s, &c);
    advance(d, dt, &c);
    assert_near(c.rho[N1], 0.125, 1e-12);
    assert_near(c.rho[2 * N1], 0.125, 1e-12);
    assert_true(c.rho[0] == 0.0 && c.rho[3 * N1] == 0.0);
    feed_density_destroy(d);
    scene_fini(&s);
}

// Parts of 0.1 m would enter from 0.15 to 0.25 m. A guide at y = 0.22 m ends that, if it is there at t = 0.
static void what_is_wider_than_a_lane_does_not_enter_behind_its_guide(void **state)
{
    static const vec2 path[] = { { 0.0, 0.22 }, { 0.5, 0.22 } };
    for (int is_there = 0; is_there < 2; is_there++) {
        cells c;
        scene s;
        make_scene(&s, 1, 1e5);
        s.cargo[0].shape.radius = 0.05;
        s.feeds[0].line[0].y = 0.19;
        s.feeds[0].line[1].y = 0.21;
        scene_obstacle *guide = helper_scene_add_obstacle(&s, path, 2, SCENE_SEALED);
        guide->thickness = 1e-6;
        guide->presence =
            helper_scene_series(1, (double[]){ 0.0 }, (double[]){ is_there }, INFINITY);
        feed_density *d = make_density(&s, &c);
        advance(d, dt, &c);
        assert_near(c.rho[N1], 0.125, 1e-12);
        assert_near(c.rho[2 * N1], is_there ? 0.05 : 0.125, 1e-5);
        feed_density_destroy(d);
        scene_fini(&s);
    }
}

// Of a cell beside a side that has room for 0.1 the one behind takes what else the belt carries. The belt runs at 45
// degrees into the domain, 0.5 m/s across the side.
static void every_side_has_its_cells(void **state)
{
    static const struct {
        scene_side side;
        size_t outer, inner, n;
    } sides[] = { { SCENE_WEST, N1, N1 + 1, N2 },
                  { SCENE_EAST, 2 * N1 - 1, 2 * N1 - 2, N2 },
                  { SCENE_SOUTH, 3, N1 + 3, N1 },
                  { SCENE_NORTH, 3 * N1 + 3, 2 * N1 + 3, N1 } };
    for (size_t k = 0; k < 4; k++) {
        const bool is_low = sides[k].side == SCENE_WEST || sides[k].side == SCENE_SOUTH;
        cells c;
        scene s;
        make_scene(&s, 1, 1e5);
        s.belts[0].velocity.x = s.belts[0].velocity.y = is_low ? 0.5 : -0.5;
        s.feeds[0].edge = sides[k].side;
        feed_density *d = make_density(&s, &c);
        c.rho[sides[k].outer] = 0.9;
        advance(d, dt, &c);
        assert_near(c.rho[sides[k].outer], 1.0, 1e-11);
        assert_near(c.rho[sides[k].inner], 0.25 - 0.1, 1e-11);
        check_balance(d, 0, 1e5 * dt, 100.0 * 0.25 * (double)sides[k].n, 0.0);
        feed_density_destroy(d);
        scene_fini(&s);
    }
}

// A line inside is filled up at once, to the jam density with the congested closure: 0.1 m in one cell and 0.05 m in the
// next, so that 6 parts are 0.04 and 0.02.
static void a_line_inside_has_no_bound_but_its_room(void **state)
{
    cells c;
    scene s;
    make_scene(&s, 1, 6.0 / dt);
    s.feeds[0].is_edge = false;
    s.feeds[0].line[0] = (vec2){ 0.4, 0.25 };
    s.feeds[0].line[1] = (vec2){ 0.55, 0.25 };
    s.macro.closure = SCENE_CONGESTED;
    s.macro.jam_density = 0.93;
    feed_density *d = make_density(&s, &c);
    advance(d, dt, &c);
    assert_near(c.rho[2 * N1 + 4], 0.04, 1e-14);
    assert_near(c.rho[2 * N1 + 5], 0.02, 1e-14);
    assert_near(c.place[2 * N1 + 4].x, 0.45, 1e-15);
    assert_near(c.place[2 * N1 + 4].y, 0.25, 1e-15);
    advance(d, 1e3, &c);
    assert_near(c.rho[2 * N1 + 4], 0.93, 1e-14);
    assert_near(c.rho[2 * N1 + 5], 0.93, 1e-14);
    feed_density_destroy(d);
    scene_fini(&s);
}

// The last section of a path goes up from x = 0.5 to 0.6 m. Of a line from 0.53 to 0.63 m the cell beside it takes nothing, as
// it is on no belt: 5 parts are 0.05 of the other.
static void a_line_lets_in_on_every_section_of_a_path_and_nothing_beside_it(void **state)
{
    static const vec2 points[] = { { 0.0, 0.15 }, { 0.55, 0.15 }, { 0.55, 0.4 } };
    cells c;
    scene s;
    make_scene(&s, 1, 5.0 / dt);
    s.n_belts = 0;
    helper_scene_add_path(&s, 0.5, 0.1, 0.06, points, 3);
    s.cargo[0].shape.radius = 0.01;
    s.feeds[0].is_edge = false;
    s.feeds[0].line[0] = (vec2){ 0.53, 0.35 };
    s.feeds[0].line[1] = (vec2){ 0.63, 0.35 };
    feed_density *d = make_density(&s, &c);
    c.off = s.n_sections;
    advance(d, dt, &c);
    assert_near(c.rho[3 * N1 + 5], 0.05, 1e-14);
    assert_true(c.rho[3 * N1 + 6] == 0.0);
    feed_density_destroy(d);
    scene_fini(&s);
}

// Blocked for 2 s at 10 parts/s, then open: those that enter are 20 less 15 that had waited for 0.5 s.
static void waits_and_drops_follow_the_order_of_arrival(void **state)
{
    cells c;
    scene s;
    make_scene(&s, 1, 10.0);
    s.feeds[0].when_blocked = SCENE_BLOCKED_DISCARD;
    s.feeds[0].max_wait = 0.5;
    feed_density *d = make_density(&s, &c);
    for (size_t k = 0; k < N1 * N2; k++)
        c.rho[k] = 1.0;
    for (int k = 0; k <= 40; k++)
        advance(d, dt * k, &c);
    check_balance(d, 0, 20.0, 0.0, 15.0);
    memset(c.rho, 0, sizeof c.rho);
    feed_density_hold(d, 0, true);
    advance(d, 2.0, &c);
    check_balance(d, 0, 20.0, 0.0, 15.0);
    feed_density_hold(d, 0, false);
    advance(d, 2.0, &c);
    check_balance(d, 0, 20.0, 5.0, 15.0);
    assert_near(feed_density_admitted(d), 5.0, 1e-12);
    feed_density_destroy(d);
    scene_fini(&s);
}

// 10 parts/s arrive at 0.05, 0.15, ... s, of which 20 are due until 2 s and 15 until 1.5 s. Where something is
// commanded for a kind they are offered one by one, and a feed of two is exhausted by the second one.
static void parts_that_are_acted_on_are_offered_and_dropped_as_they_arrive(void **state)
{
    scene_action of_kind = { .kind = 0 };
    cells c;
    scene s;
    make_scene(&s, 1, 10.0);
    s.n_actions = 1;
    s.actions = &of_kind;
    feed_density *d = make_density(&s, &c);
    advance(d, 0.049, &c);
    check_balance(d, 0, 0.0, 0.0, 0.0);
    advance(d, 0.051, &c);
    check_balance(d, 0, 1.0, 1.0, 0.0);
    advance(d, 0.149, &c);
    check_balance(d, 0, 1.0, 1.0, 0.0);
    advance(d, 0.151, &c);
    check_balance(d, 0, 2.0, 2.0, 0.0);
    feed_density_destroy(d);

    s.feeds[0].when_blocked = SCENE_BLOCKED_DISCARD;
    s.feeds[0].max_wait = 0.5;
    d = make_density(&s, &c);
    feed_density_hold(d, 0, true);
    advance(d, 2.0, &c);
    check_balance(d, 0, 20.0, 0.0, 15.0);
    feed_density_destroy(d);

    s.feeds[0].count = 2.0;
    d = make_density(&s, &c);
    advance(d, 0.14, &c);
    assert_false(feed_density_is_exhausted(d));
    advance(d, 0.16, &c);
    assert_true(feed_density_is_exhausted(d));
    feed_density_destroy(d);
    s.n_actions = 0;
    s.actions = NULL;
    scene_fini(&s);
}

// Both want all of the room of the line that they share: who is first takes it.
static void feeds_in_the_same_cells_take_turns(void **state)
{
    cells c;
    scene s;
    make_scene(&s, 2, 1e5);
    for (size_t k = 0; k < 2; k++) {
        s.feeds[k].is_edge = false;
        s.feeds[k].line[0] = (vec2){ 0.55, 0.05 };
        s.feeds[k].line[1] = (vec2){ 0.55, 0.35 };
    }
    feed_density *d = make_density(&s, &c);
    for (int k = 1; k <= 10; k++) {
        memset(c.rho, 0, sizeof c.rho);
        advance(d, dt * k, &c);
    }
    check_balance(d, 0, 1e5 * 10.0 * dt, 5.0 * 400.0, 0.0);
    check_balance(d, 1, 1e5 * 10.0 * dt, 5.0 * 400.0, 0.0);
    feed_density_destroy(d);
    scene_fini(&s);
}

static void out_of_memory_anywhere_is_an_error(void **state)
{
    bf_status status = BF_ENOMEM;
    feed_density *d = NULL;
    scene s;
    make_scene(&s, 2, 1.0);
    helper_scene_resolve(&s);
    for (size_t n = 1; status != BF_OK; n++) {
        memory_plan_fault(n, 0);
        status = feed_density_create(&s, dt, &d, NULL);
        memory_plan_fault(0, 0);
        assert_true(status == BF_OK || (status == BF_ENOMEM && d == NULL));
    }
    feed_density_destroy(d);
    scene_fini(&s);
}

// Parts 1 to 4 of kinds 0, 1, 1, 0 come at 1 to 4 s; of the 5th, at 5 s, the first half enters. With a bound of the belt of 4 times 0.25
// of a cell of 100 parts a part enters in one step.
static void what_enters_is_of_the_kinds_of_the_parts_in_their_order(void **state)
{
    static uint32_t kinds[] = { 0, 1, 1, 0, 1 };
    static double times[] = { 1.0, 2.0, 3.0, 4.0, 5.0 };
    static const double expected[][2] = {
        { 1.0, 0.0 }, { 1.0, 1.0 }, { 1.0, 2.0 }, { 2.0, 2.0 }, { 2.0, 2.5 }
    };
    scene s;
    cells c = { .factor = 1.0 };

    make_scene(&s, 1, 1.0);
    helper_scene_resolve(&s);
    s.n_cargo = 2;
    scene_action of_kind = { .kind = 1 };
    s.n_actions = 1;
    s.actions = &of_kind;
    s.feeds[0].demand = SCENE_DEMAND_SCHEDULE;
    s.feeds[0].schedule = (scene_arrival_list){ .n = 5, .times = times, .kinds = kinds };
    feed_density *d = NULL;
    assert_int_equal(feed_density_create(&s, dt, &d, NULL), BF_OK);
    for (size_t k = 0; k < 5; k++) {
        if (k == 4) // one cell that has room for half a part
            for (size_t cell = 0; cell < N1 * N2; cell++)
                c.rho[cell] = cell == 0 ? 0.995 : 1.0;
        advance(d, 1.0 + (double)k, &c);
        for (size_t kind = 0; kind < KINDS; kind++)
            assert_near(c.of_kind[kind] * 100.0, expected[k][kind], 1e-9);
    }
    feed_density_destroy(d);
    s.n_actions = 0;
    s.actions = NULL;
    s.feeds[0].schedule = (scene_arrival_list){ .n = 0 };
    scene_fini(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(equal_cells_take_equal_amounts),
        cmocka_unit_test(what_a_full_cell_cannot_take_goes_to_the_others),
        cmocka_unit_test(the_inner_cell_takes_what_the_outer_one_cannot),
        cmocka_unit_test(a_part_of_a_side_takes_a_part_of_the_belt),
        cmocka_unit_test(parts_in_single_file_enter_as_wide_as_they_are),
        cmocka_unit_test(what_is_wider_than_a_lane_does_not_enter_behind_its_guide),
        cmocka_unit_test(every_side_has_its_cells),
        cmocka_unit_test(a_line_inside_has_no_bound_but_its_room),
        cmocka_unit_test(a_line_lets_in_on_every_section_of_a_path_and_nothing_beside_it),
        cmocka_unit_test(waits_and_drops_follow_the_order_of_arrival),
        cmocka_unit_test(parts_that_are_acted_on_are_offered_and_dropped_as_they_arrive),
        cmocka_unit_test(feeds_in_the_same_cells_take_turns),
        cmocka_unit_test(what_enters_is_of_the_kinds_of_the_parts_in_their_order),
        cmocka_unit_test(out_of_memory_anywhere_is_an_error),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
