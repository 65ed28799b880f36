// v_stat and the closed faces on a grid, by the rules of regions.h and the lines of closed_lines.h.
//
// The velocity is constant between the borders of belts and bands. Row by row, the rules are
// evaluated at each face next to a border and, of every run of faces between borders, at one; the rest
// are copies of it. So the cost is little more than that of writing the result. No two faces of an arc need have the same velocity.
//
// Where obstacles move, only faces within reach of them are evaluated again. Their rectangles are grown by the widest band and the
// cells over which a line closes faces and gives corners of arcs its q; where that moves the q' of other corners, the
// faces between these are evaluated, too. Lines, apertures and what closed faces stop are made anew for all: that is cheap, and an
// aperture depends on what is opposite, however far.

#include "core/macro/velocity_field.h"

#include "core/base/memory.h"
#include "core/macro/aperture.h"
#include "core/macro/arc_faces.h"
#include "core/macro/closed_lines.h"
#include "core/macro/regions.h"
#include "core/scene/belt.h"
#include "core/scene/belt_range.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// Faces as near as this to a border are next to it, m: more than the rules' tolerances.
#define MARGIN (4.0 * SCENE_TOLERANCE)

enum { BORDERS_PER_SEGMENT = 8 };

/// Where the rules are evaluated for a face: at its centre, just before and behind it, in the centres of the cells beside it.
enum { AT_FACE, BEFORE_FACE, BEHIND_FACE, CELL_BEFORE, CELL_BEHIND, FACE_POINTS };

#define NOT_KNOWN UINT16_MAX ///< of a belt

/// A straight border between constant velocities.
typedef struct border {
    vec2 low;  ///< the end with the smaller y, m
    vec2 high; ///< the other end, m
} border;

/// What the rows are filled from, with room for all of a scene's segments and borders.
typedef struct velocity_field_sampler {
    surroundings around;
    size_t n_segments;
    regions_segment *segments;
    regions_segment *standing; ///< those of obstacles that never move, in their order; *
    uint8_t *closed[2];        ///< faces closed by the lines of these and by edges; *
    size_t n_near;             ///< segments whose bands may touch the row
    const regions_segment **near;
    size_t n_borders;
    border *borders; ///< sorted by low.y
    size_t n_begun;  ///< borders that begin below the row
    size_t n_active; ///< those of them that do not end below it
    border **active;
    double margin;  ///< faces as near as this to a border are evaluated one by one, m
    double widest;  ///< regions_extent() of any segment so far, m
    bool may_drop;  ///< there are places off every belt
    arc_faces arcs; ///< of the belts that are arcs
    uint8_t *marks; ///< of the faces of a row: nonzero, the face is near a border or an arc
    size_t n_due;
    scene_rect *due; ///< where faces are evaluated in this update
    double *v[2]; ///< velocities of x1- and x2-faces if none were closed; else those of the field
    uint16_t *under[2]; ///< FACE_POINTS belts of each face or NOT_KNOWN; *
    uint8_t *held[2];   ///< nonzero: arc_faces_is_held(); NULL without arcs
    bool is_made_again; ///< obstacles or belts may change; else what has a * is NULL
} sampler;

/// The places of one kind of faces: face (i, j) lies offset1 + i, offset2 + j cells from the corner.
typedef struct lattice {
    const bf_grid *grid;
    size_t n_columns;
    size_t n_rows;
    double offset1;
    double offset2;
} lattice;

static void add_border(sampler *k, vec2 a, vec2 b)
{
    k->borders[k->n_borders++] = a.y <= b.y ? (border){ a, b } : (border){ b, a };
}

/// The borders of a segment's bands, on both sides: which one is upstream depends on the belt.
static void add_band_borders(sampler *k, const regions_segment *g)
{
    const surroundings_piece *piece = &g->piece;
    vec2 left = vec2_turn_left(piece->along), start = piece->start;
    vec2 end = vec2_add(start, vec2_scale(piece->along, piece->length)), corner[2][2];
    const double *level = g->level;
    double extent = regions_extent(g);

    for (int side = 0; side < 2; side++) {
        double sign = side == 0 ? 1.0 : -1.0;
        for (int m = 0; m < 3; m++) {
            vec2 aside = vec2_scale(left, sign * level[m]);
            add_border(k, vec2_add(start, aside), vec2_add(end, aside));
        }
        corner[side][0] = vec2_add(start, vec2_scale(left, sign * extent));
        corner[side][1] = vec2_add(end, vec2_scale(left, sign * extent));
    }
    add_border(k, corner[0][0], corner[1][0]);
    add_border(k, corner[0][1], corner[1][1]);
}

