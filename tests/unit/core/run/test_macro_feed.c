// Unit tests of feeds in the macroscopic model, from the scenario to the density.

#include "core/base/memory.h"
#include "core/run/run_priv.h"
#include "tests/unit/core/helper_backend.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/core/helper_world.h"
#include "tests/unit/helper_amount.h"
#include "tests/unit/helper_cmocka.h"

#include <string.h>

// A belt of 0.4 m/s, 0.4 m x 0.2 m in cells of 1 cm, packed with 1000 parts/m2, with a feed along the west side at a
// rate in parts/s: it carries 80 parts/s at most, or 0.93 of it with the congested closure.
static void make_scene(scene *s, scene_closure closure, scene_scheme scheme, double rate)
{
    helper_scene_belt(s, 0.4, 0.2, 0.01, NULL, 0);
    s->initial.type = SCENE_INITIAL_EMPTY;
    s->macro.packing = 1000.0;
    s->macro.closure = closure;
    s->macro.scheme = scheme;
    s->macro.step = 0.0;
    helper_scene_add_belt(s, (vec2){ 0.4, 0.0 }, NULL, 0);
    helper_scene_add_feed(s, SCENE_WEST, SCENE_ARRIVALS_REGULAR, rate);
}

// A column of cells at the outlet, and one in the middle.
static void add_counters(scene *s)
{
    s->n_counters = 2;
    s->counters = memory_alloc(2, sizeof *s->counters);
    assert_non_null(s->counters);
    for (size_t k = 0; k < 2; k++)
        scene_counter_init(&s->counters[k]);
    s->counters[0].rect = (scene_rect){ 0.39, 0.4, 0.0, 0.2 };
    s->counters[1].rect = (scene_rect){ 0.2, 0.21, 0.0, 0.2 };
}

static void *make_run(scene *s, int n_threads, double *ret_dt)
{
    run_plan plan;
    void *solver = NULL;

    helper_scene_resolve(s);
    bf_world *w = helper_world(s->n_belts, s->belts, s->n_obstacles, s->obstacles);
    assert_int_equal(run__macro.create(s, w, n_threads, &solver, &plan, NULL), BF_OK);
    *ret_dt = plan.dt;
    return solver;
}

static void step(void *solver, size_t n)
{
    for (size_t k = 0; k < n; k++) {
        assert_int_equal(run__macro.admit(solver, NULL, NULL), BF_OK);
        assert_int_equal(run__macro.advance(solver, 1, NULL), BF_OK);
    }
}

static void check_balance(const feed_balance *b)
{
    assert_near(b->admitted + b->waiting + b->discarded, b->offered, 1e-9 * (b->offered + 1.0));
}

static const struct {
    scene_closure closure;
    scene_scheme scheme;
} solvers[] = { { SCENE_DISPERSIVE, SCENE_SCHEME_ROE },
                { SCENE_DISPERSIVE, SCENE_SCHEME_MUSCL },
                { SCENE_CONGESTED, SCENE_SCHEME_ROE },
                { SCENE_CONGESTED, SCENE_SCHEME_MUSCL } };
enum { N_SOLVERS = 4 };

// 30 parts/s at 0.4 m/s are 75 parts/m, 0.75 in a column of 1 cm. What left is summed up from the outlet's column: by
// the scheme roe the flux there is its density times 0.4 m/s.
static void a_fed_belt_carries_the_rate(void **state)
{
    for (size_t k = 0; k < N_SOLVERS; k++) {
        double dt, columns[2], left = 0.0;
        scene s;
        make_scene(&s, solvers[k].closure, solvers[k].scheme, 30.0);
        add_counters(&s);
        void *run = make_run(&s, 1, &dt);
        const size_t n = (size_t)(3.0 / dt);
        for (size_t i = 0; i < n; i++) {
            assert_int_equal(run__macro.admit(run, NULL, NULL), BF_OK);
            run__macro.count(run, columns);
            left += columns[0] / 0.01 * 0.4 * dt;
            assert_int_equal(run__macro.advance(run, 1, NULL), BF_OK);
        }
        run__macro.count(run, columns);
        const feed_balance b = run__macro.balance(run, 0);
        const run_load load = run__macro.measure(run);
        check_balance(&b);
        assert_near(b.offered, 30.0 * (double)(n - 1) * dt, 1e-9);
        assert_near(b.waiting, 0.0, 1e-9);
        assert_near(columns[1], 0.75, 1e-6);
        assert_true(load.entered == b.admitted);
        if (solvers[k].scheme == SCENE_SCHEME_ROE)
            assert_near(left + load.parts, b.admitted, 1e-9 * b.admitted);
        run__macro.destroy(run);
        scene_fini(&s);
    }
}

