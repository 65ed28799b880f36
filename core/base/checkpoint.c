#include "core/base/checkpoint.h"

#include "core/base/check.h"
#include "core/base/digest.h"

#include <string.h>

#if __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "frames and checkpoints are little-endian; this processor needs swaps"
#endif

enum { MAGIC = 0x50434642 }; // "BFCP"

typedef struct envelope {
    uint32_t magic;
    uint32_t version;
    uint32_t kind;
    uint32_t zero;
    uint64_t definition;
    uint64_t n_payload;
    uint64_t digest;
} envelope;

static uint64_t digest_of(const envelope *e, const char *payload)
{
    uint64_t digest = digest_add(DIGEST_START, e, offsetof(envelope, digest));

    return digest_add(digest, payload, e->n_payload);
}

void checkpoint_begin(checkpoint_writer *w, bf_buffer *out, checkpoint_kind kind,
                      uint64_t definition)
{
    const envelope e = { MAGIC, CHECKPOINT_VERSION, (uint32_t)kind, 0, definition, 0, 0 };

    *w = (checkpoint_writer){ .out = out, .start = out->n };
    checkpoint_write(w, &e, sizeof e);
}

void checkpoint_write(checkpoint_writer *w, const void *bytes, size_t n)
{
    w->has_failed = w->has_failed || buffer_append(w->out, bytes, n) != BF_OK;
}

size_t checkpoint_at(const checkpoint_writer *w)
{
    return w->has_failed ? 0 : w->out->n - w->start - sizeof(envelope);
}

void checkpoint_rewrite(checkpoint_writer *w, size_t at, const void *bytes, size_t n)
{
    if (w->has_failed)
        return;
    BF_CHECK(at + n <= checkpoint_at(w));
    memcpy(w->out->bytes + w->start + sizeof(envelope) + at, bytes, n);
}

bf_status checkpoint_end(checkpoint_writer *w, bf_error *err)
{
    if (w->has_failed) {
        buffer_truncate(w->out, w->start);
        return bf_fail(err, BF_ENOMEM, "", "no memory for a checkpoint");
    }
    char *start = w->out->bytes + w->start;
    envelope e;
    memcpy(&e, start, sizeof e);
    e.n_payload = w->out->n - w->start - sizeof e;
    e.digest = digest_of(&e, start + sizeof e);
    memcpy(start, &e, sizeof e);
    return BF_OK;
}

bf_status checkpoint_open(checkpoint_reader *r, const void *bytes, size_t n, checkpoint_kind kind,
                          uint64_t definition, bf_error *err)
{
    const char *payload = (const char *)bytes + sizeof(envelope);
    envelope e;

    if (n < sizeof e)
        return bf_fail(err, BF_ECORRUPT, "", "a checkpoint of %zu bytes is too short", n);
    memcpy(&e, bytes, sizeof e);
    if (e.magic != MAGIC || e.version != CHECKPOINT_VERSION)
        return bf_fail(err, BF_ECORRUPT, "", "the checkpoint is of another version");
    if (e.n_payload != n - sizeof e || e.digest != digest_of(&e, payload))
        return bf_fail(err, BF_ECORRUPT, "", "the checkpoint is damaged");
    if (e.kind != (uint32_t)kind || e.definition != definition)
        return bf_fail(err, BF_ECORRUPT, "", "the checkpoint belongs to another scenario");
    *r = (checkpoint_reader){ payload, n - sizeof e };
    return BF_OK;
}

bool checkpoint_read(checkpoint_reader *r, void *ret_bytes, size_t n)
{
    const char *from = checkpoint_read_items(r, 1, n);

    if (from != NULL && n > 0)
        memcpy(ret_bytes, from, n);
    return from != NULL;
}

const char *checkpoint_read_items(checkpoint_reader *r, uint64_t n_items, size_t size)
{
    const char *from = r->at;

    if (size > 0 && n_items > r->n_left / size)
        return NULL;
    r->at += n_items * size;
    r->n_left -= n_items * size;
    return from;
}
