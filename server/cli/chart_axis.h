/// The axes of a chart: round ticks and where values stand.

#pragma once

enum {
    CHART_AXIS_TICKS_MAX = 40,  ///< ticks on an axis
    CHART_AXIS_LABEL_SIZE = 24, ///< bytes of a tick's label with its terminator
};

/// Ticks at (first + i) * step, 0 <= i < n, of an axis from low to high.
typedef struct chart_axis {
    double low;   ///< value at the start of the axis
    double high;  ///< value at its end, > low
    double step;  ///< 1, 2 or 5 times a power of ten
    double first; ///< first tick, in steps
    int n;        ///< ticks
} chart_axis;

/// What an axis may do to get its ends.
typedef enum chart_axis_ends {
    CHART_AXIS_AS_GIVEN, ///< they stay where they are
    CHART_AXIS_ON_TICKS, ///< they move outwards to ticks
} chart_axis_ends;

/// An axis over low .. high (low <= high, both within 1e300) with about n_wanted ticks. An empty
/// range is widened.
chart_axis chart_axis_make(double low, double high, int n_wanted, chart_axis_ends ends);

/// The value of tick i.
double chart_axis_tick(const chart_axis *a, int i);

/// Write the label of tick i (CHART_AXIS_LABEL_SIZE bytes). Returns its length.
int chart_axis_label(const chart_axis *a, int i, char *ret_label);

/// Where a value stands among n places, 0 .. n - 1, from the axis's low to its high end.
int chart_axis_place(const chart_axis *a, double value, int n);
