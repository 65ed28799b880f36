/// What `beltflowd` does with a data directory besides serving it: `beltflowd backup FILE`,
/// `beltflowd verify [FILE]` and `beltflowd token`. All may be used while a daemon runs.
///
/// They print on stdout, what went wrong on stderr, and return the exit code: 0 done and sound; 2 the
/// arguments are at fault; 1 anything else.

#pragma once

/// Copy the store in the data directory to a new file.
int maintenance_backup(const char *directory, const char *file);

/// Check the store in a file (NULL: that in the data directory), a line for each check.
int maintenance_verify(const char *directory, const char *file);

/// A token that is wanted. NULL: the default.
typedef struct maintenance_token {
    const char *name;    ///< what it is for
    const char *owner;   ///< whose it is; default: the name
    const char *scopes;  ///< words of api/access.h with commas; default: read,submit
    const char *expires; ///< "90d" or "12h" from now; default: never
} maintenance_token;

/// Add a token, and print it: it is the only line on stdout, and is not shown again.
int maintenance_token_add(const char *directory, const maintenance_token *wanted);

/// Print all tokens, a line each, without their secrets.
int maintenance_token_list(const char *directory);

/// Revoke the token with this id.
int maintenance_token_revoke(const char *directory, const char *id);
