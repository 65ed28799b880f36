// Runs that were asked for wait in a ring; what was found is in a table, each run or study at the place that its id says.

#include "server/run/predictor.h"

#include "api/scenario/scenario.h"
#include "core/advice/prediction_learn.h"
#include "core/base/check.h"
#include "core/base/digest.h"
#include "core/base/memory.h"
#include "server/base/clock.h"
#include "server/base/lock.h"
#include "server/base/log.h"
#include "server/base/thread.h"

#include <math.h>
#include <pthread.h>
#include <stdatomic.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

enum {
    LOWER_PRIORITY = 10,
    LEARNED_MAX = 16,  // trials that the mean of a study goes back to
    UNASKED_MS = 5000, // then all kinds are measured, so that who asks later need not wait
};

// For each kind; the fastest of the runs within it counts.
static const double measured_s = 0.03;

// A run or a study that was asked for.
typedef struct entry {
    char id[API_ID_SIZE]; // "": none
    double seconds;       // NAN: not known, or not yet
    unsigned n_learned;   // trials that `seconds` is the mean of; 0: it is predicted
} entry;

// A run to predict.
typedef struct question {
    char run_id[API_ID_SIZE];
    char id[API_ID_SIZE]; // of the entry
} question;

struct predictor {
    store *store;
    pthread_t thread;
    atomic_bool is_stopping;
    lock lock;                    // guards what follows
    lock_condition asked;         // for a run, or to stop
    bool has_speed;               // of every kind
    prediction_speed known_speed; // a copy of `speed`
    bool is_speed_asked;
    size_t n_waiting;                     // runs that were asked for and not predicted
    question waiting[PREDICTOR_RUNS_MAX]; // a ring
    size_t first;                         // of them
    // Each at the place of its id; a newer one takes an older one's.
    entry entries[PREDICTOR_RUNS_MAX];
    // The thread's own:
    prediction_speed speed; // factors of kinds that were not needed yet are 0
    prediction_learned learned;
    int64_t learned_ms;              // when the newest run that was learned from ended
    char learned_study[API_ID_SIZE]; // whose trial it was
};

