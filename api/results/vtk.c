// VTK's XML formats with the values appended as raw bytes: each block is its length in bytes (eight
// bytes) and its values, and `offset` counts from the byte after the underscore.

#include "api/results/results.h"

#include "api/json/number.h"
#include "api/results/results_files.h"
#include "api/results/results_priv.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

#define VTK_START(type)                                                                            \
    "<?xml version=\"1.0\"?>\n"                                                                    \
    "<VTKFile type=\"" type "\" version=\"1.0\" byte_order=\"LittleEndian\" "                      \
    "header_type=\"UInt64\">\n"

static const char data_start[] = "<AppendedData encoding=\"raw\">\n_";
static const char data_end[] = "\n</AppendedData>\n</VTKFile>\n";

enum { LENGTH_BYTES = 8 };

static bf_status append_length(uint64_t n_bytes, bf_buffer *out)
{
    return results__append_values(&n_bytes, 1, sizeof n_bytes, out);
}

static bf_status append_text(const char *text, bf_buffer *out)
{
    return buffer_append(out, text, strlen(text));
}

// The time as ParaView looks for it.
static bf_status append_time(double t, bf_buffer *out)
{
    char text[NUMBER_SIZE];

    number_format(t, text);
    return buffer_printf(out,
                         "<FieldData>\n<DataArray type=\"Float64\" Name=\"TimeValue\" "
                         "NumberOfTuples=\"1\" format=\"ascii\">%s</DataArray>\n</FieldData>\n",
                         text);
}

static bf_status append_image_header(const bf_grid *grid, double t, bf_buffer *out)
{
    char origin[2][NUMBER_SIZE], spacing[2][NUMBER_SIZE];

    number_format(grid->lower1, origin[0]);
    number_format(grid->lower2, origin[1]);
    number_format(grid->d1, spacing[0]);
    number_format(grid->d2, spacing[1]);
    BF_TRY(buffer_printf(
        out,
        VTK_START("ImageData") "<ImageData WholeExtent=\"0 %zu 0 %zu 0 0\" Origin=\"%s %s 0\" "
                               "Spacing=\"%s %s 1\">\n",
        grid->n1, grid->n2, origin[0], origin[1], spacing[0], spacing[1]));
    BF_TRY(append_time(t, out));
    return buffer_printf(out,
                         "<Piece Extent=\"0 %zu 0 %zu 0 0\">\n<CellData Scalars=\"density\">\n"
                         "<DataArray type=\"Float32\" Name=\"density\" format=\"appended\" "
                         "offset=\"0\"/>\n</CellData>\n</Piece>\n</ImageData>\n",
                         grid->n1, grid->n2);
}

bf_status results__vti_head(const bf_grid *grid, double t, bf_buffer *out)
{
    BF_TRY(append_image_header(grid, t, out));
    BF_TRY(append_text(data_start, out));
    return append_length(grid_cells(grid) * sizeof(float), out);
}

bf_status results__vti_tail(bf_buffer *out)
{
    return append_text(data_end, out);
}

bf_status results_snapshot_vti(const float *rho, const bf_grid *grid, double t, bf_buffer *out,
                               bf_error *err)
{
    size_t n_before = out->n;

    bf_status status = results__vti_head(grid, t, out);
    if (status == BF_OK)
        status = results__append_values(rho, grid_cells(grid), sizeof *rho, out);
    if (status == BF_OK)
        status = results__vti_tail(out);
    return results__finish(status, out, n_before, err);
}

// An array of a point's doubles, from columns of the part's row in scenarios with feeds; others have none of
// the first FRAME_VALUES_FED. Z is 0 where the path is planar.
typedef struct vtk_array {
    const char *name;
    int n; // components
    int columns[4];
} vtk_array;

enum { Z = -1, ARRAYS = 6, ARRAYS_FED = 2 };

// The points first, and last what only scenarios with feeds have.
static const vtk_array disk_arrays[ARRAYS] = {
    { "position_m", 3, { 2, 3, Z } },
    { "velocity_m_s", 3, { 5, 6, Z } },
    { "heading_rad", 1, { 4 } },
    { "spin_rad_s", 1, { 7 } },
    { "id", 1, { 0 } },
    { "kind", 1, { 1 } },
};
static const vtk_array body_arrays[ARRAYS] = {
    { "position_m", 3, { 2, 3, 4 } },
    { "velocity_m_s", 3, { 9, 10, 11 } },
    { "quaternion_wxyz", 4, { 5, 6, 7, 8 } },
    { "spin_rad_s", 3, { 12, 13, 14 } },
    { "id", 1, { 0 } },
    { "kind", 1, { 1 } },
};

// What a file of parts holds: those that are in the domain.
typedef struct vtk_points {
    const double *rows;
    const api_parts *parts;
    const vtk_array *arrays;
    int n_arrays;
    int first_column; // of the rows
    uint64_t n;       // in the domain
    uint64_t offset;  // of the next block
} vtk_points;

static bool is_inside(const vtk_points *v, uint64_t part)
{
    return !isnan(v->rows[part * v->parts->n_values]);
}

static bf_status append_array(vtk_points *v, const char *type, const char *name, int n,
                              uint64_t n_bytes, bf_buffer *out)
{
    uint64_t offset = v->offset;

    v->offset += LENGTH_BYTES + n_bytes;
    return buffer_printf(out,
                         "<DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%d\" "
                         "format=\"appended\" offset=\"%" PRIu64 "\"/>\n",
                         type, name, n, offset);
}

