// Solving the constraints of a batch for their impulses, one in each lane.

#include "core/convex/mat6.h"
#include "core/micro/body/implicit_lanes.h"
#include "core/micro/friction.h"

// This file is compiled once per instruction set.

enum { ITERATIONS = 6 }; // on active points and secants

// Largest growth of the normal impulse without another iteration for the friction that it causes.
#define SETTLED 1.1

// 1 in lanes where any component is not 0.
static inline simd find_nonzero(const simd impulse[6])
{
    simd sum = simd_all(0.0);

    for (int k = 0; k < 6; k++)
        sum += size_of(impulse[k]);
    return simd_where_less(simd_all(0.0), sum, simd_all(1.0));
}

static inline void load_impulse(const body_batch *p, size_t lane, simd ret[6])
{
    for (int k = 0; k < 6; k++)
        ret[k] = simd_load(p->impulse[k] + lane);
}

static void warm_start(body_solver_body *bodies, const body_batch *batch)
{
    simd impulse[6];

    for (size_t lane = 0; lane < batch->n; lane += SIMD_LANES) {
        load_impulse(batch, lane, impulse);
        const simd on = find_nonzero(impulse);
        if (simd_less(simd_all(0.0), on) == 0)
            continue;
        lanes_ends e = load_ends(bodies, batch, lane);
        apply_impulse(bodies, batch, lane, &e, on, impulse);
    }
}

// Add the inverse effective mass of a body in the middle of its constraint, in its axes. With the lever r, r~ a = r x a
// and the inverse inertia I, a force moves the middle by 1/m - r~ I r~ and turns the body by I r~; a torque turns it
// by I.
static inline void add_inv_effective_mass(const lanes_axes *axes, const lanes_body *body,
                                          lanes3 lever, mat6 *m)
{
    const lanes3 r = to_axes(axes, lever);
    simd inverse[3][3]; // I, symmetric
    simd turn[3][3];    // I r~, by rows

    for (int k = 0; k < 3; k++) {
        const lanes3 column = to_axes(axes, apply_inv_inertia(body, axes->axis[k]));
        const lanes3 row = cross3(column, r);
        memcpy(inverse[k], &column, sizeof column);
        memcpy(turn[k], &row, sizeof row);
    }
#pragma GCC unroll 3
    for (int k = 0; k < 3; k++) {
        const lanes3 move = cross3((lanes3){ turn[0][k], turn[1][k], turn[2][k] }, r);
        const simd moves[3] = { move.x, move.y, move.z };
#pragma GCC unroll 3
        for (int i = k; i < 3; i++) {
            m->row[i][k] += moves[i];
            m->row[3 + i][3 + k] += inverse[k][i];
        }
        m->row[k][k] += body->inv_mass;
#pragma GCC unroll 3
        for (int i = 0; i < 3; i++)
            m->row[3 + i][k] += turn[i][k];
    }
}

// The effective masses of pairs.
static void find_inertia(const body_solver_body *bodies, body_batch *p, size_t lane)
{
    const lanes_ends e = load_ends(bodies, p, lane);
    mat6 inverse, inertia;

    mat6_clear(&inverse);
    add_inv_effective_mass(&e.axes, &e.a, e.lever[0], &inverse);
    add_inv_effective_mass(&e.axes, &e.b, e.lever[1], &inverse);
    mat6_factor(&inverse);
    mat6_invert(&inverse, &inertia);
    for (int i = 0; i < 6; i++)
        for (int j = 0; j <= i; j++)
            simd_store(p->inertia[body_entry(i, j)] + lane, inertia.row[i][j]);
}

// Velocity and spin of b relative to a in the middle, in the axes.
static inline void find_relative_velocity(const body_batch *p, size_t lane, const lanes_ends *e,
                                          simd q[6])
{
    lanes3 v = add3(e->b.v, cross3(e->b.w, e->lever[1])), w = e->b.w;

    if (p->is_pair) {
        v = sub3(v, add3(e->a.v, cross3(e->a.w, e->lever[0])));
        w = sub3(w, e->a.w);
    } else {
        v = sub3(v, load3(p->surface, lane));
        w.z -= simd_load(p->surface[3] + lane);
    }
    v = to_axes(&e->axes, v);
    w = to_axes(&e->axes, w);
    memcpy(q, &v, sizeof v);
    memcpy(q + 3, &w, sizeof w);
}

