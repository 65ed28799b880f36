// Members that name another part of the document by its id. Structs have indices: they are found when the
// whole document was read and every id is there.

#include "api/json/schema.h"
#include "api/scenario/feed_csv.h"
#include "api/scenario/scenario_priv.h"
#include "core/base/memory.h"

#include <jansson.h>
#include <stdio.h>
#include <string.h>

enum { KNOWN_SIZE = 160 }; ///< bytes of a list of ids in a text

// The ids of the items of a list, stride bytes from one to the next.
typedef struct id_list {
    const char *what; ///< an item, for people
    size_t n;
    const char *first; ///< n > 0
    size_t stride;
} id_list;

#define ID_LIST(what_, items_, n_)                                                                 \
    {                                                                                              \
        .what = (what_), .n = (n_), .first = (n_) > 0 ? (items_)[0].id : NULL,                     \
        .stride = sizeof *(items_)                                                                 \
    }

static id_list kinds_of(const scene *s)
{
    return (id_list)ID_LIST("a kind of cargo", s->cargo, s->n_cargo);
}

static id_list belts_of(const scene *s)
{
    return (id_list)ID_LIST("a belt", s->belts, s->n_belts);
}

static id_list obstacles_of(const scene *s)
{
    return (id_list)ID_LIST("an obstacle", s->obstacles, s->n_obstacles);
}

static id_list feeds_of(const scene *s)
{
    return (id_list)ID_LIST("a feed", s->feeds, s->n_feeds);
}

static id_list eyes_of(const scene *s)
{
    return (id_list)ID_LIST("a photo eye", s->eyes, s->n_eyes);
}

// Finds the item of an id, or notes, after `where`, that there is none.
static bool find(json_in *in, id_list list, const char *where, const char *id, size_t *ret_index)
{
    char known[KNOWN_SIZE] = "";
    size_t n = 0;

    for (size_t k = 0; k < list.n; k++) {
        if (strcmp(list.first + k * list.stride, id) != 0)
            continue;
        *ret_index = k;
        return true;
    }
    for (size_t k = 0; k < list.n && n < KNOWN_SIZE; k++)
        n += (size_t)snprintf(known + n, KNOWN_SIZE - n, "%s%s", k == 0 ? "" : ", ",
                              list.first + k * list.stride);
    if (n >= KNOWN_SIZE)
        snprintf(known + KNOWN_SIZE - 4, 4, "...");
    if (list.n > 0)
        json_in_fault(in, "%s\"%.*s\" is not the id of %s; there are: %s", where, SCENE_ID_SIZE - 1,
                      id, list.what, known);
    else
        json_in_fault(in, "%s\"%.*s\" is not the id of %s; there is none", where, SCENE_ID_SIZE - 1,
                      id, list.what);
    return false;
}

bool scenario__find_kind(json_in *in, const scene *s, const char *where, const char *id,
                         uint32_t *ret_kind)
{
    size_t index;

    if (!find(in, kinds_of(s), where, id, &index))
        return false;
    *ret_kind = (uint32_t)index;
    return true;
}

// ---- the members; an id is looked up later

static void read_id(json_in *in, const json_t *value, const member *m, void *item)
{
    char id[SCENE_ID_SIZE];

    (void)m;
    (void)item;
    (void)json_in_text(in, value, 1, sizeof id, id);
}

static void read_ids(json_in *in, const json_t *value, const member *m, void *item)
{
    size_t n = json_array_size(value);

    if (!json_in_is_array(in, value))
        return;
    if (n > m->limit)
        json_in_fault_limit(in, "has %zu items, the limit is %zu", n, m->limit);
    for (size_t k = 0; k < n && n <= m->limit; k++) {
        size_t mark = json_pointer_enter_index(&in->pointer, k);
        read_id(in, json_array_get(value, k), m, item);
        json_pointer_leave(&in->pointer, mark);
    }
}

static void describe_id(json_out *w, const member *m, member_view view)
{
    (void)m;
    (void)view;
    schema_write_members(w, "#ScenarioId");
}

static void describe_ids(json_out *w, const member *m, member_view view)
{
    char type[64];

    (void)view;
    snprintf(type, sizeof type, "[#ScenarioId %zu-%zu]", m->least, m->limit);
    schema_write_members(w, type);
}

static void write_id(json_out *w, id_list list, size_t index)
{
    json_out_string(w, list.first + index * list.stride);
}

static void write_target(json_out *w, id_list list, const member *m, const void *item)
{
    size_t index;

    memcpy(&index, (const char *)item + m->offset, sizeof index);
    write_id(w, list, index);
}

