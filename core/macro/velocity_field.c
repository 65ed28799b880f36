// v_stat and the closed faces: first the rules, point by point, then the same on all faces of a grid.
//
// On a grid the velocity is constant between the borders of belts and bands. Row by row, the rules are
// evaluated at each face next to a border and, of every run of faces between borders, at one; the rest
// are copies of it. So the cost is little more than that of writing the result.
//
// Closed lines have no gaps: a link between cell centres is closed if it touches the line, so that no
// path along links leads across a line that ends at walls or is closed. But where a cell centre lies on
// the line itself all its links touch it, and the cell would be cut off. Therefore the links are tested against the
// line moved downstream by the tolerance, as one piece with its corners: cell centres on the line lie
// upstream of it, as in the rules of the regions, and the moved line has no gaps either.

#include "core/macro/velocity_field.h"

#include "core/base/memory.h"
#include "core/base/polygon.h"
#include "core/macro/aperture.h"
#include "core/scene/belt_speeds.h"
#include "core/scene/surroundings.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// Nearer than this a link touches a line, m: well above rounding, well below the move.
#define TOUCH (0.1 * SCENE_TOLERANCE)

/// Faces as near as this to a border are evaluated one by one, m: more than the rules' tolerances.
#define MARGIN (4.0 * SCENE_TOLERANCE)

enum { BORDERS_PER_SEGMENT = 8 };

/// Width of the slide zone of the congested closure in radii of parts; fitted to the microscopic model.
static const double congested_slide = 6.0;

/// A straight piece of an obstacle.
typedef struct segment {
    surroundings_piece piece; ///< see there
    double level[3]; ///< borders of the regions by their distance d upstream of the line: B from
                     ///< level[0] to [1], C from there to [2], m
} segment;

/// The regions of section 3.1; the larger value takes precedence.
typedef enum region {
    REGION_FREE,   ///< A: the belt's velocity
    REGION_SLIDE,  ///< C: along the obstacle
    REGION_OUTWARD ///< B: away from it
} region;

/// v_stat at a point for the obstacles considered so far.
typedef struct evaluation {
    region region;     ///< of these obstacles
    size_t belt_index; ///< of the belt under the point, n_belts off every belt
    vec2 belt;         ///< v_T under the point, m/s
    vec2 velocity;     ///< v_stat, m/s
} evaluation;

/// A closed line as links between cell centres are tested against it.
typedef struct line {
    vec2 start; ///< m
    vec2 end;   ///< m
} line;

static bool is_congested(const scene *s)
{
    return s->macro.closure == SCENE_CONGESTED;
}

static segment segment_of(const scene *s, const surroundings *around,
                          const scene_obstacle *obstacle, size_t k)
{
    segment g = { .piece = surroundings_piece_of(around, obstacle, k) };
    const bool is_sealed = obstacle->treatment == SCENE_SEALED;

    if (is_congested(s)) {
        g.level[2] = congested_slide * aperture_radius(s);
        return g;
    }
    g.level[0] = obstacle->treatment == SCENE_FIELD ? -obstacle->thickness : 0.0;
    g.level[1] = is_sealed ? obstacle->band : 0.0;
    g.level[2] = g.level[1] + obstacle->slide_width;
    return g;
}

static region find_region(const segment *g, vec2 upstream, vec2 at)
{
    vec2 to = vec2_sub(at, g->piece.start);
    double a = vec2_dot(to, g->piece.along), d = vec2_dot(to, upstream);

    if (a < -SCENE_TOLERANCE || a > g->piece.length + SCENE_TOLERANCE)
        return REGION_FREE;
    if (d < g->level[0] - SCENE_TOLERANCE || d > g->level[2] + SCENE_TOLERANCE)
        return REGION_FREE;
    return d < g->level[1] - SCENE_TOLERANCE ? REGION_OUTWARD : REGION_SLIDE;
}

