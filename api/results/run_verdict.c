#include "api/results/run_verdict.h"

#include "core/base/number_text.h"
#include "core/feed/arrivals.h"
#include "core/feed/capacity.h"
#include "core/scene/belt_range.h"

#include <math.h>

static const double s_per_h = 3600.0;

// Of what was offered: what is missing is on the belt, or rounded.
static const double whole_feed = 0.99;

// Of it, the least that is the whole feed where chance leaves more open.
static const double whole_feed_least = 0.9;

// Times that parts stay, after which a belt has filled.
static const double filled_after = 2.0;

// Parts that find the place taken by one that is just entering wait, too: fewer than both are no limit.
static const double waiting_least = 3.0, waiting_of_offered = 0.02;

// Of what is missing behind the line, the least that an inlet must keep out to be the reason.
static const double kept_out_least = 0.5;

// Of the length of belt that a queue can take: the last part of it stands up to a diameter before the line.
static const double queue_at_line = 0.85;

// Shares of the time of all parts in a counter in which they stood: single ones stand anywhere.
static const double blocked_least = 0.02;

static double value_of(const run_verdict_subject *of, figure_id id, size_t item)
{
    return of->values == NULL ? (double)NAN : of->values[figure_at(of->scene, id, item)];
}

// Parts that were due at a feed and have not entered.
static double kept_out(const run_verdict_subject *of, size_t feed)
{
    return value_of(of, FIGURE_OFFERED, feed) - value_of(of, FIGURE_ADMITTED, feed);
}

// The feed that keeps out most of what it offers; SIZE_MAX: none keeps out what matters.
static size_t find_limited_feed(const run_verdict_subject *of)
{
    size_t found = SIZE_MAX;
    double largest = 0.0;

    for (size_t k = 0; k < of->scene->n_feeds; k++) {
        const double offered = value_of(of, FIGURE_OFFERED, k), out = kept_out(of, k);
        if (out >= fmax(waiting_least, waiting_of_offered * offered) && out > largest * offered) {
            largest = out / offered;
            found = k;
        }
    }
    return found;
}

// Length of the first belt between the line of a feed and the downstream end of the next plate, from which its queue is
// measured (core/observe/queue.h), m; INFINITY: there is none.
static double find_room(const scene *s, const scene_feed *feed)
{
    const vec2 middle = vec2_scale(vec2_add(feed->line[0], feed->line[1]), 0.5);
    const vec2 velocity = s->belts[0].velocity;
    const double speed = vec2_length(velocity);
    double room = INFINITY;

    for (size_t k = 0; k < s->n_obstacles && speed > 0.0; k++) {
        const scene_obstacle *o = &s->obstacles[k];
        double end = 0.0;
        for (size_t i = 0; i < o->n_points; i++)
            end = fmax(end, vec2_dot(vec2_sub(o->path[i], middle), velocity) / speed);
        if (end > 0.0)
            room = fmin(room, end);
    }
    return room;
}

static bf_status is_over_capacity(const scene *s, const scene_feed *feed, bool *ret_is,
                                  bf_error *err)
{
    feed_arrivals *arrivals;

    BF_TRY(feed_arrivals_create(feed, s->substream, &arrivals, err));
    *ret_is = feed_arrivals_largest_rate(arrivals) > feed_capacity(s, feed);
    feed_arrivals_destroy(arrivals);
    return BF_OK;
}

static void say_rate(verdict *v, const run_verdict_subject *of)
{
    const double error = value_of(of, FIGURE_THROUGHPUT_ERROR, 0);
    char number[VERDICT_NUMBER_SIZE];

    verdict_say(v, "%s parts/h", verdict_number(value_of(of, FIGURE_THROUGHPUT, 0), error, number));
    verdict_rests_on(v, "throughput_per_h", "", value_of(of, FIGURE_THROUGHPUT, 0));
    verdict_rests_on(v, "throughput_error_per_h", "", error);
}

