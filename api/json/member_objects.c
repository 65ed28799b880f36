// The kinds of members that are objects and lists of them: how each is read, written and described.

#include "api/json/json_priv.h"

#include <jansson.h>
#include <string.h>

static void read_object(json_in *in, const json_t *value, const member *m, void *item)
{
    members_read(in, value, m->table, member__place(item, m));
}

static void write_object(json_out *w, const member *m, const void *item)
{
    members_write(w, m->table, member__value(item, m));
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
        member__describe_length(w, m);
}

static void read_list(json_in *in, const json_t *value, const member *m, void *item)
{
    if (!member__check_list(in, value, m))
        return;
    char *items = member__allocate(in, m, json_array_size(value), m->table->size, item);
    if (items != NULL)
        read_items(in, value, m->table, items);
}

static void write_list(json_out *w, const member *m, const void *item)
{
    write_items(w, m->table, member__items(item, m), member__count(item, m));
}

static void describe_list(json_out *w, const member *m, member_view view)
{
    describe_items(w, m, m->table, view);
}

const member_kind member_list = {
    .text = "list of objects", .read = read_list, .write = write_list, .write_schema = describe_list
};

static void read_array(json_in *in, const json_t *value, const member *m, void *item)
{
    size_t n = json_array_size(value);

    if (!member__check_list(in, value, m))
        return;
    memcpy((char *)item + m->offset_n, &n, sizeof n);
    read_items(in, value, m->table, member__place(item, m));
}

static void write_array(json_out *w, const member *m, const void *item)
{
    write_items(w, m->table, member__value(item, m), member__count(item, m));
}

const member_kind member_array = { .text = "list of objects",
                                   .read = read_array,
                                   .write = write_array,
                                   .write_schema = describe_list };

static void read_one_or_list(json_in *in, const json_t *value, const member *m, void *item)
{
    size_t n = json_array_size(value);

    if (json_is_object(value)) {
        read_object(in, value, m, item);
    } else if (!json_is_array(value)) {
        json_in_fault(in, "must be an object or a list of objects");
    } else if (member__check_list(in, value, m)) {
        memcpy((char *)item + m->offset_n, &n, sizeof n);
        *(bool *)((char *)item + m->offset_list) = true;
        read_items(in, value, m->items, member__place(item, m));
    }
}

static void write_one_or_list(json_out *w, const member *m, const void *item)
{
    if (*(const bool *)((const char *)item + m->offset_list))
        write_items(w, m->items, member__value(item, m), member__count(item, m));
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
