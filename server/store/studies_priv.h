/// Private parts of the store's studies.

#pragma once

#include "server/store/store_priv.h"
#include "server/store/studies.h"

/// A study's row.
typedef struct store__study {
    int64_t rowid;                ///< column number
    api_study study;              ///< what others see of it
    char client[API_CLIENT_SIZE]; ///< who submitted it
    store_stop stop_request;      ///< what is asked of it
} store__study;

/// Find a study by its id, also one that is to be removed. BF_ENOTFOUND.
BF_MUST_CHECK bf_status store__find_study(store__connection *c, const char *id,
                                          store__study *ret_row, bf_error *err);

/// Write a changed study back, with a new revision.
BF_MUST_CHECK bf_status store__save_study(store__connection *writer, store__study *row,
                                          bf_error *err);

/// Insert or replace a text of a study.
BF_MUST_CHECK bf_status store__put_study_text(store__connection *writer, const store__study *row,
                                              api_study_text kind, const bf_buffer *text,
                                              bf_error *err);

/// Move a study to another state, without saving it. BF_ECONFLICT: it has ended.
BF_MUST_CHECK bf_status store__move_study(store__study *row, api_study_state to, bf_error *err);
