// Studies over HTTP: accepted, refused with every fault in its place, listed, changed, removed.

#include "api/study/study_document.h"
#include "tests/unit/api/helper_ask.h"
#include "tests/unit/api/helper_document.h"
#include "tests/unit/helper_cmocka.h"

#include <stdio.h>
#include <string.h>

#define STUDY_1  "/v1/studies/0190a0b0-0000-7000-a000-000000000001"
#define STUDY_2  "0190a0b0-0000-7000-a000-000000000002"
#define MEASURED "0190a0b0-0000-7000-9000-000000000001"
#define ANGLE    "{'pointer': '/obstacles/0/angle_deg', 'range': [30, 90]}"
#define PLATE    "'obstacles': [{'end_m': [0.75, 0.5], 'angle_deg': 60, 'length_m': 0.5}]"
#define STUDY_OF(parameters, figure, rest)                                                         \
    "{'base': {'scenario': " DOCUMENT_WITH(PLATE) "}, 'parameters': [" parameters                  \
                                                  "], 'objectives': [{'figure': '" figure          \
                                                  "'}], 'method': {'type': 'grid'}" rest "}"
#define STUDY STUDY_OF(ANGLE, "throughput_per_h", ", 'name': 'N', 'priority': 3")
#define CALIBRATION(curve)                                                                         \
    "{'base': {'scenario': " DOCUMENT_WITH(                                                        \
        PLATE                                                                                      \
        ", 'counters': [{'id': 'a', 'x_m': [0, 0.7]}]") "}, 'parameters': [" ANGLE                 \
                                                        "], 'curves': [" curve                     \
                                                        "], 'method': {'type': 'calibrate', "      \
                                                        "'points': 4}}"

static void post(const char *document, const char *headers, int status)
{
    bf_buffer text = document_quote(document);
    char lines[200];

    snprintf(lines, sizeof lines, IS_JSON "%s", headers == NULL ? "" : headers);
    ask("POST", "/v1/studies", NULL, lines, text.bytes, status);
    buffer_fini(&text);
}

static void a_study_is_accepted(void **state)
{
    post(STUDY, NULL, 201);
    ask_assert_header("Location", STUDY_1);
    ask_assert_header("ETag", "\"r1\"");
    assert_true(ask_body_has("\"name\":\"N\""));
    assert_true(ask_body_has("\"method\":\"grid\""));
    assert_true(ask_body_has("\"priority\":3"));
    assert_true(ask_body_has("\"limit\":5"));
    assert_string_equal(ask_daemon.columns,
                        "{\"parameters\":[\"/obstacles/0/angle_deg\"],"
                        "\"values\":[\"throughput_per_h\",\"residence_s.mean\"]}");
    ask_daemon.is_replay = true;
    post(STUDY, "Idempotency-Key: \"k\"\n", 201);
    ask_assert_header("Idempotent-Replayed", "true");
}

static void each_fault_has_its_place(void **state)
{
    static const struct {
        const char *document, *pointer;
    } cases[] = {
        { STUDY_OF("{'pointer': '/obstacles/7/angle_deg', 'range': [1, 2]}", "peak_density", ""),
          "/parameters/0/pointer" },
        { STUDY_OF("{'pointer': '/cargo', 'range': [1, 2]}", "peak_density", ""),
          "/parameters/0/pointer" },
        { STUDY_OF("{'pointer': '/obstacles/0/angle_deg', 'range': [90, 30]}", "peak_density", ""),
          "/parameters/0" },
        { STUDY_OF(ANGLE, "queue_end_m", ""), "/objectives/0/figure" },
        { STUDY_OF(ANGLE, "peak_density", ", 'limits': {'trials': 1000000000}"), "/limits/trials" },
        { STUDY_OF(ANGLE, "peak_density", ", 'priority': 101"), "/priority" },
        { "{'base': " STUDY ", 'parameters': [" ANGLE "], 'method': {'type': 'grid'}}",
          "/base/parameters" },
        { CALIBRATION("{'counter': 'a', 'measurement': '" MEASURED "'}"), "/curves/0/measurement" },
        { CALIBRATION("{'counter': 'a', 'measurement': 7}"), "/curves/0/measurement" },
    };
    char pointer[100];

    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        post(cases[k].document, NULL, 422);
        snprintf(pointer, sizeof pointer, "\"pointer\":\"%s\"", cases[k].pointer);
        if (!ask_body_has(pointer))
            fail_msg("%s is not in %s", pointer, ask_response.body.bytes);
    }
    post("{", NULL, 400);
    ask("POST", "/v1/studies", NULL, NULL, "{}", 415);
    assert_int_equal(ask_daemon.n_studies, 0);
}

static study_document read_stored(void)
{
    bf_faults faults = { 0 };
    study_document d;

    assert_int_equal(
        study_document_read(ask_daemon.document, strlen(ask_daemon.document), &d, &faults, NULL),
        BF_OK);
    return d;
}

