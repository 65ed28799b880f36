/// The variants of the step, one per instruction set.
///
/// macro_push.c and macro_sweep.c are compiled once for each (core/CMakeLists.txt); the fastest that
/// the processor can run is chosen at run time. All give the same bits.

#pragma once

struct macro_band;

/// A variant.
typedef struct variant {
    const char *name;                            ///< "avx512", "avx2" or "base"
    void (*sweep_band)(struct macro_band *band); ///< advance the band's rows by one step
} variant;

/// The fastest variant that this processor can run.
const variant *variant_best(void);

/// All variants that this processor can run, fastest first; NULL-terminated.
const variant *const *variant_available(void);
