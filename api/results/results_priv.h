/// Private to api/results.

#pragma once

#include "core/base/buffer.h"
#include "core/base/grid.h"
#include "core/base/status.h"

#include <stddef.h>

/// Words of plate_drive_state.
extern const char *const results__drive_states[];
extern const char *const results__belt_states[];

/// Members of a drive in its event and in the list of all; AT() is the place of `state`, `turn_deg` and `shift` in their structs,
/// of which is_shifted tells whether the last one is not 0.
#define RESULTS__DRIVE_MEMBERS(is_shifted)                                                         \
    MEMBER("state", enum, AT(state), "How it follows what it is told from then on",                \
           .words = results__drive_states),                                                        \
        MEMBER("turn_deg", number, AT(turn_deg), "By which its path is turned, counter-clockwise", \
               .unit = "deg"),                                                                     \
        MEMBER("shift_m", point, AT(shift), "By which its path is shifted; none without it",       \
               .unit = "m", .applies = is_shifted)

/// What stops a belt, as events and lists tell it; results__belt_states has the words of belt_stops_cause.
#define RESULTS__BELT_MEMBERS                                                                      \
    MEMBER("state", enum, AT(state),                                                               \
           "From then on: nothing of these stops it, a failure does, a break, or a merge",         \
           .words = results__belt_states)

/// Samples of a curve, as results_curve_members writes them.
typedef struct results__samples {
    const char *columns;  ///< names, with commas between; NULL: there are none
    const double *t;      ///< n times
    const double *values; ///< n rows of n_columns
    size_t n;
    size_t n_columns;
} results__samples;

/// End of a function that appends: on failure *out is again as it was, n bytes long.
bf_status results__finish(bf_status status, bf_buffer *out, size_t n, bf_error *err);

/// Write a number ("nan" if it is none) and a separator at text; returns where the next one goes.
char *results__put_number(char *text, double value, char separator);

/// Append n numbers of size bytes each, little-endian. BF_ENOMEM: *out is as before.
BF_MUST_CHECK bf_status results__append_values(const void *values, size_t n, size_t size,
                                               bf_buffer *out);

/// Bring n numbers of size bytes each to little-endian order.
void results__order_bytes(char *bytes, size_t n, size_t size);

/// Append the head of a NumPy file of n2 rows of n1 numbers of a type ("<f4"): what stands before them. BF_ENOMEM.
BF_MUST_CHECK bf_status results__npy_head(const char *type, size_t n1, size_t n2, bf_buffer *out);

/// Append what stands before and behind the numbers of a VTK image. BF_ENOMEM.
BF_MUST_CHECK bf_status results__vti_head(const bf_grid *grid, double t, bf_buffer *out);
BF_MUST_CHECK bf_status results__vti_tail(bf_buffer *out);
