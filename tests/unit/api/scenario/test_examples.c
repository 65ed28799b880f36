// The ready scenarios: found by name, in order, and what the paper describes.

#include "api/scenario/examples.h"

#include "api/scenario/scenario.h"
#include "core/run/run.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <string.h>

static scene read_example(const char *name)
{
    const example *item = examples_find(name);
    bf_faults faults = { 0 };
    bf_error err = { 0 };
    scene s;

    assert_non_null(item);
    if (scenario_read(item->document, item->n, &s, &faults, &err) != BF_OK)
        fail_msg("%s: %s: %s", name, err.pointer, err.text);
    return s;
}

static void all_examples_are_sound_and_sorted(void **unused)
{
    size_t n;
    const example *items = examples_list(&n);

    assert_true(n >= 12);
    for (size_t k = 0; k < n; k++) {
        scene s = read_example(items[k].name);
        assert_true(s.name[0] != '\0');
        assert_int_equal(strlen(items[k].document), items[k].n);
        assert_true(k == 0 || strcmp(items[k - 1].name, items[k].name) < 0);
        assert_ptr_equal(examples_find(items[k].name), &items[k]);
        scene_fini(&s);
    }
}

static void other_names_are_not_found(void **unused)
{
    assert_null(examples_find(""));
    assert_null(examples_find("example"));
    assert_null(examples_find("example-1.json"));
}

// 192 cylinders in front of a plate that ends at (0.75, 0.5): at 60 degrees it starts 0.5/tan(60)
// upstream of its end, at the belt's southern edge.
static void example_1_is_the_papers(void **unused)
{
    scene s = read_example("example-1");

    assert_int_equal(scene_parts(&s), 192);
    assert_true(s.duration == 6.0);
    assert_true(s.belts[0].velocity.x == 0.395 && s.belts[0].velocity.y == 0.0);
    assert_true(fabs(s.obstacles[0].path[0].x - (0.75 - 0.5 / sqrt(3.0))) < 1e-6);
    assert_true(fabs(s.obstacles[0].path[0].y) < 1e-6);
    assert_int_equal(s.obstacles[0].treatment, SCENE_SEALED);
    assert_true(s.macro.dispersion == 2.0 * 0.395);
    assert_string_equal(s.counters[0].id, "upstream");
    assert_true(s.counters[0].rect.x_max == 0.75);
    scene_fini(&s);
}

static void example_2_stands_across_the_belt(void **unused)
{
    scene s = read_example("example-2");

    assert_true(s.obstacles[0].path[0].x == 0.75 && s.obstacles[0].path[0].y == 0.0);
    assert_true(s.obstacles[0].path[1].x == 0.75 && s.obstacles[0].path[1].y == 0.5);
    scene_fini(&s);
}

static void example_3_disperses_at_every_density(void **unused)
{
    scene rings = read_example("example-3");
    scene lanes = read_example("example-3-lanes");

    assert_int_equal(rings.macro.heaviside, SCENE_HEAVISIDE_NONE);
    assert_int_equal(lanes.macro.heaviside, SCENE_HEAVISIDE_NONE);
    assert_true(rings.macro.mollifier == 1e4 && lanes.macro.mollifier == 1e3);
    assert_true(rings.duration == 0.5 && lanes.duration == 0.5);
    scene_fini(&rings);
    scene_fini(&lanes);
}

// The same scene as Example 1, solved in longer steps.
static void one_example_chooses_its_own_step(void **unused)
{
    scene s = read_example("example-1-implicit");
    scene paper = read_example("example-1");

    assert_int_equal(s.micro.integrator, SCENE_IMPLICIT);
    assert_true(s.micro.step == 0.0);
    assert_true(paper.micro.integrator == SCENE_VERLET && paper.micro.step == 1e-5);
    assert_memory_equal(s.obstacles[0].path, paper.obstacles[0].path,
                        2 * sizeof *s.obstacles[0].path);
    assert_int_equal(scene_parts(&s), scene_parts(&paper));
    scene_fini(&s);
    scene_fini(&paper);
}

static void mixed_cargo_is_cylinders_and_boxes(void **unused)
{
    scene s = read_example("mixed-cargo");

    assert_int_equal(s.n_cargo, 2);
    assert_int_equal(s.cargo[0].shape.type, SCENE_CYLINDER);
    assert_int_equal(s.cargo[1].shape.type, SCENE_BOX);
    assert_true(s.cargo[0].share == 2.0 * s.cargo[1].share);
    scene_fini(&s);
}

static void the_curve_turns_left_between_two_straight_belts(void **unused)
{
    scene s = read_example("curve");

    assert_int_equal(s.n_belts, 3);
    assert_true(!s.belts[0].arc.is_given && s.belts[1].arc.is_given && !s.belts[2].arc.is_given);
    // 0.5 m/s in the middle between 0.4 and 0.9 m.
    assert_true(fabs(s.belts[1].turn - 0.5 / 0.65) < 1e-15);
    scene_fini(&s);
}

// Its side belt is met by the first straight, and told what the eye on that one sees.
static void the_merge_is_a_path_of_five_sections_and_a_belt_from_its_side(void **unused)
{
    scene s = read_example("merge");

    assert_int_equal(s.n_belts, 2);
    assert_int_equal(s.n_sections, 6);
    assert_int_equal(s.n_actions, 2);
    assert_int_equal(s.actions[0].target, 1);
    assert_true(s.belts[1].is_commanded && !s.belts[0].is_commanded);
    scene_fini(&s);
}

