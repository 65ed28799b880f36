// Runs and measurements against each other.

#include "core/base/memory.h"
#include "tests/unit/api/helper_ask.h"
#include "tests/unit/api/helper_document.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

// Ids of the first two measurements that a test adds.
#define MEASURED_1 "0190a0b0-0000-7000-9000-000000000001"
#define MEASURED_2 "0190a0b0-0000-7000-9000-000000000002"

static double number_at(const json_t *object, const char *key)
{
    const json_t *value = json_object_get(object, key);

    assert_true(json_is_number(value));
    return json_number_value(value);
}

static const char *text_at(const json_t *object, const char *key)
{
    return json_string_value(json_object_get(object, key));
}

// The first pointer in the errors of a problem.
static void assert_pointer(const char *pointer)
{
    json_t *root = helper_json(&ask_response);
    const json_t *first = json_array_get(json_object_get(root, "errors"), 0);

    assert_non_null(first);
    assert_string_equal(text_at(first, "pointer"), pointer);
    json_decref(root);
}

// Curve b lies 1 below a throughout; snapshot 0 of both is the same, of snapshot 1 one of six cells
// differs by 1.5.
static void two_runs_are_compared_in_curve_and_density(void **state)
{
    helper_run *a, *b;

    a = ask_add_run(RUN_SUCCEEDED);
    b = ask_add_run(RUN_SUCCEEDED);
    b->values[0] -= 1.0;
    b->values[2] -= 1.0;
    b->rho[1][0] = a->rho[1][0] + 1.5F;
    ask_get("/v1/compare", "a=" ID_1 "&b=" ID_2, NULL, 200);
    json_t *root = helper_json(&ask_response);
    json_t *density = json_object_get(root, "density");
    json_t *items = json_object_get(density, "snapshots");
    assert_true(json_is_object(json_object_get(root, "curve")));
    assert_string_equal(json_string_value(json_object_get(json_object_get(root, "a"), "column")),
                        "upstream");
    assert_true(json_is_true(json_object_get(density, "same_grid")));
    assert_int_equal(json_array_size(items), 2);
    assert_float_equal(
        (float)json_number_value(json_object_get(json_array_get(items, 0), "mean_abs")), 0.0F, 0);
    assert_float_equal(
        (float)json_number_value(json_object_get(json_array_get(items, 1), "mean_abs")), 0.25F,
        1e-6F);
    json_decref(root);
}

// One line by both models, 10 % apart, and without what takes time.
static void two_runs_are_told_apart_in_a_sentence(void **state)
{
    bf_buffer scenario = document_resolve("{" DOCUMENT_NEEDED "}");
    helper_run *a = ask_add_run(RUN_SUCCEEDED), *b = ask_add_run(RUN_SUCCEEDED);

    a->scenario = b->scenario = scenario.bytes;
    b->record.model = RUN_MICRO;
    a->figures =
        "{\"sustained_throughput_per_h\":1100,\"counters\":[{\"id\":\"c\",\"flow_per_h\":7}]}";
    b->figures =
        "{\"sustained_throughput_per_h\":1000,\"counters\":[{\"id\":\"c\",\"flow_per_h\":9}]}";
    snprintf(a->record.figures, sizeof a->record.figures, "{\"sustained_throughput_per_h\":1100}");
    snprintf(b->record.figures, sizeof b->record.figures, "{\"sustained_throughput_per_h\":1000}");
    ask_get("/v1/compare", "a=" ID_1 "&b=" ID_2 "&densities=0", NULL, 200);
    json_t *root = helper_json(&ask_response);
    const json_t *said = json_array_get(json_object_get(root, "verdicts"), 0);
    assert_string_equal(text_at(said, "kind"), "models_disagree");
    assert_non_null(strstr(text_at(said, "text"), "1,100 against 1,000 parts/h"));
    assert_string_equal(text_at(json_array_get(json_object_get(root, "verdicts"), 1), "kind"),
                        "flows_differ");
    assert_true(ask_body_has("\"flows\":[{\"of\":\"counter\",\"id\":\"c\",\"flow_a_per_h\":7,"));
    assert_true(json_is_null(json_object_get(root, "density")));
    json_decref(root);
    ask_get("/v1/compare", "runs=" ID_1 "," ID_2 "&densities=2", NULL, 400);
    a->scenario = "{}"; // of a version that had other documents
    ask_get("/v1/compare", "a=" ID_1 "&b=" ID_2, NULL, 200);
    assert_true(ask_body_has("\"verdicts\":[]"));
    buffer_fini(&scenario);
}

