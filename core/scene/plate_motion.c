#include "core/scene/plate_motion.h"

#include "core/base/memory.h"
#include "core/base/search.h"
#include "core/scene/scene.h"

#include <math.h>
#include <string.h>

static const plate_motion_command no_command = {
    .angle = { .at = INFINITY }, .shift = { .at = INFINITY }, .presence = -1.0, .came = -INFINITY
};

static const plate_motion_lag no_lag = { .angle = { .at = INFINITY },
                                         .extent = { .at = INFINITY },
                                         .shift = { .at = INFINITY } };

static bf_status copy_series(const scene_series *from, scene_series *ret_copy)
{
    const size_t n = from->n_times, size = n * sizeof(double);
    scene_series copy = { n, memory_alloc(n, sizeof(double)), n, memory_alloc(n, sizeof(double)),
                          from->repeat };

    *ret_copy = copy;
    if (copy.times == NULL || copy.values == NULL)
        return BF_ENOMEM;
    if (n > 0) {
        memcpy(copy.times, from->times, size);
        memcpy(copy.values, from->values, size);
    }
    return BF_OK;
}

static bf_status copy_plate(const scene_obstacle *from, plate_motion_plate *ret_plate)
{
    *ret_plate = (plate_motion_plate){ .moves = scene_obstacle_moves(from),
                                       .pivot = from->pivot,
                                       .command = no_command,
                                       .lag = no_lag };
    if (!ret_plate->moves)
        return BF_OK;
    ret_plate->n_shifts = from->n_shifts;
    ret_plate->shifts = memory_alloc(from->n_shifts, sizeof *ret_plate->shifts);
    if (ret_plate->shifts == NULL)
        return BF_ENOMEM;
    if (from->n_shifts > 0)
        memcpy(ret_plate->shifts, from->shifts, from->n_shifts * sizeof *from->shifts);
    bf_status status = copy_series(&from->turn, &ret_plate->turn);
    return status == BF_OK ? copy_series(&from->presence, &ret_plate->presence) : status;
}

bf_status plate_motion_init(plate_motion *ret_motion, size_t n, const scene_obstacle *obstacles,
                            bf_error *err)
{
    plate_motion motion = { .plates = memory_alloc(n, sizeof *motion.plates) };
    bf_status status = motion.plates != NULL ? BF_OK : BF_ENOMEM;

    for (size_t k = 0; k < n && status == BF_OK; k++) {
        status = copy_plate(&obstacles[k], &motion.plates[k]);
        motion.is_any = motion.is_any || motion.plates[k].moves;
        motion.n++;
    }
    if (status != BF_OK) {
        plate_motion_fini(&motion);
        (void)bf_fail(err, status, "/obstacles", "no memory for the motion of obstacles");
    }
    *ret_motion = motion;
    return status;
}

static void free_series(const scene_series *series)
{
    memory_free(series->times);
    memory_free(series->values);
}

void plate_motion_fini(plate_motion *motion)
{
    for (size_t k = 0; k < motion->n; k++) {
        free_series(&motion->plates[k].turn);
        free_series(&motion->plates[k].presence);
        memory_free(motion->plates[k].shifts);
    }
    memory_free(motion->plates);
    *motion = (plate_motion){ .n = 0 };
}

// The time within a round.
static double time_in_round(const scene_series *s, double t)
{
    return s->repeat < INFINITY ? fmod(t, s->repeat) : t;
}

// How many times of a series are at or before t.
static size_t count_times(const scene_series *s, double t)
{
    return search_count(s->times, sizeof *s->times, s->n_times, t, true);
}

// Two times of a series, and the part of the way from the first to the second at which a time lies.
typedef struct span {
    size_t before;
    size_t after;
    double part;
} span;

// n_times > 0.
static span find_span(const scene_series *s, double t)
{
    const double in_round = time_in_round(s, t);
    const size_t n = s->n_times, k = count_times(s, in_round);

    if (k == 0 && t < s->repeat)
        return (span){ 0, 0, 0.0 };
    if (k == n && s->repeat == INFINITY)
        return (span){ n - 1, n - 1, 0.0 };
    const double from = k > 0 ? s->times[k - 1] : s->times[n - 1] - s->repeat;
    const double to = k < n ? s->times[k] : s->times[0] + s->repeat;
    return (span){ k > 0 ? k - 1 : n - 1, k < n ? k : 0, (in_round - from) / (to - from) };
}

