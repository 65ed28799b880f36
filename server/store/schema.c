#include "server/store/connection.h"

#include "server/store/page_sums.h"

#include <sqlite3.h>
#include <stdio.h>
#include <string.h>

// Marks the file as ours: "BFLW".
enum { APPLICATION_ID = 0x42464c57 };

// Blobs of doubles and of floats are in the machine's byte order, little-endian wherever we run.
// The states in the indices' conditions are run_state's numbers.
static const char schema_1[] =
    "CREATE TABLE runs ("
    "  number INTEGER PRIMARY KEY,"
    "  id TEXT NOT NULL UNIQUE,"
    "  state INTEGER NOT NULL CHECK (state BETWEEN 0 AND 4),"
    "  model INTEGER NOT NULL,"
    "  priority INTEGER NOT NULL,"
    "  label TEXT NOT NULL,"
    "  name TEXT NOT NULL,"
    "  revision INTEGER NOT NULL DEFAULT 0,"
    "  progress REAL NOT NULL DEFAULT 0,"
    "  created_ms INTEGER NOT NULL,"
    "  started_ms INTEGER NOT NULL DEFAULT 0,"
    "  finished_ms INTEGER NOT NULL DEFAULT 0,"
    "  eta_s REAL,"
    "  wall_s REAL NOT NULL DEFAULT 0,"
    "  n_samples INTEGER NOT NULL DEFAULT 0,"
    "  n_snapshots INTEGER NOT NULL DEFAULT 0,"
    "  last_event INTEGER NOT NULL DEFAULT 0,"
    "  has_summary INTEGER NOT NULL DEFAULT 0,"
    "  error_code TEXT NOT NULL DEFAULT '',"
    "  error_pointer TEXT NOT NULL DEFAULT '',"
    "  error_text TEXT NOT NULL DEFAULT '',"
    "  checkpoint_step INTEGER NOT NULL DEFAULT 0,"
    "  n1 INTEGER NOT NULL DEFAULT 0,"
    "  n2 INTEGER NOT NULL DEFAULT 0,"
    "  lower1 REAL NOT NULL DEFAULT 0,"
    "  lower2 REAL NOT NULL DEFAULT 0,"
    "  d1 REAL NOT NULL DEFAULT 0,"
    "  d2 REAL NOT NULL DEFAULT 0"
    ") STRICT;"
    "CREATE INDEX runs_queue ON runs (priority DESC, id) WHERE state = 0;"
    "CREATE INDEX runs_by_state ON runs (state, id);"
    "CREATE INDEX runs_by_label ON runs (label, id);"

    "CREATE TABLE texts ("
    "  run INTEGER NOT NULL REFERENCES runs (number) ON DELETE CASCADE,"
    "  kind INTEGER NOT NULL,"
    "  data TEXT NOT NULL,"
    "  PRIMARY KEY (run, kind)"
    ") STRICT;"

    "CREATE TABLE samples ("
    "  run INTEGER NOT NULL REFERENCES runs (number) ON DELETE CASCADE,"
    "  first INTEGER NOT NULL,"
    "  n INTEGER NOT NULL CHECK (n > 0),"
    "  t BLOB NOT NULL,"
    "  parts BLOB NOT NULL,"
    "  PRIMARY KEY (run, first)"
    ") STRICT;"

    "CREATE TABLE snapshots ("
    "  run INTEGER NOT NULL REFERENCES runs (number) ON DELETE CASCADE,"
    "  item INTEGER NOT NULL,"
    "  t REAL,"
    "  peak REAL,"
    "  mass REAL,"
    "  PRIMARY KEY (run, item)"
    ") STRICT, WITHOUT ROWID;"

    "CREATE TABLE chunks ("
    "  run INTEGER NOT NULL REFERENCES runs (number) ON DELETE CASCADE,"
    "  kind INTEGER NOT NULL,"
    "  item INTEGER NOT NULL,"
    "  part INTEGER NOT NULL,"
    "  data BLOB NOT NULL,"
    "  PRIMARY KEY (run, kind, item, part)"
    ") STRICT;"

    "CREATE TABLE events ("
    "  id INTEGER PRIMARY KEY AUTOINCREMENT,"
    "  run INTEGER NOT NULL REFERENCES runs (number) ON DELETE CASCADE,"
    "  type INTEGER NOT NULL,"
    "  snapshot INTEGER NOT NULL,"
    "  data TEXT NOT NULL"
    ") STRICT;"
    "CREATE INDEX events_of_run ON events (run);"

    "CREATE TABLE probe ("
    "  id INTEGER PRIMARY KEY,"
    "  at_ms INTEGER NOT NULL"
    ") STRICT;";