// Points in registers' width.
typedef struct lanes_point {
    simd x, y, impulse; // impulse: J
    simd gain, bias;    // 0 where the point is not active
} lanes_point;

// The row r with r.q the speed along the normal in a point.
static inline void find_row(const body_batch_point *point, size_t lane, simd row[6])
{
    const simd x = simd_load(point->x + lane), y = simd_load(point->y + lane);
    const lanes3 n = load3(point->normal, lane);

    row[0] = n.x;
    row[1] = n.y;
    row[2] = n.z;
    row[3] = y * n.z;
    row[4] = -x * n.z;
    row[5] = x * n.y - y * n.x;
}

// Find the points with a normal impulse J for q. Returns a number that says which they are.
static inline simd find_active(const body_batch *p, size_t lane, const simd q[6],
                               lanes_point *points, simd *ret_impulses)
{
    simd row[6], active = simd_all(0.0), bit = simd_all(1.0);

    for (uint32_t k = 0; k < p->n_points; k++, bit += bit) {
        const body_batch_point *from = &p->point[k];
        lanes_point *point = &points[k];
        const simd gain = simd_load(from->gain + lane), bias = simd_load(from->bias + lane);
        const simd lower_bound = simd_load(from->lower_bound + lane);
        simd speed = q[2] + point->y * q[3] - point->x * q[4];
        if (!p->is_flat) {
            find_row(from, lane, row);
            speed = simd_all(0.0);
            for (int m = 0; m < 6; m++)
                speed += row[m] * q[m];
        }
        const simd impulse = bias - gain * speed;
        point->gain = simd_where_less(lower_bound, impulse, gain);
        point->bias = simd_where_less(lower_bound, impulse, bias);
        ret_impulses[k] = simd_where_less(lower_bound, impulse, impulse);
        active += simd_where_less(lower_bound, impulse, bit);
    }
    return active;
}

// The impulse as c - D q.
typedef struct lanes_law {
    mat6 slope;    // D
    simd start[6]; // c
} lanes_law;

static inline bool is_nowhere(simd x)
{
    return simd_less(simd_all(0.0), size_of(x)) == 0;
}

static inline void add_normals(const body_batch *p, size_t lane, const lanes_point *points,
                               lanes_law *law)
{
    simd row[6];

    for (uint32_t k = 0; k < p->n_points; k++) {
        if (is_nowhere(points[k].gain))
            continue;
        if (p->is_flat) {
            // Add a point where all normals are that of the constraint: its row is (0, 0, 1, y, -x, 0).
            const simd x = points[k].x, y = points[k].y, gain = points[k].gain,
                       bias = points[k].bias;
            simd(*flat)[6] = law->slope.row;
            flat[2][2] += gain;
            flat[3][2] += gain * y;
            flat[3][3] += gain * y * y;
            flat[4][2] -= gain * x;
            flat[4][3] -= gain * x * y;
            flat[4][4] += gain * x * x;
            law->start[2] += bias;
            law->start[3] += bias * y;
            law->start[4] -= bias * x;
            continue;
        }
        find_row(&p->point[k], lane, row);
        mat6_add_square(&law->slope, points[k].gain, row);
        for (int m = 0; m < 6; m++)
            law->start[m] += points[k].bias * row[m];
    }
}

// Add friction with a secant coefficient, N s/m, that acts in (x, y) on the slip there.
static inline void add_secant(lanes_law *law, simd secant, simd x, simd y)
{
    simd(*row)[6] = law->slope.row;

    row[0][0] += secant;
    row[1][1] += secant;
    row[5][0] -= secant * y;
    row[5][1] += secant * x;
    row[5][5] += secant * (x * x + y * y);
}

