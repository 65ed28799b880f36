// photo_eyes.csv: the changes of photo eyes, from frames and from stored events.

#include "api/results/results.h"

#include "api/json/number.h"
#include "api/results/results_priv.h"

#include <jansson.h>
#include <stdbool.h>
#include <stdio.h>

static bf_status append_row(double t, const char *id, const char *state, bf_buffer *out)
{
    char time[NUMBER_SIZE];
    bf_status status = BF_OK;

    number_format(t, time);
    if (out->n == 0)
        status = buffer_printf(out, "t_s,photo_eye,state\n");
    return status == BF_OK ? buffer_printf(out, "%s,%s,%s\n", time, id, state) : status;
}

bf_status results_photo_eyes_csv(const frame_change *c, bf_buffer *out, bf_error *err)
{
    const size_t n_before = out->n;
    bf_status status = BF_OK;

    if (c->type == FRAME_CHANGE_EYE)
        status = append_row(c->t, c->id, c->is_blocked != 0 ? "blocked" : "clear", out);
    return results__finish(status, out, n_before, err);
}

// What read_events() fills.
typedef struct event_reading {
    bf_buffer *out;
    uint64_t after; // id of the last event
    size_t n;       // events in this turn
} event_reading;

static bf_status take_event(void *context, const api_event *event, bf_error *err)
{
    event_reading *reading = context;
    const char *id, *state;
    double t;

    reading->after = event->id;
    reading->n++;
    if (event->type != API_EVENT_EYE)
        return BF_OK;
    json_t *json = json_loadb(event->data, event->n, 0, NULL);
    const bool is_sound =
        json_unpack(json, "{s:F, s:s, s:s}", "t_s", &t, "photo_eye", &id, "state", &state) == 0;
    bf_status status = is_sound ? append_row(t, id, state, reading->out) : BF_ECORRUPT;
    json_decref(json);
    return status == BF_OK ? BF_OK
                           : bf_fail(err, status, "", "an event of a photo eye cannot be read");
}

bf_status results_photo_eyes_read(const api_services *services, const char *id, bf_buffer *out,
                                  bf_error *err)
{
    enum { TURN_BYTES = 1024 * 1024 };
    const size_t n_before = out->n;
    event_reading reading = { .out = out, .n = 1 };
    char runs[1][API_ID_SIZE];
    bf_status status = BF_OK;

    snprintf(runs[0], sizeof runs[0], "%s", id);
    while (status == BF_OK && reading.n > 0) {
        reading.n = 0;
        status = services->read_events(services->context, (const char(*)[API_ID_SIZE])runs, 1,
                                       reading.after, TURN_BYTES, take_event, &reading, err);
    }
    if (status != BF_OK)
        buffer_truncate(out, n_before);
    return status;
}
