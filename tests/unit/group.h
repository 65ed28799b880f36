/// Included ahead of every test file of a folder's program. CMake defines `main` as `group_<file>`, so that this declares
/// the file's function that groups.c calls.

#pragma once

/// Run the tests of the file. Returns how many failed.
int main(void);
