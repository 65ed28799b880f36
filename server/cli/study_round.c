#include "server/cli/study_round.h"

#include "core/base/memory.h"
#include "server/run/run_control.h"

#include <math.h>
#include <pthread.h>
#include <string.h>

// Of find_requested() between looks at the key figures of a run that may be pruned.
enum { PRUNING_CALLS = 64 };

// What the threads have in common.
typedef struct common {
    study_round *round;
    pthread_mutex_t lock; // of all below, of the document and of round->ended
    size_t next;          // trial to begin
    double best;          // objective of a trial that has ended; NAN: none
    bf_status status;     // of the first failure
    bf_error err;
} common;

// A run that is being solved: what is taken from its frames.
typedef struct solving {
    common *common;
    const scene *scene;
    run_control control;
    bf_buffer figures; // values of the newest FRAME_FIGURES
    bool has_curve;    // it is wanted
    bf_buffer t;       // its times
    bf_buffer columns; // and rows
    size_t n_columns;
    bool is_pruning;
    unsigned n_calls;
    bool is_hopeless; // it is pruned
    bool is_stopped;
} solving;

// True if the run cannot become better than the best trial any more.
static bool is_hopeless(const solving *s, const frame_figures *figures)
{
    common *c = s->common;

    pthread_mutex_lock(&c->lock);
    const bool is_so = study_document_is_hopeless(c->round->document, s->scene, figures->t,
                                                  figures->values, c->best);
    pthread_mutex_unlock(&c->lock);
    return is_so;
}

static bf_status on_frame(void *context, const frame *f, bf_error *err)
{
    solving *s = context;
    bf_status status = BF_OK;

    if (f->type == FRAME_FIGURES) {
        s->figures.n = 0;
        status =
            buffer_append(&s->figures, f->figures.values, f->figures.n * sizeof *f->figures.values);
        s->is_hopeless = is_hopeless(s, &f->figures);
    } else if (f->type == FRAME_CURVE && s->has_curve) {
        s->n_columns = f->curve.n_columns;
        status = buffer_append(&s->t, f->curve.t, f->curve.n * sizeof *f->curve.t);
        if (status == BF_OK)
            status =
                buffer_append(&s->columns, f->curve.values,
                              (size_t)f->curve.n * f->curve.n_columns * sizeof *f->curve.values);
    } else if (f->type == FRAME_END) {
        s->is_stopped = f->end.stopped;
    }
    return status == BF_OK ? BF_OK : bf_fail_memory(err);
}

static unsigned find_requested(void *context)
{
    solving *s = context;

    if (s->is_hopeless)
        return RUN_STOP;
    const unsigned request = run_control_requested(&s->control);
    return s->is_pruning && ++s->n_calls % PRUNING_CALLS == 0 ? request | RUN_REPORT : request;
}

static bf_status solve(const study_document *document, const scene *trial_scene, run_model model,
                       solving *s, double *ret_values, bf_error *err)
{
    const run_sink sink = { .context = s, .on_frame = on_frame, .requested = find_requested };
    run *r = NULL;

    bf_status status = run_create(trial_scene, model, 1, &r, err);
    if (status == BF_OK)
        status = run_execute(r, &sink, err);
    run_destroy(r);
    if (status != BF_OK || s->is_stopped)
        return status;
    const study_document_outcome outcome = {
        .scene = trial_scene,
        .figures = (const double *)(const void *)s->figures.bytes,
        .n = s->t.n / sizeof(double),
        .t = (const double *)(const void *)s->t.bytes,
        .n_columns = s->n_columns,
        .columns = (const double *)(const void *)s->columns.bytes,
    };
    return study_document_values(document, &outcome, ret_values, err);
}

static void fail(common *c, bf_status status, const bf_error *err)
{
    if (c->status == BF_OK) {
        c->status = status;
        c->err = *err;
    }
}

