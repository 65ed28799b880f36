#include "core/advice/review_operation.h"

#include "core/base/number_text.h"
#include "core/feed/arrivals.h"
#include "core/feed/capacity.h"
#include "core/observe/figure.h"
#include "core/scene/belt_path.h"
#include "core/scene/surroundings.h"

#include <math.h>

enum { DIGITS = 4 };          ///< of numbers in sentences
enum { LEAST_FAILURES = 10 }; ///< of a kind in a run: their number is then known to a third
enum { BEAM_POINTS = 101 };   ///< of a beam that belts are looked for under

/// Warn of a rate that belts cannot carry away from the line of a feed.
static bf_status review_rate(const scene *s, size_t k, review_warnings *ret_warnings, bf_error *err)
{
    static const char *const members[SCENE_DEMAND_COUNT] = { "rate_per_s", "profile", "schedule" };
    const scene_feed *feed = &s->feeds[k];
    const double capacity = feed_capacity(s, feed);
    feed_arrivals *arrivals;

    bf_status status = feed_arrivals_create(feed, s->substream, &arrivals, err);
    if (status != BF_OK)
        return status;
    const double rate = feed_arrivals_largest_rate(arrivals);
    feed_arrivals_destroy(arrivals);
    if (rate <= capacity)
        return BF_OK;
    char due[NUMBER_TEXT_SIZE], carried[NUMBER_TEXT_SIZE];
    review_explain(review_add(ret_warnings, "More parts arrive than the belt carries away",
                              "/feeds/%zu/%s", k, members[feed->demand]),
                   "The feed '%s' delivers up to %s parts/s, but belts carry at most %s parts/s "
                   "away from its line: the others wait.",
                   feed->id, number_text(rate, DIGITS, due),
                   number_text(capacity, DIGITS, carried));
    return BF_OK;
}

/// Which belts stand when their cargo breaks a beam, and which belts each beam crosses.
typedef struct standing {
    const scene *s;
    bool stands[SCENE_BELTS_MAX];
    bool stands_under[SCENE_EYES_MAX]; ///< nothing under the beam moves
    bool crosses[SCENE_EYES_MAX][SCENE_BELTS_MAX];
} standing;

/// True if what stops a belt starts it again, too, after a time.
static bool starts_again(const standing *c, const scene_action *stop)
{
    bool is_so = false;

    for (size_t k = 0; k < c->s->n_actions && !is_so; k++) {
        const scene_action *a = &c->s->actions[k];
        is_so = a->type == SCENE_ACTION_BELT && a->target == stop->target && a->value > 0.0 &&
                a->eye == stop->eye && a->when_blocked && a->delay > stop->delay;
    }
    return is_so;
}

/// True if the action stops a belt by cargo that then stands in the beam.
static bool stops_itself(const standing *c, const scene_action *a)
{
    return a->type == SCENE_ACTION_BELT && a->when_blocked && a->value == 0.0 &&
           c->crosses[a->eye][a->target] && c->stands_under[a->eye] && !starts_again(c, a);
}

/// True if a belt that stands stays so: an action stops it by its own cargo, and those that start it wait for
/// photo eyes above belts that stand.
static bool stays(const standing *c, size_t belt)
{
    bool is_stopped = false;

    for (size_t k = 0; k < c->s->n_actions; k++) {
        const scene_action *a = &c->s->actions[k];
        if (a->type != SCENE_ACTION_BELT || a->target != belt)
            continue;
        if (a->value > 0.0 && !c->stands_under[a->eye])
            return false;
        is_stopped = is_stopped || stops_itself(c, a);
    }
    return is_stopped;
}

/// Warn of photo eyes that command something and lie beside all belts.
static void review_beams(const standing *c, review_warnings *ret_warnings)
{
    for (size_t e = 0; e < c->s->n_eyes; e++) {
        bool commands = false, crosses = false;
        for (size_t k = 0; k < c->s->n_actions; k++)
            commands = commands || c->s->actions[k].eye == e;
        for (size_t k = 0; k < c->s->n_merges; k++)
            for (size_t i = 0; i < c->s->merges[k].n_lanes; i++)
                commands = commands || c->s->merges[k].lanes[i].eye == e;
        for (size_t k = 0; k < c->s->n_belts; k++)
            crosses = crosses || c->crosses[e][k];
        if (!commands || crosses)
            continue;
        review_explain(
            review_add(ret_warnings, "A photo eye lies beside the belts", "/photo_eyes/%zu/line_m",
                       e),
            "No cargo is carried through the beam of '%s', so that nothing it commands will "
            "happen.",
            c->s->eyes[e].id);
    }
}

