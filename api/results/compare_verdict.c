#include "api/results/compare_verdict.h"

#include "api/json/json_in.h"
#include "api/results/key_figures.h"
#include "api/results/run_verdict.h"
#include "api/scenario/scenario.h"
#include "core/base/memory.h"
#include "core/feed/arrivals.h"
#include "core/observe/columns.h"
#include "core/scene/regime.h"

#include <jansson.h>
#include <math.h>
#include <string.h>

static const double open_fraction =
    0.9; // of what is offered, that comes through where nothing holds it up
static const double most_counted = 1e5;  // parts; their number differs by 0.3 % from its mean
static const double two_sided_95 = 1.96; // of the normal distribution
static const double chance_told = 0.005; // of the mean of what arrives
static const double nothing = 1e-9;      // relative: figures are written with 12 digits

static bf_status advise_side(const scene *s, compare_side *side, bf_error *err)
{
    advice *given = memory_alloc(1, sizeof *given);

    if (given == NULL)
        return bf_fail_memory(err);
    const bf_status status = advice_of(s, side->model, given, err);
    side->is_compared = status == BF_OK && given->validity.is_compared;
    memory_free(given);
    return status;
}

// A run that ended early had the arrivals of its whole time, as far as this tells. Of many parts the chance is too small to
// matter, and they are not counted: a run may be cancelled that would have had any number.
static bf_status find_arrivals(const scene *s, compare_side *side, bf_error *err)
{
    const double hours = (s->duration - s->warmup) / 3600.0;
    double drawn = 0.0, mean = 0.0, all = 0.0;
    bf_status status = BF_OK;

    if (s->n_feeds > 0)
        status = feed_offered(s, s->warmup, s->duration, &mean, err);
    if (status != BF_OK || !(mean > 0.0 && isfinite(mean)))
        return status;
    side->offered_per_h = mean / hours;
    if (side->model != RUN_MICRO || !side->has_chance)
        return BF_OK;
    status = feed_offered(s, 0.0, s->duration, &all, err);
    if (status != BF_OK || all > most_counted)
        return status;
    status = feed_drawn(s, s->warmup, s->duration, &drawn, err);
    side->arrived = drawn / mean;
    return status;
}

// Makes the side of a run and frees its scene; figures NULL: there are none.
static bf_status make_side(run_model model, scene *s, const json_t *figures, compare_side *ret_side,
                           compare_flows *ret_flows, bf_error *err)
{
    double values[FIGURE_OFFERED];

    key_figures_read_run(figures, values);
    compare_flows_read(figures, ret_flows);
    *ret_side = (compare_side){ .is_run = true,
                                .model = model,
                                .has_chance = scene_has_chance(s, model == RUN_MACRO),
                                .is_fed = s->n_feeds > 0,
                                .offered_per_h = (double)NAN,
                                .arrived = 1.0,
                                .throughput_per_h = values[FIGURE_SUSTAINED],
                                .error_per_h = values[FIGURE_THROUGHPUT_ERROR],
                                .needs_s = values[FIGURE_THROUGHPUT_NEEDS],
                                .counted_h = (s->duration - s->warmup) / 3600.0 };
    bf_status status = find_arrivals(s, ret_side, err);
    if (status == BF_OK)
        status = advise_side(s, ret_side, err);
    s->macro = (scene_macro){ 0 };
    s->micro.integrator = (scene_integrator)0;
    s->micro.path = (scene_path)0;
    s->micro.step = s->micro.modulus_reduction = s->micro.overlap_limit = 0.0;
    s->output.curve_every = s->output.snapshot_every = 0.0;
    ret_side->line = run_definition(s, RUN_MACRO);
    scene_fini(s);
    return status;
}

bf_status compare_verdict_side(run_model model, const char *scenario, size_t n_scenario,
                               const char *figures, size_t n_figures, compare_side *ret_side,
                               compare_flows *ret_flows, bf_error *err)
{
    bf_status status = BF_OK;
    json_t *root = NULL;
    scene s;

    if (n_figures > 0)
        status = key_figures_parse(figures, n_figures, &root, err);
    if (status == BF_OK)
        status = scenario_read_resolved(scenario, n_scenario, &s, err);
    if (status == BF_OK)
        status = make_side(model, &s, root, ret_side, ret_flows, err);
    json_in_free(root);
    return status;
}

