// Unit tests of the store: the parts of microscopic runs. I1 ... I15 are the invariants of
// server/store/store.h.

#include "core/base/memory.h"
#include "core/observe/frame.h"
#include "tests/unit/server/helper_store.h"

#include <math.h>
#include <string.h>

enum { N_PARTS = 10000, N_BYTES = N_PARTS * FRAME_VALUES_PLANAR * 8 };

static const api_parts all_parts = { .n_parts = N_PARTS, .n_values = FRAME_VALUES_PLANAR };

// Row k of snapshot i: noise of k and i, and of every third part NaN: it has left.
static double value_of(uint64_t index, size_t k)
{
    uint64_t noise = (index * N_PARTS * FRAME_VALUES_PLANAR + k) * UINT64_C(0x9e3779b97f4a7c15);

    return k / FRAME_VALUES_PLANAR % 3 == 2 ? (double)NAN : (double)(noise >> 11) * 0x1p-53;
}

static void add_parts(uint64_t index, store_item *item)
{
    for (size_t k = 0; k < N_PARTS * FRAME_VALUES_PLANAR; k++) {
        double value = value_of(index, k);
        assert_int_equal(buffer_append(&item->parts, &value, sizeof value), BF_OK);
    }
}

static bool are_parts_of(const bf_buffer *rows, uint64_t index)
{
    if (rows->n != N_BYTES)
        return false;
    for (size_t k = 0; k < N_PARTS * FRAME_VALUES_PLANAR; k++) {
        double value = value_of(index, k);
        if (memcmp(rows->bytes + k * sizeof value, &value, sizeof value) != 0)
            return false;
    }
    return true;
}

static bf_status append(store *s, const char *id, uint64_t index, const api_parts *parts,
                        bool has_rows)
{
    bf_grid grid = helper_grid();
    store_item item;
    store_batch batch = { .run_id = id, .n = 1, .items = &item, .grid = &grid, .parts = *parts };

    helper_snapshot_item(id, index, &item);
    if (has_rows)
        add_parts(index, &item);
    bf_status status = helper_store_append(s, &batch, NULL);
    helper_item_fini(&item);
    return status;
}

static bf_status read_back(store *s, const char *id, uint64_t index, bf_buffer *rows)
{
    api_array got = { .snapshot = { .index = 77 }, .parts = { .n_values = 77 } };

    bf_status status = store_read_array(s, id, index, API_ARRAY_PARTS, &got, rows, NULL);
    if (status == BF_OK) {
        assert_int_equal(got.snapshot.index, index);
        assert_int_equal(got.parts.n_parts, N_PARTS);
        assert_int_equal(got.parts.n_values, FRAME_VALUES_PLANAR);
    } else {
        assert_true(got.snapshot.index == 77 && got.parts.n_values == 77 && rows->n == 0);
    }
    return status;
}

static void parts_come_back_bit_by_bit(void **state)
{
    helper_store *h = *state;
    api_run record = helper_start(h->store);
    api_snapshot_list list = { 0 };

    for (uint64_t i = 0; i < 3; i++)
        assert_int_equal(append(h->store, record.id, i, &all_parts, true), BF_OK);
    helper_store_close(h);
    helper_store_open(h);
    for (uint64_t i = 0; i < 3; i++) {
        bf_buffer rows = { 0 };
        assert_int_equal(read_back(h->store, record.id, i, &rows), BF_OK);
        assert_true(are_parts_of(&rows, i));
        buffer_fini(&rows);
    }
    // 480,000 bytes are four slices of 128 KiB at most.
    assert_int_equal(helper_store_sql(h, "SELECT max(part) FROM chunks WHERE kind = 2"), 3);
    assert_int_equal(store_list_snapshots(h->store, record.id, &list, NULL), BF_OK);
    assert_int_equal(list.parts.n_parts, N_PARTS);
    assert_int_equal(list.parts.n_values, FRAME_VALUES_PLANAR);
    buffer_fini(&list.items);
}

// I4: a resumed run sends its last snapshot with its parts again.
static void parts_that_are_stored_already_are_neither_stored_nor_emitted_again(void **state)
{
    helper_store *h = *state;
    api_run record = helper_start(h->store);

    assert_int_equal(append(h->store, record.id, 0, &all_parts, true), BF_OK);
    int64_t n_chunks = helper_store_sql(h, "SELECT count(*) FROM chunks");
    uint64_t last = helper_find(h->store, record.id).last_event;
    assert_int_equal(append(h->store, record.id, 0, &all_parts, true), BF_OK);
    assert_int_equal(helper_store_sql(h, "SELECT count(*) FROM chunks"), n_chunks);
    assert_int_equal(helper_find(h->store, record.id).last_event, last);
}

// I4: nothing of a snapshot is stored that lacks its parts, or has some that were not announced.
static void parts_of_another_size_are_refused(void **state)
{
    store *s = ((helper_store *)*state)->store;
    api_run record = helper_start(s);
    const api_parts none = { 0 }, more = { .n_parts = N_PARTS + 1, .n_values = 6 };
    const api_parts vast = { .n_parts = UINT64_MAX / 2, .n_values = 6 };

    assert_int_equal(append(s, record.id, 0, &all_parts, false), BF_ECORRUPT);
    assert_int_equal(append(s, record.id, 0, &none, true), BF_ECORRUPT);
    assert_int_equal(append(s, record.id, 0, &more, true), BF_ECORRUPT);
    assert_int_equal(append(s, record.id, 0, &vast, true), BF_ECORRUPT);
    assert_int_equal(helper_find(s, record.id).n_snapshots, 0);
    assert_int_equal(append(s, record.id, 0, &all_parts, true), BF_OK);
    assert_int_equal(append(s, record.id, 1, &none, false), BF_ECORRUPT);
    assert_int_equal(helper_find(s, record.id).n_snapshots, 1);
}

