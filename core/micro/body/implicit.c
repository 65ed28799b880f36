// Implicit steps in space.
//
// A team meets between the phases of a step. In a phase every member takes its part of the blocks of parts, or
// of the slices of a colour, none of which writes what another one reads.

#include "core/micro/body/implicit.h"
#include "core/base/memory.h"
#include "core/micro/implicit_step.h"

#include <math.h>
#include <string.h>

/// Of the smallest ball around a body: how far parts may move before the list is made anew, twice.
#define SKIN 1.0

/// How far the plates are seen, in radii of the largest ball: as far as a part may come to touch one
/// before the list is made anew.
#define SIGHT 2.0

/// Most rounds that the kinds of parts ask for.
static int find_rounds(const body_state *s)
{
    const double damping = fmax(s->cargo.damping, s->kinds[0].solid.damping);
    int rounds = 1;

    for (size_t k = 0; k < s->n_kinds; k++) {
        const body_kind *kind = &s->kinds[k];
        double stiffness = fmax(s->cargo.stiffness / (2.0 * kind->softness), kind->solid.stiffness);
        int own = implicit_step_iterations(s->n, s->def.dt, stiffness, damping, kind->mass);
        rounds = own > rounds ? own : rounds;
    }
    return rounds;
}

bf_status body__implicit_init(body_state *s, bf_error *err)
{
    s->implicit = memory_alloc(1, sizeof *s->implicit);
    body_solver *z = s->implicit;
    if (z != NULL) {
        z->holds = memory_alloc(s->n, sizeof *z->holds);
        z->movers = memory_alloc(s->n, sizeof *z->movers);
        z->used = memory_alloc(s->n, sizeof *z->used);
        z->shelves = memory_alloc(s->n_blocks, sizeof *z->shelves);
    }
    if (z == NULL || z->holds == NULL || z->movers == NULL || z->used == NULL || z->shelves == NULL)
        return bf_fail(err, BF_ENOMEM, "/initial", "no memory for %zu parts", s->n);
    z->rounds = find_rounds(s);
    z->keep = exp(-s->def.damping * s->def.dt);
    s->list.skin = SKIN * s->reach_min;
    s->map_range = SIGHT * s->reach_max;
    return BF_OK;
}

void body__implicit_fini(body_state *s)
{
    body_solver *z = s->implicit;

    if (z == NULL)
        return;
    memory_free(z->holds);
    memory_free(z->movers);
    memory_free(z->used);
    memory_free(z->shelves);
    memory_free(z->patches);
    memory_free(z->order);
    memory_free(z);
}

/// Room for all patches until the list is stale: one for each pair, and for what solids a part may
/// come near to until then.
static bf_status make_room(body_state *s, bf_error *err)
{
    body_solver *z = s->implicit;
    size_t n = 0;

    for (size_t block = 0; block < s->n_blocks; block++) {
        const size_t begin = body__first_of(block), end = body__last_of(s, block);
        body_shelf *shelf = &z->shelves[block];
        shelf->first = n;
        shelf->room = s->first_pair[end] - s->first_pair[begin] + 1;
        for (size_t k = begin; k < end; k++)
            shelf->room += 1 + body__solids_count(s, k, s->list.skin);
        n += shelf->room;
    }
    if (memory_reserve(&z->patches, &z->patches_capacity, n, sizeof *z->patches) != 0 ||
        memory_reserve(&z->order, &z->order_capacity, s->n_pairs, sizeof(void *)) != 0) {
        s->is_listed = false;
        return bf_fail(err, BF_ENOMEM, "", "no memory for the contacts of %zu parts", s->n);
    }
    return BF_OK;
}

static bf_status refresh(void *state, bf_error *err)
{
    body_state *s = state;

    return s->is_listed || (body__list(s, err) == BF_OK && make_room(s, err) == BF_OK) ? BF_OK
                                                                                       : BF_ENOMEM;
}

