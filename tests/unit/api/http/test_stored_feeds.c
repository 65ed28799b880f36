// Feeds whose profile or list of arrivals is a stored measurement: resolved to numbers, or refused with the place.

#include "api/scenario/submission.h"
#include "core/base/memory.h"
#include "tests/unit/api/helper_ask.h"
#include "tests/unit/helper_cmocka.h"

#include <stdio.h>
#include <string.h>

#define MEASURED "0190a0b0-0000-7000-9000-000000000001"
#define BODY_OF(demand)                                                                            \
    "{\"scenario\":{\"duration_s\":10,\"domain\":{\"x_m\":[0,1],\"y_m\":[0,0.6]},"                 \
    "\"cargo\":[{\"id\":\"box\"},{\"id\":\"tin\"}],"                                               \
    "\"feeds\":[{\"edge\":\"west\",\"y_m\":[0.1,0.5]," demand "}]}}"
#define PROFILE  BODY_OF("\"profile\":{\"measurement\":\"" MEASURED "\",\"repeat_s\":90}")
#define SCHEDULE BODY_OF("\"schedule\":{\"measurement\":\"" MEASURED "\"}")

static helper_measurement *add(api_measured kind, const char *csv)
{
    helper_measurement *m = helper_add_measurement(&ask_daemon, "");

    m->about.kind = kind;
    snprintf(m->csv, sizeof m->csv, "%s", csv);
    return m;
}

static void assert_refused(const char *body, const char *place, const char *detail)
{
    char pointer[100];

    snprintf(pointer, sizeof pointer, "\"pointer\":\"/scenario/feeds/0/%s\"", place);
    ask("POST", "/v1/runs", NULL, IS_JSON, body, 422);
    assert_true(ask_body_has(pointer));
    assert_true(ask_body_has(detail));
    assert_int_equal(ask_daemon.n_submitted, 0);
}

static void the_resolved_scenario_holds_the_numbers(void **state)
{
    add(API_MEASURED_PROFILE, "t_s,rate_per_h\n0,3600\n60,7200\n");
    ask("POST", "/v1/validate", NULL, IS_JSON, PROFILE, 200);
    assert_true(ask_body_has("\"profile\":{\"t_s\":[0,60],\"rate_per_s\":[1,2],\"repeat_s\":90}"));
    assert_false(ask_body_has("measurement"));
    ask("POST", "/v1/runs", NULL, IS_JSON, PROFILE, 201);
}

static void kinds_and_places_are_those_of_the_scenario(void **state)
{
    add(API_MEASURED_SCHEDULE, "t_s,kind,y_m\n0,tin,0.1\n2,box,0.5\n");
    ask("POST", "/v1/validate", NULL, IS_JSON, SCHEDULE, 200);
    assert_true(
        ask_body_has("\"schedule\":{\"t_s\":[0,2],\"kind\":[\"tin\",\"box\"],\"place\":[0,1]}"));
    assert_false(ask_body_has("measurement"));
}

static void what_a_text_says_of_another_scenario_is_refused(void **state)
{
    helper_measurement *m = add(API_MEASURED_SCHEDULE, "t_s,kind\n0,tin\n1,can\n");
    assert_refused(SCHEDULE, "schedule/measurement", "line 3");
    snprintf(m->csv, sizeof m->csv, "t_s,y_m\n0,0.55\n");
    assert_refused(SCHEDULE, "schedule/measurement", "line 2: y_m 0.55 lies off the feed");
}

static void what_is_not_there_or_of_another_kind_is_refused(void **state)
{
    assert_refused(PROFILE, "profile/measurement", "there is no measurement '" MEASURED "'");
    assert_refused(BODY_OF("\"profile\":{\"measurement\":\"yesterday\"}"), "profile/measurement",
                   "there is no measurement 'yesterday'");
    helper_measurement *m = add(API_MEASURED_SCHEDULE, "t_s\n0\n");
    assert_refused(PROFILE, "profile/measurement", "is a schedule, not a profile");
    m->about.kind = API_MEASURED_CURVE;
    assert_refused(PROFILE, "profile/measurement", "is a curve, not a profile");
    assert_refused(SCHEDULE, "schedule/measurement", "is a curve, not a schedule");
    ask("DELETE", "/v1/measurements/" MEASURED, NULL, NULL, NULL, 204);
    assert_refused(SCHEDULE, "schedule/measurement", "there is no measurement");
    assert_refused(BODY_OF("\"schedule\":{\"measurement\":7}"), "schedule/measurement",
                   "must be an id, not a number");
}

