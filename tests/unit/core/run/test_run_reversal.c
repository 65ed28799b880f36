// Runs of both models on belts that run backwards for a while, on slopes, too.

#include "core/run/run.h"

#include "tests/unit/core/helper_run.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_amount.h"
#include "tests/unit/helper_cmocka.h"

#include <stdlib.h>

enum { SOLVERS = 4 };

#define SPEED  0.4
#define LENGTH 0.8
#define DEGREE (M_PI / 180.0)

static const struct {
    run_model model;
    scene_closure closure;
    scene_path path;
} solvers[SOLVERS] = {
    { RUN_MACRO, SCENE_DISPERSIVE, SCENE_PATH_AUTO },
    { RUN_MACRO, SCENE_CONGESTED, SCENE_PATH_AUTO },
    { RUN_MICRO, SCENE_CONGESTED, SCENE_PATH_PLANAR },
    { RUN_MICRO, SCENE_CONGESTED, SCENE_PATH_SPATIAL },
};

// 12 cylinders in the middle of a belt that is closed all around but for its ends.
static void make_belt(scene *s, int solver)
{
    static scene_pose poses[12];

    for (int k = 0; k < 12; k++)
        poses[k] = (scene_pose){ 0.32 + 0.03 * (k / 3), 0.05 + 0.05 * (k % 3), 0.0 };
    helper_scene_belt(s, LENGTH, 0.2, 0.01, poses, 12);
    s->duration = 1.5;
    s->output.curve_every = 0.25;
    s->macro.closure = solvers[solver].closure;
    s->micro.path = solvers[solver].path;
    s->micro.integrator = SCENE_IMPLICIT;
    s->micro.modulus_reduction = 1e6;
    s->micro.overlap_limit = 1.0;
    helper_scene_add_belt(s, (vec2){ SPEED, 0.0 }, NULL, 0);
    s->edges[SCENE_WEST] = s->edges[SCENE_EAST] = SCENE_EDGE_OUTFLOW;
    s->edges[SCENE_SOUTH] = s->edges[SCENE_NORTH] = SCENE_EDGE_WALL;
}

static helper_run_log *run_with(scene *s, int solver, int n_threads)
{
    helper_run_log *log = calloc(1, sizeof *log);

    assert_non_null(log);
    log->model = solvers[solver].model;
    assert_int_equal(helper_run(s, n_threads, 0, log), BF_OK);
    return log;
}

// Column 0 is the first counter's, column 1 what has left the domain.
static double left_at(const helper_run_log *log, double t)
{
    return helper_run_at(log, t)[1];
}

// A jam at a plate that is there and goes, on a slope where the model has slopes; forward, back, stand and forward.
static void make_loosened_jam(scene *s, int solver)
{
    make_belt(s, solver);
    s->belts[0].acceleration = 6.0;
    s->belts[0].deceleration = 5.0;
    s->belts[0].incline = solvers[solver].closure == SCENE_CONGESTED ? 8.0 * DEGREE : 0.0;
    helper_scene_schedule(&s->belts[0], 4, (double[]){ 0.3, 0.62, 0.8, 0.95 },
                          (double[]){ -1.0, 0.0, -0.5, 1.2 });
    scene_obstacle *plate =
        helper_scene_add_obstacle(s, (vec2[]){ { 0.47, 0.0 }, { 0.52, 0.14 } }, 2, SCENE_SEALED);
    plate->presence =
        helper_scene_series(2, (double[]){ 0.0, 1.0 }, (double[]){ 1.0, 0.0 }, INFINITY);
    helper_scene_resolve(s);
}

static void a_run_resumes_to_the_same_bits_on_any_number_of_threads(void **state)
{
    for (int k = 0; k < SOLVERS; k++) {
        scene s;
        make_loosened_jam(&s, k);
        // Of less only the stop after a third of it, while the belt runs backwards into the jam.
        helper_run_free(helper_run_check_stops(&s, solvers[k].model, HELPER_AMOUNT(4, 3),
                                               HELPER_AMOUNT(1, 2),
                                               (helper_run_threads){ .before = 3, .after = 2 }));
        scene_fini(&s);
    }
}

static void cargo_between_walls_is_all_there_however_the_belt_runs(void **state)
{
    for (int k = 0; k < SOLVERS; k++) {
        scene s;
        make_loosened_jam(&s, k);
        s.edges[SCENE_WEST] = s.edges[SCENE_EAST] = SCENE_EDGE_WALL;
        helper_run_log *log = run_with(&s, k, 1);
        for (size_t n = 0; n < log->n_samples; n++)
            assert_near(log->values[n][1], 0.0, 1e-12 * 12.0);
        scene_fini(&s);
        helper_run_free(log);
    }
}

