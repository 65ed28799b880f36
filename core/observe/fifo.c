#include "core/observe/fifo.h"

#include "core/base/memory.h"

#include <math.h>
#include <string.h>

// Corners that are closer than this part of the time of all of them are merged.
static const double finest = 1.0 / 2048.0;

bf_status fifo_init(fifo *ret_f, bf_error *err)
{
    *ret_f = (fifo){ .corners = memory_alloc(FIFO_CORNERS, sizeof(fifo_corner)) };
    if (ret_f->corners == NULL)
        return bf_fail(err, BF_ENOMEM, "", "no memory for key figures");
    ret_f->n = 1; // (0, 0)
    return BF_OK;
}

void fifo_fini(fifo *f)
{
    memory_free(f->corners);
    *f = (fifo){ .corners = NULL };
}

static void enter(fifo *f, double t, double level)
{
    fifo_corner *last = &f->corners[f->n - 1];

    level = fmax(level, last->level);
    if (f->n >= 2 && (level == last[-1].level || t - last[-1].t < (t - f->corners[0].t) * finest)) {
        *last = (fifo_corner){ t, level };
        return;
    }
    if (f->n == FIFO_CORNERS) {
        // Drops every second corner, but neither the first nor the last.
        const fifo_corner newest = f->corners[f->n - 1];
        size_t n = 0;
        for (size_t k = 0; k < f->n - 1; k += 2)
            f->corners[n++] = f->corners[k];
        f->corners[n++] = newest;
        f->n = n;
    }
    f->corners[f->n++] = (fifo_corner){ t, level };
}

static double time_at(fifo_corner from, fifo_corner to, double level)
{
    return from.t + (to.t - from.t) * ((level - from.level) / (to.level - from.level));
}

void fifo_sample(fifo *f, double t, double entered, double exited, quantiles *times)
{
    const fifo_corner end = { t, fmax(exited, f->out.level) };
    double level = f->out.level;
    size_t k = 0; // the piece of E from this corner to the next one

    enter(f, t, entered);
    while (level < end.level && k + 1 < f->n) {
        const fifo_corner from = f->corners[k], to = f->corners[k + 1];
        const double next = fmin(end.level, to.level);
        if (next <= level) {
            k++;
            continue;
        }
        const double a = time_at(f->out, end, level) - time_at(from, to, level);
        const double b = time_at(f->out, end, next) - time_at(from, to, next);
        if (times != NULL)
            quantiles_add_uniform(times, fmax(a, 0.0), fmax(b, 0.0), next - level);
        level = next;
    }
    f->n -= k;
    memmove(f->corners, f->corners + k, f->n * sizeof *f->corners);
    f->out = end;
}

void fifo_save(const fifo *f, checkpoint_writer *w)
{
    const uint64_t n = f->n;

    checkpoint_write(w, &f->out, sizeof f->out);
    checkpoint_write(w, &n, sizeof n);
    checkpoint_write(w, f->corners, f->n * sizeof *f->corners);
}

bool fifo_load(fifo *f, checkpoint_reader *r)
{
    uint64_t n;

    if (!checkpoint_read(r, &f->out, sizeof f->out) || !checkpoint_read(r, &n, sizeof n) || n < 1 ||
        n > FIFO_CORNERS)
        return false;
    f->n = (size_t)n;
    return checkpoint_read(r, f->corners, f->n * sizeof *f->corners);
}
