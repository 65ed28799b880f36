// Runs of both models with sinks: what they take, when, of which kind, and that nothing is lost.

#include "core/base/memory.h"
#include "core/observe/figure.h"
#include "core/run/macro_sinks.h"
#include "core/run/run.h"
#include "tests/unit/core/helper_run.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_amount.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SOLVERS = 4 };

static const struct {
    run_model model;
    scene_closure closure;
    scene_path path;
} solvers[SOLVERS] = { { RUN_MACRO, SCENE_DISPERSIVE, SCENE_PATH_AUTO },
                       { RUN_MACRO, SCENE_CONGESTED, SCENE_PATH_AUTO },
                       { RUN_MICRO, SCENE_CONGESTED, SCENE_PATH_PLANAR },
                       { RUN_MICRO, SCENE_CONGESTED, SCENE_PATH_SPATIAL } };

// Columns of a fed scene with a lane and a packer; of one without feeds the sinks come behind LEFT.
enum { INSIDE, LEFT, OFFERED, ADMITTED, WAITING, DISCARDED, OVER_END, LANE, PACKER };

// Appends a sink over a rectangle, m; of one kind of cargo, or of all where kind is UINT32_MAX.
static void add_sink(scene *s, scene_rect at, double rate, uint32_t kind)
{
    const vec2 corners[] = { { at.x_min, at.y_min },
                             { at.x_max, at.y_min },
                             { at.x_max, at.y_max },
                             { at.x_min, at.y_max } };
    scene_sink *all = memory_alloc(s->n_sinks + 1, sizeof *all);

    assert_non_null(all);
    if (s->n_sinks > 0)
        memcpy(all, s->sinks, s->n_sinks * sizeof *all);
    memory_free(s->sinks);
    s->sinks = all;
    scene_sink *sink = &all[s->n_sinks++];
    scene_sink_init(sink);
    sink->n_points = 4;
    sink->polygon = memory_alloc(4, sizeof *sink->polygon);
    memcpy(sink->polygon, corners, sizeof corners);
    sink->rate = rate;
    sink->n_kinds = kind != UINT32_MAX;
    sink->kinds = memory_alloc(1, sizeof *sink->kinds);
    sink->kinds[0] = kind;
}

// A belt of 0.4 m/s, 0.8 m x 0.16 m, with n parts at the start.
static void make_belt(scene *s, int solver, const scene_pose *poses, size_t n)
{
    helper_scene_belt(s, 0.8, 0.16, 0.01, poses, n);
    if (n == 0)
        s->initial.type = SCENE_INITIAL_EMPTY;
    s->macro.closure = solvers[solver].closure;
    s->micro.path = solvers[solver].path;
    s->micro.integrator = SCENE_IMPLICIT;
    s->micro.step = 1e-3;
    s->micro.modulus_reduction = 1e4;
    s->output.curve_every = 0.05;
    s->output.snapshot_every = 0.5;
    helper_scene_add_belt(s, (vec2){ 0.4, 0.0 }, NULL, 0);
}

// 20 parts/s, half of which come to a lane that takes all; the other half pass a packer that takes 3 parts/s.
static void make_lane_and_packer(scene *s, int solver, scene_arrivals arrivals)
{
    make_belt(s, solver, NULL, 0);
    s->duration = 5.0;
    s->warmup = 2.5;
    helper_scene_add_feed(s, SCENE_WEST, arrivals, 20.0);
    add_sink(s, (scene_rect){ 0.3, 0.4, 0.0, 0.08 }, INFINITY, UINT32_MAX);
    add_sink(s, (scene_rect){ 0.5, 0.7, 0.08, 0.16 }, 3.0, UINT32_MAX);
    helper_scene_resolve(s);
}

static helper_run_log *run_of(const scene *s, int solver)
{
    helper_run_log *log = calloc(1, sizeof *log);

    assert_non_null(log);
    log->model = solvers[solver].model;
    assert_int_equal(helper_run(s, 1, 0, log), BF_OK);
    return log;
}

