/// Status codes and the error record that everything in Beltflow reports failures with.
///
/// A function that can fail returns bf_status and fills a caller-owned bf_error (NULL: not required)
/// at the place where the failure is known; the record is then passed up unchanged. Outputs are
/// named ret_... and stay untouched on failure. Programming errors are asserted instead: see check.h.

#pragma once

#include <stdbool.h>
#include <stddef.h>

/// The kinds of failure, each with the word that logs and documents use for it.
#define BF_STATUS_LIST(X)                                                                          \
    X(BF_OK, "ok")                                                                                 \
    X(BF_EINPUT, "bad-input")     /* the caller's document is at fault; pointer says where */      \
    X(BF_ELIMIT, "limit")         /* beyond a stated limit; the text gives figure and limit */     \
    X(BF_ENOMEM, "out-of-memory") /* the machine has no more memory */                             \
    X(BF_ENUMERIC, "numeric")     /* a value became non-finite; the text gives step and place */   \
    X(BF_ECORRUPT, "corrupt")     /* stored or transported bytes are damaged */                    \
    X(BF_ESYSTEM, "system")       /* the operating system refused */                               \
    X(BF_ENOTFOUND, "not-found")  /* the requested item does not exist */                          \
    X(BF_ECONFLICT, "conflict")   /* the request does not fit the present state */                 \
    X(BF_EBUSY, "busy")           /* full at the moment; a later attempt may succeed */            \
    X(BF_ENOSPACE, "no-space")    /* the disk is full, or nearly */

typedef enum bf_status {
#define X(code, word) code,
    BF_STATUS_LIST(X)
#undef X
        BF_STATUS_COUNT
} bf_status;

enum {
    BF_POINTER_SIZE = 160, ///< bytes of a JSON pointer with its terminator
    BF_TEXT_SIZE = 320,    ///< bytes of an error text with its terminator
};

/// What went wrong. Filled only on failure.
typedef struct bf_error {
    bf_status code;                ///< same as the returned status
    char pointer[BF_POINTER_SIZE]; ///< JSON pointer of the place at fault; "" is the whole document
    char text[BF_TEXT_SIZE];       ///< one sentence in English, no full stop
    bool has_limit;                ///< a number breaks a limit:
    double value;                  ///< the number
    double limit;                  ///< the limit
    const char *unit;              ///< of both, static, for who sets it; NULL: none, or not known
} bf_error;

/// Mark a function whose status must be looked at.
#define BF_MUST_CHECK __attribute__((warn_unused_result))

/// The word of a code, e.g. "bad-input". Never NULL.
const char *bf_status_word(bf_status code);

/// Fill *err (NULL is fine) and return code, so that a failing function ends with
/// `return bf_fail(err, BF_ELIMIT, "/macro/cell_m", "...")`. A text that is too long is truncated.
bf_status bf_fail(bf_error *err, bf_status code, const char *pointer, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/// The same of an allocation that concerns no member: BF_ENOMEM, "out of memory".
bf_status bf_fail_memory(bf_error *err);

/// Return the status of the expression if it is a failure. For functions that then have nothing to free or undo.
#define BF_TRY(expression)                                                                         \
    do {                                                                                           \
        const bf_status status_ = (expression);                                                    \
        if (status_ != BF_OK)                                                                      \
            return status_;                                                                        \
    } while (0)
