// The figures of a scenario (validity.h).

#include "core/advice/bridges.h"
#include "core/advice/review_belts.h"
#include "core/advice/validity_priv.h"
#include "core/base/memory.h"
#include "core/base/polygon.h"
#include "core/base/vec2.h"
#include "core/feed/arrivals.h"
#include "core/scene/belt_range.h"
#include "core/scene/belt_slope.h"
#include "core/scene/feed_line.h"
#include "core/scene/mix.h"
#include "core/scene/plate_pose.h"
#include "core/scene/plate_range.h"
#include "core/scene/shape.h"
#include "core/scene/surroundings.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/// Ratios of equal numbers and sines of parallel directions are within this of 1 and 0.
#define ROUNDING 1e-6

/// From this share of what a full opening passes on, cargo queues before it.
#define FULL 0.95

/// From this share on parts that are rough, or come on a fast belt, fill an opening.
#define NEARLY_FULL 0.7

/// From this share on parts that arrive by chance queue now and then.
#define QUEUES 0.5

/// Part diameters of belt behind a plate beyond which more of it changes nothing.
#define LONG_ENOUGH 8.0

/// Degrees to the belt below which the friction on a deflector says how fast a queue slides along it.
#define SHALLOW 50.0

/// Part diameters beside a feed's line that count as free belt: lines that were compared left up to one.
#define BESIDE 1.25

/// Parts within which a queue may stop for good.
#define BRIDGED_WITHIN 1000.0

enum {
    WIDTH_DIRECTIONS = 64, ///< in which the width of a part is looked for, over half a turn
    TURN_SAMPLES = 16,     ///< places of a plate that moves at which openings are measured
    TURN_PIECES_MAX = 64,  ///< straight pieces of all plates up to which they are
};

/// What figures are measured from.
typedef struct measures {
    const scene *s;
    validity__findings *to; ///< where they are judged, and the layout is
    double diameter;        ///< of the largest part, m
    double rate;            ///< of all feeds together at most, parts/s
    double n_fed;           ///< parts of feeds in the run
    bool is_moving;         ///< a plate turns or is shifted
} measures;

