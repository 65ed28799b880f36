// Unit tests of the static velocity field; its closed faces are test_closed_faces.c. Velocities are derived from section
// 3.1: v_T on the free belt, |v_T| n in the outward band B, (v_T . t) t in the slide zone C.

#include "core/macro/velocity_field.h"

#include "core/base/memory.h"
#include "core/base/random.h"
#include "core/scene/surroundings.h"
#include "tests/unit/core/helper_macro.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_amount.h"
#include "tests/unit/helper_cmocka.h"

#include <string.h>

static const double speed = 0.395; // of the paper's belt, m/s
static const scene_pose somewhere = { 0.1, 0.1, 0.0 };

/// The point of Example 1's obstacle at a share of its length, d upstream of it; angle in degrees.
static vec2 beside(double angle_deg, double share, double d)
{
    double angle = angle_deg * M_PI / 180.0, left = (1.0 - share) * 0.5 / sin(angle);
    return (vec2){ 0.75 - left * cos(angle) - d * sin(angle),
                   0.5 - left * sin(angle) + d * cos(angle) };
}

static void assert_velocity(const scene *s, vec2 at, double v1, double v2)
{
    vec2 v = helper_macro_velocity_at(s, at);
    assert_near(v.x, v1, 1e-14);
    assert_near(v.y, v2, 1e-14);
}

static void assert_outward(const scene *s, vec2 at, double angle)
{
    assert_velocity(s, at, -speed * sin(angle), speed * cos(angle));
}

static void assert_sliding(const scene *s, vec2 at, double angle)
{
    assert_velocity(s, at, speed * cos(angle) * cos(angle), speed * cos(angle) * sin(angle));
}

static void a_sealed_obstacle_has_an_outward_band_and_then_a_slide_zone(void **state)
{
    for (double angle_deg = 30.0; angle_deg <= 90.0; angle_deg += 15.0) {
        double angle = angle_deg * M_PI / 180.0;
        scene s;
        helper_scene_example(&s, angle_deg, SCENE_SEALED);
        assert_outward(&s, beside(angle_deg, 0.5, 0.0), angle);
        assert_outward(&s, beside(angle_deg, 0.5, 0.0799), angle);
        assert_sliding(&s, beside(angle_deg, 0.5, 0.0801), angle);
        assert_sliding(&s, beside(angle_deg, 0.5, 0.1099), angle);
        assert_velocity(&s, beside(angle_deg, 0.5, 0.1101), speed, 0.0);
        assert_velocity(&s, beside(angle_deg, 0.5, -0.0001), speed, 0.0);
        // The sliding speeds of the table in section 4: 0.279, 0.1975, 0.102, 0.
        vec2 v = helper_macro_velocity_at(&s, beside(angle_deg, 0.5, 0.1));
        assert_near(sqrt(v.x * v.x + v.y * v.y), speed * cos(angle), 1e-14);
        scene_fini(&s);
    }
}

static void the_papers_field_is_outward_behind_the_line_and_slides_before_it(void **state)
{
    double angle = M_PI / 3.0;
    scene s;

    helper_scene_example(&s, 60.0, SCENE_FIELD); // thickness 0.03, slide zone 0.02
    assert_sliding(&s, beside(60.0, 0.5, 0.0), angle);
    assert_sliding(&s, beside(60.0, 0.5, 0.0199), angle);
    assert_velocity(&s, beside(60.0, 0.5, 0.0201), speed, 0.0);
    assert_outward(&s, beside(60.0, 0.5, -0.0001), angle);
    assert_outward(&s, beside(60.0, 0.5, -0.0299), angle);
    assert_velocity(&s, beside(60.0, 0.5, -0.0301), speed, 0.0);
    scene_fini(&s);
}

static void a_wall_lets_slide_before_it_and_has_the_belt_behind(void **state)
{
    scene s;

    helper_scene_example(&s, 60.0, SCENE_WALL);
    assert_sliding(&s, beside(60.0, 0.5, 0.0), M_PI / 3.0);
    assert_sliding(&s, beside(60.0, 0.5, 0.0199), M_PI / 3.0);
    assert_velocity(&s, beside(60.0, 0.5, 0.0201), speed, 0.0);
    assert_velocity(&s, beside(60.0, 0.5, -0.0001), speed, 0.0);
    scene_fini(&s);
}

