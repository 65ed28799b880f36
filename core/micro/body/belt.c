// Contacts with the plane z = 0: that of the belts, which bears a part as long as one of them carries it; what of it is
// over no belt drags as if it lay on that one. Without any belt it is a surface at rest.

#include "core/micro/body/belt.h"

#include "core/base/memory.h"
#include "core/micro/backend.h"
#include "core/micro/body/body_priv.h"
#include "core/micro/friction.h"
#include "core/scene/belt_slope.h"

#include <math.h>

static const vec3 nothing = { 0.0, 0.0, 0.0 };
static const manifold_plane belt_plane = { .normal = { 0.0, 0.0, 1.0 } };

/// Normal forces on the plane: contact points with the force in each, N; or, with n = 0, only their sums.
typedef struct belt_pressure {
    size_t n;
    vec3 at[MANIFOLD_POINTS_MAX];
    double force[MANIFOLD_POINTS_MAX];
    double sum;      // of |force|
    vec3 middle;     // of |force|
    double gyration; // of |force| about the middle, m
} belt_pressure;

static body_belt belt_of(const scene_belt *belt, const micro_def *def, double factor)
{
    const scene_contact *conveyor = &def->contact[SCENE_CONVEYOR_CARGO];
    const vec2 v = belt_velocity(belt, (vec2){ 0.0, 0.0 });
    const vec2 pull = belt_slope_pull(belt, def->gravity), hold = belt_slope_hold(belt, conveyor);
    body_belt b = { v.x * factor,
                    v.y * factor,
                    belt->turn * factor,
                    belt_friction_ratio(belt, conveyor),
                    { pull.x, pull.y, -def->gravity * cos(belt->incline) } };

    if (belt->incline != 0.0) {
        b.vx += hold.x;
        b.vy += hold.y;
    }
    return b;
}

bf_status body__belt_init(body_state *s, const micro_def *def, bf_error *err)
{
    s->belts = memory_alloc(def->n_belts + 1, sizeof *s->belts);
    if (s->belts == NULL)
        return bf_fail(err, BF_ENOMEM, "/belts", "no memory for the belts");
    for (size_t k = 0; k < def->n_belts; k++) {
        s->belts[k] = belt_of(&def->belts[k], def, 1.0);
        s->has_slopes = s->has_slopes || def->belts[k].incline != 0.0;
    }
    s->belts[def->n_belts].friction_ratio = 1.0;
    s->belts[def->n_belts].gravity = s->gravity;
    return micro__copy_surroundings(def, &s->common.around, err);
}

void body__belt_fini(body_state *s)
{
    surroundings_fini(&s->common.around);
    memory_free(s->belt_cache);
    memory_free(s->belts);
}

void body__update_belts(body_state *s, uint64_t n_before)
{
    double factors[SCENE_BELTS_MAX + 1];

    if (s->common.world->belts.are_constant)
        return;
    belt_speeds_in_step(&s->common.world->belts, n_before, s->def.dt, factors);
    for (size_t k = 0; k < s->common.around.n_belts; k++)
        s->belts[k] = belt_of(&s->common.around.belts[k], &s->def, factors[k]);
}

/// How far part k bridges gaps, m.
static double bridge_of(const body_state *s, size_t k)
{
    return s->kinds[s->bodies[k].kind].inner_radius;
}

/// The cache of part k where it is now.
static const body_belt_cache *find_belt(body_state *s, size_t k)
{
    body_belt_cache *cache = &s->belt_cache[k];
    const surroundings *around = &s->common.around;
    const vec2 at = { s->bodies[k].x.x, s->bodies[k].x.y };

    if (!(vec2_length(vec2_sub(at, cache->at)) < cache->clearance)) {
        cache->at = at;
        cache->clearance =
            surroundings_border_distance(around, at) - s->bounding_radius[k] - SCENE_TOLERANCE;
        cache->belt = surroundings_belt_under(around, at, bridge_of(s, k));
    }
    return cache;
}

