// Obstacles that turn, are shifted, come and go in the macroscopic model: what plates sweep over stays on the side that they move
// to, mass is conserved, and the field is that of their present places. Expected values are derived.

#include "core/macro/moving_field.h"

#include "core/base/memory.h"
#include "core/macro/macro.h"
#include "core/world/plate_motion.h"
#include "tests/unit/core/helper_macro.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_amount.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double degree = M_PI / 180.0;

enum { KINDS = 4 };

// Both closures with both schemes.
static const struct {
    scene_closure closure;
    scene_scheme scheme;
    double full; // density up to which plates fill cells
} kinds[KINDS] = {
    { SCENE_DISPERSIVE, SCENE_SCHEME_ROE, 1.0 },
    { SCENE_DISPERSIVE, SCENE_SCHEME_MUSCL, 1.0 },
    { SCENE_CONGESTED, SCENE_SCHEME_ROE, 0.93 },
    { SCENE_CONGESTED, SCENE_SCHEME_MUSCL, 0.93 },
};

static scene_series series(size_t n, const double *times, const double *values)
{
    return helper_scene_series(n, times, values, INFINITY);
}

// A closed box of 0.8 m x 0.3 m in 1 cm cells, with a belt along it and a plate between the long walls, longer than
// they are apart, that pivots on the southern one.
static void make_box(scene *s, int kind, double speed, scene_series turn)
{
    static const scene_pose somewhere = { 0.1, 0.1, 0.0 };
    static const vec2 path[] = { { 0.4, 0.0 }, { 0.4, 0.5 } };

    helper_scene_belt(s, 0.8, 0.3, 0.01, &somewhere, 1);
    s->macro.closure = kinds[kind].closure;
    s->macro.scheme = kinds[kind].scheme;
    for (int side = 0; side < SCENE_SIDE_COUNT; side++)
        s->edges[side] = SCENE_EDGE_WALL;
    helper_scene_add_belt(s, (vec2){ speed, 0.0 }, NULL, 0);
    helper_scene_add_obstacle(s, path, 2, SCENE_SEALED)->turn = turn;
    helper_scene_resolve(s);
    s->macro.step = 0.002;
}

// A solver with its plates.
typedef struct model {
    const scene *scene;
    bf_grid grid;
    bf_world *world;
    moving_field *plates;
    macro_solver *solver;
} model;

static bf_world *world_of(const scene *s)
{
    bf_world *w = memory_alloc(1, sizeof *w);

    assert_int_equal(world_init(w, s, NULL), BF_OK);
    return w;
}

static model start(const scene *s, int n_threads)
{
    model m = { .scene = s, .grid = scene_grid(s) };

    m.world = world_of(s);
    assert_int_equal(moving_field_create(s, m.world, &m.plates, NULL), BF_OK);
    const velocity_field *f = moving_field_now(m.plates);
    macro_def def = helper_macro_def(s, f);
    def.n_threads = n_threads;
    def.tracer_portion = 1.0;
    for (int side = 0; side < SCENE_SIDE_COUNT; side++)
        def.mirror[side] = def.one_way[side] = true;
    assert_int_equal(macro_create(&def, &m.solver, NULL), BF_OK);
    return m;
}

static void stop(model *m)
{
    macro_destroy(m->solver);
    moving_field_destroy(m->plates);
    world_fini(m->world);
    memory_free(m->world);
}

// Sets a density where x_min <= x1 < x_max.
static void fill(const model *m, double x_min, double x_max, double density)
{
    const size_t n = grid_cells(&m->grid);
    double *rho = memory_alloc(n, sizeof *rho);

    for (size_t k = 0; k < n; k++) {
        const double x = grid_x1(&m->grid, k % m->grid.n1);
        rho[k] = x >= x_min && x < x_max ? density : 0.0;
    }
    macro_set_density(m->solver, rho);
    memory_free(rho);
}

static void advance(const model *m, int n_steps)
{
    for (int k = 0; k < n_steps; k++) {
        moving_field_update(m->plates, m->solver);
        macro_step(m->solver);
    }
    assert_int_equal(macro_check(m->solver, NULL), BF_OK);
}

static double mass_of(const model *m)
{
    return macro_measure(m->solver).mass;
}