// Far more than the belt carries: it enters at the belt's capacity, 0.4 m/s x 0.2 m x 1000 x rho_p, and the rest waits.
static void a_saturated_inlet_admits_the_capacity(void **state)
{
    for (size_t k = 0; k < N_SOLVERS; k++) {
        const double packed = solvers[k].closure == SCENE_CONGESTED ? 0.93 : 1.0;
        double dt;
        scene s;
        make_scene(&s, solvers[k].closure, solvers[k].scheme, 1000.0);
        void *run = make_run(&s, 1, &dt);
        const size_t n = (size_t)(2.0 / dt);
        step(run, n);
        const double before = run__macro.balance(run, 0).admitted;
        step(run, n);
        const feed_balance b = run__macro.balance(run, 0);
        check_balance(&b);
        assert_near((b.admitted - before) / ((double)n * dt), 80.0 * packed, 1e-6);
        assert_true(run__macro.measure(run).peak <= packed);
        run__macro.destroy(run);
        scene_fini(&s);
    }
}

// A wall at the outlet: everything that enters stays, and the inlet is blocked. The congested closure packs to 0.93,
// where 80 cells' worth of 1000 parts/m2 are 74.4 parts, and is exact within 2 %; the dispersive one compresses
// cargo that has no way out, so the rate only falls.
static void nothing_is_lost_behind_a_closed_outlet(void **state)
{
    for (size_t k = 0; k < N_SOLVERS; k++) {
        double dt, before = 0.0;
        scene s;
        make_scene(&s, solvers[k].closure, solvers[k].scheme, 60.0);
        s.edges[SCENE_EAST] = SCENE_EDGE_WALL;
        void *run = make_run(&s, 1, &dt);
        const size_t n = (size_t)(0.25 / dt);
        for (int i = 0; i < 40; i++) {
            before = run__macro.balance(run, 0).admitted;
            step(run, n);
            const feed_balance b = run__macro.balance(run, 0);
            check_balance(&b);
            assert_near(run__macro.measure(run).parts, b.admitted, 1e-9 * b.admitted);
        }
        const feed_balance b = run__macro.balance(run, 0);
        if (solvers[k].closure == SCENE_CONGESTED) {
            assert_near(b.admitted, 74.4, 0.02 * 74.4);
            assert_near(b.admitted, before, 1e-9);
            assert_true(run__macro.measure(run).peak < 1.02 * 0.93);
        } else {
            assert_true(b.admitted - before < 0.25 * 60.0 * (double)n * dt);
        }
        assert_true(b.waiting > 0.5 * b.offered);
        run__macro.destroy(run);
        scene_fini(&s);
    }
}

// From a line inside cargo goes with the belt, and nothing enters where the belt stands and the line is packed.
static void a_line_inside_fills_the_cells_it_crosses(void **state)
{
    double dt, columns[2];
    scene s;
    make_scene(&s, SCENE_DISPERSIVE, SCENE_SCHEME_ROE, 500.0);
    add_counters(&s);
    s.feeds[0].is_edge = false;
    s.feeds[0].line[0] = (vec2){ 0.205, 0.05 };
    s.feeds[0].line[1] = (vec2){ 0.205, 0.15 };
    helper_scene_schedule(s.belts, 2, (double[]){ 0.0, 1.0 }, (double[]){ 0.0, 1.0 });
    void *run = make_run(&s, 1, &dt);
    step(run, (size_t)(0.9 / dt));
    run__macro.count(run, columns);
    // Ten cells of 1 cm x 1 cm.
    assert_near(columns[1], 1.0, 1e-9);
    assert_near(run__macro.measure(run).parts, 1.0, 1e-9);
    // From 1 s on the belt takes 40 parts/s from the line, and until 1.1 s nothing has reached the outlet.
    step(run, (size_t)(0.2 / dt));
    assert_near(run__macro.measure(run).parts, run__macro.balance(run, 0).admitted, 1e-9);
    assert_near(run__macro.balance(run, 0).admitted, 1.0 + 40.0 * 0.1, 0.25);
    run__macro.destroy(run);
    scene_fini(&s);
}

// Nothing waits longer than 0.5 s: so when the line is held for 2 s at 30 parts/s, 15 parts wait and 45 are dropped.
static void a_held_feed_goes_on_to_be_offered(void **state)
{
    double dt;
    scene s;
    make_scene(&s, SCENE_CONGESTED, SCENE_SCHEME_ROE, 30.0);
    s.feeds[0].when_blocked = SCENE_BLOCKED_DISCARD;
    s.feeds[0].max_wait = 0.5;
    void *run = make_run(&s, 1, &dt);
    run__macro.hold(run, 0, true);
    step(run, (size_t)(2.0 / dt) + 1);
    const feed_balance b = run__macro.balance(run, 0);
    check_balance(&b);
    assert_true(b.admitted == 0.0 && run__macro.measure(run).parts == 0.0);
    assert_near(b.offered, 60.0, 1e-9);
    assert_near(b.discarded, 45.0, 1e-9);
    run__macro.destroy(run);
    scene_fini(&s);
}

