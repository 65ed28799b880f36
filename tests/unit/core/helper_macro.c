#include "tests/unit/core/helper_macro.h"

#include "core/base/buffer.h"
#include "core/base/check.h"
#include "core/base/memory.h"
#include "core/macro/closed_lines.h"
#include "core/macro/macro_priv.h"
#include "core/macro/regions.h"
#include "core/scene/density.h"
#include "core/scene/placement.h"
#include "tests/unit/core/helper_scene.h"
#include "tests/unit/core/helper_world.h"
#include "tests/unit/helper_amount.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <string.h>

velocity_field *helper_macro_field(const scene *s)
{
    velocity_field *f = NULL;

    BF_CHECK(velocity_field_create(s, &f, NULL) == BF_OK);
    return f;
}

static bf_world *world_of(const scene *s)
{
    return helper_world(s->n_sections, s->belts, s->n_obstacles, s->obstacles);
}

static macro_def def_of(const scene *s, const bf_world *w, const velocity_field *f)
{
    macro_def def = macro_def_default();

    def.closure = s->macro.closure;
    def.grid = f->grid;
    def.dt = scene_macro_step(s);
    def.scheme = s->macro.scheme;
    def.dispersion = s->macro.closure == SCENE_DISPERSIVE ? s->macro.dispersion : 0.0;
    def.jam_density = s->macro.jam_density;
    def.slip_rate = s->micro.contact[SCENE_CONVEYOR_CARGO].tanh_linear;
    def.friction = s->micro.contact[SCENE_CONVEYOR_CARGO].friction;
    memcpy(def.faces, f->faces, sizeof def.faces);
    def.tracer_portion = s->n_feeds > 0 ? 1.0 : 0.0;
    def.n_belts = f->faces[0].belt != NULL ? s->n_sections : 0;
    def.belts = s->belts;
    def.world = w;
    for (int side = 0; side < SCENE_SIDE_COUNT; side++) {
        def.mirror[side] = scene_mirrors_walls(s) && s->edges[side] == SCENE_EDGE_WALL;
        def.one_way[side] = s->edges[side] != SCENE_EDGE_OUTFLOW;
    }
    return def;
}

macro_def helper_macro_def(const scene *s, const velocity_field *f)
{
    return def_of(s, world_of(s), f);
}

macro_solver *helper_macro_create(const scene *s, int n_threads)
{
    velocity_field *f = helper_macro_field(s);
    macro_solver *solver = NULL;
    macro_def def = helper_macro_def(s, f);

    def.n_threads = n_threads;
    BF_CHECK(macro_create(&def, &solver, NULL) == BF_OK);
    velocity_field_destroy(f);
    return solver;
}

macro_solver *helper_macro_start(const scene *s, int n_threads)
{
    const bf_grid grid = scene_grid(s);
    macro_solver *solver = helper_macro_create(s, n_threads);
    double *rho = memory_alloc(grid_cells(&grid), sizeof *rho);
    scene_placement p = { .n = 0 };

    BF_CHECK(placement_of(s, &p, NULL) == BF_OK);
    BF_CHECK(density_from_parts(&grid, scene_packing_density(s), s->macro.initial_mollifier,
                                p.poses, p.n, rho, NULL) == BF_OK);
    macro_set_density(solver, rho);
    placement_fini(&p);
    memory_free(rho);
    return solver;
}

macro_solver *helper_macro_start_with(const macro_def *def, const double *rho)
{
    macro_solver *solver = NULL;

    BF_CHECK(macro_create(def, &solver, NULL) == BF_OK);
    macro_set_density(solver, rho);
    return solver;
}

void helper_macro_copy(const macro_solver *solver, double *ret_rho)
{
    const bf_grid *g = &solver->def.grid;

    for (size_t j = 0; j < g->n2; j++)
        memcpy(ret_rho + j * g->n1, macro_row(solver, j), g->n1 * sizeof *ret_rho);
}

vec2 helper_macro_velocity_at(const scene *s, vec2 at)
{
    const surroundings around = surroundings_of(s);
    regions_velocity e = regions_begin(&around, surroundings_belt_at(&around, at), at);

    for (size_t k = 0; k < s->n_obstacles; k++) {
        for (size_t m = 0; m + 1 < s->obstacles[k].n_points; m++) {
            regions_segment g = regions_segment_of(s, &around, &s->obstacles[k], m);
            regions_consider(&e, &g, at);
        }
    }
    return e.velocity;
}

static bool crosses_link(void *context, const closed_line *l)
{
    const closed_line *link = context;

    return closed_line_crosses(l, link->start, link->end);
}

bool helper_macro_is_closed(const scene *s, vec2 from, vec2 to)
{
    closed_line link = { from, to };

    return closed_lines_visit(s, crosses_link, &link);
}

void helper_macro_advance(macro_solver *solver, int n_steps)
{
    for (int k = 0; k < n_steps; k++)
        macro_step(solver);
}

uint64_t helper_macro_digest_of_both(macro_solver *first, int n, macro_solver *second, int n_steps)
{
    bf_buffer saved = { 0 };

    helper_macro_advance(first, n);
    BF_CHECK(macro_save(first, &saved, NULL) == BF_OK);
    BF_CHECK(macro_load(second, saved.bytes, saved.n, NULL) == BF_OK);
    buffer_fini(&saved);
    helper_macro_advance(second, n_steps - n);
    return macro_digest(second);
}

