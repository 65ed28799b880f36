// Solving one constraint for its impulse.

#include "core/micro/body/implicit.h"
#include "core/micro/friction.h"

#include <math.h>

enum { ITERATIONS = 6 }; // on active points and secants

/// Largest growth of the normal impulse without another iteration for the friction that it causes.
#define SETTLED 1.1

/// The impulse as c - D q.
typedef struct constraint_law {
    mat6 slope;      // D
    double start[6]; // c
} constraint_law;

/// Velocity and spin of b relative to a in the middle of a constraint, in its axes.
static void find_relative_velocity(const body_solver *z, const body_constraint *p, double q[6])
{
    const body_solver_body *b = &z->solver_bodies[p->b];
    vec3 v = vec3_add(b->v, vec3_cross(b->w, p->lever[1])), w = b->w;

    if (p->a != BODY_STATIC) {
        const body_solver_body *a = &z->solver_bodies[p->a];
        v = vec3_sub(v, vec3_add(a->v, vec3_cross(a->w, p->lever[0])));
        w = vec3_sub(w, a->w);
    } else if (p->moving != NULL) {
        v = vec3_sub(v, body__surface_velocity(p->moving, p->axis[2], p->lever[0]));
        w.z -= p->moving->spin;
    }
    for (int k = 0; k < 3; k++) {
        q[k] = vec3_dot(p->axis[k], v);
        q[3 + k] = vec3_dot(p->axis[k], w);
    }
}

static void add_to_body(body_solver_body *m, double sign, vec3 lever, vec3 force, vec3 torque)
{
    vec3 turn = vec3_add(vec3_cross(lever, force), torque);

    m->v = vec3_along(m->v, sign * m->inv_mass, force);
    m->w = vec3_along(m->w, sign, mat3_apply(&m->inv_inertia, turn));
}

static vec3 to_world(const body_constraint *p, const double a[3])
{
    return vec3_along(vec3_along(vec3_scale(p->axis[0], a[0]), a[1], p->axis[1]), a[2], p->axis[2]);
}

static void apply_impulse(const body_solver *z, const body_constraint *p, const double impulse[6])
{
    vec3 force = to_world(p, impulse), torque = to_world(p, impulse + 3);

    add_to_body(&z->solver_bodies[p->b], 1.0, p->lever[1], force, torque);
    if (p->a != BODY_STATIC)
        add_to_body(&z->solver_bodies[p->a], -1.0, p->lever[0], force, torque);
}

/// The row r with r.q the speed along the normal in a point.
static void find_row(const body_constraint_point *point, double row[6])
{
    const vec3 n = point->normal;

    row[0] = n.x;
    row[1] = n.y;
    row[2] = n.z;
    row[3] = point->y * n.z;
    row[4] = -point->x * n.z;
    row[5] = point->x * n.y - point->y * n.x;
}

static inline double normal_impulse_at(const body_constraint *p, const body_constraint_point *point,
                                       const double q[6])
{
    double row[6], speed = 0.0;

    if (p->is_flat)
        return point->bias - point->gain * (q[2] + point->y * q[3] - point->x * q[4]);
    find_row(point, row);
    for (int k = 0; k < 6; k++)
        speed += row[k] * q[k];
    return point->bias - point->gain * speed;
}

/// The points with a normal impulse for q: a bit each.
static unsigned find_active(const body_constraint *p, const double q[6])
{
    unsigned active = 0;

    for (uint32_t k = 0; k < p->n; k++)
        if (p->point[k].can_pull || normal_impulse_at(p, &p->point[k], q) > 0.0)
            active |= 1U << k;
    return active;
}

/// Set the normal impulses for q. Returns the points that have one: a bit each.
static unsigned set_normal_impulses(body_constraint *p, const double q[6])
{
    unsigned active = 0;

    p->normal_impulse = 0.0;
    for (uint32_t k = 0; k < p->n; k++) {
        double impulse = normal_impulse_at(p, &p->point[k], q);
        bool is_active = p->point[k].can_pull || impulse > 0.0;
        p->point[k].normal_impulse = is_active ? impulse : 0.0;
        p->normal_impulse += fabs(p->point[k].normal_impulse);
        active |= (unsigned)is_active << k;
    }
    return active;
}

