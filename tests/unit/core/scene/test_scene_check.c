// Unit tests of the check of scenarios: every fault at its place, and only there.

#include "core/scene/scene.h"

#include "core/base/memory.h"
#include "core/scene/placement.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double speed = 0.395; // of the paper's belt, m/s

/// The faults of a scene, which is freed.
static const bf_faults *faults_of(scene *s)
{
    static bf_faults faults;

    faults = (bf_faults){ 0 };
    scene_check(s, &faults);
    scene_fini(s);
    return &faults;
}

static bool has_fault(const bf_faults *faults, bf_status code, const char *pointer,
                      const char *words)
{
    for (size_t k = 0; k < faults_kept(faults); k++) {
        const bf_error *e = &faults->items[k];
        if (e->code == code && strcmp(e->pointer, pointer) == 0 && strstr(e->text, words) != NULL)
            return true;
    }
    for (size_t k = 0; k < faults_kept(faults); k++)
        print_message("found %d %s: %s\n", (int)faults->items[k].code, faults->items[k].pointer,
                      faults->items[k].text);
    print_message("but not %d %s: %s\n", (int)code, pointer, words);
    return false;
}

/// True if the scene, which is freed, has this fault and no other.
static bool is_only_fault(scene *s, bf_status code, const char *pointer, const char *words)
{
    const bf_faults *faults = faults_of(s);
    return has_fault(faults, code, pointer, words) && faults->n == 1;
}

static void the_examples_have_no_fault(void **state)
{
    scene s;

    for (int treatment = 0; treatment < SCENE_TREATMENT_COUNT; treatment++) {
        for (double angle = 30.0; angle <= 90.0; angle += 10.0) {
            helper_scene_example(&s, angle, (scene_treatment)treatment);
            assert_int_equal(faults_of(&s)->n, 0);
        }
    }
}

static void the_check_reports_that_memory_is_exhausted(void **state)
{
    scene s;

    helper_scene_example(&s, 60.0, SCENE_SEALED);
    for (size_t n = 1;; n++) {
        static bf_faults faults;
        faults = (bf_faults){ 0 };
        memory_plan_fault(n, 0);
        scene_check(&s, &faults);
        size_t n_faults = memory_faults();
        memory_plan_fault(0, 0);
        if (n_faults == 0) {
            assert_int_equal(faults.n, 0);
            break;
        }
        assert_int_equal(faults_status(&faults, NULL), BF_ENOMEM);
    }
    scene_fini(&s);
}

