// Copies of a store, and checks of one. A copy's source is read in one go, which is one read transaction:
// the log cannot start again meanwhile, and nothing that is written meanwhile makes the copy start again.

#include "server/store/backup.h"

#include "server/store/convert.h"
#include "server/store/page_sums.h"
#include "server/store/store_priv.h"

#include "server/base/file_io.h"

#include <errno.h>
#include <inttypes.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { TEMPORARY_SIZE = STORE__PATH_SIZE + 16 };

// After a failure *source is not open.
static bf_status open_source(const char *directory, store__connection *source, bf_error *err)
{
    char path[STORE__PATH_SIZE + 16];
    int version = 0;

    (void)snprintf(path, sizeof path, "%.*s/beltflow.db", STORE__PATH_SIZE - 1, directory);
    if (access(path, F_OK) != 0)
        return bf_fail(err, BF_EINPUT, "", "there is no store %s: %s", path, strerror(errno));
    BF_TRY(store__connect(path, STORE__READ_ONLY, source, err));
    bf_status status = store__identify(source->db, path, &version, err);
    if (status == BF_OK && version == 0)
        status = bf_fail(err, BF_EINPUT, "", "%s is empty", path);
    if (status != BF_OK)
        store__disconnect(source);
    return status;
}

static bf_status make_temporary(const char *file, char *ret_path, bf_error *err)
{
    if (access(file, F_OK) == 0)
        return bf_fail(err, BF_EINPUT, "", "%s is there already", file);
    if (strlen(file) >= STORE__PATH_SIZE)
        return bf_fail(err, BF_EINPUT, "", "the file's path is too long");
    (void)snprintf(ret_path, TEMPORARY_SIZE, "%s.XXXXXX", file);
    // SQLite opens it by its name, and locks of ours would be lost with a second descriptor.
    int fd = mkstemp(ret_path);
    if (fd < 0)
        return bf_fail(err, BF_ESYSTEM, "", "cannot write beside %s: %s", file, strerror(errno));
    (void)close(fd);
    return BF_OK;
}

static bf_status copy_pages(sqlite3 *from, sqlite3 *to, bf_error *err)
{
    sqlite3_backup *backup = sqlite3_backup_init(to, "main", from, "main");

    if (backup == NULL)
        return store__fail(to, sqlite3_errcode(to), err);
    (void)sqlite3_backup_step(backup, -1);
    int code = sqlite3_backup_finish(backup);
    // As one plain file: a reader of it then needs no files beside it.
    if (code == SQLITE_OK)
        code = sqlite3_exec(to, "PRAGMA journal_mode = DELETE", NULL, NULL, NULL);
    return code == SQLITE_OK ? BF_OK : store__fail(to, code, err);
}

// Pages are copied as they are, so where they have no sums rows are copied.
static bf_status copy(const store__connection *source, const char *temporary, bf_error *err)
{
    sqlite3 *to = NULL;

    if (!store__has_page_sums(source->db))
        return store__copy_with_sums(source->db, temporary, err);
    int code = sqlite3_open_v2(temporary, &to,
                               SQLITE_OPEN_READWRITE | SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_EXRESCODE,
                               STORE__PAGE_SUMS);
    bf_status status =
        code == SQLITE_OK ? copy_pages(source->db, to, err) : store__fail(to, code, err);
    (void)sqlite3_close(to);
    return status;
}

static bf_status copy_to(const store__connection *source, const char *file, bf_error *err)
{
    char temporary[TEMPORARY_SIZE];

    BF_TRY(make_temporary(file, temporary, err));
    bf_status status = copy(source, temporary, err);
    if (status == BF_OK)
        status = file_io_publish(temporary, file, err);
    if (status != BF_OK)
        (void)unlink(temporary);
    return status;
}

// The file of a service that never had tokens has none, or is not there.
static bf_status copy_tokens(const char *directory, const char *file, bf_error *err)
{
    char path[STORE__PATH_SIZE + 16], copied[STORE__PATH_SIZE + 16];
    store__connection source;
    int64_t n_tokens = 0;

    (void)snprintf(path, sizeof path, "%.*s/access.db", STORE__PATH_SIZE - 1, directory);
    (void)snprintf(copied, sizeof copied, "%.*s.access", STORE__PATH_SIZE - 1, file);
    if (access(path, F_OK) != 0)
        return BF_OK;
    BF_TRY(store__connect(path, STORE__READ_ONLY, &source, err));
    bf_status status = store__read_number(&source, STORE__SQL_COUNT_TOKENS, &n_tokens, err);
    if (status == BF_OK && n_tokens > 0)
        status = copy_to(&source, copied, err);
    store__disconnect(&source);
    return status;
}

