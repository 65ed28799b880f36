/// A curve in bounded memory: every sample while they are few, then every second, every fourth one and so on, and
/// always the first and the last.
///
/// With THINNED_SAMPLES samples and more, half as many of them at least stay, evenly in their order.

#pragma once

#include "core/base/checkpoint.h"
#include "core/base/status.h"
#include "core/compare/compare.h"

#include <stdbool.h>
#include <stdint.h>

enum { THINNED_SAMPLES = 4096 };

/// The samples. Begin with thinned_init().
typedef struct thinned {
    uint64_t n_taken; ///< samples that were added
    uint64_t
        every; ///< of how many one stays: the least power of two that leaves room; follows from n_taken
    double *t; ///< those that stay and, behind them, the last one; room for THINNED_SAMPLES + 1
    double *values; ///< same
} thinned;

/// Begin without samples. The caller owns it: thinned_fini(). BF_ENOMEM: nothing is owned.
BF_MUST_CHECK bf_status thinned_init(thinned *ret_c, bf_error *err);

/// Free what *c owns and zero it.
void thinned_fini(thinned *c);

/// Add a sample; times rise.
void thinned_add(thinned *c, double t, double value);

/// The curve, borrowed until the next sample.
compare_curve thinned_curve(const thinned *c);

/// Append the state to a checkpoint, and take it from one. False: damaged; *c is then only to be freed.
void thinned_save(const thinned *c, checkpoint_writer *w);
BF_MUST_CHECK bool thinned_load(thinned *c, checkpoint_reader *r);
