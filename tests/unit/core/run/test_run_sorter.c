// Runs of both models in which a plate turns to one side for parts of one kind, and to the other one for those of another.

#include "core/run/run.h"

#include "core/base/memory.h"
#include "tests/unit/core/helper_run.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_amount.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <stdlib.h>

#define ANGLE (28.0 * M_PI / 180.0)

enum { COUNTERS = 6 }; // of each lane: both kinds, then each

// Cylinders of 6 cm, every 32 cm, come one by one to a plate whose end is the beginning of a divider. The plate turns while
// the middle between two parts passes it.
static void make_sorter(scene *s)
{
    static const vec2 plate[] = { { 0.76, 0.15 }, { 0.9, 0.15 } },
                      divider[] = { { 0.9, 0.15 }, { 1.4, 0.15 } };

    helper_scene_belt(s, 1.4, 0.3, 0.02, NULL, 0);
    s->macro.closure = SCENE_CONGESTED;
    s->initial.type = SCENE_INITIAL_EMPTY;
    s->duration = 12.0;
    s->output.curve_every = 0.25;
    s->output.snapshot_every = 4.0;
    helper_scene_add_belt(s, (vec2){ 0.4, 0.0 }, NULL, 0);
    s->cargo[0].shape.radius = 0.03;
    s->cargo[0].shape.height = 0.05;
    s->cargo[1] = s->cargo[0];
    s->n_cargo = 2;
    scene_obstacle *turning = helper_scene_add_obstacle(s, plate, 2, SCENE_SEALED);
    turning->pivot = plate[1];
    turning->turn = helper_scene_series(1, (double[]){ 0.0 }, (double[]){ ANGLE }, INFINITY);
    helper_scene_add_obstacle(s, divider, 2, SCENE_SEALED);
    scene_feed *feed = helper_scene_add_feed(s, SCENE_WEST, SCENE_ARRIVALS_REGULAR, 1.25);
    feed->line[0] = (vec2){ 0.0, 0.14 };
    feed->line[1] = (vec2){ 0.0, 0.16 };
    s->n_eyes = 1;
    s->eyes = memory_alloc(1, sizeof *s->eyes);
    scene_photo_eye_init(&s->eyes[0]);
    s->eyes[0].line[0] = (vec2){ 0.3, 0.02 };
    s->eyes[0].line[1] = (vec2){ 0.3, 0.28 };
    s->n_actions = 2;
    s->actions = memory_alloc(2, sizeof *s->actions);
    for (uint32_t k = 0; k < 2; k++) {
        scene_action_init(&s->actions[k]);
        s->actions[k].eye = 0;
        s->actions[k].kind = k;
        s->actions[k].when_blocked = true;
        s->actions[k].delay = 0.95;
        s->actions[k].type = SCENE_ACTION_TURN;
        s->actions[k].target = 0;
        s->actions[k].value = k == 0 ? ANGLE : -ANGLE;
        s->actions[k].over = 0.2;
    }
    memory_free(s->counters);
    s->n_counters = COUNTERS;
    s->counters = memory_alloc(COUNTERS, sizeof *s->counters);
    for (uint32_t k = 0; k < COUNTERS; k++) {
        scene_counter_init(&s->counters[k]);
        s->counters[k].rect.x_min = 0.9;
        s->counters[k].rect.x_max = 1.4;
        s->counters[k].rect.y_min = k < 3 ? 0.15 : 0.0;
        s->counters[k].rect.y_max = k < 3 ? 0.3 : 0.15;
        s->counters[k].kind = k % 3 == 0 ? SCENE_KIND_ANY : k % 3 - 1;
    }
    helper_scene_resolve(s);
}

// Sums over all samples of the contents of the counters.
static void sum_contents(const helper_run_log *log, double ret_sums[COUNTERS])
{
    for (size_t c = 0; c < COUNTERS; c++)
        ret_sums[c] = 0.0;
    for (size_t k = 0; k < log->n_samples; k++)
        for (size_t c = 0; c < COUNTERS; c++)
            ret_sums[c] += log->values[k][c];
}

// A plate turned counter-clockwise by the angle lies below the line upstream of its end: what comes goes to the left.
static void each_kind_goes_to_its_side_and_stops_change_no_bit(void **state)
{
    static const run_model models[] = { RUN_MICRO, RUN_MACRO };
    // Of the density the grid spreads a part along the belt, and what of it passes before or after its turn goes the wrong way.
    static const double least[] = { 1.0, 0.88 };

    for (int m = 0; m < 2; m++) {
        scene s;
        double sums[COUNTERS];
        make_sorter(&s);
        helper_run_log *log = helper_run_check_stops(
            &s, models[m], 3, HELPER_AMOUNT(1, 2), (helper_run_threads){ .before = 3, .after = 2 });
        sum_contents(log, sums);
        for (size_t lane = 0; lane < 2; lane++) {
            const double *of = sums + 3 * lane;
            assert_true(fabs(of[0] - of[1] - of[2]) < 1e-9 * of[0]);
            assert_true(of[0] > 0.0);
            assert_true(of[1 + lane] >= least[m] * of[0]);
        }
        helper_run_free(log);
        scene_fini(&s);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_kind_goes_to_its_side_and_stops_change_no_bit),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