/// Add a point where all normals are that of the constraint: its row is (0, 0, 1, y, -x, 0).
static void add_flat(const body_constraint_point *point, constraint_law *law)
{
    const double x = point->x, y = point->y, gain = point->gain, bias = point->bias;
    double(*row)[6] = law->slope.row;

    row[2][2] += gain;
    row[3][2] += gain * y;
    row[3][3] += gain * y * y;
    row[4][2] -= gain * x;
    row[4][3] -= gain * x * y;
    row[4][4] += gain * x * x;
    law->start[2] += bias;
    law->start[3] += bias * y;
    law->start[4] -= bias * x;
}

static void add_normals(const body_constraint *p, unsigned active, constraint_law *law)
{
    double row[6];

    for (uint32_t k = 0; k < p->n; k++) {
        const body_constraint_point *point = &p->point[k];
        if (!(active & 1U << k))
            continue;
        if (p->is_flat) {
            add_flat(point, law);
            continue;
        }
        find_row(point, row);
        mat6_add_square(&law->slope, point->gain, row);
        for (int m = 0; m < 6; m++)
            law->start[m] += point->bias * row[m];
    }
}

/// Add friction with a secant coefficient, N s/m, that acts in (x, y) on the slip there.
static void add_secant(constraint_law *law, double secant, double x, double y)
{
    mat6 *d = &law->slope;

    d->row[0][0] += secant;
    d->row[1][1] += secant;
    d->row[5][0] -= secant * y;
    d->row[5][1] += secant * x;
    d->row[5][5] += secant * (x * x + y * y);
}

/// Add the impulse by which the moving belt drives a point.
static void add_belt_friction(constraint_law *law, double secant,
                              const body_constraint_point *point)
{
    law->start[0] += secant * point->belt_velocity[0];
    law->start[1] += secant * point->belt_velocity[1];
    law->start[5] +=
        secant * (point->x * point->belt_velocity[1] - point->y * point->belt_velocity[0]);
}

/// The secant coefficient of (7) for a normal impulse and a slip.
static double find_secant(const body_constraint *p, double normal_impulse, double slip_x,
                          double slip_y)
{
    double slip = sqrt(slip_x * slip_x + slip_y * slip_y);

    return friction_secant(p->friction, normal_impulse, p->rate, slip);
}

static void add_sliding(const body_constraint *p, const double q[6], constraint_law *law)
{
    for (uint32_t k = 0; k < p->n; k++) {
        const body_constraint_point *point = &p->point[k];
        if (point->normal_impulse == 0.0)
            continue;
        double secant =
            find_secant(p, point->normal_impulse, q[0] - point->y * q[5], q[1] + point->x * q[5]);
        add_secant(law, secant, point->x, point->y);
    }
}

/// The secant coefficient of (8), about the normal, with the radius of gyration of the pressure about its centre.
static double find_spin_secant(const body_constraint *p, double x, double y, double spin)
{
    const body_kind *kind = p->belt_kind;
    const micro_law *law = &kind->belt_law;
    double sum = 0.0;

    for (uint32_t k = 0; k < p->n; k++) {
        double dx = p->point[k].x - x, dy = p->point[k].y - y;
        sum += fabs(p->point[k].normal_impulse) * (dx * dx + dy * dy);
    }
    double flat = fmin(1.0, sqrt(sum / p->normal_impulse) / kind->flat_gyration);
    return friction_secant(law->friction * kind->spin_radius * flat, p->normal_impulse,
                           law->tanh_spin, fabs(spin));
}

