// Plates and which of them are near a point. A straight piece of an obstacle's path is a plate of infinite height.
//
// Where a path bends, two plates are joined. On the inner side of the bend both have contacts. On its outer side the
// corner belongs to one of them, so that it acts once; and where the outer side is the downstream one, both
// are prolonged until their downstream faces intersect.

#include "core/micro/body/plates.h"

#include "core/base/memory.h"
#include "core/base/vec2.h"
#include "core/micro/body/body_priv.h"

#include <math.h>

enum { CELLS_A_SIDE_MAX = 256 };

/// Most tests of a cell against a plate when the map is made. At least the number of plates, as one cell
/// always remains.
#define MAP_TESTS_MAX 1e8

/// A sine below this, between two segments of a path, is rounding: they make one plate.
#define STRAIGHT 1e-9

static body_plate make_plate(const body_state *s, const scene_obstacle *obstacle, size_t first,
                             size_t last)
{
    const surroundings_piece piece = surroundings_span_of(&s->common.around, obstacle, first, last);
    const vec2 to = vec2_sub(piece.end, piece.start);
    const vec2 middle = vec2_add(piece.start, vec2_scale(to, 0.5));
    const double half = 0.5 * piece.thickness;
    // Rounded by one division, which is nearer to a unit vector than piece.along.
    const vec3 along = { to.x / piece.length, to.y / piece.length, 0.0 };
    const vec3 left = { -along.y, along.x, 0.0 };
    const bool is_left = vec2_cross(piece.along, piece.upstream) > 0.0;
    const vec3 across = is_left ? left : vec3_scale(left, -1.0);

    return (body_plate){ .middle = vec3_along((vec3){ middle.x, middle.y, 0.0 }, piece.lift - half,
                                              across),
                         .along = along,
                         .across = across,
                         .half_length = 0.5 * piece.length,
                         .half_thickness = half,
                         .lift = piece.lift,
                         .joined = { BODY_NO_PLATE, BODY_NO_PLATE } };
}

/// Sine of the angle by which a path turns left at point k.
static double measure_bend(const scene_obstacle *obstacle, size_t k)
{
    vec2 before = vec2_sub(obstacle->path[k], obstacle->path[k - 1]);
    vec2 after = vec2_sub(obstacle->path[k + 1], obstacle->path[k]);

    return vec2_cross(before, after) / (vec2_length(before) * vec2_length(after));
}

static bool is_straight(const scene_obstacle *obstacle, size_t k)
{
    vec2 before = vec2_sub(obstacle->path[k], obstacle->path[k - 1]);
    vec2 after = vec2_sub(obstacle->path[k + 1], obstacle->path[k]);

    return fabs(measure_bend(obstacle, k)) < STRAIGHT && vec2_dot(before, after) > 0.0;
}

/// Prolong a plate beyond its start (end = 0) or its end (end = 1).
static void prolong(body_plate *plate, int end, double length)
{
    plate->middle = vec3_along(plate->middle, (end == 0 ? -0.5 : 0.5) * length, plate->along);
    plate->half_length += 0.5 * length;
}

/// How far the face of a plate on the outer side of a bend is from the path, m.
static double outer_height(const body_plate *plate, double bend)
{
    const double upstream_bend = bend * vec3_cross(plate->along, plate->across).z;

    return upstream_bend > 0.0 ? 2.0 * plate->half_thickness - plate->lift : plate->lift;
}

/// Join the last two plates, between which the path bends. Their faces on the outer side, at a height h from the path,
/// meet at h tan(angle / 2) beyond the joint; at bends of more than a right angle the plates are prolonged by h.
static void join_plates(body_state *s, double bend)
{
    const int32_t last = (int32_t)s->n_plates - 1;
    body_plate *before = &s->plates[last - 1], *after = &s->plates[last];
    double cosine = vec3_dot(before->along, after->along);
    double half_tangent = cosine > 0.0 ? fabs(bend) / (1.0 + cosine) : 1.0;
    double height = outer_height(before, bend);

    before->joined[1] = last;
    after->joined[0] = last - 1;
    before->bend[1] = after->bend[0] = bend;
    before->has_step[1] = after->has_step[0] =
        fabs(height - outer_height(after, bend)) > STRAIGHT * before->half_thickness;
    if (height > 0.0) {
        prolong(before, 1, height * half_tangent);
        prolong(after, 0, height * half_tangent);
    }
}

