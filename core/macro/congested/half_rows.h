/// Where cells and their faces stand in the half rows of congested_priv.h.

#pragma once

#include "core/macro/congested/congested_priv.h"

/// Row j of half rows; cell k is element k.
static inline float *congested__row(const congested *c, float *rows, ptrdiff_t j)
{
    return rows + (j + 1) * c->half_stride + CONGESTED_UNIT;
}

/// The flags of a half row, is_uniform by groups, is_unforced by registers; is_unsettled by units, in colour 0.
static inline bool *congested__flags(const congested *c, bool *flags, ptrdiff_t row, int colour)
{
    return flags + (2 * row + colour) * c->half_width;
}

/// Where the faces between row j and the rows next to it have their red cells: the face west of the black cell k of
/// row j is the east face of the red cell k - 1 + shift, the one east of it the west face of k + shift.
static inline ptrdiff_t congested__shift(ptrdiff_t row)
{
    return (row & 1) == 0 ? 1 : 0;
}

/// The faces on one side of the cells of a half row.
typedef struct congested_side_faces {
    const congested_law *law; ///< in whose arrays they are
    ptrdiff_t at;             ///< element of the face of cell 0; that of cell k is at + k
} congested_side_faces;

/// The faces around the cells of a half row.
typedef struct congested_row_faces {
    congested_side_faces side[CONGESTED_SIDES]; ///< by congested_side
} congested_row_faces;

/// colour 0: red cells, whose faces are their own; else black ones, whose faces are those of their neighbours.
static inline congested_row_faces congested__faces(const congested *c, ptrdiff_t row, int colour)
{
    const ptrdiff_t shift = congested__shift(row);
    const ptrdiff_t at = (row + 1) * c->half_stride + CONGESTED_UNIT;
    const congested_law *west = &c->law[CONGESTED_WEST], *east = &c->law[CONGESTED_EAST];
    const congested_law *south = &c->law[CONGESTED_SOUTH], *north = &c->law[CONGESTED_NORTH];

    if (colour == 0)
        return (
            congested_row_faces){ { { west, at }, { east, at }, { south, at }, { north, at } } };
    return (congested_row_faces){ { { east, at + shift - 1 },
                                    { west, at + shift },
                                    { north, at - c->half_stride },
                                    { south, at + c->half_stride } } };
}

/// The value at an x1-face i, 0 <= i <= n1, west of cell i of row j: of law[] member `of`.
#define CONGESTED_FACE1(c, of, i, j)                                                               \
    ((((i) + (j)) & 1) == 0 ? congested__row(c, (c)->law[CONGESTED_WEST].of, j) + ((i) >> 1)       \
                            : congested__row(c, (c)->law[CONGESTED_EAST].of, j) + (((i)-1) >> 1))

/// Same at an x2-face r, 0 <= r <= n2, south of cell i of row r.
#define CONGESTED_FACE2(c, of, i, r)                                                               \
    ((((i) + (r)) & 1) == 0 ? congested__row(c, (c)->law[CONGESTED_SOUTH].of, r) + ((i) >> 1)      \
                            : congested__row(c, (c)->law[CONGESTED_NORTH].of, (r)-1) + ((i) >> 1))
