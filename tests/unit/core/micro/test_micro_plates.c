// The four microscopic solvers with plates that turn, are shifted, come and go. Expected values are derived.

#include "core/base/buffer.h"
#include "core/base/memory.h"
#include "core/micro/micro.h"
#include "core/scene/plate_range.h"
#include "tests/unit/core/helper_micro.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/core/helper_world.h"
#include "tests/unit/helper_amount.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <string.h>

enum { PARTS_MAX = 64 };

static const double radius = 0.012, mass = 0.0284;

// Cylinders on a belt that stands, and a plate of 5 mm, whose upper face goes out from its pivot in the middle of it: centred
// on its path. Do not move it once it was made.
typedef struct world {
    micro_def def;
    scene_belt belt;
    vec2 path[3];
    scene_obstacle plate;
    double times[2][4], values[2][4];
    vec2 shifts[4];
    micro_kind kinds[2]; // see def.n_kinds
    scene_pose poses[PARTS_MAX];
    uint32_t part_kinds[PARTS_MAX]; // every other one of the second kind
} world;

static void make_world(world *w, int solver)
{
    *w = (world){ .def = helper_micro_def(solver),
                  .belt = { .acceleration = INFINITY, .deceleration = INFINITY },
                  .path = { { 1.0, 0.9975 }, { 1.5, 0.9975 } },
                  .kinds[0] = {
                      .shape = { .type = SCENE_CYLINDER, .radius = radius, .height = 0.02 },
                      .material = { 210e9, 0.28 },
                      .mass = mass,
                      .spin_radius = 0.008 } };
    w->kinds[1] = w->kinds[0];
    w->kinds[1].shape.radius = 0.015;
    scene_obstacle_init(&w->plate);
    w->plate.n_points = 2;
    w->plate.path = w->path;
    w->plate.pivot = (vec2){ 1.0, 1.0 };
    w->def.domain = (scene_rect){ 0.0, 2.0, 0.0, 2.0 };
    w->def.n_belts = w->def.n_obstacles = w->def.n_kinds = 1;
    w->def.belts = &w->belt;
    w->def.obstacles = &w->plate;
    w->def.kinds = w->kinds;
    for (size_t k = 0; k < PARTS_MAX; k++)
        w->part_kinds[k] = k % 2;
    w->def.poses = w->poses;
}

// Nothing but contacts, without friction, acts.
static void make_bare(world *w)
{
    w->def.n_belts = 0;
    w->def.gravity = 0.0;
    w->def.contact[SCENE_HANDLING_CARGO].friction = 0.0;
}

static void add_part(world *w, double x, double y)
{
    assert_true(w->def.n_parts < PARTS_MAX);
    w->poses[w->def.n_parts++] = (scene_pose){ x, y, 0.0 };
}

static void set_turn(world *w, size_t n, const double *times, const double *angles)
{
    memcpy(w->times[0], times, n * sizeof *times);
    memcpy(w->values[0], angles, n * sizeof *angles);
    w->plate.turn = (scene_series){ n, w->times[0], n, w->values[0], INFINITY };
}

// With angles 0, or beside those that are set already.
static void set_shift(world *w, size_t n, const double *times, const vec2 *shifts)
{
    memcpy(w->times[0], times, n * sizeof *times);
    memcpy(w->shifts, shifts, n * sizeof *shifts);
    w->plate.turn = (scene_series){ n, w->times[0], n, w->values[0], INFINITY };
    w->plate.shifts = w->shifts;
    w->plate.n_shifts = n;
}

static void set_presence(world *w, size_t n, const double *times, const double *values)
{
    memcpy(w->times[1], times, n * sizeof *times);
    memcpy(w->values[1], values, n * sizeof *values);
    w->plate.presence = (scene_series){ n, w->times[1], n, w->values[1], INFINITY };
}

// How far belt friction lets a part slide that has a speed u: dv/dt = -mu g tanh(lambda v).
static double slide_of(double u, double friction, double lambda, double gravity)
{
    const int n = 1000;
    double sum = 0.0;

    for (int k = 0; k < n; k++) {
        const double v = u * (k + 0.5) / n;
        sum += v / (friction * gravity * tanh(lambda * v)) * u / n;
    }
    return sum;
}

