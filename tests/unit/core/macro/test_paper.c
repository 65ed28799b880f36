// Statements of the paper, and the reference answers of its Examples.

#include "core/macro/macro.h"
#include "core/macro/velocity_field.h"
#include "core/run/run.h"
#include "core/scene/density.h"
#include "tests/unit/core/helper_run.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_amount.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double n_parts = 192.0;

// Upstream parts U, parts in the domain M and peak density at t, as two independent implementations
// of the scheme gave them, one by direct sums, one by Fourier transform.
typedef struct answer {
    double angle_deg;
    scene_treatment treatment;
    double t, u, m, peak;
} answer;

static const answer answers[] = {
    { 60.0, SCENE_FIELD, 1.0, 187.780636, 191.999998, 1.320672 },
    { 60.0, SCENE_FIELD, 2.0, 73.853087, 141.003850, 1.234711 },
    { 60.0, SCENE_FIELD, 6.0, 3.847239, 8.721468, 1.059315 },
    { 60.0, SCENE_WALL, 1.0, 189.894407, 191.999998, 6.394561 },
    { 60.0, SCENE_WALL, 6.0, 2.373422, 6.968613, 2.258576 },
    { 60.0, SCENE_SEALED, 1.0, 191.926033, 191.999998, 1.433541 },
    { 60.0, SCENE_SEALED, 2.0, 141.906700, 178.825758, 1.351892 },
    { 60.0, SCENE_SEALED, 4.0, 50.534944, 73.201054, 1.161526 },
    { 60.0, SCENE_SEALED, 6.0, 11.747285, 19.792286, 1.064808 },
    { 90.0, SCENE_FIELD, 1.0, 177.460284, 191.999998, 1.320452 },
    { 90.0, SCENE_FIELD, 2.0, 57.758736, 141.633934, 5.224506 },
    { 90.0, SCENE_SEALED, 1.0, 191.999692, 191.999998, 1.411022 },
    { 90.0, SCENE_SEALED, 2.0, 167.140242, 188.198532, 1.423150 },
    { 90.0, SCENE_SEALED, 6.0, 113.598711, 118.386847, 1.293767 },
};

enum { N_ANSWERS = sizeof answers / sizeof *answers };

// An Example as the reference implementations had it: the 60 degrees begin at x = 0.461325 m, and
// the paper's own treatments have a thick band and a narrow slide zone.
static void make_example(scene *s, double angle_deg, scene_treatment treatment)
{
    helper_scene_example(s, angle_deg, treatment);
    scene_obstacle *o = &s->obstacles[0];
    o->path[0] = (vec2){ angle_deg == 60.0 ? 0.461325 : 0.75, 0.0 };
    o->path[1] = (vec2){ 0.75, 0.5 };
    o->slide_width = treatment == SCENE_SEALED ? 0.03 : 0.02;
    o->thickness = treatment == SCENE_FIELD ? 0.03 : 0.005;
}

static void check_answer(const answer *a, const helper_run_log *log)
{
    const double *sample = helper_run_at(log, a->t);

    assert_near(sample[0], a->u, 1e-6 * n_parts);
    assert_near(log->end.parts_start - sample[1], a->m, 1e-6 * n_parts);
    assert_near(log->peaks[lround(a->t / 0.1)], a->peak, 2e-6);
}

static void the_examples_give_the_reference_answers(void **state)
{
    for (int k = 0; k < HELPER_AMOUNT(N_ANSWERS, 3);) {
        const answer *first = &answers[k];
        helper_run_log *log = calloc(1, sizeof *log);
        scene s;
        make_example(&s, first->angle_deg, first->treatment);
        assert_int_equal(helper_run(&s, 1, 0, log), BF_OK);
        for (; k < N_ANSWERS && answers[k].angle_deg == first->angle_deg &&
               answers[k].treatment == first->treatment;
             k++)
            check_answer(&answers[k], log);
        scene_fini(&s);
        free(log);
    }
}

// U falls from 3 to 0 as the parts pass the counter's edge, so its integral is the sum of their travel
// times. Upwinding lets a cell's mass pass its face, not its centre: half a cell late; and a sample
// stands for the step that begins with it: half a step early.
static void on_a_free_belt_everything_moves_at_belt_speed(void **state)
{
    static const scene_pose poses[] = { { 0.2, 0.1, 0.0 }, { 0.3, 0.2, 0.0 }, { 0.25, 0.3, 0.0 } };
    helper_run_log *log = calloc(1, sizeof *log);
    double integral = 0.0, expected = 0.0;
    scene s;
    helper_scene_belt(&s, 1.2, 0.4, 0.005, poses, 3);
    s.duration = 2.5;
    helper_scene_resolve(&s);
    s.counters[0].rect.x_max = 0.75;
    assert_int_equal(helper_run(&s, 1, 0, log), BF_OK);
    for (size_t k = 0; k + 1 < log->n_samples; k++)
        integral += 0.5 * (log->values[k][0] + log->values[k + 1][0]) * (log->t[k + 1] - log->t[k]);
    for (int k = 0; k < 3; k++)
        expected += (0.75 - poses[k].x) / 0.395 + 0.5 * (0.005 / 0.395 - scene_macro_step(&s));
    assert_near(integral, expected, 1e-4);
    assert_near(log->values[log->n_samples - 1][0], 0.0, 1e-3);
    scene_fini(&s);
    free(log);
}

