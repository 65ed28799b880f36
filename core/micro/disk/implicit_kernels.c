#include "core/base/simd_compare.h"
#include "core/base/simd_rows.h"
#include "core/micro/disk/implicit.h"
#include "core/micro/friction.h"

// This file is compiled once per instruction set.

static inline simd size_of(simd x)
{
    return simd_max(x, -x);
}

// SIMD_LANES contacts: both bodies (vx, vy, spin, inv_inertia), the normal, the levers from the centres to the contact
// and the changes of both spins by a unit sliding impulse, 1/(kg m).
typedef struct ends {
    simd_quad a, b;
    simd nx, ny, overlap;
    simd lever[2], inv_mass[2], turn[2];
} ends;

static inline ends load_ends(const solver_body *bodies, const implicit_block *block,
                             const implicit_contacts *contacts, const implicit_law *law,
                             size_t lane)
{
    ends e = { .a = simd_quad_load(&bodies->vx, block->row[0] + lane),
               .b = simd_quad_load(&bodies->vx, block->row[1] + lane),
               .nx = simd_load(contacts->nx + lane),
               .ny = simd_load(contacts->ny + lane),
               .overlap = simd_load(contacts->overlap + lane),
               .inv_mass = { simd_load(law->inv_mass[0] + lane),
                             simd_load(law->inv_mass[1] + lane) } };
    const simd half = 0.5 * e.overlap;

    e.lever[0] = simd_load(law->radius[0] + lane) - half;
    e.lever[1] = simd_load(law->radius[1] + lane) - half;
    e.turn[0] = e.lever[0] * e.a.column[3];
    e.turn[1] = e.lever[1] * e.b.column[3];
    return e;
}

// Apply impulses, or their changes, to both ends.
static inline void apply_impulse(solver_body *bodies, const implicit_block *block, size_t lane,
                                 ends *e, simd normal, simd sliding)
{
    simd x = normal * e->nx - sliding * e->ny, y = normal * e->ny + sliding * e->nx;
    simd *a = e->a.column, *b = e->b.column;

    a[0] -= x * e->inv_mass[0];
    a[1] -= y * e->inv_mass[0];
    a[2] -= sliding * e->turn[0];
    b[0] += x * e->inv_mass[1];
    b[1] += y * e->inv_mass[1];
    b[2] -= sliding * e->turn[1];
    simd_quad_scatter(&bodies->vx, block->row[0] + lane, &e->a);
    simd_quad_scatter(&bodies->vx, block->row[1] + lane, &e->b);
}

// Where parts of SIMD_LANES pairs are in the table of parts, and bits of those among the live ones. Parts that left before
// the list was made stand behind these.
static inline unsigned find_rows(const disk_state *s, const uint32_t *body, uint32_t *ret_at)
{
    unsigned live = 0;

    for (size_t k = 0; k < SIMD_LANES; k++) {
        const uint32_t slot = body[k] / SIMD_QUAD;
        const bool is_live = slot < s->n_live;
        ret_at[k] = (is_live ? slot : s->void_slot) * DISK_DOUBLES;
        live |= (is_live ? 1U : 0U) << k;
    }
    return live;
}

static inline simd load_radii(const disk_state *s, const uint32_t *at)
{
    simd radius = simd_all(s->kinds[0].part.radius);

    for (size_t k = 0; s->n_kinds > 1 && k < SIMD_LANES; k++)
        radius[k] = (&s->now->radius)[at[k]];
    return radius;
}

