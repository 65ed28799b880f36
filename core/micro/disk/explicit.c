// Explicit steps of disks: one by one, or several in one pass over the parts.
//
// Single steps   A team divides the partitions of the groups among its members and waits once a step. A thread writes
//                parts, headings, forces, border parts and what is under them of its own partitions only; it
//                reads all parts of `now`.
//
// Several steps  For disks that do not fit into the caches. Parts are sorted in space and fall into blocks. A block
//                can make its step t as soon as all blocks that hold neighbours of its parts have made step
//                t - 1; so the steps of a tile follow each other closely through the parts, and
//                a part is loaded from memory once for all of them. Step t reads one array of parts and writes
//                the other, over the state before step t - 1, which is no longer needed. Each member of
//                a team makes some steps that follow one another; n_done is their only shared state.
//                Whether the list was valid in all steps, and all of them succeeded, is checked at the end. If
//                not, the parts are restored, and single steps are made instead: results have
//                the bits of single steps.

#include "core/micro/disk/disk_priv.h"

#include "core/base/memory.h"
#include "core/base/team.h"
#include "core/scene/belt_slope.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>

enum { TURNS = 2 }; // extremes of one step are read while those of the next are written

enum {
    BLOCK_GROUPS = 32,
    TILE_STEPS = 8,           // most of a tile
    TILE_BYTES = 12 << 20,    // of what is between its first and its last step
    PART_BYTES = 2 * 64 + 56, // of a part while it is between them, and of its neighbours
    SLACK_BLOCKS = 8,         // that a step may be farther ahead of the next one than it must
};

#define X(suffix) extern const explicit_kernels explicit_kernels_##suffix;
CPU_EACH_BUILD(X)
#undef X

const explicit_kernels *disk__explicit_kernels(cpu_level level)
{
    static const explicit_kernels *const builds[] = {
#define X(suffix) &explicit_kernels_##suffix,
        CPU_EACH_BUILD(X)
#undef X
    };

    return builds[level];
}

static explicit_step make_step(const disk_state *s, uint64_t n_before, const disk_belt *belts)
{
    const bool is_first = n_before == 0;
    const double dt = s->def.dt;

    return (explicit_step){ .state = s,
                            .belts = belts,
                            .heading = s->heading,
                            .dt = dt,
                            .dt_force = is_first ? 0.0 : dt,
                            .damping_factor = is_first ? 1.0 : 1.0 - s->def.damping * dt,
                            .spin_damping_factor = is_first ? 1.0 : s->spin_damping };
}

// Adds a step with these extremes, in which plates moved by up to travel, m, to the progress.
static driver_outcome add_step(const disk_state *s, const driver_extremes *of_step, double travel,
                               driver_progress *progress)
{
    driver_join(&progress->largest, of_step);
    progress->last_bound = sqrt(of_step->speed2) * s->def.dt;
    progress->displacement_bound += progress->last_bound + travel;
    if (!isfinite(of_step->sum) || progress->last_bound > 0.5 * s->radius_min ||
        micro__is_pressed(of_step->overlap_share, &s->def))
        return DRIVER_SUSPECT;
    return neighbours_holds(s->skin, progress->displacement_bound) ? DRIVER_MADE : DRIVER_STALE;
}

static bf_status refresh(void *state, bf_error *err)
{
    disk_state *s = state;

    return !s->is_stale && neighbours_holds(s->skin, s->displacement_bound) ? BF_OK
                                                                            : disk__rebuild(s, err);
}

static int begin(const void *state, driver_progress *ret_progress)
{
    const disk_state *s = state;

    *ret_progress = (driver_progress){ .displacement_bound = s->displacement_bound };
    return s->n_partitions;
}

// A step and where its extremes go.
typedef struct single_step {
    explicit_step of;
    disk_extremes_line *extremes;
} single_step;

// Where the thread of a partition, or a member, leaves the forces of pairs.
static double *forces_of(const disk_state *s, size_t k)
{
    return s->list.forces + k * s->list.forces_size;
}

static void advance_partition(const driver_member *m, size_t k)
{
    disk_state *s = m->state;
    const single_step *step = m->step;
    const disk_partition *own = &s->partitions[k];
    driver_extremes *extremes = &step->extremes[k].of;
    explicit_step of = step->of;

    of.forces = forces_of(s, k);
    *extremes = (driver_extremes){ 0 };
    s->kernels->add_boundary_forces(&of, own->candidate_first, own->candidate_last, extremes);
    s->kernels->advance(&of, own->group_first, own->group_last, extremes);
    disk__update_border_parts(s, of.next, own->border_first, own->border_last, DISK_GONE);
}

