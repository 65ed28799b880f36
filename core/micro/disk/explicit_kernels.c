#include "core/micro/disk/disk_priv.h"

#include "core/base/simd_compare.h"
#include "core/base/simd_rows.h"
#include "core/micro/friction.h"

#include <math.h>

// This file is compiled once per instruction set. Functions with a flag `uniform` are inlined with a constant,
// once for scenes of one kind on one belt and once for all others.

#define INLINED static inline __attribute__((always_inline))

enum {
    ROWS_AT_ONCE = 8,
    GROUPS_AT_ONCE = 4,
};

static void tanh_of(size_t n, const double *x, double *ret_y)
{
    for (size_t k = 0; k < n; k += SIMD_LANES) {
        friction_quotient t = friction_tanh(simd_load_any(x + k) * 0.125);
        simd y = t.up / t.down;
        memcpy(ret_y + k, &y, sizeof y);
    }
}

// SIMD_LANES parts.
typedef struct parts {
    simd x, y, vx, vy;
    simd spin, radius, compliance, inv_mass; // all but spin only if not uniform
} parts;

INLINED parts load_parts(const disk *rows, const uint32_t *at, bool uniform)
{
    simd_quad low = simd_quad_load(&rows->x, at);
    simd_quad high = simd_quad_load(&rows->spin, at);
    parts p = { low.column[0],  low.column[1], low.column[2], low.column[3],
                high.column[0], simd_all(0.0), simd_all(0.0), simd_all(0.0) };

    if (!uniform) {
        p.radius = high.column[1];
        p.compliance = high.column[2];
        p.inv_mass = high.column[3];
    }
    return p;
}

// Sums over the contacts of SIMD_LANES parts.
typedef struct loads {
    simd x, y, torque;
    simd overlap, overlap_share; // largest
} loads;

// A law, ready for lanes.
typedef struct pair_law {
    simd damping, friction;
    simd rate;                        // lambda / 8
    simd lower_bound;                 // of the normal force
    simd line;                        // k times the sum of compliances
    simd contact_distance, stiffness; // sum of radii and k, if uniform
} pair_law;

INLINED pair_law make_law(const disk_state *s, const disk_law *law, double other_compliance)
{
    const disk *kind = &s->kinds[0].part;

    return (pair_law){ .damping = simd_all(law->damping),
                       .friction = simd_all(law->friction),
                       .rate = simd_all(law->tanh_linear / 8.0),
                       .lower_bound = simd_all(s->def.tension ? -INFINITY : 0.0),
                       .line = simd_all(law->line),
                       .contact_distance = simd_all(kind->radius + kind->radius),
                       .stiffness = simd_all(law->line / (kind->compliance + other_compliance)) };
}

// A contact of a part with something in direction n, before its friction is known.
typedef struct contact {
    simd nx, ny;  // unit, from the part to what it touches
    simd force;   // (4a), N; 0 where there is no contact
    simd sliding; // lambda/8 times the speed along the tangent, n turned left
    simd lever;   // from the part's centre to the contact point, m
} contact;

// Friction (7), and the sums.
INLINED void add_contact(const contact *c, simd friction, bool uniform, loads *sum)
{
    friction_quotient t = friction_tanh(c->sliding);
    simd size = uniform ? c->force : simd_max(c->force, -c->force);
    simd friction_force = friction * size * (t.up / t.down);

    sum->x += friction_force * c->ny - c->force * c->nx;
    sum->y -= friction_force * c->nx + c->force * c->ny;
    sum->torque -= friction_force * c->lever;
}

// The normal force of an overlap, where low < high.
INLINED simd normal_force(const pair_law *law, simd stiffness, simd overlap, simd parting, simd low,
                          simd high)
{
    simd force = simd_max(stiffness * overlap - law->damping * parting, law->lower_bound);

    return simd_where_less(low, high, force);
}