static inline unsigned find_lanes(const disk_state *s, const implicit_block *block, double margin,
                                  size_t lane, implicit_contacts *ret)
{
    const simd zero = simd_all(0.0);
    uint32_t a_at[SIMD_LANES], b_at[SIMD_LANES];

    unsigned live = find_rows(s, block->row[0] + lane, a_at);
    live &= find_rows(s, block->row[1] + lane, b_at);
    const simd_quad a = simd_quad_load(&s->now->x, a_at), b = simd_quad_load(&s->now->x, b_at);
    const simd dx = b.column[0] - a.column[0], dy = b.column[1] - a.column[1];
    const simd touching = load_radii(s, a_at) + load_radii(s, b_at), range = touching + margin;
    const simd square = dx * dx + dy * dy, distance = simd_sqrt(square), inverse = 1.0 / distance;
    const simd together = simd_all(1.0) - simd_where_less(zero, distance, simd_all(1.0));

    simd_store(ret->nx + lane, simd_where_less(zero, distance, dx * inverse) + together);
    simd_store(ret->ny + lane, simd_where_less(zero, distance, dy * inverse));
    simd_store(ret->overlap + lane, touching - distance);
    return simd_less(square, range * range) & live;
}

static unsigned find_contacts(const disk_state *s, const implicit_block *block, double margin,
                              implicit_contacts *ret)
{
    unsigned near = 0;

    for (size_t lane = 0; lane < IMPLICIT_WIDTH; lane += SIMD_LANES)
        near |= find_lanes(s, block, margin, lane, ret) << lane;
    return near;
}

static inline const implicit_law *law_of(const implicit_blocks *blocks, size_t k)
{
    return &blocks->laws[blocks->is_one_law ? 0 : k];
}

static void warm_start(solver_body *bodies, const implicit_blocks *blocks)
{
    for (size_t k = 0; k < blocks->n; k++) {
        const implicit_block *block = &blocks->pairs[k];
        for (size_t lane = 0; lane < IMPLICIT_WIDTH; lane += SIMD_LANES) {
            ends e = load_ends(bodies, block, &blocks->contacts[k], law_of(blocks, k), lane);
            apply_impulse(bodies, block, lane, &e, simd_load(block->normal + lane),
                          simd_load(block->sliding + lane));
        }
    }
}

// Normal impulse, with the present speed at which the bodies part without it, and beyond it from the former one by the
// share `excess` of the change.
static inline simd normal_impulse(const ends *e, const implicit_law *law, size_t lane, simd parting,
                                  simd former, double excess)
{
    simd bias = (simd_load(law->joint + lane) * e->overlap -
                 simd_load(law->damping + lane) * simd_positive(e->overlap)) *
                simd_load(law->scale + lane);
    simd alone = bias - simd_load(law->gain + lane) * parting;

    return simd_max(alone + excess * (alone - former), simd_load(law->lower_bound + lane));
}

// Sliding impulse, with the secant at the present slip.
static inline simd friction_impulse(const ends *e, const implicit_law *law, size_t lane,
                                    simd normal, simd sliding, simd slip)
{
    simd inv_mass =
        e->inv_mass[0] + e->inv_mass[1] + e->lever[0] * e->turn[0] + e->lever[1] * e->turn[1];
    simd most = normal * simd_load(law->friction + lane), rate = simd_load(law->rate + lane);
    friction_quotient theta = friction_theta_quick(rate * size_of(slip));
    simd secant = most * rate * theta.up;
    simd free_slip = slip - inv_mass * sliding;

    return simd_min(simd_max(-secant * free_slip / (theta.down + secant * inv_mass), -most), most);
}

// Each contact is solved for its impulses while all others are fixed, normal ones with over-relaxation. Inlined, or a call costs a tenth of it.
static inline __attribute__((always_inline)) void solve_lanes(solver_body *bodies,
                                                              implicit_block *block,
                                                              const implicit_contacts *contacts,
                                                              const implicit_law *law, size_t lane,
                                                              double excess)
{
    ends e = load_ends(bodies, block, contacts, law, lane);
    const simd *a = e.a.column, *b = e.b.column;
    simd vx = b[0] - a[0], vy = b[1] - a[1];
    simd normal = simd_load(block->normal + lane), sliding = simd_load(block->sliding + lane);
    simd parting = vx * e.nx + vy * e.ny - (e.inv_mass[0] + e.inv_mass[1]) * normal;
    simd slip = vy * e.nx - vx * e.ny - a[2] * e.lever[0] - b[2] * e.lever[1];
    simd new_normal = normal_impulse(&e, law, lane, parting, normal, excess);
    simd new_sliding = friction_impulse(&e, law, lane, size_of(new_normal), sliding, slip);

    apply_impulse(bodies, block, lane, &e, new_normal - normal, new_sliding - sliding);
    simd_store(block->normal + lane, new_normal);
    simd_store(block->sliding + lane, new_sliding);
}

