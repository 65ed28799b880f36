// Walls and plates as faces and arcs.
//
// A plate is its path swept by the thickness to the downstream side, or by half of it to both: a rectangle a segment. Of their
// union only the outside counts, so that a part that slides over a joint is in contact with one surface: sides extend
// from joint to joint, each over its half-open range; on the outer side of a bend an arc joins them,
// around the joint itself and with radius 0 if that is the upstream side, else the thickness; at free
// ends there is a short face across and a sharp edge at each of its ends.

#include "core/micro/disk/boundary.h"

#include "core/base/memory.h"
#include "core/micro/disk/disk_priv.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double parallel = 1e-12; // sines below it are rounding

// Adds a face from a to b with the obstacle on the right of the way from a to b.
static void add_face(disk_state *s, vec2 a, vec2 b, double depth)
{
    vec2 to = vec2_sub(b, a);
    double length = vec2_length(to);
    vec2 n = vec2_turn_left(vec2_scale(to, 1.0 / length));

    s->faces[s->n_faces++] = (disk_face){ .px = a.x,
                                          .py = a.y,
                                          .nx = n.x,
                                          .ny = n.y,
                                          .from = 0.0,
                                          .to = length,
                                          .depth = depth,
                                          .friction = s->handling.friction };
}

static void add_arc(disk_state *s, vec2 p, double radius, vec2 e, vec2 f)
{
    s->arcs[s->n_arcs++] = (disk_arc){ p.x, p.y, radius, e.x, e.y, f.x, f.y, s->handling.friction };
}

// The side of a segment with normal n, moved along n.
static void add_side(disk_state *s, const surroundings_piece *g, vec2 n, double shift, double depth)
{
    vec2 a = vec2_add(g->start, vec2_scale(n, shift));
    vec2 b = vec2_add(a, vec2_scale(g->along, g->length));

    if (vec2_cross(g->along, n) > 0.0)
        add_face(s, a, b, depth);
    else
        add_face(s, b, a, depth);
}

// The end of the upstream face of a segment whose path ends at p.
static vec2 face_end(const surroundings_piece *g, vec2 p)
{
    return vec2_add(p, vec2_scale(g->upstream, g->lift));
}

// The end of a segment, across it, from p on its upstream face; out points away from the segment.
static void add_end(disk_state *s, const surroundings_piece *g, vec2 p, vec2 out, double thickness)
{
    vec2 down = vec2_scale(g->upstream, -1.0);
    vec2 q = vec2_add(p, vec2_scale(down, thickness));

    if (vec2_cross(vec2_sub(q, p), out) > 0.0)
        add_face(s, p, q, 0.0);
    else
        add_face(s, q, p, 0.0);
    add_arc(s, q, 0.0, out, down);
}

static void add_free_end(disk_state *s, const surroundings_piece *g, vec2 p, vec2 out,
                         double thickness)
{
    p = face_end(g, p);
    add_end(s, g, p, out, thickness);
    add_arc(s, p, 0.0, out, g->upstream);
}

/// How far the left (side = 1) or the right face (-1) of a segment is from its path, m.
static double height_of(const surroundings_piece *g, double side)
{
    return side * vec2_cross(g->along, g->upstream) > 0.0 ? g->lift : g->thickness - g->lift;
}

static void add_joint(disk_state *s, const surroundings_piece *a, const surroundings_piece *b,
                      double thickness)
{
    double turn = vec2_cross(a->along, b->along);
    double outer = turn < 0.0 ? 1.0 : -1.0;
    bool is_step = height_of(a, outer) != height_of(b, outer);
    bool is_straight = fabs(turn) <= parallel && vec2_dot(a->along, b->along) > 0.0;
    vec2 back = vec2_scale(b->along, -1.0);

    if (!is_straight)
        add_arc(s, b->start, is_step ? 0.0 : height_of(a, outer), a->along, back);
    if (!is_step)
        return;
    add_end(s, a, face_end(a, b->start), a->along, thickness);
    add_end(s, b, face_end(b, b->start), back, thickness);
}

static bool is_closed(const scene_obstacle *obstacle)
{
    vec2 first = obstacle->path[0], last = obstacle->path[obstacle->n_points - 1];

    return obstacle->n_points > 3 && vec2_length(vec2_sub(last, first)) <= SCENE_TOLERANCE;
}

