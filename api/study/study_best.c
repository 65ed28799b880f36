#include "api/study/study_best.h"

#include "api/json/json_out.h"
#include "api/scenario/review_members.h"
#include "api/study/study_verdict.h"
#include "core/advice/advice.h"
#include "core/base/memory.h"
#include "core/study/calibration.h"
#include "core/study/study_front.h"

#include <math.h>

static const double confidence = 0.95;

static void write_pair(json_out *w, double low, double high)
{
    json_out_array(w);
    json_out_measure(w, low);
    json_out_measure(w, high);
    json_out_array_end(w);
}

static void write_interval(json_out *w, double low, double high)
{
    json_out_key(w, "interval_95");
    write_pair(w, low, high);
}

static void write_value(json_out *w, const study_document *d, const study *s, size_t point,
                        size_t value)
{
    const statistics_sample sample = study_sample(s, point, value);
    const double half = statistics_half_width(&sample, confidence);
    char name[STUDY_DOCUMENT_COLUMN];

    study_document_column(d, value, name);
    json_out_key(w, name);
    json_out_object(w);
    json_out_key_integer(w, "n", (int64_t)sample.n);
    json_out_key_measure(w, "mean", sample.n > 0 ? sample.mean : (double)NAN);
    if (sample.n >= 2) {
        json_out_key_measure(w, "deviation", statistics_deviation(&sample));
        write_interval(w, sample.mean - half, sample.mean + half);
    }
    if (value < d->n_objectives && d->objectives[value].figure == FIGURE_JAM_COUNT) {
        // In how many replications there was a jam.
        uint64_t n = 0, n_jams = 0;
        for (size_t trial = 0; trial < study_trials(s); trial++) {
            const double count = study_values(s, trial)[value];
            if (study_trial_at(s, trial).point == point && isfinite(count)) {
                n++;
                n_jams += count > 0.0;
            }
        }
        const statistics_range range = statistics_wilson(n_jams, n, confidence);
        json_out_key(w, "jam_probability");
        json_out_object(w);
        json_out_key_measure(w, "mean", n > 0 ? (double)n_jams / (double)n : (double)NAN);
        write_interval(w, range.low, range.high);
        json_out_object_end(w);
    }
    json_out_object_end(w);
}

static void write_parameters(json_out *w, const study_document *d, const study_point *p)
{
    json_out_key(w, "parameters");
    json_out_object(w);
    for (size_t k = 0; k < d->n_parameters; k++)
        json_out_key_number(w, d->parameters[k].pointer,
                            study_document_value(&d->parameters[k], p->at[k]));
    json_out_object_end(w);
}

static void write_point(json_out *w, const study_document *d, const study *s, size_t point)
{
    const study_point p = study_point_at(s, point);
    const size_t n_values = study_document_definition(d).n_values;

    json_out_object(w);
    json_out_key_integer(w, "point", (int64_t)point);
    json_out_key_string(w, "model", run_model_words[study_document_model(d, p.model)]);
    write_parameters(w, d, &p);
    json_out_key(w, "values");
    json_out_object(w);
    for (size_t value = 0; value < n_values; value++)
        write_value(w, d, s, point, value);
    json_out_object_end(w);
    json_out_object_end(w);
}

// The points that the microscopic model confirmed, each next to what the macroscopic one said.
static void write_confirmed(json_out *w, const study_document *d, const study *s, const bool *is_in)
{
    json_out_key_bool(w, "is_decided", study_is_decided(s));
    json_out_key(w, "confirmed");
    json_out_array(w);
    for (size_t point = 0; point < study_points(s); point++) {
        const study_point p = study_point_at(s, point);
        if (p.confirmed == SIZE_MAX)
            continue;
        json_out_object(w);
        json_out_key_bool(w, "is_dropped", p.is_dropped);
        json_out_key_bool(w, "is_in_set", is_in[point]);
        json_out_key(w, "micro");
        write_point(w, d, s, point);
        json_out_key(w, "macro");
        write_point(w, d, s, p.confirmed);
        json_out_key_measure(w, "difference",
                             study_sample(s, p.confirmed, 0).mean - study_sample(s, point, 0).mean);
        json_out_object_end(w);
    }
    json_out_array_end(w);
}

static void write_calibration(json_out *w, const study_document *d, const study *s, bool has_best)
{
    json_out_key(w, "left_out");
    json_out_array(w);
    for (size_t curve = 0; curve < d->n_curves; curve++) {
        const size_t without = calibration_without(s, curve);
        if (without == SIZE_MAX)
            continue;
        json_out_object(w);
        json_out_key_string(w, "counter", d->curves[curve].counter);
        json_out_key_measure(w, "rmse", sqrt(study_sample(s, without, curve).mean));
        json_out_object_end(w);
    }
    json_out_array_end(w);
    json_out_key(w, "profiles");
    json_out_array(w);
    for (size_t k = 0; k < d->n_parameters && has_best && study_is_ended(s); k++) {
        const calibration_profile profile = calibration_profile_of(s, k);
        json_out_object(w);
        json_out_key_string(w, "pointer", d->parameters[k].pointer);
        json_out_key_bool(w, "is_identifiable", profile.is_identifiable);
        json_out_key(w, "interval");
        write_pair(w, study_document_value(&d->parameters[k], profile.low),
                   study_document_value(&d->parameters[k], profile.high));
        json_out_object_end(w);
    }
    json_out_array_end(w);
}