static void bands_span_the_length_of_the_line(void **state)
{
    scene s;

    for (int treatment = 0; treatment < SCENE_TREATMENT_COUNT; treatment++) {
        helper_scene_example(&s, 60.0, (scene_treatment)treatment);
        assert_velocity(&s, beside(60.0, 1.001, 0.001), speed, 0.0);
        assert_velocity(&s, beside(60.0, -0.001, 0.001), speed, 0.0);
        assert_true(helper_macro_velocity_at(&s, beside(60.0, 0.999, 0.001)).y > 0.01);
        scene_fini(&s);
    }
}

static void borders_belong_to_the_bands_with_the_tolerance(void **state)
{
    // A line across the belt at x = 0.5 makes d = 0.5 - x; coordinates to 1e-10 m.
    static const vec2 path[] = { { 0.5, 0.0 }, { 0.5, 0.3 } };
    static const struct {
        scene_treatment treatment;
        double d;
        double v1; // -speed in B, 0 in C, speed in A
    } cases[] = {
        { SCENE_SEALED, -9e-10, -speed },
        { SCENE_SEALED, -1.1e-9, speed },
        { SCENE_SEALED, 0.08 - 1.1e-9, -speed },
        { SCENE_SEALED, 0.08 - 9e-10, 0.0 },
        { SCENE_SEALED, 0.11 + 9e-10, 0.0 },
        { SCENE_SEALED, 0.11 + 1.1e-9, speed },
        { SCENE_FIELD, -9e-10, 0.0 },
        { SCENE_FIELD, -1.1e-9, -speed },
        { SCENE_FIELD, -0.005 - 9e-10, -speed },
        { SCENE_FIELD, -0.005 - 1.1e-9, speed },
        { SCENE_FIELD, 0.02 + 9e-10, 0.0 },
        { SCENE_FIELD, 0.02 + 1.1e-9, speed },
        { SCENE_WALL, -9e-10, 0.0 },
        { SCENE_WALL, -1.1e-9, speed },
        { SCENE_WALL, 0.02 + 9e-10, 0.0 },
        { SCENE_WALL, 0.02 + 1.1e-9, speed },
    };

    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        scene s;
        helper_scene_belt(&s, 1.0, 0.5, 0.005, &somewhere, 1);
        helper_scene_add_obstacle(&s, path, 2, cases[k].treatment);
        helper_scene_resolve(&s);
        assert_velocity(&s, (vec2){ 0.5 - cases[k].d, 0.1 }, cases[k].v1, 0.0);
        // The ends too.
        bool is_band = cases[k].v1 < speed;
        assert_velocity(&s, (vec2){ 0.5 - cases[k].d, 0.3 + 9e-10 }, cases[k].v1, 0.0);
        if (is_band)
            assert_velocity(&s, (vec2){ 0.5 - cases[k].d, 0.3 + 1.1e-9 }, speed, 0.0);
        scene_fini(&s);
    }
}

static void the_upstream_side_does_not_depend_on_the_direction_of_the_path(void **state)
{
    static const vec2 up[] = { { 0.5, 0.0 }, { 0.5, 0.3 } },
                      down[] = { { 0.5, 0.3 }, { 0.5, 0.0 } };
    scene s;

    for (int k = 0; k < 2; k++) {
        helper_scene_belt(&s, 1.0, 0.5, 0.005, &somewhere, 1);
        helper_scene_add_obstacle(&s, k == 0 ? up : down, 2, SCENE_SEALED);
        helper_scene_resolve(&s);
        assert_velocity(&s, (vec2){ 0.45, 0.1 }, -speed, 0.0);
        assert_velocity(&s, (vec2){ 0.55, 0.1 }, speed, 0.0);
        scene_fini(&s);
    }
}

static void beside_a_guide_the_belt_carries_freely(void **state)
{
    scene s;

    helper_scene_belt(&s, 1.0, 0.5, 0.005, &somewhere, 1);
    helper_scene_add_obstacle(&s, (vec2[]){ { 0.2, 0.25 }, { 0.8, 0.25 } }, 2, SCENE_SEALED);
    helper_scene_resolve(&s);
    assert_velocity(&s, (vec2){ 0.5, 0.30 }, speed, 0.0);
    assert_velocity(&s, (vec2){ 0.5, 0.20 }, speed, 0.0);
    scene_fini(&s);
}

