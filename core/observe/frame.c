#include "core/observe/frame.h"

#include "core/base/check.h"
#include "core/base/digest.h"

#include <stdbool.h>
#include <string.h>

#if __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "frames and checkpoints are little-endian; this processor needs swaps"
#endif

enum {
    MAGIC = 0x31464642, // "BFF1"
    TYPE_AT = 4,        // of the type in the header
    LENGTH_AT = 8,      // of the length
    DIGEST_BYTES = 8,   // at the end
    ALIGNMENT = 8,      // of the start and the end of every frame
};

typedef enum field_kind {
    FIELD_END,   // of the list
    FIELD_COPY,  // the member's bytes
    FIELD_ZEROS, // padding without a member
    FIELD_ARRAY, // what the member points to: n times m items
    FIELD_REST,  // what the member points to, up to the payload's end: n bytes; n is not written
} field_kind;

// Where a member stands in struct frame.
typedef struct member {
    size_t offset;
    size_t size; // bytes; 0: no member
} member;

// A field of a payload.
typedef struct field {
    field_kind kind;
    member at;
    size_t item_size; // of an array
    member n;         // unsigned member that comes before it
    member m;         // same; may be missing, which means 1
} field;

#define SIZE(name)        sizeof(((frame *)NULL)->name)
#define AT(name)          .at.offset = offsetof(frame, name), .at.size = SIZE(name)
#define N(name)           .n.offset = offsetof(frame, name), .n.size = SIZE(name)
#define M(name)           .m.offset = offsetof(frame, name), .m.size = SIZE(name)
#define COPY(name)        .kind = FIELD_COPY, AT(name)
#define ZEROS(n)          .kind = FIELD_ZEROS, .at.size = n
#define ARRAY(name, n)    .kind = FIELD_ARRAY, AT(name), .item_size = SIZE(name[0]), N(n)
#define TABLE(name, n, m) ARRAY(name, n), M(m)
#define REST(name, n)     .kind = FIELD_REST, AT(name), N(n)
#define END               .kind = FIELD_END

_Static_assert(sizeof(bf_grid) == 6 * 8, "a grid is written as it stands in memory");
_Static_assert(sizeof(bf_status) == 4, "so is the code of an error");

// The payload of each type, in order: encoder and decoder both follow it.
static const field job_fields[] = { { COPY(job.model) },
                                    { COPY(job.n_threads) },
                                    { COPY(job.is_without_snapshots) },
                                    { ZEROS(4) },
                                    { REST(job.document, job.n_document) },
                                    { END } };
static const field bytes_fields[] = { { COPY(bytes.step) },
                                      { REST(bytes.bytes, bytes.n) },
                                      { END } };
static const field begin_fields[] = {
    { COPY(begin.model) },      { COPY(begin.n_columns) },  { COPY(begin.n_steps) },
    { COPY(begin.dt) },         { COPY(begin.duration) },   { COPY(begin.n_parts) },
    { COPY(begin.first_step) }, { COPY(begin.n_values) },   { ZEROS(4) },
    { COPY(begin.grid) },       { COPY(begin.definition) }, { END }
};
static const field curve_fields[] = { { COPY(curve.first) },
                                      { COPY(curve.n) },
                                      { COPY(curve.n_columns) },
                                      { ARRAY(curve.t, curve.n) },
                                      { TABLE(curve.values, curve.n, curve.n_columns) },
                                      { END } };
static const field snapshot_fields[] = { { COPY(snapshot.index) },
                                         { COPY(snapshot.t) },
                                         { COPY(snapshot.peak) },
                                         { COPY(snapshot.mass) },
                                         { COPY(snapshot.n1) },
                                         { COPY(snapshot.n2) },
                                         { END } };
