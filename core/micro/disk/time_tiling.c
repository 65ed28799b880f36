// Several explicit steps in one pass over the parts, for crowds that no cache holds.
//
// Parts are sorted in space and fall into blocks. A block can make its step t as soon as all blocks that
// hold neighbours of its parts have made step t - 1; so the steps of a tile run over the parts one
// close behind the other, and what a part is comes from memory once for all of them. Step t reads one
// array of rows and writes the other, over the state before step t - 1, which only neighbours needed.
//
// That the list held through all steps, and that all went well, is known at the end. If not, the parts
// are put back as they were, and single steps find out where it ended: results are those of single
// steps, to the bit.
//
// Threads   each member of a team makes some steps that follow one another; n_done is all that they
//           tell each other.

#include "core/micro/disk/disk_priv.h"
#include "core/micro/disk/kernels.h"

#include "core/base/memory.h"
#include "core/base/team.h"

#include <math.h>
#include <stdatomic.h>
#include <string.h>

enum {
    BLOCK_GROUPS = 32,
    TILE_STEPS = 8,           // most of a tile
    TILE_BYTES = 12 << 20,    // of what is between its first and its last step
    PART_BYTES = 2 * 64 + 56, // of a part while it is between them, and of its neighbours
    SLACK_BLOCKS = 8,         // that a step may be farther ahead of the next one than it must
};

// One step of a tile.
typedef struct level {
    _Alignas(128) atomic_size_t n_done; // blocks
    disk_extremes extremes;
} level;

typedef struct tile {
    disk_state *s;
    const disk_kernels *kernels;
    disk_step step; // its rows do not count
    int n_levels;
    level levels[TILE_STEPS];
} tile;

bf_status disk__tiles_init(disk_state *s)
{
    const size_t n_blocks = s->void_place / (BLOCK_GROUPS * DISK_GROUP) + 1;

    disk__tiles_fini(s);
    s->tiles.kept = memory_alloc(s->void_place, sizeof *s->tiles.kept);
    s->tiles.blocks = memory_alloc(n_blocks + 1, sizeof *s->tiles.blocks);
    if (s->tiles.kept != NULL && s->tiles.blocks != NULL)
        return BF_OK;
    disk__tiles_fini(s);
    return BF_ENOMEM;
}

void disk__tiles_fini(disk_state *s)
{
    memory_free(s->tiles.kept);
    memory_free(s->tiles.blocks);
    s->tiles = (disk_tiles){ 0 };
}

// The last block with a neighbour of the parts of groups first <= g < last, or themselves.
static size_t find_reach(const disk_state *s, size_t first, size_t last)
{
    const disk_list *list = &s->list;
    const uint32_t none = s->void_place * DISK_ROW;
    uint32_t farthest = (uint32_t)(last * DISK_GROUP - 1) * DISK_ROW;

    for (size_t k = (size_t)list->first[first] * DISK_GROUP;
         k < (size_t)list->first[last] * DISK_GROUP; k++)
        if (list->neighbour[k] != none && list->neighbour[k] > farthest)
            farthest = list->neighbour[k];
    return farthest / (DISK_ROW * DISK_GROUP * BLOCK_GROUPS);
}

// Returns how far ahead the neighbours of a block are at most, blocks.
static size_t cut_blocks(disk_state *s)
{
    const size_t n_groups = s->n_padded / DISK_GROUP;
    disk_block *blocks = s->tiles.blocks;
    size_t n = 0, touch = 0, watch = 0, reach = 0;

    for (size_t group = 0; group < n_groups; group += BLOCK_GROUPS, n++) {
        size_t last = group + BLOCK_GROUPS < n_groups ? group + BLOCK_GROUPS : n_groups;
        blocks[n] = (disk_block){ group, touch, watch, find_reach(s, group, last) };
        reach = blocks[n].reach - n > reach ? blocks[n].reach - n : reach;
        while (touch < s->n_touches && s->touches[touch].place < last * DISK_GROUP)
            touch++;
        while (watch < s->n_watches && s->watches[watch].place < last * DISK_GROUP)
            watch++;
    }
    blocks[n] = (disk_block){ n_groups, touch, watch, n };
    s->tiles.n_blocks = n;
    return reach;
}

void disk__cut_tiles(disk_state *s)
{
    disk_tiles *tiles = &s->tiles;

    if (tiles->kept == NULL)
        return;
    size_t reach = cut_blocks(s);
    size_t bytes = (reach + 2) * BLOCK_GROUPS * DISK_GROUP * PART_BYTES;
    int most = bytes < TILE_BYTES / TILE_STEPS ? TILE_STEPS : (int)(TILE_BYTES / bytes);
    tiles->lead = reach + SLACK_BLOCKS;
    tiles->n_steps = most - most % s->n_shares;
}

// Puts the parts of a block aside.
static void keep_block(disk_state *s, const disk_block *block)
{
    const size_t last = block[1].group_first * DISK_GROUP;

    for (size_t place = block->group_first * DISK_GROUP; place < last; place++) {
        const disk_row *row = &s->now[place];
        s->tiles.kept[place] = (disk_kept){ row->x, row->y, row->vx, row->vy, row->spin };
        s->scratch[place] = s->heading[place];
    }
}

