// What is encoded, and that the libraries' own decoders give it back.

#include "server/http/representation.h"

#include "core/base/memory.h"
#include "tests/unit/helper_cmocka.h"

#include <string.h>
#include <zlib.h>
#include <zstd.h>

enum { N_TEXT = 100000 };

static char text[N_TEXT], back[N_TEXT + 1];

static int write_text(void **state)
{
    for (size_t i = 0; i < N_TEXT; i++)
        text[i] = "0123456789,.-\n"[(i * i / 7 + i) % 14];
    return 0;
}

static size_t unpack(coding c, const bf_buffer *packed)
{
    if (c == CODING_ZSTD)
        return ZSTD_decompress(back, sizeof back, packed->bytes, packed->n);
    z_stream z = { .next_in = (Bytef *)packed->bytes,
                   .avail_in = (uInt)packed->n,
                   .next_out = (Bytef *)back,
                   .avail_out = sizeof back };
    assert_int_equal(inflateInit2(&z, 15 + 16), Z_OK); // gzip's frame and nothing else
    assert_int_equal(inflate(&z, Z_FINISH), Z_STREAM_END);
    assert_int_equal(inflateEnd(&z), Z_OK);
    return z.total_out;
}

static void what_is_packed_can_be_unpacked(void **state)
{
    static const size_t sizes[] = { 0, 1, 1023, 1024, 65536, N_TEXT };

    for (int c = 0; c < CODING_IDENTITY; c++) {
        for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
            bf_buffer packed = { 0 };
            assert_int_equal(http_encoding_pack((coding)c, text, sizes[i], &packed), BF_OK);
            assert_int_equal(unpack((coding)c, &packed), sizes[i]);
            assert_memory_equal(back, text, sizes[i]);
            if (sizes[i] >= HTTP_ENCODING_MIN)
                assert_true(packed.n < sizes[i]);
            buffer_fini(&packed);
        }
    }
}

static void without_memory_nothing_is_appended(void **state)
{
    for (int c = 0; c < CODING_IDENTITY; c++) {
        bf_buffer packed = { 0 };
        memory_plan_fault(1, 1);
        assert_int_equal(http_encoding_pack((coding)c, text, N_TEXT, &packed), BF_ENOMEM);
        memory_plan_fault(0, 0);
        assert_int_equal(packed.n, 0);
        buffer_fini(&packed);
    }
}

static void text_is_encoded_and_what_is_packed_already_is_not(void **state)
{
    static const char *const texts[] = {
        "text/csv; charset=utf-8",
        "text/html; charset=utf-8",
        "application/json",
        "application/problem+json",
        "image/svg+xml",
        "text/javascript; charset=utf-8",
        "application/x-ndjson",
        "application/xml",
        "application/openapi+json",
    };
    static const char *const others[] = {
        "text/event-stream", "application/octet-stream",
        "application/x-npy", "image/png",
        "application/zip",   "font/woff2",
        "image/x-icon",      "+json",
    };

    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
        assert_true(http_encoding_is_text(texts[i]));
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        assert_false(http_encoding_is_text(others[i]));
}

static void arrays_are_encoded_and_no_other_bytes(void **state)
{
    static const char *const others[] = { "application/x-vti", "image/png", "application/zip",
                                          "application/x-npy2", "application/json" };

    assert_true(http_encoding_is_array("application/octet-stream"));
    assert_true(http_encoding_is_array("application/x-npy"));
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        assert_false(http_encoding_is_array(others[i]));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_packed_can_be_unpacked),
        cmocka_unit_test(without_memory_nothing_is_appended),
        cmocka_unit_test(text_is_encoded_and_what_is_packed_already_is_not),
        cmocka_unit_test(arrays_are_encoded_and_no_other_bytes),
    };
    return cmocka_run_group_tests(tests, write_text, NULL);
}