/// True if a point is beyond the start (end = 0) or the end (end = 1) of a plate.
static bool is_beyond(const body_plate *plate, int end, double x, double y)
{
    double a = vec3_dot((vec3){ x - plate->middle.x, y - plate->middle.y, 0.0 }, plate->along);

    return end == 0 ? a < -plate->half_length : a > plate->half_length;
}

/// True if a point on the outer side of the joint at an end of a plate is nearer to the plate beyond the joint.
static bool is_nearer_to_next(const body_state *s, const body_plate *plate, int end, double x,
                              double y)
{
    return is_beyond(plate, end, x, y) &&
           (end == 0 || !is_beyond(&s->plates[plate->joined[end]], 0, x, y));
}

/// True if a plate is joined at an end, with the outer side of the bend on the given side of it; 1: left, -1: right.
static bool is_outside(const body_plate *plate, int end, double side)
{
    return plate->joined[end] != BODY_NO_PLATE && plate->bend[end] * side <= 0.0;
}

/// Side of a plate on which a point is; 1: left, -1: right.
static double side_of(const body_plate *plate, double x, double y)
{
    const vec3 to = { x - plate->middle.x, y - plate->middle.y, 0.0 };

    return vec3_cross(plate->along, to).z > 0.0 ? 1.0 : -1.0;
}

static bool is_felt_beyond(const body_state *s, const body_plate *plate, double x, double y,
                           bool only_steps)
{
    const double side = side_of(plate, x, y);

    for (int end = 0; end < 2; end++)
        if (is_outside(plate, end, side) && (plate->has_step[end] || !only_steps) &&
            is_nearer_to_next(s, plate, end, x, y))
            return true;
    return false;
}

bool body__is_felt_beyond_joint(const body_state *s, const body_plate *plate, double x, double y)
{
    return is_felt_beyond(s, plate, x, y, false);
}

bool body__is_behind_step(const body_state *s, const body_plate *plate, vec3 x)
{
    return is_felt_beyond(s, plate, x.x, x.y, true);
}

const body_plate *body__next_around(const body_state *s, const body_plate *plate, int end, vec3 x,
                                    double *ret_side)
{
    *ret_side = side_of(plate, x.x, x.y);
    return is_outside(plate, end, *ret_side) && !plate->has_step[end]
               ? &s->plates[plate->joined[end]]
               : NULL;
}

body_joint_contact body__feel_at_joints(const body_state *s, const body_plate *plate, vec3 x,
                                        vec3 normal)
{
    for (int end = 0; end < 2; end++) {
        double side;
        const body_plate *next = body__next_around(s, plate, end, x, &side);
        if (next == NULL)
            continue;
        // Normals of the sides are the directions along the plates, turned by a quarter.
        const vec3 from_normal = { side * normal.y, -side * normal.x, 0.0 };
        const double way = (end == 0 ? 1.0 : -1.0) * side;
        if (way * vec3_cross(plate->along, from_normal).z <= STRAIGHT)
            continue;
        if (way * vec3_cross(next->along, from_normal).z > STRAIGHT)
            return BODY_INSIDE_JOINT;
        return is_nearer_to_next(s, plate, end, x.x, x.y) ? BODY_AT_OTHER_PLATE : BODY_AT_PLATE;
    }
    return BODY_AT_PLATE;
}

double body__plate_distance(const body_plate *plate, double x, double y)
{
    vec3 to = { x - plate->middle.x, y - plate->middle.y, 0.0 };
    double a = fmax(0.0, fabs(vec3_dot(to, plate->along)) - plate->half_length);
    double c = fmax(0.0, fabs(vec3_dot(to, plate->across)) - plate->half_thickness);

    return sqrt(a * a + c * c);
}

/// Column or row of a coordinate, clamped to the map.
static size_t find_cell(double value, double low, double edge, size_t n)
{
    double cell = floor((value - low) / edge);

    return cell > 0.0 ? (cell < (double)n ? (size_t)cell : n - 1) : 0;
}

double body__plate_distance_ever(const body_state *s, size_t plate, double x, double y)
{
    const body_moving *moving = s->moving != NULL ? &s->moving[plate] : NULL;

    if (moving == NULL || !moving->moves)
        return body__plate_distance(&s->plates[plate], x, y);
    const double distance =
        plate_range_distance(&moving->range, moving->rest_pivot, (vec2){ x, y });
    return fmax(0.0, distance - moving->radius);
}

