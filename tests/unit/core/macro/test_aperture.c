// Apertures of the faces around the ends of plates: what plates take of a belt's width is their height and what the formula
// of core/macro/aperture.h adds.

#include "core/macro/aperture.h"

#include "core/base/polygon.h"
#include "core/macro/velocity_field.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>

static const scene_pose somewhere = { 0.1, 0.1, 0.0 };
static const double speed = 0.4;   // m/s
static const double exact = 1e-12; // m
static const double degree = M_PI / 180.0;

// A belt of 2 m x 1 m in cells, the short edges along it open.
static void make_belt(scene *s, double cell, vec2 velocity)
{
    helper_scene_belt(s, 2.0, 1.0, cell, &somewhere, 1);
    s->macro.closure = SCENE_CONGESTED;
    helper_scene_add_belt(s, velocity, NULL, 0);
    s->edges[SCENE_SOUTH] = s->edges[SCENE_NORTH] = SCENE_EDGE_WALL;
    s->edges[SCENE_WEST] = s->edges[SCENE_EAST] = SCENE_EDGE_OUTFLOW;
}

static void add_plate(scene *s, vec2 from, vec2 to)
{
    const vec2 path[] = { from, to };

    helper_scene_add_obstacle(s, path, 2, SCENE_WALL);
}

static vec2 beyond(vec2 from, double length, double angle)
{
    return (vec2){ from.x + length * cos(angle), from.y + length * sin(angle) };
}

// What of the width across x1 (axis 0) or x2 (axis 1) plates take away, m: the sum of what is closed of inner faces.
static double width_lost(scene *s, int axis)
{
    velocity_field *f = NULL;
    double lost = 0.0;

    helper_scene_resolve(s);
    assert_int_equal(velocity_field_create(s, &f, NULL), BF_OK);
    const bf_grid *g = &f->grid;
    const double *aperture = f->faces[axis].aperture;
    const size_t n_columns = g->n1 + (axis == 0);
    for (size_t j = (size_t)axis; j < g->n2; j++)
        for (size_t i = 1 - (size_t)axis; i < g->n1; i++) {
            const double a = aperture[j * n_columns + i];
            assert_true(a >= 0.0 && a <= 1.0);
            lost += (1.0 - a) * g->d1;
        }
    velocity_field_destroy(f);
    scene_fini(s);
    return lost;
}

// What is opposite of an end.
typedef enum opposite { NOTHING, SIDE, END } opposite;

// Frictions of a scene.
typedef struct frictions {
    double cargo, handling, wall, belt;
} frictions;

static const frictions fitted = { 0.15, 0.19, 0.19, 1.0 }; // the defaults

// delta of a plate's end whose angle to the belt has a sine and which is `way` from what is opposite, m: aperture.h.
static double extension(double sine, opposite other, const frictions *mu, double belt, double way)
{
    const double r = 0.012, a = sqrt(mu->cargo) - sqrt(0.15), square = sine * sine;
    const double along = other == END ? fmin(2.0 * pow(1.0 - square, 2.0), 1.0) : 0.0;
    double lost =
        r * (1.2 * square * (1.0 - along) + 2.0 * a + 0.4 * (sqrt(mu->handling) - sqrt(0.19)));

    if (other == SIDE)
        lost += r * (0.9 * square + 0.7 * a + 0.4 * (sqrt(mu->wall) - sqrt(0.19)));
    const double open = way - lost, stopping = belt * belt / (mu->belt * 9.81);
    const double slowing = other == NOTHING ? 0.0 : 0.9 * stopping / open * sqrt(2.0 * r / open);
    return fmin(1.0, 4.0 * fabs(sine)) * (way - open / sqrt(1.0 + slowing));
}

static double beside_wall(double sine, double way)
{
    return extension(sine, SIDE, &fitted, speed, way);
}

