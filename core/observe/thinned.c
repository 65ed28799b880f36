#include "core/observe/thinned.h"

#include "core/base/memory.h"

enum { ROOM = THINNED_SAMPLES + 1 };

bf_status thinned_init(thinned *ret_c, bf_error *err)
{
    double *room = memory_alloc(ROOM, 2 * sizeof *room);

    if (room == NULL)
        return bf_fail(err, BF_ENOMEM, "", "no memory for key figures");
    *ret_c = (thinned){ .every = 1, .t = room, .values = room + ROOM };
    return BF_OK;
}

void thinned_fini(thinned *c)
{
    memory_free(c->t);
    *c = (thinned){ .t = NULL };
}

// Of the samples before the n-th, how many stay.
static uint64_t staying(const thinned *c, uint64_t n)
{
    return n / c->every + (n % c->every != 0);
}

void thinned_add(thinned *c, double t, double value)
{
    if (c->n_taken == c->every * THINNED_SAMPLES) {
        c->every *= 2;
        for (uint64_t k = 1; k < staying(c, c->n_taken); k++) {
            c->t[k] = c->t[2 * k];
            c->values[k] = c->values[2 * k];
        }
    }
    const uint64_t at = staying(c, c->n_taken++);
    c->t[at] = t;
    c->values[at] = value;
}

compare_curve thinned_curve(const thinned *c)
{
    const uint64_t n = c->n_taken == 0 ? 0 : staying(c, c->n_taken - 1) + 1;

    return (compare_curve){ .n = n, .t = c->t, .parts = c->values };
}

void thinned_save(const thinned *c, checkpoint_writer *w)
{
    const compare_curve curve = thinned_curve(c);

    checkpoint_write(w, &c->n_taken, sizeof c->n_taken);
    checkpoint_write(w, curve.t, curve.n * sizeof *curve.t);
    checkpoint_write(w, curve.parts, curve.n * sizeof *curve.parts);
}

bool thinned_load(thinned *c, checkpoint_reader *r)
{
    if (!checkpoint_read(r, &c->n_taken, sizeof c->n_taken))
        return false;
    for (c->every = 1; c->n_taken > 0 && (c->n_taken - 1) / c->every >= THINNED_SAMPLES;)
        c->every *= 2;
    const size_t n = thinned_curve(c).n;
    return checkpoint_read(r, c->t, n * sizeof *c->t) &&
           checkpoint_read(r, c->values, n * sizeof *c->values);
}