// The secant coefficient of (7) for a normal impulse and a slip.
static inline simd find_secant(const body_batch *p, size_t lane, simd impulse, simd slip_x,
                               simd slip_y)
{
    return friction_secants(simd_load(p->friction + lane), impulse, simd_load(p->rate + lane),
                            simd_sqrt(slip_x * slip_x + slip_y * slip_y));
}

// The secant coefficient of (8), about the normal, with the radius of gyration of the pressure about its centre.
static inline simd find_spin_secant(const body_batch *p, size_t lane, const lanes_point *points,
                                    simd x, simd y, simd impulse, simd divisor, simd spin)
{
    simd sum = simd_all(0.0);

    for (uint32_t k = 0; k < p->n_points; k++) {
        const simd dx = points[k].x - x, dy = points[k].y - y;
        sum += size_of(points[k].impulse) * (dx * dx + dy * dy);
    }
    const simd flat =
        simd_min(simd_sqrt(sum / divisor) / simd_load(p->gyration + lane), simd_all(1.0));
    return friction_secants(simd_load(p->spin_friction + lane) * flat, impulse,
                            simd_load(p->spin_rate + lane), size_of(spin));
}

// Add the friction of the belt, by the slip in the centre of pressure.
static inline void add_belt(const body_batch *p, size_t lane, const lanes_point *points,
                            simd impulse, const simd q[6], lanes_law *law)
{
    const simd zero = simd_all(0.0), one = simd_all(1.0), turn = simd_load(p->belt_turn + lane);
    const simd divisor = simd_select_less(zero, impulse, impulse, one);
    simd x = zero, y = zero, sum = zero, secant_x = zero, secant_y = zero;

    for (uint32_t k = 0; k < p->n_points; k++) {
        x += size_of(points[k].impulse) * points[k].x / divisor;
        y += size_of(points[k].impulse) * points[k].y / divisor;
    }
    const simd vx = q[0] - y * q[5], vy = q[1] + x * q[5];
    for (uint32_t k = 0; k < p->n_points; k++) {
        const lanes_point *point = &points[k];
        const simd belt_x = simd_load(p->point[k].belt_velocity[0] + lane) - turn * y,
                   belt_y = simd_load(p->point[k].belt_velocity[1] + lane) + turn * x;
        const simd secant = find_secant(p, lane, point->impulse, vx - belt_x, vy - belt_y);
        law->start[0] += secant * belt_x;
        law->start[1] += secant * belt_y;
        law->start[5] += secant * (point->x * belt_y - point->y * belt_x);
        sum += secant;
        secant_x += secant * point->x;
        secant_y += secant * point->y;
    }
    const simd mean = simd_select_less(zero, sum, sum, one);
    add_secant(law, sum, secant_x / mean, secant_y / mean);
    const simd spin = find_spin_secant(p, lane, points, x, y, impulse, divisor, q[5] - turn);
    law->slope.row[5][5] += spin;
    law->start[5] += spin * turn;
}

// Solve (M + D) dq = c - D q - impulse, where q includes the impulse so far. *ret_more is M dq.
static inline void solve_law(const body_batch *p, size_t lane, const lanes_law *law,
                             const simd q[6], simd ret_dq[6], simd ret_more[6])
{
    simd rest[6], slowed[6];
    mat6 m;

    mat6_apply(&law->slope, q, slowed);
#pragma GCC unroll 6
    for (int i = 0; i < 6; i++) {
        ret_dq[i] = rest[i] = law->start[i] - slowed[i] - simd_load(p->impulse[i] + lane);
#pragma GCC unroll 6
        for (int j = 0; j <= i; j++)
            m.row[i][j] = law->slope.row[i][j] + simd_load(p->inertia[body_entry(i, j)] + lane);
    }
    mat6_factor(&m);
    mat6_solve(&m, ret_dq);
    mat6_apply(&law->slope, ret_dq, slowed);
    for (int i = 0; i < 6; i++)
        ret_more[i] = rest[i] - slowed[i];
}

