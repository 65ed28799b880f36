// The velocity is constant between the borders of belts and bands. Row by row, the faces next to a
// border are asked one by one; of every run of faces between them one is asked, and the rest copied.
// So the rules in field_rule.c are the only ones, at the cost of little more than writing the result.

#include "core/scene/velocity_field.h"

#include "core/base/memory.h"
#include "core/base/vec2.h"
#include "core/scene/velocity_field_priv.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// Faces as near as this to a border are asked themselves, m: more than the rules' tolerances.
#define MARGIN (4.0 * SCENE_TOLERANCE)

enum { BORDERS_PER_SEGMENT = 8 };

/// A straight border between constant velocities.
typedef struct border {
    vec2 low;  ///< the end with the smaller y, m
    vec2 high; ///< the other end, m
} border;

/// What the rows are drawn from.
typedef struct sketch {
    const scene *s;
    size_t n_segments;
    field__segment *segments;
    size_t n_near; ///< segments that may reach the row
    field__segment **near;
    size_t n_borders;
    border *borders; ///< sorted by low.y
    size_t n_begun;  ///< borders that begin below the row
    size_t n_active; ///< those of them that do not end below it
    border **active;
    uint8_t *marks; ///< of the faces of a row: nonzero, the face is near a border
} sketch;

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

static void add_border(sketch *k, vec2 a, vec2 b)
{
    k->borders[k->n_borders++] = a.y <= b.y ? (border){ a, b } : (border){ b, a };
}

/// The borders of a segment's bands, on both sides: which one is upstream is the belt's matter.
static void add_band_borders(sketch *k, const field__segment *segment)
{
    vec2 left = vec2_turn_left(segment->along), start = segment->start;
    vec2 end = vec2_add(start, vec2_scale(segment->along, segment->length)), corner[2][2];
    double level[3];

    velocity_field__levels(segment->obstacle, level);
    double reach = fmax(fabs(level[0]), level[2]);
    for (int side = 0; side < 2; side++) {
        double sign = side == 0 ? 1.0 : -1.0;
        for (int m = 0; m < 3; m++) {
            vec2 aside = vec2_scale(left, sign * level[m]);
            add_border(k, vec2_add(start, aside), vec2_add(end, aside));
        }
        corner[side][0] = vec2_add(start, vec2_scale(left, sign * reach));
        corner[side][1] = vec2_add(end, vec2_scale(left, sign * reach));
    }
    add_border(k, corner[0][0], corner[1][0]);
    add_border(k, corner[0][1], corner[1][1]);
}

static int compare_borders(const void *left, const void *right)
{
    const border *a = left, *b = right;
    return (a->low.y > b->low.y) - (a->low.y < b->low.y);
}

static void sketch_fini(sketch *k)
{
    memory_free(k->segments);
    memory_free(k->near);
    memory_free(k->borders);
    memory_free(k->active);
    memory_free(k->marks);
}

/// Room for all segments and borders of a scene. Returns 0, or -1 for no memory.
static int sketch_reserve(sketch *k, const scene *s)
{
    size_t n_segments = 0, n_borders = 0;

    for (size_t m = 0; m < s->n_obstacles; m++)
        n_segments += s->obstacles[m].n_points - 1;
    for (size_t m = 0; m < s->n_belts; m++)
        n_borders += s->belts[m].n_points;
    n_borders += BORDERS_PER_SEGMENT * n_segments;
    *k = (sketch){ .s = s };
    k->segments = memory_alloc(n_segments, sizeof *k->segments);
    k->near = memory_alloc(n_segments, sizeof(field__segment *));
    k->borders = memory_alloc(n_borders, sizeof *k->borders);
    k->active = memory_alloc(n_borders, sizeof(border *));
    k->marks = memory_alloc(scene_grid(s).n1 + 1, sizeof *k->marks);
    return k->segments && k->near && k->borders && k->active && k->marks ? 0 : -1;
}

static void sketch_draw(sketch *k)
{
    for (size_t b = 0; b < k->s->n_belts; b++) {
        const scene_belt *belt = &k->s->belts[b];
        for (size_t m = 0, last = belt->n_points - 1; m < belt->n_points; last = m++)
            add_border(k, belt->polygon[last], belt->polygon[m]);
    }
    for (size_t o = 0; o < k->s->n_obstacles; o++) {
        for (size_t m = 0; m + 1 < k->s->obstacles[o].n_points; m++) {
            k->segments[k->n_segments] = velocity_field__segment_of(&k->s->obstacles[o], m);
            add_band_borders(k, &k->segments[k->n_segments++]);
        }
    }
    qsort(k->borders, k->n_borders, sizeof *k->borders, compare_borders);
}

/// Choose the segments whose bands may reach the row at y, in their order.
static void choose_near(sketch *k, double y)
{
    k->n_near = 0;
    for (size_t m = 0; m < k->n_segments; m++) {
        field__segment *segment = &k->segments[m];
        double level[3], end = segment->start.y + segment->length * segment->along.y;
        velocity_field__levels(segment->obstacle, level);
        double reach = fmax(fabs(level[0]), level[2]) + MARGIN;
        if (fmin(segment->start.y, end) - reach <= y && y <= fmax(segment->start.y, end) + reach)
            k->near[k->n_near++] = segment;
    }
}

/// Mark the faces of the row at y that are near a border. Rows come upwards.
static void mark_row(sketch *k, const lattice *l, double y)
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