vec3 body__gravity(body_state *s, size_t k)
{
    return s->has_slopes ? s->belts[find_belt(s, k)->belt].gravity : s->gravity;
}

bool body__falls(body_state *s, size_t k)
{
    return surroundings_falls(&s->common.around, find_belt(s, k)->belt);
}

const body_belt *body__whole_belt(body_state *s, size_t k)
{
    const body_belt_cache *cache = find_belt(s, k);

    return cache->clearance > 0.0 ? &s->belts[cache->belt] : NULL;
}

const body_belt *body__belt_at(body_state *s, size_t k, vec3 at)
{
    size_t belt = surroundings_belt_under(&s->common.around, (vec2){ at.x, at.y }, bridge_of(s, k));

    if (belt == s->common.around.n_belts)
        belt = find_belt(s, k)->belt;
    return &s->belts[belt];
}

/// Add a contact point if it has a normal force.
static void add_point(const body_state *s, const body_body *body, const micro_law *law,
                      const manifold_point *point, belt_pressure *p)
{
    double force =
        body__normal_force(s, law, point->depth, point->weight, body__velocity(body, point->at).z);

    if (force == 0.0)
        return;
    p->at[p->n] = point->at;
    p->force[p->n++] = force;
    p->sum += fabs(force);
    p->middle = vec3_along(p->middle, fabs(force), point->at);
}

static void find_pressure(const body_state *s, const body_body *body, belt_pressure *p)
{
    const micro_law *law = &s->kinds[body->kind].belt_law;
    body_contact contact;

    p->n = 0;
    p->sum = p->gyration = 0.0;
    p->middle = nothing;
    body__find_at_plane(s, body, &belt_plane, 0.0, &contact);
    for (size_t k = 0; contact.is_closed_form && k < contact.n_points; k++) {
        const body_contact_point *contact_point = &contact.points[k];
        add_point(
            s, body, law,
            &(manifold_point){ contact_point->at, contact_point->depth, contact_point->weight }, p);
    }
    for (size_t k = 0; !contact.is_closed_form && k < contact.hull.n; k++)
        add_point(s, body, law, &contact.hull.point[k], p);
    if (p->sum <= 0.0)
        return;
    p->middle = vec3_scale(p->middle, 1.0 / p->sum);
    // Radius of gyration of the pressure about the vertical.
    double sum = 0.0;
    for (size_t k = 0; k < p->n; k++) {
        double x = p->at[k].x - p->middle.x, y = p->at[k].y - p->middle.y;
        sum += fabs(p->force[k]) * (x * x + y * y);
    }
    p->gyration = sqrt(sum / p->sum);
}

/// The sums for a body with a whole face in contact, without its points: the force in a point p of the
/// face is f_c + g.(p - c), so that they follow from the moments of the face. Returns false if no whole
/// face is in contact.
static bool find_flat_pressure(const body_state *s, const body_body *body, belt_pressure *p)
{
    const body_kind *kind = &s->kinds[body->kind];
    const vec3 up = body->r.row[2], down = vec3_scale(up, -1.0);
    size_t face_id = hull_facing(&kind->shape, hull_support(&kind->shape, down), down);
    const body_face *face = &kind->faces[face_id];
    const vec3 normal = kind->shape.normal[face_id], w = mat3_apply_back(&body->r, body->w);
    const vec3 rate = vec3_cross(up, w);
    double height = body->x.z + vec3_dot(up, face->centre);
    double speed = body->v.z + vec3_dot(rate, face->centre);
    double force = -kind->belt_law.stiffness * height - kind->belt_law.damping * speed;
    vec3 tilt = vec3_along(up, -vec3_dot(up, normal), normal);
    vec3 slope =
        vec3_along(vec3_scale(up, -kind->belt_law.stiffness), -kind->belt_law.damping, rate);
    vec3 steep = vec3_along(slope, -vec3_dot(slope, normal), normal);

    if (height + face->radius * vec3_length(tilt) >= 0.0 ||
        force - face->radius * vec3_length(steep) <= 0.0)
        return false;
    vec3 lever = vec3_scale(mat3_apply(&face->spread, slope), 1.0 / force);
    vec3 middle = mat3_apply(&body->r, vec3_add(face->centre, lever));
    const mat3 *spread = &face->spread;
    double trace = spread->row[0].x + spread->row[1].y + spread->row[2].z;
    p->n = 0;
    p->sum = force;
    p->middle = vec3_add(body->x, middle);
    p->middle.z *= 0.5; // in the middle of the overlap
    p->gyration =
        sqrt(fmax(0.0, trace + vec3_dot(slope, face->skew) / force - vec3_dot(lever, lever)));
    return true;
}

