// Answers that are made as a whole have a limit, which counts before anything is read, and all others take memory that
// does not grow with what they show.

#include "api/http/exchange.h"
#include "core/observe/frame.h"
#include "tests/unit/api/helper_ask.h"
#include "tests/unit/helper_cmocka.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

static api_services services;
static uint64_t n_reserved;     // bytes, by the present request
static uint64_t n_most_at_once; // samples of a curve that were read at once

static bool reserve(void *context, uint64_t n)
{
    n_reserved += n;
    return true;
}

static const char *header(void *context, const char *name)
{
    return strcasecmp(name, "Accept-Encoding") == 0 ? context : NULL;
}

static void get(const char *path, const char *query, const char *codings, int status)
{
    char accepted[80];

    (void)snprintf(accepted, sizeof accepted, "%s", codings == NULL ? "" : codings);
    const api_request request = { .method = "GET",
                                  .path = path,
                                  .query = query,
                                  .header = header,
                                  .reserve = reserve,
                                  .header_context = codings == NULL ? NULL : accepted };
    n_reserved = n_most_at_once = 0;
    api_response_fini(&ask_response);
    api_handle(&services, &request, &ask_response);
    if (ask_response.status != status)
        fail_msg("%s?%s: %d, %s", path, query, ask_response.status, ask_response.body.bytes);
}

static helper_run *begin(void)
{
    helper_run *of = ask_add_run(RUN_RUNNING);

    services = helper_services(&ask_daemon);
    return of;
}

// A grid of 4,000 x 10,000 cells: 160 MB.
static bf_status open_large(api_store *store, const char *id, uint64_t index, api_array_kind kind,
                            api_array *ret_array, api_slices *ret_slices, bf_error *err)
{
    assert_int_equal(kind, API_ARRAY_DENSITY);
    *ret_array = (api_array){ .grid = ask_daemon.runs[0].grid };
    *ret_slices = (api_slices){ .n = grid_cells(&ret_array->grid) * sizeof(float) };
    return BF_OK;
}

static bf_status read_zeros(api_store *store, api_slices *slices, uint64_t at, size_t limit_bytes,
                            bf_buffer *out, bf_error *err)
{
    assert_true(at + limit_bytes <= slices->n);
    memset(buffer_reserve(out, limit_bytes), 0, limit_bytes);
    out->n += limit_bytes;
    return BF_OK;
}

static void a_picture_takes_memory_for_its_pixels_and_some_rows(void **state)
{
    helper_run *of = begin();
    of->grid = (bf_grid){ .n1 = 4000, .n2 = 10000, .d1 = 0.01, .d2 = 0.01 };
    services.open_array = open_large;
    services.read_slice = read_zeros;
    services.read_array = NULL;
    get(RUN_1 "/snapshots/0", "format=png&width=100", NULL, 200);
    assert_memory_equal(ask_response.body.bytes, "\x89PNG", 4);
    assert_true(n_reserved >= 2 * 100 * 250 && n_reserved < 1000000);
}

static void a_grid_too_large_for_a_whole_answer_is_not_read(void **state)
{
    static const struct {
        const char *query, *codings, *instead;
    } cases[] = {
        { "format=csv", NULL, "use npy or vti" },
        { "format=json", NULL, "use npy or vti" },
        { "format=npy", "gzip, identity;q=0", "use Accept-Encoding: identity" },
        { "format=vti", "gzip, identity;q=0", "use Accept-Encoding: identity" },
    };

    begin()->grid.n1 = 2000001; // two rows
    services.read_array = NULL;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        get(RUN_1 "/snapshots/0", cases[i].query, cases[i].codings, 406);
        assert_true(ask_body_has("4000002 numbers are too many"));
        assert_true(ask_body_has(cases[i].instead));
        assert_int_equal(n_reserved, 0);
    }
}

