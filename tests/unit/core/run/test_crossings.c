// Parts that cross the beams of photo eyes of the macroscopic model, from densities that the tests set.

#include "core/run/crossings.h"

#include "core/base/buffer.h"
#include "core/base/memory.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>

// The same density everywhere, and one factor of all belts.
typedef struct even_field {
    double density;
    double factor;
} even_field;

static double even_density(const void *context, size_t cell)
{
    return ((const even_field *)context)->density;
}

static double even_factor(const void *context, size_t belt)
{
    (void)belt;
    return ((const even_field *)context)->factor;
}

// A belt of 1 m at 0.4 m/s with a feed on its west side, and a beam from wall to wall at a place.
static void make_scene(scene *s, double width, scene_arrivals arrivals, double place)
{
    helper_scene_belt(s, 1.0, width, 0.005, NULL, 0);
    s->initial.type = SCENE_INITIAL_EMPTY;
    helper_scene_add_belt(s, (vec2){ 0.4, 0.0 }, NULL, 0);
    helper_scene_add_feed(s, SCENE_WEST, arrivals, 1.0);
    s->n_eyes = 1;
    s->eyes = memory_alloc(1, sizeof *s->eyes);
    scene_photo_eye_init(&s->eyes[0]);
    s->eyes[0].line[0] = (vec2){ place, 0.0 };
    s->eyes[0].line[1] = (vec2){ place, width };
    helper_scene_resolve(s);
}

// What an eye saw of a density for some steps.
typedef struct sight {
    double n;      // times that the beam was broken
    double broken; // of the time
} sight;

static sight look(const scene *s, even_field now, size_t n_steps)
{
    const crossings_field field = { &now, even_density, even_factor, NULL };
    crossings *c = NULL;
    bool was_broken = false;
    sight seen = { 0.0, 0.0 };
    uint64_t n_left = 0;

    assert_int_equal(crossings_create(s, &c, NULL), BF_OK);
    for (size_t k = 0; k < n_steps; k++) {
        const bool is_broken = crossings_advance(c, 0, &field);
        // A beam that becomes free was left by one part, or by several that came meanwhile; one that is first broken by none.
        const uint64_t n_now = crossings_left(c, 0);
        assert_true(is_broken || !was_broken || n_now > n_left);
        assert_true(n_now >= n_left && (seen.n > 0.0 || n_now == 0));
        n_left = n_now;
        seen.n += is_broken && !was_broken;
        seen.broken += is_broken ? 1.0 / (double)n_steps : 0.0;
        was_broken = is_broken;
    }
    crossings_destroy(c);
    return seen;
}

// The density at which some parts/s pass a beam across the belt.
static double density_of(const scene *s, double width, double parts_per_s)
{
    return parts_per_s / (scene_packing_density(s) * width * 0.4);
}

// Parts of 24 mm pass in 60 ms: at 5/s the beam is broken five times a second, 0.3 of the time.
static void regular_parts_break_a_beam_one_by_one(void **unused)
{
    scene s;

    make_scene(&s, 0.03, SCENE_ARRIVALS_REGULAR, 0.5);
    const double dt = scene_macro_step(&s);
    const sight seen =
        look(&s, (even_field){ density_of(&s, 0.03, 5.0), 1.0 }, (size_t)(100.0 / dt));
    assert_near(seen.n, 500.0, 1.0);
    assert_near(seen.broken, 0.3, dt / 0.2); // a step for each part
    scene_fini(&s);
}

// One by one they do not lie on each other: broken for N = 0.3 of the time, too, and seen by themselves but for gaps of
// less than a step, which are seen as well.
static void random_parts_of_one_lane_do_not_overlap(void **unused)
{
    scene s;

    make_scene(&s, 0.03, SCENE_ARRIVALS_POISSON, 0.5);
    const double dt = scene_macro_step(&s);
    const sight seen = look(&s, (even_field){ density_of(&s, 0.03, 5.0), 1.0 }, (size_t)(2e3 / dt));
    assert_near(seen.n, 1e4, 3e2);
    assert_near(seen.broken, 0.3, dt / 0.2 + 0.01);
    scene_fini(&s);
}

// Side by side they do: N = 20/s 60 ms = 1.2, free for exp(-1.2) of the time, 20/s exp(-1.2) times a second.
static void random_parts_of_a_wide_belt_overlap(void **unused)
{
    scene s;

    make_scene(&s, 0.6, SCENE_ARRIVALS_POISSON, 0.5);
    const double dt = scene_macro_step(&s);
    const sight seen = look(&s, (even_field){ density_of(&s, 0.6, 20.0), 1.0 }, (size_t)(1e3 / dt));
    assert_near(seen.n / 1e3, 20.0 * exp(-1.2), 0.2);
    assert_near(1.0 - seen.broken, exp(-1.2), 0.03);
    scene_fini(&s);
}

