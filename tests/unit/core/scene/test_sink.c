// Sinks: which cells and points are in one, and what is wrong with one.

#include "core/base/memory.h"
#include "core/base/polygon.h"
#include "core/scene/sink.h"
#include "tests/unit/core/helper_faults.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <string.h>

enum { N1 = 40, N2 = 30, POINTS = 7 };

// A belt of 1 x 0.6 m with a feed over its west side and two sinks, of all kinds and of one.
static void make_scene(scene *s)
{
    helper_scene_belt(s, 1.0, 0.6, 0.005, (scene_pose[]){ { 0.5, 0.3, 0.0 } }, 1);
    helper_scene_add_feed(s, SCENE_WEST, SCENE_ARRIVALS_REGULAR, 2.0);
    s->n_sinks = 2;
    s->sinks = memory_alloc(2, sizeof *s->sinks);
    for (size_t k = 0; k < 2; k++) {
        scene_sink *sink = &s->sinks[k];
        scene_sink_init(sink);
        sink->n_points = 4;
        sink->polygon = memory_alloc(4, sizeof *sink->polygon);
        const vec2 square[] = { { 0.6, 0.1 }, { 0.8, 0.1 }, { 0.8, 0.3 }, { 0.6, 0.3 } };
        memcpy(sink->polygon, square, sizeof square);
        sink->kinds = memory_alloc(2, sizeof *sink->kinds);
    }
    s->sinks[1].n_kinds = 1;
}

static void sinks_in_order_are_accepted(void **unused)
{
    scene s;

    make_scene(&s);
    helper_faults_none(&s);
    make_scene(&s); // they may reach beyond the domain
    s.sinks[0].polygon[1].x = s.sinks[0].polygon[2].x = 1.2;
    s.sinks[0].rate = 0.5;
    helper_faults_none(&s);
}

static void move(scene_sink *sink, double by)
{
    for (size_t k = 0; k < sink->n_points; k++)
        sink->polygon[k].x += by;
}

#define SPOIL(name, code)                                                                          \
    static void name(scene *s)                                                                     \
    {                                                                                              \
        scene_sink *sink = &s->sinks[1];                                                           \
        code;                                                                                      \
    }
SPOIL(bad_id, strcpy(sink->id, "a b"))
SPOIL(same_id, strcpy(sink->id, "sink-1"))
SPOIL(no_rate, sink->rate = 0.0)
SPOIL(negative_rate, sink->rate = -1.0)
SPOIL(two_points, sink->n_points = 2)
SPOIL(nowhere, sink->polygon[2].x = NAN)
SPOIL(same_point, sink->polygon[1] = sink->polygon[0])
SPOIL(crossing, sink->polygon[1].y = 0.5)
SPOIL(flat, sink->polygon[2] = ((vec2){ 0.7, 0.1 }); sink->polygon[3] = ((vec2){ 0.65, 0.1 }))
SPOIL(outside, move(sink, 0.5))
SPOIL(fed, move(sink, -0.6))
SPOIL(unknown_kind, sink->kinds[0] = 4)
SPOIL(kind_twice, sink->n_kinds = 2)

static void what_is_wrong_with_a_sink_is_pointed_at(void **unused)
{
    static const helper_faults_case bad[] = {
        { bad_id, "/sinks/1/id", "letters" },
        { same_id, "/sinks/1/id", "/sinks/0" },
        { no_rate, "/sinks/1/rate_per_s", "above 0" },
        { negative_rate, "/sinks/1/rate_per_s", "above 0" },
        { two_points, "/sinks/1/polygon_m", "3 to" },
        { nowhere, "/sinks/1/polygon_m/2", "numbers" },
        { same_point, "/sinks/1/polygon_m/1", "repeats" },
        { crossing, "/sinks/1/polygon_m", "cross or touch" },
        { flat, "/sinks/1/polygon_m", "cross or touch" },
        { outside, "/sinks/1/polygon_m", "outside of the domain" },
        { fed, "/sinks/1/polygon_m", "line of the feed 'feed-1'" },
        { unknown_kind, "/sinks/1/kinds/0", "kind of cargo" },
        { kind_twice, "/sinks/1/kinds/1", "second time" },
    };

    helper_faults_each(make_scene, bad, sizeof bad / sizeof *bad);
}

typedef struct marks {
    uint8_t of[N2][N1];
} marks;

static bool mark(void *context, size_t j, size_t first, size_t last)
{
    marks *m = context;

    for (size_t i = first; i < last; i++)
        m->of[j][i]++;
    return true;
}

// Stars about the middle of the grid, which reach beyond it.
static void the_cells_of_a_sink_are_those_whose_centres_it_holds(void **unused)
{
    const bf_grid grid = { .n1 = N1, .n2 = N2, .d1 = 0.02, .d2 = 0.02 };
    bf_random random;

    random_init(&random, 7);
    for (int round = 0; round < 200; round++) {
        vec2 star[POINTS];
        marks m = { 0 };
        for (int k = 0; k < POINTS; k++) {
            const double r = 0.05 + 0.45 * random_unit(&random), phi = 2.0 * M_PI * k / POINTS;
            star[k] = (vec2){ 0.4 + r * cos(phi), 0.3 + r * sin(phi) };
        }
        const scene_sink sink = { .n_points = POINTS, .polygon = star };
        assert_int_equal(sink_visit_cells(&sink, &grid, mark, &m), BF_OK);
        for (size_t j = 0; j < N2; j++)
            for (size_t i = 0; i < N1; i++)
                assert_int_equal(
                    m.of[j][i], polygon_holds(star, POINTS,
                                              (vec2){ grid_x1(&grid, i), grid_x2(&grid, j) }, 0.0));
    }
}

static void a_part_is_in_the_last_sink_that_takes_its_kind(void **unused)
{
    const vec2 inside = { 0.7, 0.2 }, outside = { 0.7, 0.4 };
    scene s;

    make_scene(&s);
    assert_int_equal(sink_at(&s, inside, 0), 1);
    assert_int_equal(sink_at(&s, inside, 1), 0);
    assert_int_equal(sink_at(&s, outside, 0), 2);
    scene_fini(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sinks_in_order_are_accepted),
        cmocka_unit_test(what_is_wrong_with_a_sink_is_pointed_at),
        cmocka_unit_test(the_cells_of_a_sink_are_those_whose_centres_it_holds),
        cmocka_unit_test(a_part_is_in_the_last_sink_that_takes_its_kind),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
