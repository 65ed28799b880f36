// What acts between two parts.

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
    ret_region->is_round = body__round_pair(s, a, b, near, ret_region->spots, &ret_region->n_spots);
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
