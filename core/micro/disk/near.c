// What parts are near: faces and arcs that they may touch, open edges and borders of belts.

#include "core/micro/disk/disk_priv.h"

#include "core/base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

disk_row disk__pad(const disk_state *s, size_t place)
{
    const scene_rect *d = &s->around.domain;
    const scene_edge *edges = s->around.edges;
    const double away = DISK_FAR + 4.0 * s->radius_max * (double)place;
    disk_row row = s->kinds[0].row;

    // Beyond an open side, where it is inside of every wall.
    row.x = 0.5 * (d->x_min + d->x_max);
    row.y = 0.5 * (d->y_min + d->y_max);
    if (edges[SCENE_EAST] != SCENE_EDGE_WALL)
        row.x = away;
    else if (edges[SCENE_SOUTH] != SCENE_EDGE_WALL)
        row.y = -away;
    else if (edges[SCENE_NORTH] != SCENE_EDGE_WALL)
        row.y = away;
    else
        row.x = -away;
    return row;
}

disk_belt disk__belt_at(const disk_state *s, double x, double y)
{
    vec2 velocity;
    bool is_on_belt =
        surroundings_belt_at(&s->around, (vec2){ x, y }, (double)s->steps * s->def.dt, &velocity);

    return (disk_belt){ velocity.x, velocity.y, is_on_belt ? 1.0 : 0.0 };
}

// A box that holds all centres in question; sides may be infinite.
typedef struct box {
    double x_min, x_max, y_min, y_max;
} box;

static void add_point(box *b, double x, double y)
{
    b->x_min = fmin(b->x_min, x);
    b->x_max = fmax(b->x_max, x);
    b->y_min = fmin(b->y_min, y);
    b->y_max = fmax(b->y_max, y);
}

// a times b where nothing times infinity is nothing.
static double times(double a, double b)
{
    return a == 0.0 || b == 0.0 ? 0.0 : a * b;
}

static box bound_face(const disk_face *f, double reach, double margin)
{
    const double along[2] = { f->from - margin, f->to + margin };
    const double height[2] = { -f->depth - margin, reach + margin };
    box b = { INFINITY, -INFINITY, INFINITY, -INFINITY };

    for (int k = 0; k < 4; k++) {
        double a = along[k / 2], h = height[k % 2];
        add_point(&b, f->px + times(a, f->ny) + times(h, f->nx),
                  f->py - times(a, f->nx) + times(h, f->ny));
    }
    return b;
}

static box bound_arc(const disk_arc *a, double reach, double margin)
{
    double r = a->radius + reach + margin;

    return (box){ a->px - r, a->px + r, a->py - r, a->py + r };
}

static bool is_near_face(const disk_face *f, const disk_row *part, double margin)
{
    double rx = part->x - f->px, ry = part->y - f->py;
    double along = rx * f->ny - ry * f->nx, height = rx * f->nx + ry * f->ny;

    return along >= f->from - margin && along <= f->to + margin && height >= -f->depth - margin &&
           height <= part->radius + margin;
}

static bool is_near_arc(const disk_arc *a, const disk_row *part, double margin)
{
    double rx = part->x - a->px, ry = part->y - a->py, r = a->radius + part->radius + margin;

    return rx * rx + ry * ry <= r * r && rx * a->ex + ry * a->ey >= -margin &&
           rx * a->fx + ry * a->fy >= -margin;
}

static bool is_near(const disk_state *s, uint32_t feature, size_t place, double margin)
{
    return feature < s->n_faces
               ? is_near_face(&s->faces[feature], &s->now[place], margin)
               : is_near_arc(&s->arcs[feature - s->n_faces], &s->now[place], margin);
}

static bf_status add_touches(disk_state *s, uint32_t feature, size_t cell, double margin)
{
    const uint32_t *first = s->cells.first;

    for (uint32_t place = first[cell]; place < first[cell + 1]; place++) {
        if (!is_near(s, feature, place, margin))
            continue;
        if (memory_reserve(&s->touches, &s->touches_capacity, s->n_touches + 1,
                           sizeof *s->touches) != 0)
            return BF_ENOMEM;
        s->touches[s->n_touches++] = (disk_touch){ place, feature };
    }
    return BF_OK;
}

