#include "api/json/members.h"

#include "api/json/angle.h"
#include "api/json/suggest.h"
#include "core/base/memory.h"
#include "core/scene/scene.h"

#include <jansson.h>
#include <math.h>
#include <string.h>

#define SEED_MAX 9007199254740991.0 // 2^53 - 1

static void *place_of(void *item, size_t offset)
{
    return (char *)item + offset;
}

static unsigned read_choice(const void *item, size_t offset)
{
    unsigned choice; // enums of the structs are unsigned

    memcpy(&choice, (const char *)item + offset, sizeof choice);
    return choice;
}

bool members_applies(const member_table *table, const member *m, const void *item)
{
    if (table->choice == MEMBER_ONE_OF)
        return (size_t)(m - table->members) == read_choice(item, table->offset_choice);
    if (table->choice == MEMBER_TAGGED && m->tags != 0)
        return (m->tags >> read_choice(item, table->members[0].offset) & 1U) != 0;
    return true;
}

static void read_step(json_in *in, const json_t *value, double *ret_step)
{
    double step;

    if (json_is_string(value) && strcmp(json_string_value(value), "auto") == 0) {
        *ret_step = 0.0;
    } else if (!json_is_number(value)) {
        json_in_fault(in, "must be a number or \"auto\"");
    } else if (json_in_number(in, value, &step)) {
        if (step == 0.0) // would mean "auto" in the struct
            json_in_fault(in, "must be > 0 or \"auto\"");
        else
            *ret_step = step;
    }
}

static void read_whole(json_in *in, const json_t *value, const member *m, void *place)
{
    double number;

    if (m->kind == MEMBER_COUNT && json_in_integer(in, value, 0, UINT32_MAX, &number))
        *(uint32_t *)place = (uint32_t)number;
    if (m->kind == MEMBER_SEED && json_in_integer(in, value, 0, SEED_MAX, &number))
        *(uint64_t *)place = (uint64_t)number;
    if (m->kind == MEMBER_PRIORITY &&
        json_in_integer(in, value, m->range->minimum, m->range->maximum, &number))
        *(int *)place = (int)number;
}

// Numbers of one item of a list of tuples: fewest, most, and doubles from one item to the next.
typedef struct tuple_layout {
    size_t least;
    size_t most;
    size_t stride;
} tuple_layout;

static const tuple_layout tuple_layouts[MEMBER_KIND_COUNT] = {
    [MEMBER_POINTS] = { 2, 2, sizeof(vec2) / sizeof(double) },
    [MEMBER_OUTLINE] = { 2, 2, 3 },
    [MEMBER_VERTICES] = { 3, 3, 3 },
    [MEMBER_POSES] = { 2, 3, sizeof(scene_pose) / sizeof(double) },
};

// True if the list has neither too few nor too many items, known before anything is allocated.
static bool check_count(json_in *in, const member *m, size_t n)
{
    if (n < m->least)
        json_in_fault(in, "must have at least %zu items, not %zu", m->least, n);
    if (n > m->limit)
        json_in_fault_limit(in, "has %zu items, the limit is %zu", n, m->limit);
    return n >= m->least && n <= m->limit;
}

// Room for the items of a list, handed to the struct at once so that it is freed with it.
static void *allocate_items(json_in *in, const member *m, size_t n, size_t size, void *item)
{
    void *items = memory_alloc(n, size);

    if (items == NULL) {
        in->has_failed = true;
        return NULL;
    }
    memcpy(place_of(item, m->offset), &items, sizeof items);
    *(size_t *)place_of(item, m->offset_n) = n;
    return items;
}

static void read_tuples(json_in *in, const json_t *value, const member *m, void *item)
{
    const tuple_layout *layout = &tuple_layouts[m->kind];
    size_t n = json_array_size(value);

    double *numbers = allocate_items(in, m, n, layout->stride * sizeof *numbers, item);
    if (numbers == NULL)
        return;
    for (size_t k = 0; k < n; k++) {
        double *tuple = numbers + k * layout->stride;
        size_t mark = json_pointer_enter_index(&in->pointer, k);
        bool is_read =
            json_in_tuple(in, json_array_get(value, k), layout->least, layout->most, tuple, NULL);
        if (is_read && m->kind == MEMBER_POSES)
            tuple[2] = angle_from_degrees(tuple[2]);
        json_pointer_leave(&in->pointer, mark);
    }
}

static void read_numbers(json_in *in, const json_t *value, const member *m, void *item)
{
    size_t n = json_array_size(value);

    double *numbers = allocate_items(in, m, n, sizeof *numbers, item);
    for (size_t k = 0; k < n && numbers != NULL; k++) {
        size_t mark = json_pointer_enter_index(&in->pointer, k);
        json_in_number(in, json_array_get(value, k), &numbers[k]);
        json_pointer_leave(&in->pointer, mark);
    }
}

// All items have their defaults before the first is read, so that the struct can be freed anyhow.
static void read_items(json_in *in, const json_t *value, const member_table *table, char *items)
{
    size_t n = json_array_size(value);

    for (size_t k = 0; k < n && table->begin != NULL; k++)
        table->begin(items + k * table->size);
    for (size_t k = 0; k < n; k++) {
        size_t mark = json_pointer_enter_index(&in->pointer, k);
        members_read(in, json_array_get(value, k), table, items + k * table->size);
        json_pointer_leave(&in->pointer, mark);
    }
}

static void read_objects(json_in *in, const json_t *value, const member *m, void *item)
{
    char *items = allocate_items(in, m, json_array_size(value), m->table->size, item);

    if (items != NULL)
        read_items(in, value, m->table, items);
}

