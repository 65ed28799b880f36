// Pairs of parts for implicit steps: which there are, in what order they are solved, and where they are stored.

#include "core/base/memory.h"
#include "core/base/simd_rows.h"
#include "core/micro/colours.h"
#include "core/micro/disk/implicit.h"

#include <string.h>

static const uint32_t nothing = UINT32_MAX; // the id of a lane without a pair

static bf_status fail_for_memory(bf_error *err)
{
    return bf_fail(err, BF_ENOMEM, "", "no memory for the pairs of parts");
}

implicit_pair disk_implicit__pair(const disk_state *s, const implicit_state *z,
                                  const implicit_piece *p, size_t k)
{
    size_t lane;
    const implicit_block *block = implicit_lane(z, p, k, &lane);
    implicit_pair pair = { .id = { block->row[0][lane], block->row[1][lane] },
                           .normal = block->normal[lane],
                           .sliding = block->sliding[lane] };

    for (int end = 0; z->is_current && end < 2; end++) {
        const size_t row = pair.id[end] / SIMD_QUAD;
        pair.id[end] = row < z->first_feature
                           ? s->id_of[row]
                           : IMPLICIT_FEATURE + z->features[row - z->first_feature];
    }
    return pair;
}

void disk_implicit__set_pair(implicit_state *z, const implicit_piece *p, size_t k,
                             const implicit_pair *pair)
{
    size_t lane;
    implicit_block *block = implicit_lane(z, p, k, &lane);

    block->row[0][lane] = pair->id[0];
    block->row[1][lane] = pair->id[1];
    block->normal[lane] = pair->normal;
    block->sliding[lane] = pair->sliding;
}

void disk_implicit__forget_gone(const disk_state *s, implicit_state *z)
{
    for (size_t piece = 0; piece < z->group_piece[IMPLICIT_GROUPS]; piece++) {
        const implicit_piece *p = &z->pieces[piece];
        for (size_t k = 0; k < p->n; k++) {
            const implicit_pair pair = disk_implicit__pair(s, z, p, k);
            if (s->common.presence[pair.id[0]] == MICRO_HERE &&
                (implicit_is_at_boundary(&pair) || s->common.presence[pair.id[1]] == MICRO_HERE))
                continue;
            size_t lane;
            implicit_block *block = implicit_lane(z, p, k, &lane);
            block->normal[lane] = block->sliding[lane] = 0.0;
        }
    }
}

// Cut groups into pieces, all pairs at the front, into *pieces if that is not NULL. Returns how many blocks they need.
static size_t cut_groups(const disk_state *s, const size_t *group, implicit_piece *pieces,
                         size_t *ret_group_piece)
{
    size_t n = 0, n_blocks = 0;

    for (size_t g = 0; g < IMPLICIT_GROUPS; g++) {
        const bool is_rest = g == IMPLICIT_REST;
        const size_t n_pairs = group[g + 1] - group[g];
        const size_t n_own =
            is_rest ? n_pairs > 0 : (n_pairs + IMPLICIT_PIECE - 1) / IMPLICIT_PIECE;
        ret_group_piece[g] = n;
        for (size_t k = 0; k < n_own; k++) {
            const size_t first = group[g] + k * IMPLICIT_PIECE, end = group[g + 1];
            const bool is_last = k + 1 == n_own;
            const size_t length = is_last ? end - first : IMPLICIT_PIECE;
            const size_t n_full = (length + IMPLICIT_WIDTH - 1) / IMPLICIT_WIDTH;
            const implicit_piece piece = { .block = n_blocks,
                                           .n_blocks = n_full + (is_rest ? 0 : 1),
                                           .n = length,
                                           .n_front = length,
                                           .is_rest = is_rest,
                                           .static_body = s->void_slot + (uint32_t)k };
            if (pieces != NULL)
                pieces[n + k] = piece;
            n_blocks += piece.n_blocks;
        }
        n += n_own;
    }
    ret_group_piece[IMPLICIT_GROUPS] = n;
    return n_blocks;
}