static void what_sinks_take_has_left_the_line(void **state)
{
    for (int k = 0; k < SOLVERS; k++) {
        const bool has_parts = solvers[k].model == RUN_MICRO;
        scene s;
        make_lane_and_packer(&s, k, SCENE_ARRIVALS_REGULAR);
        helper_run_log *log = run_of(&s, k);
        for (size_t i = 0; i < log->n_samples; i++) {
            const double *v = log->values[i], rounding = has_parts ? 0.0 : 1e-12 * v[ADMITTED];
            assert_near(v[LEFT], v[OVER_END] + v[LANE] + v[PACKER], rounding);
            assert_near(v[ADMITTED], v[INSIDE] + v[LEFT], rounding);
        }
        // The packer is never idle once parts come to it: it takes 3 parts/s, and 7 of its 10 parts/s go on.
        const double *from = helper_run_at(log, 2.5), *to = helper_run_at(log, 4.5);
        assert_near(to[PACKER] - from[PACKER], 6.0, has_parts ? 0.0 : 1e-9);
        assert_near(to[LANE] - from[LANE], 20.0, has_parts ? 7.0 : 0.01); // by lot: 40 parts, 1/2
        const double *of = log->figures, spent = log->end.t - 2.5,
                     *end = log->values[log->n_samples - 1];
        assert_near(of[figure_at(&s, FIGURE_TAKEN, 1)], end[PACKER], 1e-9);
        assert_near(of[figure_at(&s, FIGURE_SINK_FLOW, 1)],
                    3600.0 * (end[PACKER] - from[PACKER]) / spent, 1e-6);
        assert_near(of[figure_at(&s, FIGURE_THROUGHPUT, 0)],
                    3600.0 * (end[LEFT] - from[LEFT]) / spent, 1e-6);
        // What is taken in a counter has left it: the first one covers all.
        assert_near(of[figure_at(&s, FIGURE_FLOW, 0)], of[figure_at(&s, FIGURE_THROUGHPUT, 0)],
                    1e-6 * of[figure_at(&s, FIGURE_FLOW, 0)]);
        helper_run_free(log);
        scene_fini(&s);
    }
}

// From the west to x = 0.4 m at 0.4 m/s. Tracers of the closure congested move each fourth step, of half a cell: each 0.05 s. The counter
// about the sink has nothing that leaves over its borders.
static void what_is_taken_was_in_the_line_for_as_long_as_it_was(void **state)
{
    for (int k = 0; k < SOLVERS; k++) {
        scene s;
        make_belt(&s, k, NULL, 0);
        s.duration = 4.0;
        s.warmup = 1.5;
        helper_scene_add_feed(&s, SCENE_WEST, SCENE_ARRIVALS_REGULAR, 20.0);
        add_sink(&s, (scene_rect){ 0.4, 0.5, 0.0, 0.16 }, INFINITY, UINT32_MAX);
        helper_scene_resolve(&s);
        s.counters[0].rect = (scene_rect){ 0.38, 0.52, 0.0, 0.16 };
        helper_run_log *log = run_of(&s, k);
        assert_near(log->figures[figure_at(&s, FIGURE_FLOW, 0)], 72000.0, 1440.0);
        assert_near(log->figures[FIGURE_RESIDENCE_MEAN], 1.0, 0.05);
        assert_near(log->figures[FIGURE_RESIDENCE_P95], 1.0, 0.05);
        assert_near(log->values[log->n_samples - 1][OVER_END], 0.0, 0.0);
        assert_near(log->figures[FIGURE_THROUGHPUT], 72000.0, 720.0);
        helper_run_free(log);
        scene_fini(&s);
    }
}

// Before a wall: what queues there is taken at the rate, whatever queues.
static void a_queue_is_worked_off_at_the_rate(void **state)
{
    const double duration = HELPER_AMOUNT(6.0, 4.0);

    for (int k = 1; k < SOLVERS; k++) {
        const bool has_parts = solvers[k].model == RUN_MICRO;
        scene s;
        make_belt(&s, k, NULL, 0);
        s.edges[SCENE_EAST] = SCENE_EDGE_WALL;
        s.duration = duration;
        helper_scene_add_feed(&s, SCENE_WEST, SCENE_ARRIVALS_REGULAR, 20.0);
        add_sink(&s, (scene_rect){ 0.7, 0.8, 0.0, 0.16 }, 8.0, UINT32_MAX);
        helper_scene_resolve(&s);
        helper_run_log *log = run_of(&s, k);
        const double *from = helper_run_at(log, 3.0), *to = helper_run_at(log, duration);
        assert_near(to[6] - from[6], 8.0 * (duration - 3.0),
                    has_parts ? 0.0 : 1e-9); // no outlet, so the sink comes first
        assert_near(to[INSIDE] - from[INSIDE], 12.0 * (duration - 3.0), has_parts ? 1.0 : 1e-9);
        helper_run_free(log);
        scene_fini(&s);
    }
}

