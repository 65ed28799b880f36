#include "core/scene/counter.h"

/// How many of n centres, which grow with their index, lie below a limit.
static size_t count_below(const bf_grid *grid, double (*centre)(const bf_grid *, size_t), size_t n,
                          double limit)
{
    size_t low = 0;

    while (low < n) {
        size_t middle = low + (n - low) / 2;
        if (centre(grid, middle) < limit)
            low = middle + 1;
        else
            n = middle;
    }
    return low;
}

counter_cells counter_cells_of(const scene_counter *c, const bf_grid *grid)
{
    counter_cells cells = { .i_min = count_below(grid, grid_x1, grid->n1, c->rect.x_min),
                            .i_max = count_below(grid, grid_x1, grid->n1, c->rect.x_max),
                            .j_min = count_below(grid, grid_x2, grid->n2, c->rect.y_min),
                            .j_max = count_below(grid, grid_x2, grid->n2, c->rect.y_max) };
    return cells;
}

bool counter_holds(const scene_counter *c, vec2 at)
{
    return c->rect.x_min <= at.x && at.x < c->rect.x_max && c->rect.y_min <= at.y &&
           at.y < c->rect.y_max;
}
