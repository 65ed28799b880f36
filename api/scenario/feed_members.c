// Feeds as tables.

#include "api/json/schema.h"
#include "api/scenario/feed_csv.h"
#include "api/scenario/scenario_priv.h"
#include "core/scene/ranges.h"
#include "core/scene/scene.h"

#include <jansson.h>
#include <math.h>
#include <string.h>

static const char *const side_words[] = { "west", "east", "south", "north", NULL };
static const char *const arrivals_words[] = { "regular", "poisson", "erlang", "batch", NULL };
static const char *const blocked_words[] = { "wait", "discard", NULL };
HAS_WORDS(side_words, SCENE_SIDE_COUNT);
HAS_WORDS(arrivals_words, SCENE_ARRIVALS_COUNT);
HAS_WORDS(blocked_words, SCENE_BLOCKED_COUNT);

static void init_feed(void *item, size_t place)
{
    (void)place;
    scene_feed_init(item);
}

static void init_profile(void *item, size_t place)
{
    (void)place;
    *(scene_series *)item = (scene_series){ .repeat = INFINITY };
}

// ---- where

static bool is_on_side(const void *item)
{
    return ((const scene_feed *)item)->edge != SCENE_SIDE_COUNT;
}

static bool is_inside(const void *item)
{
    return !is_on_side(item);
}

static bool is_along_x(const void *item)
{
    const scene_side edge = ((const scene_feed *)item)->edge;

    return edge == SCENE_SOUTH || edge == SCENE_NORTH;
}

static bool is_along_y(const void *item)
{
    return is_on_side(item) && !is_along_x(item);
}

// One coordinate of both ends of a line, as [from, to].
static void read_extent(json_in *in, const json_t *value, const member *m, void *item)
{
    double *first = (double *)(void *)((char *)item + m->offset), extent[2];
    size_t n_faults = in->faults->n;

    json_in_tuple(in, value, 2, 2, extent, NULL);
    if (in->faults->n != n_faults)
        return;
    first[0] = extent[0];
    first[sizeof(vec2) / sizeof *first] = extent[1];
}

static void write_extent(json_out *w, const member *m, const void *item)
{
    const double *first = (const double *)(const void *)((const char *)item + m->offset);

    json_out_numbers(w, first, 2, sizeof(vec2) / sizeof *first);
}

static const member_kind member_extent = {
    .text = "[from, to]", .type = "#Pair", .read = read_extent, .write = write_extent
};

// ---- headings

static void read_heading(json_in *in, const json_t *value, const member *m, void *item)
{
    scene_feed *feed = item;

    if (!json_is_string(value)) {
        member_degrees.read(in, value, m, item);
        feed->has_random_heading = false;
    } else if (strcmp(json_string_value(value), "random") == 0) {
        feed->has_random_heading = true;
    } else {
        json_in_fault(in, "must be a number or \"random\"");
    }
}

static void write_heading(json_out *w, const member *m, const void *item)
{
    const scene_feed *feed = item;

    if (feed->has_random_heading)
        json_out_string(w, "random");
    else
        member_degrees.write(w, m, item);
}

static void describe_heading(json_out *w, const member *m, member_view view)
{
    (void)m;
    (void)view;
    json_out_key(w, "oneOf");
    json_out_array(w);
    schema_write(w, "number", NULL, NULL);
    schema_write(w, "=random", NULL, NULL);
    json_out_array_end(w);
}

static const member_kind member_heading = { .text = "number or \"random\"",
                                            .read = read_heading,
                                            .write = write_heading,
                                            .write_schema = describe_heading };

// ---- how many and when

// CSV as a text, or the id of a stored one; they are read when all members of their object were.
static const member_kind member_csv = { .text = "string", .type = "string" };
static const member_kind member_stored = { .text = "id", .type = "#Id" };

