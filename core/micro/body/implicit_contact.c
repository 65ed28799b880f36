// The patches of a step, each from the region in which two bodies touch or come near each other.

#include "core/micro/body/implicit.h"

#include "core/base/check.h"

#include <math.h>
#include <string.h>

/// Most points that overlap where others are coming.
#define BELOW_MAX 5

/// Points of a region.
typedef struct spots {
    const body_region *region;
    size_t n;
    size_t n_below; // that overlap; they stand first if the region is one of hulls
} spots;

static body_spot spot_of(const spots *from, size_t k)
{
    const body_region *region = from->region;

    if (region->is_round)
        return region->spots[k];
    const manifold_point *point = &region->hull.point[k];
    return (body_spot){ point->at, region->hull.normal, point->depth, point->weight };
}

static spots find_spots(const body_region *region)
{
    size_t n = region->is_round ? region->n_spots : region->hull.n;

    return (spots){ region, n, region->is_round ? n : region->hull.n_below };
}

/// Middle and mean normal of the points; those that are coming count where none overlaps.
static vec3 find_middle(const spots *from, vec3 *ret_normal)
{
    const size_t n = from->n_below > 0 ? from->n_below : from->n;
    vec3 middle = { 0.0, 0.0, 0.0 }, normal = middle;
    double sum = 0.0;

    for (size_t k = 0; k < n; k++) {
        body_spot spot = spot_of(from, k);
        middle = vec3_along(middle, spot.share, spot.at);
        normal = vec3_along(normal, spot.share, spot.normal);
        sum += spot.share;
    }
    *ret_normal = n == 1 || !from->region->is_round ? spot_of(from, 0).normal : vec3_unit(normal);
    return vec3_scale(middle, 1.0 / sum);
}

static void add_share(body_point *to, const body_point *from)
{
    to->x += from->share * from->x;
    to->y += from->share * from->y;
    to->depth += from->share * from->depth;
    to->share += from->share;
}

/// A point in the middle of n points of a face, which have one normal.
static body_point join_points(const body_point *points, size_t n)
{
    body_point joint = { .normal = points[0].normal };

    if (n == 1)
        return points[0];
    for (size_t k = 0; k < n; k++)
        add_share(&joint, &points[k]);
    joint.x /= joint.share;
    joint.y /= joint.share;
    joint.depth /= joint.share;
    return joint;
}

/// Sum of share r^2 about a middle.
static double find_spread(const body_point *points, size_t n, const body_point *middle)
{
    double sum = 0.0;

    for (size_t k = 0; k < n; k++) {
        double x = points[k].x - middle->x, y = points[k].y - middle->y;
        sum += points[k].share * (x * x + y * y);
    }
    return sum;
}

/// No more than `most` points of n that stand for a face: neighbours are joined, and then moved apart
/// until they are as spread out as all were. So forces and torques stay what they are.
static size_t thin_out(body_point *points, size_t n, size_t most)
{
    if (n <= most)
        return n;
    const body_point middle = join_points(points, n);
    double before = find_spread(points, n, &middle);

    for (size_t k = 0; k < most; k++) {
        size_t first = k * n / most, last = (k + 1) * n / most;
        points[k] = join_points(&points[first], last - first);
    }
    double after = find_spread(points, most, &middle);
    double factor = after > 0.0 ? sqrt(before / after) : 1.0;
    for (size_t k = 0; k < most; k++) {
        points[k].x = middle.x + factor * (points[k].x - middle.x);
        points[k].y = middle.y + factor * (points[k].y - middle.y);
        points[k].depth = middle.depth + factor * (points[k].depth - middle.depth);
    }
    return most;
}

