#include "core/scene/placement.h"

#include "core/base/memory.h"
#include "core/base/random.h"
#include "core/scene/mix.h"
#include "core/scene/overlap_grid.h"
#include "core/scene/scene_priv.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

size_t scene_parts(const scene *s)
{
    switch (s->initial.type) {
    case SCENE_INITIAL_POSITIONS:
        return s->initial.n_poses;
    case SCENE_INITIAL_HEXAGONAL:
        return (size_t)s->initial.n_rows * s->initial.n_columns;
    case SCENE_INITIAL_RANDOM:
        return s->initial.n_random;
    default:
        return 0;
    }
}

/// Most places that are tried for n random parts.
static size_t limit_attempts(size_t n)
{
    return 100000 + 20 * n;
}

double placement_excess(const surroundings *around, const shape_footprint *footprint,
                        scene_pose pose, scene_side side)
{
    const double excess = surroundings_excess(around, side, (vec2){ pose.x, pose.y });
    const vec2 outward = vec2_scale(surroundings_side(around, side).inward, -1.0);

    if (around->edges[side] != SCENE_EDGE_WALL)
        return excess;
    return excess + shape_extent(footprint, pose.heading, outward);
}

static bool is_inside(const surroundings *around, const shape_footprint *footprint, scene_pose pose)
{
    const double clear = -(1.0 + 1e-9) * footprint->bounding_radius;

    for (scene_side side = 0; side < SCENE_SIDE_COUNT; side++) {
        if (surroundings_excess(around, side, (vec2){ pose.x, pose.y }) > clear &&
            placement_excess(around, footprint, pose, side) > 0.0)
            return false;
    }
    return true;
}

/// Place parts at random until all fit, too many places were tried, that took more than so many steps or was cancelled.
/// Returns how many.
static size_t fill_region(const scene *s, uint64_t steps_max, const bf_faults *check,
                          overlap_grid *c, scene_pose *ret_poses)
{
    const surroundings around = surroundings_of(s);
    const scene_rect *region = &s->initial.region;
    size_t n = 0, other;
    bf_random random;

    random_init(&random, s->initial.seed);
    for (size_t left = limit_attempts(s->initial.n_random);
         left > 0 && n < s->initial.n_random && c->steps <= steps_max &&
         !faults_are_cancelled(check);
         left--) {
        const shape_footprint *footprint = &c->footprints[mix_kind(c->kinds, n)];
        scene_pose pose = { .heading = 0.0 };
        pose.x = region->x_min + random_unit(&random) * (region->x_max - region->x_min);
        pose.y = region->y_min + random_unit(&random) * (region->y_max - region->y_min);
        if (footprint->n_corners > 0)
            pose.heading = random_unit(&random) * (2.0 * M_PI);
        if (is_inside(&around, footprint, pose) && !overlap_grid_overlaps(c, n, pose, &other)) {
            ret_poses[n] = pose;
            overlap_grid_add(c, n++);
        }
    }
    return n;
}

/// What random parts would do to their region, by means over their kinds.
typedef struct crowding {
    double
        cover; ///< fraction of the region, with the margin that parts may extend over its border, that they cover
    double attempts; ///< places to try until all have found room, at least
} crowding;

static double perimeter_of(const shape_footprint *footprint)
{
    double sum = 0.0;

    if (footprint->n_corners == 0)
        return 2.0 * M_PI * footprint->bounding_radius;
    for (size_t k = 0, last = footprint->n_corners - 1; k < footprint->n_corners; last = k++)
        sum += vec2_length(vec2_sub(footprint->corners[k], footprint->corners[last]));
    return sum;
}

/// A part keeps the centres of others out of the area A + A + P P/(2 pi) in the mean over their headings, with the areas
/// A and perimeters P of two convex outlines (Santalo, Integral Geometry and Geometric Probability, 1976, I.6.5). If k
/// parts leave exp(-k E/R) of the region R, which is more than is left where excluded areas overlap less, n take
/// n (e^X - 1)/X attempts, X = n E/R.
static crowding predict_crowding(const scene *s, const shape_footprint *footprints)
{
    const scene_rect *region = &s->initial.region;
    const double n = s->initial.n_random;
    size_t counts[SCENE_KINDS_MAX];
    double margin = 0.0, area = 0.0, perimeter = 0.0;

    mix_count(s, s->initial.n_random, counts);
    for (size_t k = 0; k < s->n_cargo; k++) {
        margin = fmax(margin, 2.0 * footprints[k].bounding_radius);
        area += (double)counts[k] * footprints[k].area;
        perimeter += (double)counts[k] / n * perimeter_of(&footprints[k]);
    }
    const double room =
        (region->x_max - region->x_min + margin) * (region->y_max - region->y_min + margin);
    const double excluded = 2.0 * area / n + perimeter * perimeter / (2.0 * M_PI);
    const double x = n * excluded / room;
    return (crowding){ .cover = area / room, .attempts = n * expm1(x) / x };
}

