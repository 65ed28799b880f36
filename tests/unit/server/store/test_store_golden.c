// Stores that daemons of versions 8 and 9 wrote before they were killed: this version gives the same bytes. What is
// expected was read from the files with SQLite's own program, zstd and Python's hashlib, not with this program.

#include "tests/unit/server/helper_golden.h"

#include "server/store/backup.h"
#include "tests/unit/helper_cmocka.h"

#include <sodium.h>
#include <stdio.h>
#include <string.h>

enum { DIGEST_BYTES = 32, TEXT_SIZE = 2 * DIGEST_BYTES + 1 };

// A run as its store has it. The digest is BLAKE2b-256 of scenario, summary and key figures, of times and values of the
// curve, of density and parts of each snapshot, and of the data of the events, in those of samples the lists of columns under
// their member `columns`; "": the run has none of them.
typedef struct golden_run {
    const char *id;
    run_state state; // after the store was opened
    uint64_t
        last_event; // before; 0: events are left out, as those of shared results are made when they are read
    const char *digest;
} golden_run;

// A store.
typedef struct golden_store {
    int version;
    const char *owner;
    golden_run runs[6];
    const char *curve; // id of a measurement
    const char *csv;   // id of another
} golden_store;

static const golden_store stores[] = {
    { .version = 8,
      .owner = "",
      .runs = { { "01a2053b-c1d3-7246-b170-14fd7345ff4a", RUN_SUCCEEDED, 10,
                  "e36c2d87193ef442d9b826d96858492fbb787ab294247e6daf5914c11ffc8183" },
                { "01a2053b-c2ba-7313-9975-42b365701ed0", RUN_SUCCEEDED, 0,
                  "87f15b4758ff4e45965d657ae43f9a1fcc232e3eaf5dfb04d2f54cdc0351dddb" },
                { "01a2053b-c2d5-775b-a22c-256ae3481cb5", RUN_SUCCEEDED, 31,
                  "a2136640fb3381774c4bbff293d2f47e7ca67965f2e1d12cb6db74e3d6d8d729" },
                { "01a2053b-c3af-7638-8058-0249c848beed", RUN_QUEUED, 139,
                  "5cc573801eae88d86fd1d99971d18ec17e56f132f0480dc74870e889b24992f6" },
                { "01a2053b-c3b3-70dc-bed7-a63d57fac30d", RUN_CANCELLED, 0, "" },
                { "01a2053b-c3e4-74c9-a774-19345b8d0492", RUN_QUEUED, 0, "" } },
      .curve = "01a2053b-c393-779f-9b66-4673475d3325",
      .csv = "01a2053b-c3a3-74ca-b379-d18d8852ccd7" },
    { .version = 9,
      .owner = "hall-3",
      .runs = { { "01a2053b-d1eb-74f4-b193-e14cf7dea40a", RUN_SUCCEEDED, 11,
                  "2ba153a921841402e84810d31f8667be562f79846a780ff3525e5cf0b5324f8f" },
                { "01a2053b-d283-729d-9fac-31eb8a23d34c", RUN_SUCCEEDED, 0,
                  "1d028eca70c17e7282f956c1dee7569a7acfd6e37ec0590d92b8ac2520168b41" },
                { "01a2053b-d286-745c-a9ef-c8c4bf1eaac8", RUN_SUCCEEDED, 30,
                  "f5e08588893ec8e630b0a15f1803602c8420d27f71fb00e7701ea4380a3b72c5" },
                { "01a2053b-d2f4-74e8-910d-22f06b4485c0", RUN_QUEUED, 132,
                  "ca60a9d0c177ed904006bf23acfc4a51927294b1e24102c6c9fcded15c636e38" },
                { "01a2053b-d2f7-76eb-8909-5d91c07190c4", RUN_CANCELLED, 0, "" },
                { "01a2053b-d2fa-763a-9ddc-402be4b4dbda", RUN_QUEUED, 0, "" } },
      .curve = "01a2053b-d2f1-716a-8066-21b3183221d5",
      .csv = "01a2053b-d2f2-739f-a620-3baf6e993191" },
};

static const char measured_digest[] =
    "6cb63233e983914ae71ac2f001b4c575be9083ea63e969080d2068f42c16be65"; // of times and counts

typedef struct digest {
    crypto_generichash_state state;
    uint64_t last_event; // later ones are of this program
} digest;

static void begin_digest(digest *d)
{
    assert_int_equal(crypto_generichash_init(&d->state, NULL, 0, DIGEST_BYTES), 0);
}