static void advance_block(tile *w, int of_step, size_t of_block)
{
    disk_state *s = w->s;
    const disk_block *block = &s->tiles.blocks[of_block];
    disk_extremes *extremes = &w->levels[of_step].extremes;
    disk_step step = w->step;

    step.now = of_step % 2 == 0 ? s->now : s->next;
    step.next = of_step % 2 == 0 ? s->next : s->now;
    if (of_step == 0)
        keep_block(s, block);
    w->kernels->touch(&step, block->touch_first, block[1].touch_first, extremes);
    w->kernels->advance(&step, block->group_first, block[1].group_first, extremes);
    disk__look(s, step.next, block->watch_first, block[1].watch_first, DISK_GOING);
}

static size_t count_done(const tile *w, int of_step)
{
    return atomic_load_explicit(&w->levels[of_step].n_done, memory_order_acquire);
}

// Whether a step can go on with its next block: the step before has made the neighbours, and the step
// after it is near.
static bool is_ready(const tile *w, int of_step, size_t of_block)
{
    const disk_tiles *tiles = &w->s->tiles;

    return (of_step == 0 || count_done(w, of_step - 1) > tiles->blocks[of_block].reach) &&
           (of_step + 1 == w->n_levels || of_block < count_done(w, of_step + 1) + tiles->lead);
}

// What one look at a member's steps came to.
typedef enum turn { TURN_OVER, TURN_WAITS, TURN_MADE } turn;

// Makes a block of the last step that can go on: steps stay close together.
static turn take_turn(tile *w, int member, int n_members)
{
    turn result = TURN_OVER;

    for (int k = w->n_levels - 1; k >= 0; k--) {
        size_t block = atomic_load_explicit(&w->levels[k].n_done, memory_order_relaxed);
        if (k * n_members / w->n_levels != member || block == w->s->tiles.n_blocks)
            continue;
        result = TURN_WAITS;
        if (!is_ready(w, k, block))
            continue;
        advance_block(w, k, block);
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

// What single steps would have come to.
typedef struct outcome {
    double travel, move;
    disk_extremes largest;
    bool is_suspect;
    bool holds; // single steps would not have ended before the last
} outcome;

static outcome judge(const tile *w)
{
    const disk_state *s = w->s;
    outcome o = { .travel = s->travel, .holds = true };

    for (int k = 0; k < w->n_levels; k++) {
        const disk_extremes *of = &w->levels[k].extremes;
        o.holds = o.holds && !o.is_suspect && o.travel <= 0.5 * s->skin;
        o.move = sqrt(of->speed2) * w->step.dt;
        o.travel += o.move;
        o.is_suspect = disk__is_suspect(s, of, o.move);
        disk__join_extremes(&o.largest, of);
    }
    return o;
}

static void put_back_gone(disk_state *s, disk_watch *w)
{
    const uint32_t number = s->number[w->place];
    const disk_row *kind = &disk__kind_of(s, number)->row;

    for (int k = 0; k < 2; k++) {
        disk_row *row = k == 0 ? &s->now[w->place] : &s->next[w->place];
        row->radius = kind->radius;
        row->softness = kind->softness;
        row->inverse_mass = kind->inverse_mass;
    }
    w->gone = DISK_HERE;
    s->is_gone[number] = 0;
}

static void put_back(disk_state *s)
{
    for (size_t place = 0; place < s->n_padded; place++) {
        const disk_kept *kept = &s->tiles.kept[place];
        disk_row *row = &s->now[place];
        row->x = kept->x;
        row->y = kept->y;
        row->vx = kept->vx;
        row->vy = kept->vy;
        row->spin = kept->spin;
        s->heading[place] = s->scratch[place];
    }
    for (size_t k = 0; k < s->n_watches; k++) {
        disk_watch *w = &s->watches[k];
        if (w->gone == DISK_GOING)
            put_back_gone(s, w);
        if (!s->is_plain)
            s->belt_under[w->place] = disk__belt_at(s, s->now[w->place].x, s->now[w->place].y);
    }
    s->tiles.n_put_back++;
}

static void accept(tile *w, const outcome *o)
{
    disk_state *s = w->s;

    for (size_t k = 0; k < s->n_watches; k++)
        if (s->watches[k].gone == DISK_GOING)
            s->watches[k].gone = DISK_GONE;
    if (w->n_levels % 2 != 0)
        disk__swap(s);
    disk__count_steps(s, (uint64_t)w->n_levels, o->travel, o->move, &o->largest);
    s->tiles.n_made++;
}

uint64_t disk__advance_tile(disk_state *s, const disk_step *step, uint64_t n, bool *ret_suspect)
{
    const int n_steps = s->tiles.n_steps;

    // Twice the last speed is a guess, which saves tiles that would only be put back.
    if (s->tiles.kept == NULL || n_steps < 2 || n < (uint64_t)n_steps || s->steps == 0 ||
        !(s->travel + 2.0 * s->move * n_steps <= 0.5 * s->skin))
        return 0;
    tile w = { .s = s, .kernels = disk_kernels_of(cpu_best()), .step = *step, .n_levels = n_steps };
    team_run(s->n_shares, make_levels, &w);
    outcome o = judge(&w);
    if (!o.holds) {
        put_back(s);
        return 0;
    }
    accept(&w, &o);
    *ret_suspect = o.is_suspect;
    return (uint64_t)n_steps;
}
