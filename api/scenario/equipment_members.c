// Belts, obstacles, photo eyes, sinks, actions and merges as tables.

#include "api/scenario/scenario_members.h"
#include "api/scenario/scenario_priv.h"
#include "core/scene/ranges.h"
#include "core/scene/scene.h"

#include <jansson.h>
#include <math.h>
#include <string.h>

static const char *const treatment_words[] = { "sealed", "field", "wall", NULL };
static const char *const state_words[] = { "clear", "blocked", NULL };
HAS_WORDS(treatment_words, SCENE_TREATMENT_COUNT);

static void init_belt(void *item, size_t place)
{
    (void)place;
    scene_belt_init(item);
}

static void init_obstacle(void *item, size_t place)
{
    (void)place;
    scene_obstacle_init(item);
}

static void init_photo_eye(void *item, size_t place)
{
    (void)place;
    scene_photo_eye_init(item);
}

static void init_sink(void *item, size_t place)
{
    (void)place;
    scene_sink_init(item);
}

static void init_action(void *item, size_t place)
{
    (void)place;
    scene_action_init(item);
}

static void init_lane(void *item, size_t place)
{
    (void)place;
    scene_lane_init(item);
}

static void init_merge(void *item, size_t place)
{
    (void)place;
    scene_merge_init(item);
}

#define AT(place) offsetof(scene_speed_schedule, place)
static const member speed_schedule_members[] = {
    MEMBER("t_s", numbers, AT(times), "from which on a factor is the target, rising", .unit = "s",
           .offset_n = AT(n_times), .range = &scene_range_instant, .least = 1,
           .limit = SCENE_SPEEDS_MAX),
    MEMBER("factor", numbers, AT(factors),
           "of velocity_m_s, one for each time; 0: it stands, below 0: it runs backwards",
           .offset_n = AT(n_factors), .range = &scene_range_speed_factor, .least = 1,
           .limit = SCENE_SPEEDS_MAX),
};
static const member_table speed_schedule_table = {
    MEMBER_TABLE("speedSchedule", speed_schedule_members), .size = sizeof(scene_speed_schedule)
};
#undef AT

static const char *const time_law_words[] = { "exponential", "weibull", "fixed", NULL };
HAS_WORDS(time_law_words, SCENE_TIME_LAW_COUNT);

static void init_failure(void *item, size_t place)
{
    (void)place;
    *(scene_failure *)item =
        (scene_failure){ .between = { .shape = 1.0 }, .repair = { .shape = 1.0 } };
}

static void init_break(void *item, size_t place)
{
    (void)place;
    *(scene_break *)item = (scene_break){ .every = INFINITY };
}

static const char *const drawn_form[] = { "mtbf_s", "mtbf_distribution", "mtbf_shape",
                                          "mttr_s", "mttr_distribution", "mttr_shape",
                                          NULL };
static const char *const listed_form[] = { "t_s", "duration_s", NULL };
static const char *const *const failure_forms[] = { [SCENE_FAILURE_DRAWN] = drawn_form,
                                                    [SCENE_FAILURE_LISTED] = listed_form,
                                                    [SCENE_FAILURE_COUNT] = NULL };

#define AT(place) offsetof(scene_failure, place)
static bool has_no_between_shape(const void *item)
{
    return ((const scene_failure *)item)->between.law != SCENE_TIME_WEIBULL;
}

static bool has_no_repair_shape(const void *item)
{
    return ((const scene_failure *)item)->repair.law != SCENE_TIME_WEIBULL;
}

// A shape that says nothing would be lost without a word.
static void check_shape(json_in *in, const struct json_t *object, const char *name, bool is_used)
{
    const size_t mark = json_pointer_enter(&in->pointer, name, strlen(name));

    if (!is_used && json_object_get(object, name) != NULL)
        json_in_fault(in, "is of a Weibull distribution, and this is none");
    json_pointer_leave(&in->pointer, mark);
}

static void check_shapes(json_in *in, const struct json_t *object, void *item)
{
    check_shape(in, object, "mtbf_shape", !has_no_between_shape(item));
    check_shape(in, object, "mttr_shape", !has_no_repair_shape(item));
}

