#include "core/micro/implicit_step.h"

#include "core/micro/backend.h"
#include "core/micro/contact_law.h"
#include "core/micro/hardness.h"
#include "core/scene/belt.h"
#include "core/scene/belt_range.h"
#include "core/scene/belt_slope.h"
#include "core/scene/shape.h"

#include <math.h>

static const double step_longest = 2e-3;      // s, that is chosen
static const double step_limit = 1e-2;        // s, that is allowed
static const double move_planar = 0.08;       // of the smallest radius
static const double move_spatial = 0.02;      // in space
static const double spatial_periods = 2.5;    // in space, of sqrt(m/k)
static const double move_limit = 0.25;        // of the same
static const double iterations_chosen = 16.0; // at most, where the step is chosen
static const double over_relaxation = 1.4;    // in the plane

static const double stiffness_weight = 0.03; // of iterations^2, per layer of a jam
static const double relaxed_weight = 0.008;  // the same with over-relaxation
static const double damping_weight = 0.4;    // of iterations^2

enum { ITERATIONS_MAX = 32 };

double implicit_step_radius_of(const scene_shape *shape)
{
    const shape_footprint f = shape_footprint_of(shape);
    double least = HUGE_VAL;

    if (f.n_corners == 0)
        return shape->radius;
    for (size_t side = 0; side < f.n_corners; side++) {
        vec2 start = f.corners[side], end = f.corners[(side + 1) % f.n_corners];
        vec2 along = vec2_sub(end, start);
        double width = 0.0;
        for (size_t k = 0; k < f.n_corners; k++) {
            vec2 to = vec2_sub(f.corners[k], start);
            width = fmax(width, fabs(along.x * to.y - along.y * to.x) / vec2_length(along));
        }
        least = fmin(least, width);
    }
    return 0.5 * least;
}

double implicit_step_radius(const micro_def *def)
{
    double radius = HUGE_VAL;

    for (size_t k = 0; k < def->n_kinds; k++)
        radius = fmin(radius, implicit_step_radius_of(&def->kinds[k].shape));
    return radius;
}

// The extremes of a definition that determine the step.
typedef struct extremes {
    double stiffness; // largest k, N/m
    double damping;   // largest d, N s/m
    double mass;      // smallest, kg
    double radius;    // smallest, m
    double speed;     // largest, m/s
} extremes;

static double stiffness_of(const micro_def *def, scene_pair pair, const scene_material *a,
                           const scene_material *b)
{
    return contact_law_of_line(&def->contact[pair], a, b, def->modulus_reduction).stiffness;
}

static extremes extremes_of(const micro_def *def)
{
    extremes e = { .damping = fmax(def->contact[SCENE_CARGO_CARGO].damping,
                                   def->contact[SCENE_HANDLING_CARGO].damping),
                   .mass = HUGE_VAL,
                   .radius = implicit_step_radius(def),
                   .speed = hypot(def->start_velocity.x, def->start_velocity.y) };

    for (size_t k = 0; k < def->n_kinds; k++) {
        const micro_kind *kind = &def->kinds[k];
        const scene_material *own = &kind->material;
        e.mass = fmin(e.mass, kind->mass);
        e.stiffness = fmax(e.stiffness, stiffness_of(def, SCENE_CARGO_CARGO, own, own));
        e.stiffness =
            fmax(e.stiffness, stiffness_of(def, SCENE_HANDLING_CARGO, own, &def->handling));
    }
    e.damping = hardness_dashpot(def, e.damping, e.stiffness, 1.0 / e.mass);
    for (size_t k = 0; k < def->n_belts; k++)
        e.speed =
            fmax(e.speed, belt_largest_speed(&def->belts[k]) * belt_range_largest(&def->belts[k]));
    return e;
}

double implicit_step_excess(int iteration, int n_iterations)
{
    return iteration + 1 < n_iterations ? over_relaxation - 1.0 : 0.0;
}

// Longest step for which no part at the largest speed moves by more than `fraction` of the radius.
static double step_of_move(const extremes *e, double fraction)
{
    return e->speed > 0.0 ? fraction * e->radius / e->speed : HUGE_VAL;
}

// iterations^2 = quadratic h^2 + linear h
typedef struct effort {
    double quadratic;
    double linear;
} effort;

static effort make_effort(double weight, size_t n_parts, double stiffness, double damping,
                          double mass)
{
    return (effort){ weight * sqrt((double)n_parts) * 2.0 * stiffness / mass,
                     damping_weight * 2.0 * damping / mass };
}

int implicit_step_iterations(bool is_planar, size_t n_parts, double h, double stiffness,
                             double damping, double mass)
{
    effort e = make_effort(is_planar ? relaxed_weight : stiffness_weight, n_parts, stiffness,
                           damping, mass);
    double square = fmax(1.0, (e.quadratic * h + e.linear) * h);

    return (int)fmin(ceil(sqrt(square)), ITERATIONS_MAX);
}

int implicit_step_effort(const micro_def *def, bool is_planar)
{
    const extremes e = extremes_of(def);

    return implicit_step_iterations(is_planar, micro__n_expected(def), def->dt, e.stiffness,
                                    e.damping, e.mass);
}

double implicit_step_stable(const micro_def *def)
{
    extremes e = extremes_of(def);

    return fmin(step_limit, step_of_move(&e, move_limit));
}

double implicit_step_chosen(const micro_def *def, bool is_planar)
{
    const scene_contact *belt = &def->contact[SCENE_CONVEYOR_CARGO];
    extremes e = extremes_of(def);
    size_t fastest;

    e.speed = fmax(e.speed, micro__plate_speed(def, &fastest));
    double dt = fmin(step_longest, step_of_move(&e, is_planar ? move_planar : move_spatial));

    if (!is_planar)
        dt = fmin(dt, spatial_periods * sqrt(e.mass / e.stiffness));
    const effort x =
        make_effort(stiffness_weight, micro__n_expected(def), e.stiffness, e.damping, e.mass);
    const double square = iterations_chosen * iterations_chosen;
    dt = fmin(dt,
              2.0 * square / (x.linear + sqrt(x.linear * x.linear + 4.0 * x.quadratic * square)));
    const double deceleration =
        belt_slope_largest_drive(def->n_belts, def->belts, belt) * def->gravity;
    return deceleration > 0.0
               ? fmin(dt, fmax(0.2 / belt->tanh_linear, 0.05 * e.speed) / deceleration)
               : dt;
}
