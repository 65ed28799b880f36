// Explicit steps: the force of every pair, then the motion of every part by the sum of its forces. The members
// of a team work on blocks of parts.

#include "core/micro/body/body_priv.h"

#include <math.h>

/// Largest displacement in a step, in bounding radii of the smallest part; more is an error.
#define STEP_MAX 0.5

size_t body__first_of(size_t block)
{
    return block * BODY_BLOCK;
}

size_t body__last_of(const body_state *s, size_t block)
{
    size_t last = body__first_of(block) + BODY_BLOCK;

    return last < s->n ? last : s->n;
}

static void find_block_forces(const driver_member *m, size_t block)
{
    body_state *s = m->state;
    size_t last = s->first_pair[body__last_of(s, block)];

    s->reports[block].n_contacts = 0;
    for (size_t p = s->first_pair[body__first_of(block)]; p < last; p++)
        body__find_pair_force(s, &s->pairs[p], &s->reports[block]);
}

/// Solve m x = b by Cramer's rule.
static vec3 solve(const mat3 *m, vec3 b)
{
    vec3 c0 = mat3_column(m, 0), c1 = mat3_column(m, 1), c2 = mat3_column(m, 2);
    double det = vec3_dot(c0, vec3_cross(c1, c2));

    return (vec3){ vec3_dot(b, vec3_cross(c1, c2)) / det, vec3_dot(c0, vec3_cross(b, c2)) / det,
                   vec3_dot(c0, vec3_cross(c1, b)) / det };
}

/// The angular velocity after a step without torque, in the body's axes: w+ = w - dt Theta^-1 (w+ x Theta w+).
static vec3 turn_freely(vec3 inertia, double dt, vec3 w)
{
    vec3 l = { inertia.x * w.x, inertia.y * w.y, inertia.z * w.z };
    vec3 residual = vec3_scale(vec3_cross(w, l), dt);
    // The derivative of Theta w + dt w x Theta w.
    mat3 m = {
        { { inertia.x, dt * (inertia.z - inertia.y) * w.z, dt * (inertia.z - inertia.y) * w.y },
          { dt * (inertia.x - inertia.z) * w.z, inertia.y, dt * (inertia.x - inertia.z) * w.x },
          { dt * (inertia.y - inertia.x) * w.y, dt * (inertia.y - inertia.x) * w.x, inertia.z } }
    };

    return vec3_sub(w, solve(&m, residual));
}

vec3 body__integrate_spin(const body_state *s, const body_body *body, vec3 torque)
{
    const vec3 inertia = s->kinds[body->kind].inertia;
    const double dt = s->def.dt;
    vec3 t = mat3_apply_back(&body->r, torque), w = mat3_apply_back(&body->r, body->w);

    w = vec3_scale(w, s->spin_damping);
    w = vec3_along(w, dt, (vec3){ t.x / inertia.x, t.y / inertia.y, t.z / inertia.z });
    return mat3_apply(&body->r, turn_freely(inertia, dt, w));
}

/// Move by the velocities. Returns the squared displacement.
static double drift(body_body *body, double dt)
{
    vec3 way = vec3_scale(body->v, dt);
    quat rate = quat_multiply((quat){ 0.0, body->w }, body->q);

    body->x = vec3_add(body->x, way);
    body->q =
        quat_unit((quat){ body->q.w + 0.5 * dt * rate.w, vec3_along(body->q.v, 0.5 * dt, rate.v) });
    body->r = mat3_of_quat(body->q);
    return vec3_dot(way, way);
}

void body__move(body_state *s, size_t k, body_report *report)
{
    body_body *body = &s->bodies[k];
    const double step_max = STEP_MAX * s->bounding_radius_min;
    double way = drift(body, s->def.dt), spin = vec3_dot(body->w, body->w);

    if (!(way <= step_max * step_max) || !isfinite(spin)) {
        if (report->bad_part == SIZE_MAX)
            report->bad_part = k;
        return;
    }
    if (surroundings_is_outside(&s->common.around, (vec2){ body->x.x, body->x.y }))
        s->common.presence[k] = MICRO_LEFT;
    else if (body__falls(s, k))
        s->common.presence[k] = MICRO_FELL;
}