// Contacts with neighbours; false if no neighbour overlaps.
INLINED bool find_contact(const pair_law *law, const parts *own, const parts *other, bool uniform,
                          contact *c, loads *sum)
{
    simd dx = other->x - own->x, dy = other->y - own->y;
    simd distance2 = dx * dx + dy * dy;
    simd contact_distance = uniform ? law->contact_distance : own->radius + other->radius,
         contact_distance2 = contact_distance * contact_distance;

    if (simd_less(distance2, contact_distance2) == 0)
        return false;
    simd distance = simd_sqrt(distance2), inverse = 1.0 / distance;
    simd vx = other->vx - own->vx, vy = other->vy - own->vy;
    simd overlap = contact_distance - distance, rolling, stiffness = law->stiffness;
    c->nx = dx * inverse;
    c->ny = dy * inverse;
    sum->overlap = simd_max(overlap, sum->overlap);
    if (uniform) {
        c->lever = 0.5 * distance;
        rolling = (own->spin + other->spin) * c->lever;
    } else {
        simd excess = own->radius - other->radius;
        simd smaller = simd_min(own->radius, other->radius);
        stiffness = law->line / (own->compliance + other->compliance);
        c->lever = 0.5 * (distance + excess);
        rolling = own->spin * c->lever + other->spin * (0.5 * (distance - excess));
        sum->overlap_share = simd_max(overlap / smaller, sum->overlap_share);
    }
    c->force = normal_force(law, stiffness, overlap, vx * c->nx + vy * c->ny, distance2,
                            contact_distance2);
    c->sliding = law->rate * (vx * c->ny - vy * c->nx + rolling);
    return true;
}

// What a step needs beyond laws.
typedef struct motion {
    simd dt, dt_force, damping_factor, spin_damping_factor;
    simd belt_rate2, spin_rate2;  // (lambda/8)^2
    simd belt_secant;             // dt mu g lambda
    simd inv_mass, inv_inertia;   // if uniform
    simd belt_x, belt_y, on_belt; // same
    simd spin_secant;             // same: dt A lambda
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
        .on_belt = simd_all(belt->on_belt),
        .spin_secant = simd_all(step->dt_force * law->tanh_spin * s->uniform_deceleration),
    };
}

// The motion of parts that differ in kind or belt.
INLINED motion make_own_motion(const motion *common, const explicit_step *step, size_t slot,
                               const parts *own)
{
    const disk_state *s = step->state;
    double belt_x[SIMD_LANES], belt_y[SIMD_LANES], on_belt[SIMD_LANES];
    motion m = *common;

    m.inv_mass = own->inv_mass;
    m.inv_inertia = 2.0 * own->inv_mass / (own->radius * own->radius);
    m.spin_secant = step->dt_force * s->belt.tanh_spin * simd_load(s->spin_deceleration + slot);
    for (int k = 0; k < SIMD_LANES; k++) {
        const disk_belt *belt = &step->belts[s->belt_under[slot + (size_t)k]];
        belt_x[k] = belt->vx;
        belt_y[k] = belt->vy;
        on_belt[k] = belt->on_belt;
    }
    m.belt_x = simd_load_any(belt_x);
    m.belt_y = simd_load_any(belt_y);
    m.on_belt = simd_load_any(on_belt);
    return m;
}

// Belt friction and (12).
INLINED void move(const motion *m, parts *own, const loads *sum)
{
    simd sx = own->vx - m->belt_x, sy = own->vy - m->belt_y;
    friction_quotient t = friction_theta((sx * sx + sy * sy) * m->belt_rate2);
    simd secant = m->on_belt * m->belt_secant * t.up / t.down;
    simd impulse = m->dt_force * m->inv_mass;

    own->vx = m->damping_factor * own->vx + (impulse * sum->x - secant * sx);
    own->vy = m->damping_factor * own->vy + (impulse * sum->y - secant * sy);
    own->x += m->dt * own->vx;
    own->y += m->dt * own->vy;
}