static void the_outward_band_wins_over_slide_zones_and_the_first_obstacle_over_later_ones(
    void **state)
{
    static const vec2 across[] = { { 0.5, 0.0 }, { 0.5, 0.5 } };
    static const vec2 slanted[] = { { 0.45, 0.2 }, { 0.55, 0.3 } };
    double half = 0.5 * speed, root = speed / sqrt(2.0);
    scene s;

    helper_scene_belt(&s, 1.0, 0.5, 0.005, &somewhere, 1);
    helper_scene_add_obstacle(&s, across, 2, SCENE_WALL);    // slide zone 0.48 .. 0.5: (0, 0)
    helper_scene_add_obstacle(&s, slanted, 2, SCENE_WALL);   // slide zone: v_T cos 45 along it
    helper_scene_add_obstacle(&s, slanted, 2, SCENE_SEALED); // outward band
    helper_scene_resolve(&s);
    assert_velocity(&s, (vec2){ 0.49, 0.26 }, -root, root);
    s.n_obstacles = 2;
    assert_velocity(&s, (vec2){ 0.49, 0.25 }, 0.0, 0.0);
    assert_velocity(&s, (vec2){ 0.51, 0.27 }, half, half);
    s.n_obstacles = 3;
    scene_fini(&s);
}

static void the_later_belt_wins_and_nothing_moves_off_the_belts(void **state)
{
    static const vec2 west[] = { { 0.0, 0.0 }, { 0.6, 0.0 }, { 0.6, 0.4 }, { 0.0, 0.4 } };
    static const vec2 east[] = { { 0.4, 0.0 }, { 1.0, 0.0 }, { 1.0, 0.4 }, { 0.4, 0.4 } };
    scene s;

    helper_scene_belt(&s, 1.0, 0.5, 0.005, &somewhere, 1);
    helper_scene_add_belt(&s, (vec2){ 0.1, 0.0 }, west, 4);
    helper_scene_add_belt(&s, (vec2){ 0.0, 0.2 }, east, 4);
    helper_scene_resolve(&s);
    assert_velocity(&s, (vec2){ 0.2, 0.2 }, 0.1, 0.0);
    assert_velocity(&s, (vec2){ 0.5, 0.2 }, 0.0, 0.2);
    assert_velocity(&s, (vec2){ 0.4, 0.2 }, 0.0, 0.2); // borders belong to the belt
    assert_velocity(&s, (vec2){ 1.0, 0.0 }, 0.0, 0.2);
    assert_velocity(&s, (vec2){ 0.5, 0.4001 }, 0.0, 0.0);
    scene_fini(&s);
}

// At x = 0.5 m, where faces are, a belt to the east and then one to the west meets a belt to the north, which is
// listed later.
static void cargo_crosses_the_border_to_a_belt_that_runs_along_it(void **state)
{
    static const vec2 west[] = { { 0.0, 0.0 }, { 0.5, 0.0 }, { 0.5, 0.5 }, { 0.0, 0.5 } };
    static const vec2 east[] = { { 0.5, 0.0 }, { 1.0, 0.0 }, { 1.0, 0.5 }, { 0.5, 0.5 } };

    for (int k = 0; k < 2; k++) {
        const double v = k == 0 ? 0.3 : -0.3;
        scene s;
        helper_scene_belt(&s, 1.0, 0.5, 0.05, &somewhere, 1);
        helper_scene_add_belt(&s, (vec2){ v, 0.0 }, k == 0 ? west : east, 4);
        helper_scene_add_belt(&s, (vec2){ 0.0, 0.3 }, k == 0 ? east : west, 4);
        helper_scene_schedule(&s.belts[0], 1, (double[]){ 1.0 }, (double[]){ 0.5 });
        helper_scene_resolve(&s);
        velocity_field *f = helper_macro_field(&s);
        for (size_t j = 0; j < f->grid.n2; j++) {
            const size_t border = j * (f->grid.n1 + 1) + 10;
            const size_t before = k == 0 ? border - 1 : border + 1;
            const size_t after = k == 0 ? border + 1 : border - 1;
            assert_true(f->faces[0].v[before] == v && f->faces[0].belt[before] == 0);
            assert_true(f->faces[0].v[border] == v && f->faces[0].belt[border] == 0);
            assert_true(f->faces[0].v[after] == 0.0 && f->faces[0].belt[after] == 1);
        }
        velocity_field_destroy(f);
        scene_fini(&s);
    }
}

