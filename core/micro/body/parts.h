/// Parts seen from outside of steps: they enter, are read and measured, saved and loaded.

#pragma once

#include "core/base/memory.h"
#include "core/micro/body/body_priv.h"

/// Give all arrays room for a number of parts, more than now. BF_ENOMEM: s is as before.
BF_MUST_CHECK bf_status body__resize(body_state *s, size_t capacity);

/// Set n, and the number of blocks with it.
void body__set_parts(body_state *s, size_t n);

/// Place part k, which lies flat.
void body__place_part(body_state *s, size_t k, const micro_arrival *arrival);

/// The arrays of MICRO_IMPLICIT as they have to be for a number of parts, at most 4, of which n are kept. Returns how many.
size_t body__implicit_arrays(struct implicit_solver *z, size_t n, size_t capacity,
                             memory_array *ret_arrays);

/// Members of micro_backend.
bf_status body__admit(void *state, size_t k, const micro_arrival *arrival, bf_error *err);
void body__take_out(void *state, size_t k);
void body__forget_gone(void *state);
micro_part body__part(const void *state, size_t k);
micro_extent body__extent(const void *state, size_t k);
micro_totals body__measure(const void *state);
void body__save(const void *state, checkpoint_writer *w);
bf_status body__load(void *state, size_t n, checkpoint_reader *r, bf_error *err);
