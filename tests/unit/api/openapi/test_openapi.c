// The OpenAPI document: complete, consistent, and identical to the file in the tree.

#include "api/openapi/openapi.h"

#include "api/openapi/openapi_priv.h"
#include "api/results/picture.h"
#include "api/services.h"
#include "api/study/study_best.h"
#include "core/base/memory.h"
#include "tests/unit/api/helper_ask.h"
#include "tests/unit/api/helper_document.h"
#include "tests/unit/helper_amount.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define STUDY_1 "/v1/studies/0190a0b0-0000-7000-a000-000000000001"

static bf_buffer text;
static json_t *document;

static int write_document(void **unused)
{
    assert_int_equal(openapi_write(&text, NULL), BF_OK);
    document = json_loadb(text.bytes, text.n, JSON_REJECT_DUPLICATES, NULL);
    assert_non_null(document);
    return 0;
}

static int drop_document(void **unused)
{
    json_decref(document);
    buffer_fini(&text);
    return 0;
}

// The value at "#/a/b" of the document, or NULL; ~1 stands for a slash.
static json_t *find(const char *place)
{
    json_t *value = document;

    assert_memory_equal(place, "#/", 2);
    for (place += 2; value != NULL && *place != '\0'; place += *place == '/') {
        char key[200];
        size_t n = 0;
        for (; *place != '/' && *place != '\0'; place++) {
            bool is_slash = place[0] == '~' && place[1] == '1';
            key[n++] = is_slash ? '/' : *place;
            place += is_slash;
        }
        key[n] = '\0';
        value = json_object_get(value, key);
    }
    return value;
}

static json_t *follow(json_t *schema)
{
    const json_t *reference = json_object_get(schema, "$ref");

    return reference == NULL ? schema : find(json_string_value(reference));
}

static void the_document_in_the_tree_is_up_to_date(void **unused)
{
    static char kept[2000000];
    FILE *file = fopen(SOURCE_DIR "/api/openapi.json", "rb");

    assert_non_null(file);
    size_t n = fread(kept, 1, sizeof kept, file);
    fclose(file);
    if (n != text.n || memcmp(kept, text.bytes, n) != 0)
        fail_msg("api/openapi.json is not what `beltflow openapi` writes; the target `openapi` of "
                 "the build makes it anew");
}

static void no_two_operations_have_the_same_name(void **unused)
{
    size_t n;
    const route *routes = routes_list(&n);

    for (size_t k = 0; k < n; k++) {
        assert_non_null(routes[k].help);
        for (size_t i = 0; i < k; i++)
            assert_string_not_equal(routes[k].id, routes[i].id);
    }
}

static void every_format_has_a_schema(void **unused)
{
#define X(format, word, type, content_type)                                                        \
    if ((format) != MEDIA_JSON && openapi__format_schema(format) == NULL)                          \
        fail_msg("openapi_schemas.c lacks a schema of %s", type);
    MEDIA_LIST(X)
#undef X
}

// Notes the schemes that an operation's `security` refers to by their names.
static void check_schemes(json_t *requirements, json_t *used)
{
    json_t *requirement, *roles;
    const char *name;
    size_t index;

    json_array_foreach(requirements, index, requirement)
    {
        json_object_foreach(requirement, name, roles)
        {
            char place[100];
            snprintf(place, sizeof place, "#/components/securitySchemes/%s", name);
            assert_non_null(find(place));
            json_object_set_new(used, place, json_true());
        }
    }
}

// Checks the references below a value, and notes those to components in *used.
static void check_references(json_t *value, json_t *used)
{
    const char *key;
    json_t *item;
    size_t index;

    json_object_foreach(value, key, item)
    {
        if (strcmp(key, "$ref") == 0) {
            if (find(json_string_value(item)) == NULL)
                fail_msg("there is no %s", json_string_value(item));
            json_object_set_new(used, json_string_value(item), json_true());
        }
        if (strcmp(key, "security") == 0)
            check_schemes(item, used);
        check_references(item, used);
    }
    json_array_foreach(value, index, item) check_references(item, used);
}

static void what_is_referred_to_is_there_and_all_of_it_is_used(void **unused)
{
    json_t *used = json_object();
    const char *kind, *name;
    json_t *components, *component;

    check_references(document, used);
    json_object_foreach(json_object_get(document, "components"), kind, components)
    {
        json_object_foreach(components, name, component)
        {
            char place[200];
            snprintf(place, sizeof place, "#/components/%s/%s", kind, name);
            if (json_object_get(used, place) == NULL)
                fail_msg("nothing refers to %s", place);
        }
    }
    json_decref(used);
}

