/// The drives of plates that move, under the load of parts.
///
///     load      of a plate: sum of k delta over its contacts, their resultant, and the torque about its pivot. An impact lasts for few
///               steps, a part that is wedged in stays: what counts is the least load of the last DRIVES_WINDOW times
///               that it was measured
///     times     every n_steps, in which no plate moves farther than 1 % of the smallest radius, at most DRIVES_STEPS_MAX;
///               the window is shorter where a plate would move farther than 10 % in it
///
/// Units    SI.

#pragma once

#include "core/base/checkpoint.h"
#include "core/micro/backend.h"
#include "core/micro/micro.h"

enum {
    DRIVES_STEPS_MAX = 16, ///< between two measurements
    DRIVES_WINDOW = 4,     ///< measurements
};

/// The drives of a solver's obstacles. Make with drives_init(), free with drives_fini().
typedef struct drives {
    size_t n;                            ///< obstacles; 0: none has a drive with a limit
    bf_world *world;                     ///< with the drives, borrowed
    double dt;                           ///< step of the solver, s
    uint64_t n_steps;                    ///< between two measurements
    size_t window;                       ///< measurements that count
    plate_load (*recent)[DRIVES_WINDOW]; ///< of each obstacle, the newest one first
} drives;

/// Those of a checked definition with its step. BF_ENOMEM: *d is empty.
BF_MUST_CHECK bf_status drives_init(drives *d, const micro_def *def, bf_error *err);

/// Free what *d owns.
void drives_fini(drives *d);

/// Steps up to the next measurement after `steps`, at most n.
uint64_t drives_steps_until(const drives *d, uint64_t steps, uint64_t n);

/// Measure, if it is time, and let plates follow until the next time.
void drives_follow(drives *d, const micro_backend *backend, micro_common *state);

/// Write what was measured, and take it into drives of the same definition. False: it is damaged, and *d undefined.
void drives_save(const drives *d, checkpoint_writer *w);
BF_MUST_CHECK bool drives_load(drives *d, checkpoint_reader *r);