static const member failure_members[] = {
    MEMBER("id", text, AT(id), "its name", .default_text = "failure-1, failure-2, ...", .least = 1,
           .limit = SCENE_ID_SIZE),
    MEMBER("mtbf_s", number, AT(between.mean),
           "first form: mean operating time from a repair, or the start, to the next failure",
           .unit = "s", .range = &scene_range_time),
    MEMBER("mtbf_distribution", enum, AT(between.law), "of these times", .words = time_law_words,
           .flags = MEMBER_INIT),
    MEMBER("mtbf_shape", number, AT(between.shape), "of a Weibull distribution",
           .range = &scene_range_weibull_shape, .flags = MEMBER_INIT | MEMBER_OMIT_EMPTY,
           .is_empty = has_no_between_shape),
    MEMBER("mttr_s", number, AT(repair.mean), "first form: mean time to repair", .unit = "s",
           .range = &scene_range_time),
    MEMBER("mttr_distribution", enum, AT(repair.law), "of these times", .words = time_law_words,
           .flags = MEMBER_INIT),
    MEMBER("mttr_shape", number, AT(repair.shape), "of a Weibull distribution",
           .range = &scene_range_weibull_shape, .flags = MEMBER_INIT | MEMBER_OMIT_EMPTY,
           .is_empty = has_no_repair_shape),
    MEMBER("t_s", numbers, AT(times), "second form: when each failure begins, rising", .unit = "s",
           .offset_n = AT(n_times), .range = &scene_range_instant, .least = 1,
           .limit = SCENE_STOPS_MAX),
    MEMBER("duration_s", numbers, AT(durations), "second form: how long each one lasts",
           .unit = "s", .offset_n = AT(n_durations), .range = &scene_range_time, .least = 1,
           .limit = SCENE_STOPS_MAX),
};
static const member_table failure_table = { MEMBER_TABLE("failure", failure_members),
                                            .size = sizeof(scene_failure),
                                            .init = init_failure,
                                            .post_read = check_shapes,
                                            .choice = MEMBER_ONE_FORM,
                                            .offset_choice = AT(type),
                                            .forms = failure_forms };
#undef AT

#define AT(place) offsetof(scene_break, place)
static const member break_members[] = {
    MEMBER("start_s", number, AT(start), "when the first one begins", .unit = "s",
           .range = &scene_range_instant),
    MEMBER("duration_s", number, AT(duration), "how long each one lasts", .unit = "s",
           .range = &scene_range_time),
    MEMBER("every_s", number, AT(every), "from the start of one to that of the next", .unit = "s",
           .range = &scene_range_time, .flags = MEMBER_OMIT_EMPTY, .default_text = "there is one"),
};
static const member_table break_table = { MEMBER_TABLE("break", break_members),
                                          .size = sizeof(scene_break), .init = init_break };
#undef AT

#define AT(place) offsetof(scene_belt, place)
static bool has_no_path(const void *item)
{
    return ((const scene_belt *)item)->path.n_points == 0;
}

// The arcs of a path follow from it.
static bool has_no_arc(const void *item)
{
    return !((const scene_belt *)item)->arc.is_given || !has_no_path(item);
}

static bool has_no_friction(const void *item)
{
    return ((const scene_belt *)item)->friction == 0.0;
}

static bool has_no_polygon(const void *item)
{
    const scene_belt *belt = item;

    return belt->arc.is_given || belt->n_points == 0 || !has_no_path(item);
}

static void note_arc(json_in *in, const struct json_t *object, void *item)
{
    (void)in;
    (void)object;
    ((scene_belt *)item)->arc.is_given = true;
}

static void check_no_other(json_in *in, const char *name, bool is_given, const char *other)
{
    const size_t mark = json_pointer_enter(&in->pointer, name, strlen(name));

    if (is_given && other != NULL)
        json_in_fault(in, "is another outline beside %s", other);
    json_pointer_leave(&in->pointer, mark);
}

