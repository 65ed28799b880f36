// The checks of feeds: first their own members, then, where nothing else is wrong, where they lie.

#include "core/base/polygon.h"
#include "core/scene/feed_line.h"
#include "core/scene/mix.h"
#include "core/scene/plate_pieces.h"
#include "core/scene/plate_range.h"
#include "core/scene/ranges.h"
#include "core/scene/scene_priv.h"
#include "core/scene/surroundings.h"

#include <math.h>
#include <stdio.h>

enum {
    SWINGS_MAX = 720, ///< angles at which a plate that turns is looked at, or places on a line
    MOVES_MAX = 26,   ///< of each where it turns and is shifted, or is shifted along several lines
    POINTS = 101,     ///< of a line that belts are looked for under
    PLACES = 501,     ///< of a line at which plates may leave no room
    NEAR_MAX =
        64, ///< pieces of plates near a line, beyond which room beside them is not looked for
};

static const char *const side_words[SCENE_SIDE_COUNT] = { "west", "east", "south", "north" };

static const char *point_at(size_t feed, const char *member, char *room, size_t size)
{
    snprintf(room, size, "/feeds/%zu%s", feed, member);
    return room;
}

/// The member that says where on its side, or inside, a feed lies.
static const char *line_member(const scene_feed *f)
{
    if (!f->is_edge)
        return "/line_m";
    return f->edge == SCENE_WEST || f->edge == SCENE_EAST ? "/y_m" : "/x_m";
}

static void check_whole(uint32_t n, size_t most, const char *feed, const char *member,
                        bf_faults *faults)
{
    char at[2 * BF_POINTER_SIZE];

    snprintf(at, sizeof at, "%s/%s", feed, member);
    if (n < scene_range_count.minimum)
        faults_add(faults, at, "must be at least %g", scene_range_count.minimum);
    else if (n > most)
        faults_add_limit(faults, at, "is %u, the limit is %zu", n, most);
}

static void check_mix(const scene *s, const scene_feed *f, const char *feed, bf_faults *faults)
{
    char at[2 * BF_POINTER_SIZE];
    bool is_there[SCENE_KINDS_MAX] = { false };

    snprintf(at, sizeof at, "%s/cargo", feed);
    if (f->n_cargo < 1 || f->n_cargo > SCENE_KINDS_MAX) {
        faults_add_limit(faults, at, "%zu kinds, the limits are 1 and %d", f->n_cargo,
                         SCENE_KINDS_MAX);
        return;
    }
    for (size_t k = 0; k < f->n_cargo; k++) {
        const uint32_t kind = f->cargo[k].kind;
        snprintf(at, sizeof at, "%s/cargo/%zu/kind", feed, k);
        if (kind >= s->n_cargo)
            faults_add(faults, at, "must be the id of a kind of cargo");
        else if (is_there[kind])
            faults_add(faults, at, "'%s' is there already", s->cargo[kind].id);
        if (kind < s->n_cargo)
            is_there[kind] = true;
        snprintf(at, sizeof at, "%s/cargo/%zu/share", feed, k);
        range_check(&scene_range_share, f->cargo[k].share, at, faults);
    }
}

/// What is wrong with entry k of a list of arrivals; NULL: nothing.
static const char *entry_fault(const scene *s, const scene_arrival_list *l, size_t k,
                               const char **ret_member)
{
    *ret_member = "count";
    if (l->counts != NULL && l->counts[k] < scene_range_count.minimum)
        return "must be at least 1";
    *ret_member = "kind";
    if (l->kinds != NULL && l->kinds[k] >= s->n_cargo)
        return "must be the id of a kind of cargo";
    *ret_member = "place";
    if (l->places != NULL && !isnan(l->places[k]) &&
        !(l->places[k] >= scene_range_place.minimum && l->places[k] <= scene_range_place.maximum))
        return "must be from 0 to 1";
    *ret_member = "heading_deg";
    if (l->headings != NULL && isinf(l->headings[k]))
        return "must be a number";
    return NULL;
}