static void numbers_out_of_range_are_refused_where_they_stand(void **state)
{
    static const struct {
        size_t offset;
        const char *pointer;
        double bad; // finite
    } numbers[] = {
        { offsetof(scene, duration), "/duration_s", 0.0 },
        { offsetof(scene, output.curve_every), "/output/curve_every_s", 0.0 },
        { offsetof(scene, output.snapshot_every), "/output/snapshot_every_s", -1.0 },
        { offsetof(scene, domain.x_min), "/domain/x_m", 1.0 },
        { offsetof(scene, domain.x_max), "/domain/x_m", 1e300 },
        { offsetof(scene, domain.y_max), "/domain/y_m", -1.0 },
        { offsetof(scene, cargo[0].mass), "/cargo/mass_kg", 0.0 },
        { offsetof(scene, cargo[0].shape.radius), "/cargo/shape/radius_m", -0.01 },
        { offsetof(scene, cargo[0].shape.height), "/cargo/shape/height_m", 0.0 },
        { offsetof(scene, cargo[0].material.young_modulus), "/cargo/material/young_modulus_pa", 0 },
        { offsetof(scene, cargo[0].material.poisson_ratio), "/cargo/material/poisson_ratio", 0.5 },
        { offsetof(scene, initial.first.y), "/initial/hexagonal/first_m", 1e9 },
        { offsetof(scene, initial.spacing), "/initial/hexagonal/spacing_m", 0.0 },
        { offsetof(scene, macro.cell), "/macro/cell_m", -0.005 },
        { offsetof(scene, macro.step), "/macro/step_s", -1.0 },
        { offsetof(scene, macro.jam_density), "/macro/jam_density", 0.0 },
        { offsetof(scene, macro.jam_density), "/macro/jam_density", 1.001 },
        { offsetof(scene, macro.heaviside_width), "/macro/heaviside_width", 0.0 },
        { offsetof(scene, macro.dispersion), "/macro/dispersion_m_s", -0.1 },
        { offsetof(scene, macro.mollifier), "/macro/mollifier_per_m2", 0.0 },
        { offsetof(scene, macro.initial_mollifier), "/macro/initial_mollifier_per_m2", -1.0 },
        { offsetof(scene, micro.step), "/micro/step_s", -1e-5 },
        { offsetof(scene, micro.modulus_reduction), "/micro/modulus_reduction", 0.5 },
        { offsetof(scene, micro.overlap_limit), "/micro/overlap_limit", 0.0 },
        { offsetof(scene, micro.damping), "/micro/damping_per_s", -1.0 },
        { offsetof(scene, micro.gravity), "/micro/gravity_m_s2", -1.0 },
        { offsetof(scene, micro.spin_friction_radius), "/micro/spin_friction_radius_m", -1.0 },
        { offsetof(scene, micro.conveyor.young_modulus), "/materials/conveyor/young_modulus_pa",
          0.0 },
        { offsetof(scene, micro.conveyor.poisson_ratio), "/materials/conveyor/poisson_ratio",
          -0.1 },
        { offsetof(scene, micro.handling.young_modulus), "/materials/handling/young_modulus_pa",
          0.0 },
        { offsetof(scene, micro.handling.poisson_ratio), "/materials/handling/poisson_ratio", 0.6 },
        { offsetof(scene, micro.contact[SCENE_CARGO_CARGO].damping),
          "/contacts/cargo_cargo/damping_n_s_m", -1.0 },
        { offsetof(scene, micro.contact[SCENE_CONVEYOR_CARGO].length),
          "/contacts/conveyor_cargo/length_m", 0.0 },
        { offsetof(scene, micro.contact[SCENE_CONVEYOR_CARGO].tanh_linear),
          "/contacts/conveyor_cargo/tanh_linear_s_m", 0.0 },
        { offsetof(scene, micro.contact[SCENE_HANDLING_CARGO].friction),
          "/contacts/handling_cargo/friction", -0.1 },
        { offsetof(scene, micro.contact[SCENE_HANDLING_CARGO].tanh_linear),
          "/contacts/handling_cargo/tanh_linear_s_m", 0.0 },
        { offsetof(scene, micro.contact[SCENE_HANDLING_CARGO].tanh_spin),
          "/contacts/handling_cargo/tanh_spin_s", 0.0 },
        { offsetof(scene, micro.wall_friction), "/contacts/wall_friction", -0.1 },
    };

    for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++) {
        const double bad[] = { numbers[k].bad, NAN, INFINITY, -INFINITY };
        for (size_t m = 0; m < sizeof bad / sizeof *bad; m++) {
            scene s;
            helper_scene_example(&s, 60.0, SCENE_SEALED);
            memcpy((char *)&s + numbers[k].offset, &bad[m], sizeof bad[m]);
            assert_true(is_only_fault(&s, BF_EINPUT, numbers[k].pointer, ""));
        }
    }
}

