// Periodic work of the store's thread, in turns: results without a run are removed, runs with suspect results marked, then runs
// removed that are beyond the limits, then idempotency keys that are too old. Of those that are too old the one that ended first goes, and
// where there are too many, or too much, one of the owner who has most: cached ones first, then the one that ended first, so
// that no owner's runs make those of another go. A turn is a row of small transactions with the groups of others in between.
//
// Pages that become free stay in the file and are used again, so the file is as long as it ever had to
// be; the limit of bytes counts pages in use, which every removal lowers, so that it is reached.

#include "server/store/idempotency.h"
#include "server/store/quotas.h"
#include "server/store/store_priv.h"

#include "server/base/clock.h"
#include "server/base/log.h"

#include <inttypes.h>
#include <string.h>

/// One step.
typedef struct step {
    store__connection *writer;
    store_retention limits;
    int64_t idempotency_ms;
    store__retention_turn turn; ///< as it was, and as it will be if the step succeeds
    char changed[API_ID_SIZE];  ///< the run that was removed or marked; "": none
    const char *rule;           ///< the limit that caused its removal; NULL: it was marked
    bool is_last;               ///< nothing is left to be done in this turn
} step;

// Free pages do not count: they are used before the file grows.
static bf_status count_bytes(store__connection *c, int64_t *ret_bytes, bf_error *err)
{
    int64_t n_pages = 0, n_free = 0, page_size = 0;

    BF_TRY(store__read_number(c, STORE__SQL_COUNT_PAGES, &n_pages, err));
    BF_TRY(store__read_number(c, STORE__SQL_COUNT_FREE_PAGES, &n_free, err));
    BF_TRY(store__read_number(c, STORE__SQL_PAGE_SIZE, &page_size, err));
    *ret_bytes = (n_pages - n_free) * page_size;
    return BF_OK;
}

// The limit that is exceeded, as a setting is called; NULL: none.
static bf_status find_rule(const step *st, const store__row *oldest, const char **ret_rule,
                           bf_error *err)
{
    const store_retention *limits = &st->limits;
    int64_t age_ms = clock_unix_ms() - oldest->run.finished_ms, n_runs = 0, n_bytes = 0;

    if (limits->n_runs > 0)
        BF_TRY(store__read_number(st->writer, STORE__SQL_COUNT_ENDED, &n_runs, err));
    if (limits->n_bytes > 0)
        BF_TRY(count_bytes(st->writer, &n_bytes, err));
    *ret_rule = limits->age_ms > 0 && age_ms > limits->age_ms                ? "retention_days"
                : limits->n_runs > 0 && (uint64_t)n_runs > limits->n_runs    ? "retention_runs"
                : limits->n_bytes > 0 && (uint64_t)n_bytes > limits->n_bytes ? "retention_bytes"
                                                                             : NULL;
    return BF_OK;
}

// With nothing left to remove, what waits and runs may still be more than the limit of bytes.
static bf_status warn(step *st, bf_error *err)
{
    int64_t n_bytes = 0;

    bf_status status = count_bytes(st->writer, &n_bytes, err);
    bool is_over = st->limits.n_bytes > 0 && (uint64_t)n_bytes > st->limits.n_bytes;
    if (status == BF_OK && is_over && !st->turn.has_warned)
        log_event(LOG_LEVEL_WARN, "retention_bytes_exceeded", "bytes=%" PRId64 " limit=%" PRIu64,
                  n_bytes, st->limits.n_bytes);
    st->turn.has_warned = is_over;
    return status;
}

static const store__column owner_column[] = { { STORE__COLUMN_TEXT, 0, API_OWNER_SIZE } };
static const store__record owner_record = RECORD(owner_column, char[API_OWNER_SIZE], NULL);

