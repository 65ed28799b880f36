#include "core/run/control.h"

#include "core/scene/belt_range.h"

#include <math.h>
#include <stdio.h>

// Less than this is no part any more where parts are divisible.
static const double least_part = 0.5;

static const double told_turn =
    2.0 * M_PI / 180.0;                // rad, between two changes of a drive that is behind
static const double told_shift = 0.01; // m, same

control control_of(const scene *s, bf_world *w, const run_backend *backend, const run_plan *plan)
{
    bool has_stops = s->n_merges > 0;

    for (size_t k = 0; k < s->n_belts; k++)
        has_stops = has_stops || belt_range_may_stop(&s->belts[k]);
    const bool needs_ticks = has_stops || s->n_feeds > 0 || s->n_eyes > 0 || s->n_sinks > 0 ||
                             s->until != SCENE_UNTIL_DURATION || scene_has_moving_obstacles(s);

    return (control){ .scene = s,
                      .world = w,
                      .backend = backend,
                      .n_tick = needs_ticks ? plan->n_tick : 0,
                      .dt = plan->dt,
                      .has_stops = has_stops,
                      .eyes = photo_eyes_of(s, plan->dt),
                      .commands = commands_of(s, plan->dt),
                      .merges = merges_of(s, plan->dt) };
}

void control_fini(control *c)
{
    commands_fini(&c->commands);
    photo_eyes_fini(&c->eyes);
    for (size_t k = 0; k < SCENE_EYES_MAX; k++)
        passages_fini(&c->passages[k]);
}

uint64_t control_next(const control *c, uint64_t step)
{
    return c->n_tick == 0 ? UINT64_MAX : (step / c->n_tick + 1) * c->n_tick;
}

// The id of what an action acts on.
static const char *target_of(const scene *s, const scene_action *a)
{
    switch (a->type) {
    case SCENE_ACTION_BELT:
        return s->belts[a->target].id;
    case SCENE_ACTION_FEED:
        return s->feeds[a->target].id;
    default:
        return s->obstacles[a->target].id;
    }
}

// The index is set here.
static bf_status emit_change(control *c, uint64_t step, const frame_change *change, const char *id,
                             const run_sink *sink, bf_error *err)
{
    frame f = { .type = FRAME_CHANGE, .change = *change };

    if (c->n_changes == FRAME_CHANGES_MAX)
        return BF_OK;
    f.change.index = c->n_changes++;
    f.change.t = (double)step * c->dt;
    snprintf(f.change.id, sizeof f.change.id, "%s", id);
    return sink->on_frame(sink->context, &f, err);
}

static bf_status watch_eye(control *c, void *solver, size_t eye, uint64_t step, figures *to,
                           const run_sink *sink, merges_eye *ret_seen, bf_error *err)
{
    run_view view = { .is_broken = false };
    double was_free = 0.0; // since the last tick, s
    bf_status status = c->backend->look(solver, eye, &view, err);

    if (status == BF_OK && c->backend->parts != NULL)
        status = passages_see(&c->passages[eye], (double)step * c->dt, &view.passages, eye, to,
                              &was_free, err);
    if (status == BF_OK && c->eyes.tells_kinds[eye])
        status = photo_eyes_see_parts(&c->eyes, eye, step, view.n_parts, view.parts, err);
    for (size_t k = 0; k < c->eyes.parts[eye].n && status == BF_OK; k++) {
        const photo_eye_known *of = &c->eyes.parts[eye].items[k];
        if (of->is_new_state != 0)
            status = commands_note(&c->commands, eye, (uint32_t)of->part.kind,
                                   of->state.is_blocked != 0, step, err);
    }
    if (status != BF_OK)
        return status;
    // Speeds between two ticks are not known well enough to tell shorter gaps than a step.
    const bool is_broken = view.is_broken && was_free < c->dt;
    const bool has_changed = photo_eyes_see(&c->eyes, eye, step, is_broken);
    *ret_seen = (merges_eye){ is_broken, c->eyes.states[eye].is_blocked != 0,
                              c->backend->parts != NULL ? c->passages[eye].n_left : view.n_left };
    if (!has_changed)
        return BF_OK;
    figures_eye_state(to, eye, (double)step * c->dt, is_broken);
    const frame_change change = { .type = FRAME_CHANGE_EYE,
                                  .item = (uint32_t)eye,
                                  .state = is_broken };
    status = emit_change(c, step, &change, c->scene->eyes[eye].id, sink, err);
    return status == BF_OK ? commands_note(&c->commands, eye, SCENE_KIND_ANY, is_broken, step, err)
                           : status;
}

