// The laws of the faces (core/macro/congested.h) for the belts' present speeds.

#include "core/macro/congested/congested_priv.h"
#include "core/macro/congested/half_rows.h"

#include <math.h>
#include <string.h>

// Fitted to the microscopic model; README.md.
static const double forward_slope = 0.07;
static const double forward_most = 0.3;
static const double lateral_most = 0.555;
static const double friction = 0.46;

// What bears of the friction of cargo that is held back on a belt of this speed.
static double grip_of(const congested *c, double speed)
{
    return tanh(0.5 * c->slip_rate * speed);
}

// The belt's speed and v_stat at a face in the directions of the face: e its normal, t the left of e.
typedef struct face_state {
    double scale;    // of fluxes: 1, or the ratio of the cells' edges
    double aperture; // 0 closed .. 1 open
    double belt_e;   // v_T
    double belt_t;
    double stat_e; // v_stat
    double stat_t;
    const congested_belt *belt; // of the belt there
} face_state;

// Elements of the half rows that belong to a face.
typedef struct face_slot {
    const congested_law *law;
    ptrdiff_t at; // index in its arrays
} face_slot;

static face_slot slot_of(const congested *c, int axis, ptrdiff_t i, ptrdiff_t j)
{
    const bool is_own = ((i + j) & 1) == 0; // the cell east or north of the face is red
    const congested_side side = axis == 0 ? (is_own ? CONGESTED_WEST : CONGESTED_EAST)
                                          : (is_own ? CONGESTED_SOUTH : CONGESTED_NORTH);
    const ptrdiff_t row = axis == 1 && !is_own ? j - 1 : j;
    const ptrdiff_t k = axis == 0 && !is_own ? (i - 1) >> 1 : i >> 1;

    return (face_slot){ &c->law[side], (row + 1) * c->half_stride + CONGESTED_UNIT + k };
}

static void set_across(const congested *c, const face_slot *f, const face_state *x, double speed,
                       double lateral)
{
    const double most = c->jam_density * x->belt->lateral, open = x->scale * x->aperture;

    f->law->lower[f->at] = (float)(open * fmin(0.0, -most - c->jam_density * lateral));
    f->law->upper[f->at] = (float)(open * fmax(0.0, most - c->jam_density * lateral));
    f->law->full_slip[f->at] = (float)(c->jam_density * speed);
    // What is held back bears on its neighbours by what the belt drives it by, and gives way by its friction across.
    const double bearing = x->belt->slower / x->belt->across;
    f->law->gain[f->at] = (float)(x->scale * 0.25 * friction * bearing * x->belt->grip);
    if (c->has_drives)
        f->law->sideways[f->at] = (float)(1.0 / x->belt->across);
}

static void set_along(const congested *c, const face_slot *f, const face_state *x, double speed,
                      double forward)
{
    const double open = x->scale * x->aperture;
    const double free = open * fmax(0.0, c->jam_density * (speed - forward));
    const double inner = 1.0 / x->belt->slower;
    const double slope = fmin(inner, forward_slope / (c->slip_rate * speed * x->belt->faster));

    f->law->slope[f->at] = (float)slope;
    f->law->offset[f->at] = (float)((1.0 - slope / inner) * free);
    if (c->has_drives)
        f->law->inner[f->at] = (float)inner;
    f->law->most[f->at] = (float)(free + open * forward_most * c->jam_density * speed);
    f->law->least[f->at] = (float)(x->scale * -c->jam_density * (forward + lateral_most * speed));
    f->law->at_rest[f->at] = 0.0F;
}

// Nothing is corrected across a closed face, nor where no belt moves.
static void close_face(const congested *c, const face_slot *f, double speed)
{
    f->law->slope[f->at] = f->law->offset[f->at] = f->law->most[f->at] = 0.0F;
    f->law->least[f->at] = f->law->lower[f->at] = f->law->upper[f->at] = 0.0F;
    f->law->full_slip[f->at] = f->law->at_rest[f->at] = (float)(c->jam_density * speed);
    f->law->gain[f->at] = 0.0F;
    if (!c->is_forward)
        f->law->along[f->at] = f->law->across[f->at] = 0.0F;
    if (c->has_drives)
        f->law->inner[f->at] = f->law->sideways[f->at] = 0.0F;
}

static void set_face(const congested *c, const face_slot *f, const face_state *x)
{
    const double speed = x->belt->speed;

    if (x->aperture == 0.0 || speed == 0.0) {
        close_face(c, f, speed);
        return;
    }
    // In the frame of e and t the belt's direction is b = (cosine, sine), its left normal q = (-sine, cosine).
    const double cosine = x->belt_e / speed, sine = x->belt_t / speed;
    set_along(c, f, x, speed, x->stat_e * cosine + x->stat_t * sine);
    set_across(c, f, x, speed, x->stat_t * cosine - x->stat_e * sine);
    if (!c->is_forward) {
        f->law->along[f->at] = (float)cosine;
        f->law->across[f->at] = (float)-sine;
    }
}

