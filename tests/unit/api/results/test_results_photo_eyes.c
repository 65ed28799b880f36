// Unit tests of the changes of photo eyes: the same lines from frames and from stored events, and JSON.

#include "api/results/events.h"
#include "api/results/results.h"
#include "core/base/memory.h"
#include "core/world/belt_stops.h"
#include "core/world/plate_drive.h"
#include "tests/unit/helper_cmocka.h"

#include <math.h>
#include <string.h>

static const char run_id[] = "0190a0b0-0000-7000-8000-000000000001";

static const frame_change changes[] = {
    { .index = 0, .t = 0.5, .type = FRAME_CHANGE_EYE, .state = 1, .id = "pe1" },
    { .index = 1, .t = 0.5, .type = FRAME_CHANGE_ACTION, .item = 2, .id = "main" },
    { .index = 2, .t = 1.25, .type = FRAME_CHANGE_EYE, .id = "pe2" },
    { .index = 3, .t = 1.5, .type = FRAME_CHANGE_DRIVE, .state = 2, .id = "arm", .turn = -M_PI_4 },
    { .index = 4,
      .t = 2.0,
      .type = FRAME_CHANGE_BELT,
      .state = BELT_STOPS_BY_FAILURE,
      .id = "main" },
    { .index = 5, .t = 3.5, .type = FRAME_CHANGE_BELT, .state = BELT_STOPS_BY_BREAK, .id = "main" },
};
enum { N_CHANGES = sizeof changes / sizeof *changes };

static const char expected[] = "t_s,photo_eye,state\n0.5,pe1,blocked\n1.25,pe2,clear\n";

static void changes_of_photo_eyes_are_lines(void **state)
{
    bf_buffer csv = { 0 };

    for (size_t k = 0; k < N_CHANGES; k++)
        assert_int_equal(results_photo_eyes_csv(&changes[k], &csv, NULL), BF_OK);
    assert_string_equal(csv.bytes, expected);
    buffer_fini(&csv);
}

// A store of the changes; damaged ones where context is not NULL.
static bf_status read_changes(api_store *store, const char *id, api_event_fn *on_event,
                              void *context, bf_error *err)
{
    static const api_event_type types[FRAME_CHANGE_TYPE_COUNT] = { API_EVENT_EYE, API_EVENT_ACTION,
                                                                   API_EVENT_DRIVE,
                                                                   API_EVENT_BELT };
    bf_status status = BF_OK;

    assert_string_equal(id, run_id);
    for (uint64_t k = 0; k < N_CHANGES && status == BF_OK; k++) {
        const frame_change *c = &changes[k];
        bf_buffer data = { 0 };
        status = (void *)store != NULL ? buffer_printf(&data, "{\"run\":1}")
                                       : events_change(run_id, c, &data, err);
        const api_event event = {
            .id = k + 1, .type = types[c->type], .n = data.n, .data = data.bytes
        };
        if (status == BF_OK)
            status = on_event(context, &event, err);
        buffer_fini(&data);
    }
    return status;
}

static void stored_events_give_the_same_lines(void **state)
{
    const api_services services = { .read_changes = read_changes };
    results_changes read = { 0 };
    bf_buffer text = { 0 };

    assert_int_equal(results_changes_read(&services, run_id, &read, NULL), BF_OK);
    assert_int_equal(results_changes_csv(&read, &text, NULL), BF_OK);
    assert_string_equal(text.bytes, expected);
    text.n = 0;
    assert_int_equal(results_changes_json(&read, &text, NULL), BF_OK);
    assert_string_equal(
        text.bytes,
        "{\"changes\":[{\"t_s\":0.5,\"photo_eye\":\"pe1\",\"state\":\"blocked\"},"
        "{\"t_s\":1.25,\"photo_eye\":\"pe2\",\"state\":\"clear\"}],"
        "\"actions\":[{\"t_s\":0.5,\"action\":2,\"target\":\"main\"}],"
        "\"drives\":[{\"t_s\":1.5,\"obstacle\":\"arm\",\"state\":\"stalled\",\"turn_deg\":-45}],"
        "\"belts\":[{\"t_s\":2,\"belt\":\"main\",\"state\":\"failed\"},"
        "{\"t_s\":3.5,\"belt\":\"main\",\"state\":\"break\"}],\"is_cut\":false}");
    results_changes_fini(&read);
    buffer_fini(&text);
}

