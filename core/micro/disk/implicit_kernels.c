#include "core/base/simd_compare.h"
#include "core/base/simd_rows.h"
#include "core/micro/disk/implicit.h"
#include "core/micro/friction.h"

// This file is compiled once per instruction set.

static inline simd size_of(simd x)
{
    return simd_max(x, -x);
}

// The first quad of rows at arbitrary places; a row that occurs twice must have the same values.
static inline void scatter(solver_body *bodies, const uint32_t *at, const simd_quad *quad)
{
    _Alignas(64) double rows[SIMD_LANES * SIMD_ROW];

    simd_quad_store(rows, quad);
    for (int k = 0; k < SIMD_LANES; k++)
        memcpy(&bodies->vx + at[k], &rows[k * SIMD_ROW], 4 * sizeof(double));
}

// SIMD_LANES contacts of a block and the motion of both ends: vx, vy, spin and inv_mass of both ends.
typedef struct ends {
    simd_quad a, b;
    simd nx, ny;
} ends;

static inline ends load_ends(const solver_body *bodies, const implicit_block *block, size_t lane)
{
    return (ends){ simd_quad_load(&bodies->vx, block->row[0] + lane),
                   simd_quad_load(&bodies->vx, block->row[1] + lane), simd_load(block->nx + lane),
                   simd_load(block->ny + lane) };
}

// Apply impulses, or their changes, to both ends.
static inline void apply_impulse(solver_body *bodies, const implicit_block *block, size_t lane,
                                 ends *e, simd normal, simd sliding)
{
    simd x = normal * e->nx - sliding * e->ny, y = normal * e->ny + sliding * e->nx;
    simd *a = e->a.column, *b = e->b.column;

    a[0] -= x * a[3];
    a[1] -= y * a[3];
    a[2] -= sliding * simd_load(block->spin_change[0] + lane);
    b[0] += x * b[3];
    b[1] += y * b[3];
    b[2] -= sliding * simd_load(block->spin_change[1] + lane);
    scatter(bodies, block->row[0] + lane, &e->a);
    scatter(bodies, block->row[1] + lane, &e->b);
}

static inline void warm_start_lanes(solver_body *bodies, implicit_block *block, size_t lane)
{
    ends e = load_ends(bodies, block, lane);
    simd lever0 = simd_load(block->lever[0] + lane), lever1 = simd_load(block->lever[1] + lane);
    simd_quad a = simd_quad_load(&bodies->inv_inertia, block->row[0] + lane);
    simd_quad b = simd_quad_load(&bodies->inv_inertia, block->row[1] + lane);
    simd turn0 = lever0 * a.column[0], turn1 = lever1 * b.column[0];

    simd_store(block->spin_change[0] + lane, turn0);
    simd_store(block->spin_change[1] + lane, turn1);
    simd_store(block->inv_slip_mass + lane,
               e.a.column[3] + e.b.column[3] + lever0 * turn0 + lever1 * turn1);
    apply_impulse(bodies, block, lane, &e, simd_load(block->normal + lane),
                  simd_load(block->sliding + lane));
}

static void warm_start(solver_body *bodies, implicit_block *blocks, size_t n)
{
    for (size_t k = 0; k < n; k++)
        for (size_t lane = 0; lane < IMPLICIT_WIDTH; lane += SIMD_LANES)
            warm_start_lanes(bodies, &blocks[k], lane);
}

// Sliding impulse, with the secant at the present slip.
static inline simd friction_impulse(const implicit_block *block, size_t lane, simd normal,
                                    simd slip)
{
    simd inv_mass = simd_load(block->inv_slip_mass + lane);
    simd most = normal * simd_load(block->friction + lane), rate = simd_load(block->rate + lane);
    friction_quotient theta = friction_theta_quick(rate * size_of(slip));
    simd secant = most * rate * theta.up;
    simd free_slip = slip - inv_mass * simd_load(block->sliding + lane);

    return simd_min(simd_max(-secant * free_slip / (theta.down + secant * inv_mass), -most), most);
}