bf_status disk_implicit__cut(const disk_state *s, implicit_state *z,
                             const size_t group[IMPLICIT_GROUPS + 1], bf_error *err)
{
    size_t group_piece[IMPLICIT_GROUPS + 1];
    const size_t n_blocks = cut_groups(s, group, NULL, group_piece);

    if (memory_reserve(&z->pieces, &z->pieces_capacity, group_piece[IMPLICIT_GROUPS],
                       sizeof *z->pieces) != 0)
        return fail_for_memory(err);
    if (n_blocks > z->blocks_capacity) {
        const size_t capacity = n_blocks + n_blocks / 8;
        implicit_block *blocks = memory_alloc(capacity, sizeof *blocks);
        if (blocks == NULL)
            return fail_for_memory(err);
        memory_free(z->blocks);
        z->blocks = blocks;
        z->blocks_capacity = capacity;
    }
    (void)cut_groups(s, group, z->pieces, z->group_piece);
    memcpy(z->group, group, sizeof z->group);
    return BF_OK;
}

// Blocks of all pieces.
static size_t count_all_blocks(const implicit_state *z)
{
    const size_t n = z->group_piece[IMPLICIT_GROUPS];

    return n > 0 ? z->pieces[n - 1].block + z->pieces[n - 1].n_blocks : 0;
}

// What the choice of pairs needs. Chosen pairs stand by the lower id, those with the boundary first.
typedef struct choice {
    implicit_pair *pairs;
    uint8_t *colour; // of each pair: its group
    size_t n;        // pairs
    uint32_t *first; // by id and one more: its pairs
    uint64_t *used;  // by slot: colours taken
    uint32_t *head;  // by id: the lane of its first former pair with an impulse
    uint32_t *next;  // by lane: that of the next one with the same first id
} choice;

// Memory for the choice behind the list.
static bf_status reserve_choice(disk_state *s, const implicit_state *z, choice *ret_choice,
                                bf_error *err)
{
    const size_t n_lanes = count_all_blocks(z) * IMPLICIT_WIDTH;
    const size_t n_rows = s->list.first[s->n_padded / DISK_GROUP];
    // Candidates, and the list without those that stand there a second time.
    const size_t most = s->n_candidates + n_rows * DISK_GROUP / 2;
    choice *c = ret_choice;
    const memory_array arrays[] = {
        { &s->list.neighbour, DISK_GROUP * sizeof *s->list.neighbour, n_rows, n_rows },
        { &c->colour, sizeof *c->colour, 0, most },
        { &c->first, sizeof *c->first, 0, s->n + 1 },
        { &c->used, sizeof *c->used, 0, s->n_padded },
        { &c->head, sizeof *c->head, 0, s->n },
        { &c->next, sizeof *c->next, 0, n_lanes },
        { &c->pairs, sizeof *c->pairs, 0, most }, // the last one, as it has room to spare
    };

    c->n = 0;
    return memory_lay_out(&s->scratch, arrays, sizeof arrays / sizeof *arrays) == 0
               ? BF_OK
               : fail_for_memory(err);
}

static void add_pair(choice *c, uint32_t id, uint32_t other_id, uint8_t colour)
{
    c->colour[c->n] = colour;
    c->pairs[c->n++] = (implicit_pair){ .id = { id, other_id } };
}

// All pairs, those of parts in the order of ids: colours must not depend on the order
// of slots, which depends on earlier steps.
static void collect_pairs(const disk_state *s, choice *c)
{
    memset(c->used, 0, s->n_padded * sizeof *c->used);
    // The candidates, which stand by slot: a part's first one to group 0 and so on.
    uint8_t group = 0;
    for (size_t k = 0; k < s->n_candidates; k++) {
        disk_candidate t = s->candidates[k];
        bool is_another = k > 0 && s->candidates[k - 1].slot == t.slot;
        group = is_another && group < IMPLICIT_BOUNDARY ? (uint8_t)(group + 1) : group;
        group = is_another ? group : 0;
        add_pair(c, s->id_of[t.slot], IMPLICIT_FEATURE + t.feature,
                 group < IMPLICIT_BOUNDARY ? group : IMPLICIT_REST);
    }
    for (size_t id = 0; id < s->n; id++) {
        c->first[id] = (uint32_t)c->n;
        if (s->slot_of[id] < s->n_live) {
            const uint32_t slot = s->slot_of[id];
            for (size_t row = 0; row < disk__n_rows(s, slot); row++) {
                uint32_t other = disk__neighbour(s, slot, row);
                if (other == s->void_slot || s->id_of[other] < s->id_of[slot])
                    continue;
                const uint32_t colour =
                    colours_take(&c->used[slot], &c->used[other], IMPLICIT_COLOURS);
                add_pair(c, s->id_of[slot], s->id_of[other], (uint8_t)(IMPLICIT_BOUNDARY + colour));
            }
        }
    }
    c->first[s->n] = (uint32_t)c->n;
}