// Mass on the downstream side of the box's plate at an angle to its path, m2.
static double mass_behind(const model *m, double turned)
{
    const vec2 along = { -sin(turned), cos(turned) };
    double sum = 0.0;

    for (size_t j = 0; j < m->grid.n2; j++)
        for (size_t i = 0; i < m->grid.n1; i++) {
            const vec2 to = { grid_x1(&m->grid, i) - 0.4, grid_x2(&m->grid, j) };
            sum += vec2_dot(vec2_turn_left(along), to) < 0.0 ? macro_row(m->solver, j)[i] : 0.0;
        }
    return sum * m->grid.d1 * m->grid.d2;
}

// Tracers in cells on that side.
static size_t tracers_behind(const model *m, double turned)
{
    const vec2 along = { -sin(turned), cos(turned) };
    double portion;
    size_t n, n_behind = 0;
    const macro_tracer *inside = macro_tracers(m->solver, &n, &portion);

    assert_near(portion * (double)n * m->grid.d1 * m->grid.d2, mass_of(m), 0.01 * mass_of(m));
    for (size_t k = 0; k < n; k++) {
        const vec2 to = { grid_x1(&m->grid, inside[k].column) - 0.4,
                          grid_x2(&m->grid, inside[k].row) };
        n_behind += vec2_dot(vec2_turn_left(along), to) < 0.0;
    }
    return n_behind;
}

// Loose cargo upstream of the plate, which turns against it by 30 degrees and back, with the tip at up to 0.5 m/s.
static void nothing_passes_a_plate_that_sweeps_through_a_heap(void **state)
{
    static const double times[] = { 0.1, 0.7, 0.9, 1.5 };
    const double angles[] = { 0.0, 30.0 * degree, 30.0 * degree, 0.0 };

    for (int k = 0; k < KINDS; k++)
        for (int moves = HELPER_AMOUNT(0, 1); moves < 2; moves++) {
            scene s;
            make_box(&s, k, moves != 0 ? 0.2 : 0.0, series(4, times, angles));
            model m = start(&s, 1);
            fill(&m, 0.1, 0.4, 0.5);
            const double mass = mass_of(&m);
            advance(&m, 400);
            assert_true(mass_behind(&m, 30.0 * degree) <= 1e-12 * mass);
            assert_int_equal(tracers_behind(&m, 30.0 * degree), 0);
            assert_near(mass_of(&m), mass, 1e-12 * mass);
            // Where the belt stands nothing else moves the cargo: there is room, and it is filled up to `full`.
            if (moves == 0)
                assert_near(macro_measure(m.solver).peak, kinds[k].full, 1e-12);
            advance(&m, 600);
            assert_true(mass_behind(&m, 0.0) <= 1e-12 * mass);
            assert_int_equal(tracers_behind(&m, 0.0), 0);
            assert_near(mass_of(&m), mass, 1e-12 * mass);
            stop(&m);
            scene_fini(&s);
        }
}

// Half of the plate's sector of 30 degrees and height 0.3 m, 0.5 0.3^2 tan(30 degrees) = 0.026 m2, is swept on a belt that
// stands. What lay there, and nothing else, has moved.
static void a_plate_moves_what_it_sweeps_and_nothing_else(void **state)
{
    static const double times[] = { 0.1, 0.7 };
    const double angles[] = { 0.0, 30.0 * degree }, density = 0.2;
    scene s;

    make_box(&s, 0, 0.0, series(2, times, angles));
    model m = start(&s, 1);
    fill(&m, 0.0, 0.8, density);
    advance(&m, 500);
    double moved = 0.0, taken = 0.0;
    for (size_t j = 0; j < m.grid.n2; j++)
        for (size_t i = 0; i < m.grid.n1; i++) {
            const double change = macro_row(m.solver, j)[i] - density;
            const double x = grid_x1(&m.grid, i) - 0.4, y = grid_x2(&m.grid, j);
            const bool is_swept = x < 0.0 && x * cos(30.0 * degree) + y * sin(30.0 * degree) > 0.0;
            assert_true(is_swept ? change == -density : change >= 0.0);
            moved += fmax(change, 0.0);
            taken -= fmin(change, 0.0);
        }
    assert_near(taken * 1e-4, density * 0.5 * 0.09 * tan(30.0 * degree), 0.02 * density * 0.026);
    assert_near(moved, taken, 1e-12 * taken);
    stop(&m);
    scene_fini(&s);
}