static void densities_on_different_grids_are_not_compared(void **state)
{
    ask_add_run(RUN_SUCCEEDED);
    ask_add_run(RUN_SUCCEEDED)->grid.d1 = 0.25;
    ask_get("/v1/compare", "a=" ID_1 "&b=" ID_2 "&column=left_domain", NULL, 200);
    assert_true(ask_body_has("\"column\":\"left_domain\""));
    assert_true(ask_body_has("\"same_grid\":false,\"n_common\":2,\"snapshots\":[]"));
}

static void only_snapshots_of_common_times_are_compared(void **state)
{
    helper_run *b;

    ask_add_run(RUN_SUCCEEDED);
    b = ask_add_run(RUN_SUCCEEDED);
    b->snapshots[0].t = 0.05;
    ask_get("/v1/compare", "a=" ID_1 "&b=" ID_2, NULL, 200);
    assert_true(ask_body_has("\"n_common\":1,\"snapshots\":[{\"t_s\":0.1,\"a\":1,\"b\":1,"));
}

// Of 401 common snapshots 200 may be compared: every third (0, 3, ..., 399: 134 of them), and the last.
static void many_snapshots_are_thinned_out_but_for_the_last(void **state)
{
    helper_run *a = ask_add_run(RUN_SUCCEEDED);

    for (uint64_t i = 0; i < 401; i++)
        a->snapshots[i] = (api_snapshot){ .index = i, .t = 0.1 * (double)i };
    a->record.n_snapshots = 401;
    ask_get("/v1/compare", "a=" ID_1 "&b=" ID_1, NULL, 200);
    json_t *root = helper_json(&ask_response);
    json_t *density = json_object_get(root, "density");
    json_t *items = json_object_get(density, "snapshots");
    assert_int_equal(json_integer_value(json_object_get(density, "n_common")), 401);
    assert_int_equal(json_array_size(items), 135);
    assert_int_equal(json_integer_value(json_object_get(json_array_get(items, 1), "a")), 3);
    assert_int_equal(json_integer_value(json_object_get(json_array_get(items, 134), "a")), 400);
    json_decref(root);
}

static void a_comparison_needs_two_runs_with_samples_and_the_column(void **state)
{
    ask_add_run(RUN_SUCCEEDED);
    ask_add_run(RUN_QUEUED)->record.n_samples = 0;
    ask_get("/v1/compare", NULL, NULL, 400);
    ask_get("/v1/compare", "a=" ID_1, NULL, 400);
    ask_get("/v1/compare", "a=" ID_1 "&b=" ID_3, NULL, 404);
    assert_pointer("/b");
    ask_get("/v1/compare", "a=x&b=" ID_1, NULL, 404);
    assert_pointer("/a");
    ask_get("/v1/compare", "a=" ID_1 "&b=" ID_2, NULL, 409);
    assert_pointer("/b");
    ask_get("/v1/compare", "a=" ID_1 "&b=" ID_1 "&column=upstreams", NULL, 422);
    assert_pointer("/a");
    assert_true(ask_body_has("it has upstream,left_domain"));
    ask_get("/v1/compare", "a=" ID_1 "&b=" ID_1 "&column=", NULL, 422);
}

static void curves_without_a_common_time_cannot_be_compared(void **state)
{
    helper_run *b;

    ask_add_run(RUN_SUCCEEDED);
    b = ask_add_run(RUN_SUCCEEDED);
    b->t[0] = 5.0;
    b->t[1] = 6.0;
    ask_get("/v1/compare", "a=" ID_1 "&b=" ID_2, NULL, 422);
    assert_pointer("/b");
    ask_get("/v1/compare", "runs=" ID_1 "," ID_2, NULL, 422);
    assert_pointer("/runs/1");
}

