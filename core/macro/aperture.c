#include "core/macro/aperture.h"

#include "core/base/polygon.h"
#include "core/scene/belt_slope.h"
#include "core/scene/mix.h"
#include "core/scene/surroundings.h"

#include <math.h>

// What a side of an outlet costs, in radii of a part, by the angle of the plate and by frictions, see aperture.h.
typedef struct side_law {
    double angle;    // times c
    double cargo;    // times sqrt(mu_c) - sqrt(0.15)
    double handling; // times sqrt(mu_h) - sqrt(0.19)
} side_law;

// Fitted to the microscopic model.
static const side_law end_law = { 1.2, 2.0, 0.4 };
static const side_law wall_law = { 0.9, 0.7, 0.4 };
static const side_law lane_law = { 0.5, 0.95, 0.63 };
static const double fitted_cargo = 0.15;    // mu_c at which friction adds nothing
static const double fitted_handling = 0.19; // mu_h, same
static const double arch_length = 10.0;     // s of aperture.h, times e r
static const double arch_slope = 2.5;       // times cos^2(theta)
static const double arch_slope_most = 0.5;  // of cos^2(theta), its value at 45 degrees
static const double most_gained = 2.0;      // f by cos^4(theta)
static const double acceleration = 0.9;     // of v_T^2/(mu_b g) by the width of the outlet
static const double shallow = 4.0;          // times sin(theta): w of aperture.h
static const double most_of_way = 0.9;      // that an extension takes
static const double along_belt = 0.05; // sin(theta) of a guide that runs along the belt, at most
static const double least_bend = 0.1;  // of what bends into it, at least; chords of arcs have less

// The end of a plate, or its bend into a lane, and how it goes on.
typedef struct plate_end {
    vec2 tip;       // m
    vec2 outward;   // unit tangent of the plate's last piece, away from the plate
    vec2 extension; // to where it goes on from the tip, m
    bool is_bend;   // the plate goes on along the belt
} plate_end;

// What is opposite of a plate's end across the belt.
typedef enum opposite_kind {
    OPPOSITE_NOTHING, // an open border of the domain
    OPPOSITE_WALL,    // of the domain
    OPPOSITE_SIDE,    // a guide, the side of a plate
    OPPOSITE_END,     // of another plate
} opposite_kind;

typedef struct opposite {
    opposite_kind kind;
    double way;      // to it, m
    double friction; // mu_h of an OPPOSITE_WALL or OPPOSITE_SIDE
} opposite;

double aperture_radius(const scene *s)
{
    return sqrt(scene_mean_footprint(s) / M_PI);
}

// True if nothing closes the space beside a plate's end: no wall and no other plate is nearer than a part's radius.
static bool is_free(const scene *s, const surroundings *around, size_t obstacle, vec2 tip)
{
    const double near = aperture_radius(s);

    for (int side = 0; side < SCENE_SIDE_COUNT; side++)
        if (s->edges[side] == SCENE_EDGE_WALL &&
            fabs(surroundings_excess(around, (scene_side)side, tip)) < near)
            return false;
    for (size_t k = 0; k < s->n_obstacles; k++)
        for (size_t m = 0; k != obstacle && m + 1 < s->obstacles[k].n_points; m++)
            if (polygon_segment_distance(tip, s->obstacles[k].path[m],
                                         s->obstacles[k].path[m + 1]) < near)
                return false;
    return true;
}

// How far a segment is from a point in a unit direction, m; INFINITY if it does not lie there.
static double way_to_segment(vec2 at, vec2 toward, vec2 start, vec2 end)
{
    const vec2 to = vec2_sub(start, at), along = vec2_sub(end, start);
    const double across = vec2_cross(toward, along);
    const double part = vec2_cross(to, toward) / across, way = vec2_cross(to, along) / across;

    return part >= 0.0 && part <= 1.0 && way > 0.0 ? way : INFINITY;
}

