// Unit tests of microscopic runs: what they report, and what is refused before they begin.

#include "core/base/memory.h"
#include "core/run/run.h"
#include "core/scene/placement.h"
#include "tests/unit/core/helper_run.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <stdlib.h>
#include <string.h>

// A short jam: Example 1's obstacle, and 20 parts that reach it soon. The row at y = 0.15 m begins
// 0.02 m from the plate.
static void make_jam(scene *s)
{
    helper_scene_example(s, 60.0, SCENE_SEALED);
    s->initial.n_rows = 4;
    s->initial.n_columns = 5;
    s->initial.first = (vec2){ 0.40, 0.15 };
    s->duration = 0.3;
    s->macro.cell = 0.01;
    s->macro.step = 0.0025;
    s->micro.step = 2e-5;
}

static helper_run_log *new_log(void)
{
    helper_run_log *log = calloc(1, sizeof *log);

    assert_non_null(log);
    log->model = RUN_MICRO;
    return log;
}

static helper_run_log *run_scene(const scene *s, int n_threads)
{
    helper_run_log *log = new_log();

    assert_int_equal(helper_run(s, n_threads, 0, log), BF_OK);
    return log;
}

// Three parts on a free belt of 0.395 m/s, 1 m long: at t = 1 s the one that began at 0.7 m has left
// at x = 1.095 m, and so has no row any more; the others are 0.395 m further.
static void parts_ride_the_free_belt_and_leave_it(void **state)
{
    static const scene_pose poses[] = { { 0.1, 0.3, 0.25 }, { 0.7, 0.3, 0.0 }, { 0.2, 0.1, 0.0 } };
    scene s;
    helper_scene_belt(&s, 1.0, 0.6, 0.01, poses, 3);
    s.micro.step = 2e-5;
    s.micro.damping = 0.0; // it would hold them back against the belt, by 0.4 mm/s
    s.n_counters = 1;
    s.counters = memory_alloc(1, sizeof *s.counters);
    scene_counter_init(s.counters);
    s.counters->rect.x_max = 0.5;
    helper_scene_resolve(&s);
    helper_run_log *log = run_scene(&s, 1);
    const double *first = log->parts, *second = log->parts + FRAME_VALUES_PLANAR;
    assert_int_equal(log->begin.n_values, FRAME_VALUES_PLANAR);
    assert_int_equal(log->begin.n_parts, 3);
    assert_int_equal(log->n_frames[FRAME_PARTS], log->n_snapshots);
    assert_near(first[0], 0.1 + 0.395, 1e-9);
    assert_near(first[1], 0.3, 1e-12);
    assert_near(first[2], 0.25, 1e-12);
    assert_near(first[3], 0.395, 1e-9);
    for (int v = 0; v < FRAME_VALUES_PLANAR; v++)
        assert_true(isnan(second[v]));
    assert_int_equal(log->n_present, 2);
    assert_int_equal(log->end.n_parts_left, 1);
    // x_0 + 0.395 t < 0.5 m until t = 0.759 s for the third, 1.01 s for the first.
    assert_true(helper_run_at(log, 0.0)[0] == 2.0 && helper_run_at(log, 0.0)[1] == 0.0);
    assert_true(helper_run_at(log, 0.75)[0] == 2.0 && helper_run_at(log, 0.75)[1] == 0.0);
    assert_true(helper_run_at(log, 0.77)[0] == 1.0 && helper_run_at(log, 0.77)[1] == 1.0);
    helper_run_free(log);
    scene_fini(&s);
}