static int compare_borders(const void *left, const void *right)
{
    const border *a = left, *b = right;
    return (a->low.y > b->low.y) - (a->low.y < b->low.y);
}

static void sampler_destroy(sampler *k)
{
    if (k == NULL)
        return;
    memory_free(k->segments);
    memory_free(k->standing);
    memory_free(k->near);
    memory_free(k->borders);
    memory_free(k->active);
    memory_free(k->marks);
    memory_free(k->due);
    for (int axis = 0; axis < 2; axis++) {
        memory_free(k->is_made_again ? k->v[axis] : NULL);
        memory_free(k->closed[axis]);
        memory_free(k->under[axis]);
        memory_free(k->held[axis]);
    }
    arc_faces_fini(&k->arcs);
    memory_free(k);
}

/// For a field that has its velocities. NULL: no memory.
static sampler *sampler_alloc(const scene *s, const velocity_field *f)
{
    sampler *k = memory_alloc(1, sizeof *k);
    size_t n_segments = 0, n_borders = 0;

    if (k == NULL)
        return NULL;
    for (size_t m = 0; m < s->n_obstacles; m++)
        n_segments += s->obstacles[m].n_points - 1;
    for (size_t m = 0; m < s->n_sections; m++)
        n_borders += s->belts[m].n_points;
    n_borders += BORDERS_PER_SEGMENT * n_segments;
    k->segments = memory_alloc(n_segments, sizeof *k->segments);
    k->near = memory_alloc(n_segments, sizeof *k->near);
    k->borders = memory_alloc(n_borders, sizeof *k->borders);
    k->active = memory_alloc(n_borders, sizeof(border *));
    k->marks = memory_alloc(f->grid.n1 + 1, sizeof *k->marks);
    k->due = memory_alloc(s->n_obstacles + s->n_sections + 1, sizeof *k->due);
    k->is_made_again =
        scene_has_moving_obstacles(s) || belt_range_may_reverse_any(s->n_sections, s->belts);
    bool is_whole = k->segments && k->near && k->borders && k->active && k->marks && k->due &&
                    arc_faces_init(&k->arcs, s, &f->grid) == BF_OK;
    if (k->is_made_again)
        k->standing = memory_alloc(n_segments, sizeof *k->standing);
    is_whole = is_whole && (!k->is_made_again || k->standing != NULL);
    for (int axis = 0; axis < 2 && is_whole; axis++) {
        const size_t n = grid_faces(&f->grid, axis);
        if (k->arcs.n > 0)
            k->held[axis] = memory_alloc(n, sizeof *k->held[axis]);
        is_whole = k->arcs.n == 0 || k->held[axis] != NULL;
        if (!k->is_made_again) {
            k->v[axis] = f->faces[axis].v;
            continue;
        }
        k->v[axis] = memory_alloc(n, sizeof *k->v[axis]);
        k->closed[axis] = memory_alloc(n, sizeof *k->closed[axis]);
        k->under[axis] = memory_alloc(FACE_POINTS * n, sizeof *k->under[axis]);
        is_whole = is_whole && k->v[axis] && k->closed[axis] && k->under[axis];
        for (size_t m = 0; is_whole && m < FACE_POINTS * n; m++)
            k->under[axis][m] = NOT_KNOWN;
    }
    if (is_whole)
        return k;
    sampler_destroy(k);
    return NULL;
}

/// is_all: obstacles that never move, too, may differ from those of the last time, as belts do.
static void sampler_prepare(sampler *k, const scene *s, bool is_all)
{
    const bf_grid grid = scene_grid(s);
    size_t n_standing = 0;

    k->around = surroundings_of(s);
    k->may_drop = s->may_drop;
    // Beside a belt's border a gap may be bridged, and faces have the velocity of a cell's centre.
    k->margin = MARGIN + (k->may_drop ? k->around.bridge + fmax(grid.d1, grid.d2) : 0.0);
    k->n_segments = k->n_borders = 0;
    for (size_t b = 0; b < s->n_sections; b++) {
        const scene_belt *belt = &s->belts[b];
        for (size_t m = 0, last = belt->n_points - 1; m < belt->n_points; last = m++)
            add_border(k, belt->polygon[last], belt->polygon[m]);
    }
    for (size_t o = 0; o < s->n_obstacles; o++) {
        for (size_t m = 0; m + 1 < s->obstacles[o].n_points; m++) {
            const bool stands = k->standing != NULL && !scene_obstacle_moves(&s->obstacles[o]);
            const regions_segment g = stands && !is_all
                                          ? k->standing[n_standing]
                                          : regions_segment_of(s, &k->around, &s->obstacles[o], m);
            if (stands)
                k->standing[n_standing++] = g;
            add_band_borders(k, &g);
            k->widest = fmax(k->widest, regions_extent(&g));
            k->segments[k->n_segments++] = g;
        }
    }
    qsort(k->borders, k->n_borders, sizeof *k->borders, compare_borders);
}

