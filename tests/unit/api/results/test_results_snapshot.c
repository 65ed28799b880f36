// Snapshots as text.

#include "api/results/results.h"

#include "tests/unit/api/helper_appender.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <string.h>

static const bf_grid grid = {
    .n1 = 3, .n2 = 2, .lower1 = -0.5, .lower2 = 1.0, .d1 = 0.5, .d2 = 0.25
};
static const float rho[] = { 0.0F, 0.1F, 1.25F, 3e-40F, 0.5F, NAN };
static const api_snapshot snapshot = { .index = 7, .t = 0.7, .peak = 1.25, .mass = 12.5 };

// Centres: x from -0.5 + 0.25 in steps of 0.5, y from 1 + 0.125 in steps of 0.25.
static void csv_is_a_matrix_with_its_axes(void **unused)
{
    bf_buffer out = { 0 };

    assert_int_equal(results_snapshot_csv(rho, &grid, &out, NULL), BF_OK);
    assert_string_equal(out.bytes, "y_m/x_m,-0.25,0.25,0.75\n"
                                   "1.125,0,0.1,1.25\n"
                                   "1.375,3e-40,0.5,nan\n");
    buffer_fini(&out);
}

static void json_has_rows_along_x(void **unused)
{
    bf_buffer out = { 0 };

    assert_int_equal(results_snapshot_json(rho, &grid, &snapshot, &out, NULL), BF_OK);
    assert_string_equal(out.bytes, "{\"n\":7,\"t_s\":0.7,\"peak\":1.25,\"mass\":12.5,"
                                   "\"origin_m\":[-0.5,1],\"cell_m\":[0.5,0.25],\"shape\":[2,3],"
                                   "\"density\":[[0,0.1,1.25],[3e-40,0.5,null]]}");
    buffer_fini(&out);
}

static bf_status append_csv(bf_buffer *out)
{
    return results_snapshot_csv(rho, &grid, out, NULL);
}

static bf_status append_json(bf_buffer *out)
{
    return results_snapshot_json(rho, &grid, &snapshot, out, NULL);
}

static void no_memory_leaves_what_was_there(void **unused)
{
    appender_survives_no_memory(append_csv);
    appender_survives_no_memory(append_json);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(csv_is_a_matrix_with_its_axes),
        cmocka_unit_test(json_has_rows_along_x),
        cmocka_unit_test(no_memory_leaves_what_was_there),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