// That of a plate at a right angle to a belt of 1 m, which leaves `open` of it.
static double right_angled(double belt, double open, const frictions *mu)
{
    scene s;

    make_belt(&s, 0.01, (vec2){ belt, 0.0 });
    s.micro.contact[SCENE_CARGO_CARGO].friction = mu->cargo;
    s.micro.contact[SCENE_HANDLING_CARGO].friction = mu->handling;
    s.micro.contact[SCENE_CONVEYOR_CARGO].friction = mu->belt;
    s.micro.wall_friction = mu->wall;
    add_plate(&s, (vec2){ 1.0, 0.0 }, (vec2){ 1.0, 1.0 - open });
    return width_lost(&s, 0) - (1.0 - open);
}

// Three of 12 mm for one of 24 mm: a mean area of 7/4 of the smaller one's.
static void the_radius_is_that_of_the_mean_footprint(void **state)
{
    scene s;

    make_belt(&s, 0.01, (vec2){ speed, 0.0 });
    assert_near(aperture_radius(&s), 0.012, exact);
    s.n_cargo = 2;
    s.cargo[1] = s.cargo[0];
    s.cargo[0].share = 3.0;
    s.cargo[1].shape.radius = 0.024;
    assert_near(aperture_radius(&s), 0.012 * sqrt(7.0 / 4.0), exact);
    scene_fini(&s);
}

static void frictions_and_speed_widen_the_extension(void **state)
{
    static const frictions others[] = { { 0.15, 0.19, 0.0, 1.0 },
                                        { 0.5, 0.19, 0.19, 1.0 },
                                        { 0.15, 0.6, 0.3, 1.0 },
                                        { 0.15, 0.19, 0.19, 0.2 },
                                        { 0.05, 0.0, 0.0, 0.5 } };

    for (size_t k = 0; k < sizeof others / sizeof *others; k++)
        for (double belt = 0.1; belt < 2.0; belt *= 2.0)
            assert_near(right_angled(belt, 0.6, &others[k]),
                        extension(1.0, SIDE, &others[k], belt, 0.6), exact);
}

// A belt of 1 m so slow that it costs nothing, and a plate at an angle of which 0.6 m are left. Its parts are disks of 16 mm,
// or n of two kinds are boxes of 40 x 20 mm with the same area.
static void make_boxes(scene *s, double angle, int n)
{
    make_belt(s, 0.01, (vec2){ 1e-6, 0.0 });
    s->n_cargo = 2;
    s->cargo[1] = s->cargo[0];
    for (int k = 0; k < 2; k++) {
        s->cargo[k].shape =
            (scene_shape){ .type = SCENE_CYLINDER, .radius = sqrt(8e-4 / M_PI), .height = 0.02 };
        if (k < n)
            s->cargo[k].shape =
                (scene_shape){ .type = SCENE_BOX, .length = 0.04, .width = 0.02, .height = 0.02 };
    }
    add_plate(s, (vec2){ 1.0, 0.0 }, beyond((vec2){ 1.0, 0.0 }, 0.4 / sin(angle), angle));
}

// s of aperture.h where n of the two kinds are boxes.
static double arch_of_boxes(double angle, int n, double friction)
{
    const double r = sqrt(8e-4 / M_PI), e = sqrt(sqrt(5e-4) / r - 1.0), cosine = cos(angle);

    return 10.0 * r * 0.5 * n * e * sqrt(friction / 0.15) *
           (1.0 + 2.5 * fmin(cosine * cosine, 0.5));
}

// Of the m that disks have arches close a share exp(-m/s).
static void arches_of_boxes_close_a_share_of_the_outlet(void **state)
{
    scene s;

    for (double angle = 30.0 * degree; angle < 91.0 * degree; angle += 15.0 * degree)
        for (double friction = 0.1; friction < 1.0; friction *= 3.0) {
            double m = NAN;
            for (int n = 0; n <= 2; n++) {
                make_boxes(&s, angle, n);
                s.micro.contact[SCENE_CARGO_CARGO].friction = friction;
                const double open = 1.0 - width_lost(&s, 0);
                m = n == 0 ? open : m;
                if (n > 0)
                    assert_near(open, m * -expm1(-m / arch_of_boxes(angle, n, friction)), 1e-7);
            }
        }
}