// 0.1 m at 0.1 m/s over a belt that stands. At the end of the stroke the part slides on by its own speed.
static void a_pushed_part_has_the_speed_of_the_stroke_and_ends_where_it_ends(void **state)
{
    const double u = 0.1, times[] = { 0.1, 1.1 };
    const vec2 shifts[] = { { 0.0, 0.0 }, { 0.0, 0.1 } };

    for (int k = 0; k < HELPER_MICRO_SOLVERS; k++) {
        world w;
        make_world(&w, k);
        w.def.contact[SCENE_HANDLING_CARGO].friction = 0.0;
        const scene_contact *belt = &w.def.contact[SCENE_CONVEYOR_CARGO];
        set_shift(&w, 2, times, shifts);
        add_part(&w, 1.2, 1.0 + radius + 0.005);
        micro_solver *s = helper_micro_start(&w.def);
        helper_micro_advance_to(s, 1.0);
        const micro_part pushed = micro_part_of(s, 0);
        assert_near(pushed.v[1], u, 0.002 * u);
        assert_near(pushed.x[1], 1.0 + 0.09 + radius, 2e-5);
        helper_micro_advance_to(s, 2.5);
        const double slid = slide_of(u, belt->friction, belt->tanh_linear, w.def.gravity);
        assert_near(micro_part_of(s, 0).x[1], 1.0 + 0.1 + radius + slid, 0.03 * slid + 2e-5);
        assert_near(micro_part_of(s, 0).x[0], 1.2, 1e-6);
        s = micro_destroy(s);
    }
}

// A plate of given motion at u strikes a part at rest, which leaves at u (1 + e). The contact, a spring k and a dashpot d
// that do not pull, ends where their force does: with z = d/(2 sqrt(k m)) < 1 and q = sqrt(1 - z^2),
//
//     e = exp(-z/q atan2(2 z q, 2 z^2 - 1))
//
// Explicit steps follow it; implicit ones, whose step is longer than the contact, take up more.
static void a_struck_part_leaves_by_the_law_of_restitution(void **state)
{
    const double u = 0.3, times[] = { 0.0, 1.0 };
    const vec2 shifts[] = { { 0.0, 0.0 }, { 0.0, u } };

    for (int k = 0; k < HELPER_MICRO_SOLVERS; k++) {
        world w;
        make_world(&w, k);
        make_bare(&w);
        w.def.contact[SCENE_HANDLING_CARGO].damping = 20.0;
        set_shift(&w, 2, times, shifts);
        add_part(&w, 1.2, 1.0 + radius + 0.003);
        micro_solver *s = helper_micro_start(&w.def);
        helper_micro_advance_to(s, 0.1);
        const micro_part struck = micro_part_of(s, 0);
        const double z = 20.0 / (2.0 * sqrt(3.7e4 * mass)), q = sqrt(1.0 - z * z);
        const double e = exp(-z / q * atan2(2.0 * z * q, 2.0 * z * z - 1.0));
        if (helper_micro_solvers[k].integrator == MICRO_IMPLICIT)
            assert_true(0.99 * u < struck.v[1] && struck.v[1] < 1.01 * u * (1.0 + e));
        else
            assert_near(struck.v[1], u * (1.0 + e), 0.03 * u * e);
        assert_near(struck.v[0], 0.0, 1e-9);
        s = micro_destroy(s);
    }
}

// Two rows of eight parts, before a plate with a stroke of 0.17 m, 0.2 m before the open side: the second row is pushed over
// it by the first one, which stays.
static void a_row_is_pushed_off_the_belt(void **state)
{
    const double times[] = { 0.0, 1.7 };
    const vec2 shifts[] = { { 0.0, 0.0 }, { 0.0, 0.17 } };

    for (int k = HELPER_AMOUNT(0, 1); k < HELPER_MICRO_SOLVERS; k += 2) {
        world w;
        make_world(&w, k);
        w.def.domain.y_max = 1.2;
        w.def.edges[SCENE_NORTH] = SCENE_EDGE_OUTFLOW;
        set_shift(&w, 2, times, shifts);
        for (int m = 0; m < 16; m++)
            add_part(&w, 1.05 + 0.05 * (m % 8), 1.02 + 0.03 * (m / 8));
        micro_solver *s = helper_micro_start(&w.def);
        helper_micro_advance_to(s, 2.0);
        assert_int_equal(micro_measure(s).n_parts, 8);
        for (size_t m = 0; m < 8; m++)
            assert_true(micro_part_of(s, m).x[1] > 1.17 + radius - 1e-4);
        s = micro_destroy(s);
    }
}