// The box with a plate that is shifted from one time to another one.
static void make_shifted(scene *s, int kind, const vec2 path[2], vec2 to)
{
    static const double times[] = { 0.1, 0.7 }, angles[] = { 0.0, 0.0 };

    make_box(s, kind, 0.0, series(2, times, angles));
    scene_obstacle *o = &s->obstacles[0];
    o->path[0] = o->pivot = path[0];
    o->path[1] = path[1];
    o->shifts = memory_alloc(2, sizeof *o->shifts);
    assert_non_null(o->shifts);
    o->n_shifts = 2;
    o->shifts[1] = to;
}

// A plate between the long walls goes 0.1 m against a belt that stands: what lay on 0.1 m by 0.3 m, whole cells, lies ahead.
static void a_plate_that_is_shifted_moves_what_it_sweeps(void **state)
{
    static const vec2 across[] = { { 0.4, -0.01 }, { 0.4, 0.31 } };
    const double density = 0.4;

    for (int k = 0; k < KINDS; k++) {
        scene s;
        make_shifted(&s, k, across, (vec2){ -0.1, 0.0 });
        model m = start(&s, 1);
        fill(&m, 0.0, 0.8, density);
        const double mass = mass_of(&m);
        double ahead = 0.0;
        advance(&m, 500);
        for (size_t j = 0; j < m.grid.n2; j++)
            for (size_t i = 0; i < m.grid.n1; i++) {
                const double x = grid_x1(&m.grid, i), rho = macro_row(m.solver, j)[i];
                if (x > 0.3)
                    assert_true(rho == (x < 0.4 ? 0.0 : density));
                else
                    ahead += rho - density;
                assert_true(rho <= kinds[k].full * (1.0 + 1e-12));
            }
        assert_near(ahead * 1e-4, density * 0.1 * 0.3, 1e-12 * mass);
        assert_near(mass_of(&m), mass, 1e-12 * mass);
        stop(&m);
        scene_fini(&s);
    }
}

// A plate along the belt goes 0.1 m across it towards an open side. The belt is full: as much leaves over that side.
static void what_a_shifted_plate_pushes_over_an_open_side_leaves(void **state)
{
    static const vec2 along[] = { { -0.01, 0.1 }, { 0.81, 0.1 } };

    for (int k = 0; k < KINDS; k++) {
        scene s;
        make_shifted(&s, k, along, (vec2){ 0.0, 0.1 });
        s.edges[SCENE_NORTH] = SCENE_EDGE_OUTFLOW;
        model m = start(&s, 1);
        fill(&m, 0.0, 0.8, kinds[k].full);
        const double mass = mass_of(&m);
        advance(&m, 500);
        assert_near(mass - mass_of(&m), kinds[k].full * 0.1 * 0.8, 1e-12 * mass);
        for (size_t j = 0; j < m.grid.n2; j++)
            for (size_t i = 0; i < m.grid.n1; i++) {
                const double y = grid_x2(&m.grid, j);
                assert_near(macro_row(m.solver, j)[i], y > 0.1 && y < 0.2 ? 0.0 : kinds[k].full,
                            1e-12);
            }
        stop(&m);
        scene_fini(&s);
    }
}

// Once the side ahead is full its drive pushes against nothing that could go anywhere: it stands where that side's area
// is what the cargo fills, but for a cell along its length and what was between the density and `full`.
static void where_there_is_no_room_the_plate_stalls(void **state)
{
    static const double times[] = { 0.1, 0.7 };
    const double angles[] = { 0.0, 20.0 * degree }, part = 0.9;

    for (int k = 0; k < KINDS; k++) {
        scene s;
        make_box(&s, k, 0.0, series(2, times, angles));
        model m = start(&s, 1);
        fill(&m, 0.0, 0.4, part * kinds[k].full);
        const double mass = mass_of(&m), stalled = atan2((1.0 - part) * 0.4 * 0.3, 0.5 * 0.09);
        advance(&m, 500);
        const plate_motion *motion = &m.world->plates;
        const double angle = plate_motion_at(motion, 0, macro_time(m.solver)).angle;
        assert_int_equal(plate_drive_state_of(motion, 0, macro_time(m.solver)),
                         PLATE_DRIVE_STALLED);
        assert_near(angle, stalled, m.grid.d1 / 0.15);
        assert_true(mass_behind(&m, angle) <= 1e-12 * mass);
        assert_near(mass_of(&m), mass, 1e-12 * mass);
        assert_true(macro_measure(m.solver).peak < 1.05 * kinds[k].full);
        stop(&m);
        scene_fini(&s);
    }
}

