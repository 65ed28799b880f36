// The kinds of members: how a value of each is read, written and described.

#include "api/json/members.h"
#include "api/json/number.h"
#include "api/json/schema.h"
#include "core/base/check.h"
#include "core/base/grid.h"
#include "core/base/memory.h"
#include "core/base/vec2.h"
#include "core/scene/scene.h"

#include <inttypes.h>
#include <jansson.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#define SEED_MAX 9007199254740991.0 // 2^53 - 1

static void *place_of(void *item, const member *m)
{
    return (char *)item + m->offset;
}

static const void *value_of(const void *item, const member *m)
{
    return (const char *)item + m->offset;
}

static size_t count_of(const void *item, const member *m)
{
    size_t n;

    memcpy(&n, (const char *)item + m->offset_n, sizeof n);
    return n;
}

// The bounds of a number; most is the largest that the C type holds.
static void describe_range(json_out *w, const bf_range *range, double most)
{
    double maximum = range == NULL ? most : fmin(range->maximum, most);

    if (range != NULL && isfinite(range->minimum))
        json_out_key_number(w, range->excludes_min ? "exclusiveMinimum" : "minimum",
                            range->minimum);
    if (isfinite(maximum))
        json_out_key_number(
            w, range != NULL && range->excludes_max ? "exclusiveMaximum" : "maximum", maximum);
}

static void describe_bounded(json_out *w, const char *type, const member *m, double most)
{
    json_out_key_string(w, "type", type);
    describe_range(w, m->range, most);
}

// ---- numbers

static void read_number(json_in *in, const json_t *value, const member *m, void *item)
{
    json_in_number(in, value, place_of(item, m));
}

static void write_number(json_out *w, const member *m, const void *item)
{
    json_out_number(w, *(const double *)value_of(item, m));
}

static void describe_number(json_out *w, const member *m, member_view view)
{
    (void)view;
    describe_bounded(w, "number", m, INFINITY);
}

const member_kind member_number = { .text = "number",
                                    .type = "number",
                                    .read = read_number,
                                    .write = write_number,
                                    .write_schema = describe_number };

static void read_step(json_in *in, const json_t *value, const member *m, void *item)
{
    double step;

    if (json_is_string(value) && strcmp(json_string_value(value), "auto") == 0) {
        *(double *)place_of(item, m) = 0.0;
    } else if (!json_is_number(value)) {
        json_in_fault(in, "must be a number or \"auto\"");
    } else if (json_in_number(in, value, &step)) {
        if (step == 0.0) // would mean "auto" in the struct
            json_in_fault(in, "must be > 0 or \"auto\"");
        else
            *(double *)place_of(item, m) = step;
    }
}

static void write_step(json_out *w, const member *m, const void *item)
{
    double step = *(const double *)value_of(item, m);

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
    describe_bounded(w, "number", m, INFINITY);
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
        *(uint32_t *)place_of(item, m) = (uint32_t)number;
}

static void write_count(json_out *w, const member *m, const void *item)
{
    json_out_integer(w, *(const uint32_t *)value_of(item, m));
}

static void describe_count(json_out *w, const member *m, member_view view)
{
    (void)view;
    describe_bounded(w, "integer", m, UINT32_MAX);
}

const member_kind member_count = { .text = "whole number",
                                   .type = "#Count",
                                   .read = read_count,
                                   .write = write_count,
                                   .write_schema = describe_count };

static void describe_integer(json_out *w, const member *m, member_view view)
{
    (void)view;
    describe_bounded(w, "integer", m, INFINITY);
}

static void read_seed(json_in *in, const json_t *value, const member *m, void *item)
{
    double number;

    if (json_in_integer(in, value, 0, SEED_MAX, &number))
        *(uint64_t *)place_of(item, m) = (uint64_t)number;
}

static void write_size(json_out *w, const member *m, const void *item)
{
    json_out_integer(w, (int64_t) * (const uint64_t *)value_of(item, m));
}

const member_kind member_seed = {
    .text = "whole number", .read = read_seed, .write = write_size, .write_schema = describe_integer
};

const member_kind member_size = { .type = "#Count", .write = write_size };

static void read_int(json_in *in, const json_t *value, const member *m, void *item)
{
    double number;

    if (json_in_integer(in, value, m->range->minimum, m->range->maximum, &number))
        *(int *)place_of(item, m) = (int)number;
}

static void write_int(json_out *w, const member *m, const void *item)
{
    json_out_integer(w, *(const int *)value_of(item, m));
}

const member_kind member_int = { .text = "whole number",
                                 .type = "integer",
                                 .read = read_int,
                                 .write = write_int,
                                 .write_schema = describe_integer };

// ---- booleans, texts and words

static void read_bool(json_in *in, const json_t *value, const member *m, void *item)
{
    json_in_bool(in, value, place_of(item, m));
}

