#include "core/scene/shape.h"

#include "core/base/polygon.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/// Largest ratio of the disk about a part's origin to its footprint: with more, far too many parts
/// fit into one cell of the search for overlaps.
#define SLENDER_MAX 1000.0

/// Relative to the size of the shape: nearer corners are one, and an outline with less area is flat.
#define FLAT 1e-9

/// The same for the volume of a hull, which must be well above the tolerance FLAT.
#define HULL_FLAT 1e-6

typedef struct vector {
    double x, y, z;
} vector;

static vector vector_between(const double from[3], const double to[3])
{
    return (vector){ to[0] - from[0], to[1] - from[1], to[2] - from[2] };
}

static vector vector_cross(vector a, vector b)
{
    return (vector){ a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x };
}

static double vector_dot(vector a, vector b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static vector vector_unit(vector a)
{
    double length = sqrt(vector_dot(a, a));
    return (vector){ a.x / length, a.y / length, a.z / length };
}

/// Largest side of the box around the vertices.
static double measure_extent(const scene_shape *shape, int n_axes)
{
    double extent = 0.0;

    for (int axis = 0; axis < n_axes; axis++) {
        double low = INFINITY, high = -INFINITY;
        for (size_t k = 0; k < shape->n_vertices; k++) {
            low = fmin(low, shape->vertices[k][axis]);
            high = fmax(high, shape->vertices[k][axis]);
        }
        extent = fmax(extent, high - low);
    }
    return extent;
}

static void copy_outline(const scene_shape *shape, vec2 *ret_points)
{
    for (size_t k = 0; k < shape->n_vertices; k++)
        ret_points[k] = (vec2){ shape->vertices[k][0], shape->vertices[k][1] };
}

shape_footprint shape_footprint_of(const scene_shape *shape)
{
    shape_footprint f = { .n_corners = 0 };
    vec2 points[SCENE_VERTICES_MAX];
    double x = 0.5 * shape->length, y = 0.5 * shape->width;

    switch (shape->type) {
    case SCENE_BOX:
        f.n_corners = 4;
        memcpy(f.corners, (vec2[]){ { -x, -y }, { x, -y }, { x, y }, { -x, y } },
               4 * sizeof *f.corners);
        break;
    case SCENE_PRISM:
        f.n_corners = shape->n_vertices;
        copy_outline(shape, f.corners);
        break;
    case SCENE_HULL:
        copy_outline(shape, points);
        f.n_corners = polygon_convex_hull(points, shape->n_vertices, f.corners);
        break;
    default:
        f.bounding_radius = shape->radius;
        f.area = M_PI * shape->radius * shape->radius;
        return f;
    }
    f.area = polygon_area(f.corners, f.n_corners);
    for (size_t k = 0; k < f.n_corners; k++)
        f.bounding_radius = fmax(f.bounding_radius, vec2_length(f.corners[k]));
    return f;
}

static vec2 find_centre(const shape_footprint *f)
{
    vec2 sum = { 0.0, 0.0 };

    // Triangles with the first corner, by their areas.
    for (size_t k = 1; k + 1 < f->n_corners; k++) {
        const vec2 a = vec2_sub(f->corners[k], f->corners[0]);
        const vec2 b = vec2_sub(f->corners[k + 1], f->corners[0]);
        sum = vec2_add(sum, vec2_scale(vec2_add(a, b), vec2_cross(a, b) / 6.0));
    }
    return vec2_add(f->corners[0], vec2_scale(sum, 1.0 / f->area));
}

double shape_inner_radius(const scene_shape *shape)
{
    const shape_footprint f = shape_footprint_of(shape);
    double least = INFINITY;

    if (f.n_corners == 0)
        return f.bounding_radius;
    const vec2 centre = find_centre(&f);
    for (size_t k = 0; k < f.n_corners; k++)
        least = fmin(least, polygon_segment_distance(centre, f.corners[k],
                                                     f.corners[(k + 1) % f.n_corners]));
    return least;
}

/// Six times the volume of the cone from apex over the facet in the plane of three vertices, given
/// by its unit normal: the facet is the hull of all the vertices that are marked to lie in it.
static double measure_cone(const scene_shape *shape, const bool *is_in_plane, size_t first,
                           size_t second, vector normal, const double apex[3])
{
    vec2 points[SCENE_VERTICES_MAX], hull[SCENE_VERTICES_MAX + 1];
    vector u = vector_unit(vector_between(shape->vertices[first], shape->vertices[second]));
    vector v = vector_cross(normal, u);
    size_t n = 0;

    for (size_t k = 0; k < shape->n_vertices; k++) {
        vector to = vector_between(shape->vertices[first], shape->vertices[k]);
        if (is_in_plane[k])
            points[n++] = (vec2){ vector_dot(to, u), vector_dot(to, v) };
    }
    size_t n_hull = polygon_convex_hull(points, n, hull);
    double height = fabs(vector_dot(normal, vector_between(apex, shape->vertices[first])));
    return 2.0 * polygon_area(hull, n_hull) * height;
}

/// True if the plane of vertices i < j < k has all the others on one side, and they are the first
/// three of it that are not on one line, so that every facet is found once. Marks its vertices.
static bool is_facet(const scene_shape *shape, const size_t corner[3], double tolerance,
                     bool *ret_is_in_plane, vector *ret_normal)
{
    const double(*at)[3] = (const double(*)[3])shape->vertices;
    vector along = vector_unit(vector_between(at[corner[0]], at[corner[1]]));
    vector across = vector_cross(along, vector_between(at[corner[0]], at[corner[2]]));
    bool has_above = false, has_below = false;

    if (!(sqrt(vector_dot(across, across)) > tolerance))
        return false;
    vector normal = vector_unit(across);
    for (size_t m = 0; m < shape->n_vertices; m++) {
        vector to = vector_between(at[corner[0]], at[m]);
        double height = vector_dot(normal, to);
        ret_is_in_plane[m] = fabs(height) <= tolerance;
        has_above |= height > tolerance;
        has_below |= height < -tolerance;
        if (has_above && has_below)
            return false;
        if (!ret_is_in_plane[m])
            continue;
        vector aside = vector_cross(along, to);
        bool is_off_line = sqrt(vector_dot(aside, aside)) > tolerance;
        if (m < corner[0] || (m < corner[1] && m != corner[0]) || (m < corner[2] && is_off_line))
            return false;
    }
    *ret_normal = normal;
    return has_above != has_below;
}

static double measure_hull(const scene_shape *shape)
{
    double tolerance = FLAT * measure_extent(shape, 3), sixfold = 0.0;
    bool is_in_plane[SCENE_VERTICES_MAX];
    vector normal;
    size_t n = shape->n_vertices;

    for (size_t i = 0; i < n; i++) {
        for (size_t j = i + 1; j < n; j++) {
            for (size_t k = j + 1; k < n; k++) {
                if (is_facet(shape, (size_t[]){ i, j, k }, tolerance, is_in_plane, &normal))
                    sixfold += measure_cone(shape, is_in_plane, i, j, normal, shape->vertices[0]);
            }
        }
    }
    return sixfold / 6.0;
}

double shape_volume(const scene_shape *shape)
{
    if (shape->type == SCENE_HULL)
        return measure_hull(shape);
    return shape_footprint_of(shape).area * shape->height;
}

double shape_packing_density(const scene_shape *shape)
{
    if (shape->type == SCENE_CYLINDER)
        return 1.0 / (2.0 * sqrt(3.0) * shape->radius * shape->radius);
    if (shape->type == SCENE_BOX)
        return 1.0 / (shape->length * shape->width);
    return M_PI / (2.0 * sqrt(3.0)) / shape_footprint_of(shape).area;
}

/// A shape that is being checked, and its list of faults.
typedef struct checking {
    const scene_shape *shape;
    const char *pointer; ///< of the shape
    bf_faults *faults;
} checking;

/// The pointer of a member of the shape.
static const char *point_at(const checking *c, const char *member, char *room, size_t size)
{
    snprintf(room, size, "%s/%s", c->pointer, member);
    return room;
}

static void check_length(const checking *c, double value, const char *member)
{
    char at[BF_POINTER_SIZE];

    if (!(value >= SCENE_LENGTH_MIN && value <= SCENE_LENGTH_MAX))
        faults_add(c->faults, point_at(c, member, at, sizeof at),
                   "must be a length from %g to %g m, not %g", SCENE_LENGTH_MIN, SCENE_LENGTH_MAX,
                   value);
}

static void check_repeats(const checking *c, const char *pointer, int n_axes)
{
    const scene_shape *shape = c->shape;
    double least = FLAT * measure_extent(shape, n_axes);
    char at[BF_POINTER_SIZE];

    for (size_t k = 1; k < shape->n_vertices; k++) {
        for (size_t m = 0; m < k; m++) {
            vector to = vector_between(shape->vertices[m], shape->vertices[k]);
            if (n_axes == 2)
                to.z = 0.0;
            if (!(sqrt(vector_dot(to, to)) > least)) {
                snprintf(at, sizeof at, "%.100s/%zu", pointer, k);
                faults_add(c->faults, at, "repeats point %zu", m);
                break;
            }
        }
    }
}

/// Note too few or too many vertices, ones that are no numbers and ones that are given twice.
/// Returns true if there are none of them.
static bool check_vertices(const checking *c, const char *pointer, int n_axes, size_t n_min)
{
    size_t n_before = c->faults->n, n = c->shape->n_vertices;

    if (n < n_min || n > SCENE_VERTICES_MAX)
        faults_add(c->faults, pointer, "must have %zu to %d points, not %zu", n_min,
                   SCENE_VERTICES_MAX, n);
    if (c->faults->n == n_before) {
        char at[BF_POINTER_SIZE];
        for (size_t k = 0; k < c->shape->n_vertices; k++) {
            bool is_good = true;
            for (int axis = 0; axis < n_axes; axis++)
                is_good = is_good && fabs(c->shape->vertices[k][axis]) <= SCENE_LENGTH_MAX;
            snprintf(at, sizeof at, "%.100s/%zu", pointer, k);
            if (!is_good)
                faults_add(c->faults, at, "must be numbers within %g m", SCENE_LENGTH_MAX);
        }
    }
    if (c->faults->n == n_before)
        check_repeats(c, pointer, n_axes);
    return c->faults->n == n_before;
}

static void check_prism(const checking *c)
{
    const scene_shape *shape = c->shape;
    vec2 outline[SCENE_VERTICES_MAX];
    char room[BF_POINTER_SIZE];
    const char *pointer = point_at(c, "outline_m", room, sizeof room);

    if (!check_vertices(c, pointer, 2, 3))
        return;
    copy_outline(shape, outline);
    double extent = measure_extent(shape, 2);
    double area = polygon_area(outline, shape->n_vertices);
    if (!(fabs(area) > FLAT * extent * extent))
        faults_add(c->faults, pointer, "encloses no area");
    else if (area < 0.0)
        faults_add(c->faults, pointer, "must run counter-clockwise");
    else if (!polygon_is_convex(outline, shape->n_vertices, FLAT * extent))
        faults_add(c->faults, pointer, "must be convex");
}

static void check_hull(const checking *c)
{
    char room[BF_POINTER_SIZE];
    const char *pointer = point_at(c, "vertices_m", room, sizeof room);

    if (!check_vertices(c, pointer, 3, 4))
        return;
    double extent = measure_extent(c->shape, 3);
    if (!(measure_hull(c->shape) > HULL_FLAT * extent * extent * extent))
        faults_add(c->faults, pointer, "is degenerate: the points enclose no volume");
}

/// Note a footprint that is too small, or too small for its radius about the origin.
static void check_footprint(const checking *c)
{
    char room[BF_POINTER_SIZE];
    const char *pointer =
        c->shape->type == SCENE_PRISM  ? point_at(c, "outline_m", room, sizeof room)
        : c->shape->type == SCENE_HULL ? point_at(c, "vertices_m", room, sizeof room)
                                       : c->pointer;
    shape_footprint f = shape_footprint_of(c->shape);
    double ratio = M_PI * f.bounding_radius * f.bounding_radius / f.area;

    if (f.area < SCENE_LENGTH_MIN * SCENE_LENGTH_MIN)
        faults_add(c->faults, pointer, "is too small: %g m2 seen from above", f.area);
    else if (!(ratio <= SLENDER_MAX))
        faults_add_limit(c->faults, pointer,
                         "is too slender or too far from its origin: the disk about the origin "
                         "has %g times its area, the limit is %g",
                         ratio, SLENDER_MAX);
}

void shape_check(const scene_shape *shape, const char *pointer, bf_faults *faults)
{
    const checking c = { shape, pointer, faults };
    char at[BF_POINTER_SIZE];
    size_t n_before = faults->n;

    switch (shape->type) {
    case SCENE_CYLINDER:
        check_length(&c, shape->radius, "radius_m");
        break;
    case SCENE_BOX:
        check_length(&c, shape->length, "length_m");
        check_length(&c, shape->width, "width_m");
        break;
    case SCENE_PRISM:
        check_prism(&c);
        break;
    case SCENE_HULL:
        check_hull(&c);
        break;
    default:
        faults_add(faults, point_at(&c, "type", at, sizeof at), "is not a type of shape");
        return;
    }
    if (shape->type != SCENE_HULL)
        check_length(&c, shape->height, "height_m");
    if (faults->n == n_before)
        check_footprint(&c);
}

bool shape_is_sound(const scene_shape *shape)
{
    bf_faults faults = { 0 };

    shape_check(shape, "", &faults);
    return faults.n == 0;
}

vec2 shape_direction(double heading)
{
    return (vec2){ cos(heading), sin(heading) };
}

void shape_place_along(const shape_footprint *footprint, vec2 centre, vec2 u, vec2 *ret_corners)
{
    const vec2 v = vec2_turn_left(u);

    for (size_t k = 0; k < footprint->n_corners; k++) {
        vec2 corner = footprint->corners[k];
        ret_corners[k] =
            vec2_add(centre, vec2_add(vec2_scale(u, corner.x), vec2_scale(v, corner.y)));
    }
}

void shape_place(const shape_footprint *footprint, scene_pose pose, vec2 *ret_corners)
{
    shape_place_along(footprint, (vec2){ pose.x, pose.y }, shape_direction(pose.heading),
                      ret_corners);
}

bool shape_overlaps_polygon(const shape_footprint *footprint, scene_pose pose, const vec2 *corners,
                            size_t n)
{
    vec2 own[SCENE_VERTICES_MAX + 1];

    if (footprint->n_corners == 0)
        return polygon_overlaps_disk((vec2){ pose.x, pose.y }, footprint->bounding_radius, corners,
                                     n, SCENE_TOLERANCE);
    shape_place(footprint, pose, own);
    return polygon_overlaps(own, footprint->n_corners, corners, n, SCENE_TOLERANCE);
}

bool shape_overlaps(const shape_footprint *of_a, scene_pose a, const shape_footprint *of_b,
                    scene_pose b)
{
    vec2 corners[SCENE_VERTICES_MAX + 1];
    const double distance = vec2_length((vec2){ b.x - a.x, b.y - a.y });

    if (distance >= of_a->bounding_radius + of_b->bounding_radius - SCENE_TOLERANCE)
        return false;
    if (of_a->n_corners == 0 && of_b->n_corners == 0)
        return true;
    if (of_b->n_corners == 0)
        return shape_overlaps(of_b, b, of_a, a);
    shape_place(of_b, b, corners);
    return shape_overlaps_polygon(of_a, a, corners, of_b->n_corners);
}

double shape_extent(const shape_footprint *footprint, double heading, vec2 direction)
{
    vec2 corners[SCENE_VERTICES_MAX + 1];
    double most = 0.0;

    if (footprint->n_corners == 0)
        return footprint->bounding_radius;
    shape_place(footprint, (scene_pose){ 0.0, 0.0, heading }, corners);
    for (size_t k = 0; k < footprint->n_corners; k++)
        most = fmax(most, vec2_dot(corners[k], direction));
    return most;
}
