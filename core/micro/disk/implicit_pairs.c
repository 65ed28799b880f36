#include "core/base/memory.h"
#include "core/micro/disk/implicit_priv.h"

#include <string.h>

static const uint32_t nothing = UINT32_MAX;

static bf_status fail_for_memory(bf_error *err)
{
    return bf_fail(err, BF_ENOMEM, "", "no memory for the pairs of parts");
}

// Number of pairs at most: touches, and the list without those that stand there a second time.
static size_t bound_pairs(const disk_state *s)
{
    size_t n_slots = s->list.first[s->n_padded / DISK_GROUP];

    return s->n_touches + n_slots * DISK_GROUP / 2;
}

// A colour that neither place has; what is left over goes to the last group.
static uint8_t take_colour(uint32_t *used, uint32_t a, uint32_t b)
{
    uint32_t free = ~(used[a] | used[b]) & (UINT32_MAX >> (32 - IMPLICIT_COLOURS));

    if (free == 0)
        return IMPLICIT_REST;
    int colour = __builtin_ctz(free);
    used[a] |= 1U << colour;
    used[b] |= 1U << colour;
    return (uint8_t)(IMPLICIT_SOLIDS + colour);
}

static void add_pair(implicit_state *z, size_t *n, implicit_pair pair, uint8_t colour)
{
    z->colour[*n] = colour;
    z->spare[(*n)++] = pair;
}

// The pairs of a part with those of higher numbers.
static void collect_of_part(const disk_state *s, implicit_state *z, uint32_t place, size_t *n)
{
    for (size_t slot = 0; slot < disk__slots(s, place); slot++) {
        uint32_t other = disk__neighbour(s, place, slot);
        if (other == s->void_place || s->number[other] < s->number[place])
            continue;
        implicit_pair pair = { .number = { s->number[place], s->number[other] },
                               .place = { place, other } };
        add_pair(z, n, pair, take_colour(z->used, place, other));
    }
}

// The touches, which stand by place: a part's first one to group 0 and so on.
static void collect_touches(const disk_state *s, implicit_state *z, size_t *n)
{
    uint8_t group = 0;

    for (size_t k = 0; k < s->n_touches; k++) {
        disk_touch t = s->touches[k];
        implicit_pair pair = { .number = { s->number[t.place], (uint32_t)s->n + t.feature },
                               .place = { t.place, s->void_place } };
        bool is_another = k > 0 && s->touches[k - 1].place == t.place;
        group = is_another && group < IMPLICIT_SOLIDS ? (uint8_t)(group + 1) : group;
        group = is_another ? group : 0;
        add_pair(z, n, pair, group < IMPLICIT_SOLIDS ? group : IMPLICIT_REST);
    }
}

// All pairs into spare, those of parts in the order of numbers: colours must not depend on the order
// of places, which has a history. Room is there.
static size_t collect_pairs(const disk_state *s, implicit_state *z)
{
    size_t n = 0;

    memset(z->used, 0, s->n_padded * sizeof *z->used);
    collect_touches(s, z, &n);
    for (size_t number = 0; number < s->n; number++) {
        z->first[number] = (uint32_t)n;
        if (s->place[number] < s->n_live)
            collect_of_part(s, z, s->place[number], &n);
    }
    z->first[s->n] = (uint32_t)n;
    return n;
}

// Impulses of the pairs in z->pairs go to the same pairs among the n in spare.
static void hand_on_impulses(const disk_state *s, implicit_state *z, size_t n)
{
    memset(z->head, 0xff, s->n * sizeof *z->head);
    for (size_t k = 0; k < z->n_pairs; k++) {
        const implicit_pair *old = &z->pairs[k];
        if (old->normal == 0.0 && old->sliding == 0.0)
            continue;
        z->next[k] = z->head[old->number[0]];
        z->head[old->number[0]] = (uint32_t)k;
    }
    for (size_t k = 0; k < n; k++) {
        implicit_pair *pair = &z->spare[k];
        uint32_t at = z->head[pair->number[0]];
        while (at != nothing && z->pairs[at].number[1] != pair->number[1])
            at = z->next[at];
        if (at == nothing)
            continue;
        pair->normal = z->pairs[at].normal;
        pair->sliding = z->pairs[at].sliding;
    }
}