/// The faces of a row from x = low to x = high, m, and one more on either side.
static void find_columns(const lattice *l, double low, double high, size_t *ret_begin,
                         size_t *ret_end)
{
    const double first = floor((low - l->grid->lower1) / l->grid->d1 - l->offset1);
    const double last = ceil((high - l->grid->lower1) / l->grid->d1 - l->offset1);

    *ret_begin = grid_clamp(first, l->n_columns);
    *ret_end = grid_clamp(last + 1.0, l->n_columns);
}

/// Mark the faces of the row at y that are near a border or an arc. Rows come upwards.
static void mark_row(sampler *k, const lattice *l, double y)
{
    const double margin = k->margin;
    size_t begin, end;

    memset(k->marks, 0, l->n_columns);
    for (size_t m = 0; m < k->arcs.n; m++) {
        const scene_rect *box = &k->arcs.arcs[m].box;
        if (y < box->y_min - margin || y > box->y_max + margin)
            continue;
        find_columns(l, box->x_min - margin, box->x_max + margin, &begin, &end);
        memset(k->marks + begin, 1, end - begin);
    }
    for (; k->n_begun < k->n_borders && k->borders[k->n_begun].low.y <= y + margin; k->n_begun++)
        k->active[k->n_active++] = &k->borders[k->n_begun];
    for (size_t m = k->n_active; m-- > 0;) {
        const border *b = k->active[m];
        double low, high;
        if (b->high.y < y - margin) {
            k->active[m] = k->active[--k->n_active];
            continue;
        }
        if (!closed_lines_clip(b->low, b->high, y - margin, y + margin, &low, &high))
            continue;
        find_columns(l, low - margin, high + margin, &begin, &end);
        memset(k->marks + begin, 1, end - begin);
    }
}

/// Choose the segments whose bands may touch the row at y, in their order.
static void find_near(sampler *k, double y)
{
    k->n_near = 0;
    for (size_t m = 0; m < k->n_segments; m++) {
        const regions_segment *g = &k->segments[m];
        const surroundings_piece *piece = &g->piece;
        const double end = piece->start.y + piece->length * piece->along.y;
        const double extent = regions_extent(g) + k->margin;
        if (fmin(piece->start.y, end) - extent <= y && y <= fmax(piece->start.y, end) + extent)
            k->near[k->n_near++] = g;
    }
}

/// A face across a component.
typedef struct face {
    const bf_grid *grid;
    int component;
    vec2 at;         ///< its centre, m
    uint16_t *under; ///< see sampler
} face;

static vec2 point_of(const face *f, int point)
{
    const double half = 0.5 * (f->component == 0 ? f->grid->d1 : f->grid->d2);
    const double ways[FACE_POINTS] = { 0.0, -MARGIN, MARGIN, -half, half };

    return f->component == 0 ? (vec2){ f->at.x + ways[point], f->at.y }
                             : (vec2){ f->at.x, f->at.y + ways[point] };
}

static size_t belt_of(const sampler *k, const face *f, int point)
{
    if (f->under == NULL)
        return surroundings_belt_at(&k->around, point_of(f, point));
    if (f->under[point] == NOT_KNOWN)
        f->under[point] = (uint16_t)surroundings_belt_at(&k->around, point_of(f, point));
    return f->under[point];
}

static regions_velocity evaluate(const sampler *k, const face *f, int point)
{
    const vec2 at = point_of(f, point);
    regions_velocity e = regions_begin(&k->around, belt_of(k, f, point), at);

    for (size_t m = 0; m < k->n_near; m++)
        regions_consider(&e, k->near[m], at);
    return e;
}

