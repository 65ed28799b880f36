#include "core/world/plate_motion.h"

#include "core/base/memory.h"
#include "core/scene/scene.h"

#include <math.h>

static const plate_motion_command no_command = {
    .angle = { .at = INFINITY }, .shift = { .at = INFINITY }, .presence = -1.0, .came = -INFINITY
};

static const plate_motion_lag no_lag = { .angle = { .at = INFINITY },
                                         .extent = { .at = INFINITY },
                                         .shift = { .at = INFINITY } };

bf_status plate_motion_init(plate_motion *ret_motion, size_t n, const scene_obstacle *obstacles,
                            bf_error *err)
{
    plate_motion motion = { .n = n,
                            .obstacles = obstacles,
                            .plates = memory_alloc(n, sizeof *motion.plates) };

    *ret_motion = (plate_motion){ .n = 0 };
    if (motion.plates == NULL)
        return bf_fail(err, BF_ENOMEM, "/obstacles", "no memory for the motion of obstacles");
    for (size_t k = 0; k < n; k++) {
        motion.plates[k] =
            (plate_motion_plate){ scene_obstacle_moves(&obstacles[k]), no_command, no_lag };
        motion.is_any = motion.is_any || motion.plates[k].moves;
    }
    *ret_motion = motion;
    return BF_OK;
}

void plate_motion_fini(plate_motion *motion)
{
    memory_free(motion->plates);
    *motion = (plate_motion){ .n = 0 };
}

// The value at a time t at or after the beginning.
static vec2 ramp_at(const plate_motion_ramp *r, double t)
{
    return t < r->until ? vec2_between(r->from, r->to, (t - r->at) / (r->until - r->at)) : r->to;
}

// Replaces what has a ramp.
static void put_ramps(const plate_motion_ramp *angle, const plate_motion_ramp *shift, double t,
                      plate_displacement *displacement)
{
    if (angle->at < INFINITY)
        displacement->angle = ramp_at(angle, t).x;
    if (shift->at < INFINITY)
        displacement->shift = ramp_at(shift, t);
}

plate_displacement plate_motion_told(const plate_motion *motion, size_t obstacle, double t)
{
    const plate_motion_command *command = &motion->plates[obstacle].command;
    plate_displacement displacement = plate_schedule_displacement(&motion->obstacles[obstacle], t);

    put_ramps(&command->angle, &command->shift, t, &displacement);
    return displacement;
}

plate_displacement plate_motion_at(const plate_motion *motion, size_t obstacle, double t)
{
    const plate_motion_lag *lag = &motion->plates[obstacle].lag;
    plate_displacement displacement = plate_motion_told(motion, obstacle, t);

    put_ramps(&lag->angle, &lag->shift, t, &displacement);
    return displacement;
}

static bool find_presence(const plate_motion *motion, size_t obstacle, double t, double *ret_came)
{
    const plate_motion_command *c = &motion->plates[obstacle].command;

    if (c->presence < 0.0)
        return plate_schedule_is_present(&motion->obstacles[obstacle], t, ret_came);
    *ret_came = c->came;
    return c->presence > 0.0;
}

bool plate_motion_is_present(const plate_motion *motion, size_t obstacle, double t)
{
    double came;

    return find_presence(motion, obstacle, t, &came);
}

double plate_motion_told_extent(const plate_motion *motion, size_t obstacle, double t)
{
    double came;

    if (!find_presence(motion, obstacle, t, &came))
        return 0.0;
    return t - came < PLATE_SCHEDULE_COMING ? (t - came) / PLATE_SCHEDULE_COMING : 1.0;
}

double plate_motion_extent(const plate_motion *motion, size_t obstacle, double t)
{
    const plate_motion_ramp *lag = &motion->plates[obstacle].lag.extent;
    const double told = plate_motion_told_extent(motion, obstacle, t);

    return lag->at < INFINITY ? fmin(ramp_at(lag, t).x, told) : told;
}

plate_motion_step plate_motion_in_step(const plate_motion *motion, size_t obstacle,
                                       uint64_t n_before, double dt, double depth)
{
    const double from = (double)n_before * dt, to = (double)(n_before + 1) * dt;
    const double extent = plate_motion_extent(motion, obstacle, from);
    const double grown = plate_motion_extent(motion, obstacle, to) - extent;
    const plate_displacement before = plate_motion_at(motion, obstacle, from);
    const plate_displacement after = plate_motion_at(motion, obstacle, to);

    return (plate_motion_step){
        .pose = plate_pose_of(&motion->obstacles[obstacle], before),
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

    plate->command.came = find_presence(motion, obstacle, t, &came) ? came : t;
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
