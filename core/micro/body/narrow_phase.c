// Where bodies touch and what acts there.
//
// Cylinders that stand side by side, or near a plate, or lie against a plane touch in a line, and its two ends are
// the contact points, with half of stiffness and dashpot each. Axes that are tilted against each other by an
// angle t less than about 0.1 count as parallel: the distance is then measured at each end of the height that
// they share, and is right to r t^2/2.

#include "core/micro/body/narrow_phase.h"

#include "core/micro/body/body_priv.h"
#include "core/micro/friction.h"

#include <math.h>

/// More than 1 for rounding.
#define CAREFUL 1.0001

vec3 body__rub(const micro_law *law, double force, vec3 slip)
{
    return vec3_scale(slip,
                      -friction_secant(law->friction, force, law->tanh_linear, vec3_length(slip)));
}

void body__note(body_report *report, double overlap, double radius)
{
    double share = overlap / radius;

    report->n_presses++;
    report->overlap = overlap > report->overlap ? overlap : report->overlap;
    report->share = share > report->share ? share : report->share;
}

/// Search for the contact from memory->axis. Returns false if the hulls are not near.
static bool search(const gjk_pair *pair, double near, body_memory *memory, manifold *ret_manifold)
{
    memory->feature.kind = MANIFOLD_NONE;
    memory->gap = gjk_find_gap(pair, &memory->axis);
    if (memory->gap > near)
        return false;
    gjk_result touch = gjk_measure(pair, memory->axis);
    memory->axis = touch.normal;
    memory->gap = touch.distance > near ? touch.distance : 0.0;
    if (touch.distance > 0.0 && touch.distance >= near)
        return false;
    memory->feature = manifold_feature_of(pair, &touch);
    manifold_find(pair, memory->feature, near, ret_manifold);
    // What is apart may be nearest in a corner, which no feature carries.
    bool is_carried = ret_manifold->is_least || touch.distance <= 0.0;
    if (ret_manifold->n == 0 || !is_carried)
        manifold_from_result(&touch, ret_manifold);
    if (!is_carried)
        memory->feature.kind = MANIFOLD_NONE;
    return true;
}

bool body__find_manifold(const gjk_pair *pair, double near, body_memory *memory,
                         manifold *ret_manifold)
{
    if (vec3_dot(memory->axis, memory->axis) == 0.0)
        memory->axis = vec3_dot(pair->translation, pair->translation) > 0.0
                           ? pair->translation
                           : (vec3){ 1.0, 0.0, 0.0 };
    if (memory->feature.kind != MANIFOLD_NONE) {
        manifold_find(pair, memory->feature, near, ret_manifold);
        memory->axis = ret_manifold->normal;
        if (ret_manifold->depth > -near && ret_manifold->is_least)
            return true;
    }
    return search(pair, near, memory, ret_manifold);
}

/// Add what acts in one contact point, a to b along normal. Returns true if it presses.
static bool add_point(const body_state *s, const micro_law *law, body_pair *pair, vec3 normal,
                      const manifold_point *point)
{
    const body_body *a = &s->bodies[pair->a], *b = &s->bodies[pair->b];
    vec3 velocity = vec3_sub(body__velocity(b, point->at), body__velocity(a, point->at));
    double approach = vec3_dot(velocity, normal);
    double press = body__press(s, law, point->depth, point->weight, approach);

    if (press == 0.0)
        return false;
    vec3 rub = body__rub(law, press, vec3_along(velocity, -approach, normal));
    vec3 force = vec3_along(rub, press, normal);
    pair->force = vec3_add(pair->force, force);
    pair->torque_a = vec3_sub(pair->torque_a, vec3_cross(vec3_sub(point->at, a->x), force));
    pair->torque_b = vec3_add(pair->torque_b, vec3_cross(vec3_sub(point->at, b->x), force));
    return true;
}

