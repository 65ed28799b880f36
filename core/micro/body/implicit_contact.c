// Setting up the constraints of a step from the contacts of bodies that overlap or are near each other.

#include "core/micro/body/implicit.h"

#include "core/base/check.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

/// Most points that overlap where others are within the margin.
#define BELOW_MAX 5

/// The points of a contact, in closed form or of hulls.
typedef struct contact_points {
    const body_contact *contact;
    size_t n;
    size_t n_below; // that overlap; they come first if the contact is one of hulls
} contact_points;

static body_contact_point contact_point_of(const contact_points *from, size_t k)
{
    const body_contact *contact = from->contact;

    if (contact->is_closed_form)
        return contact->points[k];
    const manifold_point *point = &contact->hull.point[k];
    return (body_contact_point){ point->at, contact->hull.normal, point->depth, point->weight };
}

/// Middle and mean normal of the points that overlap; of all points where none does.
static vec3 find_middle(const contact_points *from, vec3 *ret_normal)
{
    const size_t n = from->n_below > 0 ? from->n_below : from->n;
    vec3 middle = { 0.0, 0.0, 0.0 }, normal = middle;
    double sum = 0.0;

    for (size_t k = 0; k < n; k++) {
        body_contact_point contact_point = contact_point_of(from, k);
        middle = vec3_along(middle, contact_point.weight, contact_point.at);
        normal = vec3_along(normal, contact_point.weight, contact_point.normal);
        sum += contact_point.weight;
    }
    *ret_normal = n == 1 || !from->contact->is_closed_form ? contact_point_of(from, 0).normal
                                                           : vec3_unit(normal);
    return vec3_scale(middle, 1.0 / sum);
}

/// The weighted mean of n points of a face.
static body_constraint_point join_points(const body_constraint_point *points, size_t n)
{
    body_constraint_point joint = { 0 };

    if (n == 1)
        return points[0];
    for (size_t k = 0; k < n; k++) {
        joint.x += points[k].weight * points[k].x;
        joint.y += points[k].weight * points[k].y;
        joint.depth += points[k].weight * points[k].depth;
        joint.weight += points[k].weight;
    }
    joint.x /= joint.weight;
    joint.y /= joint.weight;
    joint.depth /= joint.weight;
    return joint;
}

/// Sum of weight r^2 about a middle.
static double find_spread(const body_constraint_point *points, size_t n,
                          const body_constraint_point *middle)
{
    double sum = 0.0;

    for (size_t k = 0; k < n; k++) {
        double x = points[k].x - middle->x, y = points[k].y - middle->y;
        sum += points[k].weight * (x * x + y * y);
    }
    return sum;
}

/// Reduce n points of a face to at most `most`: neighbours are joined, and the result is scaled about its
/// middle to the spread of all points, so that force and torque are preserved.
static size_t reduce_points(body_constraint_point *points, size_t n, size_t most)
{
    if (n <= most)
        return n;
    const body_constraint_point middle = join_points(points, n);
    double before = find_spread(points, n, &middle);

    for (size_t k = 0; k < most; k++) {
        size_t first = k * n / most, last = (k + 1) * n / most;
        points[k] = join_points(&points[first], last - first);
    }
    double after = find_spread(points, most, &middle);
    double factor = after > 0.0 ? sqrt(before / after) : 1.0;
    for (size_t k = 0; k < most; k++) {
        points[k].x = middle.x + factor * (points[k].x - middle.x);
        points[k].y = middle.y + factor * (points[k].y - middle.y);
        points[k].depth = middle.depth + factor * (points[k].depth - middle.depth);
    }
    return most;
}

/// Take all points of the contact, in the axes of the constraint, those that overlap first; fewer if it has more than there
/// is room for.
static void take_points(const contact_points *from, vec3 middle, body_constraint *p)
{
    const size_t most_below = from->n > from->n_below ? BELOW_MAX : BODY_CONSTRAINT_POINTS;
    const bool has_room = from->n <= BODY_CONSTRAINT_POINTS && from->n_below <= most_below;
    body_constraint_point many[MANIFOLD_POINTS_MAX], *points = has_room ? p->point : many;

    for (size_t k = 0; k < from->n; k++) {
        const body_contact_point contact_point = contact_point_of(from, k);
        const vec3 to = vec3_sub(contact_point.at, middle);
        points[k] = (body_constraint_point){ vec3_dot(p->axis[0], to), vec3_dot(p->axis[1], to),
                                             contact_point.depth, contact_point.weight };
        if (!p->is_flat)
            p->normal[k] = body_implicit__to_axes(p, contact_point.normal);
    }
    p->n = (uint32_t)from->n;
    if (!has_room) {
        // Reduce the points of a contact in place of which the constraint has fewer.
        body_constraint_point *coming = &points[from->n_below];
        const size_t n_below = reduce_points(points, from->n_below, most_below);
        const size_t n_coming =
            reduce_points(coming, from->n - from->n_below, BODY_CONSTRAINT_POINTS - n_below);
        memcpy(p->point, points, n_below * sizeof *points);
        memcpy(&p->point[n_below], coming, n_coming * sizeof *points);
        p->n = (uint32_t)(n_below + n_coming);
    }
}