// On a plate that turns at w the part slides outwards by rho'' = w^2 rho, from rest, which is rho' = w r there.
// Its speed across the plate is w rho, which needs the force 2 m w rho'; it is late by the time in which the
// contact takes up that force, d/k, and by a step.
static void a_part_that_a_plate_pushes_has_the_speed_of_its_surface(void **state)
{
    const double w = 1.0, t = 0.5, first = 0.2, times[] = { 0.0, 1.0 }, angles[] = { 0.0, w };

    for (int k = 0; k < HELPER_MICRO_SOLVERS; k++) {
        world d;
        make_world(&d, k);
        make_bare(&d);
        set_turn(&d, 2, times, angles);
        add_part(&d, 1.0 + first, 1.0 + radius);
        micro_solver *s = helper_micro_start(&d.def);
        helper_micro_advance_to(s, t);
        const double rho = first * cosh(w * t) + radius * sinh(w * t);
        const double rate = w * (first * sinh(w * t) + radius * cosh(w * t));
        const double late = 120.0 / 3.7e4 + micro_dt(s), tolerance = 2.0 * w * rate * late;
        const vec2 along = { cos(w * t), sin(w * t) }, across = vec2_turn_left(along);
        const micro_part p = micro_part_of(s, 0);
        const vec2 x = { p.x[0] - 1.0, p.x[1] - 1.0 }, v = { p.v[0], p.v[1] };
        assert_near(vec2_dot(v, across), w * rho, tolerance);
        assert_near(vec2_dot(v, along), rate - w * radius, tolerance);
        assert_near(vec2_dot(x, along), rho, tolerance);
        assert_near(vec2_dot(x, across), radius, 2e-5);
        s = micro_destroy(s);
    }
}

// The speed at which a plate is refused: by its step, and by its contacts, whose dashpot stops a part within v m/d.
static double largest_speed(int solver)
{
    return 0.25 * radius * fmin(1.0 / helper_micro_solvers[solver].dt, 120.0 / mass);
}

// Parts in the sector that the plate sweeps, from 0 to 2 rad to its left or to its right.
static void fill_sector(world *w, double side)
{
    for (int ring = 0; ring < HELPER_AMOUNT(9, 3); ring++)
        for (int k = 0; k < 5; k++) {
            const double rho = 0.1 + 0.04 * ring, angle = side * (0.3 + 0.35 * k);
            add_part(w, 1.0 + rho * cos(angle), 1.0 + rho * sin(angle));
        }
}

static void no_part_gets_behind_a_plate_that_sweeps(void **state)
{
    for (int k = 0; k < 2 * HELPER_MICRO_SOLVERS; k++) {
        const double side = k < HELPER_MICRO_SOLVERS ? 1.0 : -1.0, angles[] = { 0.0, 2.0 * side };
        const double times[] = { 0.0,
                                 2.0 * 0.505 / (0.999 * largest_speed(k % HELPER_MICRO_SOLVERS)) };
        world w;
        make_world(&w, k % HELPER_MICRO_SOLVERS);
        set_turn(&w, 2, times, angles);
        fill_sector(&w, side);
        if (side < 0.0) {
            w.def.n_kinds = 2;
            w.def.part_kinds = w.part_kinds;
        }
        micro_solver *s = helper_micro_start(&w.def);
        helper_micro_advance_to(s, times[1] + 0.1);
        for (size_t part = 0; part < w.def.n_parts; part++) {
            const micro_part p = micro_part_of(s, part);
            const vec2 x = { p.x[0] - 1.0, p.x[1] - 1.0 };
            const double angle = side * atan2(x.y, x.x);
            assert_true(p.is_gone || vec2_length(x) > 0.5 || angle < 0.0 || angle > 2.0);
        }
        s = micro_destroy(s);
    }
}

