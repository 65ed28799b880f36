// Unit tests of the spatial path as a program: threads, saving and loading, memory, errors; and its
// upright cylinders against the planar path.

#include "core/base/buffer.h"
#include "core/base/memory.h"
#include "core/micro/part_index.h"
#include "tests/unit/core/helper_body.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_amount.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <string.h>

/// The jam with the steps of either integrator.
static void make_jam(helper_body *h, micro_integrator integrator)
{
    helper_body_jam(h);
    h->def.integrator = integrator;
    if (integrator == MICRO_IMPLICIT)
        h->def.dt = 1e-3;
}

static void check_threads(micro_integrator integrator)
{
    helper_body h;
    uint64_t digest[2];
    make_jam(&h, integrator);
    for (int k = 0; k < 2; k++) {
        h.def.n_threads = k + 1;
        body_state *s = helper_body_start(&h);
        helper_body_run(s, HELPER_AMOUNT(0.12, 0.08));
        assert_true(body__measure(s).n_contacts > 5);
        digest[k] = helper_body_digest(s);
        micro__body.destroy(s);
    }
    assert_true(digest[0] == digest[1]);
}

static void two_threads_give_the_same_bits_as_one(void **state)
{
    check_threads(MICRO_VERLET);
    check_threads(MICRO_IMPLICIT);
}

// 36 parts are three blocks; a single part is one, as none is.
static void threads_without_a_block_of_parts_are_not_used(void **state)
{
    helper_body h;
    driver_progress progress;
    helper_body_jam(&h);
    h.def.n_threads = 8;
    body_state *s = helper_body_start(&h);
    assert_int_equal(s->n, 36);
    assert_int_equal(body__begin(s, &progress), 3);
    micro__body.destroy(s);
    helper_body_init(&h, helper_body_cylinder(0.01, 0.01));
    for (h.def.n_parts = 0; h.def.n_parts < 2; h.def.n_parts++) {
        h.def.n_threads = 8;
        s = helper_body_start(&h);
        assert_int_equal(body__begin(s, &progress), 1);
        micro__body.destroy(s);
    }
}

static void parts_stay_on_their_side_and_on_the_belt(void **state)
{
    helper_body h;
    helper_body_jam(&h);
    body_state *s = helper_body_start(&h);
    helper_body_run(s, HELPER_AMOUNT(0.3, 0.1));
    assert_true(body__measure(s).largest_overlap < 1.5e-3);
    assert_near(body__measure(s).overlap_share, body__measure(s).largest_overlap / 0.008, 0.06);
    for (size_t k = 0; k < s->n; k++) {
        micro_part part = body__part(s, k);
        double beyond = part.x[0] - (0.215 + (part.x[1] + 0.05) * 0.04 / 0.13);
        assert_true(part.is_gone || part.x[1] > 0.07 || beyond < 0.0);
        assert_true(part.x[1] > -0.05 && part.x[1] < 0.1 && part.x[2] > 0.0 && part.x[2] < 0.03);
    }
    micro__body.destroy(s);
}

// The state as a checkpoint, and back.
static bf_status save_state(const body_state *s, bf_buffer *out, bf_error *err)
{
    checkpoint_writer w;

    checkpoint_begin(&w, out, CHECKPOINT_BODY, 0);
    body__save(s, &w);
    return checkpoint_end(&w, err);
}

static bf_status load_state(body_state *s, const char *bytes, size_t n, bf_error *err)
{
    checkpoint_reader r;

    bf_status status = checkpoint_open(&r, bytes, n, CHECKPOINT_BODY, 0, err);
    return status == BF_OK ? body__load(s, s->n, &r, err) : status;
}