static void the_stored_document_has_the_numbers_of_measurements(void **state)
{
    helper_measurement *m = helper_add_measurement(&ask_daemon, "upstream");

    post(CALIBRATION("{'counter': 'a', 'measurement': '" MEASURED "'}"), NULL, 201);
    study_document d = read_stored();
    assert_int_equal(d.curves[0].n_t, 2);
    assert_true(d.curves[0].t[1] == 0.1 && d.curves[0].count[1] == 191.0);
    study_document_fini(&d);
    m->about.kind = API_MEASURED_PROFILE;
    snprintf(m->csv, sizeof m->csv, "t_s,rate_per_s\n0,1\n60,2\n");
    post(CALIBRATION("{'counter': 'a', 'measurement': '" MEASURED "'}"), NULL, 422);
    assert_true(ask_body_has("is a profile, not a curve"));
    post("{'base': {'scenario': {'duration_s': 1, 'domain': {'x_m': [0, 1], 'y_m': [0, 0.6]}, "
         "'cargo': {}, 'feeds': [{'edge': 'west', 'y_m': [0.1, 0.5], 'profile': {'measurement': "
         "'" MEASURED "', 'repeat_s': 90}}]}}, 'parameters': [{'pointer': '/duration_s', 'range': "
         "[1, 2]}], 'objectives': [{'figure': 'peak_density'}], 'method': {'type': 'grid'}}",
         NULL, 201);
    d = read_stored();
    assert_null(strstr(ask_daemon.document, "measurement"));
    study_document_fini(&d);
}

static void refusals_of_the_service_are_those_of_runs(void **state)
{
    ask_daemon.refusal = BF_EINPUT;
    post(STUDY, "Idempotency-Key: \"k\"\n", 422);
    ask_daemon.refusal = BF_ELIMIT;
    post(STUDY, NULL, 429);
    ask_daemon.refusal = BF_EBUSY;
    post(STUDY, NULL, 503);
    ask_daemon.refusal = BF_ENOSPACE;
    post(STUDY, NULL, 507);
}

static void lists_are_narrowed_and_paged(void **state)
{
    helper_add_study(&ask_daemon, API_STUDY_PAUSED);
    helper_add_study(&ask_daemon, API_STUDY_RUNNING);
    helper_add_study(&ask_daemon, API_STUDY_RUNNING);
    ask_get("/v1/studies", "status=running&limit=1", NULL, 200);
    ask_assert_header("Link", "</v1/studies?limit=1&status=running&cursor="
                              "0190a0b0-0000-7000-a000-000000000003>; rel=\"next\"");
    assert_true(ask_body_has("\"next_cursor\":\"0190a0b0-0000-7000-a000-000000000003\""));
    ask_get("/v1/studies", "status=paused", NULL, 200);
    assert_true(ask_body_has("\"status\":\"paused\""));
    assert_false(ask_body_has("\"status\":\"running\""));
    ask_get("/v1/studies", "status=pausing", NULL, 400);
}

static void a_study_is_shown_with_its_state_as_tag(void **state)
{
    helper_study *of = helper_add_study(&ask_daemon, API_STUDY_RUNNING);

    helper_add_trial(of, API_TRIAL_SUCCEEDED);
    helper_add_trial(of, API_TRIAL_RUNNING);
    ask_get(STUDY_1, NULL, NULL, 200);
    ask_assert_header("ETag", "\"r3\"");
    assert_true(ask_body_has("\"trials\":{\"limit\":500,\"begun\":2,\"succeeded\":1,"));
    assert_true(ask_body_has("\"best\":\"" STUDY_1 "/best\""));
    ask_get(STUDY_1, NULL, "If-None-Match: \"r3\"\n", 304);
    ask_get("/v1/studies/" STUDY_2, NULL, NULL, 404);
    ask_get("/v1/studies/none", NULL, NULL, 404);
}

static void changes_are_made_or_will_be(void **state)
{
    helper_study *of = helper_add_study(&ask_daemon, API_STUDY_RUNNING);

    ask("POST", STUDY_1 "/pause", NULL, NULL, NULL, 202);
    of->about.state = API_STUDY_PAUSED;
    ask("POST", STUDY_1 "/pause", NULL, NULL, NULL, 409);
    ask("POST", STUDY_1 "/resume", NULL, NULL, NULL, 200);
    assert_true(ask_body_has("\"status\":\"queued\""));
    ask("POST", STUDY_1 "/pause", NULL, NULL, NULL, 200);
    ask("POST", STUDY_1 "/cancel", NULL, "If-Match: \"r1\"\n", NULL, 412);
    ask_daemon.n_changes_between = 1;
    ask("POST", STUDY_1 "/cancel", NULL, "If-Match: \"r4\"\n", NULL, 412);
    ask_daemon.n_changes_between = 1;
    ask("POST", STUDY_1 "/cancel", NULL, NULL, NULL, 200);
    ask("POST", STUDY_1 "/cancel", NULL, NULL, NULL, 409);
    ask("DELETE", STUDY_1, NULL, "If-Match: \"r1\"\n", NULL, 412);
    ask("DELETE", STUDY_1, NULL, NULL, NULL, 204);
    ask("DELETE", STUDY_1, NULL, NULL, NULL, 404);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        ASK_TEST(a_study_is_accepted),
        ASK_TEST(each_fault_has_its_place),
        ASK_TEST(the_stored_document_has_the_numbers_of_measurements),
        ASK_TEST(refusals_of_the_service_are_those_of_runs),
        ASK_TEST(lists_are_narrowed_and_paged),
        ASK_TEST(a_study_is_shown_with_its_state_as_tag),
        ASK_TEST(changes_are_made_or_will_be),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