static void a_plate_that_is_too_fast_is_refused(void **state)
{
    const double times[] = { 0.0, 1.0 };

    for (int k = 0; k < HELPER_MICRO_SOLVERS; k++) {
        const double angles[] = { 0.0, 1.001 * largest_speed(k) / 0.505 };
        micro_solver *s = NULL;
        bf_error err;
        world w;
        make_world(&w, k);
        set_turn(&w, 2, times, angles);
        assert_int_equal(micro_create(&w.def, &s, &err), BF_EINPUT);
        assert_string_equal(err.pointer, "/obstacles/0/motion");
        // The step that is chosen is small enough, but where contacts are the bound.
        w.def.dt = 0.0;
        assert_true(micro_dt_chosen(&w.def) <= micro_dt_plates(&w.def));
        if (helper_micro_solvers[k].integrator == MICRO_IMPLICIT)
            s = micro_destroy(helper_micro_start(&w.def));
    }
}

static void the_largest_step_for_a_plate_is_named(void **state)
{
    const scene_action action = { .type = SCENE_ACTION_TURN, .value = 1.0, .over = 0.05 };
    micro_solver *s = NULL;
    bf_error err;
    world w;

    make_world(&w, 1);
    w.path[0].y = w.path[1].y = w.plate.pivot.y;
    w.plate.is_commanded = true;
    w.def.n_actions = 1;
    w.def.actions = &action;
    // 20 rad/s at 0.505 m: 0.003 m in 0.297 ms.
    assert_near(micro_dt_plates(&w.def), 0.003 / 10.1, 1e-12);
    assert_int_equal(micro_create(&w.def, &s, &err), BF_EINPUT);
    assert_string_equal(err.pointer, "/obstacles/0/motion");
    assert_non_null(strstr(err.text, "0.00029702"));
}

static void a_plate_that_does_not_move_has_the_bits_of_one_that_cannot(void **state)
{
    const double times[] = { 0.1, 0.2 }, zeros[] = { 0.0, 0.0 }, ones[] = { 1.0, 1.0 };

    for (int k = 0; k < HELPER_MICRO_SOLVERS; k++) {
        uint64_t digests[2];
        for (int moves = 0; moves < 2; moves++) {
            world w;
            make_world(&w, k);
            w.belt.velocity = (vec2){ 0.3, -0.3 };
            fill_sector(&w, 1.0);
            if (moves) {
                set_turn(&w, 2, times, zeros);
                set_presence(&w, 2, times, ones);
            }
            micro_solver *s = helper_micro_start(&w.def);
            helper_micro_advance_to(s, HELPER_AMOUNT(0.3, 0.1));
            assert_true(micro_measure(s).largest_overlap > 0.0);
            digests[moves] = micro_digest(s);
            s = micro_destroy(s);
        }
        assert_true(digests[0] == digests[1]);
    }
}

// A path with bends to both sides, turned by the document or by the schedule.
static void make_bent(world *w, int solver, bool is_scheduled)
{
    static const vec2 bent[] = { { 1.0, 1.0 }, { 1.2, 1.05 }, { 1.3, 1.2 } };
    const double times[] = { 0.0 }, angles[] = { 0.7 };
    plate_motion motion;

    make_world(w, solver);
    make_bare(w);
    w->def.start_velocity = (vec2){ 0.5, 0.2 };
    memcpy(w->path, bent, sizeof bent);
    w->plate.n_points = 3;
    w->plate.pivot = (vec2){ 0.9, 1.0 };
    for (int k = 0; k < 6; k++)
        add_part(w, 0.8 + 0.05 * k, 0.99 + 0.04 * k);
    if (is_scheduled) {
        set_turn(w, 1, times, angles);
        return;
    }
    assert_int_equal(plate_motion_init(&motion, 1, &w->plate, NULL), BF_OK);
    const plate_pose pose = plate_pose_of(&w->plate, (plate_displacement){ .angle = angles[0] });
    for (int k = 0; k < 3; k++)
        w->path[k] = plate_pose_move(&pose, bent[k]);
    plate_motion_fini(&motion);
}

