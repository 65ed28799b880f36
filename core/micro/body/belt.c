// The plane z = 0: belts, and the floor that stands still off every belt.

#include "core/micro/body/body_priv.h"

#include "core/base/memory.h"
#include "core/micro/backend.h"
#include "core/micro/friction.h"

#include <math.h>

static const vec3 nothing = { 0.0, 0.0, 0.0 };
static const manifold_plane floor_plane = { .normal = { 0.0, 0.0, 1.0 } };

/// What presses on the floor: the points with the force in each, N; or, with n = 0, sums alone.
typedef struct patch {
    size_t n;
    vec3 at[MANIFOLD_POINTS_MAX];
    double force[MANIFOLD_POINTS_MAX];
    double sum;      // of |force|
    vec3 middle;     // of |force|
    double gyration; // of |force| about the middle, m
} patch;

bf_status body__floor_init(body_state *s, const micro_def *def, bf_error *err)
{
    s->ground = memory_alloc(def->n_parts, sizeof *s->ground);
    if (s->ground == NULL)
        return bf_fail(err, BF_ENOMEM, "/belts", "no memory for the belts");
    for (size_t k = 0; k < def->n_parts; k++)
        s->ground[k].clear = -1.0;
    return micro__copy_surroundings(def, &s->around, err);
}

void body__floor_fini(body_state *s)
{
    surroundings_fini(&s->around);
    memory_free(s->ground);
}

bool body__belt_at(const body_state *s, double x, double y, vec3 *ret_velocity)
{
    vec2 velocity;
    bool is_on_belt =
        surroundings_belt_at(&s->around, (vec2){ x, y }, (double)s->steps * s->def.dt, &velocity);

    *ret_velocity = (vec3){ velocity.x, velocity.y, 0.0 };
    return is_on_belt;
}

bool body__is_on_one_belt(body_state *s, size_t k, vec3 *ret_velocity)
{
    body_ground *ground = &s->ground[k];
    vec2 at = { s->bodies[k].x.x, s->bodies[k].x.y };

    if (!(vec2_length(vec2_sub(at, ground->at)) < ground->clear)) {
        ground->at = at;
        ground->clear =
            surroundings_border_distance(&s->around, at) - s->reach[k] - SCENE_TOLERANCE;
        (void)body__belt_at(s, at.x, at.y, &ground->velocity);
    }
    *ret_velocity = ground->velocity;
    return ground->clear > 0.0;
}

/// Add a point to the patch if it presses.
static void add_point(const body_state *s, const body_body *body, const micro_law *law,
                      const manifold_point *point, patch *p)
{
    double force =
        body__press(s, law, point->depth, point->weight, body__velocity(body, point->at).z);

    if (force == 0.0)
        return;
    p->at[p->n] = point->at;
    p->force[p->n++] = force;
    p->sum += fabs(force);
    p->middle = vec3_along(p->middle, fabs(force), point->at);
}

/// Radius of gyration of the pressure about the vertical.
static double find_gyration(const patch *p)
{
    double sum = 0.0;

    for (size_t k = 0; k < p->n; k++) {
        double x = p->at[k].x - p->middle.x, y = p->at[k].y - p->middle.y;
        sum += fabs(p->force[k]) * (x * x + y * y);
    }
    return sqrt(sum / p->sum);
}

static void find_patch(const body_state *s, const body_body *body, patch *p)
{
    const micro_law *law = &s->kinds[body->kind].floor;
    body_region region;

    p->n = 0;
    p->sum = p->gyration = 0.0;
    p->middle = nothing;
    body__find_at_plane(s, body, &floor_plane, 0.0, &region);
    for (size_t k = 0; region.is_round && k < region.n_spots; k++) {
        const body_spot *spot = &region.spots[k];
        add_point(s, body, law, &(manifold_point){ spot->at, spot->depth, spot->share }, p);
    }
    for (size_t k = 0; !region.is_round && k < region.hull.n; k++)
        add_point(s, body, law, &region.hull.point[k], p);
    if (p->sum <= 0.0)
        return;
    p->middle = vec3_scale(p->middle, 1.0 / p->sum);
    p->gyration = find_gyration(p);
}

/// The sums of a body that presses with all of a face, without its points: the force in a point p
/// of the body is f_c + g.(p - c), so that it follows from the moments of the face. Returns false
/// if the body lies otherwise.
static bool find_flat_patch(const body_state *s, const body_body *body, patch *p)
{
    const body_kind *kind = &s->kinds[body->kind];
    const vec3 up = body->r.row[2], down = vec3_scale(up, -1.0);
    size_t number = hull_facing(&kind->shape, hull_support(&kind->shape, down), down);
    const body_face *face = &kind->faces[number];
    const vec3 normal = kind->shape.normal[number], w = mat3_apply_back(&body->r, body->w);
    const vec3 rate = vec3_cross(up, w);
    double height = body->x.z + vec3_dot(up, face->centre);
    double speed = body->v.z + vec3_dot(rate, face->centre);
    double force = -kind->floor.stiffness * height - kind->floor.damping * speed;
    vec3 tilt = vec3_along(up, -vec3_dot(up, normal), normal);
    vec3 slope = vec3_along(vec3_scale(up, -kind->floor.stiffness), -kind->floor.damping, rate);
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

/// Friction (8), so that it never turns the spin around.
static double find_spin_torque(const body_state *s, const body_body *body, const patch *p)
{
    const body_kind *kind = &s->kinds[body->kind];
    const micro_law *law = &kind->floor;
    double flat = fmin(1.0, p->gyration / kind->flat_gyration);
    vec3 up = body->r.row[2];
    double inverse_inertia = up.x * up.x / kind->inertia.x + up.y * up.y / kind->inertia.y +
                             up.z * up.z / kind->inertia.z;

    double brake = friction_secant(law->friction * kind->spin_radius * flat, p->sum, law->tanh_spin,
                                   fabs(body->w.z));
    return -brake * body->w.z / (1.0 + s->def.dt * brake * inverse_inertia);
}

/// Friction (7) in the centre of pressure, point by point where it lies on several belts.
static void add_sliding(const body_state *s, const body_body *body, const patch *p,
                        const vec3 *belt, body_load *load)
{
    const micro_law *law = &s->kinds[body->kind].floor;
    vec3 velocity = body__velocity(body, p->middle), under;

    velocity.z = 0.0;
    if (belt != NULL) {
        body__push(load, body, p->middle, body__rub(law, p->sum, vec3_sub(velocity, *belt)));
        return;
    }
    for (size_t m = 0; m < p->n; m++) {
        (void)body__belt_at(s, p->at[m].x, p->at[m].y, &under);
        body__push(load, body, p->at[m], body__rub(law, p->force[m], vec3_sub(velocity, under)));
    }
}

void body__floor_push(body_state *s, size_t k, body_load *load)
{
    const body_body *body = &s->bodies[k];
    vec3 belt;
    patch p;

    if (body->x.z >= s->reach[k])
        return;
    bool is_one_belt = body__is_on_one_belt(s, k, &belt);
    if (is_one_belt && find_flat_patch(s, body, &p))
        body__push(load, body, p.middle, (vec3){ 0.0, 0.0, p.sum });
    else
        find_patch(s, body, &p);
    if (p.sum == 0.0)
        return;
    for (size_t m = 0; m < p.n; m++)
        body__push(load, body, p.at[m], (vec3){ 0.0, 0.0, p.force[m] });
    add_sliding(s, body, &p, is_one_belt ? &belt : NULL, load);
    load->torque.z += find_spin_torque(s, body, &p);
}
