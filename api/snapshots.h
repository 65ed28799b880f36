/// Snapshots as the daemon has them: grids of density, and rows of parts.

#pragma once

#include "core/base/buffer.h"
#include "core/base/grid.h"

#include <stddef.h>
#include <stdint.h>

/// The rows of parts that come with each snapshot of a run; see frame_parts.
typedef struct api_parts {
    uint64_t n_parts;  ///< rows; of a whole run with feeds 0: each snapshot has its own number
    uint32_t n_values; ///< doubles of a row; 0: the model has no parts
} api_parts;

/// One snapshot without its grid.
typedef struct api_snapshot {
    uint64_t index; ///< from 0
    double t;       ///< s
    double peak;    ///< largest density
    double mass;    ///< parts in the domain
} api_snapshot;

/// Which array of a snapshot: its density, n2 rows of n1 float32, or its rows of parts.
typedef enum api_array_kind { API_ARRAY_DENSITY, API_ARRAY_PARTS } api_array_kind;

/// What is known of an array.
typedef struct api_array {
    api_snapshot snapshot; ///< whose it is
    bf_grid grid;          ///< of the density
    api_parts parts;       ///< how many there are
} api_array;

/// The stored snapshots of a run. Zero-initialise; free with buffer_fini(&items).
typedef struct api_snapshot_list {
    bf_grid grid;    ///< of all of them
    api_parts parts; ///< of all of them
    size_t n;        ///< how many
    bf_buffer items; ///< n api_snapshot
} api_snapshot_list;

/// A stored array of numbers that is read piece by piece, with api_services.read_slice(). Between two reads nothing
/// of the store is held. Zero-initialise; api_slices_fini().
typedef struct api_slices {
    uint64_t n;                   ///< bytes of the array
    size_t n_held;                ///< bytes of memory that it may take between two reads
    void *state;                  ///< of the service, owned
    void (*destroy)(void *state); ///< frees state
} api_slices;

/// End the reading and zero *slices.
void api_slices_fini(api_slices *slices);