static const field progress_fields[] = {
    { COPY(progress.step) }, { COPY(progress.n_steps) }, { COPY(progress.t) }, { END }
};
static const field end_fields[] = { { COPY(end.stopped) },        { COPY(end.reason) },
                                    { COPY(end.n_steps) },        { COPY(end.t) },
                                    { COPY(end.n_cells) },        { COPY(end.parts_start) },
                                    { COPY(end.parts_end) },      { COPY(end.parts_entered) },
                                    { COPY(end.parts_fallen) },   { COPY(end.peak) },
                                    { COPY(end.digest) },         { COPY(end.n_samples) },
                                    { COPY(end.n_snapshots) },    { COPY(end.n_parts_left) },
                                    { COPY(end.part_steps) },     { COPY(end.n_contacts) },
                                    { COPY(end.kinetic_energy) }, { COPY(end.largest_overlap) },
                                    { COPY(end.overlap_share) },  { COPY(end.reduction_start) },
                                    { COPY(end.reduction) },      { END } };
static const field error_fields[] = {
    { COPY(error.code) }, { COPY(error.pointer) }, { COPY(error.text) }, { END }
};
static const field parts_fields[] = {
    { COPY(parts.index) },    { COPY(parts.t) }, { COPY(parts.n_parts) },
    { COPY(parts.n_values) }, { ZEROS(4) },      { END }
};
static const field slice_fields[] = { { COPY(slice.of) },
                                      { ZEROS(4) },
                                      { COPY(slice.index) },
                                      { COPY(slice.at) },
                                      { REST(slice.bytes, slice.n) },
                                      { END } };
static const field change_fields[] = {
    { COPY(change.index) }, { COPY(change.t) },     { COPY(change.type) },
    { COPY(change.item) },  { COPY(change.state) }, { COPY(change.id) },
    { COPY(change.turn) },  { COPY(change.shift) }, { END }
};

static const field figures_fields[] = {
    { COPY(figures.t) }, { COPY(figures.n) }, { ARRAY(figures.values, figures.n) }, { END }
};

static const field *const fields_of[FRAME_TYPE_COUNT] = {
    [FRAME_JOB] = job_fields,           [FRAME_RESUME] = bytes_fields,
    [FRAME_BEGIN] = begin_fields,       [FRAME_CURVE] = curve_fields,
    [FRAME_SNAPSHOT] = snapshot_fields, [FRAME_PROGRESS] = progress_fields,
    [FRAME_CHECKPOINT] = bytes_fields,  [FRAME_END] = end_fields,
    [FRAME_ERROR] = error_fields,       [FRAME_PARTS] = parts_fields,
    [FRAME_CHANGE] = change_fields,     [FRAME_FIGURES] = figures_fields,
    [FRAME_SLICE] = slice_fields,
};

uint64_t frame_array_bytes(const frame *f)
{
    const bool is_density = f->type == FRAME_SNAPSHOT;
    const uint64_t size = is_density ? sizeof *f->snapshot.rho : sizeof *f->parts.rows;
    uint64_t n = 0;

    if (!is_density && f->type != FRAME_PARTS)
        return 0;
    if (is_density)
        n = (uint64_t)f->snapshot.n1 * f->snapshot.n2;
    else if (__builtin_mul_overflow(f->parts.n_parts, f->parts.n_values, &n))
        return UINT64_MAX;
    return n > FRAME_PAYLOAD_MAX / size ? UINT64_MAX : n * size;
}

bool frame_slice_at(const frame *f, uint64_t at, frame *ret_slice)
{
    const uint64_t n = frame_array_bytes(f), left = n - at;
    const bool is_density = f->type == FRAME_SNAPSHOT;

    BF_CHECK(n < UINT64_MAX);
    if (at >= n)
        return false;
    const char *array = is_density ? (const char *)f->snapshot.rho : (const char *)f->parts.rows;
    *ret_slice = (frame){ .type = FRAME_SLICE,
                          .slice = { .of = f->type,
                                     .index = is_density ? f->snapshot.index : f->parts.index,
                                     .at = at,
                                     .n = left < FRAME_SLICE_BYTES ? left : FRAME_SLICE_BYTES,
                                     .bytes = array + at } };
    return true;
}

