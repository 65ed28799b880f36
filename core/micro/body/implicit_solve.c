// The impulses of a patch.

#include "core/micro/body/implicit.h"
#include "core/micro/friction.h"

#include <math.h>

enum { ITERATIONS = 6 }; // on which points press, and on the secants

/// The pressure may grow by this factor before the friction that it carries is found anew.
#define SETTLED 1.1

/// Impulses of the points as c - D q.
typedef struct contact_law_of_patch {
    mat6 slope;      // D
    double start[6]; // c
} contact_law_of_patch;

/// The velocity of b against a in the middle of a patch, in its axes.
static void find_twist(const body_solver *z, const body_patch *p, double q[6])
{
    const body_mover *b = &z->movers[p->b];
    vec3 v = vec3_add(b->v, vec3_cross(b->w, p->lever[1])), w = b->w;

    if (p->a != BODY_STILL) {
        const body_mover *a = &z->movers[p->a];
        v = vec3_sub(v, vec3_add(a->v, vec3_cross(a->w, p->lever[0])));
        w = vec3_sub(w, a->w);
    }
    for (int k = 0; k < 3; k++) {
        q[k] = vec3_dot(p->axis[k], v);
        q[3 + k] = vec3_dot(p->axis[k], w);
    }
}

static void push(body_mover *m, double sign, vec3 lever, vec3 force, vec3 torque)
{
    vec3 turn = vec3_add(vec3_cross(lever, force), torque);

    m->v = vec3_along(m->v, sign * m->give, force);
    m->w = vec3_along(m->w, sign, mat3_apply(&m->give_spin, turn));
}

static vec3 to_world(const body_patch *p, const double a[3])
{
    return vec3_along(vec3_along(vec3_scale(p->axis[0], a[0]), a[1], p->axis[1]), a[2], p->axis[2]);
}

static void apply(const body_solver *z, const body_patch *p, const double impulse[6])
{
    vec3 force = to_world(p, impulse), torque = to_world(p, impulse + 3);

    push(&z->movers[p->b], 1.0, p->lever[1], force, torque);
    if (p->a != BODY_STILL)
        push(&z->movers[p->a], -1.0, p->lever[0], force, torque);
}

/// What the speed along the normal in a point is by q.
static void find_row(const body_point *point, double row[6])
{
    const vec3 n = point->normal;

    row[0] = n.x;
    row[1] = n.y;
    row[2] = n.z;
    row[3] = point->y * n.z;
    row[4] = -point->x * n.z;
    row[5] = point->x * n.y - point->y * n.x;
}

static double press_at(const body_patch *p, const body_point *point, const double q[6])
{
    double row[6], speed = 0.0;

    if (p->is_flat)
        return point->bias - point->gain * (q[2] + point->y * q[3] - point->x * q[4]);
    find_row(point, row);
    for (int k = 0; k < 6; k++)
        speed += row[k] * q[k];
    return point->bias - point->gain * speed;
}

/// Which points press when b moves by q: a bit each.
static unsigned find_open(const body_patch *p, const double q[6])
{
    unsigned open = 0;

    for (uint32_t k = 0; k < p->n; k++)
        if (p->point[k].is_stuck || press_at(p, &p->point[k], q) > 0.0)
            open |= 1U << k;
    return open;
}

static void set_presses(body_patch *p, const double q[6], unsigned open)
{
    p->press = 0.0;
    for (uint32_t k = 0; k < p->n; k++) {
        p->point[k].press = open & 1U << k ? press_at(p, &p->point[k], q) : 0.0;
        p->press += fabs(p->point[k].press);
    }
}

/// What a point adds where all normals are that of the patch: its row is (0, 0, 1, y, -x, 0).
static void add_flat(const body_point *point, contact_law_of_patch *law)
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