// Another plate's end counts within 45 degrees of the direction, so that a funnel's need not be exactly opposite. One at a wall is
// that wall: no stream comes around it.
static opposite find_opposite(const scene *s, const surroundings *around, size_t obstacle, vec2 tip,
                              vec2 toward)
{
    const double handling = s->micro.contact[SCENE_HANDLING_CARGO].friction;
    const scene_rect *d = &s->domain;
    opposite found = { OPPOSITE_NOTHING, d->x_max - d->x_min + d->y_max - d->y_min, 0.0 };

    for (int side = 0; side < SCENE_SIDE_COUNT; side++) {
        const vec2 inward = surroundings_side(around, (scene_side)side).inward;
        const double way =
            surroundings_excess(around, (scene_side)side, tip) / vec2_dot(toward, inward);
        if (way > 0.0 && way < found.way)
            found =
                (opposite){ s->edges[side] == SCENE_EDGE_WALL ? OPPOSITE_WALL : OPPOSITE_NOTHING,
                            way, s->micro.wall_friction };
    }
    for (size_t k = 0; k < s->n_obstacles; k++) {
        const scene_obstacle *o = &s->obstacles[k];
        for (size_t m = 0; k != obstacle && m + 1 < o->n_points; m++) {
            const double way = way_to_segment(tip, toward, o->path[m], o->path[m + 1]);
            if (way < found.way)
                found = (opposite){ OPPOSITE_SIDE, way, handling };
        }
    }
    for (size_t k = 0; k < s->n_obstacles; k++) {
        const scene_obstacle *o = &s->obstacles[k];
        const vec2 ends[2] = { o->path[0], o->path[o->n_points - 1] };
        for (int end = 0; k != obstacle && end < 2; end++) {
            const vec2 to = vec2_sub(ends[end], tip);
            const double way = vec2_dot(to, toward);
            if (way > M_SQRT1_2 * vec2_length(to) && way <= found.way + SCENE_LENGTH_MIN &&
                is_free(s, around, k, ends[end]))
                found = (opposite){ OPPOSITE_END, way, 0.0 };
        }
    }
    return found;
}

// c of aperture.h: by how much of a radius a plate holds off what leaves it; in a funnel another one pushes.
static double turning(double sine, const scene *s, bool is_in_funnel)
{
    const double square = sine * sine, along = (1.0 - square) * (1.0 - square);
    const double pushed = is_in_funnel ? fmax(1.0 - 2.0 * mix_angularity(s), 0.0) : 0.0;

    return square * (1.0 - pushed * fmin(most_gained * along, 1.0));
}

static double cost_of(const side_law *law, double turned, const scene *s, double handling)
{
    const double cargo = s->micro.contact[SCENE_CARGO_CARGO].friction;

    return law->angle * turned + law->cargo * (sqrt(cargo) - sqrt(fitted_cargo)) +
           law->handling * (sqrt(handling) - sqrt(fitted_handling));
}

// The fraction of an outlet that arches of parts with corners leave open; span is its width, m, sine that of the plate's angle.
static double fraction_without_arches(const scene *s, double span, double sine)
{
    const double friction = s->micro.contact[SCENE_CARGO_CARGO].friction;
    const double length = arch_length * aperture_radius(s) * mix_angularity(s) *
                          sqrt(friction / fitted_cargo) *
                          (1.0 + arch_slope * fmin(1.0 - sine * sine, arch_slope_most));

    return length > 0.0 ? -expm1(-span / length) : 1.0;
}

// How a plate goes on beyond its end.
static vec2 extension_of(const scene *s, const surroundings *around, size_t obstacle,
                         const plate_end *e, size_t under, vec2 belt)
{
    const double speed = vec2_length(belt);
    const scene_micro *parts = &s->micro;
    const scene_contact *conveyor = &parts->contact[SCENE_CONVEYOR_CARGO];

    if (speed == 0.0)
        return (vec2){ 0.0, 0.0 };
    const vec2 across = vec2_scale(vec2_turn_left(belt), 1.0 / speed);
    const double sine = vec2_dot(e->outward, across);
    const vec2 toward = vec2_scale(across, sine < 0.0 ? -1.0 : 1.0);
    const opposite other = find_opposite(s, around, obstacle, e->tip, toward);
    const double handling = parts->contact[SCENE_HANDLING_CARGO].friction;
    const double drive = belt_slope_drive(&around->belts[under], conveyor);
    const double stopping = speed * speed / (drive * parts->gravity);
    const bool is_beside = other.kind == OPPOSITE_WALL || other.kind == OPPOSITE_SIDE;
    const double turned = turning(sine, s, !e->is_bend && other.kind == OPPOSITE_END);
    double radii = 0.0;

    if (e->is_bend && other.kind == OPPOSITE_NOTHING)
        return (vec2){ 0.0, 0.0 };
    if (e->is_bend)
        radii = cost_of(&lane_law, turned, s, handling) +
                (other.kind == OPPOSITE_WALL ? cost_of(&lane_law, 0.0, s, other.friction) : 0.0);
    else
        radii = cost_of(&end_law, turned, s, handling) +
                (is_beside ? cost_of(&wall_law, turned, s, other.friction) : 0.0);
    // Of two ends, and of two guides, each has its half of the outlet.
    const bool is_half = other.kind == OPPOSITE_END || (e->is_bend && other.kind == OPPOSITE_SIDE);
    const double ends = is_half ? 2.0 : 1.0, way = other.way / ends;
    const double radius = aperture_radius(s), wide = fmax(way - radii * radius, 0.0);
    // An arch stands on both sides of an outlet.
    const double open =
        wide *
        (other.kind == OPPOSITE_NOTHING ? 1.0 : fraction_without_arches(s, ends * wide, sine));
    // What comes along a plate to its bend has v_T cos^2(theta) along the belt already.
    const double gained = e->is_bend ? sine * sine * (2.0 - sine * sine) : 1.0;
    const double slowing = other.kind == OPPOSITE_NOTHING ? 0.0
                                                          : acceleration * gained * stopping /
                                                                open * sqrt(2.0 * radius / open);
    const double length = fmin(1.0, shallow * fabs(sine)) * (way - open / sqrt(1.0 + slowing));
    return vec2_scale(toward, fmax(fmin(length, most_of_way * way), 0.0));
}

