// Unit tests of key figures as JSON and CSV.

#include "api/results/key_figures.h"

#include "api/results/events.h"
#include "api/services.h"
#include "core/base/memory.h"
#include "tests/unit/helper_cmocka.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { OF_RUN = FIGURE_OFFERED, OF_FEED = FIGURE_CONTENT_MEAN - FIGURE_OFFERED };
enum {
    OF_COUNTER = FIGURE_GAP_MIN - FIGURE_CONTENT_MEAN,
    OF_EYE = FIGURE_STOPPED_COUNT - FIGURE_GAP_MIN,
    OF_BELT = FIGURE_FAILED_COUNT - FIGURE_STOPPED_COUNT,
    OF_FAILURE = FIGURE_OUTFLOW - FIGURE_FAILED_COUNT,
    OF_OUTLET = FIGURE_TAKEN - FIGURE_OUTFLOW,
    OF_SINK = FIGURE_COUNT - FIGURE_TAKEN
};
enum {
    BEFORE_SINKS =
        OF_RUN + 2 * OF_FEED + OF_COUNTER + OF_EYE + OF_BELT + OF_FAILURE + 2 * OF_OUTLET,
    N_VALUES = BEFORE_SINKS + OF_SINK
};

// Two feeds, of which one has a dot in its id, a counter that is called like the column of a feed, a photo eye,
// a belt that is commanded, a kind of its failures, two outlets and a sink.
static const char columns[] =
    "a.offered,left_domain,in.offered,in.admitted,in.waiting,in.discarded,"
    "x.y.offered,x.y.admitted,x.y.waiting,x.y.discarded,pe1.blocked,in.speed_m_s,jam.failed,in."
    "left,out.left,packer.taken";

// All values are absent but some.
static key_figures make(double values[N_VALUES])
{
    for (size_t k = 0; k < N_VALUES; k++)
        values[k] = (double)NAN;
    values[FIGURE_THROUGHPUT] = 5400.0;
    values[FIGURE_RESIDENCE_MEAN] = 2.5;
    values[FIGURE_RESIDENCE_P95] = 3.25;
    values[FIGURE_JAM_COUNT] = 0.0;
    values[OF_RUN] = 240.0;
    values[OF_RUN + OF_FEED + FIGURE_WAIT_P95 - FIGURE_OFFERED] = 0.5;
    values[OF_RUN + 2 * OF_FEED] = 10.0;
    values[BEFORE_SINKS - 2 * OF_OUTLET - 1] = 12.0;
    values[BEFORE_SINKS - 2 * OF_OUTLET - OF_FAILURE - 1] = 0.875;
    values[BEFORE_SINKS - 2 * OF_OUTLET - OF_FAILURE - 2] = 1.5;
    values[BEFORE_SINKS - OF_OUTLET] = 720.0;
    values[BEFORE_SINKS] = 36.0;
    values[BEFORE_SINKS - 2 * OF_OUTLET - OF_FAILURE - OF_BELT - OF_EYE + FIGURE_DOUBLES -
           FIGURE_GAP_MIN] = 0.125;
    return (key_figures){ .columns = columns, .t = 60.0, .n = N_VALUES, .values = values };
}

static const char text[] =
    "{\"throughput_per_h\":5400,\"residence_s\":{\"mean\":2.5,\"p95\":3.25},\"jam\":{\"count\":0},"
    "\"feeds\":[{\"id\":\"in\",\"offered\":240},{\"id\":\"x.y\",\"wait_s\":{\"p95\":0.5}}],"
    "\"counters\":[{\"id\":\"a.offered\",\"content\":{\"mean\":10}}],"
    "\"photo_eyes\":[{\"id\":\"pe1\",\"doubles_share\":0.125}],"
    "\"belts\":[{\"id\":\"in\",\"stopped\":{\"longest_s\":1.5},\"availability\":0.875}],"
    "\"failures\":[{\"id\":\"jam\",\"failed\":{\"total_s\":12}}],"
    "\"outlets\":[{\"id\":\"in\"},{\"id\":\"out\",\"outflow_per_h\":720}],"
    "\"sinks\":[{\"id\":\"packer\",\"taken\":36}]}";

static void what_is_not_known_is_left_out(void **state)
{
    double values[N_VALUES];
    const key_figures figures = make(values);
    bf_buffer out = { 0 };
    json_out w = json_out_to(&out);
    assert_int_equal(key_figures_check(&figures, NULL), BF_OK);
    key_figures_write(&w, &figures);
    assert_int_equal(json_out_status(&w, NULL), BF_OK);
    assert_string_equal(out.bytes, text);
    buffer_fini(&out);
}

static void a_wrong_number_of_values_is_damage(void **state)
{
    double values[N_VALUES];
    key_figures figures = make(values);
    bf_error err;
    figures.n--;
    assert_int_equal(key_figures_check(&figures, &err), BF_ECORRUPT);
}