// On 3 x 2 cells of 0.5 m x 0.25 m all mass of a lies in the first column, that of b in the last:
// carried by two cells. a has it in both rows, b in the upper one, with half the mass.
static void densities_are_told_by_their_distance_and_their_way(void **state)
{
    static const float of_a[] = { 1, 0, 0, 1, 0, 0 }, of_b[] = { 0, 0, 0, 0, 0, 1 };
    helper_run *a, *b;

    a = ask_add_run(RUN_SUCCEEDED);
    b = ask_add_run(RUN_SUCCEEDED);
    for (int i = 0; i < 2; i++) {
        memcpy(a->rho[i], of_a, sizeof of_a);
        memcpy(b->rho[i], of_b, sizeof of_b);
    }
    b->snapshots[0].mass = 2.5;
    ask_get("/v1/compare", "a=" ID_1 "&b=" ID_2, NULL, 200);
    json_t *root = helper_json(&ask_response);
    json_t *density = json_object_get(root, "density");
    json_t *first = json_array_get(json_object_get(density, "snapshots"), 0);
    json_t *mean = json_object_get(density, "mean");
    assert_true(number_at(first, "l1") == 1.0);
    assert_true(number_at(first, "mean_abs") == 0.5);
    assert_true(fabs(number_at(first, "emd_x_m") - 1.0) < 1e-12);
    assert_true(fabs(number_at(first, "emd_y_m") - 0.125) < 1e-12);
    assert_true(number_at(first, "mass_a") == 6.0 && number_at(first, "mass_b") == 2.5);
    assert_true(fabs(number_at(mean, "emd_x_m") - 1.0) < 1e-12);
    assert_true(number_at(mean, "l1") == 1.0);
    json_decref(root);
}

// What cannot be known is null: an empty belt lies nowhere, and nothing was compared on other grids.
static void an_empty_belt_and_other_grids_have_no_means(void **state)
{
    helper_run *b;

    ask_add_run(RUN_SUCCEEDED);
    b = ask_add_run(RUN_SUCCEEDED);
    memset(b->rho, 0, sizeof b->rho);
    ask_get("/v1/compare", "a=" ID_1 "&b=" ID_2, NULL, 200);
    assert_true(ask_body_has("\"l1\":1,\"emd_x_m\":null,\"emd_y_m\":null}}"));
    b->grid.n1 = 2;
    ask_get("/v1/compare", "a=" ID_1 "&b=" ID_2, NULL, 200);
    assert_true(ask_body_has("\"mean\":{\"mean_abs\":null,\"l1\":null,"));
}

// Three curves of slopes -10, -20 and -30 parts/s from 192: against the second one.
static void several_runs_are_compared_with_one_of_them(void **state)
{
    for (int i = 1; i <= 3; i++) {
        helper_run *item = ask_add_run(RUN_SUCCEEDED);
        item->values[2] = 192.0 - (double)i;
        snprintf(item->record.label, sizeof item->record.label, "slope %d", i);
    }
    ask_get("/v1/compare", "runs=" ID_1 "," ID_2 "," ID_3 "&reference=" ID_2, NULL, 200);
    json_t *root = helper_json(&ask_response);
    json_t *entries = json_object_get(root, "entries");
    json_t *pairs = json_object_get(root, "pairs");
    assert_string_equal(text_at(root, "reference"), ID_2);
    assert_int_equal(json_array_size(entries), 3);
    assert_int_equal(json_array_size(pairs), 2);
    for (size_t i = 0; i < 3; i++) {
        const json_t *item = json_array_get(entries, i);
        assert_string_equal(text_at(item, "kind"), "run");
        assert_string_equal(text_at(item, "column"), "upstream");
        assert_string_equal(text_at(item, "model"), "macro");
        assert_int_equal(text_at(item, "label")[6], '1' + (char)i);
        assert_true(fabs(number_at(item, "throughput_per_s") - 10.0 * (double)(i + 1)) < 1e-9);
        assert_true(json_is_null(json_object_get(item, "drain_time_s")));
    }
    for (size_t i = 0; i < 2; i++) {
        const json_t *pair = json_array_get(pairs, i);
        const json_t *curve = json_object_get(pair, "curve");
        assert_string_equal(text_at(pair, "a"), ID_2);
        assert_string_equal(text_at(pair, "b"), i == 0 ? ID_1 : ID_3);
        assert_true(fabs(number_at(curve, "l1") - 0.5) < 1e-12); // a gap of 0 to 1 part
        assert_true(fabs(number_at(curve, "throughput_gap_per_s") - (i == 0 ? -10.0 : 10.0)) <
                    1e-9);
        assert_true(json_is_object(json_object_get(pair, "density")));
    }
    json_decref(root);
}