// Spin friction (8), implicitly, and (13).
INLINED void turn(const motion *m, parts *own, const loads *sum)
{
    simd w = m->spin_damping_factor * own->spin + m->dt_force * m->inv_inertia * sum->torque;
    friction_quotient t = friction_theta(w * w * m->spin_rate2);

    own->spin = w * t.down / (t.down + m->on_belt * m->spin_secant * t.up);
}

// The largest of all parts of a call, and a sum that is finite only if all are.
typedef struct largest {
    simd speed2, sum, overlap, overlap_share;
} greatest;

// Contacts are found for some rows and then summed up: two short chains of operations overlap better
// than one long one.
INLINED void add_neighbours(const explicit_step *step, const pair_law *law, const parts *own,
                            size_t group, size_t lane, bool uniform, loads *sum)
{
    const disk_list *list = &step->state->list;
    const uint32_t *at = list->neighbour + (size_t)list->first[group] * DISK_GROUP + lane;
    const uint32_t *end = list->neighbour + (size_t)list->first[group + 1] * DISK_GROUP;
    contact contacts[ROWS_AT_ONCE];

    while (at < end) {
        size_t n = 0;
        for (; n < ROWS_AT_ONCE && at < end; at += DISK_GROUP) {
            parts other = load_parts(step->now, at, uniform);
            n += find_contact(law, own, &other, uniform, &contacts[n], sum) ? 1 : 0;
        }
        for (size_t k = 0; k < n; k++)
            add_contact(&contacts[k], law->friction, uniform, sum);
    }
}

// Parts with the forces on them.
typedef struct loaded {
    parts own;
    loads sum;
} loaded;

INLINED loaded load_lanes(const explicit_step *step, const pair_law *law, size_t slot, bool uniform,
                          greatest *of_all)
{
    static const uint32_t in_a_row[DISK_GROUP] = { 0 * DISK_DOUBLES, 1 * DISK_DOUBLES,
                                                   2 * DISK_DOUBLES, 3 * DISK_DOUBLES,
                                                   4 * DISK_DOUBLES, 5 * DISK_DOUBLES,
                                                   6 * DISK_DOUBLES, 7 * DISK_DOUBLES };
    const disk_state *s = step->state;
    const size_t group = slot / DISK_GROUP, lane = slot % DISK_GROUP;
    const simd zero = simd_all(0.0);
    parts own = load_parts(step->now + slot, in_a_row, uniform);
    loads sum = { zero, zero, zero, of_all->overlap, of_all->overlap_share };

    if (s->has_candidates[group] != 0) {
        simd_quad forces = simd_quad_load(&step->next[slot].x, in_a_row);
        sum.x = forces.column[0];
        sum.y = forces.column[1];
        sum.torque = simd_quad_load(&step->next[slot].spin, in_a_row).column[0];
    }
    add_neighbours(step, law, &own, group, lane, uniform, &sum);
    of_all->overlap = sum.overlap;
    of_all->overlap_share = sum.overlap_share;
    return (loaded){ own, sum };
}

// speed2 where a part is in the scene; 0 for padding, which is far away but has the belt's velocity.
INLINED simd speed2_in_scene(const parts *own, simd speed2)
{
    const simd far2 = simd_all(0.25 * DISK_FAR * DISK_FAR);

    return simd_where_less(own->x * own->x + own->y * own->y, far2, speed2);
}

INLINED void move_lanes(const explicit_step *step, const motion *common, size_t slot, bool uniform,
                        bool has_padding, loaded *l, greatest *of_all)
{
    motion m = uniform ? *common : make_own_motion(common, step, slot, &l->own);

    move(&m, &l->own, &l->sum);
    turn(&m, &l->own, &l->sum);
    simd_quad quad = { { l->own.x, l->own.y, l->own.vx, l->own.vy } };
    simd_quad_store(&step->next[slot].x, SIMD_ROW, &quad);
    simd_column_store(&step->next[slot].spin, l->own.spin);
    simd_store(step->heading + slot, simd_load(step->heading + slot) + m.dt * l->own.spin);
    simd speed2 = l->own.vx * l->own.vx + l->own.vy * l->own.vy;
    simd counted = has_padding ? speed2_in_scene(&l->own, speed2) : speed2;
    of_all->speed2 = simd_max(counted, of_all->speed2);
    of_all->sum += speed2 + l->own.spin * l->own.spin;
}