// The density (18) holds all parts where none is near an edge: its peak is that of the grid, its
// sum times the cell and rho_max their number.
static void the_density_is_that_of_the_parts(void **state)
{
    static const scene_pose poses[] = { { 0.3, 0.3, 0.0 }, { 0.4, 0.3, 0.0 } };
    scene s;
    helper_scene_belt(&s, 1.0, 0.6, 0.01, poses, 2);
    s.duration = 0.2;
    s.micro.step = 2e-5;
    helper_scene_resolve(&s);
    helper_run_log *log = run_scene(&s, 1);
    // sigma_0/(2 pi rho_max) at a part's own place, the other being five deviations away.
    double peak = 2500.0 / (2.0 * M_PI * 2004.0);
    assert_true(log->end.peak <= peak * (1.0 + 2.0 * exp(-12.5)));
    assert_true(log->end.peak > 0.9 * peak);
    assert_near(log->end.parts_end, 2.0, 0.0);
    assert_int_equal(log->end.n_cells, 6000);
    helper_run_free(log);
    scene_fini(&s);
}

static void a_jam_reports_its_overlaps_contacts_and_energy(void **state)
{
    scene s;
    make_jam(&s);
    helper_run_log *log = run_scene(&s, 1);
    assert_true(log->end.n_contacts > 0);
    assert_true(log->end.largest_overlap > 0.0 && log->end.largest_overlap < 0.012);
    assert_near(log->end.overlap_share, log->end.largest_overlap / 0.012, 1e-12);
    // 20 parts of 28.41 g, none much faster than the belt.
    assert_true(log->end.kinetic_energy > 0.0);
    assert_true(log->end.kinetic_energy < 1.5 * 20.0 * 0.5 * 0.02841 * 0.395 * 0.395);
    assert_true(log->values[log->n_samples - 1][0] == 20.0);
    helper_run_free(log);
    scene_fini(&s);
}

static void threads_and_reports_change_no_result(void **state)
{
    scene s;
    make_jam(&s);
    helper_run_log *one = run_scene(&s, 1), *two = run_scene(&s, 2), *reporting = new_log();
    reporting->report_every = 3;
    assert_int_equal(helper_run(&s, 1, 0, reporting), BF_OK);
    assert_true(helper_run_is_same(one, two));
    assert_true(helper_run_is_same(one, reporting));
    helper_run_free(one);
    helper_run_free(two);
    helper_run_free(reporting);
    scene_fini(&s);
}

static void a_run_stopped_anywhere_resumes_to_the_same_results(void **state)
{
    static const uint64_t stops[] = { 1, 2, 3, 11, 30 };
    scene s;
    make_jam(&s);
    helper_run_log *whole = run_scene(&s, 1);
    for (size_t k = 0; k < sizeof stops / sizeof *stops; k++) {
        helper_run_log *log = new_log();
        log->stop_at = stops[k];
        assert_int_equal(helper_run(&s, 1, 0, log), BF_OK);
        assert_int_equal(log->end.stopped, 1);
        log->stop_at = 0;
        assert_int_equal(helper_run(&s, 2, 1, log), BF_OK);
        assert_true(helper_run_is_same(whole, log));
        helper_run_free(log);
    }
    helper_run_free(whole);
    scene_fini(&s);
}

static void a_checkpoint_of_the_other_model_is_refused(void **state)
{
    scene s;
    make_jam(&s);
    helper_run_log *log = new_log();
    log->stop_at = 5;
    assert_int_equal(helper_run(&s, 1, 0, log), BF_OK);
    log->model = RUN_MACRO;
    assert_int_equal(helper_run(&s, 1, 1, log), BF_ECORRUPT);
    helper_run_free(log);
    scene_fini(&s);
}

// A request waits for no more than the work of some ten milliseconds, however far the next sample is.
static void requests_are_asked_for_between_samples(void **state)
{
    scene s;
    helper_scene_example(&s, 90.0, SCENE_SEALED);
    s.duration = s.output.curve_every = s.output.snapshot_every = 0.1;
    s.micro.integrator = SCENE_VERLET;
    s.micro.step = 1e-5;
    helper_run_log *log = run_scene(&s, 1);
    // 10,000 steps of 192 parts, at most 200,000/193 + 1 at once.
    assert_true(log->n_askings >= 10000 / 1037);
    helper_run_free(log);
    scene_fini(&s);
}