static evaluation begin(const surroundings *around, vec2 at)
{
    evaluation e = { .region = REGION_FREE };

    e.belt_index = surroundings_belt_at(around, at);
    e.belt = surroundings_velocity_of(around, e.belt_index);
    e.velocity = e.belt;
    return e;
}

/// Consider one more segment; earlier ones take precedence within a region. Its upstream side follows from the
/// belt under the point.
static void consider(evaluation *e, const segment *g, vec2 at)
{
    vec2 along = g->piece.along, upstream = surroundings_upstream(along, e->belt);
    region found = find_region(g, upstream, at);

    if (found <= e->region)
        return;
    e->region = found;
    e->velocity = found == REGION_OUTWARD ? vec2_scale(upstream, vec2_length(e->belt))
                                          : vec2_scale(along, vec2_dot(e->belt, along));
}

vec2 velocity_field_at(const scene *s, vec2 at)
{
    const surroundings around = surroundings_of(s);
    evaluation e = begin(&around, at);

    for (size_t k = 0; k < s->n_obstacles; k++) {
        for (size_t m = 0; m + 1 < s->obstacles[k].n_points; m++) {
            segment g = segment_of(s, &around, &s->obstacles[k], m);
            consider(&e, &g, at);
        }
    }
    return e.velocity;
}

static bool is_closing(const scene *s, const scene_obstacle *obstacle)
{
    return is_congested(s) || obstacle->treatment != SCENE_FIELD;
}

/// How far the line is moved for the links.
static vec2 shift_of(const surroundings *around, const scene_obstacle *obstacle)
{
    vec2 sum = { 0.0, 0.0 }, first = { 0.0, 0.0 };
    double length = 0.0;

    for (size_t k = 0; k + 1 < obstacle->n_points; k++) {
        surroundings_piece piece = surroundings_piece_of(around, obstacle, k);
        first = k == 0 ? piece.upstream : first;
        sum = vec2_add(sum, vec2_scale(piece.upstream, piece.length));
        length += piece.length;
    }
    double size = vec2_length(sum);
    // Pieces with normals in all directions, like those of a closed path, have no common upstream side.
    vec2 upstream = size > 1e-6 * length ? vec2_scale(sum, 1.0 / size) : first;
    return vec2_scale(upstream, -SCENE_TOLERANCE);
}

/// The line of a piece for the links, moved by shift and longer by the tolerance at both ends.
static line line_of(const surroundings_piece *piece, vec2 shift)
{
    vec2 start = vec2_add(piece->start, shift);
    vec2 before = vec2_scale(piece->along, -SCENE_TOLERANCE);
    vec2 to = vec2_scale(piece->along, piece->length + SCENE_TOLERANCE);

    return (line){ vec2_add(start, before), vec2_add(start, to) };
}

static bool crosses(const line *l, vec2 from, vec2 to)
{
    return polygon_segments_touch(from, to, l->start, l->end, TOUCH);
}

/// What is done with a closing line; true ends the visit.
typedef bool line_fn(void *context, const line *l);

/// Visit the lines of all obstacles that close faces. True if a visit was ended.
static bool visit_lines(const scene *s, line_fn *visit, void *context)
{
    const surroundings around = surroundings_of(s);

    for (size_t k = 0; k < s->n_obstacles; k++) {
        const scene_obstacle *obstacle = &s->obstacles[k];
        if (!is_closing(s, obstacle))
            continue;
        vec2 shift = shift_of(&around, obstacle);
        for (size_t m = 0; m + 1 < obstacle->n_points; m++) {
            surroundings_piece piece = surroundings_piece_of(&around, obstacle, m);
            line l = line_of(&piece, shift);
            if (visit(context, &l))
                return true;
        }
    }
    return false;
}

static bool crosses_link(void *context, const line *l)
{
    const line *link = context;

    return crosses(l, link->start, link->end);
}

bool velocity_field_is_closed(const scene *s, vec2 from, vec2 to)
{
    line link = { from, to };

    return visit_lines(s, crosses_link, &link);
}