/// Add the friction of the belt, by the slip in the centre of pressure.
static void add_belt(const body_constraint *p, const double q[6], constraint_law *law)
{
    double x = 0.0, y = 0.0, sum = 0.0, secant_x = 0.0, secant_y = 0.0;

    if (p->normal_impulse <= 0.0)
        return;
    for (uint32_t k = 0; k < p->n; k++) {
        x += fabs(p->point[k].normal_impulse) * p->point[k].x / p->normal_impulse;
        y += fabs(p->point[k].normal_impulse) * p->point[k].y / p->normal_impulse;
    }
    double vx = q[0] - y * q[5], vy = q[1] + x * q[5];
    for (uint32_t k = 0; k < p->n; k++) {
        const body_constraint_point *point = &p->point[k];
        double secant = find_secant(p, point->normal_impulse, vx - point->belt_velocity[0],
                                    vy - point->belt_velocity[1]);
        add_belt_friction(law, secant, point);
        sum += secant;
        secant_x += secant * point->x;
        secant_y += secant * point->y;
    }
    if (sum > 0.0)
        add_secant(law, sum, secant_x / sum, secant_y / sum);
    law->slope.row[5][5] += find_spin_secant(p, x, y, q[5]);
}

static void find_law(const body_constraint *p, const double q[6], unsigned active,
                     constraint_law *law)
{
    mat6_clear(&law->slope);
    for (int k = 0; k < 6; k++)
        law->start[k] = 0.0;
    add_normals(p, active, law);
    if (p->belt_kind != NULL)
        add_belt(p, q, law);
    else if (p->friction > 0.0)
        add_sliding(p, q, law);
}

/// Solve (M + D) dq = c - D q - impulse, where q includes the impulse so far. *ret_more is M dq.
static void solve(const body_constraint *p, const constraint_law *law, const double q[6],
                  double ret_dq[6], double ret_more[6])
{
    double rest[6], slowed[6];
    mat6 m;

    mat6_apply(&law->slope, q, slowed);
    for (int i = 0; i < 6; i++) {
        ret_dq[i] = rest[i] = law->start[i] - slowed[i] - p->impulse[i];
        for (int j = 0; j <= i; j++)
            m.row[i][j] = law->slope.row[i][j] + p->inertia.row[i][j];
    }
    mat6_factor(&m);
    mat6_solve(&m, ret_dq);
    mat6_apply(&law->slope, ret_dq, slowed);
    for (int i = 0; i < 6; i++)
        ret_more[i] = rest[i] - slowed[i];
}

static bool has_no_impulse(const body_constraint *p)
{
    bool has_impulse = false;

    for (int k = 0; k < 6; k++)
        has_impulse |= p->impulse[k] != 0.0;
    return !has_impulse;
}

void body_implicit__begin(const body_state *s, body_constraint *constraint)
{
    if (!has_no_impulse(constraint))
        apply_impulse(s->implicit, constraint, constraint->impulse);
}

void body_implicit__solve_contact(const body_state *s, body_constraint *constraint)
{
    const body_solver *z = s->implicit;
    double q[6], q_end[6], dq[6], more[6];
    constraint_law law;

    find_relative_velocity(z, constraint, q);
    unsigned active = find_active(constraint, q);
    if (active == 0 && has_no_impulse(constraint))
        return;
    if (!constraint->has_inertia)
        body_implicit__find_inertia(s, constraint);
    for (int k = 0; k < 6; k++)
        q_end[k] = q[k];
    for (int iteration = 0; iteration < ITERATIONS; iteration++) {
        const double normal_impulse = constraint->normal_impulse;
        const unsigned before = active;
        find_law(constraint, q_end, active, &law);
        solve(constraint, &law, q, dq, more);
        for (int k = 0; k < 6; k++)
            q_end[k] = q[k] + dq[k];
        active = set_normal_impulses(constraint, q_end);
        if (active == before && constraint->normal_impulse <= SETTLED * normal_impulse)
            break;
    }
    for (int k = 0; k < 6; k++)
        constraint->impulse[k] += more[k];
    apply_impulse(z, constraint, more);
}

void body_implicit__store_warm_start(body_constraint *constraint)
{
    if (constraint->warm_start != NULL)
        *constraint->warm_start =
            (body_warm_start){ constraint->key, to_world(constraint, constraint->impulse),
                               to_world(constraint, constraint->impulse + 3) };
}