bf_status compare_verdict_side_of_summary(const char *summary, size_t n, compare_side *ret_side,
                                          compare_flows *ret_flows, bf_error *err)
{
    bf_faults faults = { 0 };
    json_in in = json_in_to(&faults);
    bf_status status = BF_OK;
    scene s;

    json_t *root = json_in_parse(&in, summary, n);
    const char *model = json_string_value(json_object_get(root, "model"));
    const json_t *scenario = json_object_get(root, "scenario");
    if (in.has_failed)
        status = json_in_status(&in, err);
    else if (model == NULL || scenario == NULL)
        status = bf_fail(err, BF_EINPUT, "", "not a summary of a run");
    else
        status = scenario_read_resolved_tree(scenario, &s, err);
    if (status == BF_OK)
        status = make_side(strcmp(model, run_model_words[RUN_MICRO]) == 0 ? RUN_MICRO : RUN_MACRO,
                           &s, json_object_get(root, "key_figures"), ret_side, ret_flows, err);
    if (status == BF_OK) {
        const json_t *list = json_object_get(root, "verdicts");
        bool is = false;
        for (size_t k = 0; k < json_array_size(list); k++) {
            const char *kind = json_string_value(json_object_get(json_array_get(list, k), "kind"));
            is = is || (kind != NULL && strcmp(kind, RUN_VERDICT_BELT_FILLS) == 0);
        }
        ret_side->is_filling = is;
    }
    json_in_free(root);
    return status;
}

bool compare_verdict_is_content(const compare_side *side, const char *column)
{
    return side->is_fed && (column == NULL || !columns_is_count(column));
}

void compare_verdict_leave_out(const compare_side *reference, const compare_side *side,
                               const char *column, compare_figures *figures,
                               compare_measures *measures)
{
    const bool is = compare_verdict_is_content(side, column);

    compare_measures_of_content(measures, compare_verdict_is_content(reference, column), is);
    if (is)
        compare_figures_of_content(figures);
}

// Half the width of the interval of the difference; NAN: not known.
static double half_width_of(const compare_side *a, const compare_side *b)
{
    const double of_a = a->has_chance ? a->error_per_h : 0.0;
    const double of_b = b->has_chance ? b->error_per_h : 0.0;

    return hypot(of_a, of_b);
}

static void say_both(verdict *v, const compare_side *a, const compare_side *b)
{
    char of_a[VERDICT_NUMBER_SIZE], of_b[VERDICT_NUMBER_SIZE];

    verdict_say(v, "%s against %s parts/h",
                verdict_number(b->throughput_per_h, b->error_per_h, of_b),
                verdict_number(a->throughput_per_h, a->error_per_h, of_a));
    verdict_rests_on(v, "throughput_a_per_h", "", a->throughput_per_h);
    verdict_rests_on(v, "throughput_b_per_h", "", b->throughput_per_h);
    verdict_rests_on(v, "half_width_per_h", "", half_width_of(a, b));
}