// The parts of snapshots are chunks of a kind of their own.
static const char schema_2[] = "ALTER TABLE runs ADD COLUMN n_parts INTEGER NOT NULL DEFAULT 0;"
                               "ALTER TABLE runs ADD COLUMN n_values INTEGER NOT NULL DEFAULT 0;";

// Results become sets that several runs may share: what was a run's own becomes a set's. Where a
// column refers to does not show in the rows, so it is changed in the tables' texts, as SQLite's
// manual has it (lang_altertable.html, "Making Other Kinds Of Table Schema Changes"), instead of
// copying all the rows. The tables that are made on the way let other connections see the change.
static const char schema_3[] =
    "CREATE TABLE results ("
    "  number INTEGER PRIMARY KEY,"
    "  state INTEGER NOT NULL DEFAULT 0,"
    "  digest BLOB NOT NULL DEFAULT x''," // of model and scenario; empty: never shared
    "  solver TEXT NOT NULL DEFAULT ''"   // version that solves it; empty: several did
    ") STRICT;"
    "CREATE INDEX results_by_state ON results (state);"
    "CREATE INDEX results_by_digest ON results (digest) WHERE state = 1;"
    "INSERT INTO results (number) SELECT number FROM runs;"
    "ALTER TABLE runs ADD COLUMN results INTEGER REFERENCES results (number);"
    "ALTER TABLE runs ADD COLUMN is_cached INTEGER NOT NULL DEFAULT 0;"
    "UPDATE runs SET results = number;"
    "CREATE INDEX runs_by_results ON runs (results);"
    "CREATE INDEX runs_by_end ON runs (finished_ms, id) WHERE state >= 2;"

    "ALTER TABLE samples RENAME COLUMN run TO results;"
    "ALTER TABLE snapshots RENAME COLUMN run TO results;"
    "ALTER TABLE chunks RENAME COLUMN run TO results;"
    "PRAGMA writable_schema = ON;"
    "UPDATE sqlite_schema SET sql = replace(sql, 'REFERENCES runs (number)',"
    "  'REFERENCES results (number)')"
    "  WHERE type = 'table' AND name IN ('samples', 'snapshots', 'chunks');"
    "PRAGMA writable_schema = RESET;"

    "CREATE TABLE answers ("
    "  number INTEGER PRIMARY KEY,"
    "  route TEXT NOT NULL,"
    "  key TEXT NOT NULL,"
    "  digest BLOB NOT NULL," // of the request's body
    "  id TEXT NOT NULL,"     // of what was made, which may be gone since
    "  revision INTEGER NOT NULL,"
    "  at_ms INTEGER NOT NULL,"
    "  data TEXT NOT NULL," // the answer's body
    "  UNIQUE (route, key)"
    ") STRICT;"
    "CREATE INDEX answers_by_age ON answers (at_ms);";

// Measured curves belong to no run. The samples stand last, so that a list does not read them.
static const char schema_4[] = "CREATE TABLE measurements ("
                               "  id TEXT PRIMARY KEY,"
                               "  label TEXT NOT NULL,"
                               "  counter TEXT NOT NULL,"
                               "  created_ms INTEGER NOT NULL,"
                               "  n INTEGER NOT NULL CHECK (n > 0),"
                               "  t_start REAL NOT NULL,"
                               "  t_end REAL NOT NULL,"
                               "  t BLOB NOT NULL CHECK (length(t) = 8 * n),"
                               "  counts BLOB NOT NULL CHECK (length(counts) = 8 * n)"
                               ") STRICT;"
                               "CREATE INDEX measurements_by_label ON measurements (label, id);";

// What the queue and the supervisor need to know of a run. Checkpoints are of a format that is not read
// any more: their runs start again, and what they emit again is already stored (I4).
static const char schema_5[] =
    "ALTER TABLE runs ADD COLUMN client TEXT NOT NULL DEFAULT '';" // who submitted it; '': no quota
    "ALTER TABLE runs ADD COLUMN stop_request INTEGER NOT NULL DEFAULT 0;" // a store_stop
    "ALTER TABLE runs ADD COLUMN external_id TEXT NOT NULL DEFAULT '';" // the executor's name of its job
    "ALTER TABLE runs ADD COLUMN parent TEXT NOT NULL DEFAULT '';" // id of the run that made it
    "CREATE INDEX runs_by_client ON runs (client) WHERE state = 0 AND client <> '';"
    "UPDATE runs SET checkpoint_step = 0 WHERE checkpoint_step <> 0;"
    "DELETE FROM chunks WHERE kind = 1 AND results IN (SELECT results FROM runs WHERE state < 2);";