static void check_schedule(const scene *s, const scene_arrival_list *l, const char *feed,
                           bf_faults *faults)
{
    const size_t n_before = faults->n;
    const char *member;
    char at[2 * BF_POINTER_SIZE];

    snprintf(at, sizeof at, "%s/schedule", feed);
    if (l->n < 1 || l->n > SCENE_SERIES_MAX) {
        faults_add_limit(faults, at, "%zu arrivals, the limits are 1 and %d", l->n,
                         SCENE_SERIES_MAX);
        return;
    }
    snprintf(at, sizeof at, "%s/schedule/t_s", feed);
    scene__check_times(l->times, l->n, at, true, faults);
    for (size_t k = 0; k < l->n && faults->n < n_before + REPORTED_MAX; k++) {
        const char *text = entry_fault(s, l, k, &member);
        snprintf(at, sizeof at, "%s/schedule/%s/%zu", feed, member, k);
        if (text != NULL)
            faults_add(faults, at, "%s", text);
    }
}

static void check_demand(const scene *s, const scene_feed *f, const char *feed, bf_faults *faults)
{
    char at[BF_POINTER_SIZE + ROOM_FOR_INDEX];

    switch (f->demand) {
    case SCENE_DEMAND_RATE:
        snprintf(at, sizeof at, "%s/rate_per_s", feed);
        range_check(&scene_range_rate, f->rate, at, faults);
        break;
    case SCENE_DEMAND_PROFILE:
        snprintf(at, sizeof at, "%s/profile", feed);
        if (f->profile.n_times == 0)
            faults_add(faults, at, "must have a time");
        else
            scene__check_series(&f->profile, at, "rate_per_s", &scene_range_profile, faults);
        break;
    case SCENE_DEMAND_SCHEDULE:
        check_schedule(s, &f->schedule, feed, faults);
        break;
    default:
        faults_add(faults, feed, "must have rate_per_s, profile or schedule");
    }
}

static void check_line(const scene *s, size_t k, bf_faults *faults)
{
    const scene_feed *f = &s->feeds[k];
    char room[BF_POINTER_SIZE];
    const char *pointer = point_at(k, line_member(f), room, sizeof room);

    if (!f->is_edge) {
        if (scene__check_points(f->line, 2, pointer, false, faults) &&
            !(surroundings_is_inside(&s->domain, f->line[0]) &&
              surroundings_is_inside(&s->domain, f->line[1])))
            faults_add(faults, pointer, "must lie in the domain");
    } else if ((unsigned)f->edge >= SCENE_SIDE_COUNT) {
        faults_add(faults, point_at(k, "/edge", room, sizeof room), "is not a side");
    } else if (s->edges[f->edge] != SCENE_EDGE_INFLOW) {
        faults_add(faults, point_at(k, "/edge", room, sizeof room),
                   "the side %s is %s: parts enter over an inflow", side_words[f->edge],
                   s->edges[f->edge] == SCENE_EDGE_WALL ? "a wall" : "an outflow");
    } else {
        // Part of a side: [from, to] within it.
        const bool is_along_y = f->edge == SCENE_WEST || f->edge == SCENE_EAST;
        const double from = is_along_y ? f->line[0].y : f->line[0].x;
        const double to = is_along_y ? f->line[1].y : f->line[1].x;
        const double low = is_along_y ? s->domain.y_min : s->domain.x_min;
        const double high = is_along_y ? s->domain.y_max : s->domain.x_max;
        if (!(from >= low && to <= high && to - from > SCENE_LENGTH_MIN))
            faults_add(
                faults, pointer,
                "must be [from, to] with from < to, within the side from %g to %g m, not [%g, %g]",
                low, high, from, to);
    }
}

