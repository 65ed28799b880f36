#include "core/scene/plate_motion.h"

#include "core/base/memory.h"
#include "core/base/search.h"
#include "core/scene/scene.h"

#include <math.h>
#include <string.h>

static const plate_motion_command no_command = { .at = INFINITY,
                                                 .presence = -1.0,
                                                 .came = -INFINITY };

static const plate_motion_lag no_lag = { .angle = { .at = INFINITY },
                                         .extent = { .at = INFINITY } };

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

static double scheduled_angle(const scene_series *s, double t)
{
    const double in_round = time_in_round(s, t);
    const size_t n = s->n_times, k = count_times(s, in_round);

    if (n == 0)
        return 0.0;
    if (k == 0 && t < s->repeat)
        return s->values[0];
    if (k == n && s->repeat == INFINITY)
        return s->values[n - 1];
    const double from = k > 0 ? s->times[k - 1] : s->times[n - 1] - s->repeat;
    const double to = k < n ? s->times[k] : s->times[0] + s->repeat;
    const double before = s->values[k > 0 ? k - 1 : n - 1], after = s->values[k < n ? k : 0];
    return before + (after - before) * ((in_round - from) / (to - from));
}

static double commanded_angle(const plate_motion_command *c, double t)
{
    return t < c->at + c->over ? c->from + (c->to - c->from) * ((t - c->at) / c->over) : c->to;
}

double plate_motion_told_angle(const plate_motion *motion, size_t obstacle, double t)
{
    const plate_motion_plate *plate = &motion->plates[obstacle];

    return plate->command.at < INFINITY ? commanded_angle(&plate->command, t)
                                        : scheduled_angle(&plate->turn, t);
}

// The value of a piece at a time t at or after its beginning.
static double value_of(const plate_motion_piece *p, double t)
{
    return t < p->until ? p->from + (p->to - p->from) * ((t - p->at) / (p->until - p->at)) : p->to;
}

double plate_motion_angle(const plate_motion *motion, size_t obstacle, double t)
{
    const plate_motion_piece *lag = &motion->plates[obstacle].lag.angle;

    return lag->at < INFINITY ? value_of(lag, t) : plate_motion_told_angle(motion, obstacle, t);
}

double plate_motion_angular_velocity(const plate_motion *motion, size_t obstacle, double from,
                                     double to)
{
    return (plate_motion_angle(motion, obstacle, to) - plate_motion_angle(motion, obstacle, from)) /
           (to - from);
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
    const plate_motion_piece *lag = &motion->plates[obstacle].lag.extent;
    const double told = plate_motion_told_extent(motion, obstacle, t);

    return lag->at < INFINITY ? fmin(value_of(lag, t), told) : told;
}

plate_motion_pose plate_motion_pose_at(const plate_motion *motion, size_t obstacle, double angle)
{
    return (plate_motion_pose){ motion->plates[obstacle].pivot, cos(angle), sin(angle) };
}

plate_motion_step plate_motion_in_step(const plate_motion *motion, size_t obstacle,
                                       uint64_t n_before, double dt, double depth)
{
    const double from = (double)n_before * dt, to = (double)(n_before + 1) * dt;
    const double extent = plate_motion_extent(motion, obstacle, from);
    const double grown = plate_motion_extent(motion, obstacle, to) - extent;

    return (plate_motion_step){
        .pose = plate_motion_pose_at(motion, obstacle, plate_motion_angle(motion, obstacle, from)),
        .spin = plate_motion_angular_velocity(motion, obstacle, from, to),
        .recess =
            plate_motion_is_present(motion, obstacle, from) ? (1.0 - extent) * depth : INFINITY,
        .growth = grown > 0.0 ? grown * depth / dt : 0.0,
    };
}

void plate_motion_command_turn(plate_motion *motion, size_t obstacle, double t, double angle,
                               double over)
{
    plate_motion_command *c = &motion->plates[obstacle].command;

    c->from = plate_motion_angle(motion, obstacle, t);
    motion->plates[obstacle].lag.angle = no_lag.angle;
    c->at = t;
    c->to = angle;
    c->over = over;
}

void plate_motion_command_presence(plate_motion *motion, size_t obstacle, double t, bool is_present)
{
    plate_motion_plate *plate = &motion->plates[obstacle];
    double came;

    plate->command.came = find_presence(plate, t, &came) ? came : t;
    plate->command.presence = is_present ? 1.0 : 0.0;
}

static double largest_scheduled(const scene_series *s)
{
    const size_t n = s->n_times;
    double largest = 0.0;

    for (size_t k = 1; k < n; k++)
        largest =
            fmax(largest, fabs(s->values[k] - s->values[k - 1]) / (s->times[k] - s->times[k - 1]));
    if (n > 1 && s->repeat < INFINITY && s->values[0] != s->values[n - 1])
        largest = fmax(largest, fabs(s->values[0] - s->values[n - 1]) /
                                    (s->times[0] + s->repeat - s->times[n - 1]));
    return largest;
}

static bool turns(const scene_action *a, size_t obstacle)
{
    return a->type == SCENE_ACTION_TURN && a->target == obstacle;
}

// Between angles that schedule and actions lead to, the plate may have any.
static double largest_commanded(const scene_series *s, size_t k, size_t n_actions,
                                const scene_action *actions)
{
    double low = s->n_times > 0 ? s->values[0] : 0.0, high = low, largest = 0.0;

    for (size_t m = 0; m < s->n_times; m++) {
        low = fmin(low, s->values[m]);
        high = fmax(high, s->values[m]);
    }
    for (size_t m = 0; m < n_actions; m++) {
        if (turns(&actions[m], k)) {
            low = fmin(low, actions[m].value);
            high = fmax(high, actions[m].value);
        }
    }
    for (size_t m = 0; m < n_actions; m++)
        if (turns(&actions[m], k))
            largest = fmax(largest,
                           fmax(high - actions[m].value, actions[m].value - low) / actions[m].over);
    return largest;
}

double plate_motion_radius(const scene_obstacle *obstacle)
{
    double radius = 0.0;

    for (size_t k = 0; k < obstacle->n_points; k++)
        radius = fmax(radius, vec2_length(vec2_sub(obstacle->path[k], obstacle->pivot)));
    return radius + obstacle->thickness;
}

double plate_motion_largest_speed(const scene_obstacle *obstacles, size_t k, size_t n_actions,
                                  const scene_action *actions)
{
    const scene_series *turn = &obstacles[k].turn;
    const double rate =
        fmax(largest_scheduled(turn), largest_commanded(turn, k, n_actions, actions));

    return rate > 0.0 ? rate * plate_motion_radius(&obstacles[k]) : 0.0;
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

static bool is_piece_sound(const plate_motion_piece *p)
{
    return p->at == INFINITY || (p->at >= 0.0 && p->until > p->at && isfinite(p->until) &&
                                 isfinite(p->from) && isfinite(p->to));
}

static bool is_sound(const saved_plate *s)
{
    const plate_motion_command *c = &s->command;

    return (c->at == INFINITY || (c->at >= 0.0 && isfinite(c->from) && isfinite(c->to) &&
                                  c->over > 0.0 && isfinite(c->over))) &&
           (c->presence == -1.0 || c->presence == 0.0 || c->presence == 1.0) &&
           c->came < INFINITY && is_piece_sound(&s->lag.angle) && is_piece_sound(&s->lag.extent);
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