// The belts' indices are those of the point rule, 2 off both belts; there are none without a schedule.
static void faces_know_their_belt_where_a_speed_changes(void **state)
{
    static const vec2 west[] = { { 0.0, 0.0 }, { 0.6, 0.0 }, { 0.6, 0.4 }, { 0.0, 0.4 } };
    static const vec2 east[] = { { 0.42, 0.0 }, { 1.0, 0.0 }, { 1.0, 0.4 }, { 0.42, 0.4 } };

    for (int changes = 0; changes < 2; changes++) {
        scene s;
        helper_scene_belt(&s, 1.0, 0.5, 0.05, &somewhere, 1);
        helper_scene_add_belt(&s, (vec2){ 0.1, 0.1 }, west, 4);
        helper_scene_add_belt(&s, (vec2){ 0.2, 0.2 }, east, 4);
        if (changes)
            helper_scene_schedule(&s.belts[1], 1, (double[]){ 1.0 }, (double[]){ 0.5 });
        helper_scene_resolve(&s);
        velocity_field *f = helper_macro_field(&s);
        const size_t n1 = f->grid.n1, n2 = f->grid.n2;
        assert_int_equal(f->faces[0].belt != NULL && f->faces[1].belt != NULL, changes);
        for (size_t k = 0; changes && k < (n1 + 1) * n2; k++) {
            const bool is_on_belt = k / (n1 + 1)<8, is_east = k % (n1 + 1)> 8;
            assert_int_equal(f->faces[0].belt[k], !is_on_belt ? 2 : is_east ? 1 : 0);
        }
        for (size_t k = 0; changes && k < n1 * (n2 + 1); k++) {
            const bool is_on_belt = k / n1 <= 8, is_east = k % n1 >= 8;
            assert_int_equal(f->faces[1].belt[k], !is_on_belt ? 2 : is_east ? 1 : 0);
        }
        velocity_field_destroy(f);
        scene_fini(&s);
    }
}

/// A path that wanders over a domain of 1 x 0.5 m and beyond its edges.
static size_t draw_path(bf_random *random, double cell, size_t n_max, vec2 *ret_path)
{
    size_t n = 2 + random_bits(random) % (n_max - 1);

    for (size_t k = 0; k < n; k++) {
        do {
            ret_path[k] = (vec2){ helper_scene_draw(random, -0.1, 1.1, cell),
                                  helper_scene_draw(random, -0.1, 0.6, cell) };
        } while (k > 0 && vec2_length(vec2_sub(ret_path[k], ret_path[k - 1])) < 1e-3);
    }
    return n;
}

static void draw_scene(scene *s, bf_random *random)
{
    static const double cells[] = { 0.05, 0.02, 0.01, 0.025 };
    double cell = cells[random_bits(random) % 4];
    vec2 path[8];

    helper_scene_belt(s, 1.0, 0.5, cell, &somewhere, 1);
    for (size_t side = 0; side < SCENE_SIDE_COUNT; side++)
        s->edges[side] = (scene_edge)(random_bits(random) % SCENE_EDGE_COUNT);
    for (size_t k = random_bits(random) % 4; k > 0; k--) {
        vec2 v = { helper_scene_draw(random, -1.0, 1.0, 0.1),
                   helper_scene_draw(random, -1.0, 1.0, 0.1) };
        size_t n = random_bits(random) % 3 == 0 ? 0 : draw_path(random, cell, 8, path);
        helper_scene_add_belt(s, v, path, n < 3 ? 0 : n);
    }
    for (size_t k = random_bits(random) % 4; k > 0; k--) {
        size_t n = draw_path(random, cell, 5, path);
        scene_obstacle *o = helper_scene_add_obstacle(
            s, path, n, (scene_treatment)(random_bits(random) % SCENE_TREATMENT_COUNT));
        o->thickness = helper_scene_draw(random, 0.001, 0.1, cell);
        o->band = helper_scene_draw(random, 0.001, 0.1, cell);
    }
    helper_scene_resolve(s);
}

