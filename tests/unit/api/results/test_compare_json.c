// Comparisons as JSON.

#include "api/results/compare_json.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>

static void figures_are_members_with_their_units(void **state)
{
    const compare_figures f = { .t_end = 6.0,
                                .parts_start = 192.0,
                                .drain_time = NAN,
                                .t10 = 0.5,
                                .t90 = 2.5,
                                .throughput = 76.8 };
    bf_buffer out = { 0 };
    json_out w = json_out_to(&out);

    json_out_object(&w);
    members_write_into(&w, &compare_json_figures, &f);
    json_out_object_end(&w);
    assert_string_equal(out.bytes, "{\"t_start_s\":0,\"t_end_s\":6,\"parts_start\":192,"
                                   "\"parts_end\":0,\"drain_time_s\":null,\"t10_s\":0.5,"
                                   "\"t90_s\":2.5,\"throughput_per_s\":76.8}");
    buffer_fini(&out);
}

static void measures_are_an_object_and_never_is_null(void **state)
{
    const compare_measures m = {
        .t_end = 6.0, .l1 = 1.5, .l2 = 2.0, .drain_time_a = NAN, .drain_gap = NAN, .rate_b = -2.0
    };
    bf_buffer out = { 0 };
    json_out w = json_out_to(&out);

    members_write(&w, &compare_json_measures, &m);
    assert_string_equal(out.bytes,
                        "{\"t_start_s\":0,\"t_end_s\":6,\"l1\":1.5,\"l2\":2,\"largest\":0,"
                        "\"largest_at_s\":0,\"drain_time_a_s\":null,\"drain_time_b_s\":0,"
                        "\"drain_time_gap_s\":null,\"rate_a_per_s\":0,\"rate_b_per_s\":-2,"
                        "\"throughput_a_per_s\":0,\"throughput_b_per_s\":0,"
                        "\"throughput_gap_per_s\":0}");
    buffer_fini(&out);
}

static void distances_are_members(void **state)
{
    const compare_distance d = { .mean_abs = 0.25, .l1 = 1.0, .emd_x = NAN, .emd_y = 0.1 };
    bf_buffer out = { 0 };
    json_out w = json_out_to(&out);

    json_out_object(&w);
    members_write_into(&w, &compare_json_distance, &d);
    json_out_object_end(&w);
    assert_string_equal(out.bytes, "{\"mean_abs\":0.25,\"l1\":1,\"emd_x_m\":null,\"emd_y_m\":0.1}");
    buffer_fini(&out);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(figures_are_members_with_their_units),
        cmocka_unit_test(measures_are_an_object_and_never_is_null),
        cmocka_unit_test(distances_are_members),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
