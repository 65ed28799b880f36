/// Services for tests of the transport: every run id exists and has the same growing log of events.

#pragma once

#include "api/services.h"
#include "server/base/lock.h"
#include "server/http/http.h"

#include <stdbool.h>
#include <stdint.h>

/// A run that exists.
#define FAKE_RUN "01234567-89ab-7cde-8f01-23456789abcd"

enum { FAKE_CELLS = 65536 }; ///< of a snapshot

/// The log, and what else a test can turn. Under lock.
typedef struct fake {
    lock lock;                ///< guards what follows
    lock_condition changed;   ///< waiting, or is_held
    uint64_t n_events;        ///< events of the log, ids from 1
    bool has_ended;           ///< the last of them is `end`
    bool is_held;             ///< ready() waits until it is not
    bool is_broken;           ///< read_events() and read_snapshot() fail
    unsigned n_waiting;       ///< calls of ready() that wait
    unsigned n_finds;         ///< calls of find()
    unsigned n_reads;         ///< calls of read_events() and read_snapshot()
    uint64_t n_snapshots;     ///< of every run, of FAKE_CELLS noisy cells each
    void (*after_find)(void); ///< called by find() when it has its answer; NULL: nothing
} fake;

void fake_init(fake *f);
void fake_fini(fake *f);

/// The table. What no test asks for is BF_ENOTFOUND.
api_services fake_services(fake *f);

/// Append an event; the last one if is_end.
void fake_append(fake *f, bool is_end);

/// Let ready() wait, or not any more.
void fake_hold(fake *f, bool is_held);

/// A server on a free port with limits that tests seldom meet. change (NULL: none) may adjust the
/// options before it starts.
http *fake_serve(fake *f, void (*change)(http_options *options));
