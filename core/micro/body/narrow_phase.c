// Contacts of bodies and the forces in them.
//
// Cylinders that stand side by side or near a plate, or lie against a plane, have a line contact, whose two ends are
// the contact points, each with half of stiffness and dashpot. Axes at an angle t of less than about 0.1 count as
// parallel: the distance is measured at both ends of their common height, with an error of r t^2/2.

#include "core/micro/body/narrow_phase.h"

#include "core/micro/body/body_priv.h"
#include "core/micro/friction.h"

#include <math.h>

/// Larger than 1, against rounding.
#define ROUNDING_FACTOR 1.0001

vec3 body__friction_force(const micro_law *law, double force, vec3 slip)
{
    return vec3_scale(slip,
                      -friction_secant(law->friction, force, law->tanh_linear, vec3_length(slip)));
}

void body__note(body_report *report, uint32_t k, uint32_t other, double overlap, double radius)
{
    double overlap_share = overlap / radius;

    report->n_contacts++;
    report->overlap = overlap > report->overlap ? overlap : report->overlap;
    if (overlap_share <= report->overlap_share)
        return;
    report->overlap_share = overlap_share;
    report->pressed[0] = k;
    report->pressed[1] = other;
}

/// Search for the contact from memory->axis. Returns false if the hulls are farther apart than the margin.
static bool search(const gjk_pair *pair, double margin, body_memory *memory, manifold *ret_manifold)
{
    memory->feature.kind = MANIFOLD_NONE;
    memory->gap = gjk_find_gap(pair, &memory->axis);
    if (memory->gap > margin)
        return false;
    gjk_result result = gjk_measure(pair, memory->axis);
    memory->axis = result.normal;
    memory->gap = result.distance > margin ? result.distance : 0.0;
    if (result.distance > 0.0 && result.distance >= margin)
        return false;
    memory->feature = manifold_feature_of(pair, &result);
    manifold_find(pair, memory->feature, margin, ret_manifold);
    // Hulls that do not overlap may be nearest in a corner, which is no feature.
    bool is_carried = ret_manifold->is_least || result.distance <= 0.0;
    if (ret_manifold->n == 0 || !is_carried)
        manifold_from_result(&result, ret_manifold);
    if (!is_carried)
        memory->feature.kind = MANIFOLD_NONE;
    return true;
}

static bool find_region(const gjk_pair *pair, double margin, body_memory *memory,
                        manifold *ret_manifold)
{
    if (vec3_dot(memory->axis, memory->axis) == 0.0)
        memory->axis = vec3_dot(pair->translation, pair->translation) > 0.0
                           ? pair->translation
                           : (vec3){ 1.0, 0.0, 0.0 };
    if (memory->feature.kind != MANIFOLD_NONE) {
        manifold_find(pair, memory->feature, margin, ret_manifold);
        memory->axis = ret_manifold->normal;
        if (ret_manifold->depth > -margin && ret_manifold->is_least)
            return true;
    }
    return search(pair, margin, memory, ret_manifold);
}

bool body__find_manifold(const gjk_pair *pair, double margin, body_memory *memory,
                         manifold *ret_manifold)
{
    if (!find_region(pair, margin, memory, ret_manifold))
        return false;
    if (margin > 0.0 && ret_manifold->n == 1)
        manifold_widen(pair, margin, ret_manifold);
    return true;
}

bool body__contact_force(const body_state *s, const micro_law *law, vec3 normal,
                         const manifold_point *point, vec3 velocity, vec3 *ret_force)
{
    double approach = vec3_dot(velocity, normal);
    double normal_force = body__normal_force(s, law, point->depth, point->weight, approach);

    if (normal_force == 0.0)
        return false;
    vec3 friction =
        body__friction_force(law, normal_force, vec3_along(velocity, -approach, normal));
    *ret_force = vec3_along(friction, normal_force, normal);
    return true;
}

/// Add the force in one contact point; the normal is from a to b. Returns true if it is not zero.
static bool add_point(const body_state *s, const micro_law *law, body_pair *pair, vec3 normal,
                      const manifold_point *point)
{
    const body_body *a = &s->bodies[pair->a], *b = &s->bodies[pair->b];
    vec3 velocity = vec3_sub(body__velocity(b, point->at), body__velocity(a, point->at));
    vec3 force;

    if (!body__contact_force(s, law, normal, point, velocity, &force))
        return false;
    pair->force = vec3_add(pair->force, force);
    pair->torque_a = vec3_sub(pair->torque_a, vec3_cross(vec3_sub(point->at, a->x), force));
    pair->torque_b = vec3_add(pair->torque_b, vec3_cross(vec3_sub(point->at, b->x), force));
    return true;
}

