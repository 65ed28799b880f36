// The kinds of members that are one value: how each is read, written and described.

#include "api/json/json_priv.h"
#include "api/json/number.h"
#include "api/json/schema.h"
#include "core/base/check.h"

#include <inttypes.h>
#include <jansson.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#define SEED_MAX 9007199254740991.0 // 2^53 - 1

void member__describe_bounded(json_out *w, const char *type, const member *m, double most)
{
    json_out_key_string(w, "type", type);
    double maximum = m->range == NULL ? most : fmin(m->range->maximum, most);
    if (m->range != NULL && isfinite(m->range->minimum))
        json_out_key_number(w, m->range->excludes_min ? "exclusiveMinimum" : "minimum",
                            m->range->minimum);
    if (isfinite(maximum))
        json_out_key_number(
            w, m->range != NULL && m->range->excludes_max ? "exclusiveMaximum" : "maximum",
            maximum);
}

// ---- numbers

static void read_number(json_in *in, const json_t *value, const member *m, void *item)
{
    json_in_number(in, value, member__place(item, m));
}

static void write_number(json_out *w, const member *m, const void *item)
{
    json_out_number(w, *(const double *)member__value(item, m));
}

static void write_measure(json_out *w, const member *m, const void *item)
{
    json_out_measure(w, *(const double *)member__value(item, m));
}

static void describe_number(json_out *w, const member *m, member_view view)
{
    (void)view;
    member__describe_bounded(w, "number", m, INFINITY);
}

const member_kind member_number = { .text = "number",
                                    .type = "number",
                                    .read = read_number,
                                    .write = write_number,
                                    .write_schema = describe_number };

const member_kind member_measure = { .type = "number", .write = write_measure };

static void read_degrees(json_in *in, const json_t *value, const member *m, void *item)
{
    double degrees;

    if (json_in_number(in, value, &degrees))
        *(double *)member__place(item, m) = number_from_degrees(degrees);
}

static void write_degrees(json_out *w, const member *m, const void *item)
{
    json_out_number(w, number_to_degrees(*(const double *)member__value(item, m)));
}

const member_kind member_degrees = {
    .text = "number", .read = read_degrees, .write = write_degrees, .write_schema = describe_number
};

static void read_step(json_in *in, const json_t *value, const member *m, void *item)
{
    double step;

    if (json_is_string(value) && strcmp(json_string_value(value), "auto") == 0) {
        *(double *)member__place(item, m) = 0.0;
    } else if (!json_is_number(value)) {
        json_in_fault(in, "must be a number or \"auto\"");
    } else if (json_in_number(in, value, &step)) {
        if (step == 0.0) // would mean "auto" in the struct
            json_in_fault(in, "must be > 0 or \"auto\"");
        else
            *(double *)member__place(item, m) = step;
    }
}

static void write_step(json_out *w, const member *m, const void *item)
{
    double step = *(const double *)member__value(item, m);

    if (step == 0.0)
        json_out_string(w, "auto");
    else
        json_out_number(w, step);
}

static void describe_step(json_out *w, const member *m, member_view view)
{
    (void)view;
    json_out_key(w, "oneOf");
    json_out_array(w);
    json_out_object(w);
    member__describe_bounded(w, "number", m, INFINITY);
    json_out_object_end(w);
    schema_write(w, "=auto", NULL, NULL);
    json_out_array_end(w);
}

const member_kind member_step = { .text = "number or \"auto\"",
                                  .read = read_step,
                                  .write = write_step,
                                  .write_schema = describe_step };

// ---- whole numbers

static void read_count(json_in *in, const json_t *value, const member *m, void *item)
{
    double number;

    if (json_in_integer(in, value, 0, UINT32_MAX, &number))
        *(uint32_t *)member__place(item, m) = (uint32_t)number;
}

static void write_count(json_out *w, const member *m, const void *item)
{
    json_out_integer(w, *(const uint32_t *)member__value(item, m));
}

static void describe_count(json_out *w, const member *m, member_view view)
{
    (void)view;
    member__describe_bounded(w, "integer", m, UINT32_MAX);
}

const member_kind member_count = { .text = "whole number",
                                   .type = "#Count",
                                   .read = read_count,
                                   .write = write_count,
                                   .write_schema = describe_count };

static void describe_integer(json_out *w, const member *m, member_view view)
{
    (void)view;
    member__describe_bounded(w, "integer", m, INFINITY);
}

static void read_seed(json_in *in, const json_t *value, const member *m, void *item)
{
    const double least = m->range == NULL ? 0.0 : m->range->minimum;
    const double most = m->range == NULL ? SEED_MAX : m->range->maximum;
    double number;

    if (json_in_integer(in, value, least, most, &number))
        *(uint64_t *)member__place(item, m) = (uint64_t)number;
}

static void write_size(json_out *w, const member *m, const void *item)
{
    json_out_integer(w, (int64_t) * (const uint64_t *)member__value(item, m));
}

const member_kind member_seed = {
    .text = "whole number", .read = read_seed, .write = write_size, .write_schema = describe_integer
};

const member_kind member_size = { .type = "#Count", .read = read_seed, .write = write_size };

static void read_whole(json_in *in, const json_t *value, const member *m, void *item)
{
    json_in_integer(in, value, 0, SEED_MAX, member__place(item, m));
}

