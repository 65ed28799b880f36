// Bodies of POST /v1/runs: a scenario with what to do with it.

#include "api/scenario/submission.h"

#include "api/scenario/scenario.h"
#include "core/base/memory.h"
#include "tests/unit/api/helper_document.h"
#include "tests/unit/helper_cmocka.h"

#include <stdio.h>
#include <string.h>

#define SCENARIO "'scenario': {'name': 'N', " DOCUMENT_NEEDED "}"

static bf_faults faults;

static bf_status read_text(const char *text, api_submission *ret_submission, bf_error *err)
{
    bf_buffer document = document_quote(text);

    faults.n = 0;
    bf_status status =
        submission_read(document.bytes, document.n, NULL, ret_submission, &faults, err);
    buffer_fini(&document);
    return status;
}

static void a_scenario_alone_suffices(void **unused)
{
    api_submission submission;

    assert_int_equal(read_text("{" SCENARIO "}", &submission, NULL), BF_OK);
    assert_int_equal(submission.model, RUN_MACRO);
    assert_int_equal(submission.priority, 0);
    assert_false(submission.is_fresh);
    assert_string_equal(submission.label, "");
    assert_string_equal(submission.name, "N");
    assert_string_equal(submission.columns.bytes, "upstream,left_domain");
    submission_fini(&submission);
    assert_null(submission.scenario.bytes);
    submission_fini(NULL);
}

static void all_members_are_taken_over(void **unused)
{
    api_submission submission;

    assert_int_equal(read_text("{" SCENARIO ", 'model': 'macro', 'label': 'night shift',"
                               "'priority': -100, 'fresh': true}",
                               &submission, NULL),
                     BF_OK);
    assert_int_equal(submission.priority, -100);
    assert_true(submission.is_fresh);
    assert_string_equal(submission.label, "night shift");
    submission_fini(&submission);
}

static void a_number_of_replications_is_refused_with_its_range(void **unused)
{
    static const struct {
        const char *number, *detail;
    } rows[] = {
        { "-1", "must be from 1 to 1000, not -1" },
        { "0", "must be from 1 to 1000, not 0" },
        { "1001", "must be from 1 to 1000, not 1001" },
    };
    api_submission submission;
    char text[512];

    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) {
        snprintf(text, sizeof text, "{" SCENARIO ", 'replications': %s}", rows[k].number);
        assert_int_equal(read_text(text, &submission, NULL), BF_EINPUT);
        assert_int_equal(faults.n, 1);
        assert_string_equal(faults.items[0].pointer, "/replications");
        assert_string_equal(faults.items[0].text, rows[k].detail);
    }
}

// What is stored is what scenario_write() makes of the scenario by itself.
static void the_document_is_resolved(void **unused)
{
    bf_buffer document = document_quote("{'name': 'N', " DOCUMENT_NEEDED "}");
    bf_buffer resolved = { 0 };
    api_submission submission;
    scene s;

    faults.n = 0;
    assert_int_equal(scenario_read(document.bytes, document.n, &s, &faults, NULL), BF_OK);
    assert_int_equal(scenario_write(&s, &resolved, NULL), BF_OK);
    assert_int_equal(read_text("{" SCENARIO "}", &submission, NULL), BF_OK);
    assert_string_equal(submission.scenario.bytes, resolved.bytes);
    submission_fini(&submission);
    scene_fini(&s);
    buffer_fini(&resolved);
    buffer_fini(&document);
}

// What two bodies have in common when their results do: all but names, labels and priorities.
static void the_identity_is_the_scenario_without_its_name(void **unused)
{
    static const struct {
        const char *body;
        bool is_same;
    } others[] = {
        { "{'scenario': {'name': 'other', " DOCUMENT_NEEDED "}, 'label': 'l', 'priority': 1}",
          true },
        { "{'scenario': {" DOCUMENT_NEEDED "}, 'fresh': true}", true },
        { "{'scenario': {" DOCUMENT_NEEDED ", 'macro': {'cell_m': 'auto'}}}", true }, // the default
        { "{'scenario': {" DOCUMENT_NEEDED ", 'macro': {'cell_m': 0.01}}}", false },
        { "{'scenario': {" DOCUMENT_NEEDED ", 'counters': [{'id': 'gate'}]}}", false },
    };
    api_submission first, other;

    assert_int_equal(read_text("{" SCENARIO "}", &first, NULL), BF_OK);
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        assert_int_equal(read_text(others[i].body, &other, NULL), BF_OK);
        assert_true((strcmp(other.identity.bytes, first.identity.bytes) == 0) == others[i].is_same);
        submission_fini(&other);
    }
    submission_fini(&first);
    assert_null(first.identity.bytes);
}