static void as_many_as_a_run_keeps_may_not_be_all(void **state)
{
    static const results_eye_change change = { .t = 1.0, .id = "pe" };
    static const results_action action = { .t = 1.0, .target = "main" };
    static const results_drive drive = { .t = 1.0, .id = "arm" };
    static const results_stop stop = { .t = 1.0, .id = "main" };
    results_changes kept = { 0 };
    bf_buffer json = { 0 };

    assert_int_equal(buffer_append(&kept.drives, &drive, sizeof drive), BF_OK);
    assert_int_equal(buffer_append(&kept.stops, &stop, sizeof stop), BF_OK);
    for (int k = 0; k < FRAME_CHANGES_MAX - 4; k++)
        assert_int_equal(buffer_append(&kept.eyes, &change, sizeof change), BF_OK);
    for (int k = 0; k < 2; k++) {
        assert_int_equal(buffer_append(&kept.actions, &action, sizeof action), BF_OK);
        json.n = 0;
        assert_int_equal(results_changes_json(&kept, &json, NULL), BF_OK);
        assert_non_null(
            strstr(json.bytes + json.n - 20, k == 0 ? "\"is_cut\":false}" : "\"is_cut\":true}"));
    }
    results_changes_fini(&kept);
    buffer_fini(&json);
}

static void a_damaged_event_is_reported(void **state)
{
    const api_services services = { .store = (void *)&(int){ 1 }, .read_changes = read_changes };
    results_changes read = { 0 };

    assert_int_equal(results_changes_read(&services, run_id, &read, NULL), BF_ECORRUPT);
    assert_int_equal(read.eyes.n + read.actions.n + read.drives.n + read.stops.n, 0);
}

static void events_say_what_changed(void **state)
{
    bf_buffer data = { 0 };

    assert_int_equal(events_change(run_id, &changes[0], &data, NULL), BF_OK);
    assert_non_null(strstr(data.bytes, "\"t_s\":0.5,\"photo_eye\":\"pe1\",\"state\":\"blocked\"}"));
    data.n = 0;
    assert_int_equal(events_change(run_id, &changes[1], &data, NULL), BF_OK);
    assert_non_null(strstr(data.bytes, "\"t_s\":0.5,\"action\":2,\"target\":\"main\"}"));
    data.n = 0;
    assert_int_equal(events_change(run_id, &changes[3], &data, NULL), BF_OK);
    assert_non_null(strstr(
        data.bytes, "\"t_s\":1.5,\"obstacle\":\"arm\",\"state\":\"stalled\",\"turn_deg\":-45}"));
    const frame_change unknown = { .type = FRAME_CHANGE_DRIVE, .state = PLATE_DRIVE_STATE_COUNT };
    assert_int_equal(events_change(run_id, &unknown, &data, NULL), BF_ECORRUPT);
    data.n = 0;
    assert_int_equal(events_change(run_id, &changes[4], &data, NULL), BF_OK);
    assert_non_null(strstr(data.bytes, "\"t_s\":2,\"belt\":\"main\",\"state\":\"failed\"}"));
    data.n = 0;
    const frame_change held = {
        .t = 4.0, .type = FRAME_CHANGE_BELT, .state = BELT_STOPS_BY_MERGE, .id = "lane"
    };
    assert_int_equal(events_change(run_id, &held, &data, NULL), BF_OK);
    assert_non_null(strstr(data.bytes, "\"t_s\":4,\"belt\":\"lane\",\"state\":\"held\"}"));
    const frame_change no_state = { .type = FRAME_CHANGE_BELT, .state = BELT_STOPS_CAUSE_COUNT };
    assert_int_equal(events_change(run_id, &no_state, &data, NULL), BF_ECORRUPT);
    buffer_fini(&data);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(changes_of_photo_eyes_are_lines),
        cmocka_unit_test(stored_events_give_the_same_lines),
        cmocka_unit_test(as_many_as_a_run_keeps_may_not_be_all),
        cmocka_unit_test(a_damaged_event_is_reported),
        cmocka_unit_test(events_say_what_changed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