static vec2 ask(const sketch *k, vec2 at)
{
    field__verdict verdict = velocity_field__begin(k->s, at);

    for (size_t m = 0; m < k->n_near; m++)
        velocity_field__consider(&verdict, k->near[m], at);
    return verdict.velocity;
}

/// Fill a component of the velocity on all faces of a lattice.
static void fill_faces(sketch *k, const lattice *l, int component, double *ret_v)
{
    k->n_begun = k->n_active = 0;
    for (size_t j = 0; j < l->n_rows; j++) {
        double y = face_y(l, j), *row = ret_v + j * l->n_columns;
        choose_near(k, y);
        mark_row(k, l, y);
        for (size_t i = 0; i < l->n_columns;) {
            vec2 v = ask(k, (vec2){ face_x(l, i), y });
            const uint8_t *next =
                k->marks[i] ? k->marks + i + 1 : memchr(k->marks + i, 1, l->n_columns - i);
            size_t end = next != NULL ? (size_t)(next - k->marks) : l->n_columns;
            for (; i < end; i++)
                row[i] = component == 0 ? v.x : v.y;
        }
    }
}

/// Shut the faces whose links run along one axis and cross the line. swap: the links run along x2,
/// and all coordinates are taken in the order x2, x1.
static void shut_links(field *f, field__line line, bool swap)
{
    const bf_grid *g = &f->grid;
    vec2 a = swap ? (vec2){ line.start.y, line.start.x } : line.start;
    vec2 b = swap ? (vec2){ line.end.y, line.end.x } : line.end;
    field__line turned = { a, b };
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
            if (!velocity_field__crosses(&turned, from, to))
                continue;
            if (swap)
                f->closed2[k * g->n1 + m] = 1;
            else
                f->closed1[m * (g->n1 + 1) + k] = 1;
        }
    }
}

static void shut_obstacles(const scene *s, field *f)
{
    for (size_t k = 0; k < s->n_obstacles; k++) {
        const scene_obstacle *obstacle = &s->obstacles[k];
        if (!velocity_field__is_shutting(obstacle))
            continue;
        vec2 shift = velocity_field__shift(s, obstacle);
        for (size_t m = 0; m + 1 < obstacle->n_points; m++) {
            field__segment segment = velocity_field__segment_of(obstacle, m);
            field__line line = velocity_field__line_of(&segment, shift);
            shut_links(f, line, false);
            shut_links(f, line, true);
        }
    }
}

static void shut_edges(const scene *s, field *f)
{
    size_t n1 = f->grid.n1, n2 = f->grid.n2;

    for (size_t j = 0; j < n2; j++) {
        f->closed1[j * (n1 + 1)] |= s->edges[SCENE_WEST] == SCENE_EDGE_WALL;
        f->closed1[j * (n1 + 1) + n1] |= s->edges[SCENE_EAST] == SCENE_EDGE_WALL;
    }
    for (size_t i = 0; i < n1; i++) {
        f->closed2[i] |= s->edges[SCENE_SOUTH] == SCENE_EDGE_WALL;
        f->closed2[n2 * n1 + i] |= s->edges[SCENE_NORTH] == SCENE_EDGE_WALL;
    }
}

static void stop_at_closed(double *v, const uint8_t *closed, size_t n)
{
    for (size_t k = 0; k < n; k++)
        v[k] = closed[k] ? 0.0 : v[k];
}

/// A field of the scene's grid, all zero. NULL: no memory.
static field *field_alloc(const scene *s)
{
    field *f = memory_alloc(1, sizeof *f);

    if (f == NULL)
        return NULL;
    f->grid = scene_grid(s);
    size_t n_faces1 = (f->grid.n1 + 1) * f->grid.n2, n_faces2 = f->grid.n1 * (f->grid.n2 + 1);
    f->v1 = memory_alloc(n_faces1, sizeof *f->v1);
    f->v2 = memory_alloc(n_faces2, sizeof *f->v2);
    f->closed1 = memory_alloc(n_faces1, sizeof *f->closed1);
    f->closed2 = memory_alloc(n_faces2, sizeof *f->closed2);
    return f->v1 && f->v2 && f->closed1 && f->closed2 ? f : velocity_field_destroy(f);
}

bf_status velocity_field_create(const scene *s, field **ret_field, bf_error *err)
{
    sketch k = { 0 };
    field *f = field_alloc(s);

    if (f == NULL || sketch_reserve(&k, s) != 0) {
        sketch_fini(&k);
        velocity_field_destroy(f);
        return bf_fail(err, BF_ENOMEM, "/macro/cell_m", "no memory for the velocity field");
    }
    size_t n1 = f->grid.n1, n2 = f->grid.n2;
    sketch_draw(&k);
    fill_faces(&k, &(lattice){ &f->grid, n1 + 1, n2, 0.0, 0.5 }, 0, f->v1);
    fill_faces(&k, &(lattice){ &f->grid, n1, n2 + 1, 0.5, 0.0 }, 1, f->v2);
    shut_obstacles(s, f);
    shut_edges(s, f);
    stop_at_closed(f->v1, f->closed1, (n1 + 1) * n2);
    stop_at_closed(f->v2, f->closed2, n1 * (n2 + 1));
    sketch_fini(&k);
    *ret_field = f;
    return BF_OK;
}

field *velocity_field_destroy(field *f)
{
    if (f == NULL)
        return NULL;
    memory_free(f->v1);
    memory_free(f->v2);
    memory_free(f->closed1);
    memory_free(f->closed2);
    memory_free(f);
    return NULL;
}