// One axis of the grid: its faces, cells along their normal (m, faces 0 .. n_normal) and beside each other.
typedef struct face_axis {
    velocity_field *field;
    int axis;           // of the normal
    double edge_normal; // of a cell
    double edge_beside;
    double lower_normal;
    double lower_beside;
    ptrdiff_t n_normal;
    ptrdiff_t n_beside;
} face_axis;

static size_t index_of(const face_axis *x, ptrdiff_t normal, ptrdiff_t beside)
{
    const ptrdiff_t n1 = (ptrdiff_t)x->field->grid.n1;

    return (size_t)(x->axis == 0 ? beside * (n1 + 1) + normal : normal * n1 + beside);
}

static double normal_of(const face_axis *x, vec2 v)
{
    return x->axis == 0 ? v.x : v.y;
}

static double beside_of(const face_axis *x, vec2 v)
{
    return x->axis == 0 ? v.y : v.x;
}

// The face nearest to a place on the normal's axis, m, as far as there is one.
static ptrdiff_t nearest_face(const face_axis *x, double normal)
{
    const double face = round((normal - x->lower_normal) / x->edge_normal);

    return (ptrdiff_t)fmin(fmax(face, 0.0), (double)x->n_normal);
}

// The face of a strip of cells that the plate closes next to its end; the nearest one to the end if there is none.
static ptrdiff_t closed_face(const face_axis *x, const plate_end *e, ptrdiff_t strip)
{
    const uint8_t *closed = x->field->faces[x->axis].closed;
    const double steep = fmax(fabs(beside_of(x, e->outward)), 1e-3);
    const double rise = fabs(normal_of(x, e->outward)) / steep; // from strip to strip
    const ptrdiff_t most = 1 + (ptrdiff_t)ceil(rise * (x->edge_beside / x->edge_normal));
    const ptrdiff_t nearest = nearest_face(x, normal_of(x, e->tip));
    const ptrdiff_t back = normal_of(x, e->outward) > 0.0 ? -1 : 1;

    for (ptrdiff_t k = -1; k <= most; k++) {
        const ptrdiff_t face = nearest + back * k;
        if (face >= 0 && face <= x->n_normal && closed[index_of(x, face, strip)] != 0)
            return face;
    }
    return nearest;
}

// What is covered of the strip with a plate's end, of which the extension covers a part; lengths in strips.
static double covered_at_tip(double tip, double strip, double length, double extension,
                             bool goes_on)
{
    const double behind = length > 0.0 ? tip - strip : strip + 1.0 - tip;

    // What the plate covers, which it reaches from the other side.
    if (goes_on)
        return fmax(extension, 0.0) + behind;
    // It comes from where the extension goes. Faces are closed where the two enclose the centre.
    if (behind > 0.5)
        return 0.0;
    return fabs(length) < 0.5 - behind ? extension : 1.0;
}

// The strips of cells that the end of a plate and its extension lie in. Faces are closed where the line through plate and
// extension crosses the links between centres, so that no face is left open between those of both axes.
static void cover_strips(const face_axis *x, const plate_end *e)
{
    const velocity_field_faces *faces = &x->field->faces[x->axis];
    const double tip = (beside_of(x, e->tip) - x->lower_beside) / x->edge_beside;
    const double length = beside_of(x, e->extension) / x->edge_beside;
    const double low = fmin(tip, tip + length), high = fmax(tip, tip + length);
    const double tip_strip = floor(tip - (length < 0.0 ? 1e-9 : -1e-9));
    const bool goes_on = beside_of(x, e->outward) * length > 0.0;

    if (fabs(length) < 1e-9)
        return;
    for (double strip = fmin(floor(low), tip_strip); strip <= fmax(floor(high), tip_strip);
         strip++) {
        const bool is_tip = strip == tip_strip;
        const ptrdiff_t m = (ptrdiff_t)strip;
        const double extension = fmin(strip + 1.0, high) - fmax(strip, low);
        const double covered =
            is_tip ? covered_at_tip(tip, strip, length, extension, goes_on) : extension;
        if (m < 0 || m >= x->n_beside || covered <= 1e-9)
            continue;
        const double centre = fmin(fmax(strip + 0.5, low), high);
        const double normal =
            normal_of(x, e->tip) + (centre - tip) / length * normal_of(x, e->extension);
        const bool is_plates =
            !e->is_bend && is_tip && goes_on && (strip + 0.5 - tip) * length <= 1e-6;
        if (e->is_bend && (strip + 0.5 - tip) * length < -1e-6) // on the other side of the guide
            continue;
        const size_t at =
            index_of(x, is_plates ? closed_face(x, e, m) : nearest_face(x, normal), m);
        if (faces->closed[at] != 0 && !(is_tip && goes_on))
            continue;
        faces->aperture[at] = fmin(faces->aperture[at], 1.0 - fmin(covered, 1.0));
        faces->closed[at] = faces->aperture[at] == 0.0;
    }
}