static bool is_edge_closed(const macro_solver *s, const congested *c, int axis, ptrdiff_t i,
                           ptrdiff_t j)
{
    if (axis == 0)
        return (i == 0 && c->closed_edge[0]) || (i == s->n1 && c->closed_edge[1]);
    return (j == 0 && c->closed_edge[2]) || (j == s->n2 && c->closed_edge[3]);
}

// The centre of a face.
static vec2 place_of(const bf_grid *g, int axis, ptrdiff_t i, ptrdiff_t j)
{
    return (vec2){ g->lower1 + ((double)i + (axis == 0 ? 0.0 : 0.5)) * g->d1,
                   g->lower2 + ((double)j + (axis == 0 ? 0.5 : 0.0)) * g->d2 };
}

// What a belt that turns has at a place.
static congested_belt belt_at(const congested *c, const congested_belt *of, vec2 v_t)
{
    congested_belt at = *of;

    at.speed = hypot(v_t.x, v_t.y);
    at.grip = grip_of(c, at.speed);
    at.lateral = lateral_most * vec2_length(v_t);
    return at;
}

static void set_axis(const macro_solver *s, const congested *c, int axis)
{
    const ptrdiff_t n_columns = s->n1 + (axis == 0), n_rows = s->n2 + axis;

    for (ptrdiff_t j = 0; j < n_rows; j++) {
        for (ptrdiff_t i = 0; i < n_columns; i++) {
            const size_t at = (size_t)(j * n_columns + i), belt = c->belt[axis][at];
            if (!c->is_stale[axis][j] && !c->is_changed[belt])
                continue;
            const scene_belt *under = &c->belts[belt];
            const double factor = s->factors[belt], aperture = c->aperture[axis][at];
            const vec2 v_t =
                vec2_scale(belt_velocity(under, place_of(&s->def.grid, axis, i, j)), factor);
            const congested_belt now =
                under->turn == 0.0 ? c->present[belt] : belt_at(c, &c->present[belt], v_t);
            const face_slot f = slot_of(c, axis, i, j);
            const face_state x = {
                .scale = axis == 0 ? 1.0 : (double)c->ratio,
                .aperture = is_edge_closed(s, c, axis, i, j) ? 0.0 : aperture,
                .belt_e = axis == 0 ? v_t.x : v_t.y,
                .belt_t = axis == 0 ? v_t.y : -v_t.x,
                .stat_e = aperture > 0.0 ? factor * c->slide[axis][at] / aperture : 0.0,
                .stat_t = (axis == 0 ? 1.0 : -1.0) * factor * c->transverse[axis][at],
                .belt = &now
            };
            set_face(c, &f, &x);
        }
        c->is_stale[axis][j] = false;
    }
}

// How much a face's flux changes with the pressure on one side of it, as if it were open.
static double steepness_of(const macro_solver *s, const congested *c, int axis, ptrdiff_t i,
                           ptrdiff_t j)
{
    const size_t belt = c->belt[axis][(size_t)(j * (s->n1 + (axis == 0)) + i)];
    const congested_belt now = c->present[belt];
    const vec2 v = belt_velocity(&c->belts[belt], place_of(&s->def.grid, axis, i, j));
    const double speed = vec2_length(v);
    const double cosine = speed > 0.0 ? (axis == 0 ? v.x : v.y) / speed : 1.0;

    return (axis == 0 ? 1.0 : (double)c->steepness) *
           (cosine * cosine / now.slower + (1.0 - cosine * cosine) / now.across);
}

static void set_relaxations(const macro_solver *s, const congested *c)
{
    for (ptrdiff_t j = 0; j < s->n2; j++)
        for (ptrdiff_t i = 0; i < s->n1; i++) {
            const double steepness = steepness_of(s, c, 0, i, j) + steepness_of(s, c, 0, i + 1, j) +
                                     steepness_of(s, c, 1, i, j) + steepness_of(s, c, 1, i, j + 1);
            congested__row(c, c->relaxations[(i + j) & 1], j)[i >> 1] =
                (float)(CONGESTED_OMEGA / (s->lambda1 * steepness));
        }
}

