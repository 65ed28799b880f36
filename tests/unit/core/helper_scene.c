#include "tests/unit/core/helper_scene.h"

#include "core/base/check.h"
#include "core/base/memory.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/// A copy of n items in memory of its own.
static void *copy(const void *items, size_t n, size_t size)
{
    void *room = memory_alloc(n, size);

    BF_CHECK(room != NULL);
    if (n > 0)
        memcpy(room, items, n * size);
    return room;
}

void helper_scene_resolve(scene *s)
{
    BF_CHECK(scene_resolve(s, NULL) == BF_OK);
}

void helper_scene_belt(scene *s, double length, double width, double cell, const scene_pose *poses,
                       size_t n)
{
    scene_init(s);
    s->duration = 1.0;
    s->domain = (scene_rect){ 0.0, length, 0.0, width };
    s->macro.cell = cell;
    s->macro.step = 0.0;
    s->macro.closure = SCENE_DISPERSIVE;
    s->initial.type = SCENE_INITIAL_POSITIONS;
    s->initial.n_poses = n;
    s->initial.poses = copy(poses, n, sizeof *poses);
}

scene_obstacle *helper_scene_add_obstacle(scene *s, const vec2 *path, size_t n,
                                          scene_treatment treatment)
{
    scene_obstacle *all = memory_alloc(s->n_obstacles + 1, sizeof *all);

    BF_CHECK(all != NULL);
    if (s->n_obstacles > 0)
        memcpy(all, s->obstacles, s->n_obstacles * sizeof *all);
    memory_free(s->obstacles);
    s->obstacles = all;
    scene_obstacle *o = &all[s->n_obstacles++];
    scene_obstacle_init(o);
    o->treatment = treatment;
    o->n_points = n;
    o->path = copy(path, n, sizeof *path);
    return o;
}

scene_belt *helper_scene_add_belt(scene *s, vec2 velocity, const vec2 *polygon, size_t n)
{
    scene_belt *all = memory_alloc(s->n_belts + 1, sizeof *all);

    BF_CHECK(all != NULL);
    if (s->n_belts > 0)
        memcpy(all, s->belts, s->n_belts * sizeof *all);
    memory_free(s->belts);
    s->belts = all;
    scene_belt *b = &all[s->n_belts++];
    s->n_sections = s->n_belts;
    scene_belt_init(b);
    b->velocity = velocity;
    b->n_points = n;
    b->polygon = n > 0 ? copy(polygon, n, sizeof *polygon) : NULL;
    return b;
}

scene_belt *helper_scene_add_arc(scene *s, double speed, double inner, double outer, double from,
                                 double to)
{
    scene_belt *belt = helper_scene_add_belt(s, (vec2){ speed, 0.0 }, NULL, 0);

    belt->arc.is_given = true;
    belt->arc.inner_radius = inner;
    belt->arc.outer_radius = outer;
    belt->arc.from = from * M_PI / 180.0;
    belt->arc.to = to * M_PI / 180.0;
    return belt;
}

scene_belt *helper_scene_add_path(scene *s, double speed, double width, double radius,
                                  const vec2 *points, size_t n)
{
    scene_belt *belt = helper_scene_add_belt(s, (vec2){ speed, 0.0 }, NULL, 0);

    belt->path = (scene_belt_path){ .n_points = n,
                                    .points = copy(points, n, sizeof *points),
                                    .n_radii = n - 2,
                                    .radii = memory_alloc(n, sizeof *belt->path.radii),
                                    .width = width };
    BF_CHECK(belt->path.radii != NULL);
    for (size_t k = 0; k + 2 < n; k++)
        belt->path.radii[k] = radius;
    return belt;
}

