#include "core/base/memory.h"

#include "core/base/check.h"

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { ALIGNMENT = 64, FIRST_CAPACITY = 16 };

static atomic_size_t fault_at;   // 0: no fault is planned
static atomic_size_t n_requests; // since the plan
static atomic_size_t n_faults;
static atomic_bool fault_persists;

static bool is_fault_due(void)
{
    size_t at = atomic_load_explicit(&fault_at, memory_order_relaxed);
    if (at == 0)
        return false;
    size_t request = atomic_fetch_add(&n_requests, 1) + 1;
    bool due = request == at || (request > at && atomic_load(&fault_persists));
    if (due)
        atomic_fetch_add(&n_faults, 1);
    return due;
}

void *memory_alloc(size_t n, size_t size)
{
    size_t bytes;

    if (is_fault_due() || __builtin_mul_overflow(n, size, &bytes) || bytes > SIZE_MAX - ALIGNMENT)
        return NULL;
    bytes = bytes == 0 ? ALIGNMENT : (bytes + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
    // Large blocks come zeroed from the kernel; calloc keeps their pages untouched until used.
    void *raw = calloc(1, bytes + ALIGNMENT);
    if (raw == NULL)
        return NULL;
    char *block = (char *)(((uintptr_t)raw / ALIGNMENT + 1) * ALIGNMENT);
    memcpy(block - sizeof raw, &raw, sizeof raw);
    return block;
}

void *memory_alloc_plain(size_t n)
{
    return is_fault_due() ? NULL : malloc(n);
}

void memory_free(void *block)
{
    void *raw;

    if (block == NULL)
        return;
    memcpy(&raw, (char *)block - sizeof raw, sizeof raw);
    free(raw);
}

int memory_reserve(void *items, size_t *capacity, size_t n, size_t size)
{
    void *old;

    if (n <= *capacity)
        return 0;
    size_t wanted = *capacity < FIRST_CAPACITY ? FIRST_CAPACITY : *capacity + *capacity / 4;
    if (wanted < n)
        wanted = n;
    void *grown = memory_alloc(wanted, size);
    if (grown == NULL)
        return -1;
    memcpy(&old, items, sizeof old);
    BF_CHECK((old == NULL) == (*capacity == 0));
    if (old != NULL)
        memcpy(grown, old, *capacity * size);
    memory_free(old);
    memcpy(items, &grown, sizeof grown);
    *capacity = wanted;
    return 0;
}

int memory_resize(const memory_array *arrays, size_t n_arrays)
{
    void *grown[MEMORY_ARRAYS_MAX] = { NULL }, *old;

    BF_CHECK(n_arrays <= MEMORY_ARRAYS_MAX);
    for (size_t k = 0; k < n_arrays; k++) {
        if (arrays[k].n_new == 0)
            continue;
        grown[k] = memory_alloc(arrays[k].n_new, arrays[k].size);
        if (grown[k] != NULL)
            continue;
        while (k-- > 0)
            memory_free(grown[k]);
        return -1;
    }
    for (size_t k = 0; k < n_arrays; k++) {
        if (arrays[k].n_new == 0)
            continue;
        memcpy(&old, arrays[k].items, sizeof old);
        if (arrays[k].n > 0)
            memcpy(grown[k], old, arrays[k].n * arrays[k].size);
        memory_free(old);
        memcpy(arrays[k].items, &grown[k], sizeof old);
    }
    return 0;
}

// Bytes of an array in a block; false: too many.
static bool measure_array(const memory_array *array, size_t *ret_bytes)
{
    size_t bytes;

    if (__builtin_mul_overflow(array->n_new, array->size, &bytes) ||
        bytes > SIZE_MAX - (ALIGNMENT - 1))
        return false;
    *ret_bytes = (bytes + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
    return true;
}

// Room for n bytes, where the first n_kept stay. If none does, the old room is freed first.
static int grow_block(memory_block *block, size_t n, size_t n_kept)
{
    if (n <= block->capacity)
        return 0;
    if (n_kept == 0) {
        memory_free(block->bytes);
        *block = (memory_block){ NULL, 0 };
    }
    const size_t wanted = n <= SIZE_MAX / 2 ? n + n / 8 : n;
    void *grown = memory_alloc(wanted, 1);
    if (grown == NULL)
        return -1;
    if (n_kept > 0)
        memcpy(grown, block->bytes, n_kept);
    memory_free(block->bytes);
    *block = (memory_block){ grown, wanted };
    return 0;
}

int memory_lay_out(memory_block *block, const memory_array *arrays, size_t n_arrays)
{
    size_t bytes, total = 0;

    for (size_t k = 0; k < n_arrays; k++)
        if (!measure_array(&arrays[k], &bytes) || __builtin_add_overflow(total, bytes, &total))
            return -1;
    if (grow_block(block, total, n_arrays > 0 ? arrays[0].n * arrays[0].size : 0) != 0)
        return -1;
    char *at = block->bytes;
    for (size_t k = 0; k < n_arrays; k++) {
        void *items = at;
        memcpy(arrays[k].items, &items, sizeof items);
        (void)measure_array(&arrays[k], &bytes);
        at += bytes;
    }
    return 0;
}

void memory_plan_fault(size_t n, int persistent)
{
    atomic_store(&n_requests, 0);
    atomic_store(&n_faults, 0);
    atomic_store(&fault_persists, persistent != 0);
    atomic_store(&fault_at, n);
}

size_t memory_faults(void)
{
    return atomic_load(&n_faults);
}
