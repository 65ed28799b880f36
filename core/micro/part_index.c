#include "core/micro/part_index.h"

#include "core/base/memory.h"
#include "core/base/polygon.h"
#include "core/scene/placement.h"

#include <math.h>

bf_status part_index_init(const micro_def *def, part_index *ret_index, bf_error *err)
{
    // The belts choose the upstream sides of plates; afterwards only the domain and its edges are needed.
    surroundings around = { .domain = def->domain, .n_belts = def->n_belts, .belts = def->belts };
    part_index p = { .n_pieces = 0 };

    for (int side = 0; side < SCENE_SIDE_COUNT; side++)
        around.edges[side] = def->edges[side];
    p.footprints = memory_alloc(def->n_kinds, sizeof *p.footprints);
    size_t n = 0;
    for (size_t k = 0; k < def->n_obstacles; k++)
        n += def->obstacles[k].n_points - 1;
    p.pieces = memory_alloc(n, sizeof *p.pieces);
    if (p.footprints == NULL || p.pieces == NULL) {
        part_index_fini(&p);
        *ret_index = p;
        return bf_fail(err, BF_ENOMEM, "/obstacles", "no memory for the index of parts");
    }
    for (size_t k = 0; k < def->n_kinds; k++)
        p.footprints[k] = shape_footprint_of(&def->kinds[k].shape);
    for (size_t k = 0; k < def->n_obstacles; k++)
        for (size_t m = 0; m + 1 < def->obstacles[k].n_points; m++) {
            const surroundings_piece piece = surroundings_piece_of(&around, &def->obstacles[k], m);
            part_index_piece *own = &p.pieces[p.n_pieces++];
            own->obstacle = k;
            own->moves = scene_obstacle_moves(&def->obstacles[k]);
            surroundings_piece_corners(&piece, own->corners);
        }
    around.n_belts = 0;
    around.belts = NULL;
    p.around = around;
    *ret_index = p;
    return BF_OK;
}

void part_index_fini(part_index *p)
{
    if (p == NULL)
        return;
    memory_free(p->footprints);
    memory_free(p->pieces);
    memory_free(p->centres);
    neighbours_cells_fini(&p->cells);
    *p = (part_index){ .n_pieces = 0 };
}

void part_index_add(part_index *p, size_t part, uint32_t kind)
{
    p->is_sorted = p->is_sorted && p->n_recent < PART_INDEX_RECENT_MAX;
    if (!p->is_sorted)
        return;
    p->recent[p->n_recent++] = (uint32_t)part;
    p->radius_max = fmax(p->radius_max, p->footprints[kind].bounding_radius);
}

static bf_status sort(part_index *p, const part_index_parts *parts, bf_error *err)
{
    const uint8_t *presence = parts->state->presence;

    if (p->is_sorted)
        return BF_OK;
    // One more, so that the array is never empty.
    if (memory_reserve(&p->centres, &p->capacity, parts->n + 1, sizeof *p->centres) != 0)
        return bf_fail(err, BF_ENOMEM, "", "no memory for the index of %zu parts", parts->n);
    p->radius_max = SCENE_LENGTH_MIN;
    for (size_t k = 0; k < parts->n; k++) {
        if (presence[k] != MICRO_HERE)
            continue;
        const micro_extent extent = parts->backend->extent(parts->state, k);
        p->centres[k] = (vec2){ extent.pose.x, extent.pose.y };
        p->radius_max = fmax(p->radius_max, extent.radius);
    }
    const neighbours_parts sorted = { .x = &p->centres->x,
                                      .y = &p->centres->y,
                                      .stride = sizeof *p->centres / sizeof(double) };
    bf_status status =
        neighbours_sort(&p->cells, parts->n, &sorted, presence, 2.0 * p->radius_max, err);
    p->is_sorted = status == BF_OK;
    p->n_recent = 0;
    return status;
}

// A query: the parts near a line.
typedef struct query {
    const part_index_parts *parts;
    vec2 a, b;
    double distance;
    micro_visit *visit;
    void *context;
} query;

static void visit_part(const query *q, size_t part)
{
    const micro_extent extent = q->parts->backend->extent(q->parts->state, part);

    if (polygon_segment_distance((vec2){ extent.pose.x, extent.pose.y }, q->a, q->b) <= q->distance)
        q->visit(q->context, part, &extent);
}

