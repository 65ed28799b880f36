#include "api/results/events.h"

#include "api/json/json_out.h"
#include "api/results/results.h"
#include "api/results/results_priv.h"
#include "api/results/run_json.h"
#include "core/world/belt_stops.h"
#include "core/world/plate_drive.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define RUN "Identifier of the run"

static bf_status write_event(const member_table *table, const void *item, bf_buffer *out,
                             bf_error *err)
{
    size_t start = out->n;
    json_out w = json_out_to(out);

    members_write(&w, table, item);
    bf_status status = json_out_status(&w, err);
    if (status != BF_OK)
        buffer_truncate(w.buffer, start);
    return status;
}

static const member status_members[] = {
    MEMBER("run", text, offsetof(api_run, id), RUN, .type = "#Id"),
    MEMBER_INLINE(&run_json, 0),
};
const member_table events_status_data = { MEMBER_TABLE("StatusEvent", status_members) };

bf_status events_status(const api_run *record, bf_buffer *out, bf_error *err)
{
    return write_event(&events_status_data, record, out, err);
}

typedef struct progress_event {
    const char *run;
    double t;
    double progress;
    double steps_per_s;
    double eta;
} progress_event;

#define AT(place) offsetof(progress_event, place)
static const member progress_members[] = {
    MEMBER("run", string, AT(run), RUN, .type = "#Id"),
    MEMBER("t_s", number, AT(t), "Simulated time", .unit = "s"),
    MEMBER("progress", measure, AT(progress), "Completed fraction of the time steps",
           .type = "#Share"),
    MEMBER("steps_per_s", measure, AT(steps_per_s), "Time steps per second of wall time",
           .unit = "1/s", .null = "not known"),
    MEMBER("eta_s", measure, AT(eta), "Remaining wall time", .unit = "s", .null = "not known"),
};
const member_table events_progress_data = { MEMBER_TABLE("ProgressEvent", progress_members) };
#undef AT

bf_status events_progress(const char *run_id, const frame_progress *p, double steps_per_s,
                          bf_buffer *out, bf_error *err)
{
    double fraction = p->n_steps == 0 ? 1.0 : (double)p->step / (double)p->n_steps;
    double left = p->step < p->n_steps ? (double)(p->n_steps - p->step) : 0.0;
    bool is_known = steps_per_s > 0.0;
    const progress_event event = { .run = run_id,
                                   .t = p->t,
                                   .progress = fmin(fraction, 1.0),
                                   .steps_per_s = is_known ? steps_per_s : (double)NAN,
                                   .eta = is_known ? left / steps_per_s : (double)NAN };

    return write_event(&events_progress_data, &event, out, err);
}

typedef struct curve_event {
    const char *run;
    uint64_t first;
    results__samples samples;
} curve_event;

#define AT(place) offsetof(curve_event, place)
static const member curve_members[] = {
    MEMBER("run", string, AT(run), RUN, .type = "#Id"),
    MEMBER("first", size, AT(first), "Index of the first of these samples in the whole curve"),
    MEMBER_INLINE(&results_curve_members, AT(samples)),
};
const member_table events_curve_data = { MEMBER_TABLE("CurveEvent", curve_members) };
#undef AT

bf_status events_curve(const char *run_id, const frame_curve *c, const char *columns,
                       bf_buffer *out, bf_error *err)
{
    const curve_event event = { .run = run_id,
                                .first = c->first,
                                .samples = { .columns = columns,
                                             .t = c->t,
                                             .values = c->values,
                                             .n = c->n,
                                             .n_columns = c->n_columns } };

    return write_event(&events_curve_data, &event, out, err);
}

typedef struct snapshot_event {
    char run[API_ID_SIZE];
    bool has_parts;
    uint64_t index;
    double t;
    double peak;
    double mass;
    bf_grid grid;
} snapshot_event;

