/// Private parts of the store's studies.

#pragma once

#include "server/store/store_priv.h"
#include "server/store/studies.h"

/// Find a study by its id, also one that is to be removed. BF_ENOTFOUND. With an error *row is not defined.
BF_MUST_CHECK bf_status store__find_study(store__connection *c, const char *id, store_study *row,
                                          bf_error *err);

/// Write a changed study back, with a new revision.
BF_MUST_CHECK bf_status store__save_study(store__connection *writer, store_study *row,
                                          bf_error *err);

/// Insert or replace a text of a study.
BF_MUST_CHECK bf_status store__put_study_text(store__connection *writer, const store_study *row,
                                              api_study_text kind, const bf_buffer *text,
                                              bf_error *err);

/// Move a study to another state, without saving it. BF_ECONFLICT: it has ended.
BF_MUST_CHECK bf_status store__move_study(store_study *row, api_study_state to, bf_error *err);
