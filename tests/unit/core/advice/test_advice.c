// What is said before a run: rates that belts cannot carry, actions in a circle, openings, steps; and doubts about a run.

#include "core/advice/advice.h"

#include "core/base/memory.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

// A belt of 1 x 0.6 m at 0.4 m/s, of which the second half may be another belt, and a feed over 0.4 m of its west side.
static void make_scene(scene *s, bool has_second)
{
    const vec2 right[] = { { 0.5, 0 }, { 1, 0 }, { 1, 0.6 }, { 0.5, 0.6 } };

    helper_scene_belt(s, 1.0, 0.6, 0.005, (scene_pose[]){ { 0.5, 0.3, 0.0 } }, 1);
    helper_scene_add_belt(s, (vec2){ 0.4, 0.0 }, NULL, 0);
    if (has_second)
        helper_scene_add_belt(s, (vec2){ 0.4, 0.0 }, right, 4);
    scene_feed *feed = helper_scene_add_feed(s, SCENE_WEST, SCENE_ARRIVALS_REGULAR, 1.0);
    feed->line[0].y = 0.1;
    feed->line[1].y = 0.5;
}

// The warnings about a scene, which is freed.
static const review_warnings *warnings_of(scene *s)
{
    static advice given;
    static bf_faults faults;

    helper_scene_resolve(s);
    faults = (bf_faults){ 0 };
    scene_check(s, &faults);
    if (faults.n > 0)
        fail_msg("%s: %s", faults.items[0].pointer, faults.items[0].text);
    assert_int_equal(advice_of(s, RUN_MICRO, &given, NULL), BF_OK);
    scene_fini(s);
    return &given.warnings;
}

// The warning at a pointer; NULL: there is none.
static const review_warning *warning_at(const review_warnings *found, const char *pointer)
{
    for (size_t k = 0; k < found->n; k++)
        if (strcmp(found->items[k].pointer, pointer) == 0)
            return &found->items[k];
    return NULL;
}

// 2004 parts/m2 at 0.4 m/s over 0.4 m and the width of a part, 1/sqrt(2004) m: 338.55 parts/s.
static void rates_beyond_the_belts_are_warned_of(void **unused)
{
    scene s;

    make_scene(&s, false);
    s.feeds[0].rate = 338.5;
    assert_int_equal(warnings_of(&s)->n, 0);
    make_scene(&s, false);
    s.feeds[0].rate = 338.6;
    const review_warnings *found = warnings_of(&s);
    assert_int_equal(found->n, 1);
    assert_string_equal(found->items[0].pointer, "/feeds/0/rate_per_s");
    assert_non_null(
        strstr(found->items[0].meaning, "up to 338.6 parts/s, but belts carry at most 338.5"));
}

// An action on a belt.
typedef struct rule {
    size_t eye;
    bool when_blocked;
    size_t belt;
    double factor;
} rule;

// Where the beams of photo eyes begin and end, x; all of them go from y = 0.1 m to 0.5 m.
static const double late[][2] = { { 0.7, 0.7 } };
static const double both[][2] = { { 0.3, 0.3 }, { 0.7, 0.7 } };
static const double across[][2] = { { 0.4, 0.6 } };

static void add_eyes(scene *s, size_t n, const double (*places)[2])
{
    s->n_eyes = n;
    s->eyes = memory_alloc(n, sizeof *s->eyes);
    for (size_t k = 0; k < n; k++) {
        scene_photo_eye_init(&s->eyes[k]);
        s->eyes[k].line[0] = (vec2){ places[k][0], 0.1 };
        s->eyes[k].line[1] = (vec2){ places[k][1], 0.5 };
    }
}

static void add_rules(scene *s, size_t n, const rule *rules)
{
    s->n_actions = n;
    s->actions = memory_alloc(n, sizeof *s->actions);
    for (size_t k = 0; k < n; k++) {
        scene_action_init(&s->actions[k]);
        s->actions[k].eye = rules[k].eye;
        s->actions[k].when_blocked = rules[k].when_blocked;
        s->actions[k].type = SCENE_ACTION_BELT;
        s->actions[k].target = rules[k].belt;
        s->actions[k].value = rules[k].factor;
    }
}

// The warnings about one belt or two with photo eyes and actions.
static const review_warnings *warnings_with(size_t n_belts, size_t n_eyes, const double (*eyes)[2],
                                            size_t n_rules, const rule *rules)
{
    scene s;

    make_scene(&s, n_belts > 1);
    add_eyes(&s, n_eyes, eyes);
    add_rules(&s, n_rules, rules);
    return warnings_of(&s);
}

