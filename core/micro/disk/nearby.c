// Parts near what is not a part: the faces and arcs that they may touch, open edges and borders of belts.

#include "core/base/memory.h"
#include "core/micro/disk/disk_priv.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// A box that contains all relevant centres; sides may be infinite.
typedef struct box {
    double x_min, x_max, y_min, y_max;
} box;

// a times b, where 0 times infinity is 0.
static double times(double a, double b)
{
    return a == 0.0 || b == 0.0 ? 0.0 : a * b;
}

static box bound_face(const disk_face *f, double radius, double margin)
{
    const double along[2] = { f->from - margin, f->to + margin };
    const double height[2] = { -f->depth - margin, radius + margin };
    box b = { INFINITY, -INFINITY, INFINITY, -INFINITY };

    for (int k = 0; k < 4; k++) {
        double a = along[k / 2], h = height[k % 2];
        const double x = f->px + times(a, f->ny) + times(h, f->nx);
        const double y = f->py - times(a, f->nx) + times(h, f->ny);
        b.x_min = fmin(b.x_min, x);
        b.x_max = fmax(b.x_max, x);
        b.y_min = fmin(b.y_min, y);
        b.y_max = fmax(b.y_max, y);
    }
    return b;
}

static box bound_arc(const disk_arc *a, double radius, double margin)
{
    double r = a->radius + radius + margin;

    return (box){ a->px - r, a->px + r, a->py - r, a->py + r };
}

static bool is_near_face(const disk_face *f, const disk *part, double margin)
{
    double rx = part->x - f->px, ry = part->y - f->py;
    double along = rx * f->ny - ry * f->nx, height = rx * f->nx + ry * f->ny;

    return along >= f->from - margin && along <= f->to + margin && height >= -f->depth - margin &&
           height <= part->radius + margin;
}

static bool is_near_arc(const disk_arc *a, const disk *part, double margin)
{
    double rx = part->x - a->px, ry = part->y - a->py, r = a->radius + part->radius + margin;

    return rx * rx + ry * ry <= r * r && rx * a->ex + ry * a->ey >= -margin &&
           rx * a->fx + ry * a->fy >= -margin;
}

static bool is_near(const disk_state *s, uint32_t feature, size_t slot, double margin)
{
    return feature < s->n_faces
               ? is_near_face(&s->faces[feature], &s->now[slot], margin)
               : is_near_arc(&s->arcs[feature - s->n_faces], &s->now[slot], margin);
}

// Adds the parts in a box that may touch a feature.
static bf_status search_box(disk_state *s, uint32_t feature, const box *b, double margin)
{
    const neighbours_cells *c = &s->cells;
    size_t i_max = neighbours_column(c, b->x_max), j_max = neighbours_row(c, b->y_max);

    for (size_t i = neighbours_column(c, b->x_min); i <= i_max; i++)
        for (size_t j = neighbours_row(c, b->y_min); j <= j_max; j++) {
            const size_t cell = neighbours_cell(c, i, j);
            for (uint32_t slot = c->first[cell]; slot < c->first[cell + 1]; slot++) {
                if (!is_near(s, feature, slot, margin))
                    continue;
                if (memory_reserve(&s->candidates, &s->candidates_capacity, s->n_candidates + 1,
                                   sizeof *s->candidates) != 0)
                    return BF_ENOMEM;
                s->candidates[s->n_candidates++] = (disk_candidate){ slot, feature };
            }
        }
    return BF_OK;
}

static int compare_candidates(const void *left, const void *right)
{
    const disk_candidate *a = left, *b = right;

    if (a->slot != b->slot)
        return a->slot < b->slot ? -1 : 1;
    return (a->feature > b->feature) - (a->feature < b->feature);
}

bf_status disk__find_candidates(disk_state *s)
{
    const double margin = 0.5 * s->skin;

    s->n_candidates = 0;
    for (size_t k = 0; k < s->n_faces + s->n_arcs; k++) {
        box b = k < s->n_faces ? bound_face(&s->faces[k], s->radius_max, margin)
                               : bound_arc(&s->arcs[k - s->n_faces], s->radius_max, margin);
        if (search_box(s, (uint32_t)k, &b, margin) != BF_OK)
            return BF_ENOMEM;
    }
    if (s->n_candidates > 0)
        qsort(s->candidates, s->n_candidates, sizeof *s->candidates, compare_candidates);
    memset(s->has_candidates, 0, s->n_padded / DISK_GROUP);
    for (size_t k = 0; k < s->n_candidates; k++)
        s->has_candidates[s->candidates[k].slot / DISK_GROUP] = 1;
    return BF_OK;
}

bf_status disk__find_border_parts(disk_state *s)
{
    const double margin = 0.5 * s->skin;
    const surroundings *around = &s->common.around;

    s->n_border_parts = 0;
    for (size_t slot = 0; slot < s->n_live; slot++) {
        const disk *part = &s->now[slot];
        const vec2 at = { part->x, part->y };
        if (!s->is_uniform)
            s->belt_under[slot] = disk__belt_under(s, part);
        bool is_near = surroundings_is_outside(around, (vec2){ at.x - margin, at.y - margin }) ||
                       surroundings_is_outside(around, (vec2){ at.x + margin, at.y + margin });
        // The belt that carries a part may change while it moves by the margin; beyond all belts it may anywhere.
        if (!is_near && !s->is_uniform)
            is_near = surroundings_falls(around, surroundings_belt_below(around, at)) ||
                      surroundings_border_distance(around, at) <= margin + SCENE_TOLERANCE;
        if (!is_near)
            continue;
        if (memory_reserve(&s->border_parts, &s->border_parts_capacity, s->n_border_parts + 1,
                           sizeof *s->border_parts) != 0)
            return BF_ENOMEM;
        s->border_parts[s->n_border_parts++] = (disk_border_part){ .slot = (uint32_t)slot };
    }
    for (size_t slot = s->n_live; !s->is_uniform && slot < s->n_padded; slot++)
        s->belt_under[slot] = (uint16_t)s->common.around.n_belts;
    return BF_OK;
}

// What a part is after a step; sets the belt that carries it.
static int find_presence(disk_state *s, size_t slot, const disk *part)
{
    const surroundings *around = &s->common.around;
    const bool has_left = surroundings_is_outside(around, (vec2){ part->x, part->y });

    if (s->is_uniform)
        return has_left ? MICRO_LEFT : MICRO_HERE;
    s->belt_under[slot] = has_left ? (uint16_t)around->n_belts : disk__belt_under(s, part);
    if (has_left)
        return MICRO_LEFT;
    return surroundings_falls(around, s->belt_under[slot]) ? MICRO_FELL : MICRO_HERE;
}

void disk__update_border_parts(disk_state *s, disk *rows, size_t border_first, size_t border_last,
                               disk_presence left)
{
    for (size_t k = border_first; k < border_last; k++) {
        disk_border_part *w = &s->border_parts[k];
        disk *part = &rows[w->slot];
        if (w->gone != DISK_HERE)
            continue;
        const int presence = find_presence(s, w->slot, part);
        if (presence == MICRO_HERE)
            continue;
        *w = (disk_border_part){ w->slot, left, s->heading[w->slot], *part };
        s->common.presence[s->id_of[w->slot]] = (uint8_t)presence;
        *part = disk__pad(s, w->slot);
    }
}
