#include "api/study/study_verdict.h"

#include "api/study/study_priv.h"
#include "core/base/memory.h"
#include "core/base/number_text.h"
#include "core/feed/arrivals.h"
#include "core/study/study_front.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

enum { LISTED = 6, PARAMETER_DIGITS = 6, TRY_DIGITS = 4 };

static const double s_per_h = 3600.0, confidence_of_means = 0.95;

// What a sentence is about.
typedef struct about {
    study_document *document;
    const study *study;
    const study_choice *choice;
    const bool *is_in;
    verdicts *verdicts; // that were found
} about;

static bool has_value(const study *s, size_t point)
{
    return study_sample(s, point, 0).n > 0;
}

static double value_of(const about *a, size_t point, size_t parameter)
{
    return study_document_value(&a->document->parameters[parameter],
                                study_point_at(a->study, point).at[parameter]);
}

// ---- points in words

// The end of a pointer from its last word on that is not a number, "angle_deg", "velocity_m_s/0".
static void say_name(verdict *v, const char *pointer)
{
    const char *word = pointer + strlen(pointer);

    while (word > pointer && !(word[-1] == '/' && !(word[0] >= '0' && word[0] <= '9')))
        word--;
    verdict_say(v, "%s", word);
}

// "angle_deg 45 to 63" where these are all that were compared in between, "angle_deg 40, 45, 63", or "7 of 9 points".
static void say_points(verdict *v, const about *a, const bool *are_meant)
{
    double least = (double)INFINITY, largest = -(double)INFINITY;
    char number[NUMBER_TEXT_SIZE];
    size_t n = 0, n_between = 0, n_all = 0;

    for (size_t p = a->choice->first; p < a->choice->end; p++)
        if (are_meant[p]) {
            least = fmin(least, value_of(a, p, 0));
            largest = fmax(largest, value_of(a, p, 0));
            n++;
        }
    for (size_t p = a->choice->first; p < a->choice->end; p++)
        if (has_value(a->study, p)) {
            n_all++;
            n_between += value_of(a, p, 0) >= least && value_of(a, p, 0) <= largest;
        }
    if (a->document->n_parameters > 1 || (n > LISTED && n_between > n)) {
        verdict_say(v, "%zu of %zu points", n, n_all);
        return;
    }
    say_name(v, a->document->parameters[0].pointer);
    if (n >= 3 && n_between == n) {
        verdict_say(v, " %s to ", number_text(least, PARAMETER_DIGITS, number));
        verdict_say(v, "%s", number_text(largest, PARAMETER_DIGITS, number));
        return;
    }
    const char *separator = " ";
    for (size_t p = a->choice->first; p < a->choice->end; p++)
        if (are_meant[p]) {
            verdict_say(v, "%s%s", separator,
                        number_text(value_of(a, p, 0), PARAMETER_DIGITS, number));
            separator = ", ";
        }
}

static void say_figure(verdict *v, const study_document *d, size_t value)
{
    char word[STUDY_DOCUMENT_COLUMN];

    study_document_column(d, value, word);
    verdict_say(v, "%s", word);
}

// ---- the sentences