static void a_belt_that_its_own_cargo_stops_is_warned_of(void **unused)
{
    static const rule rules[] = { { 0, false, 0, 1.0 }, { 0, true, 0, 0.0 } };

    const review_warnings *found = warnings_with(1, 1, late, 2, rules);
    assert_int_equal(found->n, 1);
    assert_string_equal(found->items[0].pointer, "/actions/1");
    assert_non_null(strstr(found->items[0].meaning, "'eye-1' stops the belt 'main'"));
}

static void a_belt_that_goes_slower_is_not_stopped(void **unused)
{
    assert_int_equal(warnings_with(1, 1, late, 1, (rule[]){ { 0, true, 0, 0.1 } })->n, 0);
}

// The eye is above the next belt, which goes on: its cargo leaves.
static void a_belt_that_the_next_one_stops_is_in_order(void **unused)
{
    static const rule rules[] = { { 0, true, 0, 0.0 }, { 0, false, 0, 1.0 } };

    assert_int_equal(warnings_with(2, 1, late, 2, rules)->n, 0);
}

// Cargo stops the belt under it, and an eye above the other belt starts it again.
static void another_belt_may_start_it_again(void **unused)
{
    static const rule rules[] = { { 0, true, 0, 0.0 }, { 1, false, 0, 1.0 } };

    assert_int_equal(warnings_with(2, 2, both, 2, rules)->n, 0);
}

// Each of two belts is stopped by its own cargo and started by the eye of the other one.
static void two_belts_may_wait_for_each_other(void **unused)
{
    static const rule rules[] = {
        { 0, true, 0, 0.0 }, { 1, true, 1, 0.0 }, { 1, false, 0, 1.0 }, { 0, false, 1, 1.0 }
    };

    const review_warnings *found = warnings_with(2, 2, both, 4, rules);
    assert_int_equal(found->n, 2);
    assert_string_equal(found->items[0].pointer, "/actions/0");
    assert_string_equal(found->items[1].pointer, "/actions/1");
}

// The belt ends at 0.5 m, and the beam is at 0.7 m.
static void an_eye_beside_the_belts_is_warned_of(void **unused)
{
    const vec2 left[] = { { 0, 0 }, { 0.5, 0 }, { 0.5, 0.6 }, { 0, 0.6 } };
    scene s;
    bool is_said = false;

    make_scene(&s, false);
    s.belts[0].n_points = 4;
    s.belts[0].polygon = memory_alloc(4, sizeof *left);
    memcpy(s.belts[0].polygon, left, sizeof left);
    add_eyes(&s, 1, late);
    add_rules(&s, 1, (rule[]){ { 0, true, 0, 0.0 } });
    const review_warnings *found = warnings_of(&s);
    for (size_t k = 0; k < found->n; k++)
        is_said |= strcmp(found->items[k].pointer, "/photo_eyes/0/line_m") == 0;
    assert_true(is_said);
}

// A beam across both belts clears as long as one of them moves.
static void a_beam_above_a_moving_belt_clears(void **unused)
{
    assert_int_equal(warnings_with(2, 1, across, 1, (rule[]){ { 0, true, 0, 0.0 } })->n, 0);
}

// Ten times 105 s are needed; without the warm-up the run has 900 s.
static void failures_that_are_too_rare_for_the_run_are_warned_of(void **unused)
{
    for (int k = 0; k < 2; k++) {
        scene s;
        make_scene(&s, true);
        scene_stops *stops = &s.belts[1].stops;
        stops->failures = memory_alloc(1, sizeof *stops->failures);
        assert_non_null(stops->failures);
        stops->n_failures = 1;
        stops->failures[0] = (scene_failure){ .between = { 100.0, SCENE_TIME_EXPONENTIAL, 1.0 },
                                              .repair = { 5.0, SCENE_TIME_EXPONENTIAL, 1.0 } };
        s.output.curve_every = 1.0;
        s.output.snapshot_every = 10.0;
        s.warmup = 100.0;
        s.duration = k == 0 ? 1150.0 : 1000.0;
        const review_warning *found = warning_at(warnings_of(&s), "/belts/1/failures/0/mtbf_s");
        assert_true((found != NULL) == (k == 1));
        if (k == 1)
            assert_non_null(strstr(found->meaning, "about 1,050 s are needed"));
    }
}

static void add_plate(scene *s, double from, double to)
{
    helper_scene_add_obstacle(s, (vec2[]){ { 0.7, from }, { 0.7, to } }, 2, SCENE_SEALED);
}

static bool is_too_narrow(scene *s)
{
    const review_warning *found = warning_at(warnings_of(s), "/obstacles/0");

    return found != NULL &&
           strcmp(found->title, "Parts do not fit through the narrowest opening") == 0;
}

