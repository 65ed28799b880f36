#include "core/micro/hardness.h"

#include "core/micro/backend.h"
#include "core/micro/contact_law.h"
#include "core/micro/implicit_step.h"
#include "core/scene/belt.h"
#include "core/scene/belt_range.h"
#include "core/scene/belt_slope.h"
#include "core/scene/shape.h"
#include "core/scene/surroundings.h"

#include <math.h>

const double hardness_goal = 0.02;
const double hardness_masses_most = 300.0;

static const double lines = 2.0;         // that one contact may bear
static const double softest = 1e6;       // reduction, the paper's
static const double damping_ratio = 4.0; // of dashpots to critical damping, at most
static const double corner_weight =
    0.25; // of the stiffness of a contact of bodies in space: one of its points

// What presses on a contact.
typedef struct load {
    double mass;   // M, kg
    double force;  // F, N
    double square; // M v^2 or m u^2, J
} load;

// How long a domain is along the velocity of a belt, m.
static double length_along(const scene_rect *d, vec2 velocity)
{
    const double speed = vec2_length(velocity);

    if (speed == 0.0)
        return 0.0;
    return (fabs(velocity.x) * (d->x_max - d->x_min) + fabs(velocity.y) * (d->y_max - d->y_min)) /
           speed;
}

// Whether anything can stop the cargo of a belt: a plate, a wall across it, another belt, or the belt itself.
static bool has_stop(const micro_def *def)
{
    const surroundings around = { .domain = def->domain };
    bool stops = def->n_obstacles > 0 || def->n_belts != 1 || def->belts[0].turn != 0.0 ||
                 belt_range_may_change(&def->belts[0]) || def->n_actions > 0;

    for (int side = 0; side < SCENE_SIDE_COUNT && !stops; side++)
        stops = def->edges[side] == SCENE_EDGE_WALL &&
                vec2_dot(surroundings_side(&around, (scene_side)side).inward,
                         def->belts[0].velocity) < 0.0;
    return stops;
}

static load find_load(const micro_def *def)
{
    const scene_rect *d = &def->domain;
    double length = 0.0, by_length = 0.0, heaviest = 0.0; // m, kg/m, kg
    size_t fastest;
    const double plate_speed = micro__plate_speed(def, &fastest);
    double speed = vec2_length(def->start_velocity);
    load l;

    for (size_t k = 0; k < def->n_belts; k++) {
        const scene_belt *belt = &def->belts[k];
        const double own = belt->arc.is_given ? belt->arc.outer_radius * belt_arc_angle(&belt->arc)
                                              : length_along(d, belt->velocity);
        length += has_stop(def) ? own : 0.0;
        speed = fmax(speed, belt_largest_speed(belt) * belt_range_largest(belt));
    }
    // Belts follow each other, across a domain or along it.
    length = fmin(length, d->x_max - d->x_min + d->y_max - d->y_min);
    for (size_t k = 0; k < def->n_kinds; k++) {
        const micro_kind *kind = &def->kinds[k];
        by_length = fmax(by_length, 0.5 * kind->mass / implicit_step_radius_of(&kind->shape));
        heaviest = fmax(heaviest, kind->mass);
    }
    l.mass = fmin(fmax(lines * length * by_length, heaviest),
                  heaviest * fmax((double)micro__n_expected(def), 1.0));
    l.force =
        belt_slope_largest_drive(def->n_belts, def->belts, &def->contact[SCENE_CONVEYOR_CARGO]) *
        def->gravity * l.mass;
    l.square = fmax(l.mass * speed * speed, lines * heaviest * plate_speed * plate_speed);
    return l;
}

// Stiffness of the softest contact with a reduction of 1, N/m.
static double find_stiffness(const micro_def *def)
{
    const scene_contact *contact = def->contact;
    double least = HUGE_VAL;

    for (size_t k = 0; k < def->n_kinds; k++) {
        const scene_material *own = &def->kinds[k].material;
        least = fmin(least,
                     contact_law_of_line(&contact[SCENE_HANDLING_CARGO], own, &def->handling, 1.0)
                         .stiffness);
        for (size_t m = 0; m <= k; m++)
            least = fmin(least, contact_law_of_line(&contact[SCENE_CARGO_CARGO], own,
                                                    &def->kinds[m].material, 1.0)
                                    .stiffness);
    }
    return micro_def_is_planar(def) ? least : corner_weight * least;
}

double hardness_expected_overlap(const micro_def *def)
{
    const load l = find_load(def);
    const double k = find_stiffness(def) / def->modulus_reduction;

    return (l.force + sqrt(l.force * l.force + k * l.square)) / (k * implicit_step_radius(def));
}

double hardness_reduction(const micro_def *def)
{
    const load l = find_load(def);
    const double overlap = hardness_goal * implicit_step_radius(def);
    const double k = (l.square + 2.0 * l.force * overlap) / (overlap * overlap);

    return fmin(fmax(find_stiffness(def) / k, 1.0), softest);
}

double hardness_dashpot(const micro_def *def, double dashpot, double stiffness, double inverse_mass)
{
    const double most = 2.0 * damping_ratio; // of sqrt(k m)

    if (!def->hardens || def->integrator != MICRO_IMPLICIT ||
        dashpot * dashpot * inverse_mass <= most * most * stiffness)
        return dashpot;
    return most * sqrt(stiffness / inverse_mass);
}

double hardness_harder(double reduction)
{
    // By a power of two, so that one division by several steps of it has the same bits as several.
    return reduction >= 2.0 ? 0.5 * reduction : reduction;
}