/// Take the impulse of the last step, in the axes of this one.
static void take_impulse(const body_warm_start *before, body_constraint *p)
{
    if (before == NULL || before->key == 0)
        return;
    for (int k = 0; k < 3; k++) {
        p->impulse[k] = vec3_dot(p->axis[k], before->impulse);
        p->impulse[3 + k] = vec3_dot(p->axis[k], before->angular_impulse);
    }
}

/// What a constraint is made from, beside the contact.
typedef struct constraint_source {
    uint32_t a;                    // see body_constraint
    uint32_t b;                    // same
    const micro_law *law;          // of the contact
    const body_kind *belt_kind;    // see body_constraint
    const body_moving *moving;     // see body_constraint
    const body_warm_start *before; // impulse of the previous step; NULL: none
} constraint_source;

/// Make the constraint of a contact. Returns false, with undefined output, if it has no points.
static bool make_constraint(const body_state *s, const constraint_source *source,
                            const body_contact *contact, body_constraint *ret_constraint)
{
    size_t n = contact->is_closed_form ? contact->n_points : contact->hull.n;
    const contact_points from = { contact, n, contact->is_closed_form ? n : contact->hull.n_below };
    body_constraint *p = ret_constraint;
    vec3 normal;

    if (from.n == 0)
        return false;
    const vec3 middle = find_middle(&from, &normal);
    // Most of a constraint are points, which are written where they are needed.
    memset(p, 0, offsetof(body_constraint, point));
    p->a = source->a;
    p->b = source->b;
    p->belt_kind = source->belt_kind;
    p->moving = source->moving;
    p->is_flat = from.n == 1 || !contact->is_closed_form;
    p->law = *source->law;
    p->axis[2] = normal;
    p->axis[0] = source->belt_kind != NULL ? (vec3){ 1.0, 0.0, 0.0 } : vec3_aside(normal);
    p->axis[1] = vec3_cross(normal, p->axis[0]);
    p->lever[1] = vec3_sub(middle, s->bodies[p->b].x);
    if (p->a != BODY_STATIC)
        p->lever[0] = vec3_sub(middle, s->bodies[p->a].x);
    else if (p->moving != NULL)
        p->lever[0] = vec3_sub(middle, p->moving->pivot);
    take_points(&from, middle, p);
    for (uint32_t k = 0; k < p->n; k++)
        p->depth = k == 0 || p->point[k].depth > p->depth ? p->point[k].depth : p->depth;
    take_impulse(source->before, p);
    return true;
}

enum { KEY_BELT = 1, KEY_BOUNDARIES = 2 }; // of warm starts: then walls and plates by id

static const manifold_plane belt_plane = { .normal = { 0.0, 0.0, 1.0 } };

/// Memory for one more constraint.
static body_constraint *next_constraint(const body_solver *z, const body_block_buffer *buffer)
{
    BF_CHECK(buffer->n < buffer->capacity);
    return &z->constraints[buffer->first + buffer->n];
}

static void find_pair_contact(const body_state *s, double margin, body_pair *pair,
                              body_block_buffer *buffer)
{
    const body_kind *kind_a = &s->kinds[s->bodies[pair->a].kind];
    const body_kind *kind_b = &s->kinds[s->bodies[pair->b].kind];
    const micro_law law = body__law(s, kind_a, kind_b);
    const constraint_source source = { pair->a, pair->b, &law, NULL, NULL, &pair->warm_start };
    body_contact contact;

    if (!body__find_pair(s, margin, pair, &contact)) {
        pair->warm_start = (body_warm_start){ 0 };
        return;
    }
    body_constraint *constraint = next_constraint(s->implicit, buffer);
    if (!make_constraint(s, &source, &contact, constraint)) {
        pair->warm_start = (body_warm_start){ 0 };
        return;
    }
    constraint->warm_start = &pair->warm_start;
    constraint->key = 1;
    buffer->n++;
}

