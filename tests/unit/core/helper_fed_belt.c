#include "tests/unit/core/helper_fed_belt.h"

#include "tests/unit/core/helper_micro.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>

static const double radius = 0.012; // of parts, m
static const double speed = 1.0;    // of the belt, m/s

void helper_fed_belt_init(helper_fed_belt *w, int solver)
{
    const scene_shape small = { .type = SCENE_CYLINDER, .radius = 0.009, .height = 0.008 };
    const scene_shape box = { .type = SCENE_BOX, .length = 0.03, .width = 0.02, .height = 0.008 };

    *w = (helper_fed_belt){ .def = micro_def_default(),
                            .belt = { .velocity = { speed, 0.0 } },
                            .plate = { .n_points = 2, .thickness = 0.005 },
                            .path = { { 0.06, 0.1 }, { 0.09, 0.05 } } };
    for (int k = 0; k < 2; k++)
        w->kinds[k] =
            (micro_kind){ .shape = { .type = SCENE_CYLINDER, .radius = radius, .height = 0.008 },
                          .material = { 210e9, 0.28 },
                          .mass = 0.03,
                          .spin_radius = 0.008 };
    w->kinds[1].shape = helper_micro_solvers[solver].path == MICRO_PATH_PLANAR ? small : box;
    w->plate.path = w->path;
    w->def.domain = (scene_rect){ 0.0, 0.12, 0.0, 0.1 };
    w->def.belts = &w->belt;
    w->def.n_belts = 1;
    w->def.obstacles = &w->plate;
    w->def.kinds = w->kinds;
    w->def.n_kinds = 2;
    w->def.poses = w->poses;
    w->def.n_parts_expected = 8;
    w->def.dt = 0.0;
    w->def.path = helper_micro_solvers[solver].path;
    w->def.integrator = helper_micro_solvers[solver].integrator;
}

micro_solver *helper_fed_belt_start(const helper_fed_belt *w)
{
    return helper_micro_start(&w->def);
}

size_t helper_fed_belt_admit(micro_solver *s, uint32_t kind, double x, double y)
{
    const micro_arrival arrival = { kind, { x, y, 0.0 }, { speed, 0.0 } };
    size_t part = SIZE_MAX;

    assert_int_equal(micro_admit(s, &arrival, &part, NULL), BF_OK);
    return part;
}

bool helper_fed_belt_is_free(micro_solver *s, uint32_t kind, double x, double y, double heading)
{
    bool is_free = false;

    assert_int_equal(micro_is_free(s, kind, (scene_pose){ x, y, heading }, &is_free, NULL), BF_OK);
    return is_free;
}

void helper_fed_belt_run(micro_solver *s, double time)
{
    assert_int_equal(micro_advance(s, (uint64_t)round(time / micro_dt(s)), NULL), BF_OK);
}
