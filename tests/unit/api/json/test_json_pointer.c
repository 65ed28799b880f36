// JSON pointers: what one leads to, after the examples of RFC 6901 (section 5), and what leads nowhere.

#include "api/json/json_pointer.h"
#include "tests/unit/helper_cmocka.h"

#include <string.h>

#include <jansson.h>

static const char document[] =
    "{\"foo\": [\"bar\", \"baz\"], \"\": 0, \"a/b\": 1, \"c%d\": 2, \"e^f\": 3, \"g|h\": 4, "
    "\"i\\\\j\": 5, \"k\\\"l\": 6, \" \": 7, \"m~n\": 8}";

static const struct {
    const char *pointer;
    const char *value; // as JSON; NULL: none
} cases[] = {
    { "", document },
    { "/foo", "[\"bar\",\"baz\"]" },
    { "/foo/0", "\"bar\"" },
    { "/foo/1", "\"baz\"" },
    { "/", "0" },
    { "/a~1b", "1" },
    { "/c%d", "2" },
    { "/e^f", "3" },
    { "/g|h", "4" },
    { "/i\\j", "5" },
    { "/k\"l", "6" },
    { "/ ", "7" },
    { "/m~0n", "8" },
    { "foo", NULL },
    { "/foo/2", NULL },
    { "/foo/-", NULL },
    { "/foo/01", NULL },
    { "/foo/", NULL },
    { "/foo/0/x", NULL },
    { "/foo/4294967296", NULL },
    { "/nothing", NULL },
    { "/a/b", NULL },
};

static void a_pointer_leads_to_its_value_or_nowhere(void **state)
{
    json_t *root = json_loads(document, 0, NULL);

    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        json_t *found = json_pointer_find(root, cases[k].pointer);
        json_t *wanted =
            cases[k].value == NULL ? NULL : json_loads(cases[k].value, JSON_DECODE_ANY, NULL);
        if ((found == NULL) != (wanted == NULL) || (found != NULL && !json_equal(found, wanted)))
            fail_msg("%s leads elsewhere", cases[k].pointer);
        json_decref(wanted);
    }
    json_decref(root);
}

static void a_name_that_is_too_long_leads_nowhere(void **state)
{
    char name[BF_POINTER_SIZE + 1], pointer[BF_POINTER_SIZE + 2];
    json_t *root = json_object();

    memset(name, 'a', BF_POINTER_SIZE);
    name[BF_POINTER_SIZE] = '\0';
    for (size_t n = BF_POINTER_SIZE; n >= BF_POINTER_SIZE - 1; n--) {
        name[n] = '\0';
        json_object_set_new(root, name, json_true());
        pointer[0] = '/';
        memcpy(pointer + 1, name, n + 1);
        assert_int_equal(json_pointer_find(root, pointer) != NULL, n < BF_POINTER_SIZE);
    }
    json_decref(root);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_pointer_leads_to_its_value_or_nowhere),
        cmocka_unit_test(a_name_that_is_too_long_leads_nowhere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