// One of the owner who has most of what the rule limits. What is only of trials that are open leaves *first as it was.
static bf_status find_first_to_go(const step *st, store__row *first, bf_error *err)
{
    const bool is_of_runs = strcmp(st->rule, "retention_runs") == 0;
    char owner[API_OWNER_SIZE] = "";
    bool has_row = false;
    store__row row;

    if (strcmp(st->rule, "retention_days") == 0)
        return BF_OK;
    BF_TRY(store__find_with(
        st->writer, is_of_runs ? STORE__SQL_OWNER_OF_MOST_RUNS : STORE__SQL_OWNER_OF_MOST_BYTES,
        &owner_record, owner, &has_row, err, NULL, 0));
    if (has_row)
        BF_TRY(store__find(st->writer, STORE__SQL_FIRST_TO_GO, &store__run_record, &row, &has_row,
                           err, TEXT(owner)));
    if (has_row)
        *first = row;
    return BF_OK;
}

static bf_status do_step(step *st, bf_error *err)
{
    bool has_oldest = false, is_over = false, has_suspect = false;
    int64_t orphaned = 0;
    store__row oldest;

    BF_TRY(store__read_number(st->writer, STORE__SQL_FIND_ORPHANED, &orphaned, err));
    if (orphaned != 0)
        return store__collect_results(st->writer, orphaned, &is_over, err);
    BF_TRY(store__mark_suspect(st->writer, st->changed, &has_suspect, err));
    if (has_suspect)
        return BF_OK;
    BF_TRY(store__find_with(st->writer, STORE__SQL_OLDEST_ENDED, &store__run_record, &oldest,
                            &has_oldest, err, NULL, 0));
    if (has_oldest)
        BF_TRY(find_rule(st, &oldest, &st->rule, err));
    if (has_oldest && st->rule != NULL)
        BF_TRY(find_first_to_go(st, &oldest, err));
    if (st->rule != NULL) {
        memcpy(st->changed, oldest.run.id, API_ID_SIZE);
        // What is left over the next step finds.
        return store__remove_row(st->writer, &oldest, &is_over, err);
    }
    st->is_last = true;
    if (!has_oldest)
        BF_TRY(warn(st, err));
    BF_TRY(store__expire_keys(st->writer, clock_unix_ms() - st->idempotency_ms, err));
    return store__forget_use(st->writer, err);
}

static bf_status run_step(step *st, bf_error *err)
{
    BF_TRY(store__begin_transaction(st->writer, err));
    return store__end_transaction(st->writer, do_step(st, err), err);
}

static void notify(const store *s, const step *st)
{
    if (st->changed[0] == '\0')
        return;
    if (st->rule != NULL)
        log_event(LOG_LEVEL_INFO, "run_expired", "run=%s rule=%s", st->changed, st->rule);
    else
        log_event(LOG_LEVEL_WARN, "run_suspect", "run=%s", st->changed);
    if (s->listener != NULL)
        s->listener(s->listener_context, st->changed);
}

void store__apply_retention(store *s)
{
    bf_error err = { 0 };
    char quoted[LOG_QUOTED_SIZE];

    lock_assert_held(&s->lock);
    if (s->writing.is_stopping || clock_monotonic_ms() < s->turn.next_ms)
        return;
    step st = { .writer = &s->writer,
                .limits = s->retention,
                .idempotency_ms = s->idempotency_ms,
                .turn = s->turn };
    lock_release(&s->lock);
    bf_status status = run_step(&st, &err);
    if (status == BF_ENOSPACE && store__spend_reserve(s))
        status = run_step(&st, &err);
    s->space.next_ms = 0;
    if (status == BF_OK)
        notify(s, &st);
    else
        log_event(LOG_LEVEL_WARN, "store_care_failed", "error=%s", log_quote(err.text, quoted));
    lock_acquire(&s->lock);
    if (status == BF_OK)
        s->turn = st.turn;
    if (status == BF_OK && !st.is_last) {
        s->has_new_stats = true;
        return;
    }
    s->turn.next_ms = clock_monotonic_ms() + s->turn.every_ms;
}

void store_set_retention(store *s, const store_retention *retention)
{
    lock_acquire(&s->lock);
    s->retention = *retention;
    s->turn.next_ms = 0;
    lock_wake_all(&s->writing.filled);
    lock_release(&s->lock);
}
