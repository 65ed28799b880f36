// The pairs of explicit steps. Each is computed once in a block and its forces are added to both parts, which gives
// the bits of computing it for either part, as the two only differ in their sign. Pairs of parts in two blocks stand in
// both, so that blocks do not wait for each other.

#include "core/micro/disk/disk_priv.h"

#include "core/base/memory.h"
#include "core/base/team.h"

#include <string.h>

typedef struct slots {
    size_t first, last; // first <= slot < last
} slots;

static slots slots_of(const disk_state *s, size_t block)
{
    const size_t size = (size_t)DISK_BLOCK_GROUPS * DISK_GROUP, first = block * size;

    return (slots){ first, s->n_padded - first < size ? s->n_padded : first + size };
}

// Whether a pair is stored with the part in a slot of a block, not with its neighbour.
static bool owns_pair(slots block, size_t slot, size_t neighbour)
{
    return neighbour > slot || neighbour < block.first;
}

static size_t n_neighbours(const disk_state *s, size_t slot)
{
    size_t n = 0;

    while (n < disk__n_rows(s, slot) && disk__neighbour(s, slot, n) != s->void_slot)
        n++;
    return n;
}

// Sets pair_first[block + 1] to the number of pairs in a block, with padding.
static void count_pairs(void *context, size_t block)
{
    disk_state *s = context;
    const slots at = slots_of(s, block);
    size_t n = 0;

    for (size_t slot = at.first; slot < at.last; slot++)
        for (size_t row = 0; row < n_neighbours(s, slot); row++)
            n += owns_pair(at, slot, disk__neighbour(s, slot, row));
    s->list.pair_first[block + 1] = (uint32_t)((n + DISK_GROUP - 1) / DISK_GROUP * DISK_GROUP);
}

static uint32_t *force_at(const disk_state *s, size_t slot, size_t row)
{
    return &s->list
                .force[(s->list.first[slot / DISK_GROUP] + row) * DISK_GROUP + slot % DISK_GROUP];
}

static uint32_t force_of(const disk_state *s, size_t slot, size_t neighbour)
{
    size_t row = 0;

    while (disk__neighbour(s, slot, row) != neighbour)
        row++;
    return *force_at(s, slot, row);
}

static bool overlap(const disk_state *s, size_t slot, size_t neighbour)
{
    const disk *a = &s->now[slot], *b = &s->now[neighbour];
    double dx = b->x - a->x, dy = b->y - a->y, range = a->radius + b->radius;

    return dx * dx + dy * dy < range * range;
}

// Pairs that overlap come first, so that registers are full of them; then padding; then the others.
static void fill_block(void *context, size_t block)
{
    disk_state *s = context;
    const slots at = slots_of(s, block);
    disk_list *list = &s->list;
    const size_t first = list->pair_first[block];
    size_t near = first, far = list->pair_first[block + 1];

    for (size_t slot = at.first; slot < at.last; slot++) {
        const size_t n = n_neighbours(s, slot);
        for (size_t row = 0; row < disk__n_rows(s, slot); row++) {
            uint32_t *force = force_at(s, slot, row);
            *force = 0;
            if (row >= n)
                continue;
            size_t other = disk__neighbour(s, slot, row);
            if (!owns_pair(at, slot, other)) {
                *force = force_of(s, other, slot) + DISK_PAIR_DOUBLES / 2;
                continue;
            }
            size_t pair = overlap(s, slot, other) ? near++ : --far;
            list->pair[0][pair] = (uint32_t)slot * DISK_DOUBLES;
            list->pair[1][pair] = (uint32_t)other * DISK_DOUBLES;
            *force = (uint32_t)(1 + pair - first) * DISK_PAIR_DOUBLES;
        }
    }
    for (; near < far; near++) {
        list->pair[0][near] = (uint32_t)at.first * DISK_DOUBLES;
        list->pair[1][near] = s->void_slot * DISK_DOUBLES;
    }
}

static bf_status reserve(disk_state *s, size_t n_pairs, size_t most)
{
    disk_list *list = &s->list;
    const size_t n_rows = list->first[s->n_padded / DISK_GROUP];

    list->forces_size = (1 + most) * DISK_PAIR_DOUBLES;
    const memory_array arrays[] = {
        { &list->force, DISK_GROUP * sizeof *list->force, 0, n_rows },
        { &list->pair[0], sizeof *list->pair[0], 0, n_pairs },
        { &list->pair[1], sizeof *list->pair[1], 0, n_pairs },
        { &list->forces, list->forces_size * sizeof *list->forces, 0, (size_t)s->n_partitions },
    };
    return memory_lay_out(&list->pairs, arrays, sizeof arrays / sizeof *arrays) == 0 ? BF_OK
                                                                                     : BF_ENOMEM;
}

bf_status disk__pair_up(disk_state *s)
{
    const size_t n_blocks = (s->n_padded / DISK_GROUP + DISK_BLOCK_GROUPS - 1) / DISK_BLOCK_GROUPS;
    uint32_t *first = s->list.pair_first;
    uint64_t n_pairs = 0, most = 0;

    team_for(s->n_partitions, n_blocks, count_pairs, s);
    first[0] = 0;
    for (size_t block = 1; block <= n_blocks; block++) {
        most = first[block] > most ? first[block] : most;
        n_pairs += first[block];
        first[block] = (uint32_t)n_pairs;
    }
    // Places in `forces` are 32 bits wide.
    if (n_pairs > UINT32_MAX || most >= UINT32_MAX / DISK_PAIR_DOUBLES ||
        reserve(s, n_pairs, most) != BF_OK)
        return BF_ENOMEM;
    for (size_t k = 0; k < (size_t)s->n_partitions; k++)
        memset(s->list.forces + k * s->list.forces_size, 0, DISK_PAIR_DOUBLES * sizeof(double));
    team_for(s->n_partitions, n_blocks, fill_block, s);
    return BF_OK;
}