/// True if two bodies that were apart cannot have come near: they have moved by their velocities
/// and turned by their spins, which now are those of the last step.
static bool is_still_apart(const body_state *s, double near, body_pair *pair)
{
    const body_body *a = &s->bodies[pair->a], *b = &s->bodies[pair->b];

    if (pair->memory.gap <= near)
        return false;
    double speed = vec3_length(vec3_sub(b->v, a->v)) + vec3_length(a->w) * s->reach[pair->a] +
                   vec3_length(b->w) * s->reach[pair->b];
    pair->memory.gap -= CAREFUL * s->def.dt * speed;
    return pair->memory.gap > near;
}

/// The region of two hulls in the world's frame. Returns false if they are apart.
static bool find_hulls(const body_state *s, double near, body_pair *pair, manifold *m)
{
    const body_body *a = &s->bodies[pair->a], *b = &s->bodies[pair->b];
    gjk_pair hulls =
        gjk_pair_of(&s->kinds[a->kind].shape, a->x, &a->r, &s->kinds[b->kind].shape, b->x, &b->r);

    if (!body__find_manifold(&hulls, near, &pair->memory, m))
        return false;
    m->normal = mat3_apply(&a->r, m->normal);
    for (size_t k = 0; k < m->n; k++)
        m->point[k].at = vec3_add(mat3_apply(&a->r, m->point[k].at), a->x);
    return true;
}

/// Cosine of the largest tilt.
#define UPRIGHT 0.995

/// A cylinder lies against a plane if the cosine between its axis and the normal is below this.
#define ON_ITS_SIDE M_SQRT1_2

/// The contact point of two circles around p and q, or none.
static size_t touch_circles(vec3 p, double radius_p, vec3 q, double radius_q, vec3 along,
                            double near, body_spot *ret_spot)
{
    vec3 to = vec3_sub(q, p);
    double distance = vec3_length(to), depth = radius_p + radius_q - distance;
    vec3 normal = distance > 0.0 ? vec3_scale(to, 1.0 / distance) : vec3_aside(along);

    if (depth <= -near)
        return 0;
    *ret_spot = (body_spot){ vec3_along(p, radius_p - 0.5 * depth, normal), normal, depth, 0.5 };
    return 1;
}

static bool round_pair(const body_state *s, const body_body *a, const body_body *b, double near,
                       body_spot *ret_spots, size_t *ret_n)
{
    const body_kind *kind_a = &s->kinds[a->kind], *kind_b = &s->kinds[b->kind];
    vec3 axis_a = mat3_column(&a->r, 2), axis_b = mat3_column(&b->r, 2), to = vec3_sub(b->x, a->x);
    double h_a = kind_a->half_height, h_b = kind_b->half_height;

    if (!kind_a->is_round || !kind_b->is_round || fabs(vec3_dot(axis_a, axis_b)) < UPRIGHT)
        return false;
    if (vec3_dot(axis_a, axis_b) < 0.0)
        axis_b = vec3_scale(axis_b, -1.0);
    vec3 along = vec3_unit(vec3_add(axis_a, axis_b));
    double lift = vec3_dot(to, along);
    double low = fmax(-h_a, lift - h_b), high = fmin(h_a, lift + h_b), shared = high - low;
    double radial = vec3_length(vec3_along(to, -lift, along));
    double depth = kind_a->radius + kind_b->radius - radial;
    // One on top of the other is for the hulls.
    if (shared <= 0.0 || (shared < fmin(h_a, h_b) && depth > shared))
        return false;
    *ret_n = 0;
    for (int end = 0; end < 2; end++) {
        double at = end == 0 ? low : high;
        vec3 p = vec3_along(a->x, at / vec3_dot(axis_a, along), axis_a);
        vec3 q = vec3_along(b->x, (at - lift) / vec3_dot(axis_b, along), axis_b);
        *ret_n +=
            touch_circles(p, kind_a->radius, q, kind_b->radius, along, near, &ret_spots[*ret_n]);
    }
    return true;
}