static driver_outcome step(driver_member *m)
{
    disk_state *s = m->state;
    const size_t turn = m->n_made % TURNS;
    const uint64_t n_before = s->common.steps + m->n_made;
    disk_belts room;
    single_step single = { make_step(s, n_before, disk__belts_in_step(s, n_before, &room)),
                           &s->extremes[turn * DISK_PARTITIONS_MAX] };
    driver_extremes of_step = { 0 };

    single.of.now = turn == 0 ? s->now : s->next;
    single.of.next = turn == 0 ? s->next : s->now;
    m->step = &single;
    disk__pose_plates_by_team(m);
    driver_split(m, 0, (size_t)s->n_partitions, advance_partition);
    driver_wait(m);
    for (int k = 0; k < s->n_partitions; k++)
        driver_join(&of_step, &single.extremes[k].of);
    return add_step(s, &of_step, disk__plates_travel(s, n_before), &m->progress);
}

static void end(void *state, uint64_t n, driver_outcome outcome, const driver_progress *progress)
{
    disk_state *s = state;

    (void)outcome;
    if (n % TURNS != 0)
        disk__swap(s);
    s->common.steps += n;
    disk__pose_plates(s, s->common.steps);
    s->displacement_bound = progress->displacement_bound;
    s->last_bound = progress->last_bound;
    micro__take_overlaps(&s->common, progress->largest.overlap, progress->largest.overlap_share);
}

// Groups that make a step together, and where their candidates and border parts begin; all end where those of
// the next block begin.
typedef struct disk_block {
    size_t group_first;
    size_t candidate_first;
    size_t border_first;
    size_t last_needed; // the last block with neighbours of its parts
} disk_block;

// A part before a tile's first step.
typedef struct disk_backup {
    double x, y, vx, vy, spin, heading;
} disk_backup;

// One step of a tile.
typedef struct level {
    _Alignas(128) atomic_size_t n_done; // blocks
    driver_extremes extremes;
} level;

typedef struct tile {
    disk_state *s;
    explicit_step step; // without its parts and its belts
    const disk_belt *belts[TILE_STEPS];
    int n_levels;
    level levels[TILE_STEPS];
} tile;

bf_status disk__tiling_init(disk_state *s)
{
    const size_t n_blocks = s->void_slot / (BLOCK_GROUPS * DISK_GROUP) + 1;

    disk__tiling_fini(s);
    s->tiling.backup = memory_alloc(s->void_slot, sizeof *s->tiling.backup);
    s->tiling.blocks = memory_alloc(n_blocks + 1, sizeof *s->tiling.blocks);
    s->tiling.belts = memory_alloc(TILE_STEPS, sizeof *s->tiling.belts);
    if (s->tiling.backup != NULL && s->tiling.blocks != NULL && s->tiling.belts != NULL)
        return BF_OK;
    disk__tiling_fini(s);
    return BF_ENOMEM;
}

void disk__tiling_fini(disk_state *s)
{
    memory_free(s->tiling.backup);
    memory_free(s->tiling.blocks);
    memory_free(s->tiling.belts);
    s->tiling = (disk_tiling){ 0 };
}

// The last block with a neighbour of the parts of groups first <= g < last, or themselves.
static size_t find_last_needed(const disk_state *s, size_t first, size_t last)
{
    const disk_list *list = &s->list;
    const uint32_t none = s->void_slot * DISK_DOUBLES;
    uint32_t farthest = (uint32_t)(last * DISK_GROUP - 1) * DISK_DOUBLES;

    for (size_t k = (size_t)list->first[first] * DISK_GROUP;
         k < (size_t)list->first[last] * DISK_GROUP; k++)
        if (list->neighbour[k] != none && list->neighbour[k] > farthest)
            farthest = list->neighbour[k];
    return farthest / (DISK_DOUBLES * DISK_GROUP * BLOCK_GROUPS);
}

void disk__plan_tiles(disk_state *s)
{
    disk_tiling *tiles = &s->tiling;

    if (tiles->backup == NULL)
        return;
    const size_t n_groups = s->n_padded / DISK_GROUP;
    disk_block *blocks = s->tiling.blocks;
    size_t n = 0, candidate = 0, border = 0, ahead = 0;
    for (size_t group = 0; group < n_groups; group += BLOCK_GROUPS, n++) {
        size_t last = group + BLOCK_GROUPS < n_groups ? group + BLOCK_GROUPS : n_groups;
        blocks[n] = (disk_block){ group, candidate, border, find_last_needed(s, group, last) };
        ahead = blocks[n].last_needed - n > ahead ? blocks[n].last_needed - n : ahead;
        while (candidate < s->n_candidates && s->candidates[candidate].slot < last * DISK_GROUP)
            candidate++;
        while (border < s->n_border_parts && s->border_parts[border].slot < last * DISK_GROUP)
            border++;
    }
    blocks[n] = (disk_block){ n_groups, candidate, border, n };
    s->tiling.n_blocks = n;
    size_t bytes = (ahead + 2) * BLOCK_GROUPS * DISK_GROUP * PART_BYTES;
    int most = bytes < TILE_BYTES / TILE_STEPS ? TILE_STEPS : (int)(TILE_BYTES / bytes);
    tiles->lead = ahead + SLACK_BLOCKS;
    tiles->n_steps = most - most % s->n_partitions;
}

