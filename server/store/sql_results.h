/// Private to the store: statements of measurements, of sets of results and of those that may be wrong; see sql.h, whose
/// macros they use.

#pragma once

/// The columns of table measurements but for its samples and text, and the members of api_measurement.
#define STORE__MEASUREMENT_LIST(X)                                                                 \
    X(TEXT, label, label)                                                                          \
    X(TEXT, counter, counter)                                                                      \
    X(INTEGER, created_ms, created_ms)                                                             \
    X(INTEGER, n, n_samples)                                                                       \
    X(REAL, t_start, t_start)                                                                      \
    X(REAL, t_end, t_end)                                                                          \
    X(INTEGER, kind, kind)                                                                         \
    X(TEXT, owner, owner)
#define STORE__MEASUREMENT_COLUMNS "id" STORE__MEASUREMENT_LIST(STORE__NAME)

/// X(name, text), as in sql.h. States are those of store__results.
#define STORE__SQL_RESULTS(X)                                                                      \
    X(INSERT_MEASUREMENT,                                                                          \
      "INSERT INTO measurements (" STORE__MEASUREMENT_COLUMNS ", t, counts, csv) "                 \
      "VALUES (?" STORE__MEASUREMENT_LIST(STORE__VALUE) ", ?, ?, ?)")                              \
    X(GET_MEASUREMENT_CSV, "SELECT csv FROM measurements WHERE id = ?1")                           \
    X(DELETE_MEASUREMENT, "DELETE FROM measurements WHERE id = ?1")                                \
    X(COUNT_MEASUREMENTS_OF, "SELECT count(*) FROM measurements WHERE owner = ?1")                 \
    X(COUNT_MEASUREMENTS, "SELECT count(*) FROM measurements")                                     \
    X(FIND_MEASUREMENT,                                                                            \
      "SELECT " STORE__MEASUREMENT_COLUMNS ", t, counts FROM measurements WHERE id = ?1")          \
    X(LIST_MEASUREMENTS, "SELECT " STORE__MEASUREMENT_COLUMNS " FROM measurements WHERE id < ?1 "  \
                         "AND (?3 = '' OR owner = ?3) AND ?4 = '' ORDER BY id DESC LIMIT ?2")      \
    X(LIST_MEASUREMENTS_LABEL, "SELECT " STORE__MEASUREMENT_COLUMNS " FROM measurements "          \
                               "WHERE id < ?1 AND label = ?4 AND (?3 = '' OR owner = ?3) "         \
                               "ORDER BY id DESC LIMIT ?2")                                        \
    X(INSERT_RESULTS, "INSERT INTO results (digest, solver) VALUES (?1, ?2)")                      \
    X(MARK_RESULTS, "UPDATE results SET state = ?2 WHERE number = ?1")                             \
    X(GROW_RESULTS, "UPDATE results SET n_bytes = n_bytes + ?2 WHERE number = ?1")                 \
    X(INVALIDATE_RESULTS, "UPDATE results SET solver = '' WHERE state = 0 AND solver <> ?1 AND "   \
                          "number IN (SELECT results FROM runs WHERE state < 2)")                  \
    X(FIND_SOLVED,                                                                                 \
      "SELECT " STORE__RUN_COLUMNS " FROM runs WHERE results = (SELECT number FROM results "       \
      "WHERE digest = ?1 AND solver = ?2 AND state = 1 ORDER BY number DESC LIMIT 1) "             \
      "LIMIT 1")                                                                                   \
    X(ARE_USED, "SELECT 1 FROM runs WHERE results = ?1 LIMIT 1")                                   \
    X(PUT_SENDER, "INSERT OR IGNORE INTO senders (results, token, began_ms) VALUES (?1, ?2, ?3)")  \
    X(PUT_DISTRUSTED, "INSERT OR REPLACE INTO distrusted (token, at_ms) VALUES (?1, ?2)")          \
    X(PUT_SUSPECT,                                                                                 \
      "INSERT OR IGNORE INTO suspects (results) SELECT results FROM runs WHERE id = ?1")           \
    X(NEXT_SUSPECT,                                                                                \
      "SELECT results FROM suspects WHERE results > 0 UNION ALL SELECT results FROM distrusted "   \
      "JOIN senders INDEXED BY senders_by_token ON senders.token = distrusted.token "              \
      "WHERE distrusted.token > 0 AND began_ms <= at_ms LIMIT 1")                                  \
    X(NEXT_UNMARKED,                                                                               \
      "SELECT " STORE__RUN_COLUMNS " FROM runs WHERE results = ?1 AND suspect = 0 LIMIT 1")        \
    X(SUSPECT_STUDY, "UPDATE studies SET suspect = 1, revision = revision + 1 WHERE id = ?1 "      \
                     "AND suspect = 0")                                                            \
    X(SUSPECT_RESULTS, "UPDATE results SET state = ?2 WHERE number = ?1 AND state = ?3")           \
    X(DROP_SUSPECT, "DELETE FROM suspects WHERE results = ?1")                                     \
    X(DROP_SENDERS, "DELETE FROM senders WHERE results = ?1 AND EXISTS (SELECT 1 FROM distrusted " \
                    "WHERE distrusted.token = senders.token AND began_ms <= at_ms)")               \
    X(FIND_ORPHANED, "SELECT number FROM results WHERE state = 2 LIMIT 1")                         \
    X(COLLECT_CHUNKS, "DELETE FROM chunks WHERE rowid IN "                                         \
                      "(SELECT rowid FROM chunks WHERE results = ?1 LIMIT ?2)")                    \
    X(DELETE_RESULTS, "DELETE FROM results WHERE number = ?1")