scene_feed *helper_scene_add_feed(scene *s, scene_side edge, scene_arrivals arrivals, double rate)
{
    scene_feed *all = memory_alloc(s->n_feeds + 1, sizeof *all);

    BF_CHECK(all != NULL);
    if (s->n_feeds > 0)
        memcpy(all, s->feeds, s->n_feeds * sizeof *all);
    memory_free(s->feeds);
    s->feeds = all;
    scene_feed *f = &all[s->n_feeds++];
    scene_feed_init(f);
    f->is_edge = true;
    f->edge = edge;
    f->demand = SCENE_DEMAND_RATE;
    f->arrivals = arrivals;
    f->rate = rate;
    return f;
}

void helper_scene_schedule(scene_belt *belt, size_t n, const double *times, const double *factors)
{
    belt->speed_schedule = (scene_speed_schedule){ .n_times = n,
                                                   .times = copy(times, n, sizeof *times),
                                                   .n_factors = n,
                                                   .factors = copy(factors, n, sizeof *factors) };
}

scene_series helper_scene_series(size_t n, const double *times, const double *values, double repeat)
{
    return (scene_series){ n, copy(times, n, sizeof *times), n, copy(values, n, sizeof *values),
                           repeat };
}

void helper_scene_example(scene *s, double angle_deg, scene_treatment treatment)
{
    double angle = angle_deg * M_PI / 180.0, length = 0.5 / sin(angle);
    vec2 end = { 0.75, 0.5 };
    vec2 path[] = { { end.x - length * cos(angle), end.y - length * sin(angle) }, end };

    scene_init(s);
    s->duration = 6.0;
    s->domain = (scene_rect){ 0.0, 1.0, 0.0, 0.6 };
    s->macro.closure = SCENE_DISPERSIVE;
    s->macro.cell = 0.005;
    s->initial.type = SCENE_INITIAL_HEXAGONAL;
    s->initial.n_rows = 16;
    s->initial.n_columns = 12;
    s->initial.first = (vec2){ 0.10, 0.11 };
    s->initial.spacing = 1.02 * 2.0 * 0.012;
    helper_scene_add_obstacle(s, path, 2, treatment)->thickness =
        treatment == SCENE_FIELD ? 0.03 : 0.005;
    s->n_counters = 1;
    s->counters = memory_alloc(1, sizeof *s->counters);
    BF_CHECK(s->counters != NULL);
    scene_counter_init(s->counters);
    s->counters->rect.x_max = 0.75;
    helper_scene_resolve(s);
}

void helper_scene_set_vertices(scene *s, scene_shape_type type, const double (*vertices)[3],
                               size_t n)
{
    s->cargo[0].shape.type = type;
    s->cargo[0].shape.vertices = memory_alloc(n, sizeof *vertices);
    s->cargo[0].shape.n_vertices = n;
    BF_CHECK(s->cargo[0].shape.vertices != NULL);
    memcpy(s->cargo[0].shape.vertices, vertices, n * sizeof *vertices);
}

double helper_scene_draw(bf_random *random, double low, double high, double cell)
{
    double x = low + random_unit(random) * (high - low);
    switch (random_bits(random) % 4) {
    case 0:
        return round(x / cell) * cell; // a face
    case 1:
        return (floor(x / cell) + 0.5) * cell; // a centre
    default:
        return x;
    }
}

scene_belt helper_scene_oblique_belt(double acceleration, double deceleration, size_t n,
                                     double *times, double *factors)
{
    return (scene_belt){ .velocity = { 0.3, 0.4 },
                         .acceleration = acceleration,
                         .deceleration = deceleration,
                         .speed_schedule = { n, times, n, factors } };
}

scene_failure helper_scene_failure(const char *id, scene_drawn_time between,
                                   scene_drawn_time repair)
{
    scene_failure f = { .type = SCENE_FAILURE_DRAWN, .between = between, .repair = repair };

    snprintf(f.id, sizeof f.id, "%s", id);
    return f;
}

scene_drawn_time helper_scene_fixed_time(double mean)
{
    return (scene_drawn_time){ mean, SCENE_TIME_FIXED, 1.0 };
}
