// The kinds of parameters: what each takes, and the words of refusals.

#include "api/http/param.h"

#include "api/http/routes.h"
#include "tests/unit/helper_cmocka.h"

#include <stdio.h>
#include <string.h>

#define ID_A "0190a0b0-0000-7000-8000-00000000000a"
#define ID_B "0190a0b0-0000-7000-8000-00000000000b"
#define ID_C "0190a0b0-0000-7000-8000-00000000000c"

static void assert_refused(const param *row, const char *text, bf_status status, const char *why)
{
    param_value value = { .whole = 77 };
    bf_error err = { 0 };

    if (param_read(row, text, &value, &err) != status)
        fail_msg("'%s': %s", text, err.text);
    if (strstr(err.text, why) == NULL)
        fail_msg("'%s': %s", text, err.text);
    assert_int_equal(value.whole, 77);
}

static void numbers_are_whole_and_within_their_range(void **state)
{
    static const param row = { .name = "n", .kind = &param_whole, .least = 1, .most = 200 };
    static const char *const bad[] = { "",
                                       "0",
                                       "201",
                                       "-1",
                                       "1.5",
                                       "+1",
                                       "1x",
                                       "18446744073709551616",
                                       " 1",
                                       "1 ",
                                       "99999999999999999999999" };
    param_value value;

    assert_int_equal(param_read(&row, "200", &value, NULL), BF_OK);
    assert_int_equal(value.whole, 200);
    assert_int_equal(param_read(&row, "001", &value, NULL), BF_OK);
    assert_int_equal(value.whole, 1);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_refused(&row, bad[i], BF_EINPUT, "'n' must be a whole number from 1 to 200, not '");
}

static void times_are_moments_in_utc(void **state)
{
    static const param row = { .name = "created_from", .kind = &param_time };
    static const char *const bad[] = { "",
                                       "2026-11-24",
                                       "2026-11-24T09:00:00",
                                       "2026-11-24T09:00:00+01:00",
                                       "2026-11-24T09:00:00.Z",
                                       "2026-11-24T09:00:00.1234567890Z",
                                       "2026-11-24T9:00:00Z",
                                       "2026-11-24 09:00:00Z",
                                       "2026-02-30T09:00:00Z",
                                       "2026-13-01T09:00:00Z",
                                       "1969-12-31T23:59:59Z",
                                       "2026-11-24T09:00:00Zx" };
    param_value value;

    assert_int_equal(param_read(&row, "1970-01-02T00:00:01Z", &value, NULL), BF_OK);
    assert_int_equal(value.whole, 86401000);
    assert_int_equal(param_read(&row, "1970-01-01T00:00:00.0259Z", &value, NULL), BF_OK);
    assert_int_equal(value.whole, 25);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_refused(&row, bad[i], BF_EINPUT, "'created_from' must be a time in UTC as ");
}

static void flags_are_0_or_1(void **state)
{
    static const param row = { .name = "vtk", .kind = &param_flag, .most = 1 };
    param_value value;

    assert_int_equal(param_read(&row, "1", &value, NULL), BF_OK);
    assert_int_equal(value.whole, 1);
    assert_refused(&row, "2", BF_EINPUT, "'vtk' must be a whole number from 0 to 1, not '2'");
    assert_refused(&row, "true", BF_EINPUT, "'vtk'");
}

static void decimals_are_numbers_within_their_range(void **state)
{
    static const param row = {
        .name = "m", .kind = &param_real, .least_real = 0.1, .most_real = 10.0
    };
    static const char *const bad[] = { "",    "0.05", "10.5", "nan", "inf",
                                       "0x1", "1,5",  "1 ",   "--1", "1e" };
    param_value value;

    assert_int_equal(param_read(&row, "1.25e0", &value, NULL), BF_OK);
    assert_true(value.real == 1.25);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_refused(&row, bad[i], BF_EINPUT, "'m' must be a number from 0.1 to 10");
}