static void add_plate(disk_state *s, const scene_obstacle *obstacle)
{
    const size_t n = obstacle->n_points - 1;
    const surroundings_piece first = surroundings_piece_of(&s->common.around, obstacle, 0);
    surroundings_piece last = first;

    for (size_t k = 0; k < n; k++) {
        surroundings_piece g = surroundings_piece_of(&s->common.around, obstacle, k);
        vec2 down = vec2_scale(g.upstream, -1.0);
        add_side(s, &g, g.upstream, g.lift, obstacle->thickness);
        add_side(s, &g, down, obstacle->thickness - g.lift, 0.0);
        if (k > 0)
            add_joint(s, &last, &g, obstacle->thickness);
        last = g;
    }
    if (is_closed(obstacle)) {
        add_joint(s, &last, &first, obstacle->thickness);
        return;
    }
    add_free_end(s, &first, first.start, vec2_scale(first.along, -1.0), obstacle->thickness);
    add_free_end(s, &last, obstacle->path[n], last.along, obstacle->thickness);
}

bf_status disk__boundary_init(disk_state *s, const micro_def *def, bf_error *err)
{
    size_t n_faces = SCENE_SIDE_COUNT, n_arcs = 0;

    // A segment has two sides, and at most two ends, each with an edge, and a joint or two more edges.
    for (size_t k = 0; k < def->n_obstacles; k++) {
        n_faces += 4 * def->obstacles[k].n_points;
        n_arcs += 4 * def->obstacles[k].n_points;
    }
    s->faces = memory_alloc(n_faces, sizeof *s->faces);
    s->arcs = memory_alloc(n_arcs, sizeof *s->arcs);
    s->plates.of = memory_alloc(def->n_obstacles, sizeof *s->plates.of);
    if (s->faces == NULL || s->arcs == NULL || s->plates.of == NULL)
        return bf_fail(err, BF_ENOMEM, "/obstacles", "no memory for the obstacles");
    for (int side = 0; side < SCENE_SIDE_COUNT; side++) {
        const surroundings_line line = surroundings_side(&s->common.around, (scene_side)side);
        if (s->common.around.edges[side] == SCENE_EDGE_WALL)
            s->faces[s->n_faces++] = (disk_face){ .px = line.at.x,
                                                  .py = line.at.y,
                                                  .nx = line.inward.x,
                                                  .ny = line.inward.y,
                                                  .from = -INFINITY,
                                                  .to = INFINITY,
                                                  .depth = INFINITY,
                                                  .friction = s->def.wall_friction };
    }
    for (size_t k = 0; k < def->n_obstacles; k++) {
        const size_t face_first = s->n_faces, arc_first = s->n_arcs;
        add_plate(s, &def->obstacles[k]);
        if (scene_obstacle_moves(&def->obstacles[k]))
            disk__add_moving_plate(s, &def->obstacles[k], k, face_first, arc_first);
    }
    return disk__copy_boundary(s, err);
}

void disk__boundary_fini(disk_state *s)
{
    memory_free(s->faces);
    memory_free(s->arcs);
    memory_free(s->candidates);
}

double disk__overlap(const disk_state *s, const disk *part, uint32_t feature, bool *ret_counts)
{
    const double radius =
        s->plates.n > 0 ? part->radius - s->plates.surfaces[feature].recess : part->radius;

    if (feature < s->n_faces) {
        const disk_face *f = &s->faces[feature];
        double rx = part->x - f->px, ry = part->y - f->py;
        double along = rx * f->ny - ry * f->nx, height = rx * f->nx + ry * f->ny;
        *ret_counts = f->from <= along && along < f->to && -f->depth < height;
        return radius - height;
    }
    const disk_arc *a = &s->arcs[feature - s->n_faces];
    double rx = part->x - a->px, ry = part->y - a->py;
    double height = sqrt(rx * rx + ry * ry) - a->radius;
    *ret_counts = rx * a->ex + ry * a->ey >= 0.0 && rx * a->fx + ry * a->fy > 0.0 && height > 0.0;
    return radius - height;
}
