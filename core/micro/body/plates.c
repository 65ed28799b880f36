// Contacts with plates and walls. A straight piece of an obstacle's path is a plate of infinite height; a wall
// is a half space.
//
// While the centre of a body is between the ends of a plate, the contact normal is that of the side on which
// the centre is, however thin the plate and however large the overlap. Beyond the ends it is the direction of
// least depth.
//
// Where a path bends, two plates meet. On the inner side of the bend both have contacts. On its outer side the
// corner belongs to one of them, so that it acts once; and where the outer side is the downstream one, both
// are prolonged until their downstream faces meet.

#include "core/micro/body/body_priv.h"

#include "core/base/memory.h"
#include "core/base/vec2.h"

#include <math.h>
#include <string.h>

enum { CELLS_A_SIDE_MAX = 256 };

/// Most tests of a cell against a plate when the map is made. At least the number of plates, as one cell
/// always remains.
#define MAP_TESTS_MAX 1e8

/// Half the height of the cuboid that stands for a plate near a body, in radii of the body.
#define CUBOID_HALF_HEIGHT 8.0

/// A sine below this, between two segments of a path, is rounding: they make one plate.
#define STRAIGHT 1e-9

static body_plate make_plate(const body_state *s, const scene_obstacle *obstacle, vec2 start,
                             vec2 end)
{
    vec2 ends[] = { start, end };
    scene_obstacle straight = *obstacle;
    straight.path = ends;
    straight.n_points = 2;
    const surroundings_piece piece = surroundings_piece_of(&s->around, &straight, 0);
    const vec2 to = vec2_sub(piece.end, piece.start);
    const vec2 middle = vec2_add(piece.start, vec2_scale(to, 0.5));
    const double half = 0.5 * piece.thickness;
    // Rounded by one division, which is nearer to a unit vector than piece.along.
    const vec3 along = { to.x / piece.length, to.y / piece.length, 0.0 };
    const vec3 left = { -along.y, along.x, 0.0 };
    const bool is_left = vec2_cross(piece.along, piece.upstream) > 0.0;
    const vec3 across = is_left ? left : vec3_scale(left, -1.0);

    return (body_plate){ .middle = vec3_along((vec3){ middle.x, middle.y, 0.0 }, -half, across),
                         .along = along,
                         .across = across,
                         .half_length = 0.5 * piece.length,
                         .half_thickness = half,
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

/// Join the last two plates, between which the path bends. With the upstream side inside the bend their
/// downstream faces meet at thickness tan(angle / 2) beyond the joint; at bends of more than a right angle
/// the plates are prolonged by their thickness.
static void join_plates(body_state *s, double bend)
{
    const int32_t last = (int32_t)s->n_plates - 1;
    body_plate *before = &s->plates[last - 1], *after = &s->plates[last];
    double cosine = vec3_dot(before->along, after->along);
    double upstream_bend = bend * vec3_cross(before->along, before->across).z;

    before->joined[1] = last;
    after->joined[0] = last - 1;
    before->bend[1] = after->bend[0] = bend;
    if (upstream_bend > 0.0) {
        double half_tangent = cosine > 0.0 ? fabs(bend) / (1.0 + cosine) : 1.0;
        prolong(before, 1, 2.0 * before->half_thickness * half_tangent);
        prolong(after, 0, 2.0 * after->half_thickness * half_tangent);
    }
}

static void make_plates(body_state *s, const scene_obstacle *obstacle)
{
    for (size_t first = 0, last = 1; last < obstacle->n_points; first = last++) {
        while (last + 1 < obstacle->n_points && is_straight(obstacle, last))
            last++;
        s->plates[s->n_plates++] =
            make_plate(s, obstacle, obstacle->path[first], obstacle->path[last]);
        if (first > 0)
            join_plates(s, measure_bend(obstacle, first));
    }
}

/// True if a point is beyond the start (end = 0) or the end (end = 1) of a plate.
static bool is_beyond(const body_plate *plate, int end, double x, double y)
{
    double a = vec3_dot((vec3){ x - plate->middle.x, y - plate->middle.y, 0.0 }, plate->along);

    return end == 0 ? a < -plate->half_length : a > plate->half_length;
}

/// True if a body with its centre at a point on the outer side of a bend has its contact with the plate beyond
/// the joint instead: between the ends of that one, or at the corner, which belongs to the earlier plate.
static bool is_felt_beyond_joint(const body_state *s, const body_plate *plate, double x, double y)
{
    const vec3 to = { x - plate->middle.x, y - plate->middle.y, 0.0 };
    const double left = vec3_cross(plate->along, to).z;

    for (int end = 0; end < 2; end++) {
        if (plate->joined[end] == BODY_NO_PLATE || !is_beyond(plate, end, x, y) ||
            plate->bend[end] * left > 0.0)
            continue;
        if (end == 0 || !is_beyond(&s->plates[plate->joined[end]], 0, x, y))
            return true;
    }
    return false;
}

/// Distance from a point of the plane to a plate, 0 inside.
static double distance_to(const body_plate *plate, double x, double y)
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

/// List the plates that a part with its centre in a cell may touch.
static bf_status map_cell(body_state *s, size_t i, size_t j, size_t *n)
{
    body_map *map = &s->map;
    double x = map->x_min + ((double)i + 0.5) * map->edge;
    double y = map->y_min + ((double)j + 0.5) * map->edge;
    double range = s->map_range + map->edge;

    map->first[j * map->n_x + i] = *n;
    for (size_t k = 0; k < s->n_plates; k++) {
        if (distance_to(&s->plates[k], x, y) > range)
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
    s->plate_memories = memory_alloc(def->n_parts, sizeof *s->plate_memories);
    if (s->plates == NULL || s->plate_memories == NULL)
        return bf_fail(err, BF_ENOMEM, "/obstacles", "no memory for the obstacles");
    for (size_t k = 0; k < def->n_obstacles; k++)
        make_plates(s, &def->obstacles[k]);
    if (make_map(s, &def->domain) != BF_OK)
        return bf_fail(err, BF_ENOMEM, "/obstacles", "no memory for the obstacles");
    return BF_OK;
}

void body__plates_fini(body_state *s)
{
    memory_free(s->plates);
    memory_free(s->plate_memories);
    memory_free(s->map.first);
    memory_free(s->map.plate);
}

/// What body__add_boundary_forces() adds to.
typedef struct boundary_forces {
    const body_state *s;
    body_load *load;
    body_report *report;
} boundary_forces;

/// Add the force on part k in a contact point of a boundary. Returns true if it is not zero.
static bool add_point_force(const body_state *s, size_t k, const micro_law *law, vec3 normal,
                            const manifold_point *point, body_load *load)
{
    const body_body *body = &s->bodies[k];
    vec3 velocity = body__velocity(body, point->at);
    double approach = vec3_dot(velocity, normal);
    double normal_force = body__normal_force(s, law, point->depth, point->weight, approach);

    if (normal_force == 0.0)
        return false;
    vec3 friction =
        body__friction_force(law, normal_force, vec3_along(velocity, -approach, normal));
    body__add_force(load, body, point->at, vec3_along(friction, normal_force, normal));
    return true;
}

/// Add the forces on part k in all points of its contact.
static void add_contact_force(void *context, size_t k, const micro_law *law, uint32_t boundary,
                              const body_contact *contact)
{
    const boundary_forces *forces = context;
    double depth = 0.0;

    (void)boundary;
    for (size_t m = 0; contact->is_closed_form && m < contact->n_points; m++) {
        const body_contact_point *contact_point = &contact->points[m];
        manifold_point point = { contact_point->at, contact_point->depth, contact_point->weight };
        if (add_point_force(forces->s, k, law, contact_point->normal, &point, forces->load))
            depth = fmax(depth, point.depth);
    }
    for (size_t m = 0; !contact->is_closed_form && m < contact->hull.n; m++)
        if (add_point_force(forces->s, k, law, contact->hull.normal, &contact->hull.point[m],
                            forces->load))
            depth = contact->hull.depth;
    if (depth > 0.0)
        body__note(forces->report, depth, forces->s->kinds[forces->s->bodies[k].kind].radius);
}

/// Find the contact with the side of a plate that a body is on. Returns false if the contact is elsewhere.
static bool find_at_side(const body_state *s, const body_body *body, const body_plate *plate,
                         double margin, manifold *m)
{
    vec3 to = vec3_sub(body->x, plate->middle);
    double a = vec3_dot(to, plate->along), c = vec3_dot(to, plate->across);
    manifold_plane side = { .normal = vec3_scale(plate->across, c < 0.0 ? -1.0 : 1.0),
                            .half_length = plate->half_length,
                            .along = plate->along,
                            .middle = plate->middle };

    if (fabs(a) > plate->half_length)
        return false;
    side.offset = vec3_dot(side.normal, plate->middle) + plate->half_thickness;
    manifold_on_plane(&s->kinds[body->kind].shape, body->x, &body->r, &side, margin, m);
    return m->depth <= -margin || m->is_least;
}

/// The contact with a plate as a cuboid, in the world's frame. Returns false if there is none.
static bool find_at_cuboid(const body_state *s, const body_body *body, const body_plate *plate,
                           double margin, body_memory *memory, manifold *m)
{
    double a = plate->half_length, c = plate->half_thickness;
    double half_height = CUBOID_HALF_HEIGHT * s->kinds[body->kind].shape.radius;
    const vec2 outline[] = { { -a, -c }, { a, -c }, { a, c }, { -a, c } };
    mat3 axes = { { { plate->along.x, -plate->along.y, 0.0 },
                    { plate->along.y, plate->along.x, 0.0 },
                    { 0.0, 0.0, 1.0 } } };
    vec3 origin = { plate->middle.x, plate->middle.y, body->x.z };
    hull cuboid;

    hull_from_outline(outline, 4, -half_height, half_height, &cuboid);
    gjk_pair pair =
        gjk_pair_of(&cuboid, origin, &axes, &s->kinds[body->kind].shape, body->x, &body->r);
    if (!body__find_manifold(&pair, margin, memory, m))
        return false;
    m->normal = mat3_apply(&axes, m->normal);
    for (size_t k = 0; k < m->n; k++)
        m->point[k].at = vec3_add(mat3_apply(&axes, m->point[k].at), origin);
    return true;
}

/// The slot of a plate among those of a part, or a free one; NULL if all are taken.
static body_plate_memory *find_memory_slot(body_plate_memory *slots, uint32_t plate)
{
    for (size_t k = 0; k < BODY_PLATE_MEMORIES; k++)
        if (slots[k].plate == plate + 1)
            return &slots[k];
    for (size_t k = 0; k < BODY_PLATE_MEMORIES; k++)
        if (slots[k].plate == 0)
            return &slots[k];
    return NULL;
}

static void clear_memory_slot(body_plate_memory *slots, uint32_t plate)
{
    for (size_t k = 0; k < BODY_PLATE_MEMORIES; k++)
        if (slots[k].plate == plate + 1)
            slots[k] = (body_plate_memory){ 0 };
}

/// Returns false if part k is not near the plate.
static bool find_at_plate(body_state *s, size_t k, uint32_t id, double margin,
                          body_contact *contact)
{
    const body_body *body = &s->bodies[k];
    const body_plate *plate = &s->plates[id];
    body_memory passing = { 0 };

    contact->is_closed_form = false;
    if (distance_to(plate, body->x.x, body->x.y) >= s->bounding_radius[k] + margin ||
        is_felt_beyond_joint(s, plate, body->x.x, body->x.y)) {
        clear_memory_slot(s->plate_memories[k], id);
        return false;
    }
    contact->is_closed_form =
        body__find_cylinder_at_plate(s, body, plate, margin, contact->points, &contact->n_points);
    if (contact->is_closed_form || find_at_side(s, body, plate, margin, &contact->hull)) {
        clear_memory_slot(s->plate_memories[k], id);
        return true;
    }
    body_plate_memory *slot = find_memory_slot(s->plate_memories[k], id);
    if (slot != NULL)
        slot->plate = id + 1;
    return find_at_cuboid(s, body, plate, margin, slot != NULL ? &slot->memory : &passing,
                          &contact->hull);
}

static void visit_plates(body_state *s, size_t k, double margin, body_visit *visit, void *context)
{
    const body_map *map = &s->map;
    const micro_law *law = &s->kinds[s->bodies[k].kind].boundary_law;
    body_contact contact;

    if (s->n_plates == 0)
        return;
    size_t i = find_cell(s->bodies[k].x.x, map->x_min, map->edge, map->n_x);
    size_t j = find_cell(s->bodies[k].x.y, map->y_min, map->edge, map->n_y);
    size_t cell = j * map->n_x + i;
    for (size_t at = map->first[cell]; at < map->first[cell + 1]; at++)
        if (find_at_plate(s, k, map->plate[at], margin, &contact))
            visit(context, k, law, SCENE_SIDE_COUNT + map->plate[at], &contact);
}

/// The wall on a side of the domain.
static manifold_plane wall_of(const surroundings *around, int side)
{
    const surroundings_line line = surroundings_side(around, (scene_side)side);

    return (manifold_plane){ .normal = { line.inward.x, line.inward.y, 0.0 },
                             .offset = vec2_dot(line.inward, line.at) };
}

/// True if the bounding sphere of part k is nearer to a plane than `margin`.
static bool is_near_plane(const body_state *s, size_t k, const manifold_plane *plane, double margin)
{
    return vec3_dot(plane->normal, s->bodies[k].x) - plane->offset < s->bounding_radius[k] + margin;
}

static void visit_walls(const body_state *s, size_t k, double margin, body_visit *visit,
                        void *context)
{
    const body_body *body = &s->bodies[k];
    micro_law law = s->kinds[body->kind].boundary_law;
    body_contact contact;

    law.friction = 0.0; // walls slip freely
    for (int side = 0; side < SCENE_SIDE_COUNT; side++) {
        if (s->around.edges[side] != SCENE_EDGE_WALL)
            continue;
        manifold_plane wall = wall_of(&s->around, side);
        if (!is_near_plane(s, k, &wall, margin))
            continue;
        body__find_at_plane(s, body, &wall, margin, &contact);
        visit(context, k, &law, (uint32_t)side, &contact);
    }
}

void body__visit_boundaries(body_state *s, size_t k, double margin, body_visit *visit,
                            void *context)
{
    visit_plates(s, k, margin, visit, context);
    visit_walls(s, k, margin, visit, context);
}

size_t body__count_boundaries(const body_state *s, size_t k, double range)
{
    const body_map *map = &s->map;
    const vec3 x = s->bodies[k].x;
    size_t n = 0;

    for (int side = 0; side < SCENE_SIDE_COUNT; side++) {
        manifold_plane wall = wall_of(&s->around, side);
        n += s->around.edges[side] == SCENE_EDGE_WALL && is_near_plane(s, k, &wall, range);
    }
    if (s->n_plates == 0)
        return n;
    size_t i = find_cell(x.x, map->x_min, map->edge, map->n_x);
    size_t j = find_cell(x.y, map->y_min, map->edge, map->n_y);
    size_t cell = j * map->n_x + i;
    for (size_t at = map->first[cell]; at < map->first[cell + 1]; at++)
        n += distance_to(&s->plates[map->plate[at]], x.x, x.y) < s->bounding_radius[k] + range;
    return n;
}

void body__add_boundary_forces(body_state *s, size_t k, body_load *load, body_report *report)
{
    boundary_forces forces = { s, load, report };

    body__visit_boundaries(s, k, 0.0, add_contact_force, &forces);
}