static void read_mix(json_in *in, const json_t *value, const member *m, void *item)
{
    if (json_is_object(value)) {
        members_read(in, value, m->table, place_of(item, m->offset));
    } else if (!json_is_array(value)) {
        json_in_fault(in, "must be an object or a list of objects");
    } else if (check_count(in, m, json_array_size(value))) {
        *(size_t *)place_of(item, m->offset_n) = json_array_size(value);
        *(bool *)place_of(item, m->offset_list) = true;
        read_items(in, value, m->items, place_of(item, m->offset));
    }
}

static void read_list(json_in *in, const json_t *value, const member *m, void *item)
{
    if (!json_in_is_array(in, value) || !check_count(in, m, json_array_size(value)))
        return;
    if (m->kind == MEMBER_LIST)
        read_objects(in, value, m, item);
    else if (m->kind == MEMBER_NUMBERS)
        read_numbers(in, value, m, item);
    else
        read_tuples(in, value, m, item);
}

static void read_word(json_in *in, const json_t *value, const member *m, void *place)
{
    unsigned index;

    if (json_in_word(in, value, m->words, &index))
        memcpy(place, &index, sizeof index);
}

void members_read_value(json_in *in, const struct json_t *value, const member *m, void *item)
{
    void *place = place_of(item, m->offset);

    switch (m->kind) {
    case MEMBER_NUMBER:
        json_in_number(in, value, place);
        break;
    case MEMBER_STEP:
        read_step(in, value, place);
        break;
    case MEMBER_COUNT:
    case MEMBER_SEED:
    case MEMBER_PRIORITY:
        read_whole(in, value, m, place);
        break;
    case MEMBER_BOOL:
        json_in_bool(in, value, place);
        break;
    case MEMBER_TEXT:
        json_in_text(in, value, m->least, m->limit, place);
        break;
    case MEMBER_WORD:
        read_word(in, value, m, place);
        break;
    case MEMBER_POINT:
    case MEMBER_INTERVAL:
        json_in_tuple(in, value, 2, 2, place, NULL);
        break;
    case MEMBER_OBJECT:
        members_read(in, value, m->table, place);
        break;
    case MEMBER_MIX:
        read_mix(in, value, m, item);
        break;
    default:
        read_list(in, value, m, item);
        break;
    }
}

static const member *find_member(const member_table *table, const char *name)
{
    for (size_t k = 0; k < table->n; k++) {
        if (strcmp(table->members[k].name, name) == 0)
            return &table->members[k];
    }
    return NULL;
}

static const char *nearest_name(const member_table *table, const char *name)
{
    const char *nearest = NULL;
    size_t least = SIZE_MAX;

    for (size_t k = 0; k < table->n; k++) {
        size_t distance = suggest_distance(name, table->members[k].name);
        if (distance < least) {
            least = distance;
            nearest = table->members[k].name;
        }
    }
    return nearest != NULL && suggest_is_near(nearest, least) ? nearest : NULL;
}

static void note_unknown(json_in *in, const json_t *object, const member_table *table)
{
    for (void *at = json_object_iter((json_t *)object); at != NULL;
         at = json_object_iter_next((json_t *)object, at)) {
        const char *name = json_object_iter_key(at);
        if (find_member(table, name) != NULL)
            continue;
        const char *nearest = nearest_name(table, name);
        size_t mark = json_pointer_enter(&in->pointer, name, strlen(name));
        if (nearest != NULL)
            json_in_fault(in, "unknown member; \"%s\" is like it", nearest);
        else
            json_in_fault(in, "unknown member");
        json_pointer_leave(&in->pointer, mark);
    }
}

static void read_member(json_in *in, const json_t *object, const member_table *table,
                        const member *m, void *item)
{
    const json_t *value = json_object_get(object, m->name);
    size_t mark = json_pointer_enter(&in->pointer, m->name, strlen(m->name));

    if (!members_applies(table, m, item)) {
        if (value != NULL)
            json_in_fault(in, "does not belong to this %s", table->title);
    } else if (value != NULL) {
        members_read_value(in, value, m, item);
    } else if (m->standard == NULL) {
        json_in_fault(in, "is missing");
    }
    json_pointer_leave(&in->pointer, mark);
}

// Sets the enum of a MEMBER_ONE_OF; false: there is not exactly one member.
static bool choose_member(json_in *in, const json_t *object, const member_table *table, void *item)
{
    unsigned n_found = 0;
    unsigned choice = 0;

    for (unsigned k = 0; k < table->n; k++) {
        if (json_object_get(object, table->members[k].name) != NULL) {
            n_found++;
            choice = k;
        }
    }
    if (n_found != 1) {
        json_in_fault(in, "must have exactly one of its members, not %u", n_found);
        return false;
    }
    memcpy(place_of(item, table->offset_choice), &choice, sizeof choice);
    return true;
}

void members_read(json_in *in, const struct json_t *value, const member_table *table, void *item)
{
    if (!json_in_is_object(in, value))
        return;
    note_unknown(in, value, table);
    if (table->choice == MEMBER_ONE_OF && !choose_member(in, value, table, item))
        return;
    for (size_t k = 0; k < table->n; k++) {
        const member *m = &table->members[k];
        size_t n_faults = in->faults->n;
        if ((m->flags & MEMBER_FORM) == 0)
            read_member(in, value, table, m, item);
        // Without its tag nothing can be said of the other members.
        if (table->choice == MEMBER_TAGGED && k == 0 && in->faults->n != n_faults)
            return;
    }
    if (table->finish != NULL)
        table->finish(in, value, item);
}
