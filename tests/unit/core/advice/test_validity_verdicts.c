// Verdicts on scenes well inside and far outside of what was compared, in both models.

#include "core/advice/validity.h"

#include "core/base/memory.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <string.h>

enum { INSIDE = -1 };

// A change of the paper's Example 1, by which it gets another verdict.
typedef void change(scene *s);

static void feed_it(scene *s, double rate)
{
    scene_feed *feed = memory_alloc(1, sizeof *feed);

    assert_non_null(feed);
    *feed = (scene_feed){ .is_edge = true,
                          .edge = SCENE_WEST,
                          .line = { { 0.0, 0.05 }, { 0.0, 0.55 } },
                          .end = INFINITY,
                          .count = INFINITY,
                          .rate = rate,
                          .batch_size = 10,
                          .n_cargo = s->n_cargo,
                          .seed = 1 };
    for (uint32_t k = 0; k < s->n_cargo; k++)
        feed->cargo[k] = (scene_feed_kind){ k, 1.0 };
    s->feeds = feed;
    s->n_feeds = 1;
    s->initial.type = SCENE_INITIAL_EMPTY;
    s->duration = 60.0;
}

static void nothing(scene *s)
{
}

static void congested(scene *s)
{
    s->macro.closure = SCENE_CONGESTED;
}

static void thin_feed(scene *s)
{
    congested(s);
    feed_it(s, 30.0);
}

static void full_feed(scene *s)
{
    congested(s);
    feed_it(s, 130.0);
    s->feeds[0].line[0].y = s->domain.y_min;
    s->feeds[0].line[1].y = s->domain.y_max;
}

static void full_feed_on_a_part(scene *s)
{
    full_feed(s);
    s->feeds[0].line[0].y += 0.05;
}

static void full_dispersive_feed(scene *s)
{
    feed_it(s, 130.0);
}

static void batches(scene *s)
{
    thin_feed(s);
    s->feeds[0].arrivals = SCENE_ARRIVALS_BATCH;
}

static void cans(scene *s)
{
    thin_feed(s);
    s->cargo[0].shape.radius = 0.033;
    s->cargo[0].shape.height = 0.115;
    s->cargo[0].mass = 0.35;
}

static void light_cans(scene *s)
{
    cans(s);
    s->cargo[0].shape.height = 0.03;
}

static void barrels(scene *s)
{
    thin_feed(s);
    s->cargo[0].shape.radius = 0.4;
    s->cargo[0].mass = 300.0;
}

static void cartons(scene *s)
{
    thin_feed(s);
    s->cargo[0].shape = (scene_shape){ SCENE_BOX, .height = 0.008, .length = 0.02, .width = 0.013 };
}

static void pencils_and_kegs(scene *s)
{
    s->cargo[1] = s->cargo[0];
    s->cargo[1].mass = 12.5;
    s->n_cargo = 2;
    s->is_mix = true;
    thin_feed(s);
}

static void icy_belt(scene *s)
{
    congested(s);
    s->micro.contact[SCENE_CONVEYOR_CARGO].friction = 0.1;
}

static void frictionless_belt(scene *s)
{
    congested(s);
    s->micro.contact[SCENE_CONVEYOR_CARGO].friction = 0.0;
}

static void rough_walls(scene *s)
{
    congested(s);
    s->micro.wall_friction = 1.0;
}

static void sharp_friction(scene *s)
{
    congested(s);
    s->micro.contact[SCENE_CONVEYOR_CARGO].tanh_linear = 1000.0;
}

static void other_jam(scene *s)
{
    congested(s);
    s->macro.jam_density = 0.5;
}

static void commanded_belt(scene *s)
{
    congested(s);
    s->actions = memory_alloc(1, sizeof *s->actions);
    assert_non_null(s->actions);
    s->n_actions = 1;
    s->actions[0] = (scene_action){ .type = SCENE_ACTION_BELT, .value = 0.0 };
    s->belts[0].is_commanded = true;
}

static void add_sinks(scene *s, size_t n)
{
    congested(s);
    s->sinks = memory_alloc(n, sizeof *s->sinks);
    assert_non_null(s->sinks);
    s->n_sinks = n;
    for (size_t k = 0; k < n; k++)
        scene_sink_init(&s->sinks[k]);
}