static void numbers_of_items_are_refused_where_they_stand(void **state)
{
    static const struct {
        size_t offset;
        const char *pointer;
    } numbers[] = {
        { offsetof(scene_obstacle, thickness), "/obstacles/0/thickness_m" },
        { offsetof(scene_obstacle, band), "/obstacles/0/band_m" },
        { offsetof(scene_obstacle, slide_width), "/obstacles/0/slide_width_m" },
    };
    static const double bad[] = { 0.0, -1.0, NAN, INFINITY };
    scene s;

    for (size_t k = 0; k < sizeof numbers / sizeof *numbers; k++) {
        for (size_t m = 0; m < sizeof bad / sizeof *bad; m++) {
            helper_scene_example(&s, 60.0, SCENE_SEALED);
            memcpy((char *)s.obstacles + numbers[k].offset, &bad[m], sizeof bad[m]);
            assert_true(is_only_fault(&s, BF_EINPUT, numbers[k].pointer, ""));
        }
    }
    helper_scene_example(&s, 60.0, SCENE_SEALED);
    s.belts[0].velocity.y = NAN;
    assert_true(is_only_fault(&s, BF_EINPUT, "/belts/0/velocity_m_s", ""));
    helper_scene_example(&s, 60.0, SCENE_SEALED);
    s.counters[0].rect.x_min = INFINITY;
    assert_true(is_only_fault(&s, BF_EINPUT, "/counters/0/x_m", ""));
    helper_scene_example(&s, 60.0, SCENE_SEALED);
    s.counters[0].rect.y_min = s.counters[0].rect.y_max;
    assert_true(is_only_fault(&s, BF_EINPUT, "/counters/0/y_m", ""));
}

static void words_out_of_range_are_refused(void **state)
{
    scene s;

    helper_scene_example(&s, 60.0, SCENE_SEALED);
    s.edges[SCENE_NORTH] = SCENE_EDGE_COUNT;
    s.obstacles[0].treatment = SCENE_TREATMENT_COUNT;
    s.cargo[0].shape.type = SCENE_SHAPE_COUNT;
    s.initial.type = SCENE_INITIAL_COUNT;
    s.macro.closure = SCENE_CLOSURE_COUNT;
    s.macro.scheme = SCENE_SCHEME_COUNT;
    s.macro.heaviside = SCENE_HEAVISIDE_COUNT;
    s.micro.integrator = SCENE_INTEGRATOR_COUNT;
    s.micro.path = SCENE_PATH_COUNT;
    const bf_faults *faults = faults_of(&s);
    assert_true(has_fault(faults, BF_EINPUT, "/edges/north", ""));
    assert_true(has_fault(faults, BF_EINPUT, "/obstacles/0/treatment", ""));
    assert_true(has_fault(faults, BF_EINPUT, "/cargo/shape/type", ""));
    assert_true(has_fault(faults, BF_EINPUT, "/initial", ""));
    assert_true(has_fault(faults, BF_EINPUT, "/macro/closure", ""));
    assert_true(has_fault(faults, BF_EINPUT, "/macro/scheme", ""));
    assert_true(has_fault(faults, BF_EINPUT, "/macro/heaviside", ""));
    assert_true(has_fault(faults, BF_EINPUT, "/micro/integrator", ""));
    assert_true(has_fault(faults, BF_EINPUT, "/micro/path", ""));
    assert_int_equal(faults->n, 9);
    helper_scene_example(&s, 60.0, SCENE_SEALED);
    s.micro.path = SCENE_PATH_PLANAR;
    s.cargo[0].shape =
        (scene_shape){ .type = SCENE_BOX, .length = 0.02, .width = 0.02, .height = 0.02 };
    assert_true(is_only_fault(&s, BF_EINPUT, "/micro/path", "planar is for cylinders"));
}

static void a_fresh_scene_lacks_all_that_has_no_default(void **state)
{
    scene s;

    scene_init(&s);
    helper_scene_resolve(&s);
    const bf_faults *faults = faults_of(&s);
    assert_true(has_fault(faults, BF_EINPUT, "/duration_s", ""));
    assert_true(has_fault(faults, BF_EINPUT, "/domain/x_m", ""));
    assert_true(has_fault(faults, BF_EINPUT, "/domain/y_m", ""));
    assert_true(has_fault(faults, BF_EINPUT, "/initial", ""));
}