static void the_first_one_is_the_reference_unless_another_is_named(void **state)
{
    ask_add_run(RUN_SUCCEEDED);
    ask_add_run(RUN_SUCCEEDED);
    ask_get("/v1/compare", "runs=" ID_2 "," ID_1, NULL, 200);
    assert_true(ask_body_has("{\"reference\":\"" ID_2 "\""));
    ask_get("/v1/compare", "runs=" ID_1 "," ID_2 "&reference=" ID_3, NULL, 400);
    assert_pointer("/reference");
}

// The measured curve lies 0, then 0.5 below that of the run: a mean gap of 0.25.
static void a_measurement_stands_where_a_run_can(void **state)
{
    helper_measurement *m;

    ask_add_run(RUN_SUCCEEDED);
    m = helper_add_measurement(&ask_daemon, "upstream");
    memcpy(m->about.label, "camera", 7);
    ask_get("/v1/compare", "a=" ID_1 "&b=" MEASURED_1, NULL, 200);
    json_t *root = helper_json(&ask_response);
    json_t *b = json_object_get(root, "b");
    assert_true(fabs(number_at(json_object_get(root, "curve"), "l1") - 0.25) < 1e-12);
    assert_true(json_is_null(json_object_get(root, "density")));
    assert_string_equal(text_at(b, "kind"), "measurement");
    assert_string_equal(text_at(b, "label"), "camera");
    assert_true(json_is_null(json_object_get(b, "model")));
    assert_true(json_is_null(json_object_get(b, "status")));
    json_decref(root);
    ask_get("/v1/compare", "runs=" MEASURED_1 "," ID_1, NULL, 200);
    assert_true(ask_body_has("\"density\":null"));
}

// The column is the first one that all have: here the second one of the run.
static void the_column_follows_from_what_all_have(void **state)
{
    ask_add_run(RUN_SUCCEEDED);
    helper_add_measurement(&ask_daemon, "left_domain");
    helper_add_measurement(&ask_daemon, "gate");
    ask_get("/v1/compare", "a=" ID_1 "&b=" MEASURED_1, NULL, 200);
    assert_true(ask_body_has("\"column\":\"left_domain\""));
    ask_get("/v1/compare", "runs=" ID_1 "," MEASURED_1 "," MEASURED_2, NULL, 422);
    assert_pointer("/runs/2");
    assert_true(ask_body_has("no column in common"));
    ask_get("/v1/compare", "a=" MEASURED_2 "&b=" ID_1 "&column=gate", NULL, 422);
    assert_pointer("/b");
}

static void what_is_compared_is_told_in_one_way_and_within_limits(void **state)
{
    static const char eight[] =
        "runs=" ID_1 "," ID_2 "," ID_3 ",0190a0b0-0000-7000-8000-000000000004"
        ",0190a0b0-0000-7000-8000-000000000005"
        ",0190a0b0-0000-7000-8000-000000000006"
        ",0190a0b0-0000-7000-8000-000000000007"
        ",0190a0b0-0000-7000-8000-000000000008";
    char nine[sizeof eight + 40];

    for (int i = 0; i < 8; i++)
        ask_add_run(RUN_SUCCEEDED);
    ask_get("/v1/compare", eight, NULL, 200);
    snprintf(nine, sizeof nine, "%s,0190a0b0-0000-7000-8000-000000000009", eight);
    ask_get("/v1/compare", nine, NULL, 400);
    ask_get("/v1/compare", "runs=" ID_1, NULL, 400);
    ask_get("/v1/compare", "runs=", NULL, 400);
    ask_get("/v1/compare", "reference=" ID_1, NULL, 400);
    ask_get("/v1/compare", "runs=" ID_1 "," ID_1, NULL, 400);
    ask_get("/v1/compare", "runs=" ID_1 "," ID_2 "&a=" ID_1, NULL, 400);
    ask_get("/v1/compare", "a=" ID_1 "&b=" ID_2 "&reference=" ID_1, NULL, 400);
    ask_get("/v1/compare", "runs=" ID_1 ",nothing", NULL, 404);
    assert_pointer("/runs/1");
    ask_get("/v1/compare", "runs=" ID_1 "," ID_2 "," MEASURED_1, NULL, 404);
    assert_pointer("/runs/2");
}