enum { TAKEN = 2 }; // the column of the only sink, without feeds

// Three parts before a sink of 2 parts/s. By their places they come to it at 0.25, 0.125 and 0.025 s, and leave it 0.5 s later.
static void make_three_parts(scene *s, int solver)
{
    static const scene_pose poses[] = { { 0.30, 0.08, 0.0 },
                                        { 0.35, 0.08, 0.0 },
                                        { 0.39, 0.08, 0.0 } };

    make_belt(s, solver, poses, 3);
    s->duration = 1.0;
    add_sink(s, (scene_rect){ 0.4, 0.6, 0.0, 0.16 }, 2.0, UINT32_MAX);
    helper_scene_resolve(s);
}

// The last part is taken at once, the second one 0.5 s after it, and when it is the turn of the first one, that has passed.
static void the_part_that_waits_longest_is_taken_first(void **state)
{
    for (int k = 2; k < SOLVERS; k++) {
        scene s;
        make_three_parts(&s, k);
        helper_run_log *log = run_of(&s, k);
        assert_near(helper_run_at(log, 0.0)[TAKEN], 0.0, 0.0);
        assert_near(helper_run_at(log, 0.05)[TAKEN], 1.0, 0.0);
        assert_near(helper_run_at(log, 0.5)[TAKEN], 1.0, 0.0);
        assert_near(helper_run_at(log, 0.55)[TAKEN], 2.0, 0.0);
        assert_near(helper_run_at(log, 1.0)[TAKEN], 2.0, 0.0);
        assert_near(log->end.parts_end, 1.0, 0.0);
        assert_true(log->parts[0] > 0.6); // the first part is there
        helper_run_free(log);
        scene_fini(&s);
    }
}

// Ten parts of two kinds, five each; both sinks are in the same place, and a later one outranks an earlier one.
static void kinds_and_places_say_which_sink_takes_a_part(void **state)
{
    static const scene_rect at = { 0.4, 0.5, 0.0, 0.16 };
    static const struct {
        uint32_t kinds[2];
        double taken[2];
    } cases[] = { { { UINT32_MAX, 1 }, { 5.0, 5.0 } },
                  { { 1, UINT32_MAX }, { 0.0, 10.0 } },
                  { { 0, 1 }, { 5.0, 5.0 } },
                  { { 1, 1 }, { 0.0, 5.0 } } };
    scene_pose poses[10];

    for (int i = 0; i < 10; i++)
        poses[i] = (scene_pose){ 0.05 + 0.06 * (i / 2), 0.05 + 0.06 * (i % 2), 0.0 };
    for (int k = 1; k < SOLVERS; k++)
        for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
            scene s;
            make_belt(&s, k, poses, 10);
            s.duration = 2.0;
            s.n_cargo = 2;
            s.is_mix = true;
            scene_cargo_init(&s.cargo[1]);
            s.cargo[1].shape.height = 0.02;
            for (int i = 0; i < 2; i++)
                add_sink(&s, at, INFINITY, cases[c].kinds[i]);
            helper_scene_resolve(&s);
            helper_run_log *log = run_of(&s, k);
            const double *last = log->values[log->n_samples - 1];
            // Of a density as many as a part's Gaussian has of it.
            const double off = solvers[k].model == RUN_MICRO ? 0.0 : 0.01;
            const double of_part = log->end.parts_start / 10.0;
            assert_near(last[2], of_part * cases[c].taken[0], off);
            assert_near(last[3], of_part * cases[c].taken[1], off);
            helper_run_free(log);
            scene_fini(&s);
        }
}

