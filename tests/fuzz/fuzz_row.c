// Rows of the store and of access.db, as another program or an earlier version could have left them: "TABLE COLUMN ROW
// TYPE", a line feed, the value. Everything that a daemon reads from such a file is read, or refused.

#include "tests/fuzz/fuzz.h"

#include "server/store/backup.h"
#include "server/store/page_sums.h"
#include "server/store/tokens.h"
#include "tests/unit/server/helper_store.h"

#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { N1 = 4, N2 = 3, N_PARTS = 2, N_RUNS = 3, N_TOKENS = 2 };

// A database, and its bytes without fault.
typedef struct database {
    char path[100];
    bf_buffer sound;
} database;

static helper_store h;
static database of_store, of_tokens;
static char tokens_made[N_TOKENS][API_TOKEN_SIZE]; // one counts, one was revoked
static char runs[N_RUNS][API_ID_SIZE];             // that ended, is running, waits
static char measurements[2][API_ID_SIZE];          // a curve, a profile

static void append(bf_buffer *buffer, const void *bytes, size_t n)
{
    fuzz_require(buffer_append(buffer, bytes, n) == BF_OK, "memory for a store");
}

// Samples, a snapshot with its parts, key figures and a checkpoint.
static void solve_in_part(const char *id)
{
    static const float rho[N1 * N2] = { 1.0F, 2.0F };
    static const double parts[N_PARTS * FRAME_VALUES_PLANAR] = { 0.5 };
    const bf_grid grid = { N1, N2, 0.0, 0.0, 0.1, 0.1 };
    store_item items[3] = { { .type = API_EVENT_SNAPSHOT } };
    const store_batch batch = { .run_id = id,
                                .n = 3,
                                .items = items,
                                .grid = &grid,
                                .parts = { .n_parts = N_PARTS, .n_values = FRAME_VALUES_PLANAR },
                                .step = 7,
                                .checkpoint = "checkpoint",
                                .n_checkpoint = 10 };

    append(&items[0].event, "{}", 2);
    append(&items[0].rho, rho, sizeof rho);
    append(&items[0].parts, parts, sizeof parts);
    helper_figures_item(id, 700, &items[1]);
    helper_curve_item(id, 0, 5, &items[2]);
    fuzz_require(helper_store_append(h.store, &batch, NULL) == BF_OK, "what a run sends is stored");
    for (size_t k = 0; k < batch.n; k++)
        helper_item_fini(&items[k]);
}

static void add_measurement(api_measured kind, char *ret_id)
{
    static const double rows[2] = { 1.0, 2.0 };
    api_measurement about = { .kind = kind, .counter = "upstream", .n_samples = 2, .t_end = 1.0 };
    api_curve curve = { .n_columns = 1 };
    bf_buffer csv = { 0 };

    if (kind == API_MEASURED_CURVE) {
        curve.n = 2;
        append(&curve.t, rows, sizeof rows);
        append(&curve.values, rows, sizeof rows);
    } else {
        append(&csv, "t_s,rate_per_s\n0,1\n1,1\n", 23);
    }
    fuzz_require(store_add_measurement(h.store, &about, &curve, &csv, &about, NULL) == BF_OK,
                 "a measurement is stored");
    memcpy(ret_id, about.id, API_ID_SIZE);
    api_curve_fini(&curve);
    buffer_fini(&csv);
}

static void add_tokens(void)
{
    for (size_t k = 0; k < N_TOKENS; k++) {
        tokens_record token = { .name = "press", .owner = "hall-3", .scopes = API_SCOPE_READ };
        fuzz_require(tokens_add(h.directory, &token, tokens_made[k], NULL) == BF_OK,
                     "a token is stored");
        if (k > 0)
            fuzz_require(tokens_revoke(h.directory, token.id, NULL) == BF_OK, "a token is revoked");
    }
}

static void read_sound(database *d, const char *name)
{
    char chunk[4096];

    (void)snprintf(d->path, sizeof d->path, "%s/%s", h.directory, name);
    FILE *file = fopen(d->path, "re");
    fuzz_require(file != NULL, "the database can be read");
    for (size_t n; (n = fread(chunk, 1, sizeof chunk, file)) > 0;)
        append(&d->sound, chunk, n);
    (void)fclose(file);
}