static void a_bent_plate_is_turned_as_a_whole(void **state)
{
    for (int k = 0; k < HELPER_MICRO_SOLVERS; k++) {
        micro_solver *turned[2];
        for (int is_scheduled = 0; is_scheduled < 2; is_scheduled++) {
            world w;
            make_bent(&w, k, is_scheduled == 1);
            turned[is_scheduled] = helper_micro_start(&w.def);
            helper_micro_advance_to(turned[is_scheduled], HELPER_AMOUNT(1.0, 0.4));
            assert_true(micro_measure(turned[is_scheduled]).largest_overlap > 0.0);
        }
        for (size_t m = 0; m < 6; m++) {
            const micro_part a = micro_part_of(turned[0], m), b = micro_part_of(turned[1], m);
            assert_near(a.x[0], b.x[0], 1e-9);
            assert_near(a.x[1], b.x[1], 1e-9);
        }
        for (int m = 0; m < 2; m++)
            turned[m] = micro_destroy(turned[m]);
    }
}

// Across a belt of 0.4 m/s, at x = 1 m.
static void make_stop(world *w, int solver)
{
    make_world(w, solver);
    w->belt.velocity = (vec2){ 0.4, 0.0 };
    w->path[0] = (vec2){ 1.0, 0.5 };
    w->path[1] = (vec2){ 1.0, 1.5 };
}

// A part that is released is at the belt's speed within 1 cm: v^2/(2 mu g), and a little more by the tanh of (7).
static void a_stop_that_comes_and_goes_lets_parts_pass_and_holds_them(void **state)
{
    const double times[] = { 0.0, 1.0, 2.0 }, values[] = { 0.0, 1.0, 0.0 };

    for (int k = 0; k < HELPER_MICRO_SOLVERS; k++) {
        world w;
        make_stop(&w, k);
        set_presence(&w, 3, times, values);
        add_part(&w, 0.7, 1.0);
        add_part(&w, 0.5, 1.0);
        micro_solver *s = helper_micro_start(&w.def);
        helper_micro_advance_to(s, 2.0);
        assert_near(micro_part_of(s, 0).x[0], 1.5, 1e-4);
        assert_near(micro_part_of(s, 1).x[0], 1.0 - radius, 1e-4);
        assert_near(micro_part_of(s, 1).v[0], 0.0, 1e-3);
        helper_micro_advance_to(s, 2.5);
        assert_near(micro_part_of(s, 1).x[0], 1.0 - radius + 0.195, 0.006);
        assert_near(micro_part_of(s, 1).v[0], 0.4, 1e-3);
        s = micro_destroy(s);
    }
}

// It comes by the radius and its thickness of 5 mm in 0.2 s; with the bounding radius in space. Then parts slide on, by
// little more than v/(mu g lambda), as the belt's friction is nearly viscous at this speed.
static void a_plate_that_comes_upon_parts_pushes_them_to_their_sides(void **state)
{
    static const double offsets[] = { 0.010, 0.004, 0.0, -0.008, -0.014 };
    const double times[] = { 0.0, 0.1 }, values[] = { 0.0, 1.0 };

    for (int k = 0; k < HELPER_MICRO_SOLVERS; k++) {
        const bool is_planar = helper_micro_solvers[k].path == MICRO_PATH_PLANAR;
        const double speed = ((is_planar ? radius : hypot(radius, 0.01)) + 0.005) / 0.2;
        world w;
        make_world(&w, k);
        set_presence(&w, 2, times, values);
        // The stiffness of steel, and in space what does not let the cylinders rock.
        if (helper_micro_solvers[k].integrator == MICRO_IMPLICIT)
            w.def.modulus_reduction = is_planar ? 1.0 : 1e3;
        for (int m = 0; m < 5; m++)
            add_part(&w, 1.1 + 0.05 * m, 1.0 + offsets[m]);
        micro_solver *s = helper_micro_start(&w.def);
        for (int sample = 1; sample <= 45; sample++) {
            helper_micro_advance_to(s, 0.01 * sample);
            for (size_t m = 0; m < 5; m++)
                assert_true(fabs(micro_part_of(s, m).v[1]) <= 1.1 * speed);
        }
        for (size_t m = 0; m < 5; m++) {
            const double y = micro_part_of(s, m).x[1] - 1.0;
            const double gap = offsets[m] > -0.0025 ? y - radius : -radius - 0.005 - y;
            assert_true(-1e-4 < gap && gap < 1.2 * speed / 98.1 + 1e-4);
        }
        assert_true(micro_measure(s).largest_overlap < 5e-4);
        s = micro_destroy(s);
    }
}