// Take the normal impulses in lanes that are on. Returns their sums.
static inline simd take_impulses(const body_batch *p, simd on, const simd *impulses,
                                 lanes_point *points)
{
    simd sum = simd_all(0.0);

    for (uint32_t k = 0; k < p->n_points; k++) {
        points[k].impulse = choose(on, impulses[k], points[k].impulse);
        sum += size_of(points[k].impulse);
    }
    return sum;
}

// Update active points and secants until they no longer change much, each lane for itself: lanes that are on. Returns the
// sums of normal impulses; *ret_more is the change of the impulse.
static inline simd iterate(const body_batch *p, size_t lane, simd on, simd active, const simd q[6],
                           lanes_point *points, simd ret_more[6])
{
    const bool has_friction = !is_nowhere(simd_load(p->friction + lane));
    simd sum = simd_load(p->normal_impulse + lane), q_end[6], dq[6], more[6];
    simd impulses[BODY_CONSTRAINT_POINTS];

    memcpy(q_end, q, sizeof q_end);
    for (int iteration = 0; iteration < ITERATIONS && !is_nowhere(on); iteration++) {
        const simd before = sum, active_before = active;
        lanes_law law = { 0 };
        add_normals(p, lane, points, &law);
        if (p->is_belt)
            add_belt(p, lane, points, sum, q_end, &law);
        else if (has_friction) {
            for (uint32_t k = 0; k < p->n_points; k++) {
                const lanes_point *point = &points[k];
                if (is_nowhere(point->impulse))
                    continue;
                const simd secant =
                    find_secant(p, lane, point->impulse, q_end[0] - point->y * q_end[5],
                                q_end[1] + point->x * q_end[5]);
                add_secant(&law, secant, point->x, point->y);
            }
        }
        solve_law(p, lane, &law, q, dq, more);
        for (int k = 0; k < 6; k++) {
            q_end[k] = q[k] + dq[k];
            ret_more[k] = choose(on, more[k], ret_more[k]);
        }
        active = find_active(p, lane, q_end, points, impulses);
        sum = choose(on, take_impulses(p, on, impulses, points), sum);
        const simd changed = simd_where_less(simd_all(0.0), size_of(active - active_before), on);
        on = simd_max(changed, simd_where_less(SETTLED * before, sum, on));
    }
    return sum;
}

static void solve_lanes(body_solver_body *bodies, body_batch *p, size_t lane)
{
    lanes_point points[BODY_CONSTRAINT_POINTS];
    simd q[6], impulse[6], more[6] = { 0 }, impulses[BODY_CONSTRAINT_POINTS];

    for (uint32_t k = 0; k < p->n_points; k++) {
        points[k].x = simd_load(p->point[k].x + lane);
        points[k].y = simd_load(p->point[k].y + lane);
        points[k].impulse = simd_load(p->point[k].normal_impulse + lane);
    }
    lanes_ends e = load_ends(bodies, p, lane);
    find_relative_velocity(p, lane, &e, q);
    const simd active = find_active(p, lane, q, points, impulses);
    load_impulse(p, lane, impulse);
    const simd on =
        simd_max(simd_where_less(simd_all(0.0), active, simd_all(1.0)), find_nonzero(impulse));
    if (is_nowhere(on))
        return;
    if (!p->has_inertia)
        for (size_t k = 0; k < p->n; k += SIMD_LANES)
            find_inertia(bodies, p, k);
    p->has_inertia = true;
    simd_store(p->normal_impulse + lane, iterate(p, lane, on, active, q, points, more));
    for (int k = 0; k < 6; k++)
        simd_store(p->impulse[k] + lane, choose(on, impulse[k] + more[k], impulse[k]));
    for (uint32_t k = 0; k < p->n_points; k++)
        simd_store(p->point[k].normal_impulse + lane, points[k].impulse);
    apply_impulse(bodies, p, lane, &e, on, more);
}

static void solve(body_solver_body *bodies, body_batch *batch)
{
    for (size_t lane = 0; lane < batch->n; lane += SIMD_LANES)
        solve_lanes(bodies, batch, lane);
}

extern const body_kernels CPU_NAME(body_kernels);

const body_kernels CPU_NAME(body_kernels) = { .warm_start = warm_start, .solve = solve };