double helper_macro_bump(double x1, double x2, double deviation)
{
    return 0.8 * exp(-(x1 * x1 + x2 * x2) / (2.0 * deviation * deviation));
}

static bf_status create_both(const scene *s, const bf_world *w, velocity_field **ret_f,
                             macro_solver **ret_solver)
{
    bf_status status = velocity_field_create(s, ret_f, NULL);

    if (status == BF_OK) {
        const macro_def def = def_of(s, w, *ret_f);
        status = macro_create(&def, ret_solver, NULL);
    }
    return status;
}

void helper_macro_lack_memory(const scene *s)
{
    const bf_world *w = world_of(s);
    bf_status status = BF_ENOMEM;

    for (size_t n = 1; status != BF_OK; n++) {
        velocity_field *f = NULL;
        macro_solver *solver = NULL;
        memory_plan_fault(n, 0);
        status = create_both(s, w, &f, &solver);
        memory_plan_fault(0, 0);
        BF_CHECK(status == BF_OK ? solver != NULL : status == BF_ENOMEM && solver == NULL);
        macro_destroy(solver);
        velocity_field_destroy(f);
    }
}

bool helper_macro_is_same_field(const velocity_field *a, const velocity_field *b)
{
    bool is_same = true;

    for (int axis = 0; axis < 2; axis++) {
        const velocity_field_faces *x = &a->faces[axis], *y = &b->faces[axis];
        const size_t n = grid_faces(&a->grid, axis);
        const struct {
            const void *x, *y;
            size_t n_bytes;
        } arrays[] = {
            { x->v, y->v, n * sizeof *x->v },
            { x->closed, y->closed, n },
            { x->belt, y->belt, n * sizeof *x->belt },
            { x->aperture, y->aperture, n * sizeof *x->aperture },
            { x->transverse, y->transverse, n * sizeof *x->transverse },
            { x->loose, y->loose, n * sizeof *x->loose },
        };
        for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++)
            is_same =
                is_same && (arrays[k].x == NULL) == (arrays[k].y == NULL) &&
                (arrays[k].x == NULL || memcmp(arrays[k].x, arrays[k].y, arrays[k].n_bytes) == 0);
    }
    return is_same;
}

void helper_macro_world_init(helper_macro_world *w, helper_macro_density *density, int n_threads)
{
    helper_scene_resolve(&w->s);
    w->f = helper_macro_field(&w->s);
    macro_def def = helper_macro_def(&w->s, w->f);
    def.off = w->f->off;
    def.n_threads = n_threads;
    w->rho = memory_alloc(grid_cells(&def.grid), sizeof *w->rho);
    for (size_t k = 0; k < grid_cells(&def.grid); k++)
        w->rho[k] = density(&w->s, (vec2){ grid_x1(&def.grid, k % def.grid.n1),
                                           grid_x2(&def.grid, k / def.grid.n1) });
    w->solver = helper_macro_start_with(&def, w->rho);
}

void helper_macro_world_fini(helper_macro_world *w)
{
    macro_destroy(w->solver);
    velocity_field_destroy(w->f);
    memory_free(w->rho);
    scene_fini(&w->s);
}

double helper_macro_jammed_area(const helper_macro_world *w)
{
    const bf_grid *g = &w->f->grid;
    const double jammed = 0.5 * (0.5 + w->s.macro.jam_density);
    double area = 0.0;

    for (size_t j = 0; j < g->n2; j++)
        for (size_t i = 0; i < g->n1; i++)
            area += macro_row(w->solver, j)[i] > jammed ? g->d1 * g->d2 : 0.0;
    return area;
}

double helper_macro_bump_error(const helper_macro_world *w, vec2 place, double deviation)
{
    const bf_grid *g = &w->f->grid;
    double error = 0.0, sum = 0.0;

    for (size_t j = 0; j < g->n2; j++)
        for (size_t i = 0; i < g->n1; i++) {
            const double exact =
                helper_macro_bump(grid_x1(g, i) - place.x, grid_x2(g, j) - place.y, deviation);
            error += fabs(macro_row(w->solver, j)[i] - exact);
            sum += exact;
        }
    return error / sum;
}

static uint64_t digest_of_run(void (*make)(scene *s), helper_macro_density *density, int n_threads,
                              int n_first)
{
    helper_macro_world first, second;

    make(&first.s);
    make(&second.s);
    helper_macro_world_init(&first, density, n_threads);
    helper_macro_world_init(&second, density, n_threads);
    const uint64_t digest = helper_macro_digest_of_both(first.solver, n_first, second.solver, 60);
    helper_macro_world_fini(&second);
    helper_macro_world_fini(&first);
    return digest;
}

void helper_macro_check_resumes(void (*make)(scene *s), helper_macro_density *density)
{
    const uint64_t digest = digest_of_run(make, density, 1, 0);

    for (int n_threads = HELPER_AMOUNT(2, 3); n_threads <= 3; n_threads++)
        assert_true(digest_of_run(make, density, n_threads, 20 * n_threads - 13) == digest);
}