static void parts_that_are_not_there_are_not_found(void **state)
{
    store *s = ((helper_store *)*state)->store;
    api_run micro = helper_start(s), macro = helper_start(s);
    bf_buffer rows = { 0 };

    assert_int_equal(append(s, micro.id, 0, &all_parts, true), BF_OK);
    helper_append_snapshot(s, macro.id, 0);
    assert_int_equal(read_back(s, micro.id, 1, &rows), BF_ENOTFOUND);
    assert_int_equal(read_back(s, macro.id, 0, &rows), BF_ENOTFOUND);
    assert_int_equal(read_back(s, "01234567-89ab-7cde-8f01-23456789abcd", 0, &rows), BF_ENOTFOUND);
}

static void damage_in_parts_is_noticed(void **state)
{
    helper_store *h = *state;
    api_run record = helper_start(h->store);
    bf_buffer rows = { 0 };

    assert_int_equal(append(h->store, record.id, 0, &all_parts, true), BF_OK);
    helper_store_close(h);
    helper_store_sql(h, "DELETE FROM chunks WHERE kind = 2 AND part = 1");
    helper_store_open(h);
    assert_int_equal(read_back(h->store, record.id, 0, &rows), BF_ECORRUPT);
    buffer_fini(&rows);
}

static bf_status open_parts(store *s, const char *id)
{
    api_array got;
    api_slices array = { .n = 0 };

    bf_status status = store_open_array(s, id, 0, API_ARRAY_PARTS, &got, &array, NULL);
    api_slices_fini(&array);
    return status;
}

// With feeds the bytes alone tell how many parts there are: 131,072 of them are 2048 rows of 8 values. Nothing of them may
// be taken for fewer parts, and no number of parts for one that fits.
static void damage_in_parts_is_not_taken_for_another_number(void **state)
{
    static const struct {
        uint32_t n_values;
        const char *sql;
    } damages[] = {
        { 8, "DELETE FROM chunks WHERE kind = 2 AND part = 0" },
        { 8, "UPDATE chunks SET data = zeroblob(length(data)) WHERE kind = 2 AND part = 0" },
        { 6, "UPDATE runs SET n_parts = (1 << 61) + n_parts" },
    };
    helper_store *h = *state;
    bf_buffer rows = { 0 };

    for (size_t i = 0; i < sizeof damages / sizeof *damages; i++) {
        const api_parts parts = { .n_parts = damages[i].n_values == 8 ? 0 : N_PARTS,
                                  .n_values = damages[i].n_values };
        const api_run record = helper_start(h->store);
        assert_int_equal(append(h->store, record.id, 0, &parts, true), BF_OK);
        assert_int_equal(open_parts(h->store, record.id), BF_OK);
        helper_store_sql(h, damages[i].sql);
        assert_int_equal(open_parts(h->store, record.id), BF_ECORRUPT);
        assert_int_equal(read_back(h->store, record.id, 0, &rows), BF_ECORRUPT);
        helper_finish(h->store, record.id, RUN_CANCELLED);
        assert_int_equal(store_remove(h->store, record.id, API_ANY_REVISION, NULL), BF_OK);
    }
    buffer_fini(&rows);
}

// I9
static void a_removed_run_leaves_no_parts(void **state)
{
    helper_store *h = *state;
    api_run record = helper_start(h->store);

    assert_int_equal(append(h->store, record.id, 0, &all_parts, true), BF_OK);
    helper_finish(h->store, record.id, RUN_SUCCEEDED);
    assert_int_equal(store_remove(h->store, record.id, API_ANY_REVISION, NULL), BF_OK);
    assert_int_equal(helper_store_sql(h, "SELECT count(*) FROM chunks"), 0);
}

static void without_memory_nothing_is_stored(void **state)
{
    store *s = ((helper_store *)*state)->store;
    api_run record = helper_start(s);
    const api_parts one = { .n_parts = 1, .n_values = FRAME_VALUES_PLANAR };
    const double row[FRAME_VALUES_PLANAR] = { 1, 2, 3, 4, 5, 6 };
    bf_grid grid = helper_grid();
    bf_status status = BF_ENOMEM;

    for (size_t n = 1; status != BF_OK; n++) {
        store_item item;
        store_batch batch = {
            .run_id = record.id, .n = 1, .items = &item, .grid = &grid, .parts = one
        };
        helper_snapshot_item(record.id, 0, &item);
        assert_int_equal(buffer_append(&item.parts, row, sizeof row), BF_OK);
        memory_plan_fault(n, 0);
        status = helper_store_append(s, &batch, NULL);
        memory_plan_fault(0, 0);
        helper_item_fini(&item);
        assert_true(status == BF_OK || status == BF_ENOMEM);
        assert_int_equal(helper_find(s, record.id).n_snapshots, status == BF_OK);
    }
}

#define STORE_TEST(name)                                                                           \
    cmocka_unit_test_setup_teardown(name, helper_store_setup, helper_store_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        STORE_TEST(parts_come_back_bit_by_bit),
        STORE_TEST(parts_that_are_stored_already_are_neither_stored_nor_emitted_again),
        STORE_TEST(parts_of_another_size_are_refused),
        STORE_TEST(parts_that_are_not_there_are_not_found),
        STORE_TEST(damage_in_parts_is_noticed),
        STORE_TEST(damage_in_parts_is_not_taken_for_another_number),
        STORE_TEST(a_removed_run_leaves_no_parts),
        STORE_TEST(without_memory_nothing_is_stored),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
