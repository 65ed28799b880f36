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

/// Which of the services waits until the test lets it go on.
typedef enum fake_held {
    FAKE_HELD_NONE,
    FAKE_HELD_READY,
    FAKE_HELD_LIST,
    FAKE_HELD_SUBMIT,
    FAKE_HELD_SNAPSHOT,
    FAKE_HELD_EVENTS
} fake_held;

/// The log, and what else a test can turn. Under lock.
typedef struct fake {
    lock lock;              ///< guards what follows
    lock_condition changed; ///< of n_waiting or held
    uint64_t n_events;      ///< events of the log, ids from 1
    bool has_ended;         ///< the last of them is `end`
    fake_held held; ///< this one waits: ready(), list(), submit(), read_array() or read_events()
    bool is_broken; ///< read_events() and read_array() fail
    unsigned n_waiting;   ///< calls that wait because they are held
    unsigned n_finds;     ///< calls of find()
    unsigned n_reads;     ///< calls of read_events() and read_array()
    uint64_t n_snapshots; ///< of every run, of FAKE_CELLS noisy cells each
    void (*after_look)(
        void); ///< called by find() and read_events() when they have their answer; NULL: nothing
} fake;

void fake_init(fake *f);
void fake_fini(fake *f);

/// The table. What no test of the transport asks for is NULL, and must not be asked for.
api_services fake_services(fake *f);

/// Append an event; the last one if is_end.
void fake_append(fake *f, bool is_end);

/// Let one of the services wait, and all others go on.
void fake_hold(fake *f, fake_held held);

/// Wait until n calls wait because they are held; false: they are fewer after twenty seconds.
bool fake_wait_for_held(fake *f, unsigned n);

/// A server on a free port with limits that tests seldom exceed. change (NULL: none) may adjust the
/// options before it starts.
http *fake_serve(fake *f, void (*change)(http_options *options));
