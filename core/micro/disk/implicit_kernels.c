#include "core/base/simd_compare.h"
#include "core/base/simd_rows.h"
#include "core/micro/disk/implicit_priv.h"
#include "core/micro/friction.h"

// This file is compiled once per instruction set.

static inline lanes size_of(lanes x)
{
    return lanes_max(x, -x);
}

// The first quad of rows that stand anywhere; where one stands twice both must be alike.
static inline void scatter(implicit_body *bodies, const uint32_t *at, const lanes_quad *quad)
{
    _Alignas(64) double rows[LANES * LANES_ROW];

    lanes_quad_store(rows, quad);
    for (int k = 0; k < LANES; k++)
        memcpy(&bodies->vx + at[k], &rows[k * LANES_ROW], 4 * sizeof(double));
}

// LANES contacts of a block and what moves there: vx, vy, spin and give of both ends.
typedef struct ends {
    lanes_quad a, b;
    lanes nx, ny;
} ends;

static inline ends load_ends(const implicit_body *bodies, const implicit_block *block, size_t lane)
{
    return (ends){ lanes_quad_load(&bodies->vx, block->row[0] + lane),
                   lanes_quad_load(&bodies->vx, block->row[1] + lane), lanes_load(block->nx + lane),
                   lanes_load(block->ny + lane) };
}

// Impulses, or what they have changed by, to both ends.
static inline void push(implicit_body *bodies, const implicit_block *block, size_t lane, ends *e,
                        lanes normal, lanes sliding)
{
    lanes x = normal * e->nx - sliding * e->ny, y = normal * e->ny + sliding * e->nx;
    lanes *a = e->a.column, *b = e->b.column;

    a[0] -= x * a[3];
    a[1] -= y * a[3];
    a[2] -= sliding * lanes_load(block->turn[0] + lane);
    b[0] += x * b[3];
    b[1] += y * b[3];
    b[2] -= sliding * lanes_load(block->turn[1] + lane);
    scatter(bodies, block->row[0] + lane, &e->a);
    scatter(bodies, block->row[1] + lane, &e->b);
}

static inline void begin_lanes(implicit_body *bodies, implicit_block *block, size_t lane)
{
    ends e = load_ends(bodies, block, lane);
    lanes lever0 = lanes_load(block->lever[0] + lane), lever1 = lanes_load(block->lever[1] + lane);
    lanes_quad a = lanes_quad_load(&bodies->give_spin, block->row[0] + lane);
    lanes_quad b = lanes_quad_load(&bodies->give_spin, block->row[1] + lane);
    lanes turn0 = lever0 * a.column[0], turn1 = lever1 * b.column[0];

    lanes_store(block->turn[0] + lane, turn0);
    lanes_store(block->turn[1] + lane, turn1);
    lanes_store(block->give_slip + lane,
                e.a.column[3] + e.b.column[3] + lever0 * turn0 + lever1 * turn1);
    push(bodies, block, lane, &e, lanes_load(block->normal + lane),
         lanes_load(block->sliding + lane));
}

static void begin(implicit_body *bodies, implicit_block *blocks, size_t n)
{
    for (size_t k = 0; k < n; k++)
        for (size_t lane = 0; lane < IMPLICIT_WIDTH; lane += LANES)
            begin_lanes(bodies, &blocks[k], lane);
}

// Sliding impulse, with the secant at the present slip.
static inline lanes rub(const implicit_block *block, size_t lane, lanes press, lanes slip)
{
    lanes give = lanes_load(block->give_slip + lane);
    lanes most = press * lanes_load(block->friction + lane), rate = lanes_load(block->rate + lane);
    friction_quotient theta = friction_theta_quick(rate * size_of(slip));
    lanes grip = most * rate * theta.up;
    lanes free_slip = slip - give * lanes_load(block->sliding + lane);

    return lanes_min(lanes_max(-grip * free_slip / (theta.down + grip * give), -most), most);
}

// Each contact is solved for its impulses while all others stay.
static inline void relax_lanes(implicit_body *bodies, implicit_block *block, size_t lane)
{
    ends e = load_ends(bodies, block, lane);
    const lanes *a = e.a.column, *b = e.b.column;
    lanes vx = b[0] - a[0], vy = b[1] - a[1];
    lanes normal = lanes_load(block->normal + lane), sliding = lanes_load(block->sliding + lane);
    lanes parting = vx * e.nx + vy * e.ny - (a[3] + b[3]) * normal;
    lanes slip = vy * e.nx - vx * e.ny - a[2] * lanes_load(block->lever[0] + lane) -
                 b[2] * lanes_load(block->lever[1] + lane);
    lanes new_normal =
        lanes_max(lanes_load(block->bias + lane) - lanes_load(block->gain + lane) * parting,
                  lanes_load(block->floor + lane));
    lanes new_sliding = rub(block, lane, size_of(new_normal), slip);

    push(bodies, block, lane, &e, new_normal - normal, new_sliding - sliding);
    lanes_store(block->normal + lane, new_normal);
    lanes_store(block->sliding + lane, new_sliding);
}

static void relax(implicit_body *bodies, implicit_block *blocks, size_t n)
{
    for (size_t k = 0; k < n; k++)
        for (size_t lane = 0; lane < IMPLICIT_WIDTH; lane += LANES)
            relax_lanes(bodies, &blocks[k], lane);
}

// Belts under LANES parts.
typedef struct ground {
    lanes vx, vy, grip;
} ground;

static inline ground load_ground(const disk_state *s, size_t place)
{
    disk_belt belt = s->plain_belt;
    ground g = { lanes_all(belt.vx), lanes_all(belt.vy), lanes_all(belt.grip) };

    for (size_t k = 0; !s->is_plain && k < LANES; k++) {
        g.vx[k] = s->belt_under[place + k].vx;
        g.vy[k] = s->belt_under[place + k].vy;
        g.grip[k] = s->belt_under[place + k].grip;
    }
    return g;
}

