/// What `beltflowd` does with a store besides serving it: `beltflowd backup FILE` and
/// `beltflowd verify [FILE]`. Both may be used while a daemon runs.
///
/// They print on stdout, what went wrong on stderr, and return the exit code: 0 done and sound; 2 the
/// arguments are at fault; 1 anything else.

#pragma once

/// Copy the store in the data directory to a new file.
int maintenance_backup(const char *directory, const char *file);

/// Check the store in a file (NULL: that in the data directory), a line for each check.
int maintenance_verify(const char *directory, const char *file);
