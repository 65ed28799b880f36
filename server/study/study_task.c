// One study: what its trials found is told to core/study in the order of their ends, which does not matter there, and
// trials are put into the queue by their numbers. A turn writes both in one transaction.

#include "server/study/studies_priv.h"

#include "api/scenario/submission.h"
#include "api/study/study_best.h"
#include "api/study/study_trial.h"
#include "core/base/check.h"
#include "core/base/memory.h"
#include "server/base/clock.h"

#include <math.h>
#include <string.h>

enum {
    BEST_MS = 1000,       // between what was found so far
    BEGINS_MAX = 64,      // trials that begin in a step
    AHEAD_OF_WORKERS = 4, // trials that wait or run for each worker
    HELD_MS = 60000,      // between looks at an owner without CPU time
};

/// What a turn writes.
typedef struct study__turn {
    api_study about;                        ///< as it is
    size_t n_ends;                          ///< of open trials
    size_t n_begins;                        ///< of new ones
    api_trial ends[STUDIES_OPEN_MAX];       ///< n_ends
    store_trial_begin begins[BEGINS_MAX];   ///< n_begins
    api_submission submissions[BEGINS_MAX]; ///< of those that are not infeasible
    bf_buffer best;                         ///< n = 0: it is not due
    int64_t cpu_ns;                         ///< CPU time that making them took
} turn;

bool study__may_work_later(bf_status code)
{
    return code == BF_EBUSY || code == BF_ENOMEM || code == BF_ESYSTEM || code == BF_ENOSPACE;
}

static void tell(study__task *t, const api_trial *trial)
{
    study_tell(t->core, trial->number, trial->values);
    t->best = study_document_better(&t->document, t->best, trial->values[0]);
    t->n_told++;
    t->has_news = true;
}

// Without a lock: nobody else knows the task yet, or the caller has it.
static void add_open(study__task *t, const api_trial *trial)
{
    BF_CHECK(t->n_open < STUDIES_OPEN_MAX);
    t->open[t->n_open++] = (study__open){ .trial = *trial, .is_changed = true };
}

static bool are_same(const api_trial *a, const api_trial *b)
{
    return a->point == b->point && a->model == b->model && a->substream == b->substream &&
           a->n_parameters == b->n_parameters && a->n_values == b->n_values &&
           memcmp(a->parameters, b->parameters, a->n_parameters * sizeof *a->parameters) == 0;
}

// A trial that an earlier session has made, by number.
static bf_status take_stored(void *context, const api_trial *stored, bf_error *err)
{
    study__task *t = context;
    api_trial made;

    if (stored->number == study_trials(t->core) && t->n_told == stored->number)
        BF_TRY(study_advance(t->core, err));
    if (stored->number < study_trials(t->core))
        study_trial_of(&t->document, t->core, stored->number, &made);
    if (stored->number >= study_trials(t->core) || stored->number != t->n_begun ||
        !are_same(stored, &made) || t->n_open == STUDIES_OPEN_MAX)
        return bf_fail(err, BF_ECORRUPT, "",
                       "trial %llu is not the one that this version of Beltflow would make",
                       (unsigned long long)stored->number);
    t->n_begun++;
    if (api_trial_state_is_end(stored->state))
        tell(t, stored);
    else
        add_open(t, stored);
    return BF_OK;
}

static bf_status replay(study__task *t, bf_error *err)
{
    api_trial_query query = { .limit = API_TRIALS_PAGE_MAX };
    bf_status status = BF_OK;

    do {
        query.from = t->n_begun;
        status = store_read_trials(t->owner->options.store, t->id, &query, take_stored, t, err);
    } while (status == BF_OK && t->n_begun == query.from + query.limit &&
             studies__goes_on(t->owner));
    return status;
}

static bf_status read_document(study__task *t, bf_error *err)
{
    bf_faults *faults = memory_alloc(1, sizeof *faults);
    bf_buffer text = { 0 };

    if (faults == NULL)
        return bf_fail_memory(err);
    bf_status status =
        store_read_study(t->owner->options.store, t->id, API_STUDY_DOCUMENT, &text, err);
    if (status == BF_OK)
        status = study_document_read(text.bytes, text.n, &t->document, faults, err);
    buffer_fini(&text);
    memory_free(faults);
    return status;
}

