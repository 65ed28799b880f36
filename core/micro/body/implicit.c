// Implicit steps in space.
//
// The members of a team wait for each other between the phases of a step. In a phase every member works on some
// of the blocks of parts, or of the slices of a colour, none of which writes what another one reads.

#include "core/micro/body/implicit.h"
#include "core/base/memory.h"
#include "core/micro/body/parts.h"
#include "core/micro/hardness.h"
#include "core/micro/implicit_step.h"

#include <math.h>
#include <string.h>

#define X(suffix) extern const body_kernels body_kernels_##suffix;
CPU_EACH_BUILD(X)
#undef X

/// Twice the displacement after which the list is built again, in bounding radii of the smallest part.
#define SKIN 1.0

/// Range of the map of plates, in bounding radii of the largest part: covers all plates that a part may come
/// into contact with before the list is built again.
#define PLATE_RANGE 2.0

const body_kernels *body__implicit_kernels(cpu_level level)
{
    static const body_kernels *const builds[] = {
#define X(suffix) &body_kernels_##suffix,
        CPU_EACH_BUILD(X)
#undef X
    };

    return builds[level];
}

size_t body__implicit_arrays(body_solver *z, size_t n, size_t capacity, memory_array *ret_arrays)
{
    const memory_array arrays[] = {
        { &z->warm_starts, sizeof *z->warm_starts, n, capacity },
        { &z->solver_bodies, sizeof *z->solver_bodies, 0, capacity },
        { &z->used_colours, sizeof *z->used_colours, 0, capacity },
        { &z->buffers, sizeof *z->buffers, 0, (capacity + BODY_BLOCK - 1) / BODY_BLOCK },
    };

    memcpy(ret_arrays, arrays, sizeof arrays);
    return sizeof arrays / sizeof *arrays;
}

bf_status body__implicit_init(body_state *s, bf_error *err)
{
    memory_array arrays[MEMORY_ARRAYS_MAX];
    body_solver *z = s->implicit = memory_alloc(1, sizeof *s->implicit);

    if (z == NULL || memory_resize(arrays, body__implicit_arrays(z, 0, s->capacity, arrays)) != 0)
        return bf_fail(err, BF_ENOMEM, "/initial", "no memory for %zu parts", s->n);
    z->kernels = body__implicit_kernels(cpu_best());
    // The largest number of iterations that a kind of part requires.
    const double damping = fmax(s->cargo.damping, s->def.contact[SCENE_HANDLING_CARGO].damping);
    z->iterations = 1;
    for (size_t k = 0; k < s->n_kinds; k++) {
        const body_kind *kind = &s->kinds[k];
        double stiffness =
            fmax(s->cargo.stiffness / (2.0 * kind->compliance), kind->boundary_law.stiffness);
        int own = implicit_step_iterations(
            false, micro__n_expected(&s->def), s->def.dt, stiffness,
            hardness_dashpot(&s->def, damping, stiffness, 1.0 / kind->mass), kind->mass);
        z->iterations = own > z->iterations ? own : z->iterations;
    }
    z->damping_factor = exp(-s->def.damping * s->def.dt);
    s->list.skin = SKIN * s->bounding_radius_min;
    s->map_range = PLATE_RANGE * s->bounding_radius_max;
    return BF_OK;
}

void body__implicit_fini(body_state *s)
{
    body_solver *z = s->implicit;

    if (z == NULL)
        return;
    memory_free(z->warm_starts);
    memory_free(z->solver_bodies);
    memory_free(z->used_colours);
    memory_free(z->buffers);
    memory_free(z->constraints);
    memory_free(z->batches);
    memory_free(z);
}

/// Reserve memory for all constraints until the list is stale: one for each pair, and one for each boundary
/// and belt that a part may come near to until then.
static bf_status make_room(body_state *s, bf_error *err)
{
    body_solver *z = s->implicit;
    size_t n = 0;

    for (size_t block = 0; block < s->n_blocks; block++) {
        const size_t begin = body__first_of(block), end = body__last_of(s, block);
        body_block_buffer *buffer = &z->buffers[block];
        buffer->first = n;
        buffer->n_boundaries = buffer->most_boundaries = 0;
        for (size_t k = begin; k < end; k++) {
            const size_t n_own = 1 + body__count_boundaries(s, k, s->list.skin);
            buffer->n_boundaries += n_own;
            if (n_own > buffer->most_boundaries)
                buffer->most_boundaries = n_own;
        }
        buffer->capacity = s->first_pair[end] - s->first_pair[begin] + buffer->n_boundaries + 1;
        n += buffer->capacity;
    }
    if (memory_reserve(&z->constraints, &z->constraints_capacity, n, sizeof *z->constraints) != 0 ||
        memory_reserve(&z->batches, &z->batches_capacity, body_implicit__count_batches(s),
                       sizeof *z->batches) != 0) {
        s->is_listed = false;
        return bf_fail(err, BF_ENOMEM, "", "no memory for the contacts of %zu parts", s->n);
    }
    return BF_OK;
}

static bf_status refresh(void *state, bf_error *err)
{
    body_state *s = state;

    return s->is_listed || (body__list(s, err) == BF_OK && make_room(s, err) == BF_OK) ? BF_OK
                                                                                       : BF_ENOMEM;
}

