#include "tests/unit/core/helper_spatial.h"

#include "core/base/check.h"
#include "core/base/digest.h"

#include <math.h>
#include <stdio.h>

scene_shape helper_spatial_box(double length, double width, double height)
{
    return (scene_shape){ .type = SCENE_BOX, .length = length, .width = width, .height = height };
}

scene_shape helper_spatial_cylinder(double radius, double height)
{
    return (scene_shape){ .type = SCENE_CYLINDER, .radius = radius, .height = height };
}

void helper_spatial_init(helper_spatial *h, scene_shape shape)
{
    *h = (helper_spatial){ .def = micro_def_default() };
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
    h->belts[0].velocity = h->belts[1].velocity = (scene_point){ 0.395, 0.0 };
    h->obstacle = (scene_obstacle){ .n_points = 2, .path = h->path, .thickness = 0.005 };
    for (size_t k = 0; k < HELPER_SPATIAL_KINDS; k++)
        h->kinds[k] = (micro_kind){ shape, { 210e9, 0.28 }, 0.03, 0.008 };
}

spatial_state *helper_spatial_start(const helper_spatial *h)
{
    void *state = NULL;
    bf_error err = { .code = BF_OK };

    bf_status status = micro__spatial.create(&h->def, &state, &err);
    if (status != BF_OK)
        fprintf(stderr, "%s: %s\n", err.pointer, err.text);
    BF_CHECK(status == BF_OK);
    return state;
}

void helper_spatial_run(spatial_state *s, double time)
{
    bf_error err = { .code = BF_OK };

    bf_status status = micro__spatial.advance(s, (uint64_t)llround(time / s->def.dt), &err);
    if (status != BF_OK)
        fprintf(stderr, "%s\n", err.text);
    BF_CHECK(status == BF_OK);
}

void helper_spatial_tilt(spatial_state *s, size_t k, vec3 axis, double angle, double height)
{
    spatial_body *body = &s->bodies[k];
    const hull *shape = &s->kinds[body->kind].shape;
    quat q = { cos(0.5 * angle), vec3_scale(vec3_unit(axis), sin(0.5 * angle)) };
    vec3 down = { 0.0, 0.0, -1.0 };

    body->q = quat_unit(quat_multiply(q, body->q));
    body->r = mat3_of_quat(body->q);
    size_t lowest = hull_support(shape, mat3_apply_back(&body->r, down));
    body->x.z = height - mat3_apply(&body->r, hull_vertex(shape, lowest)).z;
}

double helper_spatial_energy(const spatial_state *s)
{
    double sum = spatial__measure(s).kinetic_energy;

    for (size_t k = 0; k < s->n; k++)
        sum -= s->kinds[s->bodies[k].kind].mass * vec3_dot(s->gravity, s->bodies[k].x);
    return sum;
}

vec3 helper_spatial_momentum(const spatial_state *s)
{
    vec3 sum = { 0.0, 0.0, 0.0 };

    for (size_t k = 0; k < s->n; k++)
        sum = vec3_along(sum, s->kinds[s->bodies[k].kind].mass, s->bodies[k].v);
    return sum;
}

vec3 helper_spatial_angular_momentum(const spatial_state *s)
{
    vec3 sum = { 0.0, 0.0, 0.0 };

    for (size_t k = 0; k < s->n; k++) {
        const spatial_body *body = &s->bodies[k];
        const spatial_kind *kind = &s->kinds[body->kind];
        vec3 w = mat3_apply_back(&body->r, body->w);
        vec3 l = { kind->inertia.x * w.x, kind->inertia.y * w.y, kind->inertia.z * w.z };
        sum = vec3_along(sum, kind->mass, vec3_cross(body->x, body->v));
        sum = vec3_add(sum, mat3_apply(&body->r, l));
    }
    return sum;
}

uint64_t helper_spatial_digest(const spatial_state *s)
{
    uint64_t digest = DIGEST_START;

    for (size_t k = 0; k < s->n; k++) {
        const micro_part part = spatial__part(s, k);
        digest = digest_add(digest, part.x, sizeof part.x);
        digest = digest_add(digest, part.q, sizeof part.q);
        digest = digest_add(digest, part.v, sizeof part.v);
        digest = digest_add(digest, part.w, sizeof part.w);
    }
    return digest;
}
