// The macroscopic model on belts that rise or fall.

#include "core/base/memory.h"
#include "core/macro/congested/congested_priv.h"
#include "core/macro/congested/half_rows.h"
#include "core/macro/macro.h"
#include "tests/unit/core/helper_macro.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>

#define SPEED    0.4
#define FRICTION 0.3
#define DEGREES  (M_PI / 180.0)
#define LENGTH   2.0
#define WIDTH    0.2
#define JAM      0.93

// A solver of a scene with its field. Do not move it once it was made.
typedef struct world {
    scene s;
    velocity_field *f;
    macro_solver *solver;
} world;

// Belts in equal parts of the length, each with its incline, against a wall.
static void make_scene(scene *s, size_t n, const double *inclines)
{
    helper_scene_belt(s, LENGTH, WIDTH, 0.02, (scene_pose[]){ { 0.1, 0.1, 0.0 } }, 1);
    s->macro.closure = SCENE_CONGESTED;
    s->edges[SCENE_EAST] = SCENE_EDGE_WALL;
    for (size_t k = 0; k < n; k++) {
        const double from = LENGTH * (double)k / (double)n,
                     to = LENGTH * (double)(k + 1) / (double)n;
        const vec2 corners[] = { { from, 0.0 }, { to, 0.0 }, { to, WIDTH }, { from, WIDTH } };
        scene_belt *belt = helper_scene_add_belt(s, (vec2){ SPEED, 0.0 }, corners, 4);
        belt->friction = FRICTION;
        belt->incline = inclines[k];
    }
}

static void start(world *w, double density, int n_threads)
{
    helper_scene_resolve(&w->s);
    w->f = helper_macro_field(&w->s);
    macro_def def = helper_macro_def(&w->s, w->f);
    def.n_threads = n_threads;
    double *rho = memory_alloc(grid_cells(&def.grid), sizeof *rho);
    for (size_t k = 0; k < grid_cells(&def.grid); k++)
        rho[k] = density;
    w->solver = helper_macro_start_with(&def, rho);
    memory_free(rho);
}

static void finish(world *w)
{
    macro_destroy(w->solver);
    velocity_field_destroy(w->f);
    scene_fini(&w->s);
}

// From where its back crosses a density halfway between what arrives and a jam, in the middle row, to the wall.
static double jammed(const world *w)
{
    const bf_grid *g = &w->f->grid;
    const double *rho = macro_row(w->solver, g->n2 / 2), halfway = 0.5 * (0.5 + JAM);
    size_t i = g->n1 - 1;

    while (i > 0 && rho[i - 1] > halfway)
        i--;
    const double beyond = i > 0 ? (rho[i] - halfway) / (rho[i] - rho[i - 1]) : 0.0;
    return LENGTH - grid_x1(g, i) + beyond * g->d1;
}

// A queue grows by what arrives, whatever drives it: v rho/(rho_j - rho). It reaches over all slopes.
static void a_queue_grows_over_slopes_as_on_a_level_belt(void **state)
{
    static const double inclines[][3] = {
        { 10.0, 10.0, 10.0 }, { -10.0, -10.0, -10.0 }, { 0.0, 14.0, 0.0 }, { 14.0, -14.0, 5.0 }
    };

    for (size_t n = 0; n < sizeof inclines / sizeof *inclines; n++) {
        double angles[3];
        world w;
        for (int k = 0; k < 3; k++)
            angles[k] = inclines[n][k] * DEGREES;
        make_scene(&w.s, 3, angles);
        start(&w, 0.5, 1);
        const double dt = scene_macro_step(&w.s), mass = macro_measure(w.solver).mass;
        helper_macro_advance(w.solver, (int)lround(0.5 / dt));
        const double before = jammed(&w), t = macro_time(w.solver);
        helper_macro_advance(w.solver, (int)lround(1.5 / dt));
        const double growth = (jammed(&w) - before) / (macro_time(w.solver) - t);
        assert_near(growth / (SPEED * 0.5 / (JAM - 0.5)), 1.0, 0.02);
        assert_true(macro_measure(w.solver).peak < 1.02 * JAM);
        assert_near(macro_measure(w.solver).mass, mass, 1e-12);
        finish(&w);
    }
}