// Centre of mass of a solver's density.
static vec2 centre_of_mass(const macro_solver *solver, const bf_grid *g)
{
    double mass = 0.0, x = 0.0, y = 0.0;

    for (size_t j = 0; j < g->n2; j++)
        for (size_t i = 0; i < g->n1; i++) {
            double rho = macro_row(solver, j)[i];
            mass += rho;
            x += rho * grid_x1(g, i);
            y += rho * grid_x2(g, j);
        }
    return (vec2){ x / mass, y / mass };
}

// A loose part in a wide slide zone: it moves along the obstacle at v_T cos(theta), exactly, as long
// as its density has not spread beyond the zone.
static void a_part_slides_along_an_obstacle_at_belt_speed_times_cosine(void **state)
{
    static const double angles_deg[] = { 45.0, 60.0, 75.0, 90.0 };
    for (int k = 0; k < 4; k++) {
        const double angle = angles_deg[k] * M_PI / 180.0;
        const double speed = k == 3 ? 0.0 : 0.395 * cos(angle);
        // 0.15 m upstream of the middle of the obstacle.
        const scene_pose pose = { 0.6 - 0.15 * sin(angle), 0.3 + 0.15 * cos(angle), 0.0 };
        const vec2 path[] = { { 0.6 - 0.25 * cos(angle), 0.3 - 0.25 * sin(angle) },
                              { 0.6 + 0.25 * cos(angle), 0.3 + 0.25 * sin(angle) } };
        scene s;
        helper_scene_belt(&s, 1.0, 0.6, 0.005, &pose, 1);
        s.macro.initial_mollifier = 10000.0; // a spot of 1 cm with a peak below 1
        helper_scene_add_obstacle(&s, path, 2, SCENE_FIELD)->slide_width = 0.3;
        helper_scene_resolve(&s);

        velocity_field *f = NULL;
        macro_solver *solver = NULL;
        macro_def def = macro_def_default();
        assert_int_equal(velocity_field_create(&s, &f, NULL), BF_OK);
        double *rho = calloc(grid_cells(&f->grid), sizeof *rho);
        def.grid = f->grid;
        def.faces[0].v = f->faces[0].v;
        def.faces[1].v = f->faces[1].v;
        assert_int_equal(macro_create(&def, &solver, NULL), BF_OK);
        assert_int_equal(
            density_from_parts(&f->grid, scene_packing_density(&s), 10000.0, &pose, 1, rho, NULL),
            BF_OK);
        macro_set_density(solver, rho);
        vec2 before = centre_of_mass(solver, &f->grid);
        for (int step = 0; step < 6; step++)
            macro_step(solver);
        vec2 after = centre_of_mass(solver, &f->grid);
        double t = macro_time(solver);
        assert_near((after.x - before.x) / t, speed * cos(angle), 1e-9);
        assert_near((after.y - before.y) / t, speed * sin(angle), 1e-9);
        macro_destroy(solver);
        velocity_field_destroy(f);
        free(rho);
        scene_fini(&s);
    }
}

static double mass_behind(const float *rho, const bf_grid *g)
{
    double sum = 0.0;

    for (size_t j = 0; j < g->n2; j++)
        for (size_t i = 0; i < g->n1; i++)
            if (grid_x1(g, i) > 0.75)
                sum += rho[j * g->n1 + i];
    return sum;
}

static bf_status add_up_mass_behind(void *context, const frame *f, bf_error *err)
{
    static bf_grid grid;
    double *sum = context;

    if (f->type == FRAME_BEGIN)
        grid = f->begin.grid;
    if (f->type == FRAME_SNAPSHOT)
        *sum += mass_behind(f->snapshot.rho, &grid);
    return BF_OK;
}

// A barrier from wall to wall, straight and bent, beyond the last cell with cargo: behind it stays
// exactly nothing.
static void nothing_leaks_through_a_closed_barrier(void **state)
{
    static const vec2 bent[] = { { 0.6, 0.0 }, { 0.7, 0.21 }, { 0.74, 0.4 }, { 0.6, 0.6 } };
    static const vec2 straight[] = { { 0.6, 0.0 }, { 0.745, 0.6 } };
    for (int k = 0; k < 4; k++) {
        scene s;
        double behind = 0.0;
        const run_sink sink = { &behind, add_up_mass_behind, NULL };
        run *r = NULL;
        make_example(&s, 60.0, k % 2 == 0 ? SCENE_SEALED : SCENE_WALL);
        scene_obstacle *barrier = helper_scene_add_obstacle(&s, k < 2 ? bent : straight,
                                                            k < 2 ? 4 : 2, s.obstacles->treatment);
        barrier->band = 0.08;
        barrier->slide_width = 0.03;
        barrier->thickness = 0.005;
        s.duration = HELPER_AMOUNT(2.0, 0.8);
        assert_int_equal(run_create(&s, RUN_MACRO, 1, &r, NULL), BF_OK);
        assert_int_equal(run_execute(r, &sink, NULL), BF_OK);
        assert_true(behind == 0.0);
        run_destroy(r);
        scene_fini(&s);
    }
}

