// Scenario documents beyond limits, of wrong types throughout, and damaged byte by byte: refused, and
// no harm done.

#include "api/scenario/scenario.h"

#include "api/scenario/examples.h"
#include "core/base/random.h"
#include "tests/unit/api/helper_document.h"
#include "tests/unit/helper_amount.h"
#include "tests/unit/helper_cmocka.h"

#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bf_faults faults;

// Refuses the root as it is now; the fault must be at pointer.
static void check_tree(const json_t *root, const char *pointer)
{
    char *text = json_dumps(root, 0);
    bf_error err;

    document_refuse(text, strlen(text), &faults, &err);
    if (!document_has_fault(&faults, pointer))
        fail_msg("no fault at \"%s\" but at \"%s\": %s", pointer, err.pointer, err.text);
    free(text);
}

static void try_value(json_t *root, json_t *parent, const char *key, json_t *wrong,
                      const char *pointer)
{
    json_t *right = json_incref(json_object_get(parent, key));

    json_object_set_new(parent, key, wrong);
    check_tree(root, pointer);
    json_object_set_new(parent, key, right);
}

// Replaces every value below the object by null, and by a boolean or a number where that is wrong.
static void try_members(json_t *root, json_t *object, const char *pointer)
{
    char at[BF_POINTER_SIZE];
    const char *key;
    json_t *value;
    void *next;

    json_object_foreach_safe(object, next, key, value)
    {
        json_t *other = json_is_boolean(value) ? json_real(1) : json_true();
        snprintf(at, sizeof at, "%s/%s", pointer, key);
        try_value(root, object, key, json_null(), at);
        try_value(root, object, key, other, at);
        value = json_object_get(object, key);
        if (json_is_object(value))
            try_members(root, value, at);
        for (size_t k = 0; k < json_array_size(value); k++) {
            char item[BF_POINTER_SIZE + 24];
            snprintf(item, sizeof item, "%s/%zu", at, k);
            if (json_is_object(json_array_get(value, k)))
                try_members(root, json_array_get(value, k), item);
        }
    }
    snprintf(at, sizeof at, "%s/no_such_member", pointer);
    json_object_set_new(object, "no_such_member", json_real(1));
    check_tree(root, at);
    json_object_del(object, "no_such_member");
}

static void every_member_refuses_other_types_and_every_object_other_members(void **unused)
{
    bf_buffer document = document_complete();
    json_t *root = json_loadb(document.bytes, document.n, JSON_DECODE_INT_AS_REAL, NULL);

    try_members(root, root, "");
    json_decref(root);
    buffer_fini(&document);
}

// A list one longer than its limit, of copies of an item.
static void check_limit(const char *before, const char *item, size_t limit, const char *after,
                        const char *pointer)
{
    bf_buffer text = { 0 };
    bf_error err;

    assert_int_equal(buffer_printf(&text, "{" DOCUMENT_NEEDED ", %s[", before), BF_OK);
    for (size_t k = 0; k <= limit; k++)
        assert_int_equal(buffer_printf(&text, "%s%s", k == 0 ? "" : ",", item), BF_OK);
    assert_int_equal(buffer_printf(&text, "]%s}", after), BF_OK);
    bf_buffer document = document_quote(text.bytes);
    assert_int_equal(document_refuse(document.bytes, document.n, &faults, &err), BF_ELIMIT);
    assert_string_equal(err.pointer, pointer);
    char figures[80];
    snprintf(figures, sizeof figures, "%zu items, the limit is %zu", limit + 1, limit);
    assert_non_null(strstr(err.text, figures));
    buffer_fini(&text);
    buffer_fini(&document);
}

static void lists_have_limits(void **unused)
{
    check_limit("'belts': ", "{}", SCENE_BELTS_MAX, "", "/belts");
    check_limit("'obstacles': ", "{}", SCENE_OBSTACLES_MAX, "", "/obstacles");
    check_limit("'counters': ", "{}", SCENE_COUNTERS_MAX, "", "/counters");
    check_limit("'belts': [{'polygon_m': ", "[0,0]", SCENE_POINTS_MAX, "}]", "/belts/0/polygon_m");
    check_limit("'obstacles': [{'path_m': ", "[0,0]", SCENE_POINTS_MAX, "}]",
                "/obstacles/0/path_m");
}

static void mixes_have_a_limit(void **unused)
{
    bf_buffer text = { 0 };
    bf_error err;

    assert_int_equal(buffer_printf(&text, "{\"cargo\": [{}"), BF_OK);
    for (int k = 0; k < SCENE_KINDS_MAX; k++)
        assert_int_equal(buffer_printf(&text, ", {}"), BF_OK);
    assert_int_equal(buffer_printf(&text, "]}"), BF_OK);
    document_refuse(text.bytes, text.n, &faults, &err);
    assert_true(document_has_fault(&faults, "/cargo"));
    buffer_fini(&text);
}

static void texts_have_limits(void **unused)
{
    char text[1000];
    char name[SCENE_NAME_SIZE + 1];
    bf_error err;

    memset(name, 'n', sizeof name);
    name[SCENE_NAME_SIZE] = '\0';
    snprintf(text, sizeof text, DOCUMENT_WITH("'name': '%s'"), name);
    bf_buffer document = document_quote(text);
    assert_int_equal(document_refuse(document.bytes, document.n, &faults, &err), BF_ELIMIT);
    assert_string_equal(err.pointer, "/name");
    assert_string_equal(err.text, "has 201 bytes, the limit is 200");
    buffer_fini(&document);
}