// Numbers of 24 characters are the longest.
static void those_of_the_run_alone_are_short(void **state)
{
    double values[N_VALUES];
    bf_buffer out = { 0 };
    json_out w = json_out_to(&out);
    for (size_t k = 0; k < N_VALUES; k++)
        values[k] = -DBL_MAX;
    key_figures_write_run(&w, values);
    assert_int_equal(json_out_status(&w, NULL), BF_OK);
    assert_true(out.n < API_FIGURES_SIZE);
    assert_null(strstr(out.bytes, "feeds"));
    buffer_fini(&out);
}

static void as_csv_each_figure_is_a_line(void **state)
{
    bf_buffer out = { 0 };
    assert_int_equal(key_figures_csv(text, strlen(text), &out, NULL), BF_OK);
    assert_string_equal(out.bytes, "figure,of,id,value,unit\n"
                                   "throughput_per_h,run,,5400,parts/h\n"
                                   "residence_s.mean,run,,2.5,s\n"
                                   "residence_s.p95,run,,3.25,s\n"
                                   "jam.count,run,,0,\n"
                                   "offered,feed,in,240,parts\n"
                                   "wait_s.p95,feed,x.y,0.5,s\n"
                                   "content.mean,counter,a.offered,10,parts\n"
                                   "doubles_share,photo_eye,pe1,0.125,\n"
                                   "stopped.longest_s,belt,in,1.5,s\n"
                                   "availability,belt,in,0.875,\n"
                                   "failed.total_s,failure,jam,12,s\n"
                                   "outflow_per_h,outlet,out,720,parts/h\n"
                                   "taken,sink,packer,36,parts\n");
    buffer_fini(&out);
}

// All are numbers of 17 digits but some that are missing.
static void values_read_back_bit_by_bit(void **state)
{
    double values[N_VALUES], read[N_VALUES];
    const key_figures figures = make(values);
    bf_buffer out = { 0 };
    json_out w = json_out_to(&out);
    for (size_t k = 0; k < N_VALUES; k++)
        values[k] = k % 3 == 0 ? (double)NAN : 1.0 / (double)(k + 1);
    key_figures_write(&w, &figures);
    assert_int_equal(key_figures_read(out.bytes, out.n, columns, N_VALUES, read, NULL), BF_OK);
    for (size_t k = 0; k < N_VALUES; k++)
        assert_true(isnan(values[k]) ? isnan(read[k]) : read[k] == values[k]);
    buffer_fini(&out);
}

static void values_of_other_columns_are_damage(void **state)
{
    double read[N_VALUES];
    bf_error err;
    assert_int_equal(key_figures_read(text, strlen(text), columns, N_VALUES - 1, read, &err),
                     BF_ECORRUPT);
    assert_int_equal(key_figures_read("{}", 2, columns, N_VALUES, read, &err), BF_ECORRUPT);
    assert_int_equal(key_figures_read("{", 1, columns, N_VALUES, read, &err), BF_ECORRUPT);
}

static void what_is_no_json_is_damage(void **state)
{
    bf_buffer out = { 0 };
    bf_error err;
    assert_int_equal(key_figures_csv("{", 1, &out, &err), BF_ECORRUPT);
    assert_int_equal(out.n, 0);
    buffer_fini(&out);
}

static void an_event_has_the_time_of_the_figures(void **state)
{
    double values[N_VALUES];
    const key_figures figures = make(values);
    bf_buffer out = { 0 };
    char wanted[1024] = "{\"run\":\"r\",\"t_s\":60,\"key_figures\":";
    assert_int_equal(events_figures("r", &figures, &out, NULL), BF_OK);
    strcat(strcat(wanted, text), "}");
    assert_string_equal(out.bytes, wanted);
    buffer_fini(&out);
}

static void no_memory_leaves_nothing_behind(void **state)
{
    bool has_failed = true;
    for (size_t n = 1; has_failed; n++) {
        bf_buffer out = { 0 };
        memory_plan_fault(n, 1);
        const bf_status status = key_figures_csv(text, strlen(text), &out, NULL);
        has_failed = memory_faults() > 0;
        memory_plan_fault(0, 0);
        assert_int_equal(status, has_failed ? BF_ENOMEM : BF_OK);
        assert_true(has_failed == (out.n == 0));
        buffer_fini(&out);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_not_known_is_left_out),
        cmocka_unit_test(a_wrong_number_of_values_is_damage),
        cmocka_unit_test(those_of_the_run_alone_are_short),
        cmocka_unit_test(as_csv_each_figure_is_a_line),
        cmocka_unit_test(values_read_back_bit_by_bit),
        cmocka_unit_test(values_of_other_columns_are_damage),
        cmocka_unit_test(what_is_no_json_is_damage),
        cmocka_unit_test(an_event_has_the_time_of_the_figures),
        cmocka_unit_test(no_memory_leaves_nothing_behind),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
