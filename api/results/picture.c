#include "api/results/picture.h"

#include "core/base/check.h"
#include "core/base/memory.h"

#include <math.h>
#include <string.h>

// The cells below a pixel along one axis, with the shares of the first and the last one.
typedef struct span {
    size_t from;
    size_t to; // one beyond the last
    double first;
    double last;
} span;

// Of the cells that pixel k of n shows: whole numbers, so that neighbours share a cell exactly.
static span find_span(size_t k, size_t n, size_t n_cells)
{
    if (n >= n_cells) {
        size_t cell = (2 * k + 1) * n_cells / (2 * n);
        return (span){ cell, cell + 1, 1.0, 1.0 };
    }
    size_t from = k * n_cells, to = from + n_cells; // in units of 1/n of a cell
    span s = { from / n, (to + n - 1) / n, 1.0, 1.0 };
    s.first = 1.0 - (double)(from % n) / (double)n;
    s.last = to % n == 0 ? 1.0 : (double)(to % n) / (double)n;
    return s;
}

static double overlap_of(const span *s, size_t cell)
{
    return cell == s->from ? s->first : cell + 1 == s->to ? s->last : 1.0;
}

static size_t height_of(const bf_grid *grid, size_t width)
{
    double height = (double)width * ((double)grid->n2 * grid->d2) / ((double)grid->n1 * grid->d1);

    if (!(height < PICTURE_PIXELS_MAX))
        return PICTURE_PIXELS_MAX;
    return height < 1.0 ? 1 : (size_t)lround(height);
}

static size_t choose_width(const bf_grid *grid)
{
    size_t a_cell = PICTURE_WIDTH_USUAL / grid->n1;
    size_t width = grid->n1 * (a_cell < 1 ? 1 : a_cell);

    width = width < PICTURE_WIDTH_MAX ? width : PICTURE_WIDTH_MAX;
    while (width > 1 && width * height_of(grid, width) > PICTURE_PIXELS_MAX)
        width /= 2;
    return width;
}

bf_status picture_layout(const bf_grid *grid, size_t width, double top, picture *ret_picture,
                         bf_error *err)
{
    BF_CHECK(width <= PICTURE_WIDTH_MAX && top > 0.0);
    if (width == 0)
        width = choose_width(grid);
    size_t height = height_of(grid, width);
    if (width * height > PICTURE_PIXELS_MAX)
        return bf_fail(err, BF_ELIMIT, "",
                       "a picture of this grid that is %zu pixels wide would have more than %d "
                       "pixels, the limit; the widest one is about %.0f",
                       width, PICTURE_PIXELS_MAX,
                       (double)width * sqrt(PICTURE_PIXELS_MAX / (double)(width * height)));
    *ret_picture = (picture){ .grid = *grid, .width = width, .height = height, .top = top };
    return BF_OK;
}

static uint8_t level_of(double density, double top)
{
    double level = density / top * 255.0 + 0.5;

    return level >= 255.0 ? 255 : level > 0.0 ? (uint8_t)level : 0;
}

// A picture on its way, from the lowest row up.
typedef struct drawing {
    const picture *p;
    picture_cells_fn *read;
    void *context;
    const float *cells; // row n_read - 1
    size_t n_read;
    double *line; // n1 means over rows of cells
} drawing;

// Mean over the rows of cells below a row of pixels.
static bf_status add_rows(drawing *d, const span *rows, bf_error *err)
{
    size_t n1 = d->p->grid.n1;
    double sum = 0.0;

    memset(d->line, 0, n1 * sizeof *d->line);
    for (size_t j = rows->from; j < rows->to; j++) {
        double weight = overlap_of(rows, j);
        while (d->n_read <= j)
            BF_TRY(d->read(d->context, d->n_read++, &d->cells, err));
        sum += weight;
        for (size_t i = 0; i < n1; i++)
            d->line[i] += weight * (double)d->cells[i];
    }
    for (size_t i = 0; i < n1; i++)
        d->line[i] /= sum;
    return BF_OK;
}

static void draw_row(const drawing *d, uint8_t *ret_levels)
{
    const picture *p = d->p;

    for (size_t k = 0; k < p->width; k++) {
        span cells = find_span(k, p->width, p->grid.n1);
        double sum = 0.0, mean = 0.0;
        for (size_t i = cells.from; i < cells.to; i++) {
            sum += overlap_of(&cells, i);
            mean += overlap_of(&cells, i) * d->line[i];
        }
        ret_levels[k] = level_of(mean / sum, p->top);
    }
}

bf_status picture_draw(const picture *p, picture_cells_fn *cells, void *context,
                       uint8_t *ret_levels, bf_error *err)
{
    drawing d = { .p = p, .read = cells, .context = context };
    bf_status status = BF_OK;

    d.line = memory_alloc(p->grid.n1, sizeof *d.line);
    if (d.line == NULL)
        return bf_fail_memory(err);
    for (size_t k = 0; status == BF_OK && k < p->height; k++) {
        const span rows = find_span(k, p->height, p->grid.n2);
        status = add_rows(&d, &rows, err);
        if (status == BF_OK)
            draw_row(&d, ret_levels + (p->height - 1 - k) * p->width);
    }
    memory_free(d.line);
    return status;
}