static void assert_described(json_t *value, json_t *schema, const char *name);

// Of several schemas the first object (or list) that has all members of the value.
static json_t *choose(json_t *choices, const json_t *value)
{
    json_t *choice, *item;
    const char *key;
    size_t index;

    json_array_foreach(choices, index, choice)
    {
        json_t *schema = follow(choice);
        const char *type = json_string_value(json_object_get(schema, "type"));
        bool fits = type != NULL && strcmp(type, json_is_object(value)  ? "object"
                                                 : json_is_array(value) ? "array"
                                                                        : "-") == 0;
        json_object_foreach((json_t *)value, key, item)
        {
            fits = fits && json_object_get(json_object_get(schema, "properties"), key) != NULL;
        }
        if (fits)
            return schema;
    }
    fail_msg("no choice fits");
    return NULL;
}

static void assert_members_described(json_t *object, json_t *schema, const char *name)
{
    json_t *required = json_object_get(schema, "required");
    json_t *item;
    const char *key;
    size_t index;

    if (json_object_get(schema, "properties") == NULL)
        return; // an object of any kind
    json_object_foreach(object, key, item)
    {
        json_t *of_member = json_object_get(json_object_get(schema, "properties"), key);
        if (of_member == NULL)
            of_member = json_object_get(schema, "additionalProperties");
        if (of_member == NULL || json_is_false(of_member))
            fail_msg("the schema of %s lacks the member %s", name, key);
        if (!json_is_true(of_member))
            assert_described(item, of_member, key);
    }
    json_array_foreach(required, index, item)
    {
        if (json_object_get(object, json_string_value(item)) == NULL)
            fail_msg("%s lacks %s", name, json_string_value(item));
    }
}

// Every member of a value, however deep, has an entry in the schema, and every one that must be
// there is.
static void assert_described(json_t *value, json_t *schema, const char *name)
{
    json_t *choices, *item;
    size_t index;

    schema = follow(schema);
    assert_non_null(schema);
    choices = json_object_get(schema, "anyOf");
    if (choices == NULL)
        choices = json_object_get(schema, "oneOf");
    if (choices != NULL && (json_is_object(value) || json_is_array(value)))
        schema = choose(choices, value);
    if (json_is_object(value))
        assert_members_described(value, schema, name);
    json_array_foreach(value, index, item)
        assert_described(item, json_object_get(schema, "items"), name);
}

// The body of the answer before against the schema of the document for it.
static void assert_body_described(const char *template, const char *method, const char *status)
{
    char place[200] = "#/paths/", *end = place + strlen(place);
    json_t *root = helper_json(&ask_response);

    for (; *template != '\0'; template ++)
        end += sprintf(end, *template == '/' ? "~1" : "%c", *template);
    snprintf(end, (size_t)(place + sizeof place - end), "/%s/responses/%s", method, status);
    json_t *content = json_object_get(follow(find(place)), "content");
    json_t *of_type =
        json_object_get(content, status[0] < '4' ? "application/json" : "application/problem+json");
    assert_described(root, json_object_get(of_type, "schema"), place);
    json_decref(root);
}

