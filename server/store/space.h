/// Inside the store: room on the disk, and what is removed by itself.

#pragma once

#include "server/store/store.h"

#include <stdbool.h>
#include <stdint.h>

/// When retention works next.
typedef struct store__retention_turn {
    int64_t every_ms; ///< between two turns
    int64_t next_ms;  ///< monotonic; nothing is done before
    bool has_warned;  ///< of a limit that cannot be reached
} store__retention_turn;

/// What is kept free for what frees something; the store's thread's.
typedef struct store__space {
    bool has_reserve; ///< the file is there
    int64_t next_ms;  ///< monotonic; it is not looked after before
} store__space;

/// Bytes that are free on the store's disk; 0: not known. On any thread.
uint64_t store__count_free(const store *s);

/// BF_OK if the disk has room for more to be accepted; BF_ENOSPACE. On any thread.
BF_MUST_CHECK bf_status store__check_room(const store *s, bf_error *err);

/// The same for n bytes more.
BF_MUST_CHECK bf_status store__check_room_for(const store *s, uint64_t n, bf_error *err);

/// Let go of the reserve of the daemon before if a store could not even be opened on the disk.
void store__make_room_to_open(store *s);

/// Take the reserve, if there is none and room for it; before the store's thread starts, or on it.
void store__take_reserve(store *s);

/// Let go of the reserve, for what frees something on a full disk. False: there is none.
bool store__spend_reserve(store *s);

/// Under the store's lock, which is given meanwhile: if it is time, give a step of free pages back to the disk where
/// that is short, or take the reserve again.
void store__maintain_space(store *s);

/// Under the store's lock, which is given meanwhile: do one step of the store's own work, if it is time.
void store__apply_retention(store *s);