static const char *const csv_form[] = { "csv", NULL };
static const char *const stored_form[] = { "measurement", NULL };
static const char *const profile_form_lists[] = { "t_s", "rate_per_s", NULL };
static const char *const *const profile_forms[] = { profile_form_lists, csv_form, stored_form,
                                                    NULL };
static const char *const schedule_form_lists[] = { "t_s", NULL };
static const char *const *const schedule_forms[] = { schedule_form_lists, csv_form, stored_form,
                                                     NULL };

// True if CSV stands there, or the id of a stored text, alone; else a fault is noted where there are lists beside it,
// or nothing of these.
static bool has_text_alone(json_in *in, const json_t *object, const member *members, size_t n)
{
    const char *text_name = scenario__text_member(object);

    if (text_name == NULL && json_object_get(object, "t_s") == NULL)
        json_in_fault(in, "must have t_s, csv or measurement");
    if (text_name == NULL)
        return false;
    for (size_t k = 0; k < n; k++) {
        const bool is_list = members[k].limit > 0;
        const bool is_other = strcmp(members[k].name, "csv") == 0 && strcmp(text_name, "csv") != 0;
        if ((is_list || is_other) && json_object_get(object, members[k].name) != NULL) {
            const size_t mark =
                json_pointer_enter(&in->pointer, members[k].name, strlen(members[k].name));
            json_in_fault(in, "does not stand beside %s", text_name);
            json_pointer_leave(&in->pointer, mark);
            return false;
        }
    }
    return true;
}

#define AT(place) offsetof(scene_series, place)
#define FROM_TEXT "from csv or measurement"
static const member profile_members[] = {
    MEMBER("t_s", numbers, AT(times), "times of the rates after start_s, rising", .unit = "s",
           .offset_n = AT(n_times), .range = &scene_range_instant, .least = 1,
           .limit = SCENE_SERIES_MAX, .default_text = FROM_TEXT),
    MEMBER("rate_per_s", numbers, AT(values), "one for each time; linear between", .unit = "1/s",
           .offset_n = AT(n_values), .range = &scene_range_profile, .least = 1,
           .limit = SCENE_SERIES_MAX, .default_text = FROM_TEXT),
    MEMBER("csv", csv, 0, "both as CSV: t_s and one of rate_per_s, rate_per_h, count",
           .flags = MEMBER_FORM),
    MEMBER("measurement", stored, 0, "both from a stored measurement of the kind profile",
           .flags = MEMBER_FORM),
    MEMBER("repeat_s", number, AT(repeat), "after which it begins again", .unit = "s",
           .range = &scene_range_time, .flags = MEMBER_OMIT_EMPTY, .default_text = "never"),
};

static void read_profile_text(json_in *in, const struct json_t *object, void *item)
{
    bf_buffer stored = { 0 };

    if (!has_text_alone(in, object, profile_members,
                        sizeof profile_members / sizeof *profile_members))
        return;
    const char *name = scenario__text_member(object);
    const size_t mark = json_pointer_enter(&in->pointer, name, strlen(name));
    const char *text =
        scenario__text_of(in, json_object_get(object, name), name, "profile", &stored);
    if (text != NULL)
        feed_csv__read_profile(in, text, item);
    json_pointer_leave(&in->pointer, mark);
    buffer_fini(&stored);
}

static const member_table profile_table = { MEMBER_TABLE("profile", profile_members),
                                            .size = sizeof(scene_series), .init = init_profile,
                                            .forms = profile_forms,
                                            .post_read = read_profile_text };
#undef AT

#define AT(place) offsetof(scene_arrival_list, place)
#define EACH      .offset_n = AT(n), .least = 1, .limit = SCENE_SERIES_MAX
static bool has_no_counts(const void *item)
{
    return ((const scene_arrival_list *)item)->counts == NULL;
}

static bool has_no_kinds(const void *item)
{
    return ((const scene_arrival_list *)item)->kinds == NULL;
}

static bool has_no_places(const void *item)
{
    return ((const scene_arrival_list *)item)->places == NULL;
}