/// Inverse of a body's inertia in the world's frame.
static mat3 find_give(const body_body *body, vec3 inertia)
{
    const vec3 x = mat3_column(&body->r, 0), y = mat3_column(&body->r, 1),
               z = mat3_column(&body->r, 2);
    mat3 give;

    for (int k = 0; k < 3; k++) {
        vec3 row = vec3_scale(x, vec3_component(x, k) / inertia.x);
        row = vec3_along(row, vec3_component(y, k) / inertia.y, y);
        give.row[k] = vec3_along(row, vec3_component(z, k) / inertia.z, z);
    }
    return give;
}

/// A body as it would move in a step without contacts.
static void predict_part(body_state *s, size_t k, body_shelf *shelf)
{
    const body_body *body = &s->bodies[k];
    const body_kind *kind = &s->kinds[body->kind];
    const vec3 nothing = { 0.0, 0.0, 0.0 };
    body_mover *mover = &s->implicit->movers[k];

    mover->v = vec3_along(vec3_scale(body->v, s->implicit->keep), s->def.dt, s->gravity);
    mover->w = body__turn(s, body, nothing);
    mover->give = 1.0 / kind->mass;
    mover->give_spin = find_give(body, kind->inertia);
    double before = vec3_length(body->v) + s->reach[k] * vec3_length(body->w);
    double then = vec3_length(mover->v) + s->reach[k] * vec3_length(mover->w);
    shelf->speed = fmax(shelf->speed, fmax(before, then));
    shelf->moved2 = fmax(shelf->moved2, body__moved2(s, k));
}

static void predict_block(const driver_member *m, size_t block)
{
    body_state *s = m->state;
    body_shelf *shelf = &s->implicit->shelves[block];

    shelf->speed = shelf->moved2 = 0.0;
    s->reports[block].n_presses = 0;
    for (size_t k = body__first_of(block); k < body__last_of(s, block); k++)
        if (!s->is_gone[k])
            predict_part(s, k, shelf);
}

/// How near parts have to be for this step, m. Returns false if the list does not show all of those.
static bool find_near(const body_state *s, double *ret_near)
{
    const double skin = s->list.skin;
    double speed = 0.0, moved2 = 0.0;

    for (size_t block = 0; block < s->n_blocks; block++) {
        speed = fmax(speed, s->implicit->shelves[block].speed);
        moved2 = fmax(moved2, s->implicit->shelves[block].moved2);
    }
    *ret_near = fmin(2.0 * s->def.dt * speed, 0.5 * skin);
    return neighbours_holds(skin, sqrt(moved2) + 0.5 * *ret_near);
}

static void meet_block(const driver_member *m, size_t block)
{
    const double *near = m->step;

    body_implicit__meet(m->state, block, *near);
}

/// Give the patches of pairs colours that neither part has, in the order of the parts.
static void choose_colours(body_solver *z, size_t n_blocks, size_t *count)
{
    for (size_t block = 0; block < n_blocks; block++) {
        const body_shelf *shelf = &z->shelves[block];
        for (size_t k = shelf->first; k < shelf->first + shelf->n_pairs; k++) {
            body_patch *p = &z->patches[k];
            uint64_t free = ~(z->used[p->a] | z->used[p->b]);
            p->colour = free != 0 ? (uint8_t)__builtin_ctzll(free) : BODY_COLOURS;
            if (free != 0) {
                z->used[p->a] |= 1ULL << p->colour;
                z->used[p->b] |= 1ULL << p->colour;
            }
            count[p->colour]++;
        }
    }
}

