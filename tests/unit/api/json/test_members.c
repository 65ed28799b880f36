// The tables of members: they agree with core, which checks what they describe, and answers follow them.

#include "api/json/members.h"

#include "api/scenario/scenario_members.h"
#include "tests/unit/api/helper_document.h"
#include "tests/unit/helper_cmocka.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bf_faults faults;

// With this number in the member's place the document must be refused at the member.
static void check_refused(json_t *root, json_t *object, const char *name, double number,
                          const char *pointer)
{
    bf_error err;

    json_object_set_new(object, name, json_real(number));
    char *text = json_dumps(root, 0);
    document_refuse(text, strlen(text), &faults, &err);
    if (!document_has_fault(&faults, pointer))
        fail_msg("%.17g at %s: fault at \"%s\"", number, pointer, err.pointer);
    free(text);
}

static void check_range(json_t *root, json_t *object, const member *m, const char *pointer)
{
    json_t *value = json_object_get(object, m->name);
    const bf_range *range = m->range;

    if (value == NULL || range == NULL || !(json_is_number(value) || m->kind == &member_step))
        return;
    json_incref(value);
    double below = range->excludes_min ? range->minimum : range->minimum - 1.0;
    double above = range->excludes_max ? range->maximum : range->maximum + 1.0;
    if (isfinite(below))
        check_refused(root, object, m->name, below, pointer);
    if (isfinite(above))
        check_refused(root, object, m->name, above, pointer);
    check_refused(root, object, m->name, 1e300, pointer);
    json_object_set_new(object, m->name, value);
}

static void check_ranges(json_t *root, json_t *object, const member_table *table,
                         const char *pointer)
{
    for (size_t k = 0; k < table->n; k++) {
        const member *m = &table->members[k];
        json_t *value = json_object_get(object, m->name);
        char at[BF_POINTER_SIZE];
        snprintf(at, sizeof at, "%s/%s", pointer, m->name);
        check_range(root, object, m, at);
        if (m->table != NULL && json_is_object(value))
            check_ranges(root, value, m->table, at);
        for (size_t i = 0; m->table != NULL && i < json_array_size(value); i++) {
            char item[BF_POINTER_SIZE + 24];
            snprintf(item, sizeof item, "%s/%zu", at, i);
            check_ranges(root, json_array_get(value, i), m->items != NULL ? m->items : m->table,
                         item);
        }
    }
}

static void what_is_out_of_the_tables_ranges_is_refused(void **unused)
{
    static const char *const documents[] = {
        "{'duration_s': 1, 'domain': {'x_m': [0, 1], 'y_m': [0, 1]}, 'cargo': {'shape':"
        "{'type': 'cylinder', 'radius_m': 0.01, 'height_m': 0.01}}, 'initial': {'hexagonal':"
        "{'rows': 2, 'columns': 2, 'first_m': [0.3, 0.3], 'spacing_m': 0.1}}}",
        "{'duration_s': 1, 'domain': {'x_m': [0, 1], 'y_m': [0, 1]}, 'cargo': {},"
        "'initial': {'random': {'count': 2, 'seed': 3, 'region': {'x_m': [0.1, 0.9], 'y_m':"
        "[0.1, 0.9]}}}}",
        "{'duration_s': 1, 'domain': {'x_m': [0, 1], 'y_m': [0, 1]}, 'cargo': [{'share': 2,"
        "'mass_kg': 0.1, 'spin_friction_radius_m': 0.01, 'material': {'young_modulus_pa': 1e9,"
        "'poisson_ratio': 0.3}}, {'shape': {'type': 'box', 'length_m': 0.02, 'width_m': 0.03,"
        "'height_m': 0.01}}], 'cargo_seed': 5, 'initial': {'positions_m': [[0.5, 0.5]]}}",
    };

    for (size_t k = 0; k <= sizeof documents / sizeof *documents; k++) {
        bf_buffer document = k == 0 ? document_complete() : document_quote(documents[k - 1]);
        json_t *root = json_loadb(document.bytes, document.n, JSON_DECODE_INT_AS_REAL, NULL);
        check_ranges(root, root, &scenario_members, "");
        json_decref(root);
        buffer_fini(&document);
    }
}

typedef struct inner {
    double x;
} inner;

typedef struct outer {
    char id[8];
    uint64_t n;
    bool has_more;
    double unknown;
    inner within;
    size_t n_points;
    double limit;
} outer;