static bool has_no_headings(const void *item)
{
    return ((const scene_arrival_list *)item)->headings == NULL;
}

static const member schedule_members[] = {
    MEMBER("t_s", numbers, AT(times), "times of the run at which parts arrive, not falling",
           .unit = "s", .range = &scene_range_instant, .default_text = FROM_TEXT, EACH),
    MEMBER("count", counts, AT(counts), "how many at once, one for each time",
           .range = &scene_range_count, .flags = MEMBER_OMIT_EMPTY, .is_empty = has_no_counts,
           .default_text = "1 each", EACH),
    MEMBER_OF("kind", &scenario__kind_ids, AT(kinds), "ids of their kinds of cargo",
              .flags = MEMBER_OMIT_EMPTY, .is_empty = has_no_kinds,
              .default_text = "drawn from cargo", EACH),
    MEMBER("place", numbers_or_null, AT(places),
           "where on the line: 0 its start, 1 its end; null: drawn", .range = &scene_range_place,
           .flags = MEMBER_OMIT_EMPTY, .is_empty = has_no_places, .default_text = "drawn", EACH),
    MEMBER("heading_deg", angles_or_null, AT(headings), "null: that of the feed", .unit = "deg",
           .flags = MEMBER_OMIT_EMPTY, .is_empty = has_no_headings,
           .default_text = "those of the feed", EACH),
    MEMBER("csv", csv, 0, "all of them as CSV: t_s, count, kind, x_m or y_m, heading_deg",
           .flags = MEMBER_FORM),
    MEMBER("measurement", stored, 0, "all of them from a stored measurement of the kind schedule",
           .flags = MEMBER_FORM),
};

// All lists of a schedule have an item for each time.
static void check_lengths(json_in *in, const struct json_t *object, void *item)
{
    scene_arrival_list *list = item;

    if (has_text_alone(in, object, schedule_members,
                       sizeof schedule_members / sizeof *schedule_members))
        return;
    list->n = json_array_size(json_object_get(object, "t_s"));
    for (size_t k = 1; k < sizeof schedule_members / sizeof *schedule_members; k++) {
        const char *name = schedule_members[k].name;
        const json_t *value = json_object_get(object, name);
        if (value == NULL || !json_is_array(value) || json_array_size(value) == list->n)
            continue;
        size_t mark = json_pointer_enter(&in->pointer, name, strlen(name));
        json_in_fault(in, "has %zu items, but t_s has %zu", json_array_size(value), list->n);
        json_pointer_leave(&in->pointer, mark);
    }
}

static const member_table schedule_table = { MEMBER_TABLE("schedule", schedule_members),
                                             .size = sizeof(scene_arrival_list),
                                             .forms = schedule_forms, .post_read = check_lengths };
#undef EACH
#undef AT

// ---- the feed

#define AT(place) offsetof(scene_feed_kind, place)
static const member mix_members[] = {
    MEMBER_OF("kind", &scenario__kind_id, AT(kind), "id of a kind of cargo"),
    MEMBER("share", number, AT(share),
           "how many parts are of the kind, in proportion to all shares",
           .range = &scene_range_share, .default_text = "1"),
};
static void init_mix(void *item, size_t place)
{
    (void)place;
    *(scene_feed_kind *)item = (scene_feed_kind){ .kind = UINT32_MAX, .share = 1.0 };
}
static const member_table mix_table = { MEMBER_TABLE("feedKind", mix_members),
                                        .size = sizeof(scene_feed_kind), .init = init_mix };
#undef AT

static const char *const rate_form[] = { "rate_per_s", NULL };
static const char *const profile_form[] = { "profile", NULL };
static const char *const schedule_form[] = { "schedule", NULL };
static const char *const *const demand_forms[] = { [SCENE_DEMAND_RATE] = rate_form,
                                                   [SCENE_DEMAND_PROFILE] = profile_form,
                                                   [SCENE_DEMAND_SCHEDULE] = schedule_form,
                                                   [SCENE_DEMAND_COUNT] = NULL };

