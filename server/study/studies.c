// The thread, and which studies are at work. What is asked of studies stands in the store; nothing here is lost with the
// daemon.

#include "server/study/studies.h"

#include "core/base/check.h"
#include "core/base/memory.h"
#include "server/base/clock.h"
#include "server/base/log.h"
#include "server/base/thread.h"
#include "server/study/studies_priv.h"

#include <string.h>

enum {
    RETRY_MS = 1000,   // after a failure of the machine
    REMOVAL_MS = 10,   // between steps of the removal of a study whose runs are to end first
    STOPS_A_TURN = 64, // studies that are to end or to be removed
    EXPIRY_MS = 60000  // between looks at studies that are too old
};

void studies__look_again(studies *s, int64_t after_ms)
{
    const int64_t at_ms = clock_monotonic_ms() + after_ms;

    if (s->again_ms < 0 || at_ms < s->again_ms)
        s->again_ms = at_ms;
}

static void log_trouble(const char *event, const char *id, const bf_error *err)
{
    char quoted[LOG_QUOTED_SIZE];

    log_event(LOG_LEVEL_ERROR, event, "study=%s error=%s", id, log_quote(err->text, quoted));
}

static void drop_task(studies *s, size_t index)
{
    lock_acquire(&s->lock);
    study__task *t = s->tasks[index];
    s->tasks[index] = s->tasks[--s->n_tasks];
    lock_release(&s->lock);
    study__task_destroy(t);
}

static size_t find_task(const studies *s, const char *id)
{
    size_t k = 0;

    while (k < s->n_tasks && strcmp(s->tasks[k]->id, id) != 0)
        k++;
    return k;
}

// Trials that are open, as they end with their study.
typedef struct ending {
    size_t n;
    api_trial trials[STUDIES_OPEN_MAX];
} ending;

static bf_status take_open(void *context, const api_trial *trial, bf_error *err)
{
    ending *e = context;

    (void)err;
    e->trials[e->n] = *trial;
    e->trials[e->n++].state = API_TRIAL_CANCELLED;
    return BF_OK;
}

// End a study with all its open trials.
static bf_status end_study(studies *s, const char *id, api_study_state state, const bf_error *why,
                           bf_error *err)
{
    const api_trial_query open = { .order = API_TRIALS_OPEN, .limit = STUDIES_OPEN_MAX };
    ending *e = memory_alloc(1, sizeof *e);
    store *at = s->options.store;
    api_study after;
    api_run record;

    if (e == NULL)
        return bf_fail_memory(err);
    bf_status status = store_read_trials(at, id, &open, take_open, e, err);
    for (size_t k = 0; k < e->n && status == BF_OK; k++) {
        status = store_cancel(at, e->trials[k].run, API_ANY_REVISION, &record, err);
        if (status == BF_ECONFLICT || status == BF_ENOTFOUND)
            status = BF_OK; // it has ended
    }
    const store_study_step step = { .id = id,
                                    .n_ends = e->n,
                                    .ends = e->trials,
                                    .state = state,
                                    .error = why == NULL ? (bf_error){ .code = BF_OK } : *why };
    if (status == BF_OK)
        status = store_step_study(at, &step, &after, err);
    memory_free(e);
    return status == BF_ECONFLICT ? BF_OK : status; // it has ended
}

bool studies__goes_on(studies *s)
{
    liveness_answer(&s->liveness);
    lock_acquire(&s->lock);
    const bool goes_on = !s->is_stopping;
    lock_release(&s->lock);
    return goes_on;
}

// Remove some runs of a study, and the study with the last of them. *ret_is_over: nothing is left.
static bf_status remove_study(studies *s, const char *id, bool *ret_is_over, bf_error *err)
{
    bool has_runs = false;

    bf_status status = store_remove_runs_of_study(s->options.store, id, &has_runs, err);
    if (status == BF_OK && !has_runs) {
        *ret_is_over = true;
        status = store_forget_study(s->options.store, id, err);
    }
    return status == BF_ECONFLICT || status == BF_ENOTFOUND ? BF_OK : status; // it is ending
}