// Each command to its plates is one way, and one back.
static void the_pusher_and_its_gate_go_out_and_come_back(void **unused)
{
    scene s = read_example("pusher");
    vec2 sum[4] = { { 0.0, 0.0 } };
    int n[4] = { 0 };

    for (size_t k = 0; k < s.n_actions; k++) {
        if (s.actions[k].type != SCENE_ACTION_SHIFT)
            continue;
        sum[s.actions[k].target] = vec2_add(sum[s.actions[k].target], s.actions[k].shift);
        n[s.actions[k].target]++;
    }
    assert_int_equal(n[2], 2);
    assert_int_equal(n[3], 2);
    assert_true(sum[2].x == 0.53 && sum[2].y == 0.0);
    assert_true(sum[3].x == 0.0 && sum[3].y == 0.21);
    scene_fini(&s);
}

// So the table fills up.
static void the_packers_take_less_than_is_offered(void **unused)
{
    scene s = read_example("packers");

    assert_int_equal(s.n_sinks, 2);
    assert_true(s.sinks[0].rate + s.sinks[1].rate < s.feeds[0].rate);
    scene_fini(&s);
}

// A cell waits for the eye of the next one in its row, the last ones for their merge. More than half of a parcel that has left
// an eye of the merge is on the next belt.
static void the_cells_of_the_singulator_hand_on_in_rows(void **unused)
{
    scene s = read_example("cell-singulator");
    const scene_merge *merge = &s.merges[0];

    (void)unused;
    assert_int_equal(s.n_belts, 1 + 25 + 1);
    assert_int_equal(s.n_actions, 2 * 20);
    for (size_t k = 0; k < s.n_actions; k++)
        assert_int_equal(s.actions[k].eye, s.actions[k].target);
    assert_int_equal(merge->n_lanes, 5);
    for (size_t k = 0; k < merge->n_lanes; k++) {
        const scene_belt *cell = &s.belts[merge->lanes[k].belt];
        const double before = cell->polygon[1].x - s.eyes[merge->lanes[k].eye].line[0].x;
        assert_true(before > 0.0 && before < 0.5 * s.cargo[0].shape.length);
    }
    scene_fini(&s);
}

static void the_parcels_of_two_infeeds_come_in_turn(void **unused)
{
    scene s = read_example("parcel-infeed");

    (void)unused;
    assert_int_equal(s.merges[0].order, SCENE_MERGE_IN_TURN);
    assert_true(s.merges[0].parts == 1.0);
    assert_true(s.belts[3].arc.is_given);
    scene_fini(&s);
}

// With them parts overlap by less than 5 % of a radius, see core/micro/README.md.
static void fed_examples_have_soft_parts_and_the_congested_closure(void **unused)
{
    static const char *const names[] = { "diverter", "photo-eye", "poisson-mix", "singulator",
                                         "transfer" };

    for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
        scene s = read_example(names[k]);
        assert_int_equal(s.n_feeds, 1);
        assert_int_equal(s.micro.integrator, SCENE_IMPLICIT);
        assert_true(s.micro.modulus_reduction == 1e4);
        assert_int_equal(s.macro.closure, SCENE_CONGESTED);
        scene_fini(&s);
    }
}

static void every_example_can_be_solved_by_both_models(void **unused)
{
    size_t n;
    const example *items = examples_list(&n);

    for (size_t k = 0; k < n; k++) {
        bf_faults faults = { 0 };
        scene s = read_example(items[k].name);
        run_check(&s, RUN_MACRO, &faults);
        run_check(&s, RUN_MICRO, &faults);
        if (faults.n > 0)
            fail_msg("%s: %s: %s", items[k].name, faults.items[0].pointer, faults.items[0].text);
        scene_fini(&s);
    }
}

static void the_free_belt_has_no_obstacle(void **unused)
{
    scene s = read_example("free-belt");

    assert_int_equal(s.n_obstacles, 0);
    scene_fini(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_examples_are_sound_and_sorted),
        cmocka_unit_test(other_names_are_not_found),
        cmocka_unit_test(example_1_is_the_papers),
        cmocka_unit_test(example_2_stands_across_the_belt),
        cmocka_unit_test(example_3_disperses_at_every_density),
        cmocka_unit_test(the_free_belt_has_no_obstacle),
        cmocka_unit_test(one_example_chooses_its_own_step),
        cmocka_unit_test(mixed_cargo_is_cylinders_and_boxes),
        cmocka_unit_test(the_curve_turns_left_between_two_straight_belts),
        cmocka_unit_test(the_merge_is_a_path_of_five_sections_and_a_belt_from_its_side),
        cmocka_unit_test(the_pusher_and_its_gate_go_out_and_come_back),
        cmocka_unit_test(the_packers_take_less_than_is_offered),
        cmocka_unit_test(the_cells_of_the_singulator_hand_on_in_rows),
        cmocka_unit_test(the_parcels_of_two_infeeds_come_in_turn),
        cmocka_unit_test(fed_examples_have_soft_parts_and_the_congested_closure),
        cmocka_unit_test(every_example_can_be_solved_by_both_models),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