// Key figures of a run alone, for lists; all of them are a text.
static const char schema_6[] = "ALTER TABLE runs ADD COLUMN figures TEXT NOT NULL DEFAULT '';";

// Measurements that are texts for feeds: they have no samples, so the tests of their lengths hold for curves alone. Tests of
// columns cannot be changed in place.
static const char schema_7[] =
    "CREATE TABLE all_measurements ("
    "  id TEXT PRIMARY KEY,"
    "  kind INTEGER NOT NULL," // an api_measured
    "  label TEXT NOT NULL,"
    "  counter TEXT NOT NULL,"
    "  created_ms INTEGER NOT NULL,"
    "  n INTEGER NOT NULL CHECK (n > 0),"
    "  t_start REAL NOT NULL,"
    "  t_end REAL NOT NULL,"
    "  t BLOB NOT NULL CHECK (length(t) = 8 * n OR kind > 0),"
    "  counts BLOB NOT NULL CHECK (length(counts) = 8 * n OR kind > 0),"
    "  csv TEXT NOT NULL DEFAULT ''"
    ") STRICT;"
    "INSERT INTO all_measurements (id, kind, label, counter, created_ms, n, t_start, t_end, t, "
    "counts)"
    "  SELECT id, 0, label, counter, created_ms, n, t_start, t_end, t, counts FROM measurements;"
    "DROP TABLE measurements;"
    "ALTER TABLE all_measurements RENAME TO measurements;"
    "CREATE INDEX measurements_by_label ON measurements (label, id);";

// Attempts at a run that ended with the daemon, since the run last went on.
static const char schema_8[] = "ALTER TABLE runs ADD COLUMN attempts INTEGER NOT NULL DEFAULT 0;";

// Whose runs and measurements are; '' is nobody's: from before, or of a service without tokens.
static const char schema_9[] =
    "ALTER TABLE runs ADD COLUMN owner TEXT NOT NULL DEFAULT '';"
    "CREATE INDEX runs_by_owner ON runs (owner, id);"
    "ALTER TABLE measurements ADD COLUMN owner TEXT NOT NULL DEFAULT '';";

