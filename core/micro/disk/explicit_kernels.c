// Explicit steps block by block: the forces of its pairs, their sums over the contacts of each part, and its motion.
// This file is compiled once per instruction set.

#include "core/micro/disk/explicit_lanes.h"

enum { CONTACTS_AT_ONCE = 16 };

static void tanh_of(size_t n, const double *x, double *ret_y)
{
    for (size_t k = 0; k < n; k += SIMD_LANES) {
        friction_quotient t = friction_tanh(simd_load_any(x + k) * 0.125);
        simd y = t.up / t.down;
        memcpy(ret_y + k, &y, sizeof y);
    }
}

// Pairs of which some overlap, their contacts, and where the forces go.
typedef struct pair_contact {
    simd dx, dy, dvx, dvy; // how the second part differs from the first
    simd distance2, distance;
    simd spins;      // sum, if uniform
    simd_quad own;   // spin, radius, compliance; if not uniform
    simd_quad other; // same
    contact contact;
    simd other_lever; // of the second part
    friction_quotient tanh;
    double *forces;
} pair_contact;

INLINED simd contact_distance_of(const pair_law *law, const pair_contact *c, bool uniform)
{
    return uniform ? law->contact_distance : c->own.column[1] + c->other.column[1];
}

// Loads pairs; false, with forces cleared, if none of them overlaps.
INLINED bool find_overlap(const pair_law *law, const disk *rows, const uint32_t *own,
                          const uint32_t *other, bool uniform, pair_contact *c)
{
    const simd_quad d = simd_quad_difference(&rows->x, other, own);
    const simd distance2 = d.column[0] * d.column[0] + d.column[1] * d.column[1];

    c->dx = d.column[0];
    c->dy = d.column[1];
    c->dvx = d.column[2];
    c->dvy = d.column[3];
    if (uniform) {
        c->spins = simd_quad_sum(&rows->spin, own, other).column[0];
    } else {
        c->own = simd_quad_load(&rows->spin, own);
        c->other = simd_quad_load(&rows->spin, other);
    }
    c->distance2 = distance2;
    c->distance = simd_sqrt(distance2);
    const simd range = contact_distance_of(law, c, uniform);
    if (simd_less(distance2, range * range) != 0)
        return true;
    for (size_t k = 0; k < DISK_PAIR_DOUBLES; k++)
        simd_store(c->forces + k * SIMD_LANES, simd_all(0.0));
    return false;
}

INLINED void find_contact(const pair_law *law, bool uniform, pair_contact *p, overlaps *all)
{
    const simd *own = p->own.column, *other = p->other.column; // spin, radius, compliance
    const simd range = contact_distance_of(law, p, uniform), distance = p->distance;
    simd inverse = 1.0 / distance, overlap = range - distance, rolling, stiffness = law->stiffness;
    contact *c = &p->contact;

    c->nx = p->dx * inverse;
    c->ny = p->dy * inverse;
    all->overlap = simd_max(overlap, all->overlap);
    if (uniform) {
        c->lever = p->other_lever = 0.5 * distance;
        rolling = p->spins * c->lever;
    } else {
        simd excess = own[1] - other[1];
        stiffness = law->line / (own[2] + other[2]);
        c->lever = 0.5 * (distance + excess);
        p->other_lever = 0.5 * (distance - excess);
        rolling = own[0] * c->lever + other[0] * p->other_lever;
        all->ratio = simd_max(overlap / simd_min(own[1], other[1]), all->ratio);
    }
    c->force = normal_force(law, stiffness, overlap, p->dvx * c->nx + p->dvy * c->ny, p->distance2,
                            range * range);
    c->sliding = law->rate * (p->dvx * c->ny - p->dvy * c->nx + rolling);
}

// Leaves the forces on the parts: x, y, torque, and the torque on the other part.
INLINED void store_forces(const pair_contact *c, const contact_force *f)
{
    const simd_quad on_own = { { f->x, f->y, -(f->friction * c->contact.lever),
                                 -(f->friction * c->other_lever) } };
    simd_row_quad row[SIMD_LANES];

    simd_quad_rows(&on_own, row);
    for (size_t k = 0; k < SIMD_LANES; k++) {
        double *at = c->forces + k * DISK_PAIR_DOUBLES;
        simd_row_store(at, row[k]);
        simd_row_store(at + SIMD_QUAD, simd_row_opposite(row[k]));
    }
}