// A diverter with a free tip, 0.15 m from the wall, swings ten times over a belt that moves cargo past it.
static void make_diverter(scene *s, int kind)
{
    static const scene_pose somewhere = { 0.1, 0.1, 0.0 };
    static const vec2 path[] = { { 0.4, 0.0 }, { 0.6, 0.2 } };
    static const double times[] = { 0.05, 0.25, 0.4, 0.5 };
    const double angles[] = { 0.0, 45.0 * degree, 45.0 * degree, 0.0 };

    helper_scene_belt(s, 0.8, 0.35, 0.01, &somewhere, 1);
    s->macro.closure = kinds[kind].closure;
    s->macro.scheme = kinds[kind].scheme;
    for (int side = 0; side < SCENE_SIDE_COUNT; side++)
        s->edges[side] = SCENE_EDGE_WALL;
    helper_scene_add_belt(s, (vec2){ 0.2, 0.0 }, NULL, 0);
    scene_obstacle *o = helper_scene_add_obstacle(s, path, 2, SCENE_SEALED);
    o->turn = series(4, times, angles);
    o->turn.repeat = 0.6;
    helper_scene_resolve(s);
    s->macro.step = 0.002;
}

static void mass_is_conserved_through_ten_swings(void **state)
{
    for (int k = 0; k < KINDS; k++) {
        scene s;
        make_diverter(&s, k);
        model m = start(&s, 1);
        fill(&m, 0.1, 0.7, 0.4);
        const double mass = mass_of(&m);
        for (int swing = 0; swing < HELPER_AMOUNT(10, 2); swing++) {
            advance(&m, 300);
            assert_near(mass_of(&m), mass, 1e-12 * mass);
            for (size_t c = 0; c < grid_cells(&m.grid); c++)
                assert_true(macro_row(m.solver, c / m.grid.n1)[c % m.grid.n1] >= 0.0);
        }
        stop(&m);
        scene_fini(&s);
    }
}

// The plate comes down on the wall; what lay between them leaves at its tip and not through it.
static void a_gap_that_closes_is_emptied_at_its_open_end(void **state)
{
    static const vec2 path[] = { { 0.2, 0.0 }, { 0.2 + 0.3, 0.1 } };
    static const double times[] = { 0.1, 0.9 };
    const double angles[] = { 0.0, -atan2(0.1, 0.3) };
    scene s;

    make_box(&s, 0, 0.0, series(2, times, angles));
    memcpy(s.obstacles[0].path, path, sizeof path);
    s.obstacles[0].pivot = path[0];
    model m = start(&s, 1);
    const size_t n = grid_cells(&m.grid);
    double *rho = memory_alloc(n, sizeof *rho);
    for (size_t c = 0; c < n; c++) {
        const double x = grid_x1(&m.grid, c % m.grid.n1), y = grid_x2(&m.grid, c / m.grid.n1);
        rho[c] = x > 0.2 && x < 0.5 && y < (x - 0.2) / 3.0 - 1e-6 ? 0.15 : 0.0;
    }
    macro_set_density(m.solver, rho);
    memory_free(rho);
    const double mass = mass_of(&m);
    advance(&m, 600);
    assert_near(mass_of(&m), mass, 1e-12 * mass);
    assert_true(macro_mass_in(m.solver, 0, 49, 0, m.grid.n2) <= 1e-12 * mass);
    stop(&m);
    scene_fini(&s);
}