static void add_normals(const body_patch *p, unsigned open, contact_law_of_patch *law)
{
    double row[6];

    for (uint32_t k = 0; k < p->n; k++) {
        const body_point *point = &p->point[k];
        if (!(open & 1U << k))
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

/// Friction of strength `grip` that acts in (x, y) on the slip there.
static void add_grip(contact_law_of_patch *law, double grip, double x, double y)
{
    mat6 *d = &law->slope;

    d->row[0][0] += grip;
    d->row[1][1] += grip;
    d->row[5][0] -= grip * y;
    d->row[5][1] += grip * x;
    d->row[5][5] += grip * (x * x + y * y);
}

/// The push of what drives a point.
static void add_drive(contact_law_of_patch *law, double grip, const body_point *point)
{
    law->start[0] += grip * point->drive[0];
    law->start[1] += grip * point->drive[1];
    law->start[5] += grip * (point->x * point->drive[1] - point->y * point->drive[0]);
}

/// The secant of (7) for a pressure and a slip.
static double find_grip(const body_patch *p, double press, double slip_x, double slip_y)
{
    double slip = sqrt(slip_x * slip_x + slip_y * slip_y);

    return friction_secant(p->friction, press, p->rate, slip);
}

static void add_sliding(const body_patch *p, const double q[6], contact_law_of_patch *law)
{
    for (uint32_t k = 0; k < p->n; k++) {
        const body_point *point = &p->point[k];
        if (point->press == 0.0)
            continue;
        double grip = find_grip(p, point->press, q[0] - point->y * q[5], q[1] + point->x * q[5]);
        add_grip(law, grip, point->x, point->y);
    }
}

/// Friction (8): about the normal, with the radius of gyration of the pressure about its centre.
static double find_brake(const body_patch *p, double x, double y, double spin)
{
    const body_kind *kind = p->floor;
    const micro_law *law = &kind->floor;
    double sum = 0.0;

    for (uint32_t k = 0; k < p->n; k++) {
        double dx = p->point[k].x - x, dy = p->point[k].y - y;
        sum += fabs(p->point[k].press) * (dx * dx + dy * dy);
    }
    double flat = fmin(1.0, sqrt(sum / p->press) / kind->flat_gyration);
    return friction_secant(law->friction * kind->spin_radius * flat, p->press, law->tanh_spin,
                           fabs(spin));
}

/// The belt's friction, by the slip in the centre of pressure.
static void add_belt(const body_patch *p, const double q[6], contact_law_of_patch *law)
{
    double x = 0.0, y = 0.0, sum = 0.0, grip_x = 0.0, grip_y = 0.0;

    if (p->press <= 0.0)
        return;
    for (uint32_t k = 0; k < p->n; k++) {
        x += fabs(p->point[k].press) * p->point[k].x / p->press;
        y += fabs(p->point[k].press) * p->point[k].y / p->press;
    }
    double vx = q[0] - y * q[5], vy = q[1] + x * q[5];
    for (uint32_t k = 0; k < p->n; k++) {
        const body_point *point = &p->point[k];
        double grip = find_grip(p, point->press, vx - point->drive[0], vy - point->drive[1]);
        add_drive(law, grip, point);
        sum += grip;
        grip_x += grip * point->x;
        grip_y += grip * point->y;
    }
    if (sum > 0.0)
        add_grip(law, sum, grip_x / sum, grip_y / sum);
    law->slope.row[5][5] += find_brake(p, x, y, q[5]);
}

static void find_law(const body_patch *p, const double q[6], unsigned open,
                     contact_law_of_patch *law)
{
    *law = (contact_law_of_patch){ .start = { 0.0 } };
    add_normals(p, open, law);
    if (p->floor != NULL)
        add_belt(p, q, law);
    else if (p->friction > 0.0)
        add_sliding(p, q, law);
}

/// Solve (M + D) dq = c - D q - impulse, where q is with the impulse. *ret_more is M dq.
static void solve(const body_patch *p, const contact_law_of_patch *law, const double q[6],
                  double ret_dq[6], double ret_more[6])
{
    double rest[6], slowed[6];
    mat6 m = law->slope;

    mat6_apply(&law->slope, q, slowed);
    for (int i = 0; i < 6; i++) {
        ret_dq[i] = rest[i] = law->start[i] - slowed[i] - p->impulse[i];
        for (int j = 0; j <= i; j++)
            m.row[i][j] += p->inertia.row[i][j];
    }
    mat6_factor(&m);
    mat6_solve(&m, ret_dq);
    mat6_apply(&law->slope, ret_dq, slowed);
    for (int i = 0; i < 6; i++)
        ret_more[i] = rest[i] - slowed[i];
}

static bool is_idle(const body_patch *p)
{
    bool is_pushing = false;

    for (int k = 0; k < 6; k++)
        is_pushing |= p->impulse[k] != 0.0;
    return !is_pushing;
}

void body_implicit__begin(const body_solver *z, body_patch *patch)
{
    if (!is_idle(patch))
        apply(z, patch, patch->impulse);
}

void body_implicit__relax(const body_solver *z, body_patch *patch)
{
    double q[6], q_end[6], dq[6], more[6];
    contact_law_of_patch law;

    find_twist(z, patch, q);
    unsigned open = find_open(patch, q);
    if (open == 0 && is_idle(patch))
        return;
    for (int k = 0; k < 6; k++)
        q_end[k] = q[k];
    for (int iteration = 0; iteration < ITERATIONS; iteration++) {
        const double press = patch->press;
        const unsigned before = open;
        find_law(patch, q_end, open, &law);
        solve(patch, &law, q, dq, more);
        for (int k = 0; k < 6; k++)
            q_end[k] = q[k] + dq[k];
        open = find_open(patch, q_end);
        set_presses(patch, q_end, open);
        if (open == before && patch->press <= SETTLED * press)
            break;
    }
    for (int k = 0; k < 6; k++)
        patch->impulse[k] += more[k];
    apply(z, patch, more);
}

void body_implicit__keep(body_patch *patch)
{
    if (patch->hold != NULL)
        *patch->hold = (body_hold){ patch->key, to_world(patch, patch->impulse),
                                    to_world(patch, patch->impulse + 3) };
}