void scene__check_feeds(const scene *s, bf_faults *faults)
{
    static const number_rule rules[] = {
        RULE("/start_s", scene_feed, start, scene_range_instant),
        RULE("/max_wait_s", scene_feed, max_wait, scene_range_instant),
    };
    char feed[BF_POINTER_SIZE], at[2 * BF_POINTER_SIZE];

    if (!scene__check_count(s->n_feeds, SCENE_FEEDS_MAX, "/feeds", "feeds", faults))
        return;
    for (size_t k = 0; k < s->n_feeds; k++) {
        const scene_feed *f = &s->feeds[k];
        scene__check_id(s->feeds, sizeof *s->feeds, "feeds", k, faults);
        snprintf(feed, sizeof feed, "/feeds/%zu", k);
        check_line(s, k, faults);
        scene__check_numbers(f, feed, rules, sizeof rules / sizeof *rules, faults);
        snprintf(at, sizeof at, "%s/end_s", feed);
        if (f->end != INFINITY)
            range_check(&scene_range_time, f->end, at, faults);
        if (!(f->end > f->start))
            faults_add(faults, at, "must be after start_s, %.15g s, not %.15g s", f->start, f->end);
        snprintf(at, sizeof at, "%s/count", feed);
        scene__check_limit(f->count, at, faults);
        snprintf(at, sizeof at, "%s/arrivals", feed);
        if ((unsigned)f->arrivals >= SCENE_ARRIVALS_COUNT)
            faults_add(faults, at, "is not a kind of arrivals");
        snprintf(at, sizeof at, "%s/when_blocked", feed);
        if ((unsigned)f->when_blocked >= SCENE_BLOCKED_COUNT)
            faults_add(faults, at, "is not a rule");
        snprintf(at, sizeof at, "%s/heading_deg", feed);
        if (!isfinite(f->heading))
            faults_add(faults, at, "must be a number");
        snprintf(at, sizeof at, "%s/seed", feed);
        if ((double)f->seed > scene_range_seed.maximum)
            faults_add(faults, at, "must be below 2^53");
        check_whole(f->shape, SCENE_STAGES_MAX, feed, "shape", faults);
        check_whole(f->batch_size, SCENE_PARTS_MAX, feed, "batch_size", faults);
        check_demand(s, f, feed, faults);
        check_mix(s, f, feed, faults);
    }
}

// ---- where feeds lie

/// Belts under the line must carry parts away from it; over a side, inward. pointer is that of the line, as below.
static void check_belts(const scene *s, const surroundings *around, const scene_feed *f,
                        const char *pointer, bf_faults *faults)
{
    for (int k = 0; k < POINTS; k++) {
        const vec2 at = feed_line_at(f, (double)k / (POINTS - 1));
        const size_t belt = surroundings_belt_below(around, at); // no part enters over a gap
        if (belt == around->n_belts) {
            faults_add(faults, pointer, "lies off every belt at (%g, %g) m", at.x, at.y);
            return;
        }
        if (s->belts[belt].arc.is_given) {
            faults_add(faults, pointer,
                       "lies on the arc '%s' at (%g, %g) m: parts must enter on a straight belt",
                       s->belts[belt].id, at.x, at.y);
            return;
        }
        if (f->is_edge && !(vec2_dot(surroundings_side(around, f->edge).inward,
                                     belt_velocity(&s->belts[belt], at)) > 0.0)) {
            faults_add(faults, pointer, "the belt '%s' does not move inward at (%g, %g) m",
                       s->belts[belt].id, at.x, at.y);
            return;
        }
    }
}

/// True if the feed may deliver a kind.
static bool delivers(const scene_feed *f, uint32_t kind)
{
    bool is_in_mix = false;

    for (size_t k = 0; k < f->n_cargo; k++)
        is_in_mix = is_in_mix || f->cargo[k].kind == kind;
    if (f->demand != SCENE_DEMAND_SCHEDULE || f->schedule.kinds == NULL)
        return is_in_mix;
    for (size_t k = 0; k < f->schedule.n; k++) {
        if (f->schedule.kinds[k] == kind)
            return true;
    }
    return false;
}

/// The pieces of plates that a part on a line may touch.
typedef struct near_plates {
    size_t n;                 ///< NEAR_MAX: there may be more
    vec2 pieces[NEAR_MAX][4]; ///< corners of each
} near_plates;