static vec2 between(vec2 from, vec2 to, double part)
{
    return vec2_add(from, vec2_scale(vec2_sub(to, from), part));
}

static plate_motion_place scheduled_place(const plate_motion_plate *plate, double t)
{
    plate_motion_place place = { .angle = 0.0 };

    if (plate->turn.n_times == 0)
        return place;
    const span at = find_span(&plate->turn, t);
    const double before = plate->turn.values[at.before], after = plate->turn.values[at.after];
    place.angle = before + (after - before) * at.part;
    if (plate->n_shifts > 0)
        place.shift = between(plate->shifts[at.before], plate->shifts[at.after], at.part);
    return place;
}

// The value at a time t at or after the beginning.
static vec2 ramp_at(const plate_motion_ramp *r, double t)
{
    return t < r->until ? between(r->from, r->to, (t - r->at) / (r->until - r->at)) : r->to;
}

// Replaces what has a ramp.
static void put_ramps(const plate_motion_ramp *angle, const plate_motion_ramp *shift, double t,
                      plate_motion_place *place)
{
    if (angle->at < INFINITY)
        place->angle = ramp_at(angle, t).x;
    if (shift->at < INFINITY)
        place->shift = ramp_at(shift, t);
}

plate_motion_place plate_motion_told(const plate_motion *motion, size_t obstacle, double t)
{
    const plate_motion_plate *plate = &motion->plates[obstacle];
    plate_motion_place place = scheduled_place(plate, t);

    put_ramps(&plate->command.angle, &plate->command.shift, t, &place);
    return place;
}

plate_motion_place plate_motion_at(const plate_motion *motion, size_t obstacle, double t)
{
    const plate_motion_lag *lag = &motion->plates[obstacle].lag;
    plate_motion_place place = plate_motion_told(motion, obstacle, t);

    put_ramps(&lag->angle, &lag->shift, t, &place);
    return place;
}

// Whether it is there by the schedule. *ret_came: since when, or a time long before t; -INFINITY: always.
static bool scheduled_presence(const scene_series *s, double t, double *ret_came)
{
    const double in_round = time_in_round(s, t);
    double round = s->repeat < INFINITY ? rint((t - in_round) / s->repeat) : 0.0;
    size_t k = count_times(s, in_round);

    *ret_came = -INFINITY;
    // Back in time to where it was not there.
    for (size_t n_seen = 0; s->n_times > 0; k--, n_seen++) {
        if (k == 0 && round <= 0.0) {
            *ret_came = -INFINITY;
            return true;
        }
        if (k == 0) {
            k = s->n_times;
            round -= 1.0;
        }
        if (s->values[k - 1] == 0.0)
            return n_seen > 0;
        *ret_came = (round > 0.0 ? round * s->repeat : 0.0) + s->times[k - 1];
        if (n_seen > s->n_times || t - *ret_came > PLATE_MOTION_COMING)
            return true;
    }
    return true;
}

static bool find_presence(const plate_motion_plate *plate, double t, double *ret_came)
{
    const plate_motion_command *c = &plate->command;

    if (c->presence < 0.0)
        return scheduled_presence(&plate->presence, t, ret_came);
    *ret_came = c->came;
    return c->presence > 0.0;
}

bool plate_motion_is_present(const plate_motion *motion, size_t obstacle, double t)
{
    double came;

    return find_presence(&motion->plates[obstacle], t, &came);
}

double plate_motion_told_extent(const plate_motion *motion, size_t obstacle, double t)
{
    double came;

    if (!find_presence(&motion->plates[obstacle], t, &came))
        return 0.0;
    return t - came < PLATE_MOTION_COMING ? (t - came) / PLATE_MOTION_COMING : 1.0;
}

double plate_motion_extent(const plate_motion *motion, size_t obstacle, double t)
{
    const plate_motion_ramp *lag = &motion->plates[obstacle].lag.extent;
    const double told = plate_motion_told_extent(motion, obstacle, t);

    return lag->at < INFINITY ? fmin(ramp_at(lag, t).x, told) : told;
}