// What owners use. The bytes of a set of results count once for each owner that has runs with it. Runs know the bytes of
// their events and scenarios from here on; those of earlier ones stay at 0.
static const char schema_10[] =
    "ALTER TABLE runs ADD COLUMN cpu_s REAL NOT NULL DEFAULT 0;"      // of all attempts
    "ALTER TABLE runs ADD COLUMN n_bytes INTEGER NOT NULL DEFAULT 0;" // that it has alone
    "ALTER TABLE results ADD COLUMN n_bytes INTEGER NOT NULL DEFAULT 0;"
    "UPDATE results SET n_bytes ="
    "  (SELECT coalesce(sum(length(data)), 0) FROM chunks WHERE results = number AND kind <> 1) +"
    "  (SELECT coalesce(sum(length(t) + length(parts)), 0) FROM samples WHERE results = number);"
    "DROP INDEX runs_queue;"
    "CREATE INDEX runs_waiting ON runs (owner, priority DESC, id) WHERE state = 0;"
    "DROP INDEX runs_by_results;"
    "CREATE INDEX runs_by_results ON runs (results, owner);"

    "CREATE TABLE owners ("
    "  owner TEXT PRIMARY KEY,"
    "  n_bytes INTEGER NOT NULL DEFAULT 0,"
    "  turn INTEGER NOT NULL DEFAULT 0" // rises: who was served last has the greatest
    ") STRICT, WITHOUT ROWID;"
    "CREATE INDEX owners_by_turn ON owners (turn);"
    "CREATE INDEX owners_without_bytes ON owners (owner) WHERE n_bytes = 0;"
    "INSERT INTO owners (owner, n_bytes)"
    "  SELECT owner, sum(n_bytes) FROM (SELECT DISTINCT owner, results FROM runs)"
    "  JOIN results ON number = results GROUP BY owner;"
    "CREATE TABLE cpu_sums ("
    "  owner TEXT NOT NULL,"
    "  hour INTEGER NOT NULL," // Unix time
    "  cpu_s REAL NOT NULL,"
    "  PRIMARY KEY (owner, hour)"
    ") STRICT, WITHOUT ROWID;"
    "CREATE INDEX cpu_sums_by_hour ON cpu_sums (hour);"

    "CREATE TRIGGER run_is_added AFTER INSERT ON runs BEGIN"
    "  INSERT OR IGNORE INTO owners (owner) VALUES (new.owner);"
    "  UPDATE owners SET n_bytes = n_bytes + new.n_bytes + (SELECT coalesce(sum(n_bytes), 0) FROM "
    "results"
    "    WHERE number = new.results AND NOT EXISTS (SELECT 1 FROM runs"
    "    WHERE results = new.results AND owner = new.owner AND number <> new.number))"
    "    WHERE owner = new.owner;"
    "END;"
    "CREATE TRIGGER run_is_removed AFTER DELETE ON runs BEGIN"
    "  UPDATE owners SET n_bytes = n_bytes - old.n_bytes - (SELECT coalesce(sum(n_bytes), 0) FROM "
    "results"
    "    WHERE number = old.results AND NOT EXISTS (SELECT 1 FROM runs"
    "    WHERE results = old.results AND owner = old.owner)) WHERE owner = old.owner;"
    "END;"
    "CREATE TRIGGER run_has_grown AFTER UPDATE OF n_bytes ON runs"
    "  WHEN new.n_bytes <> old.n_bytes BEGIN"
    "  UPDATE owners SET n_bytes = n_bytes + new.n_bytes - old.n_bytes WHERE owner = new.owner;"
    "END;"
    "CREATE TRIGGER results_have_grown AFTER UPDATE OF n_bytes ON results BEGIN"
    "  UPDATE owners SET n_bytes = n_bytes + new.n_bytes - old.n_bytes"
    "    WHERE owner IN (SELECT owner FROM runs WHERE results = new.number);"
    "END;";

// Studies and their trials. Their runs have the study as their parent, and stand in lists and in the queue apart from those
// of nobody: the indices begin with what parts them.
static const char schema_11[] =
    "CREATE TABLE studies ("
    "  number INTEGER PRIMARY KEY,"
    "  id TEXT NOT NULL UNIQUE,"
    "  state INTEGER NOT NULL CHECK (state BETWEEN 0 AND 5)," // an api_study_state
    "  method INTEGER NOT NULL,"
    "  model INTEGER NOT NULL,"
    "  priority INTEGER NOT NULL,"
    "  name TEXT NOT NULL,"
    "  owner TEXT NOT NULL,"
    "  client TEXT NOT NULL,"
    "  created_ms INTEGER NOT NULL,"
    "  trials_max INTEGER NOT NULL,"
    "  revision INTEGER NOT NULL DEFAULT 0,"
    "  started_ms INTEGER NOT NULL DEFAULT 0,"
    "  finished_ms INTEGER NOT NULL DEFAULT 0,"
    "  n_trials INTEGER NOT NULL DEFAULT 0,"
    "  n_succeeded INTEGER NOT NULL DEFAULT 0,"
    "  n_failed INTEGER NOT NULL DEFAULT 0,"
    "  n_infeasible INTEGER NOT NULL DEFAULT 0,"
    "  n_pruned INTEGER NOT NULL DEFAULT 0,"
    "  n_cancelled INTEGER NOT NULL DEFAULT 0,"
    "  error_code TEXT NOT NULL DEFAULT '',"
    "  error_pointer TEXT NOT NULL DEFAULT '',"
    "  error_text TEXT NOT NULL DEFAULT '',"
    "  stop_request INTEGER NOT NULL DEFAULT 0," // a store_stop
    "  turn INTEGER NOT NULL DEFAULT 0"          // as of owners
    ") STRICT;"
    "CREATE INDEX studies_by_state ON studies (state, priority DESC, id);"
    "CREATE INDEX studies_by_end ON studies (finished_ms) WHERE finished_ms > 0;"
    "CREATE INDEX studies_by_turn ON studies (turn);"
    "CREATE INDEX studies_by_owners_turn ON studies (owner, turn);"
    "CREATE INDEX studies_to_stop ON studies (stop_request, id) WHERE stop_request > 0;"

    "CREATE TABLE study_texts ("
    "  study INTEGER NOT NULL REFERENCES studies (number) ON DELETE CASCADE,"
    "  kind INTEGER NOT NULL," // an api_study_text
    "  data TEXT NOT NULL,"
    "  PRIMARY KEY (study, kind)"
    ") STRICT;"

    "CREATE TABLE trials ("
    "  study INTEGER NOT NULL REFERENCES studies (number) ON DELETE CASCADE,"
    "  number INTEGER NOT NULL,"
    "  point INTEGER NOT NULL,"
    "  model INTEGER NOT NULL,"
    "  substream INTEGER NOT NULL,"
    "  state INTEGER NOT NULL CHECK (state BETWEEN 0 AND 6)," // an api_trial_state
    "  ended INTEGER NOT NULL CHECK ((ended = 0) = (state = 0)),"
    "  run TEXT NOT NULL," // '': there was none
    "  parameters BLOB NOT NULL,"
    "  vals BLOB NOT NULL,"
    "  error_code TEXT NOT NULL DEFAULT '',"
    "  error_pointer TEXT NOT NULL DEFAULT '',"
    "  error_text TEXT NOT NULL DEFAULT '',"
    "  PRIMARY KEY (study, number)"
    ") STRICT, WITHOUT ROWID;"
    "CREATE UNIQUE INDEX trials_by_end ON trials (study, ended) WHERE ended > 0;"
    "CREATE INDEX trials_open ON trials (study, number) WHERE ended = 0;"
    "CREATE INDEX trials_by_run ON trials (run) WHERE ended = 0;"

    "DROP INDEX runs_by_owner;"
    "CREATE INDEX runs_by_owner ON runs (owner, parent, id);"
    "DROP INDEX runs_waiting;"
    "CREATE INDEX runs_waiting ON runs (owner, priority DESC, id) WHERE state = 0 AND parent = '';"
    "CREATE INDEX trials_waiting ON runs (parent, id) WHERE state = 0 AND parent <> '';"
    "CREATE INDEX runs_by_parent ON runs (parent, id);";