// The forces of the pairs of a block, for some registers of pairs in passes. From places to forces a contact is a
// chain of a root, two divisions and a tanh, too long for a processor to work on more than one or two of them; each pass
// has a short part of it, so that contacts overlap: about a tenth of the cycles of a step.
INLINED void add_pairs(const explicit_step *step, const pair_law *law, size_t block, bool uniform,
                       overlaps *all)
{
    const disk_list *list = &step->state->list;
    const size_t end = list->pair_first[block + 1];
    double *forces = step->forces + DISK_PAIR_DOUBLES;
    pair_contact found[CONTACTS_AT_ONCE];

    for (size_t pair = list->pair_first[block]; pair < end;) {
        size_t n = 0;
        for (; n < CONTACTS_AT_ONCE && pair < end; pair += SIMD_LANES) {
            found[n].forces = forces;
            n += find_overlap(law, step->now, list->pair[0] + pair, list->pair[1] + pair, uniform,
                              &found[n]);
            forces += SIMD_LANES * DISK_PAIR_DOUBLES;
        }
        for (size_t k = 0; k < n; k++)
            find_contact(law, uniform, &found[k], all);
        for (size_t k = 0; k < n; k++)
            found[k].tanh = friction_tanh(found[k].contact.sliding);
        for (size_t k = 0; k < n; k++) {
            const contact_force f =
                add_friction(&found[k].contact, law->friction, &found[k].tanh, uniform);
            store_forces(&found[k], &f);
        }
    }
}

// What a step needs beyond laws.
typedef struct motion {
    simd dt, dt_force, damping_factor, spin_damping_factor;
    simd belt_rate2, spin_rate2;         // (lambda/8)^2
    simd belt_secant;                    // dt mu g lambda
    simd inv_mass, inv_inertia;          // if uniform
    simd belt_x, belt_y, friction_ratio; // same
    simd belt_turn;                      // unless uniform
    simd pull_x, pull_y;                 // same
    simd spin_secant;                    // same: dt A lambda
} motion;

INLINED motion make_motion(const explicit_step *step)
{
    const disk_state *s = step->state;
    const disk *kind = &s->kinds[0].part;
    const micro_law *law = &s->belt;
    const disk_belt *belt = &step->belts[s->uniform_belt];

    return (motion){
        .dt = simd_all(step->dt),
        .dt_force = simd_all(step->dt_force),
        .damping_factor = simd_all(step->damping_factor),
        .spin_damping_factor = simd_all(step->spin_damping_factor),
        .belt_rate2 = simd_all(law->tanh_linear * law->tanh_linear / 64.0),
        .spin_rate2 = simd_all(law->tanh_spin * law->tanh_spin / 64.0),
        .belt_secant = simd_all(step->dt_force * law->friction * s->def.gravity * law->tanh_linear),
        .inv_mass = simd_all(kind->inv_mass),
        .inv_inertia = simd_all(2.0 * kind->inv_mass / (kind->radius * kind->radius)),
        .belt_x = simd_all(belt->vx),
        .belt_y = simd_all(belt->vy),
        .friction_ratio = simd_all(belt->friction_ratio),
        .spin_secant = simd_all(step->dt_force * law->tanh_spin * s->uniform_deceleration),
    };
}

// The motion of parts that differ in kind or belt.
INLINED motion make_own_motion(const motion *common, const explicit_step *step, size_t slot,
                               const parts *own)
{
    const disk_state *s = step->state;
    double belt_x[SIMD_LANES], belt_y[SIMD_LANES], turn[SIMD_LANES], friction_ratio[SIMD_LANES];
    double pull_x[SIMD_LANES], pull_y[SIMD_LANES];
    motion m = *common;

    m.inv_mass = own->inv_mass;
    m.inv_inertia = 2.0 * own->inv_mass / (own->radius * own->radius);
    m.spin_secant = step->dt_force * s->belt.tanh_spin * simd_load(s->spin_deceleration + slot);
    for (int k = 0; k < SIMD_LANES; k++) {
        const disk_belt *belt = &step->belts[s->belt_under[slot + (size_t)k]];
        belt_x[k] = belt->vx;
        belt_y[k] = belt->vy;
        turn[k] = belt->turn;
        friction_ratio[k] = belt->friction_ratio;
        pull_x[k] = belt->pull.x;
        pull_y[k] = belt->pull.y;
    }
    m.belt_turn = simd_load_any(turn);
    m.belt_x = simd_load_any(belt_x) - m.belt_turn * own->y;
    m.belt_y = simd_load_any(belt_y) + m.belt_turn * own->x;
    m.friction_ratio = simd_load_any(friction_ratio);
    m.pull_x = simd_load_any(pull_x);
    m.pull_y = simd_load_any(pull_y);
    return m;
}

// Belt friction, the pull of slopes, and (12).
INLINED void move(const motion *m, parts *own, const simd_quad *force, bool sloping)
{
    simd sx = own->vx - m->belt_x, sy = own->vy - m->belt_y;
    friction_quotient t = friction_theta((sx * sx + sy * sy) * m->belt_rate2);
    simd secant = m->friction_ratio * m->belt_secant * t.up / t.down;
    simd impulse = m->dt_force * m->inv_mass;

    own->vx = m->damping_factor * own->vx + (impulse * force->column[0] - secant * sx);
    own->vy = m->damping_factor * own->vy + (impulse * force->column[1] - secant * sy);
    if (sloping) {
        own->vx += m->dt_force * m->pull_x;
        own->vy += m->dt_force * m->pull_y;
    }
    own->x += m->dt * own->vx;
    own->y += m->dt * own->vy;
}

