#include "api/json/json_in.h"

#include "api/json/json_scan.h"
#include "api/json/text.h"
#include "core/base/check.h"
#include "core/base/memory.h"

#include <jansson.h>
#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// Where memory fails jansson may drop bytes of a string without a word, or call it a wrong token, so
// its allocator remembers for it.
static _Thread_local bool allocation_failed;

static void *allocate(size_t n)
{
    void *block = memory_alloc_plain(n);

    if (block == NULL)
        allocation_failed = true;
    return block;
}

// Before main(), as no other thread may be inside jansson meanwhile.
__attribute__((constructor)) static void set_allocator(void)
{
    json_set_alloc_funcs(allocate, free);
}

void json_in_seed(size_t seed)
{
    json_object_seed(seed);
}

json_in json_in_to(bf_faults *faults)
{
    return (json_in){ .faults = faults };
}

bf_status json_in_status(const json_in *in, bf_error *err)
{
    const bf_error *failure = in->texts != NULL ? &in->texts->failure : NULL;

    if (!in->has_failed)
        return faults_status(in->faults, err);
    if (failure != NULL && failure->code != BF_OK)
        return bf_fail(err, failure->code, failure->pointer, "%s", failure->text);
    return bf_fail_memory(err);
}

static void format_clean(char *text, size_t size, const char *format, va_list args)
{
    vsnprintf(text, size, format, args);
    for (char *at = text; *at != '\0'; at++) {
        if ((unsigned char)*at < 0x20 || *at == 0x7f)
            *at = '?';
    }
}

void json_in_fault(json_in *in, const char *format, ...)
{
    char text[BF_TEXT_SIZE];
    va_list args;

    va_start(args, format);
    format_clean(text, sizeof text, format, args);
    va_end(args);
    faults_add(in->faults, in->pointer.text, "%s", text);
}

void json_in_fault_limit(json_in *in, const char *format, ...)
{
    char text[BF_TEXT_SIZE];
    va_list args;

    va_start(args, format);
    format_clean(text, sizeof text, format, args);
    va_end(args);
    faults_add_limit(in->faults, in->pointer.text, "%s", text);
}

// True if the text may hold JSON: no level too deep, no NaN.
static bool check_scan(json_in *in, const char *json, size_t n)
{
    json_in at = *in;
    json_scan_place place;

    json_scan_end end = json_scan(json, n, &place, at.pointer.text, sizeof at.pointer.text);
    if (end == JSON_SCAN_TOO_DEEP)
        json_in_fault_limit(&at, "line %zu, column %zu: nested deeper than %d levels", place.line,
                            place.column, JSON_NESTING_MAX);
    if (end == JSON_SCAN_NO_NUMBER)
        json_in_fault(&at, "line %zu, column %zu: NaN and Infinity are no JSON numbers", place.line,
                      place.column);
    return end == JSON_SCAN_ALL;
}

// Faults of one value or key have their own pointer; all else concerns the whole document.
static void note_syntax(json_in *in, const char *json, size_t n, const json_error_t *error)
{
    json_in at = *in;
    json_scan_place place;
    enum json_error_code code = json_error_code(error);
    size_t position = error->position < 0 ? 0 : (size_t)error->position;
    const bool has_null = code == json_error_null_character || code == json_error_null_byte_in_key;
    const bool is_json =
        has_null || code == json_error_duplicate_key || code == json_error_numeric_overflow;

    if (is_json)
        json_scan(json, position < n ? position : n, &place, at.pointer.text,
                  sizeof at.pointer.text);
    // Jansson's own words for U+0000 name its flags, or say that keys are not supported.
    json_in_fault(&at, "line %d, column %d: %s%s", error->line, error->column,
                  is_json ? "" : "not JSON: ", has_null ? "\\u0000 is not allowed" : error->text);
}

struct json_t *json_in_parse(json_in *in, const char *json, size_t n)
{
    size_t flags = JSON_REJECT_DUPLICATES | JSON_DECODE_ANY | JSON_DECODE_INT_AS_REAL;
    json_error_t error;

    if (!check_scan(in, json, n))
        return NULL;
    allocation_failed = false;
    json_t *root = json_loadb(json == NULL ? "" : json, n, flags, &error);
    if (root != NULL && !allocation_failed)
        return root;
    if (allocation_failed)
        in->has_failed = true;
    else
        note_syntax(in, json, n, &error);
    json_decref(root);
    return NULL;
}

void json_in_free(struct json_t *root)
{
    json_decref(root);
}

static const char *name_type(const json_t *value)
{
    switch (json_typeof(value)) {
    case JSON_OBJECT:
        return "an object";
    case JSON_ARRAY:
        return "an array";
    case JSON_STRING:
        return "a string";
    case JSON_INTEGER:
    case JSON_REAL:
        return "a number";
    case JSON_NULL:
        return "null";
    default:
        return "a boolean";
    }
}

static bool refuse_type(json_in *in, const char *wanted, const json_t *value)
{
    json_in_fault(in, "must be %s, not %s", wanted, name_type(value));
    return false;
}

bool json_in_is_object(json_in *in, const struct json_t *value)
{
    return json_is_object(value) || refuse_type(in, "an object", value);
}

bool json_in_is_array(json_in *in, const struct json_t *value)
{
    return json_is_array(value) || refuse_type(in, "an array", value);
}

