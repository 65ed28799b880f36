#include "core/run/frame.h"

#include "core/base/check.h"
#include "core/base/digest.h"
#include "core/run/frame_priv.h"

#include <stdbool.h>
#include <string.h>

// Payload that is being written; a failure is remembered.
typedef struct writer {
    bf_buffer *out;
    bool has_failed;
} writer;

static void put(writer *w, const void *bytes, size_t n)
{
    w->has_failed = w->has_failed || buffer_append(w->out, bytes, n) != BF_OK;
}

static void put_u32(writer *w, uint32_t value)
{
    put(w, &value, sizeof value);
}

static void put_u64(writer *w, uint64_t value)
{
    put(w, &value, sizeof value);
}

static void put_f64(writer *w, double value)
{
    put(w, &value, sizeof value);
}

static void put_grid(writer *w, const bf_grid *g)
{
    put_u64(w, g->n1);
    put_u64(w, g->n2);
    put_f64(w, g->lower1);
    put_f64(w, g->lower2);
    put_f64(w, g->d1);
    put_f64(w, g->d2);
}

static void put_begin(writer *w, const frame_begin *b)
{
    put_u32(w, b->model);
    put_u32(w, b->n_columns);
    put_u64(w, b->n_steps);
    put_f64(w, b->dt);
    put_f64(w, b->duration);
    put_u64(w, b->n_parts);
    put_u64(w, b->first_step);
    put_u32(w, b->n_values);
    put_u32(w, 0);
    put_grid(w, &b->grid);
}

static void put_curve(writer *w, const frame_curve *c)
{
    put_u64(w, c->first);
    put_u32(w, c->n);
    put_u32(w, c->n_columns);
    put(w, c->t, c->n * sizeof *c->t);
    put(w, c->values, (size_t)c->n * c->n_columns * sizeof *c->values);
}

static void put_snapshot(writer *w, const frame_snapshot *s)
{
    put_u64(w, s->index);
    put_f64(w, s->t);
    put_f64(w, s->peak);
    put_f64(w, s->mass);
    put_u32(w, s->n1);
    put_u32(w, s->n2);
    put(w, s->rho, (size_t)s->n1 * s->n2 * sizeof *s->rho);
}

static void put_parts(writer *w, const frame_parts *p)
{
    put_u64(w, p->index);
    put_f64(w, p->t);
    put_u64(w, p->n_parts);
    put_u32(w, p->n_values);
    put_u32(w, 0);
    put(w, p->rows, (size_t)p->n_parts * p->n_values * sizeof *p->rows);
}

static void put_end(writer *w, const frame_end *e)
{
    put_u32(w, e->stopped);
    put_u32(w, 0);
    put_u64(w, e->n_steps);
    put_f64(w, e->t);
    put_u64(w, e->n_cells);
    put_f64(w, e->parts_start);
    put_f64(w, e->parts_end);
    put_f64(w, e->peak);
    put_u64(w, e->digest);
    put_u64(w, e->n_samples);
    put_u64(w, e->n_snapshots);
    put_u64(w, e->n_parts_left);
    put_u64(w, e->n_contacts);
    put_f64(w, e->kinetic_energy);
    put_f64(w, e->largest_overlap);
    put_f64(w, e->overlap_share);
}

static void put_error(writer *w, const bf_error *e)
{
    put_u32(w, (uint32_t)e->code);
    put(w, e->pointer, sizeof e->pointer);
    put(w, e->text, sizeof e->text);
}

static void put_payload(writer *w, const frame *f)
{
    switch (f->type) {
    case FRAME_JOB:
        put_u32(w, f->job.model);
        put_u32(w, f->job.n_threads);
        put(w, f->job.document, f->job.n_document);
        break;
    case FRAME_RESUME:
    case FRAME_CHECKPOINT:
        put_u64(w, f->bytes.step);
        put(w, f->bytes.bytes, f->bytes.n);
        break;
    case FRAME_BEGIN:
        put_begin(w, &f->begin);
        break;
    case FRAME_CURVE:
        put_curve(w, &f->curve);
        break;
    case FRAME_SNAPSHOT:
        put_snapshot(w, &f->snapshot);
        break;
    case FRAME_PROGRESS:
        put_u64(w, f->progress.step);
        put_u64(w, f->progress.n_steps);
        put_f64(w, f->progress.t);
        break;
    case FRAME_END:
        put_end(w, &f->end);
        break;
    case FRAME_ERROR:
        put_error(w, &f->error.error);
        break;
    case FRAME_PARTS:
        put_parts(w, &f->parts);
        break;
    case FRAME_TYPE_COUNT:
        BF_CHECK(f->type != FRAME_TYPE_COUNT);
    }
}

bf_status frame_encode(const frame *f, bf_buffer *out, bf_error *err)
{
    static const char padding[FRAME__ALIGNMENT] = { 0 };
    writer w = { .out = out };
    const size_t start = out->n;

    put_u32(&w, FRAME__MAGIC);
    put_u32(&w, (uint32_t)f->type);
    put_u64(&w, 0);
    put_payload(&w, f);
    if (!w.has_failed) {
        uint64_t n_payload = out->n - start - FRAME__HEADER_BYTES;
        memcpy(out->bytes + start + FRAME__LENGTH_AT, &n_payload, sizeof n_payload);
        put(&w, padding, (size_t)(-n_payload % FRAME__ALIGNMENT));
    }
    if (!w.has_failed)
        put_u64(&w, digest_add(DIGEST_START, out->bytes + start, out->n - start));
    if (!w.has_failed)
        return BF_OK;
    out->n = start;
    return bf_fail(err, BF_ENOMEM, "", "no memory for a frame");
}
