/// Private to the store: statements that list runs, for the table of sql.h, which has STORE__RUN_COLUMNS.

#pragma once

/// A page of a list in the order of creation by one index; ?1 older than, ?2 how many, ?3 model or -1, ?4 state or -1,
/// ?5 label or '', ?6 owner or '', ?7 the study whose trials they are or '', ?10 not older than.
#define STORE__LIST(source)                                                                        \
    "SELECT " STORE__RUN_COLUMNS " FROM runs " source " AND parent = ?7 AND id < ?1 "              \
    "AND id >= ?10 AND (?3 < 0 OR model = ?3) AND (?4 < 0 OR state = ?4) "                         \
    "AND (?5 = '' OR label = ?5) AND (?6 = '' OR owner = ?6) ORDER BY id DESC LIMIT ?2"

/// The oldest of those that such a page looks at: the one with ?2 newer ones in the index, ?1, ?4 to ?7 as above.
#define STORE__OLDEST(source)                                                                      \
    "SELECT id FROM runs " source " AND parent = ?7 AND id < ?1 ORDER BY id DESC LIMIT 1 OFFSET "  \
    "?2"

/// By which index: all, open ones (few), ended ones, an owner's, or those with a label.
#define STORE__BY_ALL   "INDEXED BY runs_by_parent WHERE true"
#define STORE__BY_OPEN  "INDEXED BY runs_open WHERE state = ?4 AND state < 2"
#define STORE__BY_ENDED "INDEXED BY runs_ended WHERE state = ?4 AND state NOT IN (0, 1)"
#define STORE__BY_OWNER "INDEXED BY runs_by_owner WHERE owner = ?6 AND owner <> ''"
#define STORE__BY_LABEL "INDEXED BY runs_by_label WHERE label = ?5 AND label <> ''"

/// Which runs a search, another order or a count takes, by ?3 to ?7 as above and ?8, what name, label or line contains, or '': of
/// the newest ones up to that with ?9 newer ones, so that it takes a bounded time; ?10 and ?11 not older than, older than,
/// ?12 1: only starred ones, ?13 line or '', ?14 an api_conditions or an empty blob, which are tried last.
#define STORE__FOUND                                                                               \
    "runs INDEXED BY runs_by_parent WHERE parent = ?7 AND (?3 < 0 OR model = ?3) "                 \
    "AND (?4 < 0 OR state = ?4) AND (?5 = '' OR label = ?5) AND (?6 = '' OR owner = ?6) "          \
    "AND (?8 = '' OR instr(lower(name), ?8) > 0 OR instr(lower(label), ?8) > 0 "                   \
    "OR instr(lower(line), ?8) > 0) "                                                              \
    "AND id >= coalesce((SELECT id FROM runs WHERE parent = ?7 ORDER BY id DESC LIMIT 1 "          \
    "OFFSET ?9), '') AND id >= ?10 AND id < ?11 AND starred >= ?12 "                               \
    "AND (?13 = '' OR line = ?13) "                                                                \
    "AND (length(?14) = 0 OR (SELECT conditions_hold(?14, data, figures) FROM texts "              \
    "WHERE texts.run = runs.number AND texts.kind = 0)) "

/// A page of them by their keys; ?15 an api_sort_by, ?16 the path of its figure, ?17 the key of the run before the page,
/// which may be NULL. `than` parts keys behind it from those before it.
#define STORE__SORTED(direction, than)                                                             \
    "SELECT " STORE__RUN_COLUMNS ", sort_key FROM (SELECT number AS found, id AS found_id, "       \
    "CASE ?15 WHEN 0 THEN id WHEN 1 THEN nullif(finished_ms, 0) "                                  \
    "WHEN 2 THEN substr(CAST(nullif(lower(name), '') AS BLOB), 1, 80) "                            \
    "WHEN 3 THEN substr(CAST(nullif(lower(label), '') AS BLOB), 1, 80) "                           \
    "WHEN 4 THEN model WHEN 5 THEN state "                                                         \
    "ELSE json_extract(nullif(figures, ''), ?16) END AS sort_key "                                 \
    "FROM " STORE__FOUND "AND (?1 = '~' OR (sort_key IS ?17 AND id < ?1) "                         \
    "OR (?17 IS NOT NULL AND (sort_key " than " ?17 OR sort_key IS NULL))) "                       \
    "ORDER BY sort_key " direction " NULLS LAST, id DESC LIMIT ?2) "                               \
    "JOIN runs ON number = found ORDER BY sort_key " direction " NULLS LAST, found_id DESC"

/// A page of lines by their newest run or study; parameters are those of store__list_page(). Of runs the index alone is read,
/// but for each line's newest one.
#define STORE__LINES_OF_RUNS                                                                       \
    "SELECT n.owner, n.line, versions, runs, 0 AS studies, r.id AS run, r.id AS newest, "          \
    "r.created_ms AS used FROM (SELECT owner, line, max(line_version) AS versions, "               \
    "count(*) AS runs, max(number) AS last FROM runs INDEXED BY runs_by_line WHERE line <> '' "    \
    "AND line_version > 0 AND (?3 = '' OR owner = ?3) GROUP BY owner, line) AS n "                 \
    "JOIN runs AS r ON r.number = n.last"
#define STORE__LINES_OF_STUDIES                                                                    \
    "SELECT owner, line, 0, 0, count(*), '', max(id), max(created_ms) FROM studies "               \
    "WHERE line <> '' AND (?3 = '' OR owner = ?3) GROUP BY owner, line"
#define STORE__LINES                                                                               \
    "SELECT owner, line, max(versions), sum(runs), sum(studies), max(run), max(newest), "          \
    "max(used) FROM (" STORE__LINES_OF_RUNS " UNION ALL " STORE__LINES_OF_STUDIES ") "             \
    "GROUP BY owner, line HAVING max(newest) < ?1 ORDER BY max(newest) DESC LIMIT ?2"

/// X(name, text), as in sql.h.
#define STORE__SQL_LISTS(X)                                                                        \
    X(LIST_ALL, STORE__LIST(STORE__BY_ALL))                                                        \
    X(LIST_OPEN, STORE__LIST(STORE__BY_OPEN))                                                      \
    X(LIST_ENDED, STORE__LIST(STORE__BY_ENDED))                                                    \
    X(LIST_OWNER, STORE__LIST(STORE__BY_OWNER))                                                    \
    X(LIST_LABEL, STORE__LIST(STORE__BY_LABEL))                                                    \
    X(LAST_ALL, STORE__OLDEST(STORE__BY_ALL))                                                      \
    X(LAST_ENDED, STORE__OLDEST(STORE__BY_ENDED))                                                  \
    X(LAST_OWNER, STORE__OLDEST(STORE__BY_OWNER))                                                  \
    X(LAST_LABEL, STORE__OLDEST(STORE__BY_LABEL))                                                  \
    X(LIST_FOUND,                                                                                  \
      "SELECT " STORE__RUN_COLUMNS " FROM " STORE__FOUND "AND id < ?1 ORDER BY id DESC LIMIT ?2")  \
    X(LIST_RISING, STORE__SORTED("ASC", ">"))                                                      \
    X(LIST_FALLING, STORE__SORTED("DESC", "<"))                                                    \
    X(LIST_LINES, STORE__LINES)                                                                    \
    X(COUNT_FOUND, "SELECT count(*) FROM " STORE__FOUND)                                           \
    X(COUNT_LISTED, "SELECT count(*) FROM (SELECT 1 FROM runs WHERE parent = ?7 LIMIT ?9 + 1)")
