// Unit tests of photo_eyes.csv: the same lines from frames and from stored events.

#include "api/results/events.h"
#include "api/results/results.h"
#include "core/base/memory.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

static const char run_id[] = "0190a0b0-0000-7000-8000-000000000001";

static const frame_change changes[] = {
    { .index = 0, .t = 0.5, .type = FRAME_CHANGE_EYE, .is_blocked = 1, .id = "pe1" },
    { .index = 1, .t = 0.5, .type = FRAME_CHANGE_ACTION, .item = 2, .id = "main" },
    { .index = 2, .t = 1.25, .type = FRAME_CHANGE_EYE, .id = "pe2" },
};
enum { N_CHANGES = sizeof changes / sizeof *changes };

static const char expected[] = "t_s,photo_eye,state\n0.5,pe1,blocked\n1.25,pe2,clear\n";

static void changes_of_photo_eyes_are_lines(void **state)
{
    bf_buffer csv = { 0 };

    (void)state;
    for (size_t k = 0; k < N_CHANGES; k++)
        assert_int_equal(results_photo_eyes_csv(&changes[k], &csv, NULL), BF_OK);
    assert_string_equal(csv.bytes, expected);
    buffer_fini(&csv);
}

// A store that gives one event a turn: the changes, with ids from 1; damaged ones where context is not NULL.
static bf_status read_events(void *context, const char (*runs)[API_ID_SIZE], size_t n_runs,
                             uint64_t after, size_t limit_bytes, api_event_fn *take,
                             void *take_context, bf_error *err)
{
    bf_buffer data = { 0 };

    (void)limit_bytes;
    assert_int_equal(n_runs, 1);
    assert_string_equal(runs[0], run_id);
    if (after == N_CHANGES)
        return BF_OK;
    const frame_change *c = &changes[after];
    bf_status status = context != NULL ? buffer_printf(&data, "{\"run\":1}")
                                       : events_change(run_id, c, &data, err);
    const api_event event = { .id = after + 1,
                              .type =
                                  c->type == FRAME_CHANGE_EYE ? API_EVENT_EYE : API_EVENT_ACTION,
                              .n = data.n,
                              .data = data.bytes };
    if (status == BF_OK)
        status = take(take_context, &event, err);
    buffer_fini(&data);
    return status;
}

static void stored_events_give_the_same_lines(void **state)
{
    const api_services services = { .read_events = read_events };
    bf_buffer csv = { 0 };

    (void)state;
    assert_int_equal(results_photo_eyes_read(&services, run_id, &csv, NULL), BF_OK);
    assert_string_equal(csv.bytes, expected);
    buffer_fini(&csv);
}

static void a_damaged_event_is_reported(void **state)
{
    const api_services services = { .context = &(int){ 1 }, .read_events = read_events };
    bf_buffer csv = { 0 };

    (void)state;
    assert_int_equal(results_photo_eyes_read(&services, run_id, &csv, NULL), BF_ECORRUPT);
    assert_int_equal(csv.n, 0);
    buffer_fini(&csv);
}

static void events_say_what_changed(void **state)
{
    bf_buffer data = { 0 };

    (void)state;
    assert_int_equal(events_change(run_id, &changes[0], &data, NULL), BF_OK);
    assert_non_null(strstr(data.bytes, "\"t_s\":0.5,\"photo_eye\":\"pe1\",\"state\":\"blocked\"}"));
    data.n = 0;
    assert_int_equal(events_change(run_id, &changes[1], &data, NULL), BF_OK);
    assert_non_null(strstr(data.bytes, "\"t_s\":0.5,\"action\":2,\"target\":\"main\"}"));
    buffer_fini(&data);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(changes_of_photo_eyes_are_lines),
        cmocka_unit_test(stored_events_give_the_same_lines),
        cmocka_unit_test(a_damaged_event_is_reported),
        cmocka_unit_test(events_say_what_changed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