static void every_member_of_an_answer_is_described(void **state)
{
    static const struct {
        const char *template, *path, *query;
    } asked[] = {
        { "/v1/runs", "/v1/runs", NULL },
        { "/v1/runs/{id}", RUN_1, NULL },
        { "/v1/runs/{id}/curve", RUN_1 "/curve", NULL },
        { "/v1/runs/{id}/snapshots", RUN_1 "/snapshots", NULL },
        { "/v1/runs/{id}/snapshots/{n}.json", RUN_1 "/snapshots/0.json", NULL },
        { "/v1/runs/{id}/parts/{n}.json", RUN_1 "/parts/0.json", NULL },
        { "/v1/studies", "/v1/studies", NULL },
        { "/v1/studies/{id}", STUDY_1, NULL },
        { "/v1/studies/{id}/trials", STUDY_1 "/trials", NULL },
        { "/v1/compare", "/v1/compare", "a=" ID_1 "&b=" ID_2 },
        { "/v1/compare", "/v1/compare", "runs=" ID_1 "," ID_2 },
        { "/v1/measurements", "/v1/measurements", NULL },
        { "/v1/measurements/{id}", "/v1/measurements/0190a0b0-0000-7000-9000-000000000001", NULL },
        { "/v1/examples", "/v1/examples", NULL },
        { "/v1/examples/{name}", "/v1/examples/mixed-cargo", NULL },
        { "/livez", "/livez", NULL },
        { "/readyz", "/readyz", NULL },
        { "/version", "/version", NULL },
        { "/openapi.json", "/openapi.json", NULL },
    };

    ask_set_up(state);
    helper_run *of = ask_add_run(RUN_FAILED);
    of->record.error = (bf_error){ .code = BF_ENUMERIC, .text = "not finite" };
    ask_add_run(RUN_SUCCEEDED);
    helper_add_measurement(&ask_daemon, "upstream");
    helper_add_trial(helper_add_study(&ask_daemon, API_STUDY_RUNNING), API_TRIAL_SUCCEEDED);
    of->parts = (api_parts){ .n_parts = 2, .n_values = 6 };
    for (size_t k = 0; k < sizeof asked / sizeof *asked; k++) {
        ask_get(asked[k].path, asked[k].query, NULL, 200);
        assert_body_described(asked[k].template, "get", "200");
    }
    ask("POST", "/v1/runs", NULL, IS_JSON, BODY, 201);
    assert_body_described("/v1/runs", "post", "201");
    ask("POST", "/v1/validate", NULL, IS_JSON, BODY, 200);
    assert_body_described("/v1/validate", "post", "200");
    ask("POST", "/v1/runs", NULL, IS_JSON, BAD_BODY, 422);
    assert_body_described("/v1/runs", "post", "422");
    ask_tear_down(state);
}

// What a study found, when each trial said how far its number is from the middle.
static void check_best(const char *method)
{
    static const char form[] = "{'base': {'scenario': " DOCUMENT_WITH(
        "'counters': [{'id': 'a', 'x_m': [0, 0.7]}]") "},"
                                                      "'parameters': [{'pointer': '/duration_s', "
                                                      "'range': [1, 3]}], 'method': {%s}}";
    char given[1000];
    bf_faults faults = { 0 };
    bf_buffer out = { 0 };
    study_document d;
    study *s = NULL;

    snprintf(given, sizeof given, form, method);
    bf_buffer quoted = document_quote(given);
    assert_int_equal(study_document_read(quoted.bytes, quoted.n, &d, &faults, NULL), BF_OK);
    const study_definition definition = study_document_definition(&d);
    assert_int_equal(study_create(&definition, &s, NULL), BF_OK);
    for (size_t k = 0; !study_is_ended(s); k = study_trials(s)) {
        assert_int_equal(study_advance(s, NULL), BF_OK);
        for (; k < study_trials(s); k++) {
            const double at = study_point_at(s, study_trial_at(s, k).point).at[0];
            study_tell(s, k, (const double[]){ fabs(at - 0.5), 1.0 });
        }
    }
    assert_int_equal(study_best_write(&d, s, &out, NULL), BF_OK);
    json_t *found = json_loadb(out.bytes, out.n, 0, NULL);
    assert_described(found, find("#/components/schemas/StudyBest"), "StudyBest");
    json_decref(found);
    study_destroy(s);
    study_document_fini(&d);
    buffer_fini(&out);
    buffer_fini(&quoted);
}

static void every_member_of_what_studies_find_is_described(void **unused)
{
    check_best("'type': 'grid'}, 'replications': 2, 'objectives': [{'figure': 'drained_at_s'}, "
               "{'figure': 'jam.count'}], 'limits': {'trials': 20");
    check_best("'type': 'screen', 'confirm': 2, 'points': 4, 'indifference': 0.1}, 'replications': "
               "2, 'objectives': [{'figure': 'drained_at_s'}], 'limits': {'trials': 20");
    check_best("'type': 'calibrate', 'points': 2}, 'curves': [{'counter': 'a', 't_s': [0, 1], "
               "'count': [1, 0]}], 'limits': {'trials': 20");
}

static json_int_t number_at(const char *place)
{
    json_t *value = find(place);

    if (!json_is_integer(value))
        fail_msg("no whole number at %s", place);
    return json_integer_value(value);
}

static const json_t *query_parameter(const char *place, const char *name)
{
    json_t *item;
    size_t index;

    json_array_foreach(find(place), index, item)
    {
        if (strcmp(json_string_value(json_object_get(item, "name")), name) == 0)
            return json_object_get(item, "schema");
    }
    fail_msg("%s has no %s", place, name);
    return NULL;
}