// A gate across the belt that is there from 0.2 to 0.6 s.
static void a_gate_holds_cargo_as_long_as_it_is_there(void **state)
{
    static const double times[] = { 0.0, 0.2, 0.6 }, values[] = { 0.0, 1.0, 0.0 };

    for (int k = 0; k < KINDS; k++) {
        scene s;
        make_box(&s, k, 0.2, (scene_series){ .repeat = INFINITY });
        s.obstacles[0].presence = series(3, times, values);
        model m = start(&s, 1);
        fill(&m, 0.3, 0.6, 0.5);
        const double mass = mass_of(&m);
        // The belt carries it by 2 cells in 50 steps.
        advance(&m, 101);
        const double passed = mass_behind(&m, 0.0);
        assert_near(passed, mass * (2.0 / 3.0 + 0.04 / 0.3), 0.02 * mass);
        advance(&m, 199);
        assert_near(mass_behind(&m, 0.0), passed, 1e-12 * mass);
        advance(&m, 300);
        assert_true(mass_behind(&m, 0.0) > passed + 0.05 * mass);
        assert_near(mass_of(&m), mass, 1e-12 * mass);
        stop(&m);
        scene_fini(&s);
    }
}

// After 0.25 s it rests at 45 degrees to its path, across the belt.
static void a_plate_that_came_to_rest_has_the_field_of_one_that_stands_there(void **state)
{
    for (int k = 0; k < KINDS; k += 2) {
        scene s, other;
        velocity_field *f = NULL;
        make_diverter(&s, k);
        make_diverter(&other, k);
        plate_motion motion;
        assert_int_equal(plate_motion_init(&motion, 1, s.obstacles, NULL), BF_OK);
        const plate_pose pose = plate_pose_of(&s.obstacles[0], plate_motion_at(&motion, 0, 0.3));
        for (size_t i = 0; i < 2; i++)
            other.obstacles[0].path[i] = plate_pose_move(&pose, s.obstacles[0].path[i]);
        model m = start(&s, 1);
        advance(&m, 150);
        assert_int_equal(velocity_field_create(&other, &f, NULL), BF_OK);
        assert_true(helper_macro_is_same_field(moving_field_now(m.plates), f));
        velocity_field_destroy(f);
        plate_motion_fini(&motion);
        stop(&m);
        scene_fini(&s);
        scene_fini(&other);
    }
}

static void a_plate_that_has_been_turned_into_the_belts_direction_holds_nothing_back(void **state)
{
    scene s;

    make_diverter(&s, 0);
    s.obstacles[0].path[1].y = 0.0; // along the belt
    assert_near(helper_macro_velocity_at(&s, (vec2){ 0.5, 0.02 }).x, 0.2, 0.0);
    assert_near(helper_macro_velocity_at(&s, (vec2){ 0.5, 0.02 }).y, 0.0, 0.0);
    scene_fini(&s);
}

static void any_number_of_threads_gives_the_same_bits(void **state)
{
    for (int k = 0; k < KINDS; k++) {
        scene s;
        make_diverter(&s, k);
        model one = start(&s, 1);
        fill(&one, 0.1, 0.7, 0.7);
        advance(&one, HELPER_AMOUNT(120, 50));
        model three = start(&s, 3);
        fill(&three, 0.1, 0.7, 0.7);
        advance(&three, HELPER_AMOUNT(120, 50));
        assert_true(macro_digest(three.solver) == macro_digest(one.solver));
        stop(&three);
        stop(&one);
        scene_fini(&s);
    }
}

static void save(const model *m, bf_buffer *out)
{
    checkpoint_writer w;

    checkpoint_begin(&w, out, CHECKPOINT_RUN, 0);
    world_save(m->world, &w);
    moving_field_save(m->plates, &w);
    assert_int_equal(macro_save(m->solver, out, NULL), BF_OK);
    assert_int_equal(checkpoint_end(&w, NULL), BF_OK);
}

static void load(const model *m, const bf_buffer *saved)
{
    checkpoint_reader r;

    assert_int_equal(checkpoint_open(&r, saved->bytes, saved->n, CHECKPOINT_RUN, 0, NULL), BF_OK);
    assert_true(world_load(m->world, &r) && moving_field_load(m->plates, m->solver, &r));
    assert_int_equal(macro_load(m->solver, r.at, r.n_left, NULL), BF_OK);
}

