#include "core/run/frame.h"

#include "core/base/check.h"
#include "core/base/digest.h"
#include "core/run/frame_priv.h"

#include <stdbool.h>
#include <string.h>

// Payload that is being read; reading past its end is remembered.
typedef struct reader {
    const char *at;
    size_t left;
    bool has_failed;
} reader;

static const void *take(reader *r, size_t n)
{
    const char *at = r->at;

    if (r->has_failed || n > r->left) {
        r->has_failed = true;
        return NULL;
    }
    r->at += n;
    r->left -= n;
    return at;
}

static void take_copy(reader *r, void *to, size_t n)
{
    const void *from = take(r, n);

    if (from != NULL)
        memcpy(to, from, n);
}

static uint32_t take_u32(reader *r)
{
    uint32_t value = 0;

    take_copy(r, &value, sizeof value);
    return value;
}

static uint64_t take_u64(reader *r)
{
    uint64_t value = 0;

    take_copy(r, &value, sizeof value);
    return value;
}

static double take_f64(reader *r)
{
    double value = 0.0;

    take_copy(r, &value, sizeof value);
    return value;
}

// An array of n items of size bytes; its length is checked before it is believed.
static const void *take_array(reader *r, uint64_t n, size_t size)
{
    if (n > r->left / size) {
        r->has_failed = true;
        return NULL;
    }
    return take(r, (size_t)n * size);
}

static void take_grid(reader *r, bf_grid *g)
{
    g->n1 = take_u64(r);
    g->n2 = take_u64(r);
    g->lower1 = take_f64(r);
    g->lower2 = take_f64(r);
    g->d1 = take_f64(r);
    g->d2 = take_f64(r);
}

static void take_begin(reader *r, frame_begin *b)
{
    b->model = take_u32(r);
    b->n_columns = take_u32(r);
    b->n_steps = take_u64(r);
    b->dt = take_f64(r);
    b->duration = take_f64(r);
    b->n_parts = take_u64(r);
    b->first_step = take_u64(r);
    b->n_values = take_u32(r);
    take_u32(r);
    take_grid(r, &b->grid);
}

static void take_curve(reader *r, frame_curve *c)
{
    c->first = take_u64(r);
    c->n = take_u32(r);
    c->n_columns = take_u32(r);
    c->t = take_array(r, c->n, sizeof *c->t);
    c->values = take_array(r, (uint64_t)c->n * c->n_columns, sizeof *c->values);
}

static void take_snapshot(reader *r, frame_snapshot *s)
{
    s->index = take_u64(r);
    s->t = take_f64(r);
    s->peak = take_f64(r);
    s->mass = take_f64(r);
    s->n1 = take_u32(r);
    s->n2 = take_u32(r);
    s->rho = take_array(r, (uint64_t)s->n1 * s->n2, sizeof *s->rho);
}

static void take_parts(reader *r, frame_parts *p)
{
    p->index = take_u64(r);
    p->t = take_f64(r);
    p->n_parts = take_u64(r);
    p->n_values = take_u32(r);
    take_u32(r);
    // A row of no values would let any number of rows pass.
    if (p->n_values == 0 || p->n_parts > r->left)
        r->has_failed = true;
    else
        p->rows = take_array(r, p->n_parts * p->n_values, sizeof *p->rows);
}

static void take_end(reader *r, frame_end *e)
{
    e->stopped = take_u32(r);
    take_u32(r);
    e->n_steps = take_u64(r);
    e->t = take_f64(r);
    e->n_cells = take_u64(r);
    e->parts_start = take_f64(r);
    e->parts_end = take_f64(r);
    e->peak = take_f64(r);
    e->digest = take_u64(r);
    e->n_samples = take_u64(r);
    e->n_snapshots = take_u64(r);
    e->n_parts_left = take_u64(r);
    e->n_contacts = take_u64(r);
    e->kinetic_energy = take_f64(r);
    e->largest_overlap = take_f64(r);
    e->overlap_share = take_f64(r);
}

static void take_error(reader *r, bf_error *e)
{
    uint32_t code = take_u32(r);

    e->code = code < BF_STATUS_COUNT ? (bf_status)code : BF_ECORRUPT;
    take_copy(r, e->pointer, sizeof e->pointer);
    take_copy(r, e->text, sizeof e->text);
    e->pointer[sizeof e->pointer - 1] = '\0';
    e->text[sizeof e->text - 1] = '\0';
}