static bf_status search_box(disk_state *s, uint32_t feature, const box *b, double margin)
{
    const neighbours_cells *c = &s->cells;
    size_t i_max = neighbours_column(c, b->x_max), j_max = neighbours_row(c, b->y_max);

    for (size_t i = neighbours_column(c, b->x_min); i <= i_max; i++)
        for (size_t j = neighbours_row(c, b->y_min); j <= j_max; j++)
            if (add_touches(s, feature, neighbours_cell(c, i, j), margin) != BF_OK)
                return BF_ENOMEM;
    return BF_OK;
}

static int compare_touches(const void *left, const void *right)
{
    const disk_touch *a = left, *b = right;

    if (a->place != b->place)
        return a->place < b->place ? -1 : 1;
    return (a->feature > b->feature) - (a->feature < b->feature);
}

bf_status disk__find_touches(disk_state *s)
{
    const double margin = 0.5 * s->skin;

    s->n_touches = 0;
    for (size_t k = 0; k < s->n_faces + s->n_arcs; k++) {
        box b = k < s->n_faces ? bound_face(&s->faces[k], s->radius_max, margin)
                               : bound_arc(&s->arcs[k - s->n_faces], s->radius_max, margin);
        if (search_box(s, (uint32_t)k, &b, margin) != BF_OK)
            return BF_ENOMEM;
    }
    if (s->n_touches > 0)
        qsort(s->touches, s->n_touches, sizeof *s->touches, compare_touches);
    memset(s->is_touched, 0, s->n_padded / DISK_GROUP);
    for (size_t k = 0; k < s->n_touches; k++)
        s->is_touched[s->touches[k].place / DISK_GROUP] = 1;
    return BF_OK;
}

static bool is_near_open_edge(const disk_state *s, const disk_row *part, double margin)
{
    return surroundings_is_outside(&s->around, (vec2){ part->x - margin, part->y - margin }) ||
           surroundings_is_outside(&s->around, (vec2){ part->x + margin, part->y + margin });
}

static bool is_near_border(const disk_state *s, const disk_row *part, double margin)
{
    return surroundings_border_distance(&s->around, (vec2){ part->x, part->y }) <=
           margin + SCENE_TOLERANCE;
}

bf_status disk__find_watches(disk_state *s)
{
    const double margin = 0.5 * s->skin;

    s->n_watches = 0;
    for (size_t place = 0; place < s->n_live; place++) {
        const disk_row *part = &s->now[place];
        if (!s->is_plain)
            s->belt_under[place] = disk__belt_at(s, part->x, part->y);
        if (!is_near_open_edge(s, part, margin) &&
            (s->is_plain || !is_near_border(s, part, margin)))
            continue;
        if (memory_reserve(&s->watches, &s->watches_capacity, s->n_watches + 1,
                           sizeof *s->watches) != 0)
            return BF_ENOMEM;
        s->watches[s->n_watches++] = (disk_watch){ .place = (uint32_t)place };
    }
    return BF_OK;
}

void disk__look(disk_state *s, disk_row *rows, size_t watch_first, size_t watch_last,
                disk_presence left)
{
    for (size_t k = watch_first; k < watch_last; k++) {
        disk_watch *w = &s->watches[k];
        disk_row *part = &rows[w->place];
        if (w->gone != DISK_HERE)
            continue;
        if (surroundings_is_outside(&s->around, (vec2){ part->x, part->y })) {
            *w = (disk_watch){ w->place, left, s->heading[w->place], *part };
            s->is_gone[s->number[w->place]] = 1;
            *part = disk__pad(s, w->place);
        } else if (!s->is_plain) {
            s->belt_under[w->place] = disk__belt_at(s, part->x, part->y);
        }
    }
}
