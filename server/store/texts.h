/// Inside the store: texts of runs.

#pragma once

#include "server/store/store_priv.h"

/// Kinds of texts. The values stand in the store: never renumber.
typedef enum store__text {
    STORE__TEXT_SCENARIO, ///< the resolved document
    STORE__TEXT_SUMMARY,  ///< summary.json
    STORE__TEXT_COLUMNS,  ///< of the curve
    STORE__TEXT_FIGURES,  ///< key figures so far
} store__text;

/// Insert or replace a text of a run.
BF_MUST_CHECK bf_status store__put_text(store__connection *writer, int64_t rowid, store__text kind,
                                        const char *text, size_t n, bf_error *err);

/// Append a text of a run to *out. BF_ENOTFOUND: there is none.
BF_MUST_CHECK bf_status store__get_text(store__connection *c, int64_t rowid, store__text kind,
                                        bf_buffer *out, bf_error *err);

/// The same of a scenario, a summary or key figures: those of trials are compressed against the scenario of their study's first.
/// *n_bytes rises by what they take.
BF_MUST_CHECK bf_status store__put_run_text(store__connection *writer, const store__row *row,
                                            store__text kind, const char *text, size_t n,
                                            uint64_t *n_bytes, bf_error *err);
BF_MUST_CHECK bf_status store__get_run_text(store__connection *c, const store__row *row,
                                            store__text kind, bf_buffer *out, bf_error *err);
