// Unit tests of the metrics: what is counted, and the text form of it. Each case has metrics of its own,
// because they belong to the process.

#include "server/base/metrics.h"

#include "core/base/memory.h"
#include "server/base/base_priv.h"
#include "tests/unit/helper_cmocka.h"

#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

enum { N_THREADS = 4, N_EACH = 100000 };

static bf_buffer write_all(void)
{
    bf_buffer text = { 0 };

    assert_int_equal(metrics_write(&text, NULL), BF_OK);
    return text;
}

static void assert_holds(const bf_buffer *text, const char *lines)
{
    if (strstr(text->bytes, lines) == NULL)
        fail_msg("there is no\n%sin\n%s", lines, text->bytes);
}

static bool ends_with(const char *text, const char *end)
{
    size_t n = strlen(text), n_end = strlen(end);
    return n >= n_end && strcmp(text + n - n_end, end) == 0;
}

static void names_end_with_their_unit_and_counters_with_total(void **state)
{
    for (size_t i = 0; i < METRICS_COUNT; i++) {
        const metrics__metric *m = &metrics__table[i];
        char bare[128], unit[32];
        (void)snprintf(bare, sizeof bare, "%s", m->name);
        assert_int_equal(ends_with(bare, "_total"), m->type == METRICS__COUNTER);
        if (m->type == METRICS__COUNTER)
            bare[strlen(bare) - strlen("_total")] = '\0';
        (void)snprintf(unit, sizeof unit, "_%s", m->unit);
        assert_true(m->unit[0] == '\0' || ends_with(bare, unit));
        assert_true(strncmp(m->name, "beltflow_", 9) == 0 || strncmp(m->name, "process_", 8) == 0);
        assert_true(strlen(m->help) > 0 && strpbrk(m->help, "\\\n") == NULL);
    }
}

static void a_counter_has_help_type_and_its_value(void **state)
{
    metrics_add(METRICS_STREAM_BYTES, 0, 40);
    metrics_add(METRICS_STREAM_BYTES, 0, 2);
    bf_buffer text = write_all();
    assert_holds(&text, "# HELP beltflow_http_stream_bytes_total Bytes of event streams handed to "
                        "connections\n"
                        "# TYPE beltflow_http_stream_bytes_total counter\n"
                        "beltflow_http_stream_bytes_total 42\n");
    buffer_fini(&text);
}

static void a_gauge_goes_down_too_and_can_be_set(void **state)
{
    metrics_add(METRICS_CONNECTIONS, 0, 3);
    metrics_add(METRICS_CONNECTIONS, 0, -1);
    metrics_set(METRICS_STORE_SIZE, 0, 1LL << 40);
    assert_int_equal(metrics_value(METRICS_CONNECTIONS, 0), 2);
    bf_buffer text = write_all();
    assert_holds(&text, "\nbeltflow_http_connections 2\n");
    assert_holds(&text, "\nbeltflow_store_size_bytes 1099511627776\n");
    buffer_fini(&text);
}

static void seconds_are_counted_in_nanoseconds(void **state)
{
    static const struct {
        int64_t ns;
        const char *line;
    } cases[] = {
        { 0, "\nbeltflow_queue_oldest_age_seconds 0\n" },
        { 1, "\nbeltflow_queue_oldest_age_seconds 0.000000001\n" },
        { 1500000000, "\nbeltflow_queue_oldest_age_seconds 1.5\n" },
        { 20000000000, "\nbeltflow_queue_oldest_age_seconds 20\n" },
        { -2500000000, "\nbeltflow_queue_oldest_age_seconds -2.5\n" },
    };

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        metrics_set(METRICS_QUEUE_AGE, 0, cases[i].ns);
        bf_buffer text = write_all();
        assert_holds(&text, cases[i].line);
        buffer_fini(&text);
    }
}

