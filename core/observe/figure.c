#include "core/observe/figure.h"

#include "core/scene/belt_path.h"
#include "core/scene/belt_range.h"

#define OF(scope_, models_) .scope = FIGURE_OF_##scope_, .models = FIGURE_BY_##models_

#define INTERVAL_NEEDS                                                                             \
    "Where the run, or its warm-up, is too short for such an interval: about how long it has to "  \
    "be"
#define FLOW_INTERVAL                                                                              \
    "Half the width of the 95 % confidence interval of this flow in the long run, as of the "      \
    "throughput and where that has one; its share of that of the throughput at least"

const figure figure_table[FIGURE_COUNT] = {
    [FIGURE_THROUGHPUT] = { "throughput_per_h", NULL, "parts/h",
                            "Parts that left the domain after the warm-up, by the time since then",
                            OF(RUN, BOTH) },
    [FIGURE_THROUGHPUT_ERROR] = { "throughput_error_per_h", NULL, "parts/h",
                                  "Half the width of the 95 % confidence interval of the "
                                  "throughput in the long run, by batch means; absent where "
                                  "nothing is left to chance, or nothing can be said",
                                  OF(RUN, PARTS) },
    [FIGURE_THROUGHPUT_NEEDS] = { "throughput_needs_s", NULL, "s", INTERVAL_NEEDS, OF(RUN, PARTS) },
    [FIGURE_STEADY_AT] = { "steady_at_s", NULL, "s",
                           "First time at which the throughput was known to `steady_precision` of "
                           "itself: by half the width of its interval, or where nothing is left "
                           "to chance, by what it differed in the later half of the time",
                           OF(RUN, BOTH) },
    [FIGURE_SUSTAINED] = { "sustained_throughput_per_h", NULL, "parts/h",
                           "How fast parts came through while they did: with feeds "
                           "`throughput_per_h`; without, 80 % of the parts that passed the first "
                           "counter after the warm-up, by the time in which the middle 80 % of "
                           "them did",
                           OF(RUN, BOTH) },
    [FIGURE_RESIDENCE_MEAN] = { "residence_s", "mean", "s",
                                "Mean time from entering (or the start) to leaving the domain, of "
                                "each part that was inside after the warm-up, those still inside "
                                "counting as longer than their age (Kaplan-Meier; with feeds; of a "
                                "density of each tracer that moves with it), or of each "
                                "part that left (without)",
                                OF(RUN, BOTH) },
    [FIGURE_RESIDENCE_P50] = { "residence_s", "p50", "s",
                               "Median of the same times; of a density, in which what mixes gets "
                               "the mean of its times, percentiles are closer together",
                               OF(RUN, BOTH) },
    [FIGURE_RESIDENCE_P90] = { "residence_s", "p90", "s", "90 % of these times are not longer",
                               OF(RUN, BOTH) },
    [FIGURE_RESIDENCE_P95] = { "residence_s", "p95", "s", "95 % of these times are not longer",
                               OF(RUN, BOTH) },
    [FIGURE_RESIDENCE_P99] = { "residence_s", "p99", "s", "99 % of these times are not longer",
                               OF(RUN, BOTH) },
    [FIGURE_JAM_COUNT] = { "jam", "count", NULL,
                           "Jams after the warm-up: times of at least `jam_time_s` in which less "
                           "than one part left while at least one was held back (of a "
                           "density without feeds: inside)",
                           OF(RUN, BOTH) },
    [FIGURE_JAM_FIRST] = { "jam", "first_s", "s", "When the first jam began", OF(RUN, BOTH) },
    [FIGURE_JAM_TOTAL] = { "jam", "total_s", "s", "Length of all jams together", OF(RUN, BOTH) },
    [FIGURE_STALL_COUNT] = { "stall", "count", NULL,
                             "How often cargo stopped a plate that was told to move, after the "
                             "warm-up, see `force_limit_n`; absent where no plate moves",
                             OF(RUN, BOTH) },
    [FIGURE_STALL_FIRST] = { "stall", "first_s", "s", "When the first one was stopped",
                             OF(RUN, BOTH) },
    [FIGURE_STALL_TOTAL] = { "stall", "total_s", "s", "For how long, all plates together",
                             OF(RUN, BOTH) },
    [FIGURE_QUEUE_END] = { "queue_end_m", NULL, "m",
                           "Longest queue of what is held back, slower than 0.8 of the belt under "
                           "it: the largest distance, against the belt's direction, from the "
                           "downstream end of the next plate to what is held back before it, or "
                           "where there is no plate from the first to the last of it; 0 where "
                           "nothing was held back",
                           OF(RUN, BOTH_FED) },
    [FIGURE_PEAK] = { "peak_density", NULL, NULL,
                      "Largest density after the warm-up, 1 being close packing, of all samples "
                      "(macroscopic) or snapshots (microscopic, by a mollifier that is no "
                      "narrower than a part)",
                      OF(RUN, BOTH) },
    [FIGURE_DRAINED_AT] = { "drained_at_s", NULL, "s",
                            "Since when the domain has been empty again until the end: less than "
                            "half a part inside and waiting at all feeds",
                            OF(RUN, BOTH) },
    [FIGURE_ENTERED] = { "parts", "entered", "parts",
                         "Parts in the domain at the start and those of feeds that entered since",
                         OF(RUN, BOTH) },
    [FIGURE_LEFT] = { "parts", "left", "parts", "Of them, parts that left the domain",
                      OF(RUN, BOTH) },
    [FIGURE_OFFERED] = { "offered", NULL, "parts",
                         "Parts due at the feed since the start: admitted, waiting or discarded",
                         OF(FEED, BOTH) },
    [FIGURE_ADMITTED] = { "admitted", NULL, "parts",
                          "Parts of the feed that entered since the start", OF(FEED, BOTH) },
    [FIGURE_DISCARDED] = { "discarded", NULL, "parts",
                           "Parts of the feed that were dropped since the start", OF(FEED, BOTH) },
    [FIGURE_WAITING_MAX] = { "waiting_max", NULL, "parts",
                             "Most parts that waited at the feed at once", OF(FEED, BOTH) },
    [FIGURE_WAIT_MEAN] = { "wait_s", "mean", "s",
                           "Mean time from being due to entering, of what entered after the "
                           "warm-up",
                           OF(FEED, BOTH) },
    [FIGURE_WAIT_P95] = { "wait_s", "p95", "s", "95 % of these times are not longer",
                          OF(FEED, BOTH) },
    [FIGURE_WAIT_MAX] = { "wait_s", "max", "s", "Longest of these times", OF(FEED, BOTH) },
    [FIGURE_CONTENT_MEAN] = { "content", "mean", "parts",
                              "Mean over time of the parts in the counter", OF(COUNTER, BOTH) },
    [FIGURE_CONTENT_MAX] = { "content", "max", "parts", "Most parts in the counter",
                             OF(COUNTER, BOTH) },
    [FIGURE_STATE_FREE] = { "state_share", "free", NULL,
                            "Share of the time that parts spent in the counter in which they were "
                            "faster than 0.8 of the belt under them; in the rest they were held "
                            "back: queued, or blocked",
                            OF(COUNTER, BOTH_FED) },
    [FIGURE_STATE_QUEUED] = { "state_share", "queued", NULL,
                              "Share in which they were held back and moved",
                              OF(COUNTER, BOTH_FED) },
    [FIGURE_STATE_BLOCKED] = { "state_share", "blocked", NULL,
                               "Share in which they were held back and stood: slower than 0.05 of "
                               "the belt under them, or that one stood",
                               OF(COUNTER, BOTH_FED) },
    [FIGURE_FLOW] = { "flow_per_h", NULL, "parts/h",
                      "Parts that left the counter after the warm-up, by the time since then (with "
                      "feeds): one that comes back has not left, but of a density counts again; "
                      "what falls off the belts does not",
                      OF(COUNTER, BOTH_FED) },
    [FIGURE_FLOW_ERROR] = { "flow_error_per_h", NULL, "parts/h", FLOW_INTERVAL,
                            OF(COUNTER, PARTS) },
    [FIGURE_FLOW_NEEDS] = { "flow_needs_s", NULL, "s", INTERVAL_NEEDS, OF(COUNTER, PARTS) },
    [FIGURE_GAP_MIN] = { "gap_m", "min", "m",
                         "Smallest gap between parts that pass the beam: what the belt moved "
                         "between the end of one interruption and the start of the next",
                         OF(EYE, PARTS) },
    [FIGURE_GAP_P05] = { "gap_m", "p05", "m", "5 % of the gaps are not larger", OF(EYE, PARTS) },
    [FIGURE_GAP_MEAN] = { "gap_m", "mean", "m", "Mean of the gaps", OF(EYE, PARTS) },
    [FIGURE_DOUBLES] = { "doubles_share", NULL, NULL,
                         "Share of the parts that interrupted the beam at the same time as another",
                         OF(EYE, PARTS) },
    [FIGURE_BLOCKED_COUNT] = { "blocked", "count", NULL,
                               "How often the eye was blocked after the warm-up", OF(EYE, BOTH) },
    [FIGURE_BLOCKED_TOTAL] = { "blocked", "total_s", "s", "For how long together", OF(EYE, BOTH) },
    [FIGURE_BLOCKED_LONGEST] = { "blocked", "longest_s", "s", "For how long at most at a time",
                                 OF(EYE, BOTH) },
    [FIGURE_STOPPED_COUNT] = { "stopped", "count", NULL,
                               "How often the belt stood after the warm-up", OF(BELT, BOTH) },
    [FIGURE_STOPPED_TOTAL] = { "stopped", "total_s", "s", "For how long together", OF(BELT, BOTH) },
    [FIGURE_STOPPED_LONGEST] = { "stopped", "longest_s", "s", "For how long at most at a time",
                                 OF(BELT, BOTH) },
    [FIGURE_AVAILABILITY] = { "availability", NULL, NULL,
                              "Share of the time after the warm-up outside its breaks in which "
                              "the belt was not down by a failure; absent where it has none",
                              OF(BELT, BOTH) },
    [FIGURE_FAILED_COUNT] = { "failed", "count", NULL,
                              "Failures of this kind that began after the warm-up",
                              OF(FAILURE, BOTH) },
    [FIGURE_FAILED_TOTAL] = { "failed", "total_s", "s",
                              "For how long the belt was down by them together, outside its breaks",
                              OF(FAILURE, BOTH) },
    [FIGURE_OUTFLOW] = { "outflow_per_h", NULL, "parts/h",
                         "Parts that left the domain from the belt after the warm-up, by the time "
                         "since then",
                         OF(OUTLET, BOTH) },
    [FIGURE_OUTFLOW_ERROR] = { "outflow_error_per_h", NULL, "parts/h", FLOW_INTERVAL,
                               OF(OUTLET, PARTS) },
    [FIGURE_OUTFLOW_NEEDS] = { "outflow_needs_s", NULL, "s", INTERVAL_NEEDS, OF(OUTLET, PARTS) },
    [FIGURE_TAKEN] = { "taken", NULL, "parts", "Parts that the sink took since the start",
                       OF(SINK, BOTH) },
    [FIGURE_SINK_FLOW] = { "taken_per_h", NULL, "parts/h",
                           "Parts that the sink took after the warm-up, by the time since then",
                           OF(SINK, BOTH) },
    [FIGURE_SINK_FLOW_ERROR] = { "taken_error_per_h", NULL, "parts/h", FLOW_INTERVAL,
                                 OF(SINK, PARTS) },
    [FIGURE_SINK_FLOW_NEEDS] = { "taken_needs_s", NULL, "s", INTERVAL_NEEDS, OF(SINK, PARTS) },
};

