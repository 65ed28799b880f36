/// Private to the store: columns and statements of studies and trials, as parts of the lists of sql.h, whose macros they use.

#pragma once

/// The columns of table studies next to its key `number` and to `turn`, and the members of store_study: those that an
/// insert sets and no update, but for ANNOTATE_STUDY.
#define STORE__STUDY_FIXED(X)                                                                      \
    X(ID, id, study.id)                                                                            \
    X(INTEGER, method, study.method)                                                               \
    X(INTEGER, model, study.model)                                                                 \
    X(INTEGER, priority, study.priority)                                                           \
    X(TEXT, name, study.name)                                                                      \
    X(TEXT, line, study.line)                                                                      \
    X(TEXT, owner, study.owner)                                                                    \
    X(TEXT, client, client)                                                                        \
    X(INTEGER, created_ms, study.created_ms)                                                       \
    X(INTEGER, trials_max, study.trials_max)

/// Those that every update writes, next to `state`.
#define STORE__STUDY_CHANGING(X)                                                                   \
    X(INTEGER, revision, study.revision)                                                           \
    X(INTEGER, started_ms, study.started_ms)                                                       \
    X(INTEGER, finished_ms, study.finished_ms)                                                     \
    X(INTEGER, n_trials, study.n_trials)                                                           \
    X(INTEGER, n_succeeded, study.n_ended[API_TRIAL_SUCCEEDED])                                    \
    X(INTEGER, n_failed, study.n_ended[API_TRIAL_FAILED])                                          \
    X(INTEGER, n_infeasible, study.n_ended[API_TRIAL_INFEASIBLE])                                  \
    X(INTEGER, n_pruned, study.n_ended[API_TRIAL_PRUNED])                                          \
    X(INTEGER, n_cancelled, study.n_ended[API_TRIAL_CANCELLED])                                    \
    X(CODE, error_code, study.error.code)                                                          \
    X(TEXT, error_pointer, study.error.pointer)                                                    \
    X(TEXT, error_text, study.error.text)                                                          \
    X(INTEGER, stop_request, stop_request)                                                         \
    X(INTEGER, suspect, study.is_suspect)

/// All of them.
#define STORE__STUDY_LIST(X)                                                                       \
    X(INTEGER, state, study.state)                                                                 \
    STORE__STUDY_CHANGING(X)                                                                       \
    STORE__STUDY_FIXED(X)

/// The columns that a study is read from.
#define STORE__STUDY_COLUMNS "number" STORE__STUDY_LIST(STORE__NAME)

/// Studies in a state that are to be worked on, ?1 at most.
#define STORE__STUDIES_IN(state)                                                                   \
    "SELECT " STORE__STUDY_COLUMNS " FROM studies WHERE state = " state " AND stop_request = 0 "   \
    "ORDER BY priority DESC, (SELECT count(*) FROM studies AS o INDEXED BY "                       \
    "studies_by_owners_turn WHERE o.owner = studies.owner AND o.state = 1), id LIMIT ?1"

/// The columns of table trials but for its study, and the members of api_trial, then its blobs and the state of its run.
#define STORE__TRIAL_LIST(X)                                                                       \
    X(INTEGER, number, number)                                                                     \
    X(INTEGER, point, point)                                                                       \
    X(INTEGER, model, model)                                                                       \
    X(INTEGER, substream, substream)                                                               \
    X(INTEGER, state, state)                                                                       \
    X(INTEGER, ended, ended)                                                                       \
    X(TEXT, run, run)                                                                              \
    X(CODE, error_code, fault.code)                                                                \
    X(TEXT, error_pointer, fault.pointer)                                                          \
    X(TEXT, error_text, fault.text)
#define STORE__TRIAL_NAME(kind, column, member) "t." #column ", "
#define STORE__TRIAL_COLUMNS                    STORE__TRIAL_LIST(STORE__TRIAL_NAME) "t.parameters, t.vals, r.state"
#define STORE__TRIALS                           "trials AS t LEFT JOIN runs AS r ON t.ended = 0 AND r.id = t.run"