static void remove_store(void)
{
    helper_store_remove_directory(h.directory);
    buffer_fini(&of_store.sound);
    buffer_fini(&of_tokens.sound);
}

static void make_sound_store(void)
{
    // In memory where that is possible: every input opens the store, which syncs.
    (void)snprintf(h.directory, sizeof h.directory, "%s/beltflow-fuzz-XXXXXX",
                   access("/dev/shm", W_OK) == 0 ? "/dev/shm" : "/tmp");
    fuzz_require(mkdtemp(h.directory) != NULL, "a directory for a store");
    helper_store_open(&h);
    for (int k = 0; k < N_RUNS; k++) {
        const api_run record =
            k == N_RUNS - 1 ? helper_submit(h.store, "waits", 0) : helper_start(h.store);
        memcpy(runs[k], record.id, API_ID_SIZE);
        if (k < N_RUNS - 1)
            solve_in_part(record.id);
        if (k == 0)
            (void)helper_finish(h.store, record.id, RUN_SUCCEEDED);
    }
    add_measurement(API_MEASURED_CURVE, measurements[0]);
    add_measurement(API_MEASURED_PROFILE, measurements[1]);
    helper_store_close(&h);
    add_tokens();
    read_sound(&of_store, "beltflow.db");
    read_sound(&of_tokens, "access.db");
    (void)atexit(remove_store);
}

static void write_sound(const database *d)
{
    static const char *const logs[] = { "-wal", "-shm", "-journal" };
    char log[120];
    FILE *file = fopen(d->path, "we");

    fuzz_require(file != NULL && fwrite(d->sound.bytes, 1, d->sound.n, file) == d->sound.n &&
                     fclose(file) == 0,
                 "the database can be written");
    for (size_t k = 0; k < sizeof logs / sizeof *logs; k++) {
        (void)snprintf(log, sizeof log, "%s%s", d->path, logs[k]);
        (void)unlink(log);
    }
}

static bool is_column(sqlite3 *db, const char *table, const char *column)
{
    sqlite3_stmt *statement = NULL;

    fuzz_require(
        sqlite3_prepare_v2(db,
                           "SELECT 1 FROM sqlite_schema AS s, pragma_table_info(s.name) AS c "
                           "WHERE s.type = 'table' AND s.name = ?1 AND c.name = ?2",
                           -1, &statement, NULL) == SQLITE_OK,
        "columns are listed");
    (void)sqlite3_bind_text(statement, 1, table, -1, SQLITE_STATIC);
    (void)sqlite3_bind_text(statement, 2, column, -1, SQLITE_STATIC);
    const bool is_there = sqlite3_step(statement) == SQLITE_ROW;
    (void)sqlite3_finalize(statement);
    return is_there;
}

static void bind(sqlite3_stmt *statement, const char *type, const char *value, size_t n)
{
    if (strcmp(type, "integer") == 0)
        (void)sqlite3_bind_int64(statement, 1, strtoll(value, NULL, 10));
    else if (strcmp(type, "real") == 0)
        (void)sqlite3_bind_double(statement, 1, strtod(value, NULL));
    else if (strcmp(type, "text") == 0)
        (void)sqlite3_bind_text(statement, 1, value, (int)n, SQLITE_STATIC);
    else if (strcmp(type, "blob") == 0)
        (void)sqlite3_bind_blob(statement, 1, value, (int)n, SQLITE_STATIC);
    else
        (void)sqlite3_bind_null(statement, 1);
}

