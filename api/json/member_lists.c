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

enum { POINT_STRIDE = sizeof(vec2) / sizeof(double) };

// An item of a list.
typedef struct member_element {
    size_t size;                                              // of one in memory, bytes
    void (*read)(json_in *in, const json_t *value, void *to); // untouched where it is at fault
    void (*write)(json_out *w, const void *from);
    void (*describe)(json_out *w, const member *m); // its schema
    bool may_be_null;                               // a number or null, NAN in memory
    size_t least; // numbers of a tuple, which without read and write is in memory as in the list
    size_t most;  // 0: it is no tuple
} member_element;

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

// ---- lists

void member__describe_length(json_out *w, const member *m)
{
    json_out_key_integer(w, "minItems", (int64_t)m->least);
    json_out_key_integer(w, "maxItems", (int64_t)m->limit);
}

bool member__check_list(json_in *in, const json_t *value, const member *m)
{
    const size_t n = json_array_size(value);
    const size_t limit = m->limit > 0 ? m->limit : SIZE_MAX;

    if (!json_is_array(value))
        return json_in_is_array(in, value);
    if (n >= m->least && n <= limit)
        return true;
    if (n < m->least)
        json_in_fault(in, "must have at least %zu items, not %zu", m->least, n);
    else
        json_in_fault_limit(in, "has %zu items, the limit is %zu", n, limit);
    faults_set_limit(in->faults, (double)n, (double)(n < m->least ? m->least : limit));
    return false;
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

static void read_element(json_in *in, const json_t *value, const member_element *element, void *to)
{
    if (element->may_be_null)
        *(double *)to = NAN;
    if (element->may_be_null && json_is_null(value))
        return;
    if (element->read != NULL)
        element->read(in, value, to);
    else
        (void)json_in_tuple(in, value, element->least, element->most, to, NULL);
}

static void read_list(json_in *in, const json_t *value, const member *m, void *item)
{
    const member_element *element = m->kind->element;
    const size_t n = json_array_size(value);

    if (!member__check_list(in, value, m))
        return;
    char *items = member__allocate(in, m, n, element->size, item);
    for (size_t k = 0; k < n && items != NULL; k++) {
        const size_t mark = json_pointer_enter_index(&in->pointer, k);
        read_element(in, json_array_get(value, k), element, items + k * element->size);
        json_pointer_leave(&in->pointer, mark);
    }
}

static void write_list(json_out *w, const member *m, const void *item)
{
    const member_element *element = m->kind->element;
    const char *items = member__items(item, m);
    const size_t n = member__count(item, m);

    json_out_array(w);
    for (size_t k = 0; k < n; k++) {
        const void *from = items + k * element->size;
        if (element->write != NULL)
            element->write(w, from);
        else
            json_out_numbers(w, from, element->most, 1);
    }
    json_out_array_end(w);
}

static void describe_list(json_out *w, const member *m, member_view view)
{
    const member_element *element = m->kind->element;

    (void)view;
    json_out_key_string(w, "type", "array");
    json_out_key(w, "items");
    if (element->most > 0) {
        json_out_object(w);
        describe_numbers(w, element->least, element->most);
        json_out_object_end(w);
    } else if (element->may_be_null) {
        schema_write(w, "number?", NULL, NULL);
    } else {
        element->describe(w, m);
    }
    member__describe_length(w, m);
}

// A kind that is a list of such items.
#define LIST_OF(element_)                                                                          \
    .element = &(element_), .read = read_list, .write = write_list, .write_schema = describe_list

// ---- lists of numbers

static void read_number(json_in *in, const json_t *value, void *to)
{
    (void)json_in_number(in, value, to);
}

static void write_number(json_out *w, const void *from)
{
    json_out_number(w, *(const double *)from);
}

static void describe_number(json_out *w, const member *m)
{
    json_out_object(w);
    member__describe_bounded(w, "number", m, INFINITY);
    json_out_object_end(w);
}

static const member_element number = { sizeof(double), read_number, write_number,
                                       .describe = describe_number };
static const member_element number_or_null = { sizeof(double), read_number, write_number,
                                               .may_be_null = true };

const member_kind member_numbers = { .text = "list of numbers",
                                     .type = "[number]",
                                     LIST_OF(number) };
const member_kind member_numbers_or_null = { .text = "list of numbers or null",
                                             LIST_OF(number_or_null) };

static void read_angle(json_in *in, const json_t *value, void *to)
{
    double degrees;

    if (json_in_number(in, value, &degrees))
        *(double *)to = number_from_degrees(degrees);
}

static void write_angle(json_out *w, const void *from)
{
    json_out_number(w, number_to_degrees(*(const double *)from));
}

static const member_element angle = { sizeof(double), read_angle, write_angle,
                                      .describe = describe_number };
static const member_element angle_or_null = { sizeof(double), read_angle, write_angle,
                                              .may_be_null = true };

const member_kind member_angles = { .text = "list of numbers", LIST_OF(angle) };
const member_kind member_angles_or_null = { .text = "list of numbers or null",
                                            LIST_OF(angle_or_null) };

static void read_flag(json_in *in, const json_t *value, void *to)
{
    bool is_set;

    if (json_in_bool(in, value, &is_set))
        *(double *)to = is_set ? 1.0 : 0.0;
}

static void write_flag(json_out *w, const void *from)
{
    json_out_bool(w, *(const double *)from != 0.0);
}

static void describe_flag(json_out *w, const member *m)
{
    (void)m;
    schema_write(w, "boolean", NULL, NULL);
}

static const member_element flag = { sizeof(double), read_flag, write_flag,
                                     .describe = describe_flag };

const member_kind member_flags = { .text = "list of booleans", LIST_OF(flag) };

static void read_count(json_in *in, const json_t *value, void *to)
{
    double whole;

    if (json_in_integer(in, value, 0, UINT32_MAX, &whole))
        *(uint32_t *)to = (uint32_t)whole;
}

static void write_count(json_out *w, const void *from)
{
    json_out_integer(w, *(const uint32_t *)from);
}

static void describe_count(json_out *w, const member *m)
{
    json_out_object(w);
    member__describe_bounded(w, "integer", m, UINT32_MAX);
    json_out_object_end(w);
}

static const member_element count = { sizeof(uint32_t), read_count, write_count,
                                      .describe = describe_count };

const member_kind member_counts = { .text = "list of whole numbers", LIST_OF(count) };

// ---- lists of tuples

static const member_element point = { sizeof(vec2), .least = 2, .most = 2 };
static const member_element corner = { 3 * sizeof(double), .least = 2, .most = 2 };
static const member_element vertex = { 3 * sizeof(double), .least = 3, .most = 3 };

const member_kind member_points = { .text = "list of [x, y]", LIST_OF(point) };
const member_kind member_outline = { .text = "list of [x, y]", LIST_OF(corner) };
const member_kind member_vertices = { .text = "list of [x, y, z]", LIST_OF(vertex) };

// A heading that is missing or at fault is 0.
static void read_pose(json_in *in, const json_t *value, void *to)
{
    double tuple[3] = { 0.0 };

    (void)json_in_tuple(in, value, 2, 3, tuple, NULL);
    *(scene_pose *)to =
        (scene_pose){ .x = tuple[0], .y = tuple[1], .heading = number_from_degrees(tuple[2]) };
}

static void write_pose(json_out *w, const void *from)
{
    const scene_pose *pose = from;
    const double tuple[3] = { pose->x, pose->y, number_to_degrees(pose->heading) };
    const bool has_heading = pose->heading != 0.0 || signbit(pose->heading);

    json_out_numbers(w, tuple, has_heading ? 3 : 2, 1);
}

static const member_element pose = { sizeof(scene_pose), read_pose, write_pose, .least = 2,
                                     .most = 3 };

const member_kind member_poses = { .text = "list of [x, y] or [x, y, heading]", LIST_OF(pose) };
