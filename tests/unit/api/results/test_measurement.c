// Measured curves as JSON and CSV: what is read, and what is refused with its place.

#include "api/results/measurement.h"

#include "core/base/memory.h"
#include "tests/unit/helper_cmocka.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bf_faults faults;
static bf_error error;

static int set_up(void **state)
{
    faults = (bf_faults){ .n = 0 };
    error = (bf_error){ .code = BF_OK };
    return 0;
}

static bf_status read_json(const char *json, measurement *ret_measurement)
{
    return measurement_read_json(json, strlen(json), ret_measurement, &faults, &error);
}

static bf_status read_csv(const char *text, const char *label, const char *counter,
                          measurement *ret_measurement)
{
    return measurement_read_csv(text, strlen(text), label, counter, ret_measurement, &faults,
                                &error);
}

static void assert_samples(const measurement *m, size_t n, const double *t, const double *counts)
{
    assert_int_equal(m->about.n_samples, n);
    assert_int_equal(m->curve.n, n);
    assert_int_equal(m->curve.n_columns, 1);
    assert_string_equal(m->curve.columns.bytes, m->about.counter);
    assert_int_equal(m->curve.t.n, n * sizeof *t);
    assert_int_equal(m->curve.values.n, n * sizeof *counts);
    assert_memory_equal(m->curve.t.bytes, t, n * sizeof *t);
    assert_memory_equal(m->curve.values.bytes, counts, n * sizeof *counts);
    assert_true(m->about.t_start == t[0] && m->about.t_end == t[n - 1]);
}

static void json_and_csv_give_the_same_measurement(void **state)
{
    static const double t[] = { -0.5, 0.1, 2.0 }, counts[] = { 192.0, 0.0, 1e-3 };
    measurement m = { .curve = { .n = 0 } };

    assert_int_equal(read_json("{\"label\":\"\xc3\xa4\",\"counter\":\"gate\","
                               "\"t_s\":[-0.5,0.1,2],\"count\":[192,0,1e-3]}",
                               &m),
                     BF_OK);
    assert_string_equal(m.about.label, "\xc3\xa4");
    assert_string_equal(m.about.counter, "gate");
    assert_samples(&m, 3, t, counts);
    measurement_fini(&m);
    assert_int_equal(
        read_csv("t_s,gate\r\n-0.5,192\r\n0.1,0\r\n\r\n2,1e-3\r\n", "\xc3\xa4", NULL, &m), BF_OK);
    assert_string_equal(m.about.label, "\xc3\xa4");
    assert_string_equal(m.about.counter, "gate");
    assert_samples(&m, 3, t, counts);
    measurement_fini(&m);
    assert_null(m.curve.t.bytes);
    measurement_fini(NULL);
}

// The column or the request names the counter; of "count" it is the one that scenarios have by default.
static void the_counter_is_told_or_upstream(void **state)
{
    static const struct {
        const char *text, *counter, *expected;
    } good[] = {
        { "t_s,count\n0,1\n1,0\n", NULL, "upstream" },
        { "t_s,count\n0,1\n1,0\n", "gate", "gate" },
        { "t_s,gate\n0,1\n1,0\n", NULL, "gate" },
        { "t_s,gate\n0,1\n1,0\n", "gate", "gate" },
        { "\xef\xbb\xbft_s,gate,left_domain\n0,1,7\n1,0,8\n", NULL, "gate" },
    };
    static const double t[] = { 0.0, 1.0 }, counts[] = { 1.0, 0.0 };
    measurement m = { .curve = { .n = 0 } };

    for (size_t k = 0; k < sizeof good / sizeof *good; k++) {
        assert_int_equal(read_csv(good[k].text, NULL, good[k].counter, &m), BF_OK);
        assert_string_equal(m.about.counter, good[k].expected);
        assert_string_equal(m.about.label, "");
        assert_samples(&m, 2, t, counts);
        measurement_fini(&m);
    }
    assert_int_equal(read_json("{\"t_s\":[0,1],\"count\":[1,0]}", &m), BF_OK);
    assert_string_equal(m.about.counter, "upstream");
    measurement_fini(&m);
}