figure_id figure_first(figure_scope scope)
{
    static const figure_id first[FIGURE_SCOPES + 1] = { FIGURE_THROUGHPUT,    FIGURE_OFFERED,
                                                        FIGURE_CONTENT_MEAN,  FIGURE_GAP_MIN,
                                                        FIGURE_STOPPED_COUNT, FIGURE_FAILED_COUNT,
                                                        FIGURE_OUTFLOW,       FIGURE_TAKEN,
                                                        FIGURE_COUNT };

    return first[scope];
}

// Whether a belt is one of a scope.
static bool is_of(const scene_belt *belt, figure_scope scope)
{
    return scope == FIGURE_OF_OUTLET ? belt->is_outlet : belt_range_may_change(belt);
}

static size_t belts_of(const scene *s, figure_scope scope)
{
    size_t n = 0;

    for (size_t k = 0; k < s->n_belts; k++)
        n += is_of(&s->belts[k], scope);
    return n;
}

static size_t count_failures(const scene *s)
{
    size_t n = 0;

    for (size_t k = 0; k < s->n_belts; k++)
        n += s->belts[k].stops.n_failures;
    return n;
}

size_t figure_items(const scene *s, figure_scope scope)
{
    const size_t n_outlets = s->n_feeds > 0 ? belts_of(s, FIGURE_OF_OUTLET) : 0;
    const size_t n[FIGURE_SCOPES] = { 1,
                                      s->n_feeds,
                                      s->n_counters,
                                      s->n_eyes,
                                      belts_of(s, FIGURE_OF_BELT),
                                      count_failures(s),
                                      n_outlets + s->n_sinks > 1 ? n_outlets : 0,
                                      s->n_sinks };

    return n[scope];
}

