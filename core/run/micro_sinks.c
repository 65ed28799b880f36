#include "core/run/micro_sinks.h"

#include "core/base/memory.h"
#include "core/scene/sink.h"

#include <math.h>

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

// The part that has been in a sink for longest, of several the one with the lowest id; n_tags: there is none.
static size_t find_first(const micro_sinks *m, size_t sink)
{
    size_t first = m->n_tags;

    for (size_t k = 0; k < m->n_tags; k++) {
        const micro_sinks_tag *tag = &m->tags[k];
        if (tag->sink != sink || micro_is_gone(m->solver, k))
            continue;
        const micro_sinks_tag *best = first < m->n_tags ? &m->tags[first] : NULL;
        if (best == NULL || tag->since < best->since ||
            (tag->since == best->since && tag->id < best->id))
            first = k;
    }
    return first;
}

bf_status micro_sinks_take(micro_sinks *m, bf_error *err)
{
    const double t = (double)micro_steps(m->solver) * micro_dt(m->solver);
    const bf_status status = reserve_tags(m, micro_parts(m->solver), err);

    if (status != BF_OK)
        return status;
    find_sinks(m, t);
    for (size_t sink = 0; sink < m->scene->n_sinks; sink++) {
        while (m->free_at[sink] <= t) {
            const size_t part = find_first(m, sink);
            if (part == m->n_tags)
                break;
            micro_take_out(m->solver, part);
            m->tags[part].is_taken = 1;
            m->taken[sink] += 1.0;
            m->free_at[sink] =
                fmax(m->free_at[sink], m->tags[part].since) + 1.0 / m->scene->sinks[sink].rate;
        }
    }
    return BF_OK;
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