// The outline of an arc, or of a path, is that of its own members.
static void check_outline(json_in *in, const struct json_t *object, void *item)
{
    const scene_belt *belt = item;
    const char *polygon = belt->n_points > 0 ? "polygon_m" : NULL;

    (void)object;
    check_no_other(in, "arc", belt->arc.is_given, polygon);
    check_no_other(in, "path", belt->path.n_points > 0, belt->arc.is_given ? "arc" : polygon);
}

static const member arc_members[] = {
    MEMBER("centre_m", point, AT(centre), "about which it turns", .unit = "m"),
    MEMBER("inner_radius_m", number, AT(arc.inner_radius), "of its inner border", .unit = "m",
           .range = &scene_range_length),
    MEMBER("outer_radius_m", number, AT(arc.outer_radius), "of its outer border", .unit = "m",
           .range = &scene_range_length),
    MEMBER("from_deg", degrees, AT(arc.from), "where it begins, counter-clockwise from the x axis",
           .unit = "deg"),
    MEMBER("to_deg", degrees, AT(arc.to),
           "where it ends: above from_deg it turns counter-clockwise, below it clockwise",
           .unit = "deg"),
    MEMBER("reference_radius_m", number, AT(arc.reference_radius),
           "at which it has the speed of velocity_m_s", .unit = "m", .range = &scene_range_length,
           .default_text = "the mean of both radii"),
};
static const member_table arc_table = { MEMBER_TABLE("arc", arc_members),
                                        .size = sizeof(scene_belt), .init = init_belt,
                                        .post_read = note_arc };

static const member path_members[] = {
    MEMBER("points_m", points, AT(path.points),
           "corners of its centre line, in the direction in which it moves", .unit = "m",
           .offset_n = AT(path.n_points), .least = 2, .limit = SCENE_PATH_MAX),
    MEMBER("radius_m", numbers, AT(path.radii),
           "of the centre line at each corner between the first and the last one", .unit = "m",
           .offset_n = AT(path.n_radii), .range = &scene_range_length, .limit = SCENE_PATH_MAX,
           .flags = MEMBER_OMIT_EMPTY, .default_text = "none, where there are two points"),
    MEMBER("width_m", number, AT(path.width), "of the belt", .unit = "m",
           .range = &scene_range_length),
};
static const member_table path_table = { MEMBER_TABLE("beltPath", path_members),
                                         .size = sizeof(scene_belt), .init = init_belt };

static const member belt_members[] = {
    MEMBER("id", text, AT(id), "its name", .default_text = "main, belt-2, ...", .least = 1,
           .limit = SCENE_ID_SIZE),
    MEMBER("velocity_m_s", point, AT(velocity),
           "of the surface; of an arc or a path only its size counts", .unit = "m/s",
           .flags = MEMBER_INIT),
    MEMBER("friction", step, AT(friction), "of cargo on it, mu",
           .range = &scene_range_belt_friction, .flags = MEMBER_OMIT_EMPTY,
           .is_empty = has_no_friction, .default_text = "auto"),
    MEMBER("incline_deg", degrees, AT(incline),
           "by which it rises in the direction of velocity_m_s; below 0 it falls", .unit = "deg",
           .flags = MEMBER_INIT | MEMBER_OMIT_DEFAULT),
    MEMBER("acceleration_m_s2", number, AT(acceleration), "of ramps to a higher speed",
           .unit = "m/s2", .range = &scene_range_acceleration, .flags = MEMBER_OMIT_EMPTY,
           .default_text = "at once"),
    MEMBER("deceleration_m_s2", number, AT(deceleration), "of ramps to a lower speed",
           .unit = "m/s2", .range = &scene_range_acceleration, .flags = MEMBER_OMIT_EMPTY,
           .default_text = "at once"),
    MEMBER("speed_schedule", object, AT(speed_schedule), "how its speed changes in time",
           .table = &speed_schedule_table, .offset_n = AT(speed_schedule.n_times),
           .flags = MEMBER_OMIT_EMPTY, .default_text = "factor 1 at all times"),
    MEMBER("failures", list, AT(stops.failures), "kinds of its breakdowns and micro-stops",
           .table = &failure_table, .offset_n = AT(stops.n_failures), .least = 1,
           .limit = SCENE_FAILURES_MAX, .flags = MEMBER_OMIT_EMPTY,
           .default_text = "it does not fail"),
    MEMBER("breaks", list, AT(stops.breaks), "planned stops: breaks, and times between shifts",
           .table = &break_table, .offset_n = AT(stops.n_breaks), .least = 1,
           .limit = SCENE_BREAKS_MAX, .flags = MEMBER_OMIT_EMPTY, .default_text = "none"),
    MEMBER("polygon_m", points, AT(polygon), "corners of a simple polygon", .unit = "m",
           .offset_n = AT(n_points), .least = 3, .limit = SCENE_POINTS_MAX,
           .flags = MEMBER_OMIT_EMPTY, .is_empty = has_no_polygon, .default_text = "the domain"),
    MEMBER("arc", object, 0,
           "a curve: its outline, a sector of a ring, which turns about its centre",
           .table = &arc_table, .flags = MEMBER_OMIT_EMPTY, .is_empty = has_no_arc,
           .default_text = "the belt is straight"),
    MEMBER("path", object, 0, "a line of straights and arcs: its outline, along which it moves",
           .table = &path_table, .flags = MEMBER_OMIT_EMPTY, .is_empty = has_no_path,
           .default_text = "the belt is straight"),
};
const member_table scenario__belt_members = { MEMBER_TABLE("belt", belt_members),
                                              .size = sizeof(scene_belt), .init = init_belt,
                                              .post_read = check_outline };