bf_status store_backup(const char *directory, const char *file, bf_error *err)
{
    store__connection source;

    BF_TRY(open_source(directory, &source, err));
    bf_status status = copy_to(&source, file, err);
    store__disconnect(&source);
    if (status == BF_OK && (status = copy_tokens(directory, file, err)) != BF_OK)
        (void)unlink(file);
    return status;
}

enum { FINDING_SIZE = 400 };

// A question that counts the rows where an invariant of store.h does not hold.
typedef struct question {
    const char *name;
    const char *claim;
    const char *sql;
} question;

// What no run has any more is deleted step by step, and so is not whole meanwhile.
#define NOT_ORPHANED "results NOT IN (SELECT number FROM results WHERE state = 2) "

static const question questions[] = {
    { "I3", "every run is in a state, and has ended exactly if its state is an end",
      "SELECT count(*) FROM runs WHERE state NOT BETWEEN 0 AND 4 "
      "OR (state >= 2) <> (finished_ms > 0)" },
    { "I4", "samples are without gap",
      "SELECT count(*) FROM runs WHERE n_samples <> "
      "(SELECT total(n) FROM samples WHERE samples.results = runs.results) OR n_samples <> "
      "(SELECT coalesce(max(first + n), 0) FROM samples WHERE samples.results = runs.results)" },
    { "I4", "snapshots are without gap",
      "SELECT count(*) FROM runs WHERE n_snapshots <> "
      "(SELECT count(*) FROM snapshots WHERE snapshots.results = runs.results) OR n_snapshots <> "
      "(SELECT coalesce(max(item) + 1, 0) FROM snapshots WHERE snapshots.results = runs.results)" },
    { "I4", "every snapshot has its grid, and chunks are without gap",
      "SELECT (SELECT count(*) FROM snapshots AS s WHERE " NOT_ORPHANED
      "AND NOT EXISTS (SELECT 1 FROM chunks AS c "
      "WHERE c.results = s.results AND c.kind = 0 AND c.item = s.item)) + (SELECT count(*) FROM "
      "(SELECT 1 FROM chunks WHERE " NOT_ORPHANED
      "GROUP BY results, kind, item HAVING count(*) <> max(part) + 1))" },
    { "I4", "what no snapshot has is of one that is coming",
      "SELECT count(*) FROM (SELECT DISTINCT results, item FROM chunks WHERE kind <> 1) AS c "
      "WHERE NOT EXISTS (SELECT 1 FROM snapshots AS s WHERE s.results = c.results AND "
      "s.item = c.item) AND NOT EXISTS (SELECT 1 FROM runs WHERE runs.results = c.results AND "
      "runs.state = 1 AND runs.n_snapshots = c.item)" },
    { "I5", "a run has the checkpoint that it tells of, and none if it has ended",
      "SELECT count(*) FROM (SELECT state, checkpoint_step, EXISTS (SELECT 1 FROM chunks "
      "WHERE chunks.results = runs.results AND kind = 1) AS has_one FROM runs) "
      "WHERE (checkpoint_step > 0 AND NOT has_one) OR (state >= 2 AND has_one)" },
    { "I6", "ids of events go on behind all that there were",
      "SELECT count(*) FROM events WHERE id > "
      "(SELECT seq FROM sqlite_sequence WHERE name = 'events')" },
    { "I7", "the newest event of a run is the one that it names",
      "SELECT count(*) FROM runs WHERE last_event <> "
      "(SELECT coalesce(max(id), 0) FROM events WHERE run = number)" },
    { "I7", "events tell of every batch of samples, every snapshot and every end, once",
      "SELECT count(*) FROM (SELECT state, n_snapshots, "
      "(SELECT count(*) FROM events WHERE run = number AND type = 2) AS curves, "
      "(SELECT count(*) FROM samples WHERE samples.results = runs.results) AS batches, "
      "(SELECT count(*) FROM events WHERE run = number AND type = 3) AS snapshots, "
      "(SELECT count(*) FROM events WHERE run = number AND type = 4) AS ends FROM runs) "
      "WHERE curves <> batches OR snapshots <> n_snapshots OR ends <> (state >= 2)" },
    { "I9", "what belongs to no run is being deleted",
      "SELECT count(*) FROM results WHERE (state = 2) = "
      "EXISTS (SELECT 1 FROM runs WHERE runs.results = results.number)" },
    { "I10", "every run has results",
      "SELECT count(*) FROM runs WHERE NOT EXISTS "
      "(SELECT 1 FROM results WHERE results.number = runs.results)" },
    { "I10", "results that several runs have are complete or suspect, and such ones are of success",
      "SELECT (SELECT count(*) FROM results WHERE state NOT IN (1, 3) AND "
      "(SELECT count(*) FROM runs WHERE runs.results = results.number) > 1) + "
      "(SELECT count(*) FROM runs JOIN results ON runs.results = results.number "
      "WHERE results.state IN (1, 3) AND runs.state <> 2)" },
    { "I14", "only running runs have stop requests and external ids",
      "SELECT count(*) FROM runs WHERE state <> 1 AND (stop_request <> 0 OR external_id <> '')" },
    { "I11", "an answer tells of the run that it names",
      "SELECT count(*) FROM answers WHERE length(digest) <> 32 OR instr(data, id) = 0" },
    { "I16", "an owner's bytes are those of the runs and measurements",
      "SELECT count(*) FROM owners AS o WHERE n_bytes <> "
      "(SELECT coalesce(sum(n_bytes), 0) FROM runs WHERE runs.owner = o.owner) + "
      "(SELECT coalesce(sum(n_bytes), 0) FROM results WHERE number IN "
      "(SELECT results FROM runs WHERE runs.owner = o.owner)) + "
      "(SELECT coalesce(sum(length(t) + length(counts) + length(CAST(csv AS BLOB))), 0) "
      "FROM measurements AS m WHERE m.owner = o.owner)" },
    { "I17", "a study's trials are numbered without gaps, and counted",
      "SELECT count(*) FROM (SELECT s.*, count(t.number) AS n, coalesce(max(t.number) + 1, 0) AS "
      "behind, count(t.ended) FILTER (WHERE t.ended > 0) AS n_ended, coalesce(max(t.ended), 0) AS "
      "last FROM studies AS s LEFT JOIN trials AS t ON t.study = s.number WHERE s.stop_request < 2 "
      "GROUP BY s.number) WHERE n <> n_trials OR behind <> n OR last <> n_ended OR n_ended <> "
      "n_succeeded + n_failed + n_infeasible + n_pruned + n_cancelled" },
    { "I17", "runs of trials belong to studies",
      "SELECT count(*) FROM runs WHERE parent <> '' AND NOT EXISTS "
      "(SELECT 1 FROM studies WHERE studies.id = parent)" },
};

