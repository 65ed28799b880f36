/// Private to the store: statements of access tokens, for the table of sql.h; their database is one of its own.

#pragma once

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
    X(INSERT_TOKEN,                                                                                \
      "INSERT INTO tokens (name, owner, hash, scopes, created_ms, expires_ms, resource) "          \
      "VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7)")                                                       \
    X(LIST_TOKENS, "SELECT id, name, owner, hash, scopes, created_ms, expires_ms, used_ms, "       \
                   "revoked_ms, resource FROM tokens ORDER BY id")                                 \
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
