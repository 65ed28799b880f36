#include "api/scenario/condition.h"

#include "api/json/json_pointer.h"
#include "api/json/number.h"

#include <jansson.h>
#include <math.h>
#include <string.h>

static const double six_digits = 1e-6;

static const char *skip_blanks(const char *text)
{
    return text + strspn(text, " ");
}

// Reads one condition of n bytes; k counts from 1.
static bf_status read_one(const char *text, size_t n, size_t k, api_conditions *to, bf_error *err)
{
    static const struct {
        const char *text;
        api_relation relation;
    } relations[] = { { "<=", API_AT_MOST },
                      { ">=", API_AT_LEAST },
                      { "<", API_LESS },
                      { ">", API_GREATER },
                      { "=", API_EQUAL } };
    const size_t n_relations = sizeof relations / sizeof relations[0];
    const char *const end = text + n;
    const char *at = text + strcspn(text, "<>="), *name = skip_blanks(text);
    size_t n_name = (size_t)(at - name), r = 0;

    while (n_name > 0 && name[n_name - 1] == ' ')
        n_name--;
    if (at >= end || n_name == 0)
        return bf_fail(err, BF_EINPUT, "",
                       "condition %zu must be a name, <, <=, =, >= or >, and a number, not '%.*s'",
                       k, n < 64 ? (int)n : 64, text);
    if (n_name >= API_CONDITION_NAME_SIZE)
        return bf_fail(err, BF_EINPUT, "", "the name in condition %zu has more than %d bytes", k,
                       API_CONDITION_NAME_SIZE - 1);
    while (r < n_relations && strncmp(at, relations[r].text, strlen(relations[r].text)) != 0)
        r++;
    at = skip_blanks(at + strlen(relations[r].text));
    size_t n_number = at < end ? (size_t)(end - at) : 0;
    while (n_number > 0 && at[n_number - 1] == ' ')
        n_number--;
    double number;
    if (number_read(at, n_number, &number) != 0)
        return bf_fail(err, BF_EINPUT, "", "condition %zu ends in '%.*s', which is no number", k,
                       n_number < 64 ? (int)n_number : 64, at);
    memcpy(to->items[to->n].name, name, n_name);
    to->items[to->n].relation = relations[r].relation;
    to->items[to->n++].number = number;
    return BF_OK;
}

bf_status condition_list_read(const char *text, api_conditions *ret_conditions, bf_error *err)
{
    api_conditions conditions = { 0 };

    for (bool is_last = false; !is_last;) {
        const size_t n = strcspn(text, ",");
        if (conditions.n == API_CONDITIONS_MAX)
            return bf_fail(err, BF_EINPUT, "", "there are more than %d conditions",
                           API_CONDITIONS_MAX);
        BF_TRY(read_one(text, n, conditions.n + 1, &conditions, err));
        is_last = text[n] == '\0';
        text += n + 1;
    }
    *ret_conditions = conditions;
    return BF_OK;
}

// The search of documents for numbers.
typedef struct number_search {
    const api_conditions *conditions;
    bool holds[API_CONDITIONS_MAX];
    json_pointer pointer; // of what is looked at
} number_search;

static bool is_named(const char *pointer, const char *name)
{
    const size_t n = strlen(pointer), n_name = strlen(name);

    if (*name == '/')
        return strcmp(pointer, name) == 0;
    return n > n_name && pointer[n - n_name - 1] == '/' && strcmp(pointer + n - n_name, name) == 0;
}

// What was computed, as an angle from two ends, and what was typed are equal to six digits, in all relations.
static bool is_so(double number, api_relation relation, double limit)
{
    const bool is_equal = fabs(number - limit) <= six_digits * fmax(fabs(number), fabs(limit));

    switch (relation) {
    case API_LESS:
        return number < limit && !is_equal;
    case API_AT_MOST:
        return number < limit || is_equal;
    case API_EQUAL:
        return is_equal;
    case API_AT_LEAST:
        return number > limit || is_equal;
    case API_GREATER:
        return number > limit && !is_equal;
    }
    return false;
}

static void note_number(number_search *s, double number)
{
    for (size_t k = 0; k < s->conditions->n; k++) {
        if (is_named(s->pointer.text, s->conditions->items[k].name) &&
            is_so(number, s->conditions->items[k].relation, s->conditions->items[k].number))
            s->holds[k] = true;
    }
}

static void note_said_otherwise(number_search *s, const char *name, double number)
{
    const size_t mark = json_pointer_enter(&s->pointer, name, strlen(name));

    note_number(s, number);
    json_pointer_leave(&s->pointer, mark);
}

// Two numbers of a list. False: it has not as many.
static bool read_pair(const json_t *list, double ret_pair[2])
{
    for (size_t i = 0; i < 2; i++)
        ret_pair[i] = json_number_value(json_array_get(list, i));
    return json_array_size(list) == 2;
}

// The angle of a plate and the speed of a belt where the document has them by other members.
static void note_derived(number_search *s, const json_t *object)
{
    const json_t *path = json_object_get(object, "path_m");
    double from[2], to[2], velocity[2];

    if (json_array_size(path) == 2 && json_object_get(object, "motion") == NULL &&
        read_pair(json_array_get(path, 0), from) && read_pair(json_array_get(path, 1), to))
        note_said_otherwise(s, "angle_deg",
                            number_to_degrees(atan2(to[1] - from[1], to[0] - from[0])));
    if (read_pair(json_object_get(object, "velocity_m_s"), velocity))
        note_said_otherwise(s, "speed_m_s", hypot(velocity[0], velocity[1]));
}

// Documents of the store are as deep as the API lets them be.
static void search_value(number_search *s, json_t *value)
{
    const char *name;
    json_t *item;
    size_t i;

    if (json_is_number(value)) {
        note_number(s, json_number_value(value));
    } else if (json_is_object(value)) {
        note_derived(s, value);
        json_object_foreach(value, name, item)
        {
            const size_t mark = json_pointer_enter(&s->pointer, name, strlen(name));
            search_value(s, item);
            json_pointer_leave(&s->pointer, mark);
        }
    } else {
        json_array_foreach(value, i, item)
        {
            const size_t mark = json_pointer_enter_index(&s->pointer, i);
            search_value(s, item);
            json_pointer_leave(&s->pointer, mark);
        }
    }
}

bf_status condition_list_hold(const api_conditions *conditions, const char *const *documents,
                              const size_t *lengths, size_t n, bool *ret_hold, bf_error *err)
{
    number_search search = { .conditions = conditions };

    for (size_t d = 0; d < n; d++) {
        json_error_t error;
        json_t *root = json_loadb(documents[d], lengths[d], JSON_DECODE_ANY, &error);
        if (root == NULL && json_error_code(&error) == json_error_out_of_memory)
            return bf_fail_memory(err);
        search_value(&search, root);
        json_decref(root);
    }
    *ret_hold = true;
    for (size_t k = 0; k < conditions->n; k++)
        *ret_hold = *ret_hold && search.holds[k];
    return BF_OK;
}
