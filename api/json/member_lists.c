// The kinds of members that are numbers and points in a row: how each is read, written and described.

#include "api/json/json_priv.h"
#include "api/json/number.h"
#include "api/json/schema.h"
#include "core/base/grid.h"
#include "core/base/memory.h"
#include "core/base/vec2.h"
#include "core/scene/types.h"

#include <jansson.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

enum {
    POINT_STRIDE = sizeof(vec2) / sizeof(double),
    POSE_STRIDE = sizeof(scene_pose) / sizeof(double),
    VERTEX_STRIDE = 3
};

// ---- tuples

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
    json_in_tuple(in, value, 2, 2, member__place(item, m), NULL);
}

static void write_pair(json_out *w, const member *m, const void *item)
{
    json_out_numbers(w, member__value(item, m), 2, 1);
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
    const bf_grid *grid = member__value(item, m);

    json_out_array(w);
    json_out_integer(w, (int64_t)grid->n2);
    json_out_integer(w, (int64_t)grid->n1);
    json_out_array_end(w);
}

const member_kind member_shape = { .type = "#Shape2", .write = write_shape };

void member__describe_length(json_out *w, const member *m)
{
    json_out_key_integer(w, "minItems", (int64_t)m->least);
    json_out_key_integer(w, "maxItems", (int64_t)m->limit);
}

bool member__check_list(json_in *in, const json_t *value, const member *m)
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

void *member__allocate(json_in *in, const member *m, size_t n, size_t size, void *item)
{
    void *items = memory_alloc(n, size);

    if (items == NULL) {
        in->has_failed = true;
        return NULL;
    }
    memcpy(member__place(item, m), &items, sizeof items);
    memcpy((char *)item + m->offset_n, &n, sizeof n);
    return items;
}

const void *member__items(const void *item, const member *m)
{
    const void *items;

    memcpy(&items, member__value(item, m), sizeof items);
    return items;
}

// How an item of a list of doubles is read and written.
typedef bool read_double(json_in *in, const json_t *value, double *ret_number);

static void read_doubles(json_in *in, const json_t *value, const member *m, void *item,
                         read_double *read)
{
    size_t n = json_array_size(value);

    if (!member__check_list(in, value, m))
        return;
    double *numbers = member__allocate(in, m, n, sizeof *numbers, item);
    for (size_t k = 0; k < n && numbers != NULL; k++) {
        size_t mark = json_pointer_enter_index(&in->pointer, k);
        read(in, json_array_get(value, k), &numbers[k]);
        json_pointer_leave(&in->pointer, mark);
    }
}

static void read_numbers(json_in *in, const json_t *value, const member *m, void *item)
{
    read_doubles(in, value, m, item, json_in_number);
}

static void write_numbers(json_out *w, const member *m, const void *item)
{
    json_out_numbers(w, member__items(item, m), member__count(item, m), 1);
}

static void describe_number_list(json_out *w, const member *m, member_view view)
{
    (void)view;
    json_out_key_string(w, "type", "array");
    json_out_key(w, "items");
    json_out_object(w);
    member__describe_bounded(w, "number", m, INFINITY);
    json_out_object_end(w);
    member__describe_length(w, m);
}

const member_kind member_numbers = { .text = "list of numbers",
                                     .type = "[number]",
                                     .read = read_numbers,
                                     .write = write_numbers,
                                     .write_schema = describe_number_list };

static bool read_angle(json_in *in, const json_t *value, double *ret_radians)
{
    double degrees;

    if (!json_in_number(in, value, &degrees))
        return false;
    *ret_radians = number_from_degrees(degrees);
    return true;
}

static void read_angles(json_in *in, const json_t *value, const member *m, void *item)
{
    read_doubles(in, value, m, item, read_angle);
}

static void write_angles(json_out *w, const member *m, const void *item)
{
    const double *angles = member__items(item, m);
    size_t n = member__count(item, m);

    json_out_array(w);
    for (size_t k = 0; k < n; k++)
        json_out_number(w, number_to_degrees(angles[k]));
    json_out_array_end(w);
}

const member_kind member_angles = { .text = "list of numbers",
                                    .read = read_angles,
                                    .write = write_angles,
                                    .write_schema = describe_number_list };

static bool read_number_or_null(json_in *in, const json_t *value, double *ret_number)
{
    *ret_number = NAN;
    return json_is_null(value) || json_in_number(in, value, ret_number);
}

static void read_numbers_or_null(json_in *in, const json_t *value, const member *m, void *item)
{
    read_doubles(in, value, m, item, read_number_or_null);
}

static void describe_numbers_or_null(json_out *w, const member *m, member_view view)
{
    (void)view;
    json_out_key_string(w, "type", "array");
    json_out_key(w, "items");
    schema_write(w, "number?", NULL, NULL);
    member__describe_length(w, m);
}

const member_kind member_numbers_or_null = { .text = "list of numbers or null",
                                             .read = read_numbers_or_null,
                                             .write = write_numbers,
                                             .write_schema = describe_numbers_or_null };

