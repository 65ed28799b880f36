#include "core/scene/placement.h"

#include "core/base/memory.h"
#include "core/base/random.h"
#include "core/scene/mix.h"
#include "core/scene/overlap_grid.h"
#include "core/scene/placement_priv.h"
#include "core/scene/surroundings.h"

#include <math.h>
#include <string.h>

/// Most places that are tried for n random parts.
static size_t limit_attempts(size_t n)
{
    return 100000 + 20 * n;
}

/// Farthest point of a footprint from the centre in direction u, m.
static double find_support(const shape_footprint *footprint, scene_pose pose, vec2 u)
{
    vec2 corners[SCENE_VERTICES_MAX + 1];
    double support = -INFINITY;

    if (footprint->n_corners == 0)
        return footprint->reach;
    shape_place(footprint, (scene_pose){ 0.0, 0.0, pose.heading }, corners);
    for (size_t k = 0; k < footprint->n_corners; k++)
        support = fmax(support, vec2_dot(corners[k], u));
    return support;
}

double placement__excess(const scene *s, const shape_footprint *footprint, scene_pose pose,
                         scene_side side)
{
    const surroundings around = surroundings_of(s);
    const double excess = surroundings_excess(&around, side, (vec2){ pose.x, pose.y });
    const vec2 outward = vec2_scale(surroundings_side(&around, side).inward, -1.0);

    if (s->edges[side] != SCENE_EDGE_WALL)
        return excess;
    return excess + fmax(find_support(footprint, pose, outward), 0.0);
}

static void place_hexagonal(const scene_initial *initial, scene_pose *ret_poses)
{
    double row_distance = initial->spacing * (sqrt(3.0) / 2.0);

    for (size_t row = 0; row < initial->n_rows; row++) {
        double x = initial->first.x + (row % 2 == 1 ? 0.5 * initial->spacing : 0.0);
        double y = initial->first.y + (double)row * row_distance;
        for (size_t column = 0; column < initial->n_columns; column++)
            *ret_poses++ = (scene_pose){ x + (double)column * initial->spacing, y, 0.0 };
    }
}

static const shape_footprint *footprint_of(const crowd *c, size_t k)
{
    return &c->footprints[mix_kind(c->kinds, k)];
}

static bool has_room(const scene *s, const crowd *c, size_t k, scene_pose pose)
{
    size_t other;

    for (scene_side side = 0; side < SCENE_SIDE_COUNT; side++) {
        if (placement__excess(s, footprint_of(c, k), pose, side) > 0.0)
            return false;
    }
    return !overlap_grid_overlaps(c, k, pose, &other);
}

static scene_pose draw_pose(const scene_rect *region, bool is_turned, bf_random *random)
{
    scene_pose pose = { .heading = 0.0 };

    pose.x = region->x_min + random_unit(random) * (region->x_max - region->x_min);
    pose.y = region->y_min + random_unit(random) * (region->y_max - region->y_min);
    if (is_turned)
        pose.heading = random_unit(random) * (2.0 * M_PI);
    return pose;
}

/// Place parts at random until all have room, or too many places were tried. Returns how many.
static size_t fill_crowd(const scene *s, crowd *c, scene_pose *ret_poses)
{
    size_t n = 0;
    bf_random random;

    random_init(&random, s->initial.seed);
    for (size_t left = limit_attempts(s->initial.n_random); left > 0 && n < s->initial.n_random;
         left--) {
        bool is_turned = footprint_of(c, n)->n_corners > 0;
        scene_pose pose = draw_pose(&s->initial.region, is_turned, &random);
        if (has_room(s, c, n, pose)) {
            ret_poses[n] = pose;
            overlap_grid_add(c, n++);
        }
    }
    return n;
}

/// Largest share of a region that is worth a try. Random places jam near 0.55; few parts that reach
/// over a small region's border may do better.
static double limit_cover(size_t n)
{
    return n < 10000 ? 1.0 : 0.6;
}

/// Share of the region, with the margin that parts may reach over its border, that the parts cover.
static double measure_cover(const scene *s, const shape_footprint *footprints)
{
    const scene_rect *region = &s->initial.region;
    size_t counts[SCENE_KINDS_MAX];
    double reach = 0.0, area = 0.0;

    mix_count(s, s->initial.n_random, counts);
    for (size_t k = 0; k < s->n_cargo; k++) {
        reach = fmax(reach, 2.0 * footprints[k].reach);
        area += (double)counts[k] * footprints[k].area;
    }
    return area /
           ((region->x_max - region->x_min + reach) * (region->y_max - region->y_min + reach));
}

static bf_status place_random(const scene *s, const uint32_t *kinds, scene_pose *ret_poses,
                              bf_error *err)
{
    shape_footprint footprints[SCENE_KINDS_MAX];
    size_t wanted = s->initial.n_random;
    crowd c;

    mix_footprints(s, footprints);
    double cover = measure_cover(s, footprints);

    if (cover > limit_cover(wanted))
        return bf_fail(err, BF_EINPUT, "/initial/random",
                       "%zu parts would cover %.0f %% of the region, and random places without "
                       "overlap fill about half of it",
                       wanted, 100.0 * cover);
    bf_status status = overlap_grid_init(&c, footprints, s->n_cargo, kinds, ret_poses, wanted, err);
    if (status != BF_OK)
        return status;
    size_t n = fill_crowd(s, &c, ret_poses);
    overlap_grid_fini(&c);
    if (n < wanted)
        return bf_fail(err, BF_EINPUT, "/initial/random",
                       "only %zu of %zu parts found room without overlap in %zu attempts; all "
                       "would cover %.0f %% of the region, and random places fill about half of it",
                       n, wanted, limit_attempts(wanted), 100.0 * cover);
    return BF_OK;
}

bf_status placement_make(const scene *s, placement *ret_placement, bf_error *err)
{
    placement p = { .n = scene_parts(s) };

    p.poses = memory_alloc(p.n, sizeof *p.poses);
    if (p.poses == NULL)
        return bf_fail(err, BF_ENOMEM, "/initial", "no memory for %zu parts", p.n);
    bf_status status = mix_draw(s, p.n, &p.kinds, err);
    if (status != BF_OK) {
        placement_fini(&p);
        return status;
    }
    if (s->initial.type == SCENE_INITIAL_POSITIONS && p.n > 0)
        memcpy(p.poses, s->initial.poses, p.n * sizeof *p.poses);
    else if (s->initial.type == SCENE_INITIAL_HEXAGONAL)
        place_hexagonal(&s->initial, p.poses);
    else if (s->initial.type == SCENE_INITIAL_RANDOM)
        status = place_random(s, p.kinds, p.poses, err);
    if (status != BF_OK) {
        placement_fini(&p);
        return status;
    }
    *ret_placement = p;
    return BF_OK;
}

void placement_fini(placement *p)
{
    if (p == NULL)
        return;
    memory_free(p->poses);
    memory_free(p->kinds);
    *p = (placement){ 0 };
}
