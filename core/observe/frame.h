/// Frames: what a run reports while it computes, and their bytes on a pipe or in a file.
///
///     offset  bytes  content, little-endian
///     0       4      magic "BFF1"
///     4       4      type, enum frame_type
///     8       8      n, length of the payload
///     16      n      payload: the fields of the type's struct below, in order
///     16 + n  0..7   zeros up to a multiple of 8, so that the frame after it is aligned
///     ...     8      digest (digest.h) of all bytes of the frame before it
///
/// A reader can tell an incomplete frame at the end (wait, or discard it) from damage (BF_ECORRUPT).

#pragma once

#include "core/base/buffer.h"
#include "core/base/grid.h"
#include "core/base/status.h"
#include "core/base/vec2.h"
#include "core/scene/limits.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/// Frames in the order in which a run emits them: job (to the run), begin, then any number of curve, snapshot, progress,
/// change and checkpoint, then one end or error. Where begin announces rows of parts, a parts frame follows each snapshot at
/// once. As bytes, the array of a snapshot or of parts stands in slices before it. The values are stored: never renumber.
typedef enum frame_type {
    FRAME_JOB = 1,    ///< to the run: the scenario document and how to solve it
    FRAME_RESUME,     ///< to the run: a checkpoint's bytes to go on from
    FRAME_BEGIN,      ///< sizes of the results
    FRAME_CURVE,      ///< samples of the counters
    FRAME_SNAPSHOT,   ///< the density grid at one time
    FRAME_PROGRESS,   ///< how far the run is
    FRAME_CHECKPOINT, ///< bytes to resume from; everything before it has been emitted
    FRAME_END,        ///< the run is over: done, or stopped on request
    FRAME_ERROR,      ///< the run failed
    FRAME_PARTS,      ///< the parts at the time of the snapshot before it
    FRAME_CHANGE,     ///< what equipment did: see frame_change_type
    FRAME_FIGURES,    ///< the key figures so far
    FRAME_SLICE, ///< a part of the array of the snapshot or parts frame that comes next; in bytes only
    FRAME_TYPE_COUNT
} frame_type;

/// Bytes of the longest payload, and array, that a reader accepts; of every slice but the last of an array; before a payload.
#define FRAME_PAYLOAD_MAX  (UINT64_C(1) << 32)
#define FRAME_SLICE_BYTES  131072
#define FRAME_HEADER_BYTES 16

/// The job.
typedef struct frame_job {
    uint32_t model;                ///< run_model of core/run/run.h
    uint32_t n_threads;            ///< threads to use
    size_t n_document;             ///< bytes of the scenario document
    const char *document;          ///< the scenario as JSON
    uint32_t is_without_snapshots; ///< 1: neither snapshots nor parts are sent; else 0
} frame_job;

/// Bytes of FRAME_RESUME and FRAME_CHECKPOINT.
typedef struct frame_bytes {
    uint64_t step;     ///< steps that were made
    size_t n;          ///< bytes
    const void *bytes; ///< the solver's state
} frame_bytes;

/// Sizes of the results.
typedef struct frame_begin {
    uint32_t model;      ///< run_model
    uint32_t n_columns;  ///< columns of the curve, see columns.h
    uint64_t n_steps;    ///< most steps of the whole run; it may end before
    double dt;           ///< s
    double duration;     ///< n_steps * dt, s
    uint64_t n_parts;    ///< parts at the start; more may enter later
    uint64_t first_step; ///< 0, or the step of the checkpoint that the run resumes from
    uint32_t n_values;   ///< values of a part in FRAME_PARTS; 0: the model has no parts
    bf_grid grid;        ///< of the snapshots
    uint64_t
        definition; ///< digest of scenario and model: whose results these are, run_definition()
} frame_begin;

/// Samples first .. first + n - 1 of the curve.
typedef struct frame_curve {
    uint64_t first;       ///< index of the first sample since the start of the run
    uint32_t n;           ///< samples
    uint32_t n_columns;   ///< values per sample
    const double *t;      ///< n times, s
    const double *values; ///< n rows of n_columns parts
} frame_curve;

