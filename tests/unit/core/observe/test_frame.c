// Unit tests of the frame format.

#include "core/base/digest.h"
#include "core/base/memory.h"
#include "core/observe/frame.h"
#include "tests/unit/helper_cmocka.h"

#include <stdlib.h>
#include <string.h>

static const double times[] = { 0.0, 0.01, 0.02 };
static const double figure_values[] = { 3600.0, 0.25, 1.5 };
static const double values[] = { 192.0, 0.0, 191.5, 0.5, 190.25, 1.75 };
static const float cells[] = { 0.0F, 0.25F, 1.5F, 3e-38F, 1.0F, 0.5F };

// One frame of each kind, all members set.
static size_t make_frames(frame frames[FRAME_TYPE_COUNT])
{
    const bf_grid grid = { 3, 2, -0.5, 0.25, 0.005, 0.006 };
    size_t n = 0;

    frames[n++] = (frame){ .type = FRAME_JOB, .job = { 1, 4, 13, "{\"name\":\"x\"} " } };
    frames[n++] = (frame){ .type = FRAME_RESUME, .bytes = { 77, 5, "state" } };
    frames[n++] =
        (frame){ .type = FRAME_BEGIN, .begin = { 0, 2, 4800, 1.25e-3, 6.0, 192, 77, 6, grid } };
    frames[n++] = (frame){ .type = FRAME_CURVE, .curve = { 10, 3, 2, times, values } };
    frames[n++] =
        (frame){ .type = FRAME_SNAPSHOT, .snapshot = { 4, 0.4, 1.5, 191.0, 3, 2, cells } };
    frames[n++] = (frame){ .type = FRAME_PROGRESS, .progress = { 99, 4800, 0.12375 } };
    frames[n++] = (frame){ .type = FRAME_CHECKPOINT, .bytes = { 78, 0, "" } };
    frames[n++] = (frame){ .type = FRAME_END,
                           .end = { 1, 2, 4800, 6.0, 6, 192.0, 19.75, 8.5, 2.5, 1.43,
                                    0xdeadbeefcafe, 601, 61, 172, 8.2e5, 5, 0.25, 6e-4, 0.05 } };
    frames[n++] = (frame){ .type = FRAME_PARTS, .parts = { 4, 0.4, 2, 3, values } };
    frames[n++] =
        (frame){ .type = FRAME_FIGURES, .figures = { .t = 1.5, .n = 3, .values = figure_values } };
    frames[n++] = (frame){ .type = FRAME_SLICE, .slice = { FRAME_PARTS, 4, 131072, 7, "seven b" } };
    frames[n++] =
        (frame){ .type = FRAME_CHANGE, .change = { 7, 0.5, FRAME_CHANGE_EYE, 3, 1, "pe3" } };
    frames[n] = (frame){ .type = FRAME_ERROR };
    frames[n].error.code = BF_ENUMERIC;
    strcpy(frames[n].error.pointer, "/macro/step_s");
    strcpy(frames[n++].error.text, "density nan");
    return n;
}

static void encode_all(bf_buffer *out)
{
    frame frames[FRAME_TYPE_COUNT];
    size_t n = make_frames(frames);

    for (size_t k = 0; k < n; k++)
        assert_int_equal(frame_encode(&frames[k], out, NULL), BF_OK);
}

// Two frames are the same if they encode to the same bytes.
static void assert_same(const frame *a, const frame *b)
{
    bf_buffer bytes_a = { 0 }, bytes_b = { 0 };

    assert_int_equal(frame_encode(a, &bytes_a, NULL), BF_OK);
    assert_int_equal(frame_encode(b, &bytes_b, NULL), BF_OK);
    assert_int_equal(bytes_a.n, bytes_b.n);
    assert_memory_equal(bytes_a.bytes, bytes_b.bytes, bytes_a.n);
    buffer_fini(&bytes_a);
    buffer_fini(&bytes_b);
}

static void every_frame_comes_back_as_it_was(void **state)
{
    frame frames[FRAME_TYPE_COUNT], f;
    bf_buffer bytes = { 0 };
    size_t n = make_frames(frames), at = 0, used;
    frame_type type = FRAME_TYPE_COUNT;
    assert_int_equal(n, FRAME_TYPE_COUNT - 1);
    encode_all(&bytes);
    for (size_t k = 0; k < n; k++) {
        assert_int_equal(frame_decode(bytes.bytes + at, bytes.n - at, &f, &used, NULL), BF_OK);
        assert_int_equal(used % 8, 0);
        assert_int_equal(frame_length(bytes.bytes + at, 16, &type), used);
        assert_int_equal(type, frames[k].type);
        assert_int_equal(frame_length(bytes.bytes + at, 15, &type), 0);
        assert_int_equal(frame_length(bytes.bytes + at + 8, 16, &type), 0);
        assert_same(&f, &frames[k]);
        at += used;
    }
    assert_int_equal(at, bytes.n);
    buffer_fini(&bytes);
}

