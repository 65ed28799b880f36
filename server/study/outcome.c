// From a trial to the submission of its run, and from the run to the values of the trial.

#include "server/study/studies_priv.h"

#include "api/results/key_figures.h"
#include "api/scenario/submission.h"
#include "core/base/memory.h"

#include <math.h>
#include <stdatomic.h>
#include <stdio.h>

static bf_status make_scene(study__task *t, const api_trial *trial, scene *ret_scene, bf_error *err)
{
    const study_trial about = study_trial_at(t->core, trial->number);
    const study_point point = study_point_at(t->core, about.point);
    bf_faults *faults = memory_alloc(1, sizeof *faults);

    if (faults == NULL)
        return bf_fail_memory(err);
    faults->is_cancelled = &t->owner->is_abandoned;
    bf_status status = study_document_scene(&t->document, point.at, about.substream, trial->model,
                                            ret_scene, faults, err);
    memory_free(faults);
    if (status != BF_OK && atomic_load(&t->owner->is_abandoned))
        status = bf_fail(err, BF_EBUSY, "", "the service is stopping");
    return status;
}

bf_status study__submission(study__task *t, const api_study *about, const api_trial *trial,
                            api_submission *ret_submission, bf_error *err)
{
    scene s;

    BF_TRY(make_scene(t, trial, &s, err));
    bf_status status = submission_make(&s, trial->model, ret_submission, err);
    scene_fini(&s);
    if (status != BF_OK)
        return status;
    ret_submission->priority = about->priority;
    snprintf(ret_submission->sender.owner, sizeof ret_submission->sender.owner, "%s", about->owner);
    return BF_OK;
}

// The key figures of a run so far, as many as the scene has. *ret_figures is the caller's: memory_free().
static bf_status read_figures(study__task *t, const char *run_id, const scene *s,
                              const api_curve *curve, double **ret_figures, bf_error *err)
{
    const size_t n = figure_values(s);
    bf_buffer text = { 0 };

    double *figures = memory_alloc(n, sizeof *figures);
    if (figures == NULL)
        return bf_fail_memory(err);
    bf_status status =
        store_read_text(t->owner->options.store, run_id, API_TEXT_FIGURES, &text, err);
    if (status == BF_OK)
        status = key_figures_read(text.bytes, text.n, curve->columns.bytes, n, figures, err);
    buffer_fini(&text);
    if (status == BF_OK)
        *ret_figures = figures;
    else
        memory_free(figures);
    return status;
}

static bf_status read_values(study__task *t, const char *run_id, const scene *s, double *ret_values,
                             bf_error *err)
{
    const uint64_t n_most = t->document.n_curves > 0 ? UINT64_MAX : 0;
    api_curve curve = { .n = 0 };
    double *figures = NULL;

    bf_status status = store_read_curve(t->owner->options.store, run_id, 0, n_most, &curve, err);
    if (status == BF_OK)
        status = read_figures(t, run_id, s, &curve, &figures, err);
    if (status == BF_OK) {
        const study_document_outcome outcome = {
            .scene = s,
            .figures = figures,
            .n = curve.n,
            .t = (const double *)(const void *)curve.t.bytes,
            .n_columns = curve.n_columns,
            .columns = (const double *)(const void *)curve.values.bytes,
        };
        status = study_document_values(&t->document, &outcome, ret_values, err);
    }
    memory_free(figures);
    api_curve_fini(&curve);
    return status;
}

static bf_status take_success(study__task *t, api_trial *trial, bf_error *err)
{
    scene s;

    BF_TRY(make_scene(t, trial, &s, err));
    bf_status status = read_values(t, trial->run, &s, trial->values, err);
    scene_fini(&s);
    return status;
}

static bool is_hopeless(study__task *t, const api_trial *trial, const api_run *record)
{
    api_curve curve = { .n = 0 };
    double *figures = NULL;
    bool is_so = false;
    scene s;

    if (!t->document.method.is_pruning || isnan(t->best) || record->figures[0] == '\0' ||
        make_scene(t, trial, &s, NULL) != BF_OK)
        return false;
    // Until its last sample: the figures are those of a time between that and the next one.
    if (store_read_curve(t->owner->options.store, trial->run,
                         record->n_samples > 0 ? record->n_samples - 1 : 0, 1, &curve,
                         NULL) == BF_OK &&
        curve.n == 1 && read_figures(t, trial->run, &s, &curve, &figures, NULL) == BF_OK)
        is_so = study_document_is_hopeless(
            &t->document, &s, ((const double *)(const void *)curve.t.bytes)[0], figures, t->best);
    memory_free(figures);
    api_curve_fini(&curve);
    scene_fini(&s);
    return is_so;
}

static bf_status take_end(study__task *t, study__open *open, const api_run *record, bf_error *err)
{
    api_trial *trial = &open->trial;

    trial->state = open->is_pruned ? API_TRIAL_PRUNED : API_TRIAL_CANCELLED;
    if (record->state == RUN_FAILED) {
        trial->state = API_TRIAL_FAILED;
        trial->fault = record->error;
    }
    if (record->state != RUN_SUCCEEDED)
        return BF_OK;
    trial->state = API_TRIAL_SUCCEEDED;
    bf_status status = take_success(t, trial, err);
    // Of a run whose owner has removed it in between nothing can be told.
    if (status == BF_ENOTFOUND || status == BF_ECONFLICT || status == BF_ECORRUPT) {
        trial->state = API_TRIAL_FAILED;
        (void)bf_fail(&trial->fault, status, "", "the results of its run cannot be read");
        return BF_OK;
    }
    return status;
}

bf_status study__look(study__task *t, study__open *open, bool *ret_has_ended, bf_error *err)
{
    store *s = t->owner->options.store;
    api_run record = { .state = RUN_CANCELLED };

    *ret_has_ended = false;
    bf_status status = store_find(s, open->trial.run, &record, err);
    if (status == BF_ENOTFOUND)
        record.state = RUN_CANCELLED; // it was removed
    else if (status != BF_OK)
        return status;
    *ret_has_ended = run_state_is_end(record.state);
    if (*ret_has_ended)
        return take_end(t, open, &record, err);
    if (record.state != RUN_RUNNING || open->is_pruned || !is_hopeless(t, &open->trial, &record))
        return BF_OK;
    status = store_cancel(s, open->trial.run, API_ANY_REVISION, &record, err);
    open->is_pruned = status == BF_OK;
    return status == BF_ECONFLICT || status == BF_ENOTFOUND ? BF_OK : status; // it has just ended
}
