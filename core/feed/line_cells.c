#include "core/feed/line_cells.h"

#include "core/base/memory.h"

// Of a cell: a point this near to a border lies beyond it.
static const double border = 1e-9;

// A coordinate of the line in cells, from 0 to n of the grid.
typedef struct axis {
    double start;
    double change;   // from its start to its end
    double crossing; // the next border of cells
    size_t n;
} axis;

static axis axis_of(double start, double end, double lower, double d, size_t n)
{
    const double from = (start - lower) / d, change = (end - start) / d;

    return (axis){ from, change,
                   change > 0.0 ? floor(from + border) + 1.0 : ceil(from + border) - 1.0, n };
}

// Where along the line, 0 to 1, the next border is; 1: there is none.
static double next_crossing(const axis *a)
{
    return a->change != 0.0 ? fmin((a->crossing - a->start) / a->change, 1.0) : 1.0;
}

static size_t index_at(const axis *a, double along)
{
    const double at = floor(a->start + along * a->change + border);

    return at <= 0.0 ? 0 : at >= (double)a->n ? a->n - 1 : (size_t)at;
}

static void add_piece(line_cell *cells, size_t *n, size_t cell, double length)
{
    if (*n > 0 && cells[*n - 1].cell == cell)
        cells[*n - 1].length += length;
    else
        cells[(*n)++] = (line_cell){ cell, length };
}

bf_status line_cells_find(const bf_grid *grid, vec2 start, vec2 end, line_cell **ret_cells,
                          size_t *ret_n, bf_error *err)
{
    axis x = axis_of(start.x, end.x, grid->lower1, grid->d1, grid->n1);
    axis y = axis_of(start.y, end.y, grid->lower2, grid->d2, grid->n2);
    const double length = vec2_length(vec2_sub(end, start));
    line_cell *cells = memory_alloc(grid->n1 + grid->n2 + 1, sizeof *cells);
    size_t n = 0;

    if (cells == NULL)
        return bf_fail(err, BF_ENOMEM, "/feeds", "no memory for the cells of a line");
    for (double at = 0.0; at < 1.0;) {
        const double next_x = next_crossing(&x), next_y = next_crossing(&y);
        const double next = fmax(fmin(next_x, next_y), at), middle = 0.5 * (at + next);
        if ((next - at) * length > border * fmin(grid->d1, grid->d2))
            add_piece(cells, &n, index_at(&y, middle) * grid->n1 + index_at(&x, middle),
                      (next - at) * length);
        x.crossing += next_x <= next ? (x.change > 0.0 ? 1.0 : -1.0) : 0.0;
        y.crossing += next_y <= next ? (y.change > 0.0 ? 1.0 : -1.0) : 0.0;
        at = next;
    }
    if (n == 0)
        add_piece(cells, &n, index_at(&y, 0.0) * grid->n1 + index_at(&x, 0.0), 1.0);
    *ret_cells = cells;
    *ret_n = n;
    return BF_OK;
}