// It is read frame by frame, each of a type that is expected, and there is no more to come.
static void a_jobs_input_is_whole_and_in_order(void **state)
{
    frame frames[FRAME_TYPE_COUNT], f = { .type = FRAME_TYPE_COUNT };
    bf_buffer bytes = { 0 };
    size_t used = 1;

    const size_t n = make_frames(frames);
    assert_int_equal(frame_encode(&frames[0], &bytes, NULL), BF_OK);
    for (size_t cut = 0; cut < bytes.n; cut += 8)
        assert_int_equal(frame_decode_input(bytes.bytes, cut, frames[0].type, &f, &used, NULL),
                         BF_ECORRUPT);
    for (size_t k = 1; k < n; k++)
        assert_int_equal(frame_decode_input(bytes.bytes, bytes.n, frames[k].type, &f, &used, NULL),
                         BF_ECORRUPT);
    // What was refused is not told.
    assert_true(f.type == FRAME_TYPE_COUNT && used == 1);
    assert_int_equal(frame_decode_input(bytes.bytes, bytes.n, frames[0].type, &f, &used, NULL),
                     BF_OK);
    assert_int_equal(used, bytes.n);
    assert_same(&f, &frames[0]);
    buffer_fini(&bytes);
}

static void the_bytes_are_the_documented_ones(void **state)
{
    const frame f = { .type = FRAME_PROGRESS, .progress = { 1, 2, 0.0 } };
    static const unsigned char head[] = { 'B', 'F', 'F', '1', 6, 0, 0, 0, 24, 0, 0, 0, 0, 0, 0, 0,
                                          1,   0,   0,   0,   0, 0, 0, 0, 2,  0, 0, 0, 0, 0, 0, 0 };
    bf_buffer bytes = { 0 };
    assert_int_equal(frame_encode(&f, &bytes, NULL), BF_OK);
    assert_int_equal(bytes.n, 16 + 24 + 8);
    assert_memory_equal(bytes.bytes, head, sizeof head);
    buffer_fini(&bytes);
}

// The start of a frame, copied so that it is aligned and reading past its end is noticed.
static bf_status decode_copy(const char *bytes, size_t n, size_t *ret_used)
{
    frame f = { 0 };
    char *copy = aligned_alloc(8, (n + 8) / 8 * 8);

    assert_non_null(copy);
    memcpy(copy, bytes, n);
    bf_status status = frame_decode(copy, n, &f, ret_used, NULL);
    free(copy);
    return status;
}

static void a_torn_end_asks_for_more_at_every_cut(void **state)
{
    frame frames[FRAME_TYPE_COUNT];
    size_t n = make_frames(frames);
    for (size_t k = 0; k < n; k++) {
        bf_buffer bytes = { 0 };
        assert_int_equal(frame_encode(&frames[k], &bytes, NULL), BF_OK);
        for (size_t cut = 0; cut < bytes.n; cut++) {
            size_t used = 1;
            assert_int_equal(decode_copy(bytes.bytes, cut, &used), BF_OK);
            assert_int_equal(used, 0);
        }
        buffer_fini(&bytes);
    }
}

// A flipped bit is found by magic, type or digest; one in the length may also look like a longer
// frame whose end has not come yet.
static void a_flipped_bit_is_never_taken_for_a_frame(void **state)
{
    frame frames[FRAME_TYPE_COUNT];
    size_t n = make_frames(frames);
    for (size_t k = 0; k < n; k++) {
        bf_buffer bytes = { 0 };
        assert_int_equal(frame_encode(&frames[k], &bytes, NULL), BF_OK);
        for (size_t bit = 0; bit < 8 * bytes.n; bit++) {
            size_t used = 1;
            bytes.bytes[bit / 8] ^= (char)(1 << bit % 8);
            bf_status status = decode_copy(bytes.bytes, bytes.n, &used);
            assert_true(status != BF_OK || used == 0);
            if (status == BF_OK)
                assert_true(bit / 8 >= 8 && bit / 8 < 16);
            bytes.bytes[bit / 8] ^= (char)(1 << bit % 8);
        }
        buffer_fini(&bytes);
    }
}

