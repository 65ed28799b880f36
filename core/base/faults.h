/// The list of faults that a check finds in one document, each with its JSON pointer.

#pragma once

#include "core/base/status.h"

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>

enum { FAULTS_MAX = 64 }; ///< recorded per document; further ones are only counted

/// Faults in the order in which they were found. Zero-initialise; owns nothing.
///
/// Threads  only *is_cancelled may be set by another thread: long checks then end early, with a BF_EBUSY among the faults.
typedef struct bf_faults {
    bf_error items[FAULTS_MAX];       ///< the first FAULTS_MAX of them
    size_t n;                         ///< how many were found, recorded or not
    const _Atomic bool *is_cancelled; ///< nobody needs the result any more; NULL: never
} bf_faults;

/// Note a fault of the document (BF_EINPUT) at pointer.
void faults_add(bf_faults *faults, const char *pointer, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/// Note a fault that is a limit exceeded (BF_ELIMIT) at pointer.
void faults_add_limit(bf_faults *faults, const char *pointer, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/// Say of the fault that was noted last which number breaks which limit, if both are finite.
void faults_set_limit(bf_faults *faults, double value, double limit);

/// Add a failure as it was reported, with any code.
void faults_add_error(bf_faults *faults, const bf_error *err);

/// True if the check is cancelled; cheap.
static inline bool faults_are_cancelled(const bf_faults *faults)
{
    return faults->is_cancelled != NULL &&
           atomic_load_explicit(faults->is_cancelled, memory_order_relaxed);
}

/// How many are recorded: the smaller of n and FAULTS_MAX.
size_t faults_kept(const bf_faults *faults);

/// BF_OK if there are none; else the first one, copied to *err (NULL is fine), and its code.
BF_MUST_CHECK bf_status faults_status(const bf_faults *faults, bf_error *err);