#undef AT

// What moves an obstacle. A pivot is all there is where only actions turn it.
#define AT(place) offsetof(scene_obstacle, place)
static bool has_no_motion(const void *item)
{
    const scene_obstacle *o = item;
    bool has_pivot = o->n_points > 0 && (o->pivot.x != o->path[0].x || o->pivot.y != o->path[0].y);

    return o->turn.n_times == 0 && !has_pivot;
}

// A schedule that only shifts it has angles, too, once it is resolved.
static bool has_no_turn(const void *item)
{
    const scene_obstacle *o = item;
    bool is_turned = o->n_shifts == 0 && o->turn.n_values > 0;

    for (size_t k = 0; k < o->turn.n_values; k++)
        is_turned = is_turned || o->turn.values[k] != 0.0;
    return !is_turned;
}

static const member motion_members[] = {
    MEMBER("pivot_m", point, AT(pivot), "about which it turns", .unit = "m",
           .default_text = "the start of its path"),
    MEMBER("t_s", numbers, AT(turn.times), "times of turn_deg and shift_m, rising", .unit = "s",
           .offset_n = AT(turn.n_times), .range = &scene_range_instant, .least = 1,
           .limit = SCENE_SERIES_MAX, .flags = MEMBER_OMIT_EMPTY,
           .default_text = "it moves by actions only"),
    MEMBER("turn_deg", angles, AT(turn.values),
           "by which its path is turned, counter-clockwise, one for each time; linear between",
           .unit = "deg", .offset_n = AT(turn.n_values), .least = 1, .limit = SCENE_SERIES_MAX,
           .flags = MEMBER_OMIT_EMPTY, .is_empty = has_no_turn,
           .default_text = "it turns by actions only"),
    MEMBER("shift_m", points, AT(shifts),
           "by which its path and its pivot are shifted, one for each time; linear between",
           .unit = "m", .offset_n = AT(n_shifts), .least = 1, .limit = SCENE_SERIES_MAX,
           .flags = MEMBER_OMIT_EMPTY, .default_text = "it is shifted by actions only"),
    MEMBER("repeat_s", number, AT(turn.repeat), "after which it begins again", .unit = "s",
           .range = &scene_range_time, .flags = MEMBER_OMIT_EMPTY, .default_text = "never"),
};
static const member_table motion_table = { MEMBER_TABLE("motion", motion_members),
                                           .size = sizeof(scene_obstacle), .init = init_obstacle };
#undef AT

