#include "core/base/memory.h"
#include "core/micro/body/implicit_priv.h"
#include "core/micro/implicit_step.h"

#include <math.h>

/// Of the smallest ball around a body: how far parts may move before the list is made anew, twice.
#define SKIN 1.0

/// How far the plates are seen, in radii of the largest ball: as far as a part may come to touch one
/// before the list is made anew.
#define SIGHT 2.0

/// Most rounds that the kinds of parts ask for.
static int find_rounds(const body_state *s)
{
    const double damping = fmax(s->cargo.damping, s->kinds[0].solid.damping);
    int rounds = 1;

    for (size_t k = 0; k < s->n_kinds; k++) {
        const body_kind *kind = &s->kinds[k];
        double stiffness = fmax(s->cargo.stiffness / (2.0 * kind->softness), kind->solid.stiffness);
        int own = implicit_step_rounds(s->n, s->def.dt, stiffness, damping, kind->mass);
        rounds = own > rounds ? own : rounds;
    }
    return rounds;
}

bf_status body__implicit_init(body_state *s, bf_error *err)
{
    s->implicit = memory_alloc(1, sizeof *s->implicit);
    body_solver *z = s->implicit;
    if (z != NULL) {
        z->holds = memory_alloc(s->n, sizeof *z->holds);
        z->movers = memory_alloc(s->n, sizeof *z->movers);
        z->used = memory_alloc(s->n, sizeof *z->used);
        z->shelves = memory_alloc(s->n_blocks, sizeof *z->shelves);
    }
    if (z == NULL || z->holds == NULL || z->movers == NULL || z->used == NULL || z->shelves == NULL)
        return bf_fail(err, BF_ENOMEM, "/initial", "no memory for %zu parts", s->n);
    z->rounds = find_rounds(s);
    s->list.skin = SKIN * s->reach_min;
    s->map_range = SIGHT * s->reach_max;
    return BF_OK;
}

void body__implicit_fini(body_state *s)
{
    body_solver *z = s->implicit;

    if (z == NULL)
        return;
    memory_free(z->holds);
    memory_free(z->movers);
    memory_free(z->used);
    memory_free(z->shelves);
    memory_free(z->patches);
    memory_free(z->order);
    memory_free(z);
}

/// Room for all patches until the list is stale: one for each pair, and for what solids a part may
/// come near to until then.
static bf_status make_room(body_state *s, bf_error *err)
{
    body_solver *z = s->implicit;
    size_t n = 0;

    for (size_t block = 0; block < s->n_blocks; block++) {
        const size_t begin = body__first_of(block), end = body__last_of(s, block);
        body_shelf *shelf = &z->shelves[block];
        shelf->first = n;
        shelf->room = s->first_pair[end] - s->first_pair[begin] + 1;
        for (size_t k = begin; k < end; k++)
            shelf->room += 1 + body__solids_count(s, k, s->list.skin);
        n += shelf->room;
    }
    if (memory_reserve(&z->patches, &z->patches_capacity, n, sizeof *z->patches) != 0 ||
        memory_reserve(&z->order, &z->order_capacity, s->n_pairs, sizeof(void *)) != 0) {
        s->is_listed = false;
        return bf_fail(err, BF_ENOMEM, "", "no memory for the contacts of %zu parts", s->n);
    }
    return BF_OK;
}

bf_status body__implicit_advance(body_state *s, uint64_t n, bf_error *err)
{
    while (n > 0) {
        if (!s->is_listed && (body__list(s, err) != BF_OK || make_room(s, err) != BF_OK))
            return BF_ENOMEM;
        uint64_t n_made = body_implicit__burst(s, n);
        n -= n_made;
        s->is_listed = n == 0;
        bf_status status = body__check(s, err);
        if (status != BF_OK)
            return status;
    }
    return BF_OK;
}