// Steps of 12.5 ms bring 1.5 of 120 parts/s each.
static void a_rate_beyond_what_comes_is_no_limit(void **state)
{
    static const double rates[2] = { INFINITY, 1e6 };
    double taken[2];

    for (int k = 0; k < SOLVERS; k++) {
        for (int i = 0; i < 2; i++) {
            scene s;
            make_belt(&s, k, NULL, 0);
            s.duration = HELPER_AMOUNT(2.0, 1.2);
            helper_scene_add_feed(&s, SCENE_WEST, SCENE_ARRIVALS_REGULAR, 120.0);
            add_sink(&s, (scene_rect){ 0.3, 0.4, 0.0, 0.16 }, rates[i], UINT32_MAX);
            helper_scene_resolve(&s);
            helper_run_log *log = run_of(&s, k);
            taken[i] = log->values[log->n_samples - 1][LANE];
            helper_run_free(log);
            scene_fini(&s);
        }
        assert_true(taken[0] > HELPER_AMOUNT(50.0, 20.0));
        assert_near(taken[1], taken[0], 0.0);
    }
}

static void a_density_goes_to_the_later_of_two_sinks(void **state)
{
    static const scene_pose pose = { 0.2, 0.08, 0.0 };

    for (int k = 0; k < 2; k++) {
        scene s;
        make_belt(&s, k, &pose, 1);
        s.duration = 2.0;
        add_sink(&s, (scene_rect){ 0.4, 0.6, 0.0, 0.16 }, INFINITY, UINT32_MAX);
        add_sink(&s, (scene_rect){ 0.4, 0.5, 0.0, 0.16 }, INFINITY, UINT32_MAX);
        helper_scene_resolve(&s);
        helper_run_log *log = run_of(&s, k);
        const double *last = log->values[log->n_samples - 1];
        assert_near(last[2], 0.0, 0.0);
        assert_near(last[3], log->end.parts_start, 1e-3);
        assert_near(last[3], last[LEFT], 1e-12);
        helper_run_free(log);
        scene_fini(&s);
    }
}

// A belt along an axis with 17 rows of cells, fed over its whole width; along the middle of the 9th one a divider from 0.3 m on, drawn
// with the belt or against it; behind it a sink on each side.
static void make_lanes(scene *s, int solver, bool is_north, bool is_against)
{
    const vec2 along = is_north ? (vec2){ 0.085, 0.3 } : (vec2){ 0.3, 0.085 },
               end = is_north ? (vec2){ 0.085, 0.8 } : (vec2){ 0.8, 0.085 };
    const vec2 path[] = { is_against ? end : along, is_against ? along : end };

    helper_scene_belt(s, is_north ? 0.17 : 0.8, is_north ? 0.8 : 0.17, 0.01, NULL, 0);
    s->initial.type = SCENE_INITIAL_EMPTY;
    s->macro.closure = solvers[solver].closure;
    s->output.curve_every = 0.05;
    s->duration = 4.0;
    helper_scene_add_belt(s, is_north ? (vec2){ 0.0, 0.4 } : (vec2){ 0.4, 0.0 }, NULL, 0);
    helper_scene_add_obstacle(s, path, 2, SCENE_SEALED);
    if (is_north) {
        s->edges[SCENE_WEST] = s->edges[SCENE_EAST] = SCENE_EDGE_WALL;
        s->edges[SCENE_NORTH] = SCENE_EDGE_OUTFLOW;
    }
    helper_scene_add_feed(s, is_north ? SCENE_SOUTH : SCENE_WEST, SCENE_ARRIVALS_REGULAR, 20.0);
    for (int side = 0; side < 2; side++) {
        const double from = side == 0 ? 0.0 : 0.085, to = side == 0 ? 0.085 : 0.17;
        add_sink(s,
                 is_north ? (scene_rect){ from, to, 0.6, 0.7 } : (scene_rect){ 0.6, 0.7, from, to },
                 INFINITY, UINT32_MAX);
    }
    helper_scene_resolve(s);
}

