// What acts between two parts.

#include "core/micro/spatial_priv.h"

#include <math.h>

/// More than 1 for rounding.
#define CAREFUL 1.0001

vec3 spatial__rub(const micro_law *law, double force, vec3 slip)
{
    double rate = law->tanh_linear;

    return vec3_scale(slip, -law->friction * fabs(force) * rate *
                                spatial__theta(rate * vec3_length(slip)));
}

void spatial__note(spatial_report *report, double overlap, double radius)
{
    double share = overlap / radius;

    report->n_presses++;
    report->overlap = overlap > report->overlap ? overlap : report->overlap;
    report->share = share > report->share ? share : report->share;
}

bool spatial__find_manifold(const gjk_pair *pair, spatial_memory *memory, manifold *ret_manifold)
{
    if (vec3_dot(memory->axis, memory->axis) == 0.0)
        memory->axis =
            vec3_dot(pair->shift, pair->shift) > 0.0 ? pair->shift : (vec3){ 1.0, 0.0, 0.0 };
    if (memory->feature.kind != MANIFOLD_NONE) {
        manifold_find(pair, memory->feature, ret_manifold);
        memory->axis = ret_manifold->normal;
        if (ret_manifold->depth > 0.0 && ret_manifold->is_least)
            return true;
    }
    memory->feature.kind = MANIFOLD_NONE;
    memory->gap = gjk_find_gap(pair, &memory->axis);
    if (memory->gap > 0.0)
        return false;
    gjk_touch touch = gjk_measure(pair, memory->axis);
    memory->axis = touch.normal;
    if (touch.distance > 0.0)
        return false;
    memory->feature = manifold_feature_of(pair, &touch);
    manifold_find(pair, memory->feature, ret_manifold);
    if (ret_manifold->n == 0)
        manifold_from_touch(&touch, ret_manifold);
    return true;
}

/// Add what acts in one contact point, a to b along normal. Returns true if it presses.
static bool add_point(const spatial_state *s, const micro_law *law, spatial_pair *pair, vec3 normal,
                      const manifold_point *point)
{
    const spatial_body *a = &s->bodies[pair->a], *b = &s->bodies[pair->b];
    vec3 velocity = vec3_sub(spatial__velocity(b, point->at), spatial__velocity(a, point->at));
    double approach = vec3_dot(velocity, normal);
    double press = spatial__press(s, law, point->depth, point->share, approach);

    if (press == 0.0)
        return false;
    vec3 rub = spatial__rub(law, press, vec3_along(velocity, -approach, normal));
    vec3 force = vec3_along(rub, press, normal);
    pair->force = vec3_add(pair->force, force);
    pair->torque_a = vec3_sub(pair->torque_a, vec3_cross(vec3_sub(point->at, a->x), force));
    pair->torque_b = vec3_add(pair->torque_b, vec3_cross(vec3_sub(point->at, b->x), force));
    return true;
}

/// Returns the depth of the contact, or 0 if nothing presses.
static double meet_round(const spatial_state *s, const micro_law *law, spatial_pair *pair,
                         const spatial_spot *spots, size_t n)
{
    double depth = 0.0;

    for (size_t k = 0; k < n; k++) {
        manifold_point point = { spots[k].at, spots[k].depth, spots[k].share };
        if (add_point(s, law, pair, spots[k].normal, &point))
            depth = fmax(depth, point.depth);
    }
    return depth;
}

/// The same for hulls.
static double meet_hulls(const spatial_state *s, const micro_law *law, spatial_pair *pair)
{
    const spatial_body *a = &s->bodies[pair->a], *b = &s->bodies[pair->b];
    gjk_pair hulls =
        gjk_pair_of(&s->kinds[a->kind].shape, a->x, &a->r, &s->kinds[b->kind].shape, b->x, &b->r);
    double depth = 0.0;
    manifold m;

    if (!spatial__find_manifold(&hulls, &pair->memory, &m))
        return 0.0;
    vec3 normal = mat3_apply(&a->r, m.normal);
    for (size_t k = 0; k < m.n; k++) {
        m.point[k].at = vec3_add(mat3_apply(&a->r, m.point[k].at), a->x);
        if (add_point(s, law, pair, normal, &m.point[k]))
            depth = m.depth;
    }
    return depth;
}

/// True if two bodies that were apart cannot have come together: they have moved by their
/// velocities and turned by their spins, which now are those of the last step.
static bool is_still_apart(const spatial_state *s, spatial_pair *pair)
{
    const spatial_body *a = &s->bodies[pair->a], *b = &s->bodies[pair->b];

    if (pair->memory.gap <= 0.0)
        return false;
    double speed = vec3_length(vec3_sub(b->v, a->v)) + vec3_length(a->w) * s->reach[pair->a] +
                   vec3_length(b->w) * s->reach[pair->b];
    pair->memory.gap -= CAREFUL * s->def.dt * speed;
    return pair->memory.gap > 0.0;
}

void spatial__meet(const spatial_state *s, spatial_pair *pair, spatial_report *report)
{
    const spatial_body *a = &s->bodies[pair->a], *b = &s->bodies[pair->b];
    const spatial_kind *kind_a = &s->kinds[a->kind], *kind_b = &s->kinds[b->kind];
    vec3 to = vec3_sub(b->x, a->x);
    double range = s->reach[pair->a] + s->reach[pair->b], depth;
    spatial_spot spots[SPATIAL_SPOTS_MAX];
    size_t n;

    pair->is_pressing = false;
    if (vec3_dot(to, to) >= range * range || s->is_gone[pair->a] || s->is_gone[pair->b]) {
        pair->memory = (spatial_memory){ 0 };
        return;
    }
    if (is_still_apart(s, pair))
        return;
    pair->force = pair->torque_a = pair->torque_b = (vec3){ 0.0, 0.0, 0.0 };
    const micro_law law = spatial__law(s, kind_a, kind_b);
    if (spatial__round_pair(s, a, b, spots, &n)) {
        pair->memory = (spatial_memory){ 0 };
        depth = meet_round(s, &law, pair, spots, n);
    } else {
        depth = meet_hulls(s, &law, pair);
    }
    pair->is_pressing = depth > 0.0;
    if (pair->is_pressing)
        spatial__note(report, depth, fmin(kind_a->radius, kind_b->radius));
}
