// Unit tests of the store: snapshots that are read piece by piece. 480,000 bytes of noise are three slices of 131,072
// bytes and one of 86,784.

#include "tests/unit/helper_amount.h"
#include "tests/unit/server/helper_store.h"

#include <stdio.h>
#include <string.h>
#include <zstd.h>

enum {
    N_BYTES = HELPER_N1 * HELPER_N2 * 4,
    SLICE = 131072,
    OLD_ROW = 262144, // of stores before slices
};

static api_slices open_first(store *s, const char *id)
{
    api_array got = { .snapshot = { .index = 77 }, .grid = { .n1 = 77 } };
    api_slices array = { .n = 0 };

    assert_int_equal(store_open_array(s, id, 0, API_ARRAY_DENSITY, &got, &array, NULL), BF_OK);
    assert_int_equal(got.snapshot.index, 0);
    assert_int_equal(got.grid.n1, HELPER_N1);
    assert_int_equal(array.n, N_BYTES);
    return array;
}

static void read_whole(store *s, const char *id, bf_buffer *out)
{
    api_array got;

    assert_int_equal(store_read_array(s, id, 0, API_ARRAY_DENSITY, &got, out, NULL), BF_OK);
    assert_int_equal(out->n, N_BYTES);
}

static void check_piece(store *s, api_slices *array, const bf_buffer *whole, size_t at, size_t n)
{
    const size_t left = whole->n - at;
    bf_buffer piece = { 0 };

    assert_int_equal(store_read_slice(s, array, at, n, &piece, NULL), BF_OK);
    assert_int_equal(piece.n, n < left ? n : left);
    if (piece.n > 0)
        assert_memory_equal(piece.bytes, whole->bytes + at, piece.n);
    buffer_fini(&piece);
}

// Every pair of places on, before and behind the borders, each jumped to from everywhere else. Of less every third pair: each
// place comes first and second in some.
static void check_all_pieces(store *s, const char *id)
{
    static const size_t places[] = { 0,           1,       SLICE - 1,     SLICE,       SLICE + 1,
                                     OLD_ROW - 7, OLD_ROW, 3 * SLICE + 5, N_BYTES - 1, N_BYTES };
    static const size_t lengths[] = { 1, 100, SLICE, SLICE + 1, N_BYTES };
    enum { N_PLACES = sizeof places / sizeof *places };
    api_slices array = open_first(s, id);
    bf_buffer whole = { 0 };

    read_whole(s, id, &whole);
    for (size_t i = 0; i < N_PLACES * N_PLACES; i += HELPER_AMOUNT(1, 3)) {
        for (size_t k = 0; k < sizeof lengths / sizeof *lengths; k += HELPER_AMOUNT(1, 2)) {
            check_piece(s, &array, &whole, places[i / N_PLACES], lengths[k]);
            check_piece(s, &array, &whole, places[i % N_PLACES], lengths[k]);
        }
    }
    api_slices_fini(&array);
    for (size_t n = 1000; n <= 300000; n += 99667) {
        array = open_first(s, id);
        for (size_t at = 0; at < N_BYTES; at += n)
            check_piece(s, &array, &whole, at, n);
        api_slices_fini(&array);
    }
    buffer_fini(&whole);
}

static void every_piece_is_that_of_the_whole(void **state)
{
    helper_store *h = *state;
    api_run record = helper_start(h->store);

    helper_append_snapshot(h->store, record.id, 0);
    check_all_pieces(h->store, record.id);
}

static void put_row(helper_store *h, int part, const char *bytes, size_t n)
{
    bf_buffer sql = { 0 };

    assert_int_equal(
        buffer_printf(&sql,
                      "INSERT OR REPLACE INTO chunks (results, kind, item, part, data) SELECT "
                      "results, 0, 0, %d, x'",
                      part),
        BF_OK);
    for (size_t i = 0; i < n; i++)
        assert_int_equal(buffer_printf(&sql, "%02x", (unsigned char)bytes[i]), BF_OK);
    assert_int_equal(buffer_printf(&sql, "' FROM runs"), BF_OK);
    helper_store_sql(h, sql.bytes);
    buffer_fini(&sql);
}

