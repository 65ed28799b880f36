// Trials of studies as JSON and CSV, and the names of what they have.

#include "api/study/study_trial.h"

#include "core/base/memory.h"
#include "tests/unit/api/helper_document.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <string.h>

static study_document document;
static study *made;
static study_columns columns;

#define SCENARIO                                                                                   \
    DOCUMENT_WITH("'substream': 3, 'obstacles': [{'end_m': [0.75, 0.5], 'angle_deg': 60, "         \
                  "'length_m': 0.5}]")
static const char study_text[] =
    "{'base': {'scenario': " SCENARIO "}, 'priority': -7, 'method': {'type': 'grid'},"
    "'parameters': [{'pointer': '/obstacles/0/angle_deg', 'range': [30, 90]}],"
    "'objectives': [{'figure': 'throughput_per_h'}, {'figure': 'jam.count'}]}";

static int begin(void **state)
{
    bf_buffer text = document_quote(study_text);
    bf_faults faults = { 0 };

    assert_int_equal(study_document_read(text.bytes, text.n, &document, &faults, NULL), BF_OK);
    const study_definition def = study_document_definition(&document);
    assert_int_equal(study_create(&def, &made, NULL), BF_OK);
    assert_int_equal(study_advance(made, NULL), BF_OK);
    study_columns_of(&document, &columns);
    buffer_fini(&text);
    return 0;
}

static int end(void **state)
{
    study_destroy(made);
    study_document_fini(&document);
    return 0;
}

// The middle of five steps from 30 to 90.
static api_trial third(void)
{
    api_trial trial;

    study_trial_of(&document, made, 2, &trial);
    return trial;
}

static void a_trial_has_the_numbers_of_its_point(void **state)
{
    const api_trial trial = third();
    assert_int_equal(trial.number, 2);
    assert_int_equal(trial.point, 2);
    assert_int_equal(trial.model, RUN_MACRO);
    assert_int_equal(trial.substream, 3);
    assert_int_equal(trial.state, API_TRIAL_QUEUED);
    assert_int_equal(trial.n_parameters, 1);
    assert_true(trial.parameters[0] == 60.0);
    assert_int_equal(trial.n_values, 2);
    assert_true(isnan(trial.values[0]) && isnan(trial.values[1]));
    assert_int_equal(document.priority, -7);
}

static void columns_read_back(void **state)
{
    static const char *const damaged[] = {
        "",
        "{}",
        "{\"parameters\":[\"/p\"],\"values\":[]}",
        "{\"parameters\":[\"/p\"],\"values\":[7]}",
        "{\"parameters\":[\"/p\"],\"values\":\"v\"}",
        "{\"parameters\":[\"1\",\"2\",\"3\",\"4\",\"5\",\"6\",\"7\",\"8\",\"9\",\"10\",\"11\","
        "\"12\","
        "\"13\",\"14\",\"15\",\"16\",\"17\",\"18\",\"19\",\"20\",\"21\"],\"values\":[\"v\"]}",
    };
    bf_buffer text = { 0 };
    study_columns read;
    bf_error err;
    assert_int_equal(study_columns_write(&columns, &text, NULL), BF_OK);
    assert_string_equal(text.bytes, "{\"parameters\":[\"/obstacles/0/angle_deg\"],"
                                    "\"values\":[\"throughput_per_h\",\"jam.count\"]}");
    assert_int_equal(study_columns_read(text.bytes, text.n, &read, NULL), BF_OK);
    assert_int_equal(read.n_parameters, 1);
    assert_string_equal(read.parameters[0], "/obstacles/0/angle_deg");
    assert_int_equal(read.n_values, 2);
    assert_string_equal(read.values[1], "jam.count");
    for (size_t k = 0; k < sizeof damaged / sizeof *damaged; k++)
        assert_int_equal(study_columns_read(damaged[k], strlen(damaged[k]), &read, &err),
                         BF_ECORRUPT);
    memory_plan_fault(1, 1);
    assert_int_equal(study_columns_read(text.bytes, text.n, &read, &err), BF_ENOMEM);
    memory_plan_fault(0, 0);
    buffer_fini(&text);
}

static bf_buffer as_json(const api_trial *trial)
{
    const study_trial_item item = { .columns = &columns, .trial = *trial };
    bf_buffer out = { 0 };
    json_out w = json_out_to(&out);

    members_write(&w, &study_trial_members, &item);
    assert_int_equal(json_out_status(&w, NULL), BF_OK);
    return out;
}

static void what_a_trial_does_not_have_is_missing(void **state)
{
    api_trial trial = third();
    bf_buffer text = as_json(&trial);
    assert_string_equal(text.bytes,
                        "{\"trial\":2,\"point\":2,\"model\":\"macro\",\"substream\":3,"
                        "\"status\":\"queued\",\"parameters\":{\"/obstacles/0/angle_deg\":60},"
                        "\"values\":{}}");
    buffer_fini(&text);
    trial.state = API_TRIAL_FAILED;
    trial.values[1] = 2.0;
    strcpy(trial.run, "r");
    trial.fault = (bf_error){ .code = BF_ELIMIT, .pointer = "/p", .text = "too much" };
    text = as_json(&trial);
    assert_non_null(strstr(text.bytes, "\"values\":{\"jam.count\":2},\"run\":\"r\",\"error\":"
                                       "{\"code\":\"limit\",\"pointer\":\"/p\",\"detail\":"
                                       "\"too much\"}}"));
    buffer_fini(&text);
}

static void lines_read_back(void **state)
{
    api_trial trial = third();
    double values[STUDY_VALUES];
    bf_buffer line = { 0 };
    size_t number = 0;
    assert_int_equal(study_trial_csv_header(&columns, &line, NULL), BF_OK);
    assert_string_equal(line.bytes, "trial,point,model,substream,/obstacles/0/angle_deg,state,"
                                    "throughput_per_h,jam.count,fault\n");
    line.n = 0;
    trial.state = API_TRIAL_FAILED;
    trial.values[0] = 1.0 / 3.0;
    trial.fault = (bf_error){ .code = BF_EINPUT, .pointer = "/a", .text = "is \"b\"" };
    assert_int_equal(study_trial_csv_line(&trial, &line, NULL), BF_OK);
    assert_string_equal(line.bytes,
                        "2,2,macro,3,60,failed,0.3333333333333333,,\"/a: is \"\"b\"\"\"\n");
    assert_true(study_trial_csv_read(&columns, line.bytes, line.n, &number, values));
    assert_int_equal(number, 2);
    assert_true(values[0] == 1.0 / 3.0 && isnan(values[1]));
    assert_false(study_trial_csv_read(&columns, line.bytes, 20, &number, values));
    assert_false(
        study_trial_csv_read(&columns, "x,2,macro,3,60,failed,1,2,\n", 27, &number, values));
    assert_false(
        study_trial_csv_read(&columns, "-1,2,macro,3,60,failed,1,2,\n", 28, &number, values));
    assert_false(
        study_trial_csv_read(&columns, "2,2,macro,3,60,failed,1x,2,\n", 28, &number, values));
    buffer_fini(&line);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_trial_has_the_numbers_of_its_point),
        cmocka_unit_test(columns_read_back),
        cmocka_unit_test(what_a_trial_does_not_have_is_missing),
        cmocka_unit_test(lines_read_back),
    };
    return cmocka_run_group_tests(tests, begin, end);
}