static bf_status prepare(study__task *t, bf_error *err)
{
    BF_TRY(read_document(t, err));
    const study_definition definition = study_document_definition(&t->document);
    BF_TRY(study_create(&definition, &t->core, err));
    return replay(t, err);
}

bf_status study__task_create(studies *s, const api_study *about, study__task **ret_task,
                             bf_error *err)
{
    study__task *t = memory_alloc(1, sizeof *t);

    if (t == NULL)
        return bf_fail_memory(err);
    t->owner = s;
    t->best = (double)NAN;
    memcpy(t->id, about->id, sizeof t->id);
    memcpy(t->owner_name, about->owner, sizeof t->owner_name);
    t->open = memory_alloc(STUDIES_OPEN_MAX, sizeof *t->open);
    t->turn = memory_alloc(1, sizeof *t->turn);
    bf_status status = t->open == NULL || t->turn == NULL ? bf_fail_memory(err) : prepare(t, err);
    if (status == BF_OK)
        *ret_task = t;
    else
        study__task_destroy(t);
    return status;
}

void study__task_destroy(study__task *t)
{
    if (t == NULL)
        return;
    study_destroy(t->core);
    study_document_fini(&t->document);
    memory_free(t->turn);
    memory_free(t->open);
    memory_free(t);
}

// The ends of trials whose runs have changed.
static bf_status take_ends(study__task *t, turn *u, bf_error *err)
{
    bf_status status = BF_OK;

    for (size_t k = 0; k < t->n_open && status == BF_OK;) {
        bool has_ended = false;
        lock_acquire(&t->owner->lock);
        const bool is_changed = t->open[k].is_changed;
        t->open[k].is_changed = false;
        lock_release(&t->owner->lock);
        if (is_changed)
            status = study__look(t, &t->open[k], &has_ended, err);
        if (status != BF_OK || !has_ended) {
            k++;
            continue;
        }
        u->ends[u->n_ends] = t->open[k].trial;
        tell(t, &u->ends[u->n_ends++]);
        lock_acquire(&t->owner->lock);
        t->open[k] = t->open[--t->n_open];
        lock_release(&t->owner->lock);
    }
    return status;
}

static size_t room_of(study__task *t)
{
    const size_t n_of_document = (size_t)t->document.workers;

    lock_acquire(&t->owner->lock);
    const size_t n_workers = t->owner->options.n_workers;
    lock_release(&t->owner->lock);
    size_t n = n_of_document > 0 ? n_of_document : AHEAD_OF_WORKERS * n_workers;
    if (n > STUDIES_OPEN_MAX)
        n = STUDIES_OPEN_MAX;
    // By half of them, so that a commit begins several.
    if (n_of_document == 0 && t->n_open > n / 2)
        return 0;
    return n > t->n_open ? n - t->n_open : 0;
}

static bf_status make_begin(study__task *t, turn *u, bf_error *err)
{
    const size_t k = u->n_begins;
    store_trial_begin *begin = &u->begins[k];
    api_trial *trial = &begin->trial;
    bf_error why = { 0 };

    *begin = (store_trial_begin){ .submission = NULL };
    study_trial_of(&t->document, t->core, t->n_begun + k, trial);
    bf_status status = study__submission(t, &u->about, trial, &u->submissions[k], &why);
    if (status == BF_OK) {
        begin->submission = &u->submissions[k];
    } else if (status == BF_EINPUT || status == BF_ELIMIT) {
        trial->state = API_TRIAL_INFEASIBLE;
        trial->fault = why;
    } else {
        return bf_fail(err, status, why.pointer, "%s", why.text);
    }
    u->n_begins++;
    return BF_OK;
}

// Making trials is work for the owner, as solving them is: without CPU time of his own nothing is begun.
static bool is_held(study__task *t, const turn *u)
{
    api_quotas quotas = { .owner = "" };

    if (store_read_quotas(t->owner->options.store, u->about.owner, &quotas, NULL) != BF_OK ||
        quotas.cpu_s.allowed == 0 || quotas.cpu_s.used < quotas.cpu_s.allowed)
        return false;
    studies__look_again(t->owner, HELD_MS);
    return true;
}