// A study that is to be stopped has its place no more, and ends.
static bf_status cancel_study(studies *s, const store_study *work)
{
    const char *id = work->study.id;
    const size_t index = find_task(s, id);
    bf_error err = { 0 };

    if (index < s->n_tasks)
        drop_task(s, index);
    if (api_study_state_is_end(work->study.state))
        return BF_OK;
    bf_status status = end_study(s, id, API_STUDY_CANCELLED, NULL, &err);
    if (status != BF_OK)
        log_trouble("study_not_stopped", id, &err);
    else if (work->stop_request != STORE_STOP_KILL)
        log_event(LOG_LEVEL_INFO, "study_cancelled", "study=%s", id);
    return status;
}

static bf_status take_away(studies *s, const store_study *work)
{
    bool is_over = false;
    bf_error err = { 0 };

    bf_status status = remove_study(s, work->study.id, &is_over, &err);
    if (status != BF_OK)
        log_trouble("study_not_stopped", work->study.id, &err);
    else if (is_over)
        log_event(LOG_LEVEL_INFO, "study_removed", "study=%s", work->study.id);
    if (status == BF_OK && !is_over)
        studies__look_again(s, REMOVAL_MS);
    return status;
}

// Ends come before removals, which may take long; of these the one after the other has a step, so that none keeps what is
// asked meanwhile waiting.
static bf_status stop_studies(studies *s, bf_error *err)
{
    const int64_t until_ms = clock_monotonic_ms() + STUDIES_TURN_MS;
    store_study *work = memory_alloc(STOPS_A_TURN, sizeof *work);
    bool is_late = false;
    size_t n = 0;

    if (work == NULL)
        return bf_fail_memory(err);
    bf_status status =
        store_list_work(s->options.store, STORE_STUDIES_TO_STOP, STOPS_A_TURN, work, &n, err);
    bool has_trouble = false;
    for (size_t k = 0; k < n && status == BF_OK && studies__goes_on(s); k++)
        has_trouble = cancel_study(s, &work[k]) != BF_OK || has_trouble;
    for (size_t k = 0; k < n && status == BF_OK && !is_late && studies__goes_on(s); k++) {
        const store_study *next = &work[(s->n_removals + k) % n];
        if (next->stop_request == STORE_STOP_KILL)
            has_trouble = take_away(s, next) != BF_OK || has_trouble;
        is_late = clock_monotonic_ms() >= until_ms;
        s->n_removals += is_late ? k + 1 : 0;
    }
    if (is_late || n == STOPS_A_TURN)
        studies__look_again(s, 0);
    if (has_trouble)
        studies__look_again(s, RETRY_MS);
    memory_free(work);
    return status;
}

// What is wrong with a study ends it; what is wrong with the machine may pass.
static void handle_trouble(studies *s, const char *id, const bf_error *why)
{
    bf_error err = { 0 };

    log_trouble("study_trouble", id, why);
    if (!study__may_work_later(why->code) && end_study(s, id, API_STUDY_FAILED, why, &err) != BF_OK)
        log_trouble("study_not_stopped", id, &err);
    studies__look_again(s, RETRY_MS);
}

static void begin_study(studies *s, const api_study *about)
{
    const store_study_step start = { .id = about->id, .state = API_STUDY_RUNNING };
    study__task *t = NULL;
    bf_error err = { 0 };
    api_study after;

    bf_status status = BF_OK;
    if (about->state == API_STUDY_QUEUED)
        status = store_step_study(s->options.store, &start, &after, &err);
    if (status == BF_OK)
        status = study__task_create(s, about, &t, &err);
    if (status == BF_ECONFLICT || status == BF_ENOTFOUND)
        return; // it has ended, or is to be stopped
    if (status != BF_OK) {
        handle_trouble(s, about->id, &err);
        return;
    }
    log_event(LOG_LEVEL_INFO, "study_at_work", "study=%s trials=%llu", about->id,
              (unsigned long long)t->n_begun);
    lock_acquire(&s->lock);
    s->tasks[s->n_tasks++] = t;
    lock_release(&s->lock);
    // Trials that it began before it was paused wait, and may be solved again.
    s->options.queued(s->options.context);
}

