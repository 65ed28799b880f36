// Unit tests of which poses are free, and which parts are near a line.

#include "tests/unit/core/helper_fed_belt.h"
#include "tests/unit/core/helper_world.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>

static const double radius = 0.012; // of parts of kind 0, m

// More than SCENE_TOLERANCE, m.
static const double hair = 1e-8;

static void poses_are_free_up_to_the_footprints(void **state)
{
    for (int k = 0; k < HELPER_FED_BELT_SOLVERS; k++) {
        helper_fed_belt w;
        helper_fed_belt_init(&w, k);
        w.poses[0] = (scene_pose){ 0.05, 0.03, 0.0 };
        w.def.n_parts = w.def.n_obstacles = 1;
        micro_solver *s = helper_fed_belt_start(&w);
        // Beside the part, the south wall, the open edge, and another part that is admitted.
        assert_true(helper_fed_belt_is_free(s, 0, 0.05 - 2.0 * radius - hair, 0.03, 0.0));
        assert_false(helper_fed_belt_is_free(s, 0, 0.05 - 2.0 * radius + hair, 0.03, 0.0));
        assert_true(helper_fed_belt_is_free(s, 0, 0.01, radius, 0.0));
        assert_false(helper_fed_belt_is_free(s, 0, 0.01, radius - hair, 0.0));
        assert_false(helper_fed_belt_is_free(s, 0, -hair, 0.03, 0.0));
        assert_true(helper_fed_belt_is_free(s, 0, 0.02, 0.07, 0.0));
        (void)helper_fed_belt_admit(s, 0, 0.02, 0.07);
        assert_false(helper_fed_belt_is_free(s, 0, 0.02, 0.07, 0.0));
        assert_true(helper_fed_belt_is_free(s, 0, 0.02 + 2.0 * radius + hair, 0.07, 0.0));
        // The face of the plate from (0.06, 0.1) to (0.09, 0.05) is upstream.
        const double nx = -0.05 / hypot(0.03, 0.05), ny = -0.03 / hypot(0.03, 0.05);
        const double x = 0.07, y = 0.1 - 0.05 / 3.0, more = radius + hair, less = radius - hair;
        assert_true(helper_fed_belt_is_free(s, 0, x + more * nx, y + more * ny, 0.0));
        assert_false(helper_fed_belt_is_free(s, 0, x + less * nx, y + less * ny, 0.0));
        micro_destroy(s);
    }
}

static void free_poses_of_boxes_depend_on_their_headings(void **state)
{
    helper_fed_belt w;

    helper_fed_belt_init(&w, 3);
    w.poses[0] = (scene_pose){ 0.05, 0.05, 0.0 };
    w.def.n_parts = 1;
    const uint32_t kinds[] = { 1 };
    w.def.part_kinds = kinds;
    micro_solver *s = helper_fed_belt_start(&w);
    // 30 mm x 20 mm; the diagonal of 36 mm would not be free.
    assert_true(helper_fed_belt_is_free(s, 1, 0.05, 0.07 + hair, 0.0));
    assert_false(helper_fed_belt_is_free(s, 1, 0.05, 0.07 - hair, 0.0));
    assert_true(helper_fed_belt_is_free(s, 1, 0.05, 0.075 + hair, 0.5 * M_PI));
    assert_false(helper_fed_belt_is_free(s, 1, 0.05, 0.075 - hair, 0.5 * M_PI));
    assert_true(helper_fed_belt_is_free(s, 0, 0.05 + 0.015 + radius + hair, 0.05, 0.0));
    assert_false(helper_fed_belt_is_free(s, 0, 0.05 + 0.015 + radius - hair, 0.05, 0.0));
    micro_destroy(s);
}