// The list is built at other times after loading: results must not depend on them.
static void check_resume(micro_integrator integrator)
{
    helper_body h;
    bf_buffer saved = { 0 }, again = { 0 };
    make_jam(&h, integrator);
    body_state *whole = helper_body_start(&h), *second = helper_body_start(&h);
    helper_body_run(whole, 0.1);
    assert_int_equal(save_state(whole, &saved, NULL), BF_OK);
    // Steps and overlaps are saved by micro_save().
    second->common.steps = whole->common.steps;
    second->common.largest_overlap = whole->common.largest_overlap;
    assert_int_equal(load_state(second, saved.bytes, saved.n, NULL), BF_OK);
    assert_true(helper_body_digest(second) == helper_body_digest(whole));
    assert_int_equal(body__measure(second).n_contacts, body__measure(whole).n_contacts);
    assert_int_equal(save_state(second, &again, NULL), BF_OK);
    assert_int_equal(again.n, saved.n);
    assert_memory_equal(again.bytes, saved.bytes, saved.n);
    helper_body_run(whole, 0.05);
    helper_body_run(second, 0.02);
    helper_body_run(second, 0.03);
    assert_true(helper_body_digest(second) == helper_body_digest(whole));
    assert_true(body__measure(second).largest_overlap == body__measure(whole).largest_overlap);
    buffer_fini(&saved);
    buffer_fini(&again);
    micro__body.destroy(whole);
    micro__body.destroy(second);
}

static void a_loaded_state_goes_on_with_the_same_bits(void **state)
{
    check_resume(MICRO_VERLET);
    check_resume(MICRO_IMPLICIT);
}

// Once memory for the contacts of the jam is reserved, steps allocate none.
static void implicit_steps_allocate_nothing(void **state)
{
    helper_body h;
    bf_error err = { .code = BF_OK };
    make_jam(&h, MICRO_IMPLICIT);
    body_state *s = helper_body_start(&h);
    helper_body_run(s, 0.02);
    memory_plan_fault(1, 1);
    assert_int_equal(body__advance(s, 3, &err), BF_OK);
    assert_int_equal(memory_faults(), 0);
    memory_plan_fault(0, 0);
    micro__body.destroy(s);
}

static void check_damages(micro_integrator integrator)
{
    helper_body h;
    bf_buffer saved = { 0 };
    bf_error err = { .code = BF_OK };
    make_jam(&h, integrator);
    body_state *s = helper_body_start(&h);
    helper_body_run(s, 0.08);
    assert_int_equal(save_state(s, &saved, NULL), BF_OK);
    helper_body_run(s, 0.001);
    uint64_t before = helper_body_digest(s);
    for (size_t at = 0; at < saved.n; at += HELPER_AMOUNT(97, 389)) {
        saved.bytes[at] = (char)(saved.bytes[at] ^ 0x10);
        assert_int_equal(load_state(s, saved.bytes, saved.n, &err), BF_ECORRUPT);
        saved.bytes[at] = (char)(saved.bytes[at] ^ 0x10);
    }
    for (size_t n = 0; n < saved.n; n += HELPER_AMOUNT(211, 997))
        assert_int_equal(load_state(s, saved.bytes, n, &err), BF_ECORRUPT);
    assert_true(helper_body_digest(s) == before);
    h.def.n_parts = 35;
    body_state *other = helper_body_start(&h);
    assert_int_equal(load_state(other, saved.bytes, saved.n, NULL), BF_ECORRUPT);
    micro__body.destroy(other);
    buffer_fini(&saved);
    micro__body.destroy(s);
}

static void a_damaged_state_is_refused_and_changes_nothing(void **state)
{
    check_damages(MICRO_VERLET);
    check_damages(MICRO_IMPLICIT);
}

/// Create, step, save and load. Every failure is BF_ENOMEM.
static bf_status live(const helper_body *h)
{
    bf_buffer saved = { 0 };
    bf_error err = { .code = BF_OK };
    micro_common *state = NULL;

    bf_status status = micro__body.create(&h->def, &state, &err);
    body_state *s = (body_state *)state;
    assert_true((status == BF_OK) == (s != NULL));
    if (status == BF_OK)
        status = micro__body.advance(s, 20, &err);
    if (status == BF_OK)
        status = save_state(s, &saved, &err);
    if (status == BF_OK)
        status = load_state(s, saved.bytes, saved.n, &err);
    if (status == BF_OK)
        status = micro__body.advance(s, 20, &err);
    assert_true(status == BF_OK || (status == BF_ENOMEM && err.code == BF_ENOMEM));
    buffer_fini(&saved);
    micro__body.destroy(s);
    return status;
}

static void check_faults(micro_integrator integrator)
{
    helper_body h;
    bf_status status = BF_ENOMEM;
    size_t n = 0;
    make_jam(&h, integrator);
    while (status != BF_OK) {
        memory_plan_fault(++n, 0);
        status = live(&h);
        memory_plan_fault(0, 0);
    }
    assert_in_range(n, 20, 100);
}