// Give the column of one row the value; where the table does not take it, nothing changes.
static void change(const database *d, const char *table, const char *column, int row,
                   const char *type, const char *value, size_t n)
{
    char sql[400];
    sqlite3 *db = NULL;
    sqlite3_stmt *statement = NULL;

    fuzz_require(
        store__register_page_sums(NULL) == BF_OK &&
            sqlite3_open_v2(d->path, &db, SQLITE_OPEN_READWRITE, STORE__PAGE_SUMS) == SQLITE_OK &&
            sqlite3_exec(db, "PRAGMA ignore_check_constraints = ON; PRAGMA synchronous = OFF", NULL,
                         NULL, NULL) == SQLITE_OK,
        "the database can be opened");
    if (is_column(db, table, column)) {
        if (strcmp(table, "snapshots") == 0) // its rows have no numbers
            (void)snprintf(sql, sizeof sql, "UPDATE snapshots SET %s = ?1 WHERE item = %d", column,
                           row);
        else
            (void)snprintf(
                sql, sizeof sql,
                "UPDATE %s SET %s = ?1 WHERE rowid = (SELECT rowid FROM %s LIMIT 1 OFFSET %d)",
                table, column, table, row);
        fuzz_require(sqlite3_prepare_v2(db, sql, -1, &statement, NULL) == SQLITE_OK, sql);
        bind(statement, type, value, n);
        (void)sqlite3_step(statement);
        (void)sqlite3_finalize(statement);
    }
    (void)sqlite3_close(db);
}

// What is in the store is read, or there is a reason that a client can be told. SQLite says that it is full when no
// larger number of an event is left.
static void require_answer(bf_status status)
{
    static const bool is_answer[BF_STATUS_COUNT] = {
        [BF_OK] = true,        [BF_ENOTFOUND] = true, [BF_ECORRUPT] = true,
        [BF_ECONFLICT] = true, [BF_ESYSTEM] = true,   [BF_ENOSPACE] = true,
    };

    fuzz_require(is_answer[status], bf_status_word(status));
}

static bf_status on_event(void *context, const api_event *event, bf_error *err)
{
    fuzz_require((unsigned)event->type < API_EVENT_TYPE_COUNT, "events have a type");
    append(context, event->data, event->n);
    return BF_OK;
}

static void read_lists(store *s)
{
    static api_run_list list;
    static api_page page;
    const api_list_query query = { .state = -1, .model = -1, .limit = 10 };
    const api_page_query all = { .limit = 10 };

    const bf_status status = store_list(s, &query, &list, NULL);
    require_answer(status);
    for (size_t k = 0; status == BF_OK && k < list.n; k++)
        fuzz_require((unsigned)list.runs[k].state < RUN_STATE_COUNT &&
                         (unsigned)list.runs[k].model < RUN_MODEL_COUNT,
                     "runs have a state and a model");
    require_answer(store_list_measurements(s, &all, &page, NULL));
    require_answer(store_list_lines(s, &all, &page, NULL));
}

static void read_snapshots(store *s, const char *id)
{
    api_snapshot_list list = { .items = { .n = 0 } };
    api_array got;
    bf_buffer out = { 0 };

    require_answer(store_list_snapshots(s, id, &list, NULL));
    buffer_fini(&list.items);
    if (store_read_array(s, id, 0, API_ARRAY_DENSITY, &got, &out, NULL) == BF_OK)
        fuzz_require(out.n == (size_t)grid_cells(&got.grid) * sizeof(float),
                     "a density fits its grid");
    out.n = 0;
    if (store_read_array(s, id, 0, API_ARRAY_PARTS, &got, &out, NULL) == BF_OK)
        fuzz_require(out.n == got.parts.n_parts * got.parts.n_values * sizeof(double),
                     "parts fit their count");
    buffer_fini(&out);
}

static void read_run(store *s, const char *id)
{
    api_run record;
    api_curve curve = { .n = 0 };
    bf_buffer out = { 0 };

    require_answer(store_find(s, id, &record, NULL));
    for (int which = API_TEXT_SCENARIO; which <= API_TEXT_FIGURES; which++)
        require_answer(store_read_text(s, id, (api_text)which, &out, NULL));
    if (store_read_curve(s, id, 0, UINT64_MAX, &curve, NULL) == BF_OK)
        fuzz_require(curve.t.n == curve.n * sizeof(double) &&
                         curve.values.n == curve.n * curve.n_columns * sizeof(double),
                     "a curve has the samples that it counts");
    api_curve_fini(&curve);
    read_snapshots(s, id);
    require_answer(
        store_read_events(s, (const char(*)[API_ID_SIZE])id, 1, 0, SIZE_MAX, on_event, &out, NULL));
    require_answer(store_read_changes(s, id, on_event, &out, NULL));
    buffer_fini(&out);
}