// Between two ends an arch is as long as the whole outlet.
static void arches_stand_on_both_ends_of_a_funnel(void **state)
{
    double open[2];

    for (int k = 0; k < 2; k++) {
        scene s;
        make_boxes(&s, 90.0 * degree, 2 * k);
        add_plate(&s, (vec2){ 1.0, 1.0 }, (vec2){ 1.0, 0.8 });
        open[k] = 1.0 - width_lost(&s, 0);
    }
    assert_near(open[1], open[0] * -expm1(-open[0] / arch_of_boxes(90.0 * degree, 2, 0.15)), 1e-7);
}

// 0.4 m between two plates at 45 degrees: the ends hold off 1.2 sin^2(theta) of a radius each.
static void parts_with_corners_do_not_push_each_other_through_a_funnel(void **state)
{
    const double angle = 45.0 * degree, m = 0.2 - 0.6 * sqrt(8e-4 / M_PI);
    scene s;

    make_boxes(&s, angle, 2);
    add_plate(&s, (vec2){ 1.0, 1.0 }, beyond((vec2){ 1.0, 1.0 }, 0.2 / sin(angle), -angle));
    assert_near(1.0 - width_lost(&s, 0), 2.0 * m * -expm1(-2.0 * m / arch_of_boxes(angle, 2, 0.15)),
                1e-7);
}

static void boxes_do_not_arch_beside_an_open_edge(void **state)
{
    double lost[2];

    for (int k = 0; k < 2; k++) {
        scene s;
        make_boxes(&s, 90.0 * degree, 2 * k);
        s.edges[SCENE_NORTH] = SCENE_EDGE_OUTFLOW;
        lost[k] = width_lost(&s, 0);
    }
    assert_near(lost[1], lost[0], exact);
}

// What a slope accelerates cargo by, uphill or down, counts in the place of friction.
static void on_a_slope_the_extension_is_that_of_its_drive(void **state)
{
    for (double incline = -8.0 * degree; incline < 0.2; incline += 16.0 * degree) {
        const frictions drive = { 0.15, 0.19, 0.19, 0.3 * cos(incline) - sin(incline) };
        scene s;
        make_belt(&s, 0.01, (vec2){ 0.8, 0.0 });
        s.belts[0].friction = 0.3;
        s.belts[0].incline = incline;
        add_plate(&s, (vec2){ 1.0, 0.0 }, (vec2){ 1.0, 0.7 });
        assert_near(width_lost(&s, 0) - 0.7, right_angled(0.8, 0.3, &drive), exact);
    }
}

// Nothing but an outlet is left open by frictions and speeds without end: nine tenths of it are closed at most.
// The contact's friction is another one then.
static void a_belt_with_a_friction_of_its_own_has_the_extension_of_that(void **state)
{
    const frictions rough = { 0.15, 0.19, 0.19, 0.3 };
    scene s;

    make_belt(&s, 0.01, (vec2){ 0.8, 0.0 });
    s.belts[0].friction = rough.belt;
    add_plate(&s, (vec2){ 1.0, 0.0 }, (vec2){ 1.0, 0.7 });
    assert_near(width_lost(&s, 0) - 0.7, right_angled(0.8, 0.3, &rough), exact);
    assert_true(right_angled(0.8, 0.3, &rough) > right_angled(0.8, 0.3, &fitted) + 0.01);
}

static void an_extension_never_closes_the_outlet(void **state)
{
    const frictions slippery = { 0.15, 0.19, 0.19, 0.0 }, smooth = { 0.0, 0.0, 0.0, 1.0 };

    assert_near(right_angled(speed, 0.6, &slippery), 0.9 * 0.6, exact);
    assert_near(right_angled(speed, 0.02, &fitted), 0.9 * 0.02, exact);
    assert_true(right_angled(1e-3, 0.6, &smooth) >= 0.0);
}