static uint64_t count_of(const frame *f, const member *m)
{
    uint64_t count = m->size == 0 ? 1 : 0;

    memcpy(&count, (const char *)f + m->offset, m->size);
    return count;
}

static uint64_t size_of_field(const frame *f, const field *k)
{
    if (k->kind != FIELD_ARRAY && k->kind != FIELD_REST)
        return k->at.size;
    return count_of(f, &k->n) * count_of(f, &k->m) * (k->kind == FIELD_REST ? 1 : k->item_size);
}

static bf_status put_field(const frame *f, const field *k, bf_buffer *out)
{
    static const char zeros[ALIGNMENT] = { 0 };
    const char *at = k->kind == FIELD_ZEROS ? zeros : (const char *)f + k->at.offset;

    if (k->kind == FIELD_ARRAY || k->kind == FIELD_REST)
        memcpy(&at, at, sizeof at);
    return buffer_append(out, at, size_of_field(f, k));
}

bf_status frame_encode(const frame *f, bf_buffer *out, bf_error *err)
{
    static const char padding[ALIGNMENT] = { 0 };
    const uint32_t head[] = { MAGIC, (uint32_t)f->type, 0, 0 };
    const size_t start = out->n;

    BF_CHECK(f->type >= FRAME_JOB && f->type < FRAME_TYPE_COUNT);
    // Room for the whole frame, so that a large one is not moved while it is written.
    uint64_t n = FRAME_HEADER_BYTES + ALIGNMENT + DIGEST_BYTES;
    for (const field *k = fields_of[f->type]; k->kind != FIELD_END; k++)
        n += size_of_field(f, k);
    bf_status status = buffer_reserve(out, n) == NULL ? BF_ENOMEM : BF_OK;
    if (status == BF_OK)
        status = buffer_append(out, head, sizeof head);
    for (const field *k = fields_of[f->type]; status == BF_OK && k->kind != FIELD_END; k++)
        status = put_field(f, k, out);
    if (status == BF_OK) {
        const uint64_t n_payload = out->n - start - FRAME_HEADER_BYTES;
        memcpy(out->bytes + start + LENGTH_AT, &n_payload, sizeof n_payload);
        status = buffer_append(out, padding, (size_t)(-n_payload % ALIGNMENT));
    }
    if (status == BF_OK) {
        const uint64_t digest = digest_add(DIGEST_START, out->bytes + start, out->n - start);
        status = buffer_append(out, &digest, sizeof digest);
    }
    if (status == BF_OK)
        return BF_OK;
    buffer_truncate(out, start);
    return bf_fail(err, BF_ENOMEM, "", "no memory for a frame");
}

// Payload that is being read.
typedef struct reader {
    const char *at;
    size_t n_left;
} reader;

// Bytes of the items of an array that is to be read; more than are left if its counts are invalid.
static uint64_t count_bytes(const frame *f, const field *k, size_t n_left)
{
    const uint64_t n = count_of(f, &k->n), m = count_of(f, &k->m);

    // Rows without values would pass the check with any number of rows.
    if (n > 0 && (m == 0 || n > n_left / k->item_size / m))
        return UINT64_MAX;
    return n * m * k->item_size;
}

static bool take_field(reader *r, const field *k, frame *f)
{
    char *at = (char *)f + k->at.offset;
    const uint64_t n = k->kind == FIELD_REST    ? r->n_left
                       : k->kind == FIELD_ARRAY ? count_bytes(f, k, r->n_left)
                                                : k->at.size;

    if (n > r->n_left)
        return false;
    if (k->kind == FIELD_COPY)
        memcpy(at, r->at, n);
    else if (k->kind != FIELD_ZEROS)
        memcpy(at, &r->at, sizeof r->at);
    if (k->kind == FIELD_REST)
        memcpy((char *)f + k->n.offset, &n, sizeof n);
    r->at += n;
    r->n_left -= n;
    return true;
}

