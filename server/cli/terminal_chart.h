/// Curves as text: a chart of block width and height with axes, ticks and a legend.
///
/// A pure function from numbers to text; terminal.h finds what the terminal can show.
/// With Unicode a character cell holds 2 x 4 dots (braille), without it one mark. Curves differ by
/// colour, else by dashes, else by marks.

#pragma once

#include "core/base/buffer.h"
#include "core/base/status.h"

#include <stdbool.h>
#include <stddef.h>

enum { TERMINAL_CHART_CURVES_MAX = 6 }; ///< curves that can be distinguished

/// How to draw.
typedef struct terminal_chart_options {
    size_t width;        ///< columns in all; taken into 40 .. 400
    size_t height;       ///< lines of the plot without axes and legend; taken into 4 .. 100
    bool is_unicode;     ///< braille and box drawing; else ASCII only
    bool has_colors;     ///< ANSI colours
    const char *x_title; ///< under the axis, with its unit
    const char *y_title; ///< above the axis, with its unit
} terminal_chart_options;

/// A curve. Points that are not finite are gaps.
typedef struct terminal_chart_curve {
    const char *label; ///< for the legend; control bytes are shown as '?'
    size_t n;          ///< points
    const double *x;   ///< n values
    const double *y;   ///< n values
} terminal_chart_curve;

/// Append the chart of n_curves curves to *out. The y axis contains 0. BF_EINPUT: there is no finite
/// point, or one beyond 1e300; BF_ELIMIT: more curves than TERMINAL_CHART_CURVES_MAX; BF_ENOMEM.
/// *out is then as before.
BF_MUST_CHECK bf_status terminal_chart_draw(const terminal_chart_options *options,
                                            const terminal_chart_curve *curves, size_t n_curves,
                                            bf_buffer *out, bf_error *err);