// Whether a plate that comes to its point `last` from `before` runs along the belt and an axis of the grid from there, and
// downstream: the mouth of a lane.
static bool is_mouth(const scene_obstacle *obstacle, size_t last, size_t before, vec2 belt)
{
    const vec2 come = vec2_sub(obstacle->path[last], obstacle->path[before]);
    const vec2 go = vec2_sub(obstacle->path[2 * last - before], obstacle->path[last]);
    const double of_go = vec2_length(belt) * vec2_length(go);
    const double of_come = vec2_length(belt) * vec2_length(come);

    return fmin(fabs(go.x), fabs(go.y)) <= SCENE_LENGTH_MIN && vec2_dot(go, belt) > 0.0 &&
           fabs(vec2_cross(belt, go)) <= along_belt * of_go &&
           fabs(vec2_cross(belt, come)) > least_bend * of_come &&
           vec2_dot(come, belt) >= -along_belt * of_come;
}

// The end of a plate at its point `last`, or its bend there, seen from its point `before`.
static void apply_end(const scene *s, velocity_field *f, const surroundings *around,
                      const scene_obstacle *obstacle, size_t last, size_t before)
{
    const bf_grid *g = &f->grid;
    plate_end e = { .tip = obstacle->path[last],
                    .is_bend = last > 0 && last + 1 < obstacle->n_points };
    const vec2 along = vec2_sub(e.tip, obstacle->path[before]);
    const size_t under = surroundings_belt_at(around, e.tip);
    const bool turns = under < around->n_belts && around->belts[under].turn != 0.0;
    // The chord of a guide along an arc has the direction of the belt in its middle.
    const vec2 at = turns ? vec2_sub(e.tip, vec2_scale(along, 0.5)) : e.tip;
    const vec2 belt = surroundings_velocity_at(around, under, at);
    const face_axis axes[2] = {
        { f, 0, g->d1, g->d2, g->lower1, g->lower2, (ptrdiff_t)g->n1, (ptrdiff_t)g->n2 },
        { f, 1, g->d2, g->d1, g->lower2, g->lower1, (ptrdiff_t)g->n2, (ptrdiff_t)g->n1 },
    };

    const size_t index = (size_t)(obstacle - s->obstacles);

    if (!is_free(s, around, index, e.tip) || (e.is_bend && !is_mouth(obstacle, last, before, belt)))
        return;
    e.outward = vec2_scale(along, 1.0 / vec2_length(along));
    e.extension = extension_of(s, around, index, &e, under, belt);
    const vec2 lane =
        e.is_bend ? vec2_sub(obstacle->path[2 * last - before], e.tip) : (vec2){ 0.0, 0.0 };
    const double n = ceil(vec2_length(lane) / fmin(g->d1, g->d2));
    for (double k = 0.0; k <= n; k++) {
        e.tip = vec2_add(obstacle->path[last], vec2_scale(lane, n > 0.0 ? k / n : 0.0));
        for (int axis = 0; axis < 2; axis++)
            cover_strips(&axes[axis], &e);
    }
}

void aperture_apply(const scene *s, velocity_field *f)
{
    const surroundings around = surroundings_of(s);

    for (size_t k = 0; k < s->n_obstacles; k++) {
        const scene_obstacle *obstacle = &s->obstacles[k];
        apply_end(s, f, &around, obstacle, 0, 1);
        apply_end(s, f, &around, obstacle, obstacle->n_points - 1, obstacle->n_points - 2);
        for (size_t m = 1; m + 1 < obstacle->n_points; m++) {
            apply_end(s, f, &around, obstacle, m, m - 1);
            apply_end(s, f, &around, obstacle, m, m + 1);
        }
    }
    for (int axis = 0; axis < 2; axis++) {
        const velocity_field_faces *faces = &f->faces[axis];
        for (size_t k = 0; k < grid_faces(&f->grid, axis); k++)
            faces->aperture[k] = faces->closed[k] ? 0.0 : faces->aperture[k];
    }
}