static void a_plate_that_turns_or_goes_frees_its_place(void **state)
{
    for (int k = 0; k < HELPER_FED_BELT_SOLVERS; k++) {
        helper_fed_belt w;
        helper_fed_belt_init(&w, k);
        w.path[0] = w.plate.pivot = (vec2){ 0.06, 0.0 };
        w.path[1] = (vec2){ 0.06, 0.05 };
        w.plate.is_commanded = true;
        w.def.n_obstacles = 1;
        w.def.world = helper_world_of(&w.def);
        micro_solver *s = helper_fed_belt_start(&w);
        assert_false(helper_fed_belt_is_free(s, 0, 0.06, 0.03, 0.0));
        assert_true(helper_fed_belt_is_free(s, 0, 0.03, 0.03, 0.0));
        // A quarter of a turn to the west.
        helper_world_turn(w.def.world, 0.0, 0.5 * M_PI, 0.05);
        helper_fed_belt_run(s, 0.06);
        assert_true(helper_fed_belt_is_free(s, 0, 0.06, 0.03, 0.0));
        assert_false(helper_fed_belt_is_free(s, 0, 0.03, radius, 0.0));
        helper_world_presence(w.def.world, 0.06, false);
        assert_true(helper_fed_belt_is_free(s, 0, 0.03, radius, 0.0));
        micro_destroy(s);
    }
}

static void count_visit(void *context, size_t part, const micro_extent *extent)
{
    uint64_t *seen = context;

    assert_int_equal(extent->kind, part % 2);
    assert_true(extent->is_flat);
    *seen |= UINT64_C(1) << part;
}

static uint64_t visit(micro_solver *s, vec2 a, vec2 b, double distance)
{
    uint64_t seen = 0;

    assert_int_equal(micro_visit_near(s, a, b, distance, count_visit, &seen, NULL), BF_OK);
    return seen;
}

static void parts_near_a_line_are_found(void **state)
{
    for (int k = 0; k < HELPER_FED_BELT_SOLVERS; k++) {
        helper_fed_belt w;
        helper_fed_belt_init(&w, k);
        w.def.domain = (scene_rect){ 0.0, 1.0, 0.0, 1.0 };
        micro_solver *s = helper_fed_belt_start(&w);
        // Part k is in column k % 6 and row k / 6, 0.1 m apart; the last ones after a first question.
        for (int part = 0; part < 36; part++) {
            if (part == 30)
                assert_true(visit(s, (vec2){ 0.1, 0.1 }, (vec2){ 0.1, 0.1 }, 0.01) == 1);
            assert_int_equal(helper_fed_belt_admit(s, (uint32_t)part % 2, 0.1 + 0.1 * (part % 6),
                                                   0.1 + 0.1 * (part / 6)),
                             part);
        }
        const uint64_t column =
            UINT64_C(1) << 2 | 1 << 8 | 1 << 14 | 1 << 20 | 1 << 26 | UINT64_C(1) << 32;
        assert_true(visit(s, (vec2){ 0.29, 0.0 }, (vec2){ 0.29, 2.0 }, 0.011) == column);
        assert_true(visit(s, (vec2){ 0.29, 0.0 }, (vec2){ 0.29, 2.0 }, 0.009) == 0);
        const uint64_t diagonal =
            UINT64_C(1) << 0 | 1 << 7 | 1 << 14 | 1 << 21 | 1 << 28 | UINT64_C(1) << 35;
        assert_true(visit(s, (vec2){ 0.0, 0.0 }, (vec2){ 0.7, 0.7 }, 0.07) == diagonal);
        assert_true(visit(s, (vec2){ 0.7, 0.7 }, (vec2){ 0.0, 0.0 }, 10.0) ==
                    (UINT64_C(1) << 36) - 1);
        micro_destroy(s);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(poses_are_free_up_to_the_footprints),
        cmocka_unit_test(free_poses_of_boxes_depend_on_their_headings),
        cmocka_unit_test(a_plate_that_turns_or_goes_frees_its_place),
        cmocka_unit_test(parts_near_a_line_are_found),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