static void solve(solver_body *bodies, const implicit_blocks *blocks)
{
    const double excess = blocks->excess;

    for (size_t k = 0; k < blocks->n; k++)
        for (size_t lane = 0; lane < IMPLICIT_WIDTH; lane += SIMD_LANES)
            solve_lanes(bodies, &blocks->pairs[k], &blocks->contacts[k], law_of(blocks, k), lane,
                        excess);
}

// Belts under SIMD_LANES parts, in the middle of their ways in the step: a velocity at its beginning would lead a part off the
// circle of a belt that turns.
typedef struct belt_lanes {
    simd vx, vy, turn, friction_ratio;
    simd pull_x, pull_y; // 0 where no belt is a slope
} belt_lanes;

static inline belt_lanes load_belts(const disk_state *s, const disk_belt *belts, size_t slot)
{
    const disk_belt uniform = belts[s->uniform_belt];
    belt_lanes g = { simd_all(uniform.vx), simd_all(uniform.vy),
                     simd_all(0.0),        simd_all(uniform.friction_ratio),
                     simd_all(0.0),        simd_all(0.0) };

    for (size_t k = 0; !s->is_uniform && k < SIMD_LANES; k++) {
        const disk_belt *belt = &belts[s->belt_under[slot + k]];
        g.vx[k] = belt->vx;
        g.vy[k] = belt->vy;
        g.friction_ratio[k] = belt->friction_ratio;
        g.pull_x[k] = belt->pull.x;
        g.pull_y[k] = belt->pull.y;
        if (!s->has_turning)
            continue;
        const disk *part = &s->now[slot + k];
        g.vx[k] -= belt->turn * (part->y + 0.5 * s->def.dt * part->vy);
        g.vy[k] += belt->turn * (part->x + 0.5 * s->def.dt * part->vx);
        g.turn[k] = belt->turn;
    }
    return g;
}

// Velocities v of SIMD_LANES bodies with the friction of the belts; dvx and dvy are its changes of them.
static inline void belt_friction_lanes(const disk_state *s, double belt_secant, const belt_lanes *g,
                                       simd *v, simd *dvx, simd *dvy)
{
    simd ux = v[0] - g->vx, uy = v[1] - g->vy;
    friction_quotient theta =
        friction_theta_quick(s->belt.tanh_linear * simd_sqrt(ux * ux + uy * uy));
    simd secant = g->friction_ratio * belt_secant * theta.up,
         ratio = secant / (theta.down + secant);
    simd new_dvx = ratio * (*dvx - ux), new_dvy = ratio * (*dvy - uy);

    v[0] += new_dvx - *dvx;
    v[1] += new_dvy - *dvy;
    *dvx = new_dvx;
    *dvy = new_dvy;
}

// Rows of consecutive slots in a table whose rows have a length, doubles.
static inline void index_rows(size_t slot, size_t length, uint32_t *ret_at)
{
    for (size_t k = 0; k < SIMD_LANES; k++)
        ret_at[k] = (uint32_t)((slot + k) * length);
}