// The cells of a column near the line; the outer columns go on without end.
static void visit_column(const part_index *p, const query *q, size_t column)
{
    const neighbours_cells *c = &p->cells;
    const double edge = 1.0 / c->per_edge, west = c->x_min + (double)column * edge;
    const vec2 lower = { column > 0 ? west - q->distance : -INFINITY, -INFINITY };
    const vec2 upper = { column + 1 < c->n_x ? west + edge + q->distance : INFINITY, INFINITY };
    vec2 a = q->a, b = q->b;

    if (!polygon_clip_segment(&a, &b, lower, upper))
        return;
    const size_t last = neighbours_row(c, fmax(a.y, b.y) + q->distance);
    for (size_t row = neighbours_row(c, fmin(a.y, b.y) - q->distance); row <= last; row++) {
        const size_t cell = neighbours_cell(c, column, row);
        for (uint32_t at = p->cells.first[cell]; at < p->cells.first[cell + 1]; at++) {
            const uint32_t part = p->cells.order[at];
            if (polygon_segment_distance(p->centres[part], q->a, q->b) <= q->distance)
                visit_part(q, part);
        }
    }
}

static void visit_near(const part_index *p, const query *q)
{
    const size_t last = neighbours_column(&p->cells, fmax(q->a.x, q->b.x) + q->distance);

    for (size_t column = neighbours_column(&p->cells, fmin(q->a.x, q->b.x) - q->distance);
         column <= last; column++)
        visit_column(p, q, column);
    for (size_t k = 0; k < p->n_recent; k++)
        visit_part(q, p->recent[k]);
}

bf_status part_index_visit_near(part_index *p, const part_index_parts *parts, vec2 a, vec2 b,
                                double distance, micro_visit *visit, void *context, bf_error *err)
{
    const query q = { parts, a, b, distance, visit, context };

    bf_status status = sort(p, parts, err);
    if (status == BF_OK)
        visit_near(p, &q);
    return status;
}

const shape_footprint *micro_footprint(const micro_extent *extent, const shape_footprint *flat,
                                       shape_footprint *room)
{
    const vec2 half = extent->half;

    if (extent->is_flat)
        return flat;
    *room = (shape_footprint){ .n_corners = 4,
                               .corners = { { -half.x, -half.y },
                                            { half.x, -half.y },
                                            { half.x, half.y },
                                            { -half.x, half.y } },
                               .bounding_radius = extent->radius,
                               .area = 4.0 * half.x * half.y };
    return room;
}

// The part that would be placed.
typedef struct candidate {
    const part_index *p;
    const shape_footprint *footprint;
    scene_pose pose;
    bool is_free;
} candidate;

static void compare_part(void *context, size_t part, const micro_extent *extent)
{
    candidate *n = context;
    shape_footprint room;
    const shape_footprint *other = micro_footprint(extent, &n->p->footprints[extent->kind], &room);

    (void)part;
    n->is_free = n->is_free && !shape_overlaps(n->footprint, n->pose, other, extent->pose);
}

static bool is_clear_of_piece(const part_index_parts *parts, const part_index_piece *piece,
                              const candidate *n)
{
    const plate_motion *motion = &parts->state->world->plates;
    const vec2 *c = piece->corners;
    const double range = n->footprint->bounding_radius + vec2_length(vec2_sub(c[2], c[1]));
    scene_pose pose = n->pose;

    if (piece->moves && !plate_motion_is_present(motion, piece->obstacle, parts->t))
        return true;
    if (piece->moves) {
        // The pose seen from a plate that has moved.
        const plate_displacement displacement = plate_motion_at(motion, piece->obstacle, parts->t);
        const plate_pose of = plate_pose_of(&motion->obstacles[piece->obstacle], displacement);
        const plate_pose back = plate_pose_inverse(&of);
        const vec2 at = plate_pose_move(&back, (vec2){ pose.x, pose.y });
        pose = (scene_pose){ at.x, at.y, pose.heading - displacement.angle };
    }
    return polygon_segment_distance((vec2){ pose.x, pose.y }, c[0], c[1]) > range ||
           !shape_overlaps_polygon(n->footprint, pose, c, 4);
}

static bool is_clear_of_surroundings(const part_index_parts *parts, const candidate *n)
{
    for (int side = 0; side < SCENE_SIDE_COUNT; side++)
        if (!(placement_excess(&n->p->around, n->footprint, n->pose, (scene_side)side) <=
              SCENE_TOLERANCE))
            return false;
    for (size_t k = 0; k < n->p->n_pieces; k++)
        if (!is_clear_of_piece(parts, &n->p->pieces[k], n))
            return false;
    return true;
}

bf_status part_index_find_free(part_index *p, const part_index_parts *parts, uint32_t kind,
                               scene_pose pose, bool *ret_is_free, bf_error *err)
{
    candidate n = { .p = p, .footprint = &p->footprints[kind], .pose = pose };
    const vec2 at = { pose.x, pose.y };

    bf_status status = sort(p, parts, err);
    if (status != BF_OK)
        return status;
    n.is_free = is_clear_of_surroundings(parts, &n);
    const query q = {
        parts, at, at, n.footprint->bounding_radius + p->radius_max, compare_part, &n
    };
    if (n.is_free)
        visit_near(p, &q);
    *ret_is_free = n.is_free;
    return BF_OK;
}
