// Flows of two runs side by side.

#include "api/results/compare_flows.h"

#include "api/json/json_in.h"
#include "api/results/key_figures.h"
#include "core/base/buffer.h"
#include "tests/unit/api/helper_document.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <string.h>

static compare_flows of_a, of_b;

static void read_flows(const char *text, compare_flows *ret_flows)
{
    bf_buffer quoted = document_quote(text);
    struct json_t *figures = NULL;

    assert_int_equal(key_figures_parse(quoted.bytes, quoted.n, &figures, NULL), BF_OK);
    compare_flows_read(figures, ret_flows);
    json_in_free(figures);
    buffer_fini(&quoted);
}

static void counters_and_outlets_that_both_have_are_side_by_side(void **unused)
{
    bf_buffer out = { 0 };
    json_out w = json_out_to(&out);

    read_flows("{'counters': [{'id': 'x', 'flow_per_h': 5}, {'id': 'main', 'flow_per_h': 100, "
               "'flow_error_per_h': 8}], 'outlets': [{'id': 'main', 'outflow_per_h': 90}]}",
               &of_a);
    read_flows("{'counters': [{'id': 'main', 'flow_per_h': 110}, {'id': 'y', 'flow_per_h': 1}], "
               "'outlets': [{'id': 'main', 'outflow_per_h': 60, 'outflow_error_per_h': 2}]}",
               &of_b);
    assert_int_equal(of_a.n, 3);
    assert_true(isnan(of_a.items[0].error_per_h));
    compare_flows_write(&w, &of_a, &of_b);
    assert_string_equal(out.bytes, "[{\"of\":\"counter\",\"id\":\"main\",\"flow_a_per_h\":100,"
                                   "\"flow_error_a_per_h\":8,\"flow_b_per_h\":110,"
                                   "\"flow_error_b_per_h\":null,\"flow_gap_per_h\":10},"
                                   "{\"of\":\"outlet\",\"id\":\"main\",\"flow_a_per_h\":90,"
                                   "\"flow_error_a_per_h\":null,\"flow_b_per_h\":60,"
                                   "\"flow_error_b_per_h\":2,\"flow_gap_per_h\":-30}]");
    buffer_fini(&out);
}

static void what_a_run_cannot_say_is_no_flow(void **unused)
{
    read_flows("{'throughput_per_h': 3, 'counters': [{'id': 'main'}]}", &of_a);
    assert_int_equal(of_a.n, 0);
    compare_flows_read(NULL, &of_a);
    assert_int_equal(of_a.n, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(counters_and_outlets_that_both_have_are_side_by_side),
        cmocka_unit_test(what_a_run_cannot_say_is_no_flow),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}
