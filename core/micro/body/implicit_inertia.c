// The effective mass of a constraint.

#include "core/micro/body/implicit.h"

/// A vector in the axes of the constraint.
static vec3 to_axes(const body_constraint *p, vec3 a)
{
    return (vec3){ vec3_dot(p->axis[0], a), vec3_dot(p->axis[1], a), vec3_dot(p->axis[2], a) };
}

/// Add the inverse effective mass of a body in the middle of a constraint, in its axes. With the lever r, r~ a = r x a
/// and the inverse inertia I, a force moves the middle by 1/m - r~ I r~ and turns the body by I r~; a torque turns it
/// by I.
static void add_inv_effective_mass(const body_constraint *p, const body_solver_body *solver_body,
                                   vec3 lever, mat6 *inv_effective_mass)
{
    const vec3 r = to_axes(p, lever);
    double(*row)[6] = inv_effective_mass->row;
    vec3 inverse[3]; // I, symmetric
    mat3 turn;       // I r~

    for (int k = 0; k < 3; k++) {
        inverse[k] = to_axes(p, mat3_apply(&solver_body->inv_inertia, p->axis[k]));
        turn.row[k] = vec3_cross(inverse[k], r);
    }
    for (int k = 0; k < 3; k++) {
        vec3 move = vec3_cross(mat3_column(&turn, k), r);
        for (int i = k; i < 3; i++)
            row[i][k] += vec3_component(move, i);
        row[k][k] += solver_body->inv_mass;
        for (int i = 0; i < 3; i++)
            row[3 + i][k] += vec3_component(turn.row[i], k);
        for (int i = k; i < 3; i++)
            row[3 + i][3 + k] += vec3_component(inverse[k], i);
    }
}

/// r x a for the axis a = k.
static vec3 cross_axis(vec3 r, int k)
{
    const vec3 rows[] = { { 0.0, r.z, -r.y }, { -r.z, 0.0, r.x }, { r.y, -r.x, 0.0 } };

    return rows[k];
}

/// The effective mass of one body in the middle of its constraint.
static void find_own_inertia(const body_state *s, body_constraint *p)
{
    const body_body *body = &s->bodies[p->b];
    const body_kind *kind = &s->kinds[body->kind];
    const vec3 r = to_axes(p, p->lever[1]), i = kind->inertia;
    double(*row)[6] = p->inertia.row, square = vec3_dot(r, r);
    vec3 own[3];

    for (int k = 0; k < 3; k++) {
        own[k] = mat3_apply_back(&body->r, p->axis[k]);
        for (int m = 0; m < k; m++)
            row[k][m] = 0.0;
        row[k][k] = kind->mass;
        for (int m = 0; m < 3; m++)
            row[3 + k][m] = -kind->mass * vec3_component(cross_axis(r, m), k);
        for (int m = 0; m <= k; m++)
            row[3 + k][3 + m] = i.x * own[k].x * own[m].x + i.y * own[k].y * own[m].y +
                                i.z * own[k].z * own[m].z -
                                kind->mass * vec3_component(r, k) * vec3_component(r, m);
        row[3 + k][3 + k] += kind->mass * square;
    }
}

void body_implicit__find_inertia(const body_state *s, body_constraint *constraint)
{
    const body_solver *z = s->implicit;
    body_constraint *p = constraint;
    mat6 inv_effective_mass;

    p->has_inertia = true;
    if (p->a == BODY_STATIC) {
        find_own_inertia(s, p);
        return;
    }
    mat6_clear(&inv_effective_mass);
    add_inv_effective_mass(p, &z->solver_bodies[p->a], p->lever[0], &inv_effective_mass);
    add_inv_effective_mass(p, &z->solver_bodies[p->b], p->lever[1], &inv_effective_mass);
    mat6_factor(&inv_effective_mass);
    mat6_invert(&inv_effective_mass, &p->inertia);
}
