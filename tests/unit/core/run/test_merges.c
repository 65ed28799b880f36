// Unit tests of merges, and runs of both models in which two lanes are released.

#include "core/run/merges.h"

#include "core/base/memory.h"
#include "core/run/run.h"
#include "core/world/belt_stops.h"
#include "tests/unit/core/helper_run.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_amount.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <stdlib.h>

enum { LANES = 3, NONE = LANES };

// A merge of three lanes whose belts and eyes have their numbers.
typedef struct three_lanes {
    scene_lane lanes[LANES];
    scene_merge merge;
    scene scene;
    merges_eye eyes[LANES];
} three_lanes;

static void make_lanes(three_lanes *of, scene_merge_order order, uint32_t parts)
{
    *of = (three_lanes){ .lanes = { { 0, 0 }, { 1, 1 }, { 2, 2 } },
                         .merge = {
                             .n_lanes = LANES, .order = order, .parts = parts, .time = INFINITY } };
    of->merge.lanes = of->lanes;
    of->scene = (scene){ .n_belts = LANES, .n_merges = 1, .merges = &of->merge };
}

static void wait_at(three_lanes *of, size_t lane, bool waits)
{
    of->eyes[lane].n_left += of->eyes[lane].is_broken && !waits ? 1 : 0;
    of->eyes[lane].is_broken = of->eyes[lane].is_blocked = waits;
}

// The lane that is released at a step; NONE.
static size_t released(const three_lanes *of, merges *m, uint64_t step)
{
    (void)merges_go_on(m, 0, of->eyes, step);
    return m->states[0].is_open != 0 ? (size_t)m->states[0].lane : NONE;
}

static bool holds(const merges *m, size_t belt)
{
    bool held[LANES];

    merges_find_held(m, held);
    return held[belt];
}

static void lanes_are_released_in_turn_and_those_in_which_nothing_waits_are_passed_over(
    void **state)
{
    three_lanes of;

    make_lanes(&of, SCENE_MERGE_IN_TURN, 1);
    merges m = merges_of(&of.scene, 0.1);
    assert_int_equal(released(&of, &m, 0), NONE);
    assert_false(holds(&m, 0) || holds(&m, 1) || holds(&m, 2));
    wait_at(&of, 2, true);
    assert_int_equal(released(&of, &m, 1), 2);
    wait_at(&of, 0, true);
    assert_int_equal(released(&of, &m, 2), 2);
    assert_true(holds(&m, 0) && !holds(&m, 2));
    wait_at(&of, 2, false); // it has left
    assert_int_equal(released(&of, &m, 3), 0);
    wait_at(&of, 2, true);
    wait_at(&of, 0, false);
    wait_at(&of, 0, true); // the next one comes at once
    assert_int_equal(released(&of, &m, 4), 2);
    assert_true(holds(&m, 0));
    wait_at(&of, 2, false);
    assert_int_equal(released(&of, &m, 5), 0);
    wait_at(&of, 0, false);
    assert_int_equal(released(&of, &m, 6), NONE);
}

static void by_priority_the_first_lane_of_the_list_that_waits_is_next(void **state)
{
    three_lanes of;

    make_lanes(&of, SCENE_MERGE_PRIORITY, 1);
    merges m = merges_of(&of.scene, 0.1);
    for (size_t k = 0; k < LANES; k++)
        wait_at(&of, k, true);
    for (uint64_t step = 0; step < 4; step++) {
        assert_int_equal(released(&of, &m, step), 0);
        of.eyes[0].n_left++;
    }
    wait_at(&of, 0, false);
    assert_int_equal(released(&of, &m, 4), 1);
    wait_at(&of, 0, true); // a release is not cut short
    assert_int_equal(released(&of, &m, 5), 1);
    of.eyes[1].n_left++;
    assert_int_equal(released(&of, &m, 6), 0);
}

static void a_release_ends_by_parts_or_by_time_or_with_its_lane(void **state)
{
    three_lanes of;

    make_lanes(&of, SCENE_MERGE_IN_TURN, 3);
    of.merge.time = 1.0;
    merges m = merges_of(&of.scene, 0.1);
    wait_at(&of, 0, true);
    wait_at(&of, 1, true);
    assert_int_equal(released(&of, &m, 0), 0);
    of.eyes[0].n_left += 2;
    assert_int_equal(released(&of, &m, 9), 0);
    of.eyes[0].n_left += 1; // three have left
    assert_int_equal(released(&of, &m, 9), 1);
    assert_int_equal(released(&of, &m, 18), 1);
    assert_int_equal(released(&of, &m, 19), 0); // after 10 steps
    of.eyes[0].is_broken = false; // a gap between two parts, which its clear_time bridges
    assert_int_equal(released(&of, &m, 20), 0);
    of.eyes[0].is_blocked = false;
    assert_int_equal(released(&of, &m, 21), 1);
}

static void a_gap_passes_from_one_release_to_the_next(void **state)
{
    three_lanes of;

    make_lanes(&of, SCENE_MERGE_IN_TURN, 1);
    of.merge.gap = 0.5;
    merges m = merges_of(&of.scene, 0.1);
    wait_at(&of, 0, true);
    wait_at(&of, 1, true);
    assert_int_equal(released(&of, &m, 2), 0);
    of.eyes[0].n_left++;
    assert_int_equal(released(&of, &m, 3), NONE);
    assert_true(holds(&m, 0) && holds(&m, 1));
    assert_int_equal(released(&of, &m, 7), NONE);
    assert_int_equal(released(&of, &m, 8), 1);
}

// ---- runs

enum { PARTS = 3, UPPER = 0, LOWER = 1 };