// The integrator's own step is cut so that samples come at their times, the same as those of the
// other model.
static void an_automatic_step_fits_the_samples(void **state)
{
    for (scene_integrator integrator = 0; integrator < SCENE_INTEGRATOR_COUNT; integrator++) {
        scene s;
        make_jam(&s);
        s.duration = 0.05;
        s.micro.step = 0.0;
        s.micro.integrator = integrator;
        helper_run_log *log = run_scene(&s, 1);
        double steps = 0.01 / log->begin.dt;
        assert_near(steps, round(steps), 1e-9 * steps);
        for (int k = 0; k <= 5; k++)
            assert_near(log->t[k], 0.01 * k, 1e-12);
        assert_true(integrator != SCENE_VERLET || log->begin.dt <= 1e-5);
        helper_run_free(log);
        scene_fini(&s);
    }
}

// Boxes and cylinders: the path is spatial, and every part has its row.
static void check_mix(scene_integrator integrator)
{
    static const scene_pose poses[] = { { 0.2, 0.2, 0.0 }, { 0.3, 0.3, 0.5 }, { 0.4, 0.2, 0.0 } };
    scene s;
    helper_scene_belt(&s, 1.0, 0.6, 0.01, poses, 3);
    s.duration = 0.05;
    s.micro.integrator = integrator;
    s.micro.modulus_reduction = 1e4;
    s.n_cargo = 2;
    scene_cargo_init(&s.cargo[1]);
    s.cargo[1].shape.type = SCENE_BOX;
    s.cargo[1].shape.length = 0.04;
    s.cargo[1].shape.width = 0.02;
    s.cargo[1].shape.height = 0.01;
    helper_scene_resolve(&s);
    helper_run_log *log = run_scene(&s, 1);
    assert_int_equal(log->begin.n_values, FRAME_VALUES_SPATIAL);
    assert_int_equal(log->n_present, 3);
    for (int k = 0; k < 3; k++) {
        const double *row = log->parts + k * FRAME_VALUES_SPATIAL;
        double norm = row[3] * row[3] + row[4] * row[4] + row[5] * row[5] + row[6] * row[6];
        assert_near(row[0], poses[k].x + 0.395 * 0.05, 1e-4);
        assert_near(norm, 1.0, 1e-9);
        assert_near(row[7], 0.395, 1e-2);
    }
    assert_true(integrator == SCENE_VERLET || log->begin.dt >= 2e-4);
    helper_run_free(log);
    scene_fini(&s);
}

static void a_mix_of_shapes_moves_in_space(void **state)
{
    check_mix(SCENE_VERLET);
    check_mix(SCENE_IMPLICIT);
}

// What run_check() says first; the scene must have no other faults.
static void assert_refused(scene *s, bf_status code, const char *pointer, const char *text)
{
    bf_faults general = { 0 }, faults = { 0 }, macro = { 0 };
    bf_error err = { 0 };
    run *r = NULL;

    scene_check(s, &general);
    assert_int_equal(general.n, 0);
    run_check(s, RUN_MACRO, &macro);
    assert_int_equal(macro.n, 0);
    run_check(s, RUN_MICRO, &faults);
    assert_int_equal(faults_status(&faults, &err), code);
    assert_string_equal(err.pointer, pointer);
    if (strstr(err.text, text) == NULL)
        fail_msg("%s", err.text);
    assert_int_equal(run_create(s, RUN_MICRO, 1, &r, &err), code);
    assert_string_equal(err.pointer, pointer);
    assert_null(r);
    scene_fini(s);
}

static void steps_that_are_unstable_or_too_many_are_refused(void **state)
{
    scene s;
    make_jam(&s);
    s.micro.step = 0.5;
    assert_refused(&s, BF_EINPUT, "/micro/step_s", "the largest stable one is");
    make_jam(&s);
    s.micro.step = 1e-10; // 3e9 steps
    assert_refused(&s, BF_ELIMIT, "/micro/step_s", "steps of the microscopic model");
    make_jam(&s);
    s.duration = 5e-6;
    s.macro.step = 0.0;
    assert_refused(&s, BF_EINPUT, "/duration_s", "less than one step");
}

