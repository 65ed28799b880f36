#include "core/world/plate_drive.h"

#include "core/scene/belt.h"
#include "core/scene/belt_slope.h"
#include "core/scene/mix.h"
#include "core/scene/plate_range.h"
#include "core/scene/scene.h"

#include <math.h>

static const double eased = 0.5; // of its limit, up to which a drive is as fast as told

plate_drive plate_drive_of(const scene *s, size_t k)
{
    const scene_obstacle *o = &s->obstacles[k];
    const double radius = plate_range_radius(o);
    const plate_range_speed speed = plate_range_fastest(s->obstacles, k, s->n_actions, s->actions);
    const double length =
        fmax(s->domain.x_max - s->domain.x_min, s->domain.y_max - s->domain.y_min);
    const double friction =
        belt_slope_largest_drive(s->n_belts, s->belts, &s->micro.contact[SCENE_CONVEYOR_CARGO]);
    const double force = o->force_limit > 0.0
                             ? o->force_limit
                             : friction * s->micro.gravity * mix_mass_per_area(s) * radius * length;

    return (plate_drive){ .force = force,
                          .torque = force * radius,
                          .rate = speed.turning / radius,
                          .speed = speed.shifting };
}

static bool is_behind(const plate_motion_lag *lag)
{
    return lag->angle.at < INFINITY || lag->extent.at < INFINITY || lag->shift.at < INFINITY;
}

bool plate_drive_is_needed(const plate_motion *motion, size_t obstacle, double t, double until)
{
    return motion->plates[obstacle].moves &&
           (is_behind(&motion->plates[obstacle].lag) ||
            !plate_displacement_is_same(plate_motion_told(motion, obstacle, t),
                                        plate_motion_told(motion, obstacle, until)) ||
            plate_motion_told_extent(motion, obstacle, t) <
                plate_motion_told_extent(motion, obstacle, until));
}

// What part of the told speed a drive has under a load, of its limit.
static double speed_under(double load)
{
    return fmin(fmax((1.0 - load) / (1.0 - eased), 0.0), 1.0);
}

// The next ramp of a motion that is at `now`, told to be at `told` now and at `next` at its end: at most `rate` times the speed
// that the load, against its way, leaves it. None if it is as told before and after.
static void follow(plate_motion_ramp *lag, double t, double until, vec2 now, vec2 told, vec2 next,
                   double rate, double load)
{
    const vec2 way = vec2_sub(next, now);
    const double length = vec2_length(way);
    // Nothing holds back what is not told to move.
    const double part = length == 0.0 ? 1.0 : speed_under(load);
    double fastest = rate * (until - t);

    if (now.x == told.x && now.y == told.y) {
        lag->at = INFINITY;
        fastest = length;
    }
    if (lag->at == INFINITY && part == 1.0)
        return;
    const double able = part * fmin(length, fastest);
    *lag =
        (plate_motion_ramp){ t, until, now,
                             able < length ? vec2_add(now, vec2_scale(way, able / length)) : next };
}

void plate_drive_follow(plate_motion *motion, size_t obstacle, const plate_drive *drive,
                        const plate_load *load, double t, double until)
{
    plate_motion_lag *lag = &motion->plates[obstacle].lag;
    const plate_displacement now = plate_motion_at(motion, obstacle, t);
    const plate_displacement told = plate_motion_told(motion, obstacle, t);
    const plate_displacement next = plate_motion_told(motion, obstacle, until);
    const vec2 extent = { plate_motion_extent(motion, obstacle, t), 0.0 };
    const vec2 told_extent = { plate_motion_told_extent(motion, obstacle, t), 0.0 };
    const vec2 next_extent = { plate_motion_told_extent(motion, obstacle, until), 0.0 };
    const vec2 way = vec2_sub(next.shift, now.shift);
    const double against = next.angle > now.angle ? -load->torque : load->torque;

    follow(&lag->angle, t, until, (vec2){ now.angle, 0.0 }, (vec2){ told.angle, 0.0 },
           (vec2){ next.angle, 0.0 }, drive->rate, against / drive->torque);
    follow(&lag->extent, t, until, extent, told_extent, next_extent, 1.0 / PLATE_SCHEDULE_COMING,
           next_extent.x <= extent.x ? 0.0 : load->force / drive->force);
    follow(&lag->shift, t, until, now.shift, told.shift, next.shift, drive->speed,
           -vec2_dot(load->resultant, way) / vec2_length(way) / drive->force);
}

static bool stands(const plate_motion_ramp *ramp)
{
    return ramp->at < INFINITY && ramp->from.x == ramp->to.x && ramp->from.y == ramp->to.y;
}

plate_drive_state plate_drive_state_of(const plate_motion *motion, size_t obstacle, double t)
{
    const plate_motion_lag *lag = &motion->plates[obstacle].lag;
    const plate_displacement told = plate_motion_told(motion, obstacle, t);
    const vec2 left = vec2_sub(lag->shift.to, told.shift);

    if ((stands(&lag->angle) && lag->angle.to.x != told.angle) ||
        (stands(&lag->shift) && (left.x != 0.0 || left.y != 0.0)) ||
        (stands(&lag->extent) && lag->extent.to.x < plate_motion_told_extent(motion, obstacle, t)))
        return PLATE_DRIVE_STALLED;
    return is_behind(lag) ? PLATE_DRIVE_BEHIND : PLATE_DRIVE_AS_TOLD;
}