size_t figure_belt(const scene *s, figure_scope scope, size_t k)
{
    size_t belt = 0;

    while (!is_of(&s->belts[belt], scope) || k-- > 0)
        belt++;
    return belt;
}

size_t figure_failure(const scene *s, size_t k, size_t *ret_failure)
{
    size_t belt = 0;

    for (; k >= s->belts[belt].stops.n_failures; belt++)
        k -= s->belts[belt].stops.n_failures;
    *ret_failure = k;
    return belt;
}

size_t figure_outlet(const scene *s, size_t belt)
{
    const size_t of = belt < s->n_sections ? scene_belt_of(s, belt) : belt;
    size_t n = 0;

    if (of >= s->n_belts || !s->belts[of].is_outlet)
        return SIZE_MAX;
    for (size_t k = 0; k < of; k++)
        n += s->belts[k].is_outlet;
    return n;
}

const char *figure_item_id(const scene *s, figure_scope scope, size_t item)
{
    size_t failure = 0;

    switch (scope) {
    case FIGURE_OF_FEED:
        return s->feeds[item].id;
    case FIGURE_OF_COUNTER:
        return s->counters[item].id;
    case FIGURE_OF_EYE:
        return s->eyes[item].id;
    case FIGURE_OF_BELT:
    case FIGURE_OF_OUTLET:
        return s->belts[figure_belt(s, scope, item)].id;
    case FIGURE_OF_SINK:
        return s->sinks[item].id;
    case FIGURE_OF_FAILURE: {
        const size_t belt = figure_failure(s, item, &failure);
        return s->belts[belt].stops.failures[failure].id;
    }
    default:
        return "";
    }
}

static size_t figures_of(figure_scope scope)
{
    return (size_t)(figure_first(scope + 1) - figure_first(scope));
}

// Values of all items of the scopes before one.
static size_t values_before(const scene *s, figure_scope end)
{
    size_t n = 0;

    for (figure_scope scope = FIGURE_OF_RUN; scope < end; scope++)
        n += figure_items(s, scope) * figures_of(scope);
    return n;
}

size_t figure_values(const scene *s)
{
    return values_before(s, FIGURE_SCOPES);
}

size_t figure_at(const scene *s, figure_id id, size_t item)
{
    const figure_scope scope = figure_table[id].scope;

    return values_before(s, scope) + item * figures_of(scope) + (size_t)(id - figure_first(scope));
}