static void write_kind_id(json_out *w, const member *m, const void *item)
{
    uint32_t kind;

    memcpy(&kind, (const char *)item + m->offset, sizeof kind);
    write_id(w, kinds_of(w->whole), kind);
}

static void write_kind_ids(json_out *w, const member *m, const void *item)
{
    const uint32_t *kinds;
    size_t n;

    memcpy(&kinds, (const char *)item + m->offset, sizeof kinds);
    memcpy(&n, (const char *)item + m->offset_n, sizeof n);
    json_out_array(w);
    for (size_t k = 0; k < n; k++)
        write_id(w, kinds_of(w->whole), kinds[k]);
    json_out_array_end(w);
}

static void write_belt_id(json_out *w, const member *m, const void *item)
{
    write_target(w, belts_of(w->whole), m, item);
}

static void write_obstacle_id(json_out *w, const member *m, const void *item)
{
    write_target(w, obstacles_of(w->whole), m, item);
}

static void write_feed_id(json_out *w, const member *m, const void *item)
{
    write_target(w, feeds_of(w->whole), m, item);
}

static void write_eye_id(json_out *w, const member *m, const void *item)
{
    write_target(w, eyes_of(w->whole), m, item);
}

#define ID_KIND(name, write_)                                                                      \
    const member_kind scenario__##name = {                                                         \
        .text = "id", .read = read_id, .write = write_, .write_schema = describe_id                \
    };
ID_KIND(kind_id, write_kind_id)
ID_KIND(belt_id, write_belt_id)
ID_KIND(obstacle_id, write_obstacle_id)
ID_KIND(feed_id, write_feed_id)
ID_KIND(photo_eye_id, write_eye_id)
const member_kind scenario__kind_ids = {
    .text = "list of ids", .read = read_ids, .write = write_kind_ids, .write_schema = describe_ids
};

// ---- looking them up

// Calls look_up for each item of the list that is a member of the object.
typedef void look_up_item(json_in *in, const json_t *value, scene *s, size_t k);

static void for_each(json_in *in, const json_t *document, const char *name, scene *s,
                     look_up_item *look_up)
{
    const json_t *list = json_object_get(document, name);
    size_t mark = json_pointer_enter(&in->pointer, name, strlen(name));

    for (size_t k = 0; k < json_array_size(list); k++) {
        size_t mark_item = json_pointer_enter_index(&in->pointer, k);
        look_up(in, json_array_get(list, k), s, k);
        json_pointer_leave(&in->pointer, mark_item);
    }
    json_pointer_leave(&in->pointer, mark);
}

// The index of the item that a member names; untouched if there is no such member, or no such item.
static void look_up_member(json_in *in, const json_t *object, const char *name, id_list list,
                           size_t *ret_index)
{
    const json_t *value = json_object_get(object, name);
    size_t mark = json_pointer_enter(&in->pointer, name, strlen(name));

    if (value != NULL)
        (void)find(in, list, "", json_string_value(value), ret_index);
    json_pointer_leave(&in->pointer, mark);
}

// A member "kind" that may be missing.
static void look_up_kind(json_in *in, const json_t *object, const scene *s, uint32_t *ret_kind)
{
    size_t kind = *ret_kind;

    look_up_member(in, object, "kind", kinds_of(s), &kind);
    *ret_kind = (uint32_t)kind;
}

// The kinds of a list of their ids; untouched if there are none.
static void look_up_kinds(json_in *in, const json_t *list, const scene *s, uint32_t **ret_kinds)
{
    size_t n = json_array_size(list);
    uint32_t *kinds = n > 0 ? memory_alloc(n, sizeof *kinds) : NULL;

    if (n == 0)
        return;
    if (kinds == NULL) {
        in->has_failed = true;
        return;
    }
    *ret_kinds = kinds;
    for (size_t k = 0; k < n; k++) {
        size_t mark = json_pointer_enter_index(&in->pointer, k);
        (void)scenario__find_kind(in, s, "", json_string_value(json_array_get(list, k)), &kinds[k]);
        json_pointer_leave(&in->pointer, mark);
    }
}

const char *scenario__text_member(const struct json_t *object)
{
    if (json_object_get(object, "measurement") != NULL)
        return "measurement";
    return json_object_get(object, "csv") != NULL ? "csv" : NULL;
}

const char *scenario__text_of(json_in *in, const struct json_t *value, const char *member_name,
                              const char *kind, bf_buffer *stored)
{
    if (strcmp(member_name, "measurement") == 0)
        return json_in_stored_text(in, value, kind, stored) ? stored->bytes : NULL;
    if (!json_is_string(value))
        json_in_fault(in, "must be a string");
    return json_string_value(value);
}

