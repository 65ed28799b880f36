// Implicit steps: bursts of them between two choices of pairs.
//
// In a burst a team of threads makes step after step and meets between the phases of a step. In a phase
// every member takes its share of the chunks of places or of the pieces of a group, none of which
// writes what another one reads. All come to the same decisions from the same extremes.

#include "core/base/team.h"
#include "core/micro/disk/implicit_priv.h"

#include <math.h>

typedef struct burst {
    disk_state *s;
    implicit_state *z;
    implicit_step step;
    uint64_t n_wanted;
    uint64_t n_made; // by every member alike; written by the first
    bool is_suspect; // the same
} burst;

// What a member of the team knows.
typedef struct worker {
    const burst *b;
    disk_state *s;
    implicit_state *z;
    int member;
    int n_members;
    team_barrier *barrier;
    double near; // m, gaps that may close in this step
} worker;

typedef void work_on(const worker *w, size_t item);

// Items first .. last - 1, shared out.
static void share(const worker *w, size_t first, size_t last, work_on *work)
{
    for (size_t item = first + (size_t)w->member; item < last; item += (size_t)w->n_members)
        work(w, item);
}

// The pieces of one group after those of the other. Groups of one piece are all the first member's, who
// need not wait between them.
static void share_groups(const worker *w, work_on *work)
{
    const size_t *piece = w->z->group_piece;
    bool is_alone = true;

    for (size_t g = 0; g < IMPLICIT_GROUPS; g++) {
        const size_t n = piece[g + 1] - piece[g];
        if (n == 0)
            continue;
        if (n > 1 || !is_alone)
            team_barrier_wait(w->barrier);
        is_alone = n == 1;
        share(w, piece[g], piece[g + 1], work);
    }
    team_barrier_wait(w->barrier);
}

static size_t count_chunks(const disk_state *s)
{
    return (s->n_padded + IMPLICIT_CHUNK - 1) / IMPLICIT_CHUNK;
}

// Up to the next group of parts; places between the last part and that are pads.
static size_t end_of_chunk(const disk_state *s, size_t chunk)
{
    size_t end = (chunk + 1) * IMPLICIT_CHUNK;

    return end < s->n_padded ? end : s->n_padded;
}

static implicit_extremes join_chunks(const worker *w)
{
    implicit_extremes all = { 0 };

    for (size_t c = 0; c < count_chunks(w->s); c++) {
        const implicit_extremes *e = &w->z->extremes[c];
        all.speed2 = e->speed2 > all.speed2 ? e->speed2 : all.speed2;
        all.sum += e->sum;
    }
    return all;
}

static void predict_chunk(const worker *w, size_t chunk)
{
    w->z->extremes[chunk] = w->z->kernels->predict(
        w->s, &w->b->step, w->z->bodies, chunk * IMPLICIT_CHUNK, end_of_chunk(w->s, chunk));
}

static void pull_chunk(const worker *w, size_t chunk)
{
    w->z->kernels->pull(w->s, &w->b->step, w->z->bodies, chunk * IMPLICIT_CHUNK,
                        end_of_chunk(w->s, chunk));
}

static void move_chunk(const worker *w, size_t chunk)
{
    w->z->extremes[chunk] =
        w->z->kernels->move(w->s, w->z->bodies, chunk * IMPLICIT_CHUNK, end_of_chunk(w->s, chunk));
}

static void meet_piece(const worker *w, size_t piece)
{
    disk_implicit__meet(w->s, w->z, piece, w->near);
}

static void relax_piece(const worker *w, size_t piece)
{
    const implicit_piece *p = &w->z->pieces[piece];

    w->z->kernels->relax(w->z->bodies, &w->z->blocks[p->block], p->n_blocks);
}

static void keep_piece(const worker *w, size_t piece)
{
    disk_implicit__keep(w->z, piece);
}

static void look_share(const worker *w, size_t k)
{
    const disk_share *of = &w->s->shares[k];

    disk__look(w->s, w->s->now, of->watch_first, of->watch_last, DISK_GONE);
}

// A member's part of a step.
static void make_step(worker *w)
{
    const size_t n_chunks = count_chunks(w->s);

    share(w, 0, n_chunks, predict_chunk);
    team_barrier_wait(w->barrier);
    w->near = 2.0 * w->s->def.dt * sqrt(join_chunks(w).speed2);
    share_groups(w, meet_piece);
    for (int round = 0; round < w->z->rounds; round++) {
        if (round > 0) {
            share(w, 0, n_chunks, pull_chunk);
            team_barrier_wait(w->barrier);
        }
        share_groups(w, relax_piece);
    }
    share(w, 0, w->z->group_piece[IMPLICIT_GROUPS], keep_piece);
    share(w, 0, n_chunks, move_chunk);
    team_barrier_wait(w->barrier);
    share(w, 0, (size_t)w->s->n_shares, look_share);
}

static void raise_overlaps(disk_state *s, const implicit_state *z)
{
    for (size_t k = 0; k < z->group_piece[IMPLICIT_GROUPS]; k++) {
        const implicit_piece *p = &z->pieces[k];
        s->largest_overlap = p->overlap > s->largest_overlap ? p->overlap : s->largest_overlap;
        s->overlap_share = p->share > s->overlap_share ? p->share : s->overlap_share;
    }
}

// A member's part of a burst: at least one step, until all are made, the pairs or the list are stale or
// something is wrong.
static void make_burst(void *context, int member, int n_members, team_barrier *barrier)
{
    burst *b = context;
    disk_state *s = b->s;
    implicit_state *z = b->z;
    worker w = { b, s, z, member, n_members, barrier, 0.0 };
    double travel = z->travel, list_travel = s->travel, move = 0.0;
    bool is_suspect = false, is_stale = false;
    uint64_t k = 0;

    for (; k < b->n_wanted && !is_stale && !is_suspect; k++) {
        make_step(&w);
        implicit_extremes e = join_chunks(&w);
        move = s->def.dt * sqrt(e.speed2);
        travel += move;
        list_travel += move;
        is_suspect = !isfinite(e.sum) || move > 0.5 * s->radius_min;
        is_stale = disk_implicit__is_stale(z, travel, move) ||
                   disk_implicit__is_list_stale(s, list_travel, move);
        if (member == 0)
            raise_overlaps(s, z);
        team_barrier_wait(barrier);
    }
    if (member != 0)
        return;
    b->n_made = k;
    b->is_suspect = is_suspect;
    z->move = move;
    z->travel = travel;
    s->travel = list_travel;
}

uint64_t disk_implicit__burst(disk_state *s, implicit_state *z, uint64_t n, bool *ret_suspect)
{
    const double h = s->def.dt;
    burst b = { .s = s,
                .z = z,
                .step = { .keep = exp(-s->def.damping * h),
                          .drag = h * s->belt.friction * s->def.gravity * s->belt.tanh_linear },
                .n_wanted = n };

    team_run(s->n_shares, make_burst, &b);
    s->steps += b.n_made;
    *ret_suspect = b.is_suspect;
    return b.n_made;
}