// Of the times that follow, s: as many steps of either integrator.
static double unit_of(int solver)
{
    const double of_explicit = HELPER_AMOUNT(0.01, 0.004);

    return helper_micro_solvers[solver].integrator == MICRO_IMPLICIT ? 10.0 * of_explicit
                                                                     : of_explicit;
}

// Parts that a belt carries against a plate that swings, is shifted, goes, comes and is moved by commands.
static void make_busy(world *w, int solver)
{
    const double u = unit_of(solver), times[] = { 0.0, u, 2.0 * u };
    const double angles[] = { 0.0, 2.0 * u, 0.0 };
    const double switches[] = { 1.2 * u, 1.5 * u }, values[] = { 0.0, 1.0 };
    const vec2 shifts[] = { { 0.0, 0.0 }, { 0.1 * u, 0.4 * u }, { 0.0, 0.0 } };

    make_world(w, solver);
    w->belt.velocity = (vec2){ 0.2, -0.4 };
    set_turn(w, 3, times, angles);
    set_shift(w, 3, times, shifts);
    set_presence(w, 2, switches, values);
    w->plate.turn.repeat = 2.0 * u;
    w->plate.is_commanded = true;
    w->def.n_parts_expected = 60;
    for (int k = 0; k < 60; k++)
        add_part(w, 1.02 + 0.0265 * (k % 15), 1.02 + 0.0265 * (k / 15));
}

// More parts, for which the memory of the solver grows, and commands.
static void intervene(micro_solver *s, bf_world *own, double unit)
{
    for (int k = 0; k < 40; k++) {
        const micro_arrival arrival = { .pose = { 1.02 + 0.03 * (k % 10), 1.3 + 0.03 * (k / 10) },
                                        .velocity = { 0.2, -0.4 } };
        size_t part;
        assert_int_equal(micro_admit(s, &arrival, &part, NULL), BF_OK);
    }
    helper_world_turn(own, 3.0 * unit, 6.0 * unit, 2.0 * unit);
    helper_world_shift(own, 3.0 * unit, (vec2){ -0.2 * unit, 0.3 * unit }, 2.0 * unit);
    helper_world_presence(own, 3.0 * unit, true);
}

static void threads_cuts_and_checkpoints_do_not_change_a_bit(void **state)
{
    for (int k = 0; k < HELPER_MICRO_SOLVERS; k++) {
        const double unit = unit_of(k);
        bf_buffer bytes = { 0 };
        bf_error err = { 0 };
        world w;
        make_busy(&w, k);
        bf_world *of_whole = w.def.world = helper_world_of(&w.def);
        micro_solver *whole = helper_micro_start(&w.def), *cut;
        w.def.world = NULL;
        bf_world *of_cut = w.def.world = helper_world_of(&w.def);
        w.def.n_threads = 2;
        cut = helper_micro_start(&w.def);
        helper_micro_advance_to(whole, 3.0 * unit);
        for (int part = 1; part <= 10; part++)
            helper_micro_advance_to(cut, 0.3 * unit * part);
        assert_true(micro_digest(whole) == micro_digest(cut));
        intervene(whole, of_whole, unit);
        intervene(cut, of_cut, unit);
        helper_micro_advance_to(cut, 4.1 * unit);
        assert_int_equal(micro_save(cut, &bytes, &err), BF_OK);
        cut = micro_destroy(cut);
        w.def.n_threads = 1;
        w.def.world = NULL;
        w.def.world = helper_world_of(&w.def);
        helper_world_copy(of_cut, w.def.world);
        cut = helper_micro_start(&w.def);
        assert_int_equal(micro_load(cut, bytes.bytes, bytes.n, &err), BF_OK);
        helper_micro_advance_to(whole, 6.0 * unit);
        helper_micro_advance_to(cut, 6.0 * unit);
        assert_true(micro_digest(whole) == micro_digest(cut));
        assert_true(micro_measure(whole).n_contacts == micro_measure(cut).n_contacts);
        whole = micro_destroy(whole);
        cut = micro_destroy(cut);
        buffer_fini(&bytes);
    }
}