// Each index is a page of a submission's commit: those of runs without label and owner, and of results that some run has, are
// never asked for.
static const char schema_12[] =
    "DROP INDEX runs_by_label;"
    "CREATE INDEX runs_by_label ON runs (label, id) WHERE label <> '';"
    "DROP INDEX runs_by_owner;"
    "CREATE INDEX runs_by_owner ON runs (owner, parent, id) WHERE owner <> '';"
    "DROP INDEX results_by_state;"
    "CREATE INDEX results_orphaned ON results (number) WHERE state = 2;";

// The closure of the macroscopic model; '' of runs from before, and of the microscopic model.
static const char schema_13[] = "ALTER TABLE runs ADD COLUMN closure TEXT NOT NULL DEFAULT '';";

// What the store remembers of how it was used. Owners are those of tokens.
static const char schema_14[] =
    "CREATE TABLE marks (name TEXT PRIMARY KEY) STRICT, WITHOUT ROWID;"
    "INSERT INTO marks SELECT 'tokens' WHERE EXISTS (SELECT 1 FROM owners WHERE owner <> '');";

// How often workers gave a run back unsolved, one after the other.
static const char schema_15[] =
    "ALTER TABLE runs ADD COLUMN hand_backs INTEGER NOT NULL DEFAULT 0;";

// Runs that ended, by owner, those first that retention removes first.
static const char schema_16[] =
    "CREATE INDEX runs_ended_by_owner ON runs (owner, is_cached DESC, finished_ms, id) "
    "WHERE state >= 2;"
    "CREATE INDEX answers_by_route ON answers (route);"; // a route names the owner, too

// Measurements count among the bytes of their owners, as runs do.
static const char schema_17[] =
    "CREATE INDEX measurements_by_owner ON measurements (owner);"
    "INSERT OR IGNORE INTO owners (owner) SELECT DISTINCT owner FROM measurements;"
    "UPDATE owners SET n_bytes = n_bytes + (SELECT coalesce(sum(length(t) + length(counts) + "
    "  length(CAST(csv AS BLOB))), 0) FROM measurements AS m WHERE m.owner = owners.owner);"
    "CREATE TRIGGER measurement_is_added AFTER INSERT ON measurements BEGIN"
    "  INSERT OR IGNORE INTO owners (owner) VALUES (new.owner);"
    "  UPDATE owners SET n_bytes = n_bytes + length(new.t) + length(new.counts) + "
    "    length(CAST(new.csv AS BLOB)) WHERE owner = new.owner;"
    "END;"
    "CREATE TRIGGER measurement_is_removed AFTER DELETE ON measurements BEGIN"
    "  UPDATE owners SET n_bytes = n_bytes - length(old.t) - length(old.counts) - "
    "    length(CAST(old.csv AS BLOB)) WHERE owner = old.owner;"
    "END;";

