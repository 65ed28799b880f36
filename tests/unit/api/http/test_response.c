// Headers of a response.

#include "api/http/exchange.h"
#include "tests/unit/helper_cmocka.h"

#include <string.h>

static void headers_are_found_replaced_and_dropped_by_any_case(void **state)
{
    api_response response = { 0 };

    api_response_header(&response, "ETag", "%d", 1);
    api_response_set(&response, "Allow", "GET");
    api_response_set(&response, "etag", "2");
    assert_int_equal(response.n_headers, 2);
    assert_string_equal(api_response_find(&response, "eTAG"), "2");
    api_response_drop(&response, "etag");
    api_response_drop(&response, "etag");
    assert_null(api_response_find(&response, "ETag"));
    assert_string_equal(api_response_find(&response, "Allow"), "GET");
    assert_int_equal(response.n_headers, 1);
}

static void vary_names_a_field_once(void **state)
{
    api_response response = { 0 };

    api_response_vary(&response, "Accept");
    api_response_vary(&response, "Accept-Encoding");
    api_response_vary(&response, "accept");
    api_response_vary(&response, "Origin");
    api_response_vary(&response, "Accept-Encoding");
    assert_int_equal(response.n_headers, 1);
    assert_string_equal(api_response_find(&response, "Vary"), "Accept, Accept-Encoding, Origin");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(headers_are_found_replaced_and_dropped_by_any_case),
        cmocka_unit_test(vary_names_a_field_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