/// A straight border between constant velocities.
typedef struct border {
    vec2 low;  ///< the end with the smaller y, m
    vec2 high; ///< the other end, m
} border;

/// What the rows are filled from.
typedef struct sampler {
    const scene *s;
    surroundings around;
    size_t n_segments;
    segment *segments;
    size_t n_near; ///< segments whose bands may touch the row
    const segment **near;
    size_t n_borders;
    border *borders; ///< sorted by low.y
    size_t n_begun;  ///< borders that begin below the row
    size_t n_active; ///< those of them that do not end below it
    border **active;
    uint8_t *marks; ///< of the faces of a row: nonzero, the face is near a border
} sampler;

/// The places of one kind of faces: face (i, j) lies offset1 + i, offset2 + j cells from the corner.
typedef struct lattice {
    const bf_grid *grid;
    size_t n_columns;
    size_t n_rows;
    double offset1;
    double offset2;
} lattice;

static double face_x(const lattice *l, size_t i)
{
    return l->grid->lower1 + ((double)i + l->offset1) * l->grid->d1;
}

static double face_y(const lattice *l, size_t j)
{
    return l->grid->lower2 + ((double)j + l->offset2) * l->grid->d2;
}

/// A real index as one of 0 .. n.
static size_t clamp_index(double index, size_t n)
{
    return (size_t)fmin(fmax(index, 0.0), (double)n);
}

/// The part of a segment whose second coordinate lies in [low, high], as a range of its first one.
/// False if there is none.
static bool clip(vec2 a, vec2 b, double low, double high, double *ret_low, double *ret_high)
{
    double from = 0.0, to = 1.0;

    if (fmax(a.y, b.y) < low || fmin(a.y, b.y) > high)
        return false;
    if (a.y != b.y) {
        double at_low = (low - a.y) / (b.y - a.y), at_high = (high - a.y) / (b.y - a.y);
        from = fmin(fmax(fmin(at_low, at_high), 0.0), 1.0);
        to = fmax(fmin(fmax(at_low, at_high), 1.0), 0.0);
    }
    double x_from = a.x + from * (b.x - a.x), x_to = a.x + to * (b.x - a.x);
    *ret_low = fmin(x_from, x_to);
    *ret_high = fmax(x_from, x_to);
    return true;
}

static void add_border(sampler *k, vec2 a, vec2 b)
{
    k->borders[k->n_borders++] = a.y <= b.y ? (border){ a, b } : (border){ b, a };
}