// Cells on a guide's path lie on its left, seen from its start (core/scene/surroundings.h): of the 17 rows 9 flow there.
static void a_row_on_a_divider_is_taken_on_the_side_that_it_flows_on(void **state)
{
    for (int k = 0; k < 2; k++)
        for (int is_north = 0; is_north < 2; is_north++)
            for (int is_against = 0; is_against < 2; is_against++) {
                const bool is_low_left = (is_north != 0) != (is_against != 0);
                scene s;
                make_lanes(&s, k, is_north != 0, is_against != 0);
                helper_run_log *log = run_of(&s, k);
                const double *last = log->values[log->n_samples - 1];
                const double low = last[LANE], high = last[PACKER];
                assert_true(low + high > 30.0);
                assert_near(low / (low + high), (is_low_left ? 9.0 : 8.0) / 17.0, 1e-9);
                helper_run_free(log);
                scene_fini(&s);
            }
}

// The packer has taken parts from 1.25 s on, so it goes on with its rate when the run is stopped at 1.5 s.
static void a_run_stopped_anywhere_takes_the_same(void **state)
{
    for (int k = 0; k < SOLVERS; k++) {
        scene s;
        make_lane_and_packer(&s, k, SCENE_ARRIVALS_POISSON);
        s.duration = 2.0;
        helper_run_log *whole =
            helper_run_check_stops(&s, solvers[k].model, 4, HELPER_AMOUNT(1, 2),
                                   (helper_run_threads){ .before = 2, .after = 1 });
        assert_true(whole->values[whole->n_samples - 1][PACKER] > 1.5);
        scene_fini(&s);
        helper_run_free(whole);
        if (solvers[k].model == RUN_MACRO)
            continue;
        // Without feeds, too: when each part came to the sink is known from before.
        make_three_parts(&s, k);
        whole = helper_run_check_stops(&s, RUN_MICRO, 4, HELPER_AMOUNT(1, 2),
                                       (helper_run_threads){ .before = 2, .after = 1 });
        assert_near(whole->values[whole->n_samples - 1][TAKEN], 2.0, 0.0);
        scene_fini(&s);
        helper_run_free(whole);
    }
}

static void check_says(const scene *s, const char *pointer)
{
    bf_faults faults = { 0 };

    run_check(s, RUN_MACRO, &faults);
    assert_int_equal(faults.n, 1);
    assert_string_equal(faults.items[0].pointer, pointer);
}

static void a_density_has_cells_and_kinds_by_congested_alone(void **state)
{
    scene s;

    make_belt(&s, 0, NULL, 0);
    s.duration = 1.0;
    helper_scene_add_feed(&s, SCENE_WEST, SCENE_ARRIVALS_REGULAR, 20.0);
    s.n_cargo = 2;
    s.is_mix = true;
    scene_cargo_init(&s.cargo[1]);
    add_sink(&s, (scene_rect){ 0.4, 0.5, 0.0, 0.16 }, INFINITY, 1);
    helper_scene_resolve(&s);
    check_says(&s, "/macro/closure");
    s.sinks[0].n_kinds = 0;
    for (int k = 0; k < 4; k++) // between the centres at 0.405 and 0.415 m
        s.sinks[0].polygon[k].x = s.sinks[0].polygon[k].x < 0.45 ? 0.406 : 0.414;
    check_says(&s, "/sinks/0/polygon_m");
    scene_fini(&s);
}

// 0.01 m cells, 80 in a row. A cell of n kinds under sinks has 8 (3 n + 3) + 36 n + 12 bytes more than 265.
static void kinds_and_sinks_leave_memory_for_fewer_cells(void **state)
{
    static const size_t n_kinds[] = { 2, SCENE_KINDS_MAX };

    for (int k = 0; k < 2; k++) {
        const double most = 30e6 * 265.0 / (265.0 + 60.0 * (double)n_kinds[k] + 36.0);
        bf_faults faults = { 0 };
        scene s;
        make_belt(&s, 1, NULL, 0);
        helper_scene_add_feed(&s, SCENE_WEST, SCENE_ARRIVALS_REGULAR, 20.0);
        s.duration = 1.0;
        s.is_mix = true;
        for (; s.n_cargo < n_kinds[k]; s.n_cargo++)
            scene_cargo_init(&s.cargo[s.n_cargo]);
        add_sink(&s, (scene_rect){ 0.4, 0.5, 0.0, 0.16 }, INFINITY, 1);
        s.domain.y_max = 0.01 * floor(most / 80.0);
        helper_scene_resolve(&s);
        run_check(&s, RUN_MACRO, &faults);
        assert_int_equal(faults.n, 0);
        s.domain.y_max += 0.01;
        check_says(&s, "/macro/cell_m");
        scene_fini(&s);
    }
}