static void advance_block(tile *w, int member, int of_step, size_t of_block)
{
    disk_state *s = w->s;
    const disk_block *block = &s->tiling.blocks[of_block];
    driver_extremes *extremes = &w->levels[of_step].extremes;
    explicit_step step = w->step;

    step.belts = w->belts[of_step];
    step.forces = forces_of(s, (size_t)member);
    step.now = of_step % 2 == 0 ? s->now : s->next;
    step.next = of_step % 2 == 0 ? s->next : s->now;
    if (of_step == 0) {
        const size_t last = block[1].group_first * DISK_GROUP;
        for (size_t slot = block->group_first * DISK_GROUP; slot < last; slot++) {
            const disk *part = &s->now[slot];
            s->tiling.backup[slot] =
                (disk_backup){ part->x, part->y, part->vx, part->vy, part->spin, s->heading[slot] };
        }
    }
    s->kernels->add_boundary_forces(&step, block->candidate_first, block[1].candidate_first,
                                    extremes);
    s->kernels->advance(&step, block->group_first, block[1].group_first, extremes);
    disk__update_border_parts(s, step.next, block->border_first, block[1].border_first, DISK_GOING);
}

static size_t count_done(const tile *w, int of_step)
{
    return atomic_load_explicit(&w->levels[of_step].n_done, memory_order_acquire);
}

// Whether a step can go on with its next block: the step before has made the neighbours, and the step
// after it is near.
static bool is_ready(const tile *w, int of_step, size_t of_block)
{
    const disk_tiling *tiles = &w->s->tiling;

    return (of_step == 0 || count_done(w, of_step - 1) > tiles->blocks[of_block].last_needed) &&
           (of_step + 1 == w->n_levels || of_block < count_done(w, of_step + 1) + tiles->lead);
}

// The result of one pass over a member's steps.
typedef enum turn { TURN_OVER, TURN_WAITS, TURN_MADE } turn;

// Makes a block of the last step that can go on: steps stay close together.
static turn take_turn(tile *w, int member, int n_members)
{
    turn result = TURN_OVER;

    for (int k = w->n_levels - 1; k >= 0; k--) {
        size_t block = atomic_load_explicit(&w->levels[k].n_done, memory_order_relaxed);
        if (k * n_members / w->n_levels != member || block == w->s->tiling.n_blocks)
            continue;
        result = TURN_WAITS;
        if (!is_ready(w, k, block))
            continue;
        advance_block(w, member, k, block);
        atomic_store_explicit(&w->levels[k].n_done, block + 1, memory_order_release);
        return TURN_MADE;
    }
    return result;
}

static void make_levels(void *context, int member, int n_members, team_barrier *barrier)
{
    tile *w = context;
    int n_waits = 0;

    (void)barrier;
    for (turn last = TURN_MADE; last != TURN_OVER;) {
        last = take_turn(w, member, n_members);
        n_waits = last == TURN_WAITS ? n_waits + 1 : 0;
        if (n_waits > 0)
            team_spin_wait(n_waits);
    }
}

// The outcome of single steps; *ret_holds: they would not have ended before the last.
static driver_outcome outcome_of(const tile *w, driver_progress *ret_progress, bool *ret_holds)
{
    driver_outcome outcome = DRIVER_MADE;

    (void)begin(w->s, ret_progress);
    *ret_holds = true;
    for (int k = 0; k < w->n_levels; k++) {
        *ret_holds = *ret_holds && outcome == DRIVER_MADE;
        outcome = add_step(w->s, &w->levels[k].extremes, 0.0, ret_progress);
    }
    return outcome;
}

static void put_back(disk_state *s)
{
    for (size_t slot = 0; slot < s->n_padded; slot++) {
        const disk_backup *backup = &s->tiling.backup[slot];
        disk *part = &s->now[slot];
        part->x = backup->x;
        part->y = backup->y;
        part->vx = backup->vx;
        part->vy = backup->vy;
        part->spin = backup->spin;
        s->heading[slot] = backup->heading;
    }
    for (size_t k = 0; k < s->n_border_parts; k++) {
        disk_border_part *w = &s->border_parts[k];
        if (w->gone == DISK_GOING) {
            const uint32_t id = s->id_of[w->slot];
            const disk *kind = &disk__kind_of(s, id)->part;
            for (int n = 0; n < 2; n++) {
                disk *part = n == 0 ? &s->now[w->slot] : &s->next[w->slot];
                part->radius = kind->radius;
                part->compliance = kind->compliance;
                part->inv_mass = kind->inv_mass;
            }
            w->gone = DISK_HERE;
            s->common.presence[id] = MICRO_HERE;
        }
        if (!s->is_uniform)
            s->belt_under[w->slot] = disk__belt_under(s, &s->now[w->slot]);
    }
    s->tiling.n_put_back++;
}