static bool round_plane(const body_state *s, const body_body *body, const manifold_plane *plane,
                        double near, body_spot *ret_spots, size_t *ret_n)
{
    const body_kind *kind = &s->kinds[body->kind];
    vec3 axis = mat3_column(&body->r, 2);
    double leaning = vec3_dot(axis, plane->normal);

    if (!kind->is_round || fabs(leaning) > ON_ITS_SIDE)
        return false;
    // From the axis to the point of either rim that is deepest.
    vec3 down = vec3_unit(vec3_along(vec3_scale(axis, leaning), -1.0, plane->normal));
    *ret_n = 0;
    for (int end = -1; end <= 1; end += 2) {
        vec3 rim =
            vec3_along(vec3_along(body->x, end * kind->half_height, axis), kind->radius, down);
        double depth = plane->offset - vec3_dot(plane->normal, rim);
        if (depth > -near)
            ret_spots[(*ret_n)++] = (body_spot){ vec3_along(rim, 0.5 * depth, plane->normal),
                                                 plane->normal, depth, 0.5 };
    }
    return true;
}

bool body__round_plate(const body_state *s, const body_body *body, const body_plate *plate,
                       double near, body_spot *ret_spots, size_t *ret_n)
{
    const body_kind *kind = &s->kinds[body->kind];
    vec3 axis = mat3_column(&body->r, 2);

    if (!kind->is_round || fabs(axis.z) < UPRIGHT)
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
        if (depth > -near)
            ret_spots[(*ret_n)++] =
                (body_spot){ vec3_along(p, -distance - 0.5 * depth, normal), normal, depth, 0.5 };
    }
    return true;
}

void body__find_at_plane(const body_state *s, const body_body *body, const manifold_plane *plane,
                         double near, body_region *ret_region)
{
    ret_region->is_round =
        round_plane(s, body, plane, near, ret_region->spots, &ret_region->n_spots);
    if (!ret_region->is_round)
        manifold_on_plane(&s->kinds[body->kind].shape, body->x, &body->r, plane, near,
                          &ret_region->hull);
}

bool body__find_pair(const body_state *s, double near, body_pair *pair, body_region *ret_region)
{
    const body_body *a = &s->bodies[pair->a], *b = &s->bodies[pair->b];
    vec3 to = vec3_sub(b->x, a->x);
    double range = s->reach[pair->a] + s->reach[pair->b] + near;

    if (vec3_dot(to, to) >= range * range || s->is_gone[pair->a] || s->is_gone[pair->b]) {
        pair->memory = (body_memory){ 0 };
        return false;
    }
    if (is_still_apart(s, near, pair))
        return false;
    ret_region->is_round = round_pair(s, a, b, near, ret_region->spots, &ret_region->n_spots);
    if (!ret_region->is_round)
        return find_hulls(s, near, pair, &ret_region->hull);
    pair->memory = (body_memory){ 0 };
    return ret_region->n_spots > 0;
}

/// Add what acts in all points. Returns the depth of the contact, or 0 if nothing presses.
static double add_region(const body_state *s, const micro_law *law, body_pair *pair,
                         const body_region *region)
{
    double depth = 0.0;

    for (size_t k = 0; region->is_round && k < region->n_spots; k++) {
        const body_spot *spot = &region->spots[k];
        manifold_point point = { spot->at, spot->depth, spot->share };
        if (add_point(s, law, pair, spot->normal, &point))
            depth = fmax(depth, point.depth);
    }
    for (size_t k = 0; !region->is_round && k < region->hull.n; k++)
        if (add_point(s, law, pair, region->hull.normal, &region->hull.point[k]))
            depth = region->hull.depth;
    return depth;
}

void body__meet(const body_state *s, body_pair *pair, body_report *report)
{
    const body_kind *kind_a = &s->kinds[s->bodies[pair->a].kind];
    const body_kind *kind_b = &s->kinds[s->bodies[pair->b].kind];
    body_region region;

    pair->is_pressing = false;
    if (!body__find_pair(s, 0.0, pair, &region))
        return;
    pair->force = pair->torque_a = pair->torque_b = (vec3){ 0.0, 0.0, 0.0 };
    const micro_law law = body__law(s, kind_a, kind_b);
    double depth = add_region(s, &law, pair, &region);
    pair->is_pressing = depth > 0.0;
    if (pair->is_pressing)
        body__note(report, depth, fmin(kind_a->radius, kind_b->radius));
}