// Each contact is solved for its impulses while all others are fixed.
static inline void solve_lanes(solver_body *bodies, implicit_block *block, size_t lane)
{
    ends e = load_ends(bodies, block, lane);
    const simd *a = e.a.column, *b = e.b.column;
    simd vx = b[0] - a[0], vy = b[1] - a[1];
    simd normal = simd_load(block->normal + lane), sliding = simd_load(block->sliding + lane);
    simd parting = vx * e.nx + vy * e.ny - (a[3] + b[3]) * normal;
    simd slip = vy * e.nx - vx * e.ny - a[2] * simd_load(block->lever[0] + lane) -
                b[2] * simd_load(block->lever[1] + lane);
    simd new_normal =
        simd_max(simd_load(block->bias + lane) - simd_load(block->gain + lane) * parting,
                 simd_load(block->lower_bound + lane));
    simd new_sliding = friction_impulse(block, lane, size_of(new_normal), slip);

    apply_impulse(bodies, block, lane, &e, new_normal - normal, new_sliding - sliding);
    simd_store(block->normal + lane, new_normal);
    simd_store(block->sliding + lane, new_sliding);
}

static void solve(solver_body *bodies, implicit_block *blocks, size_t n)
{
    for (size_t k = 0; k < n; k++)
        for (size_t lane = 0; lane < IMPLICIT_WIDTH; lane += SIMD_LANES)
            solve_lanes(bodies, &blocks[k], lane);
}

// Belts under SIMD_LANES parts.
typedef struct belt_lanes {
    simd vx, vy, on_belt;
} belt_lanes;

static inline belt_lanes load_belts(const disk_state *s, const disk_belt *belts, size_t slot)
{
    const disk_belt uniform = belts[s->uniform_belt];
    belt_lanes g = { simd_all(uniform.vx), simd_all(uniform.vy), simd_all(uniform.on_belt) };

    for (size_t k = 0; !s->is_uniform && k < SIMD_LANES; k++) {
        const disk_belt *belt = &belts[s->belt_under[slot + k]];
        g.vx[k] = belt->vx;
        g.vy[k] = belt->vy;
        g.on_belt[k] = belt->on_belt;
    }
    return g;
}

// Velocities of SIMD_LANES bodies with the friction of the belts: quads of a solver_body.
static inline void belt_friction_lanes(const disk_state *s, double belt_secant, const belt_lanes *g,
                                       simd_quad *low, simd_quad *high)
{
    simd *v = low->column, *belt_dv = high->column + 1;
    simd ux = v[0] - g->vx, uy = v[1] - g->vy;
    friction_quotient theta =
        friction_theta_quick(s->belt.tanh_linear * simd_sqrt(ux * ux + uy * uy));
    simd secant = g->on_belt * belt_secant * theta.up, ratio = secant / (theta.down + secant);
    simd belt_dvx = ratio * (belt_dv[0] - ux), belt_dvy = ratio * (belt_dv[1] - uy);

    v[0] += belt_dvx - belt_dv[0];
    v[1] += belt_dvy - belt_dv[1];
    belt_dv[0] = belt_dvx;
    belt_dv[1] = belt_dvy;
}

static inline void index_rows(size_t slot, uint32_t *ret_at)
{
    for (size_t k = 0; k < SIMD_LANES; k++)
        ret_at[k] = (uint32_t)(slot + k) * SIMD_ROW;
}

static void apply_belt_friction(const disk_state *s, const implicit_step *step, solver_body *bodies,
                                size_t first, size_t last)
{
    uint32_t at[SIMD_LANES];

    for (size_t slot = first; slot < last; slot += SIMD_LANES) {
        belt_lanes g = load_belts(s, step->belts, slot);
        index_rows(slot, at);
        simd_quad low = simd_quad_load(&bodies->vx, at);
        simd_quad high = simd_quad_load(&bodies->inv_inertia, at);
        belt_friction_lanes(s, step->belt_secant, &g, &low, &high);
        simd_quad_store(&bodies[slot].vx, &low);
        simd_quad_store(&bodies[slot].inv_inertia, &high);
    }
}