static bool is_off(const scene *s, vec2 at)
{
    const surroundings around = surroundings_of(s);

    return s->n_belts > 0 && surroundings_belt_at(&around, at) == s->n_belts;
}

/// The plain rules at a face between the centres of two cells; off every belt, what carries cargo over it.
static vec2 find_velocity(const scene *s, vec2 at, vec2 from, vec2 to)
{
    const vec2 way = vec2_sub(to, from), before = helper_macro_velocity_at(s, from),
               after = helper_macro_velocity_at(s, to);
    const bool comes = !is_off(s, from) && vec2_dot(before, way) > 0.0;
    const bool returns = !is_off(s, to) && vec2_dot(after, way) < 0.0;

    if (!is_off(s, at) || comes == returns)
        return helper_macro_velocity_at(s, at);
    return comes ? before : after;
}

/// Compare face (i, j) of one axis with the plain rules.
static void check_face(const scene *s, const velocity_field *f, int axis, size_t i, size_t j)
{
    const bf_grid *g = &f->grid;
    size_t k = axis == 0 ? j * (g->n1 + 1) + i : j * g->n1 + i;
    double half1 = axis == 0 ? 0.5 : 0.0, half2 = axis == 0 ? 0.0 : 0.5;
    vec2 at = { g->lower1 + ((double)i + 0.5 - half1) * g->d1,
                g->lower2 + ((double)j + 0.5 - half2) * g->d2 };
    vec2 from = { g->lower1 + ((double)i + 0.5 - 2.0 * half1) * g->d1,
                  g->lower2 + ((double)j + 0.5 - 2.0 * half2) * g->d2 };
    vec2 to = { grid_x1(g, i), grid_x2(g, j) };
    size_t n = axis == 0 ? g->n1 : g->n2, along = axis == 0 ? i : j;
    scene_side low = axis == 0 ? SCENE_WEST : SCENE_SOUTH;
    scene_side high = axis == 0 ? SCENE_EAST : SCENE_NORTH;
    bool is_closed = helper_macro_is_closed(s, from, to) ||
                     (along == 0 && s->edges[low] == SCENE_EDGE_WALL) ||
                     (along == n && s->edges[high] == SCENE_EDGE_WALL);
    vec2 v = find_velocity(s, at, from, to);
    const size_t cell = j * g->n1 + i, before = axis == 0 ? cell - 1 : cell - g->n1;

    if (f->off != NULL && along > 0 && along < n && (axis == 0 ? v.x : v.y) == 0.0)
        is_closed = is_closed || f->off[before] != f->off[cell];
    assert_int_equal(f->faces[axis].closed[k] != 0, is_closed);
    assert_true(f->faces[axis].v[k] == (is_closed ? 0.0 : axis == 0 ? v.x : v.y));
}

static void the_field_on_a_grid_is_the_plain_rule_at_every_face(void **state)
{
    bf_random random;

    random_init(&random, 1);
    for (int round = 0; round < HELPER_AMOUNT(300, 60); round++) {
        scene s;
        draw_scene(&s, &random);
        velocity_field *f = helper_macro_field(&s);
        for (size_t j = 0; j < f->grid.n2; j++) {
            for (size_t i = 0; i <= f->grid.n1; i++)
                check_face(&s, f, 0, i, j);
        }
        for (size_t j = 0; j <= f->grid.n2; j++) {
            for (size_t i = 0; i < f->grid.n1; i++)
                check_face(&s, f, 1, i, j);
        }
        velocity_field_destroy(f);
        scene_fini(&s);
    }
}

enum { RAIL_POINTS = 3 }; ///< of a rail along an arc, whose long chords spread q far