/// X(name, text). States of studies are those of api_study_state: 0 queued, 1 running, 5 paused; stop requests are
/// those of store_stop: 2 is to be removed. A trial with ended = 0 is open.
#define STORE__SQL_STUDIES(X)                                                                      \
    X(NEXT_WAITING_TRIAL,                                                                          \
      "SELECT " STORE__RUN_COLUMNS " FROM runs INDEXED BY trials_waiting WHERE state = 0 "         \
      "AND parent <> '' AND parent = ?1 ORDER BY id LIMIT 1")                                      \
    X(LIST_STUDY_TURNS,                                                                            \
      "SELECT id, priority, (SELECT max(turn) FROM studies WHERE owner = s.owner), turn "          \
      "FROM studies AS s WHERE state = 1 AND stop_request = 0 ORDER BY priority DESC, id LIMIT "   \
      "?1")                                                                                        \
    X(END_STUDY_TURN,                                                                              \
      "UPDATE studies SET turn = (SELECT max(turn) + 1 FROM studies) WHERE id = ?1")               \
    X(INSERT_STUDY, "INSERT INTO studies (number" STORE__STUDY_LIST(                               \
                        STORE__NAME) ") "                                                          \
                                     "VALUES (NULL" STORE__STUDY_LIST(STORE__VALUE) ")")           \
    X(UPDATE_STUDY,                                                                                \
      "UPDATE studies SET state = ?" STORE__STUDY_CHANGING(STORE__ASSIGN) " WHERE number = ?")     \
    X(ANNOTATE_STUDY, "UPDATE studies SET name = ?1, line = ?2 WHERE number = ?3")                 \
    X(DELETE_STUDY, "DELETE FROM studies WHERE number = ?1")                                       \
    X(FIND_STUDY, "SELECT " STORE__STUDY_COLUMNS " FROM studies WHERE id = ?1")                    \
    X(LIST_STUDIES, "SELECT " STORE__STUDY_COLUMNS " FROM studies WHERE id < ?1 "                  \
                    "AND stop_request < 2 AND (?6 < 0 OR state = ?6) AND (?3 = '' OR owner = ?3) " \
                    "AND (?5 = '' OR line = ?5) "                                                  \
                    "ORDER BY id DESC LIMIT ?2")                                                   \
    X(COUNT_OPEN_STUDIES, "SELECT count(*) FROM studies WHERE state IN (0, 1, 5)")                 \
    X(COUNT_OPEN_STUDIES_OF,                                                                       \
      "SELECT count(*) FROM studies INDEXED BY studies_by_owners_turn WHERE owner = ?1 AND "       \
      "state IN (0, 1, 5)")                                                                        \
    X(COUNT_STUDIES, "SELECT count(*) FROM studies")                                               \
    X(LIST_RUNS_OF_STUDY, "SELECT id FROM runs INDEXED BY runs_by_parent WHERE parent = ?1 "       \
                          "ORDER BY id LIMIT ?2")                                                  \
    X(LIST_STUDIES_TO_STOP, "SELECT " STORE__STUDY_COLUMNS " FROM studies "                        \
                            "WHERE stop_request > 0 ORDER BY stop_request, id LIMIT ?1")           \
    X(LIST_STUDIES_RUNNING, STORE__STUDIES_IN("1"))                                                \
    X(LIST_STUDIES_QUEUED, STORE__STUDIES_IN("0"))                                                 \
    X(OLDEST_ENDED_STUDY, "SELECT " STORE__STUDY_COLUMNS " FROM studies WHERE finished_ms > 0 "    \
                          "AND finished_ms < ?1 AND stop_request < 2 "                             \
                          "ORDER BY finished_ms LIMIT 1")                                          \
    X(PUT_STUDY_TEXT, "INSERT OR REPLACE INTO study_texts (study, kind, data) "                    \
                      "VALUES (?1, ?2, ?3)")                                                       \
    X(GET_STUDY_TEXT, "SELECT data FROM study_texts WHERE study = ?1 AND kind = ?2")               \
    X(INSERT_TRIAL, "INSERT INTO trials (study, parameters, vals" STORE__TRIAL_LIST(               \
                        STORE__NAME) ") VALUES (?, ?, ?" STORE__TRIAL_LIST(STORE__VALUE) ")")      \
    X(END_TRIAL, "UPDATE trials SET state = ?3, ended = ?4, vals = ?5, error_code = ?6, "          \
                 "error_pointer = ?7, error_text = ?8 "                                            \
                 "WHERE study = ?1 AND number = ?2 AND ended = 0")                                 \
    X(LIST_TRIALS, "SELECT " STORE__TRIAL_COLUMNS " FROM " STORE__TRIALS                           \
                   " WHERE t.study = ?1 AND t.number >= ?2 ORDER BY t.number LIMIT ?3")            \
    X(LIST_ENDED_TRIALS,                                                                           \
      "SELECT " STORE__TRIAL_COLUMNS " FROM " STORE__TRIALS                                        \
      " WHERE t.study = ?1 AND t.ended > 0 AND t.ended >= ?2 ORDER BY t.ended LIMIT ?3")           \
    X(LIST_OPEN_TRIALS, "SELECT " STORE__TRIAL_COLUMNS " FROM " STORE__TRIALS                      \
                        " WHERE t.study = ?1 AND t.ended = 0 AND t.number >= ?2 "                  \
                        "ORDER BY t.number LIMIT ?3")                                              \
    X(DELETE_TRIALS, "DELETE FROM trials WHERE study = ?1 AND number IN "                          \
                     "(SELECT number FROM trials WHERE study = ?1 LIMIT ?2)")                      \
    X(NEXT_RUN_OF_STUDY, "SELECT " STORE__RUN_COLUMNS " FROM runs INDEXED BY runs_by_parent "      \
                         "WHERE parent = ?1 ORDER BY id LIMIT 1")