static uint64_t advance_tile(void *state, uint64_t n, uint64_t *ret_most, bool *ret_suspect)
{
    disk_state *s = state;
    const uint64_t n_steps = s->tiling.n_steps >= 2 ? (uint64_t)s->tiling.n_steps : 0;
    driver_progress progress;
    bool holds;

    *ret_most = n_steps > 0 && n_steps < n ? n_steps : n;
    // Twice the last speed is a guess, which avoids tiles that would only be undone.
    if (s->tiling.backup == NULL || n_steps == 0 || n < n_steps || s->common.steps == 0 ||
        !neighbours_holds(s->skin, s->displacement_bound + 2.0 * s->last_bound * (int)n_steps))
        return 0;
    tile w = { .s = s, .step = make_step(s, s->common.steps, NULL), .n_levels = (int)n_steps };
    for (uint64_t k = 0; k < n_steps; k++)
        w.belts[k] = disk__belts_in_step(s, s->common.steps + k, &s->tiling.belts[k]);
    team_run(s->n_partitions, make_levels, &w);
    driver_outcome outcome = outcome_of(&w, &progress, &holds);
    if (!holds) {
        put_back(s);
        return 0;
    }
    for (size_t k = 0; k < s->n_border_parts; k++)
        if (s->border_parts[k].gone == DISK_GOING)
            s->border_parts[k].gone = DISK_GONE;
    end(s, n_steps, outcome, &progress);
    s->tiling.n_made++;
    *ret_suspect = outcome == DRIVER_SUSPECT;
    return n_steps;
}

bf_status disk__advance_explicit(disk_state *s, uint64_t n, bf_error *err)
{
    static const driver_solver solver = { .refresh = refresh,
                                          .advance_tile = advance_tile,
                                          .begin = begin,
                                          .step = step,
                                          .end = end,
                                          .check = disk__check };

    // What is measured after the last step needs a list that holds.
    bf_status status = driver_advance(&solver, s, n, err);
    return status == BF_OK ? refresh(s, err) : status;
}

static bf_status fail(const disk_state *s, uint32_t id, const char *what, bf_error *err)
{
    const disk *part = &s->now[s->slot_of[id]];

    return bf_fail(err, BF_ENUMERIC, "",
                   "part %u %s in step %llu (t = %.6g s), at (%.6g, %.6g) m with (%.6g, %.6g) m/s",
                   (unsigned)id, what, (unsigned long long)s->common.steps,
                   (double)s->common.steps * s->def.dt, part->x, part->y, part->vx, part->vy);
}

bf_status disk__check(const void *state, bf_error *err)
{
    const disk_state *s = state;

    for (size_t k = 0; k < s->n; k++) {
        const disk *part = &s->now[s->slot_of[k]];
        if (s->slot_of[k] >= s->n_live)
            continue;
        if (!isfinite(part->x) || !isfinite(part->y) || !isfinite(part->vx) ||
            !isfinite(part->vy) || !isfinite(part->spin) || !isfinite(s->heading[s->slot_of[k]]))
            return fail(s, (uint32_t)k, "has a place or speed that is not finite", err);
        if (sqrt(part->vx * part->vx + part->vy * part->vy) * s->def.dt > 0.5 * s->radius_min)
            return fail(s, (uint32_t)k, "moved by more than half a radius", err);
    }
    return micro__is_pressed(s->common.overlap_share, &s->def)
               ? bf_fail(err, BF_ENUMERIC, "", "parts overlap by more than overlap_limit")
               : BF_OK;
}

double disk__dt_stable_explicit(const micro_def *def)
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
    // At most pi / asin(small / (small + large)) neighbours fit around a part; the sum of their
    // n n^T has half as many as its largest eigenvalue at most, and neighbours that move the other way
    // double it. The step is stable while 2 d' dt + k' dt^2 < 4.
    double neighbours = M_PI / asin(r_min / (r_min + r_max)) / m_min;
    double d = neighbours * damping, k = neighbours * stiffness;
    double dt = 4.0 / (d + sqrt(d * d + 4.0 * k));
    double belt =
        belt_slope_largest_drive(def->n_belts, def->belts, &contact[SCENE_CONVEYOR_CARGO]) *
            def->gravity * contact[SCENE_CONVEYOR_CARGO].tanh_linear +
        def->damping;
    return fmin(dt, 2.0 / belt);
}
