/// The variants of the step, one per instruction set.
///
/// macro_push.c and macro_sweep.c are compiled for each of them twice (core/CMakeLists.txt): for grids
/// of any width, and for narrow ones, whose sets of blocks are a single word: there the loops over words
/// vanish, which are a third of the work of a small grid. The fastest instruction set that the processor
/// has is chosen at run time. All give the same bits.

#pragma once

struct macro_band;

/// A variant.
typedef struct variant {
    const char *name;                                   ///< "avx512", "avx2" or "base"
    void (*sweep_band)(struct macro_band *band);        ///< advance the band's rows by one step
    void (*sweep_narrow_band)(struct macro_band *band); ///< same where a set is one word
} variant;

/// The fastest variant that this processor can run.
const variant *variant_best(void);

/// All variants that this processor can run, fastest first; NULL-terminated.
const variant *const *variant_available(void);