static const double angles[] = { 45.0, 60.0, 75.0, 90.0, 105.0, 120.0, 135.0 };
static const double tips[] = { 0.4, 0.4001, 0.4033, 0.405, 0.4062, 0.4099, 0.5 };

// The plate takes its height, whatever share of its last cell that is, and goes on by delta.
static void a_plate_takes_its_height_and_its_extension(void **state)
{
    for (size_t a = 0; a < sizeof angles / sizeof *angles; a++)
        for (size_t k = 0; k < sizeof tips / sizeof *tips; k++)
            for (int north = 0; north < 2; north++) {
                const double angle = angles[a] * degree;
                const vec2 foot = { 1.0, north ? 1.0 : 0.0 };
                scene s;
                make_belt(&s, 0.01, (vec2){ speed, 0.0 });
                add_plate(&s, foot, beyond(foot, tips[k] / sin(angle), north ? -angle : angle));
                assert_near(width_lost(&s, 0), tips[k] + beside_wall(sin(angle), 1.0 - tips[k]),
                            exact);
            }
}

static void a_finer_grid_gives_the_same_width(void **state)
{
    static const double cells[] = { 0.02, 0.01, 0.005, 0.0025 };
    for (size_t k = 0; k < sizeof cells / sizeof *cells; k++) {
        scene s;
        make_belt(&s, cells[k], (vec2){ speed, 0.0 });
        add_plate(&s, (vec2){ 0.8, 0.0 }, beyond((vec2){ 0.8, 0.0 }, 0.5, 70.0 * degree));
        const double sine = sin(70.0 * degree);
        assert_near(width_lost(&s, 0), 0.5 * sine + beside_wall(sine, 1.0 - 0.5 * sine), exact);
    }
}

static void a_belt_that_moves_back_or_across_has_the_same_extensions(void **state)
{
    const double sine = sin(60.0 * degree);
    scene s;
    make_belt(&s, 0.01, (vec2){ -speed, 0.0 });
    add_plate(&s, (vec2){ 1.2, 0.0 }, beyond((vec2){ 1.2, 0.0 }, 0.5037, 120.0 * degree));
    assert_near(width_lost(&s, 0), 0.5037 * sine + beside_wall(sine, 1.0 - 0.5037 * sine), exact);
    for (int back = 0; back < 2; back++) {
        const double tilt = (back ? -30.0 : 30.0) * degree;
        make_belt(&s, 0.01, (vec2){ 0.0, back ? -speed : speed });
        s.edges[SCENE_WEST] = s.edges[SCENE_EAST] = SCENE_EDGE_WALL;
        s.edges[SCENE_SOUTH] = s.edges[SCENE_NORTH] = SCENE_EDGE_OUTFLOW;
        add_plate(&s, (vec2){ 0.0, 0.5 }, beyond((vec2){ 0.0, 0.5 }, 0.5037, tilt));
        assert_near(width_lost(&s, 1), 0.5037 * sine + beside_wall(sine, 2.0 - 0.5037 * sine),
                    exact);
    }
}

static void a_funnel_loses_an_extension_on_each_side(void **state)
{
    for (size_t k = 0; k < 4; k++) {
        const double angle = angles[k] * degree, sine = sin(angle);
        scene s;
        make_belt(&s, 0.01, (vec2){ speed, 0.0 });
        add_plate(&s, (vec2){ 1.0, 0.0 }, beyond((vec2){ 1.0, 0.0 }, 0.3733 / sine, angle));
        add_plate(&s, (vec2){ 1.0, 1.0 }, beyond((vec2){ 1.0, 1.0 }, 0.4127 / sine, -angle));
        assert_near(width_lost(&s, 0),
                    0.3733 + 0.4127 + 2.0 * extension(sine, END, &fitted, speed, 0.107), exact);
    }
}