plate_motion_pose plate_motion_pose_at(const plate_motion *motion, size_t obstacle,
                                       plate_motion_place place)
{
    return (plate_motion_pose){ motion->plates[obstacle].pivot, place.shift, cos(place.angle),
                                sin(place.angle) };
}

plate_motion_step plate_motion_in_step(const plate_motion *motion, size_t obstacle,
                                       uint64_t n_before, double dt, double depth)
{
    const double from = (double)n_before * dt, to = (double)(n_before + 1) * dt;
    const double extent = plate_motion_extent(motion, obstacle, from);
    const double grown = plate_motion_extent(motion, obstacle, to) - extent;
    const plate_motion_place before = plate_motion_at(motion, obstacle, from);
    const plate_motion_place after = plate_motion_at(motion, obstacle, to);

    return (plate_motion_step){
        .pose = plate_motion_pose_at(motion, obstacle, before),
        .spin = (after.angle - before.angle) / (to - from),
        .velocity = vec2_scale(vec2_sub(after.shift, before.shift), 1.0 / (to - from)),
        .recess =
            plate_motion_is_present(motion, obstacle, from) ? (1.0 - extent) * depth : INFINITY,
        .growth = grown > 0.0 ? grown * depth / dt : 0.0,
    };
}

void plate_motion_command_turn(plate_motion *motion, size_t obstacle, double t, double angle,
                               double over)
{
    const double from = plate_motion_at(motion, obstacle, t).angle;

    motion->plates[obstacle].lag.angle = no_lag.angle;
    motion->plates[obstacle].command.angle =
        (plate_motion_ramp){ t, t + over, { from, 0.0 }, { angle, 0.0 } };
}

void plate_motion_command_shift(plate_motion *motion, size_t obstacle, double t, vec2 shift,
                                double over)
{
    const vec2 from = plate_motion_at(motion, obstacle, t).shift;

    motion->plates[obstacle].lag.shift = no_lag.shift;
    motion->plates[obstacle].command.shift = (plate_motion_ramp){ t, t + over, from, shift };
}

void plate_motion_command_presence(plate_motion *motion, size_t obstacle, double t, bool is_present)
{
    plate_motion_plate *plate = &motion->plates[obstacle];
    double came;

    plate->command.came = find_presence(plate, t, &came) ? came : t;
    plate->command.presence = is_present ? 1.0 : 0.0;
}

// What is saved of an obstacle that moves.
typedef struct saved_plate {
    plate_motion_command command;
    plate_motion_lag lag;
} saved_plate;

void plate_motion_save(const plate_motion *motion, checkpoint_writer *w)
{
    for (size_t k = 0; k < motion->n; k++) {
        const saved_plate saved = { motion->plates[k].command, motion->plates[k].lag };
        if (motion->plates[k].moves)
            checkpoint_write(w, &saved, sizeof saved);
    }
}

static bool is_ramp_sound(const plate_motion_ramp *r)
{
    return r->at == INFINITY ||
           (r->at >= 0.0 && r->until >= r->at && isfinite(r->until) && isfinite(r->from.x) &&
            isfinite(r->from.y) && isfinite(r->to.x) && isfinite(r->to.y));
}

static bool is_sound(const saved_plate *s)
{
    const plate_motion_command *c = &s->command;

    return is_ramp_sound(&c->angle) && is_ramp_sound(&c->shift) && is_ramp_sound(&s->lag.angle) &&
           is_ramp_sound(&s->lag.extent) && is_ramp_sound(&s->lag.shift) &&
           (c->presence == -1.0 || c->presence == 0.0 || c->presence == 1.0) && c->came < INFINITY;
}

bool plate_motion_load(plate_motion *motion, checkpoint_reader *r)
{
    saved_plate saved;

    for (size_t k = 0; k < motion->n; k++) {
        if (!motion->plates[k].moves)
            continue;
        if (!checkpoint_read(r, &saved, sizeof saved) || !is_sound(&saved))
            return false;
        motion->plates[k].command = saved.command;
        motion->plates[k].lag = saved.lag;
    }
    return true;
}