static bf_status append_doubles_array(vtk_points *v, const vtk_array *a, bf_buffer *out)
{
    return append_array(v, "Float64", a->name, a->n, v->n * (uint64_t)a->n * sizeof(double), out);
}

static bf_status append_numbers_array(vtk_points *v, const char *name, bf_buffer *out)
{
    return append_array(v, "Int32", name, 1, v->n * sizeof(int32_t), out);
}

static bf_status append_points_header(vtk_points *v, double t, bf_buffer *out)
{
    BF_TRY(append_text(VTK_START("PolyData") "<PolyData>\n", out));
    BF_TRY(append_time(t, out));
    BF_TRY(buffer_printf(out,
                         "<Piece NumberOfPoints=\"%" PRIu64 "\" NumberOfVerts=\"%" PRIu64
                         "\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n"
                         "<Points>\n",
                         v->n, v->n));
    BF_TRY(append_doubles_array(v, &v->arrays[0], out));
    BF_TRY(append_text("</Points>\n<PointData Vectors=\"velocity_m_s\">\n", out));
    for (int k = 1; k < v->n_arrays; k++)
        BF_TRY(append_doubles_array(v, &v->arrays[k], out));
    BF_TRY(append_numbers_array(v, "part", out));
    BF_TRY(append_text("</PointData>\n<Verts>\n", out));
    BF_TRY(append_numbers_array(v, "connectivity", out));
    BF_TRY(append_numbers_array(v, "offsets", out));
    return append_text("</Verts>\n</Piece>\n</PolyData>\n", out);
}

static bf_status append_doubles_block(const vtk_points *v, const vtk_array *a, bf_buffer *out)
{
    BF_TRY(append_length(v->n * (uint64_t)a->n * sizeof(double), out));
    for (uint64_t part = 0; part < v->parts->n_parts; part++) {
        const double *row = v->rows + part * v->parts->n_values;
        double values[4];
        if (!is_inside(v, part))
            continue;
        for (int k = 0; k < a->n; k++)
            values[k] = a->columns[k] == Z ? 0.0 : row[a->columns[k] - v->first_column];
        BF_TRY(results__append_values(values, (size_t)a->n, sizeof *values, out));
    }
    return BF_OK;
}

// One whole number for each point: its part's, or first, first + 1, ...
typedef enum vtk_numbers {
    NUMBERS_OF_PARTS = -1,
    NUMBERS_FROM_0 = 0,
    NUMBERS_FROM_1 = 1
} vtk_numbers;

static bf_status append_numbers_block(const vtk_points *v, vtk_numbers which, bf_buffer *out)
{
    BF_TRY(append_length(v->n * sizeof(int32_t), out));
    int32_t next = which;

    for (uint64_t part = 0; part < v->parts->n_parts; part++) {
        if (!is_inside(v, part))
            continue;
        int32_t number = which == NUMBERS_OF_PARTS ? (int32_t)part : next++;
        BF_TRY(results__append_values(&number, 1, sizeof number, out));
    }
    return BF_OK;
}

static bf_status append_points_data(const vtk_points *v, bf_buffer *out)
{
    BF_TRY(append_text(data_start, out));
    for (int k = 0; k < v->n_arrays; k++)
        BF_TRY(append_doubles_block(v, &v->arrays[k], out));
    BF_TRY(append_numbers_block(v, NUMBERS_OF_PARTS, out));
    BF_TRY(append_numbers_block(v, NUMBERS_FROM_0, out));
    BF_TRY(append_numbers_block(v, NUMBERS_FROM_1, out));
    return append_text(data_end, out);
}

bf_status results_parts_vtp(const double *rows, const api_parts *parts, double t, bf_buffer *out,
                            bf_error *err)
{
    const bool has_ids = frame_has_ids(parts->n_values);
    vtk_points v = { .rows = rows,
                     .parts = parts,
                     .arrays = frame_is_planar(parts->n_values) ? disk_arrays : body_arrays,
                     .n_arrays = has_ids ? ARRAYS : ARRAYS - ARRAYS_FED,
                     .first_column = has_ids ? 0 : FRAME_VALUES_FED };
    size_t n_before = out->n;

    for (uint64_t part = 0; part < parts->n_parts; part++)
        v.n += is_inside(&v, part);
    bf_status status = append_points_header(&v, t, out);
    if (status == BF_OK)
        status = append_points_data(&v, out);
    return results__finish(status, out, n_before, err);
}

bf_status results_series_pvd(const api_snapshot_list *list, results_files file, bf_buffer *out,
                             bf_error *err)
{
    const api_snapshot *items = (const api_snapshot *)(const void *)list->items.bytes;
    size_t n_before = out->n;

    bf_status status = append_text(VTK_START("Collection") "<Collection>\n", out);
    for (size_t k = 0; k < list->n && status == BF_OK; k++) {
        char name[RESULTS_FILES_NAME_SIZE], t[NUMBER_SIZE];
        (void)results_files_name(file, items[k].index, name);
        number_format(items[k].t, t);
        status = buffer_printf(out, "<DataSet timestep=\"%s\" part=\"0\" file=\"%s\"/>\n", t, name);
    }
    if (status == BF_OK)
        status = append_text("</Collection>\n</VTKFile>\n", out);
    return results__finish(status, out, n_before, err);
}