// Parts are 24 mm wide. A plate leaves 20 mm at its foot and 0.1 m at its tip, or those 20 mm alone; or 25 mm, for parts of
// which a kind is 24 and one is 30 mm wide.
static void an_opening_that_a_kind_does_not_fit_through_is_warned_of(void **unused)
{
    scene s;

    make_scene(&s, false);
    add_plate(&s, 0.02, 0.5);
    assert_false(is_too_narrow(&s));
    make_scene(&s, false);
    add_plate(&s, 0.02, 0.6);
    assert_true(is_too_narrow(&s));
    for (size_t n = 1; n <= 2; n++) {
        make_scene(&s, false);
        add_plate(&s, 0.025, 0.6);
        s.cargo[1] = s.cargo[0];
        s.cargo[1].shape.radius = 0.015;
        s.n_cargo = n;
        assert_true(is_too_narrow(&s) == (n == 2));
    }
}

static void both_models_warn_of_it(void **unused)
{
    static advice given;
    scene s;

    make_scene(&s, false);
    add_plate(&s, 0.02, 0.6);
    helper_scene_resolve(&s);
    for (int model = RUN_MACRO; model <= RUN_MICRO; model++) {
        bool is_found = false;
        assert_int_equal(advice_of(&s, (run_model)model, &given, NULL), BF_OK);
        for (size_t k = 0; k < given.warnings.n; k++)
            is_found = is_found || strcmp(given.warnings.items[k].meaning,
                                          "It is 0.02 m wide, and parts are up to 0.024 m wide "
                                          "where they are narrowest: those that have no other "
                                          "way stay before it.") == 0;
        assert_true(is_found);
    }
    scene_fini(&s);
}

// 295 and 305 times: the limit is 300. The density has no contacts.
static void masses_that_contacts_cannot_follow_are_warned_of(void **unused)
{
    static const double masses[][2] = { { 0.002, 0.59 }, { 0.002, 0.61 }, { 0.61, 0.002 } };
    static const char *const lightest[] = { NULL, "/cargo/0/mass_kg", "/cargo/1/mass_kg" };

    for (size_t k = 0; k < 3; k++)
        for (int model = RUN_MACRO; model <= RUN_MICRO; model++) {
            static advice given;
            const char *pointer = NULL;
            scene s;
            make_scene(&s, false);
            s.cargo[1] = s.cargo[0];
            s.n_cargo = 2;
            for (size_t kind = 0; kind < 2; kind++)
                s.cargo[kind].mass = masses[k][kind];
            helper_scene_resolve(&s);
            assert_int_equal(advice_of(&s, (run_model)model, &given, NULL), BF_OK);
            for (size_t n = 0; n < given.warnings.n; n++)
                if (strcmp(given.warnings.items[n].title,
                           "The masses of the kinds of parts differ too much") == 0)
                    pointer = given.warnings.items[n].pointer;
            if (model == RUN_MACRO || lightest[k] == NULL)
                assert_null(pointer);
            else
                assert_string_equal(pointer, lightest[k]);
            scene_fini(&s);
        }
}

// It is warned of once, and is no place at which cargo leaves the belts.
static void a_belt_outside_of_the_domain_is_warned_of(void **unused)
{
    static const vec2 beyond[] = { { 5.0, 0.0 }, { 6.0, 0.0 }, { 6.0, 0.3 }, { 5.0, 0.3 } };
    static advice given;
    size_t n = 0;
    scene s;

    make_scene(&s, false);
    helper_scene_add_belt(&s, (vec2){ 0.4, 0.0 }, beyond, 4);
    helper_scene_resolve(&s);
    assert_int_equal(advice_of(&s, RUN_MACRO, &given, NULL), BF_OK);
    for (size_t k = 0; k < given.warnings.n; k++)
        n += strcmp(given.warnings.items[k].title, "A belt lies outside of the domain") == 0;
    assert_int_equal(n, 1);
    for (size_t k = 0; k < given.validity.n_never; k++)
        assert_int_not_equal(given.validity.never[k].figure, VALIDITY_FALLS);
    scene_fini(&s);
}

static void no_memory_is_reported(void **unused)
{
    bf_status status = BF_ENOMEM;
    static advice given;
    scene s;

    make_scene(&s, false);
    helper_scene_resolve(&s);
    for (size_t n = 1; status != BF_OK; n++) {
        memory_plan_fault(n, 0);
        status = advice_of(&s, RUN_MACRO, &given, NULL);
        memory_plan_fault(0, 0);
        assert_true(status == BF_OK || status == BF_ENOMEM);
        assert_true(n < 1000);
    }
    scene_fini(&s);
}