// Arrays whose announced size exceeds the payload must not be believed, even with a right digest. Samples of no values
// would let any number of them pass.
static void a_frame_that_lies_about_its_arrays_is_refused(void **state)
{
    static const struct {
        uint32_t n;
        uint32_t n_columns;
    } lies[] = {
        { UINT32_MAX, 0 }, { 5, 1 }, { 1, UINT32_MAX }, { UINT32_MAX, UINT32_MAX }, { 1, 2 }
    };
    for (size_t k = 0; k < sizeof lies / sizeof *lies; k++) {
        uint64_t payload[4] = { 4, lies[k].n | (uint64_t)lies[k].n_columns << 32, 0, 0 };
        frame f = { .type = FRAME_CHECKPOINT,
                    .bytes = { payload[0], sizeof payload - sizeof *payload, payload + 1 } };
        bf_buffer lying = { 0 };
        frame decoded;
        size_t used;
        assert_int_equal(frame_encode(&f, &lying, NULL), BF_OK);
        // The same bytes with their digest, as a frame of samples.
        lying.bytes[4] = FRAME_CURVE;
        uint64_t digest = digest_add(DIGEST_START, lying.bytes, lying.n - sizeof digest);
        memcpy(lying.bytes + lying.n - sizeof digest, &digest, sizeof digest);
        assert_int_equal(frame_decode(lying.bytes, lying.n, &decoded, &used, NULL), BF_ECORRUPT);
        buffer_fini(&lying);
    }
}

static void assert_slices(const frame *f, const void *array, uint64_t n, uint64_t n_slices)
{
    uint64_t at = 0, n_seen = 0;
    frame s;

    assert_int_equal(frame_array_bytes(f), n);
    for (; frame_slice_at(f, at, &s); at += s.slice.n, n_seen++) {
        assert_int_equal(s.type, FRAME_SLICE);
        assert_int_equal(s.slice.of, f->type);
        assert_int_equal(s.slice.index, 4);
        assert_int_equal(s.slice.at, at);
        assert_ptr_equal(s.slice.bytes, (const char *)array + at);
        assert_true(s.slice.n == FRAME_SLICE_BYTES || at + s.slice.n == n);
    }
    assert_int_equal(at, n);
    assert_int_equal(n_seen, n_slices);
}

// 65,536 cells of 4 bytes are two whole slices; one more begins a third.
static void slices_cover_an_array_once(void **state)
{
    static float many[65537];
    static const double rows[12] = { 0 };
    frame f = { .type = FRAME_SNAPSHOT, .snapshot = { 4, 0.0, 0.0, 0.0, 256, 256, many } };
    const frame parts = { .type = FRAME_PARTS, .parts = { 4, 0.0, 2, 6, rows } };
    const frame none = { .type = FRAME_PARTS, .parts = { 4, 0.0, 0, 6, NULL } };
    const frame vast = { .type = FRAME_PARTS, .parts = { 4, 0.0, UINT64_MAX / 4, 6, NULL } };
    const frame other = { .type = FRAME_CURVE, .curve = { 10, 3, 2, times, values } };

    assert_slices(&f, many, 262144, 2);
    f.snapshot.n1 = 65537;
    f.snapshot.n2 = 1;
    assert_slices(&f, many, 262148, 3);
    assert_slices(&parts, rows, sizeof rows, 1);
    assert_slices(&none, NULL, 0, 0);
    assert_slices(&other, NULL, 0, 0);
    assert_true(frame_array_bytes(&vast) == UINT64_MAX);
}

static void an_endless_frame_is_refused_before_it_comes(void **state)
{
    static const unsigned char head[16]
        __attribute__((aligned(8))) = { 'B', 'F', 'F', '1', FRAME_SNAPSHOT, 0, 0, 0, 0, 0, 0, 0,
                                        0,   0,   0,   1 };
    frame f;
    size_t used = 1;
    assert_int_equal(frame_decode(head, sizeof head, &f, &used, NULL), BF_ECORRUPT);
}

static void out_of_memory_leaves_the_buffer_as_it_was(void **state)
{
    const frame f = { .type = FRAME_CURVE, .curve = { 10, 3, 2, times, values } };
    bf_buffer out = { 0 };
    bf_status status = BF_ENOMEM;
    for (size_t n = 1; status != BF_OK; n++) {
        memory_plan_fault(n, 0);
        status = frame_encode(&f, &out, NULL);
        if (status != BF_OK) {
            assert_int_equal(status, BF_ENOMEM);
            assert_int_equal(out.n, 0);
            buffer_fini(&out);
        }
    }
    memory_plan_fault(0, 0);
    buffer_fini(&out);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_frame_comes_back_as_it_was),
        cmocka_unit_test(a_jobs_input_is_whole_and_in_order),
        cmocka_unit_test(the_bytes_are_the_documented_ones),
        cmocka_unit_test(a_torn_end_asks_for_more_at_every_cut),
        cmocka_unit_test(a_flipped_bit_is_never_taken_for_a_frame),
        cmocka_unit_test(a_frame_that_lies_about_its_arrays_is_refused),
        cmocka_unit_test(slices_cover_an_array_once),
        cmocka_unit_test(an_endless_frame_is_refused_before_it_comes),
        cmocka_unit_test(out_of_memory_leaves_the_buffer_as_it_was),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