// Two lanes, one cylinder of 6 cm wide and fuller than their merge lets through, end at a belt of 4 m, on which all stay
// that came until the end of the run.
static void make_merge(scene *s)
{
    static const vec2 upper[] = { { 0, 0.2 }, { 0.6, 0.2 }, { 0.6, 0.28 }, { 0, 0.28 } },
                      lower[] = { { 0, 0.02 }, { 0.6, 0.02 }, { 0.6, 0.1 }, { 0, 0.1 } },
                      line[] = { { 0.6, 0 }, { 4.6, 0 }, { 4.6, 0.3 }, { 0.6, 0.3 } };
    static const double middle[] = { 0.24, 0.06 };

    helper_scene_belt(s, 4.6, 0.3, 0.02, NULL, 0);
    s->macro.closure = SCENE_CONGESTED;
    s->initial.type = SCENE_INITIAL_EMPTY;
    s->duration = 10.0;
    s->output.curve_every = 0.1;
    s->output.snapshot_every = 5.0;
    s->cargo[0].shape.radius = 0.03;
    s->cargo[0].shape.height = 0.05;
    helper_scene_add_belt(s, (vec2){ 0.4, 0.0 }, upper, 4);
    helper_scene_add_belt(s, (vec2){ 0.4, 0.0 }, lower, 4);
    helper_scene_add_belt(s, (vec2){ 0.4, 0.0 }, line, 4);
    s->n_eyes = 2;
    s->eyes = memory_alloc(2, sizeof *s->eyes);
    s->n_merges = 1;
    s->merges = memory_alloc(1, sizeof *s->merges);
    scene_merge_init(s->merges);
    s->merges[0].parts = PARTS;
    s->merges[0].gap = 1.0;
    s->merges[0].n_lanes = 2;
    s->merges[0].lanes = memory_alloc(2, sizeof *s->merges[0].lanes);
    memory_free(s->counters);
    s->n_counters = 2;
    s->counters = memory_alloc(2, sizeof *s->counters);
    for (size_t k = 0; k < 2; k++) {
        scene_feed *feed = helper_scene_add_feed(s, SCENE_WEST, SCENE_ARRIVALS_REGULAR, 2.0);
        feed->line[0].y = middle[k] - 0.035;
        feed->line[1].y = middle[k] + 0.035;
        for (int side = -1; side <= 1; side += 2) {
            const double y = middle[k] + 0.04 * side;
            helper_scene_add_obstacle(s, (vec2[]){ { 0.0, y }, { 0.6, y } }, 2, SCENE_SEALED);
        }
        scene_photo_eye_init(&s->eyes[k]);
        s->eyes[k].line[0] = (vec2){ 0.59, middle[k] - 0.03 };
        s->eyes[k].line[1] = (vec2){ 0.59, middle[k] + 0.03 };
        s->eyes[k].clear_time = 0.6;
        s->merges[0].lanes[k] = (scene_lane){ k, k };
        scene_counter_init(&s->counters[k]);
        s->counters[k].rect.x_min = 0.6;
        s->counters[k].rect.x_max = 4.6;
        s->counters[k].rect.y_min = k == UPPER ? 0.15 : 0.0;
        s->counters[k].rect.y_max = k == UPPER ? 0.3 : 0.15;
    }
    helper_scene_resolve(s);
}

// Parts come over in batches of PARTS from either lane, of which the last one may not be complete.
static void check_batches(const helper_run_log *log)
{
    int n_batch = 0, of_batch = LOWER, n_batches = 0;

    for (size_t k = 1; k < log->n_samples; k++) {
        for (int lane = 0; lane < 2; lane++) {
            const double came = log->values[k][lane] - log->values[k - 1][lane];
            if (came == 0.0)
                continue;
            if (lane != of_batch) {
                assert_int_equal(n_batch, n_batches > 0 ? PARTS : 0);
                n_batch = 0;
                n_batches++;
                of_batch = lane;
            }
            n_batch += (int)came;
        }
    }
    assert_true(n_batches >= 4);
}

static void two_lanes_that_wait_come_in_batches_and_stops_change_no_bit(void **state)
{
    static const run_model models[] = { RUN_MICRO, RUN_MACRO };
    double came[2][2];

    for (int m = 0; m < 2; m++) {
        scene s;
        make_merge(&s);
        // Before a release, and while one goes on.
        helper_run_log *log = helper_run_check_stops(
            &s, models[m], 4, HELPER_AMOUNT(1, 2), (helper_run_threads){ .before = 3, .after = 2 });
        size_t n_held = 0;
        for (size_t k = 0; k < log->n_changes; k++)
            n_held += log->changes[k].type == FRAME_CHANGE_BELT &&
                      log->changes[k].state == BELT_STOPS_BY_MERGE;
        assert_true(n_held >= 4);
        if (models[m] == RUN_MICRO)
            check_batches(log);
        for (size_t lane = 0; lane < 2; lane++)
            came[m][lane] = helper_run_at(log, s.duration)[lane];
        helper_run_free(log);
        scene_fini(&s);
    }
    // A density has no parts of its own: a part more or less of each batch stays in the lane's last cells.
    for (size_t lane = 0; lane < 2; lane++)
        assert_near(came[1][lane], came[0][lane], PARTS);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(
            lanes_are_released_in_turn_and_those_in_which_nothing_waits_are_passed_over),
        cmocka_unit_test(by_priority_the_first_lane_of_the_list_that_waits_is_next),
        cmocka_unit_test(a_release_ends_by_parts_or_by_time_or_with_its_lane),
        cmocka_unit_test(a_gap_passes_from_one_release_to_the_next),
        cmocka_unit_test(two_lanes_that_wait_come_in_batches_and_stops_change_no_bit),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
