// What MICRO_IMPLICIT keeps between steps, as bytes.

#include "core/micro/disk/implicit_priv.h"

#include <math.h>
#include <string.h>

// What stands before the pairs.
typedef struct state_header {
    uint64_t is_chosen;
    uint64_t n_pairs;
    double travel;
    double move;
    uint64_t group[IMPLICIT_GROUPS + 1];
} state_header;

// A pair without its places.
typedef struct state_pair {
    uint32_t number[2];
    double normal;
    double sliding;
} state_pair;

static state_header header_of(const implicit_state *z)
{
    state_header header = {
        .is_chosen = z->is_chosen, .n_pairs = z->n_pairs, .travel = z->travel, .move = z->move
    };

    for (size_t g = 0; g <= IMPLICIT_GROUPS; g++)
        header.group[g] = z->group[g];
    return header;
}

void disk__implicit_save(const disk_state *s, checkpoint_writer *w)
{
    const implicit_state *z = s->implicit;

    if (!z)
        return;
    const state_header header = header_of(z);
    checkpoint_write(w, &header, sizeof header);
    for (size_t k = 0; k < z->n_pairs; k++) {
        const implicit_pair *p = &z->pairs[k];
        const state_pair pair = { { p->number[0], p->number[1] }, p->normal, p->sliding };
        checkpoint_write(w, &pair, sizeof pair);
    }
}

static bool is_header_sound(const state_header *h)
{
    bool is_sound = h->is_chosen <= 1 && h->travel >= 0.0 && h->move >= 0.0 &&
                    isfinite(h->travel) && isfinite(h->move) && h->group[0] == 0 &&
                    h->group[IMPLICIT_GROUPS] == h->n_pairs;

    for (size_t g = 0; g < IMPLICIT_GROUPS; g++)
        is_sound = is_sound && h->group[g] <= h->group[g + 1];
    return is_sound;
}

// Touches and pairs of parts in their groups, and in none but the last a part twice: registers and
// threads rely on it.
static bool is_pair_sound(const disk_state *s, const implicit_state *z, size_t k, uint32_t group)
{
    const implicit_pair *p = &z->pairs[k];
    size_t n_features = s->n_faces + s->n_arcs;
    bool is_solid = p->number[1] >= s->n;

    if (p->number[0] >= s->n || !isfinite(p->normal) || !isfinite(p->sliding))
        return false;
    if (is_solid ? p->number[1] - s->n >= n_features : p->number[1] <= p->number[0])
        return false;
    if (group != IMPLICIT_REST && is_solid != (group < IMPLICIT_SOLIDS))
        return false;
    for (int end = 0; group != IMPLICIT_REST && end < (is_solid ? 1 : 2); end++) {
        if (z->head[p->number[end]] == group)
            return false;
        z->head[p->number[end]] = group;
    }
    return true;
}

static bool take_pairs(const disk_state *s, implicit_state *z, const char *bytes)
{
    uint32_t group = 0;

    memset(z->head, 0xff, s->n * sizeof *z->head);
    for (size_t k = 0; k < z->n_pairs; k++) {
        state_pair pair;
        memcpy(&pair, bytes + k * sizeof pair, sizeof pair);
        z->pairs[k] = (implicit_pair){ .number = { pair.number[0], pair.number[1] },
                                       .place = { s->void_place, s->void_place },
                                       .normal = pair.normal,
                                       .sliding = pair.sliding };
        while (z->group[group + 1] <= k)
            group++;
        if (!is_pair_sound(s, z, k, group))
            return false;
    }
    return true;
}

static bf_status take_state(const disk_state *s, implicit_state *z, const state_header *header,
                            const char *bytes, bf_error *err)
{
    z->is_chosen = header->is_chosen != 0;
    z->n_pairs = header->n_pairs;
    z->travel = header->travel;
    z->move = header->move;
    for (size_t g = 0; g <= IMPLICIT_GROUPS; g++)
        z->group[g] = header->group[g];
    bf_status status = disk_implicit__reserve(z, z->n_pairs, err);
    if (status == BF_OK)
        status = disk_implicit__cut(s, z, err);
    if (status == BF_OK && !take_pairs(s, z, bytes))
        status = bf_fail(err, BF_ECORRUPT, "", "the saved pairs of parts are not of these parts");
    return status;
}

bf_status disk__implicit_load(disk_state *s, checkpoint_reader *r, bf_error *err)
{
    state_header header;
    implicit_state *z = NULL;
    bf_status status = BF_OK;

    if (r->n_left > 0) {
        const char *pairs = NULL;
        if (checkpoint_read(r, &header, sizeof header) && is_header_sound(&header))
            pairs = checkpoint_read_items(r, header.n_pairs, sizeof(state_pair));
        if (pairs == NULL || r->n_left > 0)
            return bf_fail(err, BF_ECORRUPT, "", "the saved pairs of parts are damaged");
        z = disk_implicit__create(s);
        status = z ? take_state(s, z, &header, pairs, err)
                   : bf_fail(err, BF_ENOMEM, "", "no memory for the solver");
    }
    if (status != BF_OK) {
        disk_implicit__destroy(z);
        return status;
    }
    disk__implicit_fini(s);
    s->implicit = z;
    return BF_OK;
}