// Spin friction (8), implicitly, and (13).
INLINED void turn(const motion *m, parts *own, simd torque, bool turning)
{
    simd w = m->spin_damping_factor * own->spin + m->dt_force * m->inv_inertia * torque;
    simd slip = turning ? w - m->belt_turn : w;
    friction_quotient t = friction_theta(slip * slip * m->spin_rate2);
    simd rest = slip * t.down / (t.down + m->friction_ratio * m->spin_secant * t.up);

    own->spin = turning ? m->belt_turn + rest : rest;
}

// The largest of all parts of a call, and a sum that is finite only if all are.
typedef struct greatest {
    simd speed2, sum;
} greatest;

static const uint32_t in_a_row[DISK_GROUP] = { 0 * DISK_DOUBLES, 1 * DISK_DOUBLES, 2 * DISK_DOUBLES,
                                               3 * DISK_DOUBLES, 4 * DISK_DOUBLES, 5 * DISK_DOUBLES,
                                               6 * DISK_DOUBLES, 7 * DISK_DOUBLES };

// x, y and torque on SIMD_LANES parts: those of the boundary, then of the neighbours in the order of the list.
INLINED simd_quad sum_forces(const explicit_step *step, size_t slot)
{
    const disk_list *list = &step->state->list;
    const size_t group = slot / DISK_GROUP;
    const uint32_t *at = list->force + (size_t)list->first[group] * DISK_GROUP + slot % DISK_GROUP;
    const uint32_t *end = list->force + (size_t)list->first[group + 1] * DISK_GROUP;
    const bool has_candidates = step->state->has_candidates[group] != 0;
    simd_row_quad sum[SIMD_LANES];

    for (size_t k = 0; k < SIMD_LANES; k++)
        sum[k] = simd_row_load(has_candidates ? &step->next[slot + k].x : step->forces);
    for (; at < end; at += DISK_GROUP)
        for (size_t k = 0; k < SIMD_LANES; k++)
            sum[k] = simd_row_sum(sum[k], simd_row_load(step->forces + at[k]));
    return simd_quad_of(sum);
}

// speed2 where a part is in the scene; 0 for padding, which is far away but has the belt's velocity.
INLINED simd speed2_in_scene(const parts *own, simd speed2)
{
    const simd far2 = simd_all(0.25 * DISK_FAR * DISK_FAR);

    return simd_where_less(own->x * own->x + own->y * own->y, far2, speed2);
}

INLINED void move_lanes(const explicit_step *step, const motion *common, size_t slot, bool uniform,
                        bool has_padding, greatest *of_all)
{
    parts own = load_parts(step->now + slot, in_a_row, uniform);
    simd_quad force = sum_forces(step, slot);
    motion m = uniform ? *common : make_own_motion(common, step, slot, &own);

    move(&m, &own, &force, !uniform && step->state->has_slopes);
    turn(&m, &own, force.column[2], !uniform && step->state->has_turning);
    simd_quad quad = { { own.x, own.y, own.vx, own.vy } };
    simd_quad_store(&step->next[slot].x, SIMD_ROW, &quad);
    simd_column_store(&step->next[slot].spin, own.spin);
    simd_store(step->heading + slot, simd_load(step->heading + slot) + m.dt * own.spin);
    simd speed2 = own.vx * own.vx + own.vy * own.vy;
    simd counted = has_padding ? speed2_in_scene(&own, speed2) : speed2;
    of_all->speed2 = simd_max(counted, of_all->speed2);
    of_all->sum += speed2 + own.spin * own.spin;
}

INLINED void advance_blocks(const explicit_step *step, size_t first, size_t last, bool uniform,
                            driver_extremes *extremes)
{
    const disk_state *s = step->state;
    const pair_law law = make_law(s, &s->cargo, s->kinds[0].part.compliance);
    const motion common = make_motion(step);
    const simd zero = simd_all(0.0);
    overlaps all = { zero, zero };
    greatest of_all = { zero, zero };

    for (size_t group = first; group < last; group += DISK_BLOCK_GROUPS) {
        const size_t block = group / DISK_BLOCK_GROUPS;
        const size_t end =
            (group + DISK_BLOCK_GROUPS < last ? group + DISK_BLOCK_GROUPS : last) * DISK_GROUP;
        const bool has_padding = end > s->n_live;
        add_pairs(step, &law, block, uniform, &all);
        for (size_t slot = group * DISK_GROUP; slot < end; slot += SIMD_LANES)
            move_lanes(step, &common, slot, uniform, has_padding, &of_all);
    }
    raise(&extremes->speed2, simd_peak(of_all.speed2));
    raise_overlaps(s, &all, uniform, extremes);
    for (int k = 0; k < SIMD_LANES; k++)
        extremes->sum += of_all.sum[k];
}

static void advance(const explicit_step *step, size_t first, size_t last, driver_extremes *extremes)
{
    if (step->state->is_uniform)
        advance_blocks(step, first, last, true, extremes);
    else
        advance_blocks(step, first, last, false, extremes);
}

extern const explicit_kernels CPU_NAME(explicit_kernels);

const explicit_kernels CPU_NAME(explicit_kernels) = {
    .add_boundary_forces = CPU_NAME(explicit_boundary_forces),
    .advance = advance,
    .tanh_of = tanh_of,
};