static void take(digest *d, const void *bytes, size_t n)
{
    assert_int_equal(crypto_generichash_update(&d->state, bytes, n), 0);
}

static void assert_digest(digest *d, const char *expected)
{
    unsigned char bytes[DIGEST_BYTES];
    char text[TEXT_SIZE];

    assert_int_equal(crypto_generichash_final(&d->state, bytes, sizeof bytes), 0);
    assert_string_equal(sodium_bin2hex(text, sizeof text, bytes, sizeof bytes), expected);
}

static void take_buffer(digest *d, bf_buffer *buffer)
{
    take(d, buffer->bytes, buffer->n);
    buffer_fini(buffer);
}

static void take_texts(digest *d, store *s, const char *id)
{
    static const api_text texts[] = { API_TEXT_SCENARIO, API_TEXT_SUMMARY, API_TEXT_FIGURES };

    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        bf_buffer text = { 0 };
        const bf_status status = store_read_text(s, id, texts[i], &text, NULL);
        assert_true(status == BF_OK || (status == BF_ECONFLICT && texts[i] == API_TEXT_SUMMARY));
        take_buffer(d, &text);
    }
}

static void take_results(digest *d, store *s, const char *id, const api_run *record)
{
    api_curve curve = { 0 };

    assert_int_equal(store_read_curve(s, id, 0, UINT64_MAX, &curve, NULL), BF_OK);
    take(d, curve.t.bytes, curve.t.n);
    take(d, curve.values.bytes, curve.values.n);
    api_curve_fini(&curve);
    for (uint64_t k = 0; k < record->n_snapshots; k++) {
        bf_buffer bytes = { 0 };
        api_array got;
        assert_int_equal(store_read_array(s, id, k, API_ARRAY_DENSITY, &got, &bytes, NULL), BF_OK);
        take_buffer(d, &bytes);
        if (record->model != RUN_MICRO)
            continue;
        assert_int_equal(store_read_array(s, id, k, API_ARRAY_PARTS, &got, &bytes, NULL), BF_OK);
        take_buffer(d, &bytes);
    }
}

static bf_status on_event(void *context, const api_event *event, bf_error *err)
{
    digest *d = context;

    if (event->id <= d->last_event)
        take(d, event->data, event->n);
    return BF_OK;
}

static void assert_run(store *s, const golden_run *g, const char *owner)
{
    digest d = { .last_event = g->last_event };
    const api_run record = helper_find(s, g->id);
    char ids[1][API_ID_SIZE];

    assert_int_equal(record.state, g->state);
    assert_string_equal(record.owner, owner);
    if (*g->digest == '\0')
        return;
    memcpy(ids[0], g->id, API_ID_SIZE);
    begin_digest(&d);
    take_texts(&d, s, g->id);
    take_results(&d, s, g->id, &record);
    assert_int_equal(
        store_read_events(s, (const char(*)[API_ID_SIZE])ids, 1, 0, SIZE_MAX, on_event, &d, NULL),
        BF_OK);
    assert_digest(&d, g->digest);
}

static void assert_measurements(store *s, const golden_store *g)
{
    digest d;
    api_measurement about;
    api_curve curve = { 0 };
    bf_buffer csv = { 0 };

    assert_int_equal(store_find_measurement(s, g->curve, &about, NULL), BF_OK);
    assert_string_equal(about.label, "camera");
    assert_string_equal(about.owner, g->owner);
    assert_int_equal(store_read_measurement(s, g->curve, &curve, NULL), BF_OK);
    begin_digest(&d);
    take(&d, curve.t.bytes, curve.t.n);
    take(&d, curve.values.bytes, curve.values.n);
    assert_digest(&d, measured_digest);
    api_curve_fini(&curve);
    assert_int_equal(store_read_measurement_csv(s, g->csv, &csv, NULL), BF_OK);
    assert_string_equal(csv.bytes, "t_s,rate_per_s\n0,1\n60,2\n");
    buffer_fini(&csv);
}

// I1, I3, I8, I15 over changes of the program.
static void an_earlier_store_gives_the_same_bytes(void **state)
{
    helper_store *h = *state;

    for (size_t i = 0; i < sizeof stores / sizeof *stores; i++) {
        const golden_store *g = &stores[i];
        helper_golden_put(h, g->version);
        helper_store_open(h);
        for (size_t k = 0; k < sizeof g->runs / sizeof *g->runs; k++)
            assert_run(h->store, &g->runs[k], g->owner);
        assert_measurements(h->store, g);
        helper_store_verify(h);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(an_earlier_store_gives_the_same_bytes, helper_store_setup,
                                        helper_store_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
