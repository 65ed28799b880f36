/// Measurements as the services of the API take and return them, the sizes of what runs, studies and measurements have in
/// common, and who submits a run or a study.

#pragma once

#include "api/access.h"
#include "core/scene/limits.h"

#include <stddef.h>
#include <stdint.h>

enum {
    API_ID_SIZE = 37,            ///< bytes of an id (UUIDv7, lower case) with its terminator
    API_LABEL_SIZE = 101,        ///< bytes of a label with its terminator
    API_CLIENT_SIZE = 64,        ///< bytes of a client's address with its terminator
    API_KEY_SIZE = 256,          ///< bytes of an idempotency key with its terminator
    API_LIST_MAX = 200,          ///< runs, studies or measurements a page of a list
    API_MEASUREMENTS_MAX = 2000, ///< measurements that are kept
    API_MEASUREMENT_SAMPLES_MAX = 100000, ///< samples of one
};

/// Who submits a run or a study, and what must be the same where it is submitted again.
typedef struct api_sender {
    char owner[API_OWNER_SIZE];   ///< whose it will be, "" if nobody's
    char client[API_CLIENT_SIZE]; ///< the address, "" if no limit holds for it
    char key[API_KEY_SIZE];       ///< the client's idempotency key, one of its owner's; "" if none
    const char *body;             ///< of a request with a key, n_body bytes; borrowed
    size_t n_body;                ///< bytes
} api_sender;

/// What a measurement is. The values stand in the store: never renumber.
typedef enum api_measured {
    API_MEASURED_CURVE,    ///< samples of a curve, to compare with
    API_MEASURED_PROFILE,  ///< a feed's rate in time, as CSV
    API_MEASURED_SCHEDULE, ///< a feed's list of arrivals, as CSV
    API_MEASURED_COUNT
} api_measured;

/// Their words, ended by NULL.
extern const char *const api_measured_words[API_MEASURED_COUNT + 1];

/// What was measured elsewhere, without its samples.
typedef struct api_measurement {
    char id[API_ID_SIZE];        ///< UUIDv7, unlike those of all runs
    api_measured kind;           ///< what it is
    char label[API_LABEL_SIZE];  ///< the client's, "" if none
    char counter[SCENE_ID_SIZE]; ///< of a curve what was counted: a column of curves; else ""
    int64_t created_ms;          ///< Unix time, ms
    uint64_t n_samples;          ///< of its curve, or rows of its text
    double t_start;              ///< first time, s
    double t_end;                ///< last time, s
    char owner[API_OWNER_SIZE];  ///< whose it is; "": nobody's
} api_measurement;