/// A random scene with moving obstacles. With an arc there are rails along it. Paths of as many points as these have are moved towards the origin,
/// the centre of the arc, or away.
static void draw_moving_scene(scene *s, bf_random *random, int round)
{
    draw_scene(s, random);
    s->macro.closure = round % 2 == 0 ? SCENE_CONGESTED : SCENE_DISPERSIVE;
    if (round % 3 != 0)
        (void)helper_scene_add_arc(s, 0.4, 0.15, 0.42, 0.0, 90.0);
    for (int k = 0; k < 2 && round % 3 != 0; k++) {
        const double radius = k == 0 ? 0.3 : helper_scene_draw(random, 0.14, 0.43, s->macro.cell);
        vec2 rail[RAIL_POINTS];
        for (int m = 0; m < RAIL_POINTS; m++)
            rail[m] = (vec2){ radius * cos(0.06 + 0.7 * m), radius * sin(0.06 + 0.7 * m) };
        (void)helper_scene_add_obstacle(s, rail, RAIL_POINTS, SCENE_WALL);
    }
    // Beside the middle of the first rail's first chord, which gives fewer corners its q then.
    const vec2 toward = { cos(0.41), sin(0.41) };
    const vec2 short_rail[] = { vec2_scale(toward, 0.268), vec2_scale(toward, 0.278) };
    (void)helper_scene_add_obstacle(s, short_rail, 2, SCENE_WALL);
    helper_scene_resolve(s);
    for (size_t k = 0; k < s->n_obstacles; k++)
        s->obstacles[k].is_commanded = k + 1 == s->n_obstacles || random_bits(random) % 2 == 0;
}

/// Obstacles move by part of a cell or far, come and go; what is made of the field again and what stays is that of a new one.
static void a_field_made_again_is_the_field_of_a_new_scene(void **state)
{
    bf_random random;

    random_init(&random, 5);
    for (int round = 0; round < HELPER_AMOUNT(60, 12); round++) {
        scene s;
        bool is_there[16], was_there[16];
        scene_rect changed[16];
        draw_moving_scene(&s, &random, round);
        velocity_field *f = helper_macro_field(&s);
        scene now = s;
        now.obstacles = memory_alloc(s.n_obstacles, sizeof *now.obstacles);
        for (size_t k = 0; k < s.n_obstacles; k++)
            is_there[k] = was_there[k] = true;
        for (int update = 0; update < 4; update++) {
            size_t n_changed = 0;
            now.n_obstacles = 0;
            for (size_t k = 0; k < s.n_obstacles; k++) {
                scene_obstacle *o = &s.obstacles[k];
                const bool changes = o->is_commanded && random_bits(&random) % 3 != 0;
                const double most = random_bits(&random) % 4 == 0 ? 0.3 : 0.5 * s.macro.cell;
                scene_rect box = scene_rect_around(o->path, o->n_points);
                if (changes && random_bits(&random) % 4 == 0)
                    is_there[k] = !is_there[k];
                const double wider = helper_scene_draw(&random, 0.85, 1.15, 1e-3);
                for (size_t m = 0; changes && m < o->n_points; m++)
                    o->path[m] =
                        o->n_points == RAIL_POINTS
                            ? vec2_scale(o->path[m], wider)
                            : vec2_add(o->path[m],
                                       (vec2){ helper_scene_draw(&random, -most, most, 1e-4),
                                               helper_scene_draw(&random, -most, most, 1e-4) });
                const scene_rect after = scene_rect_around(o->path, o->n_points);
                box = (scene_rect){ fmin(box.x_min, after.x_min), fmax(box.x_max, after.x_max),
                                    fmin(box.y_min, after.y_min), fmax(box.y_max, after.y_max) };
                if (changes && (is_there[k] || was_there[k]))
                    changed[n_changed++] = box;
                was_there[k] = is_there[k];
                if (is_there[k])
                    now.obstacles[now.n_obstacles++] = *o;
            }
            velocity_field_update(f, &now, n_changed, changed);
            velocity_field *fresh = helper_macro_field(&now);
            assert_true(helper_macro_is_same_field(f, fresh));
            velocity_field_destroy(fresh);
        }
        velocity_field_destroy(f);
        memory_free(now.obstacles);
        scene_fini(&s);
    }
}