// Velocities of LANES bodies while the belts pull at them: quads of an implicit_body.
static inline void pull_lanes(const disk_state *s, double drag, const ground *g, lanes_quad *low,
                              lanes_quad *high)
{
    lanes *v = low->column, *pulled = high->column + 1;
    lanes ux = v[0] - g->vx, uy = v[1] - g->vy;
    friction_quotient theta =
        friction_theta_quick(s->belt.tanh_linear * lanes_sqrt(ux * ux + uy * uy));
    lanes grip = g->grip * drag * theta.up, ratio = grip / (theta.down + grip);
    lanes pull_x = ratio * (pulled[0] - ux), pull_y = ratio * (pulled[1] - uy);

    v[0] += pull_x - pulled[0];
    v[1] += pull_y - pulled[1];
    pulled[0] = pull_x;
    pulled[1] = pull_y;
}

static inline void number_rows(size_t place, uint32_t *ret_at)
{
    for (size_t k = 0; k < LANES; k++)
        ret_at[k] = (uint32_t)(place + k) * LANES_ROW;
}

static void pull(const disk_state *s, const implicit_step *step, implicit_body *bodies,
                 size_t first, size_t last)
{
    uint32_t at[LANES];

    for (size_t place = first; place < last; place += LANES) {
        ground g = load_ground(s, place);
        number_rows(place, at);
        lanes_quad low = lanes_quad_load(&bodies->vx, at);
        lanes_quad high = lanes_quad_load(&bodies->give_spin, at);
        pull_lanes(s, step->drag, &g, &low, &high);
        lanes_quad_store(&bodies[place].vx, &low);
        lanes_quad_store(&bodies[place].give_spin, &high);
    }
}

// Largest and sum over the parts of a call.
typedef struct greatest {
    lanes speed2, sum;
} greatest;

// Notes LANES speeds, but not those of pads and parts that are gone: these stand far away.
static inline void note_speeds(greatest *all, lanes x, lanes y, lanes vx, lanes vy, lanes spin)
{
    lanes far = lanes_max(size_of(x), size_of(y)), speed2 = vx * vx + vy * vy;
    lanes near_speed2 = lanes_where_less(far, lanes_all(0.5 * DISK_FAR), speed2);

    all->speed2 = lanes_max(near_speed2, all->speed2);
    all->sum += x * 0.0 + y * 0.0 + speed2 + spin * spin;
}

static driver_extremes fold(const greatest *all)
{
    driver_extremes e = { .speed2 = lanes_peak(all->speed2) };

    for (int k = 0; k < LANES; k++)
        e.sum += all->sum[k];
    return e;
}

static lanes load_brakes(const disk_state *s, size_t place)
{
    return s->is_plain ? lanes_all(s->plain_brake) : lanes_load(s->brake + place);
}

static driver_extremes predict(const disk_state *s, const implicit_step *step,
                               implicit_body *bodies, size_t first, size_t last)
{
    const lanes zero = lanes_all(0.0), rate = lanes_all(s->belt.tanh_spin * s->def.dt);
    greatest all = { zero, zero };
    uint32_t at[LANES];

    for (size_t place = first; place < last; place += LANES) {
        ground g = load_ground(s, place);
        number_rows(place, at);
        lanes_quad row = lanes_quad_load(&s->now->x, at), more = lanes_quad_load(&s->now->spin, at);
        lanes *x = row.column, spin = more.column[0], r = more.column[1], give = more.column[3];
        friction_quotient theta = friction_theta_quick(s->belt.tanh_spin * size_of(spin));
        lanes loose = theta.down / (theta.down + rate * g.grip * load_brakes(s, place) * theta.up);
        lanes_quad low = { { step->keep * x[2], step->keep * x[3], s->spin_damping * spin * loose,
                             give } };
        lanes_quad high = { { 2.0 * give / (r * r) * loose, zero, zero, zero } };
        pull_lanes(s, step->drag, &g, &low, &high);
        lanes_quad_store(&bodies[place].vx, &low);
        lanes_quad_store(&bodies[place].give_spin, &high);
        note_speeds(&all, x[0], x[1], x[2], x[3], spin);
        note_speeds(&all, x[0], x[1], low.column[0], low.column[1], low.column[2]);
    }
    return fold(&all);
}

static driver_extremes move(disk_state *s, const implicit_body *bodies, size_t first, size_t last)
{
    const lanes zero = lanes_all(0.0), h = lanes_all(s->def.dt);
    greatest all = { zero, zero };
    uint32_t at[LANES];

    for (size_t place = first; place < last; place += LANES) {
        number_rows(place, at);
        lanes_quad row = lanes_quad_load(&s->now->x, at), low = lanes_quad_load(&bodies->vx, at);
        lanes *x = row.column, *v = low.column;
        x[0] += h * v[0];
        x[1] += h * v[1];
        x[2] = v[0];
        x[3] = v[1];
        lanes_quad_store(&s->now[place].x, &row);
        lanes_column_store(&s->now[place].spin, v[2]);
        lanes_store(s->heading + place, lanes_load(s->heading + place) + h * v[2]);
        note_speeds(&all, x[0], x[1], v[0], v[1], v[2]);
    }
    return fold(&all);
}

extern const implicit_kernels CPU_NAME(implicit_kernels);

const implicit_kernels CPU_NAME(implicit_kernels) = {
    .begin = begin,
    .relax = relax,
    .predict = predict,
    .pull = pull,
    .move = move,
};
