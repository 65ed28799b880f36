#include "core/run/micro_sinks.h"

#include "core/base/memory.h"
#include "core/scene/sink.h"

#include <math.h>
#include <stdlib.h>

_Static_assert(sizeof(micro_sinks_tag) == 24, "no padding");

void micro_sinks_init(micro_sinks *m, const scene *s, micro_solver *solver)
{
    *m = (micro_sinks){ .scene = s, .solver = solver };
    for (size_t k = 0; k < s->n_sinks; k++)
        m->free_at[k] = -INFINITY;
}

void micro_sinks_fini(micro_sinks *m)
{
    memory_free(m->tags);
    memory_free(m->waiting);
    *m = (micro_sinks){ .scene = NULL };
}

static bf_status reserve_tags(micro_sinks *m, size_t n, bf_error *err)
{
    if (memory_reserve(&m->tags, &m->n_tags_max, n, sizeof *m->tags) != 0)
        return bf_fail(err, BF_ENOMEM, "", "no memory for %zu parts in sinks", n);
    for (; m->n_tags < n; m->n_tags++)
        m->tags[m->n_tags] = (micro_sinks_tag){ .id = UINT64_MAX };
    return BF_OK;
}

// Finds the sinks that the parts are in at t.
static void find_sinks(micro_sinks *m, double t)
{
    for (size_t k = 0; k < m->n_tags; k++) {
        if (micro_is_gone(m->solver, k))
            continue;
        const micro_part part = micro_part_of(m->solver, k);
        const size_t sink =
            sink_at(m->scene, (vec2){ part.x[0], part.x[1] }, micro_kind_of(m->solver, k));
        const uint64_t id = micro_id_of(m->solver, k);
        if (m->tags[k].id != id || m->tags[k].sink != sink)
            m->tags[k] = (micro_sinks_tag){ .id = id, .since = t, .sink = (uint32_t)sink };
    }
}

// By sinks, then by how long parts have been there, then by ids.
static int compare_waiting(const void *left, const void *right)
{
    const micro_sinks_tag *a = &((const micro_sinks_waiting *)left)->tag,
                          *b = &((const micro_sinks_waiting *)right)->tag;

    if (a->sink != b->sink)
        return a->sink < b->sink ? -1 : 1;
    if (a->since != b->since)
        return a->since < b->since ? -1 : 1;
    return (a->id > b->id) - (a->id < b->id);
}

// The parts in sinks that are free at t, those first that come first.
static bf_status find_waiting(micro_sinks *m, double t, size_t *ret_n, bf_error *err)
{
    size_t n = 0;

    for (size_t k = 0; k < m->n_tags; k++) {
        const micro_sinks_tag *tag = &m->tags[k];
        if (micro_is_gone(m->solver, k) || tag->sink >= m->scene->n_sinks ||
            m->free_at[tag->sink] > t)
            continue;
        if (memory_reserve(&m->waiting, &m->n_waiting_max, n + 1, sizeof *m->waiting) != 0)
            return bf_fail(err, BF_ENOMEM, "", "no memory for %zu parts in sinks", n + 1);
        m->waiting[n++] = (micro_sinks_waiting){ k, *tag };
    }
    if (n > 0)
        qsort(m->waiting, n, sizeof *m->waiting, compare_waiting);
    *ret_n = n;
    return BF_OK;
}

bf_status micro_sinks_take(micro_sinks *m, bf_error *err)
{
    const double t = (double)micro_steps(m->solver) * micro_dt(m->solver);
    size_t n = 0;
    bf_status status = reserve_tags(m, micro_parts(m->solver), err);

    if (status != BF_OK)
        return status;
    find_sinks(m, t);
    status = find_waiting(m, t, &n, err);
    for (size_t k = 0; status == BF_OK && k < n; k++) {
        const micro_sinks_waiting *next = &m->waiting[k];
        double *free_at = &m->free_at[next->tag.sink];
        if (*free_at > t)
            continue;
        micro_take_out(m->solver, next->part);
        m->tags[next->part].is_taken = 1;
        m->taken[next->tag.sink] += 1.0;
        *free_at = fmax(*free_at, next->tag.since) + 1.0 / m->scene->sinks[next->tag.sink].rate;
    }
    return status;
}

bool micro_sinks_took(const micro_sinks *m, size_t part, uint64_t id)
{
    return part < m->n_tags && m->tags[part].id == id && m->tags[part].is_taken != 0;
}

void micro_sinks_save(const micro_sinks *m, checkpoint_writer *w)
{
    const uint64_t n = m->n_tags;

    checkpoint_write(w, m->free_at, m->scene->n_sinks * sizeof *m->free_at);
    checkpoint_write(w, m->taken, m->scene->n_sinks * sizeof *m->taken);
    checkpoint_write(w, &n, sizeof n);
    checkpoint_write(w, m->tags, n * sizeof *m->tags);
}

bf_status micro_sinks_load(micro_sinks *m, checkpoint_reader *r, bf_error *err)
{
    uint64_t n = 0;

    if (!checkpoint_read(r, m->free_at, m->scene->n_sinks * sizeof *m->free_at) ||
        !checkpoint_read(r, m->taken, m->scene->n_sinks * sizeof *m->taken) ||
        !checkpoint_read(r, &n, sizeof n) || n > r->n_left / sizeof *m->tags)
        return bf_fail(err, BF_ECORRUPT, "", "the checkpoint's sinks are damaged");
    const bf_status status = reserve_tags(m, (size_t)n, err);
    if (status != BF_OK)
        return status;
    if (!checkpoint_read(r, m->tags, (size_t)n * sizeof *m->tags))
        return bf_fail(err, BF_ECORRUPT, "", "the checkpoint's sinks are damaged");
    return BF_OK;
}
