#include "tests/unit/core/helper_body.h"

#include "core/base/check.h"
#include "core/base/digest.h"
#include "tests/unit/core/helper_hull.h"
#include "tests/unit/helper_cmocka.h"

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

void helper_body_check_fall(const helper_body *h, bf_random *random)
{
    body_state *s = helper_body_start(h);
    vec3 axis = { helper_hull_number(random, -1.0, 1.0), helper_hull_number(random, -1.0, 1.0),
                  helper_hull_number(random, -1.0, 1.0) };

    helper_body_tilt(s, 0, axis, helper_hull_number(random, 0.0, 3.0), 0.005);
    s->bodies[0].w = (vec3){ helper_hull_number(random, -20.0, 20.0), 5.0, -10.0 };
    double least = helper_body_energy(s), start = least;
    for (int m = 0; m < 300; m++) {
        helper_body_run(s, 1e-3);
        double now = helper_body_energy(s) + helper_body_stored(s);
        assert_true(now <= least + 2e-3 * start);
        least = fmin(least, now);
    }
    assert_true(least < 0.8 * start);
    micro__body.destroy(s);
}

void helper_body_check_pair(helper_body *h, double tolerance)
{
    h->def.n_parts = 2;
    h->poses[0] = (scene_pose){ -0.03, 0.0, 0.2 };
    h->poses[1] = (scene_pose){ 0.03, 0.012, 0.9 };
    body_state *s = helper_body_start(h);
    s->gravity = (vec3){ 0.0, 0.0, 0.0 };
    for (size_t k = 0; k < 2; k++) {
        s->bodies[k].x.z = 0.5 + 0.004 * (double)k;
        s->bodies[k].v = (vec3){ k == 0 ? 0.5 : -0.3, 0.1, 0.05 };
    }
    vec3 momentum = helper_body_momentum(s), angular = helper_body_angular_momentum(s);
    double energy = helper_body_energy(s);
    for (int k = 0; k < 100; k++) {
        helper_body_run(s, 1e-3);
        assert_true(helper_body_energy(s) <= energy * (1.0 + 1e-9));
    }
    vec3 change = vec3_sub(helper_body_momentum(s), momentum);
    assert_true(vec3_length(change) < 1e-12 * vec3_length(momentum));
    change = vec3_sub(helper_body_angular_momentum(s), angular);
    assert_true(vec3_length(change) < tolerance * vec3_length(angular));
    assert_true(vec3_length(s->bodies[0].w) > 0.1 && helper_body_energy(s) < 0.9 * energy);
    micro__body.destroy(s);
}

void helper_body_check_barrier(helper_body *h, bool is_wall)
{
    const scene_shape *shape = &h->kinds[0].shape;
    const double reach =
        shape->type == SCENE_BOX ? 0.5 * hypot(shape->length, shape->width) : shape->radius;

    h->def.n_belts = 1;
    h->def.n_obstacles = is_wall ? 0 : 1;
    h->obstacle.thickness = 5e-4;
    h->path[0] = (vec2){ 0.05, -0.2 };
    h->path[1] = (vec2){ 0.05, 0.2 };
    if (is_wall) {
        h->def.domain.x_max = 0.05;
        h->def.edges[SCENE_EAST] = SCENE_EDGE_WALL;
    }
    h->poses[0].heading = 0.6;
    body_state *s = helper_body_start(h);
    helper_body_run(s, 0.4);
    micro_part part = body__part(s, 0);
    assert_false(part.is_gone);
    assert_true(part.x[0] < 0.05 && part.x[0] > 0.05 - reach - 1e-3);
    assert_true(fabs(part.v[0]) < 0.02);
    assert_int_equal(body__measure(s).n_contacts, 1);
    assert_true(body__measure(s).largest_overlap < 5e-4);
    micro__body.destroy(s);
}
