#include "api/json/members.h"

#include "api/json/angle.h"
#include "core/scene/scene.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

static const void *place_of(const void *item, size_t offset)
{
    return (const char *)item + offset;
}

static const void *items_of(const member *m, const void *item)
{
    const void *items;

    memcpy(&items, place_of(item, m->offset), sizeof items);
    return items;
}

static size_t count_items(const member *m, const void *item)
{
    return *(const size_t *)place_of(item, m->offset_n);
}

static void write_tuples(json_out *w, const double *numbers, size_t n, size_t stride, size_t width)
{
    json_out_array(w);
    for (size_t k = 0; k < n; k++)
        json_out_numbers(w, numbers + k * stride, width, 1);
    json_out_array_end(w);
}

static void write_poses(json_out *w, const scene_pose *poses, size_t n)
{
    json_out_array(w);
    for (size_t k = 0; k < n; k++) {
        double tuple[3] = { poses[k].x, poses[k].y, angle_to_degrees(poses[k].heading) };
        bool has_heading = poses[k].heading != 0.0 || signbit(poses[k].heading);
        json_out_numbers(w, tuple, has_heading ? 3 : 2, 1);
    }
    json_out_array_end(w);
}

static void write_objects(json_out *w, const member_table *table, const char *items, size_t n)
{
    json_out_array(w);
    for (size_t k = 0; k < n; k++)
        members_write(w, table, items + k * table->size);
    json_out_array_end(w);
}

static void write_step(json_out *w, double step)
{
    if (step == 0.0)
        json_out_string(w, "auto");
    else
        json_out_number(w, step);
}

static void write_word(json_out *w, const member *m, const void *place)
{
    unsigned index;

    memcpy(&index, place, sizeof index);
    json_out_string(w, m->words[index]);
}

static void write_list(json_out *w, const member *m, const void *item)
{
    const void *items = items_of(m, item);
    size_t n = count_items(m, item);

    if (m->kind == MEMBER_NUMBERS)
        json_out_numbers(w, items, n, 1);
    else if (m->kind == MEMBER_POINTS)
        write_tuples(w, items, n, sizeof(vec2) / sizeof(double), 2);
    else if (m->kind == MEMBER_OUTLINE)
        write_tuples(w, items, n, 3, 2);
    else if (m->kind == MEMBER_VERTICES)
        write_tuples(w, items, n, 3, 3);
    else if (m->kind == MEMBER_POSES)
        write_poses(w, items, n);
    else
        write_objects(w, m->table, items, n);
}

static void write_mix(json_out *w, const member *m, const void *item)
{
    if (*(const bool *)place_of(item, m->offset_list))
        write_objects(w, m->items, place_of(item, m->offset), count_items(m, item));
    else
        members_write(w, m->table, place_of(item, m->offset));
}

static void write_value(json_out *w, const member *m, const void *item)
{
    const void *place = place_of(item, m->offset);

    switch (m->kind) {
    case MEMBER_NUMBER:
        json_out_number(w, *(const double *)place);
        break;
    case MEMBER_STEP:
        write_step(w, *(const double *)place);
        break;
    case MEMBER_COUNT:
        json_out_integer(w, *(const uint32_t *)place);
        break;
    case MEMBER_SEED:
        json_out_integer(w, (int64_t) * (const uint64_t *)place);
        break;
    case MEMBER_PRIORITY:
        json_out_integer(w, *(const int *)place);
        break;
    case MEMBER_BOOL:
        json_out_bool(w, *(const bool *)place);
        break;
    case MEMBER_TEXT:
        json_out_string(w, place);
        break;
    case MEMBER_WORD:
        write_word(w, m, place);
        break;
    case MEMBER_POINT:
    case MEMBER_INTERVAL:
        json_out_numbers(w, place, 2, 1);
        break;
    case MEMBER_OBJECT:
        members_write(w, m->table, place);
        break;
    case MEMBER_MIX:
        write_mix(w, m, item);
        break;
    default:
        write_list(w, m, item);
        break;
    }
}

void members_write(json_out *w, const member_table *table, const void *item)
{
    json_out_object(w);
    for (size_t k = 0; k < table->n; k++) {
        const member *m = &table->members[k];
        bool is_empty = (m->flags & MEMBER_OMIT_EMPTY) != 0 && count_items(m, item) == 0;
        if ((m->flags & MEMBER_FORM) != 0 || is_empty || !members_applies(table, m, item))
            continue;
        json_out_key(w, m->name);
        write_value(w, m, item);
    }
    json_out_object_end(w);
}