// A density downstream of the beam alone.
static double density_behind(const void *context, size_t cell)
{
    return cell % 200 < 100 ? 0.0 : even_density(context, cell);
}

static void make_reversing_scene(scene *s)
{
    make_scene(s, 0.03, SCENE_ARRIVALS_REGULAR, 0.5);
    helper_scene_schedule(&s->belts[0], 1, (double[]){ 1.0 }, (double[]){ -1.0 });
}

static void where_the_belt_runs_backwards_parts_come_from_the_other_side(void **unused)
{
    even_field now;
    const crossings_field field = { &now, density_behind, even_factor, NULL };
    crossings *c = NULL;
    int n[2] = { 0, 0 };
    scene s;

    make_reversing_scene(&s);
    const int n_steps = (int)(20.0 / scene_macro_step(&s));
    assert_int_equal(crossings_create(&s, &c, NULL), BF_OK);
    for (int way = 0; way < 2; way++) {
        bool was_broken = false;
        now = (even_field){ density_of(&s, 0.03, 5.0), way == 0 ? 1.0 : -1.0 };
        for (int k = 0; k < n_steps; k++) {
            const bool is_broken = crossings_advance(c, 0, &field);
            n[way] += is_broken && !was_broken;
            was_broken = is_broken;
        }
    }
    assert_int_equal(n[0], 0);
    assert_in_range(n[1], 99, 101);
    crossings_destroy(c);
    scene_fini(&s);
}

static void a_part_goes_back_as_far_as_it_has_come(void **unused)
{
    even_field now;
    const crossings_field field = { &now, even_density, even_factor, NULL };
    crossings *c = NULL;
    int n = 0;
    scene s;

    make_reversing_scene(&s);
    now = (even_field){ density_of(&s, 0.03, 5.0), 1.0 };
    assert_int_equal(crossings_create(&s, &c, NULL), BF_OK);
    while (!crossings_advance(c, 0, &field))
        ;
    for (int k = 0; k < 3; k++)
        assert_true(crossings_advance(c, 0, &field));
    now = (even_field){ 0.0, -1.0 };
    while (crossings_advance(c, 0, &field))
        n++;
    assert_in_range(n, 2, 4); // it came within the first step
    crossings_destroy(c);
    scene_fini(&s);
}

static void packed_parts_and_parts_that_stand_break_it_all_the_time(void **unused)
{
    const even_field packed = { 1.0, 1.0 };
    even_field now = packed;
    const crossings_field field = { &now, even_density, even_factor, NULL };
    crossings *c = NULL;
    scene s;

    make_scene(&s, 0.6, SCENE_ARRIVALS_POISSON, 0.5);
    assert_near(look(&s, packed, 1000).n, 1.0, 0.0);
    assert_int_equal(crossings_create(&s, &c, NULL), BF_OK);
    for (int k = 0; k < 1000; k++)
        (void)crossings_advance(c, 0, &field);
    now = (even_field){ 0.01, 0.0 };
    for (int k = 0; k < 1000; k++)
        assert_true(crossings_advance(c, 0, &field));
    crossings_destroy(c);
    scene_fini(&s);
}

// What has left the domain breaks no beam: at 4 mm from the side parts do so for 16 of 24 mm.
static void parts_that_leave_break_a_beam_for_less(void **unused)
{
    scene s;

    make_scene(&s, 0.03, SCENE_ARRIVALS_REGULAR, 0.996);
    const double dt = scene_macro_step(&s);
    const sight seen =
        look(&s, (even_field){ density_of(&s, 0.03, 5.0), 1.0 }, (size_t)(100.0 / dt));
    assert_near(seen.broken, 5.0 * 0.016 / 0.4, dt / 0.2);
    scene_fini(&s);
}

static void an_eye_beside_the_belts_sees_nothing(void **unused)
{
    const vec2 left[] = { { 0, 0 }, { 0.4, 0 }, { 0.4, 0.6 }, { 0, 0.6 } };
    scene s;

    make_scene(&s, 0.6, SCENE_ARRIVALS_POISSON, 0.7);
    s.belts[0].n_points = 4;
    s.belts[0].polygon = memory_alloc(4, sizeof *left);
    for (size_t k = 0; k < 4; k++)
        s.belts[0].polygon[k] = left[k];
    helper_scene_resolve(&s);
    assert_near(look(&s, (even_field){ 1.0, 1.0 }, 1000).n, 0.0, 0.0);
    scene_fini(&s);
}