static void nesting_has_a_limit(void **unused)
{
    enum { LEVELS = 100000 };
    static char text[LEVELS];
    bf_error err;

    memset(text, '[', sizeof text);
    assert_int_equal(document_refuse(text, sizeof text, &faults, &err), BF_ELIMIT);
    assert_non_null(strstr(err.text, "column 33: nested deeper than 32 levels"));
    assert_true(strncmp(err.pointer, "/0/0/0/0", 8) == 0);
    for (size_t k = 0; k < sizeof text; k += 5)
        memcpy(text + k, "{\"a\":", k + 6 <= sizeof text ? 5 : sizeof text - k);
    document_refuse(text, sizeof text, &faults, &err);
}

static void long_names_of_members_are_cut(void **unused)
{
    bf_buffer b = { 0 };
    bf_error err;

    assert_int_equal(buffer_append(&b, "{\"", 2), BF_OK);
    for (int k = 0; k < 5000; k++)
        assert_int_equal(buffer_append(&b, "\xe2\x82\xac", 3), BF_OK);
    assert_int_equal(buffer_append(&b, "\":1}", 4), BF_OK);
    document_refuse(b.bytes, b.n, &faults, &err);
    // Whole characters only: "/" and 52 times three bytes fit into 159.
    assert_int_equal(strlen(err.pointer), 157);
    buffer_fini(&b);
}

static void many_faults_are_counted(void **unused)
{
    bf_buffer b = { 0 };
    bf_error err;

    assert_int_equal(buffer_append(&b, "{", 1), BF_OK);
    for (int k = 0; k < 3000; k++)
        assert_int_equal(buffer_printf(&b, "%s\"x%d\":1", k == 0 ? "" : ",", k), BF_OK);
    assert_int_equal(buffer_append(&b, "}", 1), BF_OK);
    document_refuse(b.bytes, b.n, &faults, &err);
    assert_int_equal(faults.n, 3000 + 3); // and the three members that are missing
    assert_int_equal(faults_kept(&faults), FAULTS_MAX);
    buffer_fini(&b);
}

// A byte replaced, removed, put in, or a piece moved over another.
static size_t mutate(char *text, size_t n, bf_random *random)
{
    static const char bytes[] = "{}[]\",:0123456789.-+eE\\ntrue\n \x01\xff_m";
    size_t at = random_bits(random) % n;
    char byte = bytes[random_bits(random) % (sizeof bytes - 1)];

    switch (random_bits(random) % 4) {
    case 0:
        text[at] = byte;
        return n;
    case 1:
        memmove(text + at, text + at + 1, n - at - 1);
        return n - 1;
    case 2:
        memmove(text + at + 1, text + at, n - at);
        text[at] = byte;
        return n + 1;
    default: {
        size_t from = random_bits(random) % n;
        size_t length = random_bits(random) % 24;
        length = length > n - at ? n - at : length;
        length = length > n - from ? n - from : length;
        memmove(text + at, text + from, length);
        return n;
    }
    }
}

// A document that is still in order must be written and read to the same bytes again.
static void check_round_trip(const scene *s)
{
    bf_buffer once = { 0 };
    bf_buffer twice = { 0 };
    scene back;

    assert_int_equal(scenario_write(s, &once, NULL), BF_OK);
    faults.n = 0;
    assert_int_equal(scenario_read(once.bytes, once.n, &back, &faults, NULL), BF_OK);
    assert_int_equal(scenario_write(&back, &twice, NULL), BF_OK);
    assert_string_equal(once.bytes, twice.bytes);
    scene_fini(&back);
    buffer_fini(&once);
    buffer_fini(&twice);
}

static void try_mutation(const char *document, size_t n, bf_random *random)
{
    char text[16384];
    scene s;
    scene before;
    bf_error err = { 0 };

    assert_true(n + 8 < sizeof text);
    memcpy(text, document, n);
    for (size_t k = 1 + random_bits(random) % 3; k > 0; k--)
        n = mutate(text, n, random);
    memset(&s, 0x5a, sizeof s);
    before = s;
    faults.n = 0;
    bf_status status = scenario_read(text, n, &s, &faults, &err);
    if (status == BF_OK) {
        check_round_trip(&s);
        scene_fini(&s);
    } else {
        assert_memory_equal(&s, &before, sizeof s);
        assert_true(status == BF_EINPUT || status == BF_ELIMIT);
        assert_true(faults.n > 0 && err.code == status);
    }
}

static void damaged_documents_never_harm(void **unused)
{
    enum { MUTATIONS = HELPER_AMOUNT(2000, 600) };
    bf_buffer complete = document_complete();
    bf_random random;
    size_t n;
    const example *examples = examples_list(&n);

    random_init(&random, 2014);
    for (int k = 0; k < MUTATIONS; k++) {
        for (size_t i = 0; i < n; i++)
            try_mutation(examples[i].document, examples[i].n, &random);
        try_mutation(complete.bytes, complete.n, &random);
    }
    buffer_fini(&complete);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_member_refuses_other_types_and_every_object_other_members),
        cmocka_unit_test(lists_have_limits),
        cmocka_unit_test(mixes_have_a_limit),
        cmocka_unit_test(texts_have_limits),
        cmocka_unit_test(nesting_has_a_limit),
        cmocka_unit_test(long_names_of_members_are_cut),
        cmocka_unit_test(many_faults_are_counted),
        cmocka_unit_test(damaged_documents_never_harm),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
