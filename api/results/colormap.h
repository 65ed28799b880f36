/// Colour maps for pictures: a level of a scale to a colour.
///
/// viridis (S. van der Walt, N. Smith and E. Firing, Matplotlib 1.5, 2015) and cividis (J. Nunez,
/// C. Anderton and R. Renslow, PLoS ONE 13(7), 2018) are perceptually uniform, rise in lightness, and
/// stay readable with a colour vision deficiency and in print without colour; here as polynomials of
/// degree 6 through their published tables, within 3 (viridis) and 6 (cividis) of 255 levels. grey is
/// that of the paper: an empty belt is white, packed cargo black.

#pragma once

#include <stdint.h>

enum { COLORMAP_LEVELS = 256 }; ///< colours of a map

/// A colour, sRGB.
typedef struct colormap_color {
    uint8_t red;   ///< 0 to 255
    uint8_t green; ///< 0 to 255
    uint8_t blue;  ///< 0 to 255
} colormap_color;

/// A map; opaque and static.
typedef struct colormap colormap;

/// The words of all maps, the default first: "viridis cividis grey".
const char *colormap_words(void);

/// The default.
const colormap *colormap_first(void);

/// The map of a word, or NULL: there is none.
const colormap *colormap_find(const char *word);

/// The word of a map.
const char *colormap_word(const colormap *map);

/// Colour `level` of a map, 0 .. COLORMAP_LEVELS - 1; 0 stands for an empty belt.
colormap_color colormap_at(const colormap *map, unsigned level);