// What a side of a lane costs, m: aperture.h; half of what is between n = 2 guides, or all up to a wall, is `way`.
static double lane_side(double sine, int n, const frictions *mu, double way)
{
    const double r = 0.012, a = sqrt(mu->cargo) - sqrt(0.15), square = sine * sine;
    double lost = r * (0.5 * square + 0.95 * a + 0.63 * (sqrt(mu->handling) - sqrt(0.19)));

    if (n == 1)
        lost += r * (0.95 * a + 0.63 * (sqrt(mu->wall) - sqrt(0.19)));
    const double open = way - lost, stopping = speed * speed / (mu->belt * 9.81);
    const double slowing = 0.9 * (1.0 - pow(1.0 - square, 2.0)) * stopping / open;
    return way - open / sqrt(1.0 + slowing * sqrt(2.0 * r / open));
}

// The open width between x2 = low and high in every column from x1 = 1.02 to 1.58 m, beside which all is open.
static void check_lane(scene *s, double low, double high, double width)
{
    velocity_field *f = NULL;

    helper_scene_resolve(s);
    assert_int_equal(velocity_field_create(s, &f, NULL), BF_OK);
    const bf_grid *g = &f->grid;
    for (size_t i = 102; i <= 158; i++) {
        double open = 0.0;
        for (size_t j = 0; j < g->n2; j++) {
            const double a = f->faces[0].aperture[j * (g->n1 + 1) + i], x2 = grid_x2(g, j);
            if (x2 > low - 1e-9 && x2 < high + 1e-9)
                open += a * g->d2;
            else
                assert_true(a == 1.0);
        }
        assert_near(open, width, exact);
    }
    velocity_field_destroy(f);
    scene_fini(s);
}

// Guides cost width along their whole lane, wherever they lie in their cells, and nothing of what is beside it.
static void a_lane_is_narrower_by_what_its_guides_cost(void **state)
{
    const frictions rough = { 0.45, 0.4, 0.4, 1.0 };

    for (size_t k = 0; tips[k] < 0.5; k++)
        for (int n = 1; n <= 2; n++) {
            const double at = tips[k], sine = sin(60.0 * degree), to = n == 1 ? 1.0 : 1.0 - at;
            const double side = lane_side(sine, n, &rough, (to - at) / n);
            const vec2 path[] = { { 1.0 - at / tan(60.0 * degree), 0.0 },
                                  { 1.0, at },
                                  { 1.6, at } };
            const vec2 other[] = { { path[0].x, 1.0 }, { 1.0, 1.0 - at }, { 1.6, 1.0 - at } };
            scene s;
            make_belt(&s, 0.01, (vec2){ speed, 0.0 });
            s.micro.contact[SCENE_CARGO_CARGO].friction = rough.cargo;
            s.micro.contact[SCENE_HANDLING_CARGO].friction = rough.handling;
            s.micro.wall_friction = rough.wall;
            helper_scene_add_obstacle(&s, path, 3, SCENE_WALL);
            if (n == 2)
                helper_scene_add_obstacle(&s, other, 3, SCENE_WALL);
            assert_true(side > 0.005);
            check_lane(&s, at, to, to - at - n * side);
        }
}

static void a_free_plate_goes_on_at_both_ends(void **state)
{
    for (size_t k = 0; k < sizeof angles / sizeof *angles; k++) {
        const double angle = angles[k] * degree, sine = sin(angle);
        scene s;
        make_belt(&s, 0.01, (vec2){ speed, 0.0 });
        add_plate(&s, (vec2){ 1.0, 0.3037 }, beyond((vec2){ 1.0, 0.3037 }, 0.3518 / sine, angle));
        assert_near(width_lost(&s, 0),
                    0.3518 + beside_wall(sine, 0.3037) + beside_wall(sine, 0.3445), exact);
    }
}

static void only_the_last_piece_of_a_bent_plate_counts(void **state)
{
    const double sine = sin(50.0 * degree);
    const vec2 bend = { 1.0, 0.3 }, tip = beyond(bend, 0.2, 50.0 * degree);
    const vec2 path[] = { { 1.0, 0.0 }, bend, tip };
    scene s;
    make_belt(&s, 0.01, (vec2){ speed, 0.0 });
    helper_scene_add_obstacle(&s, path, 3, SCENE_WALL);
    assert_near(width_lost(&s, 0), tip.y + beside_wall(sine, 1.0 - tip.y), exact);
}