static void every_allocation_may_fail(void **state)
{
    check_faults(MICRO_VERLET);
    check_faults(MICRO_IMPLICIT);
}

// A list that could not grow is built by the next call, and the state is unchanged.
static void check_retry(micro_integrator integrator)
{
    helper_body h;
    bf_error err = { .code = BF_OK };
    make_jam(&h, integrator);
    body_state *s = helper_body_start(&h), *calm = helper_body_start(&h);
    memory_plan_fault(1, 0);
    assert_int_equal(body__advance(s, 10, &err), BF_ENOMEM);
    memory_plan_fault(0, 0);
    assert_int_equal(s->common.steps, 0);
    assert_int_equal(body__advance(s, 10, &err), BF_OK);
    assert_int_equal(body__advance(calm, 10, &err), BF_OK);
    assert_true(helper_body_digest(s) == helper_body_digest(calm));
    micro__body.destroy(s);
    micro__body.destroy(calm);
}

static void a_step_without_memory_can_be_made_again(void **state)
{
    check_retry(MICRO_VERLET);
    check_retry(MICRO_IMPLICIT);
}

// Far beyond the stable step contacts are unstable.
static void a_part_that_flies_off_is_named_with_step_and_time(void **state)
{
    helper_body h;
    bf_error err = { .code = BF_OK };
    helper_body_init(&h, helper_body_box(0.02, 0.02, 0.02));
    h.def.n_parts = 2;
    h.poses[1].x = 0.019;
    h.def.dt = 5e-3;
    body_state *s = helper_body_start(&h);
    assert_int_equal(body__advance(s, 1000, &err), BF_ENUMERIC);
    assert_non_null(strstr(err.text, "part 0"));
    assert_non_null(strstr(err.text, "after step"));
    micro__body.destroy(s);
}

static void a_value_that_is_not_finite_is_named(void **state)
{
    helper_body h;
    bf_error err = { .code = BF_OK };
    helper_body_jam(&h);
    body_state *s = helper_body_start(&h);
    helper_body_run(s, 1e-3);
    s->bodies[20].w.y = NAN;
    assert_int_equal(body__advance(s, 5, &err), BF_ENUMERIC);
    assert_non_null(strstr(err.text, "part 20"));
    assert_non_null(strstr(err.text, "step 101"));
    micro__body.destroy(s);
}

static void what_cannot_be_made_is_refused(void **state)
{
    double flat[4][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 1, 1, 0 } };
    helper_body h;
    bf_error err = { .code = BF_OK };
    micro_common *s = NULL;
    helper_body_init(&h, (scene_shape){ .type = SCENE_HULL, .n_vertices = 4, .vertices = flat });
    assert_int_equal(micro__body.create(&h.def, &s, &err), BF_EINPUT);
    assert_null(s);
}

// m = 0.03 kg in a box of 2 cm: the dashpots allow some 1e-5 s; ten times the mass allows ten times
// the step. What is chosen is below the bound, and a jam at the bound stays together.
static void the_stable_step_follows_the_mass(void **state)
{
    helper_body h;
    helper_body_init(&h, helper_body_box(0.02, 0.02, 0.02));
    double light = micro__body.dt_stable(&h.def);
    assert_true(light > 1e-5 && light < 1e-4);
    assert_true(micro_dt_chosen(&h.def) < light);
    h.kinds[0].mass = 0.3;
    h.def.modulus_reduction = 1e9;
    assert_near(micro__body.dt_stable(&h.def), 10.0 * light, 0.5 * light);
    helper_body_jam(&h);
    h.def.dt = micro__body.dt_stable(&h.def);
    body_state *s = helper_body_start(&h);
    helper_body_run(s, 0.2);
    assert_true(body__measure(s).largest_overlap < 1.5e-3);
    micro__body.destroy(s);
}

static void no_parts_are_no_trouble(void **state)
{
    helper_body h;
    helper_body_init(&h, helper_body_box(0.02, 0.02, 0.02));
    h.def.n_parts = 0;
    body_state *s = helper_body_start(&h);
    helper_body_run(s, 1e-3);
    assert_int_equal(body__measure(s).n_parts, 0);
    micro__body.destroy(s);
}

