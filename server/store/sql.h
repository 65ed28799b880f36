/// Private to the store: its statements, as one table. Each connection prepares one when it is
/// first used and keeps it.

#pragma once

/// The columns of a run, in the order in which store__read_row() reads them.
#define STORE__RUN_COLUMNS                                                                         \
    "number, id, state, model, priority, label, name, revision, progress, created_ms, "            \
    "started_ms, finished_ms, eta_s, wall_s, n_samples, n_snapshots, last_event, has_summary, "    \
    "error_code, error_pointer, error_text, checkpoint_step, n1, n2, lower1, lower2, d1, d2, "     \
    "n_parts, n_values, results, is_cached"

/// A page of a list by one condition; ?1 older than, ?2 how many, ?3 model or -1.
#define STORE__LIST(condition)                                                                     \
    "SELECT " STORE__RUN_COLUMNS " FROM runs WHERE id < ?1 AND (?3 < 0 OR model = ?3) "            \
    "AND " condition " ORDER BY id DESC LIMIT ?2"

/// The columns of a measurement without its samples, in the order in which they are read.
#define STORE__MEASUREMENT_COLUMNS "id, label, counter, created_ms, n, t_start, t_end"

/// X(name, text). Parameters are bound in the order ?1, ?2, ... States of runs and types of events are
/// those of run_state and api_event_type: from 2 on a run has ended; 2 and 3 are curve and snapshot.
/// States of results are those of store__results.
#define STORE__SQL_LIST(X)                                                                         \
    X(BEGIN_WRITE, "BEGIN IMMEDIATE")                                                              \
    X(BEGIN_READ, "BEGIN")                                                                         \
    X(COMMIT, "COMMIT")                                                                            \
    X(ROLLBACK, "ROLLBACK")                                                                        \
    X(SAVEPOINT, "SAVEPOINT operation")                                                            \
    X(RELEASE, "RELEASE operation")                                                                \
    X(ROLLBACK_TO, "ROLLBACK TO operation")                                                        \
    X(INSERT_RUN, "INSERT INTO runs (id, state, model, priority, label, name, created_ms, "        \
                  "results, is_cached) VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9)")               \
    X(UPDATE_RUN, "UPDATE runs SET state = ?2, revision = ?3, progress = ?4, started_ms = ?5, "    \
                  "finished_ms = ?6, eta_s = ?7, wall_s = ?8, n_samples = ?9, "                    \
                  "n_snapshots = ?10, last_event = ?11, has_summary = ?12, error_code = ?13, "     \
                  "error_pointer = ?14, error_text = ?15, checkpoint_step = ?16, n1 = ?17, "       \
                  "n2 = ?18, lower1 = ?19, lower2 = ?20, d1 = ?21, d2 = ?22, n_parts = ?23, "      \
                  "n_values = ?24 "                                                                \
                  "WHERE number = ?1")                                                             \
    X(DELETE_RUN, "DELETE FROM runs WHERE number = ?1")                                            \
    X(FIND_RUN, "SELECT " STORE__RUN_COLUMNS " FROM runs WHERE id = ?1")                           \
    X(FIND_RUNNING, "SELECT " STORE__RUN_COLUMNS " FROM runs WHERE state = 1 LIMIT 1")             \
    X(COUNT_QUEUED, "SELECT count(*) FROM runs WHERE state = 0")                                   \
    X(COUNT_STATES, "SELECT state, count(*) FROM runs INDEXED BY runs_by_state GROUP BY state")    \
    X(OLDEST_QUEUED, "SELECT created_ms FROM runs INDEXED BY runs_by_state WHERE state = 0 "       \
                     "ORDER BY id LIMIT 1")                                                        \
    X(NEXT_QUEUED,                                                                                 \
      "SELECT " STORE__RUN_COLUMNS " FROM runs INDEXED BY runs_queue WHERE state = 0 "             \
      "ORDER BY priority DESC, id LIMIT 1")                                                        \
    X(LIST_ALL, STORE__LIST("?4 < 0 AND ?5 = ''"))                                                 \
    X(LIST_STATE, STORE__LIST("state = ?4 AND ?5 = ''"))                                           \
    X(LIST_LABEL, STORE__LIST("(?4 < 0 OR state = ?4) AND label = ?5"))                            \
    X(PUT_TEXT, "INSERT OR REPLACE INTO texts (run, kind, data) VALUES (?1, ?2, ?3)")              \
    X(GET_TEXT, "SELECT data FROM texts WHERE run = ?1 AND kind = ?2")                             \
    X(INSERT_SAMPLES,                                                                              \
      "INSERT INTO samples (results, first, n, t, parts) VALUES (?1, ?2, ?3, ?4, ?5)")             \
    X(LIST_SAMPLES, "SELECT first, n, t, parts FROM samples WHERE results = ?1 AND first >= "      \
                    "coalesce((SELECT max(first) FROM samples WHERE results = ?1 AND "             \
                    "first <= ?2), 0) ORDER BY first")                                             \
    X(GET_SAMPLES, "SELECT n, t, parts FROM samples WHERE results = ?1 AND first = ?2")            \
    X(INSERT_SNAPSHOT, "INSERT INTO snapshots (results, item, t, peak, mass) "                     \
                       "VALUES (?1, ?2, ?3, ?4, ?5)")                                              \
    X(GET_SNAPSHOT, "SELECT item, t, peak, mass FROM snapshots WHERE results = ?1 AND item = ?2")  \
    X(LIST_SNAPSHOTS,                                                                              \
      "SELECT item, t, peak, mass FROM snapshots WHERE results = ?1 ORDER BY item")                \
    X(INSERT_CHUNK, "INSERT INTO chunks (results, kind, item, part, data) "                        \
                    "VALUES (?1, ?2, ?3, ?4, ?5)")                                                 \
    X(LIST_CHUNKS, "SELECT data FROM chunks WHERE results = ?1 AND kind = ?2 AND item = ?3 "       \
                   "ORDER BY part")                                                                \
    X(DELETE_CHUNKS, "DELETE FROM chunks WHERE results = ?1 AND kind = ?2 AND item = ?3")          \
    X(INSERT_RESULTS, "INSERT INTO results (digest, solver) VALUES (?1, ?2)")                      \
    X(MARK_RESULTS, "UPDATE results SET state = ?2 WHERE number = ?1")                             \
    X(DISOWN_RESULTS, "UPDATE results SET solver = '' WHERE state = 0 AND solver <> ?1")           \
    X(FIND_SOLVED,                                                                                 \
      "SELECT " STORE__RUN_COLUMNS " FROM runs WHERE results = (SELECT number FROM results "       \
      "WHERE digest = ?1 AND solver = ?2 AND state = 1 ORDER BY number DESC LIMIT 1) "             \
      "LIMIT 1")                                                                                   \
    X(ARE_SHARED, "SELECT 1 FROM runs WHERE results = ?1 LIMIT 1")                                 \
    X(FIND_LEFT_OVER, "SELECT number FROM results WHERE state = 2 LIMIT 1")                        \
    X(SWEEP_CHUNKS, "DELETE FROM chunks WHERE rowid IN "                                           \
                    "(SELECT rowid FROM chunks WHERE results = ?1 LIMIT ?2)")                      \
    X(DELETE_RESULTS, "DELETE FROM results WHERE number = ?1")                                     \
    X(INSERT_EVENT, "INSERT INTO events (run, type, snapshot, data) VALUES (?1, ?2, ?3, ?4)")      \
    X(SHARE_EVENTS, "INSERT INTO events (run, type, snapshot, data) SELECT ?1, type, snapshot, ''" \
                    " FROM events WHERE run = ?2 AND type IN (2, 3) ORDER BY id")                  \
    X(NEXT_EVENT, "SELECT id FROM events WHERE run = ?1 AND id > ?2 ORDER BY id LIMIT 1")          \
    X(GET_EVENT, "SELECT type, snapshot, data FROM events WHERE id = ?1")                          \
    X(INSERT_MEASUREMENT, "INSERT INTO measurements (" STORE__MEASUREMENT_COLUMNS ", t, counts) "  \
                          "VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9)")                           \
    X(DELETE_MEASUREMENT, "DELETE FROM measurements WHERE id = ?1")                                \
    X(COUNT_MEASUREMENTS, "SELECT count(*) FROM measurements")                                     \
    X(FIND_MEASUREMENT,                                                                            \
      "SELECT " STORE__MEASUREMENT_COLUMNS ", t, counts FROM measurements WHERE id = ?1")          \
    X(LIST_MEASUREMENTS, "SELECT " STORE__MEASUREMENT_COLUMNS " FROM measurements WHERE id < ?1 "  \
                         "ORDER BY id DESC LIMIT ?2")                                              \
    X(LIST_MEASUREMENTS_LABEL, "SELECT " STORE__MEASUREMENT_COLUMNS " FROM measurements "          \
                               "WHERE id < ?1 AND label = ?3 ORDER BY id DESC LIMIT ?2")           \
    X(FIND_ANSWER, "SELECT digest, id, revision, data FROM answers "                               \
                   "WHERE route = ?1 AND key = ?2")                                                \
    X(INSERT_ANSWER, "INSERT INTO answers (route, key, digest, id, revision, at_ms, data) "        \
                     "VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7)")                                        \
    X(FORGET_ANSWERS, "DELETE FROM answers WHERE at_ms < ?1")                                      \
    X(TRIM_ANSWERS, "DELETE FROM answers WHERE number <= ?1")                                      \
    X(OLDEST_ENDED, "SELECT " STORE__RUN_COLUMNS " FROM runs WHERE state >= 2 "                    \
                    "ORDER BY finished_ms, id LIMIT 1")                                            \
    X(COUNT_ENDED, "SELECT count(*) FROM runs WHERE state >= 2")                                   \
    X(PAGE_SIZE, "PRAGMA page_size")                                                               \
    X(COUNT_PAGES, "PRAGMA page_count")                                                            \
    X(COUNT_FREE_PAGES, "PRAGMA freelist_count")                                                   \
    X(PROBE, "INSERT OR REPLACE INTO probe (id, at_ms) VALUES (1, ?1)")