#define AT(place) offsetof(scene_series, place)
static const member presence_members[] = {
    MEMBER("t_s", numbers, AT(times), "from which on a value applies, rising", .unit = "s",
           .offset_n = AT(n_times), .range = &scene_range_instant, .least = 1,
           .limit = SCENE_SERIES_MAX),
    MEMBER("value", flags, AT(values), "true: it stands there, one for each time",
           .offset_n = AT(n_values), .least = 1, .limit = SCENE_SERIES_MAX),
    MEMBER("repeat_s", number, AT(repeat), "after which it begins again", .unit = "s",
           .range = &scene_range_time, .flags = MEMBER_OMIT_EMPTY, .default_text = "never"),
};
static const member_table presence_table = { MEMBER_TABLE("presence", presence_members),
                                             .size = sizeof(scene_series) };
#undef AT

#define AT(place) offsetof(scene_obstacle, place)
static bool has_no_force_limit(const void *item)
{
    return ((const scene_obstacle *)item)->force_limit == 0.0;
}

static const member obstacle_members[] = {
    MEMBER("id", text, AT(id), "its name", .default_text = "obstacle-1, ...", .least = 1,
           .limit = SCENE_ID_SIZE),
    MEMBER("end_m", point, offsetof(obstacle_form, end), "first form: end of the upstream face",
           .unit = "m", .flags = MEMBER_FORM),
    MEMBER("angle_deg", number, offsetof(obstacle_form, angle),
           "first form: direction from start to end, from the x axis", .unit = "deg",
           .flags = MEMBER_FORM),
    MEMBER("length_m", number, offsetof(obstacle_form, length),
           "first form: of the upstream face, > 0", .unit = "m", .flags = MEMBER_FORM),
    MEMBER("from_m", point, offsetof(obstacle_form, from),
           "second form: start of the upstream face", .unit = "m", .flags = MEMBER_FORM),
    MEMBER("to_m", point, offsetof(obstacle_form, to), "second form: end of the upstream face",
           .unit = "m", .flags = MEMBER_FORM),
    MEMBER("path_m", points, AT(path), "third form: corners of the upstream face", .unit = "m",
           .offset_n = AT(n_points), .least = 2, .limit = SCENE_POINTS_MAX,
           .default_text = "from another form"),
    MEMBER("thickness_m", number, AT(thickness),
           "of the plate, downstream of its path; of a guide along the belt on both sides",
           .unit = "m", .range = &scene_range_length, .flags = MEMBER_INIT),
    MEMBER("treatment", enum, AT(treatment), "how the macroscopic model holds cargo",
           .words = treatment_words, .flags = MEMBER_INIT),
    MEMBER("band_m", number, AT(band), "width of the outward field (sealed)", .unit = "m",
           .range = &scene_range_length, .default_text = TEXT_OF(SCENE_BAND_FACTOR) "/sqrt(sigma)"),
    MEMBER("slide_width_m", number, AT(slide_width), "width of the slide zone", .unit = "m",
           .range = &scene_range_length,
           .default_text = TEXT_OF(SCENE_SLIDE_FACTOR) "/sqrt(sigma) if sealed, else " TEXT_OF(
               SCENE_SLIDE_WIDTH)),
    MEMBER("motion", object, 0, "how it turns and is shifted", .table = &motion_table,
           .flags = MEMBER_OMIT_EMPTY, .is_empty = has_no_motion,
           .default_text = "it does not move"),
    MEMBER("present", object, AT(presence), "when it stands there; before the first time it does",
           .table = &presence_table, .offset_n = AT(presence.n_times), .flags = MEMBER_OMIT_EMPTY,
           .default_text = "at all times"),
    MEMBER(
        "force_limit_n", step, AT(force_limit),
        "of what moves it, at the point farthest from its pivot, or along its shift: slower from "
        "half of it on, and stalled at it; auto: twice what turns it against a full belt",
        .unit = "N", .range = &scene_range_force_limit, .flags = MEMBER_OMIT_EMPTY,
        .is_empty = has_no_force_limit, .default_text = "auto"),
};
const member_table scenario_members_obstacle = {
    MEMBER_TABLE("obstacle", obstacle_members), .size = sizeof(scene_obstacle),
    .init = init_obstacle, .forms = obstacle_form__members, .post_read = obstacle_form__read
};
#undef AT