static void expect_fault(bf_status status, const char *pointer, const measurement *m)
{
    assert_int_not_equal(status, BF_OK);
    assert_true(faults.n > 0);
    assert_string_equal(faults.items[0].pointer, pointer);
    assert_int_equal(error.code, status);
    assert_string_equal(error.pointer, pointer);
    assert_true(m->about.n_samples == 77 && m->curve.t.bytes == NULL);
    set_up(NULL);
}

static void bad_json_is_refused_with_its_pointer(void **state)
{
    static const struct {
        const char *json, *pointer;
    } bad[] = {
        { "", "" },
        { "[]", "" },
        { "{}", "/t_s" },
        { "{\"t_s\":[0,1]}", "/count" },
        { "{\"t_s\":[0],\"count\":[1]}", "/t_s" },
        { "{\"t_s\":[0,1],\"count\":[1]}", "/count" },
        { "{\"t_s\":[0,1],\"count\":[1,2,3]}", "/count" },
        { "{\"t_s\":[0,1,1],\"count\":[1,2,3]}", "/t_s/2" },
        { "{\"t_s\":[0,2,1],\"count\":[1,2,3]}", "/t_s/2" },
        { "{\"t_s\":[0,1],\"count\":[1,-1]}", "/count/1" },
        { "{\"t_s\":[0,1],\"count\":[1,null]}", "/count/1" },
        { "{\"t_s\":[0,[1]],\"count\":[1,1]}", "/t_s/1" },
        { "{\"t_s\":[0,1e999],\"count\":[1,1]}", "/t_s/1" },
        { "{\"t_s\":\"0,1\",\"count\":[1,1]}", "/t_s" },
        { "{\"t_s\":[0,1],\"count\":[1,1],\"counts\":[]}", "/counts" },
        { "{\"counter\":\"\",\"t_s\":[0,1],\"count\":[1,1]}", "/counter" },
        { "{\"counter\":\"a b\",\"t_s\":[0,1],\"count\":[1,1]}", "/counter" },
        { "{\"counter\":\"t_s\",\"t_s\":[0,1],\"count\":[1,1]}", "/counter" },
        { "{\"label\":7,\"t_s\":[0,1],\"count\":[1,1]}", "/label" },
    };
    measurement m = { .about = { .n_samples = 77 } };

    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++)
        expect_fault(read_json(bad[k].json, &m), bad[k].pointer, &m);
}

static void bad_csv_is_refused_with_its_line(void **state)
{
    static const struct {
        const char *text, *label, *counter, *pointer;
    } bad[] = {
        { "", NULL, NULL, "/line/1" },
        { "0,1\n1,0\n", NULL, NULL, "/line/1" },
        { "t_s\n0\n1\n", NULL, NULL, "/line/1" },
        { "t_s,\n0,1\n1,0\n", NULL, NULL, "/line/1" },
        { "t_s,a b\n0,1\n1,0\n", NULL, NULL, "/line/1" },
        { "t_s,t_s\n0,1\n1,0\n", NULL, NULL, "/line/1" },
        { "t_s,gate\n0,1\n1,0\n", NULL, "upstream", "/line/1" },
        { "t_s,count\n0,1\n", NULL, NULL, "/line/1" },
        { "t_s,count\n", NULL, NULL, "/line/1" },
        { "t_s,count\n0,1\n\n1;0\n", NULL, NULL, "/line/4" },
        { "t_s,count\n0,1\n1,\n", NULL, NULL, "/line/3" },
        { "t_s,count\n0,1\n1,nan\n", NULL, NULL, "/line/3" },
        { "t_s,count\n0,1\n\n0,0\n", NULL, NULL, "/line/4" },
        { "t_s,count\n0,1\n1,-1e-9\n", NULL, NULL, "/line/3" },
        { "t_s,count\n0,1\n1,0\n", NULL, "", "/counter" },
        { "t_s,count\n0,1\n1,0\n", NULL, "a/b", "/counter" },
        { "t_s,count\n0,1\n1,0\n", "\xff", NULL, "/label" },
    };
    char label[API_LABEL_SIZE + 1];
    measurement m = { .about = { .n_samples = 77 } };

    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++)
        expect_fault(read_csv(bad[k].text, bad[k].label, bad[k].counter, &m), bad[k].pointer, &m);
    memset(label, 'x', sizeof label);
    label[API_LABEL_SIZE] = '\0';
    expect_fault(read_csv("t_s,count\n0,1\n1,0\n", label, NULL, &m), "/label", &m);
}