static void a_wrong_member_is_reported_once_and_not_again_for_derived_members(void **state)
{
    scene s;

    helper_scene_belt(&s, 1.0, 0.5, 0.005, (scene_pose[]){ { 0.2, 0.2, 0.0 } }, 1);
    helper_scene_add_obstacle(&s, (vec2[]){ { 0.5, 0.0 }, { 0.5, 0.2 } }, 2, SCENE_SEALED);
    s.macro.mollifier = -1.0;
    s.cargo[0].shape.radius = NAN;
    helper_scene_add_belt(&s, (vec2){ INFINITY, 0.0 }, NULL, 0);
    helper_scene_resolve(&s);
    const bf_faults *faults = faults_of(&s);
    assert_true(has_fault(faults, BF_EINPUT, "/macro/mollifier_per_m2", ""));
    assert_true(has_fault(faults, BF_EINPUT, "/cargo/shape/radius_m", ""));
    assert_true(has_fault(faults, BF_EINPUT, "/belts/0/velocity_m_s", ""));
    assert_int_equal(faults->n, 3);
}

static void ids_are_words_and_unique(void **state)
{
    static const char *const bad[] = { "", "a b", "a,b", "\"", "a/b", "\xc3\xa4" };
    scene s;

    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        helper_scene_example(&s, 60.0, SCENE_SEALED);
        strcpy(s.obstacles[0].id, bad[k]);
        assert_true(is_only_fault(&s, BF_EINPUT, "/obstacles/0/id", "letters"));
    }
    helper_scene_example(&s, 60.0, SCENE_SEALED);
    memset(s.belts[0].id, 'x', SCENE_ID_SIZE - 1);
    assert_int_equal(faults_of(&s)->n, 0);
    helper_scene_example(&s, 60.0, SCENE_SEALED);
    memset(s.belts[0].id, 'x', SCENE_ID_SIZE);
    assert_true(is_only_fault(&s, BF_EINPUT, "/belts/0/id", "letters"));
    helper_scene_example(&s, 60.0, SCENE_SEALED);
    strcpy(helper_scene_add_belt(&s, (vec2){ 0.1, 0.0 }, NULL, 0)->id, "main");
    assert_true(is_only_fault(&s, BF_EINPUT, "/belts/1/id", "/belts/0"));
}

static void counters_do_not_take_the_names_of_other_columns(void **state)
{
    static const char *const taken[] = { "t_s", "left_domain" };
    scene s;

    for (size_t k = 0; k < 2; k++) {
        helper_scene_example(&s, 60.0, SCENE_SEALED);
        strcpy(s.counters[0].id, taken[k]);
        assert_true(is_only_fault(&s, BF_EINPUT, "/counters/0/id", taken[k]));
    }
}

// 33 belts with 8 kinds of failures each are 264.
static void failures_have_ids_of_their_own_and_are_not_too_many(void **state)
{
    scene s;

    for (int k = 0; k < 2; k++) {
        helper_scene_example(&s, 60.0, SCENE_SEALED);
        for (size_t n = s.n_belts; n < (k == 0 ? 2 : 33); n++)
            snprintf(helper_scene_add_belt(&s, (vec2){ 0.2, 0.0 }, NULL, 0)->id, SCENE_ID_SIZE,
                     "belt-%zu", n);
        for (size_t n = 0; n < s.n_belts; n++) {
            scene_stops *stops = &s.belts[n].stops;
            stops->n_failures = k == 0 ? 1 : SCENE_FAILURES_MAX;
            stops->until = 10.0;
            stops->failures = memory_alloc(stops->n_failures, sizeof *stops->failures);
            assert_non_null(stops->failures);
            for (size_t i = 0; i < stops->n_failures; i++) {
                stops->failures[i] =
                    (scene_failure){ .between = { 60.0, SCENE_TIME_EXPONENTIAL, 1.0 },
                                     .repair = { 6.0, SCENE_TIME_EXPONENTIAL, 1.0 } };
                snprintf(stops->failures[i].id, SCENE_ID_SIZE, k == 0 ? "f" : "f-%zu-%zu", n, i);
            }
        }
        assert_true(is_only_fault(&s, k == 0 ? BF_EINPUT : BF_ELIMIT,
                                  k == 0 ? "/belts/1/failures/0/id" : "/belts/32/failures/0/id",
                                  k == 0 ? "'f' is the id of another" : "more than 256"));
    }
}