static void limits_are_those_of_the_code(void **unused)
{
    const json_t *limit = query_parameter("#/paths/~1v1~1runs/get/parameters", "limit");
    const json_t *label = query_parameter("#/paths/~1v1~1runs/get/parameters", "label");
    const json_t *wait = query_parameter("#/paths/~1v1~1runs~1{id}/get/parameters", "wait");
    const json_t *width =
        query_parameter("#/paths/~1v1~1runs~1{id}~1snapshots~1{n}.png/get/parameters", "width");
    const json_t *runs = query_parameter("#/paths/~1v1~1events/get/parameters", "runs");

    assert_int_equal(json_integer_value(json_object_get(limit, "maximum")), API_LIST_MAX);
    assert_int_equal(json_integer_value(json_object_get(wait, "maximum")), API_WAIT_MAX_S);
    assert_int_equal(json_integer_value(json_object_get(width, "maximum")), PICTURE_WIDTH_MAX);
    assert_int_equal(json_integer_value(json_object_get(label, "maxLength")), API_LABEL_SIZE - 1);
    assert_int_equal(json_integer_value(json_object_get(runs, "maxItems")), API_STREAM_RUNS_MAX);
    assert_int_equal(number_at("#/components/schemas/CounterId/maxLength"), SCENE_ID_SIZE - 1);
    assert_int_equal(number_at("#/components/schemas/Counter/properties/id/maxLength"),
                     SCENE_ID_SIZE - 1);
    assert_int_equal(number_at("#/components/schemas/Submission/properties/priority/minimum"),
                     -API_PRIORITY_MAX);
}

static void types_are_short_texts(void **unused)
{
    static const struct {
        const char *type, *schema;
    } pairs[] = {
        { "number", "{\"type\":\"number\"}" },
        { "string?", "{\"type\":[\"string\",\"null\"]}" },
        { "=so", "{\"type\":\"string\",\"const\":\"so\"}" },
        { "#Run", "{\"$ref\":\"#/components/schemas/Run\"}" },
        { "#Run?", "{\"anyOf\":[{\"$ref\":\"#/components/schemas/Run\"},{\"type\":\"null\"}]}" },
        { "[number]", "{\"type\":\"array\",\"items\":{\"type\":\"number\"}}" },
        { "[number 2]",
          "{\"type\":\"array\",\"items\":{\"type\":\"number\"},\"minItems\":2,\"maxItems\":2}" },
        { "[number? 1-32]", "{\"type\":\"array\",\"items\":{\"type\":[\"number\",\"null\"]},"
                            "\"minItems\":1,\"maxItems\":32}" },
        { "[[number?]?]?",
          "{\"anyOf\":[{\"type\":\"array\",\"items\":{\"anyOf\":[{\"type\":\"array\",\"items\":"
          "{\"type\":[\"number\",\"null\"]}},{\"type\":\"null\"}]}},{\"type\":\"null\"}]}" },
    };

    for (size_t k = 0; k < sizeof pairs / sizeof *pairs; k++) {
        bf_buffer out = { 0 };
        json_out w = json_out_to(&out);
        schema_write(&w, pairs[k].type, NULL, NULL);
        assert_string_equal(out.bytes, pairs[k].schema);
        buffer_fini(&out);
    }
}

static void without_memory_nothing_is_written(void **unused)
{
    bf_buffer out = { 0 };
    bf_status status;
    size_t n = 0;

    do {
        n = HELPER_AMOUNT_NEXT_FAULT(n);
        memory_plan_fault(n, 0);
        status = openapi_write(&out, NULL);
        if (status != BF_OK) {
            assert_int_equal(status, BF_ENOMEM);
            assert_int_equal(out.n, 0);
        }
    } while (status != BF_OK);
    memory_plan_fault(0, 0);
    assert_true(n > 10);
    assert_int_equal(out.n, text.n);
    buffer_fini(&out);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_document_in_the_tree_is_up_to_date),
        cmocka_unit_test(no_two_operations_have_the_same_name),
        cmocka_unit_test(every_format_has_a_schema),
        cmocka_unit_test(what_is_referred_to_is_there_and_all_of_it_is_used),
        cmocka_unit_test(every_member_of_an_answer_is_described),
        cmocka_unit_test(every_member_of_what_studies_find_is_described),
        cmocka_unit_test(limits_are_those_of_the_code),
        cmocka_unit_test(types_are_short_texts),
        cmocka_unit_test(without_memory_nothing_is_written),
    };
    return cmocka_run_group_tests(tests, write_document, drop_document);
}