static void apply_belt_friction(const disk_state *s, const implicit_step *step,
                                const implicit_bodies *bodies, size_t first, size_t last)
{
    uint32_t at[SIMD_LANES];

    for (size_t slot = first; slot < last; slot += SIMD_LANES) {
        belt_lanes g = load_belts(s, step->belts, slot);
        index_rows(slot, SIMD_QUAD, at);
        simd_quad body = simd_quad_load(&bodies->rows->vx, at);
        simd dvx = simd_load(bodies->belt_dvx + slot), dvy = simd_load(bodies->belt_dvy + slot);
        belt_friction_lanes(s, step->belt_secant, &g, body.column, &dvx, &dvy);
        simd_quad_store(&bodies->rows[slot].vx, SIMD_QUAD, &body);
        simd_store(bodies->belt_dvx + slot, dvx);
        simd_store(bodies->belt_dvy + slot, dvy);
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

static driver_extremes predict(const disk_state *s, const implicit_step *step,
                               const implicit_bodies *bodies, size_t first, size_t last)
{
    const simd zero = simd_all(0.0), rate = simd_all(s->belt.tanh_spin * s->def.dt);
    greatest all = { zero, zero };
    uint32_t at[SIMD_LANES];

    for (size_t slot = first; slot < last; slot += SIMD_LANES) {
        belt_lanes g = load_belts(s, step->belts, slot);
        index_rows(slot, SIMD_ROW, at);
        simd_quad row = simd_quad_load(&s->now->x, at), more = simd_quad_load(&s->now->spin, at);
        simd *x = row.column, spin = more.column[0], r = more.column[1], inv_mass = more.column[3];
        simd damped = s->spin_damping * spin;
        friction_quotient theta = friction_theta_quick(s->belt.tanh_spin * size_of(spin - g.turn));
        simd loose = theta.down / (theta.down + rate * g.friction_ratio *
                                                    load_decelerations(s, slot) * theta.up);
        simd spun = s->has_turning ? g.turn + (damped - g.turn) * loose : damped * loose;
        simd_quad body = { { step->damping_factor * x[2], step->damping_factor * x[3], spun,
                             2.0 * inv_mass / (r * r) * loose } };
        simd dvx = zero, dvy = zero;
        if (s->has_slopes) {
            body.column[0] += s->def.dt * g.pull_x;
            body.column[1] += s->def.dt * g.pull_y;
        }
        belt_friction_lanes(s, step->belt_secant, &g, body.column, &dvx, &dvy);
        simd_quad_store(&bodies->rows[slot].vx, SIMD_QUAD, &body);
        simd_store(bodies->belt_dvx + slot, dvx);
        simd_store(bodies->belt_dvy + slot, dvy);
        note_speeds(&all, x[0], x[1], x[2], x[3], spin);
        note_speeds(&all, x[0], x[1], body.column[0], body.column[1], body.column[2]);
    }
    return fold(&all);
}

static driver_extremes move(disk_state *s, const solver_body *bodies, size_t first, size_t last)
{
    const simd zero = simd_all(0.0), h = simd_all(s->def.dt);
    greatest all = { zero, zero };
    uint32_t at[SIMD_LANES], body_at[SIMD_LANES];

    for (size_t slot = first; slot < last; slot += SIMD_LANES) {
        index_rows(slot, SIMD_ROW, at);
        index_rows(slot, SIMD_QUAD, body_at);
        simd_quad row = simd_quad_load(&s->now->x, at), body = simd_quad_load(&bodies->vx, body_at);
        simd *x = row.column, *v = body.column;
        x[0] += h * v[0];
        x[1] += h * v[1];
        x[2] = v[0];
        x[3] = v[1];
        simd_quad_store(&s->now[slot].x, SIMD_ROW, &row);
        simd_column_store(&s->now[slot].spin, v[2]);
        simd_store(s->heading + slot, simd_load(s->heading + slot) + h * v[2]);
        note_speeds(&all, x[0], x[1], v[0], v[1], v[2]);
    }
    return fold(&all);
}

extern const implicit_kernels CPU_NAME(implicit_kernels);

const implicit_kernels CPU_NAME(implicit_kernels) = {
    .find_contacts = find_contacts,
    .warm_start = warm_start,
    .solve = solve,
    .predict = predict,
    .apply_belt_friction = apply_belt_friction,
    .move = move,
};
