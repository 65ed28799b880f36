// Dividing the constraints of a step into batches, and their impulses after it.

#include "core/micro/body/implicit.h"

#include "core/base/check.h"
#include "core/micro/colours.h"

#include <math.h>
#include <string.h>

static size_t count_neighbours(const body_state *s, size_t k)
{
    return s->list.start[k + 1] - s->list.start[k];
}

size_t body_implicit__count_batches(const body_state *s)
{
    // Not full are at most one batch of each colour and, of each block, as many as a part has constraints. Pairs without a
    // colour have one each.
    size_t n = s->n_pairs / BODY_BATCH + BODY_COLOURS;

    for (size_t k = 0; k < s->n_pairs; k++) {
        const body_pair *pair = &s->pairs[k];
        n += count_neighbours(s, pair->a) + count_neighbours(s, pair->b) > BODY_COLOURS;
    }
    for (size_t block = 0; block < s->n_blocks; block++) {
        const body_block_buffer *buffer = &s->implicit->buffers[block];
        n += buffer->n_boundaries / BODY_BATCH + buffer->most_boundaries;
    }
    return n;
}

/// Add a constraint to the batch, which is a new one for its first constraint.
static void add_to_batch(body_constraint *constraint, size_t lane, body_batch *batch)
{
    constraint->batch = batch;
    constraint->lane = (uint32_t)lane;
    batch->constraint[lane] = constraint;
    batch->n = (uint32_t)lane + 1;
}

static void batch_pairs(const body_state *s, body_solver *z)
{
    size_t at[BODY_COLOURS + 1] = { 0 };

    memset(z->used_colours, 0, s->n * sizeof *z->used_colours);
    // Give each constraint of a pair its colour, in the order of the parts.
    for (size_t block = 0; block < s->n_blocks; block++) {
        const body_block_buffer *buffer = &z->buffers[block];
        for (size_t k = buffer->first; k < buffer->first + buffer->n_pairs; k++) {
            body_constraint *p = &z->constraints[k];
            p->colour = colours_take(&z->used_colours[p->a], &z->used_colours[p->b], BODY_COLOURS);
            at[p->colour]++;
        }
    }
    z->colour[0] = 0;
    for (int c = 0; c <= BODY_COLOURS; c++) {
        const size_t width = c < BODY_COLOURS ? BODY_BATCH : 1;
        z->colour[c + 1] = z->colour[c] + (at[c] + width - 1) / width;
        at[c] = 0;
    }
    BF_CHECK(z->colour[BODY_COLOURS + 1] <= z->batches_capacity);
    for (size_t block = 0; block < s->n_blocks; block++) {
        const body_block_buffer *buffer = &z->buffers[block];
        for (size_t k = buffer->first; k < buffer->first + buffer->n_pairs; k++) {
            body_constraint *p = &z->constraints[k];
            const size_t width = p->colour < BODY_COLOURS ? BODY_BATCH : 1, place = at[p->colour]++;
            add_to_batch(p, place % width, &z->batches[z->colour[p->colour] + place / width]);
        }
    }
}

/// Add those constraints of a block with boundaries that have `n_before` before them at their part, or its belts. Returns
/// how many.
static size_t batch_boundaries(body_solver *z, body_block_buffer *buffer, bool is_belt,
                               size_t n_before)
{
    size_t n = 0;

    for (size_t k = buffer->n_pairs; k < buffer->n; k++) {
        body_constraint *p = &z->constraints[buffer->first + k];
        const size_t batch = buffer->first_batch + buffer->n_batches + n / BODY_BATCH;
        if ((p->belt_kind != NULL) != is_belt || (!is_belt && p->colour != n_before))
            continue;
        BF_CHECK(batch < z->batches_capacity);
        add_to_batch(p, n++ % BODY_BATCH, &z->batches[batch]);
    }
    buffer->n_batches += (n + BODY_BATCH - 1) / BODY_BATCH;
    return n;
}

void body_implicit__make_batches(const body_state *s)
{
    body_solver *z = s->implicit;

    batch_pairs(s, z);
    size_t n = z->colour[BODY_COLOURS + 1];
    for (size_t block = 0; block < s->n_blocks; block++) {
        body_block_buffer *buffer = &z->buffers[block];
        size_t n_before = 0;
        buffer->first_batch = n;
        buffer->n_batches = 0;
        while (batch_boundaries(z, buffer, false, n_before) > 0)
            n_before++;
        (void)batch_boundaries(z, buffer, true, 0);
        n += buffer->n_batches;
    }
}

/// r x a for the axis a = k.
static vec3 cross_axis(vec3 r, int k)
{
    const vec3 rows[] = { { 0.0, r.z, -r.y }, { -r.z, 0.0, r.x }, { r.y, -r.x, 0.0 } };

    return rows[k];
}

/// The effective mass of one body in the middle of its constraint.
static void fill_inertia(const body_state *s, const body_constraint *p, size_t lane,
                         body_batch *batch)
{
    const body_body *body = &s->bodies[p->b];
    const body_kind *kind = &s->kinds[body->kind];
    const vec3 r = body_implicit__to_axes(p, p->lever[1]), i = kind->inertia;
    const double square = vec3_dot(r, r);
    vec3 own[3];

    for (int k = 0; k < 3; k++) {
        own[k] = mat3_apply_back(&body->r, p->axis[k]);
        for (int m = 0; m < 3; m++)
            batch->inertia[body_entry(3 + k, m)][lane] =
                -kind->mass * vec3_component(cross_axis(r, m), k);
        for (int m = 0; m <= k; m++) {
            double turning = i.x * own[k].x * own[m].x + i.y * own[k].y * own[m].y +
                             i.z * own[k].z * own[m].z -
                             kind->mass * vec3_component(r, k) * vec3_component(r, m);
            batch->inertia[body_entry(k, m)][lane] = m < k ? 0.0 : kind->mass;
            batch->inertia[body_entry(3 + k, 3 + m)][lane] =
                m < k ? turning : turning + kind->mass * square;
        }
    }
}