static void every_lack_of_memory_is_reported(void **state)
{
    const double times[] = { 0.0, 1.0 }, angles[] = { 0.0, 0.5 };

    for (int k = 0; k < HELPER_MICRO_SOLVERS; k++) {
        bf_status status = BF_ENOMEM;
        world w;
        make_world(&w, k);
        set_turn(&w, 2, times, angles);
        w.plate.force_limit = 1.0;
        w.def.world = helper_world_of(&w.def);
        for (int m = 0; m < 4; m++)
            add_part(&w, 1.1 + 0.05 * m, 1.0 + radius);
        for (size_t n = 1; status != BF_OK; n++) {
            micro_solver *s = NULL;
            memory_plan_fault(n, 0);
            status = micro_create(&w.def, &s, NULL);
            if (status == BF_OK)
                status = micro_advance(s, 20, NULL);
            memory_plan_fault(0, 0);
            assert_true(status == BF_OK || status == BF_ENOMEM);
            s = micro_destroy(s);
        }
    }
}

// Over 0.04 m. Contacts give less than a tenth of the speed back, with which the part goes ahead of the plate.
static void a_command_turns_a_plate(void **state)
{
    for (int k = 0; k < HELPER_MICRO_SOLVERS; k++) {
        world w;
        make_world(&w, k);
        make_bare(&w);
        w.plate.is_commanded = true;
        add_part(&w, 1.2, 1.0 + radius + 1e-4);
        w.def.world = helper_world_of(&w.def);
        micro_solver *s = helper_micro_start(&w.def);
        helper_micro_advance_to(s, 0.1);
        assert_near(micro_part_of(s, 0).x[1], 1.0 + radius + 1e-4, 1e-12);
        helper_world_turn(w.def.world, 0.1, 0.2, 0.2);
        helper_micro_advance_to(s, 0.3);
        const micro_part p = micro_part_of(s, 0);
        const vec2 x = { p.x[0] - 1.0, p.x[1] - 1.0 };
        const double ahead = vec2_dot(x, (vec2){ -sin(0.2), cos(0.2) }) - radius;
        assert_true(-5e-5 < ahead && ahead < 0.004);
        s = micro_destroy(s);
    }
}

// A part at 0.3 m from the pivot between the plate, which turns at 1 rad/s, and another plate, which stands.
static void make_vice(world *w, int solver, scene_obstacle obstacles[2], double torque)
{
    static const double times[] = { 0.0, 1.0 }, angles[] = { 0.0, 1.0 };
    static vec2 above[] = { { 1.1, 1.0285 }, { 1.6, 1.0285 } };

    make_world(w, solver);
    w->def.n_belts = 0;
    w->def.gravity = 0.0;
    set_turn(w, 2, times, angles);
    add_part(w, 1.3, 1.0 + radius + 1e-3);
    obstacles[0] = w->plate;
    scene_obstacle_init(&obstacles[1]);
    obstacles[1].n_points = 2;
    obstacles[1].path = above;
    w->def.n_obstacles = 2;
    w->def.obstacles = obstacles;
    obstacles[0].force_limit = torque / plate_range_radius(&obstacles[0]);
    w->def.world = helper_world_of(&w->def);
}