// The step that the text names is accepted, one a little longer is not.
static void the_step_that_is_named_is_stable(void **state)
{
    bf_faults faults = { 0 };
    bf_error err = { 0 };
    scene s;
    make_jam(&s);
    s.micro.step = 0.5;
    run_check(&s, RUN_MICRO, &faults);
    assert_int_equal(faults_status(&faults, &err), BF_EINPUT);
    double stable = strtod(strstr(err.text, "one is ") + strlen("one is "), NULL);
    assert_true(stable > 0.0 && stable < 0.5);
    s.micro.step = stable * (1.0 - 1e-9);
    faults.n = 0;
    run_check(&s, RUN_MICRO, &faults);
    assert_int_equal(faults.n, 0);
    s.micro.step = stable * (1.0 + 1e-6);
    run_check(&s, RUN_MICRO, &faults);
    assert_int_equal(faults.n, 1);
    scene_fini(&s);
}

// The implicit integrator's own step is shorter for more parts; the count that is checked is that of the
// run: one part makes at most 10^9 steps in the time, 192 parts more.
static void steps_of_the_implicit_integrator_are_counted_for_all_parts(void **state)
{
    for (int is_one = 0; is_one < 2; is_one++) {
        bf_faults faults = { 0 };
        bf_error err = { 0 };
        scene s;
        helper_scene_example(&s, 60.0, SCENE_SEALED);
        if (is_one)
            s.initial.n_rows = s.initial.n_columns = 1;
        s.micro.integrator = SCENE_IMPLICIT;
        s.micro.modulus_reduction = 1.0;
        s.micro.step = 0.0;
        s.duration = 3e5;
        s.output.curve_every = s.output.snapshot_every = 3e4;
        run_check(&s, RUN_MICRO, &faults);
        assert_int_equal(faults.n, is_one ? 0 : 1);
        if (!is_one) {
            assert_int_equal(faults_status(&faults, &err), BF_ELIMIT);
            assert_string_equal(err.pointer, "/duration_s");
        }
        scene_fini(&s);
    }
}

// 20,000 snapshots of 10,000 parts of 6 doubles are 9.6 GB; of 100,000 parts whose Gaussians reach
// over all 10,000 cells 2e13 values.
static void results_that_are_too_large_are_refused(void **state)
{
    scene s;
    helper_scene_belt(&s, 100.0, 100.0, 1.0, NULL, 0);
    s.initial.type = SCENE_INITIAL_HEXAGONAL;
    s.initial.n_rows = s.initial.n_columns = 100;
    s.initial.first = (vec2){ 1.0, 1.0 };
    s.initial.spacing = 0.1;
    s.duration = 1.9;
    s.output.snapshot_every = 1e-4;
    s.output.curve_every = 0.1;
    helper_scene_resolve(&s);
    assert_refused(&s, BF_ELIMIT, "/output/snapshot_every_s", "bytes of parts");
    helper_scene_belt(&s, 100.0, 100.0, 1.0, NULL, 0);
    s.initial.type = SCENE_INITIAL_HEXAGONAL;
    s.initial.n_rows = 100;
    s.initial.n_columns = 900;
    s.initial.first = (vec2){ 1.0, 1.0 };
    s.initial.spacing = 0.1;
    s.duration = 1.2;
    s.macro.initial_mollifier = 1e-6;
    s.output.snapshot_every = 1e-4;
    s.output.curve_every = 0.1;
    helper_scene_resolve(&s);
    bf_faults faults = { 0 };
    run_check(&s, RUN_MICRO, &faults);
    assert_int_equal(faults.n, 2); // 52 GB of parts too
    assert_non_null(strstr(faults.items[1].text, "values to sum up"));
    scene_fini(&s);
}

