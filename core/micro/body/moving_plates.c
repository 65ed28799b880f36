// Plates that move: in each step they are turned and shifted from where they are in the document, so that rounding does not add up
// and upstream sides stay what they are there.

#include "core/micro/body/body_priv.h"

#include <math.h>

void body__add_moving_plates(body_state *s, const micro_def *def, size_t obstacle, size_t first)
{
    const scene_obstacle *of = &def->obstacles[obstacle];

    for (size_t k = first; k < s->n_plates; k++)
        s->moving[k] = (body_moving){ .moves = true,
                                      .obstacle = obstacle,
                                      .rest = s->plates[k],
                                      .range = plate_range_of(def->obstacles, obstacle,
                                                              def->n_actions, def->actions),
                                      .rest_pivot = of->pivot,
                                      // Ends at bends are prolonged by up to the thickness.
                                      .radius = plate_range_radius(of) + of->thickness,
                                      .depth = s->bounding_radius_max + of->thickness };
}

static vec3 turn(const plate_pose *pose, vec3 a)
{
    const vec2 turned = plate_pose_turn(pose, (vec2){ a.x, a.y });

    return (vec3){ turned.x, turned.y, a.z };
}

void body__pose_plates(body_state *s, uint64_t n_before)
{
    for (size_t k = 0; s->moving != NULL && k < s->n_plates; k++) {
        body_moving *moving = &s->moving[k];
        if (!moving->moves)
            continue;
        const plate_motion_step step = plate_motion_in_step(
            &s->common.world->plates, moving->obstacle, n_before, s->def.dt, moving->depth);
        body_plate *plate = &s->plates[k];
        const vec2 middle =
            plate_pose_move(&step.pose, (vec2){ moving->rest.middle.x, moving->rest.middle.y });
        const vec2 pivot = plate_pose_pivot(&step.pose);
        plate->middle = (vec3){ middle.x, middle.y, 0.0 };
        plate->along = turn(&step.pose, moving->rest.along);
        plate->across = turn(&step.pose, moving->rest.across);
        moving->pivot = (vec3){ pivot.x, pivot.y, 0.0 };
        moving->velocity = (vec3){ step.velocity.x, step.velocity.y, 0.0 };
        moving->spin = step.spin;
        moving->recess = step.recess;
        moving->growth = step.growth;
    }
}

double body__plates_speed(const body_state *s)
{
    double speed = 0.0;

    for (size_t k = 0; s->moving != NULL && k < s->n_plates; k++)
        speed = fmax(speed, fabs(s->moving[k].spin) * s->moving[k].radius +
                                vec3_length(s->moving[k].velocity) + s->moving[k].growth);
    return speed;
}

const body_moving *body__moving_plate(const body_state *s, uint32_t boundary)
{
    if (s->moving == NULL || boundary < SCENE_SIDE_COUNT)
        return NULL;
    const body_moving *moving = &s->moving[boundary - SCENE_SIDE_COUNT];
    return moving->moves ? moving : NULL;
}

bool body__is_absent(const body_state *s, uint32_t plate)
{
    return s->moving != NULL && s->moving[plate].recess == INFINITY;
}

// Points that still overlap stay the first.
static void recess_hull(manifold *m, double recess, double margin)
{
    manifold_point near[MANIFOLD_POINTS_MAX];
    size_t n = 0, n_near = 0;

    for (size_t k = 0; k < m->n; k++) {
        manifold_point point = m->point[k];
        point.depth -= recess;
        if (point.depth > 0.0)
            m->point[n++] = point;
        else if (point.depth > -margin)
            near[n_near++] = point;
    }
    m->n_below = n;
    for (size_t k = 0; k < n_near; k++)
        m->point[n++] = near[k];
    m->n = n;
    m->depth -= recess;
}

void body__recess_contact(const body_state *s, uint32_t plate, double margin, body_contact *contact)
{
    const double recess = s->moving != NULL ? s->moving[plate].recess : 0.0;

    if (recess > 0.0 && contact->is_closed_form) {
        size_t n = 0;
        for (size_t k = 0; k < contact->n_points; k++) {
            body_contact_point point = contact->points[k];
            point.depth -= recess;
            if (point.depth > -margin)
                contact->points[n++] = point;
        }
        contact->n_points = n;
    } else if (recess > 0.0) {
        recess_hull(&contact->hull, recess, margin);
    }
}

vec3 body__surface_velocity(const body_moving *moving, vec3 n, vec3 to)
{
    const vec3 turning = { -moving->spin * to.y, moving->spin * to.x, 0.0 };

    return vec3_along(vec3_add(turning, moving->velocity), moving->growth, n);
}

// The load of an obstacle, which contacts are added to.
typedef struct load_context {
    const body_state *s;
    size_t obstacle;
    plate_load load;
} load_context;

static void add_point(load_context *of, const body_moving *moving, double stiffness, vec3 normal,
                      vec3 at, double depth, double weight)
{
    const double force = weight * stiffness * fmax(depth, 0.0);
    const vec3 to = vec3_sub(at, moving->pivot);

    of->load.force += force;
    of->load.resultant = vec2_sub(of->load.resultant, (vec2){ force * normal.x, force * normal.y });
    of->load.torque -= force * (to.x * normal.y - to.y * normal.x);
}

static void add_contact(void *context, size_t k, const micro_law *law, uint32_t boundary,
                        const body_contact *contact)
{
    load_context *of = context;
    const body_moving *moving = body__moving_plate(of->s, boundary);

    (void)k;
    if (moving == NULL || moving->obstacle != of->obstacle)
        return;
    for (size_t m = 0; contact->is_closed_form && m < contact->n_points; m++) {
        const body_contact_point *p = &contact->points[m];
        add_point(of, moving, law->stiffness, p->normal, p->at, p->depth, p->weight);
    }
    for (size_t m = 0; !contact->is_closed_form && m < contact->hull.n; m++) {
        const manifold_point *p = &contact->hull.point[m];
        add_point(of, moving, law->stiffness, contact->hull.normal, p->at, p->depth, p->weight);
    }
}

plate_load body__load_on(void *state, size_t obstacle)
{
    body_state *s = state;
    load_context of = { s, obstacle, { .torque = 0.0 } };

    for (size_t k = 0; k < s->n; k++)
        if (!s->common.presence[k])
            body__visit_boundaries(s, k, 0.0, add_contact, &of);
    return of.load;
}