static size_t count_of_owner(const studies *s, const char *owner)
{
    size_t n = 0;

    for (size_t k = 0; k < s->n_tasks; k++)
        n += strcmp(s->tasks[k]->owner_name, owner) == 0;
    return n;
}

// Where all places are taken and an owner has none, the owner who has most gives one of several to him: that study rests,
// and goes on when there is a place.
static void free_place(studies *s, const api_study *to)
{
    size_t most = 1, index = s->n_tasks;

    if (s->n_tasks < STUDIES_AT_WORK || count_of_owner(s, to->owner) > 0)
        return;
    for (size_t k = 0; k < s->n_tasks; k++) {
        const size_t n = count_of_owner(s, s->tasks[k]->owner_name);
        if (n > most || (n == most && n > 1)) {
            most = n;
            index = k;
        }
    }
    if (index == s->n_tasks)
        return;
    log_event(LOG_LEVEL_INFO, "study_leaves_place", "study=%s to=%s", s->tasks[index]->id, to->id);
    drop_task(s, index);
}

// Those that were running go on before others begin.
static bf_status begin_studies(studies *s, store_studies which, bf_error *err)
{
    store_study work[STUDIES_AT_WORK];
    size_t n = 0;

    BF_TRY(store_list_work(s->options.store, which, STUDIES_AT_WORK, work, &n, err));
    for (size_t k = 0; k < n; k++) {
        if (find_task(s, work[k].study.id) < s->n_tasks)
            continue;
        free_place(s, &work[k].study);
        if (s->n_tasks < STUDIES_AT_WORK)
            begin_study(s, &work[k].study);
    }
    return BF_OK;
}

static bf_status expire_studies(studies *s, bf_error *err)
{
    bf_status status = BF_OK;
    char id[API_ID_SIZE];

    lock_acquire(&s->lock);
    const int64_t age_ms = s->options.age_ms;
    lock_release(&s->lock);
    while (age_ms > 0 && status == BF_OK && studies__goes_on(s)) {
        status = store_find_old_study(s->options.store, clock_unix_ms() - age_ms, id, err);
        if (status == BF_OK)
            status = store_remove_study(s->options.store, id, API_ANY_REVISION, err);
        if (status == BF_OK)
            log_event(LOG_LEVEL_INFO, "study_expired", "study=%s", id);
    }
    if (age_ms > 0)
        studies__look_again(s, EXPIRY_MS);
    return status == BF_ENOTFOUND ? BF_OK : status;
}

static void advance_studies(studies *s)
{
    bf_error err = { 0 };

    bf_status status = expire_studies(s, &err);
    if (status == BF_OK)
        status = stop_studies(s, &err);
    if (status == BF_OK)
        status = begin_studies(s, STORE_STUDIES_RUNNING, &err);
    if (status == BF_OK)
        status = begin_studies(s, STORE_STUDIES_QUEUED, &err);
    if (status == BF_OK)
        return;
    log_trouble("studies_not_read", "", &err);
    studies__look_again(s, RETRY_MS);
}

// True if a study has left its place to another.
static bool work_on_tasks(studies *s)
{
    bool has_place = false;

    for (size_t k = 0; k < s->n_tasks;) {
        char id[API_ID_SIZE];
        bool is_over = false, has_more = false;
        bf_error err = { 0 };
        memcpy(id, s->tasks[k]->id, sizeof id);
        if (!studies__goes_on(s))
            break;
        bf_status status = study__task_turn(s->tasks[k], &is_over, &has_more, &err);
        if (status == BF_EBUSY && !studies__goes_on(s))
            break;
        if (has_more) { // the thread goes round once more without being woken
            lock_acquire(&s->lock);
            s->has_changes = true;
            lock_release(&s->lock);
        }
        if (status == BF_OK && !is_over) {
            k++;
            continue;
        }
        has_place = true;
        drop_task(s, k);
        if (status == BF_OK)
            log_event(LOG_LEVEL_INFO, "study_at_rest", "study=%s", id);
        else if (status != BF_ECONFLICT && status != BF_ENOTFOUND) // else it is to be stopped
            handle_trouble(s, id, &err);
    }
    return has_place;
}

