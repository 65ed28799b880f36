/// Snapshots on their way from the frames of a job to items of the store. Slices of their arrays are stored as they come;
/// the snapshot's own frame, or that of its parts where the model has parts, makes it visible.

#pragma once

#include "core/observe/frame.h"
#include "server/store/work.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/// Items of a batch that is being put together. Zero-initialise; snapshots_fini_items().
typedef struct snapshots_items {
    store_item *items; ///< in the order in which they came
    size_t n;          ///< of them
    size_t capacity;   ///< room
} snapshots_items;

/// The snapshot that a job is sending. Zero-initialise; snapshots_forget().
typedef struct snapshots_incoming {
    uint64_t index;     ///< of the snapshot
    uint64_t n_density; ///< bytes that came of its density; 0: no snapshot is under way
    uint64_t n_parts;   ///< bytes that came of its parts
    bool has_header;    ///< its frame came, and its parts have not come yet:
    store_item header;  ///< what the frame says
} snapshots_incoming;

/// Room for one more item, zeroed and counted. NULL: no memory.
store_item *snapshots_add_item(snapshots_items *items, api_event_type type);

/// Free what the items own, and count none. Their arrays belong to others.
void snapshots_drop_items(snapshots_items *items);

/// Free what the items own and the list.
void snapshots_fini_items(snapshots_items *items);

/// True if a frame may come now, as far as the snapshot under way decides that: from its first slice on nothing else
/// comes until it is complete.
bool snapshots_may_come(const snapshots_incoming *c, const frame *f);

/// Take a slice, a snapshot or its parts: the items get what of it is to be stored, borrowed from the frame's bytes.
/// BF_ECORRUPT: it does not follow the frame before it, or has another size than `begin` says; BF_ENOMEM.
BF_MUST_CHECK bf_status snapshots_take(snapshots_incoming *c, const char *run_id,
                                       const frame_begin *begin, const frame *f,
                                       snapshots_items *items, bf_error *err);

/// Forget the snapshot that is under way.
void snapshots_forget(snapshots_incoming *c);