/// True if two bodies that were apart cannot be within the margin yet: reduce their gap by the bound of
/// their displacement in the last step.
static bool is_still_apart(const body_state *s, double margin, body_pair *pair)
{
    const body_body *a = &s->bodies[pair->a], *b = &s->bodies[pair->b];

    if (pair->memory.gap <= margin)
        return false;
    double speed = vec3_length(vec3_sub(b->v, a->v)) +
                   vec3_length(a->w) * s->bounding_radius[pair->a] +
                   vec3_length(b->w) * s->bounding_radius[pair->b];
    pair->memory.gap -= ROUNDING_FACTOR * s->def.dt * speed;
    return pair->memory.gap > margin;
}

/// The manifold of two hulls in the world's frame. Returns false if they are apart.
static bool find_hulls(const body_state *s, double margin, body_pair *pair, manifold *m)
{
    const body_body *a = &s->bodies[pair->a], *b = &s->bodies[pair->b];
    gjk_pair hulls =
        gjk_pair_of(&s->kinds[a->kind].shape, a->x, &a->r, &s->kinds[b->kind].shape, b->x, &b->r);

    if (!body__find_manifold(&hulls, margin, &pair->memory, m))
        return false;
    m->normal = mat3_apply(&a->r, m->normal);
    for (size_t k = 0; k < m->n; k++)
        m->point[k].at = vec3_add(mat3_apply(&a->r, m->point[k].at), a->x);
    return true;
}

/// Cosine of the largest angle between axes that count as parallel.
#define UPRIGHT 0.995

/// A cylinder lies against a plane if the cosine between its axis and the normal is below this.
#define ON_ITS_SIDE M_SQRT1_2

/// The contact point of two circles around p and q. Returns 0 if there is none, else 1.
static size_t find_circle_contact(vec3 p, double radius_p, vec3 q, double radius_q, vec3 along,
                                  double margin, body_contact_point *ret_point)
{
    vec3 to = vec3_sub(q, p);
    double distance = vec3_length(to), depth = radius_p + radius_q - distance;
    vec3 normal = distance > 0.0 ? vec3_scale(to, 1.0 / distance) : vec3_aside(along);

    if (depth <= -margin)
        return 0;
    *ret_point =
        (body_contact_point){ vec3_along(p, radius_p - 0.5 * depth, normal), normal, depth, 0.5 };
    return 1;
}

static bool find_cylinder_pair(const body_state *s, const body_body *a, const body_body *b,
                               double margin, body_contact_point *ret_points, size_t *ret_n)
{
    const body_kind *kind_a = &s->kinds[a->kind], *kind_b = &s->kinds[b->kind];
    vec3 axis_a = mat3_column(&a->r, 2), axis_b = mat3_column(&b->r, 2), to = vec3_sub(b->x, a->x);
    double h_a = kind_a->half_height, h_b = kind_b->half_height;

    if (!kind_a->is_cylinder || !kind_b->is_cylinder || fabs(vec3_dot(axis_a, axis_b)) < UPRIGHT)
        return false;
    if (vec3_dot(axis_a, axis_b) < 0.0)
        axis_b = vec3_scale(axis_b, -1.0);
    vec3 along = vec3_unit(vec3_add(axis_a, axis_b));
    double lift = vec3_dot(to, along);
    double low = fmax(-h_a, lift - h_b), high = fmin(h_a, lift + h_b), common_height = high - low;
    double radial = vec3_length(vec3_along(to, -lift, along));
    double depth = kind_a->radius + kind_b->radius - radial;
    // A cylinder on top of the other is left to the hulls.
    if (common_height <= 0.0 || (common_height < fmin(h_a, h_b) && depth > common_height))
        return false;
    *ret_n = 0;
    for (int end = 0; end < 2; end++) {
        double at = end == 0 ? low : high;
        vec3 p = vec3_along(a->x, at / vec3_dot(axis_a, along), axis_a);
        vec3 q = vec3_along(b->x, (at - lift) / vec3_dot(axis_b, along), axis_b);
        *ret_n += find_circle_contact(p, kind_a->radius, q, kind_b->radius, along, margin,
                                      &ret_points[*ret_n]);
    }
    return true;
}

static bool find_cylinder_at_plane(const body_state *s, const body_body *body,
                                   const manifold_plane *plane, double margin,
                                   body_contact_point *ret_points, size_t *ret_n)
{
    const body_kind *kind = &s->kinds[body->kind];
    vec3 axis = mat3_column(&body->r, 2);
    double cosine = vec3_dot(axis, plane->normal);

    if (!kind->is_cylinder || fabs(cosine) > ON_ITS_SIDE)
        return false;
    // From the axis towards the deepest point of either rim.
    vec3 down = vec3_unit(vec3_along(vec3_scale(axis, cosine), -1.0, plane->normal));
    *ret_n = 0;
    for (int end = -1; end <= 1; end += 2) {
        vec3 rim =
            vec3_along(vec3_along(body->x, end * kind->half_height, axis), kind->radius, down);
        double depth = plane->offset - vec3_dot(plane->normal, rim);
        if (depth > -margin)
            ret_points[(*ret_n)++] =
                (body_contact_point){ vec3_along(rim, 0.5 * depth, plane->normal), plane->normal,
                                      depth, 0.5 };
    }
    return true;
}