// Runs that wait or run are few; those that have ended are listed apart from trials.
static const char schema_18[] =
    "DROP INDEX runs_by_state;"
    "CREATE INDEX runs_open ON runs (state, id) WHERE state < 2;"
    "CREATE INDEX runs_ended ON runs (parent, state, id) WHERE state NOT IN (0, 1);";

// Changes of photo eyes and actions belong to sets of results; the events of runs refer to them, as to samples. Events of
// earlier versions have their data themselves.
static const char schema_19[] =
    "CREATE TABLE changes ("
    "  results INTEGER NOT NULL REFERENCES results (number) ON DELETE CASCADE,"
    "  item INTEGER NOT NULL,"
    "  data TEXT NOT NULL," // of the event of the run that was solved
    "  PRIMARY KEY (results, item)"
    ") STRICT, WITHOUT ROWID;";

// Scenarios and summaries of trials, as what they differ in from the scenario of the study's first.
static const char schema_20[] = "CREATE TABLE text_deltas ("
                                "  run INTEGER NOT NULL REFERENCES runs (number) ON DELETE CASCADE,"
                                "  kind INTEGER NOT NULL,"
                                "  data BLOB NOT NULL," // a frame of zstd
                                "  PRIMARY KEY (run, kind)"
                                ") STRICT;";

// Curve events have the columns in a member of their own: the data of those from before are made of the samples, which
// `snapshot` refers to, when they are read.
static const char schema_21[] =
    "UPDATE runs SET n_bytes = max(0, n_bytes - (SELECT coalesce(sum(length(CAST(data AS BLOB))), "
    "0)"
    "  FROM events WHERE run = runs.number AND type = 2)) WHERE n_bytes > 0;"
    "UPDATE events SET snapshot = coalesce(json_extract(data, '$.first'), snapshot), data = ''"
    "  WHERE type = 2 AND data <> '';";

// What users noted of runs.
static const char schema_22[] = "ALTER TABLE runs ADD COLUMN notes TEXT NOT NULL DEFAULT '';";

// Which runs users want to find again.
static const char schema_23[] = "ALTER TABLE runs ADD COLUMN starred INTEGER NOT NULL DEFAULT 0;";

// Whose results turned out to be wrong. A token that sent wrong ones is not believed in what it sent of runs that began before
// that was found out; `suspects` are sets whose runs are to be marked.
static const char schema_24[] =
    "ALTER TABLE runs ADD COLUMN suspect INTEGER NOT NULL DEFAULT 0;"
    "CREATE TABLE senders ("
    "  results INTEGER NOT NULL REFERENCES results (number) ON DELETE CASCADE,"
    "  token INTEGER NOT NULL,"    // of a worker that sent some of them
    "  began_ms INTEGER NOT NULL," // not after the run came to that worker
    "  PRIMARY KEY (results, token)"
    ") STRICT, WITHOUT ROWID;"
    "CREATE INDEX senders_by_token ON senders (token, began_ms);"
    "CREATE TABLE distrusted (token INTEGER PRIMARY KEY, at_ms INTEGER NOT NULL) STRICT;"
    "CREATE TABLE suspects ("
    "  results INTEGER PRIMARY KEY REFERENCES results (number) ON DELETE CASCADE"
    ") STRICT;";

// Studies one of whose trials is suspect.
static const char schema_25[] =
    "ALTER TABLE studies ADD COLUMN suspect INTEGER NOT NULL DEFAULT 0;";

// Lines that runs and studies belong to. `line_scenario` stands for a run's scenario without its name where it has a line.
static const char schema_26[] =
    "ALTER TABLE runs ADD COLUMN line TEXT NOT NULL DEFAULT '';"
    "ALTER TABLE runs ADD COLUMN line_version INTEGER NOT NULL DEFAULT 0;"
    "ALTER TABLE runs ADD COLUMN line_scenario TEXT NOT NULL DEFAULT '';"
    "CREATE INDEX runs_by_line ON runs (owner, line, line_version) WHERE line <> '';"
    "CREATE INDEX runs_by_line_scenario ON runs (owner, line, line_scenario) WHERE line <> '';"
    "ALTER TABLE studies ADD COLUMN line TEXT NOT NULL DEFAULT '';";

