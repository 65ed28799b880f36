// What owners use of the service.
//
// CPU time is kept in sums by hour, of which the last QUOTA_HOURS count: charging is one row, and each owner has no more
// rows than hours. Bytes are one number an owner; triggers of the schema change it together with the rows that it sums
// up, so no way to store or remove a run can leave it out.

#include "server/store/quotas.h"

#include "server/base/clock.h"
#include "server/base/metrics.h"

#include <inttypes.h>
#include <math.h>
#include <sqlite3.h>
#include <string.h>

enum { QUOTA_HOURS = API_QUOTA_WINDOW_S / 3600, HOUR_MS = 3600000 };

void store_set_quotas(store *s, const store_quotas *quotas)
{
    s->quotas.n_waiting = quotas->n_waiting;
    s->quotas.cpu_s = quotas->cpu_s;
    s->quotas.n_bytes = quotas->n_bytes;
    s->quotas.n_measurements = quotas->n_measurements;
    s->quotas.n_studies = quotas->n_studies;
}

bf_status store__charge_owner(store__connection *writer, const char *owner, double cpu_s,
                              bf_error *err)
{
    return store__exec(writer, STORE__SQL_CHARGE, err, TEXT(owner),
                       INTEGER(clock_unix_ms() / HOUR_MS), REAL(cpu_s));
}

bf_status store__charge(store__connection *writer, store__row *row, double cpu_s, bf_error *err)
{
    const double more_s = cpu_s - row->cpu_s;

    if (!isfinite(more_s) || more_s <= 0.0)
        return BF_OK;
    BF_TRY(store__charge_owner(writer, row->run.owner, more_s, err));
    row->cpu_s = cpu_s;
    return BF_OK;
}

// The number that a statement finds for an owner; 0 without a row.
static bf_status read_for(store__connection *c, store__sql sql, const char *owner,
                          uint64_t *ret_value, bf_error *err)
{
    int64_t value = 0;

    BF_TRY(store__find_number(c, sql, &value, err, TEXT(owner)));
    *ret_value = (uint64_t)value;
    return BF_OK;
}

// The hours that count at the moment are behind `since`, up to `until`. Later ones are of a clock that was set back.
static void find_hours(int64_t now_ms, int64_t *ret_since, int64_t *ret_until)
{
    *ret_until = now_ms / HOUR_MS;
    *ret_since = *ret_until - QUOTA_HOURS;
}

static bf_status read_cpu(store__connection *c, const char *owner, int64_t now_ms,
                          api_quota *ret_quota, bf_error *err)
{
    double sums[QUOTA_HOURS] = { 0.0 }, used_s = 0.0;
    int64_t since, until;

    find_hours(now_ms, &since, &until);
    store__query q =
        store__start(c, STORE__SQL_LIST_CPU_SUMS, TEXT(owner), INTEGER(since), INTEGER(until));
    bf_status status = BF_OK;
    while (store__next(&q, &status, err)) {
        double sum_s = sqlite3_column_double(q.statement, 1);
        sums[sqlite3_column_int64(q.statement, 0) - since - 1] = sum_s;
        used_s += sum_s;
    }
    if (status != BF_OK)
        return status;
    ret_quota->used = used_s < 0x1p63 ? (uint64_t)used_s : UINT64_C(1) << 63;
    if (ret_quota->allowed == 0 || used_s < (double)ret_quota->allowed)
        return BF_OK;
    // The oldest sums leave the window until less than the quota is left.
    int64_t n = 0;
    while (n < QUOTA_HOURS && used_s >= (double)ret_quota->allowed)
        used_s -= sums[n++];
    ret_quota->release_ms = (since + n + QUOTA_HOURS) * HOUR_MS;
    return BF_OK;
}

bf_status store_read_quotas(store *s, const char *owner, api_quotas *ret_quotas, bf_error *err)
{
    const bool has_owner = owner[0] != '\0'; // else there are no quotas
    api_quotas q = { .waiting = { .allowed = has_owner ? s->quotas.n_waiting : 0 },
                     .cpu_s = { .allowed = has_owner ? s->quotas.cpu_s : 0 },
                     .bytes = { .allowed = has_owner ? s->quotas.n_bytes : 0 } };
    store__connection *reader = store__acquire_reader(&s->pool);

    memcpy(q.owner, owner, strlen(owner) + 1);
    bf_status status = read_for(reader, STORE__SQL_COUNT_QUEUED_OWNED, owner, &q.waiting.used, err);
    if (status == BF_OK)
        status = read_for(reader, STORE__SQL_COUNT_BYTES_OF, owner, &q.bytes.used, err);
    if (status == BF_OK)
        status = read_cpu(reader, owner, clock_unix_ms(), &q.cpu_s, err);
    if (status == BF_OK)
        *ret_quotas = q;
    store__release_reader(&s->pool, reader);
    return status;
}

