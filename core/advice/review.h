/// What is said about the results of a scenario: warnings, in the words of those who plan with them.

#pragma once

#include "core/base/status.h"

#include <stddef.h>

enum {
    REVIEW_WARNINGS_MAX = 64, ///< kept; further ones are dropped
    REVIEW_TEXT_SIZE = 400,   ///< bytes of a text with its terminator
};

/// A reason to doubt the results. It is no fault: the scenario can be solved.
typedef struct review_warning {
    char title[REVIEW_TEXT_SIZE];   ///< what is the case, without a full stop
    char meaning[REVIEW_TEXT_SIZE]; ///< what it means for a planner, in sentences
    char detail
        [REVIEW_TEXT_SIZE]; ///< figures and limits of the solver, in sentences; "": there are none
    char pointer
        [BF_POINTER_SIZE]; ///< what is to be changed, in the scenario's document; "": all of it
} review_warning;

/// Warnings in the order in which they were found. Zero-initialise; owns nothing.
typedef struct review_warnings {
    size_t n;                                      ///< kept
    review_warning items[REVIEW_WARNINGS_MAX + 1]; ///< the last one takes what is dropped
} review_warnings;

/// Add a warning with a title; the pointer to what it is about is a format with its values. Return it, without a meaning.
review_warning *review_add(review_warnings *w, const char *title, const char *pointer, ...)
    __attribute__((format(printf, 3, 4)));

/// Write the meaning of a warning, a format with its values.
void review_explain(review_warning *item, const char *meaning, ...)
    __attribute__((format(printf, 2, 3)));

/// Add all of the others.
void review_append(review_warnings *w, const review_warnings *others);