/// Velocities of a body after a step without contacts.
static void predict_part(body_state *s, size_t k, body_block_buffer *buffer)
{
    const body_body *body = &s->bodies[k];
    const body_kind *kind = &s->kinds[body->kind];
    const vec3 nothing = { 0.0, 0.0, 0.0 };
    body_solver_body *solver_body = &s->implicit->solver_bodies[k];

    solver_body->v = vec3_along(vec3_scale(body->v, s->implicit->damping_factor), s->def.dt,
                                body__gravity(s, k));
    solver_body->w = body__integrate_spin(s, body, nothing);
    solver_body->inv_mass = 1.0 / kind->mass;
    // Inverse inertia of a body in the world's frame.
    const vec3 inertia = kind->inertia;
    const vec3 x = mat3_column(&body->r, 0), y = mat3_column(&body->r, 1),
               z = mat3_column(&body->r, 2);
    mat3 inverse;
    for (int axis = 0; axis < 3; axis++) {
        vec3 row = vec3_scale(x, vec3_component(x, axis) / inertia.x);
        row = vec3_along(row, vec3_component(y, axis) / inertia.y, y);
        inverse.row[axis] = vec3_along(row, vec3_component(z, axis) / inertia.z, z);
    }
    solver_body->inv_inertia = inverse;
    double before = vec3_length(body->v) + s->bounding_radius[k] * vec3_length(body->w);
    double then = vec3_length(solver_body->v) + s->bounding_radius[k] * vec3_length(solver_body->w);
    buffer->speed = fmax(buffer->speed, fmax(before, then));
    buffer->moved2 = fmax(buffer->moved2, body__moved2(s, k));
}

static void predict_block(const driver_member *m, size_t block)
{
    body_state *s = m->state;
    body_block_buffer *buffer = &s->implicit->buffers[block];

    buffer->speed = buffer->moved2 = 0.0;
    s->reports[block].n_contacts = 0;
    for (size_t k = body__first_of(block); k < body__last_of(s, block); k++)
        if (!s->common.presence[k])
            predict_part(s, k, buffer);
}

/// The margin of contacts in this step, m. Returns false if the list may lack some of them.
static bool find_margin(const body_state *s, double *ret_margin)
{
    const double skin = s->list.skin;
    double speed = 0.0, moved2 = 0.0;

    for (size_t block = 0; block < s->n_blocks; block++) {
        speed = fmax(speed, s->implicit->buffers[block].speed);
        moved2 = fmax(moved2, s->implicit->buffers[block].moved2);
    }
    *ret_margin = fmin(2.0 * s->def.dt * (speed + body__plates_speed(s)), 0.5 * skin);
    return neighbours_holds(skin, sqrt(moved2) + 0.5 * *ret_margin);
}

static void find_block_contacts(const driver_member *m, size_t block)
{
    const double *margin = m->step;

    body_implicit__find_contacts(m->state, block, *margin);
}

static void warm_start(const driver_member *m, size_t batch)
{
    const body_state *s = m->state;
    const body_solver *z = s->implicit;

    body_implicit__fill_batch(s, &z->batches[batch]);
    z->kernels->warm_start(z->solver_bodies, &z->batches[batch]);
}

static void solve(const driver_member *m, size_t batch)
{
    const body_solver *z = ((const body_state *)m->state)->implicit;

    z->kernels->solve(z->solver_bodies, &z->batches[batch]);
}

/// Work on all constraints once: those with boundaries, then those of pairs by colours.
static void sweep(const driver_member *m, driver_work *work)
{
    const body_state *s = m->state;
    const body_solver *z = s->implicit;

    for (size_t block = (size_t)m->index; block < s->n_blocks; block += (size_t)m->n_members) {
        const body_block_buffer *buffer = &z->buffers[block];
        for (size_t k = 0; k < buffer->n_batches; k++)
            work(m, buffer->first_batch + k);
    }
    driver_wait(m);
    driver_split_groups(m, z->colour, BODY_COLOURS + 1, BODY_SLICE, work);
}

/// Store the warm starts of a block, and move its parts.
static void move_block(const driver_member *m, size_t block)
{
    body_state *s = m->state;
    const body_solver *z = s->implicit;
    const body_block_buffer *buffer = &z->buffers[block];

    for (size_t k = buffer->first; k < buffer->first + buffer->n; k++) {
        const body_constraint *p = &z->constraints[k];
        body_implicit__store_warm_start(p);
        double half_width = s->kinds[s->bodies[p->b].kind].half_width;
        if (p->a != BODY_STATIC)
            half_width = fmin(half_width, s->kinds[s->bodies[p->a].kind].half_width);
        if (p->belt_kind == NULL && p->batch->normal_impulse[p->lane] > 0.0 && p->depth > 0.0)
            body__note(&s->reports[block], p->b, p->a, p->depth, half_width);
    }
    for (size_t k = body__first_of(block); k < body__last_of(s, block); k++) {
        if (s->common.presence[k])
            continue;
        s->bodies[k].v = z->solver_bodies[k].v;
        s->bodies[k].w = z->solver_bodies[k].w;
        body__move(s, k, &s->reports[block]);
    }
}

static void split_blocks(const driver_member *m, driver_work *work)
{
    driver_split(m, 0, ((const body_state *)m->state)->n_blocks, work);
    driver_wait(m);
}

static driver_outcome step(driver_member *m)
{
    body_state *s = m->state;
    double margin; // m, gaps that may close in this step

    // Contacts with belts and plates are made after the barrier.
    if (m->index == 0) {
        body__update_belts(s, s->common.steps + m->n_made);
        body__pose_plates(s, s->common.steps + m->n_made);
    }
    split_blocks(m, predict_block);
    if (!find_margin(s, &margin))
        return DRIVER_NOT_MADE;
    m->step = &margin;
    split_blocks(m, find_block_contacts);
    if (m->index == 0)
        body_implicit__make_batches(s);
    driver_wait(m);
    sweep(m, warm_start);
    for (int iteration = 0; iteration < s->implicit->iterations; iteration++)
        sweep(m, solve);
    split_blocks(m, move_block);
    return body__find_outcome(s);
}

const driver_solver body__implicit = {
    .refresh = refresh, .begin = body__begin, .step = step, .end = body__end, .check = body__check
};
