/// What `beltflowd` does with a data directory besides serving it: `beltflowd backup FILE`, `beltflowd restore FILE`,
/// `beltflowd verify [FILE]` and `beltflowd token`. All but restore may be used while a daemon runs.
///
/// They print on stdout, what went wrong on stderr, and return the exit code: 0 done and sound; 2 the
/// arguments are at fault; 1 anything else.

#pragma once

/// Copy the store in the data directory to a new file, its tokens to FILE.access, and the settings file (NULL: there is none) to
/// FILE.conf. Where FILE is a directory the copy is a file in it that is named by the time, and of such files with all that belongs
/// to them the newest `copies` (a number as text; NULL: all) stay.
int maintenance_backup(const char *directory, const char *settings, const char *file,
                       const char *copies);

/// Put such a copy in the place of what is in the data directory, and FILE.conf in that of a settings file that is missing.
int maintenance_restore(const char *directory, const char *settings, const char *file);

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

/// A new token in the place of the one with this id, which still counts for the time `overlap` ("7d"; NULL: that). Printed as a new
/// one is.
int maintenance_token_rotate(const char *directory, const char *id, const char *overlap);

/// Revoke the token with this id.
int maintenance_token_revoke(const char *directory, const char *id);