// Not all cargo passes a deflector across the belt: U levels off above 0 (the paper's Example 2).
static void a_deflector_across_the_belt_leaves_a_plateau(void **state)
{
    helper_run_log *log = calloc(1, sizeof *log);
    scene s;
    make_example(&s, 90.0, SCENE_SEALED);
    assert_int_equal(helper_run(&s, 2, 0, log), BF_OK);
    double early = helper_run_at(log, 1.5)[0] - helper_run_at(log, 2.5)[0];
    double late = helper_run_at(log, 5.0)[0] - helper_run_at(log, 6.0)[0];
    assert_true(helper_run_at(log, 6.0)[0] > 0.5 * n_parts);
    assert_true(late < 0.5 * early);
    scene_fini(&s);
    free(log);
}

// How often a density rises and falls again by a hundredth of its maximum along n cells.
static int count_lanes(const float *rho, size_t n, size_t stride)
{
    float highest = 0.0F, turn = rho[0];
    bool is_rising = false;
    int n_lanes = 0;

    for (size_t k = 0; k < n; k++)
        highest = fmaxf(highest, rho[k * stride]);
    for (size_t k = 0; k < n; k++) {
        float value = rho[k * stride];
        bool has_turned =
            is_rising ? value < turn - 0.01F * highest : value > turn + 0.01F * highest;
        n_lanes += has_turned && is_rising;
        if (has_turned)
            is_rising = !is_rising;
        if (has_turned || (is_rising ? value > turn : value < turn))
            turn = value;
    }
    return n_lanes;
}

// Lanes along and across the belt in the last snapshot but one.
typedef struct lane_count {
    bf_grid grid;
    int along, across;
} lane_count;

static bf_status count_in_snapshot(void *context, const frame *f, bf_error *err)
{
    lane_count *lanes = context;

    if (f->type == FRAME_BEGIN)
        lanes->grid = f->begin.grid;
    // At 0.1 s the middle of the cargo has moved to x = 0.28 m; its middle row is at y = 0.27 m.
    if (f->type == FRAME_SNAPSHOT && f->snapshot.index == 1) {
        lanes->along = count_lanes(f->snapshot.rho + 54 * lanes->grid.n1, lanes->grid.n1, 1);
        lanes->across = count_lanes(f->snapshot.rho + 56, lanes->grid.n2, lanes->grid.n1);
    }
    return BF_OK;
}

static lane_count lanes_of(scene_heaviside heaviside, double mollifier)
{
    lane_count lanes = { 0 };
    const run_sink sink = { &lanes, count_in_snapshot, NULL };
    run *r = NULL;
    scene s;

    helper_scene_example(&s, 60.0, SCENE_SEALED);
    s.duration = 0.11;
    s.macro.heaviside = heaviside;
    s.macro.mollifier = mollifier;
    s.n_obstacles = 0;
    assert_int_equal(run_create(&s, RUN_MACRO, 1, &r, NULL), BF_OK);
    assert_int_equal(run_execute(r, &sink, NULL), BF_OK);
    run_destroy(r);
    s.n_obstacles = 1;
    scene_fini(&s);
    return lanes;
}

// The paper's Example 3: without H dispersion acts on loose cargo too and draws it into lanes, the
// farther apart the wider the mollifier is; with H a loose block stays one block.
static void without_heaviside_loose_cargo_falls_into_lanes(void **state)
{
    lane_count narrow = lanes_of(SCENE_HEAVISIDE_NONE, 1e4);
    lane_count wide = lanes_of(SCENE_HEAVISIDE_NONE, 1e3);
    lane_count sharp = lanes_of(SCENE_HEAVISIDE_SHARP, 1e4);
    assert_true(wide.along >= 4 && wide.across >= 4);
    assert_true(narrow.along > wide.along && narrow.across > wide.across);
    assert_int_equal(sharp.along, 1);
    assert_int_equal(sharp.across, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_examples_give_the_reference_answers),
        cmocka_unit_test(on_a_free_belt_everything_moves_at_belt_speed),
        cmocka_unit_test(a_part_slides_along_an_obstacle_at_belt_speed_times_cosine),
        cmocka_unit_test(nothing_leaks_through_a_closed_barrier),
        cmocka_unit_test(a_deflector_across_the_belt_leaves_a_plateau),
        cmocka_unit_test(without_heaviside_loose_cargo_falls_into_lanes),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
