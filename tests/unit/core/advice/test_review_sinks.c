// Warnings about sinks to which no belt carries goods.

#include "core/advice/review_sinks.h"

#include "core/base/memory.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <string.h>

// A belt with this speed on the lower half of a domain of 1 x 0.6 m, and a sink over a triangle with its tip at y.
static review_warnings warnings_of(double speed, double tip)
{
    const vec2 lower[] = { { 0.0, 0.0 }, { 1.0, 0.0 }, { 1.0, 0.3 }, { 0.0, 0.3 } };
    const vec2 triangle[] = { { 0.4, 0.6 }, { 0.5, tip }, { 0.6, 0.6 } };
    const scene_pose pose = { 0.1, 0.1, 0.0 };
    review_warnings found = { 0 };
    scene s;

    helper_scene_belt(&s, 1.0, 0.6, 0.01, &pose, 1);
    helper_scene_add_belt(&s, (vec2){ speed, 0.0 }, lower, 4);
    s.n_sinks = 1;
    s.sinks = memory_alloc(1, sizeof *s.sinks);
    scene_sink_init(s.sinks);
    s.sinks[0].n_points = 3;
    s.sinks[0].polygon = memory_alloc(3, sizeof *s.sinks[0].polygon);
    memcpy(s.sinks[0].polygon, triangle, sizeof triangle);
    helper_scene_resolve(&s);
    assert_int_equal(review_sinks(&s, &found, NULL), BF_OK);
    scene_fini(&s);
    return found;
}

static void a_sink_over_a_belt_is_in_order(void **unused)
{
    assert_int_equal(warnings_of(0.4, 0.2).n, 0);
}

static void a_sink_beside_all_belts_or_over_one_that_stands_is_named(void **unused)
{
    for (int k = 0; k < 2; k++) {
        const review_warnings found = k == 0 ? warnings_of(0.4, 0.4) : warnings_of(0.0, 0.2);
        assert_int_equal(found.n, 1);
        assert_string_equal(found.items[0].pointer, "/sinks/0/polygon_m");
        assert_non_null(strstr(found.items[0].meaning, "'sink-1'"));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_sink_over_a_belt_is_in_order),
        cmocka_unit_test(a_sink_beside_all_belts_or_over_one_that_stands_is_named),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
