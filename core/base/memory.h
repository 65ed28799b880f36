/// Memory for core and api, with overflow-checked sizes and a switch that makes the n-th
/// allocation fail, so that tests can walk through every out-of-memory path.
///
/// Threads  allocation is thread-safe; the fault switch belongs to tests with one thread.

#pragma once

#include <stddef.h>

/// Zeroed room for n items of size bytes, aligned to 64 bytes (a cache line, an AVX-512 register).
/// NULL when there is none, when n * size overflows, or when an allocation fault was planned for it. n = 0 gives a
/// valid pointer. Free with memory_free().
void *memory_alloc(size_t n, size_t size);

/// Grow *items (room for *capacity items, NULL when 0) to room for at least n items of size bytes, by at least a
/// quarter; what was there stays. Returns 0, or -1 with everything left as it was.
/// items points to the caller's array pointer, of any object type.
int memory_reserve(void *items, size_t *capacity, size_t n, size_t size);

/// An array of memory_resize().
typedef struct memory_array {
    void *items;  ///< the address of the caller's array pointer, of any object type
    size_t size;  ///< of an item, bytes
    size_t n;     ///< items that stay
    size_t n_new; ///< items that there will be room for, at least n; 0: leave the array alone
} memory_array;

/// Give arrays room for more items, all or none: the first n of each stay, the others are zero. Returns 0, or -1 with
/// everything left as it was. At most MEMORY_ARRAYS_MAX arrays.
int memory_resize(const memory_array *arrays, size_t n_arrays);

enum { MEMORY_ARRAYS_MAX = 32 }; ///< see memory_resize()

/// Memory that the arrays of one task and those of the next one share. Zero-initialise; memory_free(bytes).
typedef struct memory_block {
    void *bytes;     ///< aligned as by memory_alloc(); NULL at first
    size_t capacity; ///< bytes
} memory_block;

/// Lay arrays out in a block, each aligned as by memory_alloc(), in place of those of the task before. Their contents
/// are arbitrary, but for the first n items of the first array, which stay if it was the first one before. Returns 0; or
/// -1, with everything left as it was, or, if nothing was to stay, with an empty block.
int memory_lay_out(memory_block *block, const memory_array *arrays, size_t n_arrays);

/// Free memory of memory_alloc(), memory_resize() or memory_reserve(); NULL is fine.
void memory_free(void *block);

/// n bytes as by malloc(), also NULL when a fault was planned; for libraries that accept
/// an allocator. Free with free().
void *memory_alloc_plain(size_t n);

/// From now on let the n-th allocation (counted from 1) fail, and, if persistent, all after it.
/// n = 0 switches faults off.
void memory_plan_fault(size_t n, int persistent);

/// How many allocations have failed by plan since memory_plan_fault().
size_t memory_faults(void);
