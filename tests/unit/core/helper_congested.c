#include "tests/unit/core/helper_congested.h"

#include "core/base/check.h"
#include "core/base/memory.h"
#include "core/scene/density.h"
#include "core/scene/placement.h"
#include "tests/unit/core/helper_scene.h"

macro_def helper_congested_def(const scene *s, const velocity_field *f)
{
    macro_def def = macro_def_default();

    def.closure = SCENE_CONGESTED;
    def.grid = f->grid;
    def.dt = scene_macro_step(s);
    def.scheme = s->macro.scheme;
    def.dispersion = 0.0;
    def.jam_density = s->macro.jam_density;
    def.slip_rate = s->micro.contact[SCENE_CONVEYOR_CARGO].tanh_linear;
    def.v1 = f->v1;
    def.v2 = f->v2;
    def.closed1 = f->closed1;
    def.closed2 = f->closed2;
    def.n_belts = s->n_belts;
    def.belts = s->belts;
    def.belt1 = f->belt1;
    def.belt2 = f->belt2;
    def.aperture1 = f->aperture1;
    def.aperture2 = f->aperture2;
    def.transverse1 = f->transverse1;
    def.transverse2 = f->transverse2;
    for (int side = 0; side < SCENE_SIDE_COUNT; side++)
        def.one_way[side] = s->edges[side] != SCENE_EDGE_OUTFLOW;
    return def;
}

macro_solver *helper_congested_create(const scene *s, int n_threads)
{
    velocity_field *f = NULL;
    macro_solver *solver = NULL;

    BF_CHECK(velocity_field_create(s, &f, NULL) == BF_OK);
    macro_def def = helper_congested_def(s, f);
    def.n_threads = n_threads;
    BF_CHECK(macro_create(&def, &solver, NULL) == BF_OK);
    velocity_field_destroy(f);
    return solver;
}

macro_solver *helper_congested_start(const scene *s, int n_threads)
{
    const bf_grid grid = scene_grid(s);
    macro_solver *solver = helper_congested_create(s, n_threads);
    double *rho = memory_alloc(grid_cells(&grid), sizeof *rho);
    scene_placement p = { .n = 0 };

    BF_CHECK(placement_of(s, &p, NULL) == BF_OK);
    BF_CHECK(density_from_parts(&grid, scene_packing_density(s), s->macro.initial_mollifier,
                                p.poses, p.n, rho, NULL) == BF_OK);
    BF_CHECK(macro_set_density(solver, rho, grid_cells(&grid), NULL) == BF_OK);
    placement_fini(&p);
    memory_free(rho);
    return solver;
}

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
    BF_CHECK(macro_set_density(solver, rho, grid_cells(&g), NULL) == BF_OK);
    memory_free(rho);
}

void helper_congested_advance(macro_solver *solver, int n_steps)
{
    for (int k = 0; k < n_steps; k++)
        macro_step(solver);
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
