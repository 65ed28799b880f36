/// Private to the store: statements of sets of results, and of those that may be wrong; see sql.h.

#pragma once

/// X(name, text), as in sql.h. States are those of store__results.
#define STORE__SQL_RESULTS(X)                                                                      \
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
