// Implicit steps in space: bursts of them while the list is good.
//
// A team of threads makes step after step and meets between the phases of a step. In a phase every
// member takes its share of the blocks of parts, or of the slices of a colour, none of which writes
// what another one reads. All come to the same decisions from the same figures.

#include "core/base/team.h"
#include "core/micro/body/implicit_priv.h"

#include <math.h>
#include <string.h>

/// What a member of the team knows.
typedef struct worker {
    body_state *s;
    body_solver *z;
    uint64_t n_wanted;
    uint64_t *n_made; // written by the first
    int member;
    int n_members;
    team_barrier *barrier;
    double keep; // what the damping leaves of a velocity
    double near; // m, gaps that may close in this step
} worker;

typedef void work_on(const worker *w, size_t item);

static void share(const worker *w, size_t first, size_t last, work_on *work)
{
    for (size_t item = first + (size_t)w->member; item < last; item += (size_t)w->n_members)
        work(w, item);
}

static void share_blocks(const worker *w, work_on *work)
{
    share(w, 0, w->s->n_blocks, work);
    team_barrier_wait(w->barrier);
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
static void predict_part(const worker *w, size_t k, body_shelf *shelf)
{
    const body_state *s = w->s;
    const body_body *body = &s->bodies[k];
    const body_kind *kind = &s->kinds[body->kind];
    const vec3 nothing = { 0.0, 0.0, 0.0 };
    body_mover *mover = &w->z->movers[k];
    double dx = body->x.x - s->x[k], dy = body->x.y - s->y[k];

    mover->v = vec3_along(vec3_scale(body->v, w->keep), s->def.dt, s->gravity);
    mover->w = body__turn(s, body, nothing);
    mover->give = 1.0 / kind->mass;
    mover->give_spin = find_give(body, kind->inertia);
    double before = vec3_length(body->v) + s->reach[k] * vec3_length(body->w);
    double then = vec3_length(mover->v) + s->reach[k] * vec3_length(mover->w);
    shelf->speed = fmax(shelf->speed, fmax(before, then));
    shelf->moved2 = fmax(shelf->moved2, dx * dx + dy * dy);
}

static void predict_block(const worker *w, size_t block)
{
    body_shelf *shelf = &w->z->shelves[block];

    shelf->speed = shelf->moved2 = 0.0;
    w->s->reports[block].n_presses = 0;
    for (size_t k = body__first_of(block); k < body__last_of(w->s, block); k++)
        if (!w->s->is_gone[k])
            predict_part(w, k, shelf);
}

/// How near parts have to be for this step. Returns false if the list does not show all of those.
static bool find_near(worker *w)
{
    const double skin = w->s->list.skin;
    double speed = 0.0, moved2 = 0.0;

    for (size_t block = 0; block < w->s->n_blocks; block++) {
        speed = fmax(speed, w->z->shelves[block].speed);
        moved2 = fmax(moved2, w->z->shelves[block].moved2);
    }
    w->near = fmin(2.0 * w->s->def.dt * speed, 0.5 * skin);
    return 2.0 * sqrt(moved2) + w->near <= skin;
}

static void meet_block(const worker *w, size_t block)
{
    body_implicit__meet(w->s, block, w->near);
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

static void sweep_solids(const worker *w, work_on_patch *work)
{
    for (size_t block = (size_t)w->member; block < w->s->n_blocks; block += (size_t)w->n_members) {
        const body_shelf *shelf = &w->z->shelves[block];
        for (size_t k = shelf->n_pairs; k < shelf->n; k++)
            work(w->z, &w->z->patches[shelf->first + k]);
    }
}

/// All patches once. A colour of one slice is the first member's, who need not wait between those.
static void sweep(const worker *w, work_on_patch *work)
{
    const size_t *first = w->z->colour;
    bool is_alone = false;

    sweep_solids(w, work);
    for (int c = 0; c <= BODY_COLOURS; c++) {
        const size_t n = first[c + 1] - first[c];
        const bool is_short = n <= BODY_SLICE || c == BODY_COLOURS;
        if (n == 0)
            continue;
        if (!is_alone || !is_short)
            team_barrier_wait(w->barrier);
        is_alone = is_short;
        size_t step = is_short ? n : BODY_SLICE;
        for (size_t k = (size_t)w->member * step; k < n; k += (size_t)w->n_members * step)
            for (size_t m = k; m < k + step && m < n; m++)
                work(w->z, w->z->order[first[c] + m]);
    }
    team_barrier_wait(w->barrier);
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
static void move_block(const worker *w, size_t block)
{
    const body_shelf *shelf = &w->z->shelves[block];
    body_state *s = w->s;

    for (size_t k = shelf->first; k < shelf->first + shelf->n; k++) {
        body_implicit__keep(&w->z->patches[k]);
        note_patch(s, &w->z->patches[k], &s->reports[block]);
    }
    for (size_t k = body__first_of(block); k < body__last_of(s, block); k++) {
        if (s->is_gone[k])
            continue;
        s->bodies[k].v = w->z->movers[k].v;
        s->bodies[k].w = w->z->movers[k].w;
        body__drift(s, k, &s->reports[block]);
    }
}

static bool is_well(const body_state *s)
{
    bool is_well = true;

    for (size_t block = 0; block < s->n_blocks; block++)
        is_well = is_well && s->reports[block].bad_part == SIZE_MAX;
    return is_well;
}

/// A member's part of a step. Returns false, with nothing done, if the list is stale.
static bool make_step(worker *w)
{
    share_blocks(w, predict_block);
    if (!find_near(w))
        return false;
    share_blocks(w, meet_block);
    if (w->member == 0)
        sort_by_colours(w->s, w->z);
    team_barrier_wait(w->barrier);
    sweep(w, body_implicit__begin);
    for (int round = 0; round < w->z->rounds; round++)
        sweep(w, body_implicit__relax);
    share_blocks(w, move_block);
    return true;
}

static void make_burst(void *context, int member, int n_members, team_barrier *barrier)
{
    worker w = *(const worker *)context;
    uint64_t n = 0;
    bool is_good = true;

    w.member = member;
    w.n_members = n_members;
    w.barrier = barrier;
    while (n < w.n_wanted && is_good && make_step(&w)) {
        n++;
        is_good = is_well(w.s);
        team_barrier_wait(barrier);
    }
    if (member == 0)
        *w.n_made = n;
}

uint64_t body_implicit__burst(body_state *s, uint64_t n)
{
    uint64_t n_made = 0;
    worker w = { .s = s,
                 .z = s->implicit,
                 .n_wanted = n,
                 .n_made = &n_made,
                 .keep = exp(-s->def.damping * s->def.dt) };

    team_run(s->def.n_threads, make_burst, &w);
    s->steps += n_made;
    return n_made;
}