static void faults_have_pointers_of_the_body(void **unused)
{
    static const char *const bad[][2] = {
        { "", "{" },
        { "", "[]" },
        { "/scenario", "{}" },
        { "/scenario", "{'scenario': 1}" },
        { "/scenario/duration_s", "{'scenario': {}}" },
        { "/scenario/macro/cell_m", "{'scenario': " DOCUMENT_WITH("'macro': {'cell_m': 'x'}") "}" },
        { "/scenario/macro/cell_m", "{'scenario': " DOCUMENT_WITH("'macro': {'cell_m': -1}") "}" },
        { "/scenario/initial/positions_m/0",
          "{'scenario': {'duration_s': 1, 'domain': {'x_m': [0, 1], 'y_m': [0, 1]}, 'cargo': {},"
          "'initial': {'positions_m': [[3, 3]]}}}" },
        { "/scenario/name", "{'scenario': {'name': 'a', 'name': 'b'}}" },
        { "/model", "{" SCENARIO ", 'model': 'nano'}" },
        { "/label", "{" SCENARIO ", 'label': 7}" },
        { "/priority", "{" SCENARIO ", 'priority': 101}" },
        { "/priority", "{" SCENARIO ", 'priority': 0.5}" },
        { "/priorities", "{" SCENARIO ", 'priorities': 1}" },
        { "/duration_s", "{'duration_s': 1, " SCENARIO "}" },
    };

    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        api_submission submission;
        api_submission before;
        bf_error err = { 0 };
        memset(&submission, 0x5a, sizeof submission);
        before = submission;
        bf_status status = read_text(bad[k][1], &submission, &err);
        assert_int_equal(status, BF_EINPUT);
        assert_string_equal(err.pointer, bad[k][0]);
        assert_memory_equal(&submission, &before, sizeof submission);
    }
}

#define MODEL(model, members)                                                                      \
    "{'model': '" model "', 'scenario': {'duration_s': 1, 'domain': {'x_m': [0, 1], 'y_m': [0, "   \
    "0.6]}, 'initial': {'positions_m': [[0.5, 0.3], [0.6, 0.3]]}, " members "}}"
#define MICRO(members) MODEL("micro", members)
#define MACRO(members) MODEL("macro", members)
#define PLATE          "'obstacles': [{'id': 'bar', 'from_m': [0.6, 0.1], 'to_m': [0.6, 0.5]}]"

// What only one of the models objects to is found when a run is submitted, not when it starts.
static void the_model_has_its_own_faults(void **unused)
{
    static const char *const bad[][3] = {
        { "/scenario/micro/step_s", MICRO("'cargo': {}, 'micro': {'step_s': 0.5}"),
          "the largest stable one is" },
        { "/scenario/micro/step_s",
          MICRO("'cargo': {'mass_kg': 1e-9}, 'micro': {'integrator': 'verlet'}"), "unstable" },
        { "/scenario/micro/step_s", MICRO("'cargo': {}, 'micro': {'step_s': 1e-12}"), "limit" },
        { "/scenario/output/snapshot_every_s",
          "{'model': 'micro', 'scenario': {'duration_s': 10, 'domain': {'x_m': [0, 40], 'y_m': "
          "[0, 25]}, 'cargo': {}, 'macro': {'cell_m': 1}, 'output': {'snapshot_every_s': 0.001},"
          "'initial': {'hexagonal': {'rows': 500, 'columns': 500, 'first_m': [1, 1], 'spacing_m':"
          "0.025}}}}",
          "bytes of parts" },
        { "/scenario/initial/positions_m/1", MICRO("'cargo': {}, " PLATE), "'bar'" },
        { "/scenario/macro/step_s", MACRO("'cargo': {}, 'macro': {'step_s': 0.1}"), "unstable" },
    };

    for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
        api_submission submission = { 0 };
        bf_error err = { 0 };
        bf_status status = read_text(bad[k][1], &submission, &err);
        assert_true(status == BF_EINPUT || status == BF_ELIMIT);
        assert_string_equal(err.pointer, bad[k][0]);
        assert_non_null(strstr(err.text, bad[k][2]));
    }
}

// The same scenarios are none of the other model's business.
static void another_model_does_not_mind(void **unused)
{
    static const char *const good[] = {
        MACRO("'cargo': {}, 'micro': {'step_s': 0.5}, " PLATE),
        MICRO("'cargo': {}, 'macro': {'step_s': 0.1}"),
    };

    for (size_t k = 0; k < sizeof good / sizeof *good; k++) {
        api_submission submission;
        assert_int_equal(read_text(good[k], &submission, NULL), BF_OK);
        submission_fini(&submission);
    }
}

