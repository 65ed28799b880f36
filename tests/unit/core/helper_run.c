#include "tests/unit/core/helper_run.h"

#include "core/advice/plausible.h"
#include "core/base/check.h"
#include "core/base/digest.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void keep_curve(helper_run_log *log, const frame_curve *c)
{
    BF_CHECK(c->first == log->n_samples && c->n_columns <= HELPER_RUN_COLUMNS);
    BF_CHECK(log->n_samples + c->n <= HELPER_RUN_SAMPLES);
    for (size_t k = 0; k < c->n; k++) {
        log->t[log->n_samples] = c->t[k];
        memcpy(log->values[log->n_samples++], c->values + k * c->n_columns,
               c->n_columns * sizeof(double));
    }
}

static void keep_snapshot(helper_run_log *log, const frame_snapshot *s)
{
    BF_CHECK(s->index == log->n_snapshots && s->index < HELPER_RUN_SAMPLES);
    log->peaks[log->n_snapshots++] = s->peak;
    log->snapshot_digest = digest_add(log->snapshot_digest, &s->t, sizeof s->t);
    log->snapshot_digest =
        digest_add(log->snapshot_digest, s->rho, (size_t)s->n1 * s->n2 * sizeof *s->rho);
}

static void keep_parts(helper_run_log *log, const frame_parts *p)
{
    size_t n = (size_t)p->n_parts * p->n_values;

    // Parts come right after their snapshot.
    BF_CHECK(p->index + 1 == log->n_snapshots);
    log->parts_digest = digest_add(log->parts_digest, &p->t, sizeof p->t);
    log->parts_digest = digest_add(log->parts_digest, p->rows, n * sizeof *p->rows);
    free(log->parts);
    log->parts = malloc(n * sizeof *p->rows + 1);
    BF_CHECK(log->parts != NULL);
    if (n > 0)
        memcpy(log->parts, p->rows, n * sizeof *p->rows);
    log->n_present = 0;
    for (uint64_t k = 0; k < p->n_parts; k++)
        log->n_present += isnan(p->rows[k * p->n_values]) ? 0 : 1;
}

static void keep_change(helper_run_log *log, const frame_change *c)
{
    BF_CHECK(c->index == log->n_changes && c->index < HELPER_RUN_CHANGES);
    log->changes[log->n_changes++] = *c;
}

static bf_status take(void *context, const frame *f, bf_error *err)
{
    helper_run_log *log = context;

    log->n_frames[f->type]++;
    if (f->type == FRAME_BEGIN)
        log->begin = f->begin;
    if (f->type == FRAME_CURVE)
        keep_curve(log, &f->curve);
    if (f->type == FRAME_SNAPSHOT)
        keep_snapshot(log, &f->snapshot);
    if (f->type == FRAME_PARTS)
        keep_parts(log, &f->parts);
    if (f->type == FRAME_CHANGE)
        keep_change(log, &f->change);
    if (f->type == FRAME_FIGURES) {
        BF_CHECK(f->figures.n <= HELPER_RUN_FIGURES);
        log->n_figures = f->figures.n;
        memcpy(log->figures, f->figures.values, f->figures.n * sizeof *log->figures);
    }
    if (f->type == FRAME_END)
        log->end = f->end;
    if (f->type == FRAME_CHECKPOINT) {
        log->checkpoint.n = 0;
        return buffer_append(&log->checkpoint, f->bytes.bytes, f->bytes.n);
    }
    return BF_OK;
}

static unsigned requested(void *context)
{
    helper_run_log *log = context;

    log->n_askings++;
    if (log->stop_at != 0 && log->n_askings == log->stop_at)
        return RUN_CHECKPOINT | RUN_STOP;
    return log->report_every != 0 && log->n_askings % log->report_every == 0 ? RUN_REPORT
                                                                             : RUN_GO_ON;
}

bf_status helper_run(const scene *s, int n_threads, int resume, helper_run_log *log)
{
    const run_sink sink = { log, take, requested };
    run *r = NULL;
    bf_status status = resume == 0 ? run_create(s, log->model, n_threads, &r, NULL)
                                   : run_resume(s, log->model, n_threads, log->checkpoint.bytes,
                                                log->checkpoint.n, &r, NULL);

    if (status == BF_OK)
        status = run_execute(r, &sink, NULL);
    // What every run that is done says of itself is what its scenario lets expect.
    if (status == BF_OK && log->end.stopped == 0)
        BF_CHECK(plausible_end(s, log->model, &log->begin, &log->end, NULL) == BF_OK);
    run_destroy(r);
    return status;
}

static helper_run_log *new_log(run_model model)
{
    helper_run_log *log = calloc(1, sizeof *log);

    BF_CHECK(log != NULL);
    log->model = model;
    return log;
}

helper_run_log *helper_run_check_stops(const scene *s, run_model model, uint64_t n, uint64_t step,
                                       helper_run_threads threads)
{
    helper_run_log *whole = new_log(model);

    BF_CHECK(helper_run(s, 1, 0, whole) == BF_OK);
    for (uint64_t k = 1; k < n; k += step) {
        helper_run_log *log = new_log(model);
        log->stop_at = 1 + k * whole->n_askings / n;
        BF_CHECK(helper_run(s, threads.before, 0, log) == BF_OK && log->end.stopped == 1);
        log->stop_at = 0;
        BF_CHECK(helper_run(s, threads.after, 1, log) == BF_OK);
        BF_CHECK(helper_run_is_same(log, whole));
        helper_run_free(log);
    }
    return whole;
}

const double *helper_run_at(const helper_run_log *log, double t)
{
    for (size_t k = 0; k < log->n_samples; k++)
        if (fabs(log->t[k] - t) < 1e-9)
            return log->values[k];
    BF_CHECK(!"a sample at that time");
    return NULL;
}

bool helper_run_is_same(const helper_run_log *a, const helper_run_log *b)
{
    return a->n_samples == b->n_samples && memcmp(a->t, b->t, a->n_samples * sizeof *a->t) == 0 &&
           memcmp(a->values, b->values, a->n_samples * sizeof *a->values) == 0 &&
           a->n_snapshots == b->n_snapshots && a->snapshot_digest == b->snapshot_digest &&
           a->parts_digest == b->parts_digest && a->n_changes == b->n_changes &&
           memcmp(a->changes, b->changes, sizeof a->changes) == 0 && a->n_figures == b->n_figures &&
           memcmp(a->figures, b->figures, a->n_figures * sizeof *a->figures) == 0 &&
           memcmp(&a->end, &b->end, sizeof a->end) == 0;
}

void helper_run_free(helper_run_log *log)
{
    buffer_fini(&log->checkpoint);
    free(log->parts);
    free(log);
}