static void two_sinks(scene *s)
{
    add_sinks(s, 2);
}

static void three_sinks(scene *s)
{
    add_sinks(s, 3);
}

static void dispersive_sinks(scene *s)
{
    add_sinks(s, 1);
    s->macro.closure = SCENE_DISPERSIVE;
}

static void fast_takeaway(scene *s)
{
    static const vec2 half[] = { { 0.8, 0.0 }, { 1.0, 0.0 }, { 1.0, 0.6 }, { 0.8, 0.6 } };

    thin_feed(s);
    helper_scene_add_belt(s, (vec2){ 1.0, 0.0 }, half, 4);
}

static void full_takeaway(scene *s)
{
    fast_takeaway(s);
    s->feeds[0].rate = 460.0;
}

static void three_guides(scene *s)
{
    congested(s);
    for (int k = 0; k < 3; k++) {
        const double y = 0.58 + 0.001 * k;
        helper_scene_add_obstacle(s, (vec2[]){ { 0.1 * k, y }, { 0.1 * k + 0.05, y } }, 2,
                                  SCENE_SEALED);
    }
}

static void swinging_plate(scene *s)
{
    static const double times[] = { 0.0, 1.0 }, angles[] = { 0.0, 0.2 };

    congested(s);
    s->obstacles[0].pivot = s->obstacles[0].path[0];
    s->obstacles[0].turn = helper_scene_series(2, times, angles, INFINITY);
}

static void long_queue(scene *s)
{
    full_feed(s);
    s->domain.x_min = -1.0;
    s->feeds[0].line[0].x = s->feeds[0].line[1].x = -1.0;
}

static const struct {
    const char *name;
    change *change;
    bool is_micro;
    double overlap; // of the microscopic model
    int figure;     // that is told, INSIDE: all were compared
    bool is_never;  // it was never compared, else it is outside
} verdicts[] = {
    { "the paper's heap", nothing, false, 0.0, INSIDE, false },
    { "the same, congested", congested, false, 0.0, INSIDE, false },
    { "the same as hard parts", nothing, true, 0.01, INSIDE, false },
    { "the same as soft parts", nothing, true, 0.7, VALIDITY_OVERLAP, false },
    { "a thin feed", thin_feed, false, 0.0, INSIDE, false },
    { "a thin feed of parts", thin_feed, true, 0.01, INSIDE, false },
    { "a feed beyond the outlet", full_feed, false, 0.0, INSIDE, false },
    { "one on a part of its belt", full_feed_on_a_part, false, 0.0, VALIDITY_BESIDE, false },
    { "the same, dispersive", full_dispersive_feed, false, 0.0, VALIDITY_LOAD, false },
    { "a long queue of parts", long_queue, true, 0.01, VALIDITY_QUEUE, false },
    { "batches", batches, false, 0.0, VALIDITY_BATCH, true },
    { "cans", cans, false, 0.0, VALIDITY_TIPPING, false },
    { "their outlet", light_cans, false, 0.0, VALIDITY_OPENING, false },
    { "barrels", barrels, false, 0.0, VALIDITY_DIAMETER, false },
    { "their mass", barrels, false, 0.0, VALIDITY_MASS, false },
    { "cans that can tip", cans, true, 0.01, VALIDITY_TIPPING, false },
    { "fed cartons", cartons, false, 0.0, VALIDITY_SHAPE, false },
    { "fed cartons in space", cartons, true, 0.01, VALIDITY_SHAPE, true },
    { "a mix of masses", pencils_and_kegs, true, 0.01, VALIDITY_MASSES, true },
    { "an icy belt", icy_belt, false, 0.0, VALIDITY_BELT_FRICTION, false },
    { "a belt without friction", frictionless_belt, false, 0.0, VALIDITY_ACCELERATION, true },
    { "rough walls", rough_walls, false, 0.0, VALIDITY_WALL_FRICTION, false },
    { "sharp friction", sharp_friction, false, 0.0, VALIDITY_SMOOTHING, false },
    { "another jam density", other_jam, false, 0.0, VALIDITY_CONSTANTS, true },
    { "a belt that is stopped", commanded_belt, false, 0.0, VALIDITY_SCHEDULES, false },
    { "who stops it", commanded_belt, false, 0.0, VALIDITY_COMMANDS, false },
    { "two sinks", two_sinks, false, 0.0, INSIDE, false },
    { "three sinks", three_sinks, false, 0.0, VALIDITY_SINKS, false },
    { "a sink of the paper's closure", dispersive_sinks, false, 0.0, VALIDITY_SINKS, true },
    { "a fast takeaway", fast_takeaway, false, 0.0, VALIDITY_RATIO, false },
    { "its load", full_takeaway, false, 0.0, VALIDITY_TRANSFER, false },
    { "many guides", three_guides, false, 0.0, VALIDITY_GUIDES, false },
    { "a plate that swings", swinging_plate, false, 0.0, VALIDITY_MOTIONS, false },
    { "what it comes to", swinging_plate, false, 0.0, VALIDITY_SWEPT, true },
};