static void fill_vector(vec3 from, size_t lane, body_lanes *to)
{
    to[0][lane] = from.x;
    to[1][lane] = from.y;
    to[2][lane] = from.z;
}

/// The gains of the points, and the impulse of the last step distributed to them by weight.
static void fill_points(const body_state *s, const body_constraint *p, size_t lane,
                        body_batch *batch)
{
    const double h = s->def.dt, joint = h * p->law.stiffness + p->law.damping;
    const double normal_impulse = p->impulse[2] > 0.0 ? p->impulse[2] : 0.0;
    const vec3 up = { 0.0, 0.0, 1.0 };
    double sum = 0.0;

    for (uint32_t k = 0; k < p->n; k++)
        sum += p->point[k].weight;
    for (uint32_t k = 0; k < p->n; k++) {
        const body_constraint_point *from = &p->point[k];
        body_batch_point *to = &batch->point[k];
        double overlap = from->depth > 0.0 ? from->depth : 0.0;
        to->x[lane] = from->x;
        to->y[lane] = from->y;
        if (!batch->is_flat)
            fill_vector(p->is_flat ? up : p->normal[k], lane, to->normal);
        to->gain[lane] = from->weight * h * joint;
        to->bias[lane] = from->weight * (joint * from->depth - p->law.damping * overlap);
        to->lower_bound[lane] = s->def.tension && from->depth > 0.0 ? -HUGE_VAL : 0.0;
        to->normal_impulse[lane] = normal_impulse * from->weight / sum;
    }
    for (uint32_t k = p->n; k < batch->n_points; k++) {
        double *lanes = &batch->point[k].x[lane];
        for (size_t m = 0; m < sizeof *batch->point / sizeof(body_lanes); m++)
            lanes[m * BODY_BATCH] = 0.0;
    }
    batch->normal_impulse[lane] = normal_impulse;
}

static void fill_lane(const body_state *s, const body_constraint *p, size_t lane, body_batch *batch)
{
    batch->row[1][lane] = p->b * BODY_SOLVER_ROW;
    for (int k = 0; k < 3; k++)
        fill_vector(p->axis[k], lane, batch->axis[k]);
    fill_vector(p->lever[1], lane, batch->lever[1]);
    batch->friction[lane] = p->law.friction;
    batch->rate[lane] = p->law.tanh_linear;
    for (int k = 0; k < 6; k++)
        batch->impulse[k][lane] = p->impulse[k];
    fill_points(s, p, lane, batch);
    if (batch->is_pair) {
        batch->row[0][lane] = p->a * BODY_SOLVER_ROW;
        fill_vector(p->lever[0], lane, batch->lever[0]);
        return;
    }
    // The velocity of the boundary.
    vec3 velocity = { 0.0, 0.0, 0.0 };
    if (p->moving != NULL)
        velocity = body__surface_velocity(p->moving, p->axis[2], p->lever[0]);
    fill_vector(velocity, lane, batch->surface);
    batch->surface[3][lane] = p->moving != NULL ? p->moving->spin : 0.0;
    fill_inertia(s, p, lane, batch);
    if (batch->is_belt) {
        const micro_law *law = &p->law;
        batch->spin_friction[lane] = law->friction * p->belt_kind->spin_radius;
        batch->spin_rate[lane] = law->tanh_spin;
        batch->gyration[lane] = p->belt_kind->flat_gyration;
        batch->belt_turn[lane] = p->belt_turn;
        for (uint32_t k = 0; k < p->n; k++) {
            batch->point[k].belt_velocity[0][lane] = p->belt_velocity[k].x;
            batch->point[k].belt_velocity[1][lane] = p->belt_velocity[k].y;
        }
    }
}

void body_implicit__fill_batch(const body_state *s, body_batch *batch)
{
    const body_constraint *first = batch->constraint[0];

    batch->is_pair = first->a != BODY_STATIC;
    batch->is_belt = first->belt_kind != NULL;
    batch->has_inertia = !batch->is_pair;
    batch->is_flat = true;
    batch->n_points = 0;
    for (uint32_t k = 0; k < batch->n; k++) {
        const body_constraint *p = batch->constraint[k];
        batch->is_flat = batch->is_flat && p->is_flat;
        batch->n_points = p->n > batch->n_points ? p->n : batch->n_points;
    }
    for (uint32_t lane = 0; lane < BODY_BATCH; lane++)
        fill_lane(s, batch->constraint[lane < batch->n ? lane : batch->n - 1], lane, batch);
}

/// Components first .. first + 2 of the impulse, in the world's frame.
static vec3 to_world(const body_constraint *p, int first)
{
    const double x = p->batch->impulse[first][p->lane], y = p->batch->impulse[first + 1][p->lane],
                 z = p->batch->impulse[first + 2][p->lane];

    return vec3_along(vec3_along(vec3_scale(p->axis[0], x), y, p->axis[1]), z, p->axis[2]);
}

void body_implicit__store_warm_start(const body_constraint *constraint)
{
    if (constraint->warm_start != NULL)
        *constraint->warm_start =
            (body_warm_start){ constraint->key, to_world(constraint, 0), to_world(constraint, 3) };
}