/// Let the merges stop and release their lanes.
static void command_lanes(control *c, const merges_eye *eyes, uint64_t step)
{
    for (size_t k = 0; k < c->scene->n_merges; k++) {
        const uint64_t changed = merges_go_on(&c->merges, k, eyes, step);
        for (size_t i = 0; i < c->scene->merges[k].n_lanes; i++) {
            const bool is_held = (c->merges.states[k].held >> i & 1) != 0;
            const scene_action told = { .type = SCENE_ACTION_BELT,
                                        .target = c->scene->merges[k].lanes[i].belt,
                                        .value = is_held ? 0.0 : 1.0 };
            if ((changed >> i & 1) != 0)
                world_command(c->world, &told, (double)step * c->dt);
        }
    }
}

static bf_status command_due(control *c, void *solver, uint64_t step, const run_sink *sink,
                             bf_error *err)
{
    bf_status status = BF_OK;
    size_t action;

    while (status == BF_OK && commands_take(&c->commands, step, &action)) {
        const scene_action *of = &c->scene->actions[action];
        const frame_change change = { .type = FRAME_CHANGE_ACTION, .item = (uint32_t)action };
        if (of->type == SCENE_ACTION_FEED)
            c->backend->hold(solver, of->target, of->value != 0.0);
        else
            world_command(c->world, of, (double)step * c->dt);
        status = emit_change(c, step, &change, target_of(c->scene, of), sink, err);
    }
    return status;
}

static bf_status watch_drives(control *c, uint64_t step, figures *to, const run_sink *sink,
                              bf_error *err)
{
    const plate_motion *motion = &c->world->plates;
    const double t = (double)step * c->dt;
    bf_status status = BF_OK;

    for (size_t k = 0; k < motion->n && status == BF_OK; k++) {
        if (!motion->plates[k].moves)
            continue;
        control_drive *told = &c->drives[k];
        const plate_displacement displacement = plate_motion_at(motion, k, t);
        const frame_change change = { .type = FRAME_CHANGE_DRIVE,
                                      .item = (uint32_t)k,
                                      .state = plate_drive_state_of(motion, k, t),
                                      .turn = displacement.angle,
                                      .shift = displacement.shift };
        const bool is_near = fabs(displacement.angle - told->turn) < told_turn &&
                             vec2_length(vec2_sub(displacement.shift, told->shift)) < told_shift;
        if (change.state == told->state && (change.state == PLATE_DRIVE_AS_TOLD || is_near))
            continue;
        if ((change.state == PLATE_DRIVE_STALLED) != (told->state == PLATE_DRIVE_STALLED))
            figures_stall(to, t, change.state == PLATE_DRIVE_STALLED);
        *told = (control_drive){ change.turn, change.shift, change.state };
        status = emit_change(c, step, &change, c->scene->obstacles[k].id, sink, err);
    }
    return status;
}