// Largest and sum over the parts of a call.
typedef struct greatest {
    simd speed2, sum;
} greatest;

// Records SIMD_LANES speeds, except those of padding and of parts that have left: these are far away.
static inline void note_speeds(greatest *all, simd x, simd y, simd vx, simd vy, simd spin)
{
    simd far = simd_max(size_of(x), size_of(y)), speed2 = vx * vx + vy * vy;
    simd near_speed2 = simd_where_less(far, simd_all(0.5 * DISK_FAR), speed2);

    all->speed2 = simd_max(near_speed2, all->speed2);
    all->sum += x * 0.0 + y * 0.0 + speed2 + spin * spin;
}

static driver_extremes fold(const greatest *all)
{
    driver_extremes e = { .speed2 = simd_peak(all->speed2) };

    for (int k = 0; k < SIMD_LANES; k++)
        e.sum += all->sum[k];
    return e;
}

static simd load_decelerations(const disk_state *s, size_t slot)
{
    return s->is_uniform ? simd_all(s->uniform_deceleration)
                         : simd_load(s->spin_deceleration + slot);
}

static driver_extremes predict(const disk_state *s, const implicit_step *step, solver_body *bodies,
                               size_t first, size_t last)
{
    const simd zero = simd_all(0.0), rate = simd_all(s->belt.tanh_spin * s->def.dt);
    greatest all = { zero, zero };
    uint32_t at[SIMD_LANES];

    for (size_t slot = first; slot < last; slot += SIMD_LANES) {
        belt_lanes g = load_belts(s, step->belts, slot);
        index_rows(slot, at);
        simd_quad row = simd_quad_load(&s->now->x, at), more = simd_quad_load(&s->now->spin, at);
        simd *x = row.column, spin = more.column[0], r = more.column[1], inv_mass = more.column[3];
        friction_quotient theta = friction_theta_quick(s->belt.tanh_spin * size_of(spin));
        simd loose =
            theta.down / (theta.down + rate * g.on_belt * load_decelerations(s, slot) * theta.up);
        simd_quad low = { { step->damping_factor * x[2], step->damping_factor * x[3],
                            s->spin_damping * spin * loose, inv_mass } };
        simd_quad high = { { 2.0 * inv_mass / (r * r) * loose, zero, zero, zero } };
        belt_friction_lanes(s, step->belt_secant, &g, &low, &high);
        simd_quad_store(&bodies[slot].vx, &low);
        simd_quad_store(&bodies[slot].inv_inertia, &high);
        note_speeds(&all, x[0], x[1], x[2], x[3], spin);
        note_speeds(&all, x[0], x[1], low.column[0], low.column[1], low.column[2]);
    }
    return fold(&all);
}

static driver_extremes move(disk_state *s, const solver_body *bodies, size_t first, size_t last)
{
    const simd zero = simd_all(0.0), h = simd_all(s->def.dt);
    greatest all = { zero, zero };
    uint32_t at[SIMD_LANES];

    for (size_t slot = first; slot < last; slot += SIMD_LANES) {
        index_rows(slot, at);
        simd_quad row = simd_quad_load(&s->now->x, at), low = simd_quad_load(&bodies->vx, at);
        simd *x = row.column, *v = low.column;
        x[0] += h * v[0];
        x[1] += h * v[1];
        x[2] = v[0];
        x[3] = v[1];
        simd_quad_store(&s->now[slot].x, &row);
        simd_column_store(&s->now[slot].spin, v[2]);
        simd_store(s->heading + slot, simd_load(s->heading + slot) + h * v[2]);
        note_speeds(&all, x[0], x[1], v[0], v[1], v[2]);
    }
    return fold(&all);
}

extern const implicit_kernels CPU_NAME(implicit_kernels);

const implicit_kernels CPU_NAME(implicit_kernels) = {
    .warm_start = warm_start,
    .solve = solve,
    .predict = predict,
    .apply_belt_friction = apply_belt_friction,
    .move = move,
};
