#include "core/run/beam.h"

#include "core/base/memory.h"
#include "core/base/polygon.h"
#include "core/scene/limits.h"

#include <math.h>

bool beam_meets_part(const vec2 beam[2], const shape_footprint *footprint, scene_pose pose)
{
    const size_t n = footprint->n_corners;
    const vec2 centre = { pose.x, pose.y };
    vec2 corners[SCENE_VERTICES_MAX + 1];

    if (polygon_segment_distance(centre, beam[0], beam[1]) > footprint->bounding_radius)
        return false;
    if (n == 0)
        return true;
    shape_place(footprint, pose, corners);
    bool is_met = polygon_holds(corners, n, beam[0], 0.0);
    for (size_t k = 0; k < n && !is_met; k++)
        is_met = polygon_segments_touch(beam[0], beam[1], corners[k], corners[(k + 1) % n], 0.0);
    return is_met;
}

beam_extent beam_extent_of(vec2 from, vec2 along, const shape_footprint *footprint, scene_pose pose)
{
    const size_t n = footprint->n_corners;
    const double centre = vec2_dot((vec2){ pose.x - from.x, pose.y - from.y }, along);
    const double radius = footprint->bounding_radius;
    beam_extent extent = { (double)INFINITY, -(double)INFINITY };
    vec2 corners[SCENE_VERTICES_MAX + 1];

    if (n == 0)
        return (beam_extent){ centre - radius, centre + radius };
    shape_place(footprint, pose, corners);
    for (size_t k = 0; k < n; k++) {
        const double at = vec2_dot((vec2){ corners[k].x - from.x, corners[k].y - from.y }, along);
        extent.least = fmin(extent.least, at);
        extent.most = fmax(extent.most, at);
    }
    return extent;
}

// Cells that hold the coordinates from `from` to `to`, with one more on both ends: first <= k < last.
static void find_range(double from, double to, double lower, double d, size_t n, size_t *ret_first,
                       size_t *ret_last)
{
    const double first = floor((fmin(from, to) - lower) / d) - 1.0;
    const double last = floor((fmax(from, to) - lower) / d) + 2.0;

    *ret_first = (size_t)fmin(fmax(first, 0.0), (double)n);
    *ret_last = (size_t)fmin(fmax(last, 0.0), (double)n);
}

static bool meets_cell(const vec2 beam[2], const bf_grid *g, size_t i, size_t j)
{
    const double dx = 0.5 * g->d1 + SCENE_TOLERANCE, dy = 0.5 * g->d2 + SCENE_TOLERANCE;
    const vec2 lower = { grid_x1(g, i) - dx, grid_x2(g, j) - dy };
    const vec2 upper = { grid_x1(g, i) + dx, grid_x2(g, j) + dy };
    vec2 start = beam[0], end = beam[1];

    return polygon_clip_segment(&start, &end, lower, upper);
}

bf_status beam_cells_of(const vec2 beam[2], const bf_grid *grid, beam_cells *ret_cells,
                        bf_error *err)
{
    size_t i_first, i_last, j_first, j_last, capacity = 0;
    beam_cells found = { .n = 0 };

    find_range(beam[0].x, beam[1].x, grid->lower1, grid->d1, grid->n1, &i_first, &i_last);
    find_range(beam[0].y, beam[1].y, grid->lower2, grid->d2, grid->n2, &j_first, &j_last);
    for (size_t j = j_first; j < j_last; j++) {
        for (size_t i = i_first; i < i_last; i++) {
            if (!meets_cell(beam, grid, i, j))
                continue;
            if (memory_reserve(&found.cells, &capacity, found.n + 1, sizeof *found.cells) != 0) {
                beam_cells_fini(&found);
                return bf_fail(err, BF_ENOMEM, "", "no memory for the cells of a photo eye");
            }
            found.cells[found.n++] = j * grid->n1 + i;
        }
    }
    *ret_cells = found;
    return BF_OK;
}

void beam_cells_fini(beam_cells *cells)
{
    memory_free(cells->cells);
    *cells = (beam_cells){ .n = 0 };
}
