// The data of events: members, order, one line, nothing left behind when memory runs out.

#include "api/results/events.h"

#include "core/base/memory.h"
#include "tests/unit/api/helper_services.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <string.h>

static const char id[] = "0190a0b0-0000-7000-8000-000000000001";

// A run with a value in every member. 1769860800000 ms is 2026-01-31T12:00:00Z: 20484 days of
// 86400 s since 1970 and half a day.
static api_run make_run(void)
{
    helper_daemon d = { .n_runs = 0 };
    api_run record = helper_add_run(&d, RUN_RUNNING)->record;

    record.created_ms = 1769860800000;
    record.started_ms = 1769860800000 + 7;
    record.progress = 0.25;
    record.eta_s = 1.5;
    record.predicted_s = (double)NAN;
    record.priority = -3;
    memcpy(record.label, "night \"1\"", 10);
    memcpy(record.name, "Example 1", 10);
    return record;
}

static void assert_text(bf_buffer *out, const char *expected)
{
    assert_string_equal(out->bytes, expected);
    assert_int_equal(out->n, strlen(expected));
    buffer_fini(out);
}

static void a_status_event_is_the_run_with_its_id_first(void **state)
{
    api_run record = make_run();
    bf_buffer out = { 0 };

    assert_int_equal(events_status(&record, &out, NULL), BF_OK);
    assert_text(
        &out,
        "{\"run\":\"0190a0b0-0000-7000-8000-000000000001\","
        "\"id\":\"0190a0b0-0000-7000-8000-000000000001\","
        "\"status\":\"running\",\"progress\":0.25,\"model\":\"macro\","
        "\"label\":\"night \\\"1\\\"\",\"priority\":-3,\"name\":\"Example 1\","
        "\"created_at\":\"2026-01-31T12:00:00.000Z\","
        "\"started_at\":\"2026-01-31T12:00:00.007Z\",\"finished_at\":null,\"predicted_s\":null,"
        "\"eta_s\":1.5,\"error\":null,\"cached\":false,\"links\":{"
        "\"self\":\"/v1/runs/0190a0b0-0000-7000-8000-000000000001\","
        "\"scenario\":\"/v1/runs/0190a0b0-0000-7000-8000-000000000001/scenario\","
        "\"summary\":\"/v1/runs/0190a0b0-0000-7000-8000-000000000001/summary\","
        "\"curve\":\"/v1/runs/0190a0b0-0000-7000-8000-000000000001/curve\","
        "\"key_figures\":\"/v1/runs/0190a0b0-0000-7000-8000-000000000001/key_figures\","
        "\"snapshots\":\"/v1/runs/0190a0b0-0000-7000-8000-000000000001/snapshots\","
        "\"series\":\"/v1/runs/0190a0b0-0000-7000-8000-000000000001/snapshots.pvd\","
        "\"results\":\"/v1/runs/0190a0b0-0000-7000-8000-000000000001/results.zip\","
        "\"events\":\"/v1/runs/0190a0b0-0000-7000-8000-000000000001/events\","
        "\"cancel\":\"/v1/runs/0190a0b0-0000-7000-8000-000000000001/cancel\"}}");
}

static void what_is_not_known_of_a_run_is_null(void **state)
{
    api_run record = make_run();
    bf_buffer out = { 0 };

    record.eta_s = (double)NAN;
    record.started_ms = 0;
    record.created_ms = INT64_MAX;
    assert_int_equal(events_status(&record, &out, NULL), BF_OK);
    assert_non_null(strstr(out.bytes, "\"eta_s\":null"));
    assert_non_null(strstr(out.bytes, "\"started_at\":null"));
    assert_non_null(strstr(out.bytes, "\"created_at\":\""));
    buffer_fini(&out);
}

static void progress_tells_the_share_of_the_steps_and_the_time_left(void **state)
{
    frame_progress p = { .step = 1200, .n_steps = 4800, .t = 1.5 };
    bf_buffer out = { 0 };

    // 3600 steps are left; at 2400 a second they take 1.5 s.
    assert_int_equal(events_progress(id, &p, 2400.0, &out, NULL), BF_OK);
    assert_text(&out, "{\"run\":\"0190a0b0-0000-7000-8000-000000000001\",\"t_s\":1.5,"
                      "\"progress\":0.25,\"steps_per_s\":2400,\"eta_s\":1.5}");
}

static void a_speed_that_is_not_known_yet_is_null(void **state)
{
    frame_progress p = { .step = 0, .n_steps = 0, .t = 0.0 };
    bf_buffer out = { 0 };

    assert_int_equal(events_progress(id, &p, 0.0, &out, NULL), BF_OK);
    assert_non_null(strstr(out.bytes, "\"progress\":1,\"steps_per_s\":null,\"eta_s\":null}"));
    buffer_fini(&out);
}