static bool read_angle_or_null(json_in *in, const json_t *value, double *ret_radians)
{
    *ret_radians = NAN;
    return json_is_null(value) || read_angle(in, value, ret_radians);
}

static void read_angles_or_null(json_in *in, const json_t *value, const member *m, void *item)
{
    read_doubles(in, value, m, item, read_angle_or_null);
}

const member_kind member_angles_or_null = { .text = "list of numbers or null",
                                            .read = read_angles_or_null,
                                            .write = write_angles,
                                            .write_schema = describe_numbers_or_null };

static bool read_flag(json_in *in, const json_t *value, double *ret_flag)
{
    bool flag;

    if (!json_in_bool(in, value, &flag))
        return false;
    *ret_flag = flag ? 1.0 : 0.0;
    return true;
}

static void read_flags(json_in *in, const json_t *value, const member *m, void *item)
{
    read_doubles(in, value, m, item, read_flag);
}

static void write_flags(json_out *w, const member *m, const void *item)
{
    const double *flags = member__items(item, m);
    size_t n = member__count(item, m);

    json_out_array(w);
    for (size_t k = 0; k < n; k++)
        json_out_bool(w, flags[k] != 0.0);
    json_out_array_end(w);
}

static void describe_flags(json_out *w, const member *m, member_view view)
{
    (void)view;
    json_out_key_string(w, "type", "array");
    json_out_key(w, "items");
    schema_write(w, "boolean", NULL, NULL);
    member__describe_length(w, m);
}

const member_kind member_flags = { .text = "list of booleans",
                                   .read = read_flags,
                                   .write = write_flags,
                                   .write_schema = describe_flags };

static void read_counts(json_in *in, const json_t *value, const member *m, void *item)
{
    size_t n = json_array_size(value);
    double number;

    if (!member__check_list(in, value, m))
        return;
    uint32_t *counts = member__allocate(in, m, n, sizeof *counts, item);
    for (size_t k = 0; k < n && counts != NULL; k++) {
        size_t mark = json_pointer_enter_index(&in->pointer, k);
        if (json_in_integer(in, json_array_get(value, k), 0, UINT32_MAX, &number))
            counts[k] = (uint32_t)number;
        json_pointer_leave(&in->pointer, mark);
    }
}

static void write_counts(json_out *w, const member *m, const void *item)
{
    const uint32_t *counts = member__items(item, m);
    size_t n = member__count(item, m);

    json_out_array(w);
    for (size_t k = 0; k < n; k++)
        json_out_integer(w, counts[k]);
    json_out_array_end(w);
}

static void describe_counts(json_out *w, const member *m, member_view view)
{
    (void)view;
    json_out_key_string(w, "type", "array");
    json_out_key(w, "items");
    json_out_object(w);
    member__describe_bounded(w, "integer", m, UINT32_MAX);
    json_out_object_end(w);
    member__describe_length(w, m);
}

const member_kind member_counts = { .text = "list of whole numbers",
                                    .read = read_counts,
                                    .write = write_counts,
                                    .write_schema = describe_counts };

static void read_line(json_in *in, const json_t *value, const member *m, void *item)
{
    double *ends = member__place(item, m);

    if (!json_in_is_array(in, value))
        return;
    if (json_array_size(value) != 2) {
        json_in_fault(in, "must have 2 points, not %zu", json_array_size(value));
        return;
    }
    for (size_t k = 0; k < 2; k++) {
        size_t mark = json_pointer_enter_index(&in->pointer, k);
        json_in_tuple(in, json_array_get(value, k), 2, 2, ends + k * POINT_STRIDE, NULL);
        json_pointer_leave(&in->pointer, mark);
    }
}

static void write_line(json_out *w, const member *m, const void *item)
{
    const double *ends = member__value(item, m);

    json_out_array(w);
    json_out_numbers(w, ends, 2, 1);
    json_out_numbers(w, ends + POINT_STRIDE, 2, 1);
    json_out_array_end(w);
}

static void describe_line(json_out *w, const member *m, member_view view)
{
    (void)m;
    (void)view;
    schema_write_members(w, "[#Pair 2]");
}

const member_kind member_line = { .text = "[[x, y], [x, y]]",
                                  .read = read_line,
                                  .write = write_line,
                                  .write_schema = describe_line };

// Reads a list of tuples of least to most numbers, each stride doubles after the one before.
static double *read_tuples(json_in *in, const json_t *value, const member *m, void *item,
                           size_t least, size_t most, size_t stride)
{
    size_t n = json_array_size(value);

    if (!member__check_list(in, value, m))
        return NULL;
    double *numbers = member__allocate(in, m, n, stride * sizeof *numbers, item);
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
    const double *numbers = member__items(item, m);
    size_t n = member__count(item, m);

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
    member__describe_length(w, m);
}

static void describe_pairs(json_out *w, const member *m, member_view view)
{
    (void)view;
    describe_tuples(w, m, 2, 2);
}

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
    const scene_pose *poses = member__items(item, m);
    size_t n = member__count(item, m);

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