#define AT(place) offsetof(scene_photo_eye, place)
static const member photo_eye_members[] = {
    MEMBER("id", text, AT(id), "its name", .default_text = "eye-1, eye-2, ...", .least = 1,
           .limit = SCENE_ID_SIZE),
    MEMBER("line_m", line, AT(line), "ends of its beam", .unit = "m"),
    MEMBER("block_time_s", number, AT(block_time),
           "how long the beam is broken before the state is blocked", .unit = "s",
           .range = &scene_range_instant, .flags = MEMBER_INIT),
    MEMBER("clear_time_s", number, AT(clear_time),
           "how long the beam is free before the state is clear", .unit = "s",
           .range = &scene_range_instant, .flags = MEMBER_INIT),
    MEMBER("density_ratio", step, AT(density_ratio),
           "macroscopic model: the beam is broken where the largest density on it is at least "
           "this; auto: by the parts that cross it",
           .range = &scene_range_ratio, .flags = MEMBER_INIT),
};
const member_table scenario__photo_eye_members = { MEMBER_TABLE("photoEye", photo_eye_members),
                                                   .size = sizeof(scene_photo_eye),
                                                   .init = init_photo_eye };
#undef AT

#define AT(place) offsetof(scene_sink, place)
static const member sink_members[] = {
    MEMBER("id", text, AT(id), "its name", .default_text = "sink-1, sink-2, ...", .least = 1,
           .limit = SCENE_ID_SIZE),
    MEMBER("polygon_m", points, AT(polygon),
           "corners of a simple polygon: what has its centre in it is taken", .unit = "m",
           .offset_n = AT(n_points), .least = 3, .limit = SCENE_POINTS_MAX),
    MEMBER_OF("kinds", &scenario__kind_ids, AT(kinds), "ids of the kinds of cargo that it takes",
              .offset_n = AT(n_kinds), .least = 1, .limit = SCENE_KINDS_MAX,
              .flags = MEMBER_OMIT_EMPTY, .default_text = "all"),
    MEMBER("rate_per_s", number, AT(rate), "parts that it takes at most", .unit = "1/s",
           .range = &scene_range_rate, .flags = MEMBER_OMIT_EMPTY, .default_text = "no limit"),
};
const member_table scenario__sink_members = { MEMBER_TABLE("sink", sink_members),
                                              .size = sizeof(scene_sink), .init = init_sink };
#undef AT

#define AT(place) offsetof(scene_action, place)
static bool has_no_kind(const void *item)
{
    return ((const scene_action *)item)->kind == SCENE_KIND_ANY;
}

static const member when_members[] = {
    MEMBER_OF("photo_eye", &scenario__photo_eye_id, AT(eye), "id of the photo eye"),
    MEMBER("state", either, AT(when_blocked), "the state that begins", .words = state_words),
    MEMBER_OF("kind", &scenario__kind_id, AT(kind),
              "id of a kind of cargo: it acts for each part of it, by the state of this part alone",
              .flags = MEMBER_OMIT_EMPTY, .is_empty = has_no_kind,
              .default_text = "whatever breaks the beam"),
};
static const member_table when_table = { MEMBER_TABLE("actionWhen", when_members),
                                         .size = sizeof(scene_action) };

static const char *const belt_form[] = { "factor", "belt", NULL };
static const char *const turn_form[] = { "turn_deg", "obstacle", "over_s", NULL };
static const char *const presence_form[] = { "present", "obstacle", NULL };
static const char *const shift_form[] = { "shift_m", "obstacle", "over_s", NULL };
static const char *const feed_form[] = { "hold", "feed", NULL };
static const char *const *const action_forms[] = {
    [SCENE_ACTION_BELT] = belt_form,         [SCENE_ACTION_TURN] = turn_form,
    [SCENE_ACTION_PRESENCE] = presence_form, [SCENE_ACTION_FEED] = feed_form,
    [SCENE_ACTION_SHIFT] = shift_form,       [SCENE_ACTION_COUNT] = NULL
};

