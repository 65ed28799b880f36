// Two runs against each other.

#include "tests/unit/api/helper_ask.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

// Curve b lies 1 below a throughout; snapshot 0 of both is the same, of snapshot 1 one of six cells
// differs by 1.5.
static void two_runs_are_compared_in_curve_and_density(void **state)
{
    helper_run *a, *b;

    (void)state;
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

static void densities_on_different_grids_are_not_compared(void **state)
{
    (void)state;
    ask_add_run(RUN_SUCCEEDED);
    ask_add_run(RUN_SUCCEEDED)->grid.d1 = 0.25;
    ask_get("/v1/compare", "a=" ID_1 "&b=" ID_2 "&column=left_domain", NULL, 200);
    assert_true(ask_body_has("\"column\":\"left_domain\""));
    assert_true(ask_body_has("\"same_grid\":false,\"n_common\":2,\"snapshots\":[]"));
}

static void only_snapshots_of_common_times_are_compared(void **state)
{
    helper_run *b;

    (void)state;
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

    (void)state;
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
    (void)state;
    ask_add_run(RUN_SUCCEEDED);
    ask_add_run(RUN_QUEUED)->record.n_samples = 0;
    ask_get("/v1/compare", NULL, NULL, 400);
    ask_get("/v1/compare", "a=" ID_1, NULL, 400);
    ask_get("/v1/compare", "a=" ID_1 "&b=" ID_3, NULL, 404);
    ask_get("/v1/compare", "a=" ID_1 "&b=x", NULL, 404);
    ask_get("/v1/compare", "a=" ID_1 "&b=" ID_2, NULL, 409);
    ask_get("/v1/compare", "a=" ID_1 "&b=" ID_1 "&column=upstreams", NULL, 400);
    assert_true(ask_body_has("'column'"));
}

static void curves_without_a_common_time_are_a_conflict(void **state)
{
    helper_run *b;

    (void)state;
    ask_add_run(RUN_SUCCEEDED);
    b = ask_add_run(RUN_SUCCEEDED);
    b->t[0] = 5.0;
    b->t[1] = 6.0;
    ask_get("/v1/compare", "a=" ID_1 "&b=" ID_2, NULL, 409);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        ASK_TEST(two_runs_are_compared_in_curve_and_density),
        ASK_TEST(densities_on_different_grids_are_not_compared),
        ASK_TEST(only_snapshots_of_common_times_are_compared),
        ASK_TEST(many_snapshots_are_thinned_out_but_for_the_last),
        ASK_TEST(a_comparison_needs_two_runs_with_samples_and_the_column),
        ASK_TEST(curves_without_a_common_time_are_a_conflict),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
