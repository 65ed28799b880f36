/// A density as a picture: rows of levels of a fixed scale, in true proportions.
///
/// x points to the right and y up, so the first row of pixels is the one of the largest y. Pixels are
/// square: the height follows from the width and the size of the grid in metres. Along each axis,
/// where there are fewer pixels than cells, a pixel is the mean of the cells that it covers, weighted by
/// area; else it shows the cell that its centre lies in, so that cells stay cells.

#pragma once

#include "core/base/grid.h"
#include "core/base/status.h"

#include <stddef.h>
#include <stdint.h>

enum {
    PICTURE_WIDTH_MAX = 8192,      ///< pixels of a row
    PICTURE_PIXELS_MAX = 16777216, ///< pixels of a picture
    PICTURE_WIDTH_USUAL = 1000     ///< pixels of a row, about, unless told otherwise
};

/// Density at the end of the scale, unless told otherwise: packed cargo is 1, and what the models give
/// in a jam lies below this.
#define PICTURE_TOP 1.5

/// How large a picture is and where its scale ends.
typedef struct picture {
    bf_grid grid;  ///< cells that it shows
    size_t width;  ///< pixels
    size_t height; ///< pixels
    double top;    ///< density of the last level; the first one is 0
} picture;

/// Lay out the picture of a grid. width 0 takes the largest whole number of pixels a cell that gives
/// at most PICTURE_WIDTH_USUAL, at least one, as far as limits let it. BF_ELIMIT: more than
/// PICTURE_PIXELS_MAX; the text has the figures.
BF_MUST_CHECK bf_status picture_layout(const bf_grid *grid, size_t width, double top,
                                       picture *ret_picture, bf_error *err);

/// Give row j of the cells, n1 densities, that stay until the next call. A failure is passed on.
typedef bf_status picture_cells_fn(void *context, size_t j, const float **ret_cells, bf_error *err);

/// The levels (0 to 255) of all pixels, row by row from the topmost, into ret_levels (width times height of them). cells
/// is asked for each row once, in rising order. A density below 0 or none at all counts as 0, one beyond top as top.
BF_MUST_CHECK bf_status picture_draw(const picture *p, picture_cells_fn *cells, void *context,
                                     uint8_t *ret_levels, bf_error *err);