static void say_equal(const about *a)
{
    const study_document *d = a->document;
    const study_choice *c = a->choice;
    const char *unit = figure_table[d->objectives[0].figure].unit;
    const bool has_chance = study_has_chance(a->study, c->best);
    const size_t n_runs = study_point_at(a->study, c->best).n_trials;
    verdict *v = verdict_add(a->verdicts, c->n_set > 1 ? "equal" : "alone");
    char word[STUDY_DOCUMENT_COLUMN], number[VERDICT_NUMBER_SIZE];

    study_document_column(d, 0, word);
    if (c->n_set > 1) {
        verdict_say(v, "Equally good in ");
        say_figure(v, d, 0);
        verdict_say(v, ": ");
        say_points(v, a, a->is_in);
        verdict_say(v, ". ");
    } else {
        verdict_say(v, "No other of the %zu points is as good. ", c->n_candidates);
    }
    if (c->indifference > 0.0)
        verdict_say(v, "Less than %s %s%scounts as equal",
                    verdict_number(c->indifference, (double)NAN, number), unit != NULL ? unit : "",
                    unit != NULL ? " " : "");
    else
        verdict_say(v, "Nothing but the same value counts as equal");
    if (has_chance)
        verdict_say(v, ", and what chance leaves open with %.4g %% confidence",
                    100.0 * d->method.confidence);
    verdict_say(v, ".");
    if (c->n_set > 1 && d->n_objectives > 1) {
        verdict_say(v, " Of them this one was chosen by ");
        say_figure(v, d, 1);
        verdict_say(v, ", then as the middle.");
    }
    if (c->n_set > 1 && has_chance &&
        !(d->method.type == STUDY_SCREEN && study_is_decided(a->study)))
        verdict_advise(v, "%zu more runs of each would halve what chance leaves open.", 3 * n_runs);
    verdict_rests_on(v, word, "", study_sample(a->study, c->best, 0).mean);
    verdict_rests_on(v, "indifference", "", c->indifference);
    verdict_rests_on(v, "runs_of_each", "", (double)n_runs);
}

static void say_edges(const about *a)
{
    for (size_t k = 0; k < a->document->n_parameters; k++) {
        const study_document_parameter *p = &a->document->parameters[k];
        const double best = value_of(a, a->choice->best, k);
        double low = best, high = best;

        for (size_t point = 0; point < study_points(a->study); point++) {
            low = fmin(low, value_of(a, point, k));
            high = fmax(high, value_of(a, point, k));
        }
        if (!(high > low) || (best > low && best < high))
            continue;
        const bool is_log = p->form == STUDY_BY_RANGE && p->is_log;
        const double step = is_log ? pow(high / low, 0.25) : 0.25 * (high - low);
        double from = best == low ? (is_log ? low / (step * step) : low - 2.0 * step)
                                  : (is_log ? high / step : high - step);
        const double to = best == low ? (is_log ? low * step : low + step)
                                      : (is_log ? high * step * step : high + 2.0 * step);
        if (low > 0.0 && from <= 1e-6 * low)
            from = 0.5 * low;
        char number[NUMBER_TEXT_SIZE];
        verdict *v = verdict_add(a->verdicts, "edge");
        verdict_say(v, "The best point is at the edge of the range, ");
        say_name(v, p->pointer);
        verdict_say(v, " %s.", number_text(best, PARAMETER_DIGITS, number));
        verdict_advise(v, "Try %s to ", number_text(from, TRY_DIGITS, number));
        verdict_advise(v, "%s.", number_text(to, TRY_DIGITS, number));
        verdict_rests_on(v, p->pointer, "", best);
        verdict_rests_on(v, "try_from", "", from);
        verdict_rests_on(v, "try_to", "", to);
    }
}

// A value of the first objective, "8730 ± 120 parts/h".
static void say_value(verdict *v, const about *a, double value, double half_width)
{
    const char *unit = figure_table[a->document->objectives[0].figure].unit;
    char number[VERDICT_NUMBER_SIZE];

    verdict_say(v, "%s%s%s", verdict_number(value, half_width, number), unit != NULL ? " " : "",
                unit != NULL ? unit : "");
}

// What two objectives leave to choose.
static bf_status say_front(const about *a, bool *are_meant, bf_error *err)
{
    size_t n;

    const bf_status status = study_front(a->study, a->choice, are_meant, &n, err);
    if (status != BF_OK || n < 2)
        return status;
    verdict *v = verdict_add(a->verdicts, "front");
    verdict_say(v, "What is gained in ");
    say_figure(v, a->document, 0);
    verdict_say(v, " is lost in ");
    say_figure(v, a->document, 1);
    verdict_say(v, " between ");
    say_points(v, a, are_meant);
    verdict_say(v, "; each other point is worse in both, or in one and not better in the other.");
    verdict_rests_on(v, "points", "", (double)n);
    return BF_OK;
}