// Take the next trial and make its scenario. False: there is none. One whose scenario is not valid is infeasible.
static bool begin(common *c, api_trial *ret_trial, scene *ret_scene)
{
    study_round *t = c->round;
    bf_faults *faults = NULL;

    if (c->next == t->n || c->status != BF_OK || run_control_is_stopped())
        return false;
    faults = memory_alloc(1, sizeof *faults);
    if (faults == NULL) {
        fail(c, BF_ENOMEM, &(bf_error){ .code = BF_ENOMEM, .text = "out of memory" });
        return false;
    }
    const size_t number = t->trials[c->next++];
    const study_trial trial = study_trial_at(t->study, number);
    const study_point point = study_point_at(t->study, trial.point);
    study_trial_of(t->document, t->study, number, ret_trial);
    bf_status status = study_document_scene(t->document, point.at, trial.substream,
                                            ret_trial->model, ret_scene, faults, &ret_trial->fault);
    memory_free(faults);
    ret_trial->state = status == BF_OK ? API_TRIAL_RUNNING : API_TRIAL_INFEASIBLE;
    if (status == BF_OK || status == BF_EINPUT || status == BF_ELIMIT)
        return true;
    fail(c, status, &ret_trial->fault);
    return false;
}

static void end(common *c, const api_trial *trial)
{
    bf_error err = { 0 };

    c->best = study_document_better(c->round->document, c->best, trial->values[0]);
    const bf_status status = c->round->ended(c->round->context, trial, &err);
    if (status != BF_OK)
        fail(c, status, &err);
}

static void solve_trial(common *c, const scene *s, solving *job, api_trial *trial)
{
    const study_document *document = c->round->document;

    job->common = c;
    job->scene = s;
    job->is_pruning = document->method.is_pruning;
    job->control = run_control_init(INT64_MAX / 2000000, 0);
    job->has_curve = document->n_curves > 0;
    if (solve(document, s, trial->model, job, trial->values, &trial->fault) == BF_OK) {
        trial->state = job->is_stopped ? API_TRIAL_PRUNED : API_TRIAL_SUCCEEDED;
        return;
    }
    trial->state = API_TRIAL_FAILED;
    for (size_t k = 0; k < STUDY_VALUES; k++)
        trial->values[k] = (double)NAN;
}

static void *work(void *argument)
{
    common *c = argument;

    for (;;) {
        solving s = { 0 };
        api_trial trial;
        scene trial_scene;

        pthread_mutex_lock(&c->lock);
        const bool has_trial = begin(c, &trial, &trial_scene);
        pthread_mutex_unlock(&c->lock);
        if (!has_trial)
            return NULL;
        if (trial.state == API_TRIAL_RUNNING) {
            solve_trial(c, &trial_scene, &s, &trial);
            scene_fini(&trial_scene);
        }
        pthread_mutex_lock(&c->lock);
        if (trial.fault.code == BF_ENOMEM)
            fail(c, BF_ENOMEM, &trial.fault);
        else if (!s.is_stopped || s.is_hopeless)
            end(c, &trial);
        pthread_mutex_unlock(&c->lock);
        buffer_fini(&s.figures);
        buffer_fini(&s.t);
        buffer_fini(&s.columns);
    }
}

bf_status study_round_solve(study_round *t, bf_error *err)
{
    common c = { .round = t, .status = BF_OK, .best = (double)NAN };
    pthread_t threads[STUDY_DOCUMENT_WORKERS];
    const size_t n = t->n < (size_t)t->n_workers ? t->n : (size_t)t->n_workers;
    size_t n_begun = 0;

    for (size_t k = 0; k < study_trials(t->study); k++)
        c.best = study_document_better(t->document, c.best, study_values(t->study, k)[0]);
    pthread_mutex_init(&c.lock, NULL);
    while (n_begun + 1 < n && pthread_create(&threads[n_begun], NULL, work, &c) == 0)
        n_begun++;
    work(&c);
    while (n_begun > 0)
        pthread_join(threads[--n_begun], NULL);
    pthread_mutex_destroy(&c.lock);
    if (c.status != BF_OK)
        return bf_fail(err, c.status, c.err.pointer, "%s", c.err.text);
    return BF_OK;
}