// A list of arrivals as CSV: its ids are in the text, its places are those of the feed's line.
static void read_arrivals(json_in *in, const json_t *schedule, const scene *s, scene_feed *feed)
{
    const char *text_name = scenario__text_member(schedule);
    const char *name = text_name != NULL ? text_name : "kind";
    const json_t *value = json_object_get(schedule, name);
    const size_t mark = json_pointer_enter(&in->pointer, name, strlen(name));
    bf_buffer stored = { 0 };

    if (text_name == NULL) {
        look_up_kinds(in, value, s, &feed->schedule.kinds);
    } else {
        const char *text = scenario__text_of(in, value, name, "schedule", &stored);
        if (text != NULL)
            feed_csv__read_schedule(in, text, s, feed);
    }
    json_pointer_leave(&in->pointer, mark);
    buffer_fini(&stored);
}

static void look_up_feed(json_in *in, const json_t *object, scene *s, size_t k)
{
    scene_feed *feed = &s->feeds[k];
    const json_t *mix = json_object_get(object, "cargo");

    size_t mark = json_pointer_enter(&in->pointer, "cargo", strlen("cargo"));
    for (size_t i = 0; i < json_array_size(mix); i++) {
        size_t kind = 0;
        const size_t mark_item = json_pointer_enter_index(&in->pointer, i);
        look_up_member(in, json_array_get(mix, i), "kind", kinds_of(s), &kind);
        feed->cargo[i].kind = (uint32_t)kind;
        json_pointer_leave(&in->pointer, mark_item);
    }
    json_pointer_leave(&in->pointer, mark);
    mark = json_pointer_enter(&in->pointer, "schedule", strlen("schedule"));
    read_arrivals(in, json_object_get(object, "schedule"), s, feed);
    json_pointer_leave(&in->pointer, mark);
}

static void look_up_sink(json_in *in, const json_t *object, scene *s, size_t k)
{
    const json_t *kinds = json_object_get(object, "kinds");
    const size_t mark = json_pointer_enter(&in->pointer, "kinds", strlen("kinds"));

    if (kinds != NULL && json_array_size(kinds) == 0)
        json_in_fault(in, "must have at least 1 id; without this member it takes all kinds");
    look_up_kinds(in, kinds, s, &s->sinks[k].kinds);
    s->sinks[k].n_kinds = json_array_size(kinds);
    json_pointer_leave(&in->pointer, mark);
}

static void look_up_action(json_in *in, const json_t *object, scene *s, size_t k)
{
    scene_action *action = &s->actions[k];
    const json_t *target = json_object_get(object, "do");

    size_t mark = json_pointer_enter(&in->pointer, "when", strlen("when"));
    look_up_member(in, json_object_get(object, "when"), "photo_eye", eyes_of(s), &action->eye);
    look_up_kind(in, json_object_get(object, "when"), s, &action->kind);
    json_pointer_leave(&in->pointer, mark);
    mark = json_pointer_enter(&in->pointer, "do", strlen("do"));
    look_up_member(in, target, "belt", belts_of(s), &action->target);
    look_up_member(in, target, "obstacle", obstacles_of(s), &action->target);
    look_up_member(in, target, "feed", feeds_of(s), &action->target);
    json_pointer_leave(&in->pointer, mark);
}

static void look_up_merge(json_in *in, const json_t *object, scene *s, size_t k)
{
    const json_t *lanes = json_object_get(object, "lanes");
    const size_t mark = json_pointer_enter(&in->pointer, "lanes", strlen("lanes"));

    for (size_t i = 0; i < json_array_size(lanes); i++) {
        const json_t *lane = json_array_get(lanes, i);
        const size_t mark_item = json_pointer_enter_index(&in->pointer, i);
        look_up_member(in, lane, "belt", belts_of(s), &s->merges[k].lanes[i].belt);
        look_up_member(in, lane, "photo_eye", eyes_of(s), &s->merges[k].lanes[i].eye);
        json_pointer_leave(&in->pointer, mark_item);
    }
    json_pointer_leave(&in->pointer, mark);
}

static void look_up_counter(json_in *in, const json_t *object, scene *s, size_t k)
{
    look_up_kind(in, object, s, &s->counters[k].kind);
}

void scenario__look_up(json_in *in, const json_t *document, scene *s)
{
    for_each(in, document, "counters", s, look_up_counter);
    for_each(in, document, "feeds", s, look_up_feed);
    for_each(in, document, "sinks", s, look_up_sink);
    for_each(in, document, "actions", s, look_up_action);
    for_each(in, document, "merges", s, look_up_merge);
}
