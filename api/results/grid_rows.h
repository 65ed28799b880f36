/// The rows of a stored density, read one after the other, so that a grid of any size takes little memory.

#pragma once

#include "api/services.h"
#include "core/base/buffer.h"

#include <stddef.h>

enum { GRID_ROWS_BYTES = 131072 }; ///< of rows that are read at once, or one row if that is more

/// A density that is being read. grid_rows_open(); grid_rows_fini().
typedef struct grid_rows {
    const api_services *services; ///< borrowed
    api_array of;                 ///< what it is of
    api_slices slices;            ///< the numbers
    bf_buffer block;              ///< rows that were read
    size_t first;                 ///< the first one of them
    size_t n;                     ///< how many
} grid_rows;

/// Begin to read a snapshot. Errors are those of api_services.open_array(). *ret_rows is the caller's.
BF_MUST_CHECK bf_status grid_rows_open(const api_services *services, const char *id, uint64_t index,
                                       grid_rows *ret_rows, bf_error *err);

/// Row j of the grid, n1 densities that stay until the next call; a picture_cells_fn. It is fast where rows are asked
/// for in rising order. Errors are those of api_services.read_slice().
BF_MUST_CHECK bf_status grid_rows_next(void *rows, size_t j, const float **ret_cells,
                                       bf_error *err);

/// Free what the rows own.
void grid_rows_fini(grid_rows *rows);