/// List the plates that a part with its centre in a cell may touch.
static bf_status map_cell(body_state *s, size_t i, size_t j, size_t *n)
{
    body_map *map = &s->map;
    double x = map->x_min + ((double)i + 0.5) * map->edge;
    double y = map->y_min + ((double)j + 0.5) * map->edge;
    double range = s->map_range + map->edge;

    map->first[j * map->n_x + i] = *n;
    for (size_t k = 0; k < s->n_plates; k++) {
        if (body__plate_distance_ever(s, k, x, y) > range)
            continue;
        if (memory_reserve(&map->plate, &map->capacity, *n + 1, sizeof *map->plate) != 0)
            return BF_ENOMEM;
        map->plate[(*n)++] = (uint32_t)k;
    }
    return BF_OK;
}

/// Cells of the size of parts, or larger to limit the work of making the map.
static bf_status make_map(body_state *s, const scene_rect *domain)
{
    double width = domain->x_max - domain->x_min, height = domain->y_max - domain->y_min;
    double least = fmax(width, height) / CELLS_A_SIDE_MAX;
    body_map *map = &s->map;
    size_t n = 0;

    map->x_min = domain->x_min;
    map->y_min = domain->y_min;
    map->edge = fmax(2.0 * s->bounding_radius_max, least);
    while (ceil(width / map->edge) * ceil(height / map->edge) * (double)s->n_plates > MAP_TESTS_MAX)
        map->edge *= 2.0;
    map->n_x = (size_t)fmax(1.0, ceil(width / map->edge));
    map->n_y = (size_t)fmax(1.0, ceil(height / map->edge));
    map->first = memory_alloc(map->n_x * map->n_y + 1, sizeof *map->first);
    if (map->first == NULL)
        return BF_ENOMEM;
    for (size_t j = 0; j < map->n_y; j++)
        for (size_t i = 0; i < map->n_x; i++)
            if (map_cell(s, i, j, &n) != BF_OK)
                return BF_ENOMEM;
    map->first[map->n_x * map->n_y] = n;
    return BF_OK;
}

bf_status body__plates_init(body_state *s, const micro_def *def, bf_error *err)
{
    size_t n = 0;

    for (size_t k = 0; k < def->n_obstacles; k++)
        n += def->obstacles[k].n_points - 1;
    if (n == 0)
        return BF_OK;
    s->plates = memory_alloc(n, sizeof *s->plates);
    s->plate_memories = memory_alloc(s->capacity, sizeof *s->plate_memories);
    s->moving = s->common.world->plates.is_any ? memory_alloc(n, sizeof *s->moving) : NULL;
    if (s->plates == NULL || s->plate_memories == NULL ||
        (s->common.world->plates.is_any && s->moving == NULL))
        return bf_fail(err, BF_ENOMEM, "/obstacles", "no memory for the obstacles");
    for (size_t k = 0; k < def->n_obstacles; k++) {
        const size_t first = s->n_plates;
        for (size_t start = 0, last = 1; last < def->obstacles[k].n_points; start = last++) {
            while (last + 1 < def->obstacles[k].n_points && is_straight(&def->obstacles[k], last))
                last++;
            s->plates[s->n_plates++] = make_plate(s, &def->obstacles[k], start, last);
            if (start > 0)
                join_plates(s, measure_bend(&def->obstacles[k], start));
        }
        if (scene_obstacle_moves(&def->obstacles[k]))
            body__add_moving_plates(s, def, k, first);
    }
    body__pose_plates(s, 0);
    if (make_map(s, &def->domain) != BF_OK)
        return bf_fail(err, BF_ENOMEM, "/obstacles", "no memory for the obstacles");
    return BF_OK;
}

void body__plates_fini(body_state *s)
{
    memory_free(s->moving);
    memory_free(s->plates);
    memory_free(s->plate_memories);
    memory_free(s->map.first);
    memory_free(s->map.plate);
}

const uint32_t *body__plates_near(const body_state *s, double x, double y, size_t *ret_n)
{
    const body_map *map = &s->map;

    *ret_n = 0;
    if (s->n_plates == 0)
        return NULL;
    size_t i = find_cell(x, map->x_min, map->edge, map->n_x);
    size_t j = find_cell(y, map->y_min, map->edge, map->n_y);
    size_t cell = j * map->n_x + i;
    *ret_n = map->first[cell + 1] - map->first[cell];
    return &map->plate[map->first[cell]];
}