// Where each group begins if the n pairs in spare are sorted by groups.
static void count_groups(implicit_state *z, size_t n)
{
    memset(z->group, 0, sizeof z->group);
    for (size_t k = 0; k < n; k++)
        z->group[z->colour[k] + 1]++;
    for (size_t g = 0; g < IMPLICIT_GROUPS; g++)
        z->group[g + 1] += z->group[g];
}

// The n pairs in spare by their groups into z->pairs, where room is; coloured ones by places, so that
// memory is gone through in order, the others in the order in which they stand.
static void sort_pairs(const disk_state *s, implicit_state *z, size_t n)
{
    size_t at[IMPLICIT_GROUPS];

    count_groups(z, n);
    memcpy(at, z->group, sizeof at);
    for (size_t place = 0; place < s->n_live; place++) {
        uint32_t number = s->number[place];
        for (size_t k = z->first[number]; k < z->first[number + 1]; k++)
            if (z->colour[k] != IMPLICIT_REST)
                z->pairs[at[z->colour[k]]++] = z->spare[k];
    }
    for (size_t k = 0; k < n; k++)
        if (z->colour[k] < IMPLICIT_SOLIDS || z->colour[k] == IMPLICIT_REST)
            z->pairs[at[z->colour[k]]++] = z->spare[k];
    z->n_pairs = n;
}

static int reserve_pairs(implicit_state *z, size_t n)
{
    size_t n_pieces = n / IMPLICIT_PIECE + IMPLICIT_GROUPS;

    return memory_reserve(&z->pairs, &z->neighbours_capacity, n, sizeof *z->pairs) ||
           memory_reserve(&z->pieces, &z->pieces_capacity, n_pieces, sizeof *z->pieces);
}

// Groups into pieces. Returns how many blocks they need.
static size_t cut_groups(const disk_state *s, implicit_state *z)
{
    size_t n = 0, n_blocks = 0;

    for (size_t g = 0; g < IMPLICIT_GROUPS; g++) {
        const bool is_rest = g == IMPLICIT_REST;
        const size_t end = z->group[g + 1];
        z->group_piece[g] = n;
        for (size_t first = z->group[g]; first < end;) {
            size_t left = end - first;
            size_t length = !is_rest && left > IMPLICIT_PIECE ? IMPLICIT_PIECE : left;
            z->pieces[n] =
                (implicit_piece){ .first = first,
                                  .last = first + length,
                                  .block = n_blocks,
                                  .ground = s->void_place + (uint32_t)(n - z->group_piece[g]),
                                  .is_rest = is_rest };
            n_blocks += is_rest ? length : (length + IMPLICIT_WIDTH - 1) / IMPLICIT_WIDTH;
            first += length;
            n++;
        }
    }
    z->group_piece[IMPLICIT_GROUPS] = n;
    return n_blocks;
}

bf_status disk_implicit__cut(const disk_state *s, implicit_state *z, bf_error *err)
{
    size_t n_blocks = cut_groups(s, z);

    if (memory_reserve(&z->blocks, &z->blocks_capacity, n_blocks, sizeof *z->blocks))
        return fail_for_memory(err);
    return BF_OK;
}

bf_status disk_implicit__reserve(implicit_state *z, size_t n, bf_error *err)
{
    return reserve_pairs(z, n) ? fail_for_memory(err) : BF_OK;
}

bf_status disk_implicit__choose(disk_state *s, implicit_state *z, bf_error *err)
{
    size_t bound = bound_pairs(s);

    if (memory_reserve(&z->spare, &z->spare_capacity, bound, sizeof *z->spare) ||
        memory_reserve(&z->colour, &z->colour_capacity, bound, sizeof *z->colour) ||
        memory_reserve(&z->next, &z->next_capacity, z->n_pairs, sizeof *z->next) ||
        reserve_pairs(z, bound))
        return fail_for_memory(err);
    size_t n = collect_pairs(s, z);
    hand_on_impulses(s, z, n);
    sort_pairs(s, z, n);
    return disk_implicit__cut(s, z, err);
}

void disk_implicit__locate(const disk_state *s, implicit_state *z)
{
    for (size_t k = 0; k < z->n_pairs; k++)
        for (int end = 0; end < 2; end++) {
            uint32_t number = z->pairs[k].number[end];
            bool is_there = number < s->n && !s->is_gone[number];
            z->pairs[k].place[end] = is_there ? s->place[number] : s->void_place;
        }
}