/// The borders of a segment's bands, on both sides: which one is upstream depends on the belt.
static void add_band_borders(sampler *k, const segment *g)
{
    const surroundings_piece *piece = &g->piece;
    vec2 left = vec2_turn_left(piece->along), start = piece->start;
    vec2 end = vec2_add(start, vec2_scale(piece->along, piece->length)), corner[2][2];
    const double *level = g->level;
    double extent = fmax(fabs(level[0]), level[2]);

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

static void sampler_fini(sampler *k)
{
    memory_free(k->segments);
    memory_free(k->near);
    memory_free(k->borders);
    memory_free(k->active);
    memory_free(k->marks);
}

/// Room for all segments and borders of a scene. Returns 0, or -1 for no memory.
static int sampler_reserve(sampler *k, const scene *s)
{
    size_t n_segments = 0, n_borders = 0;

    for (size_t m = 0; m < s->n_obstacles; m++)
        n_segments += s->obstacles[m].n_points - 1;
    for (size_t m = 0; m < s->n_belts; m++)
        n_borders += s->belts[m].n_points;
    n_borders += BORDERS_PER_SEGMENT * n_segments;
    *k = (sampler){ .s = s, .around = surroundings_of(s) };
    k->segments = memory_alloc(n_segments, sizeof *k->segments);
    k->near = memory_alloc(n_segments, sizeof *k->near);
    k->borders = memory_alloc(n_borders, sizeof *k->borders);
    k->active = memory_alloc(n_borders, sizeof(border *));
    k->marks = memory_alloc(scene_grid(s).n1 + 1, sizeof *k->marks);
    return k->segments && k->near && k->borders && k->active && k->marks ? 0 : -1;
}

static void sampler_prepare(sampler *k)
{
    for (size_t b = 0; b < k->s->n_belts; b++) {
        const scene_belt *belt = &k->s->belts[b];
        for (size_t m = 0, last = belt->n_points - 1; m < belt->n_points; last = m++)
            add_border(k, belt->polygon[last], belt->polygon[m]);
    }
    for (size_t o = 0; o < k->s->n_obstacles; o++) {
        for (size_t m = 0; m + 1 < k->s->obstacles[o].n_points; m++) {
            k->segments[k->n_segments] = segment_of(k->s, &k->around, &k->s->obstacles[o], m);
            add_band_borders(k, &k->segments[k->n_segments++]);
        }
    }
    qsort(k->borders, k->n_borders, sizeof *k->borders, compare_borders);
}

/// Choose the segments whose bands may touch the row at y, in their order.
static void choose_near(sampler *k, double y)
{
    k->n_near = 0;
    for (size_t m = 0; m < k->n_segments; m++) {
        const segment *g = &k->segments[m];
        const surroundings_piece *piece = &g->piece;
        double end = piece->start.y + piece->length * piece->along.y;
        double extent = fmax(fabs(g->level[0]), g->level[2]) + MARGIN;
        if (fmin(piece->start.y, end) - extent <= y && y <= fmax(piece->start.y, end) + extent)
            k->near[k->n_near++] = g;
    }
}

/// Mark the faces of the row at y that are near a border. Rows come upwards.
static void mark_row(sampler *k, const lattice *l, double y)
{
    memset(k->marks, 0, l->n_columns);
    for (; k->n_begun < k->n_borders && k->borders[k->n_begun].low.y <= y + MARGIN; k->n_begun++)
        k->active[k->n_active++] = &k->borders[k->n_begun];
    for (size_t m = k->n_active; m-- > 0;) {
        const border *b = k->active[m];
        double low, high;
        if (b->high.y < y - MARGIN) {
            k->active[m] = k->active[--k->n_active];
            continue;
        }
        if (!clip(b->low, b->high, y - MARGIN, y + MARGIN, &low, &high))
            continue;
        low = floor((low - MARGIN - l->grid->lower1) / l->grid->d1 - l->offset1);
        high = ceil((high + MARGIN - l->grid->lower1) / l->grid->d1 - l->offset1);
        size_t begin = clamp_index(low, l->n_columns), end = clamp_index(high + 1.0, l->n_columns);
        memset(k->marks + begin, 1, end - begin);
    }
}

static evaluation evaluate(const sampler *k, vec2 at)
{
    evaluation e = begin(&k->around, at);

    for (size_t m = 0; m < k->n_near; m++)
        consider(&e, k->near[m], at);
    return e;
}

static double component_of(const evaluation *e, int component)
{
    return component == 0 ? e->velocity.x : e->velocity.y;
}

/// v_stat at a face across a component. A belt that moves along its own border lets pass what another belt
/// brings over that border: on such a face the other one counts.
static evaluation evaluate_face(const sampler *k, vec2 at, int component)
{
    const double step = MARGIN;
    const vec2 across = component == 0 ? (vec2){ step, 0.0 } : (vec2){ 0.0, step };
    evaluation e = evaluate(k, at);

    if (e.region != REGION_FREE || component_of(&e, component) != 0.0)
        return e;
    evaluation before = evaluate(k, vec2_sub(at, across)),
               after = evaluate(k, vec2_add(at, across));
    bool is_border = before.region == REGION_FREE && after.region == REGION_FREE &&
                     before.belt_index != after.belt_index;
    bool comes = is_border && component_of(&before, component) > 0.0;
    bool returns = is_border && component_of(&after, component) < 0.0;
    return comes == returns ? e : comes ? before : after;
}

/// Fill a component of the velocity on all faces of a lattice and, unless NULL, the belts and the other component.
static void fill_faces(sampler *k, const lattice *l, int component, double *ret_v,
                       uint16_t *ret_belt, double *ret_transverse)
{
    k->n_begun = k->n_active = 0;
    for (size_t j = 0; j < l->n_rows; j++) {
        const size_t base = j * l->n_columns;
        double y = face_y(l, j);
        choose_near(k, y);
        mark_row(k, l, y);
        for (size_t i = 0; i < l->n_columns;) {
            const vec2 at = { face_x(l, i), y };
            evaluation e = ret_belt != NULL ? evaluate_face(k, at, component) : evaluate(k, at);
            const uint8_t *next =
                k->marks[i] ? k->marks + i + 1 : memchr(k->marks + i, 1, l->n_columns - i);
            size_t end = next != NULL ? (size_t)(next - k->marks) : l->n_columns;
            for (size_t m = i; ret_belt != NULL && m < end; m++)
                ret_belt[base + m] = (uint16_t)e.belt_index;
            for (size_t m = i; ret_transverse != NULL && m < end; m++)
                ret_transverse[base + m] = component == 0 ? e.velocity.y : e.velocity.x;
            for (; i < end; i++)
                ret_v[base + i] = component_of(&e, component);
        }
    }
}

/// Close the faces whose links run along one axis and cross the line. swap: the links run along x2,
/// and all coordinates are taken in the order x2, x1.
static void close_links(velocity_field *f, const line *l, bool swap)
{
    const bf_grid *g = &f->grid;
    vec2 a = swap ? (vec2){ l->start.y, l->start.x } : l->start;
    vec2 b = swap ? (vec2){ l->end.y, l->end.x } : l->end;
    line turned = { a, b };
    double d_along = swap ? g->d2 : g->d1, d_across = swap ? g->d1 : g->d2;
    double lower_along = swap ? g->lower2 : g->lower1, lower_across = swap ? g->lower1 : g->lower2;
    size_t n_along = swap ? g->n2 : g->n1, n_across = swap ? g->n1 : g->n2;
    double first = floor((fmin(a.y, b.y) - MARGIN - lower_across) / d_across - 0.5);
    double last = ceil((fmax(a.y, b.y) + MARGIN - lower_across) / d_across - 0.5);

    for (size_t m = clamp_index(first, n_across); m < clamp_index(last + 1.0, n_across); m++) {
        double c = lower_across + ((double)m + 0.5) * d_across, low, high;
        if (!clip(a, b, c - MARGIN, c + MARGIN, &low, &high))
            continue;
        low = floor((low - MARGIN - lower_along) / d_along - 0.5);
        high = ceil((high + MARGIN - lower_along) / d_along + 0.5);
        for (size_t k = clamp_index(low, n_along + 1); k < clamp_index(high + 1.0, n_along + 1);
             k++) {
            vec2 from = { lower_along + ((double)k - 0.5) * d_along, c };
            vec2 to = { lower_along + ((double)k + 0.5) * d_along, c };
            if (!crosses(&turned, from, to))
                continue;
            if (swap)
                f->closed2[k * g->n1 + m] = 1;
            else
                f->closed1[m * (g->n1 + 1) + k] = 1;
        }
    }
}

static bool close_line(void *context, const line *l)
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
    size_t n1 = f->grid.n1, n2 = f->grid.n2;

    for (size_t j = 0; j < n2; j++) {
        f->closed1[j * (n1 + 1)] |= is_side_closed(s, SCENE_WEST);
        f->closed1[j * (n1 + 1) + n1] |= is_side_closed(s, SCENE_EAST);
    }
    for (size_t i = 0; i < n1; i++) {
        f->closed2[i] |= is_side_closed(s, SCENE_SOUTH);
        f->closed2[n2 * n1 + i] |= is_side_closed(s, SCENE_NORTH);
    }
}