static void say_missing(const run_verdict_subject *of, double offered_per_h, double waiting,
                        verdicts *all)
{
    const scene *s = of->scene;
    const double stay = value_of(of, FIGURE_RESIDENCE_MEAN, 0);
    const bool is_filling = s->warmup < filled_after * stay;
    char number[VERDICT_NUMBER_SIZE];

    verdict *v = verdict_add(all, is_filling ? RUN_VERDICT_BELT_FILLS : "queue_grows");
    say_rate(v, of);
    verdict_say(v, " of %s offered get through, and ",
                verdict_number(offered_per_h, (double)NAN, number));
    if (waiting >= waiting_least)
        verdict_say(v,
                    "%s parts wait at the inlet: ", verdict_number(waiting, (double)NAN, number));
    else
        verdict_say(v, "nothing waits at the inlet: ");
    verdict_rests_on(v, "offered_per_h", "", offered_per_h);
    verdict_rests_on(v, "residence_s.mean", "", stay);
    verdict_rests_on(v, "warmup_s", "", s->warmup);
    if (is_filling) {
        verdict_say(v, "the belt was still filling while this was counted.");
        verdict_advise(v, "Let warmup_s be at least %s, twice as long as parts stay.",
                       verdict_number(filled_after * stay, (double)NAN, number));
    } else {
        verdict_say(v, "the rest stays on the belt, so the run is too short to say what the line "
                       "takes.");
        verdict_advise(v, "Simulate longer, until the queue comes up to the inlet or everything "
                          "gets through; or offer less.");
    }
}

static bf_status say_limited(const run_verdict_subject *of, size_t k, double offered_per_h,
                             verdicts *all, bf_error *err)
{
    const scene *s = of->scene;
    const scene_feed *feed = &s->feeds[k];
    const double queue = value_of(of, FIGURE_QUEUE_END, 0), room = find_room(s, feed);
    const double jam = value_of(of, FIGURE_JAM_TOTAL, 0);
    char offered[VERDICT_NUMBER_SIZE], out[VERDICT_NUMBER_SIZE];
    bool is_over;

    BF_TRY(is_over_capacity(s, feed, &is_over, err));
    // Only parts have a queue with an end, and it is measured along its belt.
    const bool is_measured = isfinite(queue) && s->n_sections == 1;
    const bool is_queue =
        s->n_obstacles > 0 && (is_measured ? queue >= queue_at_line * room : !is_over);
    const double missing =
        (offered_per_h - value_of(of, FIGURE_THROUGHPUT, 0)) / s_per_h * (of->end->t - s->warmup);
    if (!is_queue && kept_out(of, k) < kept_out_least * missing) {
        say_missing(of, offered_per_h, kept_out(of, k), all);
        return BF_OK;
    }
    verdict *v = verdict_add(all, is_queue ? "queue_at_inlet" : "inlet_limit");
    if (is_queue)
        verdict_say(v,
                    "The queue comes up to the inlet '%s', so the throughput is what the line "
                    "takes: ",
                    feed->id);
    else
        verdict_say(v,
                    "The inlet '%s' does not take what is offered, though no queue comes up to "
                    "it: ",
                    feed->id);
    say_rate(v, of);
    verdict_say(v, " of %s offered get through. ",
                verdict_number(offered_per_h, (double)NAN, offered));
    verdict_say(v, "%s of %s parts have not entered by the end.",
                verdict_number(kept_out(of, k), (double)NAN, out),
                verdict_number(value_of(of, FIGURE_OFFERED, k), (double)NAN, offered));
    verdict_advise(v, is_queue ? "Offer less, widen the narrowest opening, or run the belt faster."
                               : "Deliver along a longer line or over more places, offer less, or "
                                 "run the belt faster.");
    verdict_rests_on(v, "offered_per_h", "", offered_per_h);
    verdict_rests_on(v, "offered", feed->id, value_of(of, FIGURE_OFFERED, k));
    verdict_rests_on(v, "admitted", feed->id, value_of(of, FIGURE_ADMITTED, k));
    verdict_rests_on(v, "queue_end_m", "", queue);
    verdict_rests_on(v, "jam.total_s", "", jam);
    return BF_OK;
}

static bf_status say_fed(const run_verdict_subject *of, verdicts *all, bf_error *err)
{
    const scene *s = of->scene;
    const double through = value_of(of, FIGURE_THROUGHPUT, 0);
    const double error = value_of(of, FIGURE_THROUGHPUT_ERROR, 0);
    const size_t limited = find_limited_feed(of);
    char number[VERDICT_NUMBER_SIZE];
    double offered;

    if (!isfinite(through) || of->end->t <= s->warmup)
        return BF_OK;
    BF_TRY(of->advice->model == RUN_MICRO ? feed_drawn(s, s->warmup, of->end->t, &offered, err)
                                          : feed_offered(s, s->warmup, of->end->t, &offered, err));
    offered *= s_per_h / (of->end->t - s->warmup);
    if (limited != SIZE_MAX)
        return say_limited(of, limited, offered, all, err);
    if (through >= whole_feed_least * offered &&
        through + (isfinite(error) ? error : 0.0) >= whole_feed * offered) {
        verdict *v = verdict_add(all, "everything_through");
        verdict_say(v, "Everything that is offered gets through: ");
        say_rate(v, of);
        verdict_say(v, " of %s offered.", verdict_number(offered, (double)NAN, number));
        if (whole_feed * through > offered)
            verdict_say(v, " Some of it was offered during the warm-up.");
        verdict_rests_on(v, "offered_per_h", "", offered);
    } else if (isfinite(offered)) {
        say_missing(of, offered, 0.0, all);
    } else {
        verdict *v = verdict_add(all, "throughput");
        say_rate(v, of);
        verdict_say(v, " get through.");
    }
    return BF_OK;
}