/// The torque of friction (8), implicit, so that it never turns the body past the belt's angular velocity.
static double find_spin_torque(const body_state *s, const body_body *body, const belt_pressure *p,
                               double turn, double friction_ratio)
{
    const body_kind *kind = &s->kinds[body->kind];
    const micro_law *law = &kind->belt_law;
    double flat = fmin(1.0, p->gyration / kind->flat_gyration), slip = body->w.z - turn;
    vec3 up = body->r.row[2];
    double inverse_inertia = up.x * up.x / kind->inertia.x + up.y * up.y / kind->inertia.y +
                             up.z * up.z / kind->inertia.z;

    double spin_secant = friction_secant(friction_ratio * law->friction * kind->spin_radius * flat,
                                         p->sum, law->tanh_spin, fabs(slip));
    return -spin_secant * slip / (1.0 + s->def.dt * spin_secant * inverse_inertia);
}

/// Friction (7) in the centre of pressure, and (8) about it. Where several belts are under the body, (7) acts in each contact
/// point by the slip that the centre would have on the belt there, as what differs from that by turning is (8).
static void add_friction(body_state *s, size_t k, const belt_pressure *p, const body_belt *belt,
                         body_load *load)
{
    const body_body *body = &s->bodies[k];
    const micro_law *law = &s->kinds[body->kind].belt_law;
    vec3 velocity = body__velocity(body, p->middle);
    double turn = belt != NULL ? belt->turn : 0.0,
           friction_ratio = belt != NULL ? belt->friction_ratio : 0.0;

    velocity.z = 0.0;
    if (belt != NULL) {
        const vec3 slip = vec3_sub(velocity, body__belt_velocity(belt, p->middle));
        body__add_force(load, body, p->middle,
                        body__friction_force(law, belt->friction_ratio * p->sum, slip));
    }
    for (size_t m = 0; belt == NULL && m < p->n; m++) {
        const body_belt *under = body__belt_at(s, k, p->at[m]);
        const vec3 slip = vec3_sub(velocity, body__belt_velocity(under, p->middle));
        body__add_force(load, body, p->at[m],
                        body__friction_force(law, under->friction_ratio * p->force[m], slip));
        turn += under->turn * fabs(p->force[m]) / p->sum;
        friction_ratio += under->friction_ratio * fabs(p->force[m]);
    }
    if (belt == NULL)
        friction_ratio /= p->sum;
    load->torque.z += find_spin_torque(s, body, p, turn, friction_ratio);
}

void body__add_belt_forces(body_state *s, size_t k, body_load *load)
{
    const body_body *body = &s->bodies[k];
    belt_pressure p;

    if (body->x.z >= s->bounding_radius[k])
        return;
    const body_belt *belt = body__whole_belt(s, k);
    if (belt != NULL && find_flat_pressure(s, body, &p))
        body__add_force(load, body, p.middle, (vec3){ 0.0, 0.0, p.sum });
    else
        find_pressure(s, body, &p);
    if (p.sum == 0.0)
        return;
    for (size_t m = 0; m < p.n; m++)
        body__add_force(load, body, p.at[m], (vec3){ 0.0, 0.0, p.force[m] });
    add_friction(s, k, &p, belt, load);
}
