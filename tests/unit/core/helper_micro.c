#include "tests/unit/core/helper_micro.h"

#include "tests/unit/core/helper_world.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>

const helper_micro_solver helper_micro_solvers[HELPER_MICRO_SOLVERS] = {
    { MICRO_PATH_PLANAR, MICRO_VERLET, 2e-5 },
    { MICRO_PATH_PLANAR, MICRO_IMPLICIT, 1e-3 },
    { MICRO_PATH_SPATIAL, MICRO_VERLET, 1e-5 },
    { MICRO_PATH_SPATIAL, MICRO_IMPLICIT, 5e-4 },
};

micro_def helper_micro_def(int solver)
{
    micro_def def = micro_def_default();

    def.path = helper_micro_solvers[solver].path;
    def.integrator = helper_micro_solvers[solver].integrator;
    def.dt = helper_micro_solvers[solver].dt;
    def.damping = 0.0;
    def.modulus_reduction = 1e4;
    return def;
}

micro_solver *helper_micro_start(const micro_def *def)
{
    micro_def own = *def;
    micro_solver *s = NULL;
    bf_error err = { 0 };

    own.world = helper_world_of(def);
    if (micro_create(&own, &s, &err) != BF_OK)
        fail_msg("%s: %s", err.pointer, err.text);
    return s;
}

void helper_micro_advance_to(micro_solver *s, double t)
{
    bf_error err = { 0 };

    if (micro_advance(s, (uint64_t)llround(t / micro_dt(s)) - micro_steps(s), &err) != BF_OK)
        fail_msg("%s: %s", err.pointer, err.text);
}
