#include "core/observe/passages.h"

#include "core/base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

// A front or a back that crossed the beam.
typedef struct crossing {
    double travel;
    bool is_begin;
} crossing;

void passages_fini(passages *p)
{
    memory_free(p->parts);
    *p = (passages){ .n = 0 };
}

// An end before a begin at the same place: parts that touch do not overlap.
static int compare_crossings(const void *left, const void *right)
{
    const crossing *a = left, *b = right;

    if (a->travel != b->travel)
        return a->travel < b->travel ? -1 : 1;
    return (int)a->is_begin - (int)b->is_begin;
}

// Fills what crossed since the last tick, at most p->n + view->n; both lists have rising ids. Returns how many.
static size_t find_crossings(const passages *p, double t, double travel, const passages_view *view,
                             crossing *ret_all)
{
    const double passed = t - p->t;
    size_t i = 0, k = 0, n = 0;

    while (i < p->n || k < view->n) {
        const bool has_left = k == view->n || (i < p->n && p->parts[i].id < view->parts[k].id);
        const bool is_new = i == p->n || (k < view->n && view->parts[k].id < p->parts[i].id);
        if (has_left)
            ret_all[n++] =
                (crossing){ p->travel + fmin(p->parts[i].left, passed) * p->belt_speed, false };
        else if (is_new)
            ret_all[n++] =
                (crossing){ travel - fmin(view->parts[k].since, passed) * view->belt_speed, true };
        i += is_new ? 0 : 1;
        k += has_left ? 0 : 1;
    }
    return n;
}

bf_status passages_see(passages *p, double t, const passages_view *view, size_t eye, figures *f,
                       double *ret_free, bf_error *err)
{
    const double travel = p->travel + 0.5 * (p->belt_speed + view->belt_speed) * (t - p->t);
    crossing *all = memory_alloc(p->n + view->n, sizeof *all);

    if (all == NULL || memory_reserve(&p->parts, &p->n_max, view->n, sizeof *p->parts) != 0) {
        memory_free(all);
        return bf_fail(err, BF_ENOMEM, "", "no memory for what a photo eye sees");
    }
    const size_t n = find_crossings(p, t, travel, view, all);
    qsort(all, n, sizeof *all, compare_crossings);
    size_t n_in = p->n; // parts in the beam
    double gap = 0.0;   // m of travel
    for (size_t k = 0; k < n; k++) {
        n_in = all[k].is_begin ? n_in + 1 : n_in - 1;
        if (n_in == 0 && k + 1 < n)
            gap = fmax(gap, all[k + 1].travel - all[k].travel);
        p->n_left += all[k].is_begin ? 0 : 1;
        if (all[k].is_begin)
            figures_eye_begin(f, eye, all[k].travel);
        else
            figures_eye_end(f, eye, all[k].travel);
    }
    memory_free(all);
    // Of a belt that went back, or there and back, nothing is known between the ticks.
    *ret_free = gap > 0.0 && travel > p->travel ? gap / (travel - p->travel) * (t - p->t) : 0.0;
    p->t = t;
    p->travel = travel;
    p->belt_speed = view->belt_speed;
    p->n = view->n;
    if (view->n > 0)
        memcpy(p->parts, view->parts, view->n * sizeof *p->parts);
    return BF_OK;
}

void passages_save(const passages *p, checkpoint_writer *w)
{
    const uint64_t n = p->n;

    checkpoint_write(w, &p->t, sizeof p->t);
    checkpoint_write(w, &p->travel, sizeof p->travel);
    checkpoint_write(w, &p->belt_speed, sizeof p->belt_speed);
    checkpoint_write(w, &p->n_left, sizeof p->n_left);
    checkpoint_write(w, &n, sizeof n);
    checkpoint_write(w, p->parts, p->n * sizeof *p->parts);
}

bf_status passages_load(passages *p, checkpoint_reader *r, bf_error *err)
{
    const char *parts = NULL;
    uint64_t n = 0;

    if (checkpoint_read(r, &p->t, sizeof p->t) &&
        checkpoint_read(r, &p->travel, sizeof p->travel) &&
        checkpoint_read(r, &p->belt_speed, sizeof p->belt_speed) &&
        checkpoint_read(r, &p->n_left, sizeof p->n_left) && checkpoint_read(r, &n, sizeof n))
        parts = checkpoint_read_items(r, n, sizeof *p->parts);
    if (parts == NULL)
        return bf_fail(err, BF_ECORRUPT, "", "the checkpoint is damaged");
    if (memory_reserve(&p->parts, &p->n_max, (size_t)n, sizeof *p->parts) != 0)
        return bf_fail(err, BF_ENOMEM, "", "no memory for what a photo eye sees");
    p->n = (size_t)n;
    if (n > 0)
        memcpy(p->parts, parts, p->n * sizeof *p->parts);
    return BF_OK;
}