static void a_long_label_is_refused(void **unused)
{
    char text[800];
    char label[API_LABEL_SIZE + 1];
    api_submission submission;
    bf_error err = { 0 };

    memset(label, 'l', sizeof label);
    label[API_LABEL_SIZE] = '\0';
    snprintf(text, sizeof text, "{" SCENARIO ", 'label': '%s'}", label);
    assert_int_equal(read_text(text, &submission, &err), BF_ELIMIT);
    assert_string_equal(err.pointer, "/label");
}

static void a_model_that_is_not_built_in_is_refused(void **unused)
{
    for (unsigned model = 0; model < RUN_MODEL_COUNT; model++) {
        char text[600];
        api_submission submission;
        bf_error err = { 0 };
        snprintf(text, sizeof text, "{" SCENARIO ", 'model': '%s'}", run_model_words[model]);
        bf_status status = read_text(text, &submission, &err);
        if (run_model_is_available((run_model)model)) {
            assert_int_equal(status, BF_OK);
            assert_int_equal(submission.model, model);
            submission_fini(&submission);
        } else {
            assert_int_equal(status, BF_EINPUT);
            assert_string_equal(err.pointer, "/model");
        }
    }
}

// What POST /v1/validate answers.
static const prediction_speed same_speed = { .factors = { 1, 1, 1, 1, 1, 1, 1 } };

static void validate_with_parts(const char *text, size_t parts_max, bf_buffer *out)
{
    api_submission submission;

    assert_int_equal(read_text(text, &submission, NULL), BF_OK);
    assert_int_equal(submission_validation(&submission, NULL, parts_max, out, NULL), BF_OK);
    submission_fini(&submission);
}

static void validate(const char *text, bf_buffer *out)
{
    validate_with_parts(text, 0, out);
}

static void assert_begins(const bf_buffer *text, const char *expected)
{
    if (strncmp(text->bytes, expected, strlen(expected)) != 0)
        fail_msg("%.600s", text->bytes);
}

// A box of 20 x 20 mm is 28.3 mm across; the opening of 0.1 m is 3.54 of that.
#define DEFLECTED                                                                                  \
    "'scenario': {'duration_s': 1, 'domain': {'x_m': [0, 1], 'y_m': [0, 0.6]}, "                   \
    "'obstacles': [{'from_m': [0.461325, 0], 'to_m': [0.75, 0.5]}], "                              \
    "'cargo': {'shape': {'type': 'box', 'length_m': 0.02, 'width_m': 0.02}}, 'initial': "          \
    "{'hexagonal': {'rows': 5, 'columns': 5, 'first_m': [0.1, 0.1], 'spacing_m': 0.05}}, "         \
    "'macro': {'closure': 'dispersive', 'cell_m': 0.005}}"

static void a_validation_says_what_the_results_would_be_doubted_for(void **unused)
{
    bf_buffer free_belt = { 0 }, macro = { 0 }, micro = { 0 };

    validate("{" SCENARIO "}", &free_belt);
    assert_begins(
        &free_belt,
        "{\"valid\":true,\"model\":\"macro\","
        "\"cell_m\":[0.008,0.008],\"shape\":[75,125],\"warnings\":[],\"warning_"
        "details\":[],\"predicted_s\":null,\"validity\":{"
        "\"closure\":\"congested\",\"compared\":true,\"outside\":[],\"never_compared\":[]},"
        "\"resolved\":{\"name\":\"N\",");
    validate("{" DEFLECTED "}", &macro);
#define TITLE "The share of parts that are no cylinders is 100 %"
#define MEANING                                                                                    \
    "How well the density model predicts this was not measured: solve it with the microscopic "    \
    "model, too."
    assert_begins(
        &macro,
        "{\"valid\":true,\"model\":\"macro\",\"cell_m\":[0.005,0.005],\"shape\":[120,200],"
        "\"warnings\":[\"" TITLE ". " MEANING "\"],"
        "\"warning_details\":[{\"title\":\"" TITLE "\",\"meaning\":\"" MEANING "\","
        "\"detail\":\"The density model was compared with moving parts for cylinders alone.\","
        "\"pointer\":\"/cargo/shape\"}],"
        "\"predicted_s\":null,\"validity\":{\"closure\":\"dispersive\",\"compared\":false,"
        "\"outside\":[{\"what\":\"shape\","
        "\"value\":100,\"unit\":\"%\",\"min\":null,\"max\":0,"
        "\"pointer\":\"/cargo/shape\",\"detail\":\"" TITLE
        "; the model was compared with moving parts for cylinders alone.\"}],"
        "\"never_compared\":[]},\"resolved\":{");
    validate("{" DEFLECTED ", 'model': 'micro'}", &micro);
    const char *of = strstr(micro.bytes, "\"validity\":{\"compared\":false,\"outside\":[{\"what\":"
                                         "\"opening\"");
    assert_non_null(of);
    assert_non_null(strstr(of,
                           "\"never_compared\":[{\"what\":\"shape\",\"value\":100,\"unit\":\"%\","
                           "\"min\":null,\"max\":null,\"pointer\":\"/cargo/shape\","
                           "\"detail\":\"" TITLE "; the model was never compared"));
    buffer_fini(&free_belt);
    buffer_fini(&macro);
    buffer_fini(&micro);
}

