// Unit tests of parts that enter and leave during a run: handles, ids, departures, free places; and that results
// depend neither on threads nor on interruptions.

#include "core/base/memory.h"
#include "core/micro/micro.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

enum { PARTS_MAX = 4, SOLVERS = 4, DEPARTURES = 8 };

static const double radius = 0.012; // of parts, m
static const double speed = 1.0;    // of the belt, m/s

// A belt of 0.12 m x 0.1 m from west to east between two walls. Do not move it once it was made.
typedef struct world {
    micro_def def;
    scene_belt belt;
    scene_obstacle plate; // from the north wall to the middle, not in def
    vec2 path[2];
    micro_kind
        kinds[2]; // cylinders of 12 mm; cylinders of 9 mm, or boxes of 30 mm x 20 mm in space
    scene_pose poses[PARTS_MAX];
} world;

static const struct {
    micro_path path;
    micro_integrator integrator;
} solvers[SOLVERS] = { { MICRO_PATH_PLANAR, MICRO_VERLET },
                       { MICRO_PATH_PLANAR, MICRO_IMPLICIT },
                       { MICRO_PATH_SPATIAL, MICRO_VERLET },
                       { MICRO_PATH_SPATIAL, MICRO_IMPLICIT } };

static void init(world *w, int solver)
{
    const scene_shape small = { .type = SCENE_CYLINDER, .radius = 0.009, .height = 0.008 };
    const scene_shape box = { .type = SCENE_BOX, .length = 0.03, .width = 0.02, .height = 0.008 };

    *w = (world){ .def = micro_def_default(),
                  .belt = { .velocity = { speed, 0.0 } },
                  .plate = { .n_points = 2, .thickness = 0.005 },
                  .path = { { 0.06, 0.1 }, { 0.09, 0.05 } } };
    for (int k = 0; k < 2; k++)
        w->kinds[k] =
            (micro_kind){ .shape = { .type = SCENE_CYLINDER, .radius = radius, .height = 0.008 },
                          .material = { 210e9, 0.28 },
                          .mass = 0.03,
                          .spin_radius = 0.008 };
    w->kinds[1].shape = solvers[solver].path == MICRO_PATH_PLANAR ? small : box;
    w->plate.path = w->path;
    w->def.domain = (scene_rect){ 0.0, 0.12, 0.0, 0.1 };
    w->def.belts = &w->belt;
    w->def.n_belts = 1;
    w->def.obstacles = &w->plate;
    w->def.kinds = w->kinds;
    w->def.n_kinds = 2;
    w->def.poses = w->poses;
    w->def.n_parts_expected = 8;
    w->def.dt = 0.0;
    w->def.path = solvers[solver].path;
    w->def.integrator = solvers[solver].integrator;
}

static micro_solver *start(const world *w)
{
    micro_solver *s = NULL;

    assert_int_equal(micro_create(&w->def, &s, NULL), BF_OK);
    return s;
}

static size_t admit(micro_solver *s, uint32_t kind, double x, double y)
{
    const micro_arrival arrival = { kind, { x, y, 0.0 }, { speed, 0.0 } };
    size_t part = SIZE_MAX;

    assert_int_equal(micro_admit(s, &arrival, &part, NULL), BF_OK);
    return part;
}

static bool is_free(micro_solver *s, uint32_t kind, double x, double y, double heading)
{
    bool is_free = false;

    assert_int_equal(micro_is_free(s, kind, (scene_pose){ x, y, heading }, &is_free, NULL), BF_OK);
    return is_free;
}

static void run(micro_solver *s, double time)
{
    assert_int_equal(micro_advance(s, (uint64_t)round(time / micro_dt(s)), NULL), BF_OK);
}

// Takes all departures and asserts that they come in order of handles. Returns how many.
static size_t take(micro_solver *s)
{
    micro_departure left[DEPARTURES];
    size_t n = micro_take_departures(s, left, DEPARTURES);

    assert_true(n < DEPARTURES);
    for (size_t k = 0; k < n; k++) {
        assert_true(k == 0 || left[k].part > left[k - 1].part);
        assert_true(micro_is_gone(s, left[k].part));
        assert_true(left[k].id == micro_id_of(s, left[k].part));
        assert_true(left[k].x > 0.12 && left[k].y > 0.0 && left[k].y < 0.1);
    }
    return n;
}

