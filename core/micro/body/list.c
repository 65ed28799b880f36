// The list of neighbours, and each pair of it once, with what is remembered of it.

#include "core/micro/body/body_priv.h"

#include "core/base/memory.h"

#include <string.h>

/// Find the first pair of each part and make room for all.
static bf_status count_pairs(body_state *s)
{
    const neighbours_list *list = &s->list;
    size_t n = 0;

    for (size_t k = 0; k < s->n; k++) {
        s->first_pair[k] = n;
        for (size_t at = list->start[k]; at < list->start[k + 1]; at++)
            n += list->neighbour[at] > k;
    }
    s->first_pair[s->n] = n;
    if (memory_reserve(&s->spare, &s->spare_capacity, n, sizeof *s->spare) != 0 ||
        memory_reserve(&s->links, &s->links_capacity, 2 * n, sizeof *s->links) != 0)
        return BF_ENOMEM;
    return BF_OK;
}

static bool is_before(const body_pair *left, const body_pair *right)
{
    return left->a != right->a ? left->a < right->a : left->b < right->b;
}

/// Write the new pairs into the spare storage; both lists are sorted, so that one walk along the
/// old one finds what is remembered.
static void write_pairs(body_state *s)
{
    const neighbours_list *list = &s->list;
    size_t old = 0, n = 0;

    for (size_t k = 0; k < s->n; k++) {
        for (size_t at = list->start[k]; at < list->start[k + 1]; at++) {
            if (list->neighbour[at] <= k)
                continue;
            body_pair pair = { .a = (uint32_t)k, .b = list->neighbour[at] };
            while (old < s->n_pairs && is_before(&s->pairs[old], &pair))
                old++;
            if (old < s->n_pairs && !is_before(&pair, &s->pairs[old]))
                pair = s->pairs[old];
            s->links[at] = (uint32_t)n;
            s->spare[n++] = pair;
        }
    }
}

/// Link the places of neighbours with smaller numbers: those of a part stand in the order in which
/// its pairs come up.
static void link_back(body_state *s)
{
    const neighbours_list *list = &s->list;
    size_t *cursor = s->cursor;

    memcpy(cursor, s->first_pair, s->n * sizeof *cursor);
    for (size_t k = 0; k < s->n; k++)
        for (size_t at = list->start[k]; at < list->start[k + 1]; at++)
            if (list->neighbour[at] < k)
                s->links[at] = (uint32_t)cursor[list->neighbour[at]]++;
}

bf_status body__list(body_state *s, bf_error *err)
{
    const neighbours_parts parts = { .x = &s->bodies->x.x,
                                     .y = &s->bodies->x.y,
                                     .stride = sizeof *s->bodies / sizeof(double),
                                     .radius = s->reach,
                                     .radius_stride = 1 };

    s->is_listed = false;
    bf_status status = neighbours_build(&s->list, s->n, parts, s->is_gone, err);
    if (status != BF_OK)
        return status;
    if (count_pairs(s) != BF_OK || s->first_pair[s->n] > UINT32_MAX)
        return bf_fail(err, BF_ENOMEM, "", "no memory for the pairs of neighbours");
    write_pairs(s);
    link_back(s);
    body_pair *swap = s->pairs;
    size_t swap_capacity = s->pairs_capacity;
    s->pairs = s->spare;
    s->pairs_capacity = s->spare_capacity;
    s->spare = swap;
    s->spare_capacity = swap_capacity;
    s->n_pairs = s->first_pair[s->n];
    for (size_t block = 0; block < s->n_blocks; block++)
        s->reports[block].is_stale = false;
    s->is_listed = true;
    return BF_OK;
}