const member_kind member_whole = { .text = "whole number",
                                   .read = read_whole,
                                   .write = write_number,
                                   .write_schema = describe_integer };

static void read_int(json_in *in, const json_t *value, const member *m, void *item)
{
    double number;

    if (json_in_integer(in, value, m->range->minimum, m->range->maximum, &number))
        *(int *)member__place(item, m) = (int)number;
}

static void write_int(json_out *w, const member *m, const void *item)
{
    json_out_integer(w, *(const int *)member__value(item, m));
}

const member_kind member_int = { .text = "whole number",
                                 .type = "integer",
                                 .read = read_int,
                                 .write = write_int,
                                 .write_schema = describe_integer };

// ---- booleans, texts and words

static void read_bool(json_in *in, const json_t *value, const member *m, void *item)
{
    json_in_bool(in, value, member__place(item, m));
}

static void write_bool(json_out *w, const member *m, const void *item)
{
    json_out_bool(w, *(const bool *)member__value(item, m));
}

const member_kind member_bool = {
    .text = "boolean", .type = "boolean", .read = read_bool, .write = write_bool
};

static void read_either(json_in *in, const json_t *value, const member *m, void *item)
{
    unsigned index;

    if (json_in_word(in, value, m->words, &index))
        *(bool *)member__place(item, m) = index == 1;
}

static void write_either(json_out *w, const member *m, const void *item)
{
    json_out_string(w, m->words[*(const bool *)member__value(item, m) ? 1 : 0]);
}

static void read_flag(json_in *in, const json_t *value, const member *m, void *item)
{
    bool flag;

    if (json_in_bool(in, value, &flag))
        *(double *)member__place(item, m) = flag ? 1.0 : 0.0;
}

static void write_flag(json_out *w, const member *m, const void *item)
{
    json_out_bool(w, *(const double *)member__value(item, m) != 0.0);
}

const member_kind member_flag = {
    .text = "boolean", .type = "boolean", .read = read_flag, .write = write_flag
};

static void read_text(json_in *in, const json_t *value, const member *m, void *item)
{
    json_in_text(in, value, m->least, m->limit, member__place(item, m));
}

static void write_text(json_out *w, const member *m, const void *item)
{
    json_out_string(w, member__value(item, m));
}

static void describe_text(json_out *w, const member *m, member_view view)
{
    (void)view;
    json_out_key_string(w, "type", "string");
    if (m->least > 0)
        json_out_key_integer(w, "minLength", (int64_t)m->least);
    if (m->limit > 0)
        json_out_key_integer(w, "maxLength", (int64_t)m->limit - 1);
}

const member_kind member_text = { .text = "string",
                                  .type = "string",
                                  .read = read_text,
                                  .write = write_text,
                                  .write_schema = describe_text };

static void write_string(json_out *w, const member *m, const void *item)
{
    const char *text;

    memcpy(&text, member__value(item, m), sizeof text);
    json_out_string(w, text);
}

const member_kind member_string = { .type = "string", .write = write_string };

static void read_enum(json_in *in, const json_t *value, const member *m, void *item)
{
    unsigned index; // enums of the structs are unsigned

    if (json_in_word(in, value, m->words, &index))
        memcpy(member__place(item, m), &index, sizeof index);
}

static void write_enum(json_out *w, const member *m, const void *item)
{
    unsigned index;

    memcpy(&index, member__value(item, m), sizeof index);
    json_out_string(w, m->words[index]);
}

static void describe_enum(json_out *w, const member *m, member_view view)
{
    (void)view;
    json_out_key_string(w, "type", "string");
    json_out_key(w, "enum");
    json_out_array(w);
    for (const char *const *word = m->words; *word != NULL; word++)
        json_out_string(w, *word);
    json_out_array_end(w);
}

const member_kind member_enum = { .read = read_enum,
                                  .write = write_enum,
                                  .write_schema = describe_enum };

const member_kind member_either = { .read = read_either,
                                    .write = write_either,
                                    .write_schema = describe_enum };

static void write_link(json_out *w, const member *m, const void *item)
{
    char url[MEMBER_TEXT_SIZE];
    size_t n = 0;

    for (const char *at = m->path; *at != '\0'; at++) {
        size_t room = sizeof url - n;
        uint64_t number;
        if (strncmp(at, "{id}", 4) == 0) {
            n += (size_t)snprintf(url + n, room, "%s", (const char *)member__value(item, m));
            at += 3;
        } else if (strncmp(at, "{n}", 3) == 0) {
            memcpy(&number, (const char *)item + m->offset_n, sizeof number);
            n += (size_t)snprintf(url + n, room, "%" PRIu64, number);
            at += 2;
        } else {
            url[n++] = *at;
        }
        BF_CHECK(n < sizeof url);
    }
    url[n] = '\0';
    json_out_string(w, url);
}

const member_kind member_link = { .type = "#Path", .write = write_link };

static void write_time(json_out *w, const member *m, const void *item)
{
    json_out_time(w, *(const int64_t *)member__value(item, m));
}

const member_kind member_time = { .type = "#Time", .write = write_time };

static void write_raw(json_out *w, const member *m, const void *item)
{
    const char *json;

    memcpy(&json, member__value(item, m), sizeof json);
    json_out_raw(w, json, member__count(item, m));
}

const member_kind member_raw = { .type = "object", .write = write_raw };

const member_kind member_described = { .type = "object" };