static double component_of(const regions_velocity *e, int component)
{
    return component == 0 ? e->velocity.x : e->velocity.y;
}

/// v_stat at a face. A belt that moves along its own border lets pass what another belt brings over that border: on such a
/// face the other one counts.
static regions_velocity evaluate_face(const sampler *k, const face *f)
{
    const int component = f->component;
    regions_velocity e = evaluate(k, f, AT_FACE);

    if (e.region != REGIONS_FREE || component_of(&e, component) != 0.0)
        return e;
    regions_velocity before = evaluate(k, f, BEFORE_FACE), after = evaluate(k, f, BEHIND_FACE);
    bool is_border = before.region == REGIONS_FREE && after.region == REGIONS_FREE &&
                     before.belt_index != after.belt_index;
    bool comes = is_border && component_of(&before, component) > 0.0;
    bool returns = is_border && component_of(&after, component) < 0.0;
    return comes == returns ? e : comes ? before : after;
}

static bool is_off(const sampler *k, const regions_velocity *e)
{
    return surroundings_falls(&k->around, e->belt_index);
}

/// v_stat at a face; off every belt that of the cell beside it which moves over it.
static regions_velocity evaluate_any(const sampler *k, const face *f, bool has_belts)
{
    const regions_velocity e = has_belts ? evaluate_face(k, f) : evaluate(k, f, AT_FACE);

    if (!k->may_drop || !is_off(k, &e))
        return e;
    const regions_velocity before = evaluate(k, f, CELL_BEFORE),
                           after = evaluate(k, f, CELL_BEHIND);
    const bool comes = !is_off(k, &before) && component_of(&before, f->component) > 0.0;
    const bool returns = !is_off(k, &after) && component_of(&after, f->component) < 0.0;

    return comes == returns ? e : comes ? before : after;
}

/// The arc whose velocity a face has: where the face is off every belt, that of a cell beside it; n_belts: it has none.
static size_t arc_of(const sampler *k, const face *f, const regions_velocity *e)
{
    const surroundings *around = &k->around;
    size_t belt = e->region == REGIONS_FREE ? e->belt_index : around->n_belts;

    if (is_off(k, e))
        belt = belt_of(k, f, CELL_BEFORE);
    if (is_off(k, e) && belt == around->n_belts)
        belt = belt_of(k, f, CELL_BEHIND);
    return belt < around->n_belts && belt_has_lanes(&around->belts[belt]) ? belt : around->n_belts;
}

/// Fill a component of the velocity, if no face were closed, and what else there is on the faces first <= i < last of row j.
static void fill_columns(const velocity_field *f, const scene *s, const lattice *l, int component,
                         size_t j, size_t first, size_t last)
{
    const sampler *k = f->sampler;
    const velocity_field_faces *faces = &f->faces[component];
    const size_t base = j * l->n_columns;
    const double y = l->grid->lower2 + ((double)j + l->offset2) * l->grid->d2;

    for (size_t i = first; i < last;) {
        const face here = { l->grid,
                            component,
                            { l->grid->lower1 + ((double)i + l->offset1) * l->grid->d1, y },
                            k->under[component] == NULL
                                ? NULL
                                : k->under[component] + FACE_POINTS * (base + i) };
        const regions_velocity e = evaluate_any(k, &here, faces->belt != NULL);
        const size_t arc = k->arcs.n > 0 ? arc_of(k, &here, &e) : s->n_sections;
        const bool is_arc = arc < s->n_sections;
        const double v =
            is_arc ? arc_faces_velocity(&k->arcs, l->grid, k->around.belts, arc, component, i, j)
                   : component_of(&e, component);
        const uint8_t *next = k->marks[i] ? k->marks + i + 1 : memchr(k->marks + i, 1, last - i);
        const size_t end = next != NULL ? (size_t)(next - k->marks) : last;
        const uint8_t held = is_arc && arc_faces_is_held(f, s, &k->around, arc, component, i, j);
        for (size_t m = i; k->held[component] != NULL && m < end; m++)
            k->held[component][base + m] = held;
        for (size_t m = i; faces->belt != NULL && m < end; m++)
            faces->belt[base + m] = (uint16_t)(is_arc ? arc : e.belt_index);
        for (size_t m = i; faces->transverse != NULL && m < end; m++)
            faces->transverse[base + m] = component == 0 ? e.velocity.y : e.velocity.x;
        const double loose = e.region == REGIONS_SLIDE ? component == 0 ? e.belt.x : e.belt.y : v;
        for (size_t m = i; faces->loose != NULL && m < end; m++)
            faces->loose[base + m] = loose;
        for (; i < end; i++)
            k->v[component][base + i] = v;
    }
}

