/// Sets of blocks of a row, as bits: block b, -1 <= b < n_blocks, is bit b + 1.

#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { BLOCK_CELLS = 8 }; ///< cells of a block: a cache line, an AVX-512 register

/// Blocks first <= b < last of a row; empty where first >= last.
typedef struct block_span {
    ptrdiff_t first; ///< -1 at least
    ptrdiff_t last;  ///< n_blocks at most
} block_span;

/// Words that a set of blocks -1 .. n_blocks - 1 takes.
static inline size_t block_set_words(ptrdiff_t n_blocks)
{
    return ((size_t)n_blocks + 1 + 63) / 64;
}

/// Add block b.
static inline void block_set_add(uint64_t *set, ptrdiff_t b)
{
    set[(b + 1) / 64] |= UINT64_C(1) << ((b + 1) % 64);
}

/// True if b is in the set.
static inline bool block_set_has(const uint64_t *set, ptrdiff_t b)
{
    return (set[(b + 1) / 64] >> ((b + 1) % 64) & 1) != 0;
}

/// Take all blocks out.
static inline void block_set_clear(uint64_t *set, size_t n_words)
{
    for (size_t w = 0; w < n_words; w++)
        set[w] = 0;
}

/// True if nothing is in the set.
static inline bool block_set_is_empty(const uint64_t *set, size_t n_words)
{
    uint64_t any = 0;
    for (size_t w = 0; w < n_words; w++)
        any |= set[w];
    return any == 0;
}

/// The set {b - 1 : b in set}, word by word: what is added to word w.
static inline uint64_t block_set_shifted_down(const uint64_t *set, size_t n_words, size_t w)
{
    return set[w] >> 1 | (w + 1 < n_words ? set[w + 1] << 63 : 0);
}

/// Bits of word w that belong to the span.
static inline uint64_t block_set_span_word(block_span span, size_t w)
{
    ptrdiff_t low = span.first + 1 - (ptrdiff_t)(w * 64);
    ptrdiff_t high = span.last + 1 - (ptrdiff_t)(w * 64);

    if (high <= 0 || low >= 64 || low >= high)
        return 0;
    uint64_t above = low <= 0 ? ~UINT64_C(0) : ~UINT64_C(0) << low;
    uint64_t below = high >= 64 ? ~UINT64_C(0) : ~(~UINT64_C(0) << high);
    return above & below;
}

/// Find the next run of neighbouring blocks at or after *b; afterwards *run is the run and *b where
/// to go on. False: there is none. Begin with *b = -1.
static inline bool block_set_next_run(const uint64_t *set, size_t n_words, ptrdiff_t *b,
                                      block_span *run)
{
    size_t bit = (size_t)(*b + 1), w = bit / 64;

    if (w >= n_words)
        return false;
    uint64_t word = set[w] & ~UINT64_C(0) << bit % 64;
    while (word == 0) {
        if (++w >= n_words)
            return false;
        word = set[w];
    }
    bit = w * 64 + (size_t)__builtin_ctzll(word);
    run->first = (ptrdiff_t)bit - 1;
    word = ~set[w] & ~UINT64_C(0) << bit % 64;
    while (word == 0 && ++w < n_words)
        word = ~set[w];
    run->last =
        (ptrdiff_t)(w < n_words ? w * 64 + (size_t)__builtin_ctzll(word) : n_words * 64) - 1;
    *b = run->last;
    return true;
}

/// How many blocks are in the set.
static inline int block_set_count(const uint64_t *set, size_t n_words)
{
    int n = 0;
    for (size_t w = 0; w < n_words; w++)
        n += __builtin_popcountll(set[w]);
    return n;
}