static void speed_schedules_are_checked_belt_by_belt(void **state)
{
    scene s;

    for (int k = 0; k < 2; k++) {
        helper_scene_example(&s, 60.0, SCENE_SEALED);
        scene_belt *belt = helper_scene_add_belt(&s, (vec2){ 0.2, 0.0 }, NULL, 0);
        snprintf(belt->id, sizeof belt->id, "second");
        helper_scene_schedule(belt, 2, (double[]){ 1.0, k == 0 ? 0.5 : 2.0 },
                              (double[]){ 0.0, 1.0 });
        belt->deceleration = k == 0 ? INFINITY : -1.0;
        assert_true(is_only_fault(
            &s, BF_EINPUT, k == 0 ? "/belts/1/speed_schedule/t_s/1" : "/belts/1/deceleration_m_s2",
            k == 0 ? "0.5 s do not come after the 1 s" : "must be above 0"));
    }
    // The second belt is the faster one from 2 s on: 0.5 m/s; its factor of 2.5 is the largest, too.
    helper_scene_example(&s, 60.0, SCENE_SEALED);
    helper_scene_schedule(helper_scene_add_belt(&s, (vec2){ 0.2, 0.0 }, NULL, 0), 1,
                          (double[]){ 2.0 }, (double[]){ 2.5 });
    assert_near(scene_belt_speed(&s), speed, 0.0);
    assert_near(scene_step_stable(&s), 0.005 / (0.5 + 2.5 * 2.0 * speed), 1e-15);
    scene_fini(&s);
}

static void polygons_of_belts_are_simple(void **state)
{
    static const struct {
        const char *pointer;
        size_t n;
        vec2 corners[6];
    } bad[] = {
        { "/belts/0/polygon_m", 2, { { 0, 0 }, { 1, 0 } } },
        { "/belts/0/polygon_m/2", 4, { { 0, 0 }, { 1, 0 }, { 1, 0 }, { 0, 1 } } },
        { "/belts/0/polygon_m/3", 4, { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 0 } } },
        { "/belts/0/polygon_m/1", 3, { { 0, 0 }, { NAN, 0 }, { 1, 1 } } },
        { "/belts/0/polygon_m", 4, { { 0, 0 }, { 1, 1 }, { 1, 0 }, { 0, 1 } } },
        { "/belts/0/polygon_m", 3, { { 0, 0 }, { 1, 0 }, { 0.5, 0 } } },
        { "/belts/0/polygon_m", 5, { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0.5, 0 }, { 0, 1 } } },
    };
    scene s;

    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        helper_scene_belt(&s, 1.0, 0.5, 0.005, (scene_pose[]){ { 0.2, 0.2, 0.0 } }, 1);
        helper_scene_add_belt(&s, (vec2){ speed, 0.0 }, bad[k].corners, bad[k].n);
        helper_scene_resolve(&s);
        assert_true(is_only_fault(&s, BF_EINPUT, bad[k].pointer, ""));
    }
    helper_scene_belt(&s, 1.0, 0.5, 0.005, (scene_pose[]){ { 0.2, 0.2, 0.0 } }, 1);
    helper_scene_add_belt(&s, (vec2){ speed, 0.0 },
                          (vec2[]){ { 0, 0 }, { 1, 0 }, { 0.5, 0.2 }, { 0, 1 } }, 4);
    helper_scene_resolve(&s);
    assert_int_equal(faults_of(&s)->n, 0);
}

static void paths_of_obstacles_have_length(void **state)
{
    static const struct {
        const char *pointer;
        size_t n;
        vec2 points[4];
    } bad[] = {
        { "/obstacles/0/path_m", 1, { { 0, 0 } } },
        { "/obstacles/0", 2, { { 0.5, 0 }, { 0.5, 0 } } },
        { "/obstacles/0", 2, { { 0.5, 0 }, { 0.5, INFINITY } } },
        { "/obstacles/0/path_m/2", 3, { { 0.5, 0 }, { 0.5, 0.1 }, { 0.5, 0.1 } } },
        { "/obstacles/0/path_m/0", 3, { { NAN, 0 }, { 0.5, 0.1 }, { 0.5, 0.2 } } },
    };

    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        scene s;
        helper_scene_belt(&s, 1.0, 0.5, 0.005, (scene_pose[]){ { 0.2, 0.2, 0.0 } }, 1);
        helper_scene_add_obstacle(&s, bad[k].points, bad[k].n, SCENE_SEALED);
        helper_scene_resolve(&s);
        assert_true(is_only_fault(&s, BF_EINPUT, bad[k].pointer, ""));
    }
}

