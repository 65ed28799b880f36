// How long a step of MICRO_IMPLICIT may be, and how many rounds of relaxation it takes.
//
// The equations of a step couple parts by stiffness and by dashpots, in terms of their inertia,
//
//     2 h^2 k / m   and   2 h d / m,
//
// and impulses spread over about as many parts in a step as the roots of these. The more layers a jam
// may have, the more of its load is to be handed on; dashpots forget, which helps. Measured on Examples 1
// and 2 and on jams of up to 40,000 parts for reductions of 1e2 to 1e6 and steps of 0.2 to 4 ms,
//
//     rounds^2 = 0.03 sqrt(N) 2 h^2 k / m + 0.4 2 h d / m
//
// keep the outflow curve within 1 % of N of the explicit one and jams about as calm: what is left over
// is corrected in the next step, which starts from the impulses of this one. The step that is chosen is
// the shortest of
//
//     2 ms
//     0.08 r / v            parts move by less than a twelfth of a radius: directions of contacts hold
//     0.2 / (lambda mu g), or 0.05 v / (mu g) if that is longer: the belt takes parts up in many steps
//     where rounds(h) = 16  stiffer contacts take shorter steps instead of more rounds
//
// with v the speed of the fastest belt or of the parts at the start.

#include "core/micro/planar_implicit_priv.h"

#include <math.h>

static const double step_longest = 2e-3;    // s, that is chosen
static const double step_limit = 1e-2;      // s, that is allowed
static const double move_chosen = 0.08;     // of the smallest radius
static const double move_limit = 0.25;      // of the same
static const double rounds_chosen = 16.0;   // at most, where the step is chosen
static const double stiffness_share = 0.03; // of rounds^2, per layer of a jam
static const double damping_share = 0.4;    // of rounds^2

enum { ROUNDS_MAX = 32 };

// The extremes of a definition that count here.
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
    return law_of_line(&def->contact[pair], a, b, def->modulus_reduction).stiffness;
}

static extremes extremes_of(const micro_def *def)
{
    extremes e = { .damping = fmax(def->contact[SCENE_CARGO_CARGO].damping,
                                   def->contact[SCENE_HANDLING_CARGO].damping),
                   .mass = HUGE_VAL,
                   .radius = HUGE_VAL,
                   .speed = hypot(def->start_velocity.x, def->start_velocity.y) };

    for (size_t k = 0; k < def->n_kinds; k++) {
        const micro_kind *kind = &def->kinds[k];
        const scene_material *own = &kind->material;
        e.mass = fmin(e.mass, kind->mass);
        e.radius = fmin(e.radius, kind->shape.radius);
        e.stiffness = fmax(e.stiffness, stiffness_of(def, SCENE_CARGO_CARGO, own, own));
        e.stiffness =
            fmax(e.stiffness, stiffness_of(def, SCENE_HANDLING_CARGO, own, &def->handling));
    }
    for (size_t k = 0; k < def->n_belts; k++)
        e.speed = fmax(e.speed, hypot(def->belts[k].velocity.x, def->belts[k].velocity.y));
    return e;
}

// Longest step for which no part at the largest speed moves by more than `share` of the radius.
static double step_of_move(const extremes *e, double share)
{
    return e->speed > 0.0 ? share * e->radius / e->speed : HUGE_VAL;
}

// rounds^2 = quadratic h^2 + linear h
typedef struct effort {
    double quadratic;
    double linear;
} effort;

static effort make_effort(size_t n_parts, double stiffness, double damping, double mass)
{
    return (effort){ stiffness_share * sqrt((double)n_parts) * 2.0 * stiffness / mass,
                     damping_share * 2.0 * damping / mass };
}

int planar_implicit__rounds(const planar_state *s)
{
    const double h = s->def.dt;
    double square = 1.0;

    for (size_t k = 0; k < s->n_kinds; k++) {
        const planar_row *row = &s->kinds[k].row;
        double cargo = s->cargo.line / (2.0 * row->softness);
        double handling = s->handling.line / (row->softness + s->handling_softness);
        double damping = fmax(s->cargo.damping, s->handling.damping);
        effort e = make_effort(s->n, fmax(cargo, handling), damping, 1.0 / row->inverse_mass);
        square = fmax(square, (e.quadratic * h + e.linear) * h);
    }
    return (int)fmin(ceil(sqrt(square)), ROUNDS_MAX);
}

static double step_of_rounds(const micro_def *def, const extremes *x)
{
    effort e = make_effort(def->n_parts, x->stiffness, x->damping, x->mass);
    double square = rounds_chosen * rounds_chosen;

    return 2.0 * square / (e.linear + sqrt(e.linear * e.linear + 4.0 * e.quadratic * square));
}

static double step_of_belt(const micro_def *def, const extremes *e)
{
    const scene_contact *belt = &def->contact[SCENE_CONVEYOR_CARGO];
    double grip = belt->friction * def->gravity;

    return grip > 0.0 ? fmax(0.2 / belt->tanh_linear, 0.05 * e->speed) / grip : HUGE_VAL;
}

double planar__dt_stable_implicit(const micro_def *def)
{
    extremes e = extremes_of(def);

    return fmin(step_limit, step_of_move(&e, move_limit));
}

double planar__dt_auto_implicit(const micro_def *def)
{
    extremes e = extremes_of(def);
    double dt = fmin(step_longest, step_of_move(&e, move_chosen));

    return fmin(fmin(dt, step_of_rounds(def, &e)), step_of_belt(def, &e));
}