/// Fill what there is on the faces across a component that are due.
static void fill_faces(velocity_field *f, const scene *s, int component)
{
    const bf_grid *g = &f->grid;
    const lattice l = component == 0 ? (lattice){ g, g->n1 + 1, g->n2, 0.0, 0.5 }
                                     : (lattice){ g, g->n1, g->n2 + 1, 0.5, 0.0 };
    sampler *k = f->sampler;

    k->n_begun = k->n_active = 0;
    for (size_t j = 0; j < l.n_rows; j++) {
        const double y = g->lower2 + ((double)j + l.offset2) * g->d2;
        bool is_ready = false;
        for (size_t d = 0; d < k->n_due; d++) {
            const scene_rect *due = &k->due[d];
            size_t first, last;
            if (y < due->y_min || y > due->y_max)
                continue;
            if (!is_ready) {
                find_near(k, y);
                mark_row(k, &l, y);
            }
            is_ready = true;
            find_columns(&l, due->x_min, due->x_max, &first, &last);
            fill_columns(f, s, &l, component, j, first, last);
        }
    }
}

static bool is_off_at(const surroundings *around, vec2 at)
{
    return surroundings_falls(around, surroundings_belt_at(around, at));
}

/// True if cargo comes at any time over a gap that lies between the centres of a cell and of the one before it on its way.
static bool is_behind_gap(const surroundings *around, vec2 centre, vec2 to_face)
{
    const vec2 before = vec2_add(centre, vec2_scale(to_face, 2.0));
    const size_t belt = surroundings_belt_at(around, before);
    const double goes = vec2_dot(surroundings_velocity_at(around, belt, before), to_face);
    const bool reverses = belt < around->n_belts && belt_range_may_reverse(&around->belts[belt]);

    return (goes < 0.0 || (goes > 0.0 && reverses)) && is_off_at(around, vec2_add(centre, to_face));
}

/// Find the cells that carry nothing.
static bf_status find_off(const scene *s, velocity_field *f)
{
    const surroundings around = surroundings_of(s);
    const bf_grid *g = &f->grid;
    const vec2 to_faces[4] = {
        { 0.5 * g->d1, 0.0 }, { -0.5 * g->d1, 0.0 }, { 0.0, 0.5 * g->d2 }, { 0.0, -0.5 * g->d2 }
    };

    if (!s->may_drop)
        return BF_OK;
    f->off = memory_alloc(grid_cells(g), sizeof *f->off);
    for (size_t c = 0; f->off != NULL && c < grid_cells(g); c++) {
        const vec2 centre = { grid_x1(g, c % g->n1), grid_x2(g, c / g->n1) };
        bool is_off = is_off_at(&around, centre);
        for (int m = 0; m < 4; m++)
            is_off = is_off || is_behind_gap(&around, centre, to_faces[m]);
        f->off[c] = is_off;
    }
    return f->off != NULL ? BF_OK : BF_ENOMEM;
}

/// Close the faces whose links run along one axis and cross the line. swap: the links run along x2,
/// and all coordinates are taken in the order x2, x1.
static void close_links(velocity_field *f, const closed_line *l, bool swap)
{
    const bf_grid *g = &f->grid;
    vec2 a = swap ? (vec2){ l->start.y, l->start.x } : l->start;
    vec2 b = swap ? (vec2){ l->end.y, l->end.x } : l->end;
    closed_line turned = { a, b };
    double d_along = swap ? g->d2 : g->d1, d_across = swap ? g->d1 : g->d2;
    double lower_along = swap ? g->lower2 : g->lower1, lower_across = swap ? g->lower1 : g->lower2;
    size_t n_along = swap ? g->n2 : g->n1, n_across = swap ? g->n1 : g->n2;
    double first = floor((fmin(a.y, b.y) - MARGIN - lower_across) / d_across - 0.5);
    double last = ceil((fmax(a.y, b.y) + MARGIN - lower_across) / d_across - 0.5);

    for (size_t m = grid_clamp(first, n_across); m < grid_clamp(last + 1.0, n_across); m++) {
        double c = lower_across + ((double)m + 0.5) * d_across, low, high;
        if (!closed_lines_clip(a, b, c - MARGIN, c + MARGIN, &low, &high))
            continue;
        low = floor((low - MARGIN - lower_along) / d_along - 0.5);
        high = ceil((high + MARGIN - lower_along) / d_along + 0.5);
        for (size_t k = grid_clamp(low, n_along + 1); k < grid_clamp(high + 1.0, n_along + 1);
             k++) {
            vec2 from = { lower_along + ((double)k - 0.5) * d_along, c };
            vec2 to = { lower_along + ((double)k + 0.5) * d_along, c };
            if (!closed_line_crosses(&turned, from, to))
                continue;
            if (swap)
                f->faces[1].closed[k * g->n1 + m] = 1;
            else
                f->faces[0].closed[m * (g->n1 + 1) + k] = 1;
        }
    }
}