bool json_in_number(json_in *in, const struct json_t *value, double *ret_number)
{
    if (!json_is_number(value))
        return refuse_type(in, "a number", value);
    *ret_number = json_number_value(value);
    return true;
}

bool json_in_bool(json_in *in, const struct json_t *value, bool *ret_bool)
{
    if (!json_is_boolean(value))
        return refuse_type(in, "true or false", value);
    *ret_bool = json_is_true(value);
    return true;
}

bool json_in_integer(json_in *in, const struct json_t *value, double least, double most,
                     double *ret_integer)
{
    double number;

    if (!json_is_number(value))
        return refuse_type(in, "a whole number", value);
    number = json_number_value(value);
    if (number != floor(number)) {
        json_in_fault(in, "must be a whole number, not %.15g", number);
        return false;
    }
    if (number < least || number > most) {
        json_in_fault(in, "must be from %.16g to %.16g, not %.16g", least, most, number);
        faults_set_limit(in->faults, number, number < least ? least : most);
        return false;
    }
    *ret_integer = number;
    return true;
}

static bool has_control(const char *text, size_t n)
{
    for (size_t k = 0; k < n; k++) {
        if ((unsigned char)text[k] < 0x20 || text[k] == 0x7f)
            return true;
    }
    return false;
}

bool json_in_text(json_in *in, const struct json_t *value, size_t least, size_t size,
                  char *ret_text)
{
    if (!json_is_string(value))
        return refuse_type(in, "a string", value);
    size_t n = json_string_length(value);
    if (n >= size) {
        json_in_fault_limit(in, "has %zu bytes, the limit is %zu", n, size - 1);
        return false;
    }
    if (n < least) {
        json_in_fault(in, "must not be empty");
        return false;
    }
    if (has_control(json_string_value(value), n)) {
        json_in_fault(in, "must not have control characters");
        return false;
    }
    memcpy(ret_text, json_string_value(value), n + 1);
    return true;
}

bool json_in_stored_text(json_in *in, const struct json_t *value, const char *kind, bf_buffer *out)
{
    const size_t n_before = out->n;
    bf_error err = { .code = BF_OK };

    if (!json_is_string(value))
        return refuse_type(in, "an id", value);
    if (in->texts == NULL) {
        json_in_fault(in,
                      "names a stored measurement, which needs a daemon: give the lists or csv");
        return false;
    }
    const bf_status status =
        in->texts->read(in->texts->context, json_string_value(value), kind, out, &err);
    if (status == BF_OK && out->n - n_before <= in->texts->n_left) {
        in->texts->n_left -= out->n - n_before;
        return true;
    }
    if (status == BF_OK) {
        json_in_fault_limit(in, "has %zu bytes: too many with those of the measurements before it",
                            out->n - n_before);
    } else if (status == BF_EINPUT) {
        json_in_fault(in, "%s", err.text);
    } else {
        in->texts->failure = err;
        in->has_failed = true;
    }
    return false;
}

// Returns false if there is no room for all.
static bool list_words(char *text, size_t size, const char *separator, const char *quote,
                       const char *const *words)
{
    size_t n = 0;

    text[0] = '\0';
    for (size_t k = 0; words[k] != NULL && n < size; k++)
        n += (size_t)snprintf(text + n, size - n, "%s%s%s%s", k == 0 ? "" : separator, quote,
                              words[k], quote);
    return n < size;
}

bool json_in_word(json_in *in, const struct json_t *value, const char *const *words,
                  unsigned *ret_index)
{
    const char *word = json_string_value(value);
    const size_t k = word == NULL ? 0 : text_find_word(words, SIZE_MAX, word);
    char list[BF_TEXT_SIZE];

    if (word != NULL && words[k] != NULL) {
        *ret_index = (unsigned)k;
        return true;
    }
    // Of many words nothing but the words, so that all are told.
    if (!list_words(list, 128, ", ", "\"", words)) {
        (void)list_words(list, sizeof list, " ", "", words);
        json_in_fault(in, "must be one of %s", list);
    } else if (word == NULL) {
        json_in_fault(in, "must be one of %s, not %s", list, name_type(value));
    } else {
        json_in_fault(in, "must be one of %s, not \"%.60s\"", list, word);
    }
    return false;
}

static bool check_length(json_in *in, size_t n, size_t least, size_t most)
{
    if (n >= least && n <= most)
        return true;
    if (least == most)
        json_in_fault(in, "must have %zu numbers, not %zu", least, n);
    else
        json_in_fault(in, "must have %zu to %zu numbers, not %zu", least, most, n);
    return false;
}

bool json_in_tuple(json_in *in, const struct json_t *value, size_t least, size_t most,
                   double *ret_numbers, size_t *ret_n)
{
    double numbers[4];
    bool is_read = true;

    BF_CHECK(most <= sizeof numbers / sizeof *numbers);
    if (!json_in_is_array(in, value))
        return false;
    size_t n = json_array_size(value);
    if (!check_length(in, n, least, most))
        return false;
    for (size_t k = 0; k < n; k++) {
        size_t mark = json_pointer_enter_index(&in->pointer, k);
        is_read &= json_in_number(in, json_array_get(value, k), &numbers[k]);
        json_pointer_leave(&in->pointer, mark);
    }
    if (!is_read)
        return false;
    memcpy(ret_numbers, numbers, n * sizeof *numbers);
    if (ret_n != NULL)
        *ret_n = n;
    return true;
}