/// Predictions err: places that are this many times too many are not tried.
#define HOPELESS 100.0

static bf_status fail_cancelled(bf_error *err)
{
    return bf_fail(err, BF_EBUSY, "", "the check was cancelled, as the service is stopping");
}

static bf_status place_random(const scene *s, const uint32_t *kinds, uint64_t steps_max,
                              const bf_faults *check, scene_pose *ret_poses, bf_error *err)
{
    shape_footprint footprints[SCENE_KINDS_MAX];
    size_t wanted = s->initial.n_random;
    overlap_grid c;

    mix_footprints(s, footprints);
    const crowding predicted = predict_crowding(s, footprints);
    // Random places jam near 0.55; a few parts that extend over a small region's border may exceed it.
    if (predicted.cover > (wanted < 10000 ? 1.0 : 0.6))
        return bf_fail(err, BF_EINPUT, "/initial/random",
                       "%zu parts would cover %.0f %% of the region, and random places without "
                       "overlap fill about half of it",
                       wanted, 100.0 * predicted.cover);
    if (predicted.attempts > HOPELESS * (double)limit_attempts(wanted))
        return bf_fail(err, BF_EINPUT, "/initial/random",
                       "%zu parts of this shape would find room without overlap in some %.1g "
                       "attempts, the limit is %zu",
                       wanted, predicted.attempts, limit_attempts(wanted));
    bf_status status = overlap_grid_init(&c, footprints, s->n_cargo, kinds, ret_poses, wanted, err);
    if (status != BF_OK)
        return status;
    const size_t n = fill_region(s, steps_max, check, &c, ret_poses);
    const bool is_cut = c.steps > steps_max;
    overlap_grid_fini(&c);
    if (n == wanted)
        return BF_OK;
    if (faults_are_cancelled(check))
        return fail_cancelled(err);
    if (is_cut)
        return bf_fail(err, BF_ELIMIT, "/initial/random",
                       "only %zu of %zu parts found room without overlap in %.3g steps of the "
                       "search, which is the limit; fewer parts, or a larger region, take less",
                       n, wanted, (double)steps_max);
    return bf_fail(err, BF_EINPUT, "/initial/random",
                   "only %zu of %zu parts found room without overlap in %zu attempts; all "
                   "would cover %.0f %% of the region, and random places fill about half of it",
                   n, wanted, limit_attempts(wanted), 100.0 * predicted.cover);
}

bf_status placement_make_within(const scene *s, uint64_t steps_max, const bf_faults *check,
                                scene_placement *ret_placement, bf_error *err)
{
    scene_placement p = { .n = scene_parts(s) };

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
    else if (s->initial.type == SCENE_INITIAL_HEXAGONAL) {
        scene_pose *next = p.poses;
        double row_distance = s->initial.spacing * (sqrt(3.0) / 2.0);
        for (size_t row = 0; row < s->initial.n_rows; row++) {
            double x = s->initial.first.x + (row % 2 == 1 ? 0.5 * s->initial.spacing : 0.0);
            double y = s->initial.first.y + (double)row * row_distance;
            for (size_t column = 0; column < s->initial.n_columns; column++)
                *next++ = (scene_pose){ x + (double)column * s->initial.spacing, y, 0.0 };
        }
    } else if (s->initial.type == SCENE_INITIAL_RANDOM)
        status = place_random(s, p.kinds, steps_max, check, p.poses, err);
    if (status != BF_OK) {
        placement_fini(&p);
        return status;
    }
    *ret_placement = p;
    return BF_OK;
}

bf_status placement_make(const scene *s, scene_placement *ret_placement, bf_error *err)
{
    const bf_faults never = { .is_cancelled = NULL };

    return placement_make_within(s, UINT64_MAX, &never, ret_placement, err);
}

bf_status placement_of(const scene *s, scene_placement *ret_placement, bf_error *err)
{
    if (s->placement.n == 0)
        return placement_make(s, ret_placement, err);
    *ret_placement = s->placement;
    ret_placement->is_borrowed = true;
    return BF_OK;
}

void placement_fini(scene_placement *p)
{
    if (p == NULL)
        return;
    if (!p->is_borrowed) {
        memory_free(p->poses);
        memory_free(p->kinds);
    }
    *p = (scene_placement){ .n = 0 };
}