static void move_to(const model *m, double angle, double over)
{
    const scene_action turn = {
        .type = SCENE_ACTION_TURN, .target = 0, .value = angle, .over = over
    };
    const scene_action shift = {
        .type = SCENE_ACTION_SHIFT, .target = 0, .shift = { 0.02, 0.03 }, .over = over
    };

    world_command(m->world, &turn, macro_time(m->solver));
    world_command(m->world, &shift, macro_time(m->solver));
}

// Up to a number of steps, of which the 151st begins with a command.
static void advance_to(const model *m, uint64_t n_steps)
{
    while (macro_steps(m->solver) < n_steps) {
        if (macro_steps(m->solver) == 150)
            move_to(m, -0.2, 0.3);
        advance(m, 1);
    }
}

// In a swing, at rest, and in a turn with a shift that were commanded at 0.3 s.
static void a_run_resumed_in_a_swing_goes_on_with_the_same_bits(void **state)
{
    static const uint64_t stops[] = { 60, 140, 200 };

    for (int k = 0; k < KINDS; k++) {
        scene s;
        make_diverter(&s, k);
        model whole = start(&s, 1);
        fill(&whole, 0.1, 0.7, 0.7);
        for (size_t n = 0; n < sizeof stops / sizeof *stops; n++) {
            model then = start(&s, 2);
            bf_buffer saved = { 0 };
            advance_to(&whole, stops[n]);
            save(&whole, &saved);
            load(&then, &saved);
            advance_to(&whole, stops[n] + 50);
            advance_to(&then, stops[n] + 50);
            assert_true(macro_digest(then.solver) == macro_digest(whole.solver));
            stop(&then);
            buffer_fini(&saved);
        }
        stop(&whole);
        scene_fini(&s);
    }
}

// A box with a plate at rest through centres of cells, where a line that moved by its tolerance would close other faces. The belt
// runs backwards from 0.2 s on and stands from 0.4 s on.
static void make_reversing_box(scene *s, int kind)
{
    make_box(s, kind, 0.5, series(0, NULL, NULL));
    s->obstacles[0].path[0].x = s->obstacles[0].path[1].x = 0.405;
    s->obstacles[0].path[1].y = 0.2;
    helper_scene_schedule(&s->belts[0], 2, (double[]){ 0.2, 0.4 }, (double[]){ -1.0, 0.0 });
}

static void the_field_is_that_of_the_belts_direction_with_the_same_closed_faces(void **state)
{
    for (int k = 0; k < KINDS; k++) {
        scene s, other;
        make_reversing_box(&s, k);
        make_reversing_box(&other, k);
        other.belts[0].velocity.x = -0.5;
        velocity_field *back = helper_macro_field(&other);
        model m = start(&s, 1);
        const velocity_field *f = moving_field_now(m.plates);
        const size_t n1 = (m.grid.n1 + 1) * m.grid.n2;
        uint8_t *closed = memory_alloc(n1, sizeof *closed);
        memcpy(closed, f->faces[0].closed, n1);
        advance(&m, 50);
        assert_true(f->faces[0].v[1] == 0.5 && moving_field_belts(m.plates)[0].velocity.x == 0.5);
        advance(&m, 101);
        assert_true(moving_field_belts(m.plates)[0].velocity.x == -0.5);
        assert_memory_equal(f->faces[0].closed, closed, n1);
        for (size_t face = 0; face < n1; face++)
            assert_true(f->faces[0].v[face] == back->faces[0].v[face]);
        memory_free(closed);
        velocity_field_destroy(back);
        stop(&m);
        scene_fini(&s);
        scene_fini(&other);
    }
}

// One that stands keeps its direction.
static void directions_of_belts_come_back_from_a_checkpoint(void **state)
{
    bf_buffer saved = { 0 };
    scene s;

    make_reversing_box(&s, 2);
    model m = start(&s, 1), then = start(&s, 1);
    advance(&m, 250);
    save(&m, &saved);
    load(&then, &saved);
    assert_true(macro_belt_factor(m.solver, 0) == 0.0);
    assert_true(moving_field_belts(then.plates)[0].velocity.x == -0.5);
    assert_true(moving_field_now(then.plates)->faces[0].v[1] == -0.5);
    buffer_fini(&saved);
    stop(&m);
    stop(&then);
    scene_fini(&s);
}