static void raise(double *largest, double to)
{
    *largest = to > *largest ? to : *largest;
}

INLINED void raise_overlaps(const disk_state *s, simd overlap, simd ratio, bool uniform,
                            driver_extremes *extremes)
{
    raise(&extremes->overlap, simd_peak(overlap));
    raise(&extremes->overlap_share,
          uniform ? simd_peak(overlap) / s->kinds[0].part.radius : simd_peak(ratio));
}

INLINED void advance_groups(const explicit_step *step, size_t first, size_t last, bool uniform,
                            driver_extremes *extremes)
{
    const disk_state *s = step->state;
    const pair_law law = make_law(s, &s->cargo, s->kinds[0].part.compliance);
    const motion common = make_motion(step);
    greatest of_all = { simd_all(0.0), simd_all(0.0), simd_all(0.0), simd_all(0.0) };
    loaded l[GROUPS_AT_ONCE * DISK_GROUP / SIMD_LANES];

    for (size_t group = first; group < last; group += GROUPS_AT_ONCE) {
        size_t n = (last - group < GROUPS_AT_ONCE ? last - group : GROUPS_AT_ONCE) * DISK_GROUP;
        const bool has_padding = group * DISK_GROUP + n > s->n_live;
        for (size_t k = 0; k < n; k += SIMD_LANES)
            l[k / SIMD_LANES] = load_lanes(step, &law, group * DISK_GROUP + k, uniform, &of_all);
        for (size_t k = 0; k < n; k += SIMD_LANES)
            move_lanes(step, &common, group * DISK_GROUP + k, uniform, has_padding,
                       &l[k / SIMD_LANES], &of_all);
    }
    raise(&extremes->speed2, simd_peak(of_all.speed2));
    raise_overlaps(s, of_all.overlap, of_all.overlap_share, uniform, extremes);
    for (int k = 0; k < SIMD_LANES; k++)
        extremes->sum += of_all.sum[k];
}

static void advance(const explicit_step *step, size_t first, size_t last, driver_extremes *extremes)
{
    if (step->state->is_uniform)
        advance_groups(step, first, last, true, extremes);
    else
        advance_groups(step, first, last, false, extremes);
}

// A square whose root is never zero.
static const double tiny2 = 1e-200;

// SIMD_LANES candidates: the geometry of the boundary relative to the parts.
typedef struct surface {
    simd nx, ny;   // unit normal out of the boundary
    simd height;   // of the part's centre over it, m
    simd friction; // mu
    simd inside;   // 1 where the centre is in the range of the feature, else 0
} surface;

INLINED surface find_faces(const disk_state *s, const parts *own, const uint32_t *feature)
{
    simd_quad low = simd_quad_load(&s->faces->px, feature);
    simd_quad high = simd_quad_load(&s->faces->from, feature);
    simd rx = own->x - low.column[0], ry = own->y - low.column[1];
    surface f = { .nx = low.column[2], .ny = low.column[3], .friction = high.column[3] };
    simd along = rx * f.ny - ry * f.nx;

    f.height = rx * f.nx + ry * f.ny;
    f.inside = simd_where_less(along, high.column[1], simd_all(1.0));
    f.inside = simd_where_less(-high.column[2], f.height, f.inside);
    f.inside -= simd_where_less(along, high.column[0], f.inside);
    return f;
}

