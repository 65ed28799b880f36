// What photo eyes saw and did, drives under load and belts that failed, from frames and from stored events: photo_eyes.csv, and JSON with the actions.

#include "api/results/results.h"

#include "api/json/number.h"
#include "api/json/text.h"
#include "api/results/results_priv.h"
#include "core/world/belt_stops.h"
#include "core/world/plate_drive.h"

#include <jansson.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#define CSV_HEADER "t_s,photo_eye,state\n"

static const char *const states[] = { "clear", "blocked", NULL };

static bf_status append_row(double t, const char *id, uint32_t is_blocked, bf_buffer *out)
{
    char time[NUMBER_SIZE];

    number_format(t, time);
    return buffer_printf(out, "%s,%s,%s\n", time, id, states[is_blocked != 0]);
}

bf_status results_photo_eyes_csv(const frame_change *c, bf_buffer *out, bf_error *err)
{
    const size_t n_before = out->n;
    bf_status status = BF_OK;

    if (c->type != FRAME_CHANGE_EYE)
        return BF_OK;
    if (out->n == 0)
        status = buffer_printf(out, CSV_HEADER);
    if (status == BF_OK)
        status = append_row(c->t, c->id, c->state, out);
    return results__finish(status, out, n_before, err);
}

static bool read_eye(json_t *json, results_eye_change *ret_change)
{
    const char *id, *state;
    double t;

    if (json_unpack(json, "{s:F, s:s, s:s}", "t_s", &t, "photo_eye", &id, "state", &state) != 0)
        return false;
    *ret_change = (results_eye_change){ .t = t, .is_blocked = strcmp(state, states[1]) == 0 };
    snprintf(ret_change->id, sizeof ret_change->id, "%s", id);
    return true;
}

static bool read_action(json_t *json, results_action *ret_action)
{
    const char *target;
    json_int_t index;
    double t;

    if (json_unpack(json, "{s:F, s:I, s:s}", "t_s", &t, "action", &index, "target", &target) != 0)
        return false;
    *ret_action = (results_action){ .t = t, .index = (uint64_t)index };
    snprintf(ret_action->target, sizeof ret_action->target, "%s", target);
    return true;
}

static bool read_drive(json_t *json, results_drive *ret_drive)
{
    const char *id, *state;
    results_drive drive = { .state = 0 };

    if (json_unpack(json, "{s:F, s:s, s:s, s:F, s?[FF]}", "t_s", &drive.t, "obstacle", &id, "state",
                    &state, "turn_deg", &drive.turn_deg, "shift_m", &drive.shift.x,
                    &drive.shift.y) != 0)
        return false;
    drive.state = (uint32_t)text_find_word(results__drive_states, PLATE_DRIVE_STATE_COUNT, state);
    snprintf(drive.id, sizeof drive.id, "%s", id);
    *ret_drive = drive;
    return drive.state < PLATE_DRIVE_STATE_COUNT;
}

static bool read_stop(json_t *json, results_stop *ret_stop)
{
    const char *id, *state;
    results_stop stop = { .state = 0 };

    if (json_unpack(json, "{s:F, s:s, s:s}", "t_s", &stop.t, "belt", &id, "state", &state) != 0)
        return false;
    stop.state = (uint32_t)text_find_word(results__belt_states, BELT_STOPS_CAUSE_COUNT, state);
    snprintf(stop.id, sizeof stop.id, "%s", id);
    *ret_stop = stop;
    return stop.state < BELT_STOPS_CAUSE_COUNT;
}

static bf_status on_event(void *context, const api_event *event, bf_error *err)
{
    results_changes *changes = context;
    json_t *json = json_loadb(event->data, event->n, 0, NULL);
    bf_status status = BF_ECORRUPT;
    results_eye_change change;
    results_action action;
    results_drive drive;
    results_stop stop;

    if (event->type == API_EVENT_EYE && read_eye(json, &change))
        status = buffer_append(&changes->eyes, &change, sizeof change);
    else if (event->type == API_EVENT_ACTION && read_action(json, &action))
        status = buffer_append(&changes->actions, &action, sizeof action);
    else if (event->type == API_EVENT_DRIVE && read_drive(json, &drive))
        status = buffer_append(&changes->drives, &drive, sizeof drive);
    else if (event->type == API_EVENT_BELT && read_stop(json, &stop))
        status = buffer_append(&changes->stops, &stop, sizeof stop);
    json_decref(json);
    return status == BF_OK ? BF_OK
                           : bf_fail(err, status, "", "an event of the equipment cannot be read");
}

bf_status results_changes_read(const api_services *services, const char *id,
                               results_changes *changes, bf_error *err)
{
    const bf_status status = services->read_changes(services->store, id, on_event, changes, err);

    if (status != BF_OK)
        results_changes_fini(changes);
    return status;
}

void results_changes_fini(results_changes *changes)
{
    buffer_fini(&changes->eyes);
    buffer_fini(&changes->actions);
    buffer_fini(&changes->drives);
    buffer_fini(&changes->stops);
}