// A plate 0.02 m thick whose upstream face is x = 0.5 m: a disk of 0.012 m may be as near as that to
// either side, and a box of 0.04 m as near as 0.02 m.
static void parts_inside_a_plate_are_refused(void **state)
{
    static const vec2 face[] = { { 0.5, 0.1 }, { 0.5, 0.5 } };
    static const struct {
        scene_pose at;
        size_t n_disk, n_box;
    } cases[] = {
        { { 0.4879, 0.3, 0.0 }, 0, 1 }, { { 0.4881, 0.3, 0.0 }, 1, 1 },
        { { 0.51, 0.3, 0.0 }, 1, 1 },   { { 0.5319, 0.3, 0.0 }, 1, 1 },
        { { 0.5321, 0.3, 0.0 }, 0, 1 }, { { 0.541, 0.3, 0.0 }, 0, 0 },
        { { 0.479, 0.3, 0.0 }, 0, 0 },  { { 0.51, 0.513, 0.0 }, 0, 0 },
        { { 0.51, 0.509, 0.0 }, 1, 1 },
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        for (int is_box = 0; is_box < 2; is_box++) {
            bf_faults faults = { 0 };
            scene s;
            helper_scene_belt(&s, 1.0, 0.6, 0.01, &cases[k].at, 1);
            helper_scene_add_obstacle(&s, face, 2, SCENE_SEALED)->thickness = 0.02;
            if (is_box)
                s.cargo[0].shape = (scene_shape){
                    .type = SCENE_BOX, .length = 0.04, .width = 0.02, .height = 0.01
                };
            helper_scene_resolve(&s);
            run_check(&s, RUN_MICRO, &faults);
            assert_int_equal(faults.n, is_box ? cases[k].n_box : cases[k].n_disk);
            if (faults.n > 0)
                assert_string_equal(faults.items[0].pointer, "/initial/positions_m/0");
            scene_fini(&s);
        }
    }
}

// At 45 degrees and below the plate of the Examples would go through their packing: the last part of
// the first row is at (0.369, 0.11) m, and the plate's face on x - y = 0.25 m.
static void the_examples_may_begin_where_the_plate_is_steep(void **state)
{
    for (double angle = 30.0; angle <= 90.0; angle += 15.0) {
        bf_faults faults = { 0 };
        scene s;
        helper_scene_example(&s, angle, SCENE_SEALED);
        run_check(&s, RUN_MICRO, &faults);
        assert_int_equal(faults.n, angle < 50.0 ? 1 : 0);
        if (faults.n > 0)
            assert_string_equal(faults.items[0].pointer, "/initial/hexagonal");
        scene_fini(&s);
    }
}

static void out_of_memory_anywhere_is_an_error(void **state)
{
    bf_status status = BF_ENOMEM;
    run *r = NULL;
    scene s;
    make_jam(&s);
    for (size_t n = 1; status != BF_OK; n++) {
        memory_plan_fault(n, 0);
        status = run_create(&s, RUN_MICRO, 1, &r, NULL);
        memory_plan_fault(0, 0);
        assert_true(status == BF_OK ? r != NULL : status == BF_ENOMEM && r == NULL);
    }
    run_destroy(r);
    scene_fini(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(parts_ride_the_free_belt_and_leave_it),
        cmocka_unit_test(the_density_is_that_of_the_parts),
        cmocka_unit_test(a_jam_reports_its_overlaps_contacts_and_energy),
        cmocka_unit_test(threads_and_reports_change_no_result),
        cmocka_unit_test(a_run_stopped_anywhere_resumes_to_the_same_results),
        cmocka_unit_test(a_checkpoint_of_the_other_model_is_refused),
        cmocka_unit_test(requests_are_asked_for_between_samples),
        cmocka_unit_test(an_automatic_step_fits_the_samples),
        cmocka_unit_test(a_mix_of_shapes_moves_in_space),
        cmocka_unit_test(steps_that_are_unstable_or_too_many_are_refused),
        cmocka_unit_test(the_step_that_is_named_is_stable),
        cmocka_unit_test(steps_of_the_implicit_integrator_are_counted_for_all_parts),
        cmocka_unit_test(results_that_are_too_large_are_refused),
        cmocka_unit_test(parts_inside_a_plate_are_refused),
        cmocka_unit_test(the_examples_may_begin_where_the_plate_is_steep),
        cmocka_unit_test(out_of_memory_anywhere_is_an_error),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