/// A verification on its way.
typedef struct verification {
    store__connection reader;
    store_verify_fn *on_finding;
    void *context;
    bool is_sound;
} verification;

static void report(verification *v, const char *name, const char *claim, const char *finding)
{
    v->is_sound = v->is_sound && finding == NULL;
    v->on_finding(v->context, name, claim, finding);
}

// Read the first column of the first row: a number, and its text. The text of a damaged file is
// what SQLite says of it.
static int64_t ask(const verification *v, const char *sql, char ret_text[FINDING_SIZE])
{
    sqlite3_stmt *statement = NULL;
    int64_t number = -1;

    int code = sqlite3_prepare_v2(v->reader.db, sql, -1, &statement, NULL);
    if (code == SQLITE_OK)
        code = sqlite3_step(statement);
    if (code == SQLITE_ROW) {
        number = sqlite3_column_int64(statement, 0);
        const char *text = (const char *)sqlite3_column_text(statement, 0);
        (void)snprintf(ret_text, FINDING_SIZE, "%s", text == NULL ? "" : text);
    } else {
        (void)snprintf(ret_text, FINDING_SIZE, "%s", sqlite3_errmsg(v->reader.db));
    }
    sqlite3_finalize(statement);
    return number;
}

static void check_file(verification *v)
{
    char text[FINDING_SIZE];

    (void)ask(v, "PRAGMA integrity_check(1)", text);
    report(v, "file", "pages and indices fit together", strcmp(text, "ok") == 0 ? NULL : text);
    int64_t n = ask(v, "SELECT count(*) FROM pragma_foreign_key_check", text);
    report(v, "references", "no row refers to one that is not there", n == 0 ? NULL : text);
}