static void move_part(body_state *s, size_t k, bool is_first, body_report *report)
{
    body_body *body = &s->bodies[k];
    const double dt = s->def.dt;

    // The first step is forward Euler, with the initial velocities.
    if (!is_first) {
        double mass = s->kinds[body->kind].mass;
        body_load load = { .torque = { 0.0, 0.0, 0.0 } };
        // Add the forces of the neighbours of part k.
        for (size_t at = s->list.start[k]; at < s->list.start[k + 1]; at++) {
            const body_pair *pair = &s->pairs[s->links[at]];
            if (!pair->has_force)
                continue;
            bool is_a = pair->a == k;
            load.force =
                is_a ? vec3_sub(load.force, pair->force) : vec3_add(load.force, pair->force);
            load.torque = vec3_add(load.torque, is_a ? pair->torque_a : pair->torque_b);
        }
        body__add_boundary_forces(s, k, &load, report);
        body__add_belt_forces(s, k, &load);
        load.force = vec3_along(load.force, mass, body__gravity(s, k));
        double dt_over_mass = dt / mass;
        body->v =
            vec3_along(vec3_scale(body->v, 1.0 - s->def.damping * dt), dt_over_mass, load.force);
        body->w = body__integrate_spin(s, body, load.torque);
    }
    body__move(s, k, report);
    report->is_stale |= !neighbours_holds(s->list.skin, sqrt(body__moved2(s, k)));
}

static void move_block(const driver_member *m, size_t block)
{
    body_state *s = m->state;
    const bool is_first = s->common.steps + m->n_made == 0;

    for (size_t k = body__first_of(block); k < body__last_of(s, block); k++)
        if (!s->common.presence[k])
            move_part(s, k, is_first, &s->reports[block]);
}

bf_status body__check(const void *state, bf_error *err)
{
    const body_state *s = state;
    size_t bad = SIZE_MAX;
    bool is_pressed = false;

    for (size_t block = 0; block < s->n_blocks; block++) {
        bad = s->reports[block].bad_part < bad ? s->reports[block].bad_part : bad;
        is_pressed |= micro__is_pressed(s->reports[block].overlap_share, &s->def);
    }
    if (bad == SIZE_MAX)
        return is_pressed
                   ? bf_fail(err, BF_ENUMERIC, "", "parts overlap by more than overlap_limit")
                   : BF_OK;
    const body_body *body = &s->bodies[bad];
    return bf_fail(err, BF_ENUMERIC, "",
                   "part %zu flies off or is not finite after step %llu (t = %.6g s): it is at "
                   "(%.6g, %.6g, %.6g) m with %.6g m/s",
                   bad, (unsigned long long)s->common.steps, (double)s->common.steps * s->def.dt,
                   body->x.x, body->x.y, body->x.z, vec3_length(body->v));
}

driver_outcome body__find_outcome(const body_state *s)
{
    driver_outcome outcome = DRIVER_MADE;

    for (size_t block = 0; block < s->n_blocks; block++) {
        if (s->reports[block].bad_part != SIZE_MAX ||
            micro__is_pressed(s->reports[block].overlap_share, &s->def))
            return DRIVER_SUSPECT;
        if (s->reports[block].is_stale)
            outcome = DRIVER_STALE;
    }
    return outcome;
}

static bf_status refresh(void *state, bf_error *err)
{
    body_state *s = state;

    return s->is_listed ? BF_OK : body__list(s, err);
}

int body__begin(const void *state, driver_progress *ret_progress)
{
    const body_state *s = state;

    *ret_progress = (driver_progress){ .displacement_bound = 0.0 };
    // A thread without a block of parts only waits for the others, at every barrier of a step.
    const size_t n_of_use = s->n_blocks > 0 ? s->n_blocks : 1;
    return (size_t)s->def.n_threads < n_of_use ? s->def.n_threads : (int)n_of_use;
}

static driver_outcome step(driver_member *m)
{
    body_state *s = m->state;

    // Forces of belts and plates are made after the barrier.
    if (m->index == 0) {
        body__update_belts(s, s->common.steps + m->n_made);
        body__pose_plates(s, s->common.steps + m->n_made);
    }
    driver_split(m, 0, s->n_blocks, find_block_forces);
    driver_wait(m);
    driver_split(m, 0, s->n_blocks, move_block);
    driver_wait(m);
    const driver_outcome outcome = body__find_outcome(s);
    driver_wait(m); // the forces of the next step raise the overlaps that it looks at
    return outcome;
}

void body__end(void *state, uint64_t n, driver_outcome outcome, const driver_progress *progress)
{
    body_state *s = state;

    (void)progress;
    s->common.steps += n;
    body__pose_plates(s, s->common.steps);
    s->is_listed = outcome == DRIVER_MADE;
}

bf_status body__advance(void *state, uint64_t n, bf_error *err)
{
    static const driver_solver explicit = { .refresh = refresh,
                                            .begin = body__begin,
                                            .step = step,
                                            .end = body__end,
                                            .check = body__check };
    body_state *s = state;

    for (size_t block = 0; block < s->n_blocks; block++)
        s->reports[block] = (body_report){ .bad_part = SIZE_MAX };
    bf_status status = driver_advance(s->implicit != NULL ? &body__implicit : &explicit, s, n, err);
    if (n > 0)
        s->n_contacts = 0;
    for (size_t block = 0; block < s->n_blocks; block++) {
        const body_report *report = &s->reports[block];
        micro__take_overlaps(&s->common, report->overlap, report->overlap_share);
        s->n_contacts += report->n_contacts;
    }
    return status;
}
