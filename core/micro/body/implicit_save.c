// The impulses that MICRO_IMPLICIT keeps between steps in space, as bytes.

#include "core/micro/body/implicit_priv.h"

#include <string.h>

/// An impulse; those of pairs stand first, in the order of the pairs, then those with solids.
typedef struct saved_hold {
    uint32_t a;
    uint32_t b;   // BODY_STILL: a solid
    uint32_t key; // > 0
    uint32_t zero;
    double push[3];
    double twist[3];
} saved_hold;

/// Returns how many it wrote.
static uint64_t save_hold(uint32_t a, uint32_t b, const body_hold *hold, checkpoint_writer *w)
{
    const saved_hold saved = { a,
                               b,
                               hold->key,
                               0,
                               { hold->push.x, hold->push.y, hold->push.z },
                               { hold->twist.x, hold->twist.y, hold->twist.z } };

    if (hold->key == 0)
        return 0;
    checkpoint_write(w, &saved, sizeof saved);
    return 1;
}

uint64_t body__implicit_save(const body_state *s, checkpoint_writer *w)
{
    uint64_t n = 0;

    for (size_t k = 0; k < s->n_pairs; k++)
        n += save_hold(s->pairs[k].a, s->pairs[k].b, &s->pairs[k].hold, w);
    for (size_t k = 0; k < s->n; k++)
        for (size_t m = 0; m < BODY_HOLDS; m++)
            n += save_hold((uint32_t)k, BODY_STILL, &s->implicit->holds[k][m], w);
    return n;
}

/// The next free place of a part; NULL if there is none.
static body_hold *find_place(body_hold *holds)
{
    for (size_t k = 0; k < BODY_HOLDS; k++)
        if (holds[k].key == 0)
            return &holds[k];
    return NULL;
}

/// Where a saved impulse belongs; *cursor walks along the pairs. NULL: nowhere.
static body_hold *locate(const body_state *s, const saved_hold *saved, body_pair *listed,
                         size_t n_pairs, size_t *cursor, body_hold (*holds)[BODY_HOLDS])
{
    if (saved->key == 0 || saved->a >= s->n)
        return NULL;
    if (saved->b == BODY_STILL)
        return find_place(holds[saved->a]);
    while (*cursor < n_pairs && (listed[*cursor].a != saved->a || listed[*cursor].b != saved->b))
        (*cursor)++;
    return *cursor < n_pairs ? &listed[*cursor].hold : NULL;
}

bool body__implicit_load(const body_state *s, checkpoint_reader *r, uint64_t n, body_pair *listed,
                         size_t n_pairs, body_hold (*holds)[BODY_HOLDS])
{
    size_t cursor = 0;
    saved_hold saved;

    for (uint64_t k = 0; k < n; k++) {
        if (!checkpoint_read(r, &saved, sizeof saved))
            return false;
        body_hold *hold = locate(s, &saved, listed, n_pairs, &cursor, holds);
        if (hold == NULL)
            return false;
        *hold = (body_hold){ saved.key,
                             { saved.push[0], saved.push[1], saved.push[2] },
                             { saved.twist[0], saved.twist[1], saved.twist[2] } };
    }
    return true;
}