// Impulses of the former pairs go to the same pairs among the chosen ones.
static void take_impulses(const disk_state *s, const implicit_state *z, choice *c)
{
    memset(c->head, 0xff, s->n * sizeof *c->head);
    for (size_t piece = 0; piece < z->group_piece[IMPLICIT_GROUPS]; piece++) {
        const implicit_piece *p = &z->pieces[piece];
        for (size_t k = 0; k < p->n; k++) {
            size_t lane;
            const implicit_block *block = implicit_lane(z, p, k, &lane);
            if (block->normal[lane] == 0.0 && block->sliding[lane] == 0.0)
                continue;
            const size_t at = (size_t)(block - z->blocks) * IMPLICIT_WIDTH + lane;
            c->next[at] = c->head[block->row[0][lane]];
            c->head[block->row[0][lane]] = (uint32_t)at;
        }
    }
    for (size_t k = 0; k < c->n; k++) {
        implicit_pair *pair = &c->pairs[k];
        uint32_t at = c->head[pair->id[0]];
        while (at != nothing &&
               z->blocks[at / IMPLICIT_WIDTH].row[1][at % IMPLICIT_WIDTH] != pair->id[1])
            at = c->next[at];
        if (at == nothing)
            continue;
        pair->normal = z->blocks[at / IMPLICIT_WIDTH].normal[at % IMPLICIT_WIDTH];
        pair->sliding = z->blocks[at / IMPLICIT_WIDTH].sliding[at % IMPLICIT_WIDTH];
    }
}

// Add a pair to its group, which has n so far.
static void place_pair(implicit_state *z, const choice *c, size_t k, size_t *n)
{
    const size_t group = c->colour[k], at = n[group]++;
    const size_t piece = group == IMPLICIT_REST ? 0 : at / IMPLICIT_PIECE;

    disk_implicit__set_pair(z, &z->pieces[z->group_piece[group] + piece],
                            at - piece * IMPLICIT_PIECE, &c->pairs[k]);
}

bf_status disk_implicit__choose(disk_state *s, implicit_state *z, bf_error *err)
{
    size_t group[IMPLICIT_GROUPS + 1];
    choice c;

    bf_status status = reserve_choice(s, z, &c, err);
    if (status != BF_OK)
        return status;
    collect_pairs(s, &c);
    take_impulses(s, z, &c);
    memset(group, 0, (IMPLICIT_GROUPS + 1) * sizeof *group);
    for (size_t k = 0; k < c.n; k++)
        group[c.colour[k] + 1]++;
    for (size_t g = 0; g < IMPLICIT_GROUPS; g++)
        group[g + 1] += group[g];
    if ((status = disk_implicit__cut(s, z, group, err)) == BF_OK) {
        // Chosen pairs to their groups: coloured ones by slots, so that memory is accessed in order, the others in their
        // present order.
        size_t n[IMPLICIT_GROUPS] = { 0 };
        for (size_t slot = 0; slot < s->n_live; slot++) {
            uint32_t id = s->id_of[slot];
            for (size_t k = c.first[id]; k < c.first[id + 1]; k++)
                if (c.colour[k] != IMPLICIT_REST)
                    place_pair(z, &c, k, n);
        }
        for (size_t k = 0; k < c.n; k++)
            if (c.colour[k] < IMPLICIT_BOUNDARY || c.colour[k] == IMPLICIT_REST)
                place_pair(z, &c, k, n);
    }
    return status;
}