static void say_models(const compare_side *a, const compare_side *b, double half, verdicts *all)
{
    const compare_side *macro = a->model == RUN_MACRO ? a : b, *micro = macro == a ? b : a;
    const double gap = macro->throughput_per_h - micro->throughput_per_h;
    // Where a queue keeps parts back, it does not matter how many arrived.
    const bool is_open = macro->throughput_per_h >= open_fraction * macro->offered_per_h;
    const double by_chance = is_open ? micro->arrived - 1.0 : 0.0;
    const double allowed = fmax((COMPARE_MODELS_AGREE + fabs(by_chance)) * micro->throughput_per_h,
                                isfinite(half) ? half : 0.0);
    const bool do_agree = fabs(gap) <= allowed;
    const bool is_early = !do_agree && (macro->is_filling || micro->is_filling);

    verdict *v = verdict_add(all, do_agree   ? "models_agree"
                                  : is_early ? "too_early"
                                             : "models_disagree");
    if (is_early)
        verdict_say(v, "It is too early to compare the models: ");
    else
        verdict_say(v, "The models %s: ", do_agree ? "agree" : "disagree");
    say_both(v, micro, macro);
    if (micro->throughput_per_h > 0.0) {
        verdict_say(v, " by the macroscopic and the microscopic model, %+.1f %%.",
                    100.0 * gap / micro->throughput_per_h);
        verdict_rests_on(v, "macro_to_micro", "", gap / micro->throughput_per_h);
    } else {
        verdict_say(v, " by the macroscopic and the microscopic model.");
    }
    if (fabs(by_chance) >= chance_told) {
        verdict_say(v,
                    " By chance %.1f %% %s parts arrived in the microscopic one than in the mean.",
                    100.0 * fabs(by_chance), by_chance > 0.0 ? "more" : "fewer");
        verdict_rests_on(v, "arrived_by_chance", "", by_chance);
    }
    if (do_agree)
        return;
    if (!is_early && isnan(half))
        verdict_say(v, " How much of that is chance is not known.");
    if (!macro->is_compared)
        verdict_say(v, " The macroscopic one was not compared for such lines.");
    if (!micro->is_compared)
        verdict_say(v, " The microscopic one was not compared with experiments on such lines.");
    if (is_early) {
        verdict_say(v, " The belt was still filling while this was counted.");
        verdict_advise(v, "Let warmup_s be twice as long as parts stay, and the runs longer.");
    } else if (micro->is_compared || !macro->is_compared) {
        verdict_advise(v, "Trust the microscopic model.");
    } else {
        verdict_advise(v, "Trust neither without counts of a real line.");
    }
}

static const char *find_kind(double gap, double half, const compare_side *a)
{
    if (fabs(gap) <= nothing * fabs(a->throughput_per_h))
        return "same";
    if (isnan(half))
        return "uncertain";
    if (fabs(gap) <= half)
        return "equal";
    return gap > 0.0 ? "more" : "less";
}

static void say_difference(const compare_side *a, const compare_side *b, double half, verdicts *all)
{
    const double gap = b->throughput_per_h - a->throughput_per_h;
    const char *kind = find_kind(gap, half, a);
    const char *reference = a->is_run ? "the reference" : "was counted";
    char number[VERDICT_NUMBER_SIZE];

    verdict *v = verdict_add(all, kind);
    if (strcmp(kind, "same") == 0) {
        verdict_say(v, "The throughput is the same, %s parts/h.",
                    verdict_number(b->throughput_per_h, (double)NAN, number));
        verdict_rests_on(v, "throughput_a_per_h", "", a->throughput_per_h);
        return;
    }
    if (a->throughput_per_h > 0.0)
        verdict_say(v, "%.3g %% ", 100.0 * fabs(gap) / a->throughput_per_h);
    verdict_say(v, "%s throughput than %s: ", gap > 0.0 ? "more" : "less", reference);
    say_both(v, a, b);
    if (strcmp(kind, "uncertain") == 0) {
        const double needs =
            fmax(isnan(a->needs_s) ? 0.0 : a->needs_s, isnan(b->needs_s) ? 0.0 : b->needs_s);
        verdict_say(
            v, ". What arrives when and where is left to chance, and how much of it is chance is "
               "not known.");
        if (needs > 0.0)
            verdict_advise(v, "Let both runs be about %s s long.",
                           verdict_number(needs, (double)NAN, number));
        else
            verdict_advise(v, "Make several runs of other substreams of each.");
    } else if (strcmp(kind, "equal") == 0) {
        verdict_say(v, ", which is within what chance leaves open, %s parts/h.",
                    verdict_number(half, (double)NAN, number));
        verdict_advise(v, "Three more runs of each at other substreams, or runs four times as "
                          "long, would halve that.");
    } else {
        verdict_say(v, half > 0.0 ? ", more than chance leaves open." : ".");
    }
}