// 60 cylinders through a passage that a plate of 60 degrees leaves open: the mean over time of the
// difference of U(t) is below 1 % of N.
static void upright_cylinders_do_as_on_the_planar_path(void **state)
{
    enum { SAMPLES = 70 };
    helper_body h;
    double planar[SAMPLES], spatial[SAMPLES];
    helper_body_passage(&h, helper_body_cylinder(0.012, 0.008));
    h.def.dt = 2e-5;
    h.def.path = MICRO_PATH_PLANAR;
    helper_body_curve(&h.def, 1e-2, SAMPLES, planar);
    h.def.path = MICRO_PATH_SPATIAL;
    helper_body_curve(&h.def, 1e-2, SAMPLES, spatial);
    assert_true(planar[SAMPLES - 1] < 0.8 * (double)h.def.n_parts);
    assert_true(helper_body_gap(planar, spatial, SAMPLES) < 0.01 * (double)h.def.n_parts);
}

// Tilted about its width by 5 degrees a box of 0.3 m x 0.06 m x 0.04 m is held by 0.3 cos + 0.04 sin by 0.06 m, not by
// a disk of 0.3 m; a cylinder about the x axis by 10 degrees by its diameter along it, 0.06 cos + 0.2 sin across.
static void a_tilted_part_covers_the_rectangle_that_holds_it(void **state)
{
    const double box_tilt = 5.0 * M_PI / 180.0, cylinder_tilt = 10.0 * M_PI / 180.0;
    helper_body h;
    helper_body_init(&h, helper_body_box(0.3, 0.06, 0.04));
    body_state *s = helper_body_start(&h);
    assert_true(body__extent(s, 0).is_flat);
    helper_body_tilt(s, 0, (vec3){ 0.0, 1.0, 0.0 }, box_tilt, 0.0);
    micro_extent extent = body__extent(s, 0);
    assert_false(extent.is_flat);
    assert_near(extent.pose.heading, 0.0, 1e-12);
    assert_near(extent.half.x, 0.15 * cos(box_tilt) + 0.02 * sin(box_tilt), 1e-12);
    assert_near(extent.half.y, 0.03, 1e-12);
    shape_footprint room;
    const shape_footprint disk = { .bounding_radius = 0.02 },
                          *covered = micro_footprint(&extent, &disk, &room);
    assert_false(shape_overlaps(&disk, (scene_pose){ 0.0, 0.051, 0.0 }, covered, extent.pose));
    assert_true(shape_overlaps(&disk, (scene_pose){ 0.0, 0.049, 0.0 }, covered, extent.pose));
    micro__body.destroy(s);

    helper_body_init(&h, helper_body_cylinder(0.03, 0.2));
    s = helper_body_start(&h);
    helper_body_tilt(s, 0, (vec3){ 1.0, 0.0, 0.0 }, cylinder_tilt, 0.0);
    extent = body__extent(s, 0);
    assert_near(extent.half.x, 0.03, 1e-12);
    assert_near(extent.half.y, 0.03 * cos(cylinder_tilt) + 0.1 * sin(cylinder_tilt), 1e-12);
    micro__body.destroy(s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(two_threads_give_the_same_bits_as_one),
        cmocka_unit_test(threads_without_a_block_of_parts_are_not_used),
        cmocka_unit_test(a_tilted_part_covers_the_rectangle_that_holds_it),
        cmocka_unit_test(parts_stay_on_their_side_and_on_the_belt),
        cmocka_unit_test(a_loaded_state_goes_on_with_the_same_bits),
        cmocka_unit_test(implicit_steps_allocate_nothing),
        cmocka_unit_test(a_damaged_state_is_refused_and_changes_nothing),
        cmocka_unit_test(every_allocation_may_fail),
        cmocka_unit_test(a_step_without_memory_can_be_made_again),
        cmocka_unit_test(a_part_that_flies_off_is_named_with_step_and_time),
        cmocka_unit_test(a_value_that_is_not_finite_is_named),
        cmocka_unit_test(what_cannot_be_made_is_refused),
        cmocka_unit_test(the_stable_step_follows_the_mass),
        cmocka_unit_test(no_parts_are_no_trouble),
        cmocka_unit_test(upright_cylinders_do_as_on_the_planar_path),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