static void a_curve_event_has_an_array_for_every_column(void **state)
{
    const double t[] = { 0.1, 0.2 }, values[] = { 192, 0, 191.5, 0.5 };
    frame_curve c = { .first = 10, .n = 2, .n_columns = 2, .t = t, .values = values };
    bf_buffer out = { 0 };

    assert_int_equal(events_curve(id, &c, "upstream,left_domain", &out, NULL), BF_OK);
    assert_text(
        &out, "{\"run\":\"0190a0b0-0000-7000-8000-000000000001\",\"first\":10,"
              "\"t_s\":[0.1,0.2],\"columns\":{\"upstream\":[192,191.5],\"left_domain\":[0,0.5]}}");
}

static void a_snapshot_event_says_where_its_grid_is(void **state)
{
    frame_snapshot s = { .index = 7, .t = 0.7, .peak = 1.25, .mass = 192, .n1 = 200, .n2 = 120 };
    bf_buffer out = { 0 };

    assert_int_equal(events_snapshot(id, &s, false, &out, NULL), BF_OK);
    assert_text(&out, "{\"run\":\"0190a0b0-0000-7000-8000-000000000001\",\"n\":7,\"t_s\":0.7,"
                      "\"peak\":1.25,\"mass\":192,\"shape\":[120,200],"
                      "\"url\":\"/v1/runs/0190a0b0-0000-7000-8000-000000000001/snapshots/7\"}");
}

static void a_snapshot_event_says_where_its_parts_are(void **state)
{
    frame_snapshot s = { .index = 7, .t = 0.7, .peak = 1.25, .mass = 192, .n1 = 2, .n2 = 1 };
    bf_buffer out = { 0 };

    assert_int_equal(events_snapshot(id, &s, true, &out, NULL), BF_OK);
    assert_text(&out, "{\"run\":\"0190a0b0-0000-7000-8000-000000000001\",\"n\":7,\"t_s\":0.7,"
                      "\"peak\":1.25,\"mass\":192,\"shape\":[1,2],"
                      "\"url\":\"/v1/runs/0190a0b0-0000-7000-8000-000000000001/snapshots/7\","
                      "\"parts_url\":\"/v1/runs/0190a0b0-0000-7000-8000-000000000001/parts/7\"}");
}

static void the_end_tells_the_error_of_a_run_that_failed(void **state)
{
    api_run record = make_run();
    bf_buffer out = { 0 };

    record.state = RUN_FAILED;
    record.finished_ms = 1769860800000 + 61999;
    bf_fail(&record.error, BF_ENUMERIC, "", "step 3: not finite");
    assert_int_equal(events_end(&record, &out, NULL), BF_OK);
    assert_text(&out, "{\"run\":\"0190a0b0-0000-7000-8000-000000000001\",\"status\":\"failed\","
                      "\"progress\":0.25,\"finished_at\":\"2026-01-31T12:01:01.999Z\","
                      "\"n_samples\":2,\"n_snapshots\":2,\"error\":{\"code\":\"numeric\","
                      "\"pointer\":\"\",\"detail\":\"step 3: not finite\"}}");
}

static bf_status write_event(unsigned which, bf_buffer *out, bf_error *err)
{
    const double t[] = { 0.1 }, values[] = { 1, 2 };
    frame_curve c = { .n = 1, .n_columns = 2, .t = t, .values = values };
    frame_progress p = { .step = 1, .n_steps = 2 };
    frame_snapshot s = { .n1 = 1, .n2 = 1 };
    api_run record = make_run();

    switch (which) {
    case 0:
        return events_status(&record, out, err);
    case 1:
        return events_progress(id, &p, 1.0, out, err);
    case 2:
        return events_curve(id, &c, "a,left_domain", out, err);
    case 3:
        return events_snapshot(id, &s, true, out, err);
    default:
        return events_end(&record, out, err);
    }
}

static void out_of_memory_leaves_the_buffer_as_it_was(void **state)
{
    for (unsigned which = 0; which < 5; which++) {
        for (size_t n = 1;; n++) {
            bf_buffer out = { 0 };
            bf_error err = { 0 };
            assert_int_equal(buffer_append(&out, "before", 6), BF_OK);
            memory_plan_fault(n, 0);
            bf_status status = write_event(which, &out, &err);
            size_t n_faults = memory_faults();
            memory_plan_fault(0, 0);
            if (n_faults == 0) {
                assert_int_equal(status, BF_OK);
                buffer_fini(&out);
                break;
            }
            assert_int_equal(status, BF_ENOMEM);
            assert_int_equal(err.code, BF_ENOMEM);
            assert_string_equal(out.bytes, "before");
            assert_int_equal(out.n, 6);
            buffer_fini(&out);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_status_event_is_the_run_with_its_id_first),
        cmocka_unit_test(what_is_not_known_of_a_run_is_null),
        cmocka_unit_test(progress_tells_the_share_of_the_steps_and_the_time_left),
        cmocka_unit_test(a_speed_that_is_not_known_yet_is_null),
        cmocka_unit_test(a_curve_event_has_an_array_for_every_column),
        cmocka_unit_test(a_snapshot_event_says_where_its_grid_is),
        cmocka_unit_test(a_snapshot_event_says_where_its_parts_are),
        cmocka_unit_test(the_end_tells_the_error_of_a_run_that_failed),
        cmocka_unit_test(out_of_memory_leaves_the_buffer_as_it_was),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