// Store the first snapshot as the versions before slices did: one frame with a checksum, cut into rows.
static void make_old(helper_store *h, const char *id)
{
    static char packed[N_BYTES + 10000];
    ZSTD_CCtx *context = ZSTD_createCCtx();
    bf_buffer whole = { 0 };

    read_whole(h->store, id, &whole);
    (void)ZSTD_CCtx_setParameter(context, ZSTD_c_checksumFlag, 1);
    size_t n = ZSTD_compress2(context, packed, sizeof packed, whole.bytes, whole.n);
    assert_false(ZSTD_isError(n));
    ZSTD_freeCCtx(context);
    buffer_fini(&whole);
    helper_store_close(h);
    helper_store_sql(h, "DELETE FROM chunks");
    for (size_t at = 0; at < n; at += OLD_ROW)
        put_row(h, (int)(at / OLD_ROW), packed + at, n - at < OLD_ROW ? n - at : OLD_ROW);
    helper_store_open(h);
}

static void what_older_versions_stored_is_read_too(void **state)
{
    helper_store *h = *state;
    api_run record = helper_start(h->store);

    helper_append_snapshot(h->store, record.id, 0);
    (void)helper_finish(h->store, record.id, RUN_SUCCEEDED);
    make_old(h, record.id);
    assert_int_equal(helper_store_sql(h, "SELECT max(part) FROM chunks"), 1);
    check_all_pieces(h->store, record.id);
}

static void a_run_that_is_removed_meanwhile_ends_the_reading(void **state)
{
    store *s = ((helper_store *)*state)->store;
    api_run record = helper_start(s);
    bf_buffer piece = { 0 };

    helper_append_snapshot(s, record.id, 0);
    (void)helper_finish(s, record.id, RUN_SUCCEEDED);
    api_slices array = open_first(s, record.id);
    assert_int_equal(store_read_slice(s, &array, 0, SLICE, &piece, NULL), BF_OK);
    assert_int_equal(store_remove(s, record.id, API_ANY_REVISION, NULL), BF_OK);
    // The next run may be given the number of its results.
    api_run next = helper_start(s);
    helper_append_snapshot(s, next.id, 0);
    assert_int_equal(store_read_slice(s, &array, SLICE, SLICE, &piece, NULL), BF_ENOTFOUND);
    assert_int_equal(piece.n, SLICE);
    api_slices_fini(&array);
    buffer_fini(&piece);
}

// What comes before the damage is there, what is damaged is not, in whatever order they are read.
static void a_damaged_slice_fails_alone(void **state)
{
    static const char *const damages[] = {
        "UPDATE chunks SET data = CAST(substr(data, 1, 999) || x'0000' || substr(data, 1002) AS "
        "BLOB) WHERE part = 2",
        "UPDATE chunks SET data = substr(data, 1, length(data) - 5) WHERE part = 2",
        "UPDATE chunks SET data = CAST(data || x'00' AS BLOB) WHERE part = 2",
        "DELETE FROM chunks WHERE part = 2",
    };
    helper_store *h = *state;
    api_run record = helper_start(h->store);
    bf_buffer whole = { 0 }, piece = { 0 };

    helper_append_snapshot(h->store, record.id, 0);
    (void)helper_finish(h->store, record.id, RUN_SUCCEEDED);
    read_whole(h->store, record.id, &whole);
    for (size_t i = 0; i < sizeof damages / sizeof *damages; i++) {
        helper_store_close(h);
        helper_store_sql(h, damages[i]);
        helper_store_open(h);
        api_slices array = open_first(h->store, record.id);
        for (int turn = 0; turn < 2; turn++) {
            check_piece(h->store, &array, &whole, SLICE, SLICE);
            assert_int_equal(
                store_read_slice(h->store, &array, (uint64_t)2 * SLICE, SLICE, &piece, NULL),
                BF_ECORRUPT);
            assert_int_equal(piece.n, 0);
            check_piece(h->store, &array, &whole, (size_t)3 * SLICE, SLICE);
        }
        api_slices_fini(&array);
    }
    buffer_fini(&whole);
    buffer_fini(&piece);
}