bf_status results_changes_csv(const results_changes *changes, bf_buffer *out, bf_error *err)
{
    const results_eye_change *eyes = (const results_eye_change *)(const void *)changes->eyes.bytes;
    const size_t n_before = out->n, n = changes->eyes.n / sizeof *eyes;
    bf_status status = buffer_printf(out, CSV_HEADER);

    for (size_t k = 0; k < n && status == BF_OK; k++)
        status = append_row(eyes[k].t, eyes[k].id, eyes[k].is_blocked, out);
    return results__finish(status, out, n_before, err);
}

#define AT(place) offsetof(results_eye_change, place)
static const member eye_members[] = {
    MEMBER("t_s", number, AT(t), "When its state changed", .unit = "s"),
    MEMBER("photo_eye", text, AT(id), "Its id", .type = "#ScenarioId"),
    MEMBER("state", enum, AT(is_blocked), "Its state from then on", .words = states),
};
const member_table results_eye_members = { MEMBER_TABLE("PhotoEyeChange", eye_members),
                                           .size = sizeof(results_eye_change) };
#undef AT

#define AT(place) offsetof(results_action, place)
static const member action_members[] = {
    MEMBER("t_s", number, AT(t), "When it was carried out", .unit = "s"),
    MEMBER("action", size, AT(index), "Its index in the scenario's `actions`"),
    MEMBER("target", text, AT(target), "Id of the belt, obstacle or feed", .type = "#ScenarioId"),
};
const member_table results_action_members = { MEMBER_TABLE("PhotoEyeAction", action_members),
                                              .size = sizeof(results_action) };
#undef AT

static bool is_shifted(const void *item)
{
    const results_drive *drive = item;

    return drive->shift.x != 0.0 || drive->shift.y != 0.0;
}

#define AT(place) offsetof(results_drive, place)
static const member drive_members[] = {
    MEMBER("t_s", number, AT(t), "When it was so", .unit = "s"),
    MEMBER("obstacle", text, AT(id), "Its id", .type = "#ScenarioId"),
    RESULTS__DRIVE_MEMBERS(is_shifted),
};
const member_table results_drive_members = { MEMBER_TABLE("Drive", drive_members),
                                             .size = sizeof(results_drive) };
#undef AT

#define AT(place) offsetof(results_stop, place)
static const member stop_members[] = {
    MEMBER("t_s", number, AT(t), "When it was so", .unit = "s"),
    MEMBER("belt", text, AT(id), "Its id", .type = "#ScenarioId"),
    RESULTS__BELT_MEMBERS,
};
const member_table results_stop_members = { MEMBER_TABLE("BeltStop", stop_members),
                                            .size = sizeof(results_stop) };
#undef AT

// What the JSON is written from.
typedef struct changes_view {
    const results_eye_change *eyes;
    size_t n_eyes;
    const results_action *actions;
    size_t n_actions;
    const results_drive *drives;
    size_t n_drives;
    const results_stop *stops;
    size_t n_stops;
    bool is_cut;
} changes_view;

#define AT(place) offsetof(changes_view, place)
static const member changes_members[] = {
    MEMBER("changes", list, AT(eyes), "Changes of the photo eyes' states", .offset_n = AT(n_eyes),
           .table = &results_eye_members),
    MEMBER("actions", list, AT(actions), "Actions that were carried out", .offset_n = AT(n_actions),
           .table = &results_action_members),
    MEMBER("drives", list, AT(drives),
           "How obstacles that cargo holds back follow what they are told: a change of state, and "
           "every 2 degrees that they turn, or 10 mm that they are shifted, while behind",
           .offset_n = AT(n_drives), .table = &results_drive_members),
    MEMBER("belts", list, AT(stops),
           "When failures, breaks and merges began to stop belts, and when that ended",
           .offset_n = AT(n_stops), .table = &results_stop_members),
    MEMBER("is_cut", bool, AT(is_cut),
           "There are as many as a run keeps, and what came later is not among them"),
};
const member_table results_changes_members = { MEMBER_TABLE("PhotoEyes", changes_members) };
#undef AT

bf_status results_changes_json(const results_changes *changes, bf_buffer *out, bf_error *err)
{
    changes_view of = { .eyes = (const results_eye_change *)(const void *)changes->eyes.bytes,
                        .n_eyes = changes->eyes.n / sizeof *of.eyes,
                        .actions = (const results_action *)(const void *)changes->actions.bytes,
                        .n_actions = changes->actions.n / sizeof *of.actions,
                        .drives = (const results_drive *)(const void *)changes->drives.bytes,
                        .n_drives = changes->drives.n / sizeof *of.drives,
                        .stops = (const results_stop *)(const void *)changes->stops.bytes,
                        .n_stops = changes->stops.n / sizeof *of.stops };
    json_out w = json_out_to(out);

    of.is_cut = of.n_eyes + of.n_actions + of.n_drives + of.n_stops >= FRAME_CHANGES_MAX;
    members_write(&w, &results_changes_members, &of);
    return json_out_status(&w, err);
}