// The mean of a point with half of its interval, and its place.
static void say_demanded(verdict *v, const about *a)
{
    const size_t best = a->choice->best;
    const statistics_sample sample = study_sample(a->study, best, 0);
    char word[STUDY_DOCUMENT_COLUMN], number[NUMBER_TEXT_SIZE];

    study_document_column(a->document, 0, word);
    for (size_t k = 0; k < a->document->n_parameters; k++) {
        verdict_say(v, k == 0 ? "" : ", ");
        say_name(v, a->document->parameters[k].pointer);
        verdict_say(v, " %s", number_text(value_of(a, best, k), PARAMETER_DIGITS, number));
        verdict_rests_on(v, a->document->parameters[k].pointer, "", value_of(a, best, k));
    }
    verdict_say(v, ", with ");
    say_value(v, a, sample.mean, statistics_half_width(&sample, confidence_of_means));
    verdict_rests_on(v, word, "", sample.mean);
    verdict_rests_on(v, "demand", "", a->document->objectives[0].demand);
}

static void say_demand(const about *a, bool *are_meant)
{
    const study_document *d = a->document;
    const study_choice *c = a->choice;
    const statistics_sample sample = study_sample(a->study, c->best, 0);
    const double half = statistics_half_width(&sample, confidence_of_means);
    const bool is_open = !c->is_met && sample.mean + half >= d->objectives[0].demand;

    for (size_t p = 0; p < study_points(a->study); p++)
        are_meant[p] = has_value(a->study, p);
    verdict *v = verdict_add(a->verdicts, c->is_met ? "demand_met" : "demand_not_met");
    if (!c->is_met) {
        verdict_say(v, "None of ");
        say_points(v, a, are_meant);
        verdict_say(v, is_open ? " is sure to meet the demand; the nearest is "
                               : " meets the demand; the nearest is ");
    } else {
        verdict_say(v, "The least is ");
    }
    say_demanded(v, a);
    verdict_say(v, ". Demanded is ");
    say_figure(v, d, 0);
    verdict_say(v, " of at least ");
    say_value(v, a, d->objectives[0].demand, (double)NAN);
    if (d->objectives[0].is_offered)
        verdict_say(v, ", 99 %% of what is offered");
    if (c->is_known && study_has_chance(a->study, c->best))
        verdict_say(v, ", with %.4g %% confidence", 100.0 * d->method.confidence);
    verdict_say(v, ".");
    if (c->is_met && c->n_set > 1) {
        verdict_say(v, " It is met at ");
        say_points(v, a, a->is_in);
        verdict_say(v, ".");
    }
    if (is_open)
        verdict_advise(v, "%" PRIu64 " more runs of each may decide it.", 3 * sample.n);
    else if (!c->is_met)
        verdict_advise(v, "Vary another parameter, too, or demand less.");
}

static void say_confirmed(const about *a, bool *are_meant)
{
    double least = (double)INFINITY, largest = -(double)INFINITY;
    size_t n_least = SIZE_MAX, n_most = 0; // replications of the points

    if (a->choice->first == 0) {
        verdict_say(verdict_add(a->verdicts, "unconfirmed"),
                    "By the macroscopic model alone; the microscopic model has not confirmed it "
                    "yet.");
        return;
    }
    verdict *v = verdict_add(a->verdicts, study_is_decided(a->study) ? "confirmed" : "undecided");
    for (size_t p = a->choice->first; p < a->choice->end; p++) {
        const double micro = study_sample(a->study, p, 0).mean;
        const double macro = study_sample(a->study, study_point_at(a->study, p).confirmed, 0).mean;
        const size_t n = study_point_at(a->study, p).n_trials;
        n_least = n < n_least ? n : n_least;
        n_most = n > n_most ? n : n_most;
        are_meant[p] = has_value(a->study, p);
        if (are_meant[p] && micro != 0.0) {
            least = fmin(least, macro / micro - 1.0);
            largest = fmax(largest, macro / micro - 1.0);
        }
    }
    verdict_say(v, "The microscopic model compared ");
    say_points(v, a, are_meant);
    verdict_say(v, " with each other, by %zu", n_least);
    if (n_most > n_least)
        verdict_say(v, " to %zu", n_most);
    verdict_say(v, "%s%s", n_most > 1 ? " runs each" : " run each",
                study_is_decided(a->study) ? "." : "; which is best is not decided.");
    if (least <= largest) {
        verdict_say(v, " The macroscopic model says %+.1f %% to %+.1f %% of their values.",
                    100.0 * least, 100.0 * largest);
        verdict_rests_on(v, "macro_to_micro_least", "", least);
        verdict_rests_on(v, "macro_to_micro_largest", "", largest);
    }
}

