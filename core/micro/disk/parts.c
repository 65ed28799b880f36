#include "core/micro/disk/parts.h"

#include "core/base/memory.h"
#include "core/micro/disk/implicit.h"

enum { ROOM_AT_FIRST = 64 }; // parts, where there were few

// How many of what there are with room for a number of parts.
typedef struct sizes {
    size_t parts;
    size_t slots;
    size_t groups; // and one more
    size_t blocks; // same
} sizes;

static sizes sizes_of(size_t capacity)
{
    const size_t void_slot = disk__void_slot(capacity);

    return (sizes){ capacity, void_slot + 1, void_slot / DISK_GROUP + 1,
                    void_slot / DISK_GROUP / DISK_BLOCK_GROUPS + 2 };
}

static bf_status resize_arrays(disk_state *s, const sizes *old, const sizes *new)
{
    const size_t n_own = s->is_uniform ? 0 : new->slots, n_kinds = s->n_kinds > 1 ? new->parts : 0;
    const size_t n_blocks = s->def.integrator == MICRO_VERLET ? new->blocks : 0;
    const size_t n_next = s->def.integrator == MICRO_VERLET ? new->slots : 0;
    const size_t slots = s->now != NULL ? old->slots : 0, parts = s->now != NULL ? old->parts : 0;
    const memory_array arrays[] = {
        { &s->now, sizeof *s->now, slots, new->slots },
        { &s->next, sizeof *s->next, 0, n_next },
        { &s->heading, sizeof *s->heading, slots, new->slots },
        { &s->spin_deceleration, sizeof *s->spin_deceleration, 0, n_own },
        { &s->belt_under, sizeof *s->belt_under, 0, n_own },
        { &s->has_candidates, sizeof *s->has_candidates, 0, new->groups },
        { &s->id_of, sizeof *s->id_of, slots, new->slots },
        { &s->slot_of, sizeof *s->slot_of, parts, new->parts },
        { &s->common.presence, sizeof *s->common.presence, parts, new->parts },
        { &s->kind_of, sizeof *s->kind_of, s->kind_of != NULL ? parts : 0, n_kinds },
        { &s->list.first, sizeof *s->list.first, s->now != NULL ? old->groups : 0, new->groups },
        { &s->list.pair_first, sizeof *s->list.pair_first, 0, n_blocks },
    };

    return memory_resize(arrays, sizeof arrays / sizeof *arrays) == 0 ? BF_OK : BF_ENOMEM;
}

bf_status disk__resize(disk_state *s, size_t capacity)
{
    const sizes old = sizes_of(s->capacity), new = sizes_of(capacity);

    if (resize_arrays(s, &old, &new) != BF_OK)
        return BF_ENOMEM;
    if (s->implicit != NULL)
        disk_implicit__forget_choice(s->implicit);
    s->capacity = capacity;
    s->void_slot = disk__void_slot(capacity);
    s->now[s->void_slot] = disk__pad(s, s->void_slot);
    s->id_of[s->void_slot] = UINT32_MAX;
    // Without memory for tiles steps are made one by one.
    const bf_status tiled = s->tiling.backup != NULL ? disk__tiling_init(s) : BF_OK;
    (void)tiled;
    return BF_OK;
}

// A slot for the part with an id: its former one, which may still be among those of live parts, or the next one
// behind all others.
static uint32_t find_slot(disk_state *s, size_t id)
{
    if (id == s->n)
        return (uint32_t)(s->n_padded + (s->n - s->n_live));
    disk_border_part *left = disk__find_left(s, s->slot_of[id]);
    if (left != NULL)
        left->gone = DISK_HERE;
    return s->slot_of[id];
}

bf_status disk__admit(void *state, size_t k, const micro_arrival *arrival, bf_error *err)
{
    disk_state *s = state;
    const size_t more = s->capacity + s->capacity / 4;
    const size_t capacity = more > ROOM_AT_FIRST ? more : ROOM_AT_FIRST;

    if (k == s->capacity && disk__resize(s, capacity) != BF_OK)
        return bf_fail(err, BF_ENOMEM, "", "no memory for %zu parts", capacity);
    const uint32_t slot = find_slot(s, k);
    s->n += k == s->n;
    s->slot_of[k] = slot;
    s->id_of[slot] = (uint32_t)k;
    s->common.presence[k] = MICRO_HERE;
    if (s->kind_of != NULL)
        s->kind_of[k] = arrival->kind;
    s->now[slot] = s->kinds[arrival->kind].part;
    s->now[slot].x = arrival->pose.x;
    s->now[slot].y = arrival->pose.y;
    s->now[slot].vx = arrival->velocity.x;
    s->now[slot].vy = arrival->velocity.y;
    s->heading[slot] = arrival->pose.heading;
    s->is_stale = true;
    if (s->implicit != NULL)
        disk_implicit__forget_choice(s->implicit);
    return BF_OK;
}

void disk__take_out(void *state, size_t k)
{
    disk_state *s = state;

    s->common.presence[k] = MICRO_LEFT;
    s->is_stale = true;
}

void disk__forget_gone(void *state)
{
    disk_state *s = state;

    if (s->implicit != NULL)
        disk_implicit__forget_gone(s, s->implicit);
}