static void a_saved_eye_goes_on_as_it_would_have(void **unused)
{
    const even_field now = { 0.02, 1.0 };
    const crossings_field field = { &now, even_density, even_factor, NULL };
    crossings *c = NULL, *copy = NULL;
    bf_buffer saved = { .n = 0 };
    checkpoint_writer w;
    checkpoint_reader r;
    scene s;

    make_scene(&s, 0.6, SCENE_ARRIVALS_POISSON, 0.5);
    assert_int_equal(crossings_create(&s, &c, NULL), BF_OK);
    assert_int_equal(crossings_create(&s, &copy, NULL), BF_OK);
    for (int k = 0; k < 100; k++)
        (void)crossings_advance(c, 0, &field);
    checkpoint_begin(&w, &saved, CHECKPOINT_RUN, 0);
    crossings_save(c, &w);
    assert_int_equal(checkpoint_end(&w, NULL), BF_OK);
    assert_int_equal(checkpoint_open(&r, saved.bytes, saved.n, CHECKPOINT_RUN, 0, NULL), BF_OK);
    assert_true(crossings_load(copy, &r));
    assert_int_equal(r.n_left, 0);
    for (int k = 0; k < 1000; k++)
        assert_int_equal(crossings_advance(copy, 0, &field), crossings_advance(c, 0, &field));
    buffer_fini(&saved);
    crossings_destroy(c);
    crossings_destroy(copy);
    scene_fini(&s);
}

static void no_memory_is_reported(void **unused)
{
    bf_status status = BF_ENOMEM;
    crossings *c = NULL;
    scene s;

    make_scene(&s, 0.6, SCENE_ARRIVALS_POISSON, 0.5);
    for (size_t n = 1; status != BF_OK; n++) {
        memory_plan_fault(n, 0);
        status = crossings_create(&s, &c, NULL);
        memory_plan_fault(0, 0);
        assert_true(status == BF_OK || status == BF_ENOMEM);
    }
    crossings_destroy(c);
    scene_fini(&s);
}

typedef struct field_of_kinds {
    even_field even;
    size_t which; // of the fractions below
} field_of_kinds;

// Kinds of what crosses: the first one, the second one, or a quarter of the second one.
static const double *fractions_of(const void *context, size_t cell)
{
    static const double of[][2] = { { 1.0, 0.0 }, { 0.0, 1.0 }, { 0.75, 0.25 } };

    return of[((const field_of_kinds *)context)->which];
}

// 4,000 draws with probability 1/4 have a deviation of sqrt(4000 * 3/16) = 27.
static void parts_are_of_the_kinds_that_cross(void **state)
{
    static const double least[] = { 0.0, 4000.0, 1000.0 - 4.0 * 27.0 },
                        most[] = { 0.0, 4000.0, 1000.0 + 4.0 * 27.0 };
    scene s;

    make_scene(&s, 0.1, SCENE_ARRIVALS_REGULAR, 0.5);
    s.cargo[1] = s.cargo[0];
    s.n_cargo = 2;
    for (size_t k = 0; k < 3; k++) {
        const field_of_kinds now = { { density_of(&s, 0.1, 2.0), 1.0 }, k };
        const crossings_field field = { &now, even_density, even_factor, fractions_of };
        crossings *c = NULL;
        uint64_t last = 0;
        double n = 0.0, of_second = 0.0;
        assert_int_equal(crossings_create(&s, &c, NULL), BF_OK);
        while (n < 4000.0) {
            size_t n_parts;
            (void)crossings_advance(c, 0, &field);
            const photo_eye_part *parts = crossings_parts(c, 0, &n_parts);
            for (size_t i = 0; i < n_parts; i++) {
                if (parts[i].id == last)
                    continue;
                last = parts[i].id;
                n += 1.0;
                of_second += parts[i].kind == 1 ? 1.0 : 0.0;
            }
        }
        assert_true(of_second >= least[k] && of_second <= most[k]);
        crossings_destroy(c);
    }
    scene_fini(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(regular_parts_break_a_beam_one_by_one),
        cmocka_unit_test(random_parts_of_one_lane_do_not_overlap),
        cmocka_unit_test(random_parts_of_a_wide_belt_overlap),
        cmocka_unit_test(where_the_belt_runs_backwards_parts_come_from_the_other_side),
        cmocka_unit_test(a_part_goes_back_as_far_as_it_has_come),
        cmocka_unit_test(packed_parts_and_parts_that_stand_break_it_all_the_time),
        cmocka_unit_test(parts_that_leave_break_a_beam_for_less),
        cmocka_unit_test(an_eye_beside_the_belts_sees_nothing),
        cmocka_unit_test(a_saved_eye_goes_on_as_it_would_have),
        cmocka_unit_test(parts_are_of_the_kinds_that_cross),
        cmocka_unit_test(no_memory_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