static bf_status make_begins(study__task *t, turn *u, bf_error *err)
{
    const size_t room = is_held(t, u) ? 0 : room_of(t);
    const int64_t until_ms = clock_monotonic_ms() + STUDIES_TURN_MS;
    const int64_t since_ns = clock_thread_cpu_ns();
    bf_status status = BF_OK;

    if (t->n_told == study_trials(t->core))
        status = study_advance(t->core, err);
    // Checking a scenario may take a while, and what is infeasible takes no room.
    do {
        if (status != BF_OK || u->n_begins >= room || u->n_begins >= BEGINS_MAX ||
            t->n_begun + u->n_begins >= study_trials(t->core) || !studies__goes_on(t->owner))
            break;
        status = make_begin(t, u, err);
    } while (clock_monotonic_ms() < until_ms);
    u->cpu_ns = clock_thread_cpu_ns() - since_ns;
    return status;
}

static bool has_ended(const study__task *t)
{
    return study_is_ended(t->core) && t->n_told == study_trials(t->core);
}

static bf_status write_turn(study__task *t, turn *u, bf_error *err)
{
    store_study_step step = { .id = t->id,
                              .n_ends = u->n_ends,
                              .ends = u->ends,
                              .n_begins = u->n_begins,
                              .begins = u->begins,
                              .best = u->best.n > 0 ? &u->best : NULL,
                              .cpu_s = 1e-9 * (double)u->cpu_ns,
                              .state = API_STUDY_STATES };

    if (has_ended(t) && study_best(t->core) == SIZE_MAX) {
        const bool is_fit = t->document.method.type == STUDY_CALIBRATE;
        char word[STUDY_DOCUMENT_COLUMN];
        study_document_column(&t->document, 0, word);
        step.state = API_STUDY_FAILED;
        (void)bf_fail(&step.error, BF_EINPUT, is_fit ? "/curves" : "/objectives/0/figure",
                      "no trial has a value of %s", word);
    } else if (has_ended(t)) {
        step.state = API_STUDY_SUCCEEDED;
    }
    if (u->n_ends == 0 && u->n_begins == 0 && step.best == NULL && step.state == API_STUDY_STATES)
        return BF_OK;
    return store_step_study(t->owner->options.store, &step, &u->about, err);
}

// True if none of the open trials is being solved.
static bool is_resting(const study__task *t)
{
    api_run record;

    for (size_t k = 0; k < t->n_open; k++)
        if (store_find(t->owner->options.store, t->open[k].trial.run, &record, NULL) == BF_OK &&
            record.state == RUN_RUNNING)
            return false;
    return true;
}

static bf_status take_turn(study__task *t, turn *u, bf_error *err)
{
    const bool is_running = u->about.state == API_STUDY_RUNNING;

    bf_status status = take_ends(t, u, err);
    if (status == BF_OK && is_running)
        status = make_begins(t, u, err);
    const int64_t now_ms = clock_monotonic_ms();
    if (status == BF_OK && (has_ended(t) || (t->has_news && now_ms >= t->best_ms + BEST_MS))) {
        t->has_news = false;
        t->best_ms = now_ms;
        status = study_best_write(&t->document, t->core, &u->best, err);
    }
    if (status == BF_OK)
        status = write_turn(t, u, err);
    if (status == BF_OK) {
        // What has begun is open, or told where it ended at once.
        lock_acquire(&t->owner->lock);
        for (size_t k = 0; k < u->n_begins; k++) {
            api_trial *trial = &u->begins[k].trial;
            if (!api_trial_state_is_end(trial->state))
                add_open(t, trial);
        }
        lock_release(&t->owner->lock);
        for (size_t k = 0; k < u->n_begins; k++) {
            t->n_begun++;
            if (api_trial_state_is_end(u->begins[k].trial.state))
                tell(t, &u->begins[k].trial);
        }
    }
    if (status == BF_OK && u->n_begins > 0)
        t->owner->options.queued(t->owner->options.context);
    return status;
}

bf_status study__task_turn(study__task *t, bool *ret_is_over, bool *ret_has_more, bf_error *err)
{
    turn *u = t->turn;

    bf_status status = store_find_study(t->owner->options.store, t->id, &u->about, err);
    if (status == BF_OK)
        status = take_turn(t, u, err);
    *ret_has_more = u->n_begins > 0;
    *ret_is_over = status == BF_OK && (api_study_state_is_end(u->about.state) ||
                                       (u->about.state != API_STUDY_RUNNING && is_resting(t)));
    for (size_t k = 0; k < u->n_begins; k++)
        submission_fini(&u->submissions[k]);
    u->n_begins = u->n_ends = 0;
    u->cpu_ns = 0;
    buffer_fini(&u->best);
    return status;
}