// With feeds each snapshot has its own number of parts: here 500,001.
static bf_status open_many_parts(api_store *store, const char *id, uint64_t index,
                                 api_array_kind kind, api_array *ret_array, api_slices *ret_slices,
                                 bf_error *err)
{
    assert_int_equal(kind, API_ARRAY_PARTS);
    *ret_array = (api_array){ .snapshot = { .index = index },
                              .parts = { .n_parts = 500001, .n_values = 8 } };
    *ret_slices = (api_slices){ .n = 500001 * 8 * sizeof(double) };
    return BF_OK;
}

static void too_many_parts_of_a_snapshot_are_not_read(void **state)
{
    helper_run *of = begin();
    of->record.model = RUN_MICRO;
    of->parts = (api_parts){ .n_values = 8 };
    assert_true(frame_has_ids(of->parts.n_values));
    services.open_array = open_many_parts;
    services.read_array = NULL;
    get(RUN_1 "/parts/0", "format=csv", NULL, 406);
    assert_true(ask_body_has("4000008 numbers are too many for text"));
    get(RUN_1 "/parts/0", "format=json", NULL, 406);
    assert_int_equal(n_reserved, 0);
}

// 800,001 samples of four columns, with their times 4,000,005 numbers; all of them are 1.
static bf_status read_ones(api_store *store, const char *id, uint64_t first, uint64_t n_most,
                           api_curve *ret_curve, bf_error *err)
{
    const uint64_t n_left = 800001 - first, n = n_left < n_most ? n_left : n_most;
    api_curve curve = { .n = (size_t)n, .n_columns = 4 };

    n_most_at_once = n > n_most_at_once ? n : n_most_at_once;
    assert_int_equal(buffer_printf(&curve.columns, "a,b,c,left_domain"), BF_OK);
    for (uint64_t k = 0; k < n; k++) {
        const double t = (double)(first + k), values[4] = { 1.0, 1.0, 1.0, 1.0 };
        assert_int_equal(buffer_append(&curve.t, &t, sizeof t), BF_OK);
        assert_int_equal(buffer_append(&curve.values, values, sizeof values), BF_OK);
    }
    *ret_curve = curve;
    return BF_OK;
}

static void a_long_curve_is_sent_piece_by_piece_or_not_at_all(void **state)
{
    bf_buffer chunk = { 0 };
    body_state where = BODY_DONE;

    begin()->record.n_samples = 800001;
    services.read_curve = read_ones;
    get(RUN_1 "/curve", "format=csv", "gzip", 200);
    const body_source *source = &ask_response.source;
    assert_non_null(source->next_chunk);
    assert_int_equal(ask_response.body.n, 0);
    assert_true(source->n_held <= 1 << 20);
    assert_int_equal(source->next_chunk(source->state, &services, 65536, &chunk, &where, NULL),
                     BF_OK);
    assert_int_equal(where, BODY_MORE);
    assert_memory_equal(chunk.bytes, "t_s,a,b,c,left_domain\n0,1,1,1,1\n1,1,1,1,1\n", 42);
    assert_true(chunk.n < 300000 && n_most_at_once < 1000);
    buffer_fini(&chunk);
    get(RUN_1 "/curve", "format=json", NULL, 406);
    assert_true(ask_body_has("4000005 numbers are too many for text (limit 4000000); use csv"));
    get(RUN_1 "/curve", "format=csv", "gzip, identity;q=0", 406);
    assert_int_equal(n_most_at_once, 0);
}

static void curves_are_compared_by_one_column_that_is_read_in_pieces(void **state)
{
    begin()->record.n_samples = 800001;
    services.read_curve = read_ones;
    get("/v1/compare", "a=" ID_1 "&b=" ID_1, NULL, 200);
    assert_true(ask_body_has("\"t_end_s\":800000,"));
    assert_in_range(n_most_at_once, 1, 10000);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        ASK_TEST(a_picture_takes_memory_for_its_pixels_and_some_rows),
        ASK_TEST(a_grid_too_large_for_a_whole_answer_is_not_read),
        ASK_TEST(too_many_parts_of_a_snapshot_are_not_read),
        ASK_TEST(a_long_curve_is_sent_piece_by_piece_or_not_at_all),
        ASK_TEST(curves_are_compared_by_one_column_that_is_read_in_pieces),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
