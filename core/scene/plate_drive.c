#include "core/scene/plate_drive.h"

#include "core/scene/belt.h"
#include "core/scene/plate_range.h"
#include "core/scene/scene.h"

#include <math.h>

static const double eased = 0.5; // of its limit, up to which a drive is as fast as told

double plate_drive_mass_per_area(const scene *s)
{
    double mass = 0.0, of = 0.0;

    for (size_t k = 0; k < s->n_cargo; k++) {
        mass += s->cargo[k].share * s->cargo[k].mass;
        of += s->cargo[k].share;
    }
    return mass / of * scene_packing_density(s);
}

plate_drive plate_drive_of(const scene *s, size_t k)
{
    const scene_obstacle *o = &s->obstacles[k];
    const double radius = plate_range_radius(o);
    const plate_range_speed speed = plate_range_fastest(s->obstacles, k, s->n_actions, s->actions);
    const double length =
        fmax(s->domain.x_max - s->domain.x_min, s->domain.y_max - s->domain.y_min);
    const double friction =
        belt_largest_friction(s->n_belts, s->belts, &s->micro.contact[SCENE_CONVEYOR_CARGO]);
    const double force = o->force_limit > 0.0 ? o->force_limit
                                              : friction * s->micro.gravity *
                                                    plate_drive_mass_per_area(s) * radius * length;

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
            !plate_motion_is_same(plate_motion_told(motion, obstacle, t),
                                  plate_motion_told(motion, obstacle, until)) ||
            plate_motion_told_extent(motion, obstacle, t) <
                plate_motion_told_extent(motion, obstacle, until));
}

// What part of the told speed a drive has under a load, of its limit.
static double speed_under(double load)
{
    return fmin(fmax((1.0 - load) / (1.0 - eased), 0.0), 1.0);
}

// The next piece of a motion that is at `now` and told to be at `told` at its end, with a speed of at most `most` times
// `part` of it. None if it is as told before and after.
static void set_piece(plate_motion_piece *piece, double t, double until, double now, double told,
                      double most, double part)
{
    const double way = told - now;

    if (piece->at == INFINITY && part == 1.0)
        return;
    const double able = part * fmin(fabs(way), most);
    *piece = (plate_motion_piece){ .at = t,
                                   .until = until,
                                   .from = now,
                                   .to = able < fabs(way) ? now + copysign(able, way) : told };
}

// The same of a shift, straight to where it is told to be.
static void set_way(plate_motion_way *piece, double t, double until, vec2 now, vec2 told,
                    double most, double part)
{
    const vec2 way = vec2_sub(told, now);
    const double length = vec2_length(way), able = part * fmin(length, most);

    if (piece->at == INFINITY && part == 1.0)
        return;
    *piece = (plate_motion_way){ .at = t,
                                 .until = until,
                                 .from = now,
                                 .to = able < length ? vec2_add(now, vec2_scale(way, able / length))
                                                     : told };
}

static void follow_shift(plate_motion_way *lag, const plate_drive *drive, const plate_load *load,
                         double t, double until, const plate_motion_place *now,
                         const plate_motion_place *told, const plate_motion_place *next)
{
    const vec2 way = vec2_sub(next->shift, now->shift);
    const double length = vec2_length(way);
    double fastest = drive->speed * (until - t);

    if (now->shift.x == told->shift.x && now->shift.y == told->shift.y) {
        lag->at = INFINITY;
        fastest = length;
    }
    set_way(lag, t, until, now->shift, next->shift, fastest,
            length == 0.0 ? 1.0
                          : speed_under(-vec2_dot(load->resultant, way) / length / drive->force));
}

void plate_drive_follow(plate_motion *motion, size_t obstacle, const plate_drive *drive,
                        const plate_load *load, double t, double until)
{
    plate_motion_lag *lag = &motion->plates[obstacle].lag;
    const plate_motion_place now = plate_motion_at(motion, obstacle, t);
    const plate_motion_place told = plate_motion_told(motion, obstacle, t);
    const plate_motion_place next = plate_motion_told(motion, obstacle, until);
    const double extent = plate_motion_extent(motion, obstacle, t);
    const double to_extent = plate_motion_told_extent(motion, obstacle, until);
    const double against = next.angle > now.angle ? -load->torque : load->torque;
    double fastest = drive->rate * (until - t);

    if (now.angle == told.angle) {
        lag->angle.at = INFINITY;
        fastest = fabs(next.angle - now.angle);
    }
    if (extent == plate_motion_told_extent(motion, obstacle, t))
        lag->extent.at = INFINITY;
    // Nothing holds back what is not told to move.
    set_piece(&lag->angle, t, until, now.angle, next.angle, fastest,
              next.angle == now.angle ? 1.0 : speed_under(against / drive->torque));
    set_piece(&lag->extent, t, until, extent, to_extent, (until - t) / PLATE_MOTION_COMING,
              to_extent <= extent ? 1.0 : speed_under(load->force / drive->force));
    follow_shift(&lag->shift, drive, load, t, until, &now, &told, &next);
}

static bool stands(const plate_motion_piece *piece)
{
    return piece->at < INFINITY && piece->from == piece->to;
}

static bool stands_still(const plate_motion_way *way)
{
    return way->at < INFINITY && way->from.x == way->to.x && way->from.y == way->to.y;
}

plate_drive_state plate_drive_state_of(const plate_motion *motion, size_t obstacle, double t)
{
    const plate_motion_lag *lag = &motion->plates[obstacle].lag;
    const plate_motion_place told = plate_motion_told(motion, obstacle, t);
    const vec2 left = vec2_sub(lag->shift.to, told.shift);

    if ((stands(&lag->angle) && lag->angle.to != told.angle) ||
        (stands_still(&lag->shift) && (left.x != 0.0 || left.y != 0.0)) ||
        (stands(&lag->extent) && lag->extent.to < plate_motion_told_extent(motion, obstacle, t)))
        return PLATE_DRIVE_STALLED;
    return is_behind(lag) ? PLATE_DRIVE_BEHIND : PLATE_DRIVE_AS_TOLD;
}
