/// Blocks of cells of a row, and sets of them, so that work can be skipped where its result is exactly zero.
///
/// A set is an array of bits: block b, -1 <= b < n_blocks, is bit b + 1.

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

/// The smallest span that holds both.
static inline block_span block_span_hull(block_span a, block_span b)
{
    if (a.first >= a.last)
        return b;
    if (b.first >= b.last)
        return a;
    return (block_span){ a.first < b.first ? a.first : b.first, a.last > b.last ? a.last : b.last };
}

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

/// Remove all blocks.
static inline void block_set_clear(uint64_t *set, size_t n_words)
{
    for (size_t w = 0; w < n_words; w++)
        set[w] = 0;
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

/// Marks of the blocks of one word of a set, as they are found.
typedef struct block_marks {
    uint64_t bit;   ///< of the current block
    uint64_t any;   ///< blocks with a cell rho >= 1
    uint64_t first; ///< blocks whose first cell is one
} block_marks;

/// No marks yet; block b is the first one.
static inline block_marks block_marks_from(ptrdiff_t b)
{
    return (block_marks){ UINT64_C(1) << (b + 1) % 64, 0, 0 };
}

/// Add the marks of the current block (bit k: cell k is saturated) and advance to the next.
static inline block_marks block_marks_add(block_marks m, unsigned saturated_cells)
{
    m.any |= saturated_cells != 0 ? m.bit : 0;
    m.first |= (saturated_cells & 1) != 0 ? m.bit : 0;
    m.bit <<= 1;
    return m;
}

/// Store the marks of the blocks from low to high, which are in one word, in the sets.
static inline void block_marks_put(block_marks m, ptrdiff_t low, ptrdiff_t high,
                                   uint64_t *saturated, uint64_t *saturated_first)
{
    const ptrdiff_t w = (low + 1) / 64;
    const uint64_t range = block_set_span_word((block_span){ low, high }, (size_t)w);

    saturated[w] = (saturated[w] & ~range) | m.any;
    saturated_first[w] = (saturated_first[w] & ~range) | m.first;
}

/// The end of the blocks from low on that are in one word of a set.
static inline ptrdiff_t block_set_end_of_word(ptrdiff_t low, ptrdiff_t b_max)
{
    const ptrdiff_t end = (low + 1) / 64 * 64 + 63;

    return end < b_max ? end : b_max;
}
