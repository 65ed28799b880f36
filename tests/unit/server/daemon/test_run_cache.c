// Runs in memory: what is remembered holds until the next commit of the store.

#include "server/daemon/run_cache.h"
#include "tests/unit/server/helper_store.h"

#include <stdio.h>
#include <string.h>

static api_run make_run(const char *id)
{
    api_run record = { .revision = 3 };

    memcpy(record.id, id, strlen(id) + 1);
    return record;
}

static void test_a_run_is_remembered_until_the_next_commit(void **state)
{
    static run_cache f;
    const api_run record = make_run("0190a0b0-0000-7000-8000-000000000001");
    api_run found;

    run_cache_init(&f);
    assert_false(run_cache_look(&f, record.id, 5, &found));
    run_cache_remember(&f, 5, &record);
    assert_true(run_cache_look(&f, record.id, 5, NULL));
    assert_true(run_cache_look(&f, record.id, 5, &found));
    assert_memory_equal(&found, &record, sizeof record);
    assert_false(run_cache_look(&f, record.id, 6, &found));
    assert_false(run_cache_look(&f, "0190a0b0-0000-7000-8000-000000000002", 5, &found));
    assert_true(run_cache_look(&f, record.id, 5, NULL));
    run_cache_fini(&f);
}

static void test_many_runs_take_the_places_of_older_ones(void **state)
{
    static run_cache f;
    size_t n_found = 0;
    char id[API_ID_SIZE];
    api_run found;

    run_cache_init(&f);
    for (unsigned k = 0; k < 10 * RUN_CACHE_MAX; k++) {
        snprintf(id, sizeof id, "0190a0b0-0000-7000-8000-%012u", k);
        const api_run record = make_run(id);
        run_cache_remember(&f, 1, &record);
        assert_true(run_cache_look(&f, id, 1, &found));
        assert_string_equal(found.id, id);
    }
    for (unsigned k = 0; k < 10 * RUN_CACHE_MAX; k++) {
        snprintf(id, sizeof id, "0190a0b0-0000-7000-8000-%012u", k);
        if (run_cache_look(&f, id, 1, &found)) {
            assert_string_equal(found.id, id);
            n_found++;
        }
    }
    assert_true(n_found > RUN_CACHE_MAX / 2 && n_found <= RUN_CACHE_MAX);
    run_cache_fini(&f);
}

// What a listener sees of the count of commits.
typedef struct heard {
    store *store;
    _Atomic uint64_t n_commits;
} heard;

static void hear(void *context, const char *run_id)
{
    heard *h = context;

    h->n_commits = h->store == NULL ? 0 : store_count_commits(h->store);
}

static void test_the_count_of_commits_rises_before_anybody_hears_of_one(void **state)
{
    helper_store *h = *state;
    heard what = { .store = NULL };
    store_options options = {
        .directory = h->directory, .queue_limit = 10, .listener = hear, .listener_context = &what
    };

    h->store = store_close(h->store);
    assert_int_equal(store_open(&options, &h->store, NULL), BF_OK);
    what.store = h->store;
    const uint64_t before = store_count_commits(h->store);
    helper_submit(h->store, "one", 0);
    assert_true(what.n_commits > before);
    assert_true(store_count_commits(h->store) > before);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_run_is_remembered_until_the_next_commit),
        cmocka_unit_test(test_many_runs_take_the_places_of_older_ones),
        cmocka_unit_test_setup_teardown(test_the_count_of_commits_rises_before_anybody_hears_of_one,
                                        helper_store_setup, helper_store_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