static void a_comparison_that_is_known_is_told_so(void **state)
{
    char header[160];

    ask_add_run(RUN_SUCCEEDED);
    ask_add_run(RUN_SUCCEEDED);
    ask_get("/v1/compare", "runs=" ID_1 "," ID_2, NULL, 200);
    snprintf(header, sizeof header, "If-None-Match: %s\n", helper_header(&ask_response, "ETag"));
    ask_get("/v1/compare", "runs=" ID_1 "," ID_2, header, 304);
    ask_get("/v1/compare", "runs=" ID_2 "," ID_1, header, 200);
}

static void each_pair_is_thinned_out_by_itself(void **state)
{
    for (int i = 0; i < 3; i++) {
        helper_run *item = ask_add_run(RUN_SUCCEEDED);
        item->record.n_snapshots = 401;
        for (uint64_t k = 0; k < 401; k++)
            item->snapshots[k] = (api_snapshot){ .index = k, .t = 0.1 * (double)k };
    }
    ask_get("/v1/compare", "runs=" ID_1 "," ID_2 "," ID_3, NULL, 200);
    json_t *root = helper_json(&ask_response);
    for (size_t i = 0; i < 2; i++) {
        json_t *pair = json_array_get(json_object_get(root, "pairs"), i);
        json_t *density = json_object_get(pair, "density");
        assert_int_equal(json_array_size(json_object_get(density, "snapshots")), 135);
    }
    json_decref(root);
}

static void without_memory_a_comparison_is_refused_whole(void **state)
{
    ask_add_run(RUN_SUCCEEDED);
    ask_add_run(RUN_SUCCEEDED);
    helper_add_measurement(&ask_daemon, "upstream");
    for (size_t n = 1; ask_response.status != 200; n++) {
        api_response_fini(&ask_response);
        memory_plan_fault(n, 0);
        helper_request(&ask_daemon, "GET", "/v1/compare", "runs=" ID_1 "," ID_2 "," MEASURED_1,
                       NULL, NULL, &ask_response);
        memory_plan_fault(0, 0);
        assert_true(ask_response.status == 200 || ask_response.status == 503);
        assert_true(n < 1000);
    }
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        ASK_TEST(two_runs_are_compared_in_curve_and_density),
        ASK_TEST(two_runs_are_told_apart_in_a_sentence),
        ASK_TEST(densities_on_different_grids_are_not_compared),
        ASK_TEST(only_snapshots_of_common_times_are_compared),
        ASK_TEST(many_snapshots_are_thinned_out_but_for_the_last),
        ASK_TEST(a_comparison_needs_two_runs_with_samples_and_the_column),
        ASK_TEST(curves_without_a_common_time_cannot_be_compared),
        ASK_TEST(densities_are_told_by_their_distance_and_their_way),
        ASK_TEST(an_empty_belt_and_other_grids_have_no_means),
        ASK_TEST(several_runs_are_compared_with_one_of_them),
        ASK_TEST(the_first_one_is_the_reference_unless_another_is_named),
        ASK_TEST(a_measurement_stands_where_a_run_can),
        ASK_TEST(the_column_follows_from_what_all_have),
        ASK_TEST(what_is_compared_is_told_in_one_way_and_within_limits),
        ASK_TEST(a_comparison_that_is_known_is_told_so),
        ASK_TEST(each_pair_is_thinned_out_by_itself),
        ASK_TEST(without_memory_a_comparison_is_refused_whole),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