static void damaged_places_are_refused(void **state)
{
    scene s;
    bf_buffer saved = { 0 };
    checkpoint_reader r;

    make_diverter(&s, 0);
    model m = start(&s, 1);
    save(&m, &saved);
    assert_int_equal(checkpoint_open(&r, saved.bytes, saved.n, CHECKPOINT_RUN, 0, NULL), BF_OK);
    for (size_t n = 0; n < 4; n++) {
        double places[4] = { n == 0 ? NAN : 0.0, n == 1 ? NAN : 0.0, n == 2 ? INFINITY : 0.0,
                             n == 3 ? 0.5 : 1.0 };
        checkpoint_reader damaged = { (const char *)places, sizeof places };
        assert_false(moving_field_load(m.plates, m.solver, &damaged));
    }
    assert_true(world_load(m.world, &r));
    for (size_t n = 0; n < 4 * sizeof(double); n++) {
        checkpoint_reader cut = { r.at, n };
        assert_false(moving_field_load(m.plates, m.solver, &cut));
    }
    buffer_fini(&saved);
    stop(&m);
    scene_fini(&s);
}

// 0.3 m in 0.2 s for 45 degrees, with the thickness: the step in which the tip moves by a cell.
static void an_obstacle_turns_by_a_cell_in_a_step_at_most(void **state)
{
    scene s;

    make_diverter(&s, 0);
    const double radius = 0.2 * sqrt(2.0) + 0.005;
    assert_near(scene_step_turning(&s), 0.01 / (radius * 45.0 * degree / 0.1), 1e-12);
    s.macro.step = 0.0;
    s.output.curve_every = 0.1;
    s.macro.dispersion = 0.0;
    s.belts[0].velocity.x = 0.01;
    assert_near(scene_macro_step(&s), 0.1 / ceil(0.1 / scene_step_turning(&s)), 1e-12);
    s.obstacles[0].turn.n_times = s.obstacles[0].turn.n_values = 0;
    assert_true(scene_step_turning(&s) == INFINITY);
    scene_fini(&s);
}

static void out_of_memory_anywhere_is_an_error_and_nothing_leaks(void **state)
{
    scene s;
    bf_status status = BF_ENOMEM;

    make_diverter(&s, 2);
    bf_world *w = world_of(&s);
    for (size_t n = 1; status != BF_OK; n++) {
        moving_field *plates = NULL;
        memory_plan_fault(n, 0);
        status = moving_field_create(&s, w, &plates, NULL);
        memory_plan_fault(0, 0);
        assert_true(status == BF_OK ? plates != NULL : status == BF_ENOMEM && plates == NULL);
        moving_field_destroy(plates);
    }
    world_fini(w);
    memory_free(w);
    scene_fini(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_passes_a_plate_that_sweeps_through_a_heap),
        cmocka_unit_test(a_plate_moves_what_it_sweeps_and_nothing_else),
        cmocka_unit_test(a_plate_that_is_shifted_moves_what_it_sweeps),
        cmocka_unit_test(what_a_shifted_plate_pushes_over_an_open_side_leaves),
        cmocka_unit_test(where_there_is_no_room_the_plate_stalls),
        cmocka_unit_test(mass_is_conserved_through_ten_swings),
        cmocka_unit_test(a_gap_that_closes_is_emptied_at_its_open_end),
        cmocka_unit_test(a_gate_holds_cargo_as_long_as_it_is_there),
        cmocka_unit_test(a_plate_that_came_to_rest_has_the_field_of_one_that_stands_there),
        cmocka_unit_test(a_plate_that_has_been_turned_into_the_belts_direction_holds_nothing_back),
        cmocka_unit_test(any_number_of_threads_gives_the_same_bits),
        cmocka_unit_test(a_run_resumed_in_a_swing_goes_on_with_the_same_bits),
        cmocka_unit_test(the_field_is_that_of_the_belts_direction_with_the_same_closed_faces),
        cmocka_unit_test(directions_of_belts_come_back_from_a_checkpoint),
        cmocka_unit_test(damaged_places_are_refused),
        cmocka_unit_test(an_obstacle_turns_by_a_cell_in_a_step_at_most),
        cmocka_unit_test(out_of_memory_anywhere_is_an_error_and_nothing_leaks),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