static void shapes_are_convex_and_solid(void **state)
{
    static const struct {
        scene_shape_type type;
        const char *pointer;
        const char *words;
        size_t n;
        double vertices[6][3];
    } bad[] = {
        { SCENE_PRISM, "/cargo/shape/outline_m", "3 to 64", 2, { { 0 }, { 1 } } },
        { SCENE_PRISM, "/cargo/shape/outline_m", "clockwise", 3, { { 0, 0 }, { 0, 1 }, { 1, 0 } } },
        { SCENE_PRISM, "/cargo/shape/outline_m", "area", 3, { { 0, 0 }, { 1, 1 }, { 2, 2 } } },
        { SCENE_PRISM, "/cargo/shape/outline_m/1", "", 3, { { 0, 0 }, { NAN, 1 }, { 2, 2 } } },
        { SCENE_PRISM, "/cargo/shape/outline_m/2", "repeats", 3, { { 0, 0 }, { 1, 0 }, { 1, 0 } } },
        { SCENE_PRISM,
          "/cargo/shape/outline_m",
          "convex",
          4,
          { { 0, 0 }, { 1, 0 }, { 0.2, 0.2 }, { 0, 1 } } },
        { SCENE_PRISM, // a star runs round twice, with left turns only
          "/cargo/shape/outline_m",
          "convex",
          5,
          { { 1, 0 }, { -0.8, 0.6 }, { 0.3, -1 }, { 0.3, 1 }, { -0.8, -0.6 } } },
        { SCENE_PRISM,
          "/cargo/shape/outline_m",
          "too small",
          3,
          { { 0, 0 }, { 1e-7, 0 }, { 0, 1e-7 } } },
        { SCENE_HULL, "/cargo/shape/vertices_m", "4 to 64", 3, { { 0 }, { 1 }, { 0, 1 } } },
        { SCENE_HULL,
          "/cargo/shape/vertices_m",
          "degenerate",
          5,
          { { 0, 0, 1 }, { 1, 0, 1 }, { 0, 1, 1 }, { 1, 1, 1 }, { 0.5, 0.5, 1 } } },
        { SCENE_HULL,
          "/cargo/shape/vertices_m",
          "degenerate",
          4,
          { { 0, 0, 0 }, { 1, 1, 1 }, { 2, 2, 2 }, { 3, 3, 3 } } },
        { SCENE_HULL,
          "/cargo/shape/vertices_m/3",
          "",
          4,
          { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, INFINITY } } },
    };

    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        scene s;
        helper_scene_example(&s, 60.0, SCENE_SEALED);
        helper_scene_set_vertices(&s, bad[k].type, bad[k].vertices, bad[k].n);
        assert_true(is_only_fault(&s, BF_EINPUT, bad[k].pointer, bad[k].words));
    }
}

static void slender_shapes_are_beyond_the_limit(void **state)
{
    scene s;

    helper_scene_example(&s, 60.0, SCENE_SEALED);
    s.cargo[0].shape.type = SCENE_BOX;
    s.cargo[0].shape.length = 1.0;
    s.cargo[0].shape.width = 1e-4;
    assert_true(is_only_fault(&s, BF_ELIMIT, "/cargo/shape", "1000"));
}