static bool has_more(const void *item)
{
    const outer *of = item;

    return of->has_more;
}

static const member inner_members[] = { MEMBER("x_m", number, offsetof(inner, x), "a place") };
static const member_table inner_table = { MEMBER_TABLE("Inner", inner_members) };

static const member outer_members[] = {
    MEMBER("self", link, offsetof(outer, id), "itself", .path = "/a/{id}/b/{n}",
           .offset_n = offsetof(outer, n)),
    MEMBER("more", size, offsetof(outer, n), "of some only", .applies = has_more),
    MEMBER("unknown", number, offsetof(outer, unknown), "no number", .null = "not known"),
    MEMBER_INLINE(&inner_table, offsetof(outer, within)),
    MEMBER("within", object, offsetof(outer, within), "the same below", .table = &inner_table),
    MEMBER("points", points, 0, "none", .flags = MEMBER_OMIT_EMPTY,
           .offset_n = offsetof(outer, n_points)),
    MEMBER("place", object, offsetof(outer, within), "as empty as points", .table = &inner_table,
           .flags = MEMBER_OMIT_EMPTY, .offset_n = offsetof(outer, n_points)),
    MEMBER("limit", number, offsetof(outer, limit), "if any", .flags = MEMBER_OMIT_EMPTY),
    MEMBER("streamed", described, 0, "written by another", .type = "[number]"),
};
static const member_table outer_table = { MEMBER_TABLE("Outer", outer_members) };

static void an_answer_has_the_members_of_its_table_in_their_order(void **unused)
{
    outer item = {
        .id = "7", .n = 3, .unknown = (double)NAN, .within = { 0.5 }, .limit = (double)INFINITY
    };
    bf_buffer out = { 0 };
    json_out w = json_out_to(&out);

    json_out_array(&w);
    members_write(&w, &outer_table, &item);
    item.has_more = true;
    item.limit = 2.0;
    members_write(&w, &outer_table, &item);
    json_out_array_end(&w);
    assert_string_equal(out.bytes, "[{\"self\":\"/a/7/b/3\",\"unknown\":null,\"x_m\":0.5,"
                                   "\"within\":{\"x_m\":0.5}},"
                                   "{\"self\":\"/a/7/b/3\",\"more\":3,\"unknown\":null,"
                                   "\"x_m\":0.5,\"within\":{\"x_m\":0.5},\"limit\":2}]");
    buffer_fini(&out);
}

typedef struct sparse {
    uint64_t n;
    char id[8], text[8];
    int64_t ms;
    bool is_so, has_more;
    unsigned word;
} sparse;

static const char *const sparse_words[] = { "one", NULL };

#define AT(place) offsetof(sparse, place)
static const member sparse_members[] = {
    MEMBER("link", link, AT(id), "of no id", .path = "/a/{id}", .flags = MEMBER_OMIT_EMPTY),
    MEMBER("text", text, AT(text), "of no bytes", .flags = MEMBER_OMIT_EMPTY),
    MEMBER("size", size, AT(n), "0", .flags = MEMBER_OMIT_EMPTY),
    MEMBER("time", time, AT(ms), "0", .flags = MEMBER_OMIT_EMPTY),
    MEMBER("bool", bool, AT(is_so), "false", .flags = MEMBER_OMIT_EMPTY),
    MEMBER("enum", enum, AT(word), "beyond its words", .words = sparse_words,
           .flags = MEMBER_OMIT_EMPTY),
    MEMBER("more", bool, AT(is_so), "of some only", .offset_if = AT(has_more)),
};
#undef AT
static const member_table sparse_table = { MEMBER_TABLE("Sparse", sparse_members) };

static void what_is_empty_is_left_out_and_what_is_not_stands_there(void **unused)
{
    static const struct {
        sparse item;
        const char *text;
    } cases[] = {
        { { .word = 1 }, "{}" },
        { { .word = 1, .has_more = true }, "{\"more\":false}" },
        { { .id = "7", .word = 1 }, "{\"link\":\"/a/7\"}" },
        { { .text = "t", .word = 1 }, "{\"text\":\"t\"}" },
        { { .n = UINT64_C(1) << 32, .word = 1 }, "{\"size\":4294967296}" },
        { { .ms = 1, .word = 1 }, "{\"time\":\"1970-01-01T00:00:00.001Z\"}" },
        { { .is_so = true, .word = 1 }, "{\"bool\":true}" },
        { { .word = 0 }, "{\"enum\":\"one\"}" },
    };

    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        bf_buffer out = { 0 };
        json_out w = json_out_to(&out);
        members_write(&w, &sparse_table, &cases[k].item);
        assert_string_equal(out.bytes, cases[k].text);
        buffer_fini(&out);
    }
}