/// For visit_boundary(): the part whose constraints with boundaries are made.
typedef struct visitor {
    const body_state *s;
    body_block_buffer *buffer;
    const body_warm_start *before; // of the part
    body_warm_start *after;        // same, being written
    size_t n_after;
    uint32_t n_before; // constraints of the part
} visitor;

/// Returns the constraint; NULL if the contact has no point.
static body_constraint *add_boundary(visitor *v, size_t k, const micro_law *law, uint32_t key,
                                     const body_kind *belt_kind, const body_moving *moving,
                                     const body_contact *contact)
{
    constraint_source source = { BODY_STATIC, (uint32_t)k, law, belt_kind, moving, NULL };
    body_constraint *constraint = next_constraint(v->s->implicit, v->buffer);

    for (size_t i = 0; i < BODY_WARM_STARTS && source.before == NULL; i++)
        if (v->before[i].key == key)
            source.before = &v->before[i];
    if (!make_constraint(v->s, &source, contact, constraint))
        return NULL;
    if (v->n_after < BODY_WARM_STARTS)
        constraint->warm_start = &v->after[v->n_after++];
    constraint->key = key;
    constraint->colour = v->n_before++;
    v->buffer->n++;
    return constraint;
}

static void visit_boundary(void *context, size_t k, const micro_law *law, uint32_t boundary,
                           const body_contact *contact)
{
    const visitor *v = context;

    (void)add_boundary(context, k, law, KEY_BOUNDARIES + boundary, NULL,
                       body__moving_plate(v->s, boundary), contact);
}

/// The velocities, in the middle of a constraint, of the belts under its points, and their mean turn and friction. A body goes on
/// for half a step until it is in the middle of its way: else a belt that turns would lead it off its circle.
static void set_belts(body_state *s, size_t k, body_constraint *constraint)
{
    const vec3 middle = vec3_add(s->bodies[k].x, constraint->lever[1]);
    const vec3 halfway = vec3_along(middle, 0.5 * s->def.dt, s->bodies[k].v);
    const body_belt *whole = body__whole_belt(s, k);

    double friction_ratio = 0.0;

    constraint->belt_turn = 0.0;
    for (uint32_t m = 0; m < constraint->n; m++) {
        const body_constraint_point *point = &constraint->point[m];
        const vec3 at = { middle.x + point->x, middle.y + point->y, middle.z };
        const body_belt *belt = whole != NULL ? whole : body__belt_at(s, k, at);
        const vec3 velocity = body__belt_velocity(belt, halfway);
        constraint->belt_velocity[m] = (vec2){ velocity.x, velocity.y };
        constraint->belt_turn += belt->turn / constraint->n;
        friction_ratio += belt->friction_ratio;
    }
    constraint->law.friction *= friction_ratio / constraint->n;
}

static void find_belt_contact(body_state *s, size_t k, double margin, visitor *v)
{
    const body_body *body = &s->bodies[k];
    const body_kind *kind = &s->kinds[body->kind];
    body_contact contact;

    if (body->x.z >= s->bounding_radius[k] + margin)
        return;
    body__find_at_plane(s, body, &belt_plane, margin, &contact);
    body_constraint *constraint =
        add_boundary(v, k, &kind->belt_law, KEY_BELT, kind, NULL, &contact);
    if (constraint != NULL)
        set_belts(s, k, constraint);
}

static void find_boundary_contacts(body_state *s, size_t k, double margin,
                                   body_block_buffer *buffer)
{
    body_warm_start before[BODY_WARM_STARTS], *warm_starts = s->implicit->warm_starts[k];
    visitor v = { .s = s, .buffer = buffer, .before = before, .after = warm_starts };

    for (size_t m = 0; m < BODY_WARM_STARTS; m++) {
        before[m] = warm_starts[m];
        warm_starts[m] = (body_warm_start){ 0 };
    }
    body__visit_boundaries(s, k, margin, visit_boundary, &v);
    find_belt_contact(s, k, margin, &v);
}

void body_implicit__find_contacts(body_state *s, size_t block, double margin)
{
    body_block_buffer *buffer = &s->implicit->buffers[block];
    const size_t first = body__first_of(block), last = body__last_of(s, block);

    buffer->n = 0;
    for (size_t p = s->first_pair[first]; p < s->first_pair[last]; p++)
        find_pair_contact(s, margin, &s->pairs[p], buffer);
    buffer->n_pairs = buffer->n;
    for (size_t k = first; k < last; k++)
        if (!s->common.presence[k])
            find_boundary_contacts(s, k, margin, buffer);
}
