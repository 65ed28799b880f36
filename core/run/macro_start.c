#include "core/run/macro_start.h"

#include "core/base/memory.h"
#include "core/scene/density.h"
#include "core/scene/mix.h"
#include "core/scene/placement.h"
#include "core/scene/surroundings.h"

// The density (18) of those parts whose centres are on a belt, or off every one, in cells that are the same. What
// is beyond the belts' borders is left out, as it is beyond the walls.
static bf_status add_density(const scene *s, const macro_solver *solver, const scene_placement *p,
                             bool is_off, double *rho, bf_error *err)
{
    const surroundings around = surroundings_of(s);
    const bf_grid grid = scene_grid(s);
    scene_pose *poses = memory_alloc(p->n, sizeof *poses);
    double *of_poses = memory_alloc(grid_cells(&grid), sizeof *of_poses);
    bf_status status = BF_OK;
    size_t n = 0;

    if (poses == NULL || of_poses == NULL)
        status = bf_fail(err, BF_ENOMEM, "", "no memory for the density of %zu parts", p->n);
    for (size_t k = 0; status == BF_OK && k < p->n; k++) {
        const vec2 at = { p->poses[k].x, p->poses[k].y };
        if (surroundings_falls(&around, surroundings_belt_at(&around, at)) == is_off)
            poses[n++] = p->poses[k];
    }
    if (status == BF_OK)
        status = density_from_parts(&grid, scene_packing_density(s), s->macro.initial_mollifier,
                                    poses, n, of_poses, err);
    for (size_t c = 0; status == BF_OK && c < grid_cells(&grid); c++)
        if (macro_is_off(solver, c) == is_off)
            rho[c] = of_poses[c];
    memory_free(poses);
    memory_free(of_poses);
    return status;
}

// Sets the kinds of the parts at the start, by the density (18) of those of each kind.
static bf_status place_kinds(const scene *s, macro_solver *solver, const scene_placement *p,
                             bf_error *err)
{
    const bf_grid grid = scene_grid(s);
    const size_t n_cells = grid_cells(&grid), n = s->n_cargo;
    double *of_kind = memory_alloc(n_cells, sizeof *of_kind);
    double *fractions = memory_alloc(n_cells * n, sizeof *fractions);
    scene_pose *poses = memory_alloc(p->n, sizeof *poses);
    bf_status status = BF_OK;

    if (of_kind == NULL || fractions == NULL || poses == NULL)
        status = bf_fail(err, BF_ENOMEM, "/macro/cell_m", "no memory for %zu cells", n_cells);
    for (size_t kind = 0; status == BF_OK && kind < n; kind++) {
        size_t n_poses = 0;
        for (size_t k = 0; k < p->n; k++)
            if (mix_kind(p->kinds, k) == kind)
                poses[n_poses++] = p->poses[k];
        status = density_from_parts(&grid, scene_packing_density(s), s->macro.initial_mollifier,
                                    poses, n_poses, of_kind, err);
        for (size_t c = 0; status == BF_OK && c < n_cells; c++)
            fractions[c * n + kind] = of_kind[c];
    }
    for (size_t c = 0; status == BF_OK && c < n_cells; c++) {
        double sum = 0.0;
        for (size_t k = 0; k < n; k++)
            sum += fractions[c * n + k];
        for (size_t k = 0; sum > 0.0 && k < n; k++)
            fractions[c * n + k] /= sum;
        if (sum > 0.0)
            macro_set_fractions(solver, c, fractions + c * n);
    }
    memory_free(of_kind);
    memory_free(fractions);
    memory_free(poses);
    return status;
}

bf_status macro_start(const scene *s, macro_solver *solver, uint64_t *ret_n_parts, bf_error *err)
{
    const bf_grid grid = scene_grid(s);
    const size_t n_cells = grid_cells(&grid);
    double *rho = memory_alloc(n_cells, sizeof *rho);
    scene_placement p = { .n = 0 };
    bf_status status;

    if (rho == NULL)
        return bf_fail(err, BF_ENOMEM, "/macro/cell_m", "no memory for %zu cells", n_cells);
    status = placement_of(s, &p, err);
    if (status == BF_OK && !s->may_drop)
        status = density_from_parts(&grid, scene_packing_density(s), s->macro.initial_mollifier,
                                    p.poses, p.n, rho, err);
    for (int is_off = 0; s->may_drop && is_off < 2 && status == BF_OK; is_off++)
        status = add_density(s, solver, &p, is_off, rho, err);
    if (status == BF_OK)
        macro_set_density(solver, rho);
    if (status == BF_OK && scene_tells_kinds(s) && p.n > 0)
        status = place_kinds(s, solver, &p, err);
    if (status == BF_OK)
        *ret_n_parts = p.n;
    placement_fini(&p);
    memory_free(rho);
    return status;
}
