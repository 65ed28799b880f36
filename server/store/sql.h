/// Private to the store: its statements, as one table. Each connection prepares one when it is
/// first used, until it is closed.

#pragma once

#include "server/store/sql_lists.h"
#include "server/store/sql_results.h"
#include "server/store/sql_studies.h"
#include "server/store/sql_tokens.h"

/// The columns of table runs next to its key `number`, and the members of store__row that they hold, as
/// X(kind, column, member). A kind is INTEGER, REAL (not finite: NULL), TEXT (characters with their
/// terminator) or CODE (bf_status by its word). Those that an insert sets and no update, but for ANNOTATE_RUN:
#define STORE__RUN_FIXED(X)                                                                        \
    X(ID, id, run.id)                                                                              \
    X(INTEGER, model, run.model)                                                                   \
    X(INTEGER, priority, run.priority)                                                             \
    X(TEXT, label, run.label)                                                                      \
    X(TEXT, name, run.name)                                                                        \
    X(TEXT, line, run.line)                                                                        \
    X(INTEGER, line_version, run.line_version)                                                     \
    X(TEXT, line_scenario, line_scenario)                                                          \
    X(TEXT, notes, run.notes)                                                                      \
    X(INTEGER, starred, run.is_starred)                                                            \
    X(TEXT, closure, run.closure)                                                                  \
    X(INTEGER, created_ms, run.created_ms)                                                         \
    X(INTEGER, results, results)                                                                   \
    X(INTEGER, is_cached, run.is_cached)                                                           \
    X(TEXT, client, client)                                                                        \
    X(TEXT, parent, run.study)                                                                     \
    X(TEXT, owner, run.owner)

/// Those that every update writes, next to `revision`. No index has one of them: SQLite writes an index anew when a column
/// of it is assigned, even the same value. `state` and `finished_ms` are for MOVE_RUN.
#define STORE__RUN_CHANGING(X)                                                                     \
    X(REAL, progress, run.progress)                                                                \
    X(INTEGER, started_ms, run.started_ms)                                                         \
    X(REAL, eta_s, run.eta_s)                                                                      \
    X(REAL, wall_s, wall_s)                                                                        \
    X(INTEGER, n_samples, run.n_samples)                                                           \
    X(INTEGER, n_snapshots, run.n_snapshots)                                                       \
    X(INTEGER, last_event, run.last_event)                                                         \
    X(INTEGER, has_summary, run.has_summary)                                                       \
    X(CODE, error_code, run.error.code)                                                            \
    X(TEXT, error_pointer, run.error.pointer)                                                      \
    X(TEXT, error_text, run.error.text)                                                            \
    X(INTEGER, checkpoint_step, checkpoint_step)                                                   \
    X(INTEGER, n1, run.grid.n1)                                                                    \
    X(INTEGER, n2, run.grid.n2)                                                                    \
    X(REAL, lower1, run.grid.lower1)                                                               \
    X(REAL, lower2, run.grid.lower2)                                                               \
    X(REAL, d1, run.grid.d1)                                                                       \
    X(REAL, d2, run.grid.d2)                                                                       \
    X(INTEGER, n_parts, run.parts.n_parts)                                                         \
    X(INTEGER, n_values, run.parts.n_values)                                                       \
    X(INTEGER, stop_request, stop_request)                                                         \
    X(INTEGER, attempts, attempts)                                                                 \
    X(INTEGER, hand_backs, hand_backs)                                                             \
    X(TEXT, external_id, external_id)                                                              \
    X(TEXT, figures, run.figures)                                                                  \
    X(REAL, cpu_s, cpu_s)                                                                          \
    X(INTEGER, n_bytes, n_bytes)                                                                   \
    X(INTEGER, suspect, run.is_suspect)

/// All of them but `number`, in the order of the texts below.
#define STORE__RUN_LIST(X)                                                                         \
    X(INTEGER, state, run.state)                                                                   \
    X(INTEGER, finished_ms, run.finished_ms)                                                       \
    X(INTEGER, revision, run.revision)                                                             \
    STORE__RUN_CHANGING(X)                                                                         \
    STORE__RUN_FIXED(X)

/// A column in a list of names, of values, and of assignments.
#define STORE__NAME(kind, column, member)   ", " #column
#define STORE__VALUE(kind, column, member)  ", ?"
#define STORE__ASSIGN(kind, column, member) ", " #column " = ?"

/// What store__run_record has.
#define STORE__RUN_COLUMNS "number" STORE__RUN_LIST(STORE__NAME)

