// Results that may be wrong: of runs that others have other results of, and all that a worker sent that was found to send wrong
// ones. Those who sent something are noted with the set, so both are found as sets; the turns of retention.c mark the runs
// that have them, one a step, and their studies.

#include "server/store/store_priv.h"

#include "core/base/memory.h"
#include "server/base/clock.h"
#include "server/base/log.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

/// What is said to be wrong, on its way into the store.
typedef struct suspecting {
    store__operation operation;
    store *store;
    char run[API_ID_SIZE]; ///< "": none
    uint64_t token;        ///< 0: none
} suspecting;

bf_status store__note_sender(store__connection *writer, const store__row *row, uint64_t token,
                             bf_error *err)
{
    if (token == 0)
        return BF_OK;
    return store__exec(writer, STORE__SQL_PUT_SENDER, err, INTEGER(row->results), INTEGER(token),
                       INTEGER(row->run.started_ms));
}

// The set comes first, so that no further run joins it meanwhile.
static bf_status mark_one(store__connection *writer, int64_t results, char ret_run[API_ID_SIZE],
                          bf_error *err)
{
    bool has_row = false;
    store__row row;

    BF_TRY(store__exec(writer, STORE__SQL_SUSPECT_RESULTS, err, INTEGER(results),
                       INTEGER(STORE__RESULTS_SUSPECT), INTEGER(STORE__RESULTS_COMPLETE)));
    BF_TRY(store__find(writer, STORE__SQL_NEXT_UNMARKED, &store__run_record, &row, &has_row, err,
                       INTEGER(results)));
    if (has_row) {
        row.run.is_suspect = true;
        memcpy(ret_run, row.run.id, API_ID_SIZE);
        BF_TRY(store__save_row(writer, &row, err));
        return store__exec(writer, STORE__SQL_SUSPECT_STUDY, err, TEXT(row.run.study));
    }
    BF_TRY(store__exec(writer, STORE__SQL_DROP_SUSPECT, err, INTEGER(results)));
    return store__exec(writer, STORE__SQL_DROP_SENDERS, err, INTEGER(results));
}

bf_status store__mark_suspect(store__connection *writer, char ret_run[API_ID_SIZE],
                              bool *ret_has_more, bf_error *err)
{
    int64_t results = 0;

    bf_status status = store__read_number(writer, STORE__SQL_NEXT_SUSPECT, &results, err);
    *ret_has_more = status == BF_OK && results != 0;
    return *ret_has_more ? mark_one(writer, results, ret_run, err) : status;
}

static bf_status apply_suspecting(store__connection *writer, store__operation *operation,
                                  bf_error *err)
{
    const suspecting *o = operation->context;

    if (o->run[0] != '\0')
        BF_TRY(store__exec(writer, STORE__SQL_PUT_SUSPECT, err, TEXT(o->run)));
    if (o->token != 0)
        BF_TRY(store__exec(writer, STORE__SQL_PUT_DISTRUSTED, err, INTEGER(o->token),
                           INTEGER(clock_unix_ms())));
    return BF_OK;
}

static void log_lost(const char *run_id, uint64_t token, const char *why)
{
    char quoted[LOG_QUOTED_SIZE];

    log_event(LOG_LEVEL_ERROR, "suspicion_not_stored", "run=%s token=%" PRIu64 " error=%s", run_id,
              token, log_quote(why, quoted));
}

static void finish_suspecting(store__operation *operation)
{
    suspecting *o = operation->context;
    store *s = o->store;

    if (operation->status != BF_OK)
        log_lost(o->run, o->token, operation->error.text);
    lock_acquire(&s->lock);
    s->turn.next_ms = 0;
    lock_release(&s->lock);
    memory_free(o);
}

void store_begin_suspecting(store *s, const char *run_id, uint64_t token)
{
    suspecting *o = memory_alloc(1, sizeof *o);

    run_id = run_id == NULL ? "" : run_id;
    if (o == NULL) {
        log_lost(run_id, token, "out of memory");
        return;
    }
    *o = (suspecting){ .operation = { .apply = apply_suspecting,
                                      .finish = finish_suspecting,
                                      .context = o,
                                      .may_use_reserve = true },
                       .store = s,
                       .token = token };
    snprintf(o->run, sizeof o->run, "%s", run_id);
    store__begin_write(s, &o->operation);
}
