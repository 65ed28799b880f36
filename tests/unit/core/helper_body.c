#include "tests/unit/core/helper_body.h"

#include "core/base/check.h"
#include "core/base/digest.h"

#include <math.h>
#include <stdio.h>

scene_shape helper_body_box(double length, double width, double height)
{
    return (scene_shape){ .type = SCENE_BOX, .length = length, .width = width, .height = height };
}

scene_shape helper_body_cylinder(double radius, double height)
{
    return (scene_shape){ .type = SCENE_CYLINDER, .radius = radius, .height = height };
}

void helper_body_init(helper_body *h, scene_shape shape)
{
    *h = (helper_body){ .def = micro_def_default() };
    h->def.domain = (scene_rect){ -1.0, 1.0, -1.0, 1.0 };
    for (int side = 0; side < SCENE_SIDE_COUNT; side++)
        h->def.edges[side] = SCENE_EDGE_OUTFLOW;
    h->def.damping = 0.0;
    h->def.modulus_reduction = 1e4;
    h->def.belts = h->belts;
    h->def.obstacles = &h->obstacle;
    h->def.kinds = h->kinds;
    h->def.poses = h->poses;
    h->def.part_kinds = h->part_kinds;
    h->def.n_kinds = h->def.n_parts = 1;
    h->belts[0].velocity = h->belts[1].velocity = (vec2){ 0.395, 0.0 };
    h->obstacle = (scene_obstacle){ .n_points = 2, .path = h->path, .thickness = 0.005 };
    for (size_t k = 0; k < HELPER_BODY_KINDS; k++)
        h->kinds[k] = (micro_kind){ shape, { 210e9, 0.28 }, 0.03, 0.008 };
}

void helper_body_jam(helper_body *h)
{
    static double wedge[4][3] = {
        { -0.008, -0.008, 0.0 }, { 0.01, -0.008, 0.0 }, { 0.0, 0.012, 0.0 }, { 0.0, 0.0, 0.015 }
    };

    helper_body_init(h, helper_body_box(0.022, 0.018, 0.012));
    h->kinds[1].shape = helper_body_cylinder(0.01, 0.012);
    h->kinds[2].shape = (scene_shape){ .type = SCENE_HULL, .n_vertices = 4, .vertices = wedge };
    h->def.n_kinds = 3;
    h->def.n_parts = 36;
    h->def.n_belts = h->def.n_obstacles = 1;
    h->def.domain = (scene_rect){ -0.05, 0.35, -0.05, 0.1 };
    h->def.edges[SCENE_SOUTH] = h->def.edges[SCENE_NORTH] = SCENE_EDGE_WALL;
    h->path[0] = (vec2){ 0.215, -0.05 };
    h->path[1] = (vec2){ 0.255, 0.08 };
    for (uint32_t k = 0; k < 36; k++) {
        h->poses[k] = (scene_pose){ 0.026 * (k % 9), -0.03 + 0.03 * (k / 9), 0.1 * k };
        h->part_kinds[k] = k % 3;
    }
}

void helper_body_passage(helper_body *h, scene_shape shape)
{
    helper_body_init(h, shape);
    h->def.n_belts = h->def.n_obstacles = 1;
    h->def.n_parts = 60;
    h->def.damping = 0.1;
    h->def.domain = (scene_rect){ -0.3, 0.3, 0.0, 0.3 };
    h->def.edges[SCENE_SOUTH] = h->def.edges[SCENE_NORTH] = SCENE_EDGE_WALL;
    h->path[0] = (vec2){ 0.2 - 0.22 / tan(M_PI / 3.0), 0.0 };
    h->path[1] = (vec2){ 0.2, 0.22 };
    for (int k = 0; k < 60; k++)
        h->poses[k] = (scene_pose){ -0.06 + 0.0245 * (k % 6) + 0.01225 * (k / 6 % 2),
                                    0.04 + 0.0212 * (k / 6), 0.0 };
}

void helper_body_curve(const micro_def *def, double every, int n_samples, double *ret_count)
{
    micro_solver *s = NULL;

    BF_CHECK(micro_create(def, &s, NULL) == BF_OK);
    const uint64_t n_steps = (uint64_t)llround(every / micro_dt(s));
    for (int m = 0; m < n_samples; m++) {
        BF_CHECK(micro_advance(s, n_steps, NULL) == BF_OK);
        ret_count[m] = 0.0;
        for (size_t k = 0; k < def->n_parts; k++)
            ret_count[m] += !micro_is_gone(s, k) && micro_part_of(s, k).x[0] < 0.2;
    }
    micro_destroy(s);
}