static void texts_have_a_limit_in_bytes(void **state)
{
    static const param row = { .name = "label", .kind = &param_text, .most = 3 };
    static const param any = { .name = "column", .kind = &param_text };
    param_value value;

    assert_int_equal(param_read(&row, "", &value, NULL), BF_OK);
    assert_int_equal(param_read(&row, "abc", &value, NULL), BF_OK);
    assert_refused(&row, "abcd", BF_EINPUT, "'label' has more than 3 bytes");
    assert_int_equal(param_read(&any, "abcdefghijkl", &value, NULL), BF_OK);
}

static void ids_have_one_form(void **state)
{
    static const param row = { .name = "a", .kind = &param_id };
    static const param cursor = { .name = "cursor", .kind = &param_cursor };
    param_value value;
    bf_error err = { 0 };

    assert_int_equal(param_read(&row, ID_A, &value, NULL), BF_OK);
    assert_int_equal(param_read(&row, "x", &value, &err), BF_ENOTFOUND);
    assert_string_equal(err.pointer, "/a");
    assert_string_equal(err.text, "there is nothing with the id 'x'");
    assert_refused(&row, ID_A "0", BF_ENOTFOUND, "there is nothing");
    assert_int_equal(param_read(&cursor, ID_A, &value, NULL), BF_OK);
    assert_refused(&cursor, "x", BF_EINPUT, "'cursor' is not from a `next` link");
}

static void a_list_of_ids_has_no_gaps_and_no_id_twice(void **state)
{
    static const param row = { .name = "runs", .kind = &param_ids, .least = 1, .most = 2 };
    static const param two = { .name = "runs", .kind = &param_ids, .least = 2, .most = 8 };
    param_value value;
    bf_error err = { 0 };

    assert_int_equal(param_read(&row, ID_A "," ID_B, &value, NULL), BF_OK);
    assert_int_equal(value.ids.n, 2);
    assert_string_equal(value.ids.items[0], ID_A);
    assert_string_equal(value.ids.items[1], ID_B);
    assert_refused(&row, "", BF_EINPUT, "'runs' is missing: ids with commas");
    assert_refused(&row, ID_A "," ID_B "," ID_C, BF_EINPUT, "'runs' has more than 2 ids");
    assert_refused(&row, ID_A "," ID_A, BF_EINPUT, "'runs' has '" ID_A "' twice");
    assert_refused(&row, ID_A ",", BF_ENOTFOUND, "there is nothing with the id ''");
    assert_refused(&row, "," ID_A, BF_ENOTFOUND, "there is nothing with the id ''");
    assert_int_equal(param_read(&row, ID_A ",x", &value, &err), BF_ENOTFOUND);
    assert_string_equal(err.pointer, "/runs/1");
    assert_refused(&two, ID_A, BF_EINPUT, "'runs' needs two ids at least");
}

// A default that the reader refused would be a bug of the table.
static void every_default_is_a_value(void **state)
{
    size_t n, n_defaults = 0;
    const route *table = routes_list(&n);

    for (size_t i = 0; i < n; i++) {
        for (size_t k = 0; table[i].params[k] != NULL; k++) {
            const param *row = table[i].params[k];
            param_value value;
            if (row->default_text == NULL)
                continue;
            assert_int_equal(param_read(row, row->default_text, &value, NULL), BF_OK);
            n_defaults++;
        }
    }
    assert_true(n_defaults > 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_are_whole_and_within_their_range),
        cmocka_unit_test(times_are_moments_in_utc),
        cmocka_unit_test(flags_are_0_or_1),
        cmocka_unit_test(decimals_are_numbers_within_their_range),
        cmocka_unit_test(texts_have_a_limit_in_bytes),
        cmocka_unit_test(ids_have_one_form),
        cmocka_unit_test(a_list_of_ids_has_no_gaps_and_no_id_twice),
        cmocka_unit_test(every_default_is_a_value),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