// Each side of a sink is compared with each row of cells, each piece of a path with the rows that it passes: 400,000 rows, sinks of 4
// sides, and a path to and fro along all rows.
static void cells_of_sinks_are_looked_for_within_a_number_of_steps(void **state)
{
    static const vec2 path[] = { { 0.2, 0.0 }, { 0.2, 4000.0 }, { 0.2, 0.0 }, { 0.2, 4000.0 } };
    static const struct {
        size_t n_sinks, n_points, n_faults;
    } cases[] = { { 62, 3, 0 }, { 62, 4, 1 }, { 63, 3, 1 } };
    scene s;

    make_belt(&s, 1, NULL, 0);
    s.domain.y_max = 4000.0;
    for (int k = 0; k < 63; k++)
        add_sink(&s, (scene_rect){ 0.4, 0.5, 0.0, 0.16 }, INFINITY, UINT32_MAX);
    helper_scene_add_obstacle(&s, path, 4, SCENE_SEALED);
    helper_scene_resolve(&s);
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        scene of = s;
        bf_faults faults = { 0 };
        of.n_sinks = cases[k].n_sinks;
        of.obstacles[0].n_points = cases[k].n_points;
        macro_sinks_check(&of, &faults);
        assert_int_equal(faults.n, cases[k].n_faults);
        if (faults.n == 0)
            continue;
        assert_int_equal(faults.items[0].code, BF_ELIMIT);
        assert_string_equal(faults.items[0].pointer, "/sinks");
    }
    scene_fini(&s);
}

// The part is in the sink at the start.
static void out_of_memory_anywhere_ends_a_run_with_sinks(void **state)
{
    static const scene_pose pose = { 0.45, 0.08, 0.0 };

    for (int k = 1; k < SOLVERS; k++) {
        size_t n_failed = 1;
        scene s;
        make_belt(&s, k, &pose, 1);
        s.duration = 0.05;
        add_sink(&s, (scene_rect){ 0.4, 0.5, 0.0, 0.16 }, INFINITY, UINT32_MAX);
        helper_scene_resolve(&s);
        for (size_t n = 1; n_failed > 0; n++) {
            helper_run_log *log = calloc(1, sizeof *log);
            assert_non_null(log);
            log->model = solvers[k].model;
            memory_plan_fault(n, 0);
            const bf_status status = helper_run(&s, 1, 0, log);
            n_failed = memory_faults();
            memory_plan_fault(0, 0);
            assert_int_equal(status, n_failed > 0 ? BF_ENOMEM : BF_OK);
            helper_run_free(log);
        }
        scene_fini(&s);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_sinks_take_has_left_the_line),
        cmocka_unit_test(what_is_taken_was_in_the_line_for_as_long_as_it_was),
        cmocka_unit_test(a_queue_is_worked_off_at_the_rate),
        cmocka_unit_test(the_part_that_waits_longest_is_taken_first),
        cmocka_unit_test(kinds_and_places_say_which_sink_takes_a_part),
        cmocka_unit_test(a_rate_beyond_what_comes_is_no_limit),
        cmocka_unit_test(a_density_goes_to_the_later_of_two_sinks),
        cmocka_unit_test(a_row_on_a_divider_is_taken_on_the_side_that_it_flows_on),
        cmocka_unit_test(a_run_stopped_anywhere_takes_the_same),
        cmocka_unit_test(a_density_has_cells_and_kinds_by_congested_alone),
        cmocka_unit_test(kinds_and_sinks_leave_memory_for_fewer_cells),
        cmocka_unit_test(cells_of_sinks_are_looked_for_within_a_number_of_steps),
        cmocka_unit_test(out_of_memory_anywhere_ends_a_run_with_sinks),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