// Cell by cell the pressure of a queue that stands rises by what drives it, rho_j v_T (cos(alpha) - sin(alpha)/mu).
static void a_queue_presses_less_uphill_and_more_downhill(void **state)
{
    static const double inclines[] = { 0.0, 10.0, -10.0 };

    for (size_t n = 0; n < sizeof inclines / sizeof *inclines; n++) {
        const double alpha = inclines[n] * DEGREES;
        enum { FROM = 70, TO = 96, ROW = 4 };
        world w;
        make_scene(&w.s, 1, &alpha);
        start(&w, 0.9, 1);
        helper_macro_advance(w.solver, (int)lround(4.0 / scene_macro_step(&w.s)));
        const congested *c = w.solver->congested;
        const float *even = congested__row(c, c->pressure[ROW & 1], ROW);
        const double rise = (even[TO / 2] - even[FROM / 2]) / (TO - FROM);
        assert_near(rise / (JAM * SPEED * (cos(alpha) - sin(alpha) / FRICTION)), 1.0, 0.05);
        finish(&w);
    }
}

// What rests on a plate of the angle theta slips on the belt by w. Friction, against w, bears the pull along the plate:
// mu cos(alpha) (w along the plate)/|w| = sin(alpha) cos(theta).
static void along_a_plate_friction_bears_the_pull(void **state)
{
    static const double inclines[] = { 0.0, 5.0, 12.0, -5.0, -12.0 };
    const double theta = 60.0 * DEGREES;
    const vec2 along = { cos(theta), sin(theta) };

    for (size_t n = 0; n < sizeof inclines / sizeof *inclines; n++) {
        const double alpha = inclines[n] * DEGREES;
        const vec2 path[] = { { 1.0, 0.0 }, { 1.0 + 0.15 * along.x, 0.15 * along.y } };
        scene s;
        make_scene(&s, 1, &alpha);
        (void)helper_scene_add_obstacle(&s, path, 2, SCENE_SEALED);
        helper_scene_resolve(&s);
        const vec2 at = { path[0].x + 0.07 * along.x - 0.005 * along.y,
                          0.07 * along.y + 0.005 * along.x };
        const vec2 v = helper_macro_velocity_at(&s, at);
        const vec2 slip = vec2_sub((vec2){ SPEED, 0.0 }, v);
        assert_near(vec2_cross(along, v), 0.0, 1e-12);
        assert_near(FRICTION * cos(alpha) * vec2_dot(slip, along) / vec2_length(slip),
                    sin(alpha) * cos(theta), 1e-12);
        scene_fini(&s);
    }
}

// What leaves through an outlet beside a plate across a full belt in 1 s, m2.
static double passed(double incline, int n_threads, uint64_t *ret_digest)
{
    const vec2 path[] = { { 1.5, 0.0 }, { 1.5, 0.1 } };
    world w;

    make_scene(&w.s, 1, &incline);
    w.s.edges[SCENE_EAST] = SCENE_EDGE_OUTFLOW;
    (void)helper_scene_add_obstacle(&w.s, path, 2, SCENE_SEALED);
    start(&w, 0.9, n_threads);
    const double mass = macro_measure(w.solver).mass;
    helper_macro_advance(w.solver, (int)lround(1.0 / scene_macro_step(&w.s)));
    const double left = mass - macro_measure(w.solver).mass;
    if (ret_digest != NULL)
        *ret_digest = macro_digest(w.solver);
    finish(&w);
    return left;
}

// Level belts have loops of their own.
static void the_steeper_a_belt_rises_the_less_an_outlet_passes(void **state)
{
    static const double inclines[] = { -14.0, -7.0, 7.0, 14.0 };
    const double level = passed(0.0, 1, NULL);
    double before = INFINITY;

    for (int k = 0; k < 4; k++) {
        const double now = passed(inclines[k] * DEGREES, 1, NULL);
        assert_true(now < before && (inclines[k] < 0.0) == (now > level));
        before = now;
    }
    assert_near(passed(1e-9, 1, NULL) / level, 1.0, 0.005);
}

static void threads_change_no_bit_on_slopes(void **state)
{
    uint64_t digests[2];

    (void)passed(10.0 * DEGREES, 1, &digests[0]);
    (void)passed(10.0 * DEGREES, 3, &digests[1]);
    assert_true(digests[0] == digests[1]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_queue_grows_over_slopes_as_on_a_level_belt),
        cmocka_unit_test(a_queue_presses_less_uphill_and_more_downhill),
        cmocka_unit_test(along_a_plate_friction_bears_the_pull),
        cmocka_unit_test(the_steeper_a_belt_rises_the_less_an_outlet_passes),
        cmocka_unit_test(threads_change_no_bit_on_slopes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