#define AT(place) offsetof(snapshot_event, place)
static const member snapshot_members[] = {
    MEMBER("run", text, AT(run), RUN, .type = "#Id"),
    MEMBER("n", size, AT(index), "Number of the snapshot, from 0"),
    MEMBER("t_s", number, AT(t), "Its time", .unit = "s"),
    MEMBER("peak", number, AT(peak), "Largest density; 1 is close packing"),
    MEMBER("mass", number, AT(mass), "Parts in the domain"),
    MEMBER("shape", shape, AT(grid), "Rows along y and columns along x"),
    MEMBER("url", link, AT(run), "Its density", .path = "/v1/runs/{id}/snapshots/{n}",
           .offset_n = AT(index)),
    MEMBER("parts_url", link, AT(run), "Its parts (microscopic model)",
           .path = "/v1/runs/{id}/parts/{n}", .offset_n = AT(index), .offset_if = AT(has_parts)),
    MEMBER("data", described, 0,
           "With `inline=1`: the grid as float32, little-endian, rows along y, in base64",
           .type = "#Base64", .null = "it is too large, or removed", .flags = MEMBER_OPTIONAL),
};
const member_table events_snapshot_data = { MEMBER_TABLE("SnapshotEvent", snapshot_members) };
#undef AT

bf_status events_snapshot(const char *run_id, const frame_snapshot *s, bool with_parts,
                          bf_buffer *out, bf_error *err)
{
    snapshot_event event = { .has_parts = with_parts,
                             .index = s->index,
                             .t = s->t,
                             .peak = s->peak,
                             .mass = s->mass,
                             .grid = { .n1 = s->n1, .n2 = s->n2 } };

    snprintf(event.run, sizeof event.run, "%s", run_id);
    return write_event(&events_snapshot_data, &event, out, err);
}

typedef struct change_event {
    const char *run;
    double t;
    const char *id;
    uint64_t item;
    uint32_t state;
    double turn_deg;
    vec2 shift;
} change_event;

static bool is_shifted(const void *item)
{
    const change_event *change = item;

    return change->shift.x != 0.0 || change->shift.y != 0.0;
}

static const char *const eye_states[] = { "clear", "blocked", NULL };
const char *const results__belt_states[] = { "running", "failed", "break", "held", NULL };
const char *const results__drive_states[] = { "as_told", "behind", "stalled", NULL };

#define AT(place) offsetof(change_event, place)
static const member eye_members[] = {
    MEMBER("run", string, AT(run), RUN, .type = "#Id"),
    MEMBER("t_s", number, AT(t), "When its state changed", .unit = "s"),
    MEMBER("photo_eye", string, AT(id), "Its id", .type = "#ScenarioId"),
    MEMBER("state", enum, AT(state), "Its state from then on", .words = eye_states),
};
const member_table events_eye_data = { MEMBER_TABLE("PhotoEyeEvent", eye_members) };

static const member action_members[] = {
    MEMBER("run", string, AT(run), RUN, .type = "#Id"),
    MEMBER("t_s", number, AT(t), "When it was carried out", .unit = "s"),
    MEMBER("action", size, AT(item), "Its index in the scenario's `actions`"),
    MEMBER("target", string, AT(id), "Id of the belt, obstacle or feed", .type = "#ScenarioId"),
};
const member_table events_action_data = { MEMBER_TABLE("ActionEvent", action_members) };

static const member drive_members[] = {
    MEMBER("run", string, AT(run), RUN, .type = "#Id"),
    MEMBER("t_s", number, AT(t), "When it was so", .unit = "s"),
    MEMBER("obstacle", string, AT(id), "Its id", .type = "#ScenarioId"),
    RESULTS__DRIVE_MEMBERS(is_shifted),
};
const member_table events_drive_data = { MEMBER_TABLE("DriveEvent", drive_members) };

static const member belt_members[] = {
    MEMBER("run", string, AT(run), RUN, .type = "#Id"),
    MEMBER("t_s", number, AT(t), "When it was so", .unit = "s"),
    MEMBER("belt", string, AT(id), "Its id", .type = "#ScenarioId"),
    RESULTS__BELT_MEMBERS,
};
const member_table events_belt_data = { MEMBER_TABLE("BeltEvent", belt_members) };
#undef AT