// Wait until something has happened. *ret_has_news: something is asked of studies. False: the thread is to end.
static bool await_work(studies *s, bool *ret_has_news)
{
    bool is_time = false;

    lock_acquire(&s->lock);
    while (!s->has_news && !s->has_changes && !s->is_stopping && !is_time) {
        is_time = !lock_wait(&s->woken, &s->lock, s->again_ms);
        liveness_answer(&s->liveness);
    }
    liveness_answer(&s->liveness);
    *ret_has_news = s->has_news || (s->again_ms >= 0 && clock_monotonic_ms() >= s->again_ms);
    s->has_news = s->has_changes = false;
    const bool goes_on = !s->is_stopping;
    lock_release(&s->lock);
    if (*ret_has_news)
        s->again_ms = -1;
    return goes_on;
}

static void *run_loop(void *context)
{
    studies *s = context;
    bool has_news = false;

    while (await_work(s, &has_news)) {
        if (has_news)
            advance_studies(s);
        if (work_on_tasks(s))
            studies_wake(s);
    }
    return NULL;
}

bf_status studies_start(const studies_options *options, studies **ret_studies, bf_error *err)
{
    studies *s = memory_alloc(1, sizeof *s);

    if (s == NULL)
        return bf_fail(err, BF_ENOMEM, "", "no memory for studies");
    s->options = *options;
    s->again_ms = -1;
    s->has_news = true;
    lock_init(&s->lock);
    lock_condition_init(&s->woken);
    const bf_status status = thread_start(&s->thread, run_loop, s, "studies", err);
    if (status == BF_OK) {
        *ret_studies = s;
        return BF_OK;
    }
    lock_condition_fini(&s->woken);
    lock_fini(&s->lock);
    memory_free(s);
    return status;
}

void studies_reconfigure(studies *s, unsigned n_workers, int64_t age_ms)
{
    lock_acquire(&s->lock);
    s->options.n_workers = n_workers;
    s->options.age_ms = age_ms;
    s->has_news = true;
    lock_wake_all(&s->woken);
    lock_release(&s->lock);
}

void studies_wake(studies *s)
{
    lock_acquire(&s->lock);
    s->has_news = true;
    lock_wake_all(&s->woken);
    lock_release(&s->lock);
}

void studies_notify(studies *s, const char *run_id)
{
    lock_acquire(&s->lock);
    for (size_t k = 0; k < s->n_tasks; k++) {
        for (size_t i = 0; i < s->tasks[k]->n_open; i++) {
            study__open *open = &s->tasks[k]->open[i];
            if (strcmp(open->trial.run, run_id) != 0)
                continue;
            open->is_changed = s->has_changes = true;
            lock_wake_all(&s->woken);
        }
    }
    lock_release(&s->lock);
}

bool studies_is_alive(studies *s)
{
    const bool is_alive = !liveness_is_asked(&s->liveness);

    lock_acquire(&s->lock);
    liveness_ask(&s->liveness);
    lock_wake_all(&s->woken);
    lock_release(&s->lock);
    return is_alive;
}

studies *studies_stop(studies *s)
{
    if (s == NULL)
        return NULL;
    atomic_store(&s->is_abandoned, true);
    lock_acquire(&s->lock);
    s->is_stopping = true;
    lock_wake_all(&s->woken);
    lock_release(&s->lock);
    BF_CHECK(pthread_join(s->thread, NULL) == 0);
    while (s->n_tasks > 0)
        drop_task(s, s->n_tasks - 1);
    lock_condition_fini(&s->woken);
    lock_fini(&s->lock);
    memory_free(s);
    return NULL;
}