// Sets c->uniform by a face that has both laws.
static void set_uniform(const macro_solver *s, congested *c)
{
    const double speed = c->n_belts == 0 ? 0.0 : s->factors[0] * c->belts[0].velocity.x;
    congested_uniform *u = &c->uniform;
    float others[4];
    const congested_law law = { .slope = &u->slope,
                                .offset = &others[0],
                                .most = &u->most,
                                .least = &u->least,
                                .lower = &u->lower,
                                .upper = &u->upper,
                                .full_slip = &others[1],
                                .gain = &others[2],
                                .at_rest = &others[3] };
    const face_slot slot = { &law, 0 };
    face_state x = {
        .scale = 1.0, .aperture = 1.0, .belt_e = speed, .stat_e = speed, .belt = &c->present[0]
    };

    set_face(c, &slot, &x);
    if (speed == 0.0)
        return;
    x.scale = (double)c->ratio;
    set_across(c, &slot, &x, speed, 0.0);
}

static bool has_uniform_law(const congested *c, const congested_row_faces *faces, ptrdiff_t k)
{
    const congested_uniform *u = &c->uniform;
    bool has = true;

    for (int side = 0; side < CONGESTED_SIDES; side++) {
        const congested_law *l = faces->side[side].law;
        const ptrdiff_t at = faces->side[side].at + k;
        if (side == CONGESTED_WEST || side == CONGESTED_EAST)
            has = has && l->slope[at] == u->slope && l->offset[at] == 0.0F &&
                  l->most[at] == u->most && l->least[at] == u->least;
        else
            has = has && l->lower[at] == u->lower && l->upper[at] == u->upper;
    }
    return has;
}

static void find_uniform_groups(const macro_solver *s, congested *c, ptrdiff_t row, int colour)
{
    const congested_row_faces faces = congested__faces(c, row, colour);
    bool *is_uniform = congested__flags(c, c->is_uniform, row, colour);

    for (ptrdiff_t first = 0; 2 * first < s->n1; first += CONGESTED_GROUP) {
        bool are_uniform = true;
        for (ptrdiff_t k = first; are_uniform && k < first + CONGESTED_GROUP; k++)
            are_uniform = has_uniform_law(c, &faces, k);
        is_uniform[first / CONGESTED_GROUP] = are_uniform;
    }
}

// What another belt brings goes on across a belt as fast as it came. Belts that turn have only their own.
static double most_across(const macro_solver *s, const congested *c, size_t belt)
{
    const vec2 velocity = c->belts[belt].velocity;
    const double own = vec2_length(velocity);
    double most = lateral_most * s->factors[belt] * own;

    for (size_t k = 0; own > 0.0 && k < c->n_belts; k++)
        if (c->belts[k].turn == 0.0)
            most =
                fmax(most, s->factors[k] * fabs(vec2_cross(velocity, c->belts[k].velocity)) / own);
    return most;
}

static congested_belt belt_now(const macro_solver *s, const congested *c, size_t belt)
{
    const double factor = s->factors[belt], tau = c->slope_ratio[belt];
    const vec2 v = vec2_scale(c->belts[belt].velocity, factor);
    const double speed = hypot(v.x, v.y);
    // Cargo that is held back slips little on its own belt, where friction is lambda |slip|, and fast across one that it is
    // pushed onto, where it is tanh(lambda |slip|); the laws are linear.
    const double slip = c->slip_rate * factor * c->onto[belt];
    const double chi = slip > 0.0 ? slip / tanh(slip) : 1.0;
    const double level = chi * cos(c->belts[belt].incline);

    return (congested_belt){ .slower = level * (1.0 - tau),
                             .faster = level * (1.0 + tau),
                             .across = level,
                             .factor = factor,
                             .speed = speed,
                             .grip = grip_of(c, speed),
                             .lateral = most_across(s, c, belt) };
}

void congested_update(macro_solver *s)
{
    congested *c = s->congested;

    c->n_unskipped = CONGESTED_PRESSED_STEPS;
    c->has_standing = c->has_moving = false;
    for (size_t k = 0; k < c->n_belts; k++) {
        const congested_belt now = belt_now(s, c, k);
        const bool is_standing = s->factors[k] * vec2_length(c->belts[k].velocity) == 0.0;
        c->has_standing |= is_standing;
        c->has_moving |= !is_standing;
        c->is_changed[k] = memcmp(&now, &c->present[k], sizeof now) != 0;
        c->present[k] = now;
    }
    set_axis(s, c, 0);
    set_axis(s, c, 1);
    if (c->has_drives)
        set_relaxations(s, c);
    if (!c->is_forward)
        return; // no group is uniform
    set_uniform(s, c);
    for (ptrdiff_t row = 0; row < s->n2; row++)
        for (int colour = 0; colour < 2; colour++)
            find_uniform_groups(s, c, row, colour);
}