static void write_bool(json_out *w, const member *m, const void *item)
{
    json_out_bool(w, *(const bool *)value_of(item, m));
}

const member_kind member_bool = {
    .text = "boolean", .type = "boolean", .read = read_bool, .write = write_bool
};

static void read_text(json_in *in, const json_t *value, const member *m, void *item)
{
    json_in_text(in, value, m->least, m->limit, place_of(item, m));
}

static void write_text(json_out *w, const member *m, const void *item)
{
    json_out_string(w, value_of(item, m));
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

    memcpy(&text, value_of(item, m), sizeof text);
    json_out_string(w, text);
}

const member_kind member_string = { .type = "string", .write = write_string };

static void read_enum(json_in *in, const json_t *value, const member *m, void *item)
{
    unsigned index; // enums of the structs are unsigned

    if (json_in_word(in, value, m->words, &index))
        memcpy(place_of(item, m), &index, sizeof index);
}

static void write_enum(json_out *w, const member *m, const void *item)
{
    unsigned index;

    memcpy(&index, value_of(item, m), sizeof index);
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

static void write_link(json_out *w, const member *m, const void *item)
{
    char url[MEMBER_TEXT_SIZE];
    size_t n = 0;

    for (const char *at = m->path; *at != '\0'; at++) {
        size_t room = sizeof url - n;
        uint64_t number;
        if (strncmp(at, "{id}", 4) == 0) {
            n += (size_t)snprintf(url + n, room, "%s", (const char *)value_of(item, m));
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
    json_out_time(w, *(const int64_t *)value_of(item, m));
}

const member_kind member_time = { .type = "#Time", .write = write_time };

static void write_raw(json_out *w, const member *m, const void *item)
{
    const char *json;

    memcpy(&json, value_of(item, m), sizeof json);
    json_out_raw(w, json, count_of(item, m));
}

const member_kind member_raw = { .type = "object", .write = write_raw };

const member_kind member_described = { .type = "object" };

// ---- tuples and lists of numbers

static void describe_numbers(json_out *w, size_t least, size_t most)
{
    json_out_key_string(w, "type", "array");
    json_out_key(w, "items");
    json_out_object(w);
    json_out_key_string(w, "type", "number");
    json_out_object_end(w);
    json_out_key_integer(w, "minItems", (int64_t)least);
    json_out_key_integer(w, "maxItems", (int64_t)most);
}

static void read_pair(json_in *in, const json_t *value, const member *m, void *item)
{
    json_in_tuple(in, value, 2, 2, place_of(item, m), NULL);
}

static void write_pair(json_out *w, const member *m, const void *item)
{
    json_out_numbers(w, value_of(item, m), 2, 1);
}

static void describe_pair(json_out *w, const member *m, member_view view)
{
    (void)m;
    (void)view;
    describe_numbers(w, 2, 2);
}

const member_kind member_point = { .text = "[x, y]",
                                   .type = "#Pair",
                                   .read = read_pair,
                                   .write = write_pair,
                                   .write_schema = describe_pair };

const member_kind member_interval = {
    .text = "[from, to]", .read = read_pair, .write = write_pair, .write_schema = describe_pair
};

static void write_shape(json_out *w, const member *m, const void *item)
{
    const bf_grid *grid = value_of(item, m);

    json_out_array(w);
    json_out_integer(w, (int64_t)grid->n2);
    json_out_integer(w, (int64_t)grid->n1);
    json_out_array_end(w);
}

const member_kind member_shape = { .type = "#Shape2", .write = write_shape };

static void describe_length(json_out *w, const member *m)
{
    json_out_key_integer(w, "minItems", (int64_t)m->least);
    json_out_key_integer(w, "maxItems", (int64_t)m->limit);
}

// True if the value is a list of neither too few nor too many items, known before anything is
// allocated.
static bool check_list(json_in *in, const json_t *value, const member *m)
{
    size_t n = json_array_size(value);

    if (!json_is_array(value))
        return json_in_is_array(in, value);
    if (n < m->least)
        json_in_fault(in, "must have at least %zu items, not %zu", m->least, n);
    if (n > m->limit)
        json_in_fault_limit(in, "has %zu items, the limit is %zu", n, m->limit);
    return n >= m->least && n <= m->limit;
}

// Room for the items of a list, put into the struct at once so that it is freed with it.
static void *allocate_items(json_in *in, const member *m, size_t n, size_t size, void *item)
{
    void *items = memory_alloc(n, size);

    if (items == NULL) {
        in->has_failed = true;
        return NULL;
    }
    memcpy(place_of(item, m), &items, sizeof items);
    memcpy((char *)item + m->offset_n, &n, sizeof n);
    return items;
}

static const void *items_of(const void *item, const member *m)
{
    const void *items;

    memcpy(&items, value_of(item, m), sizeof items);
    return items;
}

static void read_numbers(json_in *in, const json_t *value, const member *m, void *item)
{
    size_t n = json_array_size(value);

    if (!check_list(in, value, m))
        return;
    double *numbers = allocate_items(in, m, n, sizeof *numbers, item);
    for (size_t k = 0; k < n && numbers != NULL; k++) {
        size_t mark = json_pointer_enter_index(&in->pointer, k);
        json_in_number(in, json_array_get(value, k), &numbers[k]);
        json_pointer_leave(&in->pointer, mark);
    }
}

static void write_numbers(json_out *w, const member *m, const void *item)
{
    json_out_numbers(w, items_of(item, m), count_of(item, m), 1);
}

static void describe_number_list(json_out *w, const member *m, member_view view)
{
    (void)view;
    json_out_key_string(w, "type", "array");
    json_out_key(w, "items");
    json_out_object(w);
    describe_bounded(w, "number", m, INFINITY);
    json_out_object_end(w);
    describe_length(w, m);
}

const member_kind member_numbers = { .text = "list of numbers",
                                     .type = "[number]",
                                     .read = read_numbers,
                                     .write = write_numbers,
                                     .write_schema = describe_number_list };

// Reads a list of tuples of least to most numbers, each stride doubles after the one before.
static double *read_tuples(json_in *in, const json_t *value, const member *m, void *item,
                           size_t least, size_t most, size_t stride)
{
    size_t n = json_array_size(value);

    if (!check_list(in, value, m))
        return NULL;
    double *numbers = allocate_items(in, m, n, stride * sizeof *numbers, item);
    for (size_t k = 0; k < n && numbers != NULL; k++) {
        size_t mark = json_pointer_enter_index(&in->pointer, k);
        json_in_tuple(in, json_array_get(value, k), least, most, numbers + k * stride, NULL);
        json_pointer_leave(&in->pointer, mark);
    }
    return numbers;
}

static void write_tuples(json_out *w, const member *m, const void *item, size_t stride,
                         size_t width)
{
    const double *numbers = items_of(item, m);
    size_t n = count_of(item, m);

    json_out_array(w);
    for (size_t k = 0; k < n; k++)
        json_out_numbers(w, numbers + k * stride, width, 1);
    json_out_array_end(w);
}

static void describe_tuples(json_out *w, const member *m, size_t least, size_t most)
{
    json_out_key_string(w, "type", "array");
    json_out_key(w, "items");
    json_out_object(w);
    describe_numbers(w, least, most);
    json_out_object_end(w);
    describe_length(w, m);
}

static void describe_pairs(json_out *w, const member *m, member_view view)
{
    (void)view;
    describe_tuples(w, m, 2, 2);
}

enum {
    POINT_STRIDE = sizeof(vec2) / sizeof(double),
    POSE_STRIDE = sizeof(scene_pose) / sizeof(double),
    VERTEX_STRIDE = 3
};

static void read_points(json_in *in, const json_t *value, const member *m, void *item)
{
    read_tuples(in, value, m, item, 2, 2, POINT_STRIDE);
}

static void write_points(json_out *w, const member *m, const void *item)
{
    write_tuples(w, m, item, POINT_STRIDE, 2);
}

const member_kind member_points = { .text = "list of [x, y]",
                                    .read = read_points,
                                    .write = write_points,
                                    .write_schema = describe_pairs };

static void read_outline(json_in *in, const json_t *value, const member *m, void *item)
{
    read_tuples(in, value, m, item, 2, 2, VERTEX_STRIDE);
}

static void write_outline(json_out *w, const member *m, const void *item)
{
    write_tuples(w, m, item, VERTEX_STRIDE, 2);
}

const member_kind member_outline = { .text = "list of [x, y]",
                                     .read = read_outline,
                                     .write = write_outline,
                                     .write_schema = describe_pairs };

static void read_vertices(json_in *in, const json_t *value, const member *m, void *item)
{
    read_tuples(in, value, m, item, 3, 3, VERTEX_STRIDE);
}

static void write_vertices(json_out *w, const member *m, const void *item)
{
    write_tuples(w, m, item, VERTEX_STRIDE, 3);
}

static void describe_vertices(json_out *w, const member *m, member_view view)
{
    (void)view;
    describe_tuples(w, m, 3, 3);
}

const member_kind member_vertices = { .text = "list of [x, y, z]",
                                      .read = read_vertices,
                                      .write = write_vertices,
                                      .write_schema = describe_vertices };

// A heading that is missing or at fault is 0.
static void read_poses(json_in *in, const json_t *value, const member *m, void *item)
{
    double *numbers = read_tuples(in, value, m, item, 2, 3, POSE_STRIDE);

    for (size_t k = 0; numbers != NULL && k < json_array_size(value); k++)
        numbers[k * POSE_STRIDE + 2] = number_from_degrees(numbers[k * POSE_STRIDE + 2]);
}

static void write_poses(json_out *w, const member *m, const void *item)
{
    const scene_pose *poses = items_of(item, m);
    size_t n = count_of(item, m);

    json_out_array(w);
    for (size_t k = 0; k < n; k++) {
        double tuple[3] = { poses[k].x, poses[k].y, number_to_degrees(poses[k].heading) };
        bool has_heading = poses[k].heading != 0.0 || signbit(poses[k].heading);
        json_out_numbers(w, tuple, has_heading ? 3 : 2, 1);
    }
    json_out_array_end(w);
}

static void describe_poses(json_out *w, const member *m, member_view view)
{
    (void)view;
    describe_tuples(w, m, 2, 3);
}

const member_kind member_poses = { .text = "list of [x, y] or [x, y, heading]",
                                   .read = read_poses,
                                   .write = write_poses,
                                   .write_schema = describe_poses };

// ---- objects

static void read_object(json_in *in, const json_t *value, const member *m, void *item)
{
    members_read(in, value, m->table, place_of(item, m));
}

static void write_object(json_out *w, const member *m, const void *item)
{
    members_write(w, m->table, value_of(item, m));
}

static void describe_object(json_out *w, const member *m, member_view view)
{
    members_write_ref(w, m->table, view);
}

const member_kind member_object = {
    .text = "object", .read = read_object, .write = write_object, .write_schema = describe_object
};

// All items have their defaults before the first is read, so that the struct can be freed anyhow.
static void read_items(json_in *in, const json_t *value, const member_table *table, char *items)
{
    size_t n = json_array_size(value);

    for (size_t k = 0; k < n && table->init != NULL; k++)
        table->init(items + k * table->size, 0);
    for (size_t k = 0; k < n; k++) {
        size_t mark = json_pointer_enter_index(&in->pointer, k);
        members_read(in, json_array_get(value, k), table, items + k * table->size);
        json_pointer_leave(&in->pointer, mark);
    }
}

static void write_items(json_out *w, const member_table *table, const char *items, size_t n)
{
    json_out_array(w);
    for (size_t k = 0; k < n; k++)
        members_write(w, table, items + k * table->size);
    json_out_array_end(w);
}

static void describe_items(json_out *w, const member *m, const member_table *items,
                           member_view view)
{
    json_out_key_string(w, "type", "array");
    json_out_key(w, "items");
    json_out_object(w);
    members_write_ref(w, items, view);
    json_out_object_end(w);
    if (view != MEMBER_ANSWER)
        describe_length(w, m);
}

static void read_list(json_in *in, const json_t *value, const member *m, void *item)
{
    if (!check_list(in, value, m))
        return;
    char *items = allocate_items(in, m, json_array_size(value), m->table->size, item);
    if (items != NULL)
        read_items(in, value, m->table, items);
}

static void write_list(json_out *w, const member *m, const void *item)
{
    write_items(w, m->table, items_of(item, m), count_of(item, m));
}

static void describe_list(json_out *w, const member *m, member_view view)
{
    describe_items(w, m, m->table, view);
}

const member_kind member_list = {
    .text = "list of objects", .read = read_list, .write = write_list, .write_schema = describe_list
};

static void write_array(json_out *w, const member *m, const void *item)
{
    write_items(w, m->table, value_of(item, m), count_of(item, m));
}

const member_kind member_array = { .write = write_array, .write_schema = describe_list };

static void read_one_or_list(json_in *in, const json_t *value, const member *m, void *item)
{
    size_t n = json_array_size(value);

    if (json_is_object(value)) {
        read_object(in, value, m, item);
    } else if (!json_is_array(value)) {
        json_in_fault(in, "must be an object or a list of objects");
    } else if (check_list(in, value, m)) {
        memcpy((char *)item + m->offset_n, &n, sizeof n);
        *(bool *)((char *)item + m->offset_list) = true;
        read_items(in, value, m->items, place_of(item, m));
    }
}

static void write_one_or_list(json_out *w, const member *m, const void *item)
{
    if (*(const bool *)((const char *)item + m->offset_list))
        write_items(w, m->items, value_of(item, m), count_of(item, m));
    else
        write_object(w, m, item);
}

static void describe_one_or_list(json_out *w, const member *m, member_view view)
{
    json_out_key(w, "oneOf");
    json_out_array(w);
    json_out_object(w);
    members_write_ref(w, m->table, view);
    json_out_object_end(w);
    json_out_object(w);
    describe_items(w, m, m->items, view);
    json_out_object_end(w);
    json_out_array_end(w);
}

const member_kind member_one_or_list = { .text = "object, or list of objects",
                                         .read = read_one_or_list,
                                         .write = write_one_or_list,
                                         .write_schema = describe_one_or_list };
