/// The event stream of a study towards one client: server-sent events or NDJSON.
///
/// A stream is a cursor over the trials in the order in which they ended, which never changes; it keeps no queue.
///
///     trial    its id is its place among those that have ended, from 1; the trial
///     status   without an id, when the study has changed: the study
///     end      its id is one more than that of the last trial: the study. Nothing follows
///
///     SSE      retry: 3000, then for each event  id: N / event: WORD / data: {...}
///     NDJSON   {"id":N,"study":"...","event":"WORD","data":{...}}

#pragma once

#include "api/http/stream.h"
#include "api/study/study_trial.h"

/// A client's cursor.
typedef struct study_stream {
    stream_format format;  ///< form of the bytes
    char id[API_ID_SIZE];  ///< of the study
    study_columns columns; ///< of its trials
    uint64_t after;        ///< id of the last event written, or seen by the client
    uint64_t revision;     ///< of the study that was told last; 0: none
    bool has_begun;        ///< the preamble (`retry:`) was written
} study_stream;

/// Begin the stream of a study behind the event `after`, with format and columns as they are set. An id that is newer than
/// all events, as after a loss of the store, counts as the newest. False: the client has seen the end.
bool study_stream_begin(study_stream *stream, const api_study *about);

/// Make the stream, which is copied, the body of a response. *ret_source is the caller's; its destroy() frees it. BF_ENOMEM.
BF_MUST_CHECK bf_status study_stream_open(const study_stream *stream, body_source *ret_source,
                                          bf_error *err);