// From wall to wall, and two plates that meet in the middle.
static void an_end_at_a_wall_or_at_another_plate_has_no_extension(void **state)
{
    scene s;
    make_belt(&s, 0.01, (vec2){ speed, 0.0 });
    add_plate(&s, (vec2){ 0.8, 0.0 }, (vec2){ 1.3, 1.0 });
    assert_near(width_lost(&s, 0), 1.0, exact);
    make_belt(&s, 0.01, (vec2){ speed, 0.0 });
    add_plate(&s, (vec2){ 0.8, 0.0 }, (vec2){ 1.2, 0.5 });
    add_plate(&s, (vec2){ 0.8, 1.0 }, (vec2){ 1.2, 0.5 });
    assert_near(width_lost(&s, 0), 1.0, exact);
}

// Each goes on as far as it does alone, though an end of the second one is within 45 degrees of the way to the wall: its tip, of a
// plate shorter than the radius of a part, or its foot.
static void a_plate_at_the_opposite_wall_is_no_end_of_a_funnel(void **state)
{
    const vec2 first[2] = { { 1.0, 0.0 }, { 1.0, 0.4 } };
    const vec2 second[2][2] = { { { 1.2, 1.0 }, { 1.2, 0.99 } }, { { 1.2, 1.0 }, { 1.5, 0.7 } } };
    scene s;

    make_belt(&s, 0.01, (vec2){ speed, 0.0 });
    assert_true(aperture_radius(&s) > 0.01);
    add_plate(&s, first[0], first[1]);
    const double alone = width_lost(&s, 0);
    for (int k = 0; k < 2; k++) {
        make_belt(&s, 0.01, (vec2){ speed, 0.0 });
        add_plate(&s, second[k][0], second[k][1]);
        const double second_alone = width_lost(&s, 0);
        make_belt(&s, 0.01, (vec2){ speed, 0.0 });
        add_plate(&s, first[0], first[1]);
        add_plate(&s, second[k][0], second[k][1]);
        assert_near(width_lost(&s, 0), alone + second_alone, exact);
    }
}

// The border of the domain where cargo leaves it bounds no outlet.
static void beside_an_open_edge_only_the_end_costs(void **state)
{
    scene s;

    make_belt(&s, 0.01, (vec2){ speed, 0.0 });
    s.edges[SCENE_NORTH] = SCENE_EDGE_OUTFLOW;
    add_plate(&s, (vec2){ 1.0, 0.0 }, (vec2){ 1.0, 0.4 });
    assert_near(width_lost(&s, 0), 0.4 + extension(1.0, NOTHING, &fitted, speed, 1.0), exact);
}

// A guide that begins upstream of the end is opposite like a wall.
static void a_guide_is_opposite_like_a_wall(void **state)
{
    scene s;

    make_belt(&s, 0.01, (vec2){ speed, 0.0 });
    s.micro.wall_friction = 0.8;
    add_plate(&s, (vec2){ 1.0, 0.0 }, (vec2){ 1.0, 0.4 });
    const double beside_the_wall = width_lost(&s, 0);
    make_belt(&s, 0.01, (vec2){ speed, 0.0 });
    s.micro.wall_friction = 0.8;
    add_plate(&s, (vec2){ 1.0, 0.0 }, (vec2){ 1.0, 0.4 });
    add_plate(&s, (vec2){ 0.5, 0.8 }, (vec2){ 1.5, 0.8 });
    const double beside_the_guide = width_lost(&s, 0);
    const frictions rough = { 0.15, 0.19, 0.8, 1.0 };
    assert_near(beside_the_guide, 0.4 + beside_wall(1.0, 0.4), exact);
    assert_near(beside_the_wall, 0.4 + extension(1.0, SIDE, &rough, speed, 0.6), exact);
}

