#include "core/base/memory.h"
#include "core/micro/disk/implicit_priv.h"
#include "core/micro/implicit_step.h"

#include <math.h>

#define X(suffix) extern const implicit_kernels implicit_kernels_##suffix;
CPU_EACH_BUILD(X)
#undef X

const implicit_kernels *disk_implicit__kernels(cpu_level level)
{
    static const implicit_kernels *const builds[] = {
#define X(suffix) &implicit_kernels_##suffix,
        CPU_EACH_BUILD(X)
#undef X
    };

    return builds[level];
}

static void *alloc_or_fail(size_t n, size_t size, bool *has_failed)
{
    void *block = memory_alloc(n, size);

    *has_failed |= !block;
    return block;
}

implicit_state *disk_implicit__destroy(implicit_state *z)
{
    if (!z)
        return NULL;
    memory_free(z->pairs);
    memory_free(z->spare);
    memory_free(z->colour);
    memory_free(z->next);
    memory_free(z->head);
    memory_free(z->first);
    memory_free(z->used);
    memory_free(z->pieces);
    memory_free(z->blocks);
    memory_free(z->bodies);
    memory_free(z->extremes);
    memory_free(z);
    return NULL;
}

// Most rounds that the kinds of parts ask for.
static int find_rounds(const disk_state *s)
{
    const double damping = fmax(s->cargo.damping, s->handling.damping);
    int rounds = 1;

    for (size_t k = 0; k < s->n_kinds; k++) {
        const disk_row *row = &s->kinds[k].row;
        double cargo = s->cargo.line / (2.0 * row->softness);
        double handling = s->handling.line / (row->softness + s->handling_softness);
        int own = implicit_step_rounds(s->n, s->def.dt, fmax(cargo, handling), damping,
                                       1.0 / row->inverse_mass);
        rounds = own > rounds ? own : rounds;
    }
    return rounds;
}

implicit_state *disk_implicit__create(const disk_state *s)
{
    // The void place is ground too; a group has a part once at most.
    size_t n_places = (size_t)s->void_place + 1, n_ground = s->n / IMPLICIT_PIECE;
    bool has_failed = false;
    implicit_state *z = memory_alloc(1, sizeof *z);

    if (!z)
        return NULL;
    z->head = alloc_or_fail(s->n, sizeof *z->head, &has_failed);
    z->first = alloc_or_fail(s->n + 1, sizeof *z->first, &has_failed);
    z->used = alloc_or_fail(n_places, sizeof *z->used, &has_failed);
    z->bodies = alloc_or_fail(n_places + n_ground, sizeof *z->bodies, &has_failed);
    z->extremes = alloc_or_fail(n_places / IMPLICIT_CHUNK + 1, sizeof *z->extremes, &has_failed);
    z->rounds = find_rounds(s);
    z->skin = s->radius_min;
    z->kernels = disk_implicit__kernels(cpu_best());
    return has_failed ? disk_implicit__destroy(z) : z;
}

void disk__implicit_fini(disk_state *s)
{
    s->implicit = disk_implicit__destroy(s->implicit);
}

// The list with the skin that pairs are chosen from.
static bf_status rebuild(disk_state *s, implicit_state *z, bf_error *err)
{
    s->skin = z->skin;
    z->is_current = false;
    return disk__rebuild(s, err);
}

// The list and the pairs as the next step needs them. The list alone is made anew if it is of another
// age than the pairs, as after a load.
static bf_status refresh(disk_state *s, implicit_state *z, bf_error *err)
{
    bool is_stale = !z->is_chosen || disk_implicit__is_stale(z, z->travel, z->move);

    if (is_stale || disk_implicit__is_list_stale(s, s->travel, z->move)) {
        bf_status status = rebuild(s, z, err);
        if (status == BF_OK && is_stale)
            status = disk_implicit__choose(s, z, err);
        if (status != BF_OK)
            return status;
    }
    if (is_stale) {
        z->is_current = z->is_chosen = true;
        z->travel = 0.0;
    }
    if (!z->is_current)
        disk_implicit__locate(s, z);
    z->is_current = true;
    return BF_OK;
}

bf_status disk__advance_implicit(disk_state *s, uint64_t n, bf_error *err)
{
    if (!s->implicit)
        s->implicit = disk_implicit__create(s);
    implicit_state *z = s->implicit;
    if (!z)
        return bf_fail(err, BF_ENOMEM, "", "no memory for the solver");

    while (n > 0) {
        bool is_suspect = false;
        bf_status status = refresh(s, z, err);
        if (status != BF_OK)
            return status;
        n -= disk_implicit__burst(s, z, n, &is_suspect);
        if (is_suspect && (status = disk__check(s, err)) != BF_OK)
            return status;
    }
    return BF_OK;
}