static void few_labels_are_shown_before_they_were_counted(void **state)
{
    metrics_add(METRICS_CHILD_EXITS, METRICS_EXIT_SIGNAL, 7);
    bf_buffer text = write_all();
    assert_holds(&text, "beltflow_child_exits_total{reason=\"ok\"} 0\n"
                        "beltflow_child_exits_total{reason=\"input\"} 0\n"
                        "beltflow_child_exits_total{reason=\"error\"} 0\n"
                        "beltflow_child_exits_total{reason=\"signal\"} 7\n"
                        "beltflow_child_exits_total{reason=\"timeout\"} 0\n"
                        "beltflow_child_exits_total{reason=\"output\"} 0\n");
    assert_holds(&text, "beltflow_frames_stored_total{kind=\"progress\"} 0\n"
                        "beltflow_frames_stored_total{kind=\"curve\"} 0\n"
                        "beltflow_frames_stored_total{kind=\"snapshot\"} 0\n"
                        "beltflow_frames_stored_total{kind=\"figures\"} 0\n"
                        "beltflow_frames_stored_total{kind=\"photo_eye\"} 0\n"
                        "beltflow_frames_stored_total{kind=\"action\"} 0\n"
                        "beltflow_frames_stored_total{kind=\"drive\"} 0\n"
                        "beltflow_frames_stored_total{kind=\"belt\"} 0\n#");
    assert_holds(&text, "beltflow_build_info{version=\"" BELTFLOW_VERSION "\",compiler=\"");
    buffer_fini(&text);
}

// A bucket holds what is at most its bound, and those before it.
static void a_histogram_adds_up(void **state)
{
    static const int64_t sizes[] = { 1, 2, 2, 3, 1024, 5000 };

    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        metrics_observe(METRICS_COMMIT_SIZES, 0, sizes[i]);
    bf_buffer text = write_all();
    assert_holds(&text, "# TYPE beltflow_store_commit_operations histogram\n"
                        "beltflow_store_commit_operations_bucket{le=\"1\"} 1\n"
                        "beltflow_store_commit_operations_bucket{le=\"2\"} 3\n"
                        "beltflow_store_commit_operations_bucket{le=\"4\"} 4\n");
    assert_holds(&text, "beltflow_store_commit_operations_bucket{le=\"512\"} 4\n"
                        "beltflow_store_commit_operations_bucket{le=\"1024\"} 5\n"
                        "beltflow_store_commit_operations_bucket{le=\"+Inf\"} 6\n"
                        "beltflow_store_commit_operations_sum 6032\n"
                        "beltflow_store_commit_operations_count 6\n");
    buffer_fini(&text);
}

static void a_request_is_counted_by_template_method_and_code(void **state)
{
    metrics_count_request("/v1/runs/{id}", "GET", 200, 250000);
    metrics_count_request("/v1/runs/{id}", "GET", 404, 50000000);
    metrics_count_request("/v1/runs/{id}/events", "GET", 200, -1);
    metrics_count_request(METRICS_PAGE, "HEAD", 304, 1);
    bf_buffer text = write_all();
    assert_holds(
        &text, "http_requests_total{route=\"/v1/runs/{id}\",method=\"GET\",code=\"200\"} 1\n"
               "beltflow_http_requests_total{route=\"/v1/runs/{id}\",method=\"GET\",code=\"404\"} "
               "1\n");
    assert_holds(&text, "_requests_total{route=\"page\",method=\"HEAD\",code=\"304\"} 1\n");
    assert_holds(&text,
                 "_seconds_bucket{route=\"/v1/runs/{id}\",method=\"GET\",le=\"0.0001\"} 0\n"
                 "beltflow_http_request_duration_seconds_bucket{route=\"/v1/runs/{id}\",method="
                 "\"GET\",le=\"0.0003\"} 1\n");
    assert_holds(&text, "_seconds_sum{route=\"/v1/runs/{id}\",method=\"GET\"} 0.05025\n");
    assert_holds(&text, "_seconds_count{route=\"/v1/runs/{id}\",method=\"GET\"} 2\n");
    assert_holds(&text, "{route=\"/v1/runs/{id}/events\",method=\"GET\",code=\"200\"} 1\n");
    // A stream is not timed.
    assert_null(strstr(text.bytes, "_count{route=\"/v1/runs/{id}/events\""));
    buffer_fini(&text);
}