// ---- what is offered

// Parts/h that all feeds offer; NAN where it is no question of this study, or its demand says it.
static bf_status find_offered(const about *a, double *ret_per_h, bf_error *err)
{
    study_document *d = a->document;
    const study_document_objective *o = &d->objectives[0];
    const study_point p = study_point_at(a->study, a->choice->best);
    bf_status status = BF_OK;
    scene s;

    *ret_per_h = (double)NAN;
    if (!o->is_maximized || o->is_offered ||
        (o->figure != FIGURE_THROUGHPUT && o->figure != FIGURE_SUSTAINED))
        return BF_OK;
    for (size_t k = 0; k < d->n_parameters; k++)
        if (strncmp(d->parameters[k].pointer, "/feeds", strlen("/feeds")) == 0)
            return BF_OK;
    bf_faults *faults = memory_alloc(1, sizeof *faults);
    if (faults == NULL)
        return bf_fail_memory(err);
    status = study_document_scene(d, p.at, 0, study_document_model(d, p.model), &s, faults, err);
    memory_free(faults);
    if (status != BF_OK)
        return status;
    if (s.n_feeds > 0 && s.duration > s.warmup) {
        status = feed_offered(&s, s.warmup, s.duration, ret_per_h, err);
        *ret_per_h *= s_per_h / (s.duration - s.warmup);
    }
    scene_fini(&s);
    return status;
}

// *ret_is_whole: the best point lets everything through, and nothing can be better.
static bf_status say_through(const about *a, bool *are_meant, bool *ret_is_whole, bf_error *err)
{
    double offered;
    size_t n = 0;

    *ret_is_whole = false;
    const bf_status status = find_offered(a, &offered, err);
    if (status != BF_OK || isnan(offered))
        return status;
    for (size_t p = a->choice->first; p < a->choice->end; p++) {
        const statistics_sample sample = study_sample(a->study, p, 0);
        const double half = statistics_half_width(&sample, confidence_of_means);
        are_meant[p] = sample.n > 0 &&
                       sample.mean + (isfinite(half) ? half : 0.0) >= STUDY_WHOLE_FEED * offered &&
                       sample.mean >= 0.9 * offered;
        n += are_meant[p];
    }
    if (n == 0)
        return BF_OK;
    *ret_is_whole = are_meant[a->choice->best];
    char number[VERDICT_NUMBER_SIZE];
    verdict *v = verdict_add(a->verdicts, "everything_through");
    verdict_say(v, "Everything that is offered, %s parts/h, gets through at ",
                verdict_number(offered, (double)NAN, number));
    say_points(v, a, are_meant);
    verdict_say(v, ".");
    verdict_rests_on(v, "offered_per_h", "", offered);
    return BF_OK;
}

// Of replications of one point.
static void say_jams(const about *a, size_t value)
{
    const study_document_objective *o = &a->document->objectives[value];
    statistics_sample jams = { 0 };

    if (o->figure != FIGURE_JAM_COUNT)
        return;
    for (size_t trial = 0; trial < study_trials(a->study); trial++) {
        const double n = study_values(a->study, trial)[value];
        if (isfinite(n))
            statistics_add(&jams, n > 0.0 ? 1.0 : 0.0);
    }
    const uint64_t hits = (uint64_t)lround(jams.mean * (double)jams.n);
    const statistics_range range = statistics_wilson(hits, jams.n, confidence_of_means);
    verdict *v = verdict_add(a->verdicts, "jams");
    verdict_say(v,
                "Nothing left for a while in %" PRIu64 " of %" PRIu64 " runs: it jams with a "
                "probability of %.2g to %.2g %%.",
                hits, jams.n, 100.0 * range.low, 100.0 * range.high);
    verdict_rests_on(v, "jam_probability", "", jams.mean);
    verdict_rests_on(v, "jam_probability_low", "", range.low);
    verdict_rests_on(v, "jam_probability_high", "", range.high);
}