void compare_verdict_find(const compare_side *a, const compare_side *b, verdicts *ret_verdicts)
{
    const double half = half_width_of(a, b);

    if (isnan(a->throughput_per_h) || isnan(b->throughput_per_h)) {
        verdict_say(verdict_add(ret_verdicts, "no_throughput"),
                    "There is no throughput to compare: nothing has left of one of them, or its "
                    "curve is of what is inside while cargo enters and leaves.");
        return;
    }
    if (a->throughput_per_h == 0.0 && b->throughput_per_h == 0.0) {
        verdict_say(verdict_add(ret_verdicts, "no_throughput"),
                    "Nothing came through in either of them: there is no throughput to compare.");
        return;
    }
    if (a->is_run && b->is_run && a->model != b->model && a->line == b->line)
        say_models(a, b, half, ret_verdicts);
    else
        say_difference(a, b, half, ret_verdicts);
}

// Half the width of the interval of a side's flow; NAN: not known.
static double half_width_of_flow(const compare_side *side, double error_per_h, double most_per_h)
{
    if (!side->has_chance)
        return 0.0;
    return isnan(error_per_h) && side->counted_h > 0.0
               ? two_sided_95 * sqrt(most_per_h / side->counted_h)
               : error_per_h;
}

// By which fraction of the larger one two flows differ, beyond what chance leaves open; 0: not beyond it, or it is not known.
static double differ_by(const compare_side *a, const compare_side *b, const compare_flow_pair *pair)
{
    const double most = fmax(pair->a_per_h, pair->b_per_h), gap = fabs(pair->gap_per_h);
    const double half = hypot(half_width_of_flow(a, pair->a_error, most),
                              half_width_of_flow(b, pair->b_error, most));

    return gap > half ? gap / most : 0.0;
}

void compare_verdict_flows(const compare_side *a, const compare_side *b,
                           const compare_flows *flows_a, const compare_flows *flows_b,
                           verdicts *ret_verdicts)
{
    const double most = fmax(a->throughput_per_h, b->throughput_per_h);
    const double apart = most > 0.0 ? fabs(a->throughput_per_h - b->throughput_per_h) / most : 0.0;
    const double allowed = COMPARE_MODELS_AGREE + fabs(a->arrived - b->arrived) + apart;
    compare_flow_pair pairs[COMPARE_FLOWS_MAX];
    const size_t n = compare_flows_match(flows_a, flows_b, pairs);
    size_t n_differ = 0;

    // Those that differ come to the front, the largest first.
    for (size_t k = 0; k < n; k++) {
        const compare_flow_pair pair = pairs[k];
        const double fraction = differ_by(a, b, &pair);
        if (!(fraction > allowed))
            continue;
        size_t to = n_differ++;
        for (; to > 0 && differ_by(a, b, &pairs[to - 1]) < fraction; to--)
            pairs[to] = pairs[to - 1];
        pairs[to] = pair;
    }
    if (n_differ == 0)
        return;
    verdict *v = verdict_add(ret_verdicts, "flows_differ");
    verdict_say(v, "Flows differ by more than the throughputs do:");
    for (size_t k = 0; k < n_differ && k < COMPARE_FLOWS_TOLD; k++) {
        char of_a[VERDICT_NUMBER_SIZE], of_b[VERDICT_NUMBER_SIZE];
        const compare_flow_pair *pair = &pairs[k];
        verdict_say(v, "%s %s against %s parts/h at %s '%s'", k == 0 ? "" : ",",
                    verdict_number(pair->b_per_h, pair->b_error, of_b),
                    verdict_number(pair->a_per_h, pair->a_error, of_a), pair->of, pair->id);
        verdict_rests_on(v, "flow_gap_per_h", pair->id, pair->gap_per_h);
    }
    if (n_differ > COMPARE_FLOWS_TOLD)
        verdict_say(v, ", and at %zu others", n_differ - COMPARE_FLOWS_TOLD);
    verdict_say(v, ".");
}