/// All points of the region in the axes of the patch, those that overlap first, then thinned out.
static void take_points(const spots *from, vec3 middle, body_patch *p)
{
    body_point points[MANIFOLD_POINTS_MAX];

    for (size_t k = 0; k < from->n; k++) {
        body_spot spot = spot_of(from, k);
        vec3 to = vec3_sub(spot.at, middle), n = spot.normal;
        points[k] = (body_point){
            .x = vec3_dot(p->axis[0], to),
            .y = vec3_dot(p->axis[1], to),
            .normal = { vec3_dot(p->axis[0], n), vec3_dot(p->axis[1], n), vec3_dot(p->axis[2], n) },
            .depth = spot.depth,
            .share = spot.share,
        };
    }
    size_t n_coming = from->n - from->n_below;
    size_t below = thin_out(points, from->n_below, n_coming > 0 ? BELOW_MAX : BODY_POINTS);
    size_t coming = thin_out(&points[from->n_below], n_coming, BODY_POINTS - below);
    memcpy(p->point, points, below * sizeof *points);
    memcpy(&p->point[below], &points[from->n_below], coming * sizeof *points);
    p->n = (uint32_t)(below + coming);
}

static void find_gains(const body_state *s, const micro_law *law, body_patch *p)
{
    const double h = s->def.dt, joint = h * law->stiffness + law->damping;

    for (uint32_t k = 0; k < p->n; k++) {
        body_point *point = &p->point[k];
        double pressed = point->depth > 0.0 ? point->depth : 0.0;
        point->gain = point->share * h * joint;
        point->bias = point->share * (joint * point->depth - law->damping * pressed);
        point->is_stuck = s->def.tension && point->depth > 0.0;
    }
}

/// The impulse of the last step in the axes of this one, and shared out to the points.
static void take_impulse(const body_hold *before, body_patch *p)
{
    double sum = 0.0;

    if (before == NULL || before->key == 0)
        return;
    for (int k = 0; k < 3; k++) {
        p->impulse[k] = vec3_dot(p->axis[k], before->push);
        p->impulse[3 + k] = vec3_dot(p->axis[k], before->twist);
    }
    p->press = fmax(0.0, p->impulse[2]);
    for (uint32_t k = 0; k < p->n; k++)
        sum += p->point[k].share;
    for (uint32_t k = 0; k < p->n; k++)
        p->point[k].press = p->press * p->point[k].share / sum;
}

/// The vector in the axes of the patch.
static vec3 to_axes(const body_patch *p, vec3 a)
{
    return (vec3){ vec3_dot(p->axis[0], a), vec3_dot(p->axis[1], a), vec3_dot(p->axis[2], a) };
}

/// Column k of a symmetric matrix in the axes of the patch.
static vec3 turn_column(const body_patch *p, const mat3 *m, int k)
{
    return to_axes(p, mat3_apply(m, p->axis[k]));
}

/// r x a for the axis a = k.
static vec3 cross_axis(vec3 r, int k)
{
    const vec3 rows[] = { { 0.0, r.z, -r.y }, { -r.z, 0.0, r.x }, { r.y, -r.x, 0.0 } };

    return rows[k];
}

/// Add what impulses in the middle, in the axes of the patch, change a body's velocity there by.
static void add_give(const body_patch *p, const body_mover *mover, vec3 lever, mat6 *give)
{
    const vec3 r = to_axes(p, lever);
    mat3 j; // symmetric, so that its rows are its columns
    vec3 arm[6], turn[6];

    for (int k = 0; k < 3; k++) {
        j.row[k] = turn_column(p, &mover->give_spin, k);
        arm[k] = cross_axis(r, k);
        arm[3 + k] = (vec3){ k == 0 ? 1.0 : 0.0, k == 1 ? 1.0 : 0.0, k == 2 ? 1.0 : 0.0 };
    }
    for (int k = 0; k < 6; k++)
        turn[k] = k < 3 ? mat3_apply(&j, arm[k]) : j.row[k - 3];
    for (int i = 0; i < 6; i++)
        for (int k = 0; k <= i; k++)
            give->row[i][k] += vec3_dot(arm[i], turn[k]);
    for (int k = 0; k < 3; k++)
        give->row[k][k] += mover->give;
}