// Text i brings the tables from version i to i + 1. Texts that stores have seen never change.
const char *const store__migrations[] = { schema_1,  schema_2,  schema_3,  schema_4,  schema_5,
                                          schema_6,  schema_7,  schema_8,  schema_9,  schema_10,
                                          schema_11, schema_12, schema_13, schema_14, schema_15,
                                          schema_16, schema_17, schema_18, schema_19, schema_20,
                                          schema_21, schema_22, schema_23, schema_24, schema_25,
                                          schema_26 };

enum { VERSION = sizeof store__migrations / sizeof *store__migrations };

const int store__version = VERSION;

static bf_status execute(sqlite3 *db, const char *text, bf_error *err)
{
    int code = sqlite3_exec(db, text, NULL, NULL, NULL);
    return code == SQLITE_OK ? BF_OK : store__fail(db, code, err);
}

static bf_status read_integer(sqlite3 *db, const char *text, int *ret_value, bf_error *err)
{
    sqlite3_stmt *statement = NULL;
    bf_status status = BF_OK;

    int code = sqlite3_prepare_v2(db, text, -1, &statement, NULL);
    if (code == SQLITE_OK)
        code = sqlite3_step(statement);
    if (code == SQLITE_ROW)
        *ret_value = sqlite3_column_int(statement, 0);
    else
        status = store__fail(db, code, err);
    sqlite3_finalize(statement);
    return status;
}

bf_status store__identify(sqlite3 *db, const char *path, int *ret_version, bf_error *err)
{
    int application = 0;
    int version = 0;
    int n_tables = 0;

    BF_TRY(read_integer(db, "PRAGMA application_id", &application, err));
    BF_TRY(read_integer(db, "PRAGMA user_version", &version, err));
    BF_TRY(read_integer(db, "SELECT count(*) FROM sqlite_schema", &n_tables, err));
    bool is_empty = application == 0 && version == 0 && n_tables == 0;
    if (!is_empty && application != APPLICATION_ID)
        return bf_fail(err, BF_ESYSTEM, "", "%s is not a store of Beltflow", path);
    if (version < 0 || version > VERSION)
        return bf_fail(err, BF_ESYSTEM, "",
                       "%s was written by a newer Beltflow: its version is %d, and this program "
                       "knows versions up to %d",
                       path, version, VERSION);
    *ret_version = version;
    return BF_OK;
}

static bf_status switch_to_wal(sqlite3 *db, bf_error *err)
{
    sqlite3_stmt *statement = NULL;
    bf_status status = BF_OK;

    int code = sqlite3_prepare_v2(db, "PRAGMA journal_mode = WAL", -1, &statement, NULL);
    if (code == SQLITE_OK)
        code = sqlite3_step(statement);
    if (code != SQLITE_ROW)
        status = store__fail(db, code, err);
    else if (strcmp((const char *)sqlite3_column_text(statement, 0), "wal") != 0)
        status = bf_fail(err, BF_ESYSTEM, "", "the file system of the store cannot do a WAL");
    sqlite3_finalize(statement);
    return status;
}

static bf_status upgrade(sqlite3 *db, int version, bf_error *err)
{
    char mark[96];

    for (int i = version; i < VERSION; i++)
        BF_TRY(execute(db, store__migrations[i], err));
    snprintf(mark, sizeof mark, "PRAGMA application_id = %d; PRAGMA user_version = %d",
             APPLICATION_ID, VERSION);
    return execute(db, mark, err);
}

bf_status store__migrate(store__connection *writer, const char *path, bf_error *err)
{
    int version = 0;

    BF_TRY(store__identify(writer->db, path, &version, err));
    if (version == 0) {
        // Both can only be said of a database without tables. Free pages can then be given back to the disk (space.c).
        BF_TRY(store__reserve_page_sums(writer->db, err));
        BF_TRY(execute(writer->db, "PRAGMA auto_vacuum = INCREMENTAL", err));
    }
    BF_TRY(switch_to_wal(writer->db, err));
    if (version == VERSION)
        return BF_OK;
    BF_TRY(store__begin_transaction(writer, err));
    return store__end_transaction(writer, upgrade(writer->db, version, err), err);
}