// Reasons to doubt what was found at a point.
static bf_status write_warnings(json_out *w, study_document *d, const study *s, size_t point,
                                bf_error *err)
{
    const study_point p = study_point_at(s, point);
    const run_model model =
        d->method.type == STUDY_SCREEN ? RUN_MACRO : study_document_model(d, p.model);
    bf_faults *faults = memory_alloc(1, sizeof *faults);
    advice *given = memory_alloc(1, sizeof *given);
    scene scene_;

    bf_status status = faults == NULL || given == NULL
                           ? bf_fail_memory(err)
                           : study_document_scene(d, p.at, 0, model, &scene_, faults, err);
    if (status == BF_OK) {
        status = advice_of(&scene_, model, given, err);
        scene_fini(&scene_);
    }
    if (status == BF_OK) {
        json_out_key(w, "warnings");
        review_write_texts(w, &given->warnings);
    }
    memory_free(given);
    memory_free(faults);
    return status;
}

// The points that may be best, or null where that is not known.
static void write_set(json_out *w, const study_document *d, const study *s,
                      const study_choice *choice, const bool *is_in)
{
    json_out_key_bool(w, "has_chance", study_document_definition(d).has_chance);
    json_out_key(w, "set");
    if (!choice->is_known) {
        json_out_null(w);
        return;
    }
    json_out_array(w);
    for (size_t point = 0; point < study_points(s); point++) {
        if (!is_in[point])
            continue;
        const study_point p = study_point_at(s, point);
        json_out_object(w);
        json_out_key_integer(w, "point", (int64_t)point);
        write_parameters(w, d, &p);
        json_out_object_end(w);
    }
    json_out_array_end(w);
    if (!study_document_definition(d).has_demand)
        json_out_key_measure(w, "indifference", choice->indifference);
}

static bf_status write_verdicts(json_out *w, study_document *d, const study *s,
                                const study_choice *choice, const bool *is_in, bf_error *err)
{
    verdicts *all = memory_alloc(1, sizeof *all);

    if (all == NULL)
        return bf_fail_memory(err);
    const bf_status status = study_verdict_find(d, s, choice, is_in, all, err);
    json_out_key(w, "verdicts");
    verdict_write_all(w, all);
    memory_free(all);
    return status;
}

static bf_status write_found(json_out *w, study_document *d, const study *s, bool *is_in,
                             bool *is_on, bf_error *err)
{
    study_choice choice;

    BF_TRY(study_choose(s, is_in, &choice, err));
    json_out_key(w, "best");
    if (choice.best == SIZE_MAX)
        json_out_null(w);
    else
        write_point(w, d, s, choice.best);
    write_set(w, d, s, &choice, is_in);
    if (study_document_definition(d).has_demand) {
        json_out_key_measure(w, "demand", d->objectives[0].demand);
        json_out_key_bool(w, "is_met", choice.is_met);
    }
    bf_status status = write_verdicts(w, d, s, &choice, is_in, err);
    if (d->has_own_second && d->method.type != STUDY_CALIBRATE && d->n_parameters > 0) {
        // The points between which two objectives leave the choice.
        size_t n;
        if (status == BF_OK)
            status = study_front(s, &choice, is_on, &n, err);
        json_out_key(w, "front");
        json_out_array(w);
        for (size_t point = 0; point < study_points(s); point++)
            if (is_on[point])
                write_point(w, d, s, point);
        json_out_array_end(w);
    }
    if (d->method.type == STUDY_SCREEN)
        write_confirmed(w, d, s, is_in);
    if (d->method.type == STUDY_CALIBRATE)
        write_calibration(w, d, s, choice.best != SIZE_MAX);
    if (status == BF_OK && choice.best != SIZE_MAX)
        status = write_warnings(w, d, s, choice.best, err);
    return status;
}

bf_status study_best_write(study_document *d, const study *s, bf_buffer *out, bf_error *err)
{
    json_out w = json_out_to(out);

    bool *is_in = memory_alloc(2 * study_points(s) + 1, sizeof *is_in);
    if (is_in == NULL)
        return bf_fail_memory(err);
    json_out_object(&w);
    json_out_key_string(&w, "name", d->name);
    json_out_key_string(&w, "method", study_document_methods[d->method.type]);
    json_out_key_bool(&w, "is_ended", study_is_ended(s));
    json_out_key_integer(&w, "trials", (int64_t)study_trials(s));
    json_out_key_integer(&w, "points", (int64_t)study_points(s));
    const bf_status status = write_found(&w, d, s, is_in, is_in + study_points(s), err);
    json_out_object_end(&w);
    memory_free(is_in);
    return status == BF_OK ? json_out_status(&w, err) : status;
}