static bool close_line(void *context, const closed_line *l)
{
    close_links(context, l, false);
    close_links(context, l, true);
    return false;
}

static bool is_side_closed(const scene *s, scene_side side)
{
    return s->edges[side] == SCENE_EDGE_WALL || scene_is_fed(s, side);
}

static void close_edges(const scene *s, velocity_field *f)
{
    const size_t n1 = f->grid.n1, n2 = f->grid.n2;
    uint8_t *closed1 = f->faces[0].closed, *closed2 = f->faces[1].closed;

    for (size_t j = 0; j < n2; j++) {
        closed1[j * (n1 + 1)] |= is_side_closed(s, SCENE_WEST);
        closed1[j * (n1 + 1) + n1] |= is_side_closed(s, SCENE_EAST);
    }
    for (size_t i = 0; i < n1; i++) {
        closed2[i] |= is_side_closed(s, SCENE_SOUTH);
        closed2[n2 * n1 + i] |= is_side_closed(s, SCENE_NORTH);
    }
}

static void close_lines(velocity_field *f, const scene *s, bool of_moving)
{
    const surroundings *around = &f->sampler->around;

    for (size_t o = 0; o < s->n_obstacles; o++)
        if (scene_obstacle_moves(&s->obstacles[o]) == of_moving &&
            closed_lines_has(s, &s->obstacles[o]))
            (void)closed_lines_visit_one(around, &s->obstacles[o], close_line, f);
}

/// Close the faces that lines and edges close.
static void close_faces(velocity_field *f, const scene *s, bool is_all)
{
    sampler *k = f->sampler;

    if (is_all) {
        for (int axis = 0; axis < 2; axis++)
            memset(f->faces[axis].closed, 0, grid_faces(&f->grid, axis));
        close_lines(f, s, false);
        close_edges(s, f);
    }
    for (int axis = 0; axis < 2; axis++) {
        const size_t n = grid_faces(&f->grid, axis);
        if (!is_all)
            memcpy(f->faces[axis].closed, k->closed[axis], n);
        else if (k->is_made_again)
            memcpy(k->closed[axis], f->faces[axis].closed, n);
    }
    close_lines(f, s, true);
}

/// Close the faces beside cells off every belt over which no belt moves: dispersion is no force that could push cargo
/// off a belt over its side.
static void close_off_sides(velocity_field *f)
{
    const size_t n1 = f->grid.n1, n2 = f->grid.n2;
    double *const *v = f->sampler->v;

    for (size_t j = 0; j < n2; j++)
        for (size_t i = 1; i < n1; i++)
            if (f->off[j * n1 + i - 1] != f->off[j * n1 + i] && v[0][j * (n1 + 1) + i] == 0.0)
                f->faces[0].closed[j * (n1 + 1) + i] = 1;
    for (size_t j = 1; j < n2; j++)
        for (size_t i = 0; i < n1; i++)
            if (f->off[(j - 1) * n1 + i] != f->off[j * n1 + i] && v[1][j * n1 + i] == 0.0)
                f->faces[1].closed[j * n1 + i] = 1;
}