/// The inertia of one body in the middle of its patch.
static void find_own_inertia(const body_state *s, body_patch *p)
{
    const body_body *body = &s->bodies[p->b];
    const body_kind *kind = &s->kinds[body->kind];
    const vec3 r = to_axes(p, p->lever[1]), i = kind->inertia;
    double(*row)[6] = p->inertia.row, square = vec3_dot(r, r);
    vec3 own[3];

    for (int k = 0; k < 3; k++) {
        own[k] = mat3_apply_back(&body->r, p->axis[k]);
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

/// The inertia that a patch meets: two bodies give way as the sum of both.
static void find_inertia(const body_state *s, body_patch *p)
{
    const body_solver *z = s->implicit;
    mat6 give = { { { 0.0 } } };

    if (p->a == BODY_STILL) {
        find_own_inertia(s, p);
        return;
    }
    add_give(p, &z->movers[p->a], p->lever[0], &give);
    add_give(p, &z->movers[p->b], p->lever[1], &give);
    mat6_factor(&give);
    mat6_invert(&give, &p->inertia);
}

// What the patches of a step are made with.
typedef struct body_touch {
    uint32_t a;              // as in a patch
    uint32_t b;              // same
    const micro_law *law;    // of the contact
    const body_kind *floor;  // as in a patch
    const body_hold *before; // its impulse in the step before; NULL: none
} body_touch;

static void set_axes(const body_touch *touch, vec3 normal, body_patch *p)
{
    p->axis[2] = normal;
    p->axis[0] = touch->floor != NULL ? (vec3){ 1.0, 0.0, 0.0 } : vec3_aside(normal);
    p->axis[1] = vec3_cross(normal, p->axis[0]);
}

// Make the patch of a region. Returns false, with no use of it, if it has no points.
static bool make_patch(const body_state *s, const body_touch *touch, const body_region *region,
                       body_patch *ret_patch)
{
    const spots from = find_spots(region);
    body_patch *p = ret_patch;
    vec3 normal;

    if (from.n == 0)
        return false;
    const vec3 middle = find_middle(&from, &normal);
    *p = (body_patch){ .a = touch->a,
                       .b = touch->b,
                       .floor = touch->floor,
                       .is_flat = from.n == 1 || !region->is_round,
                       .friction = touch->law->friction,
                       .rate = touch->law->tanh_linear };
    set_axes(touch, normal, p);
    p->lever[1] = vec3_sub(middle, s->bodies[p->b].x);
    if (p->a != BODY_STILL)
        p->lever[0] = vec3_sub(middle, s->bodies[p->a].x);
    take_points(&from, middle, p);
    for (uint32_t k = 0; k < p->n; k++)
        p->depth = k == 0 ? p->point[k].depth : fmax(p->depth, p->point[k].depth);
    find_gains(s, touch->law, p);
    take_impulse(touch->before, p);
    find_inertia(s, p);
    return true;
}

enum { KEY_FLOOR = 1, KEY_SOLIDS = 2 }; // of holds: then walls and plates by their numbers

static const manifold_plane floor_plane = { .normal = { 0.0, 0.0, 1.0 } };

/// Room for one more patch.
static body_patch *next_patch(const body_solver *z, const body_shelf *shelf)
{
    BF_CHECK(shelf->n < shelf->room);
    return &z->patches[shelf->first + shelf->n];
}

static void meet_pair(const body_state *s, double near, body_pair *pair, body_shelf *shelf)
{
    const body_kind *kind_a = &s->kinds[s->bodies[pair->a].kind];
    const body_kind *kind_b = &s->kinds[s->bodies[pair->b].kind];
    const micro_law law = body__law(s, kind_a, kind_b);
    const body_touch touch = { pair->a, pair->b, &law, NULL, &pair->hold };
    body_region region;

    if (!body__find_pair(s, near, pair, &region)) {
        pair->hold = (body_hold){ 0 };
        return;
    }
    body_patch *patch = next_patch(s->implicit, shelf);
    if (!make_patch(s, &touch, &region, patch)) {
        pair->hold = (body_hold){ 0 };
        return;
    }
    patch->hold = &pair->hold;
    patch->key = 1;
    shelf->n++;
}

/// A part that meets solids.
typedef struct visitor {
    const body_state *s;
    body_shelf *shelf;
    const body_hold *before; // of the part
    body_hold *after;        // same, being written
    size_t n_after;
} visitor;

static const body_hold *find_hold(const body_hold *holds, uint32_t key)
{
    for (size_t k = 0; k < BODY_HOLDS; k++)
        if (holds[k].key == key)
            return &holds[k];
    return NULL;
}

/// Returns the patch; NULL if there is no point.
static body_patch *add_solid(visitor *v, size_t k, const micro_law *law, uint32_t key,
                             const body_kind *floor, const body_region *region)
{
    const body_touch touch = { BODY_STILL, (uint32_t)k, law, floor, find_hold(v->before, key) };
    body_patch *patch = next_patch(v->s->implicit, v->shelf);

    if (!make_patch(v->s, &touch, region, patch))
        return NULL;
    if (v->n_after < BODY_HOLDS)
        patch->hold = &v->after[v->n_after++];
    patch->key = key;
    v->shelf->n++;
    return patch;
}

static void visit_solid(void *context, size_t k, const micro_law *law, uint32_t solid,
                        const body_region *region)
{
    (void)add_solid(context, k, law, KEY_SOLIDS + solid, NULL, region);
}

/// The belts under the points of a patch.
static void find_drives(body_state *s, size_t k, body_patch *patch)
{
    const vec3 middle = vec3_add(s->bodies[k].x, patch->lever[1]);
    vec3 belt;
    bool is_one = body__is_on_one_belt(s, k, &belt);

    for (uint32_t m = 0; m < patch->n; m++) {
        body_point *point = &patch->point[m];
        if (!is_one)
            (void)body__belt_at(s, middle.x + point->x, middle.y + point->y, &belt);
        point->drive[0] = belt.x;
        point->drive[1] = belt.y;
    }
}

static void meet_floor(body_state *s, size_t k, double near, visitor *v)
{
    const body_body *body = &s->bodies[k];
    const body_kind *kind = &s->kinds[body->kind];
    body_region region;

    if (body->x.z >= s->reach[k] + near)
        return;
    body__find_at_plane(s, body, &floor_plane, near, &region);
    body_patch *patch = add_solid(v, k, &kind->floor, KEY_FLOOR, kind, &region);
    if (patch != NULL)
        find_drives(s, k, patch);
}

static void meet_solids(body_state *s, size_t k, double near, body_shelf *shelf)
{
    body_hold before[BODY_HOLDS], *holds = s->implicit->holds[k];
    visitor v = { .s = s, .shelf = shelf, .before = before, .after = holds };

    for (size_t m = 0; m < BODY_HOLDS; m++) {
        before[m] = holds[m];
        holds[m] = (body_hold){ 0 };
    }
    body__solids_visit(s, k, near, visit_solid, &v);
    meet_floor(s, k, near, &v);
}

void body_implicit__meet(body_state *s, size_t block, double near)
{
    body_shelf *shelf = &s->implicit->shelves[block];
    const size_t first = body__first_of(block), last = body__last_of(s, block);

    shelf->n = 0;
    for (size_t p = s->first_pair[first]; p < s->first_pair[last]; p++)
        meet_pair(s, near, &s->pairs[p], shelf);
    shelf->n_pairs = shelf->n;
    for (size_t k = first; k < last; k++)
        if (!s->is_gone[k])
            meet_solids(s, k, near, shelf);
}