bf_status events_change(const char *run_id, const frame_change *c, bf_buffer *out, bf_error *err)
{
    static const struct {
        const member_table *table;
        uint32_t n_states;
    } kinds[FRAME_CHANGE_TYPE_COUNT] = {
        [FRAME_CHANGE_EYE] = { &events_eye_data, 2 },
        [FRAME_CHANGE_ACTION] = { &events_action_data, 1 },
        [FRAME_CHANGE_DRIVE] = { &events_drive_data, PLATE_DRIVE_STATE_COUNT },
        [FRAME_CHANGE_BELT] = { &events_belt_data, BELT_STOPS_CAUSE_COUNT },
    };
    const change_event event = { .run = run_id,
                                 .t = c->t,
                                 .id = c->id,
                                 .item = c->item,
                                 .state = c->state,
                                 .turn_deg = c->turn * 180.0 / M_PI,
                                 .shift = c->shift };

    if (c->type >= FRAME_CHANGE_TYPE_COUNT || c->state >= kinds[c->type].n_states)
        return bf_fail(err, BF_ECORRUPT, "", "a change of no known kind or state");
    return write_event(kinds[c->type].table, &event, out, err);
}

#define AT(place) offsetof(api_run, place)
static const member end_members[] = {
    MEMBER("run", text, AT(id), RUN, .type = "#Id"),
    MEMBER("status", enum, AT(state), "How the run ended", .words = run_state_words,
           .type = "#RunStatus"),
    MEMBER("progress", measure, AT(progress), "Completed fraction of the simulated time",
           .type = "#Share"),
    MEMBER("finished_at", time, AT(finished_ms), "When it ended", .null = "not known"),
    MEMBER("n_samples", size, AT(n_samples), "Samples of its curve"),
    MEMBER("n_snapshots", size, AT(n_snapshots), "Its snapshots"),
    MEMBER_OF("error", &run_json_error_kind, AT(error), "Why it failed", .null = "it did not"),
};
const member_table events_end_data = { MEMBER_TABLE("EndEvent", end_members) };
#undef AT

bf_status events_end(const api_run *record, bf_buffer *out, bf_error *err)
{
    return write_event(&events_end_data, record, out, err);
}

typedef struct figures_event {
    const char *run;
    const key_figures *figures;
    double t;
} figures_event;

static void write_figures(json_out *w, const member *m, const void *item)
{
    const figures_event *event = item;

    (void)m;
    key_figures_write(w, event->figures);
}

static const member_kind member_figures = { .type = "#KeyFigures", .write = write_figures };

#define AT(place) offsetof(figures_event, place)
static const member figures_members[] = {
    MEMBER("run", string, AT(run), RUN, .type = "#Id"),
    MEMBER("t_s", number, AT(t), "Time of the last sample", .unit = "s"),
    MEMBER("key_figures", figures, 0, "The key figures until then"),
};
const member_table events_figures_data = { MEMBER_TABLE("FiguresEvent", figures_members) };
#undef AT

bf_status events_figures(const char *run_id, const key_figures *figures, bf_buffer *out,
                         bf_error *err)
{
    const figures_event event = { .run = run_id, .figures = figures, .t = figures->t };

    BF_TRY(key_figures_check(figures, err));
    return write_event(&events_figures_data, &event, out, err);
}

bf_status events_of_run(const char *run_id, const char *data, size_t n, bf_buffer *out,
                        bf_error *err)
{
    static const char first[] = "{\"run\":\"";
    const size_t n_first = sizeof first - 1, n_id = API_ID_SIZE - 1;
    const size_t start = out->n;

    if (n < n_first + n_id || memcmp(data, first, n_first) != 0)
        return bf_fail(err, BF_ECORRUPT, "", "the data of an event are damaged");
    if (buffer_append(out, first, n_first) == BF_OK && buffer_append(out, run_id, n_id) == BF_OK &&
        buffer_append(out, data + n_first + n_id, n - n_first - n_id) == BF_OK)
        return BF_OK;
    buffer_truncate(out, start);
    return bf_fail_memory(err);
}