// Reads the header; *ret_length is that of the whole frame.
static bf_status read_header(const char *bytes, frame_type *ret_type, uint64_t *ret_n_payload,
                             uint64_t *ret_length, bf_error *err)
{
    uint32_t magic, type;
    uint64_t n;

    memcpy(&magic, bytes, sizeof magic);
    memcpy(&type, bytes + TYPE_AT, sizeof type);
    memcpy(&n, bytes + LENGTH_AT, sizeof n);
    if (magic != MAGIC)
        return bf_fail(err, BF_ECORRUPT, "", "not a frame: it begins with 0x%08x", magic);
    if (type < FRAME_JOB || type >= FRAME_TYPE_COUNT)
        return bf_fail(err, BF_ECORRUPT, "", "a frame of unknown type %u", type);
    if (n > FRAME_PAYLOAD_MAX)
        return bf_fail(err, BF_ECORRUPT, "", "a frame of %llu bytes is longer than %llu",
                       (unsigned long long)n, (unsigned long long)FRAME_PAYLOAD_MAX);
    *ret_type = (frame_type)type;
    *ret_n_payload = n;
    *ret_length = FRAME_HEADER_BYTES + (n + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT + DIGEST_BYTES;
    return BF_OK;
}

uint64_t frame_length(const void *bytes, size_t n, frame_type *ret_type)
{
    uint64_t n_payload, length = 0;

    if (n < FRAME_HEADER_BYTES || read_header(bytes, ret_type, &n_payload, &length, NULL) != BF_OK)
        return 0;
    return length;
}

static bf_status read_payload(const char *bytes, uint64_t n, frame *f, bf_error *err)
{
    reader r = { .at = bytes, .n_left = (size_t)n };
    bool is_whole = true;

    for (const field *k = fields_of[f->type]; is_whole && k->kind != FIELD_END; k++)
        is_whole = take_field(&r, k, f);
    if (!is_whole || r.n_left != 0)
        return bf_fail(err, BF_ECORRUPT, "", "a frame of type %d has a wrong length", (int)f->type);
    if (f->type == FRAME_ERROR) {
        // An error's texts must be terminated, and its code must be known.
        bf_error *e = &f->error;
        if ((unsigned)e->code >= BF_STATUS_COUNT)
            e->code = BF_ECORRUPT;
        e->pointer[sizeof e->pointer - 1] = '\0';
        e->text[sizeof e->text - 1] = '\0';
    }
    if (f->type == FRAME_CHANGE)
        f->change.id[sizeof f->change.id - 1] = '\0';
    return BF_OK;
}

bf_status frame_decode(const void *bytes, size_t n, frame *ret_frame, size_t *ret_used,
                       bf_error *err)
{
    uint64_t n_payload = 0, length = FRAME_HEADER_BYTES, digest;
    frame f = { 0 };
    bf_status status = BF_OK;

    BF_CHECK((uintptr_t)bytes % ALIGNMENT == 0);
    if (n >= FRAME_HEADER_BYTES)
        status = read_header(bytes, &f.type, &n_payload, &length, err);
    if (status != BF_OK)
        return status;
    if (n < length) {
        *ret_used = 0;
        return BF_OK;
    }
    memcpy(&digest, (const char *)bytes + length - DIGEST_BYTES, sizeof digest);
    if (digest != digest_add(DIGEST_START, bytes, (size_t)length - DIGEST_BYTES))
        return bf_fail(err, BF_ECORRUPT, "", "a frame of type %d is damaged", (int)f.type);
    status = read_payload((const char *)bytes + FRAME_HEADER_BYTES, n_payload, &f, err);
    if (status != BF_OK)
        return status;
    *ret_frame = f;
    *ret_used = (size_t)length;
    return BF_OK;
}

bf_status frame_decode_input(const void *bytes, size_t n, frame_type type, frame *ret_frame,
                             size_t *ret_used, bf_error *err)
{
    size_t used = 0;
    frame f;

    BF_TRY(frame_decode(bytes, n, &f, &used, err));
    if (used == 0 || f.type != type)
        return bf_fail(err, BF_ECORRUPT, "", "a job's input ends early or is out of order");
    *ret_frame = f;
    *ret_used = used;
    return BF_OK;
}