// What a fed belt has seen.
typedef struct tally {
    size_t n_admitted;
    size_t n_left;
} tally;

// One tick: what left is taken; cylinders and others enter in the west, in three rows, where there is room.
static void tick(micro_solver *s, double time, tally *of)
{
    run(s, time);
    of->n_left += take(s);
    for (int row = 0; row < 3; row++) {
        const uint32_t kind = (uint32_t)(of->n_admitted % 2);
        if (!is_free(s, kind, 0.02, 0.02 + 0.03 * row, 0.0))
            continue;
        const size_t part = admit(s, kind, 0.02, 0.02 + 0.03 * row);
        assert_true(micro_id_of(s, part) == of->n_admitted);
        of->n_admitted++;
    }
    assert_int_equal(micro_measure(s).n_parts, of->n_admitted - of->n_left);
}

static void handles_are_used_again_and_ids_never(void **state)
{
    (void)state;
    for (int k = 0; k < SOLVERS; k++) {
        world w;
        tally of = { 0, 0 };
        size_t most = 0;
        init(&w, k);
        micro_solver *s = start(&w);
        for (int t = 0; t < 80; t++) {
            tick(s, 0.01, &of);
            most = of.n_admitted - of.n_left > most ? of.n_admitted - of.n_left : most;
        }
        // 3 rows, 0.8 m of belt, parts of 18 to 30 mm.
        assert_in_range(of.n_admitted, 3 * 0.8 / 0.045, 3 * 0.8 / 0.02);
        assert_true(of.n_left > 30);
        assert_int_equal(micro_parts(s), most);
        micro_destroy(s);
    }
}

static void a_fed_belt_ends_with_the_same_bits_for_any_threads_and_interruption(void **state)
{
    (void)state;
    for (int k = 0; k < SOLVERS; k++) {
        uint64_t expected = 0;
        world w;
        init(&w, k);
        w.def.n_obstacles = 1;
        for (int n_threads = 1; n_threads <= 2; n_threads++)
            for (int stop = -1; stop < 12; stop += n_threads == 1 ? 3 : 20) {
                tally of = { 0, 0 };
                w.def.n_threads = n_threads;
                micro_solver *s = start(&w);
                for (int t = 0; t < 14; t++) {
                    tick(s, 0.017, &of);
                    if (t != stop)
                        continue;
                    bf_buffer saved = { 0 };
                    assert_int_equal(micro_save(s, &saved, NULL), BF_OK);
                    micro_destroy(s);
                    s = start(&w);
                    assert_int_equal(micro_load(s, saved.bytes, saved.n, NULL), BF_OK);
                    buffer_fini(&saved);
                }
                expected = expected == 0 ? micro_digest(s) : expected;
                assert_true(micro_digest(s) == expected);
                assert_true(of.n_left > 3);
                micro_destroy(s);
            }
    }
}

static void an_admitted_part_moves_like_one_of_the_definition(void **state)
{
    (void)state;
    for (int k = 0; k < SOLVERS; k++) {
        world w;
        init(&w, k);
        w.def.n_obstacles = 1;
        micro_solver *fed = start(&w);
        assert_int_equal(admit(fed, 0, 0.03, 0.06), 0);
        w.poses[0] = (scene_pose){ 0.03, 0.06, 0.0 };
        w.def.n_parts = 1;
        micro_solver *defined = start(&w);
        assert_true(micro_digest(fed) == micro_digest(defined));
        for (int t = 0; t < 5; t++) {
            run(fed, 0.01);
            run(defined, 0.01);
            assert_true(micro_digest(fed) == micro_digest(defined));
        }
        assert_true(fabs(micro_part_of(fed, 0).x[1] - 0.06) > 1e-3); // the plate deflects it
        micro_destroy(fed);
        micro_destroy(defined);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(handles_are_used_again_and_ids_never),
        cmocka_unit_test(a_fed_belt_ends_with_the_same_bits_for_any_threads_and_interruption),
        cmocka_unit_test(an_admitted_part_moves_like_one_of_the_definition),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