INLINED surface find_arcs(const disk_state *s, const parts *own, const uint32_t *feature)
{
    simd_quad low = simd_quad_load(&s->arcs->px, feature);
    simd_quad high = simd_quad_load(&s->arcs->ey, feature);
    simd rx = own->x - low.column[0], ry = own->y - low.column[1];
    simd distance = simd_sqrt(simd_max(rx * rx + ry * ry, simd_all(tiny2)));
    surface a = { .nx = rx / distance, .ny = ry / distance, .friction = high.column[3] };
    simd zero = simd_all(0.0);

    a.height = distance - low.column[2];
    a.inside = simd_where_less(zero, a.height, simd_all(1.0));
    a.inside = simd_where_less(zero, rx * high.column[1] + ry * high.column[2], a.inside);
    a.inside -= simd_where_less(rx * low.column[3] + ry * high.column[0], zero, a.inside);
    return a;
}

// Takes the lanes of b where pick is 1, keeps those of a where it is 0.
INLINED surface choose(surface a, surface b, simd pick)
{
    simd half = simd_all(0.5);
    surface s;

    s.nx = simd_where_less(pick, half, a.nx) + simd_where_less(half, pick, b.nx);
    s.ny = simd_where_less(pick, half, a.ny) + simd_where_less(half, pick, b.ny);
    s.height = simd_where_less(pick, half, a.height) + simd_where_less(half, pick, b.height);
    s.friction = simd_where_less(pick, half, a.friction) + simd_where_less(half, pick, b.friction);
    s.inside = simd_where_less(pick, half, a.inside) + simd_where_less(half, pick, b.inside);
    return s;
}

// Candidates first .. first + SIMD_LANES - 1, of which those from last on are ignored.
typedef struct candidate_lanes {
    uint32_t slot[SIMD_LANES];
    uint32_t row[SIMD_LANES], face[SIMD_LANES], arc[SIMD_LANES]; // where they begin
    simd is_arc;                                                 // 1 or 0
    simd counts;                                                 // 1, or 0 behind the last
    bool has_arcs;
} candidate_lanes;

INLINED candidate_lanes load_candidates(const disk_state *s, size_t first, size_t last)
{
    candidate_lanes t = { .has_arcs = false };

    for (size_t k = 0; k < SIMD_LANES; k++) {
        disk_candidate candidate = { s->void_slot, 0 };
        if (first + k < last)
            candidate = s->candidates[first + k];
        bool is_arc = candidate.feature >= s->n_faces;
        t.slot[k] = candidate.slot;
        t.row[k] = candidate.slot * DISK_DOUBLES;
        t.face[k] = is_arc ? 0 : candidate.feature * DISK_DOUBLES;
        t.arc[k] = is_arc ? (candidate.feature - (uint32_t)s->n_faces) * DISK_DOUBLES : 0;
        t.is_arc[k] = is_arc ? 1.0 : 0.0;
        t.counts[k] = first + k < last ? 1.0 : 0.0;
        t.has_arcs = t.has_arcs || is_arc;
    }
    return t;
}

// How the surfaces move that SIMD_LANES candidates are about.
typedef struct surface_motion {
    simd px, py; // pivot
    simd spin, recess, growth;
} surface_motion;

INLINED surface_motion load_surfaces(const disk_state *s, const candidate_lanes *t)
{
    const uint32_t first_arc = (uint32_t)s->n_faces * DISK_DOUBLES;
    uint32_t row[SIMD_LANES];

    for (size_t k = 0; k < SIMD_LANES; k++)
        row[k] = t->is_arc[k] > 0.0 ? first_arc + t->arc[k] : t->face[k];
    simd_quad low = simd_quad_load(&s->plates.surfaces->px, row);
    simd_quad high = simd_quad_load(&s->plates.surfaces->growth, row);
    return (surface_motion){ low.column[0], low.column[1], low.column[2], low.column[3],
                             high.column[0] };
}

// The velocity of the parts becomes that against the surface in the contact point.
INLINED void subtract_surface_velocity(const surface_motion *m, const surface *at, simd lever,
                                       parts *own)
{
    simd rx = own->x - lever * at->nx - m->px, ry = own->y - lever * at->ny - m->py;

    own->vx -= m->growth * at->nx - m->spin * ry;
    own->vy -= m->growth * at->ny + m->spin * rx;
}