bool body__find_cylinder_at_plate(const body_state *s, const body_body *body,
                                  const body_plate *plate, double margin,
                                  body_contact_point *ret_points, size_t *ret_n)
{
    const body_kind *kind = &s->kinds[body->kind];
    vec3 axis = mat3_column(&body->r, 2);

    if (!kind->is_cylinder || fabs(axis.z) < UPRIGHT)
        return false;
    *ret_n = 0;
    for (int end = -1; end <= 1; end += 2) {
        vec3 p = vec3_along(body->x, end * kind->half_height, axis);
        vec3 to = vec3_sub(p, plate->middle);
        double a = vec3_dot(to, plate->along), c = vec3_dot(to, plate->across);
        double beyond = fmax(0.0, fabs(a) - plate->half_length);
        double above = fmax(0.0, fabs(c) - plate->half_thickness);
        double distance = sqrt(beyond * beyond + above * above);
        vec3 normal = vec3_scale(plate->across, c < 0.0 ? -1.0 : 1.0);
        if (distance > 0.0)
            normal = vec3_along(vec3_scale(plate->along, copysign(beyond, a) / distance),
                                copysign(above, c) / distance, plate->across);
        else
            distance = fabs(c) - plate->half_thickness;
        double depth = kind->radius - distance;
        if (depth > -margin)
            ret_points[(*ret_n)++] =
                (body_contact_point){ vec3_along(p, -distance - 0.5 * depth, normal), normal, depth,
                                      0.5 };
    }
    return true;
}

void body__find_at_plane(const body_state *s, const body_body *body, const manifold_plane *plane,
                         double margin, body_contact *ret_contact)
{
    ret_contact->is_closed_form =
        find_cylinder_at_plane(s, body, plane, margin, ret_contact->points, &ret_contact->n_points);
    if (!ret_contact->is_closed_form)
        manifold_on_plane(&s->kinds[body->kind].shape, body->x, &body->r, plane, margin,
                          &ret_contact->hull);
}

bool body__find_pair(const body_state *s, double margin, body_pair *pair, body_contact *ret_contact)
{
    const body_body *a = &s->bodies[pair->a], *b = &s->bodies[pair->b];
    vec3 to = vec3_sub(b->x, a->x);
    double range = s->bounding_radius[pair->a] + s->bounding_radius[pair->b] + margin;

    if (vec3_dot(to, to) >= range * range || s->common.presence[pair->a] ||
        s->common.presence[pair->b]) {
        pair->memory = (body_memory){ 0 };
        return false;
    }
    if (is_still_apart(s, margin, pair))
        return false;
    ret_contact->is_closed_form =
        find_cylinder_pair(s, a, b, margin, ret_contact->points, &ret_contact->n_points);
    if (!ret_contact->is_closed_form)
        return find_hulls(s, margin, pair, &ret_contact->hull);
    pair->memory = (body_memory){ 0 };
    return ret_contact->n_points > 0;
}

/// Add the forces in all points. Returns the depth of the contact, or 0 without a force.
static double add_contact(const body_state *s, const micro_law *law, body_pair *pair,
                          const body_contact *contact)
{
    double depth = 0.0;

    for (size_t k = 0; contact->is_closed_form && k < contact->n_points; k++) {
        const body_contact_point *contact_point = &contact->points[k];
        manifold_point point = { contact_point->at, contact_point->depth, contact_point->weight };
        if (add_point(s, law, pair, contact_point->normal, &point))
            depth = fmax(depth, point.depth);
    }
    for (size_t k = 0; !contact->is_closed_form && k < contact->hull.n; k++)
        if (add_point(s, law, pair, contact->hull.normal, &contact->hull.point[k]))
            depth = contact->hull.depth;
    return depth;
}

void body__find_pair_force(const body_state *s, body_pair *pair, body_report *report)
{
    const body_kind *kind_a = &s->kinds[s->bodies[pair->a].kind];
    const body_kind *kind_b = &s->kinds[s->bodies[pair->b].kind];
    body_contact contact;

    pair->has_force = false;
    if (!body__find_pair(s, 0.0, pair, &contact))
        return;
    pair->force = pair->torque_a = pair->torque_b = (vec3){ 0.0, 0.0, 0.0 };
    const micro_law law = body__law(s, kind_a, kind_b);
    double depth = add_contact(s, &law, pair, &contact);
    pair->has_force = depth > 0.0;
    if (pair->has_force)
        body__note(report, pair->a, pair->b, depth, fmin(kind_a->half_width, kind_b->half_width));
}