static void beside_a_belt_that_does_not_move_plates_do_not_go_on(void **state)
{
    static const vec2 elsewhere[] = { { 0.0, 0.0 }, { 0.5, 0.0 }, { 0.5, 1.0 }, { 0.0, 1.0 } };
    scene s;
    helper_scene_belt(&s, 2.0, 1.0, 0.01, &somewhere, 1);
    s.macro.closure = SCENE_CONGESTED;
    helper_scene_add_belt(&s, (vec2){ speed, 0.0 }, elsewhere, 4);
    add_plate(&s, (vec2){ 1.0, 0.0 }, (vec2){ 1.0, 0.4 });
    assert_near(width_lost(&s, 0), 0.4, exact);
}

// Where nothing is partly closed, faces are open or closed as in the other closure; velocities are those of open faces.
static void a_face_is_closed_where_its_aperture_is_zero(void **state)
{
    scene s;
    velocity_field *f = NULL;
    size_t n_partly = 0;
    make_belt(&s, 0.01, (vec2){ speed, 0.0 });
    add_plate(&s, (vec2){ 1.0, 0.0 }, beyond((vec2){ 1.0, 0.0 }, 0.5, 60.0 * degree));
    helper_scene_resolve(&s);
    assert_int_equal(velocity_field_create(&s, &f, NULL), BF_OK);
    for (size_t k = 0; k < (f->grid.n1 + 1) * f->grid.n2; k++) {
        assert_int_equal(f->faces[0].closed[k] != 0, f->faces[0].aperture[k] == 0.0);
        n_partly += f->faces[0].aperture[k] > 0.0 && f->faces[0].aperture[k] < 1.0;
    }
    for (size_t k = 0; k < f->grid.n1 * (f->grid.n2 + 1); k++)
        assert_true(f->faces[1].aperture[k] == (f->faces[1].closed[k] ? 0.0 : 1.0));
    // The face that the extension ends in.
    assert_int_equal(n_partly, 1);
    velocity_field_destroy(f);
    scene_fini(&s);
}

enum { EDGE_CELLS = 50, ALL_CELLS = EDGE_CELLS * EDGE_CELLS };

static size_t cell_at(const bf_grid *g, vec2 at)
{
    return (size_t)((at.y - g->lower2) / g->d2) * EDGE_CELLS + (size_t)((at.x - g->lower1) / g->d1);
}

static vec2 centre_of(const bf_grid *g, size_t cell)
{
    return (vec2){ g->lower1 + ((double)(cell % EDGE_CELLS) + 0.5) * g->d1,
                   g->lower2 + ((double)(cell / EDGE_CELLS) + 0.5) * g->d2 };
}

// What is open of the face between two neighbours.
static double aperture_between(const velocity_field *f, size_t cell, size_t other)
{
    const size_t upper = cell > other ? cell : other;

    if (cell % EDGE_CELLS != other % EDGE_CELLS)
        return f->faces[0].aperture[upper / EDGE_CELLS * (EDGE_CELLS + 1) + upper % EDGE_CELLS];
    return f->faces[1].aperture[upper];
}

// Whether cells are joined by faces that are open by half and more, none of them beyond the place where the outlet begins.
static bool are_joined(const velocity_field *f, vec2 from, vec2 to, vec2 outlet, vec2 side)
{
    const bf_grid *g = &f->grid;
    const size_t target = cell_at(g, to);
    bool is_known[ALL_CELLS] = { false };
    size_t queue[ALL_CELLS], n = 0;

    queue[n++] = cell_at(g, from);
    is_known[queue[0]] = true;
    for (size_t k = 0; k < n; k++) {
        const size_t cell = queue[k], i = cell % EDGE_CELLS, j = cell / EDGE_CELLS;
        const size_t beside[] = { i > 0 ? cell - 1 : cell, i + 1 < EDGE_CELLS ? cell + 1 : cell,
                                  j > 0 ? cell - EDGE_CELLS : cell,
                                  j + 1 < EDGE_CELLS ? cell + EDGE_CELLS : cell };
        for (size_t m = 0; m < 4; m++) {
            const size_t other = beside[m];
            if (is_known[other] || aperture_between(f, cell, other) < 0.5 ||
                polygon_segments_touch(centre_of(g, cell), centre_of(g, other), outlet, side, 0.0))
                continue;
            is_known[other] = true;
            queue[n++] = other;
        }
    }
    return is_known[target];
}