static void stop_at_closed(double *v, const uint8_t *closed, size_t n)
{
    for (size_t k = 0; k < n; k++)
        v[k] = closed[k] ? 0.0 : v[k];
}

static double *ones(size_t n)
{
    double *x = memory_alloc(n, sizeof *x);

    for (size_t k = 0; x != NULL && k < n; k++)
        x[k] = 1.0;
    return x;
}

/// A field of the scene's grid, all zero. NULL: no memory.
static velocity_field *field_alloc(const scene *s)
{
    velocity_field *f = memory_alloc(1, sizeof *f);

    if (f == NULL)
        return NULL;
    f->grid = scene_grid(s);
    size_t n_faces1 = (f->grid.n1 + 1) * f->grid.n2, n_faces2 = f->grid.n1 * (f->grid.n2 + 1);
    f->v1 = memory_alloc(n_faces1, sizeof *f->v1);
    f->v2 = memory_alloc(n_faces2, sizeof *f->v2);
    f->closed1 = memory_alloc(n_faces1, sizeof *f->closed1);
    f->closed2 = memory_alloc(n_faces2, sizeof *f->closed2);
    bool is_whole = f->v1 && f->v2 && f->closed1 && f->closed2;
    if (is_whole && (is_congested(s) || !belt_speeds_are_constant(s->n_belts, s->belts))) {
        f->belt1 = memory_alloc(n_faces1, sizeof *f->belt1);
        f->belt2 = memory_alloc(n_faces2, sizeof *f->belt2);
        is_whole = f->belt1 && f->belt2;
    }
    if (is_whole && is_congested(s)) {
        f->aperture1 = ones(n_faces1);
        f->aperture2 = ones(n_faces2);
        f->transverse1 = memory_alloc(n_faces1, sizeof *f->transverse1);
        f->transverse2 = memory_alloc(n_faces2, sizeof *f->transverse2);
        is_whole = f->aperture1 && f->aperture2 && f->transverse1 && f->transverse2;
    }
    return is_whole ? f : velocity_field_destroy(f);
}

