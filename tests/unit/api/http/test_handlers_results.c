// Results over the API: scenario, summary, curve.

#include "tests/unit/api/helper_ask.h"
#include "tests/unit/helper_cmocka.h"

#include <stdio.h>
#include <string.h>

static void the_scenario_never_changes(void **state)
{
    ask_add_run(RUN_QUEUED);
    ask_get(RUN_1 "/scenario", NULL, NULL, 200);
    assert_string_equal(ask_response.body.bytes, "{\"duration_s\":6.0}");
    ask_assert_header("Cache-Control", "private, max-age=31536000, immutable");
    ask_get(RUN_1 "/scenario", NULL, "If-None-Match: \"" ID_1 "-scenario\"\n", 304);
}

static void a_summary_that_is_not_there_yet_is_a_conflict(void **state)
{
    helper_run *of = ask_add_run(RUN_RUNNING);
    ask_get(RUN_1 "/summary", NULL, NULL, 409);
    assert_true(ask_body_has("running"));
    of->record.state = RUN_FAILED;
    ask_get(RUN_1 "/summary", NULL, NULL, 409);
    assert_true(ask_body_has("left no summary"));
    of->record.has_summary = true;
    of->summary = "{\"model\":\"macro\"}";
    ask_get(RUN_1 "/summary", NULL, NULL, 200);
    assert_string_equal(ask_response.body.bytes, of->summary);
}

static void key_figures_that_are_not_there_yet_are_a_conflict(void **state)
{
    helper_run *of = ask_add_run(RUN_QUEUED);
    ask_get(RUN_1 "/key_figures", NULL, NULL, 409);
    ask_get(RUN_1, NULL, NULL, 200);
    assert_false(ask_body_has("\"key_figures\":{"));
    strcpy(of->record.figures, "{\"throughput_per_h\":60}");
    of->figures = "{\"throughput_per_h\":60,\"feeds\":[{\"id\":\"in\",\"offered\":7}]}";
    ask_get(RUN_1, NULL, NULL, 200);
    assert_true(ask_body_has("\"key_figures\":{\"throughput_per_h\":60},"));
}

static void key_figures_are_json_or_csv(void **state)
{
    helper_run *of = ask_add_run(RUN_RUNNING);
    strcpy(of->record.figures, "{\"throughput_per_h\":60}");
    of->figures = "{\"throughput_per_h\":60,\"feeds\":[{\"id\":\"in\",\"offered\":7}]}";
    ask_get(RUN_1 "/key_figures", NULL, NULL, 200);
    assert_string_equal(ask_response.body.bytes, of->figures);
    ask_get(RUN_1 "/key_figures", "format=csv", NULL, 200);
    assert_string_equal(ask_response.body.bytes, "figure,of,id,value,unit\n"
                                                 "throughput_per_h,run,,60,parts/h\n"
                                                 "offered,feed,in,7,parts\n");
}

static void changes_of_photo_eyes_are_json_or_csv(void **state)
{
    helper_run *of = ask_add_run(RUN_RUNNING);
    ask_get(RUN_1 "/photo_eyes", NULL, NULL, 200);
    assert_string_equal(
        ask_response.body.bytes,
        "{\"changes\":[],\"actions\":[],\"drives\":[],\"belts\":[],\"is_cut\":false}");
    helper_add_event(&ask_daemon, of, API_EVENT_EYE,
                     "{\"t_s\":1.5,\"photo_eye\":\"pe\",\"state\":\"blocked\"}");
    helper_add_event(&ask_daemon, of, API_EVENT_PROGRESS, "{\"t_s\":1.5}");
    helper_add_event(&ask_daemon, of, API_EVENT_ACTION,
                     "{\"t_s\":2,\"action\":3,\"target\":\"flap\"}");
    ask_get(RUN_1 "/photo_eyes", NULL, NULL, 200);
    assert_string_equal(ask_response.body.bytes,
                        "{\"changes\":[{\"t_s\":1.5,\"photo_eye\":\"pe\",\"state\":\"blocked\"}],"
                        "\"actions\":[{\"t_s\":2,\"action\":3,\"target\":\"flap\"}],\"drives\":[],"
                        "\"belts\":[],\"is_cut\":false}");
    ask_get(RUN_1 "/photo_eyes", "format=csv", NULL, 200);
    assert_string_equal(ask_response.body.bytes, "t_s,photo_eye,state\n1.5,pe,blocked\n");
    ask_get("/v1/runs/0190a0b0-0000-7000-8000-0000000000ff/photo_eyes", NULL, NULL, 404);
}