#define AT(place) offsetof(scene_feed, place)
static const member feed_members[] = {
    MEMBER("id", text, AT(id), "its name", .default_text = "feed-1, feed-2, ...", .least = 1,
           .limit = SCENE_ID_SIZE),
    MEMBER("edge", enum, AT(edge), "the side of the domain that parts enter over",
           .words = side_words, .flags = MEMBER_OMIT_EMPTY, .default_text = "they enter on line_m"),
    MEMBER("x_m", extent, AT(line[0].x), "which part of the side: south, north", .unit = "m",
           .default_text = "the whole side", .applies = is_along_x),
    MEMBER("y_m", extent, AT(line[0].y), "which part of the side: west, east", .unit = "m",
           .default_text = "the whole side", .applies = is_along_y),
    MEMBER("line_m", line, AT(line), "ends of a line inside that parts enter on", .unit = "m",
           .default_text = "they enter over edge", .applies = is_inside),
    MEMBER("start_s", number, AT(start), "before it none arrives", .unit = "s",
           .range = &scene_range_instant, .flags = MEMBER_INIT),
    MEMBER("end_s", number, AT(end), "from then on none arrives", .unit = "s",
           .range = &scene_range_time, .flags = MEMBER_OMIT_EMPTY, .default_text = "never"),
    MEMBER("count", whole, AT(count), "most parts", .range = &scene_range_count,
           .flags = MEMBER_OMIT_EMPTY, .default_text = "any number"),
    MEMBER("arrivals", enum, AT(arrivals), "how parts follow each other", .words = arrivals_words,
           .flags = MEMBER_INIT),
    MEMBER("shape", count, AT(shape), "of erlang: stages of a gap", .range = &scene_range_count,
           .flags = MEMBER_INIT),
    MEMBER("batch_size", count, AT(batch_size), "of batch: parts at once",
           .range = &scene_range_count, .flags = MEMBER_INIT),
    MEMBER("rate_per_s", number, AT(rate), "how many arrive: a constant rate", .unit = "1/s",
           .range = &scene_range_rate),
    MEMBER("profile", object, AT(profile), "how many arrive: a rate that changes in time",
           .table = &profile_table),
    MEMBER("schedule", object, AT(schedule), "how many arrive: a list of arrivals",
           .table = &schedule_table),
    MEMBER("heading_deg", heading, AT(heading), "of its parts, from the x axis", .unit = "deg",
           .flags = MEMBER_INIT),
    MEMBER("cargo", array, AT(cargo), "the kinds of its parts", .table = &mix_table,
           .offset_n = AT(n_cargo), .least = 1, .limit = SCENE_KINDS_MAX,
           .default_text = "all kinds with their shares"),
    MEMBER("when_blocked", enum, AT(when_blocked), "what parts do that find no free place",
           .words = blocked_words, .flags = MEMBER_INIT),
    MEMBER("max_wait_s", number, AT(max_wait), "how long parts wait that are then discarded",
           .unit = "s", .range = &scene_range_instant, .flags = MEMBER_INIT),
    MEMBER("seed", seed, AT(seed), "of its draws", .range = &scene_range_seed,
           .flags = MEMBER_INIT),
};

// A feed lies on a side or on a line.
static void check_place(json_in *in, const struct json_t *object, void *item)
{
    scene_feed *feed = item;

    feed->is_edge = is_on_side(feed);
    if (feed->is_edge || json_object_get(object, "edge") != NULL ||
        json_object_get(object, "line_m") != NULL)
        return;
    json_in_fault(in, "must have edge or line_m");
}

const member_table scenario__feed_members = { MEMBER_TABLE("feed", feed_members),
                                              .size = sizeof(scene_feed),
                                              .init = init_feed,
                                              .choice = MEMBER_ONE_FORM,
                                              .offset_choice = AT(demand),
                                              .forms = demand_forms,
                                              .post_read = check_place };
#undef AT