#define FIVE                                                                                       \
    "'model': 'micro', 'scenario': {'duration_s': 1, 'domain': {'x_m': [0, 1], 'y_m': [0, 0.6]}, " \
    "'cargo': {}, 'initial': {'hexagonal': {'rows': 1, 'columns': 5, 'first_m': [0.125, 0.25], "   \
    "'spacing_m': 0.125}}}"
#define PART(x) "{\"x_m\":" x ",\"y_m\":0.25,\"heading_rad\":0,\"kind\":0}"

static void assert_parts(size_t parts_max, const char *expected)
{
    bf_buffer out = { 0 };

    validate_with_parts("{" FIVE "}", parts_max, &out);
    if (strstr(out.bytes, expected) == NULL)
        fail_msg("%.600s", out.bytes);
    buffer_fini(&out);
}

static void a_validation_lists_as_many_parts_as_are_asked_for(void **unused)
{
    assert_parts(0, "\"never_compared\":[]},\"resolved\":{");
    assert_parts(1, "\"parts\":[" PART("0.125") "],\"resolved\":{");
    assert_parts(2, "\"parts\":[" PART("0.125") "," PART("0.375") "],\"resolved\":{");
    const char *all = "\"parts\":[" PART("0.125") "," PART("0.25") "," PART("0.375") "," PART(
        "0.5") "," PART("0.625") "],\"resolved\":{";
    assert_parts(5, all);
    assert_parts(SUBMISSION_PARTS_MAX, all);
}

static void a_validation_without_memory_is_reported(void **unused)
{
    bf_status status = BF_ENOMEM;
    api_submission submission;

    assert_int_equal(read_text("{" DEFLECTED "}", &submission, NULL), BF_OK);
    for (size_t n = 1; status != BF_OK; n++) {
        bf_buffer out = { 0 };
        memory_plan_fault(n, 0);
        status = submission_validation(&submission, &same_speed, 5, &out, NULL);
        memory_plan_fault(0, 0);
        if (status != BF_OK)
            assert_int_equal(status, BF_ENOMEM);
        assert_true(n < 2000);
        buffer_fini(&out);
    }
    submission_fini(&submission);
}

static void no_memory_is_reported(void **unused)
{
    bf_status status = BF_ENOMEM;

    for (size_t n = 1; status != BF_OK; n++) {
        bf_buffer document = document_quote("{" SCENARIO ", 'model': 'micro'}");
        api_submission submission;
        faults.n = 0;
        memory_plan_fault(n, 0);
        status = submission_read(document.bytes, document.n, NULL, &submission, &faults, NULL);
        memory_plan_fault(0, 0);
        if (status == BF_OK)
            submission_fini(&submission);
        else
            assert_int_equal(status, BF_ENOMEM);
        assert_true(n < 2000);
        buffer_fini(&document);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_scenario_alone_suffices),
        cmocka_unit_test(all_members_are_taken_over),
        cmocka_unit_test(a_number_of_replications_is_refused_with_its_range),
        cmocka_unit_test(the_document_is_resolved),
        cmocka_unit_test(the_identity_is_the_scenario_without_its_name),
        cmocka_unit_test(faults_have_pointers_of_the_body),
        cmocka_unit_test(the_model_has_its_own_faults),
        cmocka_unit_test(another_model_does_not_mind),
        cmocka_unit_test(a_long_label_is_refused),
        cmocka_unit_test(a_model_that_is_not_built_in_is_refused),
        cmocka_unit_test(a_validation_says_what_the_results_would_be_doubted_for),
        cmocka_unit_test(a_validation_lists_as_many_parts_as_are_asked_for),
        cmocka_unit_test(a_validation_without_memory_is_reported),
        cmocka_unit_test(no_memory_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
