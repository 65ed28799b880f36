/// Power that fails: what SQLite wrote to a file and did not sync is lost from it, wholly or in part.
///
/// A VFS of SQLite under all others of the process. Once armed it remembers of each file what was synced, and what was
/// written since. When the power fails, each write since is lost, there, or there in some of its sectors; the
/// files are left so and the process ends. Made, deleted and renamed files stay as they are: file systems
/// order those by themselves.

#pragma once

/// Put the VFS below all stores of this process. To be called before the first one is opened.
void helper_store_power_install(void);

/// Let the power fail at the n-th write, sync or cut of a file from now on, in this process alone. Files that are
/// open already are not looked at. seed: which writes are lost.
void helper_store_power_fail_at(unsigned n, unsigned seed);