/// The state of the check.
typedef struct overlap_findings {
    const scene *s;
    const scene_placement *p;
    shape_footprint footprints[SCENE_KINDS_MAX];
    bf_faults *faults;
    size_t n_outside;
    size_t n_overlaps;
} overlap_findings;

size_t placement__reported_max(const scene *s)
{
    return s->initial.type == SCENE_INITIAL_POSITIONS ? REPORTED_MAX : 1;
}

static const shape_footprint *footprint_in(const overlap_findings *f, size_t k)
{
    return &f->footprints[mix_kind(f->p->kinds, k)];
}

const char *placement__point_at(const scene *s, size_t k, char *room)
{
    if (s->initial.type == SCENE_INITIAL_HEXAGONAL)
        return "/initial/hexagonal";
    if (s->initial.type == SCENE_INITIAL_RANDOM)
        return "/initial/random";
    snprintf(room, BF_POINTER_SIZE, "/initial/positions_m/%zu", k);
    return room;
}

/// Note a part that extends over a side of the domain. Returns true if it does not.
static bool check_inside(overlap_findings *f, size_t k)
{
    static const char *const words[SCENE_SIDE_COUNT] = { "west", "east", "south", "north" };
    const surroundings around = surroundings_of(f->s);
    char room[BF_POINTER_SIZE];
    scene_pose at = f->p->poses[k];

    for (scene_side side = 0; side < SCENE_SIDE_COUNT; side++) {
        double excess = placement_excess(&around, footprint_in(f, k), at, side);
        if (excess <= SCENE_TOLERANCE)
            continue;
        f->n_outside++;
        if (f->s->edges[side] == SCENE_EDGE_WALL)
            faults_add(f->faults, placement__point_at(f->s, k, room),
                       "part %zu at (%g, %g) m reaches %g m over the %s wall", k, at.x, at.y,
                       excess, words[side]);
        else
            faults_add(f->faults, placement__point_at(f->s, k, room),
                       "part %zu at (%g, %g) m lies %g m outside the domain in the %s", k, at.x,
                       at.y, excess, words[side]);
        return false;
    }
    return true;
}

/// Note an overlap of part k with another. Returns true if there is none.
static bool check_free(overlap_findings *f, overlap_grid *c, size_t k)
{
    scene_pose at = f->p->poses[k];
    char room[BF_POINTER_SIZE];
    size_t other;

    if (!overlap_grid_overlaps(c, k, at, &other))
        return true;
    scene_pose with = f->p->poses[other];
    double distance = vec2_length((vec2){ at.x - with.x, at.y - with.y });
    const char *pointer = placement__point_at(f->s, k, room);
    f->n_overlaps++;
    const shape_footprint *own = footprint_in(f, k), *its = footprint_in(f, other);
    if (own->n_corners == 0 && its->n_corners == 0)
        faults_add(f->faults, pointer,
                   "part %zu at (%g, %g) m overlaps part %zu: they are %g m apart, the least is "
                   "%g m",
                   k, at.x, at.y, other, distance, own->bounding_radius + its->bounding_radius);
    else
        faults_add(f->faults, pointer, "part %zu at (%g, %g) m overlaps part %zu, %g m away", k,
                   at.x, at.y, other, distance);
    return false;
}

bf_status placement_check(const scene *s, const scene_placement *p, bf_faults *faults,
                          bf_error *err)
{
    overlap_findings f = { .s = s, .p = p, .faults = faults };
    size_t limit = placement__reported_max(s);
    overlap_grid c;

    if (s->initial.type == SCENE_INITIAL_RANDOM)
        return BF_OK; // placed where they are inside and overlap none
    mix_footprints(s, f.footprints);
    BF_TRY(overlap_grid_init(&c, f.footprints, s->n_cargo, p->kinds, p->poses, p->n, err));
    for (size_t k = 0; k < p->n && f.n_outside < limit && f.n_overlaps < limit &&
                       c.steps <= SCENE_PLACEMENT_STEPS_MAX && !faults_are_cancelled(faults);
         k++) {
        if (check_inside(&f, k) && check_free(&f, &c, k))
            overlap_grid_add(&c, k);
    }
    if (c.steps > SCENE_PLACEMENT_STEPS_MAX)
        faults_add_limit(
            faults, "/initial",
            "%zu parts that lie so near to each other take more than %.3g steps to look "
            "for overlaps, which is the limit",
            p->n, (double)SCENE_PLACEMENT_STEPS_MAX);
    overlap_grid_fini(&c);
    return faults_are_cancelled(faults) ? fail_cancelled(err) : BF_OK;
}
