// Explicit steps: bursts of them between two lists of neighbours.
//
// In a burst a team of threads makes step after step, each its shares of the groups, and meets once a
// step. A thread writes rows, headings, pushes, watches and what is under them of its own shares only; it
// reads all rows of `now`. All come to the same decisions from the same extremes.

#include "core/micro/disk/disk_priv.h"
#include "core/micro/disk/kernels.h"

#include "core/base/team.h"

#include <math.h>

#define X(suffix) extern const disk_kernels disk_kernels_##suffix;
CPU_EACH_BUILD(X)
#undef X

const disk_kernels *disk_kernels_of(cpu_level level)
{
    static const disk_kernels *const builds[] = {
#define X(suffix) &disk_kernels_##suffix,
        CPU_EACH_BUILD(X)
#undef X
    };

    return builds[level];
}

enum { TURNS = 2 }; // extremes of one step are read while those of the next are written

// A share's extremes, in cache lines of their own.
typedef struct share_extremes {
    _Alignas(128) disk_extremes of;
} share_extremes;

typedef struct burst {
    disk_state *s;
    const disk_kernels *kernels;
    disk_step step;
    uint64_t n_wanted;
    uint64_t n_made; // by every member alike; written by the first
    double travel;   // the same
    double move;     // the same, of the last step
    bool is_suspect; // the same
    disk_extremes largest;
    share_extremes extremes[TURNS][DISK_SHARES_MAX];
} burst;

static double larger(double a, double b)
{
    return a > b ? a : b;
}

void disk__join_extremes(disk_extremes *all, const disk_extremes *more)
{
    all->speed2 = larger(all->speed2, more->speed2);
    all->overlap = larger(all->overlap, more->overlap);
    all->overlap_share = larger(all->overlap_share, more->overlap_share);
    all->sum += more->sum;
}

bool disk__is_suspect(const disk_state *s, const disk_extremes *of_step, double move)
{
    return !isfinite(of_step->sum) || move > 0.5 * s->radius_min;
}

void disk__count_steps(disk_state *s, uint64_t n, double travel, double move,
                       const disk_extremes *largest)
{
    s->steps += n;
    s->travel = travel;
    s->move = move;
    s->largest_overlap = larger(s->largest_overlap, largest->overlap);
    s->overlap_share = larger(s->overlap_share, largest->overlap_share);
}

static void make_share(const burst *b, const disk_step *step, int k, disk_extremes *extremes)
{
    const disk_share *share = &b->s->shares[k];

    *extremes = (disk_extremes){ 0 };
    b->kernels->touch(step, share->touch_first, share->touch_last, extremes);
    b->kernels->advance(step, share->group_first, share->group_last, extremes);
    disk__look(b->s, step->next, share->watch_first, share->watch_last, DISK_GONE);
}

// A member's part of a burst: until it has made all steps, the list is stale or something is wrong.
static void make_burst(void *context, int member, int n_members, team_barrier *barrier)
{
    burst *b = context;
    const int n_shares = b->s->n_shares;
    disk_step step = b->step;
    disk_row *rows[TURNS] = { b->s->now, b->s->next };
    disk_extremes largest = { 0 };
    double travel = b->s->travel, move = 0.0;
    bool is_suspect = false;
    uint64_t k = 0;

    while (k < b->n_wanted && travel <= 0.5 * b->s->skin && !is_suspect) {
        share_extremes *extremes = b->extremes[k % TURNS];
        step.now = rows[k % TURNS];
        step.next = rows[(k + 1) % TURNS];
        for (int share = member; share < n_shares; share += n_members)
            make_share(b, &step, share, &extremes[share].of);
        team_barrier_wait(barrier);
        disk_extremes of_step = { 0 };
        for (int share = 0; share < n_shares; share++)
            disk__join_extremes(&of_step, &extremes[share].of);
        disk__join_extremes(&largest, &of_step);
        move = sqrt(of_step.speed2) * step.dt;
        travel += move;
        is_suspect = disk__is_suspect(b->s, &of_step, move);
        k++;
    }
    if (member != 0)
        return;
    b->n_made = k;
    b->travel = travel;
    b->move = move;
    b->is_suspect = is_suspect;
    b->largest = largest;
}

static disk_step make_step(const disk_state *s)
{
    const bool is_first = s->steps == 0;
    const double dt = s->def.dt;

    return (disk_step){ .state = s,
                        .heading = s->heading,
                        .dt = dt,
                        .dt_force = is_first ? 0.0 : dt,
                        .keep = is_first ? 1.0 : 1.0 - s->def.damping * dt,
                        .keep_spin = is_first ? 1.0 : s->spin_damping };
}