static bf_status watch_belts(control *c, uint64_t step, const run_sink *sink, bf_error *err)
{
    bf_status status = BF_OK;
    double until;
    bool held[SCENE_BELTS_MAX];

    merges_find_held(&c->merges, held);
    for (size_t k = 0; c->has_stops && k < c->scene->n_belts && status == BF_OK; k++) {
        const unsigned now =
            belt_speeds_stopped_by(&c->world->belts, k, (double)step * c->dt, &until);
        const belt_stops_cause cause = belt_stops_cause_of(now);
        const bool is_held = cause == BELT_STOPS_BY_NOTHING && held[k];
        const frame_change change = { .type = FRAME_CHANGE_BELT,
                                      .item = (uint32_t)k,
                                      .state = is_held ? BELT_STOPS_BY_MERGE : cause };
        if (change.state == c->stops[k])
            continue;
        c->stops[k] = change.state;
        status = emit_change(c, step, &change, c->scene->belts[k].id, sink, err);
    }
    return status;
}

bf_status control_tick(control *c, void *solver, uint64_t step, figures *to, const run_sink *sink,
                       bf_error *err)
{
    run_departures departures = { .n = 0 };
    merges_eye seen[SCENE_EYES_MAX];
    bf_status status = c->scene->n_sinks > 0 ? c->backend->remove_at_sinks(solver, err) : BF_OK;

    if (status == BF_OK && c->backend->depart != NULL && c->scene->n_feeds > 0)
        status = c->backend->depart(solver, &departures, err);
    for (size_t k = 0; k < departures.n; k++)
        if (!departures.items[k].has_fallen)
            figures_exit(to, departures.items[k].left - departures.items[k].entered, 1.0);
    if (c->backend->tell_exits != NULL && c->scene->n_feeds > 0)
        c->backend->tell_exits(solver, to);
    for (size_t k = 0; k < c->eyes.n && status == BF_OK; k++)
        status = watch_eye(c, solver, k, step, to, sink, &seen[k], err);
    if (status == BF_OK)
        command_lanes(c, seen, step);
    if (status == BF_OK)
        status = command_due(c, solver, step, sink, err);
    if (status == BF_OK && c->scene->n_feeds > 0)
        status = c->backend->admit(solver, to, err);
    if (status == BF_OK)
        status = watch_drives(c, step, to, sink, err);
    return status == BF_OK ? watch_belts(c, step, sink, err) : status;
}

bool control_is_drained(const control *c, const void *solver)
{
    return c->scene->until == SCENE_UNTIL_DRAINED &&
           (c->scene->n_feeds == 0 || c->backend->is_exhausted(solver)) &&
           c->backend->measure(solver).parts < least_part;
}

void control_save(const control *c, checkpoint_writer *w)
{
    if (c->n_tick == 0)
        return;
    checkpoint_write(w, &c->n_changes, sizeof c->n_changes);
    checkpoint_write(w, c->drives, c->scene->n_obstacles * sizeof *c->drives);
    if (c->has_stops)
        checkpoint_write(w, c->stops, c->scene->n_belts * sizeof *c->stops);
    photo_eyes_save(&c->eyes, w);
    commands_save(&c->commands, w);
    merges_save(&c->merges, w);
    for (size_t k = 0; k < c->eyes.n; k++)
        passages_save(&c->passages[k], w);
}

bf_status control_load(control *c, checkpoint_reader *r, bf_error *err)
{
    if (c->n_tick == 0)
        return BF_OK;
    if (!checkpoint_read(r, &c->n_changes, sizeof c->n_changes) ||
        !checkpoint_read(r, c->drives, c->scene->n_obstacles * sizeof *c->drives) ||
        (c->has_stops && !checkpoint_read(r, c->stops, c->scene->n_belts * sizeof *c->stops)))
        return bf_fail(err, BF_ECORRUPT, "", "the checkpoint is damaged");
    bf_status status = photo_eyes_load(&c->eyes, r, err);
    if (status == BF_OK)
        status = commands_load(&c->commands, r, err);
    if (status == BF_OK && !merges_load(&c->merges, r))
        status = bf_fail(err, BF_ECORRUPT, "", "the checkpoint is damaged");
    for (size_t k = 0; k < c->eyes.n && status == BF_OK; k++)
        status = passages_load(&c->passages[k], r, err);
    return status;
}
