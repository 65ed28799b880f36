// Contacts with plates and walls, which are half spaces, and the forces in them.
//
// While the centre of a body is between the ends of a plate, the contact normal is that of the side on which
// the centre is, however thin the plate and however large the overlap. Beyond the ends it is the direction of
// least depth. On the outer side of a joint of two plates the end of either is inside the other one: a normal there is
// that of a side, or between those of the two sides, at the corner.

#include "core/micro/body/body_priv.h"

#include "core/base/vec2.h"

#include <math.h>

/// Half the height of the cuboid that stands for a plate near a body, in radii of the body.
#define CUBOID_HALF_HEIGHT 8.0

/// What body__add_boundary_forces() adds to.
typedef struct boundary_forces {
    const body_state *s;
    body_load *load;
    body_report *report;
} boundary_forces;

/// Add the force on part k in a contact point of a boundary. Returns true if it is not zero.
static bool add_point_force(const body_state *s, size_t k, const micro_law *law,
                            const body_moving *moving, vec3 normal, const manifold_point *point,
                            body_load *load)
{
    const body_body *body = &s->bodies[k];
    vec3 velocity = body__velocity(body, point->at), force;

    if (moving != NULL)
        velocity = vec3_sub(
            velocity, body__surface_velocity(moving, normal, vec3_sub(point->at, moving->pivot)));
    if (!body__contact_force(s, law, normal, point, velocity, &force))
        return false;
    body__add_force(load, body, point->at, force);
    return true;
}

/// Add the forces on part k in all points of its contact.
static void add_contact_force(void *context, size_t k, const micro_law *law, uint32_t boundary,
                              const body_contact *contact)
{
    const boundary_forces *forces = context;
    const body_moving *moving = body__moving_plate(forces->s, boundary);
    double depth = 0.0;

    for (size_t m = 0; contact->is_closed_form && m < contact->n_points; m++) {
        const body_contact_point *contact_point = &contact->points[m];
        manifold_point point = { contact_point->at, contact_point->depth, contact_point->weight };
        if (add_point_force(forces->s, k, law, moving, contact_point->normal, &point, forces->load))
            depth = fmax(depth, point.depth);
    }
    for (size_t m = 0; !contact->is_closed_form && m < contact->hull.n; m++)
        if (add_point_force(forces->s, k, law, moving, contact->hull.normal,
                            &contact->hull.point[m], forces->load))
            depth = contact->hull.depth;
    if (depth > 0.0)
        body__note(forces->report, (uint32_t)k, UINT32_MAX, depth,
                   forces->s->kinds[forces->s->bodies[k].kind].half_width);
}