// Makes up to n steps one by one, at least one. Returns how many.
static uint64_t advance_burst(disk_state *s, const disk_step *step, uint64_t n, bool *ret_suspect)
{
    burst b = { .s = s,
                .kernels = disk_kernels_of(cpu_best()),
                .step = *step,
                .n_wanted = s->steps == 0 ? 1 : n };

    team_run(s->n_shares, make_burst, &b);
    if (b.n_made % TURNS != 0)
        disk__swap(s);
    disk__count_steps(s, b.n_made, b.travel, b.move, &b.largest);
    *ret_suspect = b.is_suspect;
    return b.n_made;
}

// Makes up to n steps, at least one, on a list that is good. Returns how many.
static uint64_t advance_some(disk_state *s, uint64_t n, bool *ret_suspect)
{
    const disk_step step = make_step(s);
    const uint64_t n_tile = s->tiles.n_steps >= 2 ? (uint64_t)s->tiles.n_steps : n;
    uint64_t n_made = disk__advance_tile(s, &step, n, ret_suspect);

    return n_made > 0 ? n_made : advance_burst(s, &step, n < n_tile ? n : n_tile, ret_suspect);
}

bf_status disk__advance_verlet(disk_state *s, uint64_t n, bf_error *err)
{
    bf_status status;

    while (n > 0) {
        bool is_suspect = false;
        if (s->travel > 0.5 * s->skin && (status = disk__rebuild(s, err)) != BF_OK)
            return status;
        n -= advance_some(s, n, &is_suspect);
        if (is_suspect && (status = disk__check(s, err)) != BF_OK)
            return status;
    }
    return s->travel > 0.5 * s->skin ? disk__rebuild(s, err) : BF_OK;
}

static bool is_finite(const disk_row *row, double heading)
{
    return isfinite(row->x) && isfinite(row->y) && isfinite(row->vx) && isfinite(row->vy) &&
           isfinite(row->spin) && isfinite(heading);
}

static bf_status fail(const disk_state *s, uint32_t number, const char *what, bf_error *err)
{
    const disk_row *row = &s->now[s->place[number]];

    return bf_fail(err, BF_ENUMERIC, "",
                   "part %u %s in step %llu (t = %.6g s), at (%.6g, %.6g) m with (%.6g, %.6g) m/s",
                   (unsigned)number, what, (unsigned long long)s->steps,
                   (double)s->steps * s->def.dt, row->x, row->y, row->vx, row->vy);
}

bf_status disk__check(const disk_state *s, bf_error *err)
{
    for (size_t k = 0; k < s->n; k++) {
        const disk_row *row = &s->now[s->place[k]];
        if (s->place[k] >= s->n_live)
            continue;
        if (!is_finite(row, s->heading[s->place[k]]))
            return fail(s, (uint32_t)k, "has a place or speed that is not finite", err);
        if (sqrt(row->vx * row->vx + row->vy * row->vy) * s->def.dt > 0.5 * s->radius_min)
            return fail(s, (uint32_t)k, "moved by more than half a radius", err);
    }
    return BF_OK;
}

double disk__dt_stable_verlet(const micro_def *def)
{
    const scene_contact *contact = def->contact;
    double damping =
        fmax(contact[SCENE_CARGO_CARGO].damping, contact[SCENE_HANDLING_CARGO].damping);
    double r_min = INFINITY, r_max = 0.0, m_min = INFINITY, stiffness = 0.0;

    for (size_t k = 0; k < def->n_kinds; k++) {
        const micro_kind *kind = &def->kinds[k];
        r_min = fmin(r_min, kind->shape.radius);
        r_max = fmax(r_max, kind->shape.radius);
        m_min = fmin(m_min, kind->mass);
        for (size_t m = 0; m < def->n_kinds; m++)
            stiffness =
                fmax(stiffness, contact_law_of_line(&contact[SCENE_CARGO_CARGO], &kind->material,
                                                    &def->kinds[m].material, def->modulus_reduction)
                                    .stiffness);
        stiffness =
            fmax(stiffness, contact_law_of_line(&contact[SCENE_HANDLING_CARGO], &kind->material,
                                                &def->handling, def->modulus_reduction)
                                .stiffness);
    }
    // Around a part there is room for pi / asin(small / (small + large)) neighbours; the sum of their
    // n n^T has half as many as its largest eigenvalue at most, and neighbours that move the other way
    // double it. The step is stable while 2 d' dt + k' dt^2 < 4.
    double crowd = M_PI / asin(r_min / (r_min + r_max)) / m_min;
    double d = crowd * damping, k = crowd * stiffness;
    double dt = 4.0 / (d + sqrt(d * d + 4.0 * k));
    double grip = contact[SCENE_CONVEYOR_CARGO].friction * def->gravity *
                      contact[SCENE_CONVEYOR_CARGO].tanh_linear +
                  def->damping;
    return fmin(dt, 2.0 / grip);
}