static void no_component_exceeds_the_speed_of_the_fastest_belt(void **state)
{
    bf_random random;

    random_init(&random, 9);
    for (int round = 0; round < 100; round++) {
        scene s;
        draw_scene(&s, &random);
        double most = scene_belt_speed(&s) * (1.0 + 1e-14);
        velocity_field *f = helper_macro_field(&s);
        for (size_t k = 0; k < (f->grid.n1 + 1) * f->grid.n2; k++)
            assert_true(fabs(f->faces[0].v[k]) <= most);
        for (size_t k = 0; k < f->grid.n1 * (f->grid.n2 + 1); k++)
            assert_true(fabs(f->faces[1].v[k]) <= most);
        velocity_field_destroy(f);
        scene_fini(&s);
    }
}

static void without_memory_no_field_is_given_or_lost(void **state)
{
    scene s;

    helper_scene_example(&s, 60.0, SCENE_SEALED);
    for (size_t n = 1;; n++) {
        velocity_field *f = (velocity_field *)&s; // poison
        bf_error err = { 0 };
        memory_plan_fault(n, 0);
        bf_status status = velocity_field_create(&s, &f, &err);
        size_t n_faults = memory_faults();
        memory_plan_fault(0, 0);
        if (n_faults == 0) {
            assert_int_equal(status, BF_OK);
            assert_null(velocity_field_destroy(f));
            break;
        }
        assert_int_equal(status, BF_ENOMEM);
        assert_int_equal(err.code, BF_ENOMEM);
        assert_ptr_equal(f, &s);
    }
    assert_null(velocity_field_destroy(NULL));
    scene_fini(&s);
}

// A gap of 26 mm, wider than the radius of 12 mm, between the centres of two cells of 50 mm, and with it on their face: what comes
// over it falls behind it, and where a belt may run backwards on either side.
static void what_comes_over_a_gap_within_a_cell_falls_behind_it(void **state)
{
    static const vec2 first[] = { { 0.0, 0.0 }, { 0.487, 0.0 }, { 0.487, 0.1 }, { 0.0, 0.1 } };
    static const vec2 second[] = { { 0.513, 0.0 }, { 1.0, 0.0 }, { 1.0, 0.1 }, { 0.513, 0.1 } };

    for (int reverses = 0; reverses < 2; reverses++) {
        scene s;
        helper_scene_belt(&s, 1.0, 0.1, 0.05, &somewhere, 1);
        helper_scene_add_belt(&s, (vec2){ speed, 0.0 }, first, 4);
        scene_belt *belt = helper_scene_add_belt(&s, (vec2){ speed, 0.0 }, second, 4);
        if (reverses)
            helper_scene_schedule(belt, 1, (double[]){ 1.0 }, (double[]){ -1.0 });
        helper_scene_resolve(&s);
        velocity_field *f = helper_macro_field(&s);
        assert_int_equal(f->off[9], reverses);
        assert_int_equal(f->off[10], 1);
        assert_int_equal(f->off[8] + f->off[11], 0);
        velocity_field_destroy(f);
        scene_fini(&s);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_sealed_obstacle_has_an_outward_band_and_then_a_slide_zone),
        cmocka_unit_test(the_papers_field_is_outward_behind_the_line_and_slides_before_it),
        cmocka_unit_test(a_wall_lets_slide_before_it_and_has_the_belt_behind),
        cmocka_unit_test(bands_span_the_length_of_the_line),
        cmocka_unit_test(borders_belong_to_the_bands_with_the_tolerance),
        cmocka_unit_test(the_upstream_side_does_not_depend_on_the_direction_of_the_path),
        cmocka_unit_test(beside_a_guide_the_belt_carries_freely),
        cmocka_unit_test(
            the_outward_band_wins_over_slide_zones_and_the_first_obstacle_over_later_ones),
        cmocka_unit_test(the_later_belt_wins_and_nothing_moves_off_the_belts),
        cmocka_unit_test(cargo_crosses_the_border_to_a_belt_that_runs_along_it),
        cmocka_unit_test(faces_know_their_belt_where_a_speed_changes),
        cmocka_unit_test(the_field_on_a_grid_is_the_plain_rule_at_every_face),
        cmocka_unit_test(a_field_made_again_is_the_field_of_a_new_scene),
        cmocka_unit_test(no_component_exceeds_the_speed_of_the_fastest_belt),
        cmocka_unit_test(without_memory_no_field_is_given_or_lost),
        cmocka_unit_test(what_comes_over_a_gap_within_a_cell_falls_behind_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
