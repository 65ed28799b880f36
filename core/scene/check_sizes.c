#include "core/scene/check_priv.h"

#include <math.h>

/// A domain this near to a whole number of cells is one, relative to its length, and at most this
/// part of a cell off.
#define WHOLE     1e-6
#define WHOLE_MAX 0.01

/// Note a length that is no whole number of cells, with the nearest cell edges that divide it.
static void check_whole(double length, double cell, const char *axis, bf_faults *faults)
{
    double ratio = length / cell, n = round(ratio);

    if (n >= 1.0 && fabs(ratio - n) <= fmin(WHOLE * n, WHOLE_MAX))
        return;
    double fewer = fmax(floor(ratio), 1.0), more = fmax(ceil(ratio), 1.0);
    if (fewer < more)
        faults_add(faults, "/macro/cell_m",
                   "the domain's %.12g m along %s are %.12g cells of %.12g m; %.12g m (%.0f cells) "
                   "or %.12g m (%.0f cells) would do",
                   length, axis, ratio, cell, length / fewer, fewer, length / more, more);
    else
        faults_add(faults, "/macro/cell_m",
                   "the domain's %.12g m along %s are %.12g cells of %.12g m; %.12g m (%.0f cells) "
                   "would do",
                   length, axis, ratio, cell, length / fewer, fewer);
}

/// Note a number beyond its limit.
static void check_limit(double figure, double limit, const char *what, const char *pointer,
                        bf_faults *faults)
{
    if (!(figure <= limit))
        faults_add_limit(faults, pointer, "%.10g %s, the limit is %.10g", figure, what, limit);
}

static void check_work(const scene *s, double n_cells, bf_faults *faults)
{
    // A part reaches to where its Gaussian has fallen to 2^-53, see density.h.
    double reached =
        2.0 * M_PI * 53.0 * M_LN2 / (s->macro.initial_mollifier * s->macro.cell * s->macro.cell);

    // Too many parts are told of where they come from.
    double n_parts = fmin((double)scene_parts(s), SCENE_PARTS_MAX);

    check_limit(n_parts * fmin(reached, n_cells), SCENE_INITIAL_WORK_MAX,
                "values to sum up for the density at the start", "/macro/initial_mollifier_per_m2",
                faults);
}

/// Note a grid that is too large or does not fit the domain. Returns true if it is neither.
static bool check_grid(const scene *s, double n1, double n2, bf_faults *faults)
{
    size_t n_before = faults->n;

    check_whole(s->domain.x_max - s->domain.x_min, s->macro.cell, "x", faults);
    check_whole(s->domain.y_max - s->domain.y_min, s->macro.cell, "y", faults);
    check_limit(n1 * n2, SCENE_CELLS_MAX, "cells", "/macro/cell_m", faults);
    check_limit(fmax(n1, n2), SCENE_CELLS_SIDE_MAX, "cells in a row", "/macro/cell_m", faults);
    return faults->n == n_before;
}

void scene_check__sizes(const scene *s, bf_faults *faults)
{
    double cell = s->macro.cell;
    double n1 = fmax(round((s->domain.x_max - s->domain.x_min) / cell), 1.0);
    double n2 = fmax(round((s->domain.y_max - s->domain.y_min) / cell), 1.0);
    double n_snapshots = floor(s->duration / s->output.snapshot_every) + 2.0;

    check_limit(floor(s->duration / s->output.curve_every) + 2.0, SCENE_SAMPLES_MAX,
                "samples of the curve", "/output/curve_every_s", faults);
    check_limit(n_snapshots, SCENE_SNAPSHOTS_MAX, "snapshots", "/output/snapshot_every_s", faults);
    // What follows from a wrong cell would only repeat that it is wrong.
    if (!check_grid(s, n1, n2, faults))
        return;
    check_limit(n_snapshots * n1 * n2 * (double)sizeof(float), SCENE_SNAPSHOT_BYTES_MAX,
                "bytes of snapshots", "/output/snapshot_every_s", faults);
    check_work(s, n1 * n2, faults);
}