static void sort_by_colours(const body_state *s, body_solver *z)
{
    size_t at[BODY_COLOURS + 1] = { 0 };

    memset(z->used, 0, s->n * sizeof *z->used);
    choose_colours(z, s->n_blocks, at);
    z->colour[0] = 0;
    for (int c = 0; c <= BODY_COLOURS; c++) {
        z->colour[c + 1] = z->colour[c] + at[c];
        at[c] = z->colour[c];
    }
    for (size_t block = 0; block < s->n_blocks; block++) {
        const body_shelf *shelf = &z->shelves[block];
        for (size_t k = shelf->first; k < shelf->first + shelf->n_pairs; k++)
            z->order[at[z->patches[k].colour]++] = &z->patches[k];
    }
}

typedef void work_on_patch(const body_solver *z, body_patch *patch);

static void sweep_solids(const driver_member *m, work_on_patch *work)
{
    const body_state *s = m->state;
    const body_solver *z = s->implicit;

    for (size_t block = (size_t)m->index; block < s->n_blocks; block += (size_t)m->n_members) {
        const body_shelf *shelf = &z->shelves[block];
        for (size_t k = shelf->n_pairs; k < shelf->n; k++)
            work(z, &z->patches[shelf->first + k]);
    }
}

/// All patches once. A colour of one slice is the first member's, who need not wait between those.
static void sweep(const driver_member *m, work_on_patch *work)
{
    const body_solver *z = ((const body_state *)m->state)->implicit;
    const size_t *first = z->colour;
    bool is_alone = false;

    sweep_solids(m, work);
    for (int c = 0; c <= BODY_COLOURS; c++) {
        const size_t n = first[c + 1] - first[c];
        const bool is_short = n <= BODY_SLICE || c == BODY_COLOURS;
        if (n == 0)
            continue;
        if (!is_alone || !is_short)
            driver_wait(m);
        is_alone = is_short;
        size_t step = is_short ? n : BODY_SLICE;
        for (size_t k = (size_t)m->index * step; k < n; k += (size_t)m->n_members * step)
            for (size_t at = k; at < k + step && at < n; at++)
                work(z, z->order[first[c] + at]);
    }
    driver_wait(m);
}

static void note_patch(const body_state *s, const body_patch *p, body_report *report)
{
    double radius = s->kinds[s->bodies[p->b].kind].radius;

    if (p->a != BODY_STILL)
        radius = fmin(radius, s->kinds[s->bodies[p->a].kind].radius);
    if (p->floor == NULL && p->press > 0.0 && p->depth > 0.0)
        body__note(report, p->depth, radius);
}

/// Keep the impulses of a block, and move its parts.
static void move_block(const driver_member *m, size_t block)
{
    body_state *s = m->state;
    const body_solver *z = s->implicit;
    const body_shelf *shelf = &z->shelves[block];

    for (size_t k = shelf->first; k < shelf->first + shelf->n; k++) {
        body_implicit__keep(&z->patches[k]);
        note_patch(s, &z->patches[k], &s->reports[block]);
    }
    for (size_t k = body__first_of(block); k < body__last_of(s, block); k++) {
        if (s->is_gone[k])
            continue;
        s->bodies[k].v = z->movers[k].v;
        s->bodies[k].w = z->movers[k].w;
        body__drift(s, k, &s->reports[block]);
    }
}

static void split_blocks(const driver_member *m, driver_work *work)
{
    driver_split(m, 0, ((const body_state *)m->state)->n_blocks, work);
    driver_wait(m);
}

static driver_outcome step(driver_member *m)
{
    body_state *s = m->state;
    double near; // m, gaps that may close in this step

    split_blocks(m, predict_block);
    if (!find_near(s, &near))
        return DRIVER_NOT_MADE;
    m->step = &near;
    split_blocks(m, meet_block);
    if (m->index == 0)
        sort_by_colours(s, s->implicit);
    driver_wait(m);
    sweep(m, body_implicit__begin);
    for (int round = 0; round < s->implicit->rounds; round++)
        sweep(m, body_implicit__relax);
    split_blocks(m, move_block);
    return body__judge(s);
}

const driver_solver body__implicit = {
    .refresh = refresh, .begin = body__begin, .step = step, .end = body__end, .check = body__check
};