static double read_cpu_s(void)
{
    struct timespec t;

    (void)clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

// The place of an id; *ret_is_known: what is there is of this id.
static entry *find_entry(predictor *p, const char *id, bool *ret_is_known)
{
    const uint64_t hash = digest_add(DIGEST_START, id, strlen(id));
    entry *e = &p->entries[hash % PREDICTOR_RUNS_MAX];

    lock_assert_held(&p->lock);
    *ret_is_known = strcmp(e->id, id) == 0;
    return e;
}

static void set_entry(entry *e, const char *id, double seconds, unsigned n_learned)
{
    memcpy(e->id, id, API_ID_SIZE);
    e->seconds = seconds;
    e->n_learned = n_learned;
}

// Let the thread predict a run that was not asked for before; where too many wait already it is asked for again later.
static void ask(predictor *p, entry *e, const char *run_id, const char *id)
{
    if (p->n_waiting == PREDICTOR_RUNS_MAX)
        return;
    question *q = &p->waiting[(p->first + p->n_waiting++) % PREDICTOR_RUNS_MAX];
    memcpy(q->run_id, run_id, API_ID_SIZE);
    memcpy(q->id, id, API_ID_SIZE);
    set_entry(e, id, (double)NAN, 0);
    lock_wake_one(&p->asked);
}

double predictor_seconds(predictor *p, const char *run_id, const char *study_id)
{
    const char *id = study_id[0] == '\0' ? run_id : study_id;
    bool is_known;

    lock_acquire(&p->lock);
    entry *e = find_entry(p, id, &is_known);
    const double seconds = is_known ? e->seconds : (double)NAN;
    if (!is_known)
        ask(p, e, run_id, id);
    lock_release(&p->lock);
    return seconds;
}

void predictor_learn(predictor *p, const char *study_id, double seconds)
{
    bool is_known;

    lock_acquire(&p->lock);
    entry *e = find_entry(p, study_id, &is_known);
    if (!is_known)
        set_entry(e, study_id, seconds, 0);
    e->n_learned += e->n_learned < LEARNED_MAX;
    e->seconds = e->n_learned == 1 ? seconds : e->seconds + (seconds - e->seconds) / e->n_learned;
    lock_release(&p->lock);
}

double predictor_queue_seconds(predictor *p, uint64_t n)
{
    store_queued runs[PREDICTOR_SAMPLE];
    size_t n_runs = 0, n_known = 0;
    double sum = 0.0;

    if (n == 0)
        return 0.0;
    if (store_list_queued(p->store, runs, PREDICTOR_SAMPLE, &n_runs, NULL) != BF_OK)
        return (double)NAN;
    for (size_t k = 0; k < n_runs; k++) {
        const double seconds = predictor_seconds(p, runs[k].id, runs[k].study);
        n_known += isfinite(seconds);
        sum += isfinite(seconds) ? seconds : 0.0;
    }
    return n_known == 0 ? (double)NAN : (double)n * sum / (double)n_known;
}

bool predictor_speed(predictor *p, prediction_speed *ret_speed)
{
    lock_acquire(&p->lock);
    const bool has_speed = p->has_speed;
    if (has_speed)
        *ret_speed = p->known_speed;
    p->is_speed_asked = true;
    lock_wake_one(&p->asked);
    lock_release(&p->lock);
    return has_speed;
}

static bf_status measure_kind(predictor *p, prediction_kind kind, bf_error *err)
{
    if (p->speed.factors[kind] > 0.0)
        return BF_OK;
    return prediction_measure(kind, read_cpu_s, measured_s, &p->speed.factors[kind], err);
}

// The speed of every kind, which is asked for.
static bf_status find_speed(predictor *p, bf_error *err)
{
    for (int kind = 0; kind < PREDICTION_KIND_COUNT; kind++) {
        if (atomic_load(&p->is_stopping))
            return BF_OK;
        BF_TRY(measure_kind(p, (prediction_kind)kind, err));
    }
    lock_acquire(&p->lock);
    p->known_speed = p->speed;
    p->has_speed = true;
    lock_release(&p->lock);
    return BF_OK;
}

// The work of a run; *ret_is_ended: it has ended.
static bf_status find_work(predictor *p, const char *run_id, prediction_work *ret_work,
                           bool *ret_is_ended, bf_error *err)
{
    bf_buffer text = { 0 };
    api_run record;
    scene s;

    bf_status status = store_find(p->store, run_id, &record, err);
    if (status == BF_OK)
        status = store_read_text(p->store, run_id, API_TEXT_SCENARIO, &text, err);
    if (status == BF_OK)
        status = scenario_read_resolved(text.bytes, text.n, &s, err);
    buffer_fini(&text);
    if (status != BF_OK)
        return status;
    *ret_is_ended = run_state_is_end(record.state);
    status = prediction_work_of(&s, record.model, ret_work, err);
    scene_fini(&s);
    return status;
}

static bf_status learn_from(predictor *p, const store_measured *ended, bf_error *err)
{
    prediction_work work;
    bool is_ended;

    const bool is_alike = ended->study[0] != '\0' && strcmp(ended->study, p->learned_study) == 0;
    memcpy(p->learned_study, ended->study, API_ID_SIZE);
    p->learned_ms = ended->finished_ms;
    if (is_alike || find_work(p, ended->id, &work, &is_ended, NULL) != BF_OK)
        return BF_OK;
    BF_TRY(measure_kind(p, work.kind, err));
    prediction_learn(&p->learned, &work, ended->cpu_s, &p->speed);
    return BF_OK;
}

// Learn from the runs that have ended since the last time, the oldest first.
static bf_status learn_news(predictor *p, bf_error *err)
{
    store_measured runs[PREDICTOR_LEARNED];
    bf_status status = BF_OK;
    size_t n;

    if (store_list_measured(p->store, p->learned_ms, runs, PREDICTOR_LEARNED, &n, NULL) != BF_OK)
        return BF_OK;
    while (n-- > 0 && status == BF_OK && !atomic_load(&p->is_stopping))
        status = learn_from(p, &runs[n], err);
    return status;
}

// NAN: a run that has ended, or that cannot be predicted.
static bf_status predict(predictor *p, const char *run_id, double *ret_seconds, bf_error *err)
{
    prediction_work work;
    bool is_ended;

    *ret_seconds = (double)NAN;
    if (find_work(p, run_id, &work, &is_ended, NULL) != BF_OK || is_ended)
        return BF_OK;
    BF_TRY(measure_kind(p, work.kind, err));
    *ret_seconds = prediction_seconds(&work, &p->speed);
    return BF_OK;
}

// Wait until somebody asks, or for the deadline to measure unasked; false: to be stopped. *ret_question is the next run, its
// run_id "" where there is none.
static bool take_next(predictor *p, int64_t unasked_ms, bool *ret_is_speed_asked,
                      question *ret_question)
{
    lock_acquire(&p->lock);
    while (p->n_waiting == 0 && !p->is_speed_asked && !atomic_load(&p->is_stopping)) {
        if (!lock_wait(&p->asked, &p->lock, p->has_speed ? -1 : unasked_ms))
            p->is_speed_asked = true;
    }
    *ret_is_speed_asked = p->is_speed_asked;
    p->is_speed_asked = false;
    *ret_question = (question){ .run_id = "" };
    if (p->n_waiting > 0) {
        *ret_question = p->waiting[p->first];
        p->first = (p->first + 1) % PREDICTOR_RUNS_MAX;
        p->n_waiting--;
    }
    lock_release(&p->lock);
    return !atomic_load(&p->is_stopping);
}

static void *run_loop(void *context)
{
    predictor *p = context;
    int64_t unasked_ms = clock_monotonic_ms() + UNASKED_MS;
    char quoted[LOG_QUOTED_SIZE];
    question next;
    bool is_speed_asked;

    (void)setpriority(PRIO_PROCESS, (id_t)gettid(), LOWER_PRIORITY);
    prediction_learn_begin(&p->learned);
    while (take_next(p, unasked_ms, &is_speed_asked, &next)) {
        double seconds = (double)NAN;
        bf_error err = { 0 };
        bf_status status = learn_news(p, &err);
        if (status == BF_OK && next.run_id[0] != '\0')
            status = predict(p, next.run_id, &seconds, &err);
        if (isfinite(seconds)) {
            bool is_known;
            lock_acquire(&p->lock);
            entry *e = find_entry(p, next.id, &is_known);
            if (!is_known || e->n_learned == 0)
                set_entry(e, next.id, seconds, 0);
            lock_release(&p->lock);
        }
        if (status == BF_OK && is_speed_asked)
            status = find_speed(p, &err);
        if (status != BF_OK) {
            log_event(LOG_LEVEL_WARN, "runs_not_predicted", "error=%s",
                      log_quote(err.text, quoted));
            unasked_ms = -1; // again when somebody asks, not by itself
        }
    }
    return NULL;
}

bf_status predictor_start(store *s, predictor **ret_predictor, bf_error *err)
{
    predictor *p = memory_alloc(1, sizeof *p);

    if (p == NULL)
        return bf_fail(err, BF_ENOMEM, "", "no memory for the predictor");
    p->store = s;
    lock_init(&p->lock);
    lock_condition_init(&p->asked);
    const bf_status status = thread_start(&p->thread, run_loop, p, "the predictor", err);
    if (status == BF_OK) {
        *ret_predictor = p;
        return BF_OK;
    }
    lock_condition_fini(&p->asked);
    lock_fini(&p->lock);
    memory_free(p);
    return status;
}

predictor *predictor_stop(predictor *p)
{
    if (p == NULL)
        return NULL;
    atomic_store(&p->is_stopping, true);
    lock_acquire(&p->lock);
    lock_wake_all(&p->asked);
    lock_release(&p->lock);
    BF_CHECK(pthread_join(p->thread, NULL) == 0);
    lock_condition_fini(&p->asked);
    lock_fini(&p->lock);
    memory_free(p);
    return NULL;
}