static bool is_used_up(const api_quota *quota)
{
    return quota->allowed > 0 && quota->used >= quota->allowed;
}

bf_status store__check_bytes(store__connection *writer, const store *s, const char *owner,
                             bf_error *err)
{
    api_quota bytes = { .allowed = s->quotas.n_bytes };

    if (owner[0] == '\0' || bytes.allowed == 0)
        return BF_OK;
    bf_status status = read_for(writer, STORE__SQL_COUNT_BYTES_OF, owner, &bytes.used, err);
    if (status != BF_OK || !is_used_up(&bytes))
        return status;
    metrics_add(METRICS_QUOTA_REFUSALS, METRICS_QUOTA_BYTES, 1);
    return bf_fail(err, BF_ENOSPACE, "",
                   "%s has %" PRIu64 " bytes of results, of %" PRIu64
                   " allowed (owner_bytes): remove runs to make room",
                   owner, bytes.used, bytes.allowed);
}

static bf_status check_kept(store__connection *writer, store__sql count, uint64_t allowed,
                            const char *owner, const char *what, bf_error *err)
{
    api_quota kept = { .allowed = allowed };

    if (owner[0] == '\0' || allowed == 0)
        return BF_OK;
    bf_status status = read_for(writer, count, owner, &kept.used, err);
    if (status != BF_OK || !is_used_up(&kept))
        return status;
    return bf_fail(err, BF_ECONFLICT, "", "%s has %" PRIu64 " %s", owner, kept.used, what);
}

bf_status store__check_measurements(store__connection *writer, const store *s, const char *owner,
                                    bf_error *err)
{
    return check_kept(writer, STORE__SQL_COUNT_MEASUREMENTS_OF, s->quotas.n_measurements, owner,
                      "measurements, as many as are allowed (owner_measurements): remove some "
                      "first",
                      err);
}

bf_status store__check_studies(store__connection *writer, const store *s, const char *owner,
                               bf_error *err)
{
    return check_kept(writer, STORE__SQL_COUNT_OPEN_STUDIES_OF, s->quotas.n_studies, owner,
                      "studies that have not ended, as many as are allowed (owner_studies)", err);
}

bf_status store__check_owner(store__connection *writer, const store *s, const char *owner,
                             unsigned *ret_retry_s, bf_error *err)
{
    const int64_t now_ms = clock_unix_ms();
    api_quota waiting = { .allowed = s->quotas.n_waiting }, cpu = { .allowed = s->quotas.cpu_s };

    if (owner[0] == '\0')
        return BF_OK;
    if (waiting.allowed > 0)
        BF_TRY(read_for(writer, STORE__SQL_COUNT_QUEUED_OWNED, owner, &waiting.used, err));
    if (is_used_up(&waiting)) {
        metrics_add(METRICS_QUOTA_REFUSALS, METRICS_QUOTA_QUEUE, 1);
        return bf_fail(err, BF_ELIMIT, "",
                       "%" PRIu64 " runs of %s wait, of %" PRIu64 " allowed (owner_queue)",
                       waiting.used, owner, waiting.allowed);
    }
    if (cpu.allowed > 0)
        BF_TRY(read_cpu(writer, owner, now_ms, &cpu, err));
    if (is_used_up(&cpu)) {
        *ret_retry_s = (unsigned)((cpu.release_ms - now_ms + 999) / 1000);
        metrics_add(METRICS_QUOTA_REFUSALS, METRICS_QUOTA_CPU, 1);
        return bf_fail(err, BF_ELIMIT, "",
                       "runs of %s have used %" PRIu64 " CPU seconds in %d hours, of %" PRIu64
                       " allowed (owner_cpu_s)",
                       owner, cpu.used, QUOTA_HOURS, cpu.allowed);
    }
    return BF_OK;
}

bf_status store__is_held(store__connection *reader, const store *s, const char *owner,
                         bool *ret_is_held, bf_error *err)
{
    api_quota cpu = { .allowed = s->quotas.cpu_s }, bytes = { .allowed = s->quotas.n_bytes };

    *ret_is_held = false;
    if (owner[0] == '\0' || (cpu.allowed == 0 && bytes.allowed == 0))
        return BF_OK;
    BF_TRY(read_for(reader, STORE__SQL_COUNT_BYTES_OF, owner, &bytes.used, err));
    BF_TRY(read_cpu(reader, owner, clock_unix_ms(), &cpu, err));
    *ret_is_held = is_used_up(&cpu) || is_used_up(&bytes);
    return BF_OK;
}

bf_status store__forget_use(store__connection *writer, bf_error *err)
{
    int64_t since, until;

    find_hours(clock_unix_ms(), &since, &until);
    BF_TRY(store__exec(writer, STORE__SQL_EXPIRE_CPU_SUMS, err, INTEGER(since), INTEGER(until)));
    return store__run_plain(writer, STORE__SQL_FORGET_OWNERS, err);
}