static void sizes_beyond_the_limits_are_refused_with_figure_and_limit(void **state)
{
    scene s;

    helper_scene_example(&s, 60.0, SCENE_SEALED);
    s.macro.cell = 1e-6;
    assert_true(is_only_fault(&s, BF_ELIMIT, "/macro/cell_m", "6e+11 cells, the limit is 1000000"));
    // 10,000 x 6,000 cells: the congested closure has a limit of its own.
    helper_scene_example(&s, 60.0, SCENE_SEALED);
    s.domain = (scene_rect){ 0.0, 10.0, 0.0, 6.0 };
    s.macro.cell = 0.001;
    s.macro.step = 1e-5;
    s.macro.closure = SCENE_CONGESTED;
    s.output.snapshot_every = 1.0;
    assert_true(has_fault(faults_of(&s), BF_ELIMIT, "/macro/cell_m",
                          "60000000 cells with the congested closure, the limit is 30000000"));
    s.macro.closure = SCENE_DISPERSIVE;
    assert_false(has_fault(faults_of(&s), BF_ELIMIT, "/macro/cell_m", "cells"));
    helper_scene_example(&s, 60.0, SCENE_SEALED);
    s.output.curve_every = 1e-6;
    assert_true(is_only_fault(&s, BF_ELIMIT, "/output/curve_every_s", "samples"));
    helper_scene_example(&s, 60.0, SCENE_SEALED);
    s.output.snapshot_every = 1e-4;
    assert_true(is_only_fault(&s, BF_ELIMIT, "/output/snapshot_every_s", "snapshots, the limit"));
    // 2e6 cells of 4 bytes, 6000 times.
    helper_scene_example(&s, 60.0, SCENE_SEALED);
    s.macro.cell = 0.0005;
    s.macro.step = 1e-4;
    s.macro.mollifier = 1e6;
    s.output.snapshot_every = 1e-3;
    assert_true(is_only_fault(&s, BF_ELIMIT, "/output/snapshot_every_s", "bytes of snapshots"));
    // A Gaussian that covers all of 6.4e7 cells would be summed up for each part.
    helper_scene_example(&s, 60.0, SCENE_SEALED);
    s.domain = (scene_rect){ 0.0, 40.0, 0.0, 40.0 };
    s.edges[SCENE_WEST] = s.edges[SCENE_EAST] = SCENE_EDGE_OUTFLOW;
    s.initial.n_rows = s.initial.n_columns = 1000;
    s.macro.initial_mollifier = 1e-9;
    s.output.snapshot_every = 1.0;
    assert_true(is_only_fault(&s, BF_ELIMIT, "/macro/initial_mollifier_per_m2", "6.4e+13"));
}

static void numbers_of_items_are_limited(void **state)
{
    static scene_belt belts[SCENE_BELTS_MAX + 1];
    static scene_obstacle obstacles[SCENE_OBSTACLES_MAX + 1];
    static bf_faults faults;
    scene s;

    helper_scene_example(&s, 60.0, SCENE_SEALED);
    scene many = s;
    many.belts = belts;
    many.n_belts = SCENE_BELTS_MAX + 1;
    many.obstacles = obstacles;
    many.n_obstacles = SCENE_OBSTACLES_MAX + 1;
    for (size_t k = 0; k < many.n_belts; k++)
        belts[k] = s.belts[0];
    for (size_t k = 0; k < many.n_obstacles; k++)
        obstacles[k] = s.obstacles[0];
    scene_check(&many, &faults);
    assert_true(has_fault(&faults, BF_ELIMIT, "/obstacles", "257"));
    assert_true(has_fault(&faults, BF_ELIMIT, "/belts", "257"));
    placement_fini(&many.placement);
    scene_fini(&s);
    helper_scene_example(&s, 60.0, SCENE_SEALED);
    s.initial.n_rows = s.initial.n_columns = UINT32_MAX;
    assert_true(is_only_fault(&s, BF_ELIMIT, "/initial/hexagonal", "18446744065119617024 parts"));
    helper_scene_example(&s, 60.0, SCENE_SEALED);
    s.initial.n_rows = 0;
    assert_true(is_only_fault(&s, BF_EINPUT, "/initial/hexagonal/rows", ""));
    helper_scene_belt(&s, 1.0, 0.5, 0.005, NULL, 0);
    helper_scene_resolve(&s);
    assert_true(is_only_fault(&s, BF_EINPUT, "/initial/positions_m", "at least 1"));
}