/// True if a part of a footprint has a place on the line between walls and plates.
static bool has_place(const surroundings *around, const scene_feed *f, const near_plates *near,
                      const shape_footprint *footprint)
{
    const feed_line_span span = feed_line_usable(around, f, footprint, f->heading);

    if (near->n == 0 || near->n == NEAR_MAX)
        return span.low <= span.high;
    for (int k = 0; k < PLACES && span.low <= span.high; k++) {
        const double place = span.low + (span.high - span.low) * (double)k / (PLACES - 1);
        const vec2 at = feed_line_at(f, place);
        const scene_pose pose = { at.x, at.y, f->heading };
        size_t free_of = 0;
        while (free_of < near->n &&
               !shape_overlaps_polygon(footprint, pose, near->pieces[free_of], 4))
            free_of++;
        if (free_of == near->n)
            return true;
    }
    return false;
}

/// The line must have a place for every kind, whatever its heading.
static void check_room(const scene *s, const surroundings *around, const scene_feed *f,
                       const shape_footprint *footprints, const char *pointer, bf_faults *faults)
{
    const bool has_one_heading = !f->has_random_heading && (f->demand != SCENE_DEMAND_SCHEDULE ||
                                                            f->schedule.headings == NULL);
    near_plates near = { .n = 0 };
    vec2 on_line, on_plate;

    const double range = mix_radii_of(s).largest;
    for (size_t k = 0; k < s->n_obstacles; k++) {
        for (size_t m = 0; m + 1 < s->obstacles[k].n_points && near.n < NEAR_MAX; m++) {
            vec2 *plate = near.pieces[near.n];
            if (plate_pieces_get(around, &s->obstacles[k], m, plate) &&
                polygon_distance(f->line, 2, plate, 4, &on_line, &on_plate) < range)
                near.n++;
        }
    }
    for (uint32_t kind = 0; kind < s->n_cargo; kind++) {
        const shape_footprint disk = { .bounding_radius = footprints[kind].bounding_radius };
        if (!delivers(f, kind) ||
            has_place(around, f, &near, has_one_heading ? &footprints[kind] : &disk))
            continue;
        faults_add(faults, pointer, "has no room between walls and plates for a part of '%s'",
                   s->cargo[kind].id);
        return;
    }
}

/// Where parts come from: the line, over a side with what lies less than a radius behind it. Both ends without a
/// radius: there, plates may guide what enters. Returns the number of corners.
static size_t place_inlet(const surroundings *around, const scene_feed *f, double radius,
                          vec2 ret_corners[5])
{
    const double cut = fmin(radius / vec2_length(vec2_sub(f->line[1], f->line[0])), 0.49);
    const vec2 first = feed_line_at(f, cut), last = feed_line_at(f, 1.0 - cut);

    ret_corners[0] = first;
    ret_corners[1] = last;
    if (!f->is_edge)
        return 2;
    const vec2 behind = vec2_scale(surroundings_side(around, f->edge).inward, radius);
    vec2 corners[] = { first, last, vec2_add(first, behind), vec2_add(last, behind) };
    return polygon_convex_hull(corners, 4, ret_corners);
}

/// Whether a plate meets an inlet, with a displacement.
static bool stands_on(const surroundings *around, const scene_obstacle *o, const vec2 *inlet,
                      size_t n, plate_displacement displacement)
{
    vec2 plate[4];

    for (size_t m = 0; m + 1 < o->n_points; m++) {
        plate_pieces_placed(around, o, m, displacement, plate);
        if (polygon_overlaps(inlet, n, plate, 4, SCENE_TOLERANCE))
            return true;
    }
    return false;
}

/// How many steps of a length lie on a way, at most some.
static int steps_on(double way, double step, int most)
{
    return (int)fmin(ceil(way / step), (double)most);
}