// The bytes that `beltflow solve` writes into curve.csv: header, then t and the counters.
static void the_curve_is_json_or_csv(void **state)
{
    static const char csv[] = "t_s,upstream,left_domain\n0,192,0\n0.1,191.5,0.5\n";

    ask_add_run(RUN_RUNNING);
    ask_get(RUN_1 "/curve", NULL, NULL, 200);
    ask_assert_header("Content-Type", "application/json");
    ask_assert_header("Vary", "Accept");
    assert_string_equal(
        ask_response.body.bytes,
        "{\"t_s\":[0,0.1],\"columns\":{\"upstream\":[192,191.5],\"left_domain\":[0,0.5]}}");
    ask_get(RUN_1 "/curve", NULL, "Accept: text/csv\n", 200);
    ask_assert_header("Content-Type", "text/csv; charset=utf-8");
    assert_string_equal(ask_response.body.bytes, csv);
    ask_get(RUN_1 "/curve", "format=csv", "Accept: application/json\n", 200);
    assert_string_equal(ask_response.body.bytes, csv);
}

// What asks for another format is refused there.
static void a_path_with_an_ending_has_one_format(void **state)
{
    ask_add_run(RUN_RUNNING);
    ask_get(RUN_1 "/curve.csv", NULL, NULL, 200);
    ask_assert_header("Content-Type", "text/csv; charset=utf-8");
    assert_null(helper_header(&ask_response, "Vary"));
    ask_get(RUN_1 "/curve.json", NULL, NULL, 200);
    ask_assert_header("Content-Type", "application/json");
    ask_get(RUN_1 "/curve.csv", NULL, "Accept: application/json\n", 406);
    ask_get(RUN_1 "/curve.csv", "format=csv", NULL, 400);
    assert_true(ask_body_has("the path says the format"));
    ask_get(RUN_1 "/snapshots/1.vti", "width=5", NULL, 400);
    assert_true(ask_body_has("'width' is for png, not for vti"));
    ask_get(RUN_1 "/curve.png", NULL, NULL, 404);
}

static void a_curve_without_samples_has_its_columns(void **state)
{
    ask_add_run(RUN_QUEUED)->record.n_samples = 0;
    ask_get(RUN_1 "/curve", "format=csv", NULL, 200);
    assert_string_equal(ask_response.body.bytes, "t_s,upstream,left_domain\n");
    ask_get(RUN_1 "/curve", NULL, NULL, 200);
    assert_string_equal(ask_response.body.bytes,
                        "{\"t_s\":[],\"columns\":{\"upstream\":[],\"left_domain\":[]}}");
}

static void the_tag_of_a_curve_tells_formats_apart(void **state)
{
    char tag[API_HEADER_SIZE], header[API_HEADER_SIZE + 20];

    ask_add_run(RUN_RUNNING);
    ask_get(RUN_1 "/curve", NULL, NULL, 200);
    snprintf(tag, sizeof tag, "%s", helper_header(&ask_response, "ETag"));
    snprintf(header, sizeof header, "If-None-Match: %s\n", tag);
    ask_get(RUN_1 "/curve", NULL, header, 304);
    ask_get(RUN_1 "/curve", "format=csv", header, 200);
    assert_string_not_equal(helper_header(&ask_response, "ETag"), tag);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        ASK_TEST(the_scenario_never_changes),
        ASK_TEST(a_summary_that_is_not_there_yet_is_a_conflict),
        ASK_TEST(key_figures_that_are_not_there_yet_are_a_conflict),
        ASK_TEST(key_figures_are_json_or_csv),
        ASK_TEST(changes_of_photo_eyes_are_json_or_csv),
        ASK_TEST(the_curve_is_json_or_csv),
        ASK_TEST(a_path_with_an_ending_has_one_format),
        ASK_TEST(a_curve_without_samples_has_its_columns),
        ASK_TEST(the_tag_of_a_curve_tells_formats_apart),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