// The size of a blob; -1: it is damaged.
static int64_t measure(verification *v, int64_t results, store__blob kind, int64_t item)
{
    bf_buffer compressed = { 0 }, bytes = { 0 };

    bf_status status =
        store__get_chunks(&v->reader, results, kind, (uint64_t)item, &compressed, NULL);
    if (status == BF_OK && compressed.n > 0)
        status = store__unpack(&compressed, &bytes, NULL);
    int64_t n = status == BF_OK ? (int64_t)bytes.n : -1;
    buffer_fini(&compressed);
    buffer_fini(&bytes);
    return n;
}

// With feeds each snapshot has its own number of rows.
static bool are_parts_sound(int64_t n, int64_t n_expected, uint32_t n_values)
{
    if (!frame_has_ids(n_values))
        return n == n_expected;
    return n >= 0 && n % (int64_t)(n_values * sizeof(double)) == 0;
}

// Unpacking compares with the sum of what was compressed, so it finds what has become of the bytes.
static void check_content(verification *v)
{
    static const char sql[] =
        "SELECT s.results, s.item, r.n1 * r.n2 * 4, r.n_parts * r.n_values * 8, r.n_values "
        "FROM snapshots AS s JOIN runs AS r ON r.number = "
        "(SELECT number FROM runs WHERE runs.results = s.results LIMIT 1)";
    static const char claim[] = "every snapshot and its parts can be read";
    char finding[FINDING_SIZE];
    sqlite3_stmt *statement = NULL;
    int64_t n_damaged = 0;

    int code = sqlite3_prepare_v2(v->reader.db, sql, -1, &statement, NULL);
    while (code == SQLITE_OK && (code = sqlite3_step(statement)) == SQLITE_ROW) {
        int64_t results = sqlite3_column_int64(statement, 0);
        int64_t item = sqlite3_column_int64(statement, 1);
        n_damaged +=
            measure(v, results, STORE__BLOB_SNAPSHOT, item) != sqlite3_column_int64(statement, 2) ||
            !are_parts_sound(measure(v, results, STORE__BLOB_PARTS, item),
                             sqlite3_column_int64(statement, 3),
                             (uint32_t)sqlite3_column_int64(statement, 4));
        code = SQLITE_OK;
    }
    if (code != SQLITE_DONE)
        (void)snprintf(finding, sizeof finding, "%s", sqlite3_errmsg(v->reader.db));
    else
        (void)snprintf(finding, sizeof finding, "%" PRId64 " of them are damaged", n_damaged);
    sqlite3_finalize(statement);
    report(v, "content", claim, code == SQLITE_DONE && n_damaged == 0 ? NULL : finding);
}

static bf_status check_version(const verification *v, const char *path, bf_error *err)
{
    int version = 0;

    BF_TRY(store__identify(v->reader.db, path, &version, err));
    if (version != store__version)
        return bf_fail(err, BF_ESYSTEM, "",
                       "%s is of version %d, and this program checks version %d: a daemon's start "
                       "brings it up to date",
                       path, version, store__version);
    return BF_OK;
}

bf_status store_verify(const char *path, store_verify_fn *on_finding, void *context,
                       bool *ret_is_sound, bf_error *err)
{
    verification v = { .on_finding = on_finding, .context = context, .is_sound = true };

    if (access(path, F_OK) != 0)
        return bf_fail(err, BF_EINPUT, "", "there is no store %s: %s", path, strerror(errno));
    BF_TRY(store__connect(path, STORE__READ_ONLY, &v.reader, err));
    bf_status status = check_version(&v, path, err);
    // All checks see the store as it is now, even if a daemon writes meanwhile.
    if (status == BF_OK)
        status = store__run_plain(&v.reader, STORE__SQL_BEGIN_READ, err);
    if (status == BF_OK) {
        check_file(&v);
        char text[FINDING_SIZE];
        for (size_t i = 0; i < sizeof questions / sizeof *questions; i++) {
            int64_t n = ask(&v, questions[i].sql, text);
            if (n > 0)
                (void)snprintf(text, sizeof text, "not so in %" PRId64 " places", n);
            report(&v, questions[i].name, questions[i].claim, n == 0 ? NULL : text);
        }
        check_content(&v);
        *ret_is_sound = v.is_sound;
    }
    store__disconnect(&v.reader);
    return status;
}