static void what_a_client_invents_makes_no_series_of_its_own(void **state)
{
    metrics_count_request("/v1/runs/0123", "BREW", 299, 0);
    metrics_count_request(METRICS_NO_ROUTE, "MIX", 1234, 0);
    metrics_count_request("", "", -7, 0);
    bf_buffer text = write_all();
    assert_holds(&text, "_requests_total{route=\"none\",method=\"other\",code=\"other\"} 3\n");
    assert_null(strstr(text.bytes, "BREW"));
    assert_null(strstr(text.bytes, "0123\""));
    buffer_fini(&text);
}

static void the_process_tells_of_itself(void **state)
{
    metrics_read_process();
    assert_true(metrics_value(METRICS_PROCESS_TIME, 0) > 0);
    assert_true(metrics_value(METRICS_PROCESS_RESIDENT, 0) > 100000);
    assert_true(metrics_value(METRICS_PROCESS_VIRTUAL, 0) >
                metrics_value(METRICS_PROCESS_RESIDENT, 0));
    int64_t n = metrics_value(METRICS_PROCESS_FDS, 0);
    assert_true(n >= 3 && n <= metrics_value(METRICS_PROCESS_FDS_MAX, 0));
    FILE *file = fopen("/dev/null", "re");
    assert_non_null(file);
    metrics_read_process();
    assert_int_equal(metrics_value(METRICS_PROCESS_FDS, 0), n + 1);
    assert_int_equal(fclose(file), 0);
}

static void *count_much(void *context)
{
    for (int i = 0; i < N_EACH; i++) {
        metrics_add(METRICS_SOLVER_STEPS, 1, 1);
        metrics_observe(METRICS_COMMIT_TIMES, 0, 2);
    }
    return NULL;
}

static void nothing_is_lost_when_many_threads_count_and_one_reads(void **state)
{
    pthread_t threads[N_THREADS];

    for (int i = 0; i < N_THREADS; i++)
        assert_int_equal(pthread_create(&threads[i], NULL, count_much, NULL), 0);
    for (int i = 0; i < 5; i++) {
        bf_buffer text = write_all();
        buffer_fini(&text);
    }
    for (int i = 0; i < N_THREADS; i++)
        assert_int_equal(pthread_join(threads[i], NULL), 0);
    bf_buffer text = write_all();
    assert_holds(&text, "beltflow_solver_steps_total{model=\"micro\"} 400000\n");
    assert_holds(&text, "beltflow_store_commit_duration_seconds_sum 0.0008\n"
                        "beltflow_store_commit_duration_seconds_count 400000\n");
    buffer_fini(&text);
}

static void without_memory_nothing_is_appended(void **state)
{
    for (size_t n = 1;; n++) {
        bf_buffer text = { 0 };
        bf_error err = { 0 };
        assert_int_equal(buffer_append(&text, "before", 6), BF_OK);
        memory_plan_fault(n, 0);
        bf_status status = metrics_write(&text, &err);
        bool has_struck = memory_faults() > 0;
        memory_plan_fault(0, 0);
        assert_int_equal(status, has_struck ? BF_ENOMEM : BF_OK);
        if (has_struck)
            assert_string_equal(text.bytes, "before");
        buffer_fini(&text);
        if (!has_struck)
            break;
        assert_true(n < 100);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_end_with_their_unit_and_counters_with_total),
        cmocka_unit_test(a_counter_has_help_type_and_its_value),
        cmocka_unit_test(a_gauge_goes_down_too_and_can_be_set),
        cmocka_unit_test(seconds_are_counted_in_nanoseconds),
        cmocka_unit_test(few_labels_are_shown_before_they_were_counted),
        cmocka_unit_test(a_histogram_adds_up),
        cmocka_unit_test(a_request_is_counted_by_template_method_and_code),
        cmocka_unit_test(what_a_client_invents_makes_no_series_of_its_own),
        cmocka_unit_test(the_process_tells_of_itself),
        cmocka_unit_test(nothing_is_lost_when_many_threads_count_and_one_reads),
        cmocka_unit_test(without_memory_nothing_is_appended),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