static void a_pointer_leads_to_the_unit_of_a_number(void **unused)
{
    static const struct {
        const char *pointer, *unit;
    } places[] = {
        { "/duration_s", "s" },
        { "/obstacles/3/thickness_m", "m" },
        { "/obstacles/0/motion/turn_deg/12", "deg" },
        { "/cargo/mass_kg", "kg" },
        { "/cargo/1/mass_kg", "kg" },
        { "/obstacles/0/motion/turn_deg", NULL },
        { "/contacts/friction", NULL },
        { "/obstacles", NULL },
        { "/nowhere/thickness_m", NULL },
        { "/duration_s/thickness_m", NULL },
        { "", NULL },
    };

    for (size_t k = 0; k < sizeof places / sizeof *places; k++) {
        const char *unit = members_unit(&scenario_members, places[k].pointer);
        if (places[k].unit == NULL)
            assert_null(unit);
        else
            assert_string_equal(unit, places[k].unit);
    }
}

static void ranges_are_texts_made_from_the_numbers(void **unused)
{
    static const struct {
        bf_range range;
        const char *text;
    } pairs[] = {
        { { 0, INFINITY, true, false, 0 }, "> 0" },
        { { 0, INFINITY, false, false, 0 }, ">= 0" },
        { { 0, 0.5, false, true, 0 }, ">= 0, < 0.5" },
        { { 0, 9007199254740991.0, false, false, 0 }, ">= 0, < 2^53" },
        { { -100, 100, false, false, 0 }, "-100 to 100" },
        { { -INFINITY, INFINITY, false, false, 0 }, "" },
    };
    char text[MEMBER_TEXT_SIZE];

    for (size_t k = 0; k < sizeof pairs / sizeof *pairs; k++) {
        members_range_text(&pairs[k].range, text);
        assert_string_equal(text, pairs[k].text);
    }
    members_range_text(NULL, text);
    assert_string_equal(text, "");
}

// The member of a table, in *ret_table, at "a/b" below the scenario.
static const member *find_row(const char *place, const member_table **ret_table)
{
    const member_table *table = &scenario_members;

    for (;;) {
        size_t n = strcspn(place, "/");
        const member *m = table->members;
        while (strlen(m->name) != n || memcmp(m->name, place, n) != 0)
            m++;
        *ret_table = table;
        if (place[n] == '\0')
            return m;
        table = m->table;
        place += n + 1;
    }
}

static void defaults_are_those_of_core(void **unused)
{
    static const struct {
        const char *place, *text;
    } pairs[] = {
        { "name", "empty" },
        { "edges/east", "outflow" },
        { "belts/velocity_m_s", "[0.395,0]" },
        { "obstacles/thickness_m", "0.005" },
        { "cargo/material", "210000000000 Pa, 0.28" },
        { "micro/tension", "false" },
        { "contacts/cargo_cargo/length_m", "0.008" }, // of each pair
        { "contacts/cargo_cargo/damping_n_s_m", "119, 230, 120" },
        { "obstacles/band_m", "8/sqrt(sigma)" }, // derived
        { "belts/acceleration_m_s2", "at once" },
        { "duration_s", "" }, // must be given
    };
    char text[MEMBER_TEXT_SIZE];
    const member_table *table;

    for (size_t k = 0; k < sizeof pairs / sizeof *pairs; k++) {
        const member *m = find_row(pairs[k].place, &table);
        members_default_text(table, m, text);
        assert_string_equal(text, pairs[k].text);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_out_of_the_tables_ranges_is_refused),
        cmocka_unit_test(an_answer_has_the_members_of_its_table_in_their_order),
        cmocka_unit_test(what_is_empty_is_left_out_and_what_is_not_stands_there),
        cmocka_unit_test(a_pointer_leads_to_the_unit_of_a_number),
        cmocka_unit_test(ranges_are_texts_made_from_the_numbers),
        cmocka_unit_test(defaults_are_those_of_core),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
