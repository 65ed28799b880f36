// A straight belt, a curve of 90 degrees and a straight belt in both models. Expected values are derived.

#include "core/base/memory.h"
#include "tests/unit/core/helper_run.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>

#define INNER  0.4
#define OUTER  0.8
#define SPEED  0.4
#define BEFORE 1.0  // length of the first belt, m
#define BEHIND 0.6  // and of the last one, m
#define RATE   12.0 // of the feed, 1/s

enum { PIECES = 24 };

static void add_rail(scene *s, double radius)
{
    vec2 rail[PIECES + 3];

    rail[0] = (vec2){ -BEFORE, -radius };
    for (int k = 0; k <= PIECES; k++) {
        const double at = 0.5 * M_PI * (k - PIECES) / PIECES;
        rail[k + 1] = (vec2){ radius * cos(at), radius * sin(at) };
    }
    rail[PIECES + 2] = (vec2){ radius, BEHIND };
    (void)helper_scene_add_obstacle(s, rail, PIECES + 3, SCENE_SEALED);
}

// The curve turns about the origin, from the south to the east.
static void make_scene(scene *s)
{
    const vec2 before[] = {
        { -BEFORE, -OUTER }, { 0.0, -OUTER }, { 0.0, -INNER }, { -BEFORE, -INNER }
    };
    const vec2 behind[] = { { INNER, 0.0 }, { OUTER, 0.0 }, { OUTER, BEHIND }, { INNER, BEHIND } };

    scene_init(s);
    s->duration = 20.0;
    s->domain = (scene_rect){ -BEFORE, OUTER, -OUTER, BEHIND };
    s->edges[SCENE_EAST] = s->edges[SCENE_SOUTH] = SCENE_EDGE_WALL;
    s->edges[SCENE_NORTH] = SCENE_EDGE_OUTFLOW;
    s->cargo[0].shape = (scene_shape){ .type = SCENE_CYLINDER, .radius = 0.033, .height = 0.115 };
    s->cargo[0].mass = 0.35;
    s->output.curve_every = 0.1;
    (void)helper_scene_add_belt(s, (vec2){ SPEED, 0.0 }, before, 4);
    (void)helper_scene_add_arc(s, SPEED, INNER, OUTER, -90.0, 0.0);
    (void)helper_scene_add_belt(s, (vec2){ 0.0, SPEED }, behind, 4);
    add_rail(s, INNER);
    add_rail(s, OUTER);
    scene_feed *feed = helper_scene_add_feed(s, SCENE_WEST, SCENE_ARRIVALS_REGULAR, RATE);
    feed->line[0] = (vec2){ -BEFORE, -OUTER + 0.05 };
    feed->line[1] = (vec2){ -BEFORE, -INNER - 0.05 };
    helper_scene_resolve(s);
}

// What leaves in 10 s is what enters in them, and nothing falls. As all of a curve turns alike, each part needs the same time
// for it, whatever its way.
static void what_enters_leaves_behind_a_curve_in_both_models(void **state)
{
    static helper_run_log logs[2];
    const double way = BEFORE + 0.5 * M_PI * 0.5 * (INNER + OUTER) + BEHIND;
    double passed[2];

    for (int k = 0; k < 2; k++) {
        scene s;
        make_scene(&s);
        logs[k].model = k == 0 ? RUN_MACRO : RUN_MICRO;
        assert_int_equal(helper_run(&s, 1, 0, &logs[k]), BF_OK);
        const double *first = helper_run_at(&logs[k], 10.0), *last = helper_run_at(&logs[k], 20.0);
        passed[k] = last[1] - first[1];
        assert_true(last[2] == 0.0);
        assert_near(passed[k], 10.0 * RATE, 0.02 * 10.0 * RATE);
        // Inside is what has entered while one part is on its way.
        assert_near(last[0], RATE * way / SPEED, 0.02 * RATE * way / SPEED);
        scene_fini(&s);
    }
    assert_near(passed[0], passed[1], 0.02 * passed[1]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_enters_leaves_behind_a_curve_in_both_models),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
