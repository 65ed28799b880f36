#include "api/http/param.h"

#include "api/json/moment.h"
#include "api/json/number.h"
#include "core/base/check.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

bool param_is_id(const char *text)
{
    static const char form[] = "xxxxxxxx-xxxx-xxxx-xxxx-xxxxxxxxxxxx";

    for (size_t i = 0; i < sizeof form - 1; i++) {
        bool fits = form[i] == '-' ? text[i] == '-'
                                   : text[i] != '\0' && strchr("0123456789abcdef", text[i]) != NULL;
        if (!fits)
            return false;
    }
    return text[sizeof form - 1] == '\0';
}

bf_status param_read(const param *row, const char *text, param_value *ret_value, bf_error *err)
{
    return row->kind->read == NULL ? BF_OK : row->kind->read(row, text, ret_value, err);
}

static bf_status read_text(const param *row, const char *text, param_value *ret_value,
                           bf_error *err)
{
    (void)ret_value;
    if (row->most == 0 || strlen(text) <= row->most)
        return BF_OK;
    return bf_fail(err, BF_EINPUT, "", "query parameter '%s' has more than %" PRIu64 " bytes",
                   row->name, row->most);
}

static void write_length(const param *row, json_out *w)
{
    if (row->most > 0)
        json_out_key_integer(w, "maxLength", (int64_t)row->most);
}

static bf_status read_word(const param *row, const char *text, param_value *ret_value,
                           bf_error *err)
{
    (void)ret_value;
    if (row->is_word(text))
        return BF_OK;
    if (row->list_words != NULL)
        return bf_fail(err, BF_EINPUT, "", "there is no %s '%.32s'; there is: %s", row->name, text,
                       row->list_words());
    return bf_fail(err, BF_EINPUT, "", "query parameter '%s' is no %s: '%.32s'", row->name,
                   row->name, text);
}

static bf_status read_whole(const param *row, const char *text, param_value *ret_value,
                            bf_error *err)
{
    uint64_t value = 0;

    if (!number_read_digits(text, row->least, row->most, &value))
        return bf_fail(err, BF_EINPUT, "",
                       "query parameter '%s' must be a whole number from %" PRIu64 " to %" PRIu64
                       ", not '%.64s'",
                       row->name, row->least, row->most, text);
    ret_value->whole = value;
    return BF_OK;
}

// The schema of a named type has the bounds.
static void write_whole_bounds(const param *row, json_out *w)
{
    if (row->type != NULL)
        return;
    json_out_key_integer(w, "minimum", (int64_t)row->least);
    json_out_key_integer(w, "maximum", (int64_t)row->most);
}

static void write_flag_values(const param *row, json_out *w)
{
    json_out_key(w, "enum");
    json_out_array(w);
    for (uint64_t value = row->least; value <= row->most; value++)
        json_out_integer(w, (int64_t)value);
    json_out_array_end(w);
}

static bf_status read_time(const param *row, const char *text, param_value *ret_value,
                           bf_error *err)
{
    int64_t ms = 0;

    if (!moment_read(text, &ms))
        return bf_fail(err, BF_EINPUT, "",
                       "query parameter '%s' must be a time in UTC as 2026-11-24T09:00:00Z, not "
                       "'%.64s'",
                       row->name, text);
    ret_value->whole = (uint64_t)ms;
    return BF_OK;
}

static bf_status read_real(const param *row, const char *text, param_value *ret_value,
                           bf_error *err)
{
    double value = 0.0;

    if (number_read(text, strlen(text), &value) != 0 || value < row->least_real ||
        value > row->most_real)
        return bf_fail(err, BF_EINPUT, "",
                       "query parameter '%s' must be a number from %g to %g, not '%.64s'",
                       row->name, row->least_real, row->most_real, text);
    ret_value->real = value;
    return BF_OK;
}

