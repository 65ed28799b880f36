#include "tests/unit/core/helper_congested.h"

#include "core/base/check.h"
#include "core/base/memory.h"
#include "tests/unit/core/helper_scene.h"

void helper_congested_fill(const scene *s, scene_rect where, double density, macro_solver *solver)
{
    const bf_grid g = scene_grid(s);
    double *rho = memory_alloc(grid_cells(&g), sizeof *rho);

    BF_CHECK(rho != NULL);
    for (size_t j = 0; j < g.n2; j++)
        for (size_t i = 0; i < g.n1; i++)
            if (grid_x1(&g, i) > where.x_min && grid_x1(&g, i) < where.x_max &&
                grid_x2(&g, j) > where.y_min && grid_x2(&g, j) < where.y_max)
                rho[j * g.n1 + i] = density;
    macro_set_density(solver, rho);
    memory_free(rho);
}

void helper_congested_example(scene *s, double angle_deg)
{
    helper_scene_example(s, angle_deg, SCENE_WALL);
    s->macro.closure = SCENE_CONGESTED;
    s->macro.step = 0.0;
    s->macro.cell = 0.01;
}

void helper_congested_saturated(scene *s, double angle_deg)
{
    helper_congested_example(s, angle_deg);
    s->domain.x_min = -0.7;
    s->initial.n_columns = 40;
    s->initial.first.x = -0.6;
}