static void results_beyond_what_can_be_trusted_are_doubted(void **state)
{
    frame_end end = { .peak = 1.4, .overlap_share = 0.05 };

    assert_int_equal(advice_doubts(RUN_MACRO, &end), 0);
    end.peak = 1.41;
    assert_int_equal(advice_doubts(RUN_MACRO, &end), ADVICE_DOUBT_DENSITY);
    end.overlap_share = 0.051; // and the density (18) of parts has no such bound
    assert_int_equal(advice_doubts(RUN_MICRO, &end), ADVICE_DOUBT_OVERLAP);
}

static void assert_warned_of_step(double step, size_t n)
{
    static advice given;
    scene s;

    helper_scene_example(&s, 60.0, SCENE_SEALED);
    s.macro.step = step;
    assert_int_equal(advice_of(&s, RUN_MACRO, &given, NULL), BF_OK);
    assert_int_equal(given.warnings.n, n);
    if (n > 0) {
        assert_string_equal(given.warnings.items[0].pointer, "/macro/step_s");
        assert_non_null(strstr(given.warnings.items[0].detail, "0.0021097"));
    }
    assert_int_equal(advice_of(&s, RUN_MICRO, &given, NULL), BF_OK);
    assert_int_equal(given.validity.subject, VALIDITY_PARTS_MODEL);
    assert_int_equal(given.warnings.n, given.validity.n + given.validity.n_never);
    scene_fini(&s);
}

// 0.005 m / (2 (0.395 m/s + 0.79 m/s)) = 2.1097 ms.
static void a_macroscopic_step_that_may_make_densities_negative_is_warned_of(void **state)
{
    assert_warned_of_step(0.0021, 0);
    assert_warned_of_step(0.00211, 1);
}

// A funnel is one thing that is warned of beside the step, and that in the words of the validity.
static void all_is_warned_of_that_lies_outside_the_validity(void **state)
{
    static const vec2 second[] = { { 0.7, 0.6 }, { 0.75, 0.58 } };
    static advice given;
    scene s;

    helper_scene_example(&s, 60.0, SCENE_SEALED);
    helper_scene_add_obstacle(&s, second, 2, SCENE_SEALED);
    s.macro.step = 0.00211;
    helper_scene_resolve(&s);
    assert_int_equal(advice_of(&s, RUN_MACRO, &given, NULL), BF_OK);
    assert_false(given.validity.is_compared);
    assert_true(given.validity.n >= 2);
    assert_int_equal(given.warnings.n, 1 + given.validity.n);
    for (size_t k = 0; k < given.validity.n; k++) {
        assert_string_equal(given.warnings.items[k + 1].title, given.validity.items[k].title);
        assert_string_equal(given.warnings.items[k + 1].meaning, given.validity.items[k].meaning);
        assert_string_equal(given.warnings.items[k + 1].pointer, given.validity.items[k].pointer);
    }
    assert_int_equal(advice_of(&s, RUN_MICRO, &given, NULL), BF_OK);
    assert_int_equal(given.validity.subject, VALIDITY_PARTS_MODEL);
    assert_int_equal(given.warnings.n, given.validity.n + given.validity.n_never);
    scene_fini(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rates_beyond_the_belts_are_warned_of),
        cmocka_unit_test(a_belt_that_its_own_cargo_stops_is_warned_of),
        cmocka_unit_test(a_belt_that_goes_slower_is_not_stopped),
        cmocka_unit_test(a_belt_that_the_next_one_stops_is_in_order),
        cmocka_unit_test(another_belt_may_start_it_again),
        cmocka_unit_test(two_belts_may_wait_for_each_other),
        cmocka_unit_test(a_beam_above_a_moving_belt_clears),
        cmocka_unit_test(an_eye_beside_the_belts_is_warned_of),
        cmocka_unit_test(failures_that_are_too_rare_for_the_run_are_warned_of),
        cmocka_unit_test(an_opening_that_a_kind_does_not_fit_through_is_warned_of),
        cmocka_unit_test(both_models_warn_of_it),
        cmocka_unit_test(results_beyond_what_can_be_trusted_are_doubted),
        cmocka_unit_test(a_macroscopic_step_that_may_make_densities_negative_is_warned_of),
        cmocka_unit_test(all_is_warned_of_that_lies_outside_the_validity),
        cmocka_unit_test(masses_that_contacts_cannot_follow_are_warned_of),
        cmocka_unit_test(a_belt_outside_of_the_domain_is_warned_of),
        cmocka_unit_test(no_memory_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
