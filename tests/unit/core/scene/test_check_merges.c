// Unit tests of the checks of merges.

#include "core/base/memory.h"
#include "tests/unit/core/helper_faults.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <stdio.h>

enum { LANES = 3 };

// Three lanes beside each other that end at a belt.
static void make_scene(scene *s)
{
    helper_scene_belt(s, 2.0, 0.9, 0.05, NULL, 0);
    s->initial.type = SCENE_INITIAL_EMPTY;
    s->n_eyes = LANES;
    s->eyes = memory_alloc(LANES, sizeof *s->eyes);
    s->n_merges = 1;
    s->merges = memory_alloc(1, sizeof *s->merges);
    scene_merge_init(s->merges);
    s->merges[0].n_lanes = LANES;
    s->merges[0].lanes = memory_alloc(LANES, sizeof *s->merges[0].lanes);
    for (size_t k = 0; k < LANES; k++) {
        const double low = 0.3 * (double)k, high = low + 0.3;
        const vec2 outline[] = { { 0, low }, { 1, low }, { 1, high }, { 0, high } };
        helper_scene_add_belt(s, (vec2){ 0.4, 0.0 }, outline, 4);
        scene_photo_eye_init(&s->eyes[k]);
        s->eyes[k].line[0] = (vec2){ 0.9, low };
        s->eyes[k].line[1] = (vec2){ 0.9, high };
        s->merges[0].lanes[k] = (scene_lane){ k, k };
    }
    const vec2 line[] = { { 1, 0 }, { 2, 0 }, { 2, 0.9 }, { 1, 0.9 } };
    helper_scene_add_belt(s, (vec2){ 0.4, 0.0 }, line, 4);
    helper_scene_add_feed(s, SCENE_WEST, SCENE_ARRIVALS_REGULAR, 1.0);
}

static void bad_id(scene *s)
{
    snprintf(s->merges[0].id, sizeof s->merges[0].id, "a merge");
}

static void one_lane(scene *s)
{
    s->merges[0].n_lanes = 1;
}

static void many_lanes(scene *s)
{
    scene_lane *all = memory_alloc(SCENE_LANES_MAX + 1, sizeof *all);

    for (size_t k = 0; k <= SCENE_LANES_MAX; k++)
        all[k] = s->merges[0].lanes[k % LANES];
    memory_free(s->merges[0].lanes);
    s->merges[0].lanes = all;
    s->merges[0].n_lanes = SCENE_LANES_MAX + 1;
}

static void no_belt(scene *s)
{
    s->merges[0].lanes[1].belt = s->n_belts;
}

static void no_eye(scene *s)
{
    s->merges[0].lanes[1].eye = s->n_eyes;
}

static void same_belt(scene *s)
{
    s->merges[0].lanes[2].belt = 0;
}

static void same_eye(scene *s)
{
    s->merges[0].lanes[2].eye = 1;
}

static void eye_of_a_density(scene *s)
{
    s->eyes[2].density_ratio = 0.5;
}

static void scheduled_belt(scene *s)
{
    helper_scene_schedule(&s->belts[1], 1, (double[]){ 1.0 }, (double[]){ 0.5 });
}

static void commanded_belt(scene *s)
{
    s->n_actions = 1;
    s->actions = memory_alloc(1, sizeof *s->actions);
    scene_action_init(s->actions);
    s->actions[0].eye = 0;
    s->actions[0].type = SCENE_ACTION_BELT;
    s->actions[0].target = 2;
    s->actions[0].value = 0.0;
}

static void no_parts(scene *s)
{
    s->merges[0].parts = 0;
}

static void half_a_part(scene *s)
{
    s->merges[0].parts = 1.5;
}

static void no_time(scene *s)
{
    s->merges[0].time = 0.0;
}

static void gap_backwards(scene *s)
{
    s->merges[0].gap = -1.0;
}

static void no_order(scene *s)
{
    s->merges[0].order = SCENE_MERGE_ORDER_COUNT;
}

static void what_is_wrong_is_pointed_at(void **unused)
{
    static const helper_faults_case bad[] = {
        { bad_id, "/merges/0/id", "letters" },
        { one_lane, "/merges/0/lanes", "2 to 16 lanes, not 1" },
        { many_lanes, "/merges/0/lanes", "2 to 16 lanes, not 17" },
        { no_belt, "/merges/0/lanes/1/belt", "the id of a belt" },
        { no_eye, "/merges/0/lanes/1/photo_eye", "the id of a photo eye" },
        { same_belt, "/merges/0/lanes/2/belt", "another lane" },
        { same_eye, "/merges/0/lanes/2/photo_eye", "another lane" },
        { eye_of_a_density, "/merges/0/lanes/2/photo_eye", "sees no parts" },
        { scheduled_belt, "/merges/0/lanes/1/belt", "speed_schedule" },
        { commanded_belt, "/merges/0/lanes/2/belt", "commanded by an action" },
        { no_parts, "/merges/0/parts", "at least 1" },
        { half_a_part, "/merges/0/parts", "a whole number" },
        { no_time, "/merges/0/time_s", "above 0" },
        { gap_backwards, "/merges/0/gap_s", "at least 0" },
        { no_order, "/merges/0/order", "is not an order" },
    };
    scene s;

    (void)unused;
    make_scene(&s);
    helper_faults_none(&s);
    helper_faults_each(make_scene, bad, sizeof bad / sizeof *bad);
}

static void a_release_is_of_one_part_unless_it_has_a_limit(void **unused)
{
    scene s;

    (void)unused;
    make_scene(&s);
    helper_scene_resolve(&s);
    assert_true(s.merges[0].parts == 1.0);
    assert_true(s.belts[0].is_commanded && s.belts[2].is_commanded && !s.belts[3].is_commanded);
    scene_fini(&s);
    make_scene(&s);
    s.merges[0].time = 5.0;
    helper_scene_resolve(&s);
    assert_true(s.merges[0].parts == INFINITY);
    scene_fini(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_wrong_is_pointed_at),
        cmocka_unit_test(a_release_is_of_one_part_unless_it_has_a_limit),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
