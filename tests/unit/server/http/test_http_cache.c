// Encoded files of the page in memory.

#include "server/http/http_priv.h"

#include "core/base/memory.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdio.h>
#include <string.h>

static http_cache *cache;

static int set_up(void **state)
{
    (void)state;
    cache = http__cache_create();
    return cache == NULL ? -1 : 0;
}

static int tear_down(void **state)
{
    (void)state;
    cache = http__cache_destroy(cache);
    return 0;
}

static void put(const char *path, const char *etag, coding c, size_t n)
{
    bf_buffer bytes = { 0 };

    assert_non_null(buffer_reserve(&bytes, n));
    memset(bytes.bytes, path[1], n);
    bytes.n = n;
    http__cache_put(cache, path, etag, c, &bytes);
    buffer_fini(&bytes);
}

// How many bytes are kept; 0: none.
static size_t kept(const char *path, const char *etag, coding c)
{
    bf_buffer out = { 0 };
    bool is_there = http__cache_find(cache, path, etag, c, &out);
    size_t n = out.n;

    assert_int_equal(is_there, n > 0);
    for (size_t i = 0; i < n; i++)
        assert_int_equal(out.bytes[i], path[1]);
    buffer_fini(&out);
    return n;
}

static void what_was_put_is_found_by_all_three_of_its_names(void **state)
{
    (void)state;
    put("/a", "1", CODING_GZIP, 10);
    put("/a", "1", CODING_ZSTD, 20);
    put("/b", "1", CODING_GZIP, 30);
    assert_int_equal(kept("/a", "1", CODING_GZIP), 10);
    assert_int_equal(kept("/a", "1", CODING_ZSTD), 20);
    assert_int_equal(kept("/b", "1", CODING_GZIP), 30);
    assert_int_equal(kept("/a", "2", CODING_GZIP), 0);
    assert_int_equal(kept("/b", "1", CODING_ZSTD), 0);
    put("/a", "1", CODING_GZIP, 99); // it is there already
    assert_int_equal(kept("/a", "1", CODING_GZIP), 10);
}

static void what_was_not_used_for_longest_goes_first(void **state)
{
    char path[16];

    (void)state;
    put("/a", "1", CODING_GZIP, 1);
    put("/b", "1", CODING_GZIP, 1);
    for (int i = 0; i < 63; i++) { // one more than there is room for
        (void)snprintf(path, sizeof path, "/c%d", i);
        put(path, "1", CODING_GZIP, 1);
        assert_int_equal(kept("/a", "1", CODING_GZIP), 1);
    }
    assert_int_equal(kept("/b", "1", CODING_GZIP), 0);
    assert_int_equal(kept("/c0", "1", CODING_GZIP), 1);
}

static void its_bytes_have_a_bound(void **state)
{
    char path[16];
    size_t n = 0;

    (void)state;
    for (int i = 0; i < 12; i++) {
        (void)snprintf(path, sizeof path, "/c%d", i);
        put(path, "1", CODING_GZIP, 1024 * 1024);
    }
    for (int i = 0; i < 12; i++) {
        (void)snprintf(path, sizeof path, "/c%d", i);
        n += kept(path, "1", CODING_GZIP);
    }
    assert_int_equal(n, 8 * 1024 * 1024);
    put("/large", "1", CODING_GZIP, 3 * 1024 * 1024);
    assert_int_equal(kept("/large", "1", CODING_GZIP), 0);
}

static void without_memory_nothing_is_kept(void **state)
{
    (void)state;
    bf_buffer bytes = { 0 }, out = { 0 };
    assert_int_equal(buffer_append(&bytes, "x", 1), BF_OK);
    memory_plan_fault(1, 1);
    http__cache_put(cache, "/x", "1", CODING_GZIP, &bytes);
    assert_null(http__cache_create());
    memory_plan_fault(0, 0);
    assert_int_equal(kept("/x", "1", CODING_GZIP), 0);
    http__cache_put(cache, "/x", "1", CODING_GZIP, &bytes);
    memory_plan_fault(1, 1);
    assert_false(http__cache_find(cache, "/x", "1", CODING_GZIP, &out));
    memory_plan_fault(0, 0);
    assert_int_equal(out.n, 0);
    assert_int_equal(kept("/x", "1", CODING_GZIP), 1);
    assert_null(http__cache_destroy(NULL));
    buffer_fini(&bytes);
}

int main(void)
{
#define CASE(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
    const struct CMUnitTest tests[] = {
        CASE(what_was_put_is_found_by_all_three_of_its_names),
        CASE(what_was_not_used_for_longest_goes_first),
        CASE(its_bytes_have_a_bound),
        CASE(without_memory_nothing_is_kept),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