static void a_store_that_fails_is_no_fault_of_the_document(void **state)
{
    add(API_MEASURED_PROFILE, "t_s,rate_per_s\n0,1\n");
    ask_daemon.refusal = BF_EBUSY;
    ask("POST", "/v1/validate", NULL, IS_JSON, PROFILE, 503);
    assert_false(ask_body_has("errors"));
}

// A text of 15 + 10 4 bytes.
static bf_status read_55_bytes(const void *context, const char *id, const char *kind,
                               bf_buffer *out, bf_error *err)
{
    assert_string_equal(kind, "profile");
    return buffer_printf(out, "t_s,rate_per_s\n0,1\n1,1\n2,1\n3,1\n4,1\n5,1\n6,1\n7,1\n8,1\n9,1\n");
}

static void all_texts_together_have_a_limit(void **state)
{
    static const char body[] =
        "{\"scenario\":{\"duration_s\":10,\"domain\":{\"x_m\":[0,1],\"y_m\":[0,0.6]},\"cargo\":{},"
        "\"feeds\":[{\"edge\":\"west\",\"y_m\":[0.1,0.3],\"profile\":{\"measurement\":\"a\"}},"
        "{\"edge\":\"west\",\"y_m\":[0.3,0.5],\"profile\":{\"measurement\":\"b\"}}]}}";
    json_in_texts texts = { .read = read_55_bytes, .n_left = 110 };
    api_submission submission = { .label = "" };
    bf_faults faults = { .n = 0 };

    assert_int_equal(submission_read(body, sizeof body - 1, &texts, &submission, &faults, NULL),
                     BF_OK);
    assert_int_equal(texts.n_left, 0);
    submission_fini(&submission);
    texts.n_left = 109;
    assert_int_equal(submission_read(body, sizeof body - 1, &texts, &submission, &faults, NULL),
                     BF_ELIMIT);
    assert_string_equal(faults.items[0].pointer, "/scenario/feeds/1/profile/measurement");
}

static void without_memory_nothing_is_submitted(void **state)
{
    add(API_MEASURED_SCHEDULE, "t_s,kind,y_m\n0,tin,0.1\n");
    for (size_t n = 1; ask_response.status != 201; n++) {
        api_response_fini(&ask_response);
        memory_plan_fault(n, 0);
        helper_request(&ask_daemon, "POST", "/v1/runs", NULL, IS_JSON, SCHEDULE, &ask_response);
        memory_plan_fault(0, 0);
        assert_true(ask_response.status == 201 || ask_response.status == 503);
        assert_int_equal(ask_daemon.n_submitted, ask_response.status == 201);
        assert_true(n < 10000);
    }
}

static void only_curves_are_compared(void **state)
{
    ask_add_run(RUN_SUCCEEDED);
    add(API_MEASURED_PROFILE, "t_s,rate_per_s\n0,1\n");
    ask_get("/v1/compare", "a=" ID_1 "&b=" MEASURED, NULL, 422);
    assert_true(ask_body_has("\"pointer\":\"/b\""));
    assert_true(ask_body_has("is a profile, not a curve"));
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        ASK_TEST(the_resolved_scenario_holds_the_numbers),
        ASK_TEST(kinds_and_places_are_those_of_the_scenario),
        ASK_TEST(what_a_text_says_of_another_scenario_is_refused),
        ASK_TEST(what_is_not_there_or_of_another_kind_is_refused),
        ASK_TEST(a_store_that_fails_is_no_fault_of_the_document),
        ASK_TEST(all_texts_together_have_a_limit),
        ASK_TEST(without_memory_nothing_is_submitted),
        ASK_TEST(only_curves_are_compared),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
