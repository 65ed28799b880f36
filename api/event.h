/// Events of runs, as the services of the API give them.

#pragma once

#include "api/measurements.h"
#include "core/base/status.h"

#include <stddef.h>
#include <stdint.h>

/// Kinds of events with their words in streams.
#define API_EVENT_LIST(X)                                                                          \
    X(API_EVENT_STATUS, "status")                                                                  \
    X(API_EVENT_PROGRESS, "progress")                                                              \
    X(API_EVENT_CURVE, "curve")                                                                    \
    X(API_EVENT_SNAPSHOT, "snapshot")                                                              \
    X(API_EVENT_END, "end")                                                                        \
    X(API_EVENT_FIGURES, "figures")                                                                \
    X(API_EVENT_EYE, "photo_eye")                                                                  \
    X(API_EVENT_ACTION, "action")                                                                  \
    X(API_EVENT_DRIVE, "drive")                                                                    \
    X(API_EVENT_BELT, "belt")

/// The values stand in the store: never renumber. Those from API_EVENT_EYE on say what the equipment did.
typedef enum api_event_type {
#define X(type, word) type,
    API_EVENT_LIST(X)
#undef X
        API_EVENT_TYPE_COUNT
} api_event_type;

/// One stored event.
typedef struct api_event {
    uint64_t id;           ///< rising over all runs of a store, never reused
    char run[API_ID_SIZE]; ///< of this run
    api_event_type type;   ///< kind
    uint64_t snapshot;     ///< API_EVENT_SNAPSHOT: its index; from _EYE on: frame_change.index
    size_t n;              ///< bytes of data
    const char *data;      ///< JSON object, one line; valid during api_event_fn
} api_event;

/// Called with each event that is read; not BF_OK stops the reading and is passed on.
typedef bf_status api_event_fn(void *context, const api_event *event, bf_error *err);

/// The word of an event type. Never NULL.
const char *api_event_word(api_event_type type);