static void cargo_faults_point_at_their_source(void **state)
{
    static const scene_pose overlapping[] = { { 0.2, 0.2, 0.0 },
                                              { 0.3, 0.2, 0.0 },
                                              { 0.2, 0.223, 0.0 } };
    scene s;

    helper_scene_belt(&s, 1.0, 0.5, 0.005, overlapping, 3);
    helper_scene_resolve(&s);
    assert_true(is_only_fault(&s, BF_EINPUT, "/initial/positions_m/2", "0.024"));
    helper_scene_belt(&s, 1.0, 0.5, 0.005, (scene_pose[]){ { 0.2, NAN, 0.0 } }, 1);
    helper_scene_resolve(&s);
    assert_true(is_only_fault(&s, BF_EINPUT, "/initial/positions_m/0", "numbers"));
    helper_scene_example(&s, 60.0, SCENE_SEALED);
    s.initial.spacing = 0.02;
    assert_true(is_only_fault(&s, BF_EINPUT, "/initial/hexagonal", "overlaps"));
    helper_scene_example(&s, 60.0, SCENE_SEALED);
    s.initial.first.y = 0.3;
    assert_true(is_only_fault(&s, BF_EINPUT, "/initial/hexagonal", "north wall"));
}

static void random_cargo_needs_a_sound_region(void **state)
{
    scene s;

    helper_scene_example(&s, 60.0, SCENE_SEALED);
    s.initial.type = SCENE_INITIAL_RANDOM;
    s.initial.n_random = 100;
    s.initial.region = (scene_rect){ 0.1, 0.5, 0.1, 0.5 };
    const scene sound = s;
    scene random = s;
    static bf_faults faults;
    scene_check(&s, &faults);
    assert_int_equal(faults.n, 0);
    random.initial.region.x_min = -0.1;
    scene_check(&random, &faults);
    random.initial.region.y_min = NAN;
    scene_check(&random, &faults);
    random = sound;
    random.initial.seed = UINT64_C(1) << 53;
    scene_check(&random, &faults);
    random = sound;
    random.initial.n_random = 0;
    scene_check(&random, &faults);
    random.initial.n_random = 400;
    scene_check(&random, &faults);
    static const char *const pointers[] = {
        "/initial/random/region/x_m", "/initial/random/region/x_m", "/initial/random/region/y_m",
        "/initial/random/seed",       "/initial/random/count",      "/initial/random"
    };
    assert_int_equal(faults.n, 6);
    for (size_t k = 0; k < 6; k++)
        assert_string_equal(faults.items[k].pointer, pointers[k]);
    scene_fini(&s);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_examples_have_no_fault),
        cmocka_unit_test(the_check_reports_that_memory_is_exhausted),
        cmocka_unit_test(numbers_out_of_range_are_refused_where_they_stand),
        cmocka_unit_test(numbers_of_items_are_refused_where_they_stand),
        cmocka_unit_test(words_out_of_range_are_refused),
        cmocka_unit_test(a_fresh_scene_lacks_all_that_has_no_default),
        cmocka_unit_test(a_wrong_member_is_reported_once_and_not_again_for_derived_members),
        cmocka_unit_test(ids_are_words_and_unique),
        cmocka_unit_test(counters_do_not_take_the_names_of_other_columns),
        cmocka_unit_test(failures_have_ids_of_their_own_and_are_not_too_many),
        cmocka_unit_test(speed_schedules_are_checked_belt_by_belt),
        cmocka_unit_test(polygons_of_belts_are_simple),
        cmocka_unit_test(paths_of_obstacles_have_length),
        cmocka_unit_test(shapes_are_convex_and_solid),
        cmocka_unit_test(slender_shapes_are_beyond_the_limit),
        cmocka_unit_test(sizes_beyond_the_limits_are_refused_with_figure_and_limit),
        cmocka_unit_test(numbers_of_items_are_limited),
        cmocka_unit_test(cargo_faults_point_at_their_source),
        cmocka_unit_test(random_cargo_needs_a_sound_region),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