bf_status velocity_field_create(const scene *s, velocity_field **ret_field, bf_error *err)
{
    sampler k = { 0 };
    velocity_field *f = field_alloc(s);

    if (f == NULL || sampler_reserve(&k, s) != 0) {
        sampler_fini(&k);
        velocity_field_destroy(f);
        return bf_fail(err, BF_ENOMEM, "/macro/cell_m", "no memory for the velocity field");
    }
    size_t n1 = f->grid.n1, n2 = f->grid.n2;
    sampler_prepare(&k);
    fill_faces(&k, &(lattice){ &f->grid, n1 + 1, n2, 0.0, 0.5 }, 0, f->v1, f->belt1,
               f->transverse1);
    fill_faces(&k, &(lattice){ &f->grid, n1, n2 + 1, 0.5, 0.0 }, 1, f->v2, f->belt2,
               f->transverse2);
    (void)visit_lines(s, close_line, f);
    close_edges(s, f);
    if (is_congested(s))
        aperture_apply(s, f);
    stop_at_closed(f->v1, f->closed1, (n1 + 1) * n2);
    stop_at_closed(f->v2, f->closed2, n1 * (n2 + 1));
    sampler_fini(&k);
    *ret_field = f;
    return BF_OK;
}

velocity_field *velocity_field_destroy(velocity_field *f)
{
    if (f == NULL)
        return NULL;
    memory_free(f->v1);
    memory_free(f->v2);
    memory_free(f->closed1);
    memory_free(f->closed2);
    memory_free(f->belt1);
    memory_free(f->belt2);
    memory_free(f->aperture1);
    memory_free(f->aperture2);
    memory_free(f->transverse1);
    memory_free(f->transverse2);
    memory_free(f);
    return NULL;
}
