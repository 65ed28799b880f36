// Unit tests of what the checkpoints of the microscopic solvers belong to.

#include "core/micro/micro.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

// Two cylinders on a belt before a plate. A change of `def` or of what it points to makes another one.
typedef struct world {
    micro_def def;
    scene_belt belt;
    scene_obstacle obstacle;
    vec2 path[2];
    micro_kind kind;
    scene_pose poses[2];
} world;

static void init(world *w)
{
    *w = (world){ .def = micro_def_default(),
                  .belt = { .velocity = { 0.4, 0.0 } },
                  .obstacle = { .n_points = 2, .thickness = 0.005 },
                  .path = { { 0.5, 0.1 }, { 0.7, 0.5 } },
                  .kind = { .shape = { .type = SCENE_CYLINDER, .radius = 0.012, .height = 0.008 },
                            .material = { 210e9, 0.28 },
                            .mass = 0.03,
                            .spin_radius = 0.008 },
                  .poses = { { 0.1, 0.1, 0.0 }, { 0.1, 0.2, 0.0 } } };
    w->obstacle.path = w->path;
    w->def.domain = (scene_rect){ 0.0, 1.0, 0.0, 0.6 };
    w->def.n_belts = w->def.n_obstacles = w->def.n_kinds = 1;
    w->def.belts = &w->belt;
    w->def.obstacles = &w->obstacle;
    w->def.kinds = &w->kind;
    w->def.n_parts = 2;
    w->def.poses = w->poses;
}

// The numbers of a definition, each a bit off.
enum { CHANGES = 15 };

static void change(world *w, int k)
{
    const double more = 1.0 + 0x1p-40;

    double *const numbers[CHANGES] = { &w->belt.velocity.x,
                                       &w->obstacle.thickness,
                                       &w->path[1].x,
                                       &w->kind.shape.radius,
                                       &w->kind.material.young_modulus,
                                       &w->kind.mass,
                                       &w->kind.spin_radius,
                                       &w->poses[1].y,
                                       &w->def.domain.x_max,
                                       &w->def.contact[SCENE_CARGO_CARGO].friction,
                                       &w->def.contact[SCENE_CONVEYOR_CARGO].tanh_spin,
                                       &w->def.handling.young_modulus,
                                       &w->def.modulus_reduction,
                                       &w->def.damping,
                                       &w->def.gravity };
    *numbers[k] *= more;
}

static bf_status load(const world *w, const bf_buffer *saved)
{
    micro_solver *s = NULL;

    assert_int_equal(micro_create(&w->def, &s, NULL), BF_OK);
    bf_status status = micro_load(s, saved->bytes, saved->n, NULL);
    micro_destroy(s);
    return status;
}

static bf_buffer save(const world *w)
{
    bf_buffer saved = { 0 };
    micro_solver *s = NULL;

    assert_int_equal(micro_create(&w->def, &s, NULL), BF_OK);
    assert_int_equal(micro_advance(s, 3, NULL), BF_OK);
    assert_int_equal(micro_save(s, &saved, NULL), BF_OK);
    micro_destroy(s);
    return saved;
}

static void check_path(micro_path path, micro_integrator integrator)
{
    world w;

    init(&w);
    w.def.path = path;
    w.def.integrator = integrator;
    bf_buffer saved = save(&w);
    assert_int_equal(load(&w, &saved), BF_OK);
    w.def.n_threads = 2;
    assert_int_equal(load(&w, &saved), BF_OK);
    for (int k = 0; k < CHANGES; k++) {
        init(&w);
        w.def.path = path;
        w.def.integrator = integrator;
        change(&w, k);
        assert_int_equal(load(&w, &saved), BF_ECORRUPT);
    }
    init(&w);
    w.def.path = path == MICRO_PATH_SPATIAL ? MICRO_PATH_PLANAR : MICRO_PATH_SPATIAL;
    w.def.integrator = integrator;
    assert_int_equal(load(&w, &saved), BF_ECORRUPT);
    w.def.path = path;
    w.def.integrator = integrator == MICRO_VERLET ? MICRO_IMPLICIT : MICRO_VERLET;
    assert_int_equal(load(&w, &saved), BF_ECORRUPT);
    buffer_fini(&saved);
}

static void a_checkpoint_fits_no_definition_that_differs_in_one_number(void **state)
{
    (void)state;
    check_path(MICRO_PATH_PLANAR, MICRO_VERLET);
    check_path(MICRO_PATH_PLANAR, MICRO_IMPLICIT);
    check_path(MICRO_PATH_SPATIAL, MICRO_VERLET);
    check_path(MICRO_PATH_SPATIAL, MICRO_IMPLICIT);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_checkpoint_fits_no_definition_that_differs_in_one_number),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