// How many pairs are with the boundary.
static size_t count_features(const disk_state *s, const implicit_state *z)
{
    size_t n = 0;

    for (size_t piece = 0; piece < z->group_piece[IMPLICIT_GROUPS]; piece++)
        for (size_t k = 0; k < z->pieces[piece].n; k++) {
            const implicit_pair pair = disk_implicit__pair(s, z, &z->pieces[piece], k);
            n += implicit_is_at_boundary(&pair);
        }
    return n;
}

// Gives pieces their laws: one for all pairs of parts if these are of one kind, else one for each block. Returns how
// many there are.
static size_t place_laws(const disk_state *s, implicit_state *z)
{
    size_t n = 1;

    for (size_t g = 0; g < IMPLICIT_GROUPS; g++) {
        const bool is_one =
            s->n_kinds == 1 && !s->def.tension && g >= IMPLICIT_BOUNDARY && g != IMPLICIT_REST;
        for (size_t k = z->group_piece[g]; k < z->group_piece[g + 1]; k++) {
            z->pieces[k].is_one_law = is_one;
            z->pieces[k].law = is_one ? 0 : n;
            n += is_one ? 0 : z->pieces[k].n_blocks;
        }
    }
    return n;
}

// Memory for steps instead of the list. The void slot is a static body too, the first one; a group has a part once
// at most.
static bf_status reserve_step(disk_state *s, implicit_state *z, bf_error *err)
{
    const size_t n_features = count_features(s, z), n_laws = place_laws(s, z);
    const size_t first_feature = s->void_slot + 1 + s->capacity / IMPLICIT_PIECE;
    const memory_array arrays[] = {
        { &z->bodies.rows, sizeof *z->bodies.rows, 0, first_feature + n_features },
        { &z->bodies.belt_dvx, sizeof *z->bodies.belt_dvx, 0, s->n_padded },
        { &z->bodies.belt_dvy, sizeof *z->bodies.belt_dvy, 0, s->n_padded },
        { &z->contacts, sizeof *z->contacts, 0, count_all_blocks(z) },
        { &z->laws, sizeof *z->laws, 0, n_laws },
        { &z->features, sizeof *z->features, 0, n_features },
        { &z->extremes, sizeof *z->extremes, 0, s->n_padded / IMPLICIT_CHUNK + 1 },
    };

    if (memory_lay_out(&s->scratch, arrays, sizeof arrays / sizeof *arrays) != 0)
        return fail_for_memory(err);
    z->first_feature = first_feature;
    return BF_OK;
}

bf_status disk_implicit__locate(disk_state *s, implicit_state *z, bf_error *err)
{
    size_t n_features = 0;

    bf_status status = reserve_step(s, z, err);
    if (status != BF_OK)
        return status;
    for (size_t piece = 0; piece < z->group_piece[IMPLICIT_GROUPS]; piece++) {
        const implicit_piece *p = &z->pieces[piece];
        for (size_t k = 0; k < p->n; k++) {
            implicit_pair pair = disk_implicit__pair(s, z, p, k);
            size_t row = z->first_feature + n_features;
            if (implicit_is_at_boundary(&pair))
                z->features[n_features++] = pair.id[1] - IMPLICIT_FEATURE;
            else
                row = s->slot_of[pair.id[1]];
            pair.id[0] = s->slot_of[pair.id[0]] * SIMD_QUAD;
            pair.id[1] = (uint32_t)row * SIMD_QUAD;
            disk_implicit__set_pair(z, p, k, &pair);
        }
    }
    disk_implicit__set_common_law(s, z);
    z->is_current = true;
    return BF_OK;
}

void disk_implicit__unlocate(const disk_state *s, implicit_state *z)
{
    for (size_t piece = 0; z->is_current && piece < z->group_piece[IMPLICIT_GROUPS]; piece++) {
        const implicit_piece *p = &z->pieces[piece];
        for (size_t k = 0; k < p->n; k++) {
            const implicit_pair pair = disk_implicit__pair(s, z, p, k);
            disk_implicit__set_pair(z, p, k, &pair);
        }
    }
    z->is_current = false;
}