INLINED void boundary_forces_lanes(const explicit_step *step, const pair_law *law,
                                   const candidate_lanes *t, bool uniform, loads *sum)
{
    const disk_state *s = step->state;
    const disk *kind = &s->kinds[0].part;
    const simd zero = simd_all(0.0);
    parts own = load_parts(step->now, t->row, uniform);
    simd radius = uniform ? simd_all(kind->radius) : own.radius, stiffness = law->stiffness;
    surface at = find_faces(s, &own, t->face);

    if (t->has_arcs)
        at = choose(at, find_arcs(s, &own, t->arc), t->is_arc);
    if (!uniform)
        stiffness = law->line / (own.compliance + s->handling_compliance);
    surface_motion surfaces = { zero, zero, zero, zero, zero };
    if (s->plates.n > 0)
        surfaces = load_surfaces(s, t);
    simd range = radius - surfaces.recess, overlap = range - at.height;
    simd presses = simd_where_less(at.height, range, at.inside * t->counts);
    contact c = { .nx = -at.nx, .ny = -at.ny, .lever = radius - 0.5 * overlap };
    if (s->plates.n > 0)
        subtract_surface_velocity(&surfaces, &at, c.lever, &own);
    c.force = normal_force(law, stiffness, overlap, own.vx * at.nx + own.vy * at.ny, zero, presses);
    c.sliding = law->rate * (own.vx * at.ny - own.vy * at.nx + own.spin * c.lever);
    add_contact(&c, at.friction, uniform, sum);
    overlap = simd_where_less(zero, presses, overlap);
    sum->overlap = simd_max(overlap, sum->overlap);
    if (!uniform)
        sum->overlap_share = simd_max(overlap / radius, sum->overlap_share);
}

static void clear_forces(disk *rows)
{
    for (size_t k = 0; k < DISK_GROUP; k++)
        rows[k].x = rows[k].y = rows[k].spin = 0.0;
}

// Adds the forces of SIMD_LANES candidates, of which n are valid. *group is that of the candidate before.
INLINED void store_forces(const explicit_step *step, const candidate_lanes *t, size_t n,
                          const loads *sum, uint32_t *group)
{
    for (size_t k = 0; k < SIMD_LANES && k < n; k++) {
        disk *to = &step->next[t->slot[k]];
        if (t->slot[k] / DISK_GROUP != *group) {
            *group = t->slot[k] / DISK_GROUP;
            clear_forces(&step->next[*group * DISK_GROUP]);
        }
        to->x += sum->x[k];
        to->y += sum->y[k];
        to->spin += sum->torque[k];
    }
}

INLINED void add_boundary_forces(const explicit_step *step, size_t first, size_t last, bool uniform,
                                 driver_extremes *extremes)
{
    const disk_state *s = step->state;
    const pair_law law = make_law(s, &s->handling, s->handling_compliance);
    const simd zero = simd_all(0.0);
    loads sum = { zero, zero, zero, zero, zero };
    uint32_t group = UINT32_MAX;

    for (size_t from = first; from < last; from += SIMD_LANES) {
        candidate_lanes t = load_candidates(s, from, last);
        sum.x = sum.y = sum.torque = zero;
        boundary_forces_lanes(step, &law, &t, uniform, &sum);
        store_forces(step, &t, last - from, &sum, &group);
    }
    raise_overlaps(s, sum.overlap, sum.overlap_share, uniform, extremes);
}

static void boundary_forces(const explicit_step *step, size_t first, size_t last,
                            driver_extremes *extremes)
{
    if (step->state->is_uniform)
        add_boundary_forces(step, first, last, true, extremes);
    else
        add_boundary_forces(step, first, last, false, extremes);
}

extern const explicit_kernels CPU_NAME(explicit_kernels);

const explicit_kernels CPU_NAME(explicit_kernels) = {
    .add_boundary_forces = boundary_forces,
    .advance = advance,
    .tanh_of = tanh_of,
};