/// The density at one time.
typedef struct frame_snapshot {
    uint64_t index;   ///< 0 at the start of the run
    double t;         ///< s
    double peak;      ///< largest density
    double mass;      ///< parts in the domain
    uint32_t n1;      ///< columns
    uint32_t n2;      ///< rows
    const float *rho; ///< n2 rows of n1, normalised; NULL in a decoded frame: it came in slices
} frame_snapshot;

/// Values of a part, by the equations of motion: x, y, heading, vx, vy, spin, or position (3), quaternion w, x, y, z (4),
/// velocity (3), angular velocity (3). SI units, rad. In scenarios with feeds id and kind stand before them.
enum {
    FRAME_VALUES_PLANAR = 6,
    FRAME_VALUES_SPATIAL = 13,
    FRAME_VALUES_FED = 2, ///< more with feeds
};

/// The parts at one time. Without feeds row k is part k, in the order in which parts were placed, and a part that
/// has left the domain still has a row, of NANs, so that row k is part k in every frame that has it. With feeds there
/// are rows of the parts in the domain, by their ids: unique numbers from 0, in the order of entering. Kinds are
/// indices into the kinds of cargo.
typedef struct frame_parts {
    uint64_t index;     ///< of the snapshot
    double t;           ///< s
    uint64_t n_parts;   ///< rows
    uint32_t n_values;  ///< FRAME_VALUES_PLANAR or _SPATIAL, with feeds FRAME_VALUES_FED more
    const double *rows; ///< n_parts rows of n_values; NULL in a decoded frame: they came in slices
} frame_parts;

/// Bytes of an array, so that neither side needs room for a second one. Slices come in order and without gap.
typedef struct frame_slice {
    uint32_t of;       ///< whose array: FRAME_SNAPSHOT or FRAME_PARTS
    uint64_t index;    ///< of the snapshot
    uint64_t at;       ///< bytes of the array before it
    size_t n;          ///< bytes: FRAME_SLICE_BYTES, or what is left of the array
    const void *bytes; ///< n of them
} frame_slice;

/// True if rows of n_values begin with id and kind.
static inline bool frame_has_ids(uint32_t n_values)
{
    return n_values == FRAME_VALUES_PLANAR + FRAME_VALUES_FED ||
           n_values == FRAME_VALUES_SPATIAL + FRAME_VALUES_FED;
}

/// True if rows of n_values are of parts that move in the plane.
static inline bool frame_is_planar(uint32_t n_values)
{
    return n_values == FRAME_VALUES_PLANAR || n_values == FRAME_VALUES_PLANAR + FRAME_VALUES_FED;
}

/// Frames of changes that a run sends at most; later ones take effect, but are not told.
enum { FRAME_CHANGES_MAX = 100000 };

/// What changed.
typedef enum frame_change_type {
    FRAME_CHANGE_EYE,    ///< the state of a photo eye
    FRAME_CHANGE_ACTION, ///< the target of an action
    FRAME_CHANGE_DRIVE, ///< how a plate follows what it is told; while it is behind, every 2 degrees or 10 mm
    FRAME_CHANGE_BELT, ///< whether a failure, a break or a merge stops a belt
    FRAME_CHANGE_TYPE_COUNT
} frame_change_type;

/// What equipment did.
typedef struct frame_change {
    uint64_t index;         ///< 0 for the first of the run
    double t;               ///< s
    uint32_t type;          ///< frame_change_type
    uint32_t item;          ///< index in the scenario: of the photo eye, action, obstacle or belt
    uint32_t state;         ///< from now on: 1 if blocked, plate_drive_state, or belt_stops_cause
    char id[SCENE_ID_SIZE]; ///< of the photo eye, the action's target, the obstacle or the belt
    double turn;            ///< of the obstacle, counter-clockwise, rad; else 0
    vec2 shift;             ///< of the obstacle, m; else 0
} frame_change;

/// The key figures until a time, as by figure.h; NAN: the run cannot say. They come with progress and before the end.
typedef struct frame_figures {
    double t;             ///< of the last sample, s
    uint64_t n;           ///< figure_values() of the scenario
    const double *values; ///< n of them
} frame_figures;