static void say_heap(const run_verdict_subject *of, verdicts *all)
{
    const double drained = value_of(of, FIGURE_DRAINED_AT, 0);
    const double sustained = value_of(of, FIGURE_SUSTAINED, 0);
    const double left = of->end->parts_start - of->end->parts_end - of->end->parts_fallen;
    char number[VERDICT_NUMBER_SIZE], start[VERDICT_NUMBER_SIZE], time[NUMBER_TEXT_SIZE];

    verdict *v = verdict_add(all, isfinite(drained) ? "drained" : "not_drained");
    if (isfinite(drained))
        verdict_say(v, "The belt has been empty since %s s.", number_text(drained, 4, time));
    else
        verdict_say(v, "%s of %s parts are still on the belt after %s s.",
                    verdict_number(of->end->parts_end, (double)NAN, number),
                    verdict_number(of->end->parts_start, (double)NAN, start),
                    number_text(of->end->t, 4, time));
    if (isfinite(sustained) && left > 0.0)
        verdict_say(v, " While they passed, %s parts/h came through.",
                    verdict_number(sustained, (double)NAN, number));
    if (!isfinite(drained))
        verdict_advise(v, "A longer run that ends when the belt is drained says when all have "
                          "left, and whether they do.");
    verdict_rests_on(v, "drained_at_s", "", drained);
    verdict_rests_on(v, "sustained_throughput_per_h", "", sustained);
    verdict_rests_on(v, "parts_end", "", of->end->parts_end);
}

static void say_jams(const run_verdict_subject *of, verdicts *all)
{
    const double n = value_of(of, FIGURE_JAM_COUNT, 0);
    char time[NUMBER_TEXT_SIZE];
    double blocked = 0.0;

    if (!(n > 0.0))
        return;
    for (size_t k = 0; k < of->scene->n_counters; k++)
        blocked = fmax(blocked, value_of(of, FIGURE_STATE_BLOCKED, k));
    bool may = of->scene->n_actions > 0 || of->scene->n_merges > 0;
    for (size_t k = 0; k < of->scene->n_belts; k++)
        may |= belt_range_may_change(&of->scene->belts[k]);
    const bool is_bridge = blocked > blocked_least && of->scene->n_obstacles > 0 && !may;
    verdict *v = verdict_add(all, is_bridge ? "bridges" : "pauses");
    if (is_bridge)
        verdict_say(v, "Parts stood before the plates and held each other: nothing");
    else
        verdict_say(v, "Nothing");
    verdict_say(v, " left for %s s, ", number_text(value_of(of, FIGURE_JAM_TOTAL, 0), 4, time));
    if (n > 1.0)
        verdict_say(v, "%.0f times, the first ", n);
    verdict_say(v, "from %s s on.", number_text(value_of(of, FIGURE_JAM_FIRST, 0), 4, time));
    if (is_bridge)
        verdict_advise(v, "Widen the narrowest opening; several runs of other substreams say how "
                          "often it happens.");
    verdict_rests_on(v, "jam.count", "", n);
    verdict_rests_on(v, "jam.first_s", "", value_of(of, FIGURE_JAM_FIRST, 0));
    verdict_rests_on(v, "jam.total_s", "", value_of(of, FIGURE_JAM_TOTAL, 0));
}