static void say_replications(const about *a)
{
    const statistics_sample sample = study_sample(a->study, a->choice->best, 0);
    const double half = statistics_half_width(&sample, confidence_of_means);
    char word[STUDY_DOCUMENT_COLUMN];

    if (sample.n < 2 || !study_document_definition(a->document).has_chance)
        return;
    study_document_column(a->document, 0, word);
    verdict *v = verdict_add(a->verdicts, "replications");
    say_value(v, a, sample.mean, half);
    verdict_say(v, " is the mean of %" PRIu64 " runs with its interval of 95 %%.", sample.n);
    if (half > 0.0)
        verdict_advise(v, "%" PRIu64 " more runs would halve it.", 3 * sample.n);
    verdict_rests_on(v, word, "", sample.mean);
    verdict_rests_on(v, "half_width", "", half);
    verdict_rests_on(v, "runs", "", (double)sample.n);
    for (size_t value = 0; value < a->document->n_objectives; value++)
        say_jams(a, value);
}

static void say_no_chance(const about *a)
{
    if (a->document->replications > 1 && !study_document_definition(a->document).has_chance)
        verdict_say(verdict_add(a->verdicts, "no_chance"),
                    "Nothing is left to chance, so each point was solved once: replications would "
                    "be the same run.");
}

static bf_status say_all(const about *a, bool *are_meant, bf_error *err)
{
    const study_document *d = a->document;
    const bool is_search = d->method.type == STUDY_DIRECT || d->method.type == STUDY_CMAES;
    bool is_whole;

    if (!isnan(d->objectives[0].demand))
        say_demand(a, are_meant);
    else if (a->choice->is_known && a->choice->n_candidates > 1)
        say_equal(a);
    if (!is_search && !a->choice->is_known) {
        verdict *v = verdict_add(a->verdicts, "one_run_each");
        verdict_say(
            v,
            "What arrives when and where is left to chance, and each point was solved once: which "
            "is best may be luck.");
        verdict_advise(v, "Ask for at least 5 replications.");
    }
    BF_TRY(say_through(a, are_meant, &is_whole, err));
    if (d->has_own_second)
        BF_TRY(say_front(a, are_meant, err));
    // Beyond the range no point is better where one lets everything through, or has nothing of what is to be least, but in a
    // second objective.
    const bool is_least =
        !d->objectives[0].is_maximized && study_sample(a->study, a->choice->best, 0).mean == 0.0;
    if ((!is_whole && !is_least) || d->has_own_second)
        say_edges(a);
    if (d->method.type != STUDY_SCREEN)
        say_no_chance(a);
    memset(are_meant, 0, study_points(a->study) * sizeof *are_meant);
    if (d->method.type == STUDY_SCREEN)
        say_confirmed(a, are_meant);
    return BF_OK;
}

bf_status study_verdict_find(study_document *document, const study *s, const study_choice *choice,
                             const bool *is_in, verdicts *ret_verdicts, bf_error *err)
{
    const about a = { document, s, choice, is_in, ret_verdicts };

    if (choice->best == SIZE_MAX && study_is_ended(s)) {
        verdict *v = verdict_add(a.verdicts, "no_value");
        verdict_say(v, "No trial has a value of ");
        say_figure(v, a.document, 0);
        verdict_say(v, ", so no point is best.");
    }
    if (choice->best == SIZE_MAX || document->method.type == STUDY_CALIBRATE)
        return BF_OK;
    if (document->n_parameters == 0) {
        say_replications(&a);
        say_no_chance(&a);
        return BF_OK;
    }
    bool *are_meant = memory_alloc(study_points(s), sizeof *are_meant);
    if (are_meant == NULL)
        return bf_fail_memory(err);
    const bf_status status = say_all(&a, are_meant, err);
    memory_free(are_meant);
    return status;
}
