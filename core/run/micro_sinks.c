#include "core/run/micro_sinks.h"

#include "core/base/memory.h"
#include "core/scene/sink.h"

#include <math.h>
#include <stdlib.h>

void micro_sinks_init(micro_sinks *m, const scene *s)
{
    *m = (micro_sinks){ .scene = s };
    for (size_t k = 0; k < s->n_sinks; k++)
        m->free_at[k] = -INFINITY;
}

void micro_sinks_fini(micro_sinks *m)
{
    memory_free(m->waiting);
    *m = (micro_sinks){ .scene = NULL };
}

// By sinks, then by how long parts have been there, then by ids.
static int compare_waiting(const void *left, const void *right)
{
    const micro_sinks_waiting *a = left, *b = right;

    if (a->sink != b->sink)
        return a->sink < b->sink ? -1 : 1;
    if (a->since != b->since)
        return a->since < b->since ? -1 : 1;
    return (a->id > b->id) - (a->id < b->id);
}

bf_status micro_sinks_take(micro_sinks *m, micro_feeds *f, bf_error *err)
{
    const double t = (double)micro_steps(f->solver) * micro_dt(f->solver);
    size_t n = 0;

    // The sinks that the parts are in, and the parts in those that are free.
    for (size_t k = 0; k < micro_parts(f->solver); k++) {
        if (micro_is_gone(f->solver, k))
            continue;
        const micro_part part = micro_part_of(f->solver, k);
        const vec2 at = { part.x[0], part.x[1] };
        const size_t sink = sink_at(m->scene, at, f->tags[k].kind);
        if (f->tags[k].sink != sink) {
            f->tags[k].sink = (uint32_t)sink;
            f->tags[k].in_sink = t;
        }
        if (sink >= m->scene->n_sinks || m->free_at[sink] > t)
            continue;
        if (memory_reserve(&m->waiting, &m->n_waiting_max, n + 1, sizeof *m->waiting) != 0)
            return bf_fail(err, BF_ENOMEM, "", "no memory for %zu parts in sinks", n + 1);
        m->waiting[n++] = (micro_sinks_waiting){ k, micro_id_of(f->solver, k), f->tags[k].in_sink,
                                                 (uint32_t)sink };
    }
    if (n > 0)
        qsort(m->waiting, n, sizeof *m->waiting, compare_waiting);
    for (size_t k = 0; k < n; k++) {
        const micro_sinks_waiting *next = &m->waiting[k];
        double *free_at = &m->free_at[next->sink];
        if (*free_at > t)
            continue;
        micro_take_out(f->solver, next->part);
        f->tags[next->part].is_taken = 1;
        m->taken[next->sink] += 1.0;
        *free_at = fmax(*free_at, next->since) + 1.0 / m->scene->sinks[next->sink].rate;
    }
    return BF_OK;
}

void micro_sinks_save(const micro_sinks *m, checkpoint_writer *w)
{
    checkpoint_write(w, m->free_at, m->scene->n_sinks * sizeof *m->free_at);
    checkpoint_write(w, m->taken, m->scene->n_sinks * sizeof *m->taken);
}

bool micro_sinks_load(micro_sinks *m, checkpoint_reader *r)
{
    return checkpoint_read(r, m->free_at, m->scene->n_sinks * sizeof *m->free_at) &&
           checkpoint_read(r, m->taken, m->scene->n_sinks * sizeof *m->taken);
}
