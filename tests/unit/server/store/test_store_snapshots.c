// Unit tests of the store: snapshots that come in pieces. 480,000 bytes of noise are three slices of 131,072 bytes and one
// of 86,784. I1 ... I15 are the invariants of server/store/store.h.

#include "tests/unit/server/helper_store.h"

#include <stdio.h>

enum { SLICE = 131072, N_BYTES = HELPER_N1 * HELPER_N2 * 4 };

// Append bytes from .. to - 1 of the density of a snapshot.
static bf_status append_piece(store *s, const char *id, uint64_t index, size_t from, size_t to,
                              bool is_last)
{
    store_item item;

    helper_snapshot_item(id, index, &item);
    item.is_open = !is_last;
    item.rho_at = from;
    buffer_truncate(&item.rho, to);
    buffer_drop(&item.rho, from);
    return helper_append(s, id, &item, NULL);
}

static void assert_piece(store *s, const char *id, uint64_t index, size_t from, size_t to,
                         bool is_last)
{
    assert_int_equal(append_piece(s, id, index, from, to, is_last), BF_OK);
}

static void assert_snapshot(store *s, const char *id, uint64_t index)
{
    api_array got;
    bf_buffer rho = { 0 };

    assert_int_equal(store_read_array(s, id, index, API_ARRAY_DENSITY, &got, &rho, NULL), BF_OK);
    assert_true(helper_snapshot_is(&rho, index));
    buffer_fini(&rho);
}

static void pieces_are_stored_as_the_whole_is(void **state)
{
    helper_store *h = *state;
    const api_run whole = helper_start(h->store), pieces = helper_start(h->store);

    for (uint64_t i = 0; i < 2; i++)
        helper_append_snapshot(h->store, whole.id, i);
    assert_piece(h->store, pieces.id, 0, 0, SLICE, false);
    assert_piece(h->store, pieces.id, 0, SLICE, 3 * SLICE, false);
    assert_piece(h->store, pieces.id, 0, 3 * SLICE, N_BYTES, true);
    // The last piece may have no bytes.
    assert_piece(h->store, pieces.id, 1, 0, N_BYTES, false);
    assert_piece(h->store, pieces.id, 1, N_BYTES, N_BYTES, true);
    assert_int_equal(
        helper_store_sql(h, "SELECT count(*) FROM chunks AS a JOIN chunks AS b USING (kind, item, "
                            "part, data) WHERE a.results = 1 AND b.results = 2"),
        8);
    assert_int_equal(helper_store_sql(h, "SELECT count(*) FROM chunks"), 16);
    assert_snapshot(h->store, pieces.id, 1);
}

// I7: neither readers nor clients that wait for a change hear of a snapshot before it is whole.
static void pieces_are_hidden_until_the_last(void **state)
{
    store *s = ((helper_store *)*state)->store;
    const api_run before = helper_start(s);
    api_array got;
    api_slices array;

    assert_piece(s, before.id, 0, 0, N_BYTES, false);
    const api_run now = helper_find(s, before.id);
    assert_int_equal(now.revision, before.revision);
    assert_int_equal(now.last_event, before.last_event);
    assert_int_equal(now.n_snapshots, 0);
    assert_int_equal(store_open_array(s, before.id, 0, API_ARRAY_DENSITY, &got, &array, NULL),
                     BF_ENOTFOUND);
    assert_piece(s, before.id, 0, N_BYTES, N_BYTES, true);
    helper_events events = helper_read_events(s, before.id, before.last_event);
    assert_int_equal(events.n, 1);
    assert_int_equal(events.type, API_EVENT_SNAPSHOT);
    buffer_fini(&events.data);
}