/// Warn of lanes whose parts their photo eyes do not see.
static void review_lanes(const standing *c, review_warnings *ret_warnings)
{
    for (size_t k = 0; k < c->s->n_merges; k++) {
        for (size_t i = 0; i < c->s->merges[k].n_lanes; i++) {
            const scene_lane *lane = &c->s->merges[k].lanes[i];
            if (c->crosses[lane->eye][lane->belt])
                continue;
            review_explain(
                review_add(ret_warnings, "A lane does not come to its photo eye",
                           "/merges/%zu/lanes/%zu/photo_eye", k, i),
                "The beam of '%s' does not cross the belt '%s', which stops and goes by what "
                "is in it.",
                c->s->eyes[lane->eye].id, c->s->belts[lane->belt].id);
        }
    }
}

/// Warn of actions in a circle. The belts that stay are the largest set of which each one stays as long as the others
/// do.
static void review_actions(const scene *s, review_warnings *ret_warnings)
{
    standing c = { .s = s };
    bool changes = true;

    if (s->n_actions == 0 && s->n_merges == 0)
        return;
    const surroundings around = surroundings_of(s);
    for (size_t e = 0; e < s->n_eyes; e++) {
        const vec2 *line = s->eyes[e].line;
        for (int k = 0; k < BEAM_POINTS; k++) {
            const double place = (double)k / (BEAM_POINTS - 1);
            const vec2 at = vec2_between(line[0], line[1], place);
            const size_t belt = surroundings_belt_at(&around, at);
            if (belt < around.n_belts)
                c.crosses[e][scene_belt_of(s, belt)] = true;
        }
    }
    review_beams(&c, ret_warnings);
    review_lanes(&c, ret_warnings);
    for (size_t k = 0; k < s->n_belts; k++)
        c.stands[k] = true;
    while (changes) {
        changes = false;
        for (size_t e = 0; e < s->n_eyes; e++) {
            bool is_any = false, all_stand = true;
            for (size_t k = 0; k < s->n_belts; k++) {
                is_any = is_any || c.crosses[e][k];
                all_stand = all_stand && (!c.crosses[e][k] || c.stands[k]);
            }
            c.stands_under[e] = is_any && all_stand;
        }
        for (size_t k = 0; k < s->n_belts; k++) {
            if (!c.stands[k] || stays(&c, k))
                continue;
            c.stands[k] = false;
            changes = true;
        }
    }
    for (size_t k = 0; k < s->n_actions; k++) {
        const scene_action *a = &s->actions[k];
        if (!stops_itself(&c, a))
            continue;
        review_explain(
            review_add(ret_warnings, "Actions in a circle stop a belt", "/actions/%zu", k),
            "Cargo in the beam of '%s' stops the belt '%s' under it, which nothing but photo "
            "eyes above standing belts starts again.",
            s->eyes[a->eye].id, s->belts[a->target].id);
    }
}

/// Warn of failures that are too rare for the run.
static void review_failures(const scene *s, review_warnings *ret_warnings)
{
    const double lasts = fmax(s->duration - s->warmup, 0.0);
    char every[NUMBER_TEXT_SIZE], expected[NUMBER_TEXT_SIZE], needed[NUMBER_TEXT_SIZE];

    for (size_t k = 0; k < figure_items(s, FIGURE_OF_FAILURE); k++) {
        size_t i;
        const size_t belt = figure_failure(s, k, &i);
        const scene_failure *f = &s->belts[belt].stops.failures[i];
        const double cycle = f->between.mean + f->repair.mean;
        if (f->type != SCENE_FAILURE_DRAWN || lasts >= LEAST_FAILURES * cycle)
            continue;
        review_explain(
            review_add(ret_warnings, "The run is too short to see what failures do",
                       "/belts/%zu/failures/%zu/mtbf_s", belt, i),
            "'%s' stops the belt '%s' every %s s, so that the run has about %s of them after "
            "its warm-up, and its figures are those of chance: about %s s are needed for %d, or "
            "as many in replications.",
            f->id, s->belts[belt].id, number_text(cycle, DIGITS, every),
            number_text(lasts / cycle, 2, expected),
            number_text(LEAST_FAILURES * cycle, DIGITS, needed), (int)LEAST_FAILURES);
    }
}

bf_status review_operation(const scene *s, review_warnings *ret_warnings, bf_error *err)
{
    bf_status status = BF_OK;

    for (size_t k = 0; k < s->n_feeds && status == BF_OK; k++)
        status = review_rate(s, k, ret_warnings, err);
    review_actions(s, ret_warnings);
    review_failures(s, ret_warnings);
    return status;
}