static void note(measures *f, validity_figure figure, double value, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/// Have a value judged that the scenario has; the text is the pointer of what has it.
static void note(measures *f, validity_figure figure, double value, const char *format, ...)
{
    char pointer[BF_POINTER_SIZE];
    va_list args;

    va_start(args, format);
    vsnprintf(pointer, sizeof pointer, format, args);
    va_end(args);
    validity__judge(f->to, figure, value, pointer);
}

/// The same for a number of things that a scenario may not have.
static void note_count(measures *f, validity_figure figure, size_t n, const char *pointer)
{
    if (n > 0)
        validity__judge(f->to, figure, (double)n, pointer);
}

// ---- plates and openings

static void note_angles(measures *f, const layout *of)
{
    note(f, VALIDITY_ANGLE, of->least.value, "/obstacles/%zu", of->least.index);
    note(f, VALIDITY_ANGLE, of->greatest.value, "/obstacles/%zu", of->greatest.index);
    note(f, VALIDITY_PLATES, (double)of->n_plates, "/obstacles");
    note(f, VALIDITY_BENDS, of->bends.value, "/obstacles/%zu", of->bends.index);
}

/// Parts/s that the narrowest opening passes when it is full: what a packed one would carry, times a share by the angle
/// of the plate to the belt. The shares are those of tests/validation/feeds.py at 4.2 diameters.
static double full_rate(const measures *f, const layout *of)
{
    static const struct {
        double angle, part;
    } full[] = { { 45.0, 0.96 }, { 60.0, 0.84 }, { 75.0, 0.83 }, { 90.0, 0.76 } };
    const scene_obstacle *plate = &f->s->obstacles[of->opening.index];
    const vec2 middle = vec2_scale(vec2_add(plate->path[0], plate->path[plate->n_points - 1]), 0.5);
    const surroundings around = surroundings_of(f->s);
    const vec2 belt = surroundings_velocity_under(&around, middle);
    double passed = full[0].part;

    for (size_t k = 1; k < sizeof full / sizeof *full; k++) {
        const double place =
            (of->greatest.value - full[k - 1].angle) / (full[k].angle - full[k - 1].angle);
        if (place > 0.0)
            passed = full[k - 1].part + fmin(place, 1.0) * (full[k].part - full[k - 1].part);
    }
    return passed * scene_packing_density(f->s) * of->opening.value * vec2_length(belt);
}

/// How far the foot of a plate is downstream of the line of a feed, m.
static double length_before(const scene *s, const scene_feed *feed, const scene_obstacle *plate)
{
    const surroundings around = surroundings_of(s);
    const vec2 middle = vec2_scale(vec2_add(feed->line[0], feed->line[1]), 0.5);
    const vec2 belt = surroundings_velocity_under(&around, middle);
    double least = INFINITY;

    for (size_t k = 0; k < plate->n_points; k++)
        least = fmin(least, vec2_dot(vec2_sub(plate->path[k], middle), belt));
    return least / vec2_length(belt);
}

static bool has_plate_across(const scene *s, vec2 from, vec2 to)
{
    for (size_t k = 0; k < s->n_obstacles; k++) {
        const scene_obstacle *o = &s->obstacles[k];
        for (size_t i = 0; i + 1 < o->n_points; i++)
            if (polygon_segments_touch(from, to, o->path[i], o->path[i + 1], o->thickness))
                return true;
    }
    return false;
}

/// True if cargo can queue beside the line of a feed, on the belt that it is on.
static bool leaves_belt_free(const measures *f, const scene_feed *feed)
{
    const surroundings around = surroundings_of(f->s);
    const vec2 line = vec2_sub(feed->line[1], feed->line[0]);
    const double beyond = BESIDE * f->diameter / vec2_length(line);

    for (int k = 0; k < 2 && vec2_length(line) > 0.0; k++) {
        const vec2 to = vec2_add(feed->line[k], vec2_scale(line, k == 0 ? -beyond : beyond));
        if (surroundings_is_inside(&f->s->domain, to) &&
            surroundings_belt_at(&around, to) == surroundings_belt_at(&around, feed->line[k]) &&
            !has_plate_across(f->s, feed->line[k], to))
            return true;
    }
    return false;
}

/// What matters where cargo queues, now and then or always.
static void note_queue(measures *f, const layout *of)
{
    size_t n_beside = 0, beside = 0;

    if (isfinite(of->stagger.value))
        note(f, VALIDITY_STAGGER, of->stagger.value / f->diameter, "/obstacles/%zu",
             of->stagger.index);
    if (of->n_plates == 1 && of->free_ends.value > 0.0)
        note(f, VALIDITY_FREE_ENDS, of->free_ends.value, "/obstacles/%zu", of->free_ends.index);
    if (isfinite(of->run_out.value))
        note(f, VALIDITY_RUN_OUT, fmin(of->run_out.value / f->diameter, LONG_ENOUGH),
             "/obstacles/%zu", of->run_out.index);
    for (size_t k = 0; k < f->s->n_feeds; k++) {
        if (!leaves_belt_free(f, &f->s->feeds[k]))
            continue;
        n_beside++;
        beside = k;
    }
    if (n_beside > 0)
        note(f, VALIDITY_BESIDE, (double)n_beside, "/feeds/%zu", beside);
    note(f, VALIDITY_BRIDGES, 100.0 * bridges_of(f->s, of, f->diameter, BRIDGED_WITHIN),
         "/obstacles/%zu", of->opening.index);
}

/// Part diameters within which the belts bring a part to the speed of the fastest; NAN: never.
static double diameters_to_speed(const measures *f)
{
    const double speed = scene_belt_speed(f->s), gravity = f->s->micro.gravity,
                 friction = belt_slope_least_drive(f->s->n_belts, f->s->belts,
                                                   &f->s->micro.contact[SCENE_CONVEYOR_CARGO]);

    return friction * gravity > 0.0 ? 0.5 * speed * speed / (friction * gravity * f->diameter)
                                    : NAN;
}

/// What matters from NEARLY_FULL on.
static void note_nearly_full(measures *f)
{
    note(f, VALIDITY_FRICTION_FULL, f->s->micro.contact[SCENE_CARGO_CARGO].friction,
         "/contacts/cargo_cargo/friction");
    note(f, VALIDITY_ACCELERATION_FULL, diameters_to_speed(f), "/belts");
}

/// What matters where feeds keep the opening full.
static void note_full(measures *f, const layout *of)
{
    if (isfinite(of->next_belt.value))
        note(f, VALIDITY_NEXT_BELT, of->next_belt.value / f->diameter, "/obstacles/%zu",
             of->next_belt.index);
    if (isfinite(of->short_end.value))
        note(f, VALIDITY_SHORT_END, of->short_end.value / f->diameter, "/obstacles/%zu",
             of->short_end.index);
    if (of->n_plates > 1)
        note(f, VALIDITY_FUNNEL_ANGLE, of->least.value, "/obstacles/%zu", of->least.index);
    if (of->least.value < SHALLOW)
        note(f, VALIDITY_SLIDING, f->s->micro.contact[SCENE_HANDLING_CARGO].friction,
             "/contacts/handling_cargo/friction");
    for (size_t k = 0; k < f->s->n_feeds; k++) {
        const scene_obstacle *plate = &f->s->obstacles[of->opening.index];
        const double before = length_before(f->s, &f->s->feeds[k], plate) / f->diameter;
        note(f, VALIDITY_QUEUE, before, "/feeds/%zu", k);
        if (of->least_bends > 0.0)
            note(f, VALIDITY_LANE_QUEUE, before, "/feeds/%zu", k);
    }
}

static void note_heap(measures *f, const layout *of)
{
    const double n_parts = (double)scene_parts(f->s), width = of->opening.value / f->diameter;
    const double most = validity__range(f->to, VALIDITY_PARTS)->maximum;

    // How many parts of feeds there are at a time is what their load says.
    if (f->s->n_feeds == 0)
        note(f, VALIDITY_PARTS, n_parts, "/initial");
    else
        note(f, VALIDITY_PARTS, fmin(n_parts + f->n_fed, most), "/feeds");
    if (of->n_plates == 0)
        return;
    if (f->s->n_feeds == 0 && f->s->warmup > 0.0)
        note(f, VALIDITY_WARM_UP, f->s->warmup, "/warmup_s");
    if (isfinite(width))
        note(f, of->n_plates > 1 ? VALIDITY_FUNNEL : VALIDITY_OPENING, width, "/obstacles/%zu",
             of->opening.index);
    if (isfinite(width) && of->n_plates == 1 && of->least_bends > 0.0)
        note(f, VALIDITY_LANE, width, "/obstacles/%zu", of->opening.index);
    if (f->s->n_feeds == 0 || f->rate >= QUEUES * full_rate(f, of))
        note_queue(f, of);
    if (width > 0.0 && isfinite(width))
        note(f, VALIDITY_HEAP, n_parts / width, "/initial");
    if (f->s->n_feeds == 0 || of->opening.value == 0.0)
        return;
    const double load = f->rate / full_rate(f, of);
    note(f, VALIDITY_LOAD, 100.0 * load, "/feeds");
    if (load >= NEARLY_FULL)
        note_nearly_full(f);
    if (load >= FULL)
        note_full(f, of);
}

static void note_plates(measures *f, const layout *of)
{
    note(f, VALIDITY_PIECES, (double)of->n_pieces, "/obstacles");
    if (!of->is_measured) {
        note(f, VALIDITY_ANGLE, NAN, "/obstacles");
        note(f, VALIDITY_OPENING, NAN, "/obstacles");
        return;
    }
    if (of->n_plates > 0)
        note_angles(f, of);
    note_count(f, VALIDITY_GUIDES, of->n_guides, "/obstacles");
}

// ---- belts

static bool has_slopes(const scene *s)
{
    bool has = false;

    for (size_t k = 0; k < s->n_belts; k++)
        has = has || s->belts[k].incline != 0.0;
    return has;
}

static void note_speeds(measures *f)
{
    double n_schedules = 0.0;

    for (size_t k = 0; k < f->s->n_belts; k++) {
        const scene_belt *belt = &f->s->belts[k];
        const scene_speed_schedule *schedule = &belt->speed_schedule;
        const double speed = vec2_length(belt->velocity);
        if (schedule->n_times == 0 || schedule->times[0] > 0.0)
            note(f, VALIDITY_SPEED, speed, "/belts/%zu/velocity_m_s", k);
        for (size_t i = 0; i < schedule->n_times; i++)
            note(f, VALIDITY_SPEED, speed * fabs(schedule->factors[i]),
                 "/belts/%zu/speed_schedule/factor/%zu", k, i);
        n_schedules += belt_range_may_change(belt);
    }
    for (size_t k = 0; k < f->s->n_actions; k++) {
        const scene_action *a = &f->s->actions[k];
        if (a->type == SCENE_ACTION_BELT)
            note(f, VALIDITY_SPEED, vec2_length(f->s->belts[a->target].velocity) * fabs(a->value),
                 "/actions/%zu/do/factor", k);
    }
    if (n_schedules > 0.0)
        note(f, VALIDITY_SCHEDULES, n_schedules, "/belts");
}

/// Parts/s that a belt carries when it is packed over its width, or over that of the domain.
static double belt_capacity(const scene *s, const scene_belt *belt)
{
    const scene_rect *d = &s->domain;
    const vec2 corners[] = { { d->x_min, d->y_min },
                             { d->x_max, d->y_min },
                             { d->x_max, d->y_max },
                             { d->x_min, d->y_max } };
    const vec2 *points = belt->n_points > 0 ? belt->polygon : corners;
    const size_t n = belt->n_points > 0 ? belt->n_points : sizeof corners / sizeof *corners;
    double low = INFINITY, high = -INFINITY; // speed times place across the belt

    if (belt->arc.is_given)
        return scene_packing_density(s) * 0.5 * fabs(belt->turn) *
               (belt->arc.outer_radius * belt->arc.outer_radius -
                belt->arc.inner_radius * belt->arc.inner_radius);
    for (size_t k = 0; k < n; k++) {
        const double across = vec2_cross(belt->velocity, points[k]);
        low = fmin(low, across);
        high = fmax(high, across);
    }
    return scene_packing_density(s) * (high - low);
}

// ---- feeds

/// Parts/s that the belt under the middle of a feed's line carries from it when it is packed, 0 off all belts. Unlike feed_capacity() without
/// the halves of parts beyond the ends of the line: the limit was measured so.
static double carried_rate(const measures *f, const surroundings *around, const scene_feed *feed)
{
    const vec2 middle = vec2_scale(vec2_add(feed->line[0], feed->line[1]), 0.5);
    const size_t under = surroundings_belt_at(around, middle);

    if (under == around->n_belts)
        return 0.0;
    const vec2 velocity = surroundings_velocity_at(around, under, middle);
    vec2 line[2];
    feed_line_widened(f->s, feed, line);
    const double across = fabs(vec2_cross(velocity, vec2_sub(line[1], line[0])));
    return fmin(scene_packing_density(f->s) * across, belt_capacity(f->s, &around->belts[under]));
}

static bf_status sum_feeds(measures *f, bf_error *err)
{
    const surroundings around = surroundings_of(f->s);

    for (size_t k = 0; k < f->s->n_feeds; k++) {
        feed_arrivals *arrivals;
        const bf_status status =
            feed_arrivals_create(&f->s->feeds[k], f->s->substream, &arrivals, err);
        if (status != BF_OK)
            return status;
        const double rate = feed_arrivals_largest_rate(arrivals);
        const double most = carried_rate(f, &around, &f->s->feeds[k]);
        if (most > 0.0)
            note(f, VALIDITY_FEED, 100.0 * rate / most, "/feeds/%zu", k);
        f->rate += rate;
        feed_arrivals_destroy(arrivals);
    }
    return feed_offered(f->s, 0.0, f->s->duration, &f->n_fed, err);
}

// ---- what moves

/// Measure the angles and openings that a plate comes to while the others stand as in the document.
static bf_status note_moving(measures *f, scene *moved, size_t index, bf_error *err)
{
    const scene_obstacle *o = &f->s->obstacles[index];
    bf_status status = BF_OK;
    const plate_range r = plate_range_of(f->s->obstacles, index, f->s->n_actions, f->s->actions);
    layout of;

    for (int k = 0; k <= TURN_SAMPLES && status == BF_OK; k++) {
        const double part = (double)k / TURN_SAMPLES;
        const double angle = r.least + (r.most - r.least) * k / TURN_SAMPLES;
        const plate_pose pose = { o->pivot, vec2_between(r.ends[0], r.ends[1], part), cos(angle),
                                  sin(angle) };
        for (size_t i = 0; i < o->n_points; i++)
            moved->obstacles[index].path[i] = plate_pose_move(&pose, o->path[i]);
        status = layout_measure(moved, &of, err);
        if (status == BF_OK && of.n_plates > 0)
            note_angles(f, &of);
        // Parts are caught in gaps that they do not fit through, too.
        const double width = fmin(of.opening.value, of.gap.value);
        if (status == BF_OK && isfinite(width))
            note(f, VALIDITY_SWEPT, width / f->diameter, "/obstacles/%zu", index);
    }
    return status;
}

/// The same for all plates that turn or are shifted, on a copy of the scene whose obstacles are its own.
static bf_status note_swept(measures *f, bf_error *err)
{
    const scene *s = f->s;
    scene moved = *s;
    bf_status status = BF_OK;

    for (size_t k = 0; k < s->n_obstacles && status == BF_OK; k++) {
        const plate_range r = plate_range_of(s->obstacles, k, s->n_actions, s->actions);
        if (r.least == r.most && !r.is_shifted)
            continue;
        f->is_moving = true;
        if (f->to->layout.n_pieces > TURN_PIECES_MAX) {
            note(f, VALIDITY_SWEPT, NAN, "/obstacles/%zu", k);
            continue;
        }
        scene_obstacle *obstacles = memory_alloc(s->n_obstacles, sizeof *obstacles);
        vec2 *path = memory_alloc(s->obstacles[k].n_points, sizeof *path);
        if (obstacles != NULL && path != NULL) {
            memcpy(obstacles, s->obstacles, s->n_obstacles * sizeof *obstacles);
            obstacles[k].path = path;
            moved.obstacles = obstacles;
            status = note_moving(f, &moved, k, err);
        } else {
            status = bf_fail(err, BF_ENOMEM, "", "no memory for plates that move");
        }
        memory_free(path);
        memory_free(obstacles);
    }
    return status;
}

static void note_motions(measures *f)
{
    size_t n_moving = 0, moving = 0, n_shifted = 0, shifted = 0;
    char pointer[BF_POINTER_SIZE];

    for (size_t k = 0; k < f->s->n_obstacles; k++) {
        if (scene_obstacle_moves(&f->s->obstacles[k])) {
            n_moving++;
            moving = k;
        }
        if (plate_range_of(f->s->obstacles, k, f->s->n_actions, f->s->actions).is_shifted) {
            n_shifted++;
            shifted = k;
        }
    }
    snprintf(pointer, sizeof pointer, "/obstacles/%zu", moving);
    note_count(f, VALIDITY_MOTIONS, n_moving, pointer);
    snprintf(pointer, sizeof pointer, "/obstacles/%zu/motion", shifted);
    note_count(f, VALIDITY_SHIFTS, n_shifted, pointer);
    note_count(f, VALIDITY_COMMANDS, f->s->n_actions + f->s->n_merges,
               f->s->n_actions > 0 ? "/actions" : "/merges");
    note_count(f, VALIDITY_SINKS, f->s->n_sinks, "/sinks");
}

// ---- cargo

/// A ratio of the largest to the smallest of the kinds, and its place.
typedef struct extremes {
    double least;
    double largest;
    size_t at; ///< the kind that is largest
} extremes;

static void widen(extremes *of, double value, size_t kind)
{
    if (value > of->largest)
        of->at = kind;
    of->least = fmin(of->least, value);
    of->largest = fmax(of->largest, value);
}

static void note_ratio(measures *f, validity_figure figure, const extremes *of)
{
    if (of->largest > of->least * (1.0 + ROUNDING))
        note(f, figure, of->largest / of->least, "/cargo/%zu", of->at);
}

/// The least width of a footprint, m.
static double width_of(const shape_footprint *footprint)
{
    double least = INFINITY;

    if (footprint->n_corners == 0)
        return 2.0 * footprint->bounding_radius;
    for (int k = 0; k < WIDTH_DIRECTIONS; k++) {
        const vec2 across = shape_direction(M_PI * k / WIDTH_DIRECTIONS);
        least = fmin(least, shape_extent(footprint, 0.0, across) +
                                shape_extent(footprint, 0.0, vec2_scale(across, -1.0)));
    }
    return least;
}

static double height_of(const scene_shape *shape)
{
    double low = INFINITY, high = -INFINITY;

    if (shape->type != SCENE_HULL)
        return shape->height;
    for (size_t k = 0; k < shape->n_vertices; k++) {
        low = fmin(low, shape->vertices[k][2]);
        high = fmax(high, shape->vertices[k][2]);
    }
    return high - low;
}

static void note_shapes(measures *f)
{
    const scene *s = f->s;
    double weights[SCENE_KINDS_MAX], all = 0.0, others = 0.0;
    size_t counts[SCENE_KINDS_MAX], other = 0;

    // Of each kind: parts at the start, and those of feeds by the shares of their mix.
    mix_count(s, scene_parts(s), counts);
    for (size_t k = 0; k < s->n_cargo; k++)
        weights[k] = (double)counts[k];
    for (size_t k = 0; k < s->n_feeds; k++) {
        for (size_t i = 0; i < s->feeds[k].n_cargo; i++)
            weights[s->feeds[k].cargo[i].kind] += s->feeds[k].cargo[i].share;
    }
    for (size_t k = 0; k < s->n_cargo; k++) {
        const bool is_other = s->cargo[k].shape.type != SCENE_CYLINDER;
        all += weights[k];
        others += is_other ? weights[k] : 0.0;
        other = is_other ? k : other;
    }
    if (others == 0.0)
        return;
    if (s->is_mix)
        note(f, VALIDITY_SHAPE, 100.0 * others / all, "/cargo/%zu/shape", other);
    else
        note(f, VALIDITY_SHAPE, 100.0 * others / all, "/cargo/shape");
}

static void note_cargo(measures *f)
{
    extremes sizes = { INFINITY, 0.0, 0 }, masses = { INFINITY, 0.0, 0 };

    for (size_t k = 0; k < f->s->n_cargo; k++) {
        const shape_footprint footprint = shape_footprint_of(&f->s->cargo[k].shape);
        const scene_cargo *kind = &f->s->cargo[k];
        const double slender = height_of(&kind->shape) / width_of(&footprint);
        char place[32] = "";
        if (f->s->is_mix)
            snprintf(place, sizeof place, "/%zu", k);
        note(f, VALIDITY_DIAMETER, 2.0 * footprint.bounding_radius, "/cargo%s/shape", place);
        note(f, VALIDITY_MASS, kind->mass, "/cargo%s/mass_kg", place);
        note(f, VALIDITY_TIPPING,
             slender * belt_slope_largest_drive(f->s->n_belts, f->s->belts,
                                                &f->s->micro.contact[SCENE_CONVEYOR_CARGO]),
             "/cargo%s/shape", place);
        widen(&sizes, footprint.bounding_radius, k);
        widen(&masses, f->s->cargo[k].mass, k);
    }
    note_ratio(f, VALIDITY_SIZES, &sizes);
    note_ratio(f, VALIDITY_MASSES, &masses);
    note_shapes(f);
    note(f, VALIDITY_KINDS, (double)f->s->n_cargo, "/cargo");
}

// ---- parameters

static void note_frictions(measures *f)
{
    const scene_contact *contact = f->s->micro.contact;

    note(f, VALIDITY_PLATE_FRICTION, contact[SCENE_HANDLING_CARGO].friction,
         "/contacts/handling_cargo/friction");
    note(f, VALIDITY_WALL_FRICTION, f->s->micro.wall_friction, "/contacts/wall_friction");
    note(f, VALIDITY_PART_FRICTION, contact[SCENE_CARGO_CARGO].friction,
         "/contacts/cargo_cargo/friction");
    note(f, VALIDITY_BELT_FRICTION, contact[SCENE_CONVEYOR_CARGO].friction,
         "/contacts/conveyor_cargo/friction");
    for (size_t k = 0; k < f->s->n_belts; k++)
        if (f->s->belts[k].friction > 0.0)
            note(f, VALIDITY_BELT_FRICTION, f->s->belts[k].friction, "/belts/%zu/friction", k);
    note(f, VALIDITY_SMOOTHING, contact[SCENE_CONVEYOR_CARGO].tanh_linear,
         "/contacts/conveyor_cargo/tanh_linear_s_m");
}

/// Constants that have other values than in the comparison.
static void note_constants(measures *f)
{
    const scene_macro *macro = &f->s->macro;
    const scene_micro *micro = &f->s->micro;
    const double dispersion = 2.0 * scene_belt_speed(f->s);
    const struct {
        validity_subject of;
        bool is_other;
        const char *pointer;
    } constants[] = {
        { VALIDITY_DISPERSIVE, macro->heaviside == SCENE_HEAVISIDE_SMOOTH, "/macro/heaviside" },
        { VALIDITY_DISPERSIVE, fabs(macro->dispersion - dispersion) > ROUNDING * dispersion,
          "/macro/dispersion_m_s" },
        { VALIDITY_DISPERSIVE, macro->mollifier < 1e3 || macro->mollifier > 1e4,
          "/macro/mollifier_per_m2" },
        { VALIDITY_CONGESTED, macro->jam_density != 0.93, "/macro/jam_density" },
        { VALIDITY_PARTS_MODEL, micro->tension, "/micro/tension" },
        { VALIDITY_PARTS_MODEL, micro->damping != 0.1, "/micro/damping_per_s" },
        { VALIDITY_PARTS_MODEL, micro->gravity != 9.81, "/micro/gravity_m_s2" },
    };
    const char *pointer = "";
    size_t n_others = 0;

    for (size_t k = 0; k < sizeof constants / sizeof *constants; k++) {
        if (constants[k].of != f->to->subject || !constants[k].is_other)
            continue;
        n_others++;
        pointer = constants[k].pointer;
    }
    note_count(f, VALIDITY_CONSTANTS, n_others, pointer);
}

static void note_grid(measures *f)
{
    double n_others = 0.0;
    size_t other = 0;

    for (size_t k = 0; k < f->s->n_obstacles; k++) {
        if (f->s->obstacles[k].treatment != SCENE_SEALED) {
            n_others += 1.0;
            other = k;
        }
    }
    if (n_others > 0.0)
        note(f, VALIDITY_TREATMENT, n_others, "/obstacles/%zu/treatment", other);
    note(f, VALIDITY_CELL, scene_cell_edge(f->s) / f->diameter, "/macro/cell_m");
}

static bool is_straight(const scene_belt *belt)
{
    return !belt->arc.is_given && belt->n_more == 0;
}

static void note_arc(measures *f, const scene_belt *belt)
{
    const scene_arc *arc = &belt->arc;
    const double radius = 0.5 * (arc->inner_radius + arc->outer_radius);
    const double speed = vec2_length(belt->velocity) * radius / arc->reference_radius;
    const double most = f->s->micro.gravity *
                        belt_slope_least_drive(1, belt, &f->s->micro.contact[SCENE_CONVEYOR_CARGO]);

    note(f, VALIDITY_CURVE, radius / (arc->outer_radius - arc->inner_radius), "/belts");
    note(f, VALIDITY_CORNERING, most > 0.0 ? 100.0 * speed * speed / (most * radius) : NAN,
         "/belts");
}

static void note_figures(measures *f)
{
    const layout *of = &f->to->layout;
    size_t n_velocities = 0, n_arcs = 0;

    for (size_t k = 0; k < f->s->n_belts; k++) {
        bool is_new = true;
        for (size_t i = 0; i < k && is_new; i++)
            is_new = !is_straight(&f->s->belts[k]) || !is_straight(&f->s->belts[i]) ||
                     vec2_length(vec2_sub(f->s->belts[k].velocity, f->s->belts[i].velocity)) > 0.0;
        n_velocities += is_new ? (is_straight(&f->s->belts[k]) ? 1 : 2) : 0;
    }
    for (size_t k = 0; k < f->s->n_sections; k++) {
        if (!f->s->belts[k].arc.is_given)
            continue;
        n_arcs++;
        note_arc(f, &f->s->belts[k]);
    }
    const bool is_free = of->is_measured && of->n_plates == 0 && of->wall_angle.value == 0.0 &&
                         n_velocities == 1 && n_arcs == 0 && !has_slopes(f->s) && !f->is_moving;

    note_motions(f);
    for (size_t k = 0; k < f->s->n_feeds; k++) {
        const scene_feed *feed = &f->s->feeds[k];
        const bool is_list = feed->demand == SCENE_DEMAND_SCHEDULE;
        double batch = !is_list && feed->arrivals == SCENE_ARRIVALS_BATCH ? feed->batch_size : 1.0;
        for (size_t i = 0; is_list && i < feed->schedule.n && feed->schedule.counts != NULL; i++)
            batch = fmax(batch, feed->schedule.counts[i]);
        if (batch > 1.0)
            note(f, VALIDITY_BATCH, batch, "/feeds/%zu", k);
    }
    if (is_free)
        return;
    note_plates(f, of);
    note(f, VALIDITY_BELTS, (double)n_velocities, "/belts");
    note_count(f, VALIDITY_ARCS, n_arcs, "/belts");
    for (size_t k = 0; k < f->s->n_belts; k++)
        if (f->s->belts[k].incline != 0.0)
            note(f, VALIDITY_INCLINE, f->s->belts[k].incline * 180.0 / M_PI,
                 "/belts/%zu/incline_deg", k);
    for (size_t k = 0; k < f->s->n_belts; k++) {
        const vec2 a = f->s->belts[k].velocity;
        for (size_t i = 0; i < k; i++) {
            const vec2 b = f->s->belts[i].velocity;
            const double turn = atan2(fabs(vec2_cross(a, b)), vec2_dot(a, b)) * 180.0 / M_PI;
            const double ratio = vec2_length(a) / vec2_length(b);
            if (vec2_length(a) == 0.0 || vec2_length(b) == 0.0)
                continue;
            if (turn > ROUNDING && is_straight(&f->s->belts[k]) && is_straight(&f->s->belts[i]))
                note(f, VALIDITY_TURN, turn, "/belts/%zu/velocity_m_s", k);
            if (fabs(ratio - 1.0) > ROUNDING)
                note(f, VALIDITY_RATIO, fmax(ratio, 1.0 / ratio), "/belts/%zu/velocity_m_s", k);
        }
    }
    for (size_t k = 0; k < f->s->n_belts && n_velocities > 1 && f->s->n_feeds > 0; k++)
        note(f, VALIDITY_TRANSFER, 100.0 * f->rate / belt_capacity(f->s, &f->s->belts[k]),
             "/belts/%zu", k);
    static const char *const sides[SCENE_SIDE_COUNT] = { [SCENE_WEST] = "west",
                                                         [SCENE_EAST] = "east",
                                                         [SCENE_SOUTH] = "south",
                                                         [SCENE_NORTH] = "north" };
    note(f, VALIDITY_WALL, of->wall_angle.value, "/edges/%s", sides[of->wall_angle.index]);
    note_heap(f, of);
    note_speeds(f);
    note(f, VALIDITY_ACCELERATION, diameters_to_speed(f), "/belts");
    note_cargo(f);
    note_frictions(f);
    note_constants(f);
    note_grid(f);
}

bf_status validity__measure(const scene *s, validity__findings *to, bf_error *err)
{
    measures f = { .s = s, .to = to, .diameter = 2.0 * mix_radii_of(s).largest };

    bf_status status = sum_feeds(&f, err);
    if (status == BF_OK)
        status = layout_measure(s, &to->layout, err);
    if (status == BF_OK)
        status = note_swept(&f, err);
    if (status == BF_OK)
        status = review_belts(s, &to->falls, err);
    if (status != BF_OK)
        return status;
    note_count(&f, VALIDITY_FALLS, to->falls.n, to->falls.items[0].pointer);
    note_figures(&f);
    return BF_OK;
}
