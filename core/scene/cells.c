#include "core/scene/cells.h"

#include "core/scene/scene.h"
#include "core/scene/shape.h"

#include <math.h>
#include <stdbool.h>

/// A side this near to a whole number of cells counts as one, relative to its length, and at most this
/// part of a cell off.
static const double whole = 1e-6;
static const double whole_most = 0.01;

static bool is_whole(double length, double cell)
{
    const double ratio = length / cell, n = round(ratio);

    return n >= 1.0 && fabs(ratio - n) <= fmin(whole * n, whole_most);
}

static double smallest_diameter(const scene *s)
{
    double area = INFINITY;

    for (size_t k = 0; k < s->n_cargo; k++)
        if (shape_is_sound(&s->cargo[k].shape))
            area = fmin(area, shape_footprint_of(&s->cargo[k].shape).area);
    return 2.0 * sqrt(area / M_PI);
}

double cells_wanted(const scene *s)
{
    const scene_rect *d = &s->domain;
    const double area = (d->x_max - d->x_min) * (d->y_max - d->y_min);

    if (s->macro.cell != 0.0)
        return s->macro.cell;
    const double n = s->macro.closure == SCENE_DISPERSIVE ? CELLS_PER_DIAMETER_DISPERSIVE
                                                          : CELLS_PER_DIAMETER_CONGESTED;
    const double chosen = fmax(smallest_diameter(s) / n, sqrt(area / CELLS_AUTO_MAX));
    return fmin(chosen, sqrt(area)); // where no kind has a size
}

cells cells_of(const scene *s)
{
    const double length1 = s->domain.x_max - s->domain.x_min;
    const double length2 = s->domain.y_max - s->domain.y_min;
    const double cell = cells_wanted(s);

    if (is_whole(length1, cell) && is_whole(length2, cell))
        return (cells){ round(length1 / cell), round(length2 / cell), cell, cell };
    const double shorter = fmin(length1, length2), longer = fmax(length1, length2);
    const double n_shorter = fmax(round(shorter / cell), 1.0);
    const double n_longer = fmax(round(longer * n_shorter / shorter), 1.0);
    const double n1 = length1 <= length2 ? n_shorter : n_longer;
    const double n2 = length1 <= length2 ? n_longer : n_shorter;
    return (cells){ n1, n2, length1 / n1, length2 / n2 };
}

bf_grid scene_grid(const scene *s)
{
    const cells c = cells_of(s);

    return (bf_grid){ .n1 = (size_t)c.n1,
                      .n2 = (size_t)c.n2,
                      .lower1 = s->domain.x_min,
                      .lower2 = s->domain.y_min,
                      .d1 = c.d1,
                      .d2 = c.d2 };
}

double scene_cell_edge(const scene *s)
{
    const cells c = cells_of(s);

    return fmin(c.d1, c.d2);
}