/// X(name, text). Parameters are bound in the order ?1, ?2, ... States of runs and types of events are
/// those of run_state and api_event_type: from 2 on a run has ended; 2 and 3 are curve and snapshot.
/// States of results are those of store__results. The table tokens is in the database of tokens.h.
#define STORE__SQL_LIST(X)                                                                         \
    X(BEGIN_WRITE, "BEGIN IMMEDIATE")                                                              \
    X(BEGIN_READ, "BEGIN")                                                                         \
    X(COMMIT, "COMMIT")                                                                            \
    X(ROLLBACK, "ROLLBACK")                                                                        \
    X(SAVEPOINT, "SAVEPOINT operation")                                                            \
    X(RELEASE, "RELEASE operation")                                                                \
    X(ROLLBACK_TO, "ROLLBACK TO operation")                                                        \
    X(INSERT_RUN, "INSERT INTO runs (number" STORE__RUN_LIST(                                      \
                      STORE__NAME) ") "                                                            \
                                   "VALUES (NULL" STORE__RUN_LIST(STORE__VALUE) ")")               \
    X(MOVE_RUN, "UPDATE runs SET state = ?1, finished_ms = ?2 WHERE number = ?3")                  \
    X(UPDATE_RUN,                                                                                  \
      "UPDATE runs SET revision = ?" STORE__RUN_CHANGING(STORE__ASSIGN) " WHERE number = ?")       \
    X(ANNOTATE_RUN, "UPDATE runs SET name = ?1, label = ?2, notes = ?3, starred = ?4, line = ?5, " \
                    "line_version = ?6, line_scenario = ?7 WHERE number = ?8")                     \
    X(LINE_VERSION, "SELECT coalesce((SELECT line_version FROM runs INDEXED BY "                   \
                    "runs_by_line_scenario WHERE line <> '' AND owner = ?1 AND line = ?2 AND "     \
                    "line_scenario = ?3 LIMIT 1), max(line_version) + 1, 1) FROM runs INDEXED BY " \
                    "runs_by_line WHERE line <> '' AND owner = ?1 AND line = ?2")                  \
    X(DELETE_RUN, "DELETE FROM runs WHERE number = ?1")                                            \
    X(FIND_RUN, "SELECT " STORE__RUN_COLUMNS " FROM runs WHERE id = ?1")                           \
    X(NEXT_RUNNING, "SELECT " STORE__RUN_COLUMNS                                                   \
                    " FROM runs INDEXED BY runs_open WHERE state = 1 AND state < 2 AND id > ?1 "   \
                    "ORDER BY id LIMIT 1")                                                         \
    X(REQUEST_STOP, "UPDATE runs SET stop_request = ?2 WHERE number = ?1")                         \
    X(SET_EXTERNAL_ID, "UPDATE runs SET external_id = ?2 WHERE id = ?1 AND state = 1")             \
    X(COUNT_QUEUED, "SELECT count(*) FROM runs INDEXED BY runs_waiting WHERE state = 0 "           \
                    "AND parent = ''")                                                             \
    X(COUNT_QUEUED_OF, "SELECT count(*) FROM runs INDEXED BY runs_by_client WHERE state = 0 "      \
                       "AND client <> '' AND client = ?1")                                         \
    X(COUNT_STATES, "SELECT state, count(*) FROM runs INDEXED BY runs_open WHERE state < 2 "       \
                    "GROUP BY state UNION ALL SELECT state, count(*) FROM runs INDEXED BY "        \
                    "runs_ended WHERE state NOT IN (0, 1) GROUP BY parent, state")                 \
    X(COUNT_CLAIMABLE_TRIALS,                                                                      \
      "SELECT count(*) FROM runs INDEXED BY trials_waiting WHERE state = 0 AND parent <> '' AND "  \
      "parent IN (SELECT id FROM studies WHERE state = 1 AND stop_request = 0)")                   \
    X(OLDEST_QUEUED,                                                                               \
      "SELECT created_ms FROM runs INDEXED BY runs_open WHERE state = 0 AND state < 2 "            \
      "AND parent = '' ORDER BY id LIMIT 1")                                                       \
    X(LIST_QUEUED,                                                                                 \
      "SELECT id, parent FROM runs INDEXED BY runs_open WHERE state = 0 AND state < 2 "            \
      "ORDER BY id LIMIT ?1")                                                                      \
    X(LIST_MEASURED, "SELECT id, parent, cpu_s, finished_ms FROM runs INDEXED BY runs_by_end "     \
                     "WHERE state >= 2 AND state = 2 AND cpu_s > 0 AND finished_ms > ?1 "          \
                     "ORDER BY finished_ms DESC LIMIT ?2")                                         \
    X(COUNT_QUEUED_OWNED, "SELECT count(*) FROM runs INDEXED BY runs_waiting WHERE state = 0 "     \
                          "AND parent = '' AND owner = ?1")                                        \
    X(NEXT_QUEUED_OWNED,                                                                           \
      "SELECT " STORE__RUN_COLUMNS " FROM runs INDEXED BY runs_waiting WHERE state = 0 "           \
      "AND parent = '' AND owner = ?1 ORDER BY priority DESC, id LIMIT 1")                         \
    X(NEXT_QUEUED_BEHIND,                                                                          \
      "SELECT " STORE__RUN_COLUMNS " FROM runs INDEXED BY runs_waiting WHERE state = 0 "           \
      "AND parent = '' AND owner > ?1 ORDER BY owner, priority DESC, id LIMIT 1")                  \
    X(END_TURN, "UPDATE owners SET turn = (SELECT max(turn) + 1 FROM owners) WHERE owner = ?1")    \
    X(COUNT_BYTES_OF, "SELECT n_bytes FROM owners WHERE owner = ?1")                               \
    X(GET_TURN, "SELECT turn FROM owners WHERE owner = ?1")                                        \
    X(CHARGE, "INSERT INTO cpu_sums (owner, hour, cpu_s) VALUES (?1, ?2, ?3) "                     \
              "ON CONFLICT (owner, hour) DO UPDATE SET cpu_s = cpu_s + excluded.cpu_s")            \
    X(LIST_CPU_SUMS,                                                                               \
      "SELECT hour, cpu_s FROM cpu_sums WHERE owner = ?1 AND hour > ?2 AND hour <= ?3")            \
    X(EXPIRE_CPU_SUMS, "DELETE FROM cpu_sums WHERE hour <= ?1 OR hour > ?2")                       \
    X(FORGET_OWNERS, "DELETE FROM owners INDEXED BY owners_without_bytes WHERE n_bytes = 0 AND "   \
                     "owner <> '' AND NOT EXISTS "                                                 \
                     "(SELECT 1 FROM runs WHERE runs.owner = owners.owner AND runs.owner <> '')")  \
    X(PUT_TEXT, "INSERT OR REPLACE INTO texts (run, kind, data) VALUES (?1, ?2, ?3)")              \
    X(GET_TEXT, "SELECT data FROM texts WHERE run = ?1 AND kind = ?2")                             \
    X(PUT_TEXT_DELTA, "INSERT OR REPLACE INTO text_deltas (run, kind, data) VALUES (?1, ?2, ?3)")  \
    X(GET_TEXT_DELTA, "SELECT data FROM text_deltas WHERE run = ?1 AND kind = ?2")                 \
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
    X(LIST_CHUNKS, "SELECT data, part FROM chunks WHERE results = ?1 AND kind = ?2 AND item = ?3 " \
                   "ORDER BY part")                                                                \
    X(GET_CHUNK, "SELECT data FROM chunks WHERE results = ?1 AND kind = ?2 AND item = ?3 "         \
                 "AND part = ?4")                                                                  \
    X(COUNT_CHUNKS, "SELECT coalesce(max(part) + 1, 0) FROM chunks WHERE results = ?1 "            \
                    "AND kind = ?2 AND item = ?3")                                                 \
    X(DELETE_CHUNKS, "DELETE FROM chunks WHERE results = ?1 AND kind = ?2 AND item = ?3")          \
    X(DELETE_OPEN_SNAPSHOTS,                                                                       \
      "DELETE FROM chunks WHERE results = ?1 AND kind IN (?2, ?3) AND item >= ?4")                 \
    X(COUNT_SNAPSHOT,                                                                              \
      "UPDATE results SET n_bytes = n_bytes + (SELECT coalesce(sum(length(data)), 0) FROM chunks " \
      "WHERE results = ?1 AND kind IN (?3, ?4) AND item = ?2) WHERE number = ?1")                  \
    X(INSERT_EVENT, "INSERT INTO events (run, type, snapshot, data) VALUES (?1, ?2, ?3, ?4)")      \
    X(INSERT_CHANGE, "INSERT INTO changes (results, item, data) VALUES (?1, ?2, ?3)")              \
    X(GET_CHANGE, "SELECT data FROM changes WHERE results = ?1 AND item = ?2")                     \
    X(COUNT_CHANGES, "SELECT count(*) FROM events WHERE run = ?1 AND type >= 6")                   \
    X(COPY_EVENTS,                                                                                 \
      "INSERT INTO events (run, type, snapshot, data) SELECT ?1, type, snapshot, "                 \
      "CASE WHEN type >= 5 THEN replace(data, ?4, ?3) ELSE '' END FROM events WHERE run = ?2 AND " \
      "(type IN (2, 3) OR type >= 6 OR id = (SELECT max(id) FROM events WHERE run = ?2 AND type "  \
      "= 5)) ORDER BY id")                                                                         \
    X(SUM_EVENTS,                                                                                  \
      "SELECT coalesce(sum(length(CAST(data AS BLOB))), 0) FROM events WHERE run = ?1")            \
    X(COUNT_SOME_CHANGES,                                                                          \
      "SELECT count(*) FROM (SELECT 1 FROM events WHERE run = ?1 AND type >= 6 LIMIT ?2)")         \
    X(LIST_CHANGES,                                                                                \
      "SELECT id, type, snapshot, data FROM events WHERE run = ?1 AND type >= 6 ORDER BY id")      \
    X(NEXT_EVENT, "SELECT id FROM events WHERE run = ?1 AND id > ?2 ORDER BY id LIMIT 1")          \
    X(GET_EVENT, "SELECT type, snapshot, data FROM events WHERE id = ?1")                          \
    X(FIND_KEY, "SELECT digest, id, revision, data FROM answers "                                  \
                "WHERE route = ?1 AND key = ?2")                                                   \
    X(INSERT_KEY, "INSERT INTO answers (route, key, digest, id, revision, at_ms, data) "           \
                  "VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7)")                                           \
    X(EXPIRE_KEYS, "DELETE FROM answers WHERE at_ms < ?1")                                         \
    X(OLDEST_KEY, "SELECT min(number) FROM answers INDEXED BY answers_by_route WHERE route = ?1")  \
    X(TRIM_KEYS, "DELETE FROM answers WHERE route = ?1 AND number <= (SELECT number FROM answers " \
                 "INDEXED BY answers_by_route WHERE route = ?1 ORDER BY number DESC LIMIT 1 "      \
                 "OFFSET ?2)")                                                                     \
    STORE__SQL_TOKENS(X)                                                                           \
    STORE__SQL_RESULTS(X)                                                                          \
    X(OLDEST_ENDED,                                                                                \
      "SELECT " STORE__RUN_COLUMNS " FROM runs WHERE state >= 2 "                                  \
      "AND NOT EXISTS (SELECT 1 FROM trials WHERE trials.run = runs.id AND ended = 0) "            \
      "ORDER BY finished_ms, id LIMIT 1")                                                          \
    X(OWNER_OF_MOST_RUNS, "SELECT owner FROM runs INDEXED BY runs_ended_by_owner "                 \
                          "WHERE state >= 2 GROUP BY owner ORDER BY count(*) DESC, owner LIMIT 1") \
    X(OWNER_OF_MOST_BYTES,                                                                         \
      "SELECT owner FROM owners WHERE EXISTS (SELECT 1 FROM runs INDEXED BY runs_ended_by_owner "  \
      "WHERE state >= 2 AND runs.owner = owners.owner) ORDER BY n_bytes DESC, owner LIMIT 1")      \
    X(FIRST_TO_GO,                                                                                 \
      "SELECT " STORE__RUN_COLUMNS " FROM runs INDEXED BY runs_ended_by_owner WHERE state >= 2 "   \
      "AND owner = ?1 AND NOT EXISTS "                                                             \
      "(SELECT 1 FROM trials WHERE trials.run = runs.id AND ended = 0) "                           \
      "ORDER BY is_cached DESC, finished_ms, id LIMIT 1")                                          \
    X(COUNT_ENDED, "SELECT count(*) FROM runs WHERE state >= 2")                                   \
    X(PAGE_SIZE, "PRAGMA page_size")                                                               \
    X(COUNT_PAGES, "PRAGMA page_count")                                                            \
    X(SHRINK_FILE, "PRAGMA incremental_vacuum(512)")                                               \
    X(COUNT_FREE_PAGES, "PRAGMA freelist_count")                                                   \
    X(NEED_TOKENS, "INSERT OR IGNORE INTO marks (name) VALUES ('tokens')")                         \
    X(NEEDS_TOKENS, "SELECT EXISTS (SELECT 1 FROM marks WHERE name = 'tokens') OR "                \
                    "EXISTS (SELECT 1 FROM owners WHERE owner <> '')")                             \
    X(PROBE, "INSERT OR REPLACE INTO probe (id, at_ms) VALUES (1, ?1)")                            \
    STORE__SQL_LISTS(X)                                                                            \
    STORE__SQL_STUDIES(X)