// Plate and extension are one line without a gap, wherever the tip lies in its cell and whatever the angle of the belt.
static void nothing_passes_between_a_plate_and_its_extension(void **state)
{
    const double cell = 0.004, far = 1.0;

    for (double turned = 0.0; turned < 90.0; turned += 10.0)
        for (double angle = 45.0; angle <= 90.0; angle += 15.0)
            for (int k = 0; k < 16; k++) {
                const double belt = turned * degree, plate = belt + angle * degree;
                const double across = belt + M_PI / 2.0, sine = sin(angle * degree);
                const double length = extension(sine, NOTHING, &fitted, speed, far);
                const vec2 tip = { 0.1 + 0.07 * cell * k, 0.1 + 0.11 * cell * k };
                const vec2 outlet = beyond(tip, length - 0.75 * cell, across);
                velocity_field *f = NULL;
                scene s;
                helper_scene_belt(&s, EDGE_CELLS * cell, EDGE_CELLS * cell, cell, &somewhere, 1);
                s.macro.closure = SCENE_CONGESTED;
                helper_scene_add_belt(&s, beyond((vec2){ 0.0, 0.0 }, speed, belt), NULL, 0);
                for (int side = 0; side < SCENE_SIDE_COUNT; side++)
                    s.edges[side] = SCENE_EDGE_OUTFLOW;
                add_plate(&s, beyond(tip, -far, plate), tip);
                helper_scene_resolve(&s);
                assert_int_equal(velocity_field_create(&s, &f, NULL), BF_OK);
                assert_false(are_joined(f, beyond(tip, -0.06, belt), beyond(tip, 0.06, belt),
                                        outlet, beyond(tip, far, across)));
                velocity_field_destroy(f);
                scene_fini(&s);
            }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_radius_is_that_of_the_mean_footprint),
        cmocka_unit_test(frictions_and_speed_widen_the_extension),
        cmocka_unit_test(arches_of_boxes_close_a_share_of_the_outlet),
        cmocka_unit_test(arches_stand_on_both_ends_of_a_funnel),
        cmocka_unit_test(parts_with_corners_do_not_push_each_other_through_a_funnel),
        cmocka_unit_test(boxes_do_not_arch_beside_an_open_edge),
        cmocka_unit_test(a_belt_with_a_friction_of_its_own_has_the_extension_of_that),
        cmocka_unit_test(on_a_slope_the_extension_is_that_of_its_drive),
        cmocka_unit_test(an_extension_never_closes_the_outlet),
        cmocka_unit_test(a_plate_takes_its_height_and_its_extension),
        cmocka_unit_test(a_finer_grid_gives_the_same_width),
        cmocka_unit_test(a_belt_that_moves_back_or_across_has_the_same_extensions),
        cmocka_unit_test(a_funnel_loses_an_extension_on_each_side),
        cmocka_unit_test(a_lane_is_narrower_by_what_its_guides_cost),
        cmocka_unit_test(a_free_plate_goes_on_at_both_ends),
        cmocka_unit_test(only_the_last_piece_of_a_bent_plate_counts),
        cmocka_unit_test(an_end_at_a_wall_or_at_another_plate_has_no_extension),
        cmocka_unit_test(a_plate_at_the_opposite_wall_is_no_end_of_a_funnel),
        cmocka_unit_test(beside_an_open_edge_only_the_end_costs),
        cmocka_unit_test(a_guide_is_opposite_like_a_wall),
        cmocka_unit_test(beside_a_belt_that_does_not_move_plates_do_not_go_on),
        cmocka_unit_test(a_face_is_closed_where_its_aperture_is_zero),
        cmocka_unit_test(nothing_passes_between_a_plate_and_its_extension),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