static void take_payload(reader *r, frame *f)
{
    switch (f->type) {
    case FRAME_JOB:
        f->job.model = take_u32(r);
        f->job.n_threads = take_u32(r);
        f->job.n_document = r->left;
        f->job.document = take(r, r->left);
        break;
    case FRAME_RESUME:
    case FRAME_CHECKPOINT:
        f->bytes.step = take_u64(r);
        f->bytes.n = r->left;
        f->bytes.bytes = take(r, r->left);
        break;
    case FRAME_BEGIN:
        take_begin(r, &f->begin);
        break;
    case FRAME_CURVE:
        take_curve(r, &f->curve);
        break;
    case FRAME_SNAPSHOT:
        take_snapshot(r, &f->snapshot);
        break;
    case FRAME_PROGRESS:
        f->progress.step = take_u64(r);
        f->progress.n_steps = take_u64(r);
        f->progress.t = take_f64(r);
        break;
    case FRAME_END:
        take_end(r, &f->end);
        break;
    case FRAME_ERROR:
        take_error(r, &f->error.error);
        break;
    case FRAME_PARTS:
        take_parts(r, &f->parts);
        break;
    case FRAME_TYPE_COUNT:
        r->has_failed = true;
    }
}

// Reads the header; *ret_length is that of the whole frame.
static bf_status read_header(const char *bytes, frame_type *ret_type, uint64_t *ret_n_payload,
                             uint64_t *ret_length, bf_error *err)
{
    uint32_t magic, type;
    uint64_t n;

    memcpy(&magic, bytes, sizeof magic);
    memcpy(&type, bytes + sizeof magic, sizeof type);
    memcpy(&n, bytes + FRAME__LENGTH_AT, sizeof n);
    if (magic != FRAME__MAGIC)
        return bf_fail(err, BF_ECORRUPT, "", "not a frame: it begins with 0x%08x", magic);
    if (type < FRAME_JOB || type >= FRAME_TYPE_COUNT)
        return bf_fail(err, BF_ECORRUPT, "", "a frame of unknown type %u", type);
    if (n > FRAME_PAYLOAD_MAX)
        return bf_fail(err, BF_ELIMIT, "", "a frame of %llu bytes is longer than %llu",
                       (unsigned long long)n, (unsigned long long)FRAME_PAYLOAD_MAX);
    *ret_type = (frame_type)type;
    *ret_n_payload = n;
    *ret_length = FRAME__HEADER_BYTES +
                  (n + FRAME__ALIGNMENT - 1) / FRAME__ALIGNMENT * FRAME__ALIGNMENT +
                  FRAME__DIGEST_BYTES;
    return BF_OK;
}

bf_status frame_decode(const void *bytes, size_t n, frame *ret_frame, size_t *ret_used,
                       bf_error *err)
{
    uint64_t n_payload = 0, length = 0, digest;
    frame f = { 0 };
    bf_status status;

    BF_CHECK((uintptr_t)bytes % FRAME__ALIGNMENT == 0);
    if (n < FRAME__HEADER_BYTES) {
        *ret_used = 0;
        return BF_OK;
    }
    if ((status = read_header(bytes, &f.type, &n_payload, &length, err)) != BF_OK)
        return status;
    if (n < length) {
        *ret_used = 0;
        return BF_OK;
    }
    memcpy(&digest, (const char *)bytes + length - FRAME__DIGEST_BYTES, sizeof digest);
    if (digest != digest_add(DIGEST_START, bytes, (size_t)length - FRAME__DIGEST_BYTES))
        return bf_fail(err, BF_ECORRUPT, "", "a frame of type %d is damaged", (int)f.type);
    reader r = { .at = (const char *)bytes + FRAME__HEADER_BYTES, .left = (size_t)n_payload };
    take_payload(&r, &f);
    if (r.has_failed || r.left != 0)
        return bf_fail(err, BF_ECORRUPT, "", "a frame of type %d has a wrong length", (int)f.type);
    *ret_frame = f;
    *ret_used = (size_t)length;
    return BF_OK;
}