/// Why a run is over.
typedef enum frame_end_reason {
    FRAME_END_DURATION, ///< its duration has passed, or it was stopped
    FRAME_END_DRAINED,  ///< SCENE_UNTIL_DRAINED
    FRAME_END_STEADY,   ///< SCENE_UNTIL_STEADY
    FRAME_END_REASON_COUNT
} frame_end_reason;

/// How far the run is.
typedef struct frame_progress {
    uint64_t step, n_steps; ///< steps made, and most of the whole run
    double t;               ///< simulated time, s
} frame_progress;

/// How a run ended, and its figures.
typedef struct frame_end {
    uint32_t stopped;   ///< 0: done; 1: stopped on request, resumable if a checkpoint came last
    uint32_t reason;    ///< frame_end_reason
    uint64_t n_steps;   ///< steps made since t = 0
    double t;           ///< simulated time, s
    uint64_t n_cells;   ///< cells of the grid
    double parts_start; ///< parts in the domain at t = 0
    double parts_end;   ///< parts in the domain now
    double parts_entered, parts_fallen; ///< since t = 0: that entered, and that fell off the belts
    double peak;                        ///< largest density of all snapshots and samples
    uint64_t digest;                    ///< of the final state
    uint64_t n_samples, n_snapshots;    ///< of the curve, and snapshots, since t = 0
    // Of models with parts, else 0:
    uint64_t n_parts_left;  ///< parts that left the domain since t = 0
    double part_steps;      ///< steps times parts: those in the domain; without feeds, at the start
    uint64_t n_contacts;    ///< contacts with a force at the end
    double kinetic_energy;  ///< of the parts in the domain at the end, J
    double largest_overlap; ///< of any contact since t = 0, m
    double overlap_share;   ///< largest overlap divided by the smaller part's radius, since t = 0
    double reduction_start, reduction; ///< modulus_reduction at both ends, where chosen by the run
} frame_end;

/// One frame; only the member of its type is valid. Pointers are borrowed from the creator of the frame.
typedef struct frame {
    frame_type type; ///< which member
    union {
        frame_job job;           ///< FRAME_JOB
        frame_bytes bytes;       ///< FRAME_RESUME, FRAME_CHECKPOINT
        frame_begin begin;       ///< FRAME_BEGIN
        frame_curve curve;       ///< FRAME_CURVE
        frame_snapshot snapshot; ///< FRAME_SNAPSHOT
        frame_progress progress; ///< FRAME_PROGRESS
        frame_end end;           ///< FRAME_END
        bf_error error;          ///< FRAME_ERROR: as reported by the function that failed
        frame_parts parts;       ///< FRAME_PARTS
        frame_change change;     ///< FRAME_CHANGE
        frame_figures figures;   ///< FRAME_FIGURES
        frame_slice slice;       ///< FRAME_SLICE
    };
} frame;

/// Bytes of the array of a snapshot or of parts; 0 for other frames, UINT64_MAX: more than FRAME_PAYLOAD_MAX.
uint64_t frame_array_bytes(const frame *f);

/// The slice of a frame's array that begins at byte `at`, written before the frame; its bytes are borrowed. False: none does.
bool frame_slice_at(const frame *f, uint64_t at, frame *ret_slice);

/// Append the bytes of a frame to *out, but for an array's. BF_ENOMEM: *out is as before.
BF_MUST_CHECK bf_status frame_encode(const frame *f, bf_buffer *out, bf_error *err);

/// Bytes of the whole frame that the n bytes begin with, and its type; 0: its header is not complete, or of no frame.
uint64_t frame_length(const void *bytes, size_t n, frame_type *ret_type);

/// Decode the frame at the start of the n bytes. *ret_used = 0: they end inside the frame, more are needed; else its length.
/// Pointers in *ret_frame point into bytes, which must be aligned to 8. BF_ECORRUPT: not a frame, damaged, or too long.
BF_MUST_CHECK bf_status frame_decode(const void *bytes, size_t n, frame *ret_frame,
                                     size_t *ret_used, bf_error *err);

/// The same of the next frame of a job's input. BF_ECORRUPT also where it is not whole, or of another type.
BF_MUST_CHECK bf_status frame_decode_input(const void *bytes, size_t n, frame_type type,
                                           frame *ret_frame, size_t *ret_used, bf_error *err);