// Uphill in a direction is downhill in the other one. Of the density a plate lets some through, the more the steeper it goes down;
// plates among parts have a body on the side that follows from the velocity.
static void a_belt_runs_backwards_as_one_of_the_other_velocity_runs_forward(void **state)
{
    for (int k = 0; k < SOLVERS; k++) {
        const double incline = solvers[k].closure == SCENE_CONGESTED ? 8.0 * DEGREE : 0.0;
        scene back, other;
        make_belt(&back, k);
        make_belt(&other, k);
        back.edges[SCENE_WEST] = other.edges[SCENE_WEST] = SCENE_EDGE_WALL;
        back.belts[0].incline = incline;
        helper_scene_schedule(&back.belts[0], 1, (double[]){ 0.0 }, (double[]){ -1.0 });
        other.belts[0].velocity.x = -SPEED;
        other.belts[0].incline = -incline;
        const vec2 plate[] = { { 0.2, 0.0 }, { 0.165, 0.1 } };
        if (solvers[k].model == RUN_MACRO) {
            helper_scene_add_obstacle(&back, plate, 2, SCENE_SEALED);
            helper_scene_add_obstacle(&other, plate, 2, SCENE_SEALED);
        }
        helper_scene_resolve(&back);
        helper_scene_resolve(&other);
        back.counters[0].rect.x_max = other.counters[0].rect.x_max = 0.1;
        helper_run_log *a = run_with(&back, k, 1), *b = run_with(&other, k, 1);
        assert_int_equal(a->n_samples, b->n_samples);
        for (size_t n = 0; n < a->n_samples; n++)
            assert_near(a->values[n][0], b->values[n][0], 1e-6 * 12.0);
        assert_true(helper_run_at(a, 1.5)[0] > 4.0); // some have come to the wall
        scene_fini(&back);
        scene_fini(&other);
        helper_run_free(a);
        helper_run_free(b);
    }
}

// They lie 0.32 to 0.41 m from the western side, and 0.04 m farther when the belt runs backwards from 0.1 s on: at 0.4 m/s they leave
// from 1.0 to 1.225 s.
static void cargo_leaves_backwards_over_an_open_side_and_counts_as_what_left(void **state)
{
    for (int k = 0; k < SOLVERS; k++) {
        scene s;
        make_belt(&s, k);
        helper_scene_schedule(&s.belts[0], 1, (double[]){ 0.1 }, (double[]){ -1.0 });
        helper_scene_resolve(&s);
        helper_run_log *log = run_with(&s, k, 1);
        assert_near(left_at(log, 0.5), 0.0, 0.01 * 12.0);
        assert_near(left_at(log, 1.5), 12.0, 0.05 * 12.0);
        scene_fini(&s);
        helper_run_free(log);
    }
}

// Backwards from the start the cargo comes to the fed side, where it queues; a density has then no way in.
static void a_fed_side_is_a_wall_and_takes_no_density_backwards(void **state)
{
    for (int k = 0; k < SOLVERS; k++) {
        scene s;
        make_belt(&s, k);
        s.edges[SCENE_WEST] = SCENE_EDGE_INFLOW;
        helper_scene_add_feed(&s, SCENE_WEST, SCENE_ARRIVALS_REGULAR, 4.0);
        helper_scene_schedule(&s.belts[0], 1, (double[]){ 0.0 }, (double[]){ -1.0 });
        helper_scene_resolve(&s);
        helper_run_log *log = run_with(&s, k, 1);
        const double *end = helper_run_at(log, 1.5); // counter, left, offered, admitted
        assert_near(end[1], 0.0, 1e-12 * 12.0);
        assert_true(end[2] >= 5.0);
        if (solvers[k].model == RUN_MACRO)
            assert_true(end[3] == 0.0);
        scene_fini(&s);
        helper_run_free(log);
    }
}

// The density between them leaves to both sides and, along a plate, across the belts in one step. The first one runs backwards by
// its velocity, or comes to.
static void check_parting(double first_speed, double factor)
{
    static const vec2 first[] = { { 0.0, 0.0 }, { 0.4, 0.0 }, { 0.4, 0.2 }, { 0.0, 0.2 } };
    static const vec2 second[] = { { 0.4, 0.0 }, { 0.8, 0.0 }, { 0.8, 0.2 }, { 0.4, 0.2 } };
    scene s;

    make_belt(&s, 1);
    s.n_belts = 0;
    helper_scene_add_belt(&s, (vec2){ first_speed, 0.0 }, first, 4);
    helper_scene_add_belt(&s, (vec2){ SPEED, 0.0 }, second, 4);
    helper_scene_schedule(&s.belts[0], 1, (double[]){ 0.0 }, (double[]){ factor });
    helper_scene_add_obstacle(&s, (vec2[]){ { 0.31, 0.0 }, { 0.41, 0.1 } }, 2, SCENE_SEALED);
    helper_scene_resolve(&s);
    helper_run_log *log = run_with(&s, 1, 1);
    assert_true(left_at(log, s.duration) > 0.0);
    scene_fini(&s);
    helper_run_free(log);
}

static void belts_run_apart_with_a_plate_across_their_border(void **state)
{
    check_parting(SPEED, -1.0);
    check_parting(-SPEED, 1.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_run_resumes_to_the_same_bits_on_any_number_of_threads),
        cmocka_unit_test(cargo_between_walls_is_all_there_however_the_belt_runs),
        cmocka_unit_test(a_belt_runs_backwards_as_one_of_the_other_velocity_runs_forward),
        cmocka_unit_test(cargo_leaves_backwards_over_an_open_side_and_counts_as_what_left),
        cmocka_unit_test(a_fed_side_is_a_wall_and_takes_no_density_backwards),
        cmocka_unit_test(belts_run_apart_with_a_plate_across_their_border),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