static const member do_members[] = {
    MEMBER_OF("belt", &scenario__belt_id, AT(target), "id of a belt that gets another speed"),
    MEMBER("factor", number, AT(value),
           "of velocity_m_s, reached with the belt's accelerations; below 0: backwards",
           .range = &scene_range_speed_factor),
    MEMBER_OF("obstacle", &scenario__obstacle_id, AT(target),
              "id of an obstacle that moves, comes or goes"),
    MEMBER("turn_deg", degrees, AT(value),
           "by which its path is then turned, as in motion, counter-clockwise", .unit = "deg"),
    MEMBER("shift_m", point, AT(shift), "by which its path is then shifted, as in motion",
           .unit = "m"),
    MEMBER("over_s", number, AT(over), "how long the turn or the shift takes", .unit = "s",
           .range = &scene_range_time, .flags = MEMBER_INIT),
    MEMBER("present", flag, AT(value), "true: it comes, false: it goes"),
    MEMBER_OF("feed", &scenario__feed_id, AT(target), "id of a feed"),
    MEMBER("hold", flag, AT(value), "true: the feed is held, false: it is released"),
};
static const member_table do_table = { MEMBER_TABLE("actionDo", do_members),
                                       .size = sizeof(scene_action),
                                       .init = init_action,
                                       .choice = MEMBER_ONE_FORM,
                                       .offset_choice = AT(type),
                                       .forms = action_forms };

static const member action_members[] = {
    MEMBER("when", object, 0, "what starts it", .table = &when_table),
    MEMBER("delay_s", number, AT(delay), "how long after that it acts", .unit = "s",
           .range = &scene_range_instant, .flags = MEMBER_INIT),
    MEMBER("do", object, 0, "what it commands; it outranks the target's own schedule from then on",
           .table = &do_table),
};
const member_table scenario__action_members = { MEMBER_TABLE("action", action_members),
                                                .size = sizeof(scene_action), .init = init_action };
#undef AT

#define AT(place) offsetof(scene_lane, place)
static const member lane_members[] = {
    MEMBER_OF("belt", &scenario__belt_id, AT(belt), "id of its belt, which waits and is released"),
    MEMBER_OF("photo_eye", &scenario__photo_eye_id, AT(eye),
              "id of the photo eye at which its parts wait, and are counted"),
};
static const member_table lane_table = { MEMBER_TABLE("mergeLane", lane_members),
                                         .size = sizeof(scene_lane), .init = init_lane };
#undef AT

static const char *const merge_order_words[] = { "in_turn", "priority", NULL };
HAS_WORDS(merge_order_words, SCENE_MERGE_ORDER_COUNT);

#define AT(place) offsetof(scene_merge, place)
static const member merge_members[] = {
    MEMBER("id", text, AT(id), "its name", .default_text = "merge-1, merge-2, ...", .least = 1,
           .limit = SCENE_ID_SIZE),
    MEMBER("lanes", list, AT(lanes), "what comes to it", .table = &lane_table,
           .offset_n = AT(n_lanes), .least = 2, .limit = SCENE_LANES_MAX),
    MEMBER("order", enum, AT(order),
           "which lane that waits is released next: the one behind the last one, or the first of "
           "the list",
           .words = merge_order_words, .flags = MEMBER_INIT),
    MEMBER("parts", whole, AT(parts), "most parts of a release", .range = &scene_range_count,
           .flags = MEMBER_OMIT_EMPTY, .default_text = "1; with time_s no limit"),
    MEMBER("time_s", number, AT(time), "how long a release lasts at most", .unit = "s",
           .range = &scene_range_time, .flags = MEMBER_OMIT_EMPTY, .default_text = "no limit"),
    MEMBER("gap_s", number, AT(gap), "from the end of a release to the next one", .unit = "s",
           .range = &scene_range_instant, .flags = MEMBER_INIT),
};
const member_table scenario__merge_members = { MEMBER_TABLE("merge", merge_members),
                                               .size = sizeof(scene_merge), .init = init_merge };
#undef AT