// I4
static void a_piece_that_does_not_follow_is_refused(void **state)
{
    static const struct {
        size_t from, to;
        bool is_last;
    } wrong[] = {
        { 2 * SLICE, 3 * SLICE, false }, // a gap
        { SLICE / 2, SLICE, false },     // what is there already, and not from a border
        { SLICE, SLICE, true },          // too few bytes
        { SLICE, N_BYTES - 4, true },    // 4 too few
        { N_BYTES, N_BYTES, true },      // slices are missing
        { SLICE + 4, N_BYTES, true },    // not from a border
    };
    store *s = ((helper_store *)*state)->store;
    const api_run record = helper_start(s);

    assert_piece(s, record.id, 0, 0, SLICE, false);
    assert_int_equal(append_piece(s, record.id, 1, 0, SLICE, false), BF_ECORRUPT);
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++)
        assert_int_equal(
            append_piece(s, record.id, 0, wrong[i].from, wrong[i].to, wrong[i].is_last),
            BF_ECORRUPT);
    assert_piece(s, record.id, 0, SLICE, N_BYTES, true);
    assert_snapshot(s, record.id, 0);
    // What is stored is left alone.
    assert_piece(s, record.id, 0, 0, SLICE, false);
    assert_piece(s, record.id, 0, 3 * SLICE, N_BYTES, true);
    assert_snapshot(s, record.id, 0);
}

static void leave_pieces(helper_store *h, const char *id)
{
    helper_append_snapshot(h->store, id, 0);
    assert_piece(h->store, id, 1, 0, 2 * SLICE, false);
    assert_int_equal(helper_store_sql(h, "SELECT count(*) FROM chunks WHERE item = 1"), 2);
}

// I9: however a run ends, goes back to the queue, or loses its daemon.
static void nothing_is_left_of_what_did_not_come_whole(void **state)
{
    static const run_state ends[] = { RUN_QUEUED, RUN_SUCCEEDED, RUN_FAILED, RUN_CANCELLED };
    helper_store *h = *state;

    for (size_t i = 0; i <= sizeof ends / sizeof *ends; i++) {
        const api_run record = helper_start(h->store);
        leave_pieces(h, record.id);
        if (i < sizeof ends / sizeof *ends) {
            helper_finish(h->store, record.id, ends[i]);
        } else {
            helper_store_close(h);
            helper_store_open(h);
        }
        assert_int_equal(helper_store_sql(h, "SELECT count(*) FROM chunks WHERE item = 1"), 0);
        assert_snapshot(h->store, record.id, 0);
        if (helper_find(h->store, record.id).state == RUN_QUEUED)
            assert_int_equal(
                store_cancel(h->store, record.id, API_ANY_REVISION, &(api_run){ 0 }, NULL), BF_OK);
    }
}

static bool goes_on(void *context, const store_running *running)
{
    return true;
}

// A job that outlives the daemon sends the snapshot again.
static void a_snapshot_that_begins_again_replaces_what_came(void **state)
{
    helper_store *h = *state;
    const store_options options = { .directory = h->directory,
                                    .queue_limit = 10,
                                    .still_runs = goes_on };
    const api_run record = helper_start(h->store);

    leave_pieces(h, record.id);
    helper_store_close(h);
    assert_int_equal(store_open(&options, &h->store, NULL), BF_OK);
    assert_int_equal(helper_find(h->store, record.id).state, RUN_RUNNING);
    assert_piece(h->store, record.id, 1, 0, SLICE, false);
    assert_int_equal(helper_store_sql(h, "SELECT count(*) FROM chunks WHERE item = 1"), 1);
    assert_piece(h->store, record.id, 1, SLICE, N_BYTES, true);
    assert_snapshot(h->store, record.id, 1);
}

#define STORE_TEST(name)                                                                           \
    cmocka_unit_test_setup_teardown(name, helper_store_setup, helper_store_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        STORE_TEST(pieces_are_stored_as_the_whole_is),
        STORE_TEST(pieces_are_hidden_until_the_last),
        STORE_TEST(a_piece_that_does_not_follow_is_refused),
        STORE_TEST(nothing_is_left_of_what_did_not_come_whole),
        STORE_TEST(a_snapshot_that_begins_again_replaces_what_came),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