static void read_measurement(store *s, const char *id)
{
    api_measurement about;
    api_curve curve = { .n = 0 };
    bf_buffer csv = { 0 };

    require_answer(store_find_measurement(s, id, &about, NULL));
    if (store_read_measurement(s, id, &curve, NULL) == BF_OK)
        fuzz_require(curve.t.n == curve.n * sizeof(double) &&
                         curve.values.n == curve.n * sizeof(double),
                     "a measured curve has the samples that it counts");
    api_curve_fini(&curve);
    require_answer(store_read_measurement_csv(s, id, &csv, NULL));
    buffer_fini(&csv);
}

// As a daemon that starts: reading, and taking what waits.
static void read_store(void)
{
    const store_options options = { .directory = h.directory, .queue_limit = 100 };
    store *s = NULL;
    store_job job = { .step = 0 };
    bf_status status = store_open(&options, &s, NULL);

    require_answer(status);
    if (status != BF_OK)
        return;
    read_lists(s);
    for (int k = 0; k < N_RUNS; k++)
        read_run(s, runs[k]);
    for (int k = 0; k < 2; k++)
        read_measurement(s, measurements[k]);
    for (int k = 0; k < N_RUNS && status == BF_OK; k++) {
        status = store_claim(s, true, &job, NULL);
        require_answer(status);
        store_job_fini(&job);
    }
    (void)store_close(s);
}

static void require_identity(api_credential credential, const api_identity *who)
{
    fuzz_require((unsigned)credential <= API_CREDENTIAL_VALID, "tokens become something");
    if (credential == API_CREDENTIAL_VALID)
        fuzz_require(who->scopes <= API_SCOPE_ANY &&
                         memchr(who->owner, '\0', sizeof who->owner) != NULL,
                     "who has a token has an owner and scopes");
}

static void on_token(void *context, const tokens_record *token)
{
    ++*(size_t *)context;
    fuzz_require(memchr(token->name, '\0', sizeof token->name) != NULL, "tokens have a name");
}

// As a daemon does, and the command that lists tokens.
static void read_tokens(void)
{
    tokens *t = NULL;
    size_t n = 0;
    bf_status status = tokens_list(h.directory, on_token, &n, NULL);

    require_answer(status);
    fuzz_require(n <= N_TOKENS, "there are no more tokens than rows");
    status = tokens_open(h.directory, &t, NULL);
    require_answer(status);
    if (status != BF_OK)
        return;
    for (size_t k = 0; k < N_TOKENS; k++) {
        api_identity who = { .scopes = 0 };
        require_identity(tokens_identify(t, tokens_made[k], &who), &who);
        require_identity(tokens_identify_by_id(t, k + 1, &who), &who);
    }
    (void)tokens_close(t);
}

static void ignore(void *context, const char *name, const char *claim, const char *finding)
{
    (void)context, (void)name, (void)claim, (void)finding;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t n)
{
    char table[21] = "", column[21] = "", type[9] = "";
    char *text = fuzz_text(bytes, n), *value = strchr(text, '\n');
    int row = 0;
    bool is_sound = false;

    if (of_store.sound.n == 0)
        make_sound_store();
    if (value != NULL &&
        sscanf(text, "%20[a-z] %20[a-z0-9_] %4d %8[a-z]", table, column, &row, type) == 4) {
        const bool is_token = strcmp(table, "tokens") == 0;
        const database *d = is_token ? &of_tokens : &of_store;
        value++;
        write_sound(d);
        change(d, table, column, row, type, value, n - (size_t)(value - text));
        if (is_token) {
            read_tokens();
        } else {
            require_answer(store_verify(d->path, ignore, NULL, &is_sound, NULL));
            read_store();
        }
    }
    free(text);
    return 0;
}