/// The region of a body below the side of a plate that its centre is on, between the plate's ends.
static void find_at_side(const body_state *s, const body_body *body, const body_plate *plate,
                         double margin, manifold *m)
{
    const bool is_behind = vec3_dot(vec3_sub(body->x, plate->middle), plate->across) < 0.0;
    manifold_plane side = { .normal = vec3_scale(plate->across, is_behind ? -1.0 : 1.0),
                            .half_length = plate->half_length,
                            .along = plate->along,
                            .middle = plate->middle };

    side.offset = vec3_dot(side.normal, plate->middle) + plate->half_thickness;
    manifold_on_plane(&s->kinds[body->kind].shape, body->x, &body->r, &side, margin, m);
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

/// How far a body reaches below the left side of a plate (side 1) or its right one (-1), continued beyond its ends, m.
static double depth_below(const body_state *s, const body_body *body, const body_plate *plate,
                          double side)
{
    const hull *shape = &s->kinds[body->kind].shape;
    const vec3 normal = { -side * plate->along.y, side * plate->along.x, 0.0 };
    const vec3 against = mat3_apply_back(&body->r, vec3_scale(normal, -1.0));
    const vec3 lowest = mat3_apply(&body->r, hull_vertex(shape, hull_support(shape, against)));

    return plate->half_thickness +
           vec3_dot(normal, vec3_sub(plate->middle, vec3_add(body->x, lowest)));
}

/// True if a body that is so deep below the side of a plate is no less deep below those that continue it around a joint: it
/// came into the solid of them through this one.
static bool is_least_deep(const body_state *s, const body_body *body, const body_plate *plate,
                          double depth)
{
    for (int end = 0; end < 2; end++) {
        double side;
        const body_plate *next = body__next_around(s, plate, end, body->x, &side);
        if (next != NULL && depth_below(s, body, next, side) < depth)
            return false;
    }
    return true;
}

/// Returns false if part k, which is no upright cylinder, has no contact with the plate.
static bool find_hull_at_plate(body_state *s, size_t k, uint32_t id, double margin, manifold *m)
{
    const body_body *body = &s->bodies[k];
    const body_plate *plate = &s->plates[id];
    const double a = vec3_dot(vec3_sub(body->x, plate->middle), plate->along);
    const bool is_beyond = body__is_felt_beyond_joint(s, plate, body->x.x, body->x.y);
    body_memory passing = { 0 };

    if (body__is_behind_step(s, plate, body->x)) {
        clear_memory_slot(s->plate_memories[k], id);
        return false;
    }
    if (fabs(a) <= plate->half_length || is_beyond) {
        find_at_side(s, body, plate, margin, m);
        if (m->depth <= -margin || m->is_least) {
            clear_memory_slot(s->plate_memories[k], id);
            return !is_beyond || is_least_deep(s, body, plate, m->depth);
        }
    }
    // Around a joint a body leaves the side that it came from, of which the memory would keep the contact.
    body_plate_memory *slot = NULL;
    if (plate->joined[a < 0.0 ? 0 : 1] == BODY_NO_PLATE)
        slot = find_memory_slot(s->plate_memories[k], id);
    else
        clear_memory_slot(s->plate_memories[k], id);
    if (slot != NULL)
        slot->plate = id + 1;
    if (!find_at_cuboid(s, body, plate, margin, slot != NULL ? &slot->memory : &passing, m))
        return false;
    const body_joint_contact at = body__feel_at_joints(s, plate, body->x, m->normal);
    if (at != BODY_INSIDE_JOINT)
        return at == BODY_AT_PLATE;
    find_at_side(s, body, plate, margin, m);
    m->depth = -margin;
    for (size_t i = 0; i < m->n; i++)
        m->depth = fmax(m->depth, m->point[i].depth);
    return m->n > 0 && is_least_deep(s, body, plate, m->depth);
}

/// Returns false if part k has no contact with the plate.
static bool find_at_plate(body_state *s, size_t k, uint32_t id, double margin,
                          body_contact *contact)
{
    const body_body *body = &s->bodies[k];
    const body_plate *plate = &s->plates[id];

    contact->is_closed_form = false;
    if (body__is_absent(s, id) ||
        body__plate_distance(plate, body->x.x, body->x.y) >= s->bounding_radius[k] + margin) {
        clear_memory_slot(s->plate_memories[k], id);
        return false;
    }
    contact->is_closed_form =
        body__find_cylinder_at_plate(s, body, plate, margin, contact->points, &contact->n_points);
    if (!contact->is_closed_form)
        return find_hull_at_plate(s, k, id, margin, &contact->hull);
    clear_memory_slot(s->plate_memories[k], id);
    return !body__is_felt_beyond_joint(s, plate, body->x.x, body->x.y);
}

static void visit_plates(body_state *s, size_t k, double margin, body_visit *visit, void *context)
{
    const micro_law *law = &s->kinds[s->bodies[k].kind].boundary_law;
    body_contact contact;
    size_t n;

    const uint32_t *plates = body__plates_near(s, s->bodies[k].x.x, s->bodies[k].x.y, &n);
    for (size_t m = 0; m < n; m++)
        if (find_at_plate(s, k, plates[m], margin, &contact)) {
            body__recess_contact(s, plates[m], margin, &contact);
            visit(context, k, law, SCENE_SIDE_COUNT + plates[m], &contact);
        }
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

    law.friction = s->def.wall_friction;
    for (int side = 0; side < SCENE_SIDE_COUNT; side++) {
        if (s->common.around.edges[side] != SCENE_EDGE_WALL)
            continue;
        manifold_plane wall = wall_of(&s->common.around, side);
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
    const vec3 x = s->bodies[k].x;
    size_t n = 0, n_near;

    for (int side = 0; side < SCENE_SIDE_COUNT; side++) {
        manifold_plane wall = wall_of(&s->common.around, side);
        n += s->common.around.edges[side] == SCENE_EDGE_WALL && is_near_plane(s, k, &wall, range);
    }
    const uint32_t *plates = body__plates_near(s, x.x, x.y, &n_near);
    for (size_t m = 0; m < n_near; m++)
        n += body__plate_distance_ever(s, plates[m], x.x, x.y) < s->bounding_radius[k] + range;
    return n;
}

void body__add_boundary_forces(body_state *s, size_t k, body_load *load, body_report *report)
{
    boundary_forces forces = { s, load, report };

    body__visit_boundaries(s, k, 0.0, add_contact_force, &forces);
}