/// Whether a plate meets an inlet at an angle and a shift of its range, looked for in steps by which its ends move by less than
/// `step`, m, where SWINGS_MAX and MOVES_MAX allow so many. Shifts are those of a line, or of the box that they span.
static bool moves_onto(const surroundings *around, const scene_obstacle *o, const vec2 *inlet,
                       size_t n, const plate_range *r, double step)
{
    const double radius = plate_range_radius(o);
    const vec2 from = r->is_line ? r->ends[0] : r->low, to = r->is_line ? r->ends[1] : r->high;
    const double along = r->is_line ? vec2_length(vec2_sub(to, from)) : to.x - from.x;
    const bool is_shifted = along > 0.0 || !r->is_line;
    const int n_angles =
        steps_on((r->most - r->least) * radius, step, is_shifted ? MOVES_MAX : SWINGS_MAX);
    const int n_along = steps_on(along, step, r->is_line ? SWINGS_MAX : MOVES_MAX);
    const int n_across = r->is_line ? 0 : steps_on(to.y - from.y, step, MOVES_MAX);
    double distance = (double)INFINITY;

    for (size_t k = 0; k < n; k++)
        distance = fmin(distance, polygon_segment_distance(o->pivot, inlet[k], inlet[(k + 1) % n]));
    if (distance > radius + step + fmax(vec2_length(r->low), vec2_length(r->high)))
        return false;
    for (int k = 0; k <= n_angles; k++)
        for (int i = 0; i <= n_along; i++)
            for (int j = 0; j <= n_across; j++) {
                const double u = i / fmax(n_along, 1.0),
                             v = r->is_line ? u : j / fmax(n_across, 1.0);
                const plate_displacement displacement = {
                    r->least + (r->most - r->least) * k / fmax(n_angles, 1.0),
                    { from.x + (to.x - from.x) * u, from.y + (to.y - from.y) * v }
                };
                if (stands_on(around, o, inlet, n, displacement))
                    return true;
            }
    return false;
}

/// Plates must not stand on the line at the start, nor move onto it.
static void check_plates(const scene *s, const surroundings *around, const scene_feed *f,
                         double radius, const char *pointer, bf_faults *faults)
{
    vec2 plate[4], inlet[5];
    const size_t n = place_inlet(around, f, radius, inlet);

    for (size_t k = 0; k < s->n_obstacles; k++) {
        for (size_t m = 0; m + 1 < s->obstacles[k].n_points; m++) {
            if (!plate_pieces_get(around, &s->obstacles[k], m, plate) ||
                !polygon_overlaps(inlet, n, plate, 4, SCENE_TOLERANCE))
                continue;
            faults_add(faults, pointer, "runs into the plate of obstacle '%s'", s->obstacles[k].id);
            return;
        }
    }
    for (size_t k = 0; k < s->n_obstacles; k++) {
        const plate_range range = plate_range_of(s->obstacles, k, s->n_actions, s->actions);
        if (!range.moves || !moves_onto(around, &s->obstacles[k], inlet, n, &range, 0.5 * radius))
            continue;
        faults_add(faults, pointer, "the plate of obstacle '%s' moves onto it", s->obstacles[k].id);
        return;
    }
}

/// Feeds on one side may share an end, others must not touch.
static bool are_apart(const scene_feed *a, const scene_feed *b)
{
    if (!a->is_edge || !b->is_edge)
        return !polygon_segments_touch(a->line[0], a->line[1], b->line[0], b->line[1],
                                       SCENE_TOLERANCE);
    // Two sides meet in a corner at most.
    return a->edge != b->edge || a->line[1].x + a->line[1].y <= b->line[0].x + b->line[0].y ||
           b->line[1].x + b->line[1].y <= a->line[0].x + a->line[0].y;
}

void scene__check_feed_lines(const scene *s, bf_faults *faults)
{
    shape_footprint footprints[SCENE_KINDS_MAX];
    const double radius = mix_radii_of(s).smallest;
    const surroundings around = surroundings_of(s);
    char room[BF_POINTER_SIZE];

    mix_footprints(s, footprints);
    for (size_t k = 0; k < s->n_feeds; k++) {
        const scene_feed *f = &s->feeds[k];
        const char *pointer = point_at(k, line_member(f), room, sizeof room);
        size_t other = 0;
        check_belts(s, &around, f, pointer, faults);
        check_room(s, &around, f, footprints, pointer, faults);
        check_plates(s, &around, f, radius, pointer, faults);
        while (other < k && are_apart(&s->feeds[other], f))
            other++;
        if (other < k)
            faults_add(faults, pointer, "overlaps the feed '%s'", s->feeds[other].id);
    }
}