/// A field of the scene's grid, all zero. NULL: no memory.
static velocity_field *field_alloc(const scene *s)
{
    const bool is_congested = s->macro.closure == SCENE_CONGESTED;
    velocity_field *f = memory_alloc(1, sizeof *f);
    bool is_whole = true;

    if (f == NULL)
        return NULL;
    f->grid = scene_grid(s);
    for (int axis = 0; axis < 2; axis++) {
        velocity_field_faces *faces = &f->faces[axis];
        faces->v = memory_alloc(grid_faces(&f->grid, axis), sizeof *faces->v);
        faces->closed = memory_alloc(grid_faces(&f->grid, axis), sizeof *faces->closed);
        is_whole = is_whole && faces->v && faces->closed;
    }
    f->sampler = is_whole ? sampler_alloc(s, f) : NULL;
    is_whole = f->sampler != NULL;
    const bool has_belts = is_whole && (is_congested || f->sampler->arcs.n > 0 ||
                                        !belt_range_is_constant(s->n_sections, s->belts));
    for (int axis = 0; axis < 2 && is_whole; axis++) {
        velocity_field_faces *faces = &f->faces[axis];
        const size_t n = grid_faces(&f->grid, axis);
        if (has_belts)
            faces->belt = memory_alloc(n, sizeof *faces->belt);
        is_whole = !has_belts || faces->belt != NULL;
        if (!is_congested)
            continue;
        faces->aperture = memory_alloc(n, sizeof *faces->aperture);
        faces->transverse = memory_alloc(n, sizeof *faces->transverse);
        faces->loose = memory_alloc(n, sizeof *faces->loose);
        is_whole = is_whole && faces->aperture && faces->transverse && faces->loose;
    }
    return is_whole ? f : velocity_field_destroy(f);
}

/// Find where faces are evaluated: all, or those within reach of the changed obstacles.
static void find_due(velocity_field *f, const scene *s, size_t n, const scene_rect *changed)
{
    static const scene_rect all = { -INFINITY, INFINITY, -INFINITY, INFINITY };
    sampler *k = f->sampler;
    const double edge = fmax(f->grid.d1, f->grid.d2);
    const double reach = fmax(k->widest, edge) + 2.0 * edge + k->margin;

    k->n_due = 0;
    for (size_t m = 0; changed != NULL && m < n; m++)
        k->due[k->n_due++] = (scene_rect){ changed[m].x_min - reach, changed[m].x_max + reach,
                                           changed[m].y_min - reach, changed[m].y_max + reach };
    if (changed == NULL)
        k->due[k->n_due++] = all;
    k->n_due += arc_faces_update(&k->arcs, f, s, &k->around, k->n_due, k->due, k->due + k->n_due);
}

void velocity_field_update(velocity_field *f, const scene *s, size_t n, const scene_rect *changed)
{
    const bool is_congested = s->macro.closure == SCENE_CONGESTED;
    sampler *k = f->sampler;

    sampler_prepare(k, s, changed == NULL);
    close_faces(f, s, changed == NULL);
    find_due(f, s, n, changed);
    for (int axis = 0; axis < 2; axis++) {
        const velocity_field_faces *faces = &f->faces[axis];
        const size_t n_faces = grid_faces(&f->grid, axis);
        fill_faces(f, s, axis);
        for (size_t m = 0; k->held[axis] != NULL && m < n_faces; m++)
            faces->closed[m] |= k->held[axis][m];
        for (size_t m = 0; is_congested && m < n_faces; m++)
            faces->aperture[m] = 1.0;
    }
    if (is_congested)
        aperture_apply(s, f);
    else if (f->off != NULL)
        close_off_sides(f);
    for (int axis = 0; axis < 2; axis++) {
        const velocity_field_faces *faces = &f->faces[axis];
        for (size_t m = 0; m < grid_faces(&f->grid, axis); m++)
            faces->v[m] = faces->closed[m] ? 0.0 : k->v[axis][m];
    }
}

bf_status velocity_field_create(const scene *s, velocity_field **ret_field, bf_error *err)
{
    velocity_field *f = field_alloc(s);

    if (f == NULL || find_off(s, f) != BF_OK) {
        velocity_field_destroy(f);
        return bf_fail(err, BF_ENOMEM, "/macro/cell_m", "no memory for the velocity field");
    }
    velocity_field_update(f, s, 0, NULL);
    *ret_field = f;
    return BF_OK;
}

velocity_field *velocity_field_destroy(velocity_field *f)
{
    if (f == NULL)
        return NULL;
    for (int axis = 0; axis < 2; axis++) {
        memory_free(f->faces[axis].v);
        memory_free(f->faces[axis].closed);
        memory_free(f->faces[axis].belt);
        memory_free(f->faces[axis].aperture);
        memory_free(f->faces[axis].transverse);
        memory_free(f->faces[axis].loose);
    }
    memory_free(f->off);
    sampler_destroy(f->sampler);
    memory_free(f);
    return NULL;
}
