/// Private to the store: statements of access tokens, for the table of sql.h; their database is one of its own.

#pragma once

/// The columns of table tokens, and the members of tokens_record: those that an insert sets, next to hash and scopes,
#define STORE__TOKEN_FIXED(X)                                                                      \
    X(TEXT, name, name)                                                                            \
    X(TEXT, owner, owner)                                                                          \
    X(INTEGER, created_ms, created_ms)                                                             \
    X(INTEGER, expires_ms, expires_ms)                                                             \
    X(TEXT, resource, resource)

/// and all of them but hash and scopes, which come last.
#define STORE__TOKEN_LIST(X)                                                                       \
    X(INTEGER, used_ms, used_ms)                                                                   \
    X(INTEGER, revoked_ms, revoked_ms)                                                             \
    STORE__TOKEN_FIXED(X)

/// X(name, text), as in sql.h.
#define STORE__SQL_TOKENS(X)                                                                       \
    X(HAS_TOKENS, "SELECT count(*) FROM sqlite_schema WHERE name = 'tokens'")                      \
    X(CREATE_TOKENS,                                                                               \
      "CREATE TABLE IF NOT EXISTS tokens (id INTEGER PRIMARY KEY AUTOINCREMENT, name TEXT NOT "    \
      "NULL, "                                                                                     \
      "owner TEXT NOT NULL, hash BLOB NOT NULL UNIQUE CHECK (length(hash) = 32), "                 \
      "scopes TEXT NOT NULL, created_ms INTEGER NOT NULL, expires_ms INTEGER NOT NULL, "           \
      "used_ms INTEGER NOT NULL DEFAULT 0, revoked_ms INTEGER NOT NULL DEFAULT 0, "                \
      "resource TEXT NOT NULL DEFAULT '') STRICT")                                                 \
    X(HAS_TOKEN_RESOURCE,                                                                          \
      "SELECT count(*) FROM pragma_table_info('tokens') WHERE name = 'resource'")                  \
    X(ADD_TOKEN_RESOURCE, "ALTER TABLE tokens ADD COLUMN resource TEXT NOT NULL DEFAULT ''")       \
    X(INSERT_TOKEN, "INSERT INTO tokens (hash, scopes" STORE__TOKEN_FIXED(                         \
                        STORE__NAME) ") VALUES (?, ?" STORE__TOKEN_FIXED(STORE__VALUE) ")")        \
    X(LIST_TOKENS,                                                                                 \
      "SELECT id" STORE__TOKEN_LIST(STORE__NAME) ", scopes, hash FROM tokens ORDER BY id")         \
    X(COUNT_TOKENS, "SELECT count(*) FROM tokens")                                                 \
    X(COUNT_GRANTS, "SELECT count(*) FROM tokens WHERE resource != '' AND revoked_ms = 0 AND "     \
                    "expires_ms > ?1 AND (?2 = '' OR owner = ?2)")                                 \
    X(FORGET_TOKEN,                                                                                \
      "DELETE FROM tokens WHERE id = (SELECT id FROM tokens WHERE revoked_ms > 0 OR "              \
      "(expires_ms > 0 AND expires_ms <= ?1) ORDER BY id LIMIT 1)")                                \
    X(REVOKE_TOKEN, "UPDATE tokens SET revoked_ms = ?2 WHERE id = ?1 AND revoked_ms = 0")          \
    X(END_TOKEN, "UPDATE tokens SET expires_ms = ?2 WHERE id = ?1 AND (expires_ms = 0 OR "         \
                 "expires_ms > ?2)")                                                               \
    X(USE_TOKEN, "UPDATE tokens SET used_ms = max(used_ms, ?2) WHERE id = ?1")