static bool tells(const validity_item *items, size_t n, int figure)
{
    for (size_t k = 0; k < n; k++) {
        if ((int)items[k].figure == figure)
            return true;
    }
    return false;
}

static void none_is_wrong_and_none_is_missing(void **state)
{
    static validity of;

    for (size_t k = 0; k < sizeof verdicts / sizeof *verdicts; k++) {
        scene s;
        helper_scene_example(&s, 60.0, SCENE_SEALED);
        verdicts[k].change(&s);
        assert_int_equal(verdicts[k].is_micro
                             ? validity_of_parts(&s, verdicts[k].overlap, &of, NULL)
                             : validity_of(&s, &of, NULL),
                         BF_OK);
        const bool is_told = verdicts[k].figure != INSIDE;
        const bool is_right =
            of.is_compared != is_told &&
            (!is_told || tells(verdicts[k].is_never ? of.never : of.items,
                               verdicts[k].is_never ? of.n_never : of.n, verdicts[k].figure));
        if (!is_right) {
            print_error("%s:\n", verdicts[k].name);
            for (size_t i = 0; i < of.n + of.n_never; i++)
                print_error("  %s\n", i < of.n ? of.items[i].detail : of.never[i - of.n].detail);
        }
        assert_true(is_right);
        scene_fini(&s);
    }
}

// Three belts at three velocities: `dispersive` was compared on one alone, which has words, `congested` on up to two.
static void a_range_that_another_model_has_more_of_is_told_in_numbers(void **state)
{
    static const char *const expected[] = {
        [SCENE_DISPERSIVE] = "The density model was compared with moving parts for one alone.",
        [SCENE_CONGESTED] = "The density model was compared with moving parts for up to 2.",
    };
    static validity of;

    for (int closure = 0; closure < SCENE_CLOSURE_COUNT; closure++) {
        bool is_found = false;
        scene s;
        helper_scene_example(&s, 60.0, SCENE_SEALED);
        for (int k = 0; k < 2; k++) {
            const double y = 0.2 * (k + 1);
            const vec2 strip[] = { { 0.0, y }, { 1.0, y }, { 1.0, y + 0.2 }, { 0.0, y + 0.2 } };
            helper_scene_add_belt(&s, (vec2){ 0.41 + 0.01 * k, 0.0 }, strip, 4);
        }
        s.macro.closure = (scene_closure)closure;
        helper_scene_resolve(&s);
        assert_int_equal(validity_of(&s, &of, NULL), BF_OK);
        for (size_t k = 0; k < of.n; k++) {
            if (of.items[k].figure != VALIDITY_BELTS)
                continue;
            assert_string_equal(of.items[k].comparison, expected[closure]);
            is_found = true;
        }
        assert_true(is_found);
        scene_fini(&s);
    }
}

static void another_jam_density_is_pointed_at(void **state)
{
    static validity of;
    bool is_found = false;
    scene s;

    helper_scene_example(&s, 60.0, SCENE_SEALED);
    other_jam(&s);
    assert_int_equal(validity_of(&s, &of, NULL), BF_OK);
    for (size_t k = 0; k < of.n_never; k++)
        is_found = is_found || (of.never[k].figure == VALIDITY_CONSTANTS &&
                                strcmp(of.never[k].pointer, "/macro/jam_density") == 0);
    assert_true(is_found);
    scene_fini(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(none_is_wrong_and_none_is_missing),
        cmocka_unit_test(a_range_that_another_model_has_more_of_is_told_in_numbers),
        cmocka_unit_test(another_jam_density_is_pointed_at),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