// It comes into contact at 2 mm of way and goes on until what bears on it has lasted, at most 10 % of the part's radius, and
// overlaps with both plates bear its force at the part's distance, M/0.3 m; their stiffness is 3.7e4 N/m.
static void a_drive_that_bears_its_limit_stalls(void **state)
{
    const double torque = 0.6, press = 2.0 * torque / 0.3 / 3.7e4;

    for (int k = 0; k < HELPER_MICRO_SOLVERS; k++) {
        scene_obstacle obstacles[2];
        world w;
        make_vice(&w, k, obstacles, torque);
        micro_solver *s = helper_micro_start(&w.def);
        const plate_motion *motion = &w.def.world->plates;
        helper_micro_advance_to(s, 0.08);
        const double way = 0.3 * plate_motion_at(motion, 0, 0.08).angle;
        assert_true(0.002 < way && way < 0.002 + press + 0.1 * radius);
        assert_int_equal(plate_drive_state_of(motion, 0, 0.08), PLATE_DRIVE_STALLED);
        helper_micro_advance_to(s, 0.12);
        assert_near(0.3 * plate_motion_at(motion, 0, 0.12).angle, way, 1e-12);
        assert_near(micro_part_of(s, 0).v[1], 0.0, 1e-3);
        s = micro_destroy(s);
    }
}

static void a_drive_that_lags_goes_on_with_the_same_bits(void **state)
{
    for (int k = 0; k < HELPER_MICRO_SOLVERS; k++) {
        scene_obstacle obstacles[2];
        bf_buffer bytes = { 0 };
        world w;
        make_vice(&w, k, obstacles, 0.6);
        bf_world *of_whole = w.def.world;
        micro_solver *whole = helper_micro_start(&w.def), *resumed;
        while (plate_drive_state_of(&of_whole->plates, 0,
                                    (double)micro_steps(whole) * micro_dt(whole)) ==
               PLATE_DRIVE_AS_TOLD)
            assert_int_equal(micro_advance(whole, 1, NULL), BF_OK);
        assert_int_equal(micro_save(whole, &bytes, NULL), BF_OK);
        w.def.n_threads = 2;
        w.def.world = NULL;
        w.def.world = helper_world_of(&w.def);
        helper_world_copy(of_whole, w.def.world);
        resumed = helper_micro_start(&w.def);
        assert_int_equal(micro_load(resumed, bytes.bytes, bytes.n, NULL), BF_OK);
        helper_micro_advance_to(whole, 0.08);
        helper_micro_advance_to(resumed, 0.08);
        assert_true(micro_digest(whole) == micro_digest(resumed));
        assert_true(plate_motion_at(&of_whole->plates, 0, 0.08).angle ==
                    plate_motion_at(&w.def.world->plates, 0, 0.08).angle);
        whole = micro_destroy(whole);
        resumed = micro_destroy(resumed);
        buffer_fini(&bytes);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_part_that_a_plate_pushes_has_the_speed_of_its_surface),
        cmocka_unit_test(a_pushed_part_has_the_speed_of_the_stroke_and_ends_where_it_ends),
        cmocka_unit_test(a_struck_part_leaves_by_the_law_of_restitution),
        cmocka_unit_test(a_row_is_pushed_off_the_belt),
        cmocka_unit_test(no_part_gets_behind_a_plate_that_sweeps),
        cmocka_unit_test(a_plate_that_is_too_fast_is_refused),
        cmocka_unit_test(the_largest_step_for_a_plate_is_named),
        cmocka_unit_test(a_plate_that_does_not_move_has_the_bits_of_one_that_cannot),
        cmocka_unit_test(a_stop_that_comes_and_goes_lets_parts_pass_and_holds_them),
        cmocka_unit_test(a_plate_that_comes_upon_parts_pushes_them_to_their_sides),
        cmocka_unit_test(a_command_turns_a_plate),
        cmocka_unit_test(a_drive_that_bears_its_limit_stalls),
        cmocka_unit_test(a_drive_that_lags_goes_on_with_the_same_bits),
        cmocka_unit_test(a_bent_plate_is_turned_as_a_whole),
        cmocka_unit_test(every_lack_of_memory_is_reported),
        cmocka_unit_test(threads_cuts_and_checkpoints_do_not_change_a_bit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