static void write_real_bounds(const param *row, json_out *w)
{
    json_out_key_number(w, "minimum", row->least_real);
    json_out_key_number(w, "maximum", row->most_real);
}

static bf_status refuse_id(const char *pointer, const char *text, size_t n, bf_error *err)
{
    return bf_fail(err, BF_ENOTFOUND, pointer, "there is nothing with the id '%.*s'",
                   n < 64 ? (int)n : 64, text);
}

static bf_status read_id(const param *row, const char *text, param_value *ret_value, bf_error *err)
{
    char pointer[BF_POINTER_SIZE];

    (void)ret_value;
    if (param_is_id(text))
        return BF_OK;
    snprintf(pointer, sizeof pointer, "/%s", row->name);
    return refuse_id(pointer, text, strlen(text), err);
}

static bf_status read_cursor(const param *row, const char *text, param_value *ret_value,
                             bf_error *err)
{
    (void)ret_value;
    if (param_is_id(text))
        return BF_OK;
    return bf_fail(err, BF_EINPUT, "", "query parameter '%s' is not from a `next` link", row->name);
}

// Reads the id of n bytes at text, which must not be among those before it.
static bf_status add_id(const param *row, const char *text, size_t n, param_value *value,
                        bf_error *err)
{
    char *id = value->ids.items[value->ids.n];
    char pointer[BF_POINTER_SIZE];

    snprintf(pointer, sizeof pointer, "/%s/%zu", row->name, value->ids.n);
    if (n != API_ID_SIZE - 1)
        return refuse_id(pointer, text, n, err);
    memcpy(id, text, n);
    id[n] = '\0';
    if (!param_is_id(id))
        return refuse_id(pointer, text, n, err);
    for (size_t i = 0; i < value->ids.n; i++) {
        if (strcmp(value->ids.items[i], id) == 0)
            return bf_fail(err, BF_EINPUT, "", "query parameter '%s' has '%s' twice", row->name,
                           id);
    }
    value->ids.n++;
    return BF_OK;
}

static bf_status read_ids(const param *row, const char *text, param_value *ret_value, bf_error *err)
{
    param_value value = { .ids = { .n = 0 } };

    BF_CHECK(row->least <= 2 && row->most <= API_STREAM_RUNS_MAX);
    if (*text == '\0')
        return bf_fail(err, BF_EINPUT, "", "query parameter '%s' is missing: ids with commas",
                       row->name);
    for (bool is_last = false; !is_last;) {
        size_t n = strcspn(text, ",");
        if (value.ids.n == row->most)
            return bf_fail(err, BF_EINPUT, "", "query parameter '%s' has more than %" PRIu64 " ids",
                           row->name, row->most);
        BF_TRY(add_id(row, text, n, &value, err));
        is_last = text[n] == '\0';
        text += n + 1;
    }
    if (value.ids.n < row->least)
        return bf_fail(err, BF_EINPUT, "", "query parameter '%s' needs two ids at least",
                       row->name);
    *ret_value = value;
    return BF_OK;
}

static void write_ids_bounds(const param *row, json_out *w)
{
    json_out_key_integer(w, "minItems", (int64_t)row->least);
    json_out_key_integer(w, "maxItems", (int64_t)row->most);
    json_out_key_bool(w, "uniqueItems", true);
}

const param_kind param_text = { "string", read_text, write_length };
const param_kind param_member = { "string", NULL, write_length };
const param_kind param_word = { NULL, read_word, NULL };
const param_kind param_format = { NULL, NULL, NULL };
const param_kind param_whole = { "integer", read_whole, write_whole_bounds };
const param_kind param_flag = { "integer", read_whole, write_flag_values };
const param_kind param_time = { "#Time", read_time, NULL };
const param_kind param_real = { "number", read_real, write_real_bounds };
const param_kind param_id = { "#Id", read_id, NULL };
const param_kind param_cursor = { "#Id", read_cursor, NULL };
const param_kind param_ids = { "[#Id]", read_ids, write_ids_bounds };