static void say_stalls(const run_verdict_subject *of, verdicts *all)
{
    const double n = value_of(of, FIGURE_STALL_COUNT, 0);
    const scene *s = of->scene;
    char first[NUMBER_TEXT_SIZE], total[NUMBER_TEXT_SIZE];
    size_t n_moving = 0, last = 0;

    if (!(n > 0.0))
        return;
    for (size_t k = 0; k < s->n_obstacles; k++) {
        if (!scene_obstacle_moves(&s->obstacles[k]))
            continue;
        n_moving++;
        last = k;
    }
    verdict *v = verdict_add(all, "stalled");
    if (n_moving == 1)
        verdict_say(v, "Cargo stopped the plate '%s', which could not push it away: ",
                    s->obstacles[last].id);
    else
        verdict_say(v, "Cargo stopped plates, which could not push it away: ");
    if (n > 1.0)
        verdict_say(v, "%.0f times, the first ", n);
    verdict_say(v, "at %s s, for %s s together.",
                number_text(value_of(of, FIGURE_STALL_FIRST, 0), 4, first),
                number_text(value_of(of, FIGURE_STALL_TOTAL, 0), 4, total));
    verdict_advise(v, "Let it move while less cargo lies in its way, slower or less far; "
                      "`force_limit_n` says how much its drive can push.");
    verdict_rests_on(v, "stall.count", "", n);
    verdict_rests_on(v, "stall.first_s", "", value_of(of, FIGURE_STALL_FIRST, 0));
    verdict_rests_on(v, "stall.total_s", "", value_of(of, FIGURE_STALL_TOTAL, 0));
}

static void say_chance(const run_verdict_subject *of, verdicts *all)
{
    const double needs = value_of(of, FIGURE_THROUGHPUT_NEEDS, 0);
    char number[VERDICT_NUMBER_SIZE];
    bool fail = false;

    if (!isfinite(needs))
        return;
    for (size_t k = 0; k < of->scene->n_belts; k++)
        fail = fail || belt_range_stops_by_chance(&of->scene->belts[k]);
    verdict *v = verdict_add(all, "too_short");
    verdict_say(v, "%s, and the run is too short to say how far that moved its throughput.",
                fail ? "Belts fail by chance" : "What arrives when and where is left to chance");
    verdict_advise(v, "Let duration_s be about %s, or make several runs of other substreams.",
                   verdict_number(needs, (double)NAN, number));
    verdict_rests_on(v, "throughput_needs_s", "", needs);
    verdict_rests_on(v, "duration_s", "", of->end->t);
}

// What the validity says of parts that bridge the opening; NULL: nothing.
static const validity_item *find_bridges(const validity *known)
{
    for (size_t k = 0; k < known->n; k++)
        if (known->items[k].figure == VALIDITY_BRIDGES)
            return &known->items[k];
    return NULL;
}

static void say_doubt(const run_verdict_subject *of, verdicts *all)
{
    const validity *known = &of->advice->validity;
    const bool is_macro = known->subject != VALIDITY_PARTS_MODEL;

    if (known->is_compared)
        return;
    verdict *v = verdict_add(all, "not_compared");
    verdict_say(v, "The %s model was not compared for such lines",
                is_macro ? "macroscopic" : "microscopic");
    const validity_item *item = known->n > 0 ? &known->items[0] : &known->never[0];
    if (known->n + known->n_never > 0)
        verdict_say(v, ": %s", item->title);
    if (known->n + known->n_never > 1)
        verdict_say(v, " (and %zu more)", known->n + known->n_never - 1);
    verdict_say(v, ".");
    if (is_macro)
        verdict_advise(v, "Solve it with the microscopic model, too, and compare.");
}

bf_status run_verdict_find(const run_verdict_subject *of, verdicts *ret_verdicts, bf_error *err)
{
    const validity_item *bridges = find_bridges(&of->advice->validity);

    if (bridges != NULL) {
        // A density knows no bridges: what it says of the throughput is not told.
        verdict *v = verdict_add(ret_verdicts, "bridged");
        verdict_say(
            v,
            "Parts bridge this opening: %.3g %% of queues before it stop for good within 1,000 "
            "parts, which the macroscopic model cannot show. Its throughput says nothing here.",
            bridges->value);
        verdict_advise(v, "Solve it with the microscopic model, or widen the narrowest opening.");
        verdict_rests_on(v, "bridges", "", bridges->value);
    } else if (of->values != NULL && of->scene->n_feeds > 0)
        BF_TRY(say_fed(of, ret_verdicts, err));
    else if (of->values != NULL && of->end->parts_start > 0.0)
        say_heap(of, ret_verdicts);
    say_jams(of, ret_verdicts);
    say_stalls(of, ret_verdicts);
    say_chance(of, ret_verdicts);
    say_doubt(of, ret_verdicts);
    return BF_OK;
}
