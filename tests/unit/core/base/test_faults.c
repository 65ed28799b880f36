// Unit tests of the list of faults.

#include "core/base/faults.h"
#include "tests/unit/helper_cmocka.h"

#include <string.h>

static void an_empty_list_is_no_failure(void **state)
{
    static const bf_faults faults;
    bf_error err = { .code = BF_EBUSY, .text = "untouched" };

    assert_int_equal(faults_status(&faults, &err), BF_OK);
    assert_int_equal(faults_kept(&faults), 0);
    assert_string_equal(err.text, "untouched");
}

static void faults_retain_their_order_code_place_and_text(void **state)
{
    static bf_faults faults;
    bf_error err = { .code = BF_ENOMEM, .pointer = "/c", .text = "three" };

    faults_add(&faults, "/a", "one %d", 1);
    faults_add_limit(&faults, "/b", "two %s", "2");
    faults_add_error(&faults, &err);
    assert_int_equal(faults_kept(&faults), 3);
    assert_int_equal(faults.items[0].code, BF_EINPUT);
    assert_string_equal(faults.items[0].pointer, "/a");
    assert_string_equal(faults.items[0].text, "one 1");
    assert_int_equal(faults.items[1].code, BF_ELIMIT);
    assert_string_equal(faults.items[1].text, "two 2");
    assert_int_equal(faults.items[2].code, BF_ENOMEM);
    assert_string_equal(faults.items[2].pointer, "/c");
}

static void the_first_fault_is_the_status(void **state)
{
    static bf_faults faults;
    bf_error err = { 0 };

    faults_add_limit(&faults, "/first", "large");
    faults_add(&faults, "/second", "bad");
    assert_int_equal(faults_status(&faults, &err), BF_ELIMIT);
    assert_string_equal(err.pointer, "/first");
    assert_int_equal(faults_status(&faults, NULL), BF_ELIMIT);
}

static void a_flood_is_counted_but_not_kept(void **state)
{
    static bf_faults faults;
    bf_error err = { .code = BF_EINPUT };

    for (int k = 0; k < 1000; k++)
        faults_add(&faults, "/x", "%d", k);
    faults_add_error(&faults, &err);
    assert_int_equal(faults.n, 1001);
    assert_int_equal(faults_kept(&faults), FAULTS_MAX);
    assert_string_equal(faults.items[FAULTS_MAX - 1].text, "63");
}

static void long_texts_and_pointers_are_cut(void **state)
{
    static bf_faults faults;
    char pointer[1000];

    memset(pointer, 'p', sizeof pointer - 1);
    pointer[sizeof pointer - 1] = '\0';
    faults_add(&faults, pointer, "%1000d", 1);
    assert_int_equal(strlen(faults.items[0].pointer), BF_POINTER_SIZE - 1);
    assert_int_equal(strlen(faults.items[0].text), BF_TEXT_SIZE - 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_empty_list_is_no_failure),
        cmocka_unit_test(faults_retain_their_order_code_place_and_text),
        cmocka_unit_test(the_first_fault_is_the_status),
        cmocka_unit_test(a_flood_is_counted_but_not_kept),
        cmocka_unit_test(long_texts_and_pointers_are_cut),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