static void all_faults_are_told_at_once(void **state)
{
    measurement m = { .about = { .n_samples = 77 } };

    assert_int_equal(read_csv("t_s,gate\n0,-1\n0,-2\n", NULL, "a b", &m), BF_EINPUT);
    assert_int_equal(faults.n, 5); // counter, its column, a count, a time and its count
    set_up(NULL);
    assert_int_equal(read_json("{\"counter\":\"?\",\"t_s\":[1,1],\"count\":[-1,-1,0]}", &m),
                     BF_EINPUT);
    assert_int_equal(faults.n, 5);
}

// n samples at 0, 1, 2, ... as CSV; free().
static char *make_lines(size_t n)
{
    char *text = malloc(32 + 16 * n);

    assert_non_null(text);
    size_t at = (size_t)sprintf(text, "t_s,count\n");
    for (size_t k = 0; k < n; k++)
        at += (size_t)sprintf(text + at, "%zu,1\n", k);
    return text;
}

static void the_number_of_samples_is_limited(void **state)
{
    measurement m = { .about = { .n_samples = 77 } };
    char place[32];

    char *most = make_lines(API_MEASUREMENT_SAMPLES_MAX);
    char *more = make_lines(API_MEASUREMENT_SAMPLES_MAX + 1);
    snprintf(place, sizeof place, "/line/%d", API_MEASUREMENT_SAMPLES_MAX + 2);
    expect_fault(read_csv(more, NULL, NULL, &m), place, &m);
    assert_int_equal(read_csv(most, NULL, NULL, &m), BF_OK);
    assert_int_equal(m.about.n_samples, API_MEASUREMENT_SAMPLES_MAX);
    measurement_fini(&m);
    free(most);
    free(more);
}

static void what_was_read_is_written_back(void **state)
{
    measurement m = { .curve = { .n = 0 } };
    bf_buffer out = { 0 };

    assert_int_equal(read_csv("t_s,count\n0,3\n0.1,0.25\n", "a\"b", NULL, &m), BF_OK);
    assert_int_equal(measurement_json(&m.about, &m.curve, &m.csv, &out, NULL), BF_OK);
    assert_string_equal(out.bytes,
                        "{\"id\":\"\",\"label\":\"a\\\"b\",\"counter\":\"upstream\","
                        "\"created_at\":null,\"n_samples\":2,\"t_start_s\":0,\"t_end_s\":0.1,"
                        "\"links\":{\"self\":\"/v1/measurements/\"},"
                        "\"t_s\":[0,0.1],\"count\":[3,0.25]}");
    buffer_fini(&out);
    measurement_fini(&m);
}

static void without_memory_nothing_is_read(void **state)
{
    measurement m = { .about = { .n_samples = 77 } };

    for (int form = 0; form < 2; form++) {
        bf_status status = BF_ENOMEM;
        for (size_t n = 1; status != BF_OK; n++) {
            set_up(NULL);
            memory_plan_fault(n, 0);
            status = form == 0 ? read_json("{\"t_s\":[0,1],\"count\":[1,0]}", &m)
                               : read_csv("t_s,count\n0,1\n1,0\n", NULL, NULL, &m);
            memory_plan_fault(0, 0);
            assert_true(status == BF_OK || (status == BF_ENOMEM && error.code == BF_ENOMEM));
            assert_true(status == BF_OK || m.about.n_samples == 77);
        }
        measurement_fini(&m);
        m.about.n_samples = 77;
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(json_and_csv_give_the_same_measurement, set_up),
        cmocka_unit_test_setup(the_counter_is_told_or_upstream, set_up),
        cmocka_unit_test_setup(bad_json_is_refused_with_its_pointer, set_up),
        cmocka_unit_test_setup(bad_csv_is_refused_with_its_line, set_up),
        cmocka_unit_test_setup(all_faults_are_told_at_once, set_up),
        cmocka_unit_test_setup(the_number_of_samples_is_limited, set_up),
        cmocka_unit_test_setup(what_was_read_is_written_back, set_up),
        cmocka_unit_test_setup(without_memory_nothing_is_read, set_up),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
