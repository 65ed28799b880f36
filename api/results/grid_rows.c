#include "api/results/grid_rows.h"

#include "core/base/check.h"

bf_status grid_rows_open(const api_services *services, const char *id, uint64_t index,
                         grid_rows *ret_rows, bf_error *err)
{
    *ret_rows = (grid_rows){ .services = services };
    return services->open_array(services->store, id, index, API_ARRAY_DENSITY, &ret_rows->of,
                                &ret_rows->slices, err);
}

// Reads rows from j on, as many as fit into a block.
static bf_status read_block(grid_rows *rows, size_t j, bf_error *err)
{
    const api_services *services = rows->services;
    const size_t row = rows->of.grid.n1 * sizeof(float), n_left = rows->of.grid.n2 - j;
    size_t n = GRID_ROWS_BYTES / row;

    n = n < 1 ? 1 : n < n_left ? n : n_left;
    rows->n = 0;
    rows->block.n = 0;
    while (rows->block.n < n * row)
        BF_TRY(services->read_slice(services->store, &rows->slices, j * row + rows->block.n,
                                    n * row - rows->block.n, &rows->block, err));
    rows->first = j;
    rows->n = n;
    return BF_OK;
}

bf_status grid_rows_next(void *context, size_t j, const float **ret_cells, bf_error *err)
{
    grid_rows *rows = context;

    BF_CHECK(j < rows->of.grid.n2);
    if (j < rows->first || j >= rows->first + rows->n)
        BF_TRY(read_block(rows, j, err));
    *ret_cells =
        (const float *)(const void *)rows->block.bytes + (j - rows->first) * rows->of.grid.n1;
    return BF_OK;
}

void grid_rows_fini(grid_rows *rows)
{
    buffer_fini(&rows->block);
    api_slices_fini(&rows->slices);
}