double helper_body_gap(const double *a, const double *b, int n_samples)
{
    double sum = 0.0;

    for (int m = 0; m < n_samples; m++)
        sum += fabs(a[m] - b[m]);
    return sum / n_samples;
}

body_state *helper_body_start(const helper_body *h)
{
    micro_common *state = NULL;
    bf_error err = { .code = BF_OK };

    bf_status status = micro__body.create(&h->def, &state, &err);
    if (status != BF_OK)
        fprintf(stderr, "%s: %s\n", err.pointer, err.text);
    BF_CHECK(status == BF_OK);
    return (body_state *)state;
}

void helper_body_run(body_state *s, double time)
{
    bf_error err = { .code = BF_OK };

    bf_status status = micro__body.advance(s, (uint64_t)llround(time / s->def.dt), &err);
    if (status != BF_OK)
        fprintf(stderr, "%s\n", err.text);
    BF_CHECK(status == BF_OK);
}

void helper_body_tilt(body_state *s, size_t k, vec3 axis, double angle, double height)
{
    body_body *body = &s->bodies[k];
    const hull *shape = &s->kinds[body->kind].shape;
    quat q = { cos(0.5 * angle), vec3_scale(vec3_unit(axis), sin(0.5 * angle)) };
    vec3 down = { 0.0, 0.0, -1.0 };

    body->q = quat_unit(quat_multiply(q, body->q));
    body->r = mat3_of_quat(body->q);
    size_t lowest = hull_support(shape, mat3_apply_back(&body->r, down));
    body->x.z = height - mat3_apply(&body->r, hull_vertex(shape, lowest)).z;
}

double helper_body_energy(const body_state *s)
{
    double sum = body__measure(s).kinetic_energy;

    for (size_t k = 0; k < s->n; k++)
        sum -= s->kinds[s->bodies[k].kind].mass * vec3_dot(s->gravity, s->bodies[k].x);
    return sum;
}

vec3 helper_body_momentum(const body_state *s)
{
    vec3 sum = { 0.0, 0.0, 0.0 };

    for (size_t k = 0; k < s->n; k++)
        sum = vec3_along(sum, s->kinds[s->bodies[k].kind].mass, s->bodies[k].v);
    return sum;
}

vec3 helper_body_angular_momentum(const body_state *s)
{
    vec3 sum = { 0.0, 0.0, 0.0 };

    for (size_t k = 0; k < s->n; k++) {
        const body_body *body = &s->bodies[k];
        const body_kind *kind = &s->kinds[body->kind];
        vec3 w = mat3_apply_back(&body->r, body->w);
        vec3 l = { kind->inertia.x * w.x, kind->inertia.y * w.y, kind->inertia.z * w.z };
        sum = vec3_along(sum, kind->mass, vec3_cross(body->x, body->v));
        sum = vec3_add(sum, mat3_apply(&body->r, l));
    }
    return sum;
}

uint64_t helper_body_digest(const body_state *s)
{
    uint64_t digest = DIGEST_START;

    for (size_t k = 0; k < s->n; k++) {
        const micro_part part = body__part(s, k);
        digest = digest_add(digest, part.x, sizeof part.x);
        digest = digest_add(digest, part.q, sizeof part.q);
        digest = digest_add(digest, part.v, sizeof part.v);
        digest = digest_add(digest, part.w, sizeof part.w);
    }
    return digest;
}

double helper_body_stored(const body_state *s)
{
    const body_body *body = &s->bodies[0];
    const body_kind *kind = &s->kinds[body->kind];
    const manifold_plane belt = { .normal = { 0.0, 0.0, 1.0 } };
    double sum = 0.0;
    manifold m;

    manifold_on_plane(&kind->shape, body->x, &body->r, &belt, 0.0, &m);
    for (size_t k = 0; k < m.n; k++)
        sum += 0.5 * kind->belt_law.stiffness * m.point[k].weight * m.point[k].depth *
               m.point[k].depth;
    return sum;
}