// Whole frames with right checksums, of another size than the slice that they stand for.
static void a_slice_of_another_size_is_damage(void **state)
{
    static const size_t sizes[] = { SLICE - 1, SLICE + 1, 2 * SLICE };
    static char zeros[2 * SLICE], packed[1000];
    helper_store *h = *state;
    api_run record = helper_start(h->store);
    ZSTD_CCtx *context = ZSTD_createCCtx();
    bf_buffer whole = { 0 }, piece = { 0 };

    (void)ZSTD_CCtx_setParameter(context, ZSTD_c_checksumFlag, 1);
    helper_append_snapshot(h->store, record.id, 0);
    read_whole(h->store, record.id, &whole);
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        const size_t n = ZSTD_compress2(context, packed, sizeof packed, zeros, sizes[i]);
        assert_false(ZSTD_isError(n));
        put_row(h, 1, packed, n);
        api_slices array = open_first(h->store, record.id);
        check_piece(h->store, &array, &whole, 0, SLICE);
        assert_int_equal(store_read_slice(h->store, &array, SLICE, SLICE + 1000, &piece, NULL),
                         BF_ECORRUPT);
        check_piece(h->store, &array, &whole, (size_t)2 * SLICE, SLICE);
        api_slices_fini(&array);
    }
    ZSTD_freeCCtx(context);
    buffer_fini(&whole);
    buffer_fini(&piece);
}

static void an_id_that_is_too_long_is_of_no_run(void **state)
{
    store *s = ((helper_store *)*state)->store;
    api_run record = helper_start(s);
    char longer[API_ID_SIZE + 1];
    api_array got;
    api_slices array;

    helper_append_snapshot(s, record.id, 0);
    (void)snprintf(longer, sizeof longer, "%sa", record.id);
    assert_int_equal(store_open_array(s, longer, 0, API_ARRAY_DENSITY, &got, &array, NULL),
                     BF_ENOTFOUND);
}

static void a_snapshot_without_its_last_slice_is_not_opened(void **state)
{
    helper_store *h = *state;
    api_run record = helper_start(h->store);
    api_array got;
    api_slices array = { .n = 77 };

    helper_append_snapshot(h->store, record.id, 0);
    (void)helper_finish(h->store, record.id, RUN_SUCCEEDED);
    assert_int_equal(
        store_open_array(h->store, record.id, 1, API_ARRAY_DENSITY, &got, &array, NULL),
        BF_ENOTFOUND);
    helper_store_close(h);
    helper_store_sql(h, "DELETE FROM chunks WHERE part = 3");
    helper_store_open(h);
    assert_int_equal(
        store_open_array(h->store, record.id, 0, API_ARRAY_DENSITY, &got, &array, NULL),
        BF_ECORRUPT);
    assert_int_equal(array.n, 77);
}

#define STORE_TEST(name)                                                                           \
    cmocka_unit_test_setup_teardown(name, helper_store_setup, helper_store_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        STORE_TEST(every_piece_is_that_of_the_whole),
        STORE_TEST(what_older_versions_stored_is_read_too),
        STORE_TEST(a_run_that_is_removed_meanwhile_ends_the_reading),
        STORE_TEST(a_damaged_slice_fails_alone),
        STORE_TEST(a_slice_of_another_size_is_damage),
        STORE_TEST(an_id_that_is_too_long_is_of_no_run),
        STORE_TEST(a_snapshot_without_its_last_slice_is_not_opened),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