static void the_end_of_a_feed_is_known(void **state)
{
    double dt;
    scene s;
    make_scene(&s, SCENE_DISPERSIVE, SCENE_SCHEME_ROE, 30.0);
    s.feeds[0].count = 9.0;
    void *run = make_run(&s, 1, &dt);
    step(run, (size_t)(0.29 / dt));
    assert_false(run__macro.is_exhausted(run));
    step(run, (size_t)(0.05 / dt));
    assert_true(run__macro.is_exhausted(run));
    assert_near(run__macro.balance(run, 0).admitted, 9.0, 1e-12);
    run__macro.destroy(run);
    scene_fini(&s);
}

// Two feeds, one of them on the south side and one inside, into a jam: on 1 and 3 threads, and from a checkpoint.
static void threads_and_checkpoints_do_not_change_a_bit(void **state)
{
    for (size_t k = 0; k < N_SOLVERS; k++) {
        void *runs[3];
        double dt;
        scene s;
        bf_buffer saved = { 0 };
        make_scene(&s, solvers[k].closure, solvers[k].scheme, 60.0);
        s.edges[SCENE_EAST] = SCENE_EDGE_WALL;
        scene_feed *feeds = memory_alloc(2, sizeof *feeds);
        assert_non_null(feeds);
        feeds[0] = feeds[1] = s.feeds[0];
        memory_free(s.feeds);
        s.feeds = feeds;
        s.n_feeds = 2;
        feeds[1].is_edge = false;
        feeds[1].line[0] = (vec2){ 0.03, 0.02 };
        feeds[1].line[1] = (vec2){ 0.21, 0.14 };
        feeds[1].when_blocked = SCENE_BLOCKED_DISCARD;
        runs[0] = make_run(&s, 1, &dt);
        runs[1] = make_run(&s, 3, &dt);
        runs[2] = make_run(&s, 2, &dt);
        const size_t n = (size_t)(HELPER_AMOUNT(0.7, 0.4) / dt);
        step(runs[0], n);
        assert_int_equal(helper_backend_save(&run__macro, runs[0], &saved), BF_OK);
        assert_int_equal(helper_backend_load(&run__macro, runs[2], &saved), BF_OK);
        saved.bytes[saved.n / 2]++;
        assert_int_equal(helper_backend_load(&run__macro, runs[2], &saved), BF_ECORRUPT);
        step(runs[0], n);
        step(runs[1], 2 * n);
        step(runs[2], n);
        for (size_t r = 1; r < 3; r++) {
            assert_true(run__macro.digest(runs[r]) == run__macro.digest(runs[0]));
            for (size_t f = 0; f < 2; f++) {
                const feed_balance a = run__macro.balance(runs[0], f),
                                   b = run__macro.balance(runs[r], f);
                check_balance(&b);
                assert_memory_equal(&a, &b, sizeof a);
            }
        }
        for (size_t r = 0; r < 3; r++)
            run__macro.destroy(runs[r]);
        buffer_fini(&saved);
        scene_fini(&s);
    }
}

static void out_of_memory_anywhere_is_an_error(void **state)
{
    bf_status status = BF_ENOMEM;
    void *run = NULL;
    run_plan plan;
    scene s;
    make_scene(&s, SCENE_CONGESTED, SCENE_SCHEME_MUSCL, 60.0);
    helper_scene_resolve(&s);
    bf_world *w = helper_world(s.n_belts, s.belts, s.n_obstacles, s.obstacles);
    for (size_t n = 1; status != BF_OK; n++) {
        memory_plan_fault(n, 0);
        status = run__macro.create(&s, w, 1, &run, &plan, NULL);
        memory_plan_fault(0, 0);
        assert_true(status == BF_OK || (status == BF_ENOMEM && run == NULL));
    }
    bf_buffer saved = { 0 };
    status = BF_ENOMEM;
    for (size_t n = 1; status != BF_OK; n++) {
        memory_plan_fault(n, 0);
        status = helper_backend_save(&run__macro, run, &saved);
        memory_plan_fault(0, 0);
        assert_true(status == BF_OK || (status == BF_ENOMEM && saved.n == 0));
    }
    buffer_fini(&saved);
    run__macro.destroy(run);
    scene_fini(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_fed_belt_carries_the_rate),
        cmocka_unit_test(a_saturated_inlet_admits_the_capacity),
        cmocka_unit_test(nothing_is_lost_behind_a_closed_outlet),
        cmocka_unit_test(a_line_inside_fills_the_cells_it_crosses),
        cmocka_unit_test(a_held_feed_goes_on_to_be_offered),
        cmocka_unit_test(the_end_of_a_feed_is_known),
        cmocka_unit_test(threads_and_checkpoints_do_not_change_a_bit),
        cmocka_unit_test(out_of_memory_anywhere_is_an_error),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
